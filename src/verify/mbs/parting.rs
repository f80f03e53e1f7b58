//! What is conserved when a body parts at its latent bushings.

use super::models::{elastic, solid};
use crate::mbs::latent::Latent;
use crate::mbs::math::{self, V3};
use crate::mbs::model::{Bushing, Model};
use crate::mbs::system::System;
use crate::verify::{Case, Figure};

/// Pieces of the body, and the size of each \[m\].
const PIECES: usize = 5;
const PIECE_M: V3 = [1.8, 0.4, 0.3];
const DENSITY_KG_M3: f64 = 2500.0;
/// Velocity \[m/s\] of the point at [`ABOUT_M`] \[m\] and angular velocity \[rad/s\] of all pieces.
const VELOCITY_M_S: V3 = [10.0, -20.0, 5.0];
const SPIN_RAD_S: V3 = [3.0, -2.0, 7.0];
const ABOUT_M: V3 = [2.0, 1.0, 0.0];
/// Some thousand roundings of numbers in double precision, as many operations as parting takes at most.
const ROUNDING: f64 = 1e-12;

/// The case of this file.
pub fn cases() -> Vec<Case> {
    vec![Case::short(
        "split-momentum",
        "A body of five pieces, not in a line and one of them askew, flies and rotates about no principal axis; it parts at three latent bushings, one after the other: relative change of its momenta.",
        split,
    )]
}

/// The body in its pieces.
fn pieces() -> Model {
    let mut m = Model::empty("parting body", [0.0, 0.0, -9.81], 1.0, 0.1);
    for i in 0..PIECES {
        let middle = [(i as f64 + 0.5) * PIECE_M[0], 0.0, 0.0];
        m.bodies.push(solid(&format!("piece-{i}"), DENSITY_KG_M3, PIECE_M, middle));
        if i > 0 {
            let (id, at) = (format!("section-{i}"), [i as f64 * PIECE_M[0], 0.0, 0.0]);
            let between = elastic(id.clone(), Some(format!("piece-{}", i - 1)), format!("piece-{i}"), at);
            m.bushings.push(Bushing { latent: Some(id), ..between });
        }
    }
    m.bodies[2].position_m[1] += 0.7;
    m.bodies[3].inertia_kg_m2[0][1] = 20.0;
    m.bodies[3].inertia_kg_m2[1][0] = 20.0;
    for body in &mut m.bodies {
        let arm = math::sub(body.position_m, ABOUT_M);
        body.velocity_m_s = math::add(VELOCITY_M_S, math::cross(SPIN_RAD_S, arm));
        body.angular_velocity_rad_s = SPIN_RAD_S;
    }
    m
}

/// Momentum \[kg m/s\] and angular momentum about the origin \[kg m²/s\] of all bodies.
fn momenta(system: &System) -> [V3; 2] {
    let add = |[linear, angular]: [V3; 2], body: &crate::mbs::system::BodyState| {
        let about = math::add(math::cross(body.x, body.p), body.l);
        [math::add(linear, body.p), math::add(angular, about)]
    };
    system.bodies[..system.count()].iter().fold([[0.0; 3]; 2], add)
}

fn split() -> Result<Vec<Figure>, String> {
    let m = pieces();
    m.check().map_err(|e| e.to_string())?;
    let (mut latent, whole) = Latent::new(&m).map_err(|e| e.to_string())?;
    let mut system = latent.compile(&whole.ok_or("nothing is latent")?).map_err(|e| e.to_string())?;
    // where the file does not have it, so that no pose is a special one
    system.bodies[0].x = [100.0, -50.0, 20.0];
    system.bodies[0].rotate([0.3, 1.2, -0.7]);
    let mut worst = [0.0_f64; 2];
    for cause in [2, 0, 3] {
        let before = momenta(&system);
        let parting = latent.parting(&system, cause);
        (system, _) = latent.part(&m, &system, &parting).map_err(|e| e.to_string())?;
        let after = momenta(&system);
        for k in 0..2 {
            let change = math::norm(math::sub(after[k], before[k])) / math::norm(before[k]);
            worst[k] = worst[k].max(change);
        }
    }
    let source = "conservation of momentum, to rounding";
    let kept = |what: &str, change: f64| Figure::absolute(what, "-", [0.0, change], ROUNDING, source);
    let bodies = [4.0, system.count() as f64];
    Ok(vec![
        Figure::absolute(
            "bodies after three partings",
            "-",
            bodies,
            0.0,
            "as many sections part as are told to",
        ),
        kept("change of momentum over momentum", worst[0]),
        kept("change of angular momentum over angular momentum", worst[1]),
    ])
}
