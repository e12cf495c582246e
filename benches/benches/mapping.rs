//! Two-part mapping and bumps: nanoseconds for each point, medians of rounds in CPU time of one thread.
//!
//! There is no other implementation to compare with that has all of a kind; each result is checked before it is timed.

use cpu_time::ThreadTime;
use glam::{Vec2, Vec3};
use hemicube::raster::bump::relief::{Bricks, GolfBall, Noise, OrangePeel, Relief, Ripples};
use hemicube::raster::bump::tangents::{IndexedTriangles, corner_tangents};
use hemicube::raster::bump::{HeightMap, SlopePyramid, SurfaceGradient};
use hemicube::raster::two_part::{OMap, SMap, SphereLayout, SurfacePoint, TwoPart};
use hemicube_tests::spheres::random;
use std::hint::black_box;

const POINTS: u64 = 100_000;
const ROUNDS: usize = 9;

fn main() {
    let points: Vec<SurfacePoint> = (0..POINTS).map(surface_point).collect();
    two_part(&points);
    reliefs(&points);
    height_maps();
    tangents();
}

/// A point of a unit sphere with the derivatives of a pixel.
fn surface_point(i: u64) -> SurfacePoint {
    let number = |k| 2.0 * random(7, 4 * i + k) - 1.0;
    let normal = Vec3::new(number(0), number(1), number(2)).normalize_or(Vec3::Z);
    let (a, b) = normal.any_orthonormal_pair();
    let d_point = [a * 0.003, b * 0.004];
    SurfacePoint {
        d_point,
        d_normal: d_point,
        d_view: d_point.map(|d| -d),
        ..SurfacePoint::new(normal, normal, Vec3::new(0.3, 0.5, 4.0) - normal)
    }
}

fn two_part(points: &[SurfacePoint]) {
    let s_maps = [
        ("plane", SMap::plane(2.0)),
        ("cylinder", SMap::cylinder(1.5, 3.0)),
        ("sphere, lat-long", SMap::sphere(1.5)),
        (
            "sphere, stereographic",
            SMap::Sphere {
                radius: 1.5,
                layout: SphereLayout::HEMISPHERE,
            },
        ),
        ("box", SMap::cube(1.5)),
    ];
    let o_maps = [
        OMap::ReflectedRay,
        OMap::ObjectNormal,
        OMap::Centroid(Vec3::ZERO),
        OMap::IntermediateNormal,
    ];
    println!("ns per point with derivatives: reflected ray, normal, centroid, intermediate normal");
    for (name, s) in s_maps {
        let times = o_maps.map(|o| {
            let mapping = TwoPart::new(s, o);
            for point in &points[..1000] {
                let value = mapping.texcoord(point.point, point.normal, point.view);
                let mapped = mapping.map(point).map(|m| (m.texcoord, m.face));
                assert_eq!(value, mapped, "derivatives change no value");
            }
            nanoseconds(points, |point| black_box(mapping.map(point)).is_some())
        });
        println!(
            "{name:22} {:6.1} {:6.1} {:6.1} {:6.1}",
            times[0], times[1], times[2], times[3]
        );
    }
}

fn reliefs(points: &[SurfacePoint]) {
    let reliefs: [(&str, &dyn Relief); 5] = [
        ("noise, 4 octaves", &Noise::default()),
        ("orange peel", &OrangePeel::default()),
        ("ripples", &Ripples::default()),
        ("bricks", &Bricks::default()),
        ("golf ball", &GolfBall::default()),
    ];
    println!("ns per height with gradient");
    for (name, relief) in reliefs {
        let time = nanoseconds(points, |p| {
            let gradient = relief.sample(p.point).gradient;
            let bumped = SurfaceGradient::from_volume(p.normal, gradient).apply(p.normal);
            assert!((bumped.length() - 1.0).abs() < 1e-3, "{name}: {bumped}");
            true
        });
        println!("{name:22} {time:6.1}");
    }
}

fn height_maps() {
    let height = |uv: Vec2| Noise::default().sample((uv * 8.0).extend(0.5)).height;
    let map = HeightMap::from_fn(512, 512, height).expect("a map");
    let start = ThreadTime::now();
    let pyramid = SlopePyramid::new(map.slope_moments());
    let building = start.elapsed().as_secs_f64();
    let places: Vec<Vec2> = (0..POINTS)
        .map(|i| Vec2::new(random(8, 2 * i), random(8, 2 * i + 1)))
        .collect();
    let inside = |h: f32| h.abs() < 0.2;
    println!(
        "ns per sample of a height map of 512 x 512; its pyramid of moments took {:.0} ms",
        building * 1e3
    );
    let time = nanoseconds(&places, |&uv| inside(map.sample(uv).height));
    println!("{:22} {time:6.1}", "B-spline, with slopes");
    let time = nanoseconds(&places, |&uv| {
        black_box(map.bilinear_slopes(uv)).is_finite()
    });
    println!("{:22} {time:6.1}", "bilinear slopes");
    for (name, dy) in [("moments, round", 0.02), ("moments, 8 times as long", 0.16)] {
        let footprint = [Vec2::new(0.02, 0.0), Vec2::new(0.0, dy)];
        let time = nanoseconds(&places, |&uv| {
            pyramid.sample(uv, footprint).covariance()[0] >= 0.0
        });
        println!("{name:24} {time:6.1}");
    }
}

/// A grid of quads over a bumpy plane.
fn tangents() {
    let side = 300_u16;
    let at = |i: usize| {
        let row = usize::from(side) + 1;
        let uv = Vec2::new((i % row) as f32, (i / row) as f32) / f32::from(side);
        (uv, Vec3::new(uv.x, -uv.y, 0.1 * (9.0 * uv.x).sin()))
    };
    let vertices = (usize::from(side) + 1).pow(2);
    let positions: Vec<Vec3> = (0..vertices).map(|i| at(i).1).collect();
    let texcoords: Vec<Vec2> = (0..vertices).map(|i| at(i).0).collect();
    let n = u32::from(side) + 1;
    let quads = (0..n - 1).flat_map(|y| (0..n - 1).map(move |x| y * n + x));
    let triangles: Vec<[u32; 3]> = quads
        .flat_map(|a| [[a, a + n, a + 1], [a + 1, a + n, a + n + 1]])
        .collect();
    let mesh = IndexedTriangles {
        positions: &positions,
        normals: &vec![Vec3::Z; vertices],
        texcoords: &texcoords,
        triangles: &triangles,
    };
    let start = ThreadTime::now();
    let tangents = corner_tangents(&mesh).expect("a good mesh");
    let time = start.elapsed().as_secs_f64();
    assert!(tangents.iter().flatten().all(|t| t.x > 0.99), "along x");
    println!(
        "tangents: {:.2} million triangles per second",
        triangles.len() as f64 / time * 1e-6
    );
}

/// Median time for each item, for all of which `f` must hold or not as it is.
fn nanoseconds<T>(items: &[T], f: impl Fn(&T) -> bool) -> f64 {
    let mut times: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = ThreadTime::now();
            let count = items.iter().filter(|item| f(item)).count();
            black_box(count);
            start.elapsed().as_secs_f64() * 1e9 / items.len() as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[ROUNDS / 2]
}
