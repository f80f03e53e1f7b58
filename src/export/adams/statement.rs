//! Statements of a dataset: `NAME/id`, then one argument a line behind a comma.

use crate::export::number::{euler_313, list, plain, word};
use crate::mbs::math::{M3, V3};

/// Marker and part of the ground.
pub(super) const GROUND: usize = 1;

/// A dataset that grows.
#[derive(Debug, Default)]
pub(super) struct Dataset {
    pub text: String,
    /// Markers so far.
    markers: usize,
}

impl Dataset {
    /// A headline.
    pub fn section(&mut self, title: &str) {
        self.text += &format!("!\n!{:-^78}\n!\n", format!(" {title} "));
    }

    /// A comment.
    pub fn comment(&mut self, text: &str) {
        for line in text.lines() {
            self.text += &format!("! {line}\n");
        }
    }

    /// A statement with the name that its element has in Adams View.
    pub fn named(&mut self, kind: &str, number: usize, id: &str, arguments: &[String]) {
        self.text += &format!("!  adams_view_name='{}'\n", word(id));
        self.statement(&format!("{kind}/{number}"), arguments);
    }

    /// A statement.
    pub fn statement(&mut self, head: &str, arguments: &[String]) {
        self.text += head;
        self.text.push('\n');
        for argument in arguments {
            self.text += &format!(", {argument}\n");
        }
        self.text += "!\n";
    }

    /// A marker at a point of a part's frame, with axes given as rows in that frame.
    pub fn marker(&mut self, part: usize, point: V3, axes: Option<&M3>) -> usize {
        let mut arguments = vec![format!("PART = {part}")];
        if point != [0.0; 3] {
            arguments.push(format!("QP = {}", list(&point, ", ")));
        }
        if let Some(axes) = axes {
            arguments.extend(reuler(&crate::mbs::math::transpose(axes)));
        }
        self.markers += 1;
        self.statement(&format!("MARKER/{}", self.markers), &arguments);
        self.markers
    }

    /// A marker that moves with another one.
    pub fn floating(&mut self, part: usize) -> usize {
        self.markers += 1;
        self.statement(&format!("MARKER/{}", self.markers), &[format!("PART = {part}"), "FLOATING".into()]);
        self.markers
    }
}

/// The orientation argument of a matrix whose columns are the turned axes; nothing if it turns nothing.
pub(super) fn reuler(r: &M3) -> Option<String> {
    let angles = euler_313(r);
    (angles != [0.0; 3]).then(|| format!("REULER = {}", list(&angles, ", ")))
}

/// `NAME = value`.
pub(super) fn number(name: &str, value: f64) -> String {
    format!("{name} = {}", plain(value))
}
