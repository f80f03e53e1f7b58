//! Elastic demands at the member ends before and after the removal, against the capacity of the sections.
//!
//! Two capacities stand side by side: that of the reinforced section ([`FibreSection`], perfectly plastic
//! steel) and that of the homogenised law which the global FE model uses ([`HomogenisedCapacity`]).
//! Demands are linear elastic and of first order: a ratio above 1 says where the structure yields
//! first, not that it collapses, and says nothing about the dynamic increase after a sudden removal.

use super::apart;
use super::ends::MemberEnd;
use super::frame::{Frame, FrameError, FrameSolution, Mechanism, SectionForces};
use super::idealise::{Idealised, idealise};
use super::paths::{charged_members, cut_members};
use super::structure::Structure;
use crate::base::geom::Aabb;
use crate::base::root::{Close, increasing};
use crate::building::{Building, Material, MemberKind};
use crate::material::section_capacity::{CompressedEdge, FibreSection, HomogenisedCapacity};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeSet;

/// Share of the weight that may be missing from the supports without a word.
const BALANCE: f64 = 0.01;
/// Share of the building's smaller side in plan by which the supports may bear the weight beside its centre without a word.
const OFF_CENTER: f64 = 0.04;
/// To what share of itself a ratio is found.
const CLOSE: f64 = 1e-9;
/// A moment over its capacity from which on it counts as that.
const BEYOND: f64 = 1e9;

/// Demand against one capacity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Utilisation {
    /// Moment capacity about axes 1 and 2 at the axial force of the demand, for the sense of the
    /// demand \[N m\]; zero beyond the axial limits.
    pub capacity_nm: [f64; 2],
    /// Demand over capacity: the axial force and the moments over this are what the section can just bear together, all of them smaller or larger alike.
    pub ratio: f64,
}

/// Demand at one member end in one state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EndState {
    /// Section forces.
    pub forces: SectionForces,
    /// Against the reinforced section.
    pub section: Utilisation,
    /// Against the homogenised law.
    pub homogenised: Utilisation,
}

/// Demand at one member end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EndDemand {
    /// Id of the member end.
    pub id: String,
    /// Before the charges; `None` if the member was cut away in preparation or there is no solution.
    pub before: Option<EndState>,
    /// After the charges; `None` if the member is gone or there is no solution.
    pub after: Option<EndState>,
}

/// One solved state.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum StateSummary {
    /// A static equilibrium exists in linear theory.
    Equilibrium {
        /// Weight of the members left \[N\].
        weight_n: f64,
        /// Sum of the support forces \[N\].
        reaction_sum_n: [f64; 3],
        /// Support forces \[N\] and moments \[N m\] by the id of the supported end.
        reactions: Vec<(String, [f64; 6])>,
        /// Largest nodal displacement \[m\].
        largest_displacement_m: f64,
        /// Number of unknowns.
        unknowns: usize,
        /// Members whose weight rests on nothing and was left out.
        unplaced: Vec<String>,
        /// Columns and walls that touch a slab above them and bear nothing of it.
        left_out: Vec<String>,
        /// Beams that only a slab holds: it bears them, and they have no forces of their own.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        by_slab: Vec<String>,
        /// Members that can move freely in buildings beside those in equilibrium: weight, forces and supports are those of the latter.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        not_held: Vec<String>,
        /// How far from the centre of the weight the supports bear it, over the smaller side of the building in plan.
        #[serde(skip)]
        off_center: f64,
    },
    /// Parts can move freely.
    Mechanism(Mechanism),
    /// The solver failed.
    Failed {
        /// Why.
        reason: String,
    },
}

/// Demands of a building.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Demands {
    /// The dead-load state after the preparation.
    pub before: StateSummary,
    /// After all charges; `None` if the building has none.
    pub after: Option<StateSummary>,
    /// All member ends, in the order of `Structure::ends`.
    pub ends: Vec<EndDemand>,
}

/// Solves the frame before and after the charges and compares with the capacities.
pub fn demands(structure: &Structure, building: &Building) -> Demands {
    Solved::of(structure, building).demands
}

/// Demands with the frame that they come from.
pub struct Solved {
    /// Demands before and after the charges.
    pub demands: Demands,
    /// The frame before the charges.
    pub frame: Frame,
}

impl Solved {
    /// Solves the frame before and after the charges, side by side.
    pub fn of(structure: &Structure, building: &Building) -> Self {
        let cut = cut_members(building);
        let gone: BTreeSet<usize> = charged_members(building).union(&cut).copied().collect();
        let solved = |removed: &BTreeSet<usize>| {
            let ideal = idealise(structure, building, removed);
            (state(structure, building, &ideal), ideal.frame)
        };
        let charged = gone != cut;
        let (((before, before_ends), frame), after) =
            rayon::join(|| solved(&cut), || charged.then(|| solved(&gone).0));
        let (after, after_ends) = match after {
            Some((summary, ends)) => (Some(summary), ends),
            None => (None, vec![None; structure.ends.len()]),
        };
        let ends = structure
            .ends
            .iter()
            .zip(before_ends.into_iter().zip(after_ends))
            .map(|(end, (before, after))| EndDemand { id: end.id.clone(), before, after })
            .collect();
        Self { demands: Demands { before, after, ends }, frame }
    }
}

impl StateSummary {
    /// Why the forces of the state are not those of the building, each with what to do about it.
    pub fn warnings(&self) -> Vec<String> {
        let Self::Equilibrium { weight_n, reaction_sum_n, unplaced, left_out, by_slab, off_center, .. } =
            self
        else {
            return Vec::new();
        };
        let mut warnings = Vec::new();
        let borne_n = reaction_sum_n[2];
        if (borne_n - weight_n).abs() > BALANCE * weight_n {
            let remedy = if unplaced.is_empty() {
                "look at what the slabs rest on".to_string()
            } else {
                format!(
                    "{} rest on nothing: give them ends of their own on columns or beams",
                    unplaced.join(", ")
                )
            };
            warnings.push(format!(
                "the supports bear {:.3} kN of a weight of {:.3} kN, so that forces and ratios are too small; {remedy}",
                borne_n / 1e3,
                weight_n / 1e3
            ));
        } else if *off_center > OFF_CENTER {
            warnings.push(format!(
                "the supports bear the weight beside its centre, by {:.0} % of the building's smaller side in plan, so that forces and moments of columns are wrong; look at slabs that reach far beyond beams and columns",
                1e2 * off_center
            ));
        }
        if !left_out.is_empty() {
            warnings.push(format!(
                "{} touch a slab and bear nothing of it: their forces and ratios are too small, those of their neighbours too large; put a beam on them or a column in line with them",
                left_out.join(", ")
            ));
        }
        if !by_slab.is_empty() {
            warnings.push(format!(
                "only a slab holds {}: they have no forces and ratios, and their stiffness is left out; let them reach columns, walls or beams",
                by_slab.join(", ")
            ));
        }
        warnings
    }

    /// Members that can move freely, if there are any.
    pub fn free(&self) -> Option<&[String]> {
        match self {
            Self::Mechanism(mechanism) => Some(&mechanism.members),
            Self::Equilibrium { not_held, .. } if !not_held.is_empty() => Some(not_held),
            _ => None,
        }
    }
}

impl Demands {
    /// Warnings of both states, each with the name of its state, and of columns that are overloaded before.
    pub fn warnings(&self, building: &Building) -> Vec<String> {
        let states = [("before", Some(&self.before)), ("after", self.after.as_ref())];
        let named = |(name, state): (&str, Option<&StateSummary>)| {
            let all = state.map(StateSummary::warnings).unwrap_or_default();
            all.into_iter().map(|warning| format!("{name}: {warning}")).collect::<Vec<_>>()
        };
        states.into_iter().flat_map(named).chain(self.overloaded(building)).collect()
    }

    /// That columns bear more than they can before any charge goes off, which no static state does, if so.
    pub fn overloaded(&self, building: &Building) -> Option<String> {
        let columns = columns_of(building);
        let ratio = |end: &EndDemand| Some((end.before?.homogenised.ratio, member_of(&end.id)?.to_string()));
        let over =
            self.ends.iter().filter_map(ratio).filter(|(r, id)| *r > 1.0 && columns.contains(id.as_str()));
        let (mut most, mut ids) = ((0.0, String::new()), BTreeSet::new());
        for (ratio, id) in over {
            ids.insert(id.clone());
            most = if ratio > most.0 { (ratio, id) } else { most };
        }
        (!ids.is_empty()).then(|| {
            format!(
                "{} of {} columns bear more than the homogenised law can under dead load, before any charge: {} by a factor of {:.2}; give them larger sections or a law that yields later",
                ids.len(),
                columns.len(),
                most.1,
                most.0
            )
        })
    }

    /// Largest ratio of demand to capacity of all column ends after the charges, or before if there are none; `None` if there is no solution.
    pub fn largest_of_columns(&self, building: &Building, ratio: fn(&EndState) -> f64) -> Option<f64> {
        let columns = columns_of(building);
        let column = |id: &str| member_of(id).is_some_and(|member| columns.contains(member));
        let state = |end: &EndDemand| if self.after.is_some() { end.after } else { end.before };
        let states = self.ends.iter().filter(|end| column(&end.id)).filter_map(state);
        states.map(|s| ratio(&s)).reduce(f64::max)
    }
}

/// The ids of all columns.
fn columns_of(building: &Building) -> BTreeSet<&str> {
    building.members.iter().filter(|m| m.kind == MemberKind::Column).map(|m| m.id.as_str()).collect()
}

/// The member of an end.
fn member_of(end: &str) -> Option<&str> {
    end.rsplit_once('.').map(|(member, _)| member)
}

/// One state: its summary and the state of each end.
fn state(
    structure: &Structure,
    building: &Building,
    ideal: &Idealised,
) -> (StateSummary, Vec<Option<EndState>>) {
    let none = vec![None; structure.ends.len()];
    let apart = match apart::solve(structure, &ideal.frame) {
        Ok(apart) => apart,
        Err(FrameError::Mechanism(mechanism)) => return (StateSummary::Mechanism(mechanism), none),
        Err(FrameError::Factorisation(reason)) => return (StateSummary::Failed { reason }, none),
    };
    let solution = &apart.solution;
    let length = |u: &[f64; 6]| (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt();
    let summary = StateSummary::Equilibrium {
        weight_n: ideal.weight_n - apart.free_weight_n(&ideal.frame),
        reaction_sum_n: solution.reaction_sum_n(),
        reactions: solution.reactions.iter().map(|(n, r)| (ideal.frame.nodes[*n].id.clone(), *r)).collect(),
        largest_displacement_m: solution.displacement.iter().map(length).fold(0.0, f64::max),
        unknowns: solution.unknowns,
        unplaced: ideal.unplaced.clone(),
        left_out: ideal.left_out.clone(),
        by_slab: ideal.by_slab.clone(),
        off_center: if apart.free.is_empty() { off_center(building, ideal, solution) } else { 0.0 },
        not_held: apart.free.clone(),
    };
    let ends = ideal.ends.par_iter().zip(&structure.ends).map(|(place, end)| {
        let (element, side) = (*place).filter(|(element, _)| apart.held[*element])?;
        let forces = solution.forces[element][side];
        Some(EndState {
            forces,
            section: against_section(building, end, &forces)?,
            homogenised: against_law(building, end, &forces),
        })
    });
    (summary, ends.collect())
}

/// How far from the centre of the weight the supports bear it, over the smaller side of the building in plan.
fn off_center(building: &Building, ideal: &Idealised, solution: &FrameSolution) -> f64 {
    let borne_at = ideal.frame.center_of_reactions_m(solution);
    let off_m = libm::hypot(borne_at[0] - ideal.center_m[0], borne_at[1] - ideal.center_m[1]);
    let outline = building.members.iter().map(|m| m.solid).reduce(Aabb::around);
    let side_m = outline.map_or(0.0, |o| o.size()[0].min(o.size()[1]));
    off_m / side_m
}

/// The compressed edge for a moment about axis 1 or 2 (see [`SectionForces::moment_nm`]).
fn compressed_edge(about: usize, moment_nm: f64) -> CompressedEdge {
    match (about, moment_nm >= 0.0) {
        (0, true) => CompressedEdge::DepthLow,
        (0, false) => CompressedEdge::DepthHigh,
        (_, true) => CompressedEdge::WidthHigh,
        (_, false) => CompressedEdge::WidthLow,
    }
}

/// Against the reinforced section: uniaxial capacities at the axial force, combined as in EN 1992-1-1, 5.8.9
/// (4), eq. 5.39. `None` if the section's materials are not concrete and steel.
pub fn against_section(building: &Building, end: &MemberEnd, forces: &SectionForces) -> Option<Utilisation> {
    let member = &building.members[end.member];
    let section = building.sections.get(&member.section)?;
    let (Some(Material::Concrete(concrete)), Some(Material::Steel(steel))) =
        (building.materials.get(&section.concrete), building.materials.get(&section.steel))
    else {
        return None;
    };
    // Strength and force scaled alike: M(N) of the weakened section is f M(N / f).
    let factor = building.strength_factor(&member.id);
    let axial = forces.axial_n / factor;
    let fibres: [FibreSection; 2] = std::array::from_fn(|i| {
        FibreSection::of_section(
            section,
            concrete,
            steel,
            end.size_m[0],
            compressed_edge(i, forces.moment_nm[i]),
        )
    });
    let [tension, compression] = fibres[0].axial_limits_n();
    let axial_ratio = if axial >= 0.0 { axial / compression } else { axial / tension };
    let at = |share: f64| {
        let capacity_nm = std::array::from_fn(|i| factor * fibres[i].ultimate_moment_nm(share * axial));
        (capacity_nm, biaxial_exponent(share * axial.max(0.0) / compression))
    };
    Some(utilisation(forces.moment_nm, axial_ratio, at))
}

/// Exponent of the biaxial interaction of a rectangular section over `N/N_Rd`, EN 1992-1-1, 5.8.9 (4).
fn biaxial_exponent(axial_ratio: f64) -> f64 {
    if axial_ratio <= 0.7 {
        1.0 + 0.5 * ((axial_ratio - 0.1) / 0.6).max(0.0)
    } else {
        1.5 + 0.5 * ((axial_ratio - 0.7) / 0.3).min(1.0)
    }
}

/// Against the homogenised law: rectangle, biaxial exponent `1.73 + 1.8 n³` (ENV 1993-1-1:1992, 5.4.8.1 (11),
/// solid rectangles).
pub fn against_law(building: &Building, end: &MemberEnd, forces: &SectionForces) -> Utilisation {
    let member = &building.members[end.member];
    let law = building.law_of(member);
    let factor = building.strength_factor(&member.id);
    let [width, depth] = end.size_m;
    let axial = forces.axial_n / factor;
    let capacities = [
        HomogenisedCapacity::of_rectangle(law, width, depth),
        HomogenisedCapacity::of_rectangle(law, depth, width),
    ];
    let n = (axial / capacities[0].plastic_force_n).abs();
    let at = |share: f64| {
        let capacity_nm = [0, 1].map(|i| factor * capacities[i].moment_nm(share * axial));
        (capacity_nm, 1.73 + 1.8 * (share * n).powi(3))
    };
    utilisation(forces.moment_nm, n, at)
}

/// Of moments \[N m\] beside an axial force that takes a ratio of its limit; `at` tells the moment capacities and the exponent of their interaction at a share of that force.
///
/// Loads that grow alike move the demand along a ray from the origin of `(N, M_1, M_2)`. The moments alone, over the capacity beside the whole axial force, would be without bound where that force takes nearly all of a section that bears hardly any moment.
fn utilisation(moment_nm: [f64; 2], axial_ratio: f64, at: impl Fn(f64) -> ([f64; 2], f64)) -> Utilisation {
    let used = |share: f64| {
        let (capacity_nm, exponent) = at(share);
        let of = |i: usize| match moment_nm[i].abs() {
            0.0 => 0.0,
            moment => libm::pow((share * moment / capacity_nm[i].max(0.0)).min(BEYOND), exponent),
        };
        libm::pow(of(0) + of(1), 1.0 / exponent) - 1.0
    };
    let capacity_nm = if axial_ratio < 1.0 { at(1.0).0.map(|c| c.max(0.0)) } else { [0.0; 2] };
    if moment_nm == [0.0; 2] {
        return Utilisation { capacity_nm, ratio: axial_ratio };
    }
    // the share of the loads that the section can just bear: at most what the axial force alone allows
    let most = 1.0 / axial_ratio.max(f64::MIN_POSITIVE);
    let mut low = 0.0;
    let mut high = most.min(1.0);
    while high < most && used(high) < 0.0 {
        (low, high) = (high, most.min(2.0 * high));
    }
    let close = Close { value: CLOSE, width: CLOSE * CLOSE * high };
    Utilisation { capacity_nm, ratio: 1.0 / increasing([low, high], used, close) }
}
