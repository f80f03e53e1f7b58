//! Numbers and names as other programs read them.

use crate::mbs::math::{M3, V3};

/// The shortest decimal that reads back as the same number, without an exponent.
pub fn plain(value: f64) -> String {
    // zero has no sign here
    if value == 0.0 { "0".into() } else { format!("{value}") }
}

/// Numbers with something in between.
pub fn list(values: &[f64], between: &str) -> String {
    values.iter().map(|v| plain(*v)).collect::<Vec<_>>().join(between)
}

/// A name of letters, digits and underscores that begins with a letter.
pub fn word(id: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let word: String = id.chars().map(plain).collect();
    if word.starts_with(|c: char| c.is_ascii_alphabetic()) { word } else { format!("n_{word}") }
}

/// Euler angles 3-1-3 of a matrix whose columns are the turned axes \[rad\].
pub fn euler_313(r: &M3) -> V3 {
    let across = libm::hypot(r[0][2], r[1][2]);
    let b = libm::atan2(across, r[2][2]);
    if across > 1e-12 {
        [libm::atan2(r[0][2], -r[1][2]), b, libm::atan2(r[2][0], r[2][1])]
    } else {
        // the two turns about z are one: all of it is the first
        [libm::atan2(r[1][0], r[0][0]), b, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mbs::math::{matmul, qexp, qmat};

    #[test]
    fn numbers_have_no_exponent_and_come_back() {
        for value in [1e-7, -2.5e-9, 4.16e4, 1e12, 0.1 + 0.2, 1.0 / 3.0] {
            let text = plain(value);
            assert!(!text.contains(['e', 'E']), "{text}");
            assert_eq!(text.parse::<f64>().unwrap(), value);
        }
        assert_eq!(plain(-0.0), "0");
    }

    #[test]
    fn euler_angles_make_the_matrix_again() {
        let about = |axis: usize, angle: f64| {
            let mut r = [0.0; 3];
            r[axis] = angle;
            qmat(qexp(r))
        };
        let turns =
            [[0.3, -0.2, 0.9], [0.0; 3], [0.0, 0.0, 1.2], [std::f64::consts::PI, 0.0, 0.0], [0.0, 2.0, 0.0]];
        for turn in turns {
            let r = qmat(qexp(turn));
            let [a, b, c] = euler_313(&r);
            let again = matmul(&matmul(&about(2, a), &about(0, b)), &about(2, c));
            for (row, other) in r.iter().flatten().zip(again.iter().flatten()) {
                assert!((row - other).abs() < 1e-14, "{turn:?}");
            }
        }
    }

    #[test]
    fn words_are_words() {
        assert_eq!(word("column-11 head"), "column_11_head");
        assert_eq!(word("1st"), "n_1st");
    }
}
