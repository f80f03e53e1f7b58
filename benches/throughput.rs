//! Throughput of the two solvers, timed with nothing but the standard library: `cargo bench`.
//!
//! What is measured, and what is not, stands in `benches/README.md`.

use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::law::{Erosion, Law};
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::shapes::{elastic, grid, point};
use fallwerk::mbs::model::*;
use fallwerk::mbs::simulate;
use std::time::Instant;

/// Repetitions of each case; the fastest and the middle one are printed.
const REPETITIONS: usize = 5;

fn main() {
    println!("{:44} {:>12} {:>12}", "case", "fastest", "median");
    let threads = rayon::current_num_threads();
    for (name, top_m_s, parallel) in [
        ("FE block, elastic, one thread", 0.0, false),
        ("FE block, flowing, one thread", -2.0, false),
        ("FE block, flowing, all threads", -2.0, true),
    ] {
        let name = if parallel { format!("{name} ({threads})") } else { name.to_string() };
        line(&name, "M element-cycles/s", 1e-6, || fe_block(20, top_m_s, 100, parallel));
    }
    for storeys in [3, 12] {
        line(&format!("MBS frame, {} bodies", 5 * storeys), "k steps/s", 1e-3, || mbs_frame(storeys));
    }
}

/// Times a case, which returns its rate \[1/s\].
fn line(name: &str, unit: &str, scale: f64, case: impl Fn() -> f64) {
    case(); // caches, page faults, clock of the processor
    let mut rates: Vec<f64> = (0..REPETITIONS).map(|_| case()).collect();
    rates.sort_by(f64::total_cmp);
    let (fastest, median) = (scale * rates[REPETITIONS - 1], scale * rates[REPETITIONS / 2]);
    println!("{name:44} {fastest:12.2} {median:12.2}  {unit}");
}

/// Element-cycles per second of a cube of `n`³ elements, clamped below, its top moved at `top_m_s` (0: free under gravity).
fn fe_block(n: usize, top_m_s: f64, steps: usize, parallel: bool) -> f64 {
    let mesh = block(n, 0.4);
    let mut body = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), parallel);
    if top_m_s != 0.0 {
        for node in (0..mesh.nodes.len()).filter(|i| mesh.nodes[*i][2] > 0.4 * n as f64 - 1e-6) {
            body.prescribed_m_s[node] = [Some(0.0), Some(0.0), Some(top_m_s)];
        }
        advance(&mut body, steps);
    }
    let start = Instant::now();
    advance(&mut body, steps);
    let seconds = start.elapsed().as_secs_f64();
    assert!(body.broken_node().is_none() && body.deaths.is_empty(), "the block must stay whole");
    let flowed = (0..mesh.elements.len()).filter(|e| body.blocks.plastic_strain(*e) > 0.0).count();
    assert_eq!(flowed > mesh.elements.len() / 2, top_m_s != 0.0, "{flowed} elements have flowed");
    (mesh.elements.len() * steps) as f64 / seconds
}

fn advance(body: &mut Dynamics, steps: usize) {
    for _ in 0..steps {
        body.step(false);
    }
}

/// A cube of `n`³ elements of edge `h` \[m\], fixed at z = 0.
fn block(n: usize, h: f64) -> Mesh {
    let law = Law {
        hardening: vec![point(0.0, 10.5e6), point(0.01, 11.55e6), point(0.1, 12.25e6)],
        erosion: Erosion { plastic_strain: 0.5, ..Erosion::NEVER },
        youngs_modulus_pa: 16.5e9,
        ..elastic()
    };
    grid([n; 3], [h * n as f64; 3], law, |p| p[2] == 0.0)
}

/// Steps per second of a frame of slabs on four columns a storey, hinges at both ends of each, that sways freely after a push.
fn mbs_frame(storeys: usize) -> f64 {
    let mut model = Model {
        schema: MODEL_SCHEMA.into(),
        name: "frame".into(),
        gravity_m_s2: [0.0, 0.0, -9.81],
        bodies: Vec::new(),
        shared_masses: Vec::new(),
        curves: [("hinge".to_string(), hinge_curve())].into(),
        joints: Vec::new(),
        bushings: Vec::new(),
        forces: Vec::new(),
        contact: Contact {
            ground: Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: RESTITUTION }),
            bodies: Some(BodyContact { friction: 0.5, restitution: RESTITUTION }),
            ..Contact::default()
        },
        events: Vec::new(),
        event_rules: Vec::new(),
        tracked: Vec::new(),
        settings: RunSettings {
            end_time_s: 2.0,
            output_interval_s: 0.01,
            preload: true,
            time_step_s: Some(2e-4),
            tolerance: TOLERANCE,
            reactions: false,
            sleep_speed_m_s: None,
            relative_inertia_rad_s: None,
            soft_after_m: None,
        },
    };
    for storey in 0..storeys {
        let foot = 3.5 * storey as f64;
        let slab = format!("slab{storey}");
        model.bodies.push(solid(&slab, [3.0, 2.5, foot + 3.5], [6.4, 5.4, 0.25], 0.1 * storey as f64));
        for (x, y) in [(0.0, 0.0), (6.0, 0.0), (0.0, 5.0), (6.0, 5.0)] {
            let id = format!("column{storey}-{x}-{y}");
            let mut column = solid(&id, [x, y, foot + 1.75], [0.4, 0.4, 3.0], 0.0);
            column.shapes[0] = Shape::cuboid([0.0; 3], [0.2, 0.2, 1.4]);
            model.bodies.push(column);
            let below = storey.checked_sub(1).map(|s| format!("slab{s}"));
            model.bushings.push(joint(format!("{id}.bottom"), below, &id, [x, y, foot]));
            model.bushings.push(joint(format!("{id}.top"), Some(id), &slab, [x, y, foot + 3.5]));
        }
    }
    let start = Instant::now();
    let result = simulate(&model).expect("the frame stands");
    result.steps as f64 / start.elapsed().as_secs_f64()
}

fn solid(id: &str, center: [f64; 3], size: [f64; 3], velocity_x_m_s: f64) -> Body {
    let mass = 2500.0 * size[0] * size[1] * size[2];
    let s = size.map(|v| v * v * mass / 12.0);
    Body {
        id: id.into(),
        mass_kg: mass,
        inertia_kg_m2: [[s[1] + s[2], 0.0, 0.0], [0.0, s[0] + s[2], 0.0], [0.0, 0.0, s[0] + s[1]]],
        position_m: center,
        orientation: [1.0, 0.0, 0.0, 0.0],
        velocity_m_s: [velocity_x_m_s, 0.0, 0.0],
        angular_velocity_rad_s: [0.0; 3],
        shapes: vec![Shape::cuboid([0.0; 3], size.map(|v| 0.5 * v))],
        origin: Origin::default(),
    }
}

fn joint(id: String, a: Option<String>, b: &str, point_m: [f64; 3]) -> Bushing {
    let bending = serde_json::json!({ "kind": "curve", "curve": "hinge" });
    let joint = serde_json::json!({
        "id": id, "body_a": a, "body_b": b, "point_m": point_m,
        "axes": [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        "axial_stiffness_n_m": 1e9,
        "shear_stiffness_n_m": [4e8, 4e8],
        "torsional_stiffness_nm_rad": 2e7,
        "bending": [bending, bending],
    });
    serde_json::from_value(joint).expect("a joint as the model file writes it")
}

fn hinge_curve() -> ResistanceCurve {
    let level = |axial_force_n: f64, peak: f64| CapacityLevel {
        axial_force_n,
        capacity: vec![[0.0, peak], [0.1, peak], [0.4, 0.0]],
        fracture_rotation_rad: 0.4,
    };
    ResistanceCurve {
        stiffness_nm_rad: 8e7,
        levels: vec![level(0.0, 250e3), level(500e3, 290e3)],
        cyclic: None,
    }
}
