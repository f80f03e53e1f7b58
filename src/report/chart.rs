//! One line chart as a `<figure>` with inline SVG.
//!
//! Colours, dashes and fonts come from the page's style sheet by class, so that a chart follows light, dark
//! and print. The read-out under the pointer (`templates/charts.js`) takes its numbers from the paths and
//! from the axis ranges in the `data-` attributes.

use super::number::{Axis, axis, fixed, significant};
use std::fmt::Write;

/// One line.
pub struct Series {
    /// Name in the legend.
    pub label: String,
    /// Style class: `fe`, `mbs` or `s0` … `s6`.
    pub class: String,
    /// Points in display units; a non-finite number is a gap.
    pub points: Vec<[f64; 2]>,
}

/// A vertical line with a label.
pub struct Mark {
    /// Position.
    pub x: f64,
    /// Label.
    pub label: String,
    /// Style class of the line.
    pub class: &'static str,
}

/// How much of the page's width a chart takes. The drawing is laid out in about as many units as it gets
/// pixels, so that its letters are as large as the text around it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Size {
    /// All of it.
    #[default]
    Wide,
    /// Half.
    Half,
    /// A third.
    Third,
}

/// A line chart.
#[derive(Default)]
pub struct Chart {
    /// Title.
    pub title: String,
    /// What the x axis shows, and its unit.
    pub x: (String, String),
    /// What the y axis shows, and its unit.
    pub y: (String, String),
    /// Lines.
    pub series: Vec<Series>,
    /// Vertical marks.
    pub marks: Vec<Mark>,
    /// Horizontal limit lines: from, to (on x), height, label.
    pub limits: Vec<(f64, f64, f64, String)>,
    /// Shaded range of x.
    pub shade: Option<[f64; 2]>,
    /// Range of y that must be visible.
    pub y_range: Option<[f64; 2]>,
    /// Whether x is the time of the runs: the player's time is shown and a click goes there.
    pub is_time: bool,
    /// Whether x counts something: its ticks are whole numbers, and each point has a mark.
    pub x_counts: bool,
    /// Size on the page.
    pub size: Size,
    /// Leave the legend out.
    pub no_legend: bool,
}

/// Text for HTML and XML.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if c.is_control() && c != '\n' && c != '\t' => {}
            c => out.push(c),
        }
    }
    out
}

/// Width of a letter of a label, in units of the drawing.
const LETTER: f64 = 6.4;

/// The drawing area within the SVG.
struct Frame {
    width: f64,
    height: f64,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Frame {
    fn x(&self, axis: &Axis, value: f64) -> f64 {
        self.left + (value - axis.min) / (axis.max - axis.min) * (self.right - self.left)
    }

    fn y(&self, axis: &Axis, value: f64) -> f64 {
        self.bottom - (value - axis.min) / (axis.max - axis.min) * (self.bottom - self.top)
    }
}

impl Chart {
    /// The chart as HTML.
    pub fn to_html(&self) -> String {
        let mut out = String::new();
        let class = if self.size == Size::Third { "chart small" } else { "chart" };
        let _ = write!(out, "<figure class=\"{class}\"><figcaption>{}</figcaption>", escape(&self.title));
        let drawable = self.series.iter().any(|s| s.points.iter().any(|p| p.iter().all(|v| v.is_finite())));
        if drawable {
            if !self.no_legend {
                self.legend(&mut out);
            }
            self.svg(&mut out);
        } else {
            out.push_str("<p class=\"empty\">Not recorded.</p>");
        }
        out.push_str("</figure>");
        out
    }

    fn legend(&self, out: &mut String) {
        out.push_str("<ul class=\"legend\">");
        for series in &self.series {
            let _ = write!(
                out,
                "<li><svg width=\"26\" height=\"8\" aria-hidden=\"true\"><path class=\"line {}\" d=\"M1 4H25\"/></svg>{}</li>",
                series.class,
                escape(&series.label)
            );
        }
        out.push_str("</ul>");
    }

    fn axes(&self) -> (Axis, Axis) {
        let range = |k: usize| {
            let values = self.series.iter().flat_map(|s| &s.points);
            values
                .filter(|p| p.iter().all(|v| v.is_finite()))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| (lo.min(p[k]), hi.max(p[k])))
        };
        let (x0, x1) = range(0);
        let (mut y0, mut y1) = range(1);
        if let Some([lo, hi]) = self.y_range {
            (y0, y1) = (y0.min(lo), y1.max(hi));
        }
        for limit in &self.limits {
            (y0, y1) = (y0.min(limit.2), y1.max(limit.2));
        }
        let wanted = match self.size {
            Size::Wide => (10, 5),
            Size::Half => (6, 5),
            Size::Third => (5, 4),
        };
        let ys = axis(y0, y1, wanted.1, false);
        if self.x_counts && x0 <= x1 {
            // no more ticks than whole numbers, and room for the first and the last point
            let (low, high) = (x0 - 0.5, x1 + 0.5);
            return (axis(low, high, wanted.0.min((high - low) as usize), true), ys);
        }
        (axis(x0, x1, wanted.0, true), ys)
    }

    /// The drawing without title and legend.
    pub(super) fn svg(&self, out: &mut String) {
        let (width, height) = match self.size {
            Size::Wide => (1124.0, 300.0),
            Size::Half => (547.0, 260.0),
            Size::Third => (360.0, 190.0),
        };
        let (xs, ys) = self.axes();
        let widest = ys.ticks.iter().map(|t| t.1.chars().count()).max().unwrap_or(1) as f64;
        let frame = Frame {
            width,
            height,
            left: 12.0 + LETTER * widest,
            right: width - 12.0,
            top: if self.marks.is_empty() { 22.0 } else { 36.0 },
            bottom: height - 34.0,
        };
        let _ = write!(
            out,
            "<svg class=\"plot\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\" data-x=\"{} {} {} {}\" \
             data-y=\"{} {} {} {}\" data-xname=\"{}\" data-xunit=\"{}\" data-yunit=\"{}\"{}>",
            escape(&self.describe()),
            xs.min,
            xs.max,
            coordinate(frame.left),
            coordinate(frame.right),
            ys.min,
            ys.max,
            coordinate(frame.bottom),
            coordinate(frame.top),
            escape(&self.x.0),
            escape(&self.x.1),
            escape(&self.y.1),
            if self.is_time { " data-time" } else { "" },
        );
        self.grid(out, &frame, &xs, &ys);
        self.limit_lines(out, &frame, &xs, &ys);
        for series in &self.series {
            let d = path(&series.points, |p| [frame.x(&xs, p[0]), frame.y(&ys, p[1])]);
            let _ = write!(
                out,
                "<path class=\"line {}\" data-label=\"{}\" d=\"{d}\"/>",
                series.class,
                escape(&series.label)
            );
        }
        if self.x_counts {
            self.points(out, &frame, &xs, &ys);
        }
        self.mark_lines(out, &frame, &xs);
        let _ = write!(
            out,
            "<line class=\"cursor\" y1=\"{}\" y2=\"{}\" visibility=\"hidden\"/></svg>",
            coordinate(frame.top),
            coordinate(frame.bottom)
        );
    }

    /// The chart in words, for those who do not see it.
    fn describe(&self) -> String {
        let mut text =
            format!("{}: {} [{}] over {} [{}].", self.title, self.y.0, self.y.1, self.x.0, self.x.1);
        for series in &self.series {
            let values = series.points.iter().map(|p| p[1]).filter(|v| v.is_finite());
            let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            if lo <= hi {
                let _ =
                    write!(text, " {} from {} to {}.", series.label, significant(lo, 3), significant(hi, 3));
            }
        }
        text
    }

    fn grid(&self, out: &mut String, f: &Frame, xs: &Axis, ys: &Axis) {
        if let Some([from, to]) = self.shade {
            let (a, b) = (f.x(xs, from.max(xs.min)), f.x(xs, to.min(xs.max)));
            if b > a {
                let _ = write!(
                    out,
                    "<rect class=\"shade\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>",
                    coordinate(a),
                    coordinate(f.top),
                    coordinate(b - a),
                    coordinate(f.bottom - f.top)
                );
            }
        }
        for (value, label) in &ys.ticks {
            let y = coordinate(f.y(ys, *value));
            let class = if *value == 0.0 { "grid zero" } else { "grid" };
            let _ = write!(
                out,
                "<path class=\"{class}\" d=\"M{} {y}H{}\"/><text class=\"tick end\" x=\"{}\" y=\"{y}\" dy=\".35em\">{label}</text>",
                coordinate(f.left),
                coordinate(f.right),
                coordinate(f.left - 6.0)
            );
        }
        for (value, label) in &xs.ticks {
            let x = coordinate(f.x(xs, *value));
            let _ = write!(
                out,
                "<path class=\"tickmark\" d=\"M{x} {}v4\"/><text class=\"tick mid\" x=\"{x}\" y=\"{}\">{label}</text>",
                coordinate(f.bottom),
                coordinate(f.bottom + 16.0)
            );
        }
        let _ = write!(
            out,
            "<path class=\"axis\" d=\"M{} {}H{}\"/><text class=\"unit\" x=\"{}\" y=\"11\">{}</text>\
             <text class=\"unit end\" x=\"{}\" y=\"{}\">{}</text>",
            coordinate(f.left),
            coordinate(f.bottom),
            coordinate(f.right),
            coordinate(4.0),
            escape(&with_unit(&self.y)),
            coordinate(f.width - 12.0),
            coordinate(f.height - 4.0),
            escape(&with_unit(&self.x)),
        );
    }

    fn limit_lines(&self, out: &mut String, f: &Frame, xs: &Axis, ys: &Axis) {
        for (from, to, height, label) in &self.limits {
            let (a, b) = (f.x(xs, from.max(xs.min)), f.x(xs, to.min(xs.max)));
            let y = f.y(ys, *height);
            // the label stands below its line, or above where a curve goes through it below and none does above
            let from = b - 6.0 - LETTER * label.chars().count() as f64;
            let points = self.series.iter().flat_map(|s| &s.points).map(|p| [f.x(xs, p[0]), f.y(ys, p[1])]);
            let beside: Vec<f64> = points.filter(|p| (from..b).contains(&p[0])).map(|p| p[1]).collect();
            let is_free = |top: f64| !beside.iter().any(|y| (top..top + 14.0).contains(y));
            let base = if is_free(y + 3.0) || !is_free(y - 17.0) { y + 14.0 } else { y - 5.0 };
            if b > a {
                let _ = write!(
                    out,
                    "<path class=\"limit\" d=\"M{} {}H{}\"/><text class=\"tick end over\" x=\"{}\" y=\"{}\">{}</text>",
                    coordinate(a),
                    coordinate(y),
                    coordinate(b),
                    coordinate(b - 6.0),
                    coordinate(base),
                    escape(label)
                );
            }
        }
    }

    /// A mark at each point: a line through one point alone is not seen.
    fn points(&self, out: &mut String, f: &Frame, xs: &Axis, ys: &Axis) {
        for series in &self.series {
            for p in series.points.iter().filter(|p| p.iter().all(|v| v.is_finite())) {
                let _ = write!(
                    out,
                    "<circle class=\"line {}\" style=\"stroke-dasharray:none\" cx=\"{}\" cy=\"{}\" r=\"3\"/>",
                    series.class,
                    coordinate(f.x(xs, p[0])),
                    coordinate(f.y(ys, p[1]))
                );
            }
        }
    }

    fn mark_lines(&self, out: &mut String, f: &Frame, xs: &Axis) {
        let inside = |m: &&Mark| m.x >= xs.min && m.x <= xs.max;
        let mut marks: Vec<&Mark> = self.marks.iter().filter(inside).collect();
        marks.sort_by(|a, b| a.x.total_cmp(&b.x));
        let last = marks.len().saturating_sub(1);
        for (i, mark) in marks.into_iter().enumerate() {
            let x = f.x(xs, mark.x);
            // Two marks are close together as a rule: the first is labelled to its left, the last to its right.
            let is_right = if last > 0 { i == last } else { x < 0.3 * f.width };
            let width = 4.0 + LETTER * mark.label.chars().count() as f64;
            let has_room = if is_right { x + width <= f.width } else { x - width >= 0.0 };
            // Without room there it goes to the other side, over the label of the other mark.
            let (side, shift) = if is_right == has_room { ("start", 4.0) } else { ("end", -4.0) };
            let rise = if has_room || last == 0 { 4.0 } else { 15.0 };
            let _ = write!(
                out,
                "<path class=\"mark {}\" d=\"M{} {}V{}\"/><text class=\"tick {side}\" x=\"{}\" y=\"{}\">{}</text>",
                mark.class,
                coordinate(x),
                coordinate(f.top - 12.0),
                coordinate(f.bottom),
                coordinate(x + shift),
                coordinate(f.top - rise),
                escape(&mark.label)
            );
        }
    }
}

fn with_unit((name, unit): &(String, String)) -> String {
    if unit.is_empty() { name.clone() } else { format!("{name} [{unit}]") }
}

/// A coordinate with at most two decimals.
fn coordinate(x: f64) -> String {
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// The path of a line: gaps at non-finite points; points that lie within a tenth of a unit of the line between
/// their kept neighbours are left out.
fn path(points: &[[f64; 2]], place: impl Fn(&[f64; 2]) -> [f64; 2]) -> String {
    let mut d = String::new();
    for run in points.split(|p| !p.iter().all(|v| v.is_finite())) {
        let run: Vec<[f64; 2]> = run.iter().map(&place).collect();
        let mut start = 'M';
        for p in simplify(&run, 0.1) {
            let _ = write!(d, "{start}{} {}", coordinate(p[0]), coordinate(p[1]));
            start = 'L';
        }
        if run.len() == 1 {
            d.push_str("h0"); // a round cap shows a lone point
        }
    }
    d
}

/// Greedy simplification of a function graph: each left-out point is within `tolerance` of the chord.
fn simplify(run: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = run.first().copied().into_iter().collect();
    let mut from = 0;
    for to in 2..run.len() {
        let (a, b) = (run[from], run[to]);
        let off = |p: &[f64; 2]| {
            let width = b[0] - a[0];
            if width <= 0.0 {
                return f64::INFINITY;
            }
            (a[1] + (b[1] - a[1]) * (p[0] - a[0]) / width - p[1]).abs()
        };
        // A chord of at most 64 points keeps the effort linear.
        if to - from > 64 || run[from + 1..to].iter().any(|p| off(p) > tolerance) {
            from = to - 1;
            kept.push(run[from]);
        }
    }
    if run.len() > 1 {
        kept.extend(run.last());
    }
    kept
}

/// A time for a label: "1.12 s".
pub fn seconds(t: f64) -> String {
    format!("{} s", fixed(t, if t.abs() < 10.0 { 3 } else { 2 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<[f64; 2]>) -> String {
        let series = vec![Series { label: "a<b".into(), class: "fe".into(), points }];
        Chart {
            title: "t".into(),
            x: ("time".into(), "s".into()),
            y: ("u".into(), "m".into()),
            series,
            ..Chart::default()
        }
        .to_html()
    }

    #[test]
    fn a_gap_starts_a_new_stretch_and_never_prints_nan() {
        let html = chart(vec![[0.0, 0.0], [1.0, 1.0], [2.0, f64::NAN], [3.0, 1.0], [4.0, 0.0]]);
        let d = html.split("data-label=\"a&lt;b\" d=\"").nth(1).unwrap().split('"').next().unwrap();
        assert_eq!(d.matches('M').count(), 2, "{d}");
        assert!(!html.contains("NaN") && !html.contains("inf"));
    }

    /// Cycles are counted: one of them is a point in the middle, ten have no tick between two of them.
    #[test]
    fn what_is_counted_has_whole_ticks_and_a_mark_each() {
        let drawn = |count: u32| {
            let points = (1..=count).map(|i| [f64::from(i), 2.0]).collect();
            let series = vec![Series { label: "energy".into(), class: "s0".into(), points }];
            Chart { series, x_counts: true, ..Chart::default() }.to_html()
        };
        let one = drawn(1);
        assert_eq!((one.matches("<circle").count(), one.matches("tick mid").count()), (1, 1));
        assert!(one.contains(">1</text>"), "{one}");
        let three = drawn(3);
        assert_eq!((three.matches("<circle").count(), three.matches("tick mid").count()), (3, 3));
    }

    /// The label of a limit stands on the side of its line that the curve leaves free.
    #[test]
    fn labels_of_limits_leave_the_curve_alone() {
        let base = |e: f64| {
            let points = (0..=50).map(|i| [0.05 * f64::from(i), e]).collect();
            let series = vec![Series { label: "e".into(), class: "mbs".into(), points }];
            let limits = vec![(0.0, 2.5, 0.1, "limit 0.10".into())];
            let html = Chart { series, limits, y_range: Some([0.0, 0.2]), ..Chart::default() }.to_html();
            let after = |from: &str, more: &str| {
                let text = html.split(from).nth(1).unwrap().split(more).nth(1).unwrap();
                text.split(['"', 'H']).next().unwrap().parse::<f64>().unwrap()
            };
            after("tick end over", " y=\"") - after("class=\"limit\" d=", " ")
        };
        assert!(base(0.02) > 0.0 && base(0.12) > 0.0, "below the limit");
        assert!(base(0.094) < 0.0, "above it");
    }

    /// Labels of two marks stand apart, within the drawing, wherever the marks are.
    #[test]
    fn labels_of_marks_do_not_overlap() {
        let labels = |at: [f64; 2]| {
            let series =
                vec![Series { label: "e".into(), class: "mbs".into(), points: vec![[0.0, 0.0], [2.5, 1.0]] }];
            let mark = |x| Mark { x, label: "FE contact 0.123 s".into(), class: "fe" };
            let html = Chart { series, marks: at.map(mark).into(), ..Chart::default() }.to_html();
            let places = html.split("<text class=\"tick ").filter(|t| t.contains(">FE contact"));
            let place = |t: &str| {
                let number = |name: &str| {
                    t.split(name).nth(1).unwrap().split('"').next().unwrap().parse::<f64>().unwrap()
                };
                let (x, width) = (number(" x=\""), 18.0 * LETTER);
                let left = if t.starts_with("start") { x } else { x - width };
                assert!(left >= 0.0 && left + width <= 1124.0, "{t}");
                (left, number(" y=\""))
            };
            let [a, b]: [(f64, f64); 2] = places.map(place).collect::<Vec<_>>().try_into().unwrap();
            (a.0 - b.0).abs() >= 18.0 * LETTER || (a.1 - b.1).abs() >= 11.0
        };
        for at in [[0.05, 0.06], [0.02, 0.3], [1.2, 1.21], [2.44, 2.45], [0.1, 2.4]] {
            assert!(labels(at), "{at:?}");
        }
    }

    #[test]
    fn nothing_to_draw_says_so() {
        assert!(chart(vec![]).contains("Not recorded"));
        assert!(chart(vec![[f64::NAN, 1.0]]).contains("Not recorded"));
    }

    #[test]
    fn simplification_stays_within_its_tolerance() {
        let run: Vec<[f64; 2]> =
            (0..400).map(|i| [f64::from(i), 40.0 * (f64::from(i) / 60.0).sin()]).collect();
        let kept = simplify(&run, 0.1);
        assert!(kept.len() < run.len() / 2);
        for p in &run {
            let k = kept.windows(2).find(|w| w[0][0] <= p[0] && p[0] <= w[1][0]).unwrap();
            let y = k[0][1] + (k[1][1] - k[0][1]) * (p[0] - k[0][0]) / (k[1][0] - k[0][0]);
            assert!((y - p[1]).abs() <= 0.1 + 1e-9);
        }
    }
}
