//! The FE run of a building: dead load, charges, collapse, histories.

use super::contact::RigidSurfaces;
use super::dynamics::{Death, Dynamics};
use super::mesh::Mesh;
use super::preload;
use super::probe::Probe;
use super::result::{ElementDeath, FeEnergies, FeRun, FeSummary, History, Touch};
use super::strain_rate::StrainWindow;
use crate::base::cpu::Stopwatch;
use crate::building::partition::Partition;
use crate::building::tracked::tracked_points;
use crate::building::{Building, MemberKind};

/// Options of a run.
#[derive(Debug, Clone, Default)]
pub struct FeOptions {
    /// Element size other than the building's \[m\].
    pub mesh_size_m: Option<f64>,
    /// End time other than the building's \[s\].
    pub end_time_s: Option<f64>,
    /// Share of the stability limit other than [`super::dynamics::STEP_SAFETY`].
    pub step_safety: Option<f64>,
}

/// How far a run is.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// Simulated time \[s\].
    pub time_s: f64,
    /// Simulated time at the end \[s\].
    pub end_s: f64,
}

/// A run that cannot go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FeError {
    /// No static state under dead load.
    #[error("no dead-load state: {0}")]
    Preload(String),
    /// Not a number.
    #[error(
        "at t = {time_s:.6} s node {node} of part `{part}` has no finite position or velocity; try a smaller time step or a finer mesh"
    )]
    NotFinite {
        /// Time \[s\].
        time_s: f64,
        /// Node index.
        node: usize,
        /// Part of an element at the node.
        part: String,
    },
    /// More energy than was put in.
    #[error(
        "at t = {time_s:.6} s the energy balance is off by {percent:.1} % of the work done; the run is not trustworthy"
    )]
    Energy {
        /// Time \[s\].
        time_s: f64,
        /// Residual over work \[%\].
        percent: f64,
    },
}

/// Energy residual (over the work of gravity) at which a run is stopped.
pub const ENERGY_LIMIT: f64 = 0.10;

/// Runs a building. `report` is called at every output time.
pub fn run(
    building: &Building,
    options: &FeOptions,
    report: &mut dyn FnMut(Progress),
) -> Result<FeRun, FeError> {
    let watch = Stopwatch::start();
    let settings = &building.settings;
    let (mesh, snapped) = Mesh::of(building, options.mesh_size_m.unwrap_or(settings.mesh_size_m));
    let parallel = rayon::current_num_threads() > 1;
    let mut body = Dynamics::new(&mesh, settings.gravity_m_s2, RigidSurfaces::of(building), parallel);
    let preload_iterations = preload::equilibrate(&mesh, &mut body).map_err(FeError::Preload)?;
    body.surfaces.new_touches.clear();
    if let Some(safety) = options.step_safety {
        body.set_step_safety(safety);
    }
    let mut recorder = Recorder::new(building, &mesh, &body);
    let mut removal = Removal::new(building, &mesh);
    let end_s = options.end_time_s.unwrap_or(settings.end_time_s);
    let interval = settings.output_interval_s;
    let outputs = (end_s / interval).round().max(1.0) as usize;
    recorder.record(building, &mesh, &mut body, 0.0, interval)?;
    for output in 1..=outputs {
        let target = output as f64 * interval;
        while body.time_s < target - 0.5 * body.dt_s {
            removal.apply(&mesh, &mut body, settings.removal_duration_s, &mut recorder);
            let last = body.time_s + 1.5 * body.dt_s >= target;
            recorder.kinetic_j = body.step(last);
            recorder.note(&mesh, &mut body, building);
        }
        let kinetic = recorder.kinetic_j;
        recorder.record(building, &mesh, &mut body, kinetic, interval)?;
        report(Progress { time_s: body.time_s, end_s });
    }
    let mut result = recorder.finish(mesh, snapped, &body);
    result.summary.preload_iterations = preload_iterations;
    result.summary.elapsed = watch.elapsed();
    Ok(result)
}

/// Charges: which elements go when.
struct Removal {
    /// `(time, elements)` not yet finished.
    pending: Vec<(f64, Vec<usize>)>,
}

impl Removal {
    fn new(building: &Building, mesh: &Mesh) -> Self {
        let pending = building
            .events
            .iter()
            .map(|charge| {
                let part = building.members.iter().position(|m| m.id == charge.member);
                let hit = |e: &usize| {
                    if Some(mesh.elements[*e].part) != part {
                        return false;
                    }
                    let member = &building.members[mesh.elements[*e].part];
                    let along = mesh.center(*e)[member.axis] - member.solid.min[member.axis];
                    charge.stretch_m.is_none_or(|[from, to]| along >= from && along <= to)
                };
                (charge.time_s, (0..mesh.elements.len()).filter(hit).collect())
            })
            .collect();
        Self { pending }
    }

    /// Lowers the acting share of elements under removal; at the end takes their mass away.
    fn apply(&mut self, mesh: &Mesh, body: &mut Dynamics, duration_s: f64, recorder: &mut Recorder) {
        let now = body.time_s;
        let mut finished = Vec::new();
        self.pending.retain(|(start, elements)| {
            if now < *start {
                return true;
            }
            let share = if duration_s > 0.0 { 1.0 - (now - start) / duration_s } else { 0.0 };
            for e in elements {
                if body.blocks.share(*e) == 0.0 {
                    continue;
                }
                body.blocks.set_share(*e, share.max(0.0));
                if share <= 0.0 {
                    finished.push(*e);
                }
            }
            share > 0.0
        });
        if finished.is_empty() {
            return;
        }
        for e in &finished {
            recorder.deaths.push(ElementDeath { element: *e, time_s: now, cause: Death::Removed });
            recorder.removed[*e] = true;
        }
        let before = body.kinetic_j();
        body.assemble_mass(mesh, |e| !recorder.removed[e]);
        recorder.removed_j += body.kinetic_j() - before;
        body.clear_forces_of_dead();
    }
}

/// Collects what the run shows.
struct Recorder {
    probes: Vec<Probe>,
    start_m: Vec<[f64; 3]>,
    last_m: Vec<[f64; 3]>,
    times_s: Vec<f64>,
    tracked: Vec<History>,
    frames_m: Vec<Vec<[f32; 3]>>,
    strain_rates_1_s: Vec<Vec<f32>>,
    window: StrainWindow,
    deaths: Vec<ElementDeath>,
    removed: Vec<bool>,
    touches: Vec<Touch>,
    energies: Vec<FeEnergies>,
    initial_j: f64,
    kinetic_j: f64,
    removed_j: f64,
    standing: Vec<bool>,
    energy_error: f64,
    hourglass_share: f64,
    first_contact_s: Option<f64>,
}

impl Recorder {
    fn new(building: &Building, mesh: &Mesh, body: &Dynamics) -> Self {
        let partition = Partition::of(building);
        let probes: Vec<Probe> = tracked_points(building, &partition)
            .iter()
            .filter_map(|t| {
                let part = building.members.iter().position(|m| m.id == t.member)?;
                Probe::new(mesh, &t.id, part, t.point_m, building.members[part].kind == MemberKind::Column)
            })
            .collect();
        let start_m: Vec<[f64; 3]> =
            probes.iter().map(|p| p.position(mesh, &body.blocks, &body.x).unwrap_or(p.point_m)).collect();
        let tracked =
            probes.iter().map(|p| History { id: p.id.clone(), displacement_m: Vec::new() }).collect();
        let standing =
            building.members.iter().map(|m| building.supports.iter().any(|s| s.member == m.id)).collect();
        Self {
            last_m: start_m.clone(),
            probes,
            start_m,
            times_s: Vec::new(),
            tracked,
            frames_m: Vec::new(),
            strain_rates_1_s: Vec::new(),
            window: StrainWindow::new(&body.x),
            deaths: Vec::new(),
            removed: vec![false; mesh.elements.len()],
            touches: Vec::new(),
            energies: Vec::new(),
            initial_j: body.blocks.energies_j().iter().sum(),
            kinetic_j: 0.0,
            removed_j: 0.0,
            standing,
            energy_error: 0.0,
            hourglass_share: 0.0,
            first_contact_s: None,
        }
    }

    /// Events of one step.
    fn note(&mut self, mesh: &Mesh, body: &mut Dynamics, building: &Building) {
        for (element, cause) in &body.deaths {
            self.deaths.push(ElementDeath { element: *element, time_s: body.time_s, cause: *cause });
            self.window.note_end(mesh, *element, &body.x);
        }
        for (node, surface) in std::mem::take(&mut body.surfaces.new_touches) {
            let Some(element) = body.blocks.elements_at(node).find(|e| body.blocks.share(*e) > 0.0) else {
                continue;
            };
            let part = mesh.elements[element].part;
            let surface = match surface {
                0 => "ground".to_string(),
                i => building.obstacles[i - 1].id.clone(),
            };
            if surface == "ground" && !self.standing[part] {
                self.first_contact_s.get_or_insert(body.time_s);
            }
            let part = mesh.parts[part].clone();
            if !self.touches.iter().any(|t| t.part == part && t.surface == surface) {
                self.touches.push(Touch { time_s: body.time_s, part, surface });
            }
        }
    }

    /// One output.
    fn record(
        &mut self,
        building: &Building,
        mesh: &Mesh,
        body: &mut Dynamics,
        kinetic_j: f64,
        interval: f64,
    ) -> Result<(), FeError> {
        let time_s = self.times_s.len() as f64 * interval;
        if let Some(node) = body.broken_node() {
            let part = body
                .blocks
                .elements_at(node)
                .next()
                .map_or("?".into(), |e| mesh.parts[mesh.elements[e].part].clone());
            return Err(FeError::NotFinite { time_s: body.time_s, node, part });
        }
        self.times_s.push(time_s);
        for (i, probe) in self.probes.iter().enumerate() {
            let at = probe.position(mesh, &body.blocks, &body.x).unwrap_or(self.last_m[i]);
            self.last_m[i] = at;
            self.tracked[i].displacement_m.push(std::array::from_fn(|k| at[k] - self.start_m[i][k]));
        }
        self.frames_m.push(body.x.iter().map(|p| p.map(|c| c as f32)).collect());
        self.strain_rates_1_s.push(self.window.finish(
            mesh,
            |e| body.blocks.share(e) > 0.0,
            &body.x,
            interval,
        ));
        self.balance(building, body, kinetic_j)
    }

    fn balance(&mut self, building: &Building, body: &Dynamics, kinetic_j: f64) -> Result<(), FeError> {
        let [internal_j, hourglass_j, viscous_j] = body.blocks.energies_j();
        let eroded_j = self
            .deaths
            .iter()
            .filter(|d| d.cause != Death::Removed)
            .map(|d| body.blocks.internal_j(d.element))
            .sum();
        let [contact_j, friction_j] = body.contact_j;
        let supplied = self.initial_j + body.gravity_j + contact_j + friction_j + self.removed_j;
        let residual_j = kinetic_j + internal_j + hourglass_j + viscous_j - supplied;
        self.energies.push(FeEnergies {
            kinetic_j,
            internal_j,
            eroded_j,
            hourglass_j,
            viscous_j,
            gravity_j: body.gravity_j,
            contact_j,
            friction_j,
            removed_j: self.removed_j,
            residual_j,
        });
        let largest = self
            .energies
            .iter()
            .map(|e| e.gravity_j.abs().max(e.kinetic_j + e.internal_j))
            .fold(1e-9, f64::max);
        let error = residual_j.abs() / largest;
        let fall_j = 0.01 * body.mass_kg.iter().sum::<f64>() * building.settings.gravity_m_s2;
        if body.gravity_j > fall_j {
            self.hourglass_share = self.hourglass_share.max(hourglass_j / internal_j);
            self.energy_error = self.energy_error.max(error);
            if residual_j / largest > ENERGY_LIMIT {
                return Err(FeError::Energy { time_s: body.time_s, percent: 100.0 * error });
            }
        }
        Ok(())
    }

    fn finish(self, mesh: Mesh, snapped: Vec<super::mesh::Snapped>, body: &Dynamics) -> FeRun {
        let summary = FeSummary {
            elements: mesh.elements.len(),
            nodes: mesh.nodes.len(),
            mass_kg: (0..mesh.elements.len()).map(|e| body.blocks.mass_kg(e)).sum(),
            steps: body.steps,
            time_step_s: body.first_dt_s,
            first_ground_contact_s: self.first_contact_s,
            eroded_elements: self.deaths.iter().filter(|d| d.cause != Death::Removed).count(),
            energy_error: self.energy_error,
            hourglass_share: self.hourglass_share,
            ..FeSummary::default()
        };
        let plastic_strain = (0..mesh.elements.len()).map(|e| body.blocks.plastic_strain(e)).collect();
        FeRun {
            mesh,
            snapped,
            times_s: self.times_s,
            tracked: self.tracked,
            frames_m: self.frames_m,
            strain_rates_1_s: self.strain_rates_1_s,
            plastic_strain,
            deaths: self.deaths,
            touches: self.touches,
            energies: self.energies,
            summary,
        }
    }
}
