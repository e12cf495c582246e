//! Names of antialiasing for command lines and files: `4x4`, `4x4:bartlett`, `3x3-jittered@0.1:mitchell`.

use super::{Antialiasing, Factor, Filter, Pattern};
use core::fmt;
use core::str::FromStr;

/// What was given is not the name of an antialiasing.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AntialiasingError {
    /// The number of samples cannot be read or is out of range.
    #[error(
        "'{0}' is no number of samples per pixel; write 1x1, 2x2, ... {max}x{max}, for example 4x4:bartlett",
        max = Factor::MAX
    )]
    Factor(String),
    /// There is no such pattern.
    #[error(
        "there is no sampling pattern '{0}'; write 4x4 (regular), 4x4-jittered or 4x4-jittered@0.125 (at most 0.125 pixels)"
    )]
    Pattern(String),
    /// There is no such filter.
    #[error(
        "there is no filter '{0}'; there are box, bartlett (of the width that fits), bartlett-3x3, -5x5, -7x7, ..., gaussian, mitchell, blackman-harris, lanczos"
    )]
    Filter(String),
}

/// Filters of one width, with their names.
const NAMES: [(&str, Filter); 5] = [
    ("box", Filter::Box),
    ("gaussian", Filter::Gaussian),
    ("mitchell", Filter::Mitchell),
    ("blackman-harris", Filter::BlackmanHarris),
    ("lanczos", Filter::Lanczos),
];

/// `none`, or `FACTOR[-jittered[@BOUND]][:FILTER]` where `FACTOR` is `4x4` or `4`, and `BOUND` is in pixels.
///
/// Without a filter all samples of a pixel count alike (`box`); the seed of jitter is 0.
impl FromStr for Antialiasing {
    type Err = AntialiasingError;

    fn from_str(name: &str) -> Result<Self, AntialiasingError> {
        if name == "none" {
            return Ok(Self::NONE);
        }
        let (grid, filter) = name.split_once(':').unwrap_or((name, "box"));
        let (factor, pattern) = match grid.split_once('-') {
            Some((factor, pattern)) => (factor, parse_pattern(pattern)?),
            None => (grid, Pattern::Regular),
        };
        let factor = parse_factor(factor)?;
        Ok(Self {
            pattern,
            factor,
            filter: parse_filter(filter, factor)?,
        })
    }
}

fn parse_factor(text: &str) -> Result<Factor, AntialiasingError> {
    let error = || AntialiasingError::Factor(text.to_owned());
    square(text).and_then(Factor::new).ok_or_else(error)
}

/// The number of `4x4` or `4`.
fn square(text: &str) -> Option<usize> {
    let (across, down) = text.split_once('x').unwrap_or((text, text));
    let side = across.parse().ok()?;
    (down.parse() == Ok(side)).then_some(side)
}

fn parse_pattern(text: &str) -> Result<Pattern, AntialiasingError> {
    let error = || AntialiasingError::Pattern(text.to_owned());
    let bound = match text.strip_prefix("jittered").ok_or_else(error)? {
        "" => Pattern::JITTER,
        bound => {
            let bound = bound.strip_prefix('@').and_then(|b| b.parse().ok());
            bound
                .filter(|b| (0.0..=1.0).contains(b))
                .ok_or_else(error)?
        }
    };
    Ok(Pattern::Jittered { bound, seed: 0 })
}

fn parse_filter(text: &str, factor: Factor) -> Result<Filter, AntialiasingError> {
    let error = || AntialiasingError::Filter(text.to_owned());
    if let Some(&(_, filter)) = NAMES.iter().find(|(name, _)| *name == text) {
        return Ok(filter);
    }
    let width = text.strip_prefix("bartlett").ok_or_else(error)?;
    if width.is_empty() {
        return Ok(Filter::for_factor(factor));
    }
    let taps = width.strip_prefix('-').and_then(square);
    let odd = taps.filter(|taps| taps % 2 == 1).ok_or_else(error)?;
    let factor = Factor::new(odd / 2 + 1).ok_or_else(error)?;
    Ok(Filter::Bartlett { factor })
}

/// The name from which the same antialiasing can be read, but for the seed of its jitter.
impl fmt::Display for Antialiasing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let k = self.factor.get();
        write!(f, "{k}x{k}")?;
        match self.pattern {
            Pattern::Regular => {}
            Pattern::Jittered { bound, .. } if bound == Pattern::JITTER => write!(f, "-jittered")?,
            Pattern::Jittered { bound, .. } => write!(f, "-jittered@{bound}")?,
        }
        match self.filter {
            Filter::Box => Ok(()),
            filter => write!(f, ":{filter}"),
        }
    }
}

/// Its name; a Bartlett filter tells its width.
impl fmt::Display for Filter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bartlett { factor } => {
                let taps = 2 * factor.get() - 1;
                write!(f, "bartlett-{taps}x{taps}")
            }
            fixed => {
                let name = NAMES.iter().find(|(_, filter)| filter == fixed);
                f.write_str(name.map_or("", |(name, _)| name))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        for name in [
            "1x1",
            "4x4",
            "2x2:bartlett-3x3",
            "4x4:bartlett-3x3",
            "3x3-jittered",
            "32x32-jittered@0.125:blackman-harris",
            "4x4-jittered@0:lanczos",
            "5x5:gaussian",
            "7x7-jittered:mitchell",
        ] {
            let read: Antialiasing = name.parse().expect(name);
            assert_eq!(read.to_string(), name, "written again");
        }
    }

    #[test]
    fn short_names_stand_for_long_ones() {
        for (short, long) in [
            ("none", "1x1"),
            ("4", "4x4:box"),
            ("3:bartlett", "3x3:bartlett-5x5"),
            ("4x4:bartlett", "4x4:bartlett-7x7"),
            ("2-jittered", "2x2-jittered"),
        ] {
            let read = |name: &str| name.parse::<Antialiasing>().expect(name);
            assert_eq!(read(short), read(long), "{short}");
        }
        assert_eq!(
            "4x4:bartlett".parse(),
            Ok(Antialiasing::default()),
            "default"
        );
    }

    #[test]
    fn what_is_no_name_is_told_what_is() {
        for (name, word) in [
            ("", "4x4"),
            ("0x0", "4x4"),
            ("33", "32x32"),
            ("4x3", "4x4"),
            ("-1", "jittered"),
            ("4x4x4", "4x4"),
            ("99999999999999999999", "4x4"),
            ("4x4-random", "jittered"),
            ("4x4-jittered@", "jittered@"),
            ("4x4-jittered@NaN", "jittered@"),
            ("4x4-jittered@2", "jittered@"),
            ("4x4:", "mitchell"),
            ("4x4:bartlett-4x4", "bartlett"),
            ("4x4:bartlett-999x999", "bartlett"),
            ("4x4:tent", "lanczos"),
        ] {
            let error = name.parse::<Antialiasing>().expect_err(name).to_string();
            assert!(error.contains(word), "'{word}' in '{error}'");
            assert!(!error.contains('\n'), "one line: {error}");
        }
    }
}
