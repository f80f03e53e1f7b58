//! Progressive collapse of floors onto each other, without resistance.

use super::contact::{energy, ground, model, run};
use super::models::{held, solid};
use crate::mbs::model::{Body, BodyContact, Event, Shape};
use crate::verify::{Case, Figure};

const G: f64 = 9.81;
/// Clear height of a storey \[m\].
const STOREY_M: f64 = 3.5;
/// Plan and thickness of a floor \[m\], and its density.
const FLOOR_M: [f64; 3] = [4.0, 4.0, 0.2];
const DENSITY_KG_M3: f64 = 2500.0;
/// Stiffness of what holds a floor \[N/m\], and its strength over the weight: it lets go as soon as the floor is struck.
const STIFFNESS_N_M: f64 = 1e6;
const STRENGTH: f64 = 1.01;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "pancake-3",
            "Three floors, 3.5 m above each other and the ground: the top one falls, strikes the next without rebound, which goes with it, and so on.",
            || pancake(3),
        ),
        Case::short("pancake-10", "The same with ten floors.", || pancake(10)),
    ]
}

/// Time until the ground is struck \[s\] and speed then \[m/s\]: free fall by a storey, after each impact the momentum is shared with one floor more.
fn accretion(floors: u32) -> [f64; 2] {
    let (mut time, mut speed) = (0.0, 0.0);
    for falling in 1..=floors {
        let end = f64::sqrt(speed * speed + 2.0 * G * STOREY_M);
        time += (end - speed) / G;
        speed = if falling < floors { end * f64::from(falling) / f64::from(falling + 1) } else { end };
    }
    [time, speed]
}

fn pancake(floors: u32) -> Result<Vec<Figure>, String> {
    let [end_s, speed_m_s] = accretion(floors);
    let mut m = model(end_s + 0.05, 1e-3);
    m.contact.ground = ground(0.0, 0.0);
    m.contact.bodies = Some(BodyContact { friction: 0.0, restitution: 0.0 });
    m.settings.preload = true;
    m.settings.time_step_s = Some(2e-4);
    let half = FLOOR_M.map(|s| 0.5 * s);
    // what holds a floor is stretched by its weight
    let sag_m = DENSITY_KG_M3 * FLOOR_M.iter().product::<f64>() * G / STIFFNESS_N_M;
    for k in 0..floors {
        let id = format!("floor-{}", k + 1);
        let height = f64::from(k + 1) * STOREY_M + f64::from(k) * FLOOR_M[2] + half[2];
        let position_m = [0.0, 0.0, height + sag_m];
        let shapes = vec![Shape::cuboid([0.0; 3], half)];
        let floor = Body { shapes, ..solid(&id, DENSITY_KG_M3, FLOOR_M, position_m) };
        let strength_n = STRENGTH * floor.mass_kg * G;
        m.bodies.push(floor);
        let hanger = held(
            format!("hanger-{}", k + 1),
            id,
            [0.0, 0.0, position_m[2] + half[2]],
            STIFFNESS_N_M,
            strength_n,
        );
        m.bushings.push(hanger);
    }
    let release = vec![format!("hanger-{floors}")];
    m.events.push(Event { release, ..Event::at("start", 0.0) });
    let result = run(&m)?;
    let struck_s = result.first_ground_contact_s.ok_or("the floors do not come down")?;
    // the speed in the middle of the last two outputs before that, and free fall from there
    let last = result.times_s.partition_point(|t| *t < struck_s) - 1;
    let height = |i: usize| result.frames[i].position_m[0][2];
    let [before, after] = [result.times_s[last - 1], result.times_s[last]];
    let middle_m_s = (height(last - 1) - height(last)) / (after - before);
    let found_m_s = middle_m_s + G * (struck_s - 0.5 * (before + after));
    let source = "accretion without loss of momentum: v' = v n/(n + 1) after each impact (Bažant and Zhou, J. Eng. Mech. 128 (2002) 2, without resistance)";
    Ok(vec![
        Figure::relative("time until the ground is struck", "s", [end_s, struck_s], 1e-3, source),
        Figure::relative("speed then", "m/s", [speed_m_s, found_m_s], 1e-3, source),
        energy(&result, 1e-3),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floors_gather_as_published() {
        for (floors, time_s, speed_m_s) in [(3, 1.79072667, 10.33537616), (10, 3.79454767, 16.25975092)] {
            let [time, speed] = accretion(floors);
            assert!((time - time_s).abs() < 5e-8 && (speed - speed_m_s).abs() < 5e-8, "{time} {speed}");
        }
    }
}
