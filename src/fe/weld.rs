//! Members that the mesh joins though they stand apart in the building.
//!
//! Faces nearer than a quarter of the mesh size become one plane ([`super::merge`]). Where that closes the gap between two members they share nodes, and
//! the model is another structure: an expansion joint is gone, a column that ends below its beam bears it. Such a mesh is refused ([`check`]).
//!
//! Members touch if their solids without the openings do, or what they own of the building ([`Partition`]), to within [`LEAST_GAP_M`] (building files with narrower gaps are refused). Two that do not
//! are welded where they share the face of an element, or nodes that belong to no third member that touches both; not where other members fill the gap
//! between them, as the column does between two beams. Nodes of columns with a mesh of their own ([`super::apart`]) are tied as far away as planes
//! are merged, and judged likewise.

use super::apart::FACES;
use super::mesh::Mesh;
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::building::Building;
use crate::building::gaps::{LEAST_GAP_M, gap, solids};
use crate::building::partition::{COORDINATE_TOLERANCE_M, Partition};
use std::collections::{BTreeMap, BTreeSet};

/// Most pairs that the message lists.
const MOST_LISTED: usize = 5;
/// Where the way across a gap is looked at, as shares of it.
const LOOKS: [f64; 3] = [0.25, 0.5, 0.75];

/// Two members that share nodes though they do not touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Weld {
    /// Their ids, in file order.
    pub members: [String; 2],
    /// The gap that is closed, where it is narrowest \[m\].
    pub gap_m: f64,
    /// A place of the mesh where they are joined \[m\].
    pub at_m: [f64; 3],
    /// Mesh sizes below this keep it open \[m\].
    pub size_below_m: f64,
}

/// A mesh that closes gaps of its building.
#[derive(Debug, Clone, PartialEq)]
pub struct Welds {
    /// The pairs, in file order.
    pub pairs: Vec<Weld>,
    /// Mesh size \[m\].
    pub size_m: f64,
}

impl std::error::Error for Welds {}

impl std::fmt::Display for Welds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}; {}", self.problem(), self.remedy())
    }
}

impl Welds {
    /// What is wrong.
    pub fn problem(&self) -> String {
        let one = |w: &Weld| {
            let ([x, y, z], gap_mm) = (w.at_m, 1e3 * w.gap_m);
            let [a, b] = &w.members;
            format!("`{a}` and `{b}` ({gap_mm:.1} mm, at ({x:.3}, {y:.3}, {z:.3}) m)")
        };
        let listed: Vec<String> = self.pairs.iter().take(MOST_LISTED).map(one).collect();
        let more = match self.pairs.len().saturating_sub(MOST_LISTED) {
            0 => String::new(),
            1 => " and 1 more pair".into(),
            more => format!(" and {more} more pairs"),
        };
        let (size_m, listed) = (self.size_m, listed.join(", "));
        format!("a mesh size of {size_m} m closes gaps between members of the building: {listed}{more}")
    }

    /// What to do about it.
    pub fn remedy(&self) -> String {
        let below_m = self.pairs.iter().map(|w| w.size_below_m).fold(f64::INFINITY, f64::min);
        format!(
            "faces nearer than a quarter of the mesh size become one plane: give a mesh size below {below_m:.3} m (`settings.mesh_size`; `fe --mesh-size`), one of less than \
             four times the gap for one member of each pair in `[[mesh.refine]]`, or close the gaps in the building file"
        )
    }
}

/// Refuses meshes that join what stands apart.
///
/// # Errors
/// If two members share nodes, or are tied, across a gap.
pub fn check(building: &Building, mesh: &Mesh, size_m: f64) -> Result<(), Welds> {
    let parts_at = parts_at(mesh);
    let mut shared: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    for (node, parts) in &parts_at {
        for (i, a) in parts.iter().enumerate() {
            parts[i + 1..].iter().for_each(|b| shared.entry((*a, *b)).or_default().push(*node));
        }
    }
    let tied = tied_across(mesh);
    let pairs = shared.keys().chain(tied.keys()).copied().collect();
    let gaps = Gaps::of(building, &pairs);
    if gaps.apart.is_empty() {
        return Ok(());
    }
    let pairs = gaps.apart.iter().filter_map(|pair| {
        let joined = shared.get(pair).and_then(|nodes| gaps.joined(mesh, *pair, nodes, &parts_at));
        joined.or_else(|| gaps.tied(mesh, *pair, tied.get(pair)?))
    });
    let pairs: Vec<Weld> = pairs.collect();
    if pairs.is_empty() { Ok(()) } else { Err(Welds { pairs, size_m }) }
}

/// The members at nodes that belong to more than one, ascending.
fn parts_at(mesh: &Mesh) -> BTreeMap<usize, Vec<usize>> {
    const NONE: usize = usize::MAX;
    let mut first = vec![NONE; mesh.nodes.len()];
    let mut several: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for element in &mesh.elements {
        for node in element.nodes {
            match first[node] {
                NONE => first[node] = element.part,
                part if part == element.part => {}
                part => several.entry(node).or_insert_with(|| BTreeSet::from([part])).extend([element.part]),
            }
        }
    }
    several.into_iter().map(|(node, parts)| (node, parts.into_iter().collect())).collect()
}

/// The tied nodes between each two members, each with the member it belongs to.
fn tied_across(mesh: &Mesh) -> BTreeMap<(usize, usize), Vec<(usize, usize)>> {
    let mut tied: BTreeMap<(usize, usize), Vec<(usize, usize)>> = BTreeMap::new();
    let to: BTreeMap<usize, usize> =
        mesh.ties.iter().map(|t| (t.node, mesh.elements[t.element].part)).collect();
    let ends = mesh.elements.iter().filter(|_| !to.is_empty());
    for (node, part) in ends.flat_map(|e| e.nodes.map(|n| (n, e.part))) {
        if let Some(other) = to.get(&node).filter(|other| **other != part) {
            tied.entry((part.min(*other), part.max(*other))).or_default().push((node, part));
        }
    }
    tied
}

/// Whether no box of one list comes as near as [`LEAST_GAP_M`] to one of the other.
pub(super) fn are_apart(a: &[Aabb], b: &[Aabb]) -> bool {
    a.iter().all(|p| b.iter().all(|q| gap(p, q).1 > LEAST_GAP_M))
}

/// Pairs of members that stand apart, and what the building has about them.
struct Gaps<'a> {
    building: &'a Building,
    /// Of the pairs asked about those that stand apart, lower index first.
    apart: BTreeSet<(usize, usize)>,
    /// Solids of these members and what they own \[m\].
    boxes: BTreeMap<usize, Vec<Aabb>>,
    /// Solids of all members that are not cut in preparation or turned, to be found by place \[m\].
    all: Vec<(usize, Aabb)>,
    places: Boxes,
}

impl<'a> Gaps<'a> {
    fn of(building: &'a Building, pairs: &BTreeSet<(usize, usize)>) -> Self {
        let members = &building.members;
        let mut apart = pairs.clone();
        apart.retain(|(a, b)| {
            let turned = members[*a].is_skew() || members[*b].is_skew();
            !turned && are_apart(&solids(&members[*a]), &solids(&members[*b]))
        });
        let mut this =
            Self { building, apart, boxes: BTreeMap::new(), all: Vec::new(), places: Boxes::default() };
        if this.apart.is_empty() {
            return this;
        }
        let partition = Partition::of(building);
        for member in this.apart.iter().flat_map(|(a, b)| [*a, *b]) {
            let of = || [solids(&members[member]), partition.boxes_of(member)].concat();
            this.boxes.entry(member).or_insert_with(of);
        }
        this.apart.retain(|(a, b)| are_apart(&this.boxes[a], &this.boxes[b]));
        let there =
            (0..members.len()).filter(|m| !members[*m].is_skew() && !building.is_cut(&members[*m].id));
        this.all = there.flat_map(|m| solids(&members[m]).into_iter().map(move |s| (m, s))).collect();
        this.places = Boxes::of(this.all.iter().map(|(_, solid)| *solid));
        this
    }

    fn are_apart(&self, a: usize, b: usize) -> bool {
        self.apart.contains(&(a.min(b), a.max(b)))
    }

    /// Where two members that stand apart are joined by nodes that they share.
    fn joined(
        &self,
        mesh: &Mesh,
        pair: (usize, usize),
        nodes: &[usize],
        parts_at: &BTreeMap<usize, Vec<usize>>,
    ) -> Option<Weld> {
        let third = |part: usize| {
            part != pair.0 && part != pair.1 && !self.are_apart(part, pair.0) && !self.are_apart(part, pair.1)
        };
        let alone = nodes.iter().filter(|n| !parts_at[*n].iter().any(|part| third(*part)));
        let places = common_faces(mesh, pair, nodes).into_iter().chain(alone.map(|n| mesh.nodes[*n]));
        self.narrowest(pair, places)
    }

    /// Where a tie goes across a gap: its node lies on no other member at all.
    fn tied(&self, mesh: &Mesh, pair: (usize, usize), nodes: &[(usize, usize)]) -> Option<Weld> {
        let hangs = |(node, part): &&(usize, usize)| {
            let point = mesh.nodes[*node];
            let near = self.places.near(&Aabb { min: point, max: point }, LEAST_GAP_M);
            near.iter().all(|at| self.all[*at].0 == *part)
        };
        self.narrowest(pair, nodes.iter().filter(hangs).map(|(node, _)| mesh.nodes[*node]))
    }

    /// The narrowest of the gaps between two members that are closed at some places of the mesh.
    fn narrowest(&self, pair: (usize, usize), places: impl Iterator<Item = [f64; 3]>) -> Option<Weld> {
        let ids = [pair.0, pair.1].map(|m| self.building.members[m].id.clone());
        let closed = places.filter_map(|at_m| self.closed(pair, at_m).map(|gap| (gap, at_m)));
        let ((gap_m, size_below_m), at_m) = closed.min_by(|a, b| a.0.0.total_cmp(&b.0.0))?;
        Some(Weld { members: ids, gap_m, at_m, size_below_m })
    }

    /// The gap that is closed at a place, and the size below which it stays open \[m\]; `None` where other members fill it.
    fn closed(&self, pair: (usize, usize), at_m: [f64; 3]) -> Option<(f64, f64)> {
        let [(a, p), (b, q)] = [nearest(&self.boxes[&pair.0], at_m)?, nearest(&self.boxes[&pair.1], at_m)?];
        let (axis, gap_m) = gap(&a, &b);
        let between = |share: f64| -> [f64; 3] { std::array::from_fn(|i| p[i] + share * (q[i] - p[i])) };
        if LOOKS.into_iter().all(|share| self.is_filled(between(share))) {
            return None;
        }
        // both faces may have gone to one between them: then half of the gap has to be more than a quarter of the size
        let faces = [a.min[axis], a.max[axis], b.min[axis], b.max[axis]];
        let stayed = faces.iter().any(|face| (face - at_m[axis]).abs() < COORDINATE_TOLERANCE_M);
        Some((gap_m, if stayed { 4.0 * gap_m } else { 2.0 * gap_m }))
    }

    /// Whether a point lies inside a member.
    fn is_filled(&self, point: [f64; 3]) -> bool {
        !self.places.near(&Aabb { min: point, max: point }, -COORDINATE_TOLERANCE_M).is_empty()
    }
}

/// Centres of the faces between elements of two members \[m\], whose common nodes are given.
fn common_faces(mesh: &Mesh, pair: (usize, usize), nodes: &[usize]) -> Vec<[f64; 3]> {
    let nodes: BTreeSet<usize> = nodes.iter().copied().collect();
    let of = |part: usize| -> BTreeSet<[usize; 4]> {
        let own = mesh.elements.iter().filter(|e| e.part == part);
        let faces = own.flat_map(|e| FACES.map(|face| face.map(|i| e.nodes[i])));
        let common = faces.filter(|face| face.iter().all(|n| nodes.contains(n)));
        common
            .map(|mut face| {
                face.sort_unstable();
                face
            })
            .collect()
    };
    let center = |face: &[usize; 4]| {
        std::array::from_fn(|i| face.iter().map(|n| mesh.nodes[*n][i]).sum::<f64>() / 4.0)
    };
    of(pair.0).intersection(&of(pair.1)).map(center).collect()
}

/// The box nearest to a place, and its point nearest to it \[m\].
fn nearest(boxes: &[Aabb], at_m: [f64; 3]) -> Option<(Aabb, [f64; 3])> {
    let point = |b: &Aabb| -> [f64; 3] { std::array::from_fn(|i| at_m[i].clamp(b.min[i], b.max[i])) };
    let off = |b: &Aabb| point(b).iter().zip(at_m).map(|(p, a)| (p - a).powi(2)).sum::<f64>();
    let nearest = boxes.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
    Some((*nearest, point(nearest)))
}
