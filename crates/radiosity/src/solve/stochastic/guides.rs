//! Where light comes from: what earlier rays of a patch found says which directions deserve more of them.
//!
//! Directions are drawn from a square, whose cells each patch remembers by the mean square of what rays through them
//! brought. The next rays go through a cell in proportion to the root of that, which leaves the least variance of all
//! densities that are constant over cells (importance sampling with a density learnt on the way: Vorba and others 2014;
//! Müller, Gross, Novák 2017), and count by the inverse. Points of a low-discrepancy sequence are bent rather than chosen
//! from, so they stay evenly spread over each cell. In the theatre guides leave two thirds of the variance.

use crate::patch::PatchMesh;

/// Cells along each side of the square.
const SIDE: usize = 8;
const CELLS: usize = SIDE * SIDE;
/// Rays of a cell for which what is around it counts.
const TRUST: f32 = 2.0;
/// Share of the rays that go anywhere.
const ANYWHERE: f32 = 0.2;

/// What is known of each patch.
pub(super) struct Guides(Vec<Learnt>);

impl Guides {
    /// Nothing is known yet.
    pub(super) fn new(mesh: &PatchMesh) -> Self {
        Self(vec![Learnt::NOTHING; mesh.patches().len()])
    }

    /// What is known of each patch, to be used and added to.
    pub(super) fn of_patches(&mut self) -> &mut [Learnt] {
        &mut self.0
    }
}

/// What the rays of a patch have brought, cell by cell.
#[derive(Debug, Clone)]
pub(super) struct Learnt {
    /// Sums of squares.
    squares: [f32; CELLS],
    rays: [u16; CELLS],
}

impl Learnt {
    const NOTHING: Self = Self {
        squares: [0.0; CELLS],
        rays: [0; CELLS],
    };

    /// Adds what a ray through a cell brought. Both sums are halved where they would not fit.
    pub(super) fn add(&mut self, cell: usize, brought: f32) {
        if self.rays[cell] == u16::MAX {
            self.rays[cell] /= 2;
            self.squares[cell] *= 0.5;
        }
        self.rays[cell] += 1;
        self.squares[cell] += brought * brought;
    }

    /// Mean squares of the cells, where `else_by` counts as much as [`TRUST`] rays.
    fn mean_squares(&self, else_by: impl Fn(usize) -> f32) -> [f32; CELLS] {
        core::array::from_fn(|cell| {
            let rays = f32::from(self.rays[cell]);
            (self.squares[cell] + TRUST * else_by(cell)) / (rays + TRUST)
        })
    }

    /// Where to send rays.
    pub(super) fn guide(&self) -> Guide {
        let rays: f32 = self.rays.iter().map(|&rays| f32::from(rays)).sum();
        let mean = self.squares.iter().sum::<f32>() / rays.max(1.0);
        let smooth = smoothed(&self.mean_squares(|_| mean));
        Guide::new(self.mean_squares(|cell| smooth[cell]).map(f32::sqrt))
    }
}

/// Each cell with its neighbours, by binomial weights; beyond the border all is as on it.
fn smoothed(cells: &[f32; CELLS]) -> [f32; CELLS] {
    let along = |cells: &[f32; CELLS], step: usize| -> [f32; CELLS] {
        core::array::from_fn(|cell| {
            let position = cell / step % SIDE;
            let before = cell - if position > 0 { step } else { 0 };
            let after = cell + if position + 1 < SIDE { step } else { 0 };
            0.25 * (cells[before] + cells[after]) + 0.5 * cells[cell]
        })
    };
    along(&along(cells, 1), SIDE)
}

/// A density over the square of directions, constant over each of its cells.
#[derive(Debug, Clone)]
pub(super) struct Guide {
    /// Of the cells; their mean is 1.
    density: [f32; CELLS],
    /// Shares of the rays up to and with each row.
    rows: [f32; SIDE],
    /// Of each row, up to and with each of its cells.
    cells: [[f32; SIDE]; SIDE],
}

/// A place in the square that was drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drawn {
    pub(super) place: [f32; 2],
    pub(super) cell: usize,
    /// By which what is found counts.
    pub(super) weight: f32,
}

impl Guide {
    fn new(wanted: [f32; CELLS]) -> Self {
        let mean = wanted.iter().sum::<f32>() / CELLS as f32;
        let density = wanted.map(|wanted| {
            if mean > 0.0 {
                ANYWHERE + (1.0 - ANYWHERE) * wanted / mean
            } else {
                1.0
            }
        });
        let (rows, _) = density.as_chunks::<SIDE>();
        let sums = core::array::from_fn(|row: usize| rows[row].iter().sum());
        Self {
            rows: shares(sums),
            cells: core::array::from_fn(|row| shares(rows[row])),
            density,
        }
    }

    /// Bends a point of the square to where more of them belong.
    pub(super) fn draw(&self, [s, t]: [f32; 2]) -> Drawn {
        let (row, s) = find(&self.rows, s);
        let (column, t) = find(&self.cells[row], t);
        let cell = row * SIDE + column;
        Drawn {
            place: [s, t],
            cell,
            weight: 1.0 / self.density[cell],
        }
    }
}

/// Running sums of positive numbers, as shares of all.
fn shares(numbers: [f32; SIDE]) -> [f32; SIDE] {
    let total: f32 = numbers.iter().sum();
    let mut sum = 0.0;
    numbers.map(|number| {
        sum += number;
        sum / total
    })
}

/// Which of the shares a number in [0, 1) is in, and where it lies if all are equally wide.
fn find(shares: &[f32; SIDE], number: f32) -> (usize, f32) {
    /// The largest number below 1.
    const LAST: f32 = 1.0 - f32::EPSILON / 2.0;
    // Rounding may leave the last of them below 1.
    let inner = shares[..SIDE - 1].iter();
    let index = inner.filter(|&&share| share <= number).count();
    let before = index.checked_sub(1).map_or(0.0, |before| shares[before]);
    let within = (number - before) / (shares[index] - before);
    let place = (index as f32 + within.clamp(0.0, LAST)) / SIDE as f32;
    (index, place.min(LAST))
}

/// Things sorted by their cells, those of a cell in the order they had.
pub(super) fn in_order_of_cells<T: Copy>(things: &[T], cell: impl Fn(&T) -> usize) -> Vec<T> {
    let mut places = [0; CELLS + 1];
    things.iter().for_each(|thing| places[cell(thing) + 1] += 1);
    (0..CELLS).for_each(|cell| places[cell + 1] += places[cell]);
    let mut sorted = things.to_vec();
    for thing in things {
        let place = &mut places[cell(thing)];
        sorted[*place] = *thing;
        *place += 1;
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sobol::Sobol4;

    fn cell_of([s, t]: [f32; 2]) -> usize {
        let along = |x: f32| {
            (0..SIDE - 1)
                .filter(|&i| x * SIDE as f32 >= (i + 1) as f32)
                .count()
        };
        along(s) * SIDE + along(t)
    }

    #[test]
    fn rays_go_where_light_was_and_their_weights_make_up_for_it() {
        let mut learnt = Learnt::NOTHING;
        for cell in 0..CELLS {
            for _ in 0..32 {
                learnt.add(cell, if cell == 19 { 9.0 } else { 1.0 });
            }
        }
        let guide = learnt.guide();
        let sequence = Sobol4::new(5);
        let mut counts = [0_u32; CELLS];
        let (mut area, n) = (0.0, 1 << 14);
        for i in 0..n {
            let [s, t, ..] = sequence.point(i);
            let drawn = guide.draw([s, t]);
            assert_eq!(drawn.cell, cell_of(drawn.place), "{drawn:?}");
            counts[drawn.cell] += 1;
            area += f64::from(drawn.weight) * f64::from(u8::from(drawn.place[0] < 0.5));
        }
        let area = area / f64::from(n);
        assert!((area - 0.5).abs() < 1e-3, "half of the square: {area}");
        let ratio = f64::from(counts[19]) / f64::from(counts[44]);
        assert!((4.0..9.0).contains(&ratio), "{ratio} times as many");
    }

    #[test]
    fn without_knowledge_nothing_is_bent() {
        let mut dark = Learnt::NOTHING;
        (0..CELLS).for_each(|cell| dark.add(cell, 0.0));
        for learnt in [Learnt::NOTHING, dark] {
            let drawn = learnt.guide().draw([0.3, 0.999]);
            assert_eq!(drawn.weight, 1.0, "as anywhere");
            assert!((drawn.place[0] - 0.3).abs() < 1e-6, "{drawn:?}");
        }
    }

    #[test]
    fn cells_follow_each_other() {
        let things = [(5, 'a'), (63, 'b'), (0, 'c'), (5, 'd')];
        let sorted = in_order_of_cells(&things, |thing| thing.0);
        assert_eq!(sorted, [(0, 'c'), (5, 'a'), (5, 'd'), (63, 'b')]);
    }

    #[test]
    fn counts_are_bounded() {
        let mut learnt = Learnt::NOTHING;
        (0..200_000).for_each(|_| learnt.add(7, 3.0));
        let mean = learnt.squares[7] / f32::from(learnt.rays[7]);
        assert!((mean - 9.0).abs() < 1e-2, "the mean stays: {mean}");
    }
}
