//! Line charts below each other as an SVG file of its own, with the look of the report in print.

use super::chart::{Chart, Series, escape};
use std::fmt::Write;

/// One line of a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend.
    pub label: String,
    /// Points in display units.
    pub points: Vec<[f64; 2]>,
    /// Drawn black, to compare the others with.
    pub is_reference: bool,
}

/// One chart.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Panel {
    /// Title.
    pub title: String,
    /// What the x axis shows, and its unit.
    pub x: (String, String),
    /// What the y axis shows, and its unit.
    pub y: (String, String),
    /// Lines.
    pub lines: Vec<Line>,
    /// Whether x counts something: its ticks are whole numbers, and each point has a mark.
    pub counts: bool,
}

const WIDTH: f64 = 1124.0;
const CHART_HEIGHT: f64 = 300.0;
const MARGIN: f64 = 24.0;
const LEGEND_ROW: f64 = 20.0;
/// Width of a letter of the legend, about.
const LETTER: f64 = 7.0;
const STYLES: usize = 7;
const REFERENCE_STYLES: usize = 4;

const STYLE: &str = "text{font:13px sans-serif;fill:#1b2127}.plot text{font-size:11.5px;fill:#566069}.title{font-weight:600;font-size:15px}\
.head{font-weight:600}.end{text-anchor:end}.mid{text-anchor:middle}.plot .unit{font-size:12px}\
.plot path{fill:none}.grid{stroke:#e9ecef}.zero,.axis,.tickmark{stroke:#c4cbd1}.cursor{visibility:hidden}\
.line{fill:none;stroke-width:1.7;stroke-linejoin:round;stroke-linecap:round}\
.s0{stroke:#1d5c9e}.s1{stroke:#b8480f;stroke-dasharray:8 3}.s2{stroke:#4b5a66;stroke-dasharray:2 3}\
.s3{stroke:#1d7a63;stroke-dasharray:9 3 2 3}.s4{stroke:#7b4ea3;stroke-dasharray:4 3}.s5{stroke:#94731a;stroke-dasharray:12 4}\
.s6{stroke:#a8201a;stroke-width:2.4}.r0,.r1,.r2,.r3{stroke:#000;stroke-width:2.2}.r0{stroke-dasharray:1 5}.r1{stroke-dasharray:7 5}.r2{stroke-dasharray:7 5 1 5}.r3{stroke-dasharray:14 5}";

/// The panels as one SVG file, with a title and a line of words below it.
pub fn svg(title: &str, words: &str, panels: &[Panel]) -> String {
    let mut body = String::new();
    let mut y = MARGIN + 10.0;
    let _ = write!(
        body,
        "<text class=\"title\" x=\"{MARGIN}\" y=\"{y}\">{}</text><text x=\"{MARGIN}\" y=\"{}\">{}</text>",
        escape(title),
        y + LEGEND_ROW,
        escape(words)
    );
    y += LEGEND_ROW;
    for panel in panels {
        y += 30.0;
        let _ = write!(body, "<text class=\"head\" x=\"{MARGIN}\" y=\"{y}\">{}</text>", escape(&panel.title));
        y = legend(&mut body, panel, y + 6.0);
        let _ = write!(body, "<svg x=\"{MARGIN}\" y=\"{y}\" width=\"{WIDTH}\" height=\"{CHART_HEIGHT}\">");
        panel.chart().svg(&mut body);
        body.push_str("</svg>");
        y += CHART_HEIGHT;
    }
    let (width, height) = (WIDTH + 2.0 * MARGIN, y + MARGIN);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\
         <style>{STYLE}</style><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>{body}</svg>\n"
    )
}

/// The legend below a panel's title; returns where it ends.
fn legend(out: &mut String, panel: &Panel, mut y: f64) -> f64 {
    let mut x = MARGIN;
    y += LEGEND_ROW;
    for (line, class) in panel.lines.iter().zip(panel.classes()) {
        let width = 48.0 + LETTER * line.label.chars().count() as f64;
        if x > MARGIN && x + width > WIDTH {
            x = MARGIN;
            y += LEGEND_ROW;
        }
        let _ = write!(
            out,
            "<path class=\"line {class}\" d=\"M{x} {}h26\"/><text x=\"{}\" y=\"{y}\">{}</text>",
            y - 4.0,
            x + 32.0,
            escape(&line.label)
        );
        x += width;
    }
    y + 8.0
}

impl Panel {
    fn classes(&self) -> Vec<String> {
        let mut next = [0, 0];
        let class = |line: &Line| {
            let (count, letter, styles) = if line.is_reference {
                (&mut next[1], 'r', REFERENCE_STYLES)
            } else {
                (&mut next[0], 's', STYLES)
            };
            *count += 1;
            format!("{letter}{}", (*count - 1) % styles)
        };
        self.lines.iter().map(class).collect()
    }

    fn chart(&self) -> Chart {
        let series = self.lines.iter().zip(self.classes());
        Chart {
            title: self.title.clone(),
            x: self.x.clone(),
            y: self.y.clone(),
            series: series
                .map(|(l, class)| Series { label: l.label.clone(), class, points: l.points.clone() })
                .collect(),
            x_counts: self.counts,
            ..Chart::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_has_every_line_once_in_the_drawing_and_once_in_the_legend() {
        let line = |label: &str, is_reference| Line {
            label: label.into(),
            points: vec![[0.0, 0.0], [1.0, 2.0], [2.0, 1.0]],
            is_reference,
        };
        let lines = vec![line("N = 0", false), line("test <A>", true), line("N = 1", false)];
        let panel = Panel { title: "axis 1".into(), lines, ..Panel::default() };
        let text = svg("a & b", "in words", &[panel.clone(), panel]);
        assert_eq!(text.matches("class=\"line s0\"").count(), 4);
        assert_eq!(text.matches("class=\"line s1\"").count(), 4);
        assert_eq!(text.matches("class=\"line r0\"").count(), 4);
        assert!(text.contains("a &amp; b") && text.contains("test &lt;A&gt;") && !text.contains("NaN"));
        assert_eq!(text.matches("<svg").count(), text.matches("</svg>").count());
    }
}
