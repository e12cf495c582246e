//! A patch or element as pairs of them need it, in f64.

use crate::form_factor::polygon::FlatPolygon;
use glam::DVec3;

/// Nodes in [0, 1] and weights of Gauss-Legendre quadrature with 2, 3 and 4 points.
const GAUSS: [&[(f64, f64)]; 3] = [
    &[
        (0.211_324_865_405_187_1, 0.5),
        (0.788_675_134_594_812_9, 0.5),
    ],
    &[
        (0.112_701_665_379_258_3, 0.277_777_777_777_777_8),
        (0.5, 0.444_444_444_444_444_4),
        (0.887_298_334_620_741_7, 0.277_777_777_777_777_8),
    ],
    &crate::form_factor::polygon::GAUSS_4,
];

/// Nodes in [0, 1] and weights of Gauss-Jacobi quadrature of `∫ u f(u) du`, in the same order.
const JACOBI: [&[(f64, f64)]; 3] = [
    &[
        (0.355_051_025_721_682_2, 0.181_958_618_256_022_8),
        (0.844_948_974_278_317_8, 0.318_041_381_743_977_3),
    ],
    &[
        (0.212_340_538_239_153, 0.069_826_979_901_454_1),
        (0.590_533_135_559_265, 0.229_241_106_359_586),
        (0.911_412_040_487_296, 0.200_931_913_738_959_8),
    ],
    &[
        (0.139_759_864_343_781, 0.031_180_970_950_008),
        (0.416_409_567_631_083, 0.129_847_547_608_232),
        (0.723_156_986_361_877, 0.203_464_568_010_271),
        (0.942_895_803_885_482, 0.135_506_913_431_489),
    ],
];

/// Points that one SIMD instruction handles.
const LANES: usize = 4;

/// Points on a polygon with weights that sum to its area, in `PACKS` of four with each coordinate on its own, so that
/// loops over them become SIMD instructions. Points beyond those in use have weight 0.
#[derive(Debug, Clone, Copy)]
pub struct Nodes<const PACKS: usize> {
    x: [[f64; LANES]; PACKS],
    y: [[f64; LANES]; PACKS],
    z: [[f64; LANES]; PACKS],
    weight: [[f64; LANES]; PACKS],
    count: usize,
}

impl<const PACKS: usize> Nodes<PACKS> {
    /// A product rule of `side` points, 2 to 4, each way over a convex polygon of three or four corners: Gauss-Legendre
    /// over the bilinear map of a quad, Gauss-Jacobi times Gauss-Legendre over a triangle, drawn from its first corner.
    pub fn new(corners: &[DVec3], side: usize) -> Self {
        let mut nodes = Self {
            x: [[corners[0].x; LANES]; PACKS],
            y: [[corners[0].y; LANES]; PACKS],
            z: [[corners[0].z; LANES]; PACKS],
            weight: [[0.0; LANES]; PACKS],
            count: 0,
        };
        if let &[a, b, c] = corners {
            let doubled = (b - a).cross(c - a).length();
            for &(u, wu) in JACOBI[side - 2] {
                for &(v, wv) in GAUSS[side - 2] {
                    nodes.push(a + (b.lerp(c, v) - a) * u, wu * wv * doubled);
                }
            }
            return nodes;
        }
        let (a, b, c, d) = (corners[0], corners[1], corners[2], corners[3]);
        for &(u, wu) in GAUSS[side - 2] {
            let (low, high) = (a.lerp(b, u), d.lerp(c, u));
            for &(v, wv) in GAUSS[side - 2] {
                let jacobian = (b - a).lerp(c - d, v).cross(high - low).length();
                nodes.push(low.lerp(high, v), wu * wv * jacobian);
            }
        }
        nodes
    }

    fn push(&mut self, point: DVec3, weight: f64) {
        let (pack, lane) = (self.count / LANES, self.count % LANES);
        self.x[pack][lane] = point.x;
        self.y[pack][lane] = point.y;
        self.z[pack][lane] = point.z;
        self.weight[pack][lane] = weight;
        self.count += 1;
    }

    fn point(&self, i: usize) -> DVec3 {
        let (pack, lane) = (i / LANES, i % LANES);
        DVec3::new(self.x[pack][lane], self.y[pack][lane], self.z[pack][lane])
    }

    /// The points in use with their weights.
    pub fn iter(&self) -> impl Iterator<Item = (DVec3, f64)> + '_ {
        (0..self.count).map(|i| (self.point(i), self.weight[i / LANES][i % LANES]))
    }

    /// `weight × height` of the points of a pack over a plane.
    fn weighted_heights(&self, pack: usize, origin: DVec3, normal: DVec3) -> [f64; LANES] {
        let (x, y, z) = (&self.x[pack], &self.y[pack], &self.z[pack]);
        core::array::from_fn(|lane| {
            let height = (x[lane] - origin.x) * normal.x
                + (y[lane] - origin.y) * normal.y
                + (z[lane] - origin.z) * normal.z;
            self.weight[pack][lane] * height
        })
    }

    /// `1/π ∫∫ cos cos / r² dA dA` over two planar polygons wholly in front of each other's plane.
    ///
    /// The distance times the cosine at a point is its height over the other's plane, whatever point of that is
    /// meant: heights are taken once, and two pairs of points share a division.
    pub fn exchange(&self, normal: DVec3, to: &Self, to_normal: DVec3) -> f64 {
        let mut here = [[0.0; LANES]; PACKS];
        for (pack, here) in here.iter_mut().enumerate() {
            *here = self.weighted_heights(pack, to.point(0), to_normal);
        }
        let mut total = [0.0; LANES];
        for pack in 0..PACKS {
            let there = to.weighted_heights(pack, self.point(0), normal);
            let (x, y, z) = (&to.x[pack], &to.y[pack], &to.z[pack]);
            let fourth_power = |from: DVec3| -> [f64; LANES] {
                core::array::from_fn(|lane| {
                    let (dx, dy, dz) = (x[lane] - from.x, y[lane] - from.y, z[lane] - from.z);
                    let squared = dx * dx + dy * dy + dz * dz;
                    squared * squared
                })
            };
            let mut sums = [0.0; LANES];
            for i in (0..self.count).step_by(2) {
                // An odd last point has one of weight 0 beside it.
                let (one, two) = (fourth_power(self.point(i)), fourth_power(self.point(i + 1)));
                let (h, k) = (
                    here[i / LANES][i % LANES],
                    here[(i + 1) / LANES][(i + 1) % LANES],
                );
                for lane in 0..LANES {
                    sums[lane] += (h * two[lane] + k * one[lane]) / (one[lane] * two[lane]);
                }
            }
            for lane in 0..LANES {
                total[lane] += sums[lane] * there[lane];
            }
        }
        total.iter().sum::<f64>() * core::f64::consts::FRAC_1_PI
    }
}

/// A lit polygon: its corners, the circle around it, and the points of the cheapest rules.
#[derive(Debug, Clone, Copy)]
pub struct Site {
    /// Corners and normal.
    pub polygon: FlatPolygon,
    /// Mean of the corners.
    pub centre: DVec3,
    /// Radius around the centre that holds all corners.
    pub radius: f64,
    /// Area.
    pub area: f64,
    /// Two points each way.
    pub nodes2: Nodes<1>,
    /// Three points each way.
    pub nodes3: Nodes<3>,
}

impl Site {
    /// From three or four corners, counter-clockwise around the lit side; the normal is theirs.
    pub fn new(corners: &[DVec3]) -> Self {
        Self::of(FlatPolygon::from_corners(corners), corners)
    }

    /// From three or four corners in a plane whose normal is known better than by them.
    pub fn with_normal(corners: &[DVec3], normal: DVec3) -> Self {
        let mut polygon = FlatPolygon::from_corners(corners);
        polygon.normal = normal;
        Self::of(polygon, corners)
    }

    fn of(polygon: FlatPolygon, corners: &[DVec3]) -> Self {
        let centre = polygon.centre();
        Self {
            centre,
            radius: polygon.radius(centre),
            area: polygon.area(),
            nodes2: Nodes::new(corners, 2),
            nodes3: Nodes::new(corners, 3),
            polygon,
        }
    }
}
