//! Figures as text: a table for a terminal, the JSON list, the Markdown page.

use super::figure::{Figure, Tolerance};
use super::suite::{Case, Form};
use std::fmt::Write;

/// Six significant digits, in powers of ten where that is shorter.
pub fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return x.to_string();
    }
    let exponent = libm::log10(x.abs()).floor() as i32;
    if !(-4..7).contains(&exponent) {
        let text = format!("{x:.4e}");
        let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", trimmed(mantissa));
    }
    trimmed(&format!("{x:.*}", (5 - exponent).max(0) as usize)).to_string()
}

fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// A tolerance in words: `0.5 %`, or `± 3 mm`.
pub fn tolerance(figure: &Figure) -> String {
    match figure.tolerance {
        Tolerance::Relative(share) => format!("{} %", number(100.0 * share)),
        Tolerance::Absolute(band) if figure.unit == "-" => format!("± {}", number(band)),
        Tolerance::Absolute(band) => format!("± {} {}", number(band), figure.unit),
    }
}

fn with_unit(figure: &Figure) -> String {
    if figure.unit == "-" {
        figure.quantity.clone()
    } else {
        format!("{} [{}]", figure.quantity, figure.unit)
    }
}

/// Text as it stands in a cell of a Markdown table.
pub fn in_cell(text: &str) -> String {
    text.replace('|', "\\|").replace('[', "\\[").replace(']', "\\]")
}

/// The figures as a table of fixed width, for a terminal.
pub fn table(figures: &[Figure]) -> String {
    let rows: Vec<[String; 7]> = figures
        .iter()
        .map(|f| {
            let pass = if f.passes() { "pass" } else { "FAIL" };
            let (reference, ours) = (number(f.reference), number(f.ours));
            let quantity = with_unit(f);
            [f.case.clone(), quantity, reference, ours, tolerance(f), pass.into(), f.source.into()]
        })
        .collect();
    let heads = ["case", "quantity", "reference", "ours", "tolerance", "", "source"].map(String::from);
    let width =
        |column: usize| rows.iter().chain([&heads]).map(|r| r[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 7] = std::array::from_fn(width);
    let mut text = String::new();
    for row in [&heads].into_iter().chain(&rows) {
        for (column, cell) in row.iter().enumerate() {
            let space = " ".repeat(widths[column] - cell.chars().count());
            let _ = match column {
                2..=4 => write!(text, "{space}{cell}  "),
                6 => writeln!(text, "{cell}"),
                _ => write!(text, "{cell}{space}  "),
            };
        }
    }
    text
}

/// Passed and all: `97 of 98 figures within their tolerances`.
pub fn verdict(figures: &[Figure]) -> String {
    let passed = figures.iter().filter(|f| f.passes()).count();
    format!("{passed} of {} figures within their tolerances\n", figures.len())
}

/// The figures as a JSON list, one object a line.
pub fn json(figures: &[Figure]) -> Result<String, serde_json::Error> {
    let lines: Result<Vec<String>, _> = figures.iter().map(serde_json::to_string).collect();
    Ok(format!("[\n{}\n]\n", lines?.join(",\n")))
}

/// The manual: each case with what it models, and its figures; cases beyond the form `ran` say that they were not run. `intro` follows the title.
pub fn markdown(title: &str, intro: &str, cases: &[Case], ran: Form, figures: &[Figure]) -> String {
    let mut text = format!("# {title}\n\n{intro}\n{}", verdict(figures));
    for case in cases {
        let of_case: Vec<&Figure> = figures.iter().filter(|f| f.case == case.name).collect();
        let form = match case.form {
            Form::Short => "",
            Form::Full => " (full form only)",
            Form::Complete => " (complete form only)",
        };
        let _ = write!(text, "\n## {}{form}\n\n{}\n\n", case.name, case.about);
        if case.form > ran {
            text.push_str("Not run for this page.\n");
            continue;
        }
        text.push_str(
            "| quantity | reference | ours | tolerance | | source |\n|---|---:|---:|---:|---|---|\n",
        );
        for f in of_case {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {} | {} |",
                in_cell(&with_unit(f)),
                number(f.reference),
                number(f.ours),
                tolerance(f),
                if f.passes() { "pass" } else { "**fail**" },
                f.source
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, expected) in [
            (0.0, "0"),
            (-24.995, "-24.995"),
            (0.0895217, "0.0895217"),
            (1.0, "1"),
            (123456.7, "123457"),
            (3.2e-11, "3.2e-11"),
            (-7.5e9, "-7.5e9"),
            (100.0, "100"),
        ] {
            assert_eq!(number(x), expected);
        }
        assert_eq!(number(f64::NAN), "NaN");
    }

    #[test]
    fn the_page_says_which_cases_were_not_run() {
        let figure = || Ok(vec![Figure::relative("u", "m", [1.0, 1.0], 0.1, "s")]);
        let cases = [Case::short("a", "A.", figure), Case::complete("b", "B.", figure)];
        let page = markdown("T", "", &cases, Form::Full, &cases[0].figures().unwrap());
        assert!(page.contains("## a\n\nA.\n\n| quantity") && page.contains("| u \\[m\\] |"), "{page}");
        assert!(page.ends_with("## b (complete form only)\n\nB.\n\nNot run for this page.\n"), "{page}");
    }

    #[test]
    fn failures_are_seen() {
        let figure = |ours| Figure::relative("u", "m", [1.0, ours], 0.1, "s");
        let text = table(&[figure(1.0), figure(2.0)]);
        assert_eq!(text.matches("FAIL").count(), 1, "{text}");
        assert!(verdict(&[figure(1.0), figure(2.0)]).starts_with("1 of 2 "));
        let list: serde_json::Value = serde_json::from_str(&json(&[figure(2.0)]).unwrap()).unwrap();
        assert_eq!(list[0]["pass"], false);
    }
}
