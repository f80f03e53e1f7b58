//! Openings of plates: rectangles in the plate's plane, cut through its thickness.

use super::fields::Fields;
use super::format::OPENING;
use super::grid::clean;
use super::model::{Member, MemberKind};
use super::partition::COORDINATE_TOLERANCE_M;
use crate::base::diagnostic::{Diagnostic, quoted};
use crate::base::geom::Aabb;
use crate::base::tree::Node;
use crate::base::units::{Dimension, show};

/// Narrowest opening that passes \[m\].
const NARROWEST_M: f64 = 0.1;

/// The corners in the list of openings under a key; `None` if any of them is wrong.
pub fn rectangles(fields: Fields<'_>, key: &str) -> Option<Vec<[[f64; 2]; 2]>> {
    let Some(list) = fields.child(key) else { return Some(Vec::new()) };
    let corner = |fields: Fields<'_>, key| fields.numbers(key)?.try_into().ok();
    list.items()
        .iter()
        .map(|node| {
            let fields = Fields { node, table: &OPENING };
            Some([corner(fields, "from")?, corner(fields, "to")?])
        })
        .collect()
}

/// The box that a rectangle cuts out of a plate.
pub fn through(plate: &Member, corners: [[f64; 2]; 2]) -> Aabb {
    let mut cut = plate.solid;
    for (k, i) in (0..3).filter(|i| *i != plate.axis).enumerate() {
        cut.min[i] = clean(corners[0][k].min(corners[1][k]));
        cut.max[i] = clean(corners[0][k].max(corners[1][k]));
    }
    cut
}

/// Reads the openings of a member; `None` after an error.
pub fn check(
    fields: Fields<'_>,
    key: &str,
    member: &Member,
    found: &mut Vec<Diagnostic>,
) -> Option<Vec<Aabb>> {
    let corners = rectangles(fields, key)?;
    let nodes = fields.child(key).map_or(&[][..], Node::items);
    let before = found.len();
    if let (MemberKind::Column | MemberKind::Beam | MemberKind::Brace, Some(_)) = (member.kind, nodes.first())
    {
        let message = format!("the {} {} cannot have openings", member.kind.name(), quoted(&member.id));
        let error = Diagnostic::error("wrong-kind", message)
            .at(fields.span(key), "only slabs, walls and footings")
            .help("leave `openings` out, or divide the member in two");
        found.push(error);
        return None;
    }
    let cuts: Vec<Aabb> = corners.into_iter().map(|c| through(member, c)).collect();
    for (i, (cut, node)) in cuts.iter().zip(nodes).enumerate() {
        let plane: Vec<usize> = (0..3).filter(|i| *i != member.axis).collect();
        let least = plane.iter().map(|i| cut.size()[*i]).fold(f64::INFINITY, f64::min);
        let outside = plane.iter().find(|i| {
            cut.min[**i] < member.solid.min[**i] - COORDINATE_TOLERANCE_M
                || cut.max[**i] > member.solid.max[**i] + COORDINATE_TOLERANCE_M
        });
        if least < NARROWEST_M {
            let message = format!("this opening is {} wide", show(least, Dimension::Length));
            let error = Diagnostic::error("bad-opening", message)
                .at(node.span, format!("at least {}", show(NARROWEST_M, Dimension::Length)))
                .help("`from` and `to` are two opposite corners; leave small openings out");
            found.push(error);
        } else if let Some(&i) = outside {
            let message =
                format!("this opening reaches out of the {} {}", member.kind.name(), quoted(&member.id));
            let (low, high) = (member.solid.min[i], member.solid.max[i]);
            let [low, high] = [low, high].map(|x| show(x, Dimension::Length));
            let error = Diagnostic::error("bad-opening", message)
                .at(node.span, format!("the member lies between {} = {low} and {high}", ["x", "y", "z"][i]))
                .help("corners are global coordinates in the member's plane");
            found.push(error);
        } else if let Some(j) = (0..i).find(|j| cuts[*j].intersection(cut, COORDINATE_TOLERANCE_M).is_some())
        {
            let error = Diagnostic::error("bad-opening", "two openings overlap")
                .at(node.span, "this one")
                .also(nodes[j].span, "the other")
                .help("join them into one rectangle, or into several that share an edge");
            found.push(error);
        }
    }
    (found.len() == before).then_some(cuts)
}
