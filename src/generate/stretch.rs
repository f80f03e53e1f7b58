//! How far floors reach between columns that stand, and beyond the last of them, while charges go off.
//!
//! A column stands while it and all below it in its place are there. A floor whose columns go one row after the other hangs over the rest like a cantilever, as long as the rows that have gone are wide.

use crate::building::rows::rows;
use crate::building::{Building, Member, MemberKind};
use std::collections::{BTreeMap, BTreeSet};

/// Longest stretch of the floor of each storey along x or y, over all times at which any of its columns stands \[m\].
pub fn stretches(building: &Building) -> BTreeMap<Option<u32>, f64> {
    let columns: Vec<&Member> = building.members.iter().filter(|m| m.kind == MemberKind::Column).collect();
    let axes = [0, 1].map(|i| {
        let places = columns.iter().map(|m| [m.solid.center()[i], 0.0]).collect();
        rows(places).iter().map(|axis| axis.at_m).collect::<Vec<f64>>()
    });
    let stacks = stacks(&columns, &axes);
    let edges = edges(building);
    let mut longest = BTreeMap::new();
    for gone in stages(building) {
        let mut standing = BTreeMap::<Option<u32>, [BTreeSet<usize>; 2]>::new();
        for (place, stack) in &stacks {
            for column in stack.iter().take_while(|c| !gone.contains(c.id.as_str())) {
                let of_storey = standing.entry(column.storey).or_default();
                (0..2).for_each(|i| _ = of_storey[i].insert(place[i]));
            }
        }
        for (storey, rows) in &standing {
            let Some(edges) = edges.get(storey) else { continue };
            for i in 0..2 {
                let held: &mut f64 = longest.entry(*storey).or_default();
                *held = held.max(reach(&rows[i], &axes[i], edges[i]));
            }
        }
    }
    longest
}

/// Longest distance between neighbouring rows, and from the outer ones to the edges \[m\].
fn reach(rows: &BTreeSet<usize>, axes: &[f64], edges: [f64; 2]) -> f64 {
    let mut places = vec![edges[0]];
    places.extend(rows.iter().map(|row| axes[*row]));
    places.push(edges[1]);
    places.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max)
}

/// Columns over each other, from below, by the axes that they stand on.
fn stacks<'a>(columns: &[&'a Member], axes: &[Vec<f64>; 2]) -> BTreeMap<[usize; 2], Vec<&'a Member>> {
    let nearest = |i: usize, place: f64| {
        let after = axes[i].partition_point(|axis| *axis < place);
        let away = |k: usize| (axes[i][k] - place).abs();
        (after.saturating_sub(1)..axes[i].len().min(after + 1))
            .min_by(|a, b| away(*a).total_cmp(&away(*b)))
            .unwrap_or(0)
    };
    let mut stacks = BTreeMap::<[usize; 2], Vec<&Member>>::new();
    for column in columns {
        let center = column.solid.center();
        stacks.entry([0, 1].map(|i| nearest(i, center[i]))).or_default().push(column);
    }
    stacks.values_mut().for_each(|s| s.sort_by(|a, b| a.solid.min[2].total_cmp(&b.solid.min[2])));
    stacks
}

/// Members that are gone from the start, and after each time of ignition.
fn stages(building: &Building) -> Vec<BTreeSet<&str>> {
    let cut = || building.members.iter().map(|m| m.id.as_str()).filter(|id| building.is_cut(id));
    let mut events: Vec<_> = building.events.iter().collect();
    events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let mut stages = vec![cut().collect::<BTreeSet<&str>>()];
    for at_once in events.chunk_by(|a, b| a.time_s == b.time_s) {
        let mut gone = stages[stages.len() - 1].clone();
        gone.extend(at_once.iter().map(|e| e.member.as_str()));
        stages.push(gone);
    }
    stages
}

/// Edges of the floors along x and y \[m\].
fn edges(building: &Building) -> BTreeMap<Option<u32>, [[f64; 2]; 2]> {
    let mut edges = BTreeMap::new();
    for member in building.members.iter().filter(|m| matches!(m.kind, MemberKind::Slab | MemberKind::Beam)) {
        let own = edges.entry(member.storey).or_insert([[f64::INFINITY, f64::NEG_INFINITY]; 2]);
        for (i, [low, high]) in own.iter_mut().enumerate() {
            *low = low.min(member.solid.min[i]);
            *high = high.max(member.solid.max[i]);
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tree::Format;
    use crate::building::{EXAMPLE, parse};

    /// The longest stretch of the lowest floor of the reference building, whose front row along y goes, with axes at 0 and 4 m along x, 0 and 5 m along y.
    fn longest(change: impl Fn(&str) -> String) -> f64 {
        let text = change(&EXAMPLE.replace("x = [0, 6] ", "x = [0, 4] "));
        stretches(&parse(&text, Format::Toml, "stretch").expect("a sound building"))[&Some(1)]
    }

    #[test]
    fn a_floor_reaches_from_its_edge_to_the_first_row_that_stands() {
        // from the axis of the rear row to the edge of the slab before the front row
        let hangs = longest(str::to_string);
        assert!(hangs > 5.0 && hangs < 5.5, "{hangs}");
        let later = longest(|text| text.replacen("time = \"0 ms\"", "time = \"80 ms\"", 1));
        assert!((later - hangs).abs() < 1e-12, "{later}");
    }

    #[test]
    fn without_charges_it_is_the_longest_span() {
        let whole = longest(|text| {
            let (before, after) = text.split_once("[[events]]").expect("charges");
            let rest = after.split_once("[settings]").map_or("", |(_, rest)| rest);
            format!("{before}[settings]{rest}")
        });
        assert!((whole - 5.0).abs() < 1e-9, "{whole}");
    }
}
