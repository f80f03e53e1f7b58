//! A plot of points joined by lines on two logarithmic axes, as an SVG file of its own.

use super::chart::escape;
use std::fmt::Write;

/// One line: name and points, all coordinates positive (others are left out).
pub type Line = (String, Vec<[f64; 2]>);

const SIZE: [f64; 2] = [640.0, 420.0];
const AREA: [f64; 4] = [70.0, 620.0, 30.0, 360.0];
const COLOURS: [&str; 4] = ["#1f6fb4", "#c0482c", "#3a8a4d", "#7a5aa6"];

/// The plot with a title and the names of its axes (with units).
pub fn svg(title: &str, axes: [&str; 2], lines: &[Line]) -> String {
    let valid = |p: &&[f64; 2]| p.iter().all(|c| c.is_finite() && *c > 0.0);
    let decades = |k: usize| {
        let logs = lines.iter().flat_map(|l| l.1.iter().filter(valid)).map(|p| p[k].log10());
        let (low, high) =
            logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v.floor()), b.max(v.ceil())));
        if low <= high { (low, high.max(low + 1.0)) } else { (0.0, 1.0) }
    };
    let ranges = [decades(0), decades(1)];
    let [left, right, top, bottom] = AREA;
    let place = |k: usize, log: f64| {
        let share = (log - ranges[k].0) / (ranges[k].1 - ranges[k].0);
        if k == 0 { left + share * (right - left) } else { bottom - share * (bottom - top) }
    };
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"13\">\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/><text x=\"{left}\" y=\"18\">{}</text>\n",
        SIZE[0],
        SIZE[1],
        escape(title)
    );
    for k in 0..2 {
        for decade in ranges[k].0 as i32..=ranges[k].1 as i32 {
            let at = place(k, f64::from(decade));
            let label = format!("10<tspan dy=\"-5\" font-size=\"10\">{decade}</tspan>");
            let _ = if k == 0 {
                writeln!(
                    out,
                    "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"#ddd\"/>\
                     <text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
                    bottom + 20.0
                )
            } else {
                writeln!(
                    out,
                    "<path d=\"M{left} {at:.1}H{right}\" stroke=\"#ddd\"/>\
                     <text x=\"{}\" y=\"{at:.1}\" text-anchor=\"end\" dy=\"4\">{label}</text>",
                    left - 8.0
                )
            };
        }
    }
    for (i, (name, points)) in lines.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        let at: Vec<[f64; 2]> =
            points.iter().filter(valid).map(|p| [place(0, p[0].log10()), place(1, p[1].log10())]).collect();
        let path: Vec<String> = at.iter().map(|p| format!("{:.1} {:.1}", p[0], p[1])).collect();
        if !path.is_empty() {
            let _ = writeln!(
                out,
                "<path d=\"M{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>",
                path.join("L")
            );
        }
        for p in at {
            let _ =
                writeln!(out, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"4\" fill=\"{colour}\"/>", p[0], p[1]);
        }
        let y = top + 18.0 * (i as f64 + 1.0);
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{y}\" text-anchor=\"end\" fill=\"{colour}\">{}</text>",
            right - 8.0,
            escape(name)
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
         <text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">{}</text></svg>",
        0.5 * (left + right),
        bottom + 44.0,
        escape(axes[0]),
        0.5 * (top + bottom),
        escape(axes[1])
    );
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_without_a_logarithm_are_left_out() {
        let text = svg("a<b", ["t [s]", "e"], &[("x".into(), vec![[1.0, 0.1], [10.0, 0.0], [20.0, 0.01]])]);
        assert_eq!(text.matches("<circle").count(), 2);
        assert!(text.contains("a&lt;b") && !text.contains("NaN") && !text.contains("inf"));
        assert!(svg("t", ["x", "y"], &[]).ends_with("</svg>\n"));
    }
}
