use hemicube_gpu::*;
use hemicube_radiosity::form_factor::hemicube::*;
use hemicube_radiosity::form_factor::*;
use hemicube_radiosity::patch::*;
use std::sync::Arc;
use std::time::Instant;
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    (f[11].parse::<f64>().unwrap() + f[12].parse::<f64>().unwrap()) / 100.0
}
fn main() {
    let a: Vec<usize> = std::env::args()
        .skip(1)
        .map(|x| x.parse().unwrap())
        .collect();
    let (elements, res, n) = (a[0], a[1], a[2]);
    let ctx = Arc::new(Context::headless(None).unwrap());
    let scene = Arc::new(hemicube_scene::builtin::scene("cornell").unwrap());
    let mesh = Arc::new(
        PatchMesh::build(
            scene,
            PatchOptions::default()
                .with_elements(elements)
                .with_patches(elements / 10),
        )
        .unwrap(),
    );
    let o = HemicubeOptions::default()
        .with_resolution(res as u32)
        .with_max_points(1);
    let gpu = GpuHemicube::new(ctx, mesh.clone(), o).unwrap();
    let some: Vec<NodeId> = mesh.patches().iter().copied().step_by(7).take(n).collect();
    let c = gpu.shot_counts(&some[..16.min(n)]).unwrap();
    println!("{c:?}");
    let mut rows = vec![Row::default(); some.len()];
    let (t, c0) = (Instant::now(), cpu());
    gpu.fill_rows(&some, &mut rows);
    println!(
        "rows: {:.2} ms, {:.2} cpu-ms each",
        t.elapsed().as_secs_f64() * 1e3 / n as f64,
        (cpu() - c0) * 1e3 / n as f64
    );
}
