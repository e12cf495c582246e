//! Addressing: which texel an index outside of the texture reads.

use serde::{Deserialize, Serialize};

/// How coordinates outside [0, 1] are brought back (Vulkan specification, texel addressing).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
pub enum Wrap {
    /// The picture repeats: `i mod n`.
    #[default]
    Repeat,
    /// It repeats with every second copy mirrored: `(n - 1) - mirror((i mod 2n) - n)`, with `mirror(i) = i` from 0 on
    /// and `-(1 + i)` below.
    MirroredRepeat,
    /// Its outermost texels go on.
    ClampToEdge,
    /// One mirrored copy below 0, then the outermost texels go on: `clamp(mirror(i))`.
    MirrorOnce,
    /// Outside is one colour, [`Sampler::border`](super::Sampler::border).
    Border,
}

impl Wrap {
    /// All rules, in the order of a textbook.
    pub const ALL: [Self; 5] = [
        Self::Repeat,
        Self::MirroredRepeat,
        Self::ClampToEdge,
        Self::MirrorOnce,
        Self::Border,
    ];

    /// The texel that index `i` of an axis with `size` texels reads; `None` is the border. `size` is at least 1.
    #[inline]
    pub fn index(self, i: i64, size: usize) -> Option<usize> {
        match usize::try_from(i) {
            Ok(inside) if inside < size => Some(inside),
            _ => self.outside(i, size),
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap,
        reason = "sides fit 32 bits and every result lies in 0..size"
    )]
    fn outside(self, i: i64, size: usize) -> Option<usize> {
        let size = size as i64;
        let mirror = |i: i64| if i < 0 { !i } else { i };
        let inside = match self {
            Self::Repeat => i.rem_euclid(size),
            Self::MirroredRepeat => size - 1 - mirror(i.rem_euclid(2 * size) - size),
            Self::ClampToEdge => i.clamp(0, size - 1),
            Self::MirrorOnce => mirror(i).min(size - 1),
            Self::Border => return None,
        };
        Some(inside as usize)
    }

    /// A coordinate that reads the same texels, small enough for integers.
    ///
    /// Periodic rules are reduced to their period first, as Direct3D 11.3 (7.18) demands, so that no digit is lost when
    /// the coordinate is multiplied by the size. The others stop at a thousand million, far from every texel.
    #[inline]
    pub(super) fn reduce(self, u: f64) -> f64 {
        const FAR: f64 = 1e9;
        match self {
            Self::Repeat => u - u.floor(),
            Self::MirroredRepeat => u - 2.0 * (0.5 * u).floor(),
            Self::ClampToEdge | Self::MirrorOnce | Self::Border => u.clamp(-FAR, FAR),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Texels of an axis of three, walked from index -7 to 8; 9 is the border.
    fn walk(wrap: Wrap) -> Vec<usize> {
        (-7..=8).map(|i| wrap.index(i, 3).unwrap_or(9)).collect()
    }

    #[test]
    fn walks_along_three_texels_are_as_drawn_by_hand() {
        let expected = [
            [2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2],
            [0, 0, 1, 2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0, 1, 2],
            [0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2, 2, 2],
            [2, 2, 2, 2, 2, 1, 0, 0, 1, 2, 2, 2, 2, 2, 2, 2],
            [9, 9, 9, 9, 9, 9, 9, 0, 1, 2, 9, 9, 9, 9, 9, 9],
        ];
        for (wrap, expected) in Wrap::ALL.into_iter().zip(expected) {
            assert_eq!(walk(wrap), expected, "{wrap:?}");
        }
    }

    /// The same rules step by step: from a far index to the picture, one copy at a time.
    fn naive(wrap: Wrap, mut i: i64, n: i64) -> Option<i64> {
        while !(0..n).contains(&i) {
            i = match wrap {
                Wrap::Repeat if i < 0 => i + n,
                Wrap::Repeat => i - n,
                Wrap::MirroredRepeat if i < 0 => -1 - i,
                Wrap::MirroredRepeat => 2 * n - 1 - i,
                Wrap::ClampToEdge if i < 0 => 0,
                Wrap::MirrorOnce if i < 0 => -1 - i,
                Wrap::ClampToEdge | Wrap::MirrorOnce => n - 1,
                Wrap::Border => return None,
            };
            if wrap == Wrap::MirroredRepeat && i < -3 * n {
                i += 2 * n;
            }
        }
        Some(i)
    }

    proptest! {
        #[test]
        fn index_is_what_walking_finds(i in -300_i64..300, n in 1_i64..40, rule in 0_usize..5) {
            let wrap = Wrap::ALL[rule];
            let size = usize::try_from(n).expect("n is positive");
            let found = wrap.index(i, size).map(|i| i64::try_from(i).expect("small"));
            prop_assert_eq!(found, naive(wrap, i, n));
        }

        #[test]
        fn reducing_changes_no_texel(quarters in -400_i32..400, n in 1_usize..40, rule in 0_usize..5) {
            // Quarters and whole sizes keep every product exact.
            let (wrap, u) = (Wrap::ALL[rule], f64::from(quarters) / 4.0);
            let index = |u: f64| (u * n as f64).floor();
            #[expect(clippy::cast_possible_truncation, reason = "a few thousand")]
            let texel = |u: f64| wrap.index(index(u) as i64, n);
            prop_assert_eq!(texel(u), texel(wrap.reduce(u)));
        }
    }

    #[test]
    fn reduced_coordinates_are_small() {
        for wrap in Wrap::ALL {
            for u in [f32::MAX, -f32::MAX, 1e20, -1e-30] {
                let reduced = wrap.reduce(f64::from(u));
                assert!(reduced.abs() <= 1e9, "{wrap:?} of {u}: {reduced}");
            }
        }
    }
}
