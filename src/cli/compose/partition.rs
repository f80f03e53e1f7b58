//! Rigid and deforming parts of the runs: shares over time, and pictures at some times.

use super::Pieces;
use super::marks::{Happened, Marks, pose};
use super::scene::{Skin, held, kept};
use crate::base::geom::Aabb;
use crate::fe::result::{FeRun, KeptFrame};
use crate::mbs::latent::compounds;
use crate::mbs::math;
use crate::report::{Facet, FacetKind, Moment, PartitionView, Picture, SceneFace};
use std::collections::BTreeSet;

/// Longest edge of a face in a picture \[m\]: smaller than the members, so that the depth of their centres orders them.
const FACE_M: f64 = 0.5;

/// Shares over the kept frames, and pictures before the first contact, at it, after it and at the end.
pub fn partition(p: &Pieces) -> PartitionView {
    let outputs = kept(p);
    let times_s = p.times_s();
    let fe_runs: Vec<Deforming> = p.fe_runs().map(Deforming::of).collect();
    let marks = Marks::of(&p.generated.model, p.mbs);
    let shares = |run: usize, share: &dyn Fn(&Deforming, &KeptFrame) -> f64| {
        let of = |run: &Deforming| outputs.iter().filter_map(|o| Some(share(run, run.frame(*o)?))).collect();
        fe_runs.get(run).map_or(Vec::new(), of)
    };
    let moment = |(label, output): (&str, usize)| {
        let of_fe = fe_runs.iter().map(|run| run.picture(p, output));
        let pictures = of_fe.chain([mbs_picture(p, &marks, output)]).collect();
        Moment { label: label.into(), time_s: times_s[output], pictures }
    };
    PartitionView {
        time_s: outputs.iter().map(|o| times_s[*o]).collect(),
        fe_share: shares(0, &|run, f| run.rigid_share(f)),
        fe_never_share: shares(0, &|run, f| run.never_share(f)),
        hybrid_share: shares(1, &|run, f| run.rigid_share(f)),
        ground_level_m: Some(p.building.ground.level_m),
        building_m: Some(match &p.against {
            Some(a) => around(a.fe.mesh.nodes.iter().copied()),
            None => around(p.building.members.iter().flat_map(|m| [m.solid.min, m.solid.max])),
        }),
        moments: moments(p, &outputs).into_iter().map(moment).collect(),
    }
}

/// The box around some points.
fn around(points: impl Iterator<Item = [f64; 3]>) -> Aabb {
    let [mut min, mut max] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for p in points {
        min = std::array::from_fn(|i| min[i].min(p[i]));
        max = std::array::from_fn(|i| max[i].max(p[i]));
    }
    Aabb { min, max }
}

/// Which outputs are drawn, of those that were kept.
fn moments(p: &Pieces, outputs: &[usize]) -> Vec<(&'static str, usize)> {
    let at = |time_s: f64| outputs.iter().copied().find(|o| p.times_s()[*o] >= time_s - 1e-9);
    let end_s = outputs.last().map_or(0.0, |o| p.times_s()[*o]);
    let wanted = match p.first_contact_s().filter(|t| *t < end_s) {
        Some(t) => vec![
            ("before the first contact", 0.5 * t),
            ("at the first contact", t),
            ("after the first contact", 0.5 * (t + end_s)),
            ("at the end", end_s),
        ],
        None => vec![("under way", 0.5 * end_s), ("at the end", end_s)],
    };
    one_each(wanted.into_iter().filter_map(|(label, t)| Some((label, at(t)?))).collect())
}

/// One moment an output: of a run of few outputs the end is the end, and no time under way.
fn one_each(mut moments: Vec<(&'static str, usize)>) -> Vec<(&'static str, usize)> {
    moments.reverse();
    moments.dedup_by_key(|m| m.1);
    moments.reverse();
    moments
}

/// An FE run with what its pictures take.
struct Deforming<'a> {
    run: &'a FeRun,
    skin: Skin,
}

impl<'a> Deforming<'a> {
    fn of(run: &'a FeRun) -> Self {
        Self { run, skin: Skin::of(run) }
    }

    fn frame(&self, output: usize) -> Option<&'a KeptFrame> {
        self.run.frames.iter().find(|f| f.output == output)
    }

    /// Whether an element is there at a time \[s\].
    fn acts(&self, element: usize, time_s: f64) -> bool {
        self.skin.elements[element].death_s.is_none_or(|t| t > time_s)
    }

    /// Whether an element is rigid: in a run with rigid parts if it belongs to one, else if it strains no faster than the critical rate.
    fn is_rigid(&self, frame: &KeptFrame, element: usize) -> bool {
        if frame.rigid.is_empty() { !frame.fast[element] } else { frame.rigid[element] }
    }

    /// Whether an element has strained no faster than the critical rate until then.
    fn never_deformed(&self, frame: &KeptFrame, element: usize) -> bool {
        let first_s = self.run.strain_rates.first_s[element];
        first_s.is_none_or(|t| t > self.run.times_s[frame.output])
    }

    /// Share of the acting elements that count.
    fn share(&self, frame: &KeptFrame, counts: impl Fn(usize) -> bool) -> f64 {
        let time_s = self.run.times_s[frame.output];
        let acting: Vec<usize> = (0..self.skin.elements.len()).filter(|e| self.acts(*e, time_s)).collect();
        acting.iter().filter(|e| counts(**e)).count() as f64 / acting.len().max(1) as f64
    }

    fn rigid_share(&self, frame: &KeptFrame) -> f64 {
        self.share(frame, |e| self.is_rigid(frame, e))
    }

    fn never_share(&self, frame: &KeptFrame) -> f64 {
        self.share(frame, |e| self.never_deformed(frame, e))
    }

    fn kind(&self, frame: &KeptFrame, element: usize) -> FacetKind {
        match (self.is_rigid(frame, element), self.run.hybrid.is_some()) {
            (false, _) => FacetKind::Deforming,
            (true, false) if !self.never_deformed(frame, element) => FacetKind::Deformed,
            _ => FacetKind::Rigid,
        }
    }

    fn picture(&self, p: &Pieces, output: usize) -> Picture {
        let Some(frame) = self.frame(output) else { return Picture::default() };
        let time_s = self.run.times_s[output];
        let at = |n: u32| frame.nodes_m[n as usize].map(f64::from);
        let seen =
            |f: &&SceneFace| f.birth_s.is_none_or(|t| t <= time_s) && self.acts(f.element as usize, time_s);
        let facet =
            |f: &SceneFace| Facet { corners_m: f.nodes.map(at), kind: self.kind(frame, f.element as usize) };
        let share = 100.0 * self.rigid_share(frame);
        let (name, words) = match &self.run.hybrid {
            Some(record) => {
                let sets = record.sets.get(output).copied().unwrap_or(0);
                let parts = if sets == 1 { "part" } else { "parts" };
                ("hybrid", format!("{share:.1} % in {sets} rigid {parts}"))
            }
            None => {
                let never = 100.0 * self.never_share(frame);
                let words = "below the critical strain rate";
                ("FE", format!("{share:.1} % {words}, {never:.1} % since the start"))
            }
        };
        Picture {
            run: name.into(),
            words,
            facets: self.skin.faces.iter().filter(seen).map(facet).chain(obstacles(p)).collect(),
            marks: Vec::new(),
        }
    }
}

fn obstacles(p: &Pieces) -> Vec<Facet> {
    let solids = p.building.obstacles.iter().map(|o| o.solid);
    solids.flat_map(|solid| box_facets(solid, FacetKind::Obstacle, |local| local)).collect()
}

/// The faces of a box in pieces of at most [`FACE_M`], at their place.
fn box_facets(solid: Aabb, kind: FacetKind, place: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<Facet> {
    let size = solid.size();
    let count: [usize; 3] = size.map(|s| (s / FACE_M).ceil().max(1.0) as usize);
    let mut facets = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let corner = |side: usize, i: usize, j: usize| {
            let mut at = solid.min;
            at[axis] += side as f64 * size[axis];
            at[u] += i as f64 / count[u] as f64 * size[u];
            at[v] += j as f64 / count[v] as f64 * size[v];
            place(at)
        };
        for i in 0..count[u] {
            for j in 0..count[v] {
                let around = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
                let upper = around.map(|[i, j]| corner(1, i, j));
                let mut lower = around.map(|[i, j]| corner(0, i, j));
                lower.reverse();
                facets.extend([lower, upper].map(|corners_m| Facet { corners_m, kind }));
            }
        }
    }
    facets
}

/// The bodies of the MBS, its hinges that have yielded or separated, and its latent sections that have gone live.
fn mbs_picture(p: &Pieces, marks: &Marks, output: usize) -> Picture {
    let model = &p.generated.model;
    let Some(frame) = p.mbs.frames.get(output) else { return Picture::default() };
    let compounds = compounds(model, p.mbs, p.mbs.times_s[output]);
    let mut facets = obstacles(p);
    facets.extend(held(p.building).flat_map(|m| box_facets(m.solid, FacetKind::Rigid, |local| local)));
    for (body, _) in compounds.iter().enumerate().filter(|(_, compound)| compound.is_some()) {
        let (turn, position_m) = pose(frame, body);
        for shape in &model.bodies[body].shapes {
            let [center, half] = shape.bounds();
            let solid = Aabb::from_corners(math::sub(center, half), math::add(center, half));
            let place = |local| math::add(position_m, math::mul(&turn, local));
            facets.extend(box_facets(solid, FacetKind::Rigid, place));
        }
    }
    let words = mbs_words(&compounds, marks.happened(output));
    Picture { run: "MBS".into(), words, facets, marks: marks.at(output) }
}

/// "24 rigid compounds of 32 bodies; hinges: 20 have yielded so far, 4 of latent sections have gone live, 6 have separated".
fn mbs_words(compounds: &[Option<usize>], happened: Happened) -> String {
    let (bodies, moving) = count_compounds(compounds);
    let rigid = match (bodies == moving, moving) {
        (_, 1) => "1 rigid compound".into(),
        (true, _) => format!("{moving} rigid compounds"),
        (false, _) => format!("{moving} rigid compounds of {bodies} bodies"),
    };
    format!(
        "{rigid}; hinges: {} have yielded so far, {} of latent sections have gone live, {} have separated",
        happened.yielded, happened.live, happened.broken
    )
}

/// Bodies that are there, and what they move as.
pub(super) fn count_compounds(compounds: &[Option<usize>]) -> (usize, usize) {
    let present = || compounds.iter().flatten();
    (present().count(), present().collect::<BTreeSet<_>>().len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_one_output_interval_there_is_the_end() {
        assert_eq!(one_each(vec![("under way", 1), ("at the end", 1)]), [("at the end", 1)]);
        let all = vec![("before", 1), ("at", 2), ("after", 3), ("end", 3)];
        assert_eq!(one_each(all), [("before", 1), ("at", 2), ("end", 3)]);
    }
}
