//! What happens to single bars and ties while a member end is bent.

use super::member::RcMember;
use crate::fe::dynamics::Dynamics;
use serde::Serialize;
use std::collections::BTreeSet;

/// A bar counts as buckled when its average stress has fallen to this share of the straight bar's.
const BUCKLED_SHARE: f64 = 0.9;

/// What happens.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// The average compressive stress of a bar between two ties has fallen to 90 % of the straight bar's.
    BarBuckles,
    /// A bar reaches its ultimate strain.
    BarRuptures,
    /// A bar begins to slide out of its anchorage.
    BarPullsOut,
    /// A leg of a tie reaches its ultimate strain.
    TieRuptures,
}

impl EventKind {
    /// All kinds, in the order in which they are told.
    pub const ALL: [Self; 4] = [Self::BarBuckles, Self::BarRuptures, Self::BarPullsOut, Self::TieRuptures];

    /// In words, as of several.
    pub fn words(self) -> &'static str {
        match self {
            Self::BarBuckles => "bars buckle",
            Self::BarRuptures => "bars rupture",
            Self::BarPullsOut => "bars pull out",
            Self::TieRuptures => "tie legs rupture",
        }
    }
}

/// One event: the first of its kind of a bar, or of the leg of a tie.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Event {
    /// What.
    pub kind: EventKind,
    /// Rotation of the chord \[rad\].
    pub rotation_rad: f64,
    /// Where in the undeformed member: along width, depth and height above the end section \[m\].
    pub place_m: [f64; 3],
    /// Direction of the bar or the leg: 0 along the width, 1 along the depth, 2 along the member.
    pub along: usize,
}

/// Looks for events.
#[derive(Debug)]
pub struct Watch<'a> {
    member: &'a RcMember,
    is_bar: Vec<bool>,
    seen: BTreeSet<(EventKind, usize, [i64; 2])>,
}

impl<'a> Watch<'a> {
    /// Of a member of which nothing has been told.
    pub fn of(member: &'a RcMember) -> Self {
        let mut is_bar = vec![false; member.mesh.trusses.len()];
        member.bars.iter().for_each(|t| is_bar[*t] = true);
        Self { member, is_bar, seen: BTreeSet::new() }
    }

    /// Adds what is new at a rotation \[rad\]; `sliding` are the nodes of bars that slide.
    pub fn look(
        &mut self,
        body: &Dynamics,
        sliding: impl Iterator<Item = usize>,
        rotation_rad: f64,
        events: &mut Vec<Event>,
    ) {
        for (t, bar) in body.trusses.bars.iter().enumerate() {
            let state = &bar.rebar;
            let kind = match (self.is_bar[t], bar.acts) {
                (true, false) => EventKind::BarRuptures,
                (false, false) => EventKind::TieRuptures,
                (true, true)
                    if state.straight_pa < 0.0 && state.stress_pa > BUCKLED_SHARE * state.straight_pa =>
                {
                    EventKind::BarBuckles
                }
                _ => continue,
            };
            let [a, b] = self.member.mesh.trusses[t].nodes.map(|n| self.member.mesh.nodes[n]);
            let along = (0..3).find(|i| (b[*i] - a[*i]).abs() > 1e-9).unwrap_or(2);
            let place_m = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
            self.tell(Event { kind, rotation_rad, place_m, along }, events);
        }
        for node in sliding {
            let place_m = self.member.mesh.nodes[node];
            let event = Event { kind: EventKind::BarPullsOut, rotation_rad, place_m, along: 2 };
            self.tell(event, events);
        }
    }

    /// Adds an event if it is the first of its kind on this line.
    fn tell(&mut self, event: Event, events: &mut Vec<Event>) {
        let across = [(event.along + 1) % 3, (event.along + 2) % 3];
        let line = across.map(|i| (1e6 * event.place_m[i]).round() as i64);
        if self.seen.insert((event.kind, event.along, line)) {
            events.push(event);
        }
    }
}

/// Each kind in a line of words: when and where it begins, and how often it happens.
pub fn in_words(events: &[Event]) -> Vec<String> {
    let kinds = EventKind::ALL.iter().filter_map(|kind| {
        let all: Vec<&Event> = events.iter().filter(|e| e.kind == *kind).collect();
        let first = all.first()?;
        let [x, y, z] = first.place_m.map(|c| 1e3 * c);
        let place = match first.along {
            0 => format!("leg at y = {y:.0} mm, {z:.0} mm above the end section"),
            1 => format!("leg at x = {x:.0} mm, {z:.0} mm above the end section"),
            _ => format!("at x = {x:.0}, y = {y:.0} mm, {z:.0} mm above the end section"),
        };
        let from = 1e3 * first.rotation_rad;
        Some(format!("{} from {from:.1} mrad ({place}), {} in all", kind.words(), all.len()))
    });
    kinds.collect()
}
