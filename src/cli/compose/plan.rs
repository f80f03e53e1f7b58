//! Plans for the report: the charges with their times, and the outlines of the debris.

use super::Pieces;
use super::scene::what;
use crate::building::{Building, Charge, Member, MemberKind};
use crate::report::{BlastingPlan, DebrisOutline, DebrisPlan, PlanKind, PlanPart, PlannedCharge, StoreyPlan};
use crate::validate::heap::Heap;
use std::collections::{BTreeMap, BTreeSet};

/// The charges, and the storeys that have some.
pub fn blasting(building: &Building) -> Option<BlastingPlan> {
    let heights = heights(building);
    let of = |c: &Charge| building.member(&c.member).and_then(|m| storey_of(m, &heights));
    let storeys: BTreeSet<Option<u32>> = building.events.iter().map(of).collect();
    let charge = |c: &Charge| PlannedCharge {
        id: c.id.clone(),
        what: what(c),
        storey: of(c).map_or("none".into(), |s| s.to_string()),
        time_s: c.time_s,
    };
    (!building.events.is_empty()).then(|| BlastingPlan {
        charges: building.events.iter().map(charge).collect(),
        storeys: storeys.into_iter().map(|s| storey(building, s, &heights)).collect(),
    })
}

fn kind(member: &Member) -> PlanKind {
    match member.kind {
        MemberKind::Slab | MemberKind::Footing => PlanKind::Floor,
        MemberKind::Beam => PlanKind::Beam,
        MemberKind::Column | MemberKind::Wall | MemberKind::Brace => PlanKind::Bearing,
    }
}

/// From where to where what bears in a storey reaches \[m\].
type Heights = BTreeMap<u32, [f64; 2]>;

fn heights(building: &Building) -> Heights {
    let mut heights = Heights::new();
    for member in building.members.iter().filter(|m| kind(m) == PlanKind::Bearing) {
        let Some(storey) = member.storey else { continue };
        let [low, high] = heights.entry(storey).or_insert([f64::INFINITY, f64::NEG_INFINITY]);
        (*low, *high) = (low.min(member.solid.min[2]), high.max(member.solid.max[2]));
    }
    heights
}

/// The storey of a member. One beside a grid has none of its own: it has that whose bearing members stand beside most of its height.
fn storey_of(member: &Member, heights: &Heights) -> Option<u32> {
    let beside = |[low, high]: &[f64; 2]| high.min(member.solid.max[2]) - low.max(member.solid.min[2]);
    let overlaps = heights.iter().map(|(storey, range)| (*storey, beside(range))).filter(|o| o.1 > 0.0);
    // of two alike the lower one
    let most = overlaps.reduce(|best, o| if best.1 >= o.1 { best } else { o });
    member.storey.or(most.map(|o| o.0))
}

/// The members of a storey, with the times of the charges of each.
fn storey(building: &Building, storey: Option<u32>, heights: &Heights) -> StoreyPlan {
    let times_s = |m: &Member| {
        let own = building.events.iter().filter(|c| c.member == m.id);
        let mut times_s: Vec<f64> = own.map(|c| c.time_s).collect();
        times_s.sort_by(f64::total_cmp);
        times_s.dedup();
        times_s
    };
    let part =
        |m: &Member| PlanPart { kind: kind(m), box_m: plan(m.solid.min, m.solid.max), charges_s: times_s(m) };
    let is_here = |m: &&Member| storey_of(m, heights) == storey && !building.is_cut(&m.id);
    let members = building.members.iter().filter(is_here);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tree::Format;
    use crate::building::{EXAMPLE, parse};

    /// A column beside the grid stands in the plan of the storey that it goes through, as its charge does.
    #[test]
    fn members_beside_a_grid_have_the_storey_that_they_stand_in() {
        let mut building = parse(EXAMPLE, Format::Toml, "example.toml").unwrap();
        let is_upper = |m: &&Member| m.kind == MemberKind::Column && m.storey == Some(2);
        let column = building.members.iter().find(is_upper).unwrap().clone();
        building.members.push(Member { id: "beside".into(), storey: None, ..column });
        building.events.truncate(1);
        building.events[0].member = "beside".into();
        let plan = blasting(&building).unwrap();
        assert_eq!((plan.charges[0].storey.as_str(), plan.storeys.len()), ("2", 1));
        let charged = plan.storeys[0].parts.iter().filter(|p| !p.charges_s.is_empty()).count();
        assert!(
            charged == 1 && plan.storeys[0].label.starts_with("Storey 2") && plan.storeys[0].parts.len() > 5
        );
        // several charges on one member, two of them at once
        let first = building.events[0].clone();
        building.events.extend([0.05, 0.025, 0.05].map(|time_s| Charge { time_s, ..first.clone() }));
        building.events[0].time_s = 0.1;
        let plan = blasting(&building).unwrap();
        let times_s = plan.storeys[0].parts.iter().map(|p| p.charges_s.clone()).max_by_key(Vec::len);
        assert_eq!(times_s, Some(vec![0.025, 0.05, 0.1]));
        let beside = building.members.pop().unwrap();
        assert_eq!(storey_of(&beside, &Heights::new()), None, "a building of such members alone");
    }
}
