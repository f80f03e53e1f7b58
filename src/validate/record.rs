//! An MBS run against the record of an FE study, which has what is needed without a further FE run.

use super::measure::Sites;
use super::points::PointErrors;
use super::{ACTIVE_ROTATION_RAD, Both, LIMIT_STANDING_M, LIMIT_TO_CONTACT, compare_sites, turning};
use crate::mbs::Model;
use crate::mbs::result::RunResult;
use crate::study::{Study, fell};
use serde::Serialize;

/// How far a run and a study agree. Errors are those of [`super::Validation`], on the times of the record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    /// Name of the building.
    pub building: String,
    /// Error up to the first ground contact of the FE run, or to the end if there is none; `None`: no tracked point is in both.
    pub e_to_contact: Option<f64>,
    /// Error from that contact to the end; `None`: nothing touches the ground, or at the end only.
    pub e_after_contact: Option<f64>,
    /// Error over the whole run.
    pub e_total: Option<f64>,
    /// The same over the points that do not become debris.
    pub e_total_without_debris: Option<f64>,
    /// Largest distance between both runs' displacements of a point \[m\].
    pub largest_difference_m: f64,
    /// Largest displacement of a point in either, at the times of the record \[m\].
    pub largest_displacement_m: Both<f64>,
    /// First ground contact \[s\].
    pub first_contact_s: Both<Option<f64>>,
    /// Whether the structure collapsed.
    pub collapsed: Both<bool>,
    /// Active hinges against FE zones at member ends.
    pub hinges: Sites,
    /// Ends that turn before the first contact, MBS against FE.
    pub turning_before_contact: Sites,
    /// The same over the whole run.
    pub turning: Sites,
    /// Energy error of the MBS run.
    pub energy_error: f64,
    /// Bodies and steps of the MBS run.
    pub bodies: usize,
    /// Steps.
    pub steps: usize,
    /// Its processor time \[s\].
    pub cpu_s: f64,
}

impl Agreement {
    /// Compares a run of a model with the record of its building.
    pub fn of(study: &Study, model: &Model, run: &RunResult) -> Self {
        let times_s = study.motion.times_s();
        // the outputs of the run nearest to the times of the record
        let output_s = run.times_s.get(1).copied().unwrap_or(1.0);
        let at: Vec<usize> = times_s.iter().map(|t| (t / output_s).round() as usize).collect();
        let count = at.iter().take_while(|i| **i < run.times_s.len()).count();
        let own: Vec<(&str, Vec<[f64; 3]>)> = run
            .tracked
            .iter()
            .map(|p| (p.id.as_str(), at[..count].iter().map(|i| p.displacement_m[*i]).collect()))
            .collect();
        let reference = study.motion.histories();
        let errors = PointErrors::of(&times_s, &reference, count, |id| {
            own.iter().find(|(own, _)| *own == id).map(|(_, displacement)| &displacement[..])
        });
        let distance =
            |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
        let largest = |displacement: &[[f64; 3]]| {
            displacement.iter().map(|u| distance((u, &[0.0; 3]))).fold(0.0, f64::max)
        };
        let facts = &study.facts;
        let sites = compare_sites(facts, model, run);
        Self {
            building: study.building.clone(),
            e_to_contact: errors.until(facts.first_contact_s),
            e_after_contact: errors.after(facts.first_contact_s),
            e_total: errors.until(None),
            e_total_without_debris: errors.without_debris(),
            largest_difference_m: errors
                .pairs
                .iter()
                .flat_map(|(a, b)| a.iter().zip(b.iter()).map(distance))
                .fold(0.0, f64::max),
            largest_displacement_m: Both {
                fe: errors.pairs.iter().map(|(_, fe)| largest(fe)).fold(0.0, f64::max),
                mbs: errors.pairs.iter().map(|(own, _)| largest(own)).fold(0.0, f64::max),
            },
            first_contact_s: Both { fe: facts.first_contact_s, mbs: run.first_ground_contact_s },
            collapsed: Both { fe: facts.collapsed, mbs: run.tracked.iter().any(|t| fell(&t.displacement_m)) },
            hinges: Sites::of(
                sites.iter().map(|s| (s.fe_zone, s.plastic_rotation_rad > ACTIVE_ROTATION_RAD)),
            ),
            turning_before_contact: turning(&sites, |s| s.turns_before_contact),
            turning: turning(&sites, |s| s.turns),
            energy_error: run.energy_error,
            bodies: model.bodies.len(),
            steps: run.steps,
            cpu_s: run.cpu_s,
        }
    }
}

impl Agreement {
    /// Whether the displacements agree, as [`super::Validation::displacements_agree`] says, and the outcome.
    pub fn agrees(&self) -> bool {
        let stands = !self.collapsed.fe && !self.collapsed.mbs;
        self.collapsed.fe == self.collapsed.mbs
            && self.e_to_contact.is_some_and(|e| {
                e <= LIMIT_TO_CONTACT || stands && self.largest_difference_m <= LIMIT_STANDING_M
            })
    }
}

/// Figures of many comparisons together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Together {
    /// Buildings.
    pub buildings: usize,
    /// Median and 90th percentile of the error up to the first contact.
    pub e_to_contact: [f64; 2],
    /// The same of the error over the whole run.
    pub e_total: [f64; 2],
    /// How many collapse in FE, and both errors of these alone.
    pub falling: usize,
    /// Error up to the first contact of those that collapse in FE.
    pub e_to_contact_falling: [f64; 2],
    /// The same of the error from that contact on, where there is one.
    pub e_after_contact_falling: [f64; 2],
    /// The same of the error over the whole run.
    pub e_total_falling: [f64; 2],
    /// 10th percentile, median and 90th percentile of the largest displacement of the MBS over that of FE, of those that stand in both.
    pub largest_standing: [f64; 3],
    /// Buildings that agree ([`Agreement::agrees`]).
    pub agree: usize,
    /// F1 of the hinges of all buildings: against zones, of turning before the first contact, and of turning in the whole run.
    pub f1: [f64; 3],
    /// Buildings that collapse in both runs or in neither.
    pub collapse_right: usize,
}

impl Together {
    /// Of some comparisons.
    pub fn of(list: &[Agreement]) -> Self {
        let falls = |a: &&Agreement| a.collapsed.fe;
        let stands =
            |a: &&Agreement| !a.collapsed.fe && !a.collapsed.mbs && a.largest_displacement_m.fe > 0.0;
        let ratio = |a: &Agreement| a.largest_displacement_m.mbs / a.largest_displacement_m.fe;
        let ratios: Vec<f64> = list.iter().filter(stands).map(ratio).collect();
        let share = |of: &dyn Fn(&Agreement) -> Option<f64>, all: bool, share: f64| {
            percentile(list.iter().filter(|a| all || falls(a)).filter_map(of).collect(), share)
        };
        let both =
            |of: &dyn Fn(&Agreement) -> Option<f64>, all: bool| [share(of, all, 0.5), share(of, all, 0.9)];
        let f1 = |of: fn(&Agreement) -> Sites| {
            let sum = |count: fn(&Sites) -> usize| list.iter().map(|a| count(&of(a))).sum::<usize>() as f64;
            let all = sum(|s| s.expected) + sum(|s| s.found);
            if all > 0.0 { 2.0 * sum(|s| s.common) / all } else { 1.0 }
        };
        Self {
            buildings: list.len(),
            e_to_contact: both(&|a| a.e_to_contact, true),
            e_total: both(&|a| a.e_total, true),
            falling: list.iter().filter(falls).count(),
            e_to_contact_falling: both(&|a| a.e_to_contact, false),
            e_after_contact_falling: both(&|a| a.e_after_contact, false),
            e_total_falling: both(&|a| a.e_total, false),
            largest_standing: [0.1, 0.5, 0.9].map(|p| percentile(ratios.clone(), p)),
            agree: list.iter().filter(|a| a.agrees()).count(),
            f1: [f1(|a| a.hinges), f1(|a| a.turning_before_contact), f1(|a| a.turning)],
            collapse_right: list.iter().filter(|a| a.collapsed.fe == a.collapsed.mbs).count(),
        }
    }
}

/// A percentile, between the closest ranks: definition 7 of Hyndman and Fan, The American Statistician 50 (1996) 361.
fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = share * (values.len().max(1) - 1) as f64;
    let [low, high] = [at.floor(), at.ceil()].map(|i| values.get(i as usize).copied());
    low.zip(high).map_or(f64::NAN, |(low, high)| low + at.fract() * (high - low))
}
