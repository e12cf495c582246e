//! Triangles into an item buffer: a number and a depth for each of 256 x 256 pixels, by this project and by `euc`.
//!
//! 65 536 triangles of random place and shape in four sizes, alone (`draw_ids`) in CPU time of one thread; medians of
//! rounds in which both take turns.

use cpu_time::ThreadTime;
use euc::buffer::Buffer2d;
use euc::rasterizer::{BackfaceCullingDisabled, Triangles};
use euc::{Interpolate, Pipeline, Target};
use glam::Vec4;
use hemicube::raster::triangle::{
    ClipVertex, Cull, DepthBuffer, Viewport, draw_ids, draw_triangle,
};
use hemicube_tests::spheres::random;

const SIDE: usize = 256;
const VIEWPORT: Viewport = Viewport::new(SIDE, SIDE);
const TRIANGLES: u64 = 65_536;
const ROUNDS: usize = 9;
const NOTHING: u32 = u32::MAX;

type Triangle = [Vec4; 3];

fn main() {
    for seed in 0..20 {
        check_exactly(&triangles(5.0 + 20.0 * seed as f32, 300, seed));
    }
    println!("fragments per triangle: ms for 65 536 triangles, euc 0.5.3, ratio");
    for size in [3.0, 8.0, 28.0, 90.0] {
        let triangles = triangles(size, TRIANGLES, 1);
        check_depths(&triangles);
        let fragments = fragments(&triangles);
        let (ours, theirs) = measure(&triangles);
        println!(
            "{:6.2}: {:7.2} {:7.2} {:5.2}",
            fragments as f64 / TRIANGLES as f64,
            ours * 1e3,
            theirs * 1e3,
            theirs / ours
        );
    }
}

/// Triangles whose corners lie in boxes of `size` pixels around points of the picture, at random depths.
fn triangles(size: f32, count: u64, seed: u64) -> Vec<Triangle> {
    let number = |index| random(seed, index);
    (0..count)
        .map(|i| {
            let [x, y] = [0, 1].map(|k| 2.0 * number(11 * i + k) - 1.0);
            [0, 1, 2].map(|corner| {
                let at = |k| number(11 * i + 2 + 3 * corner + k);
                let place = |centre: f32, k| centre + (at(k) - 0.5) * 2.0 * size / SIDE as f32;
                Vec4::new(place(x, 0), place(y, 1), at(2), 1.0)
            })
        })
        .collect()
}

fn draw(triangles: &[Triangle], depth: &mut [f32], ids: &mut [u32]) {
    for (id, triangle) in (0..).zip(triangles) {
        draw_ids(0..SIDE, VIEWPORT, Cull::None, triangle, id, depth, ids);
    }
}

fn empty() -> (Vec<f32>, Vec<u32>) {
    let pixels = SIDE * SIDE;
    (vec![DepthBuffer::EMPTY; pixels], vec![NOTHING; pixels])
}

/// Ids against integers: corners rounded to 1/256 pixel, a pixel is covered if its centre moved by a hair to the right
/// and by a hair of a hair down lies inside, and each triangle has one depth.
fn check_exactly(triangles: &[Triangle]) {
    let flat = |i: u64, triangle: &Triangle| {
        let z = random(99, i);
        triangle.map(|p| Vec4::new(p.x, p.y, z, p.w))
    };
    let triangles: Vec<Triangle> = (0..).zip(triangles).map(|(i, t)| flat(i, t)).collect();
    let (mut depth, mut ids) = empty();
    draw(&triangles, &mut depth, &mut ids);
    for (pixel, &id) in ids.iter().enumerate() {
        let covering = (0..)
            .zip(&triangles)
            .filter(|(_, t)| covers(t, pixel % SIDE, pixel / SIDE));
        let nearest = covering.min_by(|a, b| a.1[0].z.total_cmp(&b.1[0].z));
        assert_eq!(id, nearest.map_or(NOTHING, |(id, _)| id), "pixel {pixel}");
    }
}

fn covers(triangle: &Triangle, x: usize, y: usize) -> bool {
    const HAIR: i128 = 1 << 30;
    #[expect(clippy::cast_possible_truncation, reason = "a few hundred pixels")]
    let snap = |pixels: f64| (pixels * 256.0 + 0.5).floor() as i128 * HAIR * HAIR;
    let half = SIDE as f64 / 2.0;
    let corners = triangle.map(|p| {
        let [x, y, w] = [p.x, p.y, p.w].map(f64::from);
        (snap((x / w + 1.0) * half), snap((1.0 - y / w) * half))
    });
    let centre = |pixel: usize| (256 * pixel as i128 + 128) * HAIR * HAIR;
    let (px, py) = (centre(x) + HAIR, centre(y) + 1);
    let side = |i: usize, j: usize| {
        let ((ax, ay), (bx, by)) = (corners[i], corners[j]);
        // Within i128: differences stay below 2^80, so one factor is scaled back first where nothing is lost.
        (((bx - ax) / (HAIR * HAIR)) * (py - ay) - ((by - ay) / (HAIR * HAIR)) * (px - ax)).signum()
    };
    let sides = [side(0, 1), side(1, 2), side(2, 0)];
    sides == [1; 3] || sides == [-1; 3]
}

/// Ids and depths against the readable `draw_triangle`, bit for bit.
fn check_depths(triangles: &[Triangle]) {
    let (mut depth, mut ids) = empty();
    draw(triangles, &mut depth, &mut ids);
    let (mut expected, mut expected_ids) = empty();
    for (id, triangle) in (0..).zip(triangles) {
        let vertices = triangle.map(|p| ClipVertex::new(p, []));
        draw_triangle(
            0..SIDE,
            VIEWPORT,
            Cull::None,
            &vertices,
            &mut expected,
            |x, y, _, _| {
                expected_ids[y * SIDE + x] = id;
                true
            },
        );
    }
    assert!(
        ids == expected_ids && depth == expected,
        "not what draw_triangle draws"
    );
}

fn fragments(triangles: &[Triangle]) -> usize {
    let mut count = 0;
    let (mut depth, _) = empty();
    for triangle in triangles {
        let vertices = triangle.map(|p| ClipVertex::new(p, []));
        draw_triangle(
            0..SIDE,
            VIEWPORT,
            Cull::None,
            &vertices,
            &mut depth,
            |_, _, _, _| {
                count += 1;
                false
            },
        );
    }
    count
}

/// The number of a triangle on its way through `euc`.
#[derive(Clone, Copy)]
struct Id(u32);

impl Interpolate for Id {
    fn lerp2(a: Self, _: Self, _: f32, _: f32) -> Self {
        a
    }

    fn lerp3(a: Self, _: Self, _: Self, _: f32, _: f32, _: f32) -> Self {
        a
    }
}

struct Items;

impl Pipeline for Items {
    type Vertex = (Vec4, u32);
    type VsOut = Id;
    type Pixel = u32;

    #[inline(always)]
    fn vert(&self, &(position, id): &(Vec4, u32)) -> ([f32; 4], Id) {
        (position.to_array(), Id(id))
    }

    #[inline(always)]
    fn frag(&self, id: &Id) -> u32 {
        id.0
    }
}

/// Medians of the seconds, ours and theirs.
fn measure(triangles: &[Triangle]) -> (f64, f64) {
    let vertices: Vec<(Vec4, u32)> = (0..)
        .zip(triangles)
        .flat_map(|(id, t)| t.map(|p| (p, id)))
        .collect();
    let (mut depth, mut ids) = empty();
    let mut their_ids = Buffer2d::new([SIDE; 2], NOTHING);
    let mut their_depth = Buffer2d::new([SIDE; 2], f32::INFINITY);
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        let start = ThreadTime::now();
        depth.fill(DepthBuffer::EMPTY);
        ids.fill(NOTHING);
        draw(triangles, &mut depth, &mut ids);
        ours.push(start.elapsed().as_secs_f64());
        let start = ThreadTime::now();
        their_depth.clear(f32::INFINITY);
        their_ids.clear(NOTHING);
        Items.draw::<Triangles<_, BackfaceCullingDisabled>, _>(
            &vertices,
            &mut their_ids,
            Some(&mut their_depth),
        );
        theirs.push(start.elapsed().as_secs_f64());
    }
    (median(&mut ours), median(&mut theirs))
}

fn median(seconds: &mut [f64]) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}
