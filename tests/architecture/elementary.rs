//! Elementary functions come from the crate `libm` wherever results are made: those of the standard library call the system's, whose
//! last digit differs between processors.

use super::tokens::{Token, tokens};
use super::{none, sources};

/// Modules that show results and make none: plots, pages and words may use any function.
const SHOWN: [&str; 2] = ["report/", "cli/"];

/// Methods of floating point numbers and what stands for them.
const FUNCTIONS: &[(&str, &str)] = &[
    ("sin", "sin"),
    ("cos", "cos"),
    ("tan", "tan"),
    ("sin_cos", "sincos"),
    ("asin", "asin"),
    ("acos", "acos"),
    ("atan", "atan"),
    ("atan2", "atan2"),
    ("exp", "exp"),
    ("exp2", "exp2"),
    ("exp_m1", "expm1"),
    ("ln", "log"),
    ("ln_1p", "log1p"),
    ("log", "log"), // twice
    ("log2", "log2"),
    ("log10", "log10"),
    ("powf", "pow"),
    ("sinh", "sinh"),
    ("cosh", "cosh"),
    ("tanh", "tanh"),
    ("asinh", "asinh"),
    ("acosh", "acosh"),
    ("atanh", "atanh"),
    ("cbrt", "cbrt"),
    ("hypot", "hypot"),
];

/// What of `nalgebra` takes sines for itself.
const TURNS: [&str; 5] =
    ["Rotation2", "Rotation3", "from_axis_angle", "from_scaled_axis", "from_euler_angles"];

/// Tokens without the items that are compiled for tests only.
fn without_tests(tokens: &[Token]) -> Vec<&Token> {
    const MARK: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let mut kept = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        if tokens[i..].iter().take(MARK.len()).map(|t| t.text.as_str()).eq(MARK) {
            i = after_item(tokens, i + MARK.len());
        } else {
            kept.push(&tokens[i]);
            i += 1;
        }
    }
    kept
}

/// The end of the item that begins at `start`: its semicolon or its last brace.
fn after_item(tokens: &[Token], start: usize) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate().skip(start) {
        match token.text.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 && matches!(token.text.as_str(), ";" | "}") {
            return i + 1;
        }
    }
    tokens.len()
}

/// Lines that call elementary functions of the standard library, and what to use.
fn breaches(source: &str) -> Vec<(usize, String)> {
    let all = tokens(source);
    let tokens = without_tests(&all);
    let is = |i: usize, text: &str| tokens.get(i).is_some_and(|t| t.text == text);
    let of_floats = |i: usize| {
        i >= 3 && is(i - 1, ":") && is(i - 2, ":") && matches!(tokens[i - 3].text.as_str(), "f64" | "f32")
    };
    let mut found = Vec::new();
    for (i, token) in tokens.iter().enumerate() {
        let called = i >= 1 && is(i - 1, ".") && is(i + 1, "(");
        if let Some((own, other)) = FUNCTIONS.iter().find(|(own, _)| token.text == *own)
            && (called || of_floats(i))
        {
            found.push((token.line, format!("`{own}` of the standard library; use `libm::{other}`")));
        } else if TURNS.contains(&token.text.as_str()) {
            let message = format!("`{}` takes sines of the standard library; use `libm::sincos`", token.text);
            found.push((token.line, message));
        }
    }
    found
}

#[test]
fn results_are_made_with_the_functions_of_libm() {
    let makes_results =
        |path: &str| !path.ends_with("_tests.rs") && !SHOWN.iter().any(|s| path.starts_with(s));
    let mut found = Vec::new();
    for (path, source) in sources().iter().filter(|(path, _)| makes_results(path)) {
        found.extend(
            breaches(source).into_iter().map(|(line, message)| format!("src/{path}:{line}: {message}")),
        );
    }
    none(&found);
}

#[test]
fn calls_and_function_values_are_found_outside_tests() {
    let lines = |source: &str| breaches(source).into_iter().map(|(line, _)| line).collect::<Vec<_>>();
    let source = "fn f(x: f64) -> f64 {\n  x.sin()\n    .exp() + 2.0_f64.powf(x) // x.cos()\n}\nlet y = z.map(f64::ln);";
    assert_eq!(lines(source), [2, 3, 3, 5]);
    assert_eq!(breaches("a.ln_1p()")[0].1, "`ln_1p` of the standard library; use `libm::log1p`");
    assert_eq!(lines("libm::sin(x).sqrt() + self.cos + \"x.sin()\".len()"), [0; 0]);
    let source = "#[cfg(test)]\nconst A: [f64; 1] = [0.0];\na.cos();\n#[cfg(test)]\nmod tests {\n{ b.cos(); }\n}\nc.cos();";
    assert_eq!(lines(source), [3, 8]);
    assert_eq!(lines("use nalgebra::Rotation3;"), [1]);
}
