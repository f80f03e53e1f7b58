//! Plans for the report: the charges with their times, and the outlines of the debris.

use super::Pieces;
use super::scene::what;
use crate::building::{Building, Charge, Member, MemberKind};
use crate::report::{BlastingPlan, DebrisOutline, DebrisPlan, PlanKind, PlanPart, PlannedCharge, StoreyPlan};
use crate::validate::heap::Heap;
use std::collections::BTreeSet;

/// The charges, and the storeys that have some.
pub fn blasting(building: &Building) -> Option<BlastingPlan> {
    let of = |c: &Charge| building.member(&c.member).and_then(|m| m.storey);
    let storeys: BTreeSet<Option<u32>> = building.events.iter().map(of).collect();
    let charge = |c: &Charge| PlannedCharge {
        id: c.id.clone(),
        what: what(c),
        storey: of(c).map_or("none".into(), |s| s.to_string()),
        time_s: c.time_s,
    };
    (!building.events.is_empty()).then(|| BlastingPlan {
        charges: building.events.iter().map(charge).collect(),
        storeys: storeys.into_iter().map(|s| storey(building, s)).collect(),
    })
}

/// The members of a storey, with the first charge of each.
fn storey(building: &Building, storey: Option<u32>) -> StoreyPlan {
    let first_s = |m: &Member| {
        let own = building.events.iter().filter(|c| c.member == m.id);
        own.map(|c| c.time_s).reduce(f64::min)
    };
    let part = |m: &Member| PlanPart {
        kind: match m.kind {
            MemberKind::Slab | MemberKind::Footing => PlanKind::Floor,
            MemberKind::Beam => PlanKind::Beam,
            MemberKind::Column | MemberKind::Wall | MemberKind::Brace => PlanKind::Bearing,
        },
        box_m: plan(m.solid.min, m.solid.max),
        charge_s: first_s(m),
    };
    let members = building.members.iter().filter(|m| m.storey == storey && !building.is_cut(&m.id));
    StoreyPlan {
        label: match storey {
            Some(number) => format!("Storey {number}: ignition times in ms"),
            None => "Members without a storey: ignition times in ms".into(),
        },
        parts: members.map(part).collect(),
    }
}

fn plan(min: [f64; 3], max: [f64; 3]) -> [[f64; 2]; 2] {
    [[min[0], min[1]], [max[0], max[1]]]
}

/// The debris of all runs, where the building has come down in FE or in the MBS.
pub fn debris(p: &Pieces) -> Option<DebrisPlan> {
    if p.stands() {
        return None;
    }
    let names = [("FE", "fe"), ("hybrid", "hybrid")].into_iter();
    let of_fe = names.zip(p.fe_runs()).map(|((run, class), fe)| (run, class, Heap::of_fe(fe)));
    let heaps = of_fe.chain([("MBS", "mbs", Heap::of_mbs(&p.generated.model, p.mbs))]);
    let members: Vec<[[f64; 2]; 2]> =
        p.building.members.iter().map(|m| plan(m.solid.min, m.solid.max)).collect();
    let around = around(members.iter().flatten().copied())?;
    let falling = p.falling();
    let speed_m_s = |run: &str| falling.iter().find(|(name, _)| *name == run).map(|(_, f)| f.speed_m_s);
    let outline = |(run, class, heap): (&str, &str, Heap)| {
        let outline_m = heap.footprint.outline();
        let reach = self::around(outline_m.iter().flatten().copied())?;
        Some(DebrisOutline {
            run: run.into(),
            class: class.into(),
            area_m2: heap.footprint.area_m2(),
            reach_m: [
                around[0][0] - reach[0][0],
                reach[1][0] - around[1][0],
                around[0][1] - reach[0][1],
                reach[1][1] - around[1][1],
            ],
            top_m: heap.top_m - p.building.ground.level_m,
            speed_m_s: speed_m_s(run),
            outline_m,
        })
    };
    Some(DebrisPlan {
        building_m: members,
        obstacles_m: p.building.obstacles.iter().map(|o| plan(o.solid.min, o.solid.max)).collect(),
        runs: heaps.filter_map(outline).collect(),
    })
}

/// The box around some points, lower and upper corner.
fn around(points: impl Iterator<Item = [f64; 2]>) -> Option<[[f64; 2]; 2]> {
    points.fold(None, |all: Option<[[f64; 2]; 2]>, p| {
        let [low, high] = all.unwrap_or([p, p]);
        Some([[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]])
    })
}
