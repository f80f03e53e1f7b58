//! A whole run: set-up, preload, time loop with events, outputs and the energy balance.
//!
//! Steps end exactly at every output and every event: between two such times the step is constant and
//! at most the limit. The energies are taken at full steps, with the momenta of that time; the balance is
//! a true one (states and trapezoidal dissipation), not an identity of the update formulas.
//!
//! | file | owns |
//! |---|---|
//! | this one | the time loop |
//! | `entry` | options, and finer runs where one was too coarse |
//! | `setup` | the step, the empty result |
//! | `events` | yield, fracture, contacts, removal and weakening |
//! | `meetings` | which contacts begin |
//! | `rules` | what contacts and fractures change by the rules of a model |
//! | `part` | latent bushings: bodies that part |
//! | `relate` | inertia that bodies have together: when it begins and ends |
//! | `soften` | springs of what has come down |
//! | `output` | histories, the energy balance, what begins inside something else |
//! | `remarks` | what is worth saying of a run |
//! | `work` | what is computed of bodies and latent sections, and what is left out |

mod entry;
mod events;
mod meetings;
mod output;
mod part;
mod relate;
mod remarks;
mod rules;
mod setup;
mod soften;
mod work;

pub(super) use self::entry::simulate_varied;
pub use self::entry::{REPEATED, SolverOptions, simulate, simulate_carefully, simulate_with};
use self::meetings::Meetings;
pub(super) use self::output::remark_on_overlaps;
pub use self::remarks::OFF_BALANCE;
pub(super) use self::remarks::{FINER_IDEAL, Overturned, closing_remarks, remarks_on_wishes};
use self::rules::EventRules;
use self::setup::{choose_step, connect, empty_result, outputs, preload_error, usable_step};
use super::balance::Balance;
use super::contact::{ContactSet, Moving};
use super::error::SolveError;
use super::latent::Latent;
use super::math;
use super::model::Model;
use super::preload;
use super::relative_mass::have_turned;
use super::result::RunResult;
use super::shared_mass::{Shared, UPRIGHT};
use super::sleep::Sleep;
use super::system::{BodyState, System};
use super::tables::Tables;
use super::{frequency, step};
use std::borrow::Cow;

/// Largest automatic step \[s\]: in it a body at 10 m/s moves by a centimetre, one that turns at 10 rad/s by a hundredth of a radian.
pub const LARGEST_STEP_S: f64 = 1e-3;
/// The same with inertia against relative motion, while nothing has been touched.
pub const LARGEST_RELATED_STEP_S: f64 = 2.5e-3;
/// The same once springs are softer ([`Run::soften`]).
const LARGEST_SOFT_STEP_S: f64 = 1.5e-3;
/// How often the energy balance is looked at between outputs that are farther apart \[s\].
const LOOK_S: f64 = 0.01;
/// Most automatic steps between two outputs, as more points to a wrong stiffness or mass; most steps of a given length.
pub(super) const MOST_STEPS: f64 = 2e9;

/// Times that are one time, as a share of the whole.
pub(super) const SAME: f64 = 1e-12;

struct Run<'a> {
    /// The model as it was given.
    file: &'a Model,
    /// The model that runs: that of the file, with the bodies that latent bushings hold together as one.
    model: Cow<'a, Model>,
    latent: Latent,
    rules: EventRules,
    meetings: Meetings,
    /// States before a step that a body may part in.
    before: Vec<BodyState>,
    resting: Vec<bool>,
    /// Bodies of the file that are, or were a part of, a member that has been crushed.
    crushed: Vec<bool>,
    options: &'a SolverOptions,
    system: System,
    contacts: ContactSet,
    /// The bodies as the contacts see them.
    moving: Vec<Moving>,
    sleep: Sleep,
    /// Work of the forces on displacements without velocity, by contacts \[J\]; and those of this step, for which the half of it is due that the next forces do.
    opened: f64,
    displaced: Vec<step::Displaced>,
    /// States before contacts, where bodies share inertia or latent bushings may give way.
    untouched: Vec<BodyState>,
    result: RunResult,
    time: f64,
    /// Length of the last step, zero right after a start \[s\].
    last_step: f64,
    step_limit: f64,
    /// Step with which vibrations are as well resolved as the energy turned over asks for ([`Self::resolve`]) \[s\].
    finer_step: f64,
    /// That of bodies that have no inertia against relative motion, and that of bodies that share none at all \[s\].
    shared_limit: f64,
    alone_limit: f64,
    /// Whether inertia against relative motion has ended for good.
    is_loose: bool,
    /// Orientations at `t = 0`, and whether a body has turned by more than [`UPRIGHT`] since, under it.
    upright: Vec<math::M3>,
    is_falling: bool,
    /// Whether springs are softer now ([`Self::soften`]).
    is_soft: bool,
    /// Whether bodies have moved as far as the model asks for that.
    has_come_down: bool,
    /// Share of the automatic step that is taken.
    share: f64,
    /// Where the bodies of the file are at `t = 0` \[m\], and the centres of those that run.
    start: Vec<math::V3>,
    origin: Vec<math::V3>,
    /// Bodies of the file and the tracked points in them \[m\].
    tracked: Vec<(usize, math::V3)>,
    /// The hinges: bushings of the file that have a curve, and the place among their own.
    hinges: Vec<(usize, usize)>,
    /// What events have made of the strength of each bushing of the file.
    strength: Vec<f64>,
    /// Of each joint its hinges ([`super::model::Bushing::hinges`]).
    yielded: Vec<[bool; 2]>,
    range_warned: Vec<bool>,
    /// Joints that flowed under axial forces \[N\] outside the levels of their curves, with the first time of it \[s\].
    beyond_levels: Vec<(String, f64, f64)>,
    overturned: Overturned,
    plastic_start: f64,
    released: f64,
    books: Balance,
    /// When it was looked at last \[s\].
    balanced_s: Option<f64>,
    preloading: bool,
}

impl<'a> Run<'a> {
    fn new(
        file: &'a Model,
        options: &'a SolverOptions,
        (share, known): (f64, &Tables),
    ) -> Result<Self, SolveError> {
        let (mut latent, merged) = Latent::with_tables(file, known)?;
        latent.hold(options.hold_latent);
        latent.look_always(options.look_always);
        let model = merged.map_or(Cow::Borrowed(file), Cow::Owned);
        let mut system = latent.compile(&model)?;
        latent.orient(&mut system);
        let at = |id: &str| file.bodies.iter().position(|b| b.id == id).unwrap_or(0);
        let tracked = file.tracked.iter().map(|t| {
            let body = at(&t.body);
            let state = BodyState::new(&file.bodies[body]);
            (body, math::mul_t(&state.r, math::sub(t.point_m, state.x)))
        });
        let tracked: Vec<(usize, math::V3)> = tracked.collect();
        let preload_iterations = if file.settings.preload {
            Some(preload::equilibrate(&mut system).map_err(|e| preload_error(&model, e))?)
        } else {
            None
        };
        let alone = frequency::highest_rad_s(&mut system);
        let mut frequency = alone;
        if !model.shared_masses.is_empty() {
            system.share_masses(&model, alone);
            frequency = frequency::highest_rad_s(&mut system);
        }
        let choose =
            |of: f64| choose_step(&model, of, share).map_err(|e| usable_step(e, file, alone.max(frequency)));
        let (alone_limit, step_limit) = (choose(alone)?, choose(frequency)?);
        let mut contacts = ContactSet::new(&model, options.contact);
        let crushed = vec![false; file.bodies.len()];
        connect(&mut contacts, &system, &latent, &crushed);
        let of = |b: usize| (0..file.bushings[b].hinges().len()).map(move |k| (b, k));
        let hinges: Vec<(usize, usize)> = (0..file.bushings.len()).flat_map(of).collect();
        let n = system.count();
        let mut run = Self {
            start: Vec::new(),
            origin: system.bodies[..n].iter().map(|b| b.x).collect(),
            strength: vec![1.0; file.bushings.len()],
            yielded: system.joints.iter().map(|j| j.flowed().map(|(alpha, _)| alpha > 0.0)).collect(),
            range_warned: vec![false; system.joints.len()],
            beyond_levels: Vec::new(),
            overturned: Overturned::default(),
            plastic_start: system.joints.iter().map(|j| j.hinge.dissipated_j + j.crush_j).sum(),
            result: empty_result(file, &hinges, frequency, preload_iterations),
            file,
            model,
            latent,
            rules: EventRules::of(file),
            meetings: Meetings::default(),
            before: Vec::new(),
            resting: Vec::new(),
            crushed,
            options,
            system,
            contacts,
            moving: Vec::new(),
            sleep: Sleep::new(file.settings.sleep_speed_m_s, n),
            opened: 0.0,
            displaced: Vec::new(),
            untouched: Vec::new(),
            time: 0.0,
            last_step: 0.0,
            step_limit,
            finer_step: f64::INFINITY,
            shared_limit: step_limit,
            alone_limit,
            is_loose: false,
            upright: Vec::new(),
            is_falling: false,
            is_soft: false,
            has_come_down: false,
            share,
            tracked,
            hinges,
            released: 0.0,
            books: Balance::default(),
            balanced_s: None,
            preloading: file.settings.preload,
        };
        run.upright = run.system.bodies[..n].iter().map(|b| b.r).collect();
        run.start = (0..file.bodies.len()).map(|i| run.piece(i).0).collect();
        for k in 0..run.tracked.len() {
            run.result.tracked[k].origin_m = run.place_of(run.tracked[k]);
        }
        Ok(run)
    }

    /// Position and orientation of a body of the file.
    fn piece(&self, i: usize) -> (math::V3, math::Q) {
        let place = self.latent.places[i];
        let body = &self.system.bodies[place.body];
        place.of(body.x, body.q, &body.r)
    }

    /// A point of a body of the file in space \[m\].
    fn place_of(&self, (body, local): (usize, math::V3)) -> math::V3 {
        let place = self.latent.places[body];
        let state = &self.system.bodies[place.body];
        let (x, q) = place.of(state.x, state.q, &state.r);
        let r = if place.pose.is_some() { math::qmat(q) } else { state.r };
        math::add(x, math::mul(&r, local))
    }

    fn go(&mut self) -> Result<(), SolveError> {
        self.note_preload_yield();
        self.forces();
        self.part_under_load()?;
        self.output()?;
        self.events_at(0.0)?;
        self.begin_relating();
        if self.system.relative.is_some() {
            self.forces();
        }
        for (end, is_output) in self.stops() {
            self.advance_to(end)?;
            self.forces();
            self.soften();
            if is_output {
                self.output()?;
            }
            self.events_at(end)?;
            self.resolve();
        }
        Ok(())
    }

    /// Outputs and events after `t = 0` in order of time.
    fn stops(&self) -> Vec<(f64, bool)> {
        let s = &self.file.settings;
        let count = outputs(s);
        let mut stops: Vec<(f64, bool)> =
            (1..=count).map(|i| (i as f64 * s.output_interval_s, true)).collect();
        if stops.last().is_none_or(|last| s.end_time_s - last.0 > 1e-9 * s.end_time_s) {
            stops.push((s.end_time_s, true));
        }
        let events = self.file.events.iter().map(|e| e.time_s);
        stops.extend(events.filter(|t| *t > 0.0 && *t <= s.end_time_s).map(|t| (t, false)));
        stops.sort_by(|a, b| a.0.total_cmp(&b.0));
        stops.dedup_by(|later, kept| {
            let same = later.0 - kept.0 <= SAME * s.end_time_s;
            kept.1 |= same && later.1;
            same
        });
        stops
    }

    /// Steps up to `end`. Forces at the current position are known; at the end they are not yet.
    fn advance_to(&mut self, end: f64) -> Result<(), SolveError> {
        while !self.advance(end)? {}
        self.time = end;
        Ok(())
    }

    /// The same, or up to the time at which a body parts: the steps then begin anew.
    fn advance(&mut self, end: f64) -> Result<bool, SolveError> {
        let span = end - self.time;
        let count = (span / self.step_limit.min(self.finer_step) - 1e-9).ceil().max(1.0);
        let h = span / count;
        let begin = self.time;
        let census = self.census();
        if self.sleep.is_complete(&self.system) {
            (self.last_step, self.time) = (h, end);
            self.result.steps += count as usize;
            self.book_steps(census, count as u64);
            return Ok(true);
        }
        for i in 0..count as usize {
            if i > 0 {
                self.forces();
                if self.time - self.balanced_s.unwrap_or(0.0) >= LOOK_S {
                    self.balance()?;
                    if self.system.relative.is_some() {
                        self.resolve();
                        return Ok(false);
                    }
                }
            }
            if self.step_limit < (1.0 - 1e-9) * h {
                return Ok(false);
            }
            if self.latent.is_watching() && self.part_under_load()? {
                return Ok(false);
            }
            step::kick(&mut self.system, 0.5 * (self.last_step + h), h);
            let meets = !step::is_quiet(&self.system, &mut self.contacts, h);
            if meets && self.meet(h)? {
                return Ok(false);
            }
            if self.latent.is_watching() && (!meets || !self.contacts.has_points()) {
                self.latent.feel(&self.system, None, h);
                self.latent.keep();
            }
            self.sleep.count(&mut self.system, &mut self.contacts, self.time, h);
            step::drift(&mut self.system, h);
            self.system.weigh(h);
            self.result.steps += 1;
            self.result.time_step_s = self.result.time_step_s.max(h);
            self.book_steps(census, 1);
            self.last_step = h;
            self.time = begin + h * (i + 1) as f64;
        }
        Ok(true)
    }

    /// Contact impulses at the present positions, for a step of `h` from here. Whether a body parted under them: the step has not been taken then.
    fn meet(&mut self, h: f64) -> Result<bool, SolveError> {
        let books = (self.contacts.energy, self.opened);
        let is_waiting = self.latent.is_waiting();
        let is_latent = is_waiting || self.latent.is_watching();
        if is_latent || !self.system.shared.is_empty() || self.system.relative.is_some() {
            self.remember();
        }
        loop {
            let (contacts, displaced) = (&mut self.contacts, &mut self.displaced);
            let opened = step::meet(&mut self.system, contacts, &mut self.moving, displaced, h);
            self.opened += opened.map_err(|deep| SolveError::Penetration {
                time_s: self.time,
                a: self.model.bodies[deep.a].id.clone(),
                b: deep.b.id(&self.model).into(),
                depth_m: deep.depth_m,
                step_s: h,
            })?;
            let touched = std::mem::take(&mut self.contacts.touched);
            if touched.is_empty() {
                break;
            }
            self.sleep.rouse(&mut self.system, &mut self.contacts, &touched, h);
        }
        if self.system.relative.is_some() && self.let_loose(h, books) {
            return Ok(true);
        }
        if is_waiting {
            self.ask_about_contacts(h);
        }
        if self.latent.is_watching() && self.contacts.has_points() && self.part_under_contact(h, books)? {
            return Ok(true);
        }
        if !self.system.shared.is_empty() && self.part_touched(h, books) {
            return self.meet(h);
        }
        if !self.contacts.touches.is_empty() {
            self.record_touches();
        }
        Ok(false)
    }

    /// Forces at the current position; fracture.
    #[inline]
    fn forces(&mut self) {
        self.forces_with(|s, all| s.is_over(&all.bodies, &all.data, &all.joints));
    }

    /// The same, where the sharing of inertia of which this is true ends.
    #[inline]
    fn forces_with(&mut self, mut is_over: impl FnMut(&Shared, &System) -> bool) {
        self.system.reset_forces();
        let was_related = self.system.relative.is_some();
        let parted = if self.system.add_joint_forces() { self.look_at_joints() } else { Vec::new() };
        self.system.carry_over();
        self.opened += step::half_work_j(&self.system, &self.displaced);
        self.displaced.clear();
        if let Some(relative) = &self.system.relative {
            let system = &self.system;
            let (bodies, data) = (&system.bodies, &system.data);
            self.is_loose |= relative.is_over(self.step_limit, bodies, data);
            let begins_to_fall = !self.is_falling && have_turned(&self.upright, UPRIGHT, bodies, data);
            self.is_falling |= begins_to_fall;
            let has_turned = begins_to_fall || relative.has_turned(bodies, data, &system.joints);
            if self.is_loose
                || has_turned
                || !parted.is_empty()
                || system.shared.iter().any(|s| is_over(s, system))
            {
                self.end_relating();
            }
        }
        if self.system.relative.is_none() && !self.system.shared.is_empty() {
            let joins = |s: &Shared| parted.iter().any(|pair| s.joins(*pair));
            self.released += self.system.end_sharing(self.last_step, |s, all| joins(s) || is_over(s, all));
            if self.system.shared.is_empty() {
                self.step_limit = self.step_limit.max(self.alone_limit);
            }
        }
        if was_related && self.system.relative.is_none() {
            self.relate();
        }
        self.system.share_forces();
    }

    /// Notes what flows and opens what breaks; the bodies of the joints that did.
    fn look_at_joints(&mut self) -> Vec<[usize; 2]> {
        let mut broken = false;
        for i in 0..self.system.joints.len() {
            let joint = &self.system.joints[i];
            broken |= joint.breaks();
            let is_known = self.yielded[i][0] && (joint.beam.is_none() || self.yielded[i][1]);
            if joint.flowing && (!is_known || (joint.hinge.out_of_range && !self.range_warned[i])) {
                self.note_yield(i);
            }
        }
        if broken { self.fracture() } else { Vec::new() }
    }
}
