//! What has become of the hinges and latent sections of an MBS run, and where they are.

use crate::mbs::latent::{is_gone, live_s};
use crate::mbs::model::{Bushing, Model};
use crate::mbs::result::{EventKind, Frame};
use crate::mbs::{RunResult, math};
use crate::report::{Mark, MarkKind};
use crate::validate::ACTIVE_ROTATION_RAD;

/// A hinge, an elastic bushing or a latent section of a run.
struct Place {
    /// Where it is in the body that carries it \[m\].
    local_m: [f64; 3],
    carrier: usize,
    /// The bodies that it joins.
    bodies: Vec<usize>,
    /// When it turned plastically for the first time, went live, separated \[s\]; infinite: never.
    yielded_s: f64,
    live_s: f64,
    broken_s: f64,
}

/// All hinges and latent sections of a run.
pub struct Marks<'a> {
    model: &'a Model,
    result: &'a RunResult,
    places: Vec<Place>,
}

impl<'a> Marks<'a> {
    /// Of a run of a model. A hinge that turned plastically by no more than [`ACTIVE_ROTATION_RAD`] in the whole run counts as not yielded, as in the comparison with FE.
    pub fn of(model: &'a Model, result: &'a RunResult) -> Self {
        let start = result.frames.first();
        let places = start.map_or(Vec::new(), |start| {
            let live_s = live_s(model, result);
            let of_bushing = |b: &Bushing| {
                let live_s = live_s.get(b.id.as_str()).copied().unwrap_or(f64::INFINITY);
                places_of(b, live_s, (model, result, start))
            };
            model.bushings.iter().flat_map(of_bushing).collect()
        });
        Self { model, result, places }
    }

    /// What has become of them at an output, and where they are then; nothing of those whose bodies have vanished.
    pub fn at(&self, output: usize) -> Vec<Mark> {
        let (Some(time_s), Some(frame)) = (self.result.times_s.get(output), self.result.frames.get(output))
        else {
            return Vec::new();
        };
        let gone = is_gone(self.model, *time_s);
        let mark = |place: &Place| {
            let happened = [
                (place.broken_s, MarkKind::Broken),
                (place.live_s, MarkKind::Live),
                (place.yielded_s, MarkKind::Yielded),
            ];
            let (_, kind) = happened.into_iter().find(|(t, _)| t <= time_s)?;
            let (turn, position_m) = pose(frame, place.carrier);
            let point_m = math::add(position_m, math::mul(&turn, place.local_m));
            Some(Mark { point_m, kind })
        };
        self.places.iter().filter(|p| p.bodies.iter().all(|b| !gone[*b])).filter_map(mark).collect()
    }
}

/// How many hinges and latent sections something has happened to by a time. One may count in all three.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Happened {
    /// Have turned plastically.
    pub yielded: usize,
    /// Have gone live.
    pub live: usize,
    /// Have separated.
    pub broken: usize,
}

impl Marks<'_> {
    /// How many something has happened to by an output, those included whose bodies have vanished since: no count ever falls.
    pub fn happened(&self, output: usize) -> Happened {
        let until_s = self.result.times_s.get(output).copied().unwrap_or(f64::NEG_INFINITY);
        let count = |of: fn(&Place) -> f64| self.places.iter().filter(|p| of(p) <= until_s).count();
        Happened { yielded: count(|p| p.yielded_s), live: count(|p| p.live_s), broken: count(|p| p.broken_s) }
    }
}

/// The hinges of a bushing, or the bushing itself if it is elastic.
fn places_of(
    bushing: &Bushing,
    live_s: f64,
    (model, result, start): (&Model, &RunResult, &Frame),
) -> Vec<Place> {
    let at = |id: &String| model.bodies.iter().position(|b| b.id == *id);
    let bodies: Vec<usize> = bushing.body_a.iter().chain([&bushing.body_b]).filter_map(at).collect();
    let first = |is: &dyn Fn(&EventKind) -> bool| {
        result.events.iter().find(|e| is(&e.kind)).map_or(f64::INFINITY, |e| e.time_s)
    };
    let place = |(k, name): (usize, &str)| {
        let point_m = point_of(bushing, k);
        let carrier = carrier(bushing, &bodies, start, point_m)?;
        let (turn, position_m) = pose(start, carrier);
        let yields = |kind: &EventKind| matches!(kind, EventKind::Yield { joint } if joint == name);
        let breaks = |kind: &EventKind| matches!(kind, EventKind::Fracture { joint, .. } if joint == name);
        Some(Place {
            local_m: math::mul_t(&turn, math::sub(point_m, position_m)),
            carrier,
            bodies: bodies.clone(),
            yielded_s: if is_active(result, name) { first(&yields) } else { f64::INFINITY },
            live_s,
            broken_s: first(&breaks),
        })
    };
    let named = bushing.hinges();
    let names = if named.is_empty() { vec![bushing.id.as_str()] } else { named };
    names.into_iter().enumerate().filter_map(place).collect()
}

/// Whether a hinge turns plastically by more than [`ACTIVE_ROTATION_RAD`] in a run.
pub(super) fn is_active(result: &RunResult, name: &str) -> bool {
    let history = result.hinges.iter().find(|h| h.joint == name);
    history.is_some_and(|h| h.plastic_rotation_rad.iter().any(|a| *a > ACTIVE_ROTATION_RAD))
}

/// Where the hinge with a number among those of a bushing is at the start \[m\]: of a beam the end towards negative axis 0 comes first.
pub(super) fn point_of(bushing: &Bushing, k: usize) -> [f64; 3] {
    let sense = [-1.0, 1.0][k.min(1)];
    let along_m = bushing.beam.as_ref().map_or(0.0, |beam| sense * beam.half_length_m);
    math::axpy(bushing.point_m, along_m, bushing.axes[0])
}

/// The body that carries a hinge: the second one; at the end of a beam that of its side.
fn carrier(bushing: &Bushing, bodies: &[usize], start: &Frame, point_m: [f64; 3]) -> Option<usize> {
    let second = bodies.last().copied()?;
    if bushing.beam.is_none() {
        return Some(second);
    }
    let beyond = |b: &usize| {
        let to_body = math::sub(start.position_m[*b], bushing.point_m);
        math::dot(to_body, math::sub(point_m, bushing.point_m)) > 0.0
    };
    Some(bodies.iter().copied().find(beyond).unwrap_or(second))
}

/// Rotation and centre of mass \[m\] of a body in a frame.
pub(super) fn pose(frame: &Frame, body: usize) -> (math::M3, [f64; 3]) {
    (math::qmat(frame.orientation[body]), frame.position_m[body])
}
