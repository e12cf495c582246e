//! x
use hemicube::radiosity::form_factor::{
    Analytic, AnalyticOptions, MatrixOptions, Storage, ViewFactorMatrix,
};
use hemicube::radiosity::{PatchMesh, PatchOptions};
use hemicube_tests::enclosures;
use std::sync::Arc;
use std::time::Instant;

fn main() {
    let which = std::env::args().nth(1).unwrap_or_default();
    let error: f64 = std::env::args()
        .nth(2)
        .and_then(|e| e.parse().ok())
        .unwrap_or(1e-5);
    let scene = match which.as_str() {
        "cube10" => enclosures::cube(10),
        "cube20" => enclosures::cube(20),
        "cube40" => enclosures::cube(40),
        "room12" => enclosures::room_with_cube(12, 5),
        _ => enclosures::room_with_cube(25, 8),
    };
    let t = Instant::now();
    let mesh = Arc::new(
        PatchMesh::build(
            Arc::new(scene),
            PatchOptions::default().with_element_size(100.0),
        )
        .unwrap(),
    );
    println!("mesh {:?} {}", t.elapsed(), mesh.elements().len());
    let t = Instant::now();
    let factors =
        Analytic::new(mesh.clone(), AnalyticOptions::default().with_error(error)).unwrap();
    println!("prepare {:?}", t.elapsed());
    let t = Instant::now();
    let m = ViewFactorMatrix::build(
        &factors,
        MatrixOptions {
            storage: Storage::Dense,
            ..MatrixOptions::default()
        },
    )
    .unwrap()
    .remove(0);
    println!("matrix {:?}", t.elapsed());
    let n = m.size();
    let worst = (0..n)
        .map(|i| (m.row_sum(i) - 1.0).abs())
        .fold(0.0, f64::max);
    println!(
        "closure {worst:e} reciprocity {:e}",
        m.reciprocity_error().error
    );
    if let Some(out) = std::env::args().nth(3) {
        let bytes: Vec<u8> = (0..n)
            .flat_map(|i| {
                m.entries()
                    .row(i)
                    .flat_map(|(_, f)| f.to_le_bytes())
                    .collect::<Vec<u8>>()
            })
            .collect();
        std::fs::write(out, bytes).unwrap();
    }
}
