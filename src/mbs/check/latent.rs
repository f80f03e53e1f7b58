//! Checks of latent bushings and the bodies that they hold together.

use super::List;
use crate::mbs::latent::merge;
use crate::mbs::math;
use crate::mbs::model::{Bending, Model};

/// How far the velocities of pieces may be from those of the body that they make, of the largest speed.
const VELOCITY_TOLERANCE: f64 = 1e-6;

pub(super) fn check(model: &Model, list: &mut List) {
    let latent: Vec<bool> = model.bushings.iter().map(|b| b.latent.is_some()).collect();
    if !latent.contains(&true) {
        return;
    }
    let before = list.len();
    for (i, bushing) in model.bushings.iter().enumerate().filter(|(_, b)| b.latent.is_some()) {
        let path = format!("bushings[{i}]");
        list.require(!model.is_ideal(), &format!("{path}.latent"), || {
            "needs a model without ideal joints and forces: leave it out, so that the bushing is live".into()
        });
        list.require(bushing.body_a.is_some(), &format!("{path}.latent"), || {
            "needs a body on both sides, body_a is the ground: leave it out, so that the bushing is live"
                .into()
        });
        let [s1, s2] = bushing.shear_stiffness_n_m;
        let mut stiff = vec![
            ("axial_stiffness_n_m", bushing.axial_stiffness_n_m),
            ("shear_stiffness_n_m[0]", s1),
            ("shear_stiffness_n_m[1]", s2),
            ("torsional_stiffness_nm_rad", bushing.torsional_stiffness_nm_rad),
        ];
        for (k, bending) in bushing.bending.iter().enumerate() {
            if let Bending::Elastic { stiffness_nm_rad } = bending {
                stiff.push((
                    ["bending[0].stiffness_nm_rad", "bending[1].stiffness_nm_rad"][k],
                    *stiffness_nm_rad,
                ));
            }
        }
        for (name, k) in stiff {
            list.require(k > 0.0, &format!("{path}.{name}"), || {
                format!("is {k}, expected a positive number: a latent bushing goes live with the force that it bears")
            });
        }
    }
    if list.len() == before {
        check_bodies(model, &latent, list);
    }
}

fn check_bodies(model: &Model, latent: &[bool], list: &mut List) {
    let merged = merge(model, latent);
    for (i, pair) in model.contact.pairs.iter().enumerate() {
        for id in [&pair.a, &pair.b] {
            let Some(body) = model.bodies.iter().position(|b| b.id == *id) else { continue };
            let first = merged.pieces[merged.places[body].body][0];
            list.require(first == body, &format!("contact.pairs[{i}]"), || {
                let first = &model.bodies[first].id;
                format!("names \"{id}\", which latent bushings hold to \"{first}\": as long as they are one, what is said of the first of them holds for all")
            });
        }
    }
    let speed = model.bodies.iter().map(|b| math::norm(b.velocity_m_s)).fold(0.0, f64::max);
    let spin = model.bodies.iter().map(|b| math::norm(b.angular_velocity_rad_s)).fold(0.0, f64::max);
    // what velocities round off turns a body as well, by as much over a metre
    let spin = spin + speed;
    for (i, body) in model.bodies.iter().enumerate() {
        let whole = &merged.model.bodies[merged.places[i].body];
        let arm = math::sub(body.position_m, whole.position_m);
        let v = math::add(whole.velocity_m_s, math::cross(whole.angular_velocity_rad_s, arm));
        let off = math::norm(math::sub(body.velocity_m_s, v));
        list.require(off <= VELOCITY_TOLERANCE * speed, &format!("bodies[{i}].velocity_m_s"), || {
            format!(
                "is {:?}, but latent bushings hold it to bodies with which it would move at {v:?}",
                body.velocity_m_s
            )
        });
        let off = math::norm(math::sub(body.angular_velocity_rad_s, whole.angular_velocity_rad_s));
        list.require(
            off <= VELOCITY_TOLERANCE * spin,
            &format!("bodies[{i}].angular_velocity_rad_s"),
            || {
                format!(
                    "is {:?}, but latent bushings hold it to bodies that turn at {:?}",
                    body.angular_velocity_rad_s, whole.angular_velocity_rad_s
                )
            },
        );
    }
}
