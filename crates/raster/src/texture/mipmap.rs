//! Mip levels: each from the one before, by filters that are exact for every size.
//!
//! A side of `n` texels becomes `max(1, n / 2)`, rounded down, as every graphics interface has it. Where `n` is odd, a
//! texel of the smaller level is `n / (n / 2)` texels wide, between two and three, and texels on its edges count with the
//! part that lies inside (polyphase box filter, Guthe and Heckbert 2005). So every texel of the picture has the same
//! total weight in each level, and the mean is kept.

use super::chain::{Alpha, TextureOptions};
use super::texel::{Level, Texel};
use super::wrap::Wrap;
use crate::sinc::sinc;
use core::f64::consts::PI;
use glam::Vec4;

/// The filter between a level and the next smaller one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum MipFilter {
    /// The mean over the area of the texel: keeps the mean of the picture and never leaves the range of its texels.
    #[default]
    Box,
    /// A sinc under a Kaiser window (alpha 4, three texels of the smaller level to each side): sharper.
    Kaiser,
    /// A sinc under the main lobe of another, three texels to each side: sharpest, with the most ringing.
    Lanczos,
}

/// How many levels a picture has, down to a single texel.
pub(super) fn level_count(width: usize, height: usize) -> usize {
    1 + width.max(height).ilog2() as usize
}

/// Half the side, rounded down, at least 1.
pub(super) fn halved(side: usize) -> usize {
    (side / 2).max(1)
}

/// What a texel along one axis is made of.
pub(super) struct AxisFilter {
    /// Source texel and weight.
    taps: Vec<(usize, f32)>,
    /// Where the taps of each texel end.
    ends: Vec<usize>,
}

impl AxisFilter {
    /// From `from` texels to `to`, at most as many.
    pub(super) fn new(filter: MipFilter, wrap: Wrap, from: usize, to: usize) -> Self {
        let (mut taps, mut ends) = (Vec::new(), Vec::with_capacity(to));
        let wrap = if wrap == Wrap::Border {
            Wrap::ClampToEdge
        } else {
            wrap
        };
        for i in 0..to {
            let start = taps.len();
            if from == to {
                taps.push((i, 1.0));
            } else if filter == MipFilter::Box {
                push_overlaps(&mut taps, i, from, to);
            } else {
                push_windowed_sinc(&mut taps, filter, wrap, i, from, to);
            }
            let sum: f32 = taps[start..].iter().map(|&(_, weight)| weight).sum();
            taps[start..]
                .iter_mut()
                .for_each(|(_, weight)| *weight /= sum);
            ends.push(taps.len());
        }
        Self { taps, ends }
    }

    fn len(&self) -> usize {
        self.ends.len()
    }

    fn taps(&self, i: usize) -> &[(usize, f32)] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.taps[start..self.ends[i]]
    }
}

/// Texel `i` of `to` spans `[i from, (i + 1) from]` in units of `1 / to` source texels: integers, so overlaps are exact.
fn push_overlaps(taps: &mut Vec<(usize, f32)>, i: usize, from: usize, to: usize) {
    let (low, high) = (i * from, (i + 1) * from);
    for source in low / to..high.div_ceil(to) {
        let overlap = high.min((source + 1) * to) - low.max(source * to);
        taps.push((source, overlap as f32 / from as f32));
    }
}

/// Texels of the smaller level that a windowed sinc reaches to each side.
const REACH: f64 = 3.0;

#[expect(
    clippy::cast_possible_truncation,
    reason = "a few texels around the picture; weights are rounded"
)]
fn push_windowed_sinc(
    taps: &mut Vec<(usize, f32)>,
    filter: MipFilter,
    wrap: Wrap,
    i: usize,
    from: usize,
    to: usize,
) {
    let scale = from as f64 / to as f64;
    let centre = (i as f64 + 0.5) * scale - 0.5;
    let (low, high) = (centre - REACH * scale, centre + REACH * scale);
    for source in low.ceil() as i64..=high.floor() as i64 {
        let x = (source as f64 - centre) / scale;
        let window = match filter {
            MipFilter::Kaiser => kaiser(x / REACH),
            _ => sinc(PI * x / REACH),
        };
        if let Some(texel) = wrap.index(source, from) {
            taps.push((texel, (sinc(PI * x) * window) as f32));
        }
    }
}

/// The Kaiser window `I0(4 sqrt(1 - x^2)) / I0(4)`, 0 outside [-1, 1].
fn kaiser(x: f64) -> f64 {
    const ALPHA: f64 = 4.0;
    let inside = 1.0 - x * x;
    if inside < 0.0 {
        0.0
    } else {
        bessel_i0(ALPHA * inside.sqrt()) / bessel_i0(ALPHA)
    }
}

/// The modified Bessel function of order 0: `sum ((x/2)^k / k!)^2`.
fn bessel_i0(x: f64) -> f64 {
    let (mut sum, mut term) = (1.0, 1.0);
    for k in 1..40 {
        term *= x / (2.0 * f64::from(k));
        sum += term * term;
    }
    sum
}

/// A smaller copy of a level, one filter for each axis.
pub(super) fn resampled<T: Texel>(
    source: &Level<T>,
    codec: T::Codec,
    columns: &AxisFilter,
    rows: &AxisFilter,
) -> Level<Vec4> {
    let (width, height) = (columns.len(), rows.len());
    let mut texels = Vec::with_capacity(width * height);
    let mut row = vec![Vec4::ZERO; source.width];
    for y in 0..height {
        row.fill(Vec4::ZERO);
        for &(from, weight) in rows.taps(y) {
            for (sum, texel) in row.iter_mut().zip(source.row(from)) {
                *sum += texel.decode(codec) * weight;
            }
        }
        let mixed = |x| {
            columns
                .taps(x)
                .iter()
                .map(|&(from, weight)| row[from] * weight)
                .sum::<Vec4>()
        };
        texels.extend((0..width).map(mixed));
    }
    Level {
        width,
        height,
        texels,
    }
}

/// How the levels of one texture are made.
pub(super) struct Reduction {
    filter: MipFilter,
    wrap: [Wrap; 2],
    alpha: Alpha,
    /// The alpha above which a texel counts as there, and the share of such texels in the picture.
    coverage: Option<(f32, f64)>,
}

impl Reduction {
    pub(super) fn new<T: Texel>(
        options: &TextureOptions,
        base: &Level<T>,
        codec: T::Codec,
    ) -> Self {
        let is_above = |cutoff: f32| {
            base.texels
                .iter()
                .filter(move |t| t.decode(codec).w > cutoff)
                .count()
        };
        Self {
            filter: options.filter,
            wrap: options.wrap,
            alpha: options.alpha,
            coverage: options
                .cutoff
                .map(|cutoff| (cutoff, is_above(cutoff) as f64 / base.texels.len() as f64)),
        }
    }

    /// The next level, not rounded.
    pub(super) fn reduced<T: Texel>(&self, source: &Level<T>, codec: T::Codec) -> Level<Vec4> {
        let filter =
            |axis: usize, side| AxisFilter::new(self.filter, self.wrap[axis], side, halved(side));
        let mut level = resampled(
            source,
            codec,
            &filter(0, source.width),
            &filter(1, source.height),
        );
        if self.alpha == Alpha::Coverage && self.filter != MipFilter::Box {
            // The negative lobes of a sinc leave the range of colours.
            for texel in &mut level.texels {
                *texel = texel.max(Vec4::ZERO);
                texel.w = texel.w.min(1.0);
            }
        }
        level
    }

    /// A level as it is stored.
    pub(super) fn stored<T: Texel>(&self, level: &Level<Vec4>, codec: T::Codec) -> Level<T> {
        let scale = self
            .coverage
            .map_or(1.0, |(cutoff, share)| alpha_scale(level, cutoff, share));
        level.mapped(|&texel| T::encode(with_alpha_scaled(texel, scale), codec))
    }
}

/// The factor that brings a share of a level's texels above the cutoff: the cutoff lies half-way between the alphas of
/// the last texel above and the first below. Texels of equal alpha cannot be told apart; 1 if there is nothing to keep.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a count of texels"
)]
fn alpha_scale(level: &Level<Vec4>, cutoff: f32, share: f64) -> f32 {
    let above = (share * level.texels.len() as f64).round() as usize;
    if above == 0 || cutoff.is_nan() || cutoff <= 0.0 {
        return 1.0;
    }
    let mut alphas: Vec<f32> = level.texels.iter().map(|t| t.w).collect();
    let (_, &mut last, below) = alphas.select_nth_unstable_by(above - 1, |a, b| b.total_cmp(a));
    let next = below.iter().copied().fold(0.0, f32::max);
    let threshold = 0.5 * (last + next);
    if threshold > 0.0 {
        cutoff / threshold
    } else {
        1.0
    }
}

/// Alpha times a factor, at most 1; the straight colour stays.
fn with_alpha_scaled(texel: Vec4, scale: f32) -> Vec4 {
    let alpha = (texel.w * scale).min(1.0);
    if texel.w > 0.0 {
        (texel * (alpha / texel.w)).with_w(alpha)
    } else {
        texel
    }
}
