//! Numbers as Fortran programs read and write them.

/// A real number: `1`, `1.`, `.5`, `1.5e3`, `1.D-3`, `1.0+3`. `None` if it is none or not finite.
pub(super) fn real(text: &str) -> Option<f64> {
    let (mut mantissa, mut exponent) = (String::with_capacity(text.len() + 2), String::new());
    let (mut digits, mut point, mut in_exponent) = (0, false, false);
    let bytes = text.as_bytes();
    for (i, c) in bytes.iter().map(|b| *b as char).enumerate() {
        match c {
            '0'..='9' if in_exponent => exponent.push(c),
            '0'..='9' => {
                digits += 1;
                mantissa.push(c);
            }
            '.' if !point && !in_exponent => {
                point = true;
                mantissa.push(c);
            }
            '+' | '-' if i == 0 => mantissa.push(c),
            'e' | 'E' | 'd' | 'D' if !in_exponent && digits > 0 => in_exponent = true,
            '+' | '-' if digits > 0 && !in_exponent => {
                in_exponent = true;
                exponent.push(c);
            }
            '+' | '-'
                if in_exponent
                    && exponent.is_empty()
                    && matches!(bytes[i - 1], b'e' | b'E' | b'd' | b'D') =>
            {
                exponent.push(c);
            }
            _ => return None,
        }
    }
    if digits == 0 || (in_exponent && !exponent.ends_with(|c: char| c.is_ascii_digit())) {
        return None;
    }
    if in_exponent {
        mantissa.push('e');
        mantissa.push_str(&exponent);
    }
    mantissa.parse().ok().filter(|x: &f64| x.is_finite())
}

/// A whole number, also one written as a real (`3.`).
pub(super) fn whole(text: &str) -> Option<i64> {
    let plain = text.strip_prefix('+').unwrap_or(text);
    plain.parse().ok().or_else(|| real(text).filter(|x| x.fract() == 0.0 && x.abs() < 9e15).map(|x| x as i64))
}

/// A number in at most `width` columns that reads back to the last bit; `None` if there is no such text.
pub(super) fn shortest(x: f64, width: usize) -> Option<String> {
    common(x, width).or_else(|| {
        let (dotted, digits, exponent) = scientific(x)?;
        let decimals = dotted.split_once('.').map_or(0, |(_, d)| d.len() as i32);
        let whole = match dotted.strip_suffix(".0") {
            Some(whole) => format!("{whole}{exponent:+}"),
            None => format!("{digits}{:+}", exponent - decimals),
        };
        [format!("{dotted}{exponent:+}"), whole].into_iter().find(|c| c.len() <= width)
    })
}

/// Like [`shortest`], in a spelling that all programs read: an exponent stands after an `e`.
pub(super) fn common(x: f64, width: usize) -> Option<String> {
    if x == 0.0 {
        return Some(if x.is_sign_negative() { "-0.0" } else { "0.0" }.into());
    }
    let plain = if (1e-5..1e16).contains(&x.abs()) { format!("{x:?}") } else { String::new() };
    let (dotted, _, exponent) = scientific(x)?;
    let without_zero = plain.replacen("0.", ".", usize::from(x.abs() < 1.0));
    let candidates = [plain, format!("{dotted}e{exponent}"), without_zero];
    candidates.into_iter().find(|c| !c.is_empty() && c.len() <= width)
}

/// Mantissa with a point, its digits without, exponent.
fn scientific(x: f64) -> Option<(String, String, i32)> {
    let text = format!("{x:e}");
    let (mantissa, exponent) = text.split_once('e')?;
    let dotted = if mantissa.contains('.') { mantissa.to_string() } else { format!("{mantissa}.0") };
    Some((dotted, mantissa.replace('.', ""), exponent.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reals_in_all_spellings() {
        for (text, expected) in [
            ("1", 1.0),
            ("1.", 1.0),
            (".5", 0.5),
            ("-1.5e3", -1500.0),
            ("1.D-3", 1e-3),
            ("1.0+3", 1e3),
            ("2-3", 2e-3),
            ("+1E+02", 100.0),
        ] {
            assert_eq!(real(text), Some(expected), "{text}");
        }
        for text in [
            "", ".", "-", "e3", "1e", "1e+", "1.0 3", "nan", "inf", "0x1", "1.2.3", "1e400", "1_0", "--1",
            "1e3+2", "1+2-3", "é",
        ] {
            assert_eq!(real(text), None, "{text}");
        }
        assert_eq!([whole("3."), whole("+12"), whole("1.5"), whole("x")], [Some(3), Some(12), None, None]);
    }

    #[test]
    fn written_numbers_come_back() {
        let mut bits = 88_172_645_463_325_252_u64;
        let mut failed = 0;
        for i in 0..20_000 {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            let x = if i % 2 == 0 { f64::from_bits(bits) } else { bits as f64 / 1e19 - 0.5 };
            if !x.is_finite() {
                continue;
            }
            match shortest(x, 20) {
                Some(text) => assert!(text.len() <= 20 && real(&text) == Some(x), "{x:e} as {text}"),
                None => {
                    failed += 1;
                    assert!(shortest(x, 24).is_some(), "{x:e}");
                    assert!(x < 0.0 || !(1e-80..1e80).contains(&x), "{x:e} has to fit");
                }
            }
        }
        assert!(failed > 0);
        assert_eq!(shortest(3e10, 10).as_deref(), Some("3.0e10"));
        assert_eq!(shortest(0.4, 10).as_deref(), Some("0.4"));
        assert_eq!(shortest(-0.0, 10).as_deref(), Some("-0.0"));
    }
}
