//! Quantities written as text with their unit ("400 mm", "30 MPa"), converted to SI.
//!
//! Symbols follow the SI brochure (BIPM, 9th edition, 2019): they are case sensitive ("mm" is a length,
//! "MPa" a stress). Powers may be written "m3", "m^3" or "m³".

use std::fmt;

/// The physical dimension of a number in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// A length, m.
    Length,
    /// A time, s.
    Time,
    /// A force, N.
    Force,
    /// A stress or modulus, Pa.
    Stress,
    /// A density, kg/m³.
    Density,
    /// An angle, rad.
    Angle,
    /// An acceleration, m/s².
    Acceleration,
    /// A rate, 1/s.
    Rate,
    /// A mass, kg.
    Mass,
    /// A pure number.
    Number,
}

impl Dimension {
    /// What it is called in a sentence, with its article.
    pub fn noun(self) -> &'static str {
        match self {
            Self::Length => "a length",
            Self::Time => "a time",
            Self::Force => "a force",
            Self::Stress => "a stress",
            Self::Density => "a density",
            Self::Angle => "an angle",
            Self::Acceleration => "an acceleration",
            Self::Rate => "a rate",
            Self::Mass => "a mass",
            Self::Number => "a number without unit",
        }
    }

    /// Symbol of the SI unit, empty for a pure number.
    pub fn si_symbol(self) -> &'static str {
        match self {
            Self::Length => "m",
            Self::Time => "s",
            Self::Force => "N",
            Self::Stress => "Pa",
            Self::Density => "kg/m3",
            Self::Angle => "rad",
            Self::Acceleration => "m/s2",
            Self::Rate => "1/s",
            Self::Mass => "kg",
            Self::Number => "",
        }
    }

    /// How a value of this dimension may be written.
    pub fn example(self) -> &'static str {
        match self {
            Self::Length => "\"400 mm\"",
            Self::Time => "\"120 ms\"",
            Self::Force => "\"25 kN\"",
            Self::Stress => "\"30 MPa\"",
            Self::Density => "\"2500 kg/m3\"",
            Self::Angle => "\"5 deg\"",
            Self::Acceleration => "\"9.81 m/s2\"",
            Self::Rate => "\"0.25 1/s\"",
            Self::Mass => "\"12 t\"",
            Self::Number => "0.5",
        }
    }

    /// The units of this dimension, in the order in which they are suggested.
    pub fn units(self) -> impl Iterator<Item = &'static Unit> {
        UNITS.iter().filter(move |unit| unit.dimension == self)
    }
}

/// A unit: one of it is `factor` in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Symbol with powers as plain digits.
    pub symbol: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Value of one unit in SI.
    pub factor: f64,
}

const fn unit(symbol: &'static str, dimension: Dimension, factor: f64) -> Unit {
    Unit { symbol, dimension, factor }
}

/// All units that are understood.
pub const UNITS: &[Unit] = &[
    unit("mm", Dimension::Length, 1e-3),
    unit("cm", Dimension::Length, 1e-2),
    unit("m", Dimension::Length, 1.0),
    unit("dm", Dimension::Length, 1e-1),
    unit("km", Dimension::Length, 1e3),
    unit("ms", Dimension::Time, 1e-3),
    unit("s", Dimension::Time, 1.0),
    unit("us", Dimension::Time, 1e-6),
    unit("min", Dimension::Time, 60.0),
    unit("kN", Dimension::Force, 1e3),
    unit("MN", Dimension::Force, 1e6),
    unit("N", Dimension::Force, 1.0),
    unit("MPa", Dimension::Stress, 1e6),
    unit("GPa", Dimension::Stress, 1e9),
    unit("N/mm2", Dimension::Stress, 1e6),
    unit("kN/mm2", Dimension::Stress, 1e9),
    unit("kN/cm2", Dimension::Stress, 1e7),
    unit("kN/m2", Dimension::Stress, 1e3),
    unit("MN/m2", Dimension::Stress, 1e6),
    unit("N/m2", Dimension::Stress, 1.0),
    unit("kPa", Dimension::Stress, 1e3),
    unit("Pa", Dimension::Stress, 1.0),
    unit("kg/m3", Dimension::Density, 1.0),
    unit("t/m3", Dimension::Density, 1e3),
    unit("g/cm3", Dimension::Density, 1e3),
    unit("deg", Dimension::Angle, std::f64::consts::PI / 180.0),
    unit("mrad", Dimension::Angle, 1e-3),
    unit("rad", Dimension::Angle, 1.0),
    unit("m/s2", Dimension::Acceleration, 1.0),
    unit("mm/s2", Dimension::Acceleration, 1e-3),
    unit("1/s", Dimension::Rate, 1.0),
    unit("1/ms", Dimension::Rate, 1e3),
    unit("kg", Dimension::Mass, 1.0),
    unit("t", Dimension::Mass, 1e3),
    unit("%", Dimension::Number, 1e-2),
];

/// Why a text is not a quantity of the expected dimension.
#[derive(Debug, Clone, PartialEq)]
pub enum UnitError {
    /// The text does not begin with a number.
    NotANumber,
    /// The number has a decimal comma.
    DecimalComma,
    /// The number is not finite.
    NotFinite,
    /// There is no unit behind the number.
    MissingUnit {
        /// The number.
        number: f64,
    },
    /// No such unit.
    UnknownUnit {
        /// The unit as written.
        unit: String,
        /// The most similar unit of the expected dimension.
        similar: Option<&'static str>,
    },
    /// A unit of another dimension.
    WrongDimension {
        /// What the unit measures.
        found: Dimension,
    },
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotANumber => write!(f, "this text does not begin with a number"),
            Self::DecimalComma => write!(f, "the decimal separator is a point, not a comma"),
            Self::NotFinite => write!(f, "this number is not finite"),
            Self::MissingUnit { .. } => write!(f, "a quantity in quotes needs a unit"),
            Self::UnknownUnit { unit, .. } => write!(f, "there is no unit `{unit}`"),
            Self::WrongDimension { found } => write!(f, "this is {}", found.noun()),
        }
    }
}

/// Longest text that can be a quantity.
const MAX_QUANTITY_BYTES: usize = 64;

/// Number and unit of a text, `None` if it does not begin with a number; the unit may be empty.
pub fn split_quantity(text: &str) -> Option<(f64, String)> {
    if text.len() > MAX_QUANTITY_BYTES {
        return None;
    }
    let text = text.trim().replace('\u{2212}', "-");
    let ends = text.char_indices().map(|(i, c)| i + c.len_utf8()).filter(|&end| {
        let head = &text[..end];
        head.ends_with(|c: char| c.is_ascii_digit() || c == '.')
    });
    // The longest beginning that is a number: "1e3 mm" is 1000 mm, "400mm" is 400 mm.
    let (number, end) = ends.filter_map(|end| Some((text[..end].parse::<f64>().ok()?, end))).next_back()?;
    Some((number, canonical_symbol(&text[end..])))
}

fn canonical_symbol(symbol: &str) -> String {
    let plain = symbol.trim().replace('^', "").replace('²', "2").replace('³', "3").replace(['µ', 'μ'], "u");
    match plain.as_str() {
        "°" => "deg".into(),
        "s-1" => "1/s".into(),
        _ => plain,
    }
}

/// The unit with this symbol.
pub fn find_unit(symbol: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.symbol == symbol)
}

/// The SI value of a text such as "400 mm", which must have the expected dimension.
pub fn parse_quantity(text: &str, expected: Dimension) -> Result<f64, UnitError> {
    let (number, symbol) = split_quantity(text).ok_or(UnitError::NotANumber)?;
    if !number.is_finite() {
        return Err(UnitError::NotFinite);
    }
    if symbol.starts_with(',') {
        return Err(UnitError::DecimalComma);
    }
    if symbol.is_empty() {
        return Err(UnitError::MissingUnit { number });
    }
    let Some(unit) = find_unit(&symbol) else {
        let similar = similar_unit(&symbol, expected);
        return Err(UnitError::UnknownUnit { unit: symbol, similar });
    };
    if unit.dimension != expected {
        return Err(UnitError::WrongDimension { found: unit.dimension });
    }
    let value = to_si(number, unit.factor);
    if value.is_finite() { Ok(value) } else { Err(UnitError::NotFinite) }
}

/// `number * factor`, dividing where the factor is a negative power of ten: "400 mm" is then the same
/// number as 0.4 to the last bit.
fn to_si(number: f64, factor: f64) -> f64 {
    let inverse = (1.0 / factor).round();
    if factor < 1.0 && (factor * inverse - 1.0).abs() < 1e-15 { number / inverse } else { number * factor }
}

fn similar_unit(symbol: &str, expected: Dimension) -> Option<&'static str> {
    let lower = symbol.to_lowercase();
    let mut best: Option<(usize, &'static str)> = None;
    for unit in expected.units() {
        let distance = strsim::damerau_levenshtein(&lower, &unit.symbol.to_lowercase());
        if distance <= 1 && distance < lower.chars().count() && best.is_none_or(|(d, _)| distance < d) {
            best = Some((distance, unit.symbol));
        }
    }
    best.map(|(_, symbol)| symbol)
}

/// A value in the unit in which a reader expects it, such as "0.4 m", "30 MPa" or "12 ms".
pub fn show(value: f64, dimension: Dimension) -> String {
    let steps: &[(&str, f64)] = match dimension {
        Dimension::Length => &[("m", 1.0), ("mm", 1e-3)],
        Dimension::Time => &[("s", 1.0), ("ms", 1e-3)],
        Dimension::Stress => &[("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3), ("Pa", 1.0)],
        Dimension::Force => &[("MN", 1e6), ("kN", 1e3), ("N", 1.0)],
        _ => &[],
    };
    let size = value.abs();
    // 0.05 m reads better than 50 mm in a range that ends at 3 m, so lengths change over late.
    let least = if matches!(dimension, Dimension::Length | Dimension::Time) { 0.05 } else { 1.0 };
    let (symbol, factor) = steps
        .iter()
        .copied()
        .find(|(_, factor)| size >= factor * least && size > 0.0)
        .unwrap_or((dimension.si_symbol(), 1.0));
    let number = round_to_digits(value / factor, 6);
    if symbol.is_empty() { format!("{number}") } else { format!("{number} {symbol}") }
}

/// A range such as "4 mm to 60 mm": both ends of a small length in mm, otherwise each as [`show`] does.
pub fn show_range(min: f64, max: f64, dimension: Dimension) -> String {
    if dimension == Dimension::Length && max < 1.0 {
        return format!("{} mm to {} mm", round_to_digits(min * 1e3, 6), round_to_digits(max * 1e3, 6));
    }
    format!("{} to {}", show(min, dimension), show(max, dimension))
}

/// A number rounded to some significant digits, for messages.
pub fn round_to_digits(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// A time \[s\] as tables say it: to 15 digits, without what rounding leaves of multiples of an interval (0.7 for 0.7000000000000001).
pub fn in_table(time_s: f64) -> f64 {
    round_to_digits(time_s, 15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_in_tables_are_multiples_of_their_interval() {
        for i in 0..100_000 {
            let text = in_table(f64::from(i) * 0.01).to_string();
            assert!(text.split('.').nth(1).is_none_or(|digits| digits.len() <= 2), "{text}");
        }
        assert_eq!(in_table(1.0 / 3.0), 0.333333333333333);
    }

    #[test]
    fn quantities_become_si() {
        let cases = [
            ("400 mm", Dimension::Length, 0.4),
            ("400mm", Dimension::Length, 0.4),
            ("-3.5 m", Dimension::Length, -3.5),
            ("40 cm", Dimension::Length, 0.4),
            ("30 MPa", Dimension::Stress, 30e6),
            ("30 N/mm²", Dimension::Stress, 30e6),
            ("33 GPa", Dimension::Stress, 33e9),
            ("120 ms", Dimension::Time, 0.12),
            ("25 kN", Dimension::Force, 25e3),
            ("2500 kg/m^3", Dimension::Density, 2500.0),
            ("2.5 t/m3", Dimension::Density, 2500.0),
            ("180 deg", Dimension::Angle, std::f64::consts::PI),
            ("9.81 m/s²", Dimension::Acceleration, 9.81),
            ("1e3 mm", Dimension::Length, 1.0),
            ("5 %", Dimension::Number, 0.05),
        ];
        for (text, dimension, value) in cases {
            assert_eq!(parse_quantity(text, dimension), Ok(value), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let of = |text| parse_quantity(text, Dimension::Length).unwrap_err();
        assert_eq!(of("30 MPa"), UnitError::WrongDimension { found: Dimension::Stress });
        assert_eq!(of("4 MM"), UnitError::UnknownUnit { unit: "MM".into(), similar: Some("mm") });
        assert_eq!(of("400"), UnitError::MissingUnit { number: 400.0 });
        assert_eq!(of("0,4 m"), UnitError::DecimalComma);
        assert_eq!(of("wide"), UnitError::NotANumber);
        assert_eq!(of(""), UnitError::NotANumber);
        assert_eq!(of("1e999 m"), UnitError::NotFinite);
        assert_eq!(of("4 ft"), UnitError::UnknownUnit { unit: "ft".into(), similar: None });
    }

    #[test]
    fn values_are_shown_in_a_usual_unit() {
        assert_eq!(show(0.4, Dimension::Length), "0.4 m");
        assert_eq!(show(0.002, Dimension::Length), "2 mm");
        assert_eq!(show(30.0, Dimension::Stress), "30 Pa");
        assert_eq!(show(16.5e6, Dimension::Stress), "16.5 MPa");
        assert_eq!(show(0.0, Dimension::Time), "0 s");
    }
}
