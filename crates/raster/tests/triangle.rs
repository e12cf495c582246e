//! The rasteriser against exact arithmetic, against rays, and against itself.

use glam::camera::rh::proj::directx::perspective;
use glam::camera::rh::view::look_to_mat4;
use glam::{DVec3, Vec3, Vec4};
use hemicube_raster::triangle::{
    ClipVertex, Cull, DepthBuffer, Viewport, draw_ids, draw_quad_ids, draw_triangle,
};
use proptest::prelude::*;

const VIEWPORT: Viewport = Viewport::new(64, 48);

/// One call of the fragment closure, with bits instead of floats so that equal means equal.
#[derive(Debug, Clone, PartialEq)]
struct Fragment<const N: usize> {
    x: usize,
    y: usize,
    depth: u32,
    attributes: [u32; N],
}

/// The fragments of triangles drawn one after the other in bands of `band` rows, sorted by pixel, and the depths.
fn draw<const N: usize>(
    viewport: Viewport,
    cull: Cull,
    triangles: &[[ClipVertex<N>; 3]],
    band: usize,
) -> (Vec<Fragment<N>>, Vec<f32>) {
    let mut depth = DepthBuffer::new(viewport);
    let mut fragments = Vec::new();
    for (rows, depth) in depth.bands_mut(band) {
        for triangle in triangles {
            draw_triangle(
                rows.clone(),
                viewport,
                cull,
                triangle,
                depth,
                |x, y, z, attributes| {
                    fragments.push(Fragment {
                        x,
                        y,
                        depth: z.to_bits(),
                        attributes: attributes.map(f32::to_bits),
                    });
                    true
                },
            );
        }
    }
    fragments.sort_by_key(|f| (f.y, f.x));
    (fragments, depth.values().to_vec())
}

/// How often each pixel is covered by triangles drawn without hiding each other.
fn coverage(viewport: Viewport, triangles: &[[Vec4; 3]]) -> Vec<u32> {
    let mut counts = vec![0; viewport.width * viewport.height];
    for triangle in triangles {
        let triangle = triangle.map(|position| ClipVertex::new(position, []));
        for fragment in draw(viewport, Cull::None, &[triangle], viewport.height).0 {
            counts[fragment.y * viewport.width + fragment.x] += 1;
        }
    }
    counts
}

/// The clip-space position of a point on the screen given in 1/256 of a pixel, at `w`. Exact for w = 1 in a picture
/// with sides that are powers of two.
fn from_subpixels(viewport: Viewport, [x, y]: [i64; 2], z: f32, w: f32) -> Vec4 {
    let ndc = |k: i64, side: usize| k as f32 / (128.0 * side as f32) - 1.0;
    let (x, y) = (ndc(x, viewport.width), -ndc(y, viewport.height));
    Vec4::new(x * w, y * w, z * w, w)
}

/// Whether the pixel centre, moved by a hair to the right and by a hair of a hair down, is strictly inside of the
/// triangle: what the top-left rule amounts to.
fn covers_exactly(corners: [[i64; 2]; 3], x: usize, y: usize) -> bool {
    const SCALE: i128 = 1 << 60;
    let scaled = |c: i64| i128::from(c) * SCALE;
    let px = scaled(x as i64 * 256 + 128) + (1 << 30);
    let py = scaled(y as i64 * 256 + 128) + 1;
    let side = |[ax, ay]: [i64; 2], [bx, by]: [i64; 2]| {
        (i128::from(bx - ax) * (py - scaled(ay)) - i128::from(by - ay) * (px - scaled(ax))).signum()
    };
    let [a, b, c] = corners;
    let sides = [side(a, b), side(b, c), side(c, a)];
    sides == [1; 3] || sides == [-1; 3]
}

fn subpixel_corners(range: core::ops::Range<i64>) -> impl Strategy<Value = [[i64; 2]; 3]> {
    // Some corners on pixel centres and borders, where the fill rule decides.
    let coordinate = prop_oneof![
        range.clone(),
        range.clone().prop_map(|c| c.div_euclid(128) * 128)
    ];
    prop::array::uniform3(prop::array::uniform2(coordinate))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn coverage_is_that_of_exact_arithmetic(corners in subpixel_corners(-20_000..30_000)) {
        let viewport = Viewport::new(64, 32);
        let counts = coverage(viewport, &[corners.map(|c| from_subpixels(viewport, c, 0.5, 1.0))]);
        for (pixel, &count) in counts.iter().enumerate() {
            let (x, y) = (pixel % 64, pixel / 64);
            prop_assert_eq!(count == 1, covers_exactly(corners, x, y), "pixel ({}, {})", x, y);
        }
    }

    #[test]
    fn coverage_of_small_triangles_is_that_of_exact_arithmetic(corners in subpixel_corners(1000..2000)) {
        let viewport = Viewport::new(16, 16);
        let counts = coverage(viewport, &[corners.map(|c| from_subpixels(viewport, c, 0.5, 1.0))]);
        for (pixel, &count) in counts.iter().enumerate() {
            let (x, y) = (pixel % 16, pixel / 16);
            prop_assert_eq!(count == 1, covers_exactly(corners, x, y), "pixel ({}, {})", x, y);
        }
    }

    #[test]
    fn coverage_within_the_guard_band_is_that_of_exact_arithmetic(corners in subpixel_corners(-50_000_000..50_000_000)) {
        let viewport = Viewport::new(32, 32);
        // f32 holds such positions to 4 sub-pixels: take corners that it holds exactly.
        let corners = corners.map(|corner| corner.map(|c| c.div_euclid(8) * 8));
        let counts = coverage(viewport, &[corners.map(|c| from_subpixels(viewport, c, 0.5, 1.0))]);
        for (pixel, &count) in counts.iter().enumerate() {
            let (x, y) = (pixel % 32, pixel / 32);
            prop_assert_eq!(count == 1, covers_exactly(corners, x, y), "pixel ({}, {})", x, y);
        }
    }

    #[test]
    fn a_jittered_grid_covers_every_pixel_once(
        jitter in prop::collection::vec((-0.2_f32..0.2, -0.2_f32..0.2, any::<bool>(), 0.1_f32..10.0), 9 * 9),
        snapped in any::<bool>(),
    ) {
        // 8 x 8 cells over a bit more than the picture, each cut along one of its diagonals.
        let point = |i: usize, j: usize| {
            let (dx, dy, _, w) = jitter[j * 9 + i];
            let place = |k: usize, d: f32| (k as f32 + if snapped { 0.0 } else { d }) / 3.0 - 4.0 / 3.0;
            Vec4::new(place(i, dx), place(j, dy), 0.5, 1.0) * w
        };
        let mut triangles = Vec::new();
        for j in 0..8 {
            for i in 0..8 {
                let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
                triangles.extend(if jitter[j * 9 + i].2 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
            }
        }
        prop_assert!(coverage(VIEWPORT, &triangles).iter().all(|&count| count == 1), "counts differ from 1");
    }

    #[test]
    fn a_fan_to_anywhere_covers_every_pixel_once(
        centre in (-0.9_f32..0.9, -0.9_f32..0.9),
        spokes in prop::collection::vec((0.0_f32..1.0, 1.0_f32..9.0), 5..40),
    ) {
        // Outer corners up to 10^9 half pictures away: beyond the guard band.
        let centre = Vec4::new(centre.0, centre.1, 0.5, 1.0);
        let count = spokes.len();
        let rim: Vec<Vec4> = spokes.iter().enumerate().map(|(k, &(turn, magnitude))| {
            let angle = (k as f32 + 0.9 * turn) / count as f32 * core::f32::consts::TAU;
            let radius = 10_f32.powf(magnitude);
            centre + Vec4::new(radius * angle.cos(), radius * angle.sin(), 0.0, 0.0)
        }).collect();
        let triangles: Vec<_> = (0..count).map(|k| [centre, rim[k], rim[(k + 1) % count]]).collect();
        // The rim is far outside where neighbours stand close enough; the picture may stick out between two spokes.
        let counts = coverage(VIEWPORT, &triangles);
        prop_assert!(counts.iter().all(|&count| count <= 1), "a pixel is drawn twice");
        let enclosed = rim.iter().zip(rim.iter().cycle().skip(1)).all(|(a, b)| {
            let (a, b) = (a.truncate().truncate(), b.truncate().truncate());
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            corners.into_iter().all(|(x, y)| (b - a).as_dvec2().perp_dot(glam::DVec2::new(x, y) - a.as_dvec2()) > 0.0)
        });
        if enclosed {
            prop_assert!(counts.iter().all(|&count| count == 1), "a pixel is not drawn");
        }
    }

    #[test]
    fn a_floor_under_the_eye_covers_every_pixel_once(
        jitter in prop::collection::vec((-0.2_f32..0.2, -0.2_f32..0.2, any::<bool>()), 11 * 11),
        pitch in 0.5_f32..1.5, yaw in 0.0_f32..6.0,
    ) {
        // The eye is in the middle of the floor's extent, so half of the triangles are behind it and some cross its plane.
        let eye = Vec3::new(0.1, 1.0, -0.2);
        let forward = Vec3::new(yaw.cos() * pitch.cos(), -pitch.sin(), yaw.sin() * pitch.cos());
        let clip_from_world = perspective(0.8, 4.0 / 3.0, 0.05, 1e4)
            * look_to_mat4(eye, forward, Vec3::Y);
        let point = |i: usize, j: usize| {
            let (dx, dz, _) = jitter[j * 11 + i];
            // Finer towards the eye, and no cell folds over.
            let line = |k: f32| (k - 5.0).powi(3) * 8.0;
            let place = |k: usize, d: f32| {
                let k = k as f32;
                line(k) + d * (line(k) - line(k - 1.0)).min(line(k + 1.0) - line(k))
            };
            clip_from_world * Vec4::new(place(i, dx), 0.0, place(j, dz), 1.0)
        };
        let mut triangles = Vec::new();
        for j in 0..10 {
            for i in 0..10 {
                let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
                triangles.extend(if jitter[j * 11 + i].2 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
            }
        }
        prop_assert!(coverage(VIEWPORT, &triangles).iter().all(|&count| count == 1), "counts differ from 1");
    }

    #[test]
    fn attributes_and_depth_are_those_of_the_ray(
        corners in subpixel_corners(-3000..9000),
        w in prop::array::uniform3(0.1_f32..100.0),
        z in prop::array::uniform3(0.0_f32..1.0),
        attributes in prop::array::uniform3(-1.0_f32..1.0),
    ) {
        let viewport = Viewport::new(32, 32);
        let vertices: [_; 3] = std::array::from_fn(|k| {
            ClipVertex::new(from_subpixels(viewport, corners[k], z[k], w[k]), [attributes[k]])
        });
        // A camera of 90 degrees that looks along +w, in f64.
        let ndc = |k: i64| k as f64 / (128.0 * 32.0) - 1.0;
        let p: [DVec3; 3] = std::array::from_fn(|k| {
            DVec3::new(ndc(corners[k][0]), ndc(corners[k][1]), 1.0) * f64::from(w[k])
        });
        for fragment in draw(viewport, Cull::None, &[vertices], 32).0 {
            let centre = |pixel: usize| ndc(pixel as i64 * 256 + 128);
            let ray = DVec3::new(centre(fragment.x), centre(fragment.y), 1.0);
            let normal = (p[1] - p[0]).cross(p[2] - p[0]);
            let hit = ray * (normal.dot(p[0]) / normal.dot(ray));
            let weight = |k: usize| {
                let (a, b) = (p[(k + 1) % 3] - hit, p[(k + 2) % 3] - hit);
                a.cross(b).dot(normal) / normal.length_squared()
            };
            let mix = |v: [f64; 3]| v[0] * weight(0) + v[1] * weight(1) + v[2] * weight(2);
            let expected = mix(attributes.map(f64::from));
            let actual = f64::from(f32::from_bits(fragment.attributes[0]));
            // Rounding of f32 in w and in the result; the corners lie on the sub-pixel grid.
            prop_assert!((actual - expected).abs() < 1e-4, "attribute {} instead of {}", actual, expected);
            let expected = mix(std::array::from_fn(|k| f64::from(z[k]) * f64::from(w[k]))) / hit.z;
            let actual = f64::from(f32::from_bits(fragment.depth));
            prop_assert!((actual - expected).abs() < 1e-5, "depth {} instead of {}", actual, expected);
        }
    }

    #[test]
    fn a_triangle_through_the_eye_plane_covers_what_rays_hit(
        points in prop::array::uniform3(prop::array::uniform3(-5.0_f32..5.0)),
    ) {
        let viewport = Viewport::new(64, 64);
        let near = 0.1_f32;
        // x and y right and down, z ahead; 90 degrees; far at infinity.
        let vertices = points.map(|[x, y, z]| ClipVertex::new(Vec4::new(x, -y, z - near, z), [x, y, z]));
        let p = points.map(|[x, y, z]| DVec3::new(x.into(), y.into(), z.into()));
        let det = p[0].dot(p[1].cross(p[2]));
        // A ray r meets the triangle where r = sum m_k p_k with all m_k >= 0, at distance 1 / sum m_k.
        let lines = [p[1].cross(p[2]) / det, p[2].cross(p[0]) / det, p[0].cross(p[1]) / det];
        let sum = lines[0] + lines[1] + lines[2];
        let conditions = [lines[0], lines[1], lines[2], DVec3::Z / f64::from(near) - sum];
        let mut covered = vec![None; 64 * 64];
        for fragment in draw(viewport, Cull::None, &[vertices], 64).0 {
            let pixel = fragment.y * 64 + fragment.x;
            covered[pixel] = Some(fragment);
        }
        for (pixel, fragment) in covered.iter().enumerate() {
            let ndc = |k: usize| (k as f64 + 0.5) / 32.0 - 1.0;
            let ray = DVec3::new(ndc(pixel % 64), ndc(pixel / 64), 1.0);
            // Signed distances from the sides in pixels; snapping moves a side by less than 1/256 per corner.
            let inside = conditions.map(|c| c.dot(ray) / c.truncate().length() * 32.0);
            let least = inside.into_iter().fold(f64::INFINITY, f64::min);
            prop_assert!(least < 0.01 || fragment.is_some(), "pixel {} is missing, {} inside", pixel, least);
            prop_assert!(least > -0.01 || fragment.is_none(), "pixel {} is drawn, {} outside", pixel, -least);
            if let (Some(fragment), true) = (fragment, least > 0.01) {
                let hit = ray / sum.dot(ray);
                // What moving the ray by the error of snapping changes.
                let moved = |x: f64, y: f64| {
                    let ray = ray + DVec3::new(x, y, 0.0) / (32.0 * 128.0);
                    (ray / sum.dot(ray)).distance(hit)
                };
                let tolerance = 1e-4 + 2.0 * [moved(1.0, 0.0), moved(-1.0, 0.0), moved(0.0, 1.0), moved(0.0, -1.0)]
                    .into_iter().fold(0.0, f64::max);
                let actual = Vec3::from_array(fragment.attributes.map(f32::from_bits)).as_dvec3();
                prop_assert!(actual.distance(hit) < tolerance, "{} instead of {}, tolerance {}", actual, hit, tolerance);
            }
        }
    }

    #[test]
    fn bands_give_the_bits_of_the_whole(triangles in prop::collection::vec(wild_triangle(2.0), 1..8)) {
        let (whole, depths) = draw(VIEWPORT, Cull::None, &triangles, VIEWPORT.height);
        for band in [1, 7, 24] {
            let (fragments, band_depths) = draw(VIEWPORT, Cull::None, &triangles, band);
            prop_assert!(fragments == whole, "fragments in bands of {} rows", band);
            prop_assert_eq!(&band_depths, &depths, "depths in bands of {} rows", band);
        }
    }

    #[test]
    fn the_nearest_wins_in_any_order(mut triangles in prop::collection::vec(wild_triangle(2.0), 2..8)) {
        let mut nearest = vec![DepthBuffer::EMPTY; VIEWPORT.width * VIEWPORT.height];
        for triangle in &triangles {
            let (_, depths) = draw(VIEWPORT, Cull::None, &[*triangle], VIEWPORT.height);
            nearest.iter_mut().zip(depths).for_each(|(near, depth)| *near = near.min(depth));
        }
        prop_assert_eq!(&draw(VIEWPORT, Cull::None, &triangles, 48).1, &nearest, "in order");
        triangles.reverse();
        prop_assert_eq!(&draw(VIEWPORT, Cull::None, &triangles, 48).1, &nearest, "in reverse");
    }

    #[test]
    fn an_item_buffer_agrees_with_the_fragments(triangles in prop::collection::vec(wild_triangle(2.0), 1..8), back in any::<bool>()) {
        let cull = if back { Cull::Back } else { Cull::None };
        let mut expected = DepthBuffer::new(VIEWPORT);
        let mut depth = expected.clone();
        let mut expected_ids = vec![u32::MAX; VIEWPORT.width * VIEWPORT.height];
        let mut ids = expected_ids.clone();
        for (id, triangle) in (0..).zip(&triangles) {
            draw_triangle(0..48, VIEWPORT, cull, triangle, expected.values_mut(), |x, y, _, _| {
                expected_ids[y * VIEWPORT.width + x] = id;
                true
            });
            draw_ids(0..48, VIEWPORT, cull, &triangle.map(|v| v.position), id, depth.values_mut(), &mut ids);
        }
        prop_assert_eq!(ids, expected_ids, "ids");
        prop_assert_eq!(depth, expected, "depths");
    }

    #[test]
    fn small_quads_and_triangles_agree_with_the_fragments(
        quads in prop::collection::vec(small_quad(), 1..12),
        width in 17_usize..70,
        back in any::<bool>(),
        band in 1_usize..48,
    ) {
        let viewport = Viewport::new(width, 48);
        let cull = if back { Cull::Back } else { Cull::None };
        let mut expected = DepthBuffer::new(viewport);
        let mut depth = expected.clone();
        let mut expected_ids = vec![u32::MAX; width * 48];
        let mut ids = expected_ids.clone();
        for (id, &[a, b, c, d]) in (0..).zip(&quads) {
            let is_quad = id % 2 == 0;
            for triangle in if is_quad { vec![[a, b, c], [a, c, d]] } else { vec![[a, b, c]] } {
                let vertices = triangle.map(|p| ClipVertex::new(p, []));
                draw_triangle(0..48, viewport, cull, &vertices, expected.values_mut(), |x, y, _, _| {
                    expected_ids[y * width + x] = id;
                    true
                });
            }
            for (rows, depth) in depth.bands_mut(band) {
                let ids = &mut ids[rows.start * width..rows.end * width];
                if is_quad {
                    draw_quad_ids(rows, viewport, cull, &[a, b, c, d], id, depth, ids);
                } else {
                    draw_ids(rows, viewport, cull, &[a, b, c], id, depth, ids);
                }
            }
        }
        prop_assert_eq!(ids, expected_ids, "ids");
        prop_assert_eq!(depth, expected, "depths");
    }

    #[test]
    fn no_input_panics_or_leaves_the_range_of_the_corners(triangle in any_triangle(), width in 0_usize..70, height in 0_usize..40) {
        let viewport = Viewport::new(width, height);
        let finite = triangle.iter().all(|v| v.position.is_finite() && v.attributes[0].is_finite());
        let low = triangle.iter().fold(f32::INFINITY, |low, v| low.min(v.attributes[0]));
        let high = triangle.iter().fold(f32::NEG_INFINITY, |high, v| high.max(v.attributes[0]));
        for fragment in draw(viewport, Cull::None, &[triangle], 16).0 {
            prop_assert!(finite, "drawn with a number that is not finite: {:?}", triangle);
            let depth = f32::from_bits(fragment.depth);
            prop_assert!((0.0..=1.0).contains(&depth), "depth {}", depth);
            let attribute = f32::from_bits(fragment.attributes[0]);
            // A clipped corner is a mean of corners, rounded.
            let slack = 1e-6 * low.abs().max(high.abs());
            prop_assert!((low - slack..=high + slack).contains(&attribute), "attribute {}", attribute);
        }
    }
}

/// Four corners not far from each other, in any order, so that some quads are dents and bows; some at the border, and
/// now and then one far away or behind the eye.
fn small_quad() -> impl Strategy<Value = [Vec4; 4]> {
    let corner = (-0.5_f32..0.5, -0.5_f32..0.5, 0.0_f32..1.0);
    let away = prop_oneof![9 => Just(1.0_f32), 1 => prop::sample::select(vec![-1.0, 0.01, 30.0])];
    (
        -1.1_f32..1.1,
        -1.1_f32..1.1,
        0.01_f32..1.0,
        0.1_f32..9.0,
        away,
        prop::array::uniform4(corner),
    )
        .prop_map(|(x, y, size, w, away, corners)| {
            let mut quad =
                corners.map(|(dx, dy, z)| Vec4::new(x + dx * size, y + dy * size, z, 1.0) * w);
            quad[2].w *= away;
            quad
        })
}

/// Corners in and around the picture, behind the eye as well.
fn wild_triangle(extent: f32) -> impl Strategy<Value = [ClipVertex<2>; 3]> {
    let coordinate = -extent..extent;
    let position = (
        coordinate.clone(),
        coordinate.clone(),
        -0.2_f32..1.2,
        -0.3_f32..1.5,
    );
    let vertex = (position, prop::array::uniform2(-1.0_f32..1.0))
        .prop_map(|((x, y, z, w), a)| ClipVertex::new(Vec4::new(x, y, z, w), a));
    prop::array::uniform3(vertex)
}

/// Anything an f32 can be.
fn any_triangle() -> impl Strategy<Value = [ClipVertex<1>; 3]> {
    let number = prop_oneof![
        4 => -2.0_f32..2.0,
        2 => prop::num::f32::NORMAL | prop::num::f32::SUBNORMAL | prop::num::f32::ZERO,
        1 => prop::sample::select(vec![f32::MAX, f32::MIN, f32::MIN_POSITIVE, -f32::MIN_POSITIVE, 1e-45, 1.0, -1.0, 0.0]),
    ];
    let finite_vertex = prop::array::uniform5(number)
        .prop_map(|[x, y, z, w, a]| ClipVertex::new(Vec4::new(x, y, z, w), [a]));
    let vertex = prop_oneof![
        20 => finite_vertex,
        1 => prop::array::uniform5(prop::num::f32::ANY)
            .prop_map(|[x, y, z, w, a]| ClipVertex::new(Vec4::new(x, y, z, w), [a])),
    ];
    prop::array::uniform3(vertex)
}

fn flat(x: f32, y: f32) -> Vec4 {
    Vec4::new(x, y, 0.5, 1.0)
}

#[test]
fn only_clockwise_triangles_are_culled() {
    let front = [flat(-1.0, -1.0), flat(1.0, -1.0), flat(0.0, 1.0)].map(|p| ClipVertex::new(p, []));
    let back = [front[0], front[2], front[1]];
    let count = |cull, triangle| draw(VIEWPORT, cull, &[triangle], 48).0.len();
    assert_eq!(count(Cull::Back, back), 0, "back side");
    assert!(count(Cull::Back, front) > 1000, "front side");
    assert_eq!(
        count(Cull::None, back),
        count(Cull::Back, front),
        "both sides cover the same pixels"
    );
}

#[test]
fn a_clipped_triangle_keeps_its_facing() {
    // A floor that reaches behind the eye, seen from above.
    let clip_from_world = perspective(1.0, 4.0 / 3.0, 0.1, 100.0)
        * look_to_mat4(Vec3::Y, Vec3::new(0.0, -0.3, -1.0), Vec3::Y);
    let front = [(-50.0, 50.0), (50.0, 50.0), (0.0, -50.0)]
        .map(|(x, z)| ClipVertex::new(clip_from_world * Vec4::new(x, 0.0, z, 1.0), []));
    let back = [front[0], front[2], front[1]];
    let count = |cull, triangle| draw(VIEWPORT, cull, &[triangle], 48).0.len();
    assert!(count(Cull::Back, front) > 500, "seen from above");
    assert_eq!(count(Cull::Back, back), 0, "seen from below");
}

#[test]
fn a_discarded_fragment_leaves_the_depth() {
    let triangle =
        [flat(-9.0, -9.0), flat(9.0, -9.0), flat(0.0, 9.0)].map(|p| ClipVertex::new(p, []));
    let mut depth = DepthBuffer::new(VIEWPORT);
    draw_triangle(
        0..48,
        VIEWPORT,
        Cull::None,
        &triangle,
        depth.values_mut(),
        |x, _, _, _| x % 2 == 0,
    );
    for (pixel, &z) in depth.values().iter().enumerate() {
        let expected = if pixel % 2 == 0 {
            0.5
        } else {
            DepthBuffer::EMPTY
        };
        assert_eq!(z, expected, "pixel {pixel}");
    }
}

#[test]
fn of_equal_depths_the_first_stays() {
    let triangle = [flat(-9.0, -9.0), flat(9.0, -9.0), flat(0.0, 9.0)];
    let mut depth = DepthBuffer::new(VIEWPORT);
    let mut ids = vec![0; VIEWPORT.width * VIEWPORT.height];
    for id in [7, 8] {
        draw_ids(
            0..48,
            VIEWPORT,
            Cull::None,
            &triangle,
            id,
            depth.values_mut(),
            &mut ids,
        );
    }
    assert!(ids.iter().all(|&id| id == 7), "the second has drawn over");
    depth.clear();
    assert_eq!(depth, DepthBuffer::new(VIEWPORT), "a cleared buffer");
}

#[test]
fn the_far_plane_is_seen_and_beyond_it_nothing() {
    let at = |z| [(-9.0, -9.0), (9.0, -9.0), (0.0, 9.0)].map(|(x, y)| Vec4::new(x, y, z, 1.0));
    let count = |z| coverage(VIEWPORT, &[at(z)]).iter().sum::<u32>();
    assert_eq!(count(1.0), 64 * 48, "on the far plane");
    assert_eq!(count(0.0), 64 * 48, "on the near plane");
    assert_eq!(count(1.0 + f32::EPSILON), 0, "beyond the far plane");
    assert_eq!(count(-f32::MIN_POSITIVE), 0, "before the near plane");
}

#[test]
fn the_largest_picture_can_be_drawn_to() {
    let viewport = Viewport::new(Viewport::MAX_SIDE, Viewport::MAX_SIDE);
    let triangle = [flat(-1e9, -1e9), flat(1e9, -1e9), flat(0.0, 1e9)];
    for row in [0, Viewport::MAX_SIDE - 1] {
        let mut depth = vec![DepthBuffer::EMPTY; viewport.width];
        let mut ids = vec![0; viewport.width];
        draw_ids(
            row..row + 1,
            viewport,
            Cull::Back,
            &triangle,
            1,
            &mut depth,
            &mut ids,
        );
        assert!(ids.iter().all(|&id| id == 1), "row {row} has gaps");
    }
}
