//! Axes: from numbers to pixels, with ticks at numbers that people like.

/// An axis as it is drawn.
#[derive(Debug, Clone)]
pub struct Axis {
    low: f64,
    high: f64,
    is_log: bool,
    /// Pixels of both ends.
    ends: [f64; 2],
    /// Pixel and label.
    pub ticks: Vec<(f64, String)>,
}

impl Axis {
    /// The pixel of a number.
    pub fn place(&self, number: f64) -> f64 {
        let number = if self.is_log { number.log10() } else { number };
        let share = (number - self.low) / (self.high - self.low);
        self.ends[0] + share * (self.ends[1] - self.ends[0])
    }

    fn with_ticks(mut self, numbers: impl Iterator<Item = (f64, String)>) -> Self {
        self.ticks = numbers.map(|(x, label)| (self.place(x), label)).collect();
        self
    }
}

/// Smallest and largest number; 0 and 1 if there is none.
fn bounds(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = numbers.fold(start, |(low, high), x| (low.min(x), high.max(x)));
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

/// Numbers at equal distances from pixel `start` to pixel `end`; counts stay whole.
pub fn linear_axis(numbers: impl Iterator<Item = f64>, start: f64, end: f64) -> Axis {
    let numbers: Vec<f64> = numbers.collect();
    let is_whole = numbers.iter().all(|x| x.fract() == 0.0);
    let (low, high) = bounds(numbers.into_iter());
    let least_span = if is_whole {
        1.0
    } else {
        (1e-9 * low.abs().max(high.abs())).max(f64::MIN_POSITIVE)
    };
    let high = high.max(low + least_span);
    let least_step = (high - low) / 7.0;
    let step = nice_step(if is_whole {
        least_step.max(1.0)
    } else {
        least_step
    });
    let axis = Axis {
        low,
        high,
        is_log: false,
        ends: [start, end],
        ticks: Vec::new(),
    };
    let first = (low / step).ceil();
    let ticks = (0..=20_u32)
        .map(|i| (first + f64::from(i)) * step)
        .take_while(|&x| x <= high + 1e-9 * step);
    axis.with_ticks(ticks.map(|x| (x, number(x, step))))
}

/// 1, 2 or 5 times a power of ten, at least this.
fn nice_step(least: f64) -> f64 {
    let unit = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * unit)
        .find(|&step| step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * unit)
}

/// A number with as many decimals as its distance to the next one asks for, thousands set off by commas.
fn number(x: f64, step: f64) -> String {
    if !(1e-6..1e9).contains(&step) {
        return format!("{x:e}");
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and 6"
    )]
    let decimals = (-(step * 1.000_001).log10().floor()).max(0.0) as usize;
    let text = format!("{:.decimals$}", x.abs());
    let (whole, rest) = text.split_once('.').unwrap_or((&text, ""));
    let mut grouped = String::new();
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    let is_zero = text.chars().all(|c| matches!(c, '0' | '.'));
    let sign = if x < 0.0 && !is_zero { "-" } else { "" };
    let point = if rest.is_empty() { "" } else { "." };
    format!("{sign}{grouped}{point}{rest}")
}

/// Numbers above 0 on a logarithmic scale from the smallest to the largest, from pixel `start` to pixel `end`. Ticks are
/// powers of ten, with 2 and 5 times such where there is room, or powers of two.
pub fn log_number_axis(
    numbers: impl Iterator<Item = f64>,
    base: LogBase,
    start: f64,
    end: f64,
) -> Axis {
    let (low, high) = bounds(numbers);
    let [low, high] = [low.max(1e-300), high.max(1e-300)];
    // One number alone has a place in the middle.
    let (low, high) = if high > low * (1.0 + 1e-9) {
        (low, high)
    } else {
        (low / 2.0, low * 2.0)
    };
    let axis = Axis {
        low: low.log10(),
        high: high.log10(),
        is_log: true,
        ends: [start, end],
        ticks: Vec::new(),
    };
    let is_within = |x: &f64| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(x);
    let ticks: Vec<f64> = base
        .ticks(low, high)
        .into_iter()
        .filter(is_within)
        .collect();
    axis.with_ticks(ticks.into_iter().map(|x| (x, plain(x))))
}

/// What the ticks of a logarithmic axis of numbers are powers of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogBase {
    Two,
    Ten,
}

impl LogBase {
    /// Numbers for ticks from about `low` to about `high`, some beyond.
    fn ticks(self, low: f64, high: f64) -> Vec<f64> {
        let base: f64 = match self {
            Self::Two => 2.0,
            Self::Ten => 10.0,
        };
        let [first, last] = [low, high].map(|x| x.ln() / base.ln());
        let every = ((last - first) / 9.0).ceil().max(1.0);
        let between: &[f64] = if self == Self::Ten && last - first <= 4.0 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        let mut ticks = Vec::new();
        let mut power = (first.floor() / every).floor() * every;
        while power <= last + 1e-9 {
            ticks.extend(between.iter().map(|factor| factor * base.powf(power)));
            power += every;
        }
        ticks
    }
}

/// A tick's number without noise.
fn plain(x: f64) -> String {
    match x {
        1.0..1e6 => number(x, 1.0),
        1e-4..1.0 => format!("{x:.6}").trim_end_matches('0').to_owned(),
        _ => format!("{x:.0e}"),
    }
}

/// Shares above 0 on a logarithmic scale, from pixel `start` to pixel `end`, labelled in percent.
pub fn log_axis(numbers: impl Iterator<Item = f64>, start: f64, end: f64) -> Axis {
    let (low, high) = bounds(numbers);
    let low = low.max(1e-300).log10();
    let high = high.max(1e-300).log10();
    // Whole decades, at least one.
    let top = (high - 1e-9).ceil();
    let bottom = (low + 1e-9).floor().min(top - 1.0);
    let decades = top - bottom;
    let axis = Axis {
        low: bottom,
        high: top,
        is_log: true,
        ends: [start, end],
        ticks: Vec::new(),
    };
    let every = (decades / 8.0).ceil().max(1.0);
    let between: &[f64] = if decades <= 2.0 {
        &[1.0, 2.0, 5.0]
    } else {
        &[1.0]
    };
    let mut ticks = Vec::new();
    let mut decade = bottom;
    while decade <= top {
        let shares = between.iter().map(|factor| factor * 10_f64.powf(decade));
        ticks.extend(shares.filter(|share| share.log10() <= top + 1e-9));
        decade += every;
    }
    axis.with_ticks(ticks.into_iter().map(|share| (share, in_percent(share))))
}

fn in_percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent > 0.9e-3 {
        // At most one digit that is not 0, so this prints without noise.
        let text = format!("{percent:.3}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        format!("{text} %")
    } else {
        format!("{percent:.0e} %")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn ticks_are_numbers_that_people_like() {
        let steps = linear_axis([0.0, 100.0].into_iter(), 0.0, 100.0);
        assert_eq!(labels(&steps), ["0", "20", "40", "60", "80", "100"]);
        let many = linear_axis([0.0, 3210.0].into_iter(), 0.0, 100.0);
        assert_eq!(
            labels(&many),
            ["0", "500", "1,000", "1,500", "2,000", "2,500", "3,000"]
        );
        let few = linear_axis([0.0, 3.0].into_iter(), 0.0, 100.0);
        assert_eq!(labels(&few), ["0", "1", "2", "3"]);
        let fine = linear_axis([-0.2, 0.31].into_iter(), 0.0, 100.0);
        assert_eq!(labels(&fine), ["-0.2", "-0.1", "0.0", "0.1", "0.2", "0.3"]);
        let same = linear_axis([0.25; 3].into_iter(), 0.0, 100.0);
        assert!(same.place(0.25).is_finite(), "one value has a place");
        let shares = log_axis([1.0, 3e-4].into_iter(), 100.0, 0.0);
        assert_eq!(labels(&shares), ["0.01 %", "0.1 %", "1 %", "10 %", "100 %"]);
        let narrow = log_axis([0.9, 0.4].into_iter(), 100.0, 0.0);
        assert_eq!(labels(&narrow), ["10 %", "20 %", "50 %", "100 %"]);
        let deep = log_axis([1.0, 1e-12].into_iter(), 100.0, 0.0);
        assert_eq!(
            labels(&deep),
            [
                "1e-10 %", "1e-8 %", "1e-6 %", "1e-4 %", "0.01 %", "1 %", "100 %"
            ]
        );
    }

    #[test]
    fn numbers_on_a_logarithmic_axis_are_themselves() {
        let places = |numbers: &[f64], base| {
            let axis = log_number_axis(numbers.iter().copied(), base, 0.0, 100.0);
            let labels: Vec<String> = labels(&axis).into_iter().map(String::from).collect();
            labels.join(" ")
        };
        let octaves = [1.0, 64.0];
        assert_eq!(places(&octaves, LogBase::Two), "1 2 4 8 16 32 64");
        let metres = [3.6, 187.0];
        assert_eq!(places(&metres, LogBase::Ten), "5 10 20 50 100");
        assert_eq!(places(&[0.02, 0.5], LogBase::Ten), "0.02 0.05 0.1 0.2 0.5");
        assert_eq!(places(&[0.25, 2.0], LogBase::Two), "0.25 0.5 1 2");
        let wide = [1.0, 65_536.0];
        assert_eq!(
            places(&wide, LogBase::Two),
            "1 4 16 64 256 1,024 4,096 16,384 65,536"
        );
        assert_eq!(places(&[8.0], LogBase::Two), "4 8 16");
        let axis = log_number_axis([1.0, 16.0].into_iter(), LogBase::Two, 0.0, 100.0);
        assert!((axis.place(4.0) - 50.0).abs() < 1e-9, "the middle");
    }

    #[test]
    fn ends_are_where_they_belong() {
        let axis = log_axis([1.0, 1e-3].into_iter(), 400.0, 100.0);
        assert_eq!(
            (axis.place(1.0), axis.place(1e-3)),
            (100.0, 400.0),
            "both ends"
        );
        assert!((axis.place(0.1) - 200.0).abs() < 1e-9, "a third of the way");
    }
}
