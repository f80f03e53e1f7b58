//! Nodes meant by sets, parts and boxes, as indices.

use super::error::{At, Messages};
use super::raw::{Raw, Who};
use std::collections::{BTreeSet, HashMap, HashSet};

/// Limits of a box that holds all points: in place of one that is wrong, so that nothing follows from it.
pub(super) const EVERYWHERE: [[f64; 2]; 3] = [[f64::NEG_INFINITY, f64::INFINITY]; 3];

/// Looks up what identifiers mean.
pub(super) struct Groups<'a> {
    raw: &'a Raw,
    /// Index of each node identifier (looked up only, never walked through).
    pub node: HashMap<u64, usize>,
}

impl<'a> Groups<'a> {
    /// Enters the nodes; two with one identifier are an error.
    pub fn new(raw: &'a Raw, messages: &mut Messages) -> Self {
        let mut node = HashMap::with_capacity(raw.nodes.len());
        for (index, item) in raw.nodes.iter().enumerate() {
            if node.insert(item.id, index).is_some() {
                let message = format!("*NODE: {} is defined twice", item.id);
                messages.error(item.at, "duplicate-id", message, "", "give one of them another identifier");
            }
        }
        let later = raw.node_ranges.iter().map(|(id, (_, at))| (id, *at));
        for (id, at) in later.chain(raw.node_general.iter().map(|(id, (_, at))| (id, *at))) {
            let general = raw.node_ranges.contains_key(id) && raw.node_general.contains_key(id);
            if raw.node_sets.contains_key(id) || general {
                let message = format!("the set of nodes {id} is defined twice");
                messages.error(at, "duplicate-id", message, "", "give one of them another identifier");
            }
        }
        Self { raw, node }
    }

    /// The index of a node.
    pub fn node(&self, id: u64, at: At, messages: &mut Messages) -> Option<usize> {
        let found = self.node.get(&id).copied();
        if found.is_none() {
            unknown(at, "node", id, "*NODE", messages);
        }
        found
    }

    /// The nodes meant, in the order given (sets) or increasing (others); empty after an error. That there are none is an error: a support or
    /// a wall would be missing.
    pub fn nodes(&self, who: &Who, at: At, messages: &mut Messages) -> Vec<usize> {
        let before = messages.count();
        let found = self.find(who, at, messages);
        if found.is_empty() && messages.count() == before {
            let (meant, help) = match who {
                Who::Set(id) => (format!("set of nodes {id}"), "give it nodes that the deck has"),
                Who::Part(id) => (format!("part {id}"), "give it elements"),
                Who::PartSet(id) => (format!("set of parts {id}"), "give it parts with elements"),
                Who::All | Who::Node(_) => return found,
            };
            let message = format!("the {meant} has no nodes{}", self.ranges_of(who));
            let help = format!("{help}, or take out what refers to it");
            messages.error(at, "no-nodes", message, "referred to here", &help);
        }
        found
    }

    /// Where the ranges of a set are that has no nodes in them, for the message.
    fn ranges_of(&self, who: &Who) -> String {
        let Who::Set(id) = who else { return String::new() };
        let ranges = self.raw.node_ranges.get(id).map_or(&[][..], |(ranges, _)| &ranges[..]);
        let ranges: Vec<String> = ranges.iter().take(4).map(|[from, to]| format!("{from} to {to}")).collect();
        if ranges.is_empty() {
            String::new()
        } else {
            format!(": none is in its ranges {}", ranges.join(", "))
        }
    }

    fn find(&self, who: &Who, at: At, messages: &mut Messages) -> Vec<usize> {
        match who {
            Who::All => (0..self.raw.nodes.len()).collect(),
            Who::Node(id) => self.node(*id, at, messages).into_iter().collect(),
            Who::Set(id) => self.set(*id, at, messages),
            Who::Part(id) => {
                if !self.raw.parts.iter().any(|p| p.id == *id) {
                    unknown(at, "part", *id, "*PART", messages);
                }
                self.of_parts(&[*id])
            }
            Who::PartSet(id) => match self.raw.part_sets.get(id) {
                Some((parts, _)) => self.of_parts(parts),
                None => {
                    unknown(at, "set of parts", *id, "*SET_PART_LIST", messages);
                    Vec::new()
                }
            },
        }
    }

    fn set(&self, id: u64, at: At, messages: &mut Messages) -> Vec<usize> {
        if let Some((ids, place)) = self.raw.node_sets.get(&id) {
            // a set holds a node once, however often it is listed
            let mut seen = HashSet::with_capacity(ids.len());
            let once = ids.iter().filter(|n| seen.insert(**n));
            return once.filter_map(|n| self.node(*n, *place, messages)).collect();
        }
        if let Some((of, place)) = self.raw.node_general.get(&id) {
            let found: BTreeSet<usize> = of.iter().flat_map(|who| self.find(who, *place, messages)).collect();
            return found.into_iter().collect();
        }
        let Some((ranges, _)) = self.raw.node_ranges.get(&id) else {
            unknown(at, "set of nodes", id, "*SET_NODE_LIST", messages);
            return Vec::new();
        };
        let inside = |node: u64| ranges.iter().any(|[from, to]| (*from..=*to).contains(&node));
        (0..self.raw.nodes.len()).filter(|n| inside(self.raw.nodes[*n].id)).collect()
    }

    fn of_parts(&self, parts: &[u64]) -> Vec<usize> {
        let parts: BTreeSet<u64> = parts.iter().copied().collect();
        let solids = self.raw.solids.iter().filter(|s| parts.contains(&s.part)).flat_map(|s| &s.nodes);
        let beams = self.raw.beams.iter().filter(|b| parts.contains(&b.part)).flat_map(|b| &b.nodes);
        let found: BTreeSet<usize> = solids.chain(beams).filter_map(|n| self.node.get(n).copied()).collect();
        found.into_iter().collect()
    }

    /// The limits of a box along each axis; without bounds after an error.
    pub fn limits(&self, id: u64, at: At, messages: &mut Messages) -> [[f64; 2]; 3] {
        match self.raw.boxes.get(&id) {
            Some((sides, _)) => *sides,
            None => {
                unknown(at, "box", id, "*DEFINE_BOX", messages);
                EVERYWHERE
            }
        }
    }
}

/// An error about something that is referred to and not there.
pub(super) fn unknown(at: At, what: &str, id: u64, keyword: &str, messages: &mut Messages) {
    let message = format!("there is no {what} {id}");
    messages.error(at, "unknown-id", message, "referred to here", &format!("define it with {keyword}"));
}
