//! A series of bends of one member end: axial forces and directions, with the figures of each curve.
//!
//! Bends run beside each other on the threads of the pool, each of them on one thread: results do not depend on the number of threads.

use super::bend::{Bend, BendError, Bent, bend};
use super::drive::{self, KINETIC_LIMIT};
use super::hysteresis::{History, Hysteresis};
use super::member::{Joint, RcMember};
use super::section_file::RcSection;
use super::shear::ShearDemand;
use crate::curve::ResistanceCurve;
use crate::material::concrete::{ConcreteLaw, LawError, Surface};
use crate::material::fibre::FibreSection;
use crate::material::fibre_concrete;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Mutex;
use std::time::Instant;

/// Share of the peak through which the secant to the yield rotation is drawn.
pub const YIELD_SHARE: f64 = 0.75;
/// Curvature times depth up to which the fibre section is bent.
const FIBRE_REACH: f64 = 0.4;

/// Step of direction between fibre sections of a biaxial figure \[deg\].
const FIBRE_STEP_DEG: f64 = 15.0;
/// Rotation of the monotonic bend to which a rule is fitted, over the largest one of the cycles.
const BACKBONE_REACH: f64 = 1.25;
/// Least share of the ordinary speed at which a push is tried.
const LEAST_PACE: f64 = 0.25;
/// Most hexahedra of a member end.
pub const MOST_HEXAHEDRA: usize = 5000;
/// Smallest size of elements \[m\].
pub const SMALLEST_MESH_M: f64 = 0.01;

/// What is run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SeriesOptions {
    /// Axial forces over `f_c A`, compression positive.
    pub axial_shares: Vec<f64>,
    /// Directions of the push: 0 along x, 90 along y \[deg\].
    pub directions_deg: Vec<f64>,
    /// Rotation at which a monotonic bend stops \[rad\].
    pub until_rad: f64,
    /// Turning points of the rotation ([`super::drive::Path::through`]); none: monotonic bends \[rad\].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub turns_rad: Vec<f64>,
    /// Whether a cyclic bend is followed by a monotonic one, and the rule of degradation fitted to both.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub fit_rule: bool,
    /// Size of the elements \[m\].
    pub mesh_size_m: f64,
    /// What the member stands on.
    pub joint: Joint,
    /// Whether the concrete has the seed's pure surfaces.
    pub seed_law: bool,
    /// Whether the whole section is meshed where half of it would do ([`RcMember::half`]).
    pub whole: bool,
}

impl Default for SeriesOptions {
    fn default() -> Self {
        Self {
            axial_shares: vec![0.0, 0.1, 0.3, 0.6],
            directions_deg: vec![90.0],
            until_rad: 0.1,
            turns_rad: Vec::new(),
            fit_rule: false,
            mesh_size_m: 0.05,
            joint: Joint::Symmetry,
            seed_law: false,
            whole: false,
        }
    }
}

/// Figures of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figures {
    /// Largest moment \[N m\].
    pub peak_nm: f64,
    /// Rotation at it \[rad\].
    pub peak_rotation_rad: f64,
    /// Rotation at which the secant through [`YIELD_SHARE`] of the peak reaches the peak: an estimate of first yield \[rad\].
    pub yield_rotation_rad: f64,
    /// Rotation beyond the peak at which 80 % of it are left \[rad\]; `None`: not reached.
    pub rotation_80_rad: Option<f64>,
    /// As before, 20 %.
    pub rotation_20_rad: Option<f64>,
}

impl Figures {
    /// Figures of `[rotation (rad), moment (N m), ...]` points; `None` without a positive moment.
    pub fn of(points: &[[f64; 3]]) -> Option<Self> {
        let peak = (0..points.len()).reduce(|a, b| if points[b][1] > points[a][1] { b } else { a })?;
        let [peak_rotation_rad, peak_nm, _] = points[peak];
        if peak_nm <= 0.0 {
            return None;
        }
        let wanted = YIELD_SHARE * peak_nm;
        let rising = points[..=peak].windows(2).find(|w| w[0][1] < wanted && w[1][1] >= wanted)?;
        let fall = |share: f64| {
            let level = share * peak_nm;
            points[peak..].windows(2).find(|w| w[0][1] >= level && w[1][1] < level).map(|w| at(w, level))
        };
        Some(Self {
            peak_nm,
            peak_rotation_rad,
            yield_rotation_rad: at(rising, wanted) / YIELD_SHARE,
            rotation_80_rad: fall(0.8),
            rotation_20_rad: fall(super::bend::FAILED_SHARE),
        })
    }
}

impl Figures {
    /// Figures of the envelope of a sense, with positive numbers.
    fn of_sense(envelopes: &[Vec<[f64; 3]>; 2], sense: f64) -> Option<Self> {
        if sense > 0.0 {
            return Self::of(&envelopes[0]);
        }
        let turned: Vec<[f64; 3]> = envelopes[1].iter().map(|p| [-p[0], -p[1], p[2]]).collect();
        Self::of(&turned)
    }
}

/// Rotation at which a moment is passed between two points.
fn at(pair: &[[f64; 3]], moment: f64) -> f64 {
    let share = (moment - pair[0][1]) / (pair[1][1] - pair[0][1]);
    pair[0][0] + share * (pair[1][0] - pair[0][0])
}

/// One bend of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Axial force over `f_c A`.
    pub axial_share: f64,
    /// Axial force, compression positive \[N\].
    pub axial_n: f64,
    /// Direction of the push \[deg\].
    pub direction_deg: f64,
    /// Share of the ordinary speed at which it was pushed: less where that left too much motion.
    pub pace: f64,
    /// The bend, or why there is none.
    pub bent: Result<Bent, BendError>,
    /// Figures of the curve; of a cyclic one those of its envelope in the sense in which it begins.
    pub figures: Option<Figures>,
    /// Excursions and cycles of a cyclic bend.
    pub hysteresis: Option<Hysteresis>,
    /// The curve of a monotonic bend with the rule of degradation of the cycles, or why there is none; `None`: not asked for.
    pub curve: Option<Result<ResistanceCurve, String>>,
    /// Largest moment of the fibre section (Mander's concrete that bars displace, with history) \[N m\].
    pub fibre_peak_nm: Option<f64>,
    /// Its shear force beside the shear strength; `None` without a bend or off the axes.
    pub shear: Option<ShearDemand>,
    /// Time it took \[s\].
    pub seconds: f64,
}

impl Case {
    /// Why a monotonic push is no static curve, in words.
    pub fn fault(&self) -> Option<String> {
        let bent = self.bent.as_ref().ok().filter(|_| self.hysteresis.is_none())?;
        drive::moves(bent.kinetic_share).map(|moves| format!("{moves}, at {} of the speed", self.pace))
    }
}

/// All bends of a member end.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What was run.
    pub options: SeriesOptions,
    /// Elements of the mesh of the first direction: hexahedra and bars.
    pub elements: [usize; 2],
    /// Length after meshing \[m\].
    pub length_m: f64,
    /// Bends by direction, then by axial force, in the order asked for.
    pub cases: Vec<Case>,
}

/// The concrete law that a series uses.
pub fn concrete_of(section: &RcSection, options: &SeriesOptions) -> ConcreteLaw {
    let mut law = section.concrete.clone();
    if options.seed_law {
        law.surface = Surface::SEED;
    }
    law
}

/// Why a series cannot be run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SeriesError {
    /// The concrete does not suit the size of the elements.
    #[error("{0}; use other elements (--mesh), or correct the concrete")]
    Law(#[from] LawError),
    /// Elements of a size that makes no sense.
    #[error(
        "the size of elements is {:.0} mm (--mesh): it must be at least {:.0} mm and at most half of the smaller side, {:.0} mm",
        1e3 * size_m,
        1e3 * SMALLEST_MESH_M,
        1e3 * largest_m
    )]
    Size {
        /// Size asked for \[m\].
        size_m: f64,
        /// Largest size \[m\].
        largest_m: f64,
    },
    /// Too many elements.
    #[error(
        "elements of {:.0} mm make {count} hexahedra, more than {MOST_HEXAHEDRA}; use --mesh \"{:.0} mm\" or larger",
        1e3 * size_m,
        1e3 * fits_m
    )]
    Count {
        /// Size asked for \[m\].
        size_m: f64,
        /// Number of hexahedra that it makes.
        count: usize,
        /// A size that is not too small \[m\].
        fits_m: f64,
    },
}

/// Refuses sizes of elements that make no sense, or too many elements.
fn check_mesh(section: &RcSection, options: &SeriesOptions) -> Result<(), SeriesError> {
    let [width, depth] = section.input.size_m;
    let (size_m, largest_m) = (options.mesh_size_m, 0.5 * width.min(depth));
    // sizes are written in decimals, halves of sides need not be
    if !(size_m >= SMALLEST_MESH_M * (1.0 - 1e-9) && size_m <= largest_m * (1.0 + 1e-9)) {
        return Err(SeriesError::Size { size_m, largest_m });
    }
    let count_of =
        |size| RcMember::hexahedra(&section.input, &section.concrete, options.joint, section.length_m, size);
    let count = count_of(size_m);
    if count <= MOST_HEXAHEDRA {
        return Ok(());
    }
    let whole_mm = (1e3 * size_m).floor() as u32..=(1e3 * largest_m).floor() as u32;
    let mut sizes = whole_mm.map(|mm| 1e-3 * f64::from(mm)).filter(|size| *size > size_m);
    let fits_m = sizes.find(|size| count_of(*size) <= MOST_HEXAHEDRA).unwrap_or(largest_m);
    Err(SeriesError::Count { size_m, count, fits_m })
}

/// Runs a series on the threads of the present pool; `progress` is told the share done (0 to 1) and what is under way.
///
/// # Errors
/// If the size of the elements makes no sense or too many of them, or the concrete does not suit it. A bend that fails is told in its case.
pub fn run(
    section: &RcSection,
    options: &SeriesOptions,
    progress: &(dyn Fn(f64, &str) + Sync),
) -> Result<Series, SeriesError> {
    check_mesh(section, options)?;
    let concrete = concrete_of(section, options);
    let member = |direction: &f64| {
        let sizes = [section.length_m, options.mesh_size_m];
        let member = if options.whole {
            RcMember::new(&section.input, &concrete, options.joint, sizes[0], sizes[1])
        } else {
            RcMember::half(&section.input, &concrete, options.joint, sizes, *direction)
        }?;
        Ok(match &section.anchorage {
            Some(anchorage) => {
                let strength_pa = section.concrete.compressive_strength_pa;
                member.anchored(anchorage, section.input.steel, &section.input.bars, strength_pa)
            }
            None => member,
        })
    };
    let members: Vec<RcMember> =
        options.directions_deg.iter().map(member).collect::<Result<_, LawError>>()?;
    let jobs: Vec<(&RcMember, [f64; 2])> = options
        .directions_deg
        .iter()
        .zip(&members)
        .flat_map(|(d, member)| options.axial_shares.iter().map(move |share| (member, [*share, *d])))
        .collect();
    let shares = Mutex::new(vec![0.0; jobs.len()]);
    let tell = |job: usize, done: f64| {
        let mut all = shares.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        all[job] = done;
        let sum: f64 = all.iter().sum();
        let finished = all.iter().filter(|s| **s >= 1.0).count();
        progress(sum / all.len() as f64, &format!("{finished} of {} bends done", all.len()));
    };
    let cases = jobs
        .par_iter()
        .with_max_len(1)
        .enumerate()
        .map(|(job, (member, [share, direction]))| {
            let case = one(section, member, options, [*share, *direction], &|done| tell(job, done));
            tell(job, 1.0);
            case
        })
        .collect();
    Ok(Series {
        options: options.clone(),
        elements: members.first().map_or([0; 2], |m| [m.mesh.elements.len(), m.mesh.trusses.len()]),
        length_m: members.first().map_or(section.length_m, |m| m.length_m),
        cases,
    })
}

fn one(
    section: &RcSection,
    member: &RcMember,
    options: &SeriesOptions,
    [axial_share, direction_deg]: [f64; 2],
    progress: &dyn Fn(f64),
) -> Case {
    let began = Instant::now();
    let axial_n = section.axial_n(axial_share);
    let is_cyclic = !options.turns_rad.is_empty();
    let turns_rad = if is_cyclic { options.turns_rad.clone() } else { vec![options.until_rad] };
    let load = Bend { axial_n, direction_deg, turns_rad, pace: 1.0 };
    let (pace, bent) = paced(member, load, progress);
    let demand = |b: &Bent| ShearDemand::of(section, &b.points, axial_n, direction_deg, member.length_m);
    let shear = bent.as_ref().ok().and_then(demand);
    let hysteresis = bent.as_ref().ok().filter(|_| is_cyclic).map(|b| {
        Hysteresis::of(&History {
            points: &b.points,
            turned_at: &b.turned_at,
            axial_n,
            length_m: member.length_m,
        })
    });
    let figures = match &hysteresis {
        Some(h) => Figures::of_sense(&h.envelopes, options.turns_rad[0]),
        None => bent.as_ref().ok().and_then(|b| Figures::of(&b.points)),
    };
    let curve = hysteresis.as_ref().filter(|_| options.fit_rule).map(|h| {
        let until = options.turns_rad.iter().map(|t| t.abs()).fold(0.0, f64::max);
        let load = Bend::monotonic(axial_n, direction_deg, BACKBONE_REACH * until);
        let backbone = bend(member, &load, false, &|_| {}).map_err(|e| e.to_string())?;
        h.curve(&backbone.points, axial_n)
    });
    let fibre_peak_nm = fibre_peak_nm(section, axial_n, direction_deg);
    Case {
        axial_share,
        axial_n,
        direction_deg,
        pace,
        bent,
        figures,
        hysteresis,
        curve,
        fibre_peak_nm,
        shear,
        seconds: began.elapsed().as_secs_f64(),
    }
}

/// Bends a member; a monotonic push with too much motion in it again at half of the speed, down to [`LEAST_PACE`].
fn paced(member: &RcMember, mut load: Bend, progress: &dyn Fn(f64)) -> (f64, Result<Bent, BendError>) {
    loop {
        let bent = bend(member, &load, false, progress);
        let moves = bent.as_ref().is_ok_and(|b| b.kinetic_share > KINETIC_LIMIT) && load.turns_rad.len() == 1;
        if !moves || load.pace <= LEAST_PACE {
            return (load.pace, bent);
        }
        load.pace *= 0.5;
    }
}

/// Largest moment of the fibre section \[N m\]; `None` if it does not bear the axial force.
pub fn fibre_peak_nm(section: &RcSection, axial_n: f64, direction_deg: f64) -> Option<f64> {
    let fibres = FibreSection::of(&section.input, fibre_concrete::ConcreteLaw::Mander);
    let depth = section.input.size_m[0].min(section.input.size_m[1]);
    let curvatures = FibreSection::curvatures_to(FIBRE_REACH / depth);
    let points = fibres.moment_curvature(axial_n, direction_deg.to_radians(), &curvatures);
    let peak = points.iter().map(|p| p.moment_nm).fold(0.0, f64::max);
    (peak > 0.0).then_some(peak)
}

/// Largest moments of the fibre section at an axial share over the directions of a series, every 15° between the first and the last and at those asked for:
/// `[direction (deg), moment (N m)]`.
pub fn fibre_peaks(section: &RcSection, axial_share: f64, series: &Series) -> Vec<[f64; 2]> {
    let asked = &series.options.directions_deg;
    let (first, last) =
        asked.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), d| (a.min(*d), b.max(*d)));
    let mut directions = asked.clone();
    directions.extend((1..).map(|k| first + FIBRE_STEP_DEG * f64::from(k)).take_while(|d| *d < last));
    directions.sort_by(f64::total_cmp);
    directions.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    let peak = |deg: &f64| {
        let known = series
            .cases
            .iter()
            .find(|c| c.axial_share == axial_share && (c.direction_deg - deg).abs() < 1e-6);
        let moment = match known {
            Some(case) => case.fibre_peak_nm,
            None => fibre_peak_nm(section, section.axial_n(axial_share), *deg),
        };
        Some([*deg, moment?])
    };
    directions.par_iter().filter_map(peak).collect()
}

#[cfg(test)]
mod tests {
    use super::Figures;

    #[test]
    fn figures_of_a_polygon_are_those_of_its_lines() {
        let points =
            [[0.0, 0.0, 0.0], [0.01, 75.0, 0.0], [0.03, 100.0, 0.0], [0.05, 60.0, 0.0], [0.06, 10.0, 0.0]];
        let f = Figures::of(&points).unwrap();
        assert_eq!((f.peak_nm, f.peak_rotation_rad), (100.0, 0.03));
        assert!((f.yield_rotation_rad - 0.01 / 0.75).abs() < 1e-15);
        assert!((f.rotation_80_rad.unwrap() - 0.04).abs() < 1e-15);
        assert!((f.rotation_20_rad.unwrap() - 0.058).abs() < 1e-15);
        let short = Figures::of(&points[..3]).unwrap();
        assert_eq!((short.rotation_80_rad, short.rotation_20_rad), (None, None));
        assert_eq!(Figures::of(&[[0.0; 3]]), None);
    }
}
