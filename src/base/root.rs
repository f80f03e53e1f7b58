//! The root of a function of one number in a bracket.

/// Most evaluations.
const MOST: usize = 200;

/// When a search for a root ends: the value that counts as zero, and the width of the bracket that counts as a point.
#[derive(Debug, Clone, Copy)]
pub struct Close {
    /// In units of the function.
    pub value: f64,
    /// In units of its argument.
    pub width: f64,
}

/// Root in a bracket of `[place, value]` pairs of opposite signs: regula falsi in the form called Illinois (Dowell and Jarratt 1971), every fourth time a bisection, so that it closes in on a jump too.
pub fn root(f: impl Fn(f64) -> f64, [mut a, mut b]: [[f64; 2]; 2], close: Close) -> f64 {
    let mut kept = 0;
    for round in 0..MOST {
        let linear = (a[0] * b[1] - b[0] * a[1]) / (b[1] - a[1]);
        let at = if round % 4 == 3 || !linear.is_finite() { 0.5 * (a[0] + b[0]) } else { linear };
        let value = f(at);
        if value.abs() <= close.value || (b[0] - a[0]).abs() < close.width {
            return at;
        }
        if (value > 0.0) == (b[1] > 0.0) {
            b = [at, value];
            a[1] *= if kept == 1 { 0.5 } else { 1.0 };
            kept = 1;
        } else {
            a = [at, value];
            b[1] *= if kept == 2 { 0.5 } else { 1.0 };
            kept = 2;
        }
    }
    0.5 * (a[0] + b[0])
}

/// Root of an increasing function in a range, or the end of it beyond which the root lies.
pub fn increasing([low, high]: [f64; 2], f: impl Fn(f64) -> f64, close: Close) -> f64 {
    let bracket = [low, high].map(|x| [x, f(x)]);
    match bracket {
        [[_, from], _] if from >= 0.0 => low,
        [_, [_, to]] if to <= 0.0 => high,
        _ => root(f, bracket, close),
    }
}

/// Root of an increasing function near a guess: steps that grow until there is a change of sign, or the last place within a distance of the guess.
pub fn near(guess: f64, first_step: f64, farthest: f64, f: impl Fn(f64) -> f64, close: Close) -> f64 {
    let mut from = [guess, f(guess)];
    let (sign, mut step) = (if from[1] > 0.0 { -1.0 } else { 1.0 }, first_step);
    while from[1].abs() > close.value {
        let at = from[0] + sign * step;
        if (at - guess).abs() > farthest {
            break;
        }
        let to = [at, f(at)];
        if sign * to[1] >= 0.0 {
            return root(f, [from, to], close);
        }
        (from, step) = (to, 4.0 * step);
    }
    from[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    fn counted(f: impl Fn(f64) -> f64, from: f64, to: f64) -> (f64, usize) {
        let calls = Cell::new(0);
        let f = |x: f64| {
            calls.set(calls.get() + 1);
            f(x)
        };
        let bracket = [[from, f(from)], [to, f(to)]];
        (root(f, bracket, Close { value: 1e-12, width: 1e-12 }), calls.get())
    }

    #[test]
    fn a_smooth_root_takes_a_few_evaluations_and_a_jump_those_of_bisection() {
        let (x, calls) = counted(|x| x.powi(3) - 2.0, 0.0, 2.0);
        assert!((x - 2.0_f64.cbrt()).abs() < 1e-12 && calls < 16, "{x} {calls}");
        let (x, calls) = counted(|x| if x < 0.3 { -1.0 } else { 50.0 }, 0.0, 1.0);
        assert!((x - 0.3).abs() < 1e-11 && calls < 120, "{x} {calls}");
        let (x, _) = counted(|x| 1.0 - x, 0.0, 7.0);
        assert!((x - 1.0).abs() < 1e-12);
        let close = Close { value: 0.0, width: 1e-15 };
        assert_eq!(increasing([0.0, 1.0], |x| x + 1.0, close), 0.0);
        assert_eq!(increasing([0.0, 1.0], |x| x - 2.0, close), 1.0);
        assert!((near(5.0, 1e-3, 100.0, |x| x.exp() - 2.0, close) - 2.0_f64.ln()).abs() < 1e-15);
        assert!((near(-5.0, 1e-3, 100.0, |x| x.exp() - 2.0, close) - 2.0_f64.ln()).abs() < 1e-15);
        assert!(near(0.0, 1e-3, 1.0, |_| -1.0, close) > 0.2);
        assert!((increasing([0.0, 1.0], |x| x.exp() - 2.0, close) - 2.0_f64.ln()).abs() < 1e-15);
    }
}
