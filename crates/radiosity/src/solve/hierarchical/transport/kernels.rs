//! How the kernel `cos cos / π r²` varies between two nodes.

use super::tangents;
use core::f32::consts::PI;
use glam::Vec3;

/// Most points of a node.
const POINTS: usize = 5;
/// Points that are averaged; the one after them is the centre, which shows curvature.
const AVERAGED: usize = 4;
/// Nodes of Gauss's quadrature with two points, from -1 to 1.
const GAUSS: f32 = 0.577_350_26;

/// Points that stand for a node, and its normal, zero where it has none.
#[derive(Debug, Clone, Copy)]
pub(super) struct Points {
    at: [Vec3; POINTS],
    count: usize,
    normal: Vec3,
}

impl Points {
    /// A cluster's.
    pub(super) fn one(point: Vec3) -> Self {
        Self {
            at: [point; POINTS],
            count: 1,
            normal: Vec3::ZERO,
        }
    }

    /// A cell's: Gauss points of a quad, centres of the four equal parts of a triangle; then the centre.
    pub(super) fn of_polygon(corners: &[Vec3], normal: Vec3) -> Self {
        let at = if let &[a, b, c] = corners {
            let centre = (a + b + c) / 3.0;
            let part = |corner: Vec3| centre + (corner - centre) * 0.5;
            [part(a), part(b), part(c), centre, centre]
        } else {
            let [a, b, c, d] = [corners[0], corners[1], corners[2], corners[3]];
            let point = |u: f32, v: f32| a.lerp(b, u).lerp(d.lerp(c, u), v);
            let (low, high) = (0.5 - 0.5 * GAUSS, 0.5 + 0.5 * GAUSS);
            [
                point(low, low),
                point(high, low),
                point(high, high),
                point(low, high),
                point(0.5, 0.5),
            ]
        };
        Self {
            at,
            count: POINTS,
            normal,
        }
    }

    fn averaged(&self) -> usize {
        self.count.min(AVERAGED)
    }
}

/// Kernels between the points of two nodes.
#[derive(Debug)]
pub(super) struct Kernels {
    receiver: Points,
    /// At the receiver's points, averaged over the source, and the other way round.
    rows: [f32; POINTS],
    columns: [f32; POINTS],
    mean: f32,
}

impl Kernels {
    pub(super) fn between(receiver: &Points, source: &Points) -> Self {
        let mut values = [[0.0; POINTS]; POINTS];
        for (row, &x) in values.iter_mut().zip(&receiver.at[..receiver.count]) {
            for (value, &y) in row.iter_mut().zip(&source.at[..source.count]) {
                *value = kernel(y - x, receiver.normal, source.normal);
            }
        }
        let (n, m) = (receiver.averaged(), source.averaged());
        let rows = values.map(|row| row[..m].iter().sum::<f32>() / m as f32);
        let column = |j: usize| values[..n].iter().map(|row| row[j]).sum::<f32>() / n as f32;
        Self {
            receiver: *receiver,
            mean: rows[..n].iter().sum::<f32>() / n as f32,
            columns: core::array::from_fn(column),
            rows,
        }
    }

    pub(super) fn mean(&self) -> f32 {
        self.mean
    }

    /// Change of the kernel along the tangents of a receiving cell, as a share of its mean: the plane through the rows
    /// with the least squared error, not steeper than that it stays positive within the radius.
    pub(super) fn slope(&self, radius: f32) -> [f32; 2] {
        if self.receiver.count == 1 || self.mean <= 0.0 {
            return [0.0; 2];
        }
        let places = self.places();
        let (mut uu, mut uv, mut vv) = (0.0, 0.0, 0.0);
        let (mut ut, mut vt) = (0.0, 0.0);
        for ([u, v], row) in places.iter().zip(&self.rows) {
            let change = row / self.mean - 1.0;
            (uu, uv, vv) = (uu + u * u, uv + u * v, vv + v * v);
            (ut, vt) = (ut + u * change, vt + v * change);
        }
        let determinant = uu * vv - uv * uv;
        if determinant <= 1e-6 * (uu + vv) * (uu + vv) {
            return [0.0; 2];
        }
        let slope = [
            (vv * ut - uv * vt) / determinant,
            (uu * vt - uv * ut) / determinant,
        ];
        let steepness = slope[0].hypot(slope[1]) * radius;
        slope.map(|s| s / steepness.max(1.0))
    }

    /// Where the averaged points of the receiver are beside their mean, along its tangents.
    fn places(&self) -> [[f32; 2]; AVERAGED] {
        let points = &self.receiver.at[..AVERAGED];
        let middle = points.iter().sum::<Vec3>() / AVERAGED as f32;
        let tangents = tangents(self.receiver.normal);
        core::array::from_fn(|i| tangents.map(|t| (points[i] - middle).dot(t)))
    }

    /// Standard deviations over the receiver and over the source as shares of the mean; over the receiver only of what
    /// the slope does not tell, and a share of what it tells.
    pub(super) fn spreads(&self, slope_error: f32) -> [f32; 2] {
        if self.mean <= 0.0 {
            return [2.0; 2];
        }
        let relative = |value: f32| value / self.mean - 1.0;
        let mut over_receiver = 0.0;
        if self.receiver.count > 1 {
            let [u, v] = self.slope(0.0);
            for (place, &row) in self.places().iter().zip(&self.rows) {
                let linear = u * place[0] + v * place[1];
                let rest = relative(row) - linear;
                over_receiver += rest * rest + (slope_error * linear).powi(2);
            }
            over_receiver = over_receiver / AVERAGED as f32 + relative(self.rows[AVERAGED]).powi(2);
        }
        let columns = self.columns[..AVERAGED].iter();
        let over_source = columns.map(|&c| relative(c).powi(2)).sum::<f32>() / AVERAGED as f32;
        [over_receiver.sqrt(), over_source.sqrt()]
    }
}

/// `cos cos / π r²`; the cosine of a node without a normal is 1.
fn kernel(offset: Vec3, receiver: Vec3, source: Vec3) -> f32 {
    let squared = offset.length_squared().max(f32::MIN_POSITIVE);
    let inverse = 1.0 / squared.sqrt();
    let cosine = |normal: Vec3, offset: Vec3| {
        if normal == Vec3::ZERO {
            1.0
        } else {
            (normal.dot(offset) * inverse).max(0.0)
        }
    };
    cosine(receiver, offset) * cosine(source, -offset) / (PI * squared)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(origin: Vec3, u: Vec3, v: Vec3) -> Points {
        let corners = [origin, origin + u, origin + u + v, origin + v];
        Points::of_polygon(&corners, u.cross(v).normalize())
    }

    #[test]
    fn far_squares_have_the_kernel_of_their_centres_and_near_ones_vary() {
        let floor = square(Vec3::ZERO, Vec3::X, Vec3::Y);
        let above = |height: f32| square(Vec3::Z * height, Vec3::Y, Vec3::X);
        let far = Kernels::between(&floor, &above(20.0));
        let exact = 1.0 / (PI * 400.0);
        assert!((far.mean() / exact - 1.0).abs() < 5e-3, "{}", far.mean());
        let [far, near] = [20.0, 1.0].map(|h| Kernels::between(&floor, &above(h)).spreads(0.1)[0]);
        assert!(far < 2e-3 && near > 0.05, "spreads {far} and {near}");
    }

    #[test]
    fn a_slope_points_to_the_source() {
        let floor = square(Vec3::ZERO, Vec3::X, Vec3::Y);
        // A wall far along x that looks back.
        let wall = square(Vec3::new(5.0, 0.0, 0.0), Vec3::Z, Vec3::Y);
        let kernels = Kernels::between(&floor, &wall);
        let [u, v] = kernels.slope(0.7);
        let direction: Vec3 = {
            let [a, b] = tangents(Vec3::Z);
            a * u + b * v
        };
        assert!(direction.x > 0.1, "towards the wall: {direction}");
        assert!(direction.y.abs() < 1e-3, "not beside it: {direction}");
        let [spread, _] = kernels.spreads(0.0);
        let [all, _] = Kernels::between(&floor, &wall).spreads(1.0);
        assert!(spread < 0.3 * all, "{spread} of {all} is left");
    }
}
