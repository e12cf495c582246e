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

/// Points on a polygon with weights that sum to its area, each coordinate an array of its own so that loops over them
/// become SIMD instructions. Points beyond those in use have weight 0.
#[derive(Debug, Clone, Copy)]
pub struct Nodes<const N: usize> {
    x: [f64; N],
    y: [f64; N],
    z: [f64; N],
    weight: [f64; N],
}

impl<const N: usize> Nodes<N> {
    /// A product rule of `side` points, 2 to 4, each way over a convex polygon of three or four corners: Gauss-Legendre
    /// over the bilinear map of a quad, Gauss-Jacobi times Gauss-Legendre over a triangle, drawn from its first corner.
    pub fn new(corners: &[DVec3], side: usize) -> Self {
        let mut nodes = Self {
            x: [corners[0].x; N],
            y: [corners[0].y; N],
            z: [corners[0].z; N],
            weight: [0.0; N],
        };
        let mut next = 0;
        let mut push = |point: DVec3, weight: f64| {
            [nodes.x[next], nodes.y[next], nodes.z[next]] = point.to_array();
            nodes.weight[next] = weight;
            next += 1;
        };
        if let &[a, b, c] = corners {
            let doubled = (b - a).cross(c - a).length();
            for &(u, wu) in JACOBI[side - 2] {
                for &(v, wv) in GAUSS[side - 2] {
                    push(a + (b.lerp(c, v) - a) * u, wu * wv * doubled);
                }
            }
            return nodes;
        }
        let (a, b, c, d) = (corners[0], corners[1], corners[2], corners[3]);
        for &(u, wu) in GAUSS[side - 2] {
            let (low, high) = (a.lerp(b, u), d.lerp(c, u));
            for &(v, wv) in GAUSS[side - 2] {
                let jacobian = (b - a).lerp(c - d, v).cross(high - low).length();
                push(low.lerp(high, v), wu * wv * jacobian);
            }
        }
        nodes
    }

    /// The points with their weights.
    pub fn iter(&self) -> impl Iterator<Item = (DVec3, f64)> + '_ {
        (0..N).map(|i| (DVec3::new(self.x[i], self.y[i], self.z[i]), self.weight[i]))
    }

    /// `weight × height` of each point over a plane.
    fn weighted_heights(&self, origin: DVec3, normal: DVec3) -> [f64; N] {
        core::array::from_fn(|i| {
            let height = (self.x[i] - origin.x) * normal.x
                + (self.y[i] - origin.y) * normal.y
                + (self.z[i] - origin.z) * normal.z;
            self.weight[i] * height
        })
    }

    /// `π ∫∫ cos cos / r⁴ dA dA` over two planar polygons wholly in front of each other's plane.
    ///
    /// The distance times the cosine at a point is its height over the other's plane, whatever point of that is
    /// meant: heights are taken once, and a pair of points costs one division.
    pub fn exchange<const M: usize>(&self, normal: DVec3, to: &Nodes<M>, to_normal: DVec3) -> f64 {
        let here = self.weighted_heights(DVec3::new(to.x[0], to.y[0], to.z[0]), to_normal);
        let there = to.weighted_heights(DVec3::new(self.x[0], self.y[0], self.z[0]), normal);
        let mut sums = [0.0; M];
        for i in 0..N {
            let (x, y, z, height) = (self.x[i], self.y[i], self.z[i], here[i]);
            for j in 0..M {
                let (dx, dy, dz) = (to.x[j] - x, to.y[j] - y, to.z[j] - z);
                let squared = dx * dx + dy * dy + dz * dz;
                sums[j] += height / (squared * squared);
            }
        }
        sums.iter().zip(&there).map(|(s, t)| s * t).sum::<f64>() * core::f64::consts::FRAC_1_PI
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
    pub nodes2: Nodes<4>,
    /// Three points each way.
    pub nodes3: Nodes<12>,
}

impl Site {
    /// From three or four corners, counter-clockwise around the lit side; the normal is theirs, in f64.
    pub fn new(corners: &[DVec3]) -> Self {
        let polygon = FlatPolygon::from_corners(corners);
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
