//! A form-factor method of one's own: `cargo run --release --example custom_form_factors`.
//!
//! The integrating sphere: light leaves a patch and arrives everywhere alike. Its factors are the areas' shares, no
//! visibility, no geometry; the mean irradiance of a closed room comes out right all the same.

use hemicube::radiosity::solve::run;
use hemicube::radiosity::{
    FormFactors, Grouping, NodeId, Order, PatchMesh, PatchOptions, RadiosityError, Row,
};
use hemicube::radiosity::{Shooting, Solution, Solver};
use hemicube::raster::Rgb;
use hemicube::scene;
use std::sync::Arc;

/// Every element receives its share of the whole area.
struct IntegratingSphere {
    mesh: Arc<PatchMesh>,
    area: f32,
}

impl FormFactors for IntegratingSphere {
    fn mesh(&self) -> &Arc<PatchMesh> {
        &self.mesh
    }

    fn fill_row(&self, _source: NodeId, row: &mut Row) {
        row.clear(1);
        for (e, receiver) in (0..).zip(0..self.mesh.elements().len()) {
            row.receivers.push(e);
            row.fractions
                .push(self.mesh.exposed_area(receiver) / self.area);
        }
    }
}

/// Area-weighted mean irradiance of a scene lit by these factors.
pub fn mean_irradiance(name: &str) -> Result<Rgb, RadiosityError> {
    let mesh = Arc::new(PatchMesh::build(
        Arc::new(scene::open(name)?),
        PatchOptions::default().with_elements(500),
    )?);
    let elements = mesh.elements().len();
    let area = (0..elements).map(|e| mesh.exposed_area(e)).sum();
    let factors = IntegratingSphere {
        mesh: mesh.clone(),
        area,
    };
    let solution = Solution::new(
        mesh.clone(),
        &vec![Rgb::BLACK; elements],
        Grouping::Together,
    );
    let mut solver = Shooting::new(&factors, solution, Order::Sorted);
    run(&mut solver, 1e-6, |_, _| true);
    let light = solver.solution();
    Ok((0..elements)
        .map(|e| light.element_irradiance(e) * mesh.exposed_area(e))
        .sum::<Rgb>()
        / area)
}

fn main() -> Result<(), RadiosityError> {
    println!(
        "mean irradiance of the furnace: {:?} (exact: 2)",
        mean_irradiance("furnace")?
    );
    Ok(())
}
