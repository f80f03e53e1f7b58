//! The hinge law: return mapping, energy, envelopes, toppling column.

use super::support::*;
use fallwerk::curve::hinge::AxisLaw;
use fallwerk::curve::*;
use fallwerk::mbs::model::{Body, Bushing};
use fallwerk::mbs::simulate;

fn softening_table() -> CapacityTable {
    CapacityTable::new(&frame_curve(), 1.0).unwrap()
}

#[test]
fn work_is_elastic_energy_plus_dissipation_in_every_step() {
    let levels = [(0.0, 1.0), (8e5, 1.6)].map(|(axial_force_n, factor)| CapacityLevel {
        axial_force_n,
        capacity: vec![[0.0, 80e3 * factor], [0.01, 120e3 * factor], [0.05, 20e3], [0.08, 0.0]],
        fracture_rotation_rad: 0.5,
    });
    let strong = CapacityTable::new(
        &ResistanceCurve { stiffness_nm_rad: 2e7, levels: levels.to_vec(), cyclic: None },
        1.0,
    )
    .unwrap();
    let weak = softening_table();
    let laws = [AxisLaw::Plastic(&strong), AxisLaw::Plastic(&weak)];
    let mut state = Hinge2::default();
    let (mut work, mut old_theta, mut elastic) = (0.0, [0.0; 2], 0.0);
    for i in 1..=4000 {
        let s = f64::from(i) / 4000.0;
        let theta = [0.06 * s * (9.0 * s).sin(), 0.05 * s * (5.0 * s).cos() - 0.02 * s];
        let old = state;
        let force = 1e6 * (3.0 * s).sin();
        elastic = state.step(laws, theta, force).elastic_j;
        work += (0..2)
            .map(|k| 0.5 * (old.moment_nm[k] + state.moment_nm[k]) * (theta[k] - old_theta[k]))
            .sum::<f64>();
        let balance = elastic + state.dissipated_j - work;
        assert!(balance.abs() < 1e-9 * (work.abs() + 1.0), "step {i}: {balance} of {work}");
        let mut hints = [CapacityHint::default(); 2];
        let c =
            [&strong, &weak].map(|t| t.capacity(state.alpha_rad, force, &mut hints[0]).moment_nm.max(1e-9));
        let f = (state.moment_nm[0] / c[0]).hypot(state.moment_nm[1] / c[1]);
        assert!(f <= 1.0 + 1e-9 || c[0].min(c[1]) < 1.0, "step {i}: outside the ellipse, f = {f}");
        assert!(state.alpha_rad >= old.alpha_rad);
        old_theta = theta;
    }
    assert!(state.dissipated_j > 1e3 && elastic >= 0.0);
}

#[test]
fn monotonic_rotation_follows_the_capacity_and_dissipates_its_area() {
    let table = softening_table();
    let laws = [AxisLaw::Elastic(1e6), AxisLaw::Plastic(&table)];
    let mut state = Hinge2::default();
    for i in 1..=20000 {
        state.step(laws, [0.0, 0.2 * f64::from(i) / 20000.0], 0.0);
        if i == 9000 {
            // theta = 0.09: the softening line of the total rotation.
            assert!(
                (state.moment_nm[1] - 120e3 * (0.15 - 0.09) / 0.12).abs() < 1e-4,
                "{}",
                state.moment_nm[1]
            );
        }
    }
    let area = frame_curve().levels[0].energy_j();
    assert!((area - 120e3 * (0.024 + 0.063)).abs() < 1e-6);
    assert!((state.dissipated_j - area).abs() < 1e-4 * area, "{} {area}", state.dissipated_j);
}

/// Two levels that fracture at 0.4 and 0.1 rad: half of the damage under one and half under the other, and a pulse beyond 0.1 rad that adds only what turns under it.
#[test]
fn damage_to_fracture_adds_up_over_axial_forces() {
    let level = |axial_force_n: f64, fracture_rotation_rad: f64| CapacityLevel {
        axial_force_n,
        capacity: vec![[0.0, 1e5], [0.5, 1e5]],
        fracture_rotation_rad,
    };
    let levels = vec![level(0.0, 0.4), level(1e6, 0.1)];
    let curve = ResistanceCurve { stiffness_nm_rad: 1e9, levels, cyclic: None };
    let table = CapacityTable::new(&curve, 1.0).unwrap();
    let laws = [AxisLaw::Elastic(1e6), AxisLaw::Plastic(&table)];
    let fractured_at = |force: &dyn Fn(f64) -> f64| {
        let mut state = Hinge2::default();
        let turns = (1..=100_000).map(|i| 5e-6 * f64::from(i));
        let mut turned = turns.skip_while(|theta| {
            state.step(laws, [0.0, *theta], force(state.alpha_rad));
            !state.fractured
        });
        (turned.next().map(|_| state.alpha_rad), state.damage)
    };
    // a step, 5e-6 rad, on the wrong side of a change counts for four
    let near = |at: (Option<f64>, f64), expected: f64| {
        assert!((at.0.unwrap() - expected).abs() < 3e-5 && (at.1 - 1.0).abs() < 2e-4, "{at:?}, {expected}");
    };
    near(fractured_at(&|_| 0.0), 0.4);
    near(fractured_at(&|_| 1e6), 0.1);
    near(fractured_at(&|turned| if turned < 0.2 { 0.0 } else { 1e6 }), 0.25);
    // turned by 0.01 under the heavy force: 0.1 of damage, 0.9 of it under the light one
    near(fractured_at(&|turned| if (0.2..0.21).contains(&turned) { 1e6 } else { 0.0 }), 0.9 * 0.4 + 0.01);
}

#[test]
fn equal_axes_flow_along_the_trial_moment() {
    let table = CapacityTable::new(&curve(&[[0.0, 100e3], [1.0, 100e3]], 2.0), 1.0).unwrap();
    let mut state = Hinge2::default();
    state.step([AxisLaw::Plastic(&table); 2], [0.03, 0.04], 0.0);
    assert!((state.moment_nm[0] - 60e3).abs() < 1e-6 && (state.moment_nm[1] - 80e3).abs() < 1e-6);
    assert!((state.alpha_rad - (0.05 - 100e3 / 2e7)).abs() < 1e-12);
}

#[test]
fn softening_faster_than_unloading_falls_to_the_next_admissible_point() {
    // The capacity drops by 90 kN m within 1e-3 rad; elastic unloading gives back only 20 kN m per 1e-3 rad.
    let table =
        CapacityTable::new(&curve(&[[0.0, 100e3], [0.01, 100e3], [0.011, 10e3], [1.0, 10e3]], 2.0), 1.0)
            .unwrap();
    let mut state = Hinge2::default();
    let mut last = 0.0;
    for i in 0..=3000 {
        state.step(
            [AxisLaw::Plastic(&table), AxisLaw::Elastic(0.0)],
            [0.02 * f64::from(i) / 3000.0, 0.0],
            0.0,
        );
        let c = table.capacity(state.alpha_rad, 0.0, &mut CapacityHint::default()).moment_nm;
        assert!(state.moment_nm[0] <= c * (1.0 + 1e-9), "{} above {c}", state.moment_nm[0]);
        last = state.moment_nm[0];
    }
    assert!((last - 10e3).abs() < 1e-3);
}

#[test]
fn envelopes_give_back_their_moments() {
    let envelope = |n: f64, peak: f64, k: f64| Envelope {
        axial_force_n: n,
        points: vec![
            [0.0, 0.0],
            [0.5 * peak / k, 0.5 * peak],
            [1.6 * peak / k, peak],
            [0.03, 0.9 * peak],
            [0.08, 0.2 * peak],
            [0.12, 0.0],
        ],
    };
    let curve =
        ResistanceCurve::from_envelopes(&[envelope(0.0, 80e3, 1e7), envelope(5e5, 130e3, 2e7)]).unwrap();
    assert!((curve.stiffness_nm_rad - 2e7).abs() < 1.0);
    for (n, peak) in [(0.0, 80e3), (5e5, 130e3)] {
        let table = CapacityTable::new(&curve, 1.0).unwrap();
        let mut state = Hinge2::default();
        for i in 1..=8000 {
            state.step([AxisLaw::Plastic(&table), AxisLaw::Elastic(0.0)], [1e-5 * f64::from(i), 0.0], n);
            if i == 3000 {
                assert!(
                    (state.moment_nm[0] - 0.9 * peak).abs() < 1e-6 * peak,
                    "N = {n}: {}",
                    state.moment_nm[0]
                );
            }
        }
        assert!((state.moment_nm[0] - 0.2 * peak).abs() < 1e-6 * peak);
    }
    // 5 % of the peak lies a quarter of the way before the end of the last branch.
    let plastic = curve.levels[0].fracture_rotation_rad;
    assert!((plastic - (0.08 + 0.04 * 0.75 - 0.05 * 80e3 / 2e7)).abs() < 1e-9, "{plastic}");
    assert!(
        ResistanceCurve::from_envelopes(&[Envelope { axial_force_n: 0.0, points: vec![[0.0, 0.0]] }])
            .is_err()
    );
}

#[test]
fn interpolation_in_axial_force_is_exact_between_levels_of_different_break_points() {
    let level = |n, c: [[f64; 2]; 3]| CapacityLevel {
        axial_force_n: n,
        capacity: c.to_vec(),
        fracture_rotation_rad: 0.1,
    };
    let curve = ResistanceCurve {
        stiffness_nm_rad: 1e7,
        levels: vec![
            level(0.0, [[0.0, 10.0], [0.02, 20.0], [0.1, 0.0]]),
            level(100.0, [[0.0, 30.0], [0.05, 40.0], [0.08, 0.0]]),
        ],
        cyclic: None,
    };
    let table = CapacityTable::new(&curve, 2.0).unwrap();
    let mut hint = CapacityHint::default();
    let c = table.capacity(0.03, 25.0, &mut hint);
    assert!((c.moment_nm - 2.0 * (0.75 * 17.5 + 0.25 * 36.0)).abs() < 1e-9 && !c.out_of_range);
    assert!((c.slope_nm_rad - 2.0 * (0.75 * -250.0 + 0.25 * 200.0)).abs() < 1e-6);
    assert!(table.capacity(0.03, -1.0, &mut hint).out_of_range);
}

/// A column of 3.5 m on a hinge at its foot, released at 0.2 rad.
fn topple(plastic_moment: f64, end_s: f64, step_s: Option<f64>) -> fallwerk::mbs::RunResult {
    let mut m = model("topple", end_s, 1e-3);
    let mut column = solid("column", [1.75 * 0.2_f64.sin(), 0.0, 1.75 * 0.2_f64.cos()], [0.4, 0.4, 3.5]);
    column.orientation = [0.1_f64.cos(), 0.0, 0.1_f64.sin(), 0.0];
    m.bodies.push(column);
    m.curves.insert("foot".into(), curve(&[[0.0, plastic_moment], [10.0, plastic_moment]], 10.0));
    m.bushings.push(joint("foot", None, "column", [0.0; 3], 1e10, 1e7, [elastic(2e7), hinge("foot")]));
    m.settings.time_step_s = step_s;
    simulate(&m).unwrap()
}

#[test]
fn toppling_column_reaches_the_ground_at_the_closed_form_speed() {
    for (step, tolerance) in [(None, 2e-5), (Some(1e-4), 5e-6)] {
        let result = topple(3e3, 1.85, step);
        let angle: Vec<f64> = result.hinges[0].rotation_rad.iter().map(|r| r[1] + 0.2).collect();
        let (time, speed) = crossing(&result.times_s, &angle, std::f64::consts::FRAC_PI_2);
        println!(
            "topple A: step {:.4} ms, speed {speed:.7} (exact 2.6038745), time {time:.7} (exact 1.8097588), energy error {:.1e}",
            1e3 * result.time_step_s,
            result.energy_error
        );
        assert!((speed / 2.603874529595256 - 1.0).abs() < tolerance);
        assert!((time / 1.80975871 - 1.0).abs() < tolerance);
    }
}

#[test]
fn strong_column_only_vibrates() {
    let result = topple(60e3, 0.5, None);
    let largest = result.hinges[0].rotation_rad.iter().map(|r| r[1]).fold(0.0, f64::max);
    println!("topple C: {largest:.6e} (exact 4.780548e-4)");
    assert!((largest / 4.780548e-4 - 1.0).abs() < 1e-3);
    assert_eq!(result.energies.plastic_j.last(), Some(&0.0));
}

/// A heavy body on a plastic hinge of a rectangular section falls over: as the section turns by `dθ` it shortens by `n h / 2 dθ` (normality to `M = M_p (1 - n²)`), and the energies add up as without.
#[test]
fn a_hinge_that_turns_under_compression_shortens_its_member() {
    let (squash_n, depth_m) = (1e6, 0.4);
    let level = |k: i32| {
        let share = f64::from(k) / 10.0;
        let moment = 0.25 * squash_n * depth_m * (1.0 - share * share);
        let capacity = vec![[0.0, moment], [1.0, moment]];
        CapacityLevel { axial_force_n: share * squash_n, capacity, fracture_rotation_rad: 5.0 }
    };
    let mut m = model("column", 1.0, 1e-3);
    let levels = (-9..=9).map(level).collect();
    m.curves.insert("c".into(), ResistanceCurve { stiffness_nm_rad: 5e7, levels, cyclic: None });
    let body = solid("body", [0.5, 0.0, 4.0], [2.0; 3]);
    m.bodies.push(body);
    m.bodies[0].mass_kg *= 2.0;
    let mut foot = joint("foot", None, "body", [0.0; 3], 1e9, 5e8, [hinge("c"), hinge("c")]);
    foot.axes = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    m.bushings.push(foot);
    track(&mut m, "body", [0.0; 3]);
    m.settings.time_step_s = Some(1e-4);
    let stiff = simulate(&m).unwrap();
    m.bushings[0].associated_flow = true;
    let result = simulate(&m).unwrap();
    let hinge = &result.hinges[0];
    let plastic = &hinge.plastic_rotation_rad;
    let axis_m = |i: usize| 0.5 * depth_m * hinge.axial_force_n[i] / squash_n;
    let flow: f64 =
        (1..plastic.len()).map(|i| 0.5 * (axis_m(i) + axis_m(i - 1)) * (plastic[i] - plastic[i - 1])).sum();
    let elastic = hinge.axial_force_n.last().unwrap() / 1e9;
    let shorter = -result.tracked[0].displacement_m.last().unwrap()[2] - elastic;
    assert!(flow > 5e-3 && (shorter / flow - 1.0).abs() < 0.01, "{shorter} {flow}");
    let rigid = -stiff.tracked[0].displacement_m.last().unwrap()[2];
    assert!(rigid < 1e-3, "{rigid}");
    assert!(result.energy_error < 2.0 * stiff.energy_error, "{} {}", result.energy_error, stiff.energy_error);
}

/// Below the balance point a section bears more under more compression, and by normality gets longer as it turns. Once it has softened it does so less: what it takes is never given back.
#[test]
fn a_softened_hinge_that_lengthens_its_member_dissipates() {
    let level = |axial_force_n: f64, peak: f64| CapacityLevel {
        axial_force_n,
        capacity: vec![[0.0, peak], [0.2, 0.01 * peak], [2.0, 0.01 * peak]],
        fracture_rotation_rad: 5.0,
    };
    let mut m = model("softening", 1.0, 1e-3);
    let levels = vec![level(0.0, 1e5), level(1e6, 2e5)];
    m.curves.insert("c".into(), ResistanceCurve { stiffness_nm_rad: 5e7, levels, cyclic: None });
    m.bodies.push(solid("body", [1.0, 0.0, 4.0], [2.0; 3]));
    m.bodies[0].mass_kg *= 2.0;
    let mut foot = joint("foot", None, "body", [0.0; 3], 1e9, 5e8, [hinge("c"), hinge("c")]);
    foot.axes = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    foot.associated_flow = true;
    m.bushings.push(foot);
    m.settings.time_step_s = Some(1e-4);
    let result = simulate(&m).unwrap();
    let plastic = &result.energies.plastic_j;
    let turned = result.hinges[0].plastic_rotation_rad.last().unwrap();
    let back = plastic.windows(2).map(|w| w[0] - w[1]).fold(0.0, f64::max);
    assert!(*turned > 0.22 && back < 1e-6 * plastic.last().unwrap(), "{turned} rad, {back} J back");
}

/// A block of 40 t on a column whose foot turns by 0.1 rad: what the column still bears is less than the block weighs from 0.05 rad on.
#[test]
fn a_column_that_has_turned_bears_less() {
    let (mass, inertia, stiff) = (40e3, 40e3 / 6.0, 2e9);
    let weight = mass * G;
    let (moment, speed, capacity) = (inertia / 0.2, 1.0, 1.6 * weight);
    let left = |turned: f64| if turned < 0.1 { 1.0 - 7.5 * turned } else { 0.25 };
    let mut m = model("fading", 0.5, 0.001);
    m.settings.time_step_s = Some(5e-5);
    m.settings.preload = true;
    let law = ResistanceCurve { stiffness_nm_rad: 2e9, ..curve(&[[0.0, moment], [1.0, moment]], 1.0) };
    m.curves.insert("foot".into(), law);
    let block = solid("block", [0.0, 0.0, 1.0], [1.0; 3]);
    m.bodies.push(Body {
        mass_kg: mass,
        inertia_kg_m2: box_inertia(mass, [1.0; 3]),
        angular_velocity_rad_s: [speed, 0.0, 0.0],
        ..block
    });
    // on the centre of the block, so that turning does not lower it
    m.bushings.push(Bushing {
        compressive_capacity_n: Some(capacity),
        compressive_fading: vec![[0.0, 1.0], [0.1, 0.25]],
        ..joint("column", None, "block", [0.0, 0.0, 1.0], stiff, 1e9, [hinge("foot"), elastic(1e8)])
    });
    track(&mut m, "block", [0.0, 0.0, 1.0]);
    let result = simulate(&m).unwrap();
    let turned = *result.hinges[0].plastic_rotation_rad.last().unwrap();
    assert!((turned - 0.5 * inertia * speed * speed / moment).abs() < 1e-3, "{turned}");
    // along the axis that turns with the block: m (s'' - s ω²) = m g cos θ - capacity left, once that is less
    let (mut short, mut fall, mut borne_j) = (0.0, 0.0, 0.0);
    let step = 1e-5;
    for i in 0..50_000 {
        let time = (step * (f64::from(i) + 0.5)).min(0.2);
        let (angle, rate) = (speed * time - 2.5 * speed * time * time, speed * (1.0 - 5.0 * time));
        let pressing = G * angle.cos() + short * rate * rate;
        let bears = (capacity * left(angle)).min(mass * pressing);
        fall += step * (pressing - bears / mass);
        short += step * fall;
        borne_j += bears * step * fall;
    }
    let sunk = short * turned.cos();
    let found = -result.tracked[0].displacement_m.last().unwrap()[2];
    println!("{found:.5} m ({sunk:.5}), {turned:.5} rad");
    assert!((found / sunk - 1.0).abs() < 5e-3, "{found} {sunk}");
    let plastic_j = result.energies.plastic_j.last().unwrap();
    let bent_j = moment * turned;
    assert!(((plastic_j - bent_j) / borne_j - 1.0).abs() < 5e-3, "{plastic_j} {bent_j} {borne_j}");
    assert!(result.energy_error < 1e-4, "{}", result.energy_error);

    type Change = fn(&mut Bushing);
    let wrong: [Change; 6] = [
        |b| b.compressive_fading[0][1] = 0.9,
        |b| b.compressive_fading[0][0] = 0.01,
        |b| b.compressive_fading[1][1] = 1.1,
        |b| b.compressive_fading[1][1] = 0.0,
        |b| b.compressive_capacity_n = None,
        |b| b.bending[0] = elastic(1e8),
    ];
    for change in wrong {
        let mut m = m.clone();
        change(&mut m.bushings[0]);
        let said = m.check().unwrap_err().to_string();
        assert!(said.starts_with("bushings[0].compressive_fading: "), "{said}");
    }
}
