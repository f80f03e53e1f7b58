//! A whole run of a model file with ideal joints: events, outputs, energy balance.

use super::compile;
use super::march::{Locked, MarchError, Marcher, Span};
use super::motion::{Motion, STATE};
use super::start;
use super::survey::Observed;
use super::touch::Touching;
use crate::mbs::balance::Balance;
use crate::mbs::contact::{ContactSet, Partner};
use crate::mbs::error::SolveError;
use crate::mbs::math::{self, V3};
use crate::mbs::model::{Bending, Body, Bushing, Event, Force, Model};
use crate::mbs::result::{
    Energies, EventKind, FractureCause, Frame, HingeHistory, ReactionHistory, RunEvent, RunResult,
    TurnHistory,
};
use crate::mbs::run::{
    FINER_IDEAL, Overturned, SAME, SolverOptions, closing_remarks, remark_on_overlaps, remarks_on_wishes,
};

/// Runs a checked model.
///
/// # Errors
/// If the run goes wrong.
pub fn simulate(model: &Model, options: &SolverOptions) -> Result<RunResult, SolveError> {
    let mut run = Run::new(model, options)?;
    if let Some(given_s) = model.settings.time_step_s {
        let limit_s = run.marcher.limit_s();
        if given_s > limit_s {
            return Err(SolveError::time_step(given_s, limit_s, limit_s));
        }
        run.marcher.fix(given_s);
    }
    run.go()?;
    Ok(run.result)
}

struct Run<'a> {
    model: &'a Model,
    options: &'a SolverOptions,
    marcher: Marcher,
    tracked: Vec<(usize, V3)>,
    /// Whether velocities are those of the time after the events at t = 0, which joints that go then would not allow.
    frees: bool,
    record: Record,
    result: RunResult,
}

/// What outputs need beside the result.
struct Record {
    /// Next output.
    next: usize,
    start: Observed,
    /// What events took of kinetic energy and gravity, and of springs and hinges.
    released_j: f64,
    unbound_j: f64,
    /// What contacts took along their normals, and by friction.
    contact_j: [f64; 2],
    /// What joints took as they left singular poses.
    locked_j: f64,
    /// Half of the last step if it was one of the leapfrog, else zero, and what forces add to the kinetic energy in it \[s, J\].
    kick_s: f64,
    kick_j: f64,
    /// Where in its step the output is, from its start (0) to its end (1).
    share: f64,
    books: Balance,
    overturned: Overturned,
}

impl<'a> Run<'a> {
    fn new(model: &'a Model, options: &'a SolverOptions) -> Result<Self, SolveError> {
        let mechanism = compile::mechanism(model);
        let settings = &model.settings;
        let given = Motion::state(&mechanism);
        // contacts may push across the plane of a mechanism, where nothing but its joints holds it
        let in_space = settings.reactions || model.may_touch();
        let mut marcher = Marcher::of(&mechanism, settings.tolerance, settings.end_time_s, in_space)?;
        let frees = start::misfit(&given, &marcher.state).is_some() && !start::freed(model).is_empty();
        if frees {
            marcher.state = start::fitting_state(model, &mechanism)?;
            marcher.restart();
        }
        if model.may_touch() {
            let set = ContactSet::new(model, options.contact);
            let mut touching = Touching::new(set, settings.tolerance);
            touching.tells_reactions = settings.reactions;
            marcher.touching = Some(touching);
            marcher.connect();
            marcher.restart();
        }
        let start = marcher.motion.observe(&marcher.state, 0.0);
        let mut result = empty(model);
        result.warnings = remarks(model, &marcher, &given);
        if let Some(touching) = &marcher.touching {
            let pose = |s: &[f64]| ([s[0], s[1], s[2]], math::qrenormalise([s[3], s[4], s[5], s[6]]));
            let poses: Vec<_> = marcher.state.chunks_exact(STATE).map(pose).collect();
            result.warnings.extend(remark_on_overlaps(model, &touching.set, &poses));
        }
        let tracked = model.tracked.iter().map(|t| {
            let body = model.bodies.iter().position(|b| b.id == t.body).unwrap_or(0);
            let b = &mechanism.bodies[body];
            (body, math::mul_t(&math::qmat(b.orientation), math::sub(t.point_m, b.position_m)))
        });
        let mass: f64 = model.bodies.iter().map(|b| b.mass_kg).sum();
        // one millimetre of fall: the scale of a model in which nothing happens
        let scale_j = 1e-3 * mass * math::norm(model.gravity_m_s2) + start.kinetic_j + start.elastic_j;
        let contacts_j = marcher.touching.as_ref().map_or(0.0, |touching| {
            let weight = |b: &Body| b.mass_kg * math::norm(model.gravity_m_s2);
            let bodies = model.bodies.iter().enumerate();
            Balance::of_contacts(bodies.map(|(i, b)| (weight(b), touching.set.radius_m(i))))
        });
        let record = Record {
            next: 0,
            start,
            released_j: 0.0,
            unbound_j: 0.0,
            contact_j: [0.0; 2],
            locked_j: 0.0,
            kick_s: 0.0,
            share: 0.0,
            kick_j: 0.0,
            books: Balance::new(scale_j, contacts_j),
            overturned: Overturned::default(),
        };
        Ok(Self { model, options, tracked: tracked.collect(), frees, record, marcher, result })
    }

    fn go(&mut self) -> Result<(), SolveError> {
        if self.switch(0.0) {
            self.marcher.restart();
        }
        if self.frees {
            self.events_at(0.0);
            self.output_here()?;
        } else {
            self.output_here()?;
            self.events_at(0.0);
        }
        for stop in self.stops() {
            self.advance(stop)?;
            self.events_at(stop);
        }
        let tally = &self.marcher.tally;
        self.result.steps = tally.steps[0] as usize;
        self.result.time_step_s = tally.longest_s;
        self.result.highest_frequency_rad_s = self.marcher.frequency_rad_s();
        let books = &self.record.books;
        (self.result.energy_error, self.result.energy_growth) = (books.error, books.growth);
        let contacts = self.marcher.touching.as_ref().map(|t| t.set.work);
        self.result.contact_work = contacts.unwrap_or_default().into();
        self.result.warnings.extend(remark(&self.marcher.locked));
        self.result
            .warnings
            .extend(self.marcher.confused.iter().map(|(id, at)| remark_on_turn(self.model, *id, *at)));
        self.result.warnings.extend(self.record.overturned.remark());
        self.result.warnings.extend(remarks_on_wishes(self.model));
        self.result.warnings.extend(closing_remarks(&self.record.books, contacts, FINER_IDEAL));
        self.result.events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        Ok(())
    }

    /// Times at which the march has to stop: events, switches of forces, the end; outputs, if reactions are recorded.
    fn stops(&self) -> Vec<f64> {
        let s = &self.model.settings;
        let mut stops: Vec<f64> = self.model.events.iter().map(|e| e.time_s).collect();
        stops.extend(self.model.forces.iter().filter_map(span).flatten());
        if s.reactions {
            stops.extend((1..).map(|i| i as f64 * s.output_interval_s).take_while(|t| *t < s.end_time_s));
        }
        stops.retain(|t| *t > 0.0 && *t < s.end_time_s * (1.0 - SAME));
        stops.push(s.end_time_s);
        stops.sort_by(f64::total_cmp);
        stops.dedup_by(|later, kept| *later - *kept <= SAME * s.end_time_s);
        stops
    }

    fn advance(&mut self, stop: f64) -> Result<(), SolveError> {
        let Self { model, marcher, tracked, record, result, options, .. } = self;
        let mut failure = None;
        let mut state = marcher.state.clone();
        let mut fractured = Vec::new();
        let at_stops = model.settings.reactions;
        let mut seen = |span: &Span<'_>, marcher: &Marcher| {
            record.contact_j = marcher.touching.as_ref().map_or([0.0; 2], Touching::taken_j);
            record.locked_j = marcher.locked.energy_j;
            record.kick_s = span.kick_s();
            while !at_stops && failure.is_none() {
                let time = record.time(model);
                if time > span.to_s() + SAME * model.settings.end_time_s {
                    break;
                }
                span.at(time, &mut state);
                record.share = ((time - span.from_s) / span.length_s).clamp(0.0, 1.0);
                record.kick_j = marcher.kick_j(record.kick_s);
                failure = record
                    .output(model, options, tracked, [time, span.length_s], &marcher.motion, &state, result)
                    .err()
                    .map(|error| by_locks(error, &marcher.locked));
            }
            None
        };
        let outcome = marcher.advance(stop, &mut seen, &mut fractured);
        result.events.extend(marcher.yields.drain(..).map(|(time_s, id)| first_flow(model, time_s, id)));
        for (time_s, id) in fractured {
            let torn = marcher.motion.torn.contains(&id);
            let cause = if torn { FractureCause::Tension } else { FractureCause::Rotation };
            let kind = EventKind::Fracture { joint: id_of(model, id).into(), cause };
            result.events.push(RunEvent { time_s, kind });
        }
        self.record_touches();
        if let Some(error) = failure {
            return Err(error);
        }
        let longest_s = self.marcher.tally.longest_s;
        outcome.map_err(|error| stopped(self.model, error, longest_s))?;
        let due = self.record.time(self.model) <= stop + SAME * self.model.settings.end_time_s;
        if at_stops && due { self.output_here() } else { Ok(()) }
    }

    /// An output at the march's own state.
    fn output_here(&mut self) -> Result<(), SolveError> {
        let Self { model, marcher, tracked, record, result, options, .. } = self;
        let at = [marcher.time_s, marcher.tally.longest_s];
        record.contact_j = marcher.touching.as_ref().map_or([0.0; 2], Touching::taken_j);
        record.locked_j = marcher.locked.energy_j;
        (record.kick_j, record.share) = (marcher.kick_j(record.kick_s), 0.0);
        record
            .output(model, options, tracked, at, &marcher.motion, &marcher.state, result)
            .map_err(|error| by_locks(error, &marcher.locked))?;
        if !model.settings.reactions {
            return Ok(());
        }
        marcher.refresh();
        let found = marcher.motion.reactions();
        for (id, history) in result.reactions.iter_mut().enumerate() {
            let at = marcher.motion.joint_ids().iter().position(|j| *j == id);
            let [force, torque] = at.map_or([[0.0; 3]; 2], |j| found[j]);
            history.force_n.push(force);
            history.torque_nm.push(torque);
        }
        Ok(())
    }

    fn record_touches(&mut self) {
        let Some(touching) = &mut self.marcher.touching else { return };
        touching.touches.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (time_s, touch) in touching.touches.drain(..) {
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

    /// Applied forces that begin or end at a time.
    fn switch(&mut self, time: f64) -> bool {
        let same = SAME * self.model.settings.end_time_s;
        let mut any = false;
        for (id, force) in self.model.forces.iter().enumerate() {
            if let Some([from, to]) = span(force) {
                let on = time >= from - same && time < to - same;
                if let Some(acting) = self.marcher.motion.force_mut(id) {
                    acting.switch(on);
                    any = true;
                }
            }
        }
        any
    }

    /// Carries out what happens at a time; what it takes from the energies is booked as released.
    fn events_at(&mut self, time: f64) {
        let model = self.model;
        let same = SAME * model.settings.end_time_s;
        let happens = |e: &&Event| (e.time_s - time).abs() <= same;
        let switches = model.forces.iter().filter_map(span).flatten().any(|t| (t - time).abs() <= same);
        if switches || model.events.iter().any(|e| happens(&e)) {
            self.marcher.synchronise();
        }
        let before = self.marcher.motion.observe(&self.marcher.state, 0.0);
        let (mut any, mut from_j) = (self.switch(time), 0.0);
        for event in model.events.iter().filter(happens) {
            any = true;
            let Marcher { motion, state, .. } = &mut self.marcher;
            for id in &event.remove_bodies {
                if let Some(i) = model.bodies.iter().position(|b| b.id == *id) {
                    if !motion.is_gone(i) {
                        let body = &model.bodies[i];
                        from_j -= body.mass_kg * math::dot(model.gravity_m_s2, body.position_m);
                    }
                    motion.remove(i, state);
                }
            }
            for id in &event.release {
                let joint = model.joints.iter().position(|j| j.id == *id);
                let own = std::iter::once(id.as_str()).chain(model.hinges_on(id));
                let forces: Vec<usize> = own.filter_map(|id| place_of(model, id)).collect();
                motion.release(joint.as_slice(), &forces);
            }
            for w in &event.weaken {
                if let Some(id) = place_of(model, &w.id) {
                    motion.weaken(id, w.factor);
                }
            }
            let kind = EventKind::Removal { event: event.id.clone() };
            self.result.events.push(RunEvent { time_s: time, kind });
            let yielded = self.marcher.motion.yielded.drain(..);
            self.result.events.extend(yielded.map(|id| first_flow(model, time, id)));
        }
        if any {
            self.marcher.restart();
            self.marcher.connect();
            let after = self.marcher.motion.observe(&self.marcher.state, 0.0);
            let bound = |o: &Observed| o.elastic_j + o.plastic_j;
            let free = |o: &Observed| o.kinetic_j + o.gravity_j;
            self.record.unbound_j += bound(&before) - bound(&after);
            // what a body had at t = 0 counts for nothing, with it and without it
            self.record.start.gravity_j -= from_j;
            self.record.released_j += free(&before) - free(&after) - from_j;
        }
    }
}

impl Record {
    /// Time of the next output; beyond the end if there is none.
    fn time(&self, model: &Model) -> f64 {
        let s = &model.settings;
        let even = self.next as f64 * s.output_interval_s;
        let last = (self.next - 1) as f64 * s.output_interval_s;
        let is_over = last >= s.end_time_s * (1.0 - 1e-9);
        if is_over { f64::INFINITY } else { even.min(s.end_time_s) }
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "the parts of a run that an output needs while the march holds the rest"
    )]
    fn output(
        &mut self,
        model: &Model,
        options: &SolverOptions,
        tracked: &[(usize, V3)],
        [time, step]: [f64; 2],
        motion: &Motion,
        state: &[f64],
        result: &mut RunResult,
    ) -> Result<(), SolveError> {
        let body = |i: usize| &state[STATE * i..STATE * (i + 1)];
        if let Some(i) = (0..model.bodies.len()).find(|i| body(*i).iter().any(|v| !v.is_finite())) {
            let id = model.bodies[i].id.clone();
            return Err(SolveError::NotANumber { time_s: time, joints: joints_of(model, &id), body: id });
        }
        for bushing in motion.bushings.iter().filter(|b| b.has_overturned()) {
            self.overturned.note(bushing.id(), time);
        }
        self.next += 1;
        result.times_s.push(time);
        let orientation = |i: usize| math::qrenormalise([body(i)[3], body(i)[4], body(i)[5], body(i)[6]]);
        let all = 0..model.bodies.len();
        if !options.brief {
            result.frames.push(Frame {
                position_m: all.clone().map(|i| [body(i)[0], body(i)[1], body(i)[2]]).collect(),
                orientation: all.map(orientation).collect(),
            });
        }
        for (history, (i, local)) in result.tracked.iter_mut().zip(tracked) {
            let point = super::motion::point_at(state, *i, *local);
            history.displacement_m.push(math::sub(point, history.origin_m));
        }
        let seen = motion.observe(state, self.share);
        for (id, force) in model.forces.iter().enumerate().filter(|(_, f)| turns(f)) {
            let Some(history) = result.turns.iter_mut().find(|t| t.id == force.id()) else { continue };
            let now = seen.hinges.iter().find(|(hinge, _)| *hinge == id).map(|(_, h)| h);
            let [turned, flowed] = motion.ended.get(&id).copied().unwrap_or_default();
            history.rotation_rad.push(now.map_or(turned, |h| h.rotation_rad));
            history.moment_nm.push(now.map_or([0.0; 3], |h| h.moment_nm));
            history.plastic_rotation_rad.push(now.map_or(flowed, |h| h.plastic_rad));
        }
        for history in result.hinges.iter_mut().filter(|_| !options.brief) {
            let is_own = |id: &usize| id_of(model, *id) == history.joint;
            let now = seen.bushings.iter().find(|(id, _)| is_own(id)).map(|(_, b)| *b);
            let ended = motion.ended.iter().find(|(id, _)| is_own(id)).map(|(_, ended)| *ended);
            let [[first, second, _], [flowed, ..]] = ended.unwrap_or_default();
            history.rotation_rad.push(now.map_or([first, second], |b| b.rotation_rad));
            history.moment_nm.push(now.map_or([0.0; 2], |b| b.moment_nm));
            history.plastic_rotation_rad.push(now.map_or(flowed, |b| b.plastic_rad));
            history.axial_force_n.push(now.map_or(0.0, |b| b.axial_force_n));
        }
        self.balance(model, options, [time, step], &seen, state, result)
    }

    fn balance(
        &mut self,
        model: &Model,
        options: &SolverOptions,
        [time, step]: [f64; 2],
        seen: &Observed,
        state: &[f64],
        result: &mut RunResult,
    ) -> Result<(), SolveError> {
        let start = &self.start;
        let gravity_j = seen.gravity_j - start.gravity_j;
        let unbound_j = self.unbound_j + seen.lost_j;
        let applied_j = if model.bushings.is_empty() {
            0.0 - seen.given_j
        } else {
            // their law books what they take by trapezoids of its own
            start.elastic_j - seen.work_j - seen.elastic_j - seen.plastic_j - unbound_j
        };
        let energies = Energies {
            kinetic_j: seen.kinetic_j,
            gravity_j,
            joints_elastic_j: seen.elastic_j,
            plastic_j: seen.plastic_j,
            contact_damping_j: self.contact_j[0],
            friction_j: self.contact_j[1],
            released_j: self.released_j + unbound_j + self.locked_j,
            applied_j,
        };
        result.energies.push(&energies);
        let turned_j = seen.kinetic_j + gravity_j.abs() + seen.plastic_j;
        let error = self.books.note(&energies, self.kick_j, turned_j.max(seen.work_j.abs()));
        if error <= options.energy_limit {
            return self.books.check_contacts(time, options.energy_limit, step);
        }
        let speed = |i: usize| math::norm([7, 8, 9].map(|k| state[STATE * i + k]));
        let body = (0..model.bodies.len()).max_by(|a, b| speed(*a).total_cmp(&speed(*b))).unwrap_or(0);
        Err(SolveError::Energy {
            time_s: time,
            error,
            limit: options.energy_limit,
            body: model.bodies[body].id.clone(),
            speed_m_s: speed(body),
            joint: joints_of(model, &model.bodies[body].id),
            step_s: step,
        })
    }
}

/// Whether a force resists rotation.
fn turns(force: &Force) -> bool {
    matches!(force, Force::Hinge { .. } | Force::Torsion { .. })
}

/// When an applied force acts, if not always.
fn span(force: &Force) -> Option<[f64; 2]> {
    match force {
        Force::Force { from_to_s, .. } | Force::Torque { from_to_s, .. } => *from_to_s,
        _ => None,
    }
}

/// Place of a force, or of a bushing behind them, by its id.
fn place_of(model: &Model, id: &str) -> Option<usize> {
    let bushing = || model.bushings.iter().position(|b| b.id == id).map(|i| model.forces.len() + i);
    model.forces.iter().position(|f| f.id() == id).or_else(bushing)
}

/// Id of a force, or of a bushing behind them, by its place.
fn id_of(model: &Model, place: usize) -> &str {
    match model.forces.get(place) {
        Some(force) => force.id(),
        None => &model.bushings[place - model.forces.len()].id,
    }
}

/// That a hinge or bushing, by its place, flows for the first time.
fn first_flow(model: &Model, time_s: f64, place: usize) -> RunEvent {
    RunEvent { time_s, kind: EventKind::Yield { joint: id_of(model, place).into() } }
}

/// Why a march stopped, with names.
fn stopped(model: &Model, error: MarchError, longest_s: f64) -> SolveError {
    match error {
        MarchError::Penetration { time_s, deep, step_s } => SolveError::Penetration {
            time_s,
            a: model.bodies[deep.a].id.clone(),
            b: deep.b.id(model).into(),
            depth_m: deep.depth_m,
            step_s,
        },
        error => SolveError::March { error, longest_s },
    }
}

/// Times that joints have stopped a motion from which an energy balance that is off is their doing: no smaller step helps, since each of them ends one.
const LOCKED_OFTEN: usize = 20;

/// An error of the energy balance, with its cause where joints stop motions again and again.
fn by_locks(error: SolveError, locked: &Locked) -> SolveError {
    match error {
        SolveError::Energy { time_s, error, limit, body, joint, .. } if locked.times >= LOCKED_OFTEN => {
            SolveError::Locked { time_s, error, limit, times: locked.times, body, joints: joint }
        }
        other => other,
    }
}

/// What is worth saying of a model before it runs.
fn remarks(model: &Model, marcher: &Marcher, given: &[f64]) -> Vec<String> {
    let mut list = Vec::new();
    let [rows, dependent] = marcher.tally.rows;
    if dependent > 0 {
        list.push(format!(
            "{dependent} of {rows} joint conditions depend on others (redundant joints or loops): the motion is unique, the reactions of those joints are not"
        ));
    }
    if let Some((i, change)) = start::misfit(given, &marcher.state) {
        list.push(format!(
            "initial velocities do not fit the joints: the nearest ones that do are taken; body \"{}\" changes most, by {change:.3e} m/s or rad/s",
            model.bodies[i].id
        ));
    }
    list
}

/// What is worth saying of motions that joints stopped.
fn remark(locked: &Locked) -> Option<String> {
    let Locked { times, last_s, energy_j } = locked;
    (*times > 0).then(|| {
        format!(
            "joints stopped a motion {times} times, the last one at {last_s:.6} s: in a singular pose they allow it at first order only (three of their points on a line, say); it held {energy_j:.3e} J, booked as released. Leave a joint out if the mechanism is meant to move"
        )
    })
}

/// What is worth saying of a turn that a hinge or a torsion spring has no measure of.
fn remark_on_turn(model: &Model, place: usize, time_s: f64) -> String {
    let id = id_of(model, place);
    match &model.forces[place] {
        Force::Torsion { .. } => format!(
            "torsion spring \"{id}\": at {time_s:.6} s its axis in one body points against that in the other, but for 20°; near 180° there is no rotation about it and the torque grows without bound: let a revolute, cylindrical or universal joint hold the axis"
        ),
        _ => format!(
            "hinge \"{id}\": at {time_s:.6} s it came near a full revolution about several axes, where no rotation vector goes on: from there it is that of the shortest rotation, with the moments and the capacities left that it had; let a revolute joint hold one axis, or let the hinge break before (fracture_rad)"
        ),
    }
}

fn joints_of(model: &Model, body: &str) -> String {
    let own = model.joints.iter().filter(|j| j.body_b == body || j.body_a.as_deref() == Some(body));
    let list: Vec<&str> = own.map(|j| j.id.as_str()).collect();
    if list.is_empty() { "none".into() } else { list.join(", ") }
}

fn empty(model: &Model) -> RunResult {
    let turns = model.forces.iter().filter(|f| turns(f)).map(|f| TurnHistory {
        id: f.id().into(),
        rotation_rad: Vec::new(),
        moment_nm: Vec::new(),
        plastic_rotation_rad: Vec::new(),
    });
    let curved = |b: &&Bushing| b.bending.iter().any(|k| matches!(k, Bending::Curve { .. }));
    let hinges = model.bushings.iter().filter(curved).map(|b| HingeHistory {
        joint: b.id.clone(),
        rotation_rad: Vec::new(),
        moment_nm: Vec::new(),
        plastic_rotation_rad: Vec::new(),
        axial_force_n: Vec::new(),
    });
    let recorded = if model.settings.reactions { model.joints.as_slice() } else { &[] };
    let reactions = recorded.iter().map(|j| ReactionHistory {
        joint: j.id.clone(),
        force_n: Vec::new(),
        torque_nm: Vec::new(),
    });
    RunResult {
        hinges: hinges.collect(),
        turns: turns.collect(),
        reactions: reactions.collect(),
        ..RunResult::empty(model, 0)
    }
}
