//! Matrices between faces and objects, and the files that they are written to: what is read back is what was written.

use glam::Vec3;
use hemicube::radiosity::export::view_factors::{View3dFacts, csv, matrix_market, npy, view3d};
use hemicube::radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube::radiosity::form_factor::{
    Analytic, AnalyticOptions, MatrixOptions, Storage, Surfaces, SurfacesBy, ViewFactorMatrix,
};
use hemicube::radiosity::stop::NEVER;
use hemicube::radiosity::{FormFactors, PatchMesh, PatchOptions, RayCast, RayCastOptions};
use hemicube::scene::{Scene, builtin, open_bytes};
use std::sync::Arc;

fn mesh_of(scene: Scene, options: PatchOptions) -> Arc<PatchMesh> {
    Arc::new(PatchMesh::build(Arc::new(scene), options).expect("it can be cut"))
}

fn fine(elements: usize) -> PatchOptions {
    PatchOptions::default()
        .with_elements(elements)
        .with_patches(elements)
}

fn rays(mesh: &Arc<PatchMesh>) -> RayCast {
    RayCast::new(mesh.clone(), RayCastOptions::default())
}

fn stored(storage: Storage) -> MatrixOptions {
    MatrixOptions {
        storage,
        ..MatrixOptions::default()
    }
}

fn between(factors: &dyn FormFactors, by: SurfacesBy, storage: Storage) -> ViewFactorMatrix {
    let surfaces = Surfaces::new(factors.mesh(), by);
    ViewFactorMatrix::build_by(factors, &surfaces, stored(storage), NEVER).expect("it fits")
}

fn obj(text: &str) -> Scene {
    open_bytes(text.as_bytes(), "test.obj", None).expect("the file is good")
}

/// An open box of three named objects; the names are what tables stumble over.
const OPEN_BOX: &str = "\
o wall, \"north\"
v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 4 3 2
o plain
v 0 1 0\nv 1 1 0\nv 1 1 1\nv 0 1 1\nf 5 6 7\nf 5 7 8
o größe
f 5 1 2 6\nf 6 2 3 7\nf 7 3 4\nf 7 4 8
";

fn open_box(storage: Storage) -> ViewFactorMatrix {
    between(
        &rays(&mesh_of(obj(OPEN_BOX), fine(100))),
        SurfacesBy::Face,
        storage,
    )
}

fn written(write: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()>) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&mut bytes).expect("memory takes everything");
    bytes
}

fn text(write: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()>) -> String {
    String::from_utf8(written(write)).expect("the file is UTF-8")
}

#[test]
fn faces_and_objects_have_the_names_of_their_nodes() {
    let mesh = mesh_of(obj(OPEN_BOX), PatchOptions::whole_faces());
    let faces = Surfaces::new(&mesh, SurfacesBy::Face);
    let expected = ["wall, \"north\"", "plain", "größe 1", "größe 2", "größe 3"];
    assert_eq!(faces.names(), expected, "a number where there are several");
    let objects = Surfaces::new(&mesh, SurfacesBy::Object);
    assert_eq!(
        objects.names(),
        ["wall, \"north\"", "plain", "größe"],
        "nodes"
    );
    assert_eq!(
        mesh.elements().len(),
        5,
        "faces stay whole, pairs of triangles are quads"
    );
}

#[test]
fn the_second_side_of_a_face_and_a_name_that_is_taken() {
    let mut scene = obj(
        "o leaf\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\no box\nf 1 3 2\nv 5 5 5\nf 1 2 4\no box 1\nf 2 3 4\n",
    );
    scene.materials[0].double_sided = true;
    let mesh = mesh_of(scene, PatchOptions::whole_faces());
    let names = Surfaces::new(&mesh, SurfacesBy::Face).names().to_vec();
    let mut once = names.clone();
    once.sort();
    once.dedup();
    assert_eq!(once.len(), names.len(), "each name once: {names:?}");
    assert!(
        names.contains(&String::from("leaf back")),
        "both sides: {names:?}"
    );
    assert!(
        names.contains(&String::from("box 1 (2)")),
        "a node is called so: {names:?}"
    );
}

/// `F_IJ = Σ_i A_i Σ_j F_ij / A_I`, by the formula itself.
#[test]
fn sums_are_those_of_the_formula_and_keep_closure_and_reciprocity() {
    let mesh = mesh_of(
        builtin::scene("cornell").expect("it is built in"),
        fine(150),
    );
    let factors = rays(&mesh);
    let mut patches = ViewFactorMatrix::build(&factors, MatrixOptions::default()).expect("it fits");
    let patches = patches.remove(0);
    for by in SurfacesBy::ALL {
        let surfaces = Surfaces::new(&mesh, by);
        assert!(surfaces.buried().is_empty(), "nothing is buried");
        let group: Vec<usize> = (0..patches.size())
            .map(|p| surfaces.of_patch(p).expect("it is out"))
            .collect();
        let n = surfaces.len();
        let (mut exchange, mut area) = (vec![0.0; n * n], vec![0.0; n]);
        for i in 0..patches.size() {
            area[group[i]] += patches.areas()[i];
            for j in 0..patches.size() {
                exchange[group[i] * n + group[j]] +=
                    patches.areas()[i] * f64::from(patches.get(i, j));
            }
        }
        let summed = patches
            .summed(&group, surfaces.names().to_vec())
            .expect("each row has a group");
        for storage in [Storage::Dense, Storage::Sparse, Storage::Auto] {
            let built = between(&factors, by, storage);
            assert_eq!(built.names(), surfaces.names(), "rows have names");
            for (k, exchange) in exchange.iter().enumerate() {
                let (i, j) = (k / n, k % n);
                let expected = exchange / area[i];
                for matrix in [&built, &summed] {
                    let error = (f64::from(matrix.get(i, j)) - expected).abs();
                    assert!(error < 1e-7, "{} ({i}, {j}): {error:.1e} off", by.name());
                }
            }
            assert!(built.closure_error() < 1e-6, "rows still sum to 1");
            assert!(summed.closure_error() < 1e-6, "rows still sum to 1");
        }
    }
    let corrected = patches.enclosure_corrected();
    let objects = Surfaces::new(&mesh, SurfacesBy::Object);
    let group: Vec<usize> = (0..patches.size())
        .map(|p| objects.of_patch(p).expect("it is out"))
        .collect();
    let summed = corrected
        .summed(&group, objects.names().to_vec())
        .expect("each row has a group");
    let error = summed.reciprocity_error().error;
    assert!(error < 1e-6, "reciprocal rows stay so: {error:.1e}");
}

#[test]
fn groups_that_do_not_fit_are_refused_by_name() {
    let matrix = open_box(Storage::Dense);
    let message = |groups: &[usize], names: &[&str]| {
        let names = names.iter().map(|&name| name.into()).collect();
        matrix
            .summed(groups, names)
            .expect_err("it is refused")
            .to_string()
    };
    assert!(
        message(&[0, 0], &["a"]).contains("5 rows need 5 groups, not 2"),
        "their number"
    );
    assert!(
        message(&[0, 0, 0, 0, 1], &["a"]).contains("row 4: group 1 of 1"),
        "the group"
    );
    assert!(
        message(&[0; 5], &["a", "b"]).contains("group 'b' has no row"),
        "empty groups"
    );
}

#[test]
fn too_large_a_matrix_is_refused_before_the_work() {
    let mesh = mesh_of(obj(OPEN_BOX), fine(100));
    let surfaces = Surfaces::new(&mesh, SurfacesBy::Face);
    for storage in [Storage::Auto, Storage::Dense, Storage::Sparse] {
        let factors = rays(&mesh);
        let options = MatrixOptions {
            memory_limit: 50,
            storage,
        };
        let refused = ViewFactorMatrix::build_by(&factors, &surfaces, options, NEVER)
            .expect_err("25 numbers need more");
        let message = refused.to_string();
        assert!(
            message.contains("5 x 5") && message.contains("MiB"),
            "{message}"
        );
        assert!(factors.rays() < 1_000_000, "not before all rows are done");
    }
}

/// A cube inside another one's wall of solid: its faces see nothing.
#[test]
fn what_is_buried_has_no_row() {
    let cube = |low: f32, high: f32, first: usize| {
        let corner = |i: usize| {
            Vec3::select(
                glam::BVec3::new(i & 1 == 1, i & 2 == 2, i & 4 == 4),
                Vec3::splat(high),
                Vec3::splat(low),
            )
        };
        let vertices: String = (0..8)
            .map(corner)
            .map(|c| format!("v {} {} {}\n", c.x, c.y, c.z))
            .collect();
        let faces = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let faces: String = faces
            .iter()
            .map(|f| {
                format!(
                    "f {} {} {} {}\n",
                    f[0] + first,
                    f[1] + first,
                    f[2] + first,
                    f[3] + first
                )
            })
            .collect();
        vertices + &faces
    };
    let scene = obj(&format!(
        "o outer\n{}o inner\n{}",
        cube(0.0, 4.0, 1),
        cube(1.0, 3.0, 9)
    ));
    let mesh = mesh_of(scene, PatchOptions::whole_faces());
    let surfaces = Surfaces::new(&mesh, SurfacesBy::Object);
    assert_eq!(surfaces.names(), ["outer"], "what is out in the open");
    assert_eq!(surfaces.buried(), ["inner"], "what is not");
    let matrix = between(&rays(&mesh), SurfacesBy::Object, Storage::Auto);
    assert!(
        (matrix.sky()[0] - 1.0).abs() < 1e-6,
        "the outside of a cube sees the sky"
    );
}

/// Two unit squares at a distance of 1 that face each other; half of the lower one is covered by a mask.
const MASKED: &str = "\
F 3
V 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0
V 5 0 0 1\nV 6 1 0 1\nV 7 1 1 1\nV 8 0 1 1
V 9 .5 0 0\nV 10 .5 1 0
S 1  1 2 3 4   0 0 0.9 lower
M 2  4 10 9 1  1 0 0.3 mask
S 3  8 7 6 5   0 0 0.5 upper
E
";

fn vs3(text: &str) -> Arc<PatchMesh> {
    let scene = open_bytes(text.as_bytes(), "test.vs3", None).expect("the file is good");
    assert!(scene.report.warnings.is_empty(), "all of it is read");
    mesh_of(scene, PatchOptions::whole_faces())
}

/// What View3D prints: the area of the base with the covered half, the mask as a row that sees its base alone.
/// By symmetry each half of the lower square gets half of the factor between unit squares at a distance of 1.
/// Two one-sided squares back to back, and one opposite.
const BACK_TO_BACK: &str = "T back to back\nF 3\n\
V 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\n\
V 5 0 0 1\nV 6 1 0 1\nV 7 1 1 1\nV 8 0 1 1\n\
S 1 1 2 3 4 0 0 0.9 up\nS 2 4 3 2 1 0 0 0.9 down\nS 3 8 7 6 5 0 0 0.9 top\nEnd Of Data\n";

#[test]
fn what_exact_factors_leave_goes_to_the_sky_to_the_last_digit() {
    const PARALLEL: f64 = 0.199_824_895_7;
    let mesh = vs3(BACK_TO_BACK);
    let surfaces = Surfaces::new(&mesh, SurfacesBy::Object);
    for seed in 0..4 {
        let options = AnalyticOptions {
            seed,
            ..AnalyticOptions::default()
        };
        let way = Analytic::new(mesh.clone(), options).expect("good");
        let matrix = ViewFactorMatrix::build_by(&way, &surfaces, stored(Storage::Dense), NEVER);
        let matrix = matrix.expect("it fits");
        for (row, expected) in [1.0 - PARALLEL, 1.0, 1.0 - PARALLEL]
            .into_iter()
            .enumerate()
        {
            let sky = matrix.sky()[row];
            assert!(
                (sky - expected).abs() < 1e-6,
                "row {row}, seed {seed}: {sky}"
            );
        }
    }
}

#[test]
fn masks_and_their_bases_are_as_view3d_has_them() {
    const PARALLEL: f64 = 0.199_824_895_7;
    let mesh = vs3(MASKED);
    let surfaces = Surfaces::new(&mesh, SurfacesBy::Object);
    assert_eq!(
        surfaces.names(),
        ["lower", "mask", "upper"],
        "the order of the file"
    );
    assert!(surfaces.buried().is_empty(), "each has a row");
    let half = PARALLEL / 2.0;
    let expected = [[0.0, 0.5, half], [1.0, 0.0, 0.0], [half, 0.0, 0.0]];
    let ways: [(&dyn FormFactors, f64); 3] = [
        (
            &Analytic::new(mesh.clone(), AnalyticOptions::default()).expect("good"),
            1e-6,
        ),
        // Cells of 1/256, and the mean over a face of which the centre alone is looked from, are percents off.
        (
            &Hemicube::new(mesh.clone(), HemicubeOptions::default()).expect("good"),
            0.1,
        ),
        // 5 standard deviations of some 256 rays.
        (&rays(&mesh), 0.1),
    ];
    for ((way, error), storage) in ways
        .into_iter()
        .flat_map(|way| [Storage::Dense, Storage::Sparse].map(|storage| (way, storage)))
    {
        let matrix = ViewFactorMatrix::build_by(way, &surfaces, stored(storage), NEVER);
        let matrix = matrix.expect("it fits");
        assert_eq!(matrix.names(), surfaces.names(), "rows have names");
        for (area, expected) in matrix.areas().iter().zip([1.0, 0.5, 1.0]) {
            assert!(
                (area - expected).abs() < 1e-6,
                "areas with what is covered: {area}"
            );
        }
        for (i, row) in expected.iter().enumerate() {
            for (j, expected) in row.iter().enumerate() {
                let got = f64::from(matrix.get(i, j));
                assert!(
                    (got - expected).abs() < error,
                    "({i}, {j}) is {got}, not {expected}"
                );
            }
        }
        assert_eq!(
            matrix.get(1, 0),
            1.0,
            "the mask sees its base, whatever the way"
        );
        assert!(
            (matrix.get(0, 1) - 0.5).abs() < 1e-6,
            "and the base the mask"
        );
        assert!(matrix.closure_error() < 1e-5, "rows sum to 1");
    }
    for (got, expected) in surfaces.emissivities(&mesh).iter().zip([0.9, 0.3, 0.5]) {
        assert!(
            (got - expected).abs() < 1e-6,
            "emissivity {got}, not {expected}"
        );
    }
}

#[test]
fn between_faces_the_covered_part_is_one_of_its_own() {
    let mesh = vs3(MASKED);
    let matrix = between(&rays(&mesh), SurfacesBy::Face, Storage::Auto);
    let names = ["lower", "upper", "mask", "lower under mask"];
    assert_eq!(matrix.names(), names, "masks come last");
    assert_eq!(
        [matrix.get(2, 3), matrix.get(3, 2)],
        [1.0; 2],
        "they see each other alone"
    );
    assert_eq!(matrix.areas()[3], 0.5, "the covered part");
    assert!((matrix.areas()[0] - 0.5).abs() < 1e-6, "what is left");
}

/// All of the wall is covered, by a mask and, in part, by a null surface that is no row.
#[test]
fn a_surface_that_is_masked_all_over_sees_its_masks_alone() {
    let null = MASKED.replace("S 3 ", "N 3  10 3 2 9  1 0 0.5 null\nS 4 ");
    let mesh = vs3(&null);
    let matrix = between(&rays(&mesh), SurfacesBy::Object, Storage::Auto);
    assert_eq!(
        matrix.names(),
        ["lower", "mask", "upper"],
        "null surfaces are no rows"
    );
    assert_eq!(
        matrix.areas()[0],
        0.5,
        "the null surface takes its area away"
    );
    assert_eq!(
        [matrix.get(0, 1), matrix.get(1, 0)],
        [1.0; 2],
        "they see each other alone"
    );
    assert_eq!(matrix.sky()[0], 0.0, "and nothing else");
}

fn overlaps_of(text: &str, by: SurfacesBy) -> Vec<(String, String, f64)> {
    let mesh = mesh_of(obj(text), PatchOptions::whole_faces());
    let surfaces = Surfaces::new(&mesh, by);
    let name = |i: usize| surfaces.names()[i].clone();
    let overlaps = surfaces.overlaps(&mesh).into_iter();
    overlaps
        .map(|o| (name(o.surfaces[0]), name(o.surfaces[1]), o.area))
        .collect()
}

/// A wall with a picture in its plane, a plate back to back with the wall, a tile beside it and a shelf far above.
#[test]
fn surfaces_in_one_place_are_found_with_their_area() {
    let scene = "\
o wall\nv 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nf 1 2 3 4
o picture\nv 3 1 0\nv 5 1 0\nv 5 2 0\nv 3 2 0\nf 5 6 7 8
o plate\nf 1 4 3 2
o tile\nv 0 -1 0\nv 4 -1 0\nf 9 10 2 1
o near\nv 0 0 .01\nv 4 0 .01\nv 4 3 .01\nv 0 3 .01\nf 11 12 13 14
";
    for by in SurfacesBy::ALL {
        let overlaps = overlaps_of(scene, by);
        let [(first, second, area)] = &*overlaps else {
            panic!("one pair overlaps: {overlaps:?}");
        };
        assert_eq!([first, second], ["wall", "picture"], "their names");
        assert!((area - 1.0).abs() < 1e-6, "its area: {area}");
    }
}

/// Turned and moved, so that neither plane nor edges are round numbers; two triangles overlap two others.
#[test]
fn overlaps_of_slanted_surfaces_are_summed() {
    let at = |x: f32, y: f32| {
        let turn = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.7, 0.3, 1.1);
        let p = turn * Vec3::new(x, y, 0.0) + Vec3::new(3.3, -1.7, 2.9);
        format!("v {} {} {}\n", p.x, p.y, p.z)
    };
    let square = |low: f32, size: f32| {
        [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)]
            .map(|(x, y)| at(low + x, low + y))
            .concat()
    };
    let text = format!(
        "o a\n{}f 1 2 3\nf 1 3 4\no b\n{}f 5 6 7\nf 5 7 8\n",
        square(0.0, 2.0),
        square(1.5, 2.0)
    );
    let overlaps = overlaps_of(&text, SurfacesBy::Object);
    assert_eq!(overlaps.len(), 1, "{overlaps:?}");
    assert!((overlaps[0].2 - 0.25).abs() < 1e-5, "{overlaps:?}");
}

#[test]
fn tiles_of_a_floor_do_not_overlap() {
    let mut text = String::new();
    let (n, step) = (100, 0.137);
    for k in 0..=n {
        for i in 0..=n {
            text.push_str(&format!(
                "v {} 0.3 {}\n",
                f64::from(i) * step,
                f64::from(k) * -step
            ));
        }
    }
    for k in 0..n {
        for i in 0..n {
            let a = k * (n + 1) + i + 1;
            text.push_str(&format!("f {a} {} {} {}\n", a + 1, a + n + 2, a + n + 1));
        }
    }
    assert!(
        overlaps_of(&text, SurfacesBy::Face).is_empty(),
        "edges only touch"
    );
    for scene in ["cornell", "two-rooms"] {
        let scene = builtin::scene(scene).expect("it is built in");
        let mesh = mesh_of(scene, PatchOptions::whole_faces());
        let found = Surfaces::new(&mesh, SurfacesBy::Object).overlaps(&mesh);
        assert!(found.is_empty(), "built-in scenes are clean: {found:?}");
    }
}

/// A table as RFC 4180 has it.
fn table(text: &str) -> Vec<Vec<String>> {
    let (mut rows, mut row, mut field, mut in_quotes) =
        (Vec::new(), Vec::new(), String::new(), false);
    let mut letters = text.chars().peekable();
    while let Some(c) = letters.next() {
        match c {
            '"' if in_quotes && letters.peek() == Some(&'"') => {
                field.push(letters.next().expect("it is there"));
            }
            '"' => in_quotes = !in_quotes,
            ',' if !in_quotes => row.push(core::mem::take(&mut field)),
            '\n' if !in_quotes => {
                row.push(core::mem::take(&mut field));
                rows.push(core::mem::take(&mut row));
            }
            c => field.push(c),
        }
    }
    assert!(row.is_empty() && field.is_empty(), "the last line ends");
    rows
}

#[test]
fn csv_reads_back() {
    for storage in [Storage::Dense, Storage::Sparse] {
        let matrix = open_box(storage);
        let n = matrix.size();
        let rows = table(&text(|out| csv(&matrix, out)));
        assert_eq!(rows.len(), n + 1, "a header and the surfaces");
        assert_eq!(rows[0][..2], ["name", "area"], "the first columns");
        assert_eq!(
            rows[0][2..n + 2],
            *matrix.names(),
            "columns have the names of rows"
        );
        assert_eq!(
            rows[0][n + 2..],
            ["sky", "absorbed", "transmitted"],
            "the last columns"
        );
        for (i, row) in rows[1..].iter().enumerate() {
            assert_eq!(row[0], matrix.names()[i], "the row's name");
            let number = |k: usize| {
                row[k]
                    .parse::<f64>()
                    .unwrap_or_else(|e| panic!("'{}': {e}", row[k]))
            };
            assert_eq!(number(1), matrix.areas()[i], "its area, exactly");
            for j in 0..n {
                let read: f32 = row[j + 2].parse().expect("a factor");
                assert_eq!(read, matrix.get(i, j), "({i}, {j}), exactly");
            }
            let sum: f64 = (2..n + 4).map(number).sum();
            assert!(
                (sum - number(n + 4) - 1.0).abs() < 1e-6,
                "everything is in the row: {sum}"
            );
        }
    }
}

#[test]
fn small_and_strange_numbers_survive_csv() {
    let names = vec!["=1+1".into(), " edge ".into(), "two\nlines".into()];
    let factors = [
        0.0,
        1.5e-7,
        1e-38,
        0.999_999_9,
        0.0,
        1.0 / 3.0,
        0.1,
        1e-4,
        0.0,
    ];
    let matrix = ViewFactorMatrix::from_rows(vec![1e-9, 12345.678, 1e12], names, &factors)
        .expect("a matrix");
    let rows = table(&text(|out| csv(&matrix, out)));
    for i in 0..3 {
        assert_eq!(
            rows[i + 1][0],
            matrix.names()[i],
            "the name, with its blanks and line ends"
        );
        assert_eq!(
            rows[i + 1][1].parse::<f64>().expect("an area"),
            matrix.areas()[i],
            "the area"
        );
        for j in 0..3 {
            assert_eq!(
                rows[i + 1][j + 2].parse::<f32>().expect("a factor"),
                matrix.get(i, j),
                "({i}, {j})"
            );
            assert!(
                rows[i + 1][j + 2].len() < 16,
                "no row of zeros: {}",
                rows[i + 1][j + 2]
            );
        }
    }
}

#[test]
fn npy_reads_back() {
    for storage in [Storage::Dense, Storage::Sparse] {
        let matrix = open_box(storage);
        let n = matrix.size();
        let bytes = written(|out| npy(&matrix, out));
        assert_eq!(bytes[..8], *b"\x93NUMPY\x01\x00", "magic and version");
        let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert!(
            (10 + length).is_multiple_of(64),
            "data start at a multiple of 64"
        );
        let header = str::from_utf8(&bytes[10..10 + length]).expect("ASCII");
        let expected = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({n}, {n}), }}");
        assert_eq!(header.trim_end(), expected, "what NumPy writes");
        assert!(header.ends_with('\n'), "the header's end");
        let data = &bytes[10 + length..];
        assert_eq!(data.len(), 4 * n * n, "one f32 a factor");
        for (k, number) in data.as_chunks::<4>().0.iter().enumerate() {
            assert_eq!(
                f32::from_le_bytes(*number),
                matrix.get(k / n, k % n),
                "entry {k}"
            );
        }
    }
}

#[test]
fn matrix_market_reads_back() {
    for storage in [Storage::Dense, Storage::Sparse] {
        let matrix = open_box(storage);
        let n = matrix.size();
        let text = text(|out| matrix_market(&matrix, out));
        let mut lines = text.lines();
        let banner = "%%MatrixMarket matrix coordinate real general";
        assert_eq!(lines.next(), Some(banner), "the banner");
        let comments: Vec<&str> = text
            .lines()
            .skip(1)
            .filter(|line| line.starts_with('%'))
            .collect();
        for (comment, name) in comments[1..].iter().zip(matrix.names()) {
            assert!(comment.ends_with(name.as_str()), "'{name}' in '{comment}'");
        }
        let mut numbers = text.lines().filter(|line| !line.starts_with('%'));
        let size: Vec<usize> = numbers
            .next()
            .expect("a size")
            .split(' ')
            .map(|word| word.parse().expect("a number"))
            .collect();
        let entries: Vec<(usize, usize, f32)> = numbers
            .map(|line| {
                let words: Vec<&str> = line.split(' ').collect();
                let index = |k: usize| words[k].parse::<usize>().expect("an index") - 1;
                (index(0), index(1), words[2].parse().expect("a factor"))
            })
            .collect();
        assert_eq!(size, [n, n, entries.len()], "rows, columns, entries");
        let mut left: f32 = (0..n * n)
            .map(|k| matrix.get(k / n, k % n))
            .filter(|f| *f != 0.0)
            .count() as f32;
        for (i, j, f) in entries {
            assert_eq!(f, matrix.get(i, j), "({i}, {j}), exactly");
            assert_ne!(f, 0.0, "zeros are left out");
            left -= 1.0;
        }
        assert_eq!(left, 0.0, "all others are there");
    }
}

#[test]
fn long_names_do_not_break_the_lines_of_matrix_market() {
    let names = vec!["ä".repeat(3000), String::from("two\nlines")];
    let matrix =
        ViewFactorMatrix::from_rows(vec![1.0; 2], names, &[0.0, 0.5, 0.5, 0.0]).expect("a matrix");
    let text = text(|out| matrix_market(&matrix, out));
    assert!(
        text.lines().all(|line| line.len() <= 1024),
        "1024 characters at most"
    );
    assert_eq!(text.lines().count(), 4 + 1 + 2, "a name stays on its line");
}

/// The cube of View3D's manual, with exact factors: the file is the one that View3D 4.0.0 writes.
#[test]
fn view3d_gets_its_own_file() {
    let exact = |i: usize, j: usize| match (i, j) {
        _ if i == j => 0.0,
        _ if i % 3 == j % 3 => 0.199_824_895_7,
        _ => 0.200_043_776_1,
    };
    let factors: Vec<f64> = (0..36).map(|k| exact(k / 6, k % 6)).collect();
    let names = (0..6).map(|i| format!("face {i}")).collect();
    let cube = ViewFactorMatrix::from_rows(vec![1.0; 6], names, &factors).expect("a matrix");
    let facts = View3dFacts {
        emissivities: &[0.5; 6],
        enclosure: true,
    };
    let expected = "\
View3D 4.0.0 0 1 0 6          
1 1 1 1 1 1
0.000000 0.200044 0.200044 0.199825 0.200044 0.200044
0.200044 0.000000 0.200044 0.200044 0.199825 0.200044
0.200044 0.200044 0.000000 0.200044 0.200044 0.199825
0.199825 0.200044 0.200044 0.000000 0.200044 0.200044
0.200044 0.199825 0.200044 0.200044 0.000000 0.200044
0.200044 0.200044 0.199825 0.200044 0.200044 0.000000
0.500 0.500 0.500 0.500 0.500 0.500
";
    assert_eq!(
        text(|out| view3d(&cube, facts, out)),
        expected,
        "byte for byte"
    );
    let black = text(|out| view3d(&cube, View3dFacts::default(), out));
    assert!(
        black.ends_with("1.000 1.000 1.000 1.000 1.000 1.000\n"),
        "black without emissivities"
    );
    assert!(black.starts_with("View3D 4.0.0 0 0 0 6  "), "no enclosure");
}

#[test]
fn emissivities_are_what_is_not_reflected() {
    let mesh = mesh_of(builtin::furnace_with(0.3, 1.0), fine(50));
    let surfaces = Surfaces::new(&mesh, SurfacesBy::Object);
    for emissivity in surfaces.emissivities(&mesh) {
        assert!((emissivity - 0.7).abs() < 1e-6, "1 - 0.3, not {emissivity}");
    }
}

/// Two unit squares face each other at distance 1, and a square of a quarter of their area stands between them.
fn with_obstruction(flipped: bool) -> Scene {
    let mut scene = obj("o low\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n\
         o high\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 5 8 7 6\n\
         o plate\nusemtl plate\nv 0 0 0.5\nv 0.5 0 0.5\nv 0.5 0.5 0.5\nv 0 0.5 0.5\nf 9 10 11 12\n");
    let plate = scene
        .materials
        .iter_mut()
        .find(|m| m.name == "plate")
        .expect("it is there");
    plate.obstruction = true;
    plate.double_sided = true;
    scene.instances[2].flipped = flipped;
    scene
}

/// A method of form factors by its name.
type Method = (&'static str, fn(Arc<PatchMesh>) -> Box<dyn FormFactors>);

const METHODS: [Method; 2] = [
    ("raycast", |mesh| {
        let options = RayCastOptions {
            rays: 4096,
            ..Default::default()
        };
        Box::new(RayCast::new(mesh, options))
    }),
    ("hemicube", |mesh| {
        Box::new(Hemicube::new(mesh, HemicubeOptions::default()).expect("usual options"))
    }),
];

#[test]
fn obstructions_block_both_ways_and_have_no_row() {
    // View3D 4.0.0 with eps = 1e-6 and up to 12 recursions.
    let expected = 0.149_869;
    for flipped in [false, true] {
        let mesh = mesh_of(with_obstruction(flipped), fine(600));
        assert_eq!(mesh.obstructions().len(), 1, "the plate");
        for (name, method) in METHODS {
            let matrix = between(&*method(mesh.clone()), SurfacesBy::Object, Storage::Auto);
            assert_eq!(
                matrix.names(),
                ["low", "high"],
                "{name}: the plate is no row"
            );
            for (i, j) in [(0, 1), (1, 0)] {
                let error = (matrix.get(i, j) - expected).abs();
                assert!(error < 1e-3, "{name}, flipped {flipped}: {error:.1e} off");
                let absorbed = matrix.absorbed()[i];
                assert!(
                    (absorbed - 0.104).abs() < 2e-3,
                    "{name}: the plate takes {absorbed}"
                );
            }
        }
    }
}

#[test]
fn nothing_is_buried_before_the_front_of_an_obstruction() {
    // A square in a box of obstructions that face it.
    let mut scene = builtin::furnace_with(0.5, 0.0);
    for material in &mut scene.materials {
        material.obstruction = true;
    }
    let middle =
        obj("o square\nv -0.1 0 0.1\nv 0.1 0 0.1\nv 0.1 0 -0.1\nv -0.1 0 -0.1\nf 1 2 3 4\n");
    let (low, high) = scene.bounds().expect("it has faces");
    let mut square = middle.meshes[0].clone();
    square.material = scene.materials.len();
    square
        .positions
        .iter_mut()
        .for_each(|p| *p += (low + high) * 0.5);
    scene.materials.push(middle.materials[0].clone());
    let mut instance = middle.instances[0].clone();
    instance.mesh = scene.meshes.len();
    scene.meshes.push(square);
    scene.instances.push(instance);
    let mesh = mesh_of(scene, PatchOptions::whole_faces());
    let matrix = between(&rays(&mesh), SurfacesBy::Object, Storage::Auto);
    assert_eq!(matrix.names(), ["square"], "the only row");
    assert!(
        (matrix.absorbed()[0] - 1.0).abs() < 1e-6,
        "all of it is absorbed"
    );
}

#[test]
fn a_scene_of_obstructions_alone_has_nothing_to_light() {
    let mut scene = builtin::furnace_with(0.5, 1.0);
    scene
        .materials
        .iter_mut()
        .for_each(|m| m.obstruction = true);
    let refused =
        PatchMesh::build(Arc::new(scene), PatchOptions::default()).expect_err("no lit side");
    assert!(
        refused.to_string().contains("nothing to light"),
        "{refused}"
    );
}

/// The cube of FACET's manual (Shapiro 1983, UCID-19887) with a plate of two one-sided faces in one place. The factors
/// are those of View3D 4.0.0.
#[test]
fn a_plate_of_two_faces_in_one_place_shows_its_fronts() {
    let cube: String = (0..8)
        .map(|i| [(i + 1) / 2 % 2, i / 2 % 2, i / 4])
        .map(|[x, y, z]| format!("v {x} {y} {z}\n"))
        .collect();
    let plate = "v 0.25 0.75 0.25\nv 0.75 0.75 0.25\nv 0.75 0.75 0.75\nv 0.25 0.75 0.75\n";
    let faces = "o bottom\nf 1 2 3 4\no right\nf 3 2 6 7\no top\nf 7 6 5 8\no left\nf 4 8 5 1\no behind\nf 3 7 8 4\n\
                 o before\nf 1 5 6 2\no outside\nf 9 10 11 12\no inside\nf 12 11 10 9\n";
    let mesh = mesh_of(obj(&format!("{cube}{plate}{faces}")), fine(500));
    let expected = [
        (0, 1, 0.197_469),
        (0, 2, 0.179_233),
        (0, 4, 0.171_494),
        (0, 6, 0.041_448),
        (0, 7, 0.012_847),
        (4, 5, 0.115_621),
        (4, 7, 0.198_613),
        (6, 5, 0.336_817),
        (7, 4, 0.794_453),
    ];
    for (name, method) in METHODS {
        let matrix = between(&*method(mesh.clone()), SurfacesBy::Object, Storage::Auto);
        for (i, j, factor) in expected {
            let found = matrix.get(i, j);
            let (from, to) = (&matrix.names()[i], &matrix.names()[j]);
            println!("{name}: {from} to {to} {found}, expected {factor}");
            assert!(
                (found - factor).abs() < 2e-3,
                "{name}: {from} to {to} is {found}, not {factor}"
            );
        }
        let backs = matrix
            .absorbed()
            .iter()
            .fold(0.0, |most: f64, &share| most.max(share));
        assert!(
            backs < 1e-3,
            "{name}: no back can be seen, {backs} is absorbed"
        );
    }
}
