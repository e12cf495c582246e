//! Tangents against the derivatives of the surfaces that they belong to, and of triangles that have none.

use core::f32::consts::TAU;
use glam::{Vec2, Vec3, Vec4};
use hemicube_raster::bump::tangents::{
    IndexedTriangles, TangentError, bitangent, corner_tangents, split_vertices,
};
use proptest::prelude::*;

/// A tube around y, its texture once around it, `mirrored` to the left or not.
fn tube(steps: u16, mirrored: bool) -> (Vec<Vec3>, Vec<Vec3>, Vec<Vec2>, Vec<[u32; 3]>) {
    let (mut positions, mut normals, mut texcoords) = (vec![], vec![], vec![]);
    for row in 0_u8..2 {
        for step in 0..=steps {
            let u = f32::from(step) / f32::from(steps);
            let (sin, cos) = (u * TAU).sin_cos();
            let normal = Vec3::new(sin, 0.0, cos);
            positions.push(normal + Vec3::Y * (1.0 - f32::from(row)));
            normals.push(normal);
            texcoords.push(Vec2::new(
                if mirrored { 1.0 - u } else { u },
                f32::from(row),
            ));
        }
    }
    let n = u32::from(steps) + 1;
    let quads = (0..n - 1).flat_map(|i| [[i, i + n, i + 1], [i + 1, i + n, i + n + 1]]);
    (positions, normals, texcoords, quads.collect())
}

#[test]
fn tube_has_its_tangents() {
    for (mirrored, along) in [(false, 1.0), (true, -1.0)] {
        let (positions, normals, texcoords, triangles) = tube(64, mirrored);
        let mesh = IndexedTriangles {
            positions: &positions,
            normals: &normals,
            texcoords: &texcoords,
            triangles: &triangles,
        };
        let tangents = corner_tangents(&mesh).expect("a good mesh");
        for (triangle, corners) in triangles.iter().zip(&tangents) {
            for (&vertex, tangent) in triangle.iter().zip(corners) {
                let normal = normals[vertex as usize];
                let expected = Vec3::new(normal.z, 0.0, -normal.x) * along;
                // Chords of 64 steps: at the open ends of the tube they are half a step off.
                assert!(
                    tangent.truncate().dot(expected) > 0.998,
                    "{tangent} for {expected}"
                );
                let up = bitangent(normal, *tangent);
                assert!(up.dot(Vec3::Y) > 0.998, "{up} is up, mirrored {mirrored}");
            }
        }
    }
}

#[test]
fn vertices_between_mirrored_halves_are_split() {
    let positions = [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]
        .map(|[x, y]: [u8; 2]| Vec3::new(f32::from(x), f32::from(y), 0.0));
    let texcoords =
        positions.map(|p| Vec2::new(if p.x > 1.0 { 2.0 - p.x } else { p.x }, 1.0 - p.y));
    let triangles = [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]];
    let mesh = IndexedTriangles {
        positions: &positions,
        normals: &[Vec3::Z; 6],
        texcoords: &texcoords,
        triangles: &triangles,
    };
    let tangents = corner_tangents(&mesh).expect("a good mesh");
    assert_eq!(tangents[0], [Vec4::new(1.0, 0.0, 0.0, 1.0); 3]);
    assert_eq!(tangents[3], [Vec4::new(-1.0, 0.0, 0.0, -1.0); 3]);
    let split = split_vertices(6, &triangles, &tangents);
    assert_eq!(split.sources, [0, 1, 2, 3, 4, 5, 1, 4]);
    for ((triangle, corners), before) in split.triangles.iter().zip(&tangents).zip(&triangles) {
        for ((&vertex, tangent), &source) in triangle.iter().zip(corners).zip(before) {
            assert_eq!(split.tangents[vertex as usize], *tangent);
            assert_eq!(split.sources[vertex as usize], source);
        }
    }
}

#[test]
fn wrong_lengths_and_indices_are_named() {
    let mesh = IndexedTriangles {
        positions: &[Vec3::ZERO; 3],
        normals: &[Vec3::Z; 2],
        texcoords: &[Vec2::ZERO; 3],
        triangles: &[],
    };
    let error = corner_tangents(&mesh).expect_err("lengths");
    assert!(
        error.to_string().starts_with("3 positions, 2 normals"),
        "{error}"
    );
    let mesh = IndexedTriangles {
        normals: &[Vec3::Z; 3],
        triangles: &[[0, 1, 2], [0, 1, 3]],
        ..mesh
    };
    let expected = TangentError::Index {
        triangle: 1,
        vertex: 3,
        vertices: 3,
    };
    assert_eq!(corner_tangents(&mesh), Err(expected));
}

/// Many triangles around one vertex neither overflow the stack (MikkTSpace recurses) nor take minutes (it compares pairs).
#[test]
fn huge_fan_is_done() {
    let steps = 50_000_u32;
    let rim = (0..steps).map(|i| {
        let (sin, cos) = (f64::from(i) / f64::from(steps) * core::f64::consts::TAU).sin_cos();
        glam::DVec3::new(cos, sin, 0.0).as_vec3()
    });
    let positions: Vec<Vec3> = std::iter::once(Vec3::ZERO).chain(rim).collect();
    let texcoords: Vec<Vec2> = positions.iter().map(|p| Vec2::new(p.x, -p.y)).collect();
    let triangles: Vec<[u32; 3]> = (0..steps)
        .map(|i| [0, i + 1, (i + 1) % steps + 1])
        .collect();
    let mesh = IndexedTriangles {
        positions: &positions,
        normals: &vec![Vec3::Z; positions.len()],
        texcoords: &texcoords,
        triangles: &triangles,
    };
    let tangents = corner_tangents(&mesh).expect("a good mesh");
    let along_x = |t: &Vec4| (*t - Vec4::new(1.0, 0.0, 0.0, 1.0)).length() < 1e-2;
    let good = tangents.iter().flatten().filter(|t| along_x(t)).count();
    assert_eq!(good, 3 * triangles.len(), "all point along x");
}

fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![8 => -2.0_f32..2.0, 1 => Just(0.0_f32), 1 => any::<f32>()]
}

proptest! {
    #[test]
    fn any_triangles_have_unit_tangents(
        numbers in prop::collection::vec(prop::array::uniform8(any_float()), 1..9),
        corners in prop::collection::vec(prop::array::uniform3(0_u32..8), 0..16),
    ) {
        let n = u32::try_from(numbers.len()).expect("few");
        let triangles: Vec<[u32; 3]> = corners.iter().map(|t| t.map(|i| i % n)).collect();
        let positions: Vec<Vec3> = numbers.iter().map(|v| Vec3::new(v[0], v[1], v[2])).collect();
        let normals: Vec<Vec3> = numbers.iter().map(|v| Vec3::new(v[3], v[4], v[5]).normalize_or_zero()).collect();
        let texcoords: Vec<Vec2> = numbers.iter().map(|v| Vec2::new(v[6], v[7])).collect();
        let mesh = IndexedTriangles {
            positions: &positions,
            normals: &normals,
            texcoords: &texcoords,
            triangles: &triangles,
        };
        let tangents = corner_tangents(&mesh).expect("indices are good");
        prop_assert_eq!(tangents.len(), triangles.len());
        for tangent in tangents.iter().flatten() {
            prop_assert!((tangent.truncate().length() - 1.0).abs() < 1e-4, "{}", tangent);
            prop_assert!(tangent.w.abs() == 1.0, "{}", tangent);
        }
    }
}
