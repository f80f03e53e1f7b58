//! Axial, shear and torsion curves of a member: runs of a piece with the figures of each, and what closed forms and published formulae say.
//!
//! Runs go beside each other on the threads of the pool, each of them on one thread: results do not depend on the number of threads.

use super::member::RcMember;
use super::piece::{self, Drive, PieceError, PieceLoad, PieceRun};
use super::section_file::RcSection;
use super::{axial, shear, torsion};
use crate::material::concrete::{ConcreteLaw, LawError, Surface};
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Mutex;
use std::time::Instant;

/// What is run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpringOptions {
    /// What is done to the piece.
    pub drive: Drive,
    /// Axial forces over `f_c A` of shear and torsion, compression positive.
    pub axial_shares: Vec<f64>,
    /// Directions of shear: 0 along x, 90 along y \[deg\].
    pub directions_deg: Vec<f64>,
    /// Length of the piece in larger sides of the section; rounded to whole spacings of the ties.
    pub length_depths: f64,
    /// Shortening or elongation over length, drift, or rotation times width over length at which a run stops.
    pub until: f64,
    /// Size of the elements \[m\].
    pub mesh_size_m: f64,
    /// Whether the lower section is rough: a contact.
    pub rough: bool,
    /// Whether longitudinal bars stay elastic in shear, so that the ends do not fail by bending.
    pub elastic_bars: bool,
    /// Whether the concrete has the seed's pure surfaces.
    pub seed_law: bool,
    /// `crack_softening` of the concrete law, where it is not that of the section.
    pub crack_softening: Option<f64>,
}

impl SpringOptions {
    /// What is usual.
    pub fn of(drive: Drive) -> Self {
        let (axial_shares, length_depths, until) = match drive {
            Drive::Crush => (vec![0.0], 1.0, 0.1),
            Drive::Tension => (vec![0.0], 1.0, 0.5),
            Drive::Shear => (vec![0.0, 0.1, 0.3], 4.0, 0.02),
            Drive::Torsion => (vec![0.0, 0.1, 0.3], 2.0, 0.04),
        };
        Self {
            drive,
            axial_shares,
            directions_deg: vec![90.0],
            length_depths,
            until,
            mesh_size_m: 0.05,
            rough: false,
            elastic_bars: true,
            seed_law: false,
            crack_softening: None,
        }
    }

    /// The concrete of a section under these options.
    pub fn concrete_of(&self, section: &RcSection) -> ConcreteLaw {
        let mut law = section.concrete.clone();
        if self.seed_law {
            law.surface = Surface::SEED;
        }
        if let Some(softening) = self.crack_softening {
            law.surface.crack_softening = softening;
        }
        law
    }

    /// The mesh of a section's piece.
    ///
    /// # Errors
    /// If the concrete does not suit the elements.
    pub fn piece(&self, section: &RcSection) -> Result<RcMember, LawError> {
        let length_m = axial::piece_length_m(section, self.length_depths);
        let concrete = self.concrete_of(section);
        match self.drive {
            Drive::Crush | Drive::Tension => axial::piece(section, &concrete, length_m, self.mesh_size_m),
            Drive::Shear => shear::piece(section, &concrete, length_m, self.mesh_size_m, self.elastic_bars),
            Drive::Torsion => shear::piece(section, &concrete, length_m, self.mesh_size_m, false),
        }
    }
}

/// Figures of a curve; forces in N and displacements in m, or torques in N m and rotations in rad.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SpringFigures {
    /// Initial stiffness.
    pub stiffness: f64,
    /// Displacement and force at the first crack in the middle third of the length.
    pub first_crack: Option<[f64; 2]>,
    /// Where the secant stiffness is 80 % of the initial one for good.
    pub softened: Option<[f64; 2]>,
    /// Where the first longitudinal bar yields.
    pub bar_yield: Option<[f64; 2]>,
    /// Where the first tie yields.
    pub tie_yield: Option<[f64; 2]>,
    /// Largest resistance.
    pub peak: f64,
    /// Displacement at it.
    pub peak_at: f64,
    /// Displacement beyond the peak at which 80 % of it are left.
    pub at_80: Option<f64>,
    /// As before, 20 %.
    pub at_20: Option<f64>,
    /// Energy of the concrete and of bars and ties at the end \[J\].
    pub energy_j: [f64; 2],
    /// Elements of longitudinal bars and of ties that ruptured.
    pub ruptured: [usize; 2],
}

impl SpringFigures {
    /// Figures of a run.
    pub fn of(run: &PieceRun) -> Self {
        let peak = run.points[run.peak()];
        Self {
            stiffness: run.stiffness(),
            first_crack: run.first_crack,
            softened: run.softened(),
            bar_yield: run.first_yield[0],
            tie_yield: run.first_yield[1],
            peak: peak.force,
            peak_at: peak.at,
            at_80: run.fall_to(0.8),
            at_20: run.fall_to(piece::FAILED_SHARE),
            energy_j: run.points[run.points.len() - 1].energy_j,
            ruptured: run.ruptured,
        }
    }
}

/// What a closed form or a published formula says, and what the run gives for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reference {
    /// What it is.
    pub name: &'static str,
    /// Its value: N, N m, J, m, N/m or N m/rad.
    pub value: f64,
    /// What the run gives; `None`: it did not come to that.
    pub found: Option<f64>,
}

impl Reference {
    /// What the run gives over the reference.
    pub fn ratio(&self) -> Option<f64> {
        self.found.filter(|_| self.value > 0.0).map(|f| f / self.value)
    }
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct SpringCase {
    /// Axial force over `f_c A`.
    pub axial_share: f64,
    /// Axial force, compression positive \[N\].
    pub axial_n: f64,
    /// Direction of shear \[deg\].
    pub direction_deg: f64,
    /// The run, or why there is none.
    pub run: Result<PieceRun, PieceError>,
    /// Figures of the curve.
    pub figures: Option<SpringFigures>,
    /// What it is compared with.
    pub references: Vec<Reference>,
    /// Time it took \[s\].
    pub seconds: f64,
}

impl SpringCase {
    /// Why it cannot be used, in words.
    pub fn fault(&self) -> Option<String> {
        self.run.as_ref().map_or_else(|e| Some(e.to_string()), PieceRun::fault)
    }
}

/// All runs of a piece.
#[derive(Debug, Clone, PartialEq)]
pub struct Springs {
    /// What was run.
    pub options: SpringOptions,
    /// Elements of the mesh: hexahedra and bars.
    pub elements: [usize; 2],
    /// Length of the piece \[m\].
    pub length_m: f64,
    /// Runs by direction, then by axial force.
    pub cases: Vec<SpringCase>,
    /// `[shortening (m), force (N)]` of the fibre section, for a crushed piece.
    pub fibre: Vec<[f64; 2]>,
}

/// Runs a piece on the threads of the present pool; `progress` is told the share done (0 to 1) and what is under way.
///
/// # Errors
/// If the concrete does not suit the size of the elements. A run that fails is told in its case.
pub fn run(
    section: &RcSection,
    options: &SpringOptions,
    progress: &(dyn Fn(f64, &str) + Sync),
) -> Result<Springs, LawError> {
    let member = options.piece(section)?;
    let across = options.drive == Drive::Shear;
    let along = matches!(options.drive, Drive::Crush | Drive::Tension);
    let directions = if across { options.directions_deg.clone() } else { vec![90.0] };
    let shares = if along { vec![0.0] } else { options.axial_shares.clone() };
    let jobs: Vec<[f64; 2]> = directions.iter().flat_map(|d| shares.iter().map(|s| [*s, *d])).collect();
    let done = Mutex::new(vec![0.0; jobs.len()]);
    let tell = |job: usize, share: f64| {
        let mut all = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        all[job] = share;
        let finished = all.iter().filter(|s| **s >= 1.0).count();
        let sum: f64 = all.iter().sum();
        progress(sum / all.len() as f64, &format!("{finished} of {} runs done", all.len()));
    };
    let jobs = jobs.par_iter().with_max_len(1).enumerate();
    let cases = jobs.map(|(job, [share, direction])| {
        let at = |d: f64| tell(job, (d / options.until).sqrt().min(0.999));
        let case = one(section, &member, options, [*share, *direction], &at);
        tell(job, 1.0);
        case
    });
    let cases: Vec<SpringCase> = cases.collect();
    let reach = cases.iter().filter_map(|c| Some(c.run.as_ref().ok()?.points.last()?.at)).fold(0.0, f64::max);
    let fibre = match options.drive {
        Drive::Crush => axial::fibre_line(section, member.length_m, reach / member.length_m),
        _ => Vec::new(),
    };
    Ok(Springs {
        options: options.clone(),
        elements: [member.mesh.elements.len(), member.mesh.trusses.len()],
        length_m: member.length_m,
        cases,
        fibre,
    })
}

fn one(
    section: &RcSection,
    member: &RcMember,
    options: &SpringOptions,
    [axial_share, direction_deg]: [f64; 2],
    progress: &dyn Fn(f64),
) -> SpringCase {
    let began = Instant::now();
    let axial_n = section.axial_n(axial_share);
    let load = PieceLoad {
        drive: options.drive,
        direction_deg,
        axial_n,
        until: options.until,
        rough: options.rough,
    };
    let [width, depth] = section.input.size_m;
    let run = piece::run(member, width.min(depth), &load, progress);
    let figures = run.as_ref().ok().map(SpringFigures::of);
    let references = figures.map_or(Vec::new(), |f| references(section, &load, member.length_m, &f));
    let seconds = began.elapsed().as_secs_f64();
    SpringCase { axial_share, axial_n, direction_deg, run, figures, references, seconds }
}

/// What a run is compared with.
fn references(section: &RcSection, load: &PieceLoad, length_m: f64, f: &SpringFigures) -> Vec<Reference> {
    let line = |name, value, found| Reference { name, value, found };
    let force = |at: Option<[f64; 2]>| at.map(|p| p[1]);
    let n = load.axial_n;
    match load.drive {
        Drive::Crush => {
            let crushing = section.concrete.crushing_energy_j_m2 * section.input.area_m2();
            let mut all = vec![
                line("elastic stiffness", axial::stiffness_n_m(section, length_m), Some(f.stiffness)),
                line("squash load", axial::squash_n(section), Some(f.peak)),
                line("G_c A", crushing, Some(f.energy_j[0])),
            ];
            if let Some(core) = axial::confined_n(section) {
                // the pressure of the ties is there when they yield
                all.insert(2, line("confined core", core, force(f.tie_yield)));
            }
            all
        }
        Drive::Tension => {
            let [yielding, ultimate] = axial::bars_n(section);
            let rupture = section.input.steel.ultimate_strain * length_m;
            let ruptured = (f.ruptured[0] > 0).then_some(f.peak_at);
            vec![
                line("elastic stiffness", axial::stiffness_n_m(section, length_m), Some(f.stiffness)),
                line("cracking load", axial::cracking_n(section), force(f.first_crack)),
                line("yield of the bars", yielding, force(f.bar_yield)),
                line("ultimate strength", ultimate, Some(f.peak)),
                line("elongation at rupture", rupture, ruptured),
            ]
        }
        Drive::Shear => {
            // the principal tension in the middle is the same in every direction
            let cracking = line("cracking shear", shear::cracking_n(section, n), force(f.first_crack));
            let Some(axis) = shear::axis_of(load.direction_deg) else { return vec![cracking] };
            let peak = Some(f.peak);
            let strength_pa = section.concrete.compressive_strength_pa;
            let asce = shear::asce_column_n(&section.input, strength_pa, axis, n, 0.5 * length_m);
            vec![
                line("elastic stiffness", shear::stiffness_n_m(section, axis, length_m), Some(f.stiffness)),
                cracking,
                line("EN 6.2.2", shear::en_without_ties_n(section, axis, n), peak),
                line("EN 6.2.3", shear::en_truss_n(section, axis, n)[0], peak),
                line("ASCE 41", asce, peak),
            ]
        }
        Drive::Torsion => {
            let elastic = torsion::elastic_cracking_nm(section, n);
            let plastic = torsion::plastic_cracking_nm(section, n);
            let mut all = vec![
                line("G I_t / l", torsion::stiffness_nm_rad(section, length_m), Some(f.stiffness)),
                line("elastic cracking", elastic, force(f.first_crack)),
                line("plastic cracking", plastic, force(f.softened)),
            ];
            if let Some(truss) = torsion::space_truss_nm(section, n) {
                // its ties yield; the piece goes on rising with the stretch of its bars
                all.push(line("EN 6.3.2", truss, force(f.tie_yield)));
            }
            all
        }
    }
}
