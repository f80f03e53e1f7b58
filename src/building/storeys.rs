//! Storeys of a building whose members come from no grid.

use super::{Member, MemberKind};

/// Levels nearer to each other than this are one, such as those of a slab and of a depressed part of it \[m\].
const LEAST_STOREY_M: f64 = 1.5;

/// Numbers the storeys of the members, unless a grid has: that of the lowest level which is not below their top, with half of [`LEAST_STOREY_M`] for columns that are given up to the
/// soffit or a little beyond the slab. Levels are the tops of slabs, in a building without any those of beams. What ends above all levels, and a footing, belongs to no storey.
pub(super) fn number(members: &mut [Member]) {
    if members.iter().any(|m| m.storey.is_some()) {
        return;
    }
    let has_slabs = members.iter().any(|m| m.kind == MemberKind::Slab);
    let floor = if has_slabs { MemberKind::Slab } else { MemberKind::Beam };
    let mut levels: Vec<f64> = members.iter().filter(|m| m.kind == floor).map(|m| m.solid.max[2]).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|upper, lower| *upper - *lower < LEAST_STOREY_M);
    for member in members.iter_mut().filter(|m| m.kind != MemberKind::Footing) {
        let below = levels.partition_point(|level| *level < member.solid.max[2] - 0.5 * LEAST_STOREY_M);
        member.storey = (below < levels.len()).then_some(below as u32 + 1);
    }
}

#[cfg(test)]
mod tests {
    use crate::base::tree::Format;
    use crate::building::{Building, EXAMPLE, MemberKind, parse};

    /// The example with its members listed one by one, as a building without a grid has them, and more members.
    fn listed(more: &str) -> Building {
        let building = parse(EXAMPLE, Format::Toml, "example").unwrap();
        let (head, rest) = EXAMPLE.split_once("\n[grid]\n").unwrap();
        let (_, tail) = rest.split_once("\n[[supports]]\n").unwrap();
        let members: String = building
            .members
            .iter()
            .map(|m| {
                let (kind, [a, b]) = (m.kind.name(), [m.solid.min, m.solid.max]);
                let (mut from, mut to) = (m.solid.center(), m.solid.center());
                match m.kind {
                    MemberKind::Slab => (from, to) = ([a[0], a[1], b[2]], b),
                    MemberKind::Beam => {
                        (from[m.axis], to[m.axis]) = (a[m.axis], b[m.axis]);
                        (from[2], to[2]) = (b[2], b[2]);
                    }
                    _ => (from[2], to[2]) = (a[2], b[2]),
                }
                let place = format!("from = {from:?}\nto = {to:?}");
                format!(
                    "[[members]]\nid = \"{}\"\nkind = \"{kind}\"\nsection = \"{}\"\n{place}\n\n",
                    m.id, m.section
                )
            })
            .collect();
        parse(&format!("{head}\n{members}{more}[[supports]]\n{tail}"), Format::Toml, "listed").unwrap()
    }

    #[test]
    fn listed_members_have_the_storeys_that_a_grid_gives_them() {
        let grid = parse(EXAMPLE, Format::Toml, "example").unwrap();
        let storeys = |b: &Building| -> Vec<(String, Option<u32>)> {
            let mut all: Vec<_> = b.members.iter().map(|m| (m.id.clone(), m.storey)).collect();
            all.sort();
            all
        };
        assert_eq!(storeys(&listed("")), storeys(&grid));
        let parapet = "[[members]]\nid = \"P\"\nkind = \"column\"\nsection = \"column\"\nfrom = [0, 0, 10.5]\nto = [0, 0, 12]\n\n";
        let with = listed(parapet);
        assert_eq!(with.members.iter().find(|m| m.id == "P").unwrap().storey, None);
    }
}
