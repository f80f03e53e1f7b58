//! Charges on footings that let nothing fall: the ground is where the footing bore what stands on it.

use super::check::some_of;
use super::fields::Placed;
use super::gaps::LEAST_GAP_M;
use super::model::{Member, MemberKind};
use super::read::Draft;
use crate::base::diagnostic::{Diagnostic, quoted};
use crate::base::units::{Dimension, show};

/// Warns of charges that take a footing whose top lies at the level of the ground: what stands on it then stands on the ground.
pub fn check(draft: &Draft, found: &mut Vec<Diagnostic>) {
    let Some(ground) = draft.ground else { return };
    let members = &draft.members.list;
    for event in &draft.events {
        let footing = members.iter().find(|m| m.item.id == event.item.member);
        let Some(footing) = footing.filter(|m| m.item.kind == MemberKind::Footing) else { continue };
        let stays = |m: &&Placed<Member>| {
            let upright = matches!(m.item.kind, MemberKind::Column | MemberKind::Wall);
            let at_ground = m.item.solid.min[2] <= ground.level_m + LEAST_GAP_M;
            upright && at_ground && m.item.stands_on(&footing.item)
        };
        let ids: Vec<&str> = members.iter().filter(stays).map(|m| m.item.id.as_str()).collect();
        let Some(first) = ids.first() else { continue };
        let (stand, level) =
            (if ids.len() == 1 { "stands" } else { "stand" }, show(ground.level_m, Dimension::Length));
        let message = format!(
            "the charge {} takes the footing {}, and {} then {stand} on the ground, at {level}",
            quoted(&event.item.id),
            quoted(&footing.item.id),
            some_of(&ids)
        );
        let warning = Diagnostic::warning("charge-on-footing", message).at(event.span, "nothing falls by it");
        found.push(warning.help(format!(
            "charge {} in place of the footing, or give `ground.level` below the footing if it stands in a pit",
            quoted(first)
        )));
    }
}
