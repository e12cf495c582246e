//! Memory that a scene's light takes, estimated before the work begins.
//!
//! An estimate is a line: what an element takes, with each group of luminaires, and what any work takes. The numbers are
//! fitted to peaks of the program that solves and writes a lit file: by rays, `cornell` of 111,568 and 426,765 elements and
//! `theatre` of 546,615 and 1,010,332 take 73, 250, 580 and 805 MiB, and 96, 301, 571 and 820 by the line; by shooting,
//! `cornell` of 431,322 and `theatre` of 541,518 take 434 and 449 MiB, and 408 and 481 by the line. Matrices and links have a
//! limit of their own ([`SolveOptions::memory_limit`]).

use crate::error::RadiosityError;
use crate::job::{SolveOptions, Way, groups_in};
use crate::patch::MAX_ELEMENTS;
use crate::solution::BANDS;
use hemicube_scene::Scene;

const MIB: usize = 1 << 20;
/// What work on few elements takes.
const FIXED: usize = 24 * MIB;
/// Rows that are kept for patches that shoot again: mostly fewer than may be.
const ROWS: usize = 96 * MIB;
/// Of a mesh with one group, its solver, and the lit file.
const OF_ELEMENT: usize = 700;
/// The same by rays alone.
const OF_ELEMENT_BY_RAYS: usize = 565;
/// Of a patch that gathers by rays.
const OF_GATHERING_PATCH: usize = 2400;
/// Irradiance, its unshot part and the file's share, of each band.
const OF_GROUP: usize = 12 * BANDS;

/// Bytes that so many elements take.
pub fn estimated_bytes(scene: &Scene, options: &SolveOptions, elements: usize) -> usize {
    let line = Line::of(scene, options);
    line.fixed
        .saturating_add(line.of_element.saturating_mul(elements))
}

/// Most elements for which there is [memory](SolveOptions::total_memory).
pub fn most_elements(scene: &Scene, options: &SolveOptions) -> usize {
    let line = Line::of(scene, options);
    options.total_memory.map_or(MAX_ELEMENTS, |total| {
        (total.saturating_sub(line.fixed) / line.of_element).min(MAX_ELEMENTS)
    })
}

/// Says of a mesh that is too fine what it would have taken, and what may be taken.
pub(crate) fn explained(
    error: RadiosityError,
    scene: &Scene,
    options: &SolveOptions,
) -> RadiosityError {
    let RadiosityError::TooManyElements { elements, most } = error else {
        return error;
    };
    let solver = options.solver.name();
    let mib = |bytes: usize| bytes.div_ceil(MIB);
    let needed = mib(estimated_bytes(scene, options, elements));
    let limit = match options.total_memory.filter(|_| most < MAX_ELEMENTS) {
        Some(total) => format!(
            "{} MiB are free for it, enough for {most} elements",
            mib(total)
        ),
        None => format!(
            "a mesh has at most {most} elements, about {} MiB",
            mib(estimated_bytes(scene, options, most))
        ),
    };
    RadiosityError::Option(format!(
        "{elements} elements or more would take about {needed} MiB with solver {solver}; {limit}: ask for fewer or larger \
         ones, or leave out what cuts them"
    ))
}

/// Bytes of some elements.
struct Line {
    fixed: usize,
    of_element: usize,
}

impl Line {
    fn of(scene: &Scene, options: &SolveOptions) -> Self {
        let groups = groups_in(scene, options.grouping);
        let (fixed, of_element) = match options.solver.way() {
            Way::Shooting(_) | Way::OnMatrix(_) => (FIXED + ROWS, OF_ELEMENT),
            Way::Hierarchical => (FIXED, OF_ELEMENT),
            Way::Stochastic => {
                let asked = options.mesh.patches.unwrap_or(0).min(MAX_ELEMENTS);
                let patches = asked.max(scene.face_count());
                let of_patches = patches.saturating_mul(OF_GATHERING_PATCH);
                (FIXED.saturating_add(of_patches), OF_ELEMENT_BY_RAYS)
            }
        };
        Self {
            fixed,
            of_element: of_element + (groups - 1) * OF_GROUP,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::SolverKind;
    use hemicube_scene::builtin;

    #[test]
    fn as_many_elements_are_allowed_as_fit() {
        let scene = builtin::scene("cornell").expect("it is built in");
        for solver in SolverKind::ALL {
            let options = SolveOptions {
                solver,
                total_memory: Some(1000 * MIB),
                ..SolveOptions::default()
            };
            let most = most_elements(&scene, &options);
            let taken = |elements| estimated_bytes(&scene, &options, elements);
            assert!(taken(most) <= 1000 * MIB, "{}: they fit", solver.name());
            assert!(taken(most + 1) > 1000 * MIB, "{}: no more", solver.name());
        }
    }

    #[test]
    fn without_a_limit_the_mesh_has_one() {
        let scene = builtin::scene("cornell").expect("it is built in");
        let most = most_elements(&scene, &SolveOptions::default());
        assert_eq!(most, MAX_ELEMENTS);
    }
}
