//! Cover and bars: a bar buckles out of the member only where its cover has spalled.
//!
//! The law of a buckling bar ([`crate::material::rebar::Buckling`]) was found on bare bars. In a member the concrete outside of the ties keeps the bar in its line as
//! long as it bears ("Reinforcement stability and fracture of cover concrete", Dhakal and Maekawa, J. Struct. Eng. 128(10), 2002). Beside each element of a bar lie the
//! elements of the cover, outside of the outermost bars; once they have been, in the mean, shortened by 0.004 along the member, where cover begins to spall (Priestley, Calvi and
//! Kowalsky 2007, their limit of serviceability), they have spalled for good. So has cover beside a bar that has
//! yielded in tension: cracks as wide as its plastic elongation part it into loose pieces. A bar inside the core is held by all elements around it.

use super::member::RcMember;
use crate::fe::dynamics::Dynamics;
use std::collections::BTreeSet;

/// Shortening at which cover spalls.
const SPALLED: f64 = 0.004;
/// Coordinates closer than this are one \[m\].
const SAME_M: f64 = 1e-6;

/// Elements of bars that are still held, each with the elements of concrete that hold it.
#[derive(Debug)]
pub struct Cover {
    held: Vec<Held>,
}

/// An element of a bar.
#[derive(Debug)]
struct Held {
    bar: usize,
    /// Edges along the member of the elements that hold it, as often as these have them: node below, node above.
    edges: Vec<[usize; 2]>,
    /// Their length at the start \[m\].
    length_m: f64,
    /// Strain at which the bar yields.
    yield_strain: f64,
}

impl Cover {
    /// Holds all bars of a member that could buckle.
    pub fn of(member: &RcMember, body: &mut Dynamics) -> Self {
        let mesh = &member.mesh;
        let buckles = |t: &usize| {
            let law = mesh.laws[mesh.trusses[*t].law].rebar.filter(|r| r.buckling.is_some())?;
            Some((*t, law.yield_strain()))
        };
        let bars: Vec<(usize, f64)> = member.bars.iter().filter_map(buckles).collect();
        // where the outermost bars are, on each side of each axis
        let mut outer = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for bar in &member.bars {
            let at = mesh.nodes[mesh.trusses[*bar].nodes[0]];
            for (range, x) in outer.iter_mut().zip(at) {
                *range = [range[0].min(x), range[1].max(x)];
            }
        }
        let outside = |e: &usize| {
            let middle = mesh.center(*e);
            (0..2).any(|a| {
                let x = middle[a];
                // the plane of symmetry of half a section is no face
                x > outer[a][1] + SAME_M || (member.mirror != Some(a) && x < outer[a][0] - SAME_M)
            })
        };
        let mut held = Vec::new();
        for (bar, yield_strain) in bars {
            let [below, above] = mesh.trusses[bar].nodes;
            // a bar that slips has a node of its own at the end section, which no element of concrete has
            let heights = [below, above].map(|n| mesh.nodes[n][2]);
            let level = |e: &usize| (heights[0]..heights[1]).contains(&mesh.center(*e)[2]);
            let around: BTreeSet<usize> =
                [below, above].iter().flat_map(|n| body.blocks.elements_at(*n)).filter(level).collect();
            let beside: Vec<usize> = around.into_iter().collect();
            let cover: Vec<usize> = beside.iter().copied().filter(outside).collect();
            body.trusses.bars[bar].rebar.held = true;
            let holding = if cover.is_empty() { &beside } else { &cover };
            let edges = |e: &usize| {
                let n = mesh.elements[*e].nodes;
                [0, 1, 2, 3].map(|k| [n[k], n[k + 4]])
            };
            let edges = holding.iter().flat_map(edges).collect();
            held.push(Held { bar, edges, length_m: heights[1] - heights[0], yield_strain });
        }
        Self { held }
    }

    /// Lets bars go whose cover has spalled.
    pub fn look(&mut self, body: &mut Dynamics) {
        self.held.retain(|Held { bar, edges, length_m, yield_strain }| {
            let shortened: f64 =
                edges.iter().map(|[below, above]| length_m - (body.x[*above][2] - body.x[*below][2])).sum();
            let rebar = &mut body.trusses.bars[*bar].rebar;
            let torn = rebar.strain > *yield_strain;
            let holds = !torn && shortened < SPALLED * length_m * edges.len() as f64;
            rebar.held = holds;
            holds
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::source::Source;
    use crate::fe::contact::RigidSurfaces;
    use crate::rc::member::Joint;
    use crate::rc::section_file::{EXAMPLE, read};

    /// The example's column: its bars lie behind one layer of cover, those of a corner behind three elements, the others behind two.
    #[test]
    fn each_bar_is_held_by_its_cover() {
        let section = read(&Source::new("section.toml", EXAMPLE)).unwrap();
        let member =
            RcMember::new(&section.input, &section.concrete, Joint::Symmetry, section.length_m, 0.075)
                .unwrap();
        let mut body = Dynamics::new(&member.mesh, 0.0, RigidSurfaces::default(), false);
        let mut cover = Cover::of(&member, &mut body);
        assert_eq!(cover.held.len(), member.bars.len());
        let layers = member.bars.len() / section.input.bars.len();
        for Held { bar, edges, .. } in &cover.held {
            let at = &section.input.bars[bar / layers];
            let corner = at.x_m.abs() > 0.01 && at.y_m.abs() > 0.01;
            assert_eq!(edges.len(), 4 * if corner { 3 } else { 2 }, "{at:?}");
        }
        cover.look(&mut body);
        assert!(member.bars.iter().all(|b| body.trusses.bars[*b].rebar.held));
        // shortened by 0.0039 and by 0.0041
        for (strain, holds) in [(0.0039, true), (0.0041, false)] {
            for (x, start) in body.x.iter_mut().zip(&member.mesh.nodes) {
                x[2] = (1.0 - strain) * start[2];
            }
            cover.look(&mut body);
            assert!(member.bars.iter().all(|b| body.trusses.bars[*b].rebar.held == holds));
        }
    }
}
