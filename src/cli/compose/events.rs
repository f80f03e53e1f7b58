//! What happened when, in all runs.

use super::marks::is_active;
use super::{Against, Pieces};
use crate::fe::dynamics::Death;
use crate::mbs::result::{EventKind, FractureCause};
use crate::report::TimedEvent;
use crate::validate::ACTIVE_ROTATION_RAD;

/// Events of the runs in order of time.
pub fn events(p: &Pieces) -> Vec<TimedEvent> {
    let of_fe = p.against.iter().flat_map(|a| fe_events(p, a));
    let mut events: Vec<TimedEvent> = of_fe.chain(mbs_events(p)).collect();
    events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    events
}

fn fe_events(p: &Pieces, a: &Against) -> Vec<TimedEvent> {
    let event = |time_s: f64, what: String| TimedEvent { time_s, run: "FE".into(), what };
    let mut events: Vec<TimedEvent> = p
        .building
        .events
        .iter()
        .map(|c| event(c.time_s, format!("charge {} removes {}", c.id, c.member)))
        .collect();
    for zone in &a.facts.ends {
        let zones = [
            (zone.first_s, "exceeds the critical strain rate"),
            (zone.fracture_s, "has lost a whole layer of elements"),
        ];
        events
            .extend(zones.iter().filter_map(|(t, what)| t.map(|t| event(t, format!("{} {what}", zone.id)))));
    }
    if let Some(death) = a.fe.deaths.iter().find(|d| d.cause != Death::Removed) {
        let part = &a.fe.mesh.parts[a.fe.mesh.elements[death.element].part];
        events.push(event(death.time_s, format!("the first element erodes, in {part}")));
    }
    events.extend(
        a.fe.touches.iter().map(|t| event(t.time_s, format!("{} touches {}", t.part, surface(&t.surface)))),
    );
    events
}

/// An event of an MBS run in words.
pub fn words(kind: &EventKind) -> String {
    match kind {
        EventKind::Yield { joint } => format!("hinge {joint} yields"),
        EventKind::Fracture { joint, cause: FractureCause::Rotation } => {
            format!("hinge {joint} separates: rotation capacity used up")
        }
        EventKind::Fracture { joint, cause: FractureCause::Tension } => {
            format!("hinge {joint} separates in tension")
        }
        EventKind::Fracture { joint, cause: FractureCause::Compression } => {
            format!("hinge {joint} is crushed")
        }
        EventKind::Fracture { joint, cause: FractureCause::Shear } => {
            format!("hinge {joint} separates in shear")
        }
        EventKind::Contact { a, b } => format!("{a} touches {}", surface(b)),
        EventKind::Live { joint, with: None } => format!("{joint} gives way: its body parts there"),
        EventKind::Live { joint, with: Some(cause) } => format!("{joint} becomes a hinge with {cause}"),
        EventKind::Rule { rule, body, with, watched, approach_speed_m_s } => {
            let happened = match approach_speed_m_s {
                Some(speed) => format!("{body} meets {} at {speed:.2} m/s", surface(with)),
                None => format!("{body} breaks at {with}"),
            };
            format!("{happened}: rule {rule} fires, and {} may give way from now on", watched.join(", "))
        }
        EventKind::Removal { event } => format!("charge {event} removes its bodies"),
    }
}

fn mbs_events(p: &Pieces) -> Vec<TimedEvent> {
    let recorded = |joint: &str| p.mbs.hinges.iter().any(|h| h.joint == joint);
    let what = |kind: &EventKind| match kind {
        // as in the table of the sites
        EventKind::Yield { joint } if recorded(joint) && !is_active(p.mbs, joint) => {
            format!("{} slightly, by less than {ACTIVE_ROTATION_RAD} rad in the whole run", words(kind))
        }
        _ => words(kind),
    };
    let event = |e: &crate::mbs::result::RunEvent| TimedEvent {
        time_s: e.time_s,
        run: "MBS".into(),
        what: what(&e.kind),
    };
    p.mbs.events.iter().map(event).collect()
}

fn surface(name: &str) -> &str {
    if name == "ground" { "the ground" } else { name }
}
