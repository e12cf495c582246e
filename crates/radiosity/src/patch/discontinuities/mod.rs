//! Discontinuity meshing: elements end where shadows do (Heckbert 1992; Lischinski, Tampieri, Greenberg 1992).
//!
//! Behind an edge, irradiance has jumps in its first or second derivative (D1, D2) where the set of visible corners and
//! edges of a lamp changes: on *critical surfaces*. Here it is cut along those that a corner and an edge span, the
//! wedges of
//! - a lamp's corner and an occluder's edge that is an outline as seen from the corner (VE),
//! - a lamp's edge and an occluder's corner on such an outline (EV).
//!
//! Of points and of the sun there is only the first kind, and irradiance itself jumps there (D0). D0 lines under what
//! stands on a surface are [joints](super::constraints).
//!
//! 1. Each wedge is a flat part of a plane, beginning at the occluder. It is cut with the faces that are large enough
//!    (`lines.rs`).
//! 2. What is hidden goes: at points along the line, the lamp's corner must be seen from one side of the line and not
//!    from the other (VE), or the point of its edge that the line looks at from at least one (EV) (`sight.rs`).
//! 3. What is left is handed to [`constraints`](super::constraints).
//!
//! Left out: critical surfaces of three edges of occluders and lamps (EEE), which are curved; lamps of more than 24
//! corners; windows with the sky behind them; lines where a penumbra is wider than four elements, since those resolve
//! it; edges shorter than a quarter of an element. The strongest lamps come first, up to 512 lines a face and 400,000
//! wedges.
//!
//! It pays where a penumbra is about as wide as an element or narrower. Light exact at the vertices and linear between
//! them, root mean square over the penumbra: below a table of 0.8 m at a height of 0.7 m, under a lamp of 0.2 m at 2 m, a
//! uniform mesh takes 42 to 46 times as many elements for the same error; where the penumbra is one and a half elements
//! wide, it takes as many, since light is smooth inside. Scenes of much furniture and many lamps get far more lines than
//! they need: the office grows from 21,000 to 70,000 elements. So it is off by default.

mod lights;
mod lines;
mod outlines;
mod sight;

use self::lines::Caster;
use self::outlines::Outlines;
use super::PatchMesh;
use super::constraints::plane::{Line, Segment};
use super::sizes::Sizes;
use crate::stop::Stop;
use hemicube_scene::report::counted;
use rayon::prelude::*;

/// Lines of shadows that one face keeps at most.
const MOST_LINES: usize = 512;
/// Wedges that are looked at, over all lamps.
const MOST_WEDGES: usize = 400_000;

impl PatchMesh {
    /// Adds the borders of shadows to the lines of each face; none if it was stopped.
    pub(super) fn add_shadow_lines(
        &mut self,
        lines: &mut [Vec<Line>],
        sizes: Sizes,
        stop: Stop<'_>,
    ) -> Option<()> {
        let faces = self.faces.clone();
        let outlines = Outlines::new(&faces);
        let (lamps, mut left_out) = lights::lamps(&self.scene, &outlines, &faces);
        let caster = Caster::new(self, &outlines, sizes);
        let mut budget = MOST_WEDGES;
        let mut kept: Vec<Vec<Line>> = vec![Vec::new(); faces.len()];
        for lamp in &lamps {
            let wedges = caster.wedges(lamp);
            if wedges.len() > budget {
                left_out += 1;
                continue;
            }
            budget -= wedges.len();
            let cast: Option<Vec<Vec<(usize, Segment)>>> = wedges
                .par_iter()
                .map(|wedge| (!stop()).then(|| caster.lines(lamp, wedge)))
                .collect();
            let jumps = lamp.edges.is_empty();
            for (face, ends) in cast?.into_iter().flatten() {
                caster.keep(&mut kept[face], Line { ends, jumps });
            }
        }
        self.cuts.shadow_lines = kept.iter().map(Vec::len).sum();
        for (lines, shadows) in lines.iter_mut().zip(kept) {
            lines.extend(shadows);
        }
        if left_out > 0 {
            let what = format!(
                "the shadows of {} got no lines: they are round, or the weakest of too many",
                counted(left_out, "lamp")
            );
            self.report.warn("discontinuities", what);
        }
        Some(())
    }
}
