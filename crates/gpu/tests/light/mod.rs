//! Light that two solvers found.

use hemicube_radiosity::Solution;

/// Checks in all bands that the second has lost no energy, and that irradiance differs by less than a share of the light.
pub fn assert_alike(cpu: &Solution, gpu: &Solution, tolerance: f64) {
    for band in 0..3 {
        let unshot = gpu.unshot_flux(band);
        let error = gpu.total_balance(band).relative_error(unshot);
        assert!(error < 1e-4, "band {band}: energy is off by {error:.1e}");
        let mesh = cpu.mesh();
        let (mut difference, mut sum) = (0.0, 0.0);
        for e in 0..mesh.elements().len() {
            let [a, b] = [cpu, gpu].map(|solution| solution.element_irradiance(e)[band]);
            let area = f64::from(mesh.exposed_area(e));
            difference += area * f64::from((a - b).abs());
            sum += area * f64::from(a);
        }
        let share = difference / sum;
        println!("band {band}: irradiance differs by {share:.2e}");
        assert!(share < tolerance, "band {band}: {share}");
    }
}
