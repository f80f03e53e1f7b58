//! The critical time step: margin of the element bound, mass scaling.

use super::mesh::{Single, bilinear, distort, elastic, grid, hexahedron, in_lanes};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::{Dynamics, most_step_safety};
use fallwerk::fe::hexahedron::volume_m3;
use fallwerk::fe::kernel::{KernelStep, LANES, update_block};
use fallwerk::fe::mass_scaling::{MOST_ADDED, MassScalingError, scale_mass};
use fallwerk::fe::mesh::{Mesh, Truss};
use nalgebra::{DMatrix, Rotation3, Vector3};

type Nodes = [[f64; 3]; 8];

const STATIC: KernelStep = KernelStep { dt_s: 1.0, viscous: false };

/// Stiffness by unit displacements, hourglass control included, and the kernel's bound \[1/s²\].
fn stiffness(nodes: &Nodes, one: &Single) -> (DMatrix<f64>, f64) {
    const UNIT_M: f64 = 1e-9;
    let mut matrix = DMatrix::zeros(24, 24);
    let mut bound = 0.0;
    for column in 0..24 {
        let mut du = [[0.0; LANES]; 24];
        du[column] = [UNIT_M; LANES];
        let (mut state, mut force) = (one.state, [[0.0; LANES]; 24]);
        bound =
            update_block(&in_lanes(nodes), &du, &one.material, &one.table, &mut state, &mut force, STATIC)[0];
        for row in 0..24 {
            matrix[(row, column)] = force[row][0] / UNIT_M;
        }
    }
    (0.5 * (&matrix + matrix.transpose()), bound)
}

/// Largest possible over allowed time step of a single element: `sqrt(bound / ω²)`, at least 1 if the bound is safe.
fn margin(nodes: &Nodes, poisson: f64) -> f64 {
    let mass = 2500.0 * volume_m3(nodes);
    let one = Single::new(&bilinear(30e9, poisson, 2500.0, 1e15, 0.0), mass);
    let (matrix, bound) = stiffness(nodes, &one);
    let square = matrix.symmetric_eigenvalues().max() / (mass / 8.0);
    (bound / square).sqrt()
}

fn mapped(nodes: Nodes, map: impl Fn([f64; 3]) -> [f64; 3]) -> Nodes {
    nodes.map(map)
}

fn turned(nodes: Nodes, axis: [f64; 3], angle: f64) -> Nodes {
    let rotation = Rotation3::from_scaled_axis(Vector3::from(axis).normalize() * angle);
    mapped(nodes, |p| (rotation * Vector3::from(p)).into())
}

const ASPECTS: [f64; 7] = [1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0];
const POISSON: [f64; 5] = [0.0, 0.2, 0.3, 0.4, 0.45];

/// Families of shapes: name, shapes.
fn families() -> Vec<(&'static str, Vec<Nodes>)> {
    let cube = hexahedron(0.0, 0);
    let bricks: Vec<Nodes> = ASPECTS
        .iter()
        .flat_map(|a| ASPECTS.iter().map(move |b| mapped(cube, |p| [p[0], a * p[1], b * p[2]])))
        .collect();
    let axes: [[f64; 3]; 4] = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 2.0, 3.0], [-1.0, 1.0, 1.0]];
    let turns: Vec<Nodes> = bricks
        .iter()
        .flat_map(|b| axes.iter().flat_map(move |axis| [0.4, 0.8, 1.2].map(|angle| turned(*b, *axis, angle))))
        .collect();
    let mut skewed = Vec::new();
    let mut tapered = Vec::new();
    for brick in &bricks {
        for amount in [0.25, 0.5, 1.0] {
            skewed.push(mapped(*brick, |p| [p[0] + amount * p[2], p[1], p[2]]));
            skewed.push(mapped(*brick, |p| [p[0] + amount * p[1], p[1] + 0.5 * amount * p[2], p[2]]));
        }
        let height = brick[4][2];
        for amount in [0.3, 0.6, 0.8] {
            let factor = |p: [f64; 3]| 1.0 - amount * p[2] / height;
            tapered.push(mapped(*brick, |p| [factor(p) * p[0], p[1], p[2]]));
            tapered.push(mapped(*brick, |p| [factor(p) * p[0], factor(p) * p[1], p[2]]));
        }
    }
    let random = (0..400)
        .map(|seed| {
            let stretch = [1.0, ASPECTS[seed % 7], ASPECTS[seed / 7 % 7]];
            let amount = [0.1, 0.2, 0.28][seed % 3];
            mapped(hexahedron(amount, seed as u64), |p| std::array::from_fn(|i| p[i] * stretch[i]))
        })
        .collect();
    vec![
        ("bricks along the axes", bricks),
        ("bricks turned", turns),
        ("skewed", skewed),
        ("tapered", tapered),
        ("corners moved at random", random),
    ]
}

/// The bound is never below the true frequency, and loses little; the table of `docs/fe-time-step.md` (shown with `--nocapture`).
#[test]
fn bound_is_safe_for_all_shapes() {
    for (name, shapes) in families() {
        for poisson in POISSON {
            let margins: Vec<f64> =
                shapes.iter().filter(|s| volume_m3(s) > 0.0).map(|s| margin(s, poisson)).collect();
            let least = margins.iter().copied().fold(f64::INFINITY, f64::min);
            let most = margins.iter().copied().fold(0.0, f64::max);
            let mean = margins.iter().sum::<f64>() / margins.len() as f64;
            println!("| {name} | {poisson} | {} | {least:.4} | {mean:.3} | {most:.3} |", margins.len());
            assert!(least > 1.0 - 1e-5, "{name}, Poisson {poisson}: {least}");
            assert!(most < 1.25, "{name}, Poisson {poisson}: {most}");
        }
    }
}

/// Largest squared frequency of a mesh \[1/s²\] by power iteration with its own kernel.
fn true_frequency(mesh: &Mesh) -> f64 {
    let body = Dynamics::new(mesh, 0.0, RigidSurfaces::default(), false);
    let fresh = body.clone();
    let mut field: Vec<[f64; 3]> = vec![[0.0; 3]; mesh.nodes.len()];
    distort(&mut field, 1.0, 3, |_| true);
    let mut square = 0.0;
    for _ in 0..600 {
        let mut trial = fresh.clone();
        let size = field.as_flattened().iter().map(|c| c * c).sum::<f64>().sqrt();
        for (v, u) in trial.v.iter_mut().zip(&field) {
            *v = u.map(|c| 1e-9 * c / size);
        }
        trial.update_elements(STATIC, 1.0);
        let (mut above, mut below) = (0.0, 0.0);
        for n in 0..mesh.nodes.len() {
            for i in 0..3 {
                let (u, f) = (trial.v[n][i], trial.internal_n(n)[i]);
                above += u * f;
                below += u * u * trial.mass_kg[n];
                field[n][i] = f / trial.mass_kg[n];
            }
        }
        square = above / below;
    }
    square
}

#[test]
fn assembled_meshes_allow_at_least_the_step_of_their_elements() {
    let shapes: [(&str, [f64; 3], f64); 4] = [
        ("cubes", [1.0, 1.0, 1.0], 0.0),
        ("1 : 2 : 5", [1.0, 2.0, 5.0], 0.0),
        ("1 : 10 : 10", [1.0, 10.0, 10.0], 0.0),
        ("cubes, corners moved", [1.0, 1.0, 1.0], 0.15),
    ];
    for (name, size, amount) in shapes {
        let counts = [5, 5, 5];
        let mut mesh = grid(counts, size.map(|s| 5.0 * s), elastic(), |_| false);
        distort(&mut mesh.nodes, amount, 9, |_| true);
        let body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        let bound = body.blocks.blocks.iter().map(|b| b.largest_bound).fold(0.0, f64::max);
        let margin = (bound / true_frequency(&mesh)).sqrt();
        println!("| 5 x 5 x 5 {name} | {margin:.3} |");
        assert!(margin > 0.999 && margin < 1.6, "{name}: {margin}");
    }
}

/// A bar of cubes with one slice an eighth as thick: only that slice gets mass, and the step is the wished one.
#[test]
fn mass_scaling_is_selective_and_limited() {
    let mut mesh = grid([8, 2, 2], [8.0, 2.0, 2.0], elastic(), |_| false);
    for node in &mut mesh.nodes {
        node[0] = if node[0] > 4.5 { node[0] - 0.875 } else { node[0] };
    }
    mesh.parts.push("slice".into());
    for e in 0..mesh.elements.len() {
        mesh.elements[e].part = usize::from((4.0..4.2).contains(&mesh.center(e)[0]));
    }
    let fresh = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false);
    let cube = grid([2, 2, 2], [2.0; 3], elastic(), |_| false);
    let whole = Dynamics::new(&cube, 9.81, RigidSurfaces::default(), false).dt_s;
    let wished = 0.25 * whole;
    let mut body = fresh.clone();
    let report = scale_mass(&mesh, &mut body, wished, MOST_ADDED).unwrap();
    assert!(
        (body.dt_s / wished - 1.0).abs() < 1e-9 && body.first_dt_s == body.dt_s,
        "{} {wished}",
        body.dt_s
    );
    assert_eq!((report.elements, report.parts.len(), report.parts[0].part.as_str()), (4, 1, "slice"));
    let slice_kg = 4.0 * 2500.0 / 8.0;
    let expected = slice_kg * ((wished / fresh.dt_s).powi(2) - 1.0);
    assert!((report.added_kg / expected - 1.0).abs() < 1e-9 && report.parts[0].added_kg == report.added_kg);
    assert!((report.parts[0].added_share * slice_kg / expected - 1.0).abs() < 1e-9);
    let (before, after): (f64, f64) = (fresh.mass_kg.iter().sum(), body.mass_kg.iter().sum());
    assert!((after - before - expected).abs() < 1e-6 * expected);
    for n in 0..mesh.nodes.len() {
        let near = (3.9..4.2).contains(&mesh.nodes[n][0]);
        assert_eq!(body.mass_kg[n] > fresh.mass_kg[n] * (1.0 + 1e-12), near, "node {n}");
    }
    let mut body = fresh.clone();
    let error = scale_mass(&mesh, &mut body, whole, MOST_ADDED).unwrap_err();
    let MassScalingError::TooMuch { percent, allowed_s, ref part, .. } = error else { panic!("{error}") };
    assert!(percent > 5.0 && allowed_s < whole && allowed_s > fresh.dt_s && part == "slice", "{error}");
    assert_eq!(body.mass_kg, fresh.mass_kg);
    assert!(scale_mass(&mesh, &mut body, 0.9999 * allowed_s, MOST_ADDED).is_ok());
    let mut forced = fresh.clone();
    let report = scale_mass(&mesh, &mut forced, whole, f64::INFINITY).unwrap();
    assert!((100.0 * report.added_share - percent).abs() < 1e-9);
    let mut same = fresh.clone();
    let report = scale_mass(&mesh, &mut same, 0.9 * fresh.dt_s, MOST_ADDED).unwrap();
    assert_eq!((report.elements, report.added_kg, same.mass_kg == fresh.mass_kg), (0, 0.0, true));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(scale_mass(&mesh, &mut same, bad, f64::INFINITY), Err(MassScalingError::Step(_))));
    }
}

/// Largest deviation from uniform compression over the deviation at its start, for a block whose outer nodes close in with the volume rate
/// `rate` (over the largest frequency) until a fifth of the volume is left.
fn squeezed(rate: f64, share: f64) -> f64 {
    let mesh = grid([8; 3], [8.0; 3], elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let bound = body.blocks.blocks.iter().map(|b| b.largest_bound).fold(0.0, f64::max);
    let rate_1_s = rate * bound.sqrt() / 3.0;
    body.set_step_safety(share);
    body.failure.step_collapse = 0.0;
    let mut noise = vec![[0.0; 3]; mesh.nodes.len()];
    distort(&mut noise, 1e-4, 5, |_| true);
    let uniform: Vec<[f64; 3]> = mesh.nodes.iter().map(|p| p.map(|c| -rate_1_s * (c - 4.0))).collect();
    for (n, p) in mesh.nodes.iter().enumerate() {
        body.v[n] = uniform[n];
        if p.iter().any(|c| *c == 0.0 || *c == 8.0) {
            body.prescribed_m_s[n] = uniform[n].map(Some);
        } else {
            (0..3).for_each(|i| body.v[n][i] += rate_1_s * noise[n][i]);
        }
    }
    let mut most: f64 = 0.0;
    while (1.0 - rate_1_s * body.time_s).powi(3) > 0.2 {
        body.step(false);
        for (v, u) in body.v.as_flattened().iter().zip(uniform.as_flattened()) {
            most = most.max((v - u).abs() / rate_1_s);
        }
    }
    most / 1e-4
}

/// The quadratic bulk viscosity is in the step: without it, at 0.9 of the limit, the deviation grows to 50 times its start when the volume shrinks
/// at a tenth of the largest frequency, and to 2.7 times at a twentieth.
#[test]
fn fast_compression_is_stable() {
    for rate in [0.005, 0.02, 0.05, 0.1, 0.15] {
        let grown = squeezed(rate, 0.9);
        println!("| {rate} | {grown:.2} |");
        assert!(grown < 2.0, "{rate}: {grown}");
    }
}

/// Poisson's ratio of a bar, which has no volume to be viscous, and of a law without elements does not shorten the step: with ν = 0.2 a share of 0.93 is stable, with 0 one of 0.88.
#[test]
fn only_elements_bound_the_share_of_the_limit() {
    let mut mesh = grid([1, 1, 1], [0.4; 3], elastic(), |_| false);
    let alone = most_step_safety(&mesh);
    assert!((alone - 0.93258).abs() < 1e-4, "{alone}");
    mesh.laws.push(bilinear(200e9, 0.0, 7850.0, 1e15, 0.0));
    let nodes = [0, 6];
    mesh.trusses.push(Truss { nodes, area_m2: 1e-4, part: 0, law: 1 });
    assert_eq!(most_step_safety(&mesh), alone);
    mesh.elements[0].law = 1;
    assert!(most_step_safety(&mesh) < 0.89);
}

/// Single cubes that breathe, which bulk viscosity damps by more than a plane wave, also of laws with a negative Poisson's ratio: the longest steps that are taken are stable.
#[test]
fn single_cubes_breathe_in_stable_steps() {
    for poisson in [-0.5, -0.2, -0.05, 0.0, 0.05, 0.2, 0.3] {
        let mesh = grid([1, 1, 1], [0.4; 3], bilinear(30e9, poisson, 2500.0, 1e15, 0.0), |_| false);
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        body.set_step_safety(most_step_safety(&mesh));
        for (n, x) in mesh.nodes.iter().enumerate() {
            let uneven = 0.01 * (n as f64 + 1.0).sin();
            body.v[n] = std::array::from_fn(|i| x[i] - 0.2 + uneven * (i as f64 + 1.0).cos());
        }
        for _ in 0..3000 {
            body.step(false);
        }
        let fastest = body.v.iter().flatten().map(|v| v.abs()).fold(0.0, f64::max);
        assert!(fastest < 0.4, "ν = {poisson}: {fastest} m/s of 0.2 m/s");
    }
}
