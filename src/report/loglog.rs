//! Plots of points joined by lines on two logarithmic axes, as an SVG file of its own.

use super::chart::escape;
use super::number::significant;
use std::fmt::Write;

/// A line.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Its name; lines without one are not in the legend.
    pub name: String,
    /// Points whose coordinates are positive; others are left out.
    pub points: Vec<[f64; 2]>,
    /// Number of its colour.
    pub colour: usize,
    /// Whether it is dashed and its points are hollow.
    pub dashed: bool,
    /// What the points are, in their order; empty: nothing stands beside them.
    pub labels: Vec<String>,
}

/// A plot with a title.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Title.
    pub title: String,
    /// Lines.
    pub lines: Vec<Line>,
}

const SIZE: [f64; 2] = [640.0, 420.0];
const AREA: [f64; 4] = [70.0, 620.0, 30.0, 360.0];
const COLOURS: [&str; 4] = ["#1f6fb4", "#c0482c", "#3a8a4d", "#7a5aa6"];

/// One or several plots, two side by side, with the names of their axes (with units); all have the same ranges.
pub fn svg(axes: [&str; 2], panels: &[Panel]) -> String {
    let columns = panels.len().clamp(1, 2);
    let rows = panels.len().div_ceil(columns).max(1);
    let [width, height] = [SIZE[0] * columns as f64, SIZE[1] * rows as f64];
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"13\">\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    let scale = Scale::of(panels.iter().flat_map(|p| &p.lines));
    for (i, panel) in panels.iter().enumerate() {
        let at = [SIZE[0] * (i % columns) as f64, SIZE[1] * (i / columns) as f64];
        let _ = writeln!(out, "<g transform=\"translate({} {})\">", at[0], at[1]);
        scale.between(&mut out);
        scale.grid(&mut out, axes, &panel.title);
        let named = panel.lines.iter().filter(|line| !line.name.is_empty());
        for (row, line) in named.enumerate() {
            let _ = writeln!(
                out,
                "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" fill=\"{}\">{}</text>",
                AREA[1] - 8.0,
                AREA[2] + 18.0 * (row as f64 + 1.0),
                colour(line),
                escape(&line.name)
            );
        }
        panel.lines.iter().for_each(|line| scale.line(&mut out, line));
        out += "</g>\n";
    }
    out + "</svg>\n"
}

fn colour(line: &Line) -> &'static str {
    COLOURS[line.colour % COLOURS.len()]
}

fn valid(point: &[f64; 2]) -> bool {
    point.iter().all(|c| c.is_finite() && *c > 0.0)
}

/// How a line across an axis and its number look: colour of the line, style of the number, and how far it is below the x axis.
struct Tick(&'static str, &'static str, f64);

const DECADE: Tick = Tick("#ddd", "", 20.0);
const BETWEEN: Tick = Tick("#eee", " font-size=\"10\" fill=\"#666\"", 18.0);

/// A line across axis `k` at a place on it, with its label.
fn tick(out: &mut String, (k, at): (usize, f64), label: &str, Tick(stroke, style, below): Tick) {
    let [left, right, top, bottom] = AREA;
    let _ = if k == 0 {
        writeln!(
            out,
            "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"{stroke}\"/>\
             <text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\"{style}>{label}</text>",
            bottom + below
        )
    } else {
        writeln!(
            out,
            "<path d=\"M{left} {at:.1}H{right}\" stroke=\"{stroke}\"/>\
             <text x=\"{}\" y=\"{at:.1}\" text-anchor=\"end\" dy=\"4\"{style}>{label}</text>",
            left - 8.0
        )
    };
}

/// Ranges of both axes in decades.
struct Scale([[f64; 2]; 2]);

impl Scale {
    /// Whole decades around all points.
    fn of<'a>(lines: impl Iterator<Item = &'a Line> + Clone) -> Self {
        Self([0, 1].map(|k| {
            let logs = lines.clone().flat_map(|l| l.points.iter().filter(|p| valid(p))).map(|p| p[k].log10());
            let around = |r: [f64; 2], v: f64| [r[0].min(v.floor()), r[1].max(v.ceil())];
            let [low, high] = logs.fold([f64::INFINITY, f64::NEG_INFINITY], around);
            if low <= high { [low, high.max(low + 1.0)] } else { [0.0, 1.0] }
        }))
    }

    fn place(&self, k: usize, log: f64) -> f64 {
        let [low, high] = self.0[k];
        let (share, [left, right, top, bottom]) = ((log - low) / (high - low), AREA);
        if k == 0 { left + share * (right - left) } else { bottom - share * (bottom - top) }
    }

    /// Lines at two and five times the decades where there are few of these: within one decade nothing else could be read.
    fn between(&self, out: &mut String) {
        for k in 0..2 {
            let [low, high] = self.0[k];
            if high - low > 2.0 {
                continue;
            }
            for value in (low as i32..high as i32).flat_map(|d| [2.0, 5.0].map(|m| m * 10_f64.powi(d))) {
                tick(out, (k, self.place(k, value.log10())), &significant(value, 1), BETWEEN);
            }
        }
    }

    /// Title, names of the axes, and a line and a number at each decade.
    fn grid(&self, out: &mut String, axes: [&str; 2], title: &str) {
        let [left, right, top, bottom] = AREA;
        let _ = writeln!(out, "<text x=\"{left}\" y=\"18\">{}</text>", escape(title));
        for k in 0..2 {
            for decade in self.0[k][0] as i32..=self.0[k][1] as i32 {
                let label = format!("10<tspan dy=\"-5\" font-size=\"10\">{decade}</tspan>");
                tick(out, (k, self.place(k, f64::from(decade))), &label, DECADE);
            }
        }
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
             <text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            0.5 * (left + right),
            bottom + 44.0,
            escape(axes[0]),
            0.5 * (top + bottom),
            escape(axes[1])
        );
    }

    fn line(&self, out: &mut String, line: &Line) {
        let colour = colour(line);
        let (dashes, fill) = if line.dashed { (" stroke-dasharray=\"5 4\"", "#fff") } else { ("", colour) };
        let at = |p: &[f64; 2]| [0, 1].map(|k| self.place(k, p[k].log10()));
        let labels = line.labels.iter().map(String::as_str).chain(std::iter::repeat(""));
        let shown = line.points.iter().zip(labels).filter(|(p, _)| valid(p));
        let (at, labels): (Vec<[f64; 2]>, Vec<&str>) = shown.map(|(p, label)| (at(p), label)).unzip();
        let path: Vec<String> = at.iter().map(|p| format!("{:.1} {:.1}", p[0], p[1])).collect();
        if !path.is_empty() {
            let _ = writeln!(
                out,
                "<path d=\"M{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"{dashes}/>",
                path.join("L")
            );
        }
        for ([x, y], label) in at.into_iter().zip(labels) {
            let _ = writeln!(
                out,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{fill}\" stroke=\"{colour}\"/>"
            );
            if !label.is_empty() {
                let _ = writeln!(
                    out,
                    "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"10\" fill=\"{colour}\">{}</text>",
                    x + 7.0,
                    y - 5.0,
                    escape(label)
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(title: &str, points: Vec<[f64; 2]>) -> Panel {
        let labels = vec!["0.4 m".into(), "0.2 m".into(), "0.1 m".into()];
        let line = Line { name: "x".into(), points, colour: 0, dashed: false, labels };
        Panel { title: title.into(), lines: vec![line] }
    }

    #[test]
    fn points_without_a_logarithm_are_left_out() {
        let text = svg(["t [s]", "e"], &[panel("a<b", vec![[1.0, 0.1], [10.0, 0.0], [20.0, 0.01]])]);
        assert_eq!(text.matches("<circle").count(), 2);
        assert!(text.contains(">0.1 m<") && !text.contains(">0.2 m<"), "labels go with their points");
        assert!(text.contains("a&lt;b") && !text.contains("NaN") && !text.contains("inf"));
        assert!(svg(["x", "y"], &[]).ends_with("</svg>\n"));
    }

    /// Between ends of one decade there are lines at two and five.
    #[test]
    fn few_decades_are_divided() {
        let near = svg(["x", "y"], &[panel("a", vec![[20.0, 0.03], [60.0, 0.06]])]);
        assert!([">20<", ">50<", ">0.02<", ">0.05<"].iter().all(|label| near.contains(label)), "{near}");
        let far = svg(["x", "y"], &[panel("a", vec![[0.1, 0.03], [600.0, 0.06]])]);
        assert!(!far.contains(">20<") && far.contains(">0.02<"));
    }

    #[test]
    fn panels_stand_two_in_a_row_with_the_same_decades() {
        let panels = [panel("a", vec![[1.0, 0.1]]), panel("b", vec![[1e3, 0.1]]), panel("c", Vec::new())];
        let text = svg(["x", "y"], &panels);
        assert!(text.contains("viewBox=\"0 0 1280 840\"") && text.contains("translate(640 0)"));
        assert_eq!(text.matches(">3</tspan>").count(), 3);
    }
}
