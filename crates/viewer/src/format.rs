//! Numbers as people read them.

/// Three significant digits, with thousands apart: `0.0123`, `1.23`, `12.3`, `1 230`.
pub fn number(x: f64) -> String {
    if !x.is_finite() {
        return String::from("–");
    }
    let magnitude = x.abs();
    if magnitude == 0.0 {
        return String::from("0");
    }
    if !(1e-4..1e7).contains(&magnitude) {
        return format!("{x:.2e}");
    }
    let digits = magnitude.log10().floor();
    if digits >= 2.0 {
        return thousands(x.round());
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 1 to 6"
    )]
    let decimals = (2.0 - digits) as usize;
    format!("{x:.decimals$}")
}

/// A whole number with thin spaces between thousands.
pub fn thousands(x: f64) -> String {
    let digits = format!("{:.0}", x.abs());
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    if x < 0.0 { format!("-{text}") } else { text }
}

/// A share as percents, small ones with their exponent: `12 %`, `0.34 %`, `2.0e-5`.
pub fn share(x: f64) -> String {
    match x.abs() {
        x if !x.is_finite() => String::from("–"),
        a if a >= 0.1 => format!("{:.0} %", 100.0 * x),
        a if a >= 0.01 => format!("{:.1} %", 100.0 * x),
        a if a >= 1e-4 => format!("{:.2} %", 100.0 * x),
        0.0 => String::from("0 %"),
        _ => format!("{x:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_and_thousands_apart() {
        let cases = [
            (0.0, "0"),
            (0.012_345, "0.0123"),
            (1.234, "1.23"),
            (-12.34, "-12.3"),
            (123.4, "123"),
            (12_345.6, "12\u{2009}346"),
            (1.5e9, "1.50e9"),
            (f64::NAN, "–"),
        ];
        for (x, text) in cases {
            assert_eq!(number(x), text, "{x}");
        }
    }

    #[test]
    fn shares_stay_readable() {
        for (x, text) in [
            (1.0, "100 %"),
            (0.0345, "3.5 %"),
            (0.00123, "0.12 %"),
            (2e-5, "2.0e-5"),
            (0.0, "0 %"),
        ] {
            assert_eq!(share(x), text, "{x}");
        }
    }
}
