//! Interval lists along a ray and their set operations, after Roth, *Ray casting for modeling solids* (CGIP 18, 1982).
//!
//! A solid meets a line in spans. Sets of points combine along a line as they do in space, so the spans of `A - B`
//! follow from those of A and B by one walk over the ends of both in order, which keeps in mind whether it is inside A
//! and inside B. No surface is ever intersected with another one.
//!
//! Ends that [coincide] are crossed together. Surfaces that lie on each other so leave neither a skin without
//! thickness, where one solid is cut along the face of another, nor a gap where two are glued together, and the
//! boundary is always that of the first operand. This is the *regularised* set operation of Requicha (1980).

use crate::leaf::Leaf;

/// One end of a span.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Boundary<'a> {
    /// Distance from the ray's origin; may be infinite.
    pub t: f64,
    /// Whose surface it is; none at infinity.
    pub leaf: Option<&'a Leaf>,
}

/// Ends of spans in ascending order, entering ones at even places. Lists of several solids lie behind one another, so
/// that casting a ray allocates nothing once the vector has grown.
pub(crate) type Boundaries<'a> = Vec<Boundary<'a>>;

/// How two solids are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Operation {
    Union,
    Intersection,
    Difference,
}

impl Operation {
    pub(crate) fn is_inside(self, a: bool, b: bool) -> bool {
        match self {
            Self::Union => a || b,
            Self::Intersection => a && b,
            Self::Difference => a && !b,
        }
    }
}

/// Ends closer than this, relative to `1 + |t|`, are one.
pub(crate) const COINCIDENT: f64 = 1e-9;

/// Whether two ends are so close that rounding decides their order.
fn coincide(a: f64, b: f64) -> bool {
    // The bound keeps infinite ends apart from others.
    a == b || (b - a).abs() <= COINCIDENT * (1.0 + a.abs()).min(1e9)
}

/// Replaces the lists `first..second` and `second..` by that of their combination.
pub(crate) fn combine(
    operation: Operation,
    list: &mut Boundaries<'_>,
    first: usize,
    second: usize,
) {
    let end = list.len();
    if first == second || second == end {
        let is_kept = match operation {
            Operation::Union => true,
            Operation::Intersection => false,
            Operation::Difference => second == end,
        };
        list.truncate(if is_kept { end } else { first });
        return;
    }
    let (mut i, mut j) = (first, second);
    while i < second || j < end {
        let (a, b) = (list[i.min(second - 1)], list[j.min(end - 1)]);
        let is_both = i < second && j < end && coincide(a.t, b.t);
        let is_a = is_both || j == end || (i < second && a.t < b.t);
        i += usize::from(is_a);
        j += usize::from(is_both || !is_a);
        let is_inside = operation.is_inside((i - first) % 2 == 1, (j - second) % 2 == 1);
        cross(list, end, if is_a { a } else { b }, is_inside);
    }
    list.drain(first..end);
}

/// Notes that the walk comes inside or outside at a place, in the list from `start` on.
fn cross<'a>(list: &mut Boundaries<'a>, start: usize, at: Boundary<'a>, is_inside: bool) {
    let was_inside = (list.len() - start) % 2 == 1;
    if is_inside == was_inside {
        return;
    }
    let follows_closely = list[start..].last().is_some_and(|b| coincide(b.t, at.t));
    if follows_closely {
        list.pop();
    } else {
        list.push(at);
    }
}

/// Replaces the list from `first` on by that of the points outside.
pub(crate) fn complement(list: &mut Boundaries<'_>, first: usize) {
    let infinite = |t| Boundary { t, leaf: None };
    let starts_inside = list.get(first).is_some_and(|b| b.t == f64::NEG_INFINITY);
    if starts_inside {
        list.remove(first);
    } else {
        list.insert(first, infinite(f64::NEG_INFINITY));
    }
    let ends_inside = list[first..].last().is_some_and(|b| b.t == f64::INFINITY);
    if ends_inside {
        list.pop();
    } else {
        list.push(infinite(f64::INFINITY));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn combined(operation: Operation, a: &[f64], b: &[f64]) -> Vec<f64> {
        let boundary = |&t: &f64| Boundary { t, leaf: None };
        let before = [boundary(&7.0), boundary(&8.0)];
        let mut list: Vec<_> = before.into_iter().chain(a.iter().map(boundary)).collect();
        let second = list.len();
        list.extend(b.iter().map(boundary));
        combine(operation, &mut list, 2, second);
        assert_eq!(
            (list[0].t, list[1].t),
            (7.0, 8.0),
            "what lies before is left alone"
        );
        list[2..].iter().map(|b| b.t).collect()
    }

    const INF: f64 = f64::INFINITY;

    #[test]
    fn spans_combine_as_sets() {
        let (a, b) = ([1.0, 4.0, 6.0, 9.0], [3.0, 7.0]);
        assert_eq!(combined(Operation::Union, &a, &b), [1.0, 9.0], "union");
        assert_eq!(
            combined(Operation::Intersection, &a, &b),
            [3.0, 4.0, 6.0, 7.0],
            "intersection"
        );
        assert_eq!(
            combined(Operation::Difference, &a, &b),
            [1.0, 3.0, 7.0, 9.0],
            "difference"
        );
        assert_eq!(
            combined(Operation::Difference, &b, &a),
            [4.0, 6.0],
            "the other way round"
        );
    }

    #[test]
    fn empty_lists_combine() {
        let a = [1.0, 2.0];
        assert_eq!(combined(Operation::Union, &[], &a), a, "nothing and a");
        assert_eq!(combined(Operation::Union, &a, &[]), a, "a and nothing");
        assert_eq!(
            combined(Operation::Difference, &a, &[]),
            a,
            "a without nothing"
        );
        assert!(
            combined(Operation::Difference, &[], &a).is_empty(),
            "nothing without a"
        );
        assert!(
            combined(Operation::Intersection, &a, &[]).is_empty(),
            "in both"
        );
    }

    #[test]
    fn coincident_surfaces_leave_no_skin_and_no_gap() {
        let (a, b) = ([1.0, 2.0], [2.0 + 1e-15, 3.0]);
        assert_eq!(combined(Operation::Union, &a, &b), [1.0, 3.0], "glued");
        assert!(
            combined(Operation::Intersection, &a, &b).is_empty(),
            "no skin"
        );
        let same = [1.0 + 1e-14, 2.0 - 1e-14];
        assert!(
            combined(Operation::Difference, &a, &same).is_empty(),
            "nothing is left"
        );
        let deeper = [1.0 - 1e-14, 1.5];
        assert_eq!(
            combined(Operation::Difference, &a, &deeper),
            [1.5, 2.0],
            "cut from its face on"
        );
    }

    #[test]
    fn spans_may_be_infinite() {
        let (below, above) = ([-INF, 1.0], [0.0, INF]);
        assert_eq!(
            combined(Operation::Union, &below, &above),
            [-INF, INF],
            "union"
        );
        assert_eq!(
            combined(Operation::Intersection, &below, &above),
            [0.0, 1.0],
            "intersection"
        );
        assert_eq!(
            combined(Operation::Difference, &[-INF, INF], &above),
            [-INF, 0.0],
            "difference"
        );
    }

    #[test]
    fn complement_of_the_complement_is_the_list() {
        for list in [
            &[][..],
            &[1.0, 2.0],
            &[-INF, 1.0, 3.0, 4.0],
            &[2.0, INF],
            &[-INF, INF],
        ] {
            let mut spans: Vec<_> = list.iter().map(|&t| Boundary { t, leaf: None }).collect();
            complement(&mut spans, 0);
            let inside =
                |spans: &[Boundary<'_>], t: f64| spans.iter().filter(|b| b.t < t).count() % 2 == 1;
            assert!(
                list.is_empty() || inside(&spans, 2.5) || list[1] == INF,
                "outside at 2.5"
            );
            complement(&mut spans, 0);
            let back: Vec<f64> = spans.iter().map(|b| b.t).collect();
            assert_eq!(back, list, "twice");
        }
    }
}
