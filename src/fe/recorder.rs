//! What a run shows, gathered while it runs: histories, energies, events, and of each element just the extremes.

use super::dynamics::{Death, Dynamics};
use super::erosion::{ErosionTable, free_nodes};
use super::hybrid::HybridRecord;
use super::mesh::{Mesh, Snapped};
use super::probe::Probe;
use super::result::{ElementDeath, FeEnergies, FeRun, FeSummary, History, KeptFrame, StrainRates, Touch};
use super::run::FeError;
use super::section_force::Sections;
use super::split::Split;
use super::strain_rate::StrainWindow;
use super::truss::BarRupture;
use super::vtu::{Frame, FrameSink};
use super::watch::{Books, Watch};
use crate::building::partition::Partition;
use crate::building::tracked::{stands_to_m, stretches_to_m, tracked_points};
use crate::building::{Building, Member, MemberKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Node positions that are kept in memory for reports at most, over all frames \[bytes\].
const MOST_KEPT_BYTES: usize = 100_000_000;

/// Collects what the run shows. All of it is in checkpoints.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Recorder {
    probes: Vec<Probe>,
    start_m: Vec<[f64; 3]>,
    last_m: Vec<[f64; 3]>,
    times_s: Vec<f64>,
    tracked: Vec<History>,
    /// Node positions under dead load \[m\].
    rest_m: Vec<[f64; 3]>,
    /// Frames kept in memory, one every so many outputs; 0: none.
    keep_every: usize,
    frames: Vec<KeptFrame>,
    rates: StrainRates,
    window: StrainWindow,
    sections: Sections,
    pub(super) deaths: Vec<ElementDeath>,
    ruptures: Vec<BarRupture>,
    pub(super) removed: Vec<bool>,
    pub(super) splits: Vec<Split>,
    touches: Vec<Touch>,
    energies: Vec<FeEnergies>,
    initial_j: f64,
    pub(super) kinetic_j: f64,
    pub(super) removed_j: f64,
    /// The level up to which each member stands on the ground from the start on: that it goes on standing there while it is crushed is no first contact \[m\].
    stands_to_m: Vec<f64>,
    energy_error: f64,
    hourglass_share: f64,
    first_contact_s: Option<f64>,
    watch: Watch,
    hybrid: HybridRecord,
}

impl Recorder {
    /// Begins at the dead-load state of a run of `outputs` outputs; `keep_frames`: frames stay in memory for a report, thinned out if
    /// they would be too large.
    pub fn new(building: &Building, mesh: &Mesh, body: &Dynamics, outputs: usize, keep_frames: bool) -> Self {
        let partition = Partition::of(building);
        let probes: Vec<Probe> = tracked_points(building, &partition)
            .iter()
            .filter_map(|t| {
                let part = building.members.iter().position(|m| m.id == t.member)?;
                let member = &building.members[part];
                // of a column of which charges take a stretch what is above it carries the top
                let above_m = stretches_to_m(building, member).unwrap_or(f64::NEG_INFINITY);
                let carried_by = (member.kind == MemberKind::Column, above_m);
                Probe::new(mesh, &t.id, part, t.point_m, carried_by)
            })
            .collect();
        let start_m: Vec<[f64; 3]> =
            probes.iter().map(|p| p.position(mesh, &body.blocks, &body.x).unwrap_or(p.point_m)).collect();
        let tracked = probes.iter().map(|p| History { id: p.id.clone(), ..History::default() }).collect();
        let stands_to = |m: &Member| match building.supports.iter().any(|s| s.member == m.id) {
            true => stands_to_m(building, m),
            false => f64::NEG_INFINITY,
        };
        Self {
            last_m: start_m.clone(),
            probes,
            start_m,
            times_s: Vec::new(),
            tracked,
            rest_m: body.x.clone(),
            keep_every: if keep_frames { kept_every(mesh.nodes.len(), outputs) } else { 0 },
            frames: Vec::new(),
            rates: StrainRates::new(mesh.elements.len(), building.settings.critical_strain_rate_1_s),
            window: StrainWindow::new(&body.x),
            sections: Sections::of(building, mesh),
            deaths: Vec::new(),
            ruptures: Vec::new(),
            removed: vec![false; mesh.elements.len()],
            splits: Vec::new(),
            touches: Vec::new(),
            energies: Vec::new(),
            initial_j: body.blocks.energies_j().iter().sum::<f64>() + body.trusses.internal_j(),
            kinetic_j: 0.0,
            removed_j: 0.0,
            stands_to_m: building.members.iter().map(stands_to).collect(),
            energy_error: 0.0,
            hourglass_share: 0.0,
            first_contact_s: None,
            watch: Watch::new(fall_j(building, body)),
            hybrid: HybridRecord::default(),
        }
    }

    /// Events of one step.
    pub fn note(&mut self, mesh: &Mesh, body: &mut Dynamics, building: &Building) {
        for (element, cause) in &body.deaths {
            self.deaths.push(ElementDeath { element: *element, time_s: body.time_s, cause: *cause });
            self.window.note_end(mesh, *element, &body.x);
        }
        self.ruptures.extend(body.trusses.ruptures(mesh, body.time_s));
        for (node, surface) in std::mem::take(&mut body.surfaces.new_touches) {
            let Some(part) = part_at(mesh, body, node) else { continue };
            if surface == 0 && self.rest_m[node][2] > self.stands_to_m[part] {
                self.first_contact_s.get_or_insert(body.time_s);
            }
            let [part, surface] =
                [mesh.parts[part].as_str(), surface_name(building, surface)].map(str::to_string);
            if !self.touches.iter().any(|t| t.part == part && t.surface == surface) {
                self.touches.push(Touch { time_s: body.time_s, part, surface, force_n: 0.0 });
            }
        }
    }

    /// Forces of surfaces on parts over the last output interval; what stands on the ground from the start has none.
    fn weigh(&mut self, mesh: &Mesh, body: &mut Dynamics, building: &Building) {
        let mut impulses = BTreeMap::<(usize, usize), f64>::new();
        for (node, push) in body.surfaces.take_pushes().into_iter().enumerate() {
            if push.impulse_ns > 0.0
                && let Some(part) = part_at(mesh, body, node)
            {
                *impulses.entry((part, push.surface)).or_default() += push.impulse_ns;
            }
        }
        for ((part, surface), impulse_ns) in impulses {
            let [part, surface] = [mesh.parts[part].as_str(), surface_name(building, surface)];
            if let Some(touch) = self.touches.iter_mut().find(|t| t.part == part && t.surface == surface) {
                let force_n = (impulse_ns / building.settings.output_interval_s).round();
                touch.force_n = touch.force_n.max(force_n);
            }
        }
    }

    /// Elements that were detached in a step.
    pub fn follow(&mut self, splits: &[Split]) {
        self.window.follow(splits);
        for [old, _] in splits.iter().flat_map(|s| &s.copies) {
            self.rest_m.push(self.rest_m[*old]);
        }
        self.splits.extend_from_slice(splits);
    }

    /// One output; `frames` gets the state.
    pub fn record(
        &mut self,
        building: &Building,
        mesh: &Mesh,
        body: &mut Dynamics,
        frames: Option<&mut (dyn FrameSink + '_)>,
    ) -> Result<(), FeError> {
        self.weigh(mesh, body, building);
        let body = &*body;
        let interval = building.settings.output_interval_s;
        let output = self.times_s.len();
        let time_s = output as f64 * interval;
        self.look(mesh, body)?;
        self.times_s.push(time_s);
        for (i, probe) in self.probes.iter().enumerate() {
            let at = probe.position(mesh, &body.blocks, &body.x).unwrap_or(self.last_m[i]);
            self.last_m[i] = at;
            let point = &mut self.tracked[i];
            point.displacement_m.push(std::array::from_fn(|k| at[k] - self.start_m[i][k]));
            if point.debris_s.is_none() && probe.is_debris(mesh, &body.blocks) {
                point.debris_s = Some(time_s);
            }
        }
        let rates = self.window.finish(mesh, |e| body.blocks.share(e) > 0.0, &body.x, interval);
        self.rates.add(time_s, &rates);
        self.sections.look(&body.blocks, &self.removed, &body.x, time_s);
        if self.keep_every > 0 && output.is_multiple_of(self.keep_every) {
            self.frames.push(kept_frame(output, body, &rates, self.rates.critical_1_s));
        }
        if let Some(sink) = frames {
            let start_m = &self.rest_m[..];
            let frame = Frame { output, time_s, mesh, body, start_m, strain_rates_1_s: &rates };
            sink.frame(&frame).map_err(FeError::Output)?;
        }
        self.balance(building, body);
        if let Some(hybrid) = &body.hybrid {
            let acting = (0..mesh.elements.len()).filter(|e| body.blocks.share(*e) > 0.0).count();
            self.hybrid.rigid_share.push(hybrid.rigid() as f64 / acting.max(1) as f64);
            self.hybrid.sets.push(hybrid.sets.len());
            self.hybrid.switched_j.push(hybrid.books.switched_j);
        }
        Ok(())
    }

    /// Stops a run that is not sound.
    pub fn look(&mut self, mesh: &Mesh, body: &Dynamics) -> Result<(), FeError> {
        let books = self.books(body);
        self.watch.look(mesh, body, &books)
    }

    fn books(&self, body: &Dynamics) -> Books {
        Books::of(body, self.kinetic_j, self.initial_j, self.removed_j)
    }

    fn balance(&mut self, building: &Building, body: &Dynamics) {
        let books = self.books(body);
        let residual_j = books.residual_j();
        let eroded_j = self
            .deaths
            .iter()
            .filter(|d| !matches!(d.cause, Death::Removed | Death::Split))
            .map(|d| body.blocks.internal_j(d.element))
            .fold(0.0, |sum, j| sum + j); // the sum of nothing would be -0
        self.energies.push(FeEnergies {
            kinetic_j: books.kinetic_j,
            internal_j: books.internal_j,
            eroded_j,
            hourglass_j: books.hourglass_j,
            viscous_j: books.viscous_j,
            gravity_j: books.body_loads_j,
            contact_j: books.contact_j,
            friction_j: books.friction_j,
            // nothing else drives a building
            removed_j: books.removed_j + books.driven_j,
            released_j: books.released_j,
            eroded_elastic_j: body.failure.table.elastic_j(),
            free_kinetic_j: free_nodes(body).kinetic_j,
            residual_j,
        });
        let largest = self
            .energies
            .iter()
            .map(|e| e.gravity_j.abs().max(e.kinetic_j + e.internal_j))
            .fold(1e-9, f64::max);
        if body.gravity_j > fall_j(building, body) {
            self.hourglass_share = self.hourglass_share.max((books.hourglass_j / books.internal_j).abs());
            self.energy_error = self.energy_error.max(residual_j.abs() / largest);
        }
    }

    /// Number of outputs recorded so far.
    pub fn count(&self) -> usize {
        self.times_s.len()
    }

    /// The results.
    pub fn finish(mut self, mesh: Mesh, snapped: Vec<Snapped>, body: &Dynamics) -> FeRun {
        let copied: Vec<[usize; 2]> = self.splits.iter().flat_map(|s| &s.copies).copied().collect();
        for frame in self.frames.iter_mut().map(|f| &mut f.nodes_m) {
            for [old, new] in &copied {
                if *new == frame.len() {
                    frame.push(frame[*old]);
                }
            }
        }
        let erosion = ErosionTable { free: free_nodes(body), ..body.failure.table };
        let summary = FeSummary {
            elements: mesh.elements.len(),
            nodes: mesh.nodes.len() - copied.len(),
            mass_kg: (0..mesh.elements.len()).map(|e| body.blocks.mass_kg(e)).sum(),
            steps: body.steps,
            time_step_s: body.first_dt_s,
            first_ground_contact_s: self.first_contact_s,
            eroded_elements: erosion.eroded(),
            erosion,
            ruptured_bars: self.ruptures.len(),
            energy_error: self.energy_error,
            hourglass_share: self.hourglass_share,
            quiet_share: body.blocks.skipped() as f64
                / (body.steps.max(1) * mesh.elements.len() as u64) as f64,
            body_contact: body.body_contact.as_ref().map(|c| c.summary().clone()),
            ..FeSummary::default()
        };
        let hybrid = body.hybrid.as_ref().map(|hybrid| HybridRecord {
            switching: hybrid.softens(),
            skipped_share: hybrid.books.skipped as f64
                / (body.steps.max(1) * mesh.elements.len() as u64) as f64,
            checks: hybrid.books.checks[0],
            factors: hybrid.books.checks[1],
            switches: hybrid.books.switches.clone(),
            ..self.hybrid
        });
        let plastic_strain = (0..mesh.elements.len()).map(|e| body.blocks.plastic_strain(e)).collect();
        FeRun {
            mesh,
            snapped,
            times_s: self.times_s,
            tracked: self.tracked,
            frames: self.frames,
            last_m: body.x.iter().map(|p| p.map(|c| c as f32)).collect(),
            strain_rates: self.rates,
            plastic_strain,
            deaths: self.deaths,
            broken: self.sections.broken,
            ruptures: self.ruptures,
            touches: self.touches,
            energies: self.energies,
            hybrid,
            resting_steps: body.blocks.skipped_in_all(),
            summary,
        }
    }
}

/// Work of gravity when the whole body has fallen by 1 cm \[J\]: with less, a run has not begun.
fn fall_j(building: &Building, body: &Dynamics) -> f64 {
    0.01 * body.mass_kg.iter().sum::<f64>() * building.settings.gravity_m_s2
}

/// The state at an output, for a report.
fn kept_frame(output: usize, body: &Dynamics, rates_1_s: &[f32], critical_1_s: f64) -> KeptFrame {
    let rigid =
        body.hybrid.as_ref().map_or(Vec::new(), |h| (0..rates_1_s.len()).map(|e| h.is_rigid(e)).collect());
    KeptFrame {
        output,
        nodes_m: body.x.iter().map(|p| p.map(|c| c as f32)).collect(),
        fast: rates_1_s.iter().map(|rate| f64::from(*rate) > critical_1_s).collect(),
        rigid,
        plastic_strain: (0..rates_1_s.len()).map(|e| body.blocks.plastic_strain(e) as f32).collect(),
    }
}

/// Every how many outputs a frame is kept, so that the positions of all together are not too large.
fn kept_every(nodes: usize, outputs: usize) -> usize {
    (12 * nodes * (outputs + 1)).div_ceil(MOST_KEPT_BYTES).max(1)
}

/// The part that a node belongs to, as far as it acts.
fn part_at(mesh: &Mesh, body: &Dynamics, node: usize) -> Option<usize> {
    let element = body.blocks.elements_at(node).find(|e| body.blocks.share(*e) > 0.0)?;
    Some(mesh.elements[element].part)
}

/// The name of a surface: 0 for the ground, 1 + i for obstacle i.
fn surface_name(building: &Building, surface: usize) -> &str {
    surface.checked_sub(1).map_or("ground", |i| &building.obstacles[i].id)
}

#[cfg(test)]
mod tests {
    use super::kept_every;

    #[test]
    fn kept_frames_stay_below_the_limit() {
        assert_eq!(kept_every(3942, 250), 1);
        for (nodes, outputs) in [(3942, 2500), (100_000, 250), (100_000, 6000), (2_000_000, 500)] {
            let every = kept_every(nodes, outputs);
            let frames = outputs / every + 1;
            assert!(12 * nodes * frames <= super::MOST_KEPT_BYTES + 12 * nodes, "{nodes} {outputs} {every}");
        }
    }
}
