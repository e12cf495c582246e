//! How many entries of a matrix are not zero, told before any of them is computed.
//!
//! Two surfaces exchange light if some point of one sees some point of the other. Of all pairs some are picked, evenly
//! with jitter, and asked by a few segments between random points of both: is each point in front of the other's plane,
//! and is nothing opaque in between? The work is the same for a hundred surfaces and for a million, where rows would take
//! a second each; it does not depend on the way to the factors either.
//!
//! # Error
//! Pairs that see each other through narrow gaps alone are missed; a share `s` of `k` pairs has a standard error of
//! `√(s (1 - s) / k)` or somewhat more, since pairs share rows: 0.3 % of all pairs at most, or 1 % with that.

use crate::form_factor::FormFactors;
use crate::form_factor::surfaces::Surfaces;
use crate::patch::PatchMesh;
use crate::sampling::{hash, point4, polygon_point};
use rayon::prelude::*;

/// Rows that are looked at.
const ROWS: usize = 64;
/// Columns that are looked at of each.
const COLUMNS: usize = 512;
/// Segments by which one pair is asked.
const SEGMENTS: u32 = 4;

/// What an estimate says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fill {
    /// Share of the entries that are not zero.
    pub(super) share: f64,
    /// Pairs that were asked.
    pub(super) pairs: usize,
}

/// The patches behind each row and column.
pub(super) struct Groups {
    starts: Vec<usize>,
    patches: Vec<usize>,
}

impl Groups {
    /// A row for each patch.
    pub(super) fn of_patches(mesh: &PatchMesh) -> Self {
        let n = mesh.patches().len();
        Self {
            starts: (0..=n).collect(),
            patches: (0..n).collect(),
        }
    }

    /// A row for each surface; those without a patch see nothing.
    pub(super) fn of_surfaces(mesh: &PatchMesh, surfaces: &Surfaces) -> Self {
        let of_patch = |p: usize| Some((surfaces.of_patch(p)?, p));
        let mut patches: Vec<(usize, usize)> =
            (0..mesh.patches().len()).filter_map(of_patch).collect();
        // Stable, so that patches of one surface keep their order.
        patches.sort_by_key(|&(surface, _)| surface);
        let first = |surface: usize| patches.partition_point(|&(of, _)| of < surface);
        Self {
            starts: (0..=surfaces.len()).map(first).collect(),
            patches: patches.into_iter().map(|(_, patch)| patch).collect(),
        }
    }

    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn patches(&self, row: usize) -> &[usize] {
        &self.patches[self.starts[row]..self.starts[row + 1]]
    }
}

/// The share of entries that are not zero.
pub(super) fn estimate(factors: &dyn FormFactors, groups: &Groups) -> Fill {
    let n = groups.len();
    let (rows, columns) = (n.min(ROWS), n.min(COLUMNS));
    if n == 0 {
        return Fill {
            share: 0.0,
            pairs: 0,
        };
    }
    let mesh = factors.mesh();
    let share_of_row = |k: usize| {
        let row = pick(k, rows, n, 0);
        let column = |c: usize| pick(c, columns, n, row as u64 + 1);
        let sees = |c: &usize| sees(mesh, groups, row, column(*c));
        let seen = (0..columns).filter(sees).count() as f64 / columns as f64;
        let most = |&patch: &usize| factors.most_receivers(mesh.patches()[patch]);
        let most = groups.patches(row).iter().map(most);
        let most = most.fold(0, usize::saturating_add) as f64 / n as f64;
        seen.min(most)
    };
    let shares: Vec<f64> = (0..rows).into_par_iter().map(share_of_row).collect();
    Fill {
        share: shares.iter().sum::<f64>() / rows as f64,
        pairs: rows * columns,
    }
}

/// A number below `n` from the k-th of `count` equal parts; the parts are single numbers where `count` is `n`.
fn pick(k: usize, count: usize, n: usize, seed: u64) -> usize {
    let (first, end) = (k * n / count, (k + 1) * n / count);
    first + below(hash(k as u64, seed), end - first)
}

/// A number below `count` out of random bits; 0 if there is none.
fn below(bits: u64, count: usize) -> usize {
    usize::try_from(bits % count.max(1) as u64).expect("it is below a usize")
}

/// Whether some point of a row's patches sees one of a column's.
fn sees(mesh: &PatchMesh, groups: &Groups, row: usize, column: usize) -> bool {
    let (from, to) = (groups.patches(row), groups.patches(column));
    if from.is_empty() || to.is_empty() {
        return false;
    }
    let seed = hash(row as u64, column as u64);
    (0..SEGMENTS).any(|k| {
        let bits = hash(seed, u64::from(k));
        let (from, to) = (
            from[below(bits >> 32, from.len())],
            to[below(bits & 0xffff_ffff, to.len())],
        );
        from != to && segment_is_clear(mesh, [from, to], point4(k, seed))
    })
}

/// Whether light gets from a point of one patch to a point of another.
fn segment_is_clear(mesh: &PatchMesh, patches: [usize; 2], [a, b, c, d]: [f32; 4]) -> bool {
    let [from, to] = patches.map(|patch| mesh.patches()[patch]);
    let start = polygon_point(&mesh.polygon(from), [a, b]);
    let end = polygon_point(&mesh.polygon(to), [c, d]);
    let normals = [from, to].map(|node| mesh.node(node).normal);
    let way = end - start;
    if way.dot(normals[0]) <= 0.0 || way.dot(normals[1]) >= 0.0 {
        return false;
    }
    let visibility = mesh.visibility();
    let start = visibility.off_surface(start, normals[0]);
    let end = visibility.off_surface(end, normals[1]);
    !visibility.transmittance(start, end).is_black()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::{MatrixOptions, RayCast, RayCastOptions, Storage, ViewFactorMatrix};
    use crate::patch::PatchOptions;
    use hemicube_scene::builtin;
    use std::sync::Arc;

    fn factors_of(scene: &str, patches: usize) -> RayCast {
        let scene = Arc::new(builtin::scene(scene).expect("it is built in"));
        let options = PatchOptions::default()
            .with_elements(patches)
            .with_patches(patches);
        let mesh = PatchMesh::build(scene, options).expect("it can be cut");
        RayCast::new(Arc::new(mesh), RayCastOptions::default())
    }

    /// Rows themselves are the truth; pairs of which less than some percent is seen may be missed.
    #[test]
    fn the_estimate_is_near_what_rows_have() {
        for scene in ["cornell", "two-rooms"] {
            let factors = factors_of(scene, 700);
            let options = MatrixOptions {
                storage: Storage::Sparse,
                ..MatrixOptions::default()
            };
            let matrix = ViewFactorMatrix::build(&factors, options).expect("it fits");
            let n = matrix[0].size();
            let entries: usize = (0..n).map(|i| matrix[0].entries().row(i).count()).sum();
            let share = entries as f64 / (n * n) as f64;
            let fill = estimate(&factors, &Groups::of_patches(factors.mesh()));
            let error = (fill.share - share).abs();
            assert!(
                error < 0.03,
                "{scene}: {} estimated, {share} there",
                fill.share
            );
            assert_eq!(fill.pairs, 64 * 512, "the work is bounded");
        }
    }

    #[test]
    fn an_estimate_costs_no_row() {
        let factors = factors_of("cornell", 100);
        let groups = Groups::of_patches(factors.mesh());
        let first = estimate(&factors, &groups);
        assert_eq!(factors.rays(), 0, "rays of rows");
        assert_eq!(first, estimate(&factors, &groups), "twice the same");
    }

    #[test]
    fn picks_are_all_numbers_where_there_are_few() {
        let all: Vec<usize> = (0..7).map(|k| pick(k, 7, 7, 3)).collect();
        assert_eq!(all, [0, 1, 2, 3, 4, 5, 6], "each once");
        for k in 0..512 {
            let of_many = pick(k, 512, 1_000_003, 5);
            assert!(
                of_many * 512 / 1_000_003 == k,
                "one of each part: {of_many}"
            );
        }
    }
}
