//! Points of two quantities that should be equal, with the line on which they are, as an SVG file of its own.

use super::chart::escape;
use super::number::axis;
use std::fmt::Write;

/// A point.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Place, first quantity across.
    pub at: [f64; 2],
    /// Name, shown when the pointer rests on it.
    pub name: String,
    /// Index into the groups of the panel.
    pub group: usize,
    /// Drawn hollow: not reached, the real place is further out.
    pub is_bound: bool,
}

/// One square plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Title.
    pub title: String,
    /// Names of the quantities with their units, across and up.
    pub axes: [String; 2],
    /// Names of the groups of points.
    pub groups: Vec<String>,
    /// Points.
    pub points: Vec<Point>,
    /// Share by which the dashed lines lie beside the line of equality.
    pub band: f64,
}

const SIDE: f64 = 360.0;
const LEFT: f64 = 70.0;
const TOP: f64 = 84.0;
const PANEL: f64 = SIDE + LEFT + 40.0;
const BELOW: f64 = 60.0;
const COLOURS: [&str; 4] = ["#1d5c9e", "#b8480f", "#1d7a63", "#7b4ea3"];

/// The panels side by side.
pub fn svg(title: &str, panels: &[Panel]) -> String {
    let (width, height) = (PANEL * panels.len() as f64 + 20.0, TOP + SIDE + BELOW);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"13\">\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/><text x=\"20\" y=\"24\" font-weight=\"600\">{}</text>\n",
        escape(title)
    );
    for (number, panel) in panels.iter().enumerate() {
        panel.draw(&mut out, LEFT + PANEL * number as f64);
    }
    out.push_str("</svg>\n");
    out
}

impl Panel {
    fn draw(&self, out: &mut String, left: f64) {
        let valid = |p: &&Point| p.at.iter().all(|c| c.is_finite());
        let largest = self.points.iter().filter(valid).flat_map(|p| p.at).fold(0.0, f64::max);
        let scale = axis(0.0, largest, 5, false);
        let end = scale.max;
        let (across, up) = (|v: f64| left + SIDE * v / end, |v: f64| TOP + SIDE * (1.0 - v / end));
        for (tick, label) in &scale.ticks {
            let (x, y) = (across(*tick), up(*tick));
            let _ = writeln!(
                out,
                "<path d=\"M{x:.1} {TOP}v{SIDE}M{left} {y:.1}h{SIDE}\" stroke=\"#e3e6e9\"/>\
                 <text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>\
                 <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
                TOP + SIDE + 18.0,
                left - 8.0,
                y + 4.0
            );
        }
        let dashed = " stroke-dasharray=\"5 4\"";
        for (factor, dash) in [(1.0, ""), (1.0 + self.band, dashed), (1.0 / (1.0 + self.band), dashed)] {
            let far = end / f64::max(factor, 1.0);
            let _ = writeln!(
                out,
                "<path d=\"M{left} {}L{:.1} {:.1}\" stroke=\"#7a848d\"{dash}/>",
                TOP + SIDE,
                across(far),
                up(far * factor)
            );
        }
        for point in self.points.iter().filter(valid) {
            let colour = COLOURS[point.group % COLOURS.len()];
            let fill = if point.is_bound { "#fff" } else { colour };
            let _ = writeln!(
                out,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"4.5\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.5\"><title>{}</title></circle>",
                across(point.at[0]),
                up(point.at[1]),
                escape(&point.name)
            );
        }
        self.words(out, left);
    }

    /// Title, groups and names of the axes.
    fn words(&self, out: &mut String, left: f64) {
        let _ = writeln!(out, "<text x=\"{left}\" y=\"50\">{}</text>", escape(&self.title));
        let mut x = left;
        for (group, name) in self.groups.iter().enumerate() {
            let colour = COLOURS[group % COLOURS.len()];
            let _ = writeln!(
                out,
                "<circle cx=\"{}\" cy=\"66\" r=\"4.5\" fill=\"{colour}\"/><text x=\"{}\" y=\"70\">{}</text>",
                x + 5.0,
                x + 15.0,
                escape(name)
            );
            x += 30.0 + 7.5 * name.chars().count() as f64;
        }
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
             <text transform=\"translate({} {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            left + 0.5 * SIDE,
            TOP + SIDE + 42.0,
            escape(&self.axes[0]),
            left - 48.0,
            TOP + 0.5 * SIDE,
            escape(&self.axes[1])
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_quantities_lie_on_the_line_and_bounds_are_hollow() {
        let point = |at, is_bound| Point { at, name: "a<b".into(), group: 0, is_bound };
        let panel = Panel {
            title: "moment".into(),
            axes: ["measured".into(), "computed".into()],
            groups: vec!["bending".into()],
            points: vec![point([10.0, 10.0], false), point([5.0, 20.0], true), point([f64::NAN, 1.0], false)],
            band: 0.2,
        };
        let text = svg("columns", &[panel.clone(), panel]);
        // a legend and two points a panel; the one that is not a number is left out
        assert_eq!(text.matches("<circle").count(), 6);
        assert_eq!(text.matches("fill=\"#fff\" stroke").count(), 2);
        assert!(text.contains("a&lt;b") && !text.contains("NaN"));
        // 10 of 20 across and up
        let (x, y) = (LEFT + 0.5 * SIDE, TOP + 0.5 * SIDE);
        assert!(text.contains(&format!("cx=\"{x:.1}\" cy=\"{y:.1}\"")), "{text}");
    }
}
