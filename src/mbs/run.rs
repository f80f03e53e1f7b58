//! A whole run: set-up, preload, time loop with events, outputs and the energy balance.
//!
//! Steps end exactly at every output and every event: between two such times the step is constant and
//! at most the limit. The energies are taken at full steps, with the momenta of that time; the balance is
//! a true one (states and trapezoidal dissipation), not an identity of the update formulas.

use super::contact::{ContactSet, Moving, Partner, Settings, Work};
use super::error::SolveError;
use super::ideal;
use super::math;
use super::model::Model;
use super::preload::{self, PreloadError};
use super::result::{
    EventKind, FractureCause, Frame, HingeHistory, RESULT_SCHEMA, RunEvent, RunResult, TrackedHistory,
};
use super::sleep::Sleep;
use super::system::System;
use super::{frequency, step};
use crate::base::cpu::ThreadClock;

/// Largest automatic step \[s\]: in it a body at 10 m/s moves by a centimetre, one that turns at 10 rad/s by a hundredth of a radian.
pub const LARGEST_STEP_S: f64 = 1e-3;
/// Most steps between two outputs; more points to a wrong stiffness or mass.
const MOST_STEPS: f64 = 2e9;

/// Options that are not part of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverOptions {
    /// Relative energy error above which the run stops.
    pub energy_limit: f64,
    /// How contact impulses are found.
    pub contact: Settings,
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self { energy_limit: 0.1, contact: Settings::default() }
    }
}

/// Checks and runs a model.
pub fn simulate(model: &Model) -> Result<RunResult, SolveError> {
    simulate_with(model, &SolverOptions::default())
}

/// Checks and runs a model with options.
pub fn simulate_with(model: &Model, options: &SolverOptions) -> Result<RunResult, SolveError> {
    model.check()?;
    if !model.joints.is_empty() || !model.forces.is_empty() {
        return ideal::run::simulate(model, options);
    }
    let clock = ThreadClock::start();
    let mut run = Run::new(model, options)?;
    run.go()?;
    let remarks = closing_remarks(run.result.energy_error, Some(run.contacts.work));
    run.result.warnings.extend(remarks);
    run.result.cpu_s = clock.elapsed_s();
    Ok(run.result)
}

/// Energy error worth a warning.
const ENERGY_WORTH_TELLING: f64 = 1e-3;
/// Depth of a contact worth a warning \[m\].
const DEPTH_WORTH_TELLING_M: f64 = 5e-3;

/// What is worth saying of a run that came to its end.
pub(super) fn closing_remarks(energy_error: f64, contacts: Option<Work>) -> Vec<String> {
    let mut list = Vec::new();
    if energy_error > ENERGY_WORTH_TELLING {
        list.push(format!(
            "the energy balance is off by {energy_error:.1e} of the energy turned over; a smaller settings.tolerance or settings.time_step_s shows what that changes"
        ));
    }
    if let Some(work) = contacts.filter(|w| w.deepest_m > DEPTH_WORTH_TELLING_M) {
        list.push(format!(
            "contacts were up to {:.1} mm deep (heavy bodies on light ones, or impacts whose impulses did not settle in {} of {} steps); a smaller settings.time_step_s holds them better",
            1e3 * work.deepest_m,
            work.unfinished,
            work.steps
        ));
    }
    list
}

struct Run<'a> {
    model: &'a Model,
    options: &'a SolverOptions,
    system: System,
    contacts: ContactSet,
    /// The bodies as the contacts see them.
    moving: Vec<Moving>,
    sleep: Sleep,
    /// Work of the forces on displacements that open gaps \[J\].
    opened: f64,
    result: RunResult,
    time: f64,
    /// Length of the last step, zero right after a start \[s\].
    last_step: f64,
    step_limit: f64,
    start: Vec<math::V3>,
    tracked: Vec<(usize, math::V3)>,
    hinges: Vec<usize>,
    yielded: Vec<bool>,
    range_warned: Vec<bool>,
    plastic_start: f64,
    released: f64,
    total_start: f64,
    turnover: f64,
    preloading: bool,
}

impl<'a> Run<'a> {
    fn new(model: &'a Model, options: &'a SolverOptions) -> Result<Self, SolveError> {
        let mut system = System::new(model)?;
        let tracked: Vec<(usize, math::V3)> = model
            .tracked
            .iter()
            .map(|t| {
                let body = model.bodies.iter().position(|b| b.id == t.body).unwrap_or(0);
                let state = &system.bodies[body];
                (body, math::mul_t(&state.r, math::sub(t.point_m, state.x)))
            })
            .collect();
        let preload_iterations = if model.settings.preload {
            Some(preload::equilibrate(&mut system).map_err(|e| preload_error(model, e))?)
        } else {
            None
        };
        let frequency = frequency::highest_rad_s(&system);
        let step_limit = choose_step(model, frequency)?;
        let mut contacts = ContactSet::new(model, options.contact);
        connect(&mut contacts, &system);
        let hinges: Vec<usize> = (0..system.joints.len()).filter(|i| system.joints[*i].has_curve()).collect();
        let result =
            empty_result(model, &system, &tracked, &hinges, step_limit, frequency, preload_iterations);
        let n = system.count();
        Ok(Self {
            start: system.bodies[..n].iter().map(|b| b.x).collect(),
            yielded: system.joints.iter().map(|j| j.hinge.alpha_rad > 0.0).collect(),
            range_warned: vec![false; system.joints.len()],
            plastic_start: system.joints.iter().map(|j| j.hinge.dissipated_j + j.crush_j).sum(),
            model,
            options,
            system,
            contacts,
            moving: Vec::new(),
            sleep: Sleep::new(model.settings.sleep_speed_m_s, n),
            opened: 0.0,
            result,
            time: 0.0,
            last_step: 0.0,
            step_limit,
            tracked,
            hinges,
            released: 0.0,
            total_start: 0.0,
            turnover: 0.0,
            preloading: model.settings.preload,
        })
    }

    fn go(&mut self) -> Result<(), SolveError> {
        self.note_preload_yield();
        self.forces();
        self.output()?;
        self.remove_at(0.0);
        for (end, is_output) in self.stops() {
            self.advance_to(end)?;
            self.forces();
            if is_output {
                self.output()?;
            }
            self.remove_at(end);
        }
        Ok(())
    }

    /// Outputs and events after `t = 0` in order of time.
    fn stops(&self) -> Vec<(f64, bool)> {
        let s = &self.model.settings;
        let count = (s.end_time_s / s.output_interval_s * (1.0 + 1e-12)).floor() as usize;
        let mut stops: Vec<(f64, bool)> =
            (1..=count).map(|i| (i as f64 * s.output_interval_s, true)).collect();
        if stops.last().is_none_or(|last| s.end_time_s - last.0 > 1e-9 * s.end_time_s) {
            stops.push((s.end_time_s, true));
        }
        let events = self.model.events.iter().map(|e| e.time_s);
        stops.extend(events.filter(|t| *t > 0.0 && *t <= s.end_time_s).map(|t| (t, false)));
        stops.sort_by(|a, b| a.0.total_cmp(&b.0));
        stops.dedup_by(|later, kept| {
            let same = later.0 - kept.0 <= 1e-12 * s.end_time_s;
            kept.1 |= same && later.1;
            same
        });
        stops
    }

    /// Steps up to `end`. Forces at the current position are known; at the end they are not yet.
    fn advance_to(&mut self, end: f64) -> Result<(), SolveError> {
        let span = end - self.time;
        let count = (span / self.step_limit - 1e-9).ceil().max(1.0);
        let h = span / count;
        let begin = self.time;
        self.result.steps += count as usize;
        if self.sleep.is_complete(&self.system) {
            (self.last_step, self.time) = (h, end);
            return Ok(());
        }
        for i in 0..count as usize {
            if i > 0 {
                self.forces();
            }
            step::kick(&mut self.system, 0.5 * (self.last_step + h), h);
            if !step::is_quiet(&self.system, &mut self.contacts, h) {
                self.meet(h)?;
            }
            self.sleep.count(&mut self.system, &mut self.contacts, self.time, h);
            step::drift(&mut self.system, h);
            self.last_step = h;
            self.time = begin + h * (i + 1) as f64;
        }
        self.time = end;
        Ok(())
    }

    /// Contact impulses at the present positions, for a step of `h` from here.
    fn meet(&mut self, h: f64) -> Result<(), SolveError> {
        loop {
            let opened = step::meet(&mut self.system, &mut self.contacts, &mut self.moving, h);
            self.opened += opened.map_err(|deep| SolveError::Penetration {
                time_s: self.time,
                a: self.model.bodies[deep.a].id.clone(),
                b: deep.b.id(self.model).into(),
                depth_m: deep.depth_m,
                step_s: h,
            })?;
            let touched = std::mem::take(&mut self.contacts.touched);
            if touched.is_empty() {
                break;
            }
            self.sleep.rouse(&mut self.system, &mut self.contacts, &touched, h);
        }
        if !self.contacts.touches.is_empty() {
            self.record_touches();
        }
        Ok(())
    }

    /// Forces at the current position; fracture.
    #[inline]
    fn forces(&mut self) {
        self.system.reset_forces();
        if self.system.add_joint_forces() {
            self.look_at_joints();
        }
    }

    fn look_at_joints(&mut self) {
        let mut broken = false;
        for i in 0..self.system.joints.len() {
            let joint = &self.system.joints[i];
            broken |= joint.alive && (joint.hinge.fractured || joint.is_pulled_apart());
            if joint.flowing && (!self.yielded[i] || joint.hinge.out_of_range) {
                self.note_yield(i);
            }
        }
        if broken {
            self.fracture();
        }
    }

    #[cold]
    fn note_yield(&mut self, i: usize) {
        let id = &self.model.bushings[i].id;
        if !std::mem::replace(&mut self.yielded[i], true) {
            self.result
                .events
                .push(RunEvent { time_s: self.time, kind: EventKind::Yield { joint: id.clone() } });
        }
        let joint = &self.system.joints[i];
        if joint.hinge.out_of_range && !std::mem::replace(&mut self.range_warned[i], true) {
            self.result.warnings.push(format!(
                "joint \"{id}\": at t = {:.4} s the axial force {:.4e} N lies outside the levels of its curve; the nearest level is used",
                self.time, joint.axial_force
            ));
        }
    }

    fn note_preload_yield(&mut self) {
        for i in 0..self.system.joints.len() {
            if self.preloading && self.yielded[i] {
                let id = &self.model.bushings[i].id;
                self.result.warnings.push(format!("joint \"{id}\" flows under dead load already"));
                let kind = EventKind::Yield { joint: id.clone() };
                self.result.events.push(RunEvent { time_s: 0.0, kind });
            }
        }
    }

    #[cold]
    fn fracture(&mut self) {
        for i in 0..self.system.joints.len() {
            let joint = &mut self.system.joints[i];
            let tension = joint.is_pulled_apart();
            if joint.alive && (joint.hinge.fractured || tension) {
                joint.alive = false;
                joint.flowing = false;
                self.released += std::mem::take(&mut joint.elastic_j);
                let cause =
                    if joint.hinge.fractured { FractureCause::Rotation } else { FractureCause::Tension };
                let kind = EventKind::Fracture { joint: self.model.bushings[i].id.clone(), cause };
                self.result.events.push(RunEvent { time_s: self.time, kind });
            }
        }
        self.system.pack();
        self.sleep.rouse_all(&mut self.system, &mut self.contacts, 0.5 * self.last_step);
        connect(&mut self.contacts, &self.system);
        if self.model.settings.time_step_s.is_none() && self.system.joints.iter().all(|j| !j.alive) {
            self.step_limit = LARGEST_STEP_S;
        }
    }

    #[cold]
    fn record_touches(&mut self) {
        for touch in std::mem::take(&mut self.contacts.touches) {
            let time_s = self.time + touch.after_s;
            if touch.b == Partner::Ground {
                self.result.first_ground_contact_s.get_or_insert(time_s);
            }
            let kind = EventKind::Contact {
                a: self.model.bodies[touch.a].id.clone(),
                b: touch.b.id(self.model).into(),
            };
            self.result.events.push(RunEvent { time_s, kind });
        }
    }

    /// Carries out the events of a time: momenta are brought to the full step, the bodies and their
    /// joints vanish, forces are evaluated again.
    fn remove_at(&mut self, time: f64) {
        let model = self.model;
        let tolerance = 1e-12 * model.settings.end_time_s;
        let mut any = false;
        for event in model.events.iter().filter(|e| (e.time_s - time).abs() <= tolerance) {
            if !std::mem::replace(&mut any, true) {
                self.sleep.rouse_all(&mut self.system, &mut self.contacts, 0.5 * self.last_step);
                self.synchronise();
            }
            for id in &event.remove_bodies {
                if let Some(i) = model.bodies.iter().position(|b| b.id == *id) {
                    self.remove_body(i);
                }
            }
            self.result
                .events
                .push(RunEvent { time_s: self.time, kind: EventKind::Removal { event: event.id.clone() } });
        }
        if any {
            self.system.pack();
            connect(&mut self.contacts, &self.system);
            self.forces();
        }
    }

    fn synchronise(&mut self) {
        let n = self.system.count();
        for body in &mut self.system.bodies[..n] {
            (body.p, body.l) = step::synchronised(body, 0.5 * self.last_step);
        }
        self.last_step = 0.0;
    }

    fn remove_body(&mut self, i: usize) {
        if !self.system.data[i].alive {
            return;
        }
        self.released += step::kinetic_j(&self.system.bodies[i], &self.system.data[i], 0.5 * self.last_step)
            + self.gravity_energy(i);
        self.system.data[i].alive = false;
        let body = &mut self.system.bodies[i];
        (body.p, body.l, body.v, body.w, body.w_body) = ([0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]);
        for joint in self.system.joints.iter_mut().filter(|j| j.alive && (j.a == i || j.b == i)) {
            joint.alive = false;
            joint.flowing = false;
            self.released += std::mem::take(&mut joint.elastic_j);
        }
    }

    fn gravity_energy(&self, i: usize) -> f64 {
        let rise = math::sub(self.system.bodies[i].x, self.start[i]);
        -self.system.data[i].mass * math::dot(self.system.gravity, rise)
    }

    fn output(&mut self) -> Result<(), SolveError> {
        let n = self.system.count();
        if let Some(i) = (0..n).find(|i| !finite(&self.system.bodies[*i])) {
            return Err(SolveError::NotANumber {
                time_s: self.time,
                body: self.model.bodies[i].id.clone(),
                joints: joints_of(self.model, i),
            });
        }
        self.result.times_s.push(self.time);
        self.result.frames.push(Frame {
            position_m: self.system.bodies[..n].iter().map(|b| b.x).collect(),
            orientation: self.system.bodies[..n].iter().map(|b| b.q).collect(),
        });
        for (history, (body, local)) in self.result.tracked.iter_mut().zip(&self.tracked) {
            let state = &self.system.bodies[*body];
            let point = math::add(state.x, math::mul(&state.r, *local));
            history.displacement_m.push(math::sub(point, history.origin_m));
        }
        for (history, i) in self.result.hinges.iter_mut().zip(&self.hinges) {
            let joint = &self.system.joints[*i];
            let moment = if joint.alive { joint.hinge.moment_nm } else { [0.0; 2] };
            history.rotation_rad.push([joint.theta[1], joint.theta[2]]);
            history.moment_nm.push(moment);
            history.plastic_rotation_rad.push(joint.hinge.alpha_rad);
            history.axial_force_n.push(if joint.alive { joint.axial_force } else { 0.0 });
        }
        self.balance()
    }

    /// Records the energies and checks their sum.
    fn balance(&mut self) -> Result<(), SolveError> {
        let n = self.system.count();
        let alive = (0..n).filter(|i| self.system.data[*i].alive);
        let (mut kinetic, mut gravity) = (0.0, 0.0);
        for i in alive {
            if !self.system.data[i].asleep {
                kinetic +=
                    step::kinetic_j(&self.system.bodies[i], &self.system.data[i], 0.5 * self.last_step);
            }
            gravity += self.gravity_energy(i);
        }
        let joints: f64 = self.system.joints.iter().filter(|j| j.alive).map(|j| j.elastic_j).sum();
        let plastic: f64 = self.system.joints.iter().map(|j| j.hinge.dissipated_j + j.crush_j).sum::<f64>()
            - self.plastic_start;
        let contact = self.contacts.energy;
        let e = &mut self.result.energies;
        e.kinetic_j.push(kinetic);
        e.gravity_j.push(gravity);
        e.joints_elastic_j.push(joints);
        e.plastic_j.push(plastic);
        e.contact_elastic_j.push(0.0);
        e.contact_damping_j.push(contact.normal_j + self.opened + self.sleep.taken_j);
        e.friction_j.push(contact.friction_j);
        e.released_j.push(self.released);
        e.applied_j.push(0.0);
        let total = e.total_j(e.kinetic_j.len() - 1);
        if e.kinetic_j.len() == 1 {
            self.total_start = total;
            // One millimetre of fall: the scale of a model in which nothing happens.
            let mass: f64 = self.system.data.iter().map(|d| d.mass).sum();
            self.turnover = 1e-3 * mass * math::norm(self.system.gravity) + kinetic + joints;
        }
        self.turnover = self.turnover.max(kinetic + gravity.abs() + plastic.abs() + contact.friction_j.abs());
        let error = (total - self.total_start).abs() / self.turnover;
        self.result.energy_error = self.result.energy_error.max(error);
        if error.is_nan() || error > self.options.energy_limit {
            return Err(self.energy_error(error));
        }
        Ok(())
    }

    fn energy_error(&self, error: f64) -> SolveError {
        let speed = |i: usize| math::norm(self.system.bodies[i].v);
        let body = (0..self.system.count()).max_by(|a, b| speed(*a).total_cmp(&speed(*b))).unwrap_or(0);
        let energy = |i: usize| self.system.joints[i].elastic_j;
        let joint = (0..self.system.joints.len()).max_by(|a, b| energy(*a).total_cmp(&energy(*b)));
        SolveError::Energy {
            time_s: self.time,
            error,
            limit: self.options.energy_limit,
            body: self.model.bodies[body].id.clone(),
            speed_m_s: speed(body),
            joint: joint.map_or_else(|| "none".into(), |i| self.model.bushings[i].id.clone()),
            step_s: self.step_limit,
        }
    }
}

fn finite(body: &super::system::BodyState) -> bool {
    let sum: f64 = body.x.iter().chain(&body.q).chain(&body.p).chain(&body.l).map(|v| v * 0.0).sum();
    sum == 0.0
}

/// Tells the contacts which bodies are there and which a joint connects.
fn connect(contacts: &mut ContactSet, system: &System) {
    let joined = system.joints.iter().filter(|j| j.alive).map(|j| (j.a, j.b));
    contacts.connect(joined, |i| system.data[i].alive);
}

fn choose_step(model: &Model, frequency: f64) -> Result<f64, SolveError> {
    let limit = if frequency > 0.0 { 2.0 / frequency } else { f64::INFINITY };
    let step = match model.settings.time_step_s {
        Some(given) if given > limit => return Err(SolveError::TimeStep { given_s: given, limit_s: limit }),
        Some(given) => given,
        None => (frequency::STEP_FRACTION * limit).min(LARGEST_STEP_S),
    };
    let interval = model.settings.output_interval_s;
    if interval / step >= MOST_STEPS {
        return Err(SolveError::TooManySteps { step_s: step, interval_s: interval });
    }
    Ok(step)
}

fn preload_error(model: &Model, error: PreloadError) -> SolveError {
    match error {
        PreloadError::Mechanism { body } => {
            SolveError::Mechanism { body: model.bodies[body].id.clone(), joints: joints_of(model, body) }
        }
        PreloadError::NoConvergence { body, residual } => {
            SolveError::Preload { body: model.bodies[body].id.clone(), residual }
        }
    }
}

fn joints_of(model: &Model, body: usize) -> String {
    let id = &model.bodies[body].id;
    let own = model.bushings.iter().filter(|j| j.body_b == *id || j.body_a.as_ref() == Some(id));
    let list: Vec<&str> = own.map(|j| j.id.as_str()).collect();
    if list.is_empty() { "none".into() } else { list.join(", ") }
}

fn empty_result(
    model: &Model,
    system: &System,
    tracked: &[(usize, math::V3)],
    hinges: &[usize],
    step_limit: f64,
    frequency: f64,
    preload_iterations: Option<usize>,
) -> RunResult {
    let histories = model.tracked.iter().zip(tracked).map(|(point, (body, local))| {
        let state = &system.bodies[*body];
        TrackedHistory {
            id: point.id.clone(),
            origin_m: math::add(state.x, math::mul(&state.r, *local)),
            displacement_m: Vec::new(),
        }
    });
    let hinge_histories = hinges.iter().map(|i| HingeHistory {
        joint: model.bushings[*i].id.clone(),
        rotation_rad: Vec::new(),
        moment_nm: Vec::new(),
        plastic_rotation_rad: Vec::new(),
        axial_force_n: Vec::new(),
    });
    RunResult {
        schema: RESULT_SCHEMA.into(),
        name: model.name.clone(),
        times_s: Vec::new(),
        tracked: histories.collect(),
        bodies: model.bodies.iter().map(|b| b.id.clone()).collect(),
        frames: Vec::new(),
        energies: Default::default(),
        hinges: hinge_histories.collect(),
        turns: Vec::new(),
        reactions: Vec::new(),
        events: Vec::new(),
        first_ground_contact_s: None,
        steps: 0,
        time_step_s: step_limit,
        highest_frequency_rad_s: frequency,
        preload_iterations,
        cpu_s: 0.0,
        energy_error: 0.0,
        warnings: Vec::new(),
    }
}
