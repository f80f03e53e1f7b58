//! The collapsing frame with a reference converged by several engines, and the cost of a step.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::EventKind;
use fallwerk::mbs::simulate;

/// Storeys of slabs 0.25 m thick on columns 0.4 x 0.4 m; the ground columns at `y < remove_below` vanish at t = 0.
fn frame(rows: &[f64], slab: [f64; 3], translation: f64, end_s: f64, remove_below: f64) -> Model {
    let mut m = model("frame", end_s, 0.01);
    m.curves.insert("hinge".into(), frame_curve());
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    let middle = 0.5 * rows[rows.len() - 1];
    let mut removed = Vec::new();
    for storey in 1..=3_u8 {
        let z = 3.5 * f64::from(storey);
        m.bodies.push(solid(&format!("slab{storey}"), [3.0, middle, z], slab));
    }
    for storey in 1..=3_u8 {
        let top = 3.5 * f64::from(storey);
        for x in [0.0, 6.0] {
            for y in rows.iter().copied() {
                let id = format!("column{storey}_{x}_{y}");
                let mut column = solid(&id, [x, y, top - 1.75], [0.4, 0.4, 3.5]);
                column.shapes[0] = Shape::cuboid([0.0; 3], [0.2, 0.2, 1.55]);
                m.bodies.push(column);
                if storey == 1 && y < remove_below {
                    removed.push(id.clone());
                }
                let ends = [hinge("hinge"), hinge("hinge")];
                let below = (storey > 1).then(|| format!("slab{}", storey - 1));
                let foot = joint(
                    &format!("foot_{id}"),
                    below.as_deref(),
                    &id,
                    [x, y, top - 3.5],
                    translation,
                    2e7,
                    ends.clone(),
                );
                let slab = format!("slab{storey}");
                let head =
                    joint(&format!("head_{id}"), Some(&id), &slab, [x, y, top], translation, 2e7, ends);
                m.bushings.extend([foot, head]);
            }
        }
    }
    m.events.push(Event { remove_bodies: removed, ..Event::at("charge", 0.0) });
    track(&mut m, "slab3", [6.2, -0.2, 10.5]);
    m
}

pub fn frame4(translation: f64, end_s: f64) -> Model {
    frame(&[0.0, 5.0, 10.0], [6.4, 10.4, 0.25], translation, end_s, 6.0)
}

/// Roof corner (y, z) of the rigid-jointed frame, converged to 1e-6 m by MuJoCo RK4 and confirmed by four more engines.
const REFERENCE: [(f64, f64, f64); 15] = [
    (0.05, -0.200532, 10.482472),
    (0.10, -0.207435, 10.433794),
    (0.15, -0.230298, 10.361299),
    (0.20, -0.272024, 10.267429),
    (0.25, -0.325871, 10.147896),
    (0.30, -0.382943, 9.996369),
    (0.35, -0.441193, 9.811406),
    (0.40, -0.507113, 9.597291),
    (0.45, -0.587224, 9.357241),
    (0.50, -0.677113, 9.087965),
    (0.55, -0.763934, 8.783063),
    (0.60, -0.842556, 8.440795),
    (0.65, -0.921773, 8.065508),
    (0.70, -1.009198, 7.660852),
    (0.75, -1.097096, 7.223814),
];

#[test]
fn collapsing_frame_follows_the_reference_before_contact() {
    for (stiffness, tolerance) in [(1e9, 0.02), (1e10, 0.005)] {
        let mut m = frame4(stiffness, 2.0);
        // Rigid columns of the reference stop all storeys at once; here they crush at 40 MPa.
        m.bushings.iter_mut().for_each(|j| j.compressive_capacity_n = Some(6.4e6));
        let result = simulate(&m).unwrap();
        let mut worst = 0.0_f64;
        for (t, y, z) in REFERENCE {
            let u = result.tracked[0].displacement_m[(t / 0.01_f64).round() as usize];
            worst = worst.max((u[0].powi(2) + (u[1] - 0.2 - y).powi(2) + (u[2] + 10.5 - z).powi(2)).sqrt());
        }
        let fractures: Vec<f64> = result
            .events
            .iter()
            .filter(|e| matches!(e.kind, EventKind::Fracture { .. }))
            .map(|e| e.time_s)
            .collect();
        let end = result.tracked[0].displacement_m.last().unwrap();
        println!(
            "frame4, {stiffness:.0e} N/m: {:.2} mm before contact; first fracture {:.4} s (0.7615), {} joints; contact {:?} s (0.8012); end y {:.3}, z {:.4}; energy error {:.1e}; {} steps of {:.3} ms, {:.2} us a step",
            1e3 * worst,
            fractures[0],
            fractures.len(),
            result.first_ground_contact_s,
            end[1] - 0.2,
            end[2] + 10.5,
            result.energy_error,
            result.steps,
            1e3 * result.time_step_s,
            1e6 * result.cpu_s / result.steps as f64
        );
        // After the contact four engines with rigid joints lie within 4 cm of each other; joints of 1e9 N/m are too soft to compare.
        for (i, low, high) in [(100, 6.4336, 6.4701), (130, 5.7494, 5.7857), (150, 4.8895, 4.9094)] {
            let z = result.tracked[0].displacement_m[i][2] + 10.5;
            println!("    t = {:.1}: z = {z:.4} ({low} to {high})", 0.01 * i as f64);
            assert!(stiffness < 1e10 || z > low - 0.15 && z < high + 0.15);
        }
        assert!(worst < tolerance);
        assert!((fractures[0] - 0.7615).abs() < 2e-3);
        assert!((result.first_ground_contact_s.unwrap() - 0.8012).abs() < 3e-3);
        assert_eq!(fractures.len(), 28);
        assert!(stiffness < 1e10 || (-5.1..-4.4).contains(&(end[1] - 0.2)));
    }
}

#[test]
fn frame_on_its_middle_row_does_not_move() {
    let mut m = frame4(1e10, 1.0);
    m.events[0].remove_bodies.retain(|id| id.ends_with("_0"));
    let result = simulate(&m).unwrap();
    let moved = result.tracked[0].displacement_m.iter().flatten().fold(0.0_f64, |a, u| a.max(u.abs()));
    println!("frame2: moves by {:.3} mm (compliance of the joints)", 1e3 * moved);
    assert!(moved < 2e-3);
}

#[test]
fn a_run_of_thirteen_bodies_and_twenty_hinges_takes_few_steps() {
    let mut m = frame(&[0.0, 5.0], [6.4, 5.4, 0.25], 2.7e9, 2.5, 1.0);
    m.settings.preload = true;
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: RESTITUTION });
    let result = simulate(&m).unwrap();
    println!(
        "13 bodies, 20 hinges, 2.5 s: {:.2} ms, {} steps of {:.4} ms, {:.3} us a step, contact {:?} s, energy error {:.1e}",
        1e3 * result.cpu_s,
        result.steps,
        1e3 * result.time_step_s,
        1e6 * result.cpu_s / result.steps as f64,
        result.first_ground_contact_s,
        result.energy_error
    );
    assert!(result.energy_error < 0.05);
    // of the longest that its stiffness bears; what a step costs is for `benches/`
    assert!(result.steps < 4400, "{}", result.steps);
}

/// A frame that falls tells the same error of its energy whether it is recorded every hundredth of a second or at its end alone.
#[test]
fn the_energy_error_is_that_of_the_run_and_not_of_its_outputs() {
    let error = |interval_s: f64| {
        let mut m = frame4(1e9, 0.7);
        m.settings.time_step_s = Some(2e-4);
        m.settings.output_interval_s = interval_s;
        let result = simulate(&m).unwrap();
        assert_eq!(result.times_s.len(), (0.7 / interval_s).round() as usize + 1);
        result.energy_error
    };
    let (often, once) = (error(0.01), error(0.7));
    println!("{often:e} {once:e}");
    assert!(often > 1e-6 && (once / often - 1.0).abs() < 0.05, "{often:e} {once:e}");
}
