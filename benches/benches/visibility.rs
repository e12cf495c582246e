//! Rays a second of one thread, by this project and by what `obvhs` offers, among the same 100 012 triangles.
//!
//! A plain main: criterion takes wall-clock time, which follows the load of a shared machine. Every way is timed once
//! in each of several rounds, in CPU time of the thread, and medians are printed.

use cpu_time::ThreadTime;
use glam::{Vec3, Vec3A};
use hemicube::radiosity::Visibility;
use hemicube_tests::spheres::{SIDE, meet, random_segments, spheres_in_a_box, visibility};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use std::time::{Duration, Instant};

const ROUNDS: usize = 9;

type Segment = (Vec3, Vec3);

/// What one way says of segments: 0 if one is clear and 1 if not, or at which distance it meets something.
type Answers = Vec<f32>;

type Ask<'a> = Box<dyn Fn(&[Segment]) -> Answers + 'a>;

struct Way<'a> {
    name: &'static str,
    ask: Ask<'a>,
    /// Whether the answers are distances.
    measures: bool,
}

fn main() {
    let triangles = spheres_in_a_box(40, 26, 50);
    let start = Instant::now();
    let ours = visibility(&triangles);
    println!(
        "{} triangles, built in {:.0?}",
        triangles.len(),
        start.elapsed()
    );
    let peers = Peers::new(&triangles);
    let ways = ways(&ours, &peers);
    let sets = [
        ("incoherent", random_segments(200_000, 77)),
        ("incoherent, sorted", sorted(random_segments(200_000, 77))),
        ("coherent, from a point to a wall", to_a_wall()),
    ];
    for (name, segments) in &sets {
        check(&triangles, &ways, segments);
        println!("\n{name}: million rays per second");
        measure(&ways, segments);
    }
}

/// The trees of obvhs with its triangles in the order of their leaves.
struct Peers {
    wide: (CwBvh, Vec<RtTriangle>),
    binary: (Bvh2, Vec<RtTriangle>),
}

impl Peers {
    fn new(triangles: &[[Vec3; 3]]) -> Self {
        let triangles: Vec<Triangle> = triangles
            .iter()
            .map(|t| {
                let [v0, v1, v2] = t.map(Vec3A::from);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let ordered = |indices: &[u32]| -> Vec<RtTriangle> {
            let triangle = |&i: &u32| RtTriangle::from(&triangles[i as usize]);
            indices.iter().map(triangle).collect()
        };
        let (parameters, mut time) = (BvhBuildParams::medium_build(), Duration::default());
        let wide = build_cwbvh_from_tris(&triangles, parameters, &mut time);
        let binary = build_bvh2_from_tris(&triangles, parameters, &mut time);
        let (of_wide, of_binary) = (
            ordered(&wide.primitive_indices),
            ordered(&binary.primitive_indices),
        );
        Self {
            wide: (wide, of_wide),
            binary: (binary, of_binary),
        }
    }
}

fn ray((from, to): Segment) -> Ray {
    let length = from.distance(to);
    Ray::new(from.into(), ((to - from) / length).into(), 0.0, length)
}

/// A way that asks for any hit, one segment after the other.
fn any_hit<'a>(name: &'static str, is_clear: impl Fn(Segment) -> bool + 'a) -> Way<'a> {
    let blocked = move |&segment: &Segment| f32::from(u8::from(!is_clear(segment)));
    Way {
        name,
        ask: Box::new(move |segments| segments.iter().map(&blocked).collect()),
        measures: false,
    }
}

/// A way that asks for the closest hit.
fn closest<'a>(name: &'static str, distance: impl Fn(Segment) -> f32 + 'a) -> Way<'a> {
    Way {
        name,
        ask: Box::new(move |segments| segments.iter().map(|&s| distance(s)).collect()),
        measures: true,
    }
}

fn ways<'a>(ours: &'a Visibility, peers: &'a Peers) -> Vec<Way<'a>> {
    let ((wide, wide_triangles), (binary, binary_triangles)) = (&peers.wide, &peers.binary);
    let batch = Way {
        name: "any hit, batch",
        ask: Box::new(move |segments| {
            let mut clear = vec![false; segments.len()];
            ours.clear_segments(segments, &mut clear);
            let blocked = |clear: bool| f32::from(u8::from(!clear));
            clear.into_iter().map(blocked).collect()
        }),
        measures: false,
    };
    vec![
        any_hit("any hit, one by one", move |(from, to)| {
            ours.is_clear(from, to)
        }),
        batch,
        any_hit("any hit, obvhs CwBvh", move |segment| {
            wide.ray_traverse_miss(ray(segment), |ray, i| wide_triangles[i].intersect(ray))
        }),
        any_hit("any hit, obvhs Bvh2", move |segment| {
            binary.ray_traverse_miss(ray(segment), |ray, i| binary_triangles[i].intersect(ray))
        }),
        closest("closest", move |(from, to)| {
            let length = from.distance(to);
            let hit = ours.first_hit(from, (to - from) / length, length);
            hit.map_or(f32::INFINITY, |hit| hit.distance)
        }),
        closest("closest, obvhs CwBvh", move |segment| {
            let mut hit = RayHit::none();
            wide.ray_traverse(ray(segment), &mut hit, |ray, i| {
                wide_triangles[i].intersect(ray)
            });
            hit.t
        }),
    ]
}

/// By octant of the direction, then along a Morton curve of the origin.
fn sorted(mut segments: Vec<Segment>) -> Vec<Segment> {
    segments.sort_by_cached_key(|&(from, to)| {
        let octant = (to - from).is_negative_bitmask();
        let cell = (from / SIDE * 1024.0).as_uvec3();
        let interleaved = (0..10).fold(0_u32, |key, bit| {
            key | (cell.x >> bit & 1) << (3 * bit)
                | (cell.y >> bit & 1) << (3 * bit + 1)
                | (cell.z >> bit & 1) << (3 * bit + 2)
        });
        (octant, interleaved)
    });
    segments
}

/// From a point close to one wall to all over the wall opposite, just short of it.
fn to_a_wall() -> Vec<Segment> {
    let target = |i: usize| (i as f32 + 0.5) / 450.0 * SIDE;
    let from = Vec3::new(0.49 * SIDE, 0.51 * SIDE, 0.05);
    (0..450 * 450)
        .map(|i| {
            (
                from,
                Vec3::new(target(i % 450), target(i / 450), 0.999 * SIDE),
            )
        })
        .collect()
}

/// A fast wrong answer counts for nothing: some segments against all triangles, all of them against each other.
fn check(triangles: &[[Vec3; 3]], ways: &[Way], segments: &[Segment]) {
    let some: Vec<Segment> = segments
        .iter()
        .step_by(segments.len() / 200)
        .copied()
        .collect();
    let answers: Vec<Answers> = ways.iter().map(|way| (way.ask)(&some)).collect();
    for (i, &(from, to)) in some.iter().enumerate() {
        let length = from.distance(to);
        let met = triangles
            .iter()
            .filter_map(|t| meet(from, (to - from) / length, t));
        // Along edges rounding decides.
        let inner: Vec<f64> = met
            .filter(|&(t, inside)| inside > -1e-4 && t > 0.0 && t < f64::from(length))
            .map(|m| m.0)
            .collect();
        let nearest = inner.iter().copied().fold(f64::INFINITY, f64::min);
        for (way, answers) in ways.iter().zip(&answers) {
            let answer = f64::from(answers[i]);
            let right = if way.measures {
                answer == nearest || (answer - nearest).abs() < 1e-3
            } else {
                (answer == 1.0) == nearest.is_finite()
            };
            assert!(
                right,
                "{}: {answer} for {nearest}, {from} to {to}",
                way.name
            );
        }
    }
    let blocked = |way: &Way| -> usize {
        let is_blocked = |&&a: &&f32| {
            if way.measures {
                a.is_finite()
            } else {
                a == 1.0
            }
        };
        (way.ask)(segments).iter().filter(is_blocked).count()
    };
    let first = blocked(&ways[0]);
    for way in ways {
        let found = blocked(way);
        assert!(
            found.abs_diff(first) * 10_000 <= segments.len(),
            "{}: {found} blocked, not {first}",
            way.name
        );
    }
}

fn measure(ways: &[Way], segments: &[Segment]) {
    let mut seconds = vec![Vec::new(); ways.len()];
    for _ in 0..ROUNDS {
        for (way, seconds) in ways.iter().zip(&mut seconds) {
            let start = ThreadTime::now();
            std::hint::black_box((way.ask)(segments));
            seconds.push(start.elapsed().as_secs_f64());
        }
    }
    for (way, seconds) in ways.iter().zip(&mut seconds) {
        seconds.sort_by(f64::total_cmp);
        println!(
            "{:24} {:6.2}",
            way.name,
            segments.len() as f64 / seconds[ROUNDS / 2] * 1e-6
        );
    }
}
