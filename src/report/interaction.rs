//! Strengths in the plane of two moments as an SVG file of its own: points over lines, the same scale on both axes.

use super::chart::escape;
use super::number::fixed;
use std::fmt::Write;

/// A line and the points that belong to it, in display units.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Group {
    /// Name in the legend.
    pub label: String,
    /// The line, in the order in which it is drawn.
    pub line: Vec<[f64; 2]>,
    /// The points.
    pub points: Vec<[f64; 2]>,
}

const SIDE: f64 = 560.0;
const LEFT: f64 = 90.0;
const TOP: f64 = 84.0;
const LEGEND: f64 = 250.0;
const COLOURS: [&str; 6] = ["#1d5c9e", "#b8480f", "#1d7a63", "#7b4ea3", "#94731a", "#a8201a"];
const STYLE: &str = "text{font:12px sans-serif;fill:#1b2127}.title{font-weight:600;font-size:15px}.tick{font-size:11px;fill:#566069}\
.end{text-anchor:end}.mid{text-anchor:middle}.grid{stroke:#e9ecef}.zero{stroke:#9aa4ad}";

/// The groups as one SVG file, with a title, a line of words below it, and the names of the axes with their unit.
pub fn svg(title: &str, words: &str, axes: [&str; 2], groups: &[Group]) -> String {
    let all = || groups.iter().flat_map(|g| g.line.iter().chain(&g.points));
    let ends = |i: usize| {
        let values = all().map(|p| p[i]).filter(|v| v.is_finite());
        values.fold([0.0, 0.0], |[low, high]: [f64; 2], v| [low.min(v), high.max(v)])
    };
    let (x, y) = (ends(0), ends(1));
    let span = (1.06 * (x[1] - x[0]).max(y[1] - y[0])).max(1e-9);
    let scale = SIDE / span;
    let low = [x, y].map(|e| if e[0] < 0.0 { 0.5 * (e[0] + e[1] - span) } else { 0.0 });
    let at = |p: &[f64; 2]| [LEFT + scale * (p[0] - low[0]), TOP + SIDE - scale * (p[1] - low[1])];
    let mut out = String::new();
    let _ = write!(
        out,
        "<text class=\"title\" x=\"24\" y=\"30\">{}</text><text x=\"24\" y=\"50\">{}</text>",
        escape(title),
        escape(words)
    );
    grid(&mut out, low, span, scale);
    let (middle, bottom) = (LEFT + 0.5 * SIDE, TOP + SIDE);
    let _ = write!(
        out,
        "<text class=\"mid\" x=\"{middle}\" y=\"{}\">{}</text><text class=\"mid\" transform=\"translate(26 {}) rotate(-90)\">{}</text>",
        bottom + 42.0,
        escape(axes[0]),
        TOP + 0.5 * SIDE,
        escape(axes[1])
    );
    for (i, group) in groups.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        let steps: Vec<String> = group.line.iter().map(at).map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
        if !steps.is_empty() {
            let _ = write!(
                out,
                "<path fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.7\" d=\"M{}\"/>",
                steps.join("L")
            );
        }
        for [x, y] in group.points.iter().map(at) {
            let _ = write!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\" fill=\"{colour}\"/>");
        }
        let row = TOP + 14.0 + 22.0 * i as f64;
        let _ = write!(
            out,
            "<path stroke=\"{colour}\" stroke-width=\"1.7\" d=\"M{} {row}h26\"/><circle cx=\"{}\" cy=\"{row}\" r=\"4.5\" fill=\"{colour}\"/><text x=\"{}\" y=\"{}\">{}</text>",
            LEFT + SIDE + 20.0,
            LEFT + SIDE + 33.0,
            LEFT + SIDE + 54.0,
            row + 4.0,
            escape(&group.label)
        );
    }
    let (width, height) = (LEFT + SIDE + LEGEND, TOP + SIDE + 64.0);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\
         <style>{STYLE}</style><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>{out}</svg>\n"
    )
}

/// Lines at round numbers, with their labels.
fn grid(out: &mut String, low: [f64; 2], span: f64, scale: f64) {
    let power = 10f64.powf((span / 6.0).log10().floor());
    let rough = span / 6.0 / power;
    let step = power
        * if rough < 1.5 {
            1.0
        } else if rough < 3.5 {
            2.0
        } else if rough < 7.5 {
            5.0
        } else {
            10.0
        };
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    for axis in 0..2 {
        let first = (low[axis] / step - 1e-9).ceil() as i64;
        let last = ((low[axis] + span) / step + 1e-9).floor() as i64;
        for k in first..=last {
            let value = step * k as f64;
            let way = scale * (value - low[axis]);
            let class = if k == 0 { "zero" } else { "grid" };
            let label = fixed(value, decimals);
            let _ = if axis == 0 {
                let x = LEFT + way;
                write!(
                    out,
                    "<path class=\"{class}\" d=\"M{x:.1} {TOP}v{SIDE}\"/><text class=\"tick mid\" x=\"{x:.1}\" y=\"{}\">{label}</text>",
                    TOP + SIDE + 18.0
                )
            } else {
                let y = TOP + SIDE - way;
                write!(
                    out,
                    "<path class=\"{class}\" d=\"M{LEFT} {y:.1}h{SIDE}\"/><text class=\"tick end\" x=\"{}\" y=\"{:.1}\">{label}</text>",
                    LEFT - 8.0,
                    y + 4.0
                )
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_and_line_is_drawn_inside_the_square() {
        let group = Group {
            label: "n = <0.1>".into(),
            line: vec![[100.0, 0.0], [60.0, 60.0], [0.0, 80.0]],
            points: vec![[101.0, 0.0], [0.0, 81.0]],
        };
        let text = svg("a", "b", ["x [kN m]", "y [kN m]"], &[group]);
        assert_eq!(text.matches("<circle").count(), 3); // with the legend's
        assert!(text.contains("n = &lt;0.1&gt;") && !text.contains("NaN"));
        for part in text.split("<circle cx=\"").skip(1).take(2) {
            let x: f64 = part.split('"').next().unwrap().parse().unwrap();
            assert!((LEFT..=LEFT + SIDE).contains(&x), "{x}");
        }
    }
}
