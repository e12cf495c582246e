//! Solids by set operations.

use crate::exhibit::{Exhibit, GalleryError, Piece, Request};
use crate::fruit_bowl;
use hemicube_csg::View;

pub(crate) const EXHIBITS: &[Exhibit] = &[Exhibit {
    name: "fruit-bowl",
    about: "solids by set operations in a ray tracer: a bowl of fruit, and the luminosity along a line of it",
    needs: &[],
    draw: fruit_bowl,
}];

fn fruit_bowl(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = request.size.unwrap_or((800, 600));
    let scene = fruit_bowl::scene().unwrap();
    let camera = fruit_bowl::camera().unwrap();
    let image = View {
        scene: &scene,
        camera: &camera,
        width,
        height,
    }
    .render();
    Ok(vec![Piece::picture("", &image)?])
}
