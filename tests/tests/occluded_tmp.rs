use glam::DVec3;
use hemicube::radiosity::form_factor::analytic;
use serde_json::Value;
fn v(value: &Value) -> Vec<DVec3> {
    value["vertices"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| DVec3::from_array([0, 1, 2].map(|i| p[i].as_f64().unwrap())))
        .collect()
}
#[test]
fn occ() {
    let root: Value = serde_json::from_str(include_str!("../data/view_factors.json")).unwrap();
    for e in root["references"].as_array().unwrap() {
        let Some(o) = e["occluders"].as_array().filter(|o| !o.is_empty()) else {
            continue;
        };
        let (a, b) = (v(&e["surf1"]), v(&e["surf2"]));
        let occ: Vec<Vec<DVec3>> = o.iter().map(v).collect();
        let refs: Vec<&[DVec3]> = occ.iter().map(|o| &o[..]).collect();
        let area = analytic::area(&a);
        for tol in [1e-3, 1e-4, 1e-5, 1e-6] {
            let t = std::time::Instant::now();
            let x = analytic::occluded_exchange(&a, &b, &refs, tol * area);
            println!(
                "{} tol {tol:e} F {} err {:.2e} est {:.2e} {:?}",
                e["id"],
                x.area / area,
                x.area / area - e["F12"].as_f64().unwrap(),
                x.error / area,
                t.elapsed()
            );
        }
    }
}
