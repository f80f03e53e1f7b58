//! Softer springs in what has come down: steps are longer, and what falls strikes the ground as without.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::RunResult;
use fallwerk::mbs::{math, simulate};

/// Two floors on columns that crush under 4 MN; the lower one has lost its foot 1 m above the ground.
fn tower() -> Model {
    let mut m = model("tower", 0.6, 0.01);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    let ends = || [elastic(5e7), elastic(5e7)];
    for storey in 0..2 {
        let foot = 1.0 + 3.3 * f64::from(storey);
        let (column, floor) = (format!("column{storey}"), format!("floor{storey}"));
        m.bodies.push(solid(&column, [0.0, 0.0, foot + 1.5], [0.4, 0.4, 3.0]));
        m.bodies.push(solid(&floor, [0.0, 0.0, foot + 3.15], [4.0, 4.0, 0.3]));
        let spring = |id: &str, floor: &str, z: f64| Bushing {
            compressive_capacity_n: Some(4e6),
            ..joint(&format!("{id}{storey}"), Some(floor), &column, [0.0, 0.0, z], 3e9, 5e7, ends())
        };
        m.bushings.push(spring("top", &floor, foot + 3.0));
        if storey > 0 {
            m.bushings.push(spring("foot", "floor0", foot));
        }
        track(&mut m, &floor, [2.0, 2.0, foot + 3.15]);
    }
    m
}

fn with(mut m: Model, soft_after_m: f64) -> [RunResult; 2] {
    let plain = simulate(&m).unwrap();
    m.settings.soft_after_m = Some(soft_after_m);
    [plain, simulate(&m).unwrap()]
}

#[test]
fn what_falls_strikes_the_ground_at_the_same_time_and_hops_no_higher_than_springs_allow() {
    let [plain, soft] = with(tower(), 0.1);
    println!("{} steps for {}", soft.steps, plain.steps);
    assert!(3 * soft.steps < 2 * plain.steps, "{} for {}", soft.steps, plain.steps);
    assert!(plain.time_step_s <= 1e-3 && soft.time_step_s > plain.time_step_s && soft.time_step_s <= 1.5e-3);
    let [a, b] = [&plain, &soft].map(|r| r.first_ground_contact_s.unwrap());
    // free fall through 1 m
    assert!((a - (2.0 / G).sqrt()).abs() < 1e-3 && (a - b).abs() < 1e-3, "{a} {b}");
    for run in [&plain, &soft] {
        println!("energy: error {:.1e}, growth {:.1e}", run.energy_error, run.energy_growth);
        assert!(run.energy_growth < 1e-4, "{}", run.energy_growth);
    }
    let apart = plain.tracked.iter().zip(&soft.tracked).flat_map(|(p, s)| {
        p.displacement_m.iter().zip(&s.displacement_m).map(|(p, s)| math::norm(math::sub(*p, *s)))
    });
    let largest = apart.fold(0.0, f64::max);
    println!("{largest} m apart");
    // 4 MN on a spring of 1.1e9 N/m, as soft as steps of 1.5 ms need at a column of 1,200 kg, are 7.3 kJ; three of them lift 26 t by 8 cm at most
    assert!(largest < 0.08, "{largest}");
}

#[test]
fn nothing_is_softer_before_bodies_have_moved_as_far() {
    let [plain, soft] = with(tower(), 5.0);
    assert_eq!((plain.steps, &plain.tracked, &plain.energies), (soft.steps, &soft.tracked, &soft.energies));
}

/// As below a charge in the middle of a building: what stands is struck by what falls, and has to bear it as stiff as it is.
#[test]
fn nothing_is_softer_as_long_as_a_tenth_of_the_mass_stands() {
    let mut m = tower();
    m.bodies.push(solid("pier", [20.0, 0.0, 1.0], [2.0, 2.0, 2.0]));
    m.bushings.push(joint("base", None, "pier", [20.0, 0.0, 0.0], 3e9, 5e7, [elastic(5e7), elastic(5e7)]));
    let mass = |m: &Model| m.bodies.iter().map(|b| b.mass_kg).sum::<f64>();
    let pier = m.bodies.last_mut().unwrap();
    let given = pier.mass_kg;
    for (share, stays) in [(0.12, true), (0.08, false)] {
        let mut m = m.clone();
        let others = mass(&m) - given;
        let pier = m.bodies.last_mut().unwrap();
        pier.mass_kg = others * share / (1.0 - share);
        let [plain, soft] = with(m, 0.1);
        println!("{share}: {} steps for {}", soft.steps, plain.steps);
        assert_eq!(plain.steps == soft.steps, stays, "{share}");
        assert_eq!(plain.tracked == soft.tracked, stays, "{share}");
    }
}

#[test]
fn a_given_step_stays() {
    let mut m = tower();
    m.settings.time_step_s = Some(2e-4);
    let [plain, soft] = with(m, 0.1);
    assert_eq!((plain.steps, &plain.tracked), (soft.steps, &soft.tracked));
}

#[test]
fn it_needs_a_positive_distance() {
    let mut m = tower();
    m.settings.soft_after_m = Some(-0.1);
    let text = simulate(&m).unwrap_err().to_string();
    assert!(text.contains("settings.soft_after_m"), "{text}");
}
