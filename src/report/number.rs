//! Numbers as text: significant digits, SI prefixes, axis ticks.

/// A dash for what is missing.
pub const MISSING: &str = "–";

/// Three significant digits (or as asked), no exponent between 1e-4 and 1e6, true minus sign, thin spaces in
/// groups of three. Not-a-number is a dash.
pub fn significant(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return MISSING.into();
    }
    if x == 0.0 {
        return "0".into();
    }
    let exponent = x.abs().log10().floor() as i32;
    if !(-4..6).contains(&exponent) {
        let text = format!("{:.*e}", digits.saturating_sub(1), x);
        let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{} · 10{}", minus(mantissa), superscript(power));
    }
    let mut decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    // Rounding may carry into a new digit: 9.999 with three digits is 10.0.
    let rounded: f64 = format!("{x:.decimals$}").parse().unwrap_or(x);
    if rounded.abs().log10().floor() as i32 > exponent {
        decimals = decimals.saturating_sub(1);
    }
    fixed(x, decimals)
}

/// A fixed number of decimals with grouped thousands and a true minus sign.
pub fn fixed(x: f64, decimals: usize) -> String {
    if !x.is_finite() {
        return MISSING.into();
    }
    let text = format!("{:.*}", decimals, x.abs());
    let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
    let mut out = String::new();
    if x < 0.0 && text.bytes().any(|b| (b'1'..=b'9').contains(&b)) {
        out.push('−');
    }
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && whole.len() > 4 && (whole.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    if !fraction.is_empty() {
        out.push('.');
        out.push_str(fraction);
    }
    out
}

/// A count with grouped thousands.
pub fn count(n: u64) -> String {
    fixed(n as f64, 0)
}

fn minus(text: &str) -> String {
    text.replace('-', "−")
}

fn superscript(power: &str) -> String {
    power
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            d @ '4'..='9' => char::from_u32('⁴' as u32 + d as u32 - '4' as u32).unwrap_or(d),
            _ => '⁰',
        })
        .collect()
}

/// Factor and unit with the prefix that suits the largest number: `(1e-3, "kN m")`.
pub fn prefixed(max_abs: f64, unit: &str) -> (f64, String) {
    match max_abs {
        x if x >= 2e9 => (1e-9, format!("G{unit}")),
        x if x >= 2e6 => (1e-6, format!("M{unit}")),
        x if x >= 2e3 => (1e-3, format!("k{unit}")),
        _ => (1.0, unit.into()),
    }
}

/// A duration with a readable unit.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() => MISSING.into(),
        s if s < 1e-3 => format!("{} µs", significant(s * 1e6, 3)),
        s if s < 1.0 => format!("{} ms", significant(s * 1e3, 3)),
        s if s < 120.0 => format!("{} s", significant(s, 3)),
        s if s < 7200.0 => format!("{} min", significant(s / 60.0, 3)),
        s => format!("{} h", significant(s / 3600.0, 3)),
    }
}

/// An axis: a range that ends at ticks, and the ticks with their labels.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Lower end.
    pub min: f64,
    /// Upper end.
    pub max: f64,
    /// Tick positions and labels.
    pub ticks: Vec<(f64, String)>,
}

/// Least distance of ticks that are labelled with decimals.
const LEAST_STEP: f64 = 1e-6;

/// Ticks at 1, 2 or 5 times a power of ten, about `wanted` of them. `tight` keeps the data's own ends.
pub fn axis(min: f64, max: f64, wanted: usize, tight: bool) -> Axis {
    let (mut min, mut max) = if min.is_finite() && max.is_finite() { (min, max) } else { (0.0, 1.0) };
    if max - min <= 1e-12 * min.abs().max(max.abs()).max(1e-12) {
        let pad = if min == 0.0 { 1.0 } else { 0.5 * min.abs() };
        (min, max) = (min - pad, max + pad);
    }
    let raw = (max - min) / wanted.max(1) as f64;
    let power = 10_f64.powf(raw.log10().floor());
    let step =
        [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= raw * 0.999).unwrap_or(raw);
    // data that end a little before a tick, as drifts of 0.9999 % do, reach it, and those that end a little behind it need no other one
    let near = 0.01;
    let (first, last) = if tight {
        ((min / step - near).ceil() as i64, (max / step + near).floor() as i64)
    } else {
        ((min / step + near).floor() as i64, (max / step - near).ceil() as i64)
    };
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    // of smaller steps decimals would be zeros
    let label = |x: f64| if step < LEAST_STEP { significant(x, 2) } else { fixed(x, decimals) };
    let ticks = (first..=last).map(|k| (k as f64 * step, label(k as f64 * step))).collect();
    let ends = (first as f64 * step, last as f64 * step);
    (min, max) = if tight { (min.min(ends.0), max.max(ends.1)) } else { ends };
    Axis { min, max, ticks }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_survive_rounding_up_and_extremes() {
        assert_eq!(significant(9.999, 3), "10.0");
        assert_eq!(significant(0.040_36, 3), "0.0404");
        assert_eq!(significant(-1234.5, 3), "−1234");
        assert_eq!(significant(123_456.0, 3), "123\u{202f}456");
        assert_eq!(significant(2.5e-7, 2), "2.5 · 10⁻⁷");
        assert_eq!(significant(f64::NAN, 3), MISSING);
        assert_eq!(fixed(-0.0004, 2), "0.00");
    }

    #[test]
    fn ticks_are_round_and_enclose_the_data() {
        let a = axis(-0.13, 7.2, 5, false);
        assert!(a.min <= -0.13 && a.max >= 7.2);
        assert_eq!(a.ticks.iter().map(|t| t.1.as_str()).collect::<Vec<_>>(), ["−2", "0", "2", "4", "6", "8"]);
        let t = axis(0.0, 2.5, 5, true);
        assert_eq!((t.min, t.max, t.ticks.len()), (0.0, 2.5, 6));
        let drift = axis(-0.9999, 0.999_95, 4, true);
        assert_eq!((drift.min, drift.max), (-1.0, 1.0));
        assert_eq!(drift.ticks.first().map(|t| t.1.as_str()), Some("−1.0"));
        let fall = axis(-7.9, 0.004, 4, false);
        assert_eq!((fall.min, fall.max), (-8.0, 0.0), "no room for what is not seen");
        let noise = axis(0.0, 7e-13, 4, false);
        assert_eq!((noise.ticks[0].1.as_str(), noise.ticks[1].1.as_str()), ("0", "2.0 · 10⁻¹³"));
        assert!(axis(f64::NAN, 1.0, 5, false).ticks.len() > 2);
        assert!(axis(3.0, 3.0, 5, false).ticks.len() > 2);
    }
}
