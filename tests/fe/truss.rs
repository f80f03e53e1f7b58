//! Bars: static truss, pendulum, wave, plastic elongation and rupture; bars inside hexahedra.

use super::mesh::{bilinear, elastic, grid, hexahedron, of_hexahedra, point};
use fallwerk::base::random::Random;
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::embed::embed;
use fallwerk::fe::kernel::KernelStep;
use fallwerk::fe::law::{Erosion, Law};
use fallwerk::fe::mass_scaling::scale_mass;
use fallwerk::fe::mesh::{Mesh, Tie, Truss};
use fallwerk::fe::model::{Control, Curve, DrivenNode, Model};
use fallwerk::fe::model_run::{ModelOptions, run_model};
use fallwerk::fe::preload::equilibrate;
use fallwerk::fe::watch::Books;

const STEEL_PA: f64 = 200e9;

fn steel() -> Law {
    bilinear(STEEL_PA, 0.3, 7850.0, 1e15, 0.0)
}

fn bars(nodes: Vec<[f64; 3]>, pairs: &[[usize; 2]], area_m2: f64, law: Law, fixed: Vec<usize>) -> Mesh {
    let trusses = pairs.iter().map(|nodes| Truss { nodes: *nodes, area_m2, part: 0, law: 0 }).collect();
    Mesh { nodes, trusses, laws: vec![law], fixed, parts: vec!["bars".into()], ..Mesh::default() }
}

/// Two bars at 30° to the horizontal carry a force at their apex: `N = P / (2 sin α)`, `w = P l / (2 E A sin² α)`.
#[test]
fn two_bar_truss() {
    let (length, area, load) = (2.0, 3e-4, 6e3);
    let (s, c) = (0.5, 0.75f64.sqrt());
    let nodes = vec![[-length * c, 0.0, 0.0], [length * c, 0.0, 0.0], [0.0, 0.0, length * s]];
    let mesh = bars(nodes, &[[0, 2], [1, 2]], area, steel(), vec![0, 1]);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    body.prescribed_m_s[2][1] = Some(0.0);
    body.applied_n[2][2] = -load;
    equilibrate(&mut body).expect("a truss stands");
    let sag = length * s - body.x[2][2];
    let expected = load * length / (2.0 * STEEL_PA * area * s * s);
    assert!((sag / expected - 1.0).abs() < 2e-3, "{sag} {expected}");
    for bar in &body.trusses.bars {
        assert!((bar.force_n() / (-load / (2.0 * s)) - 1.0).abs() < 2e-3, "{}", bar.force_n());
    }
    let work = 0.5 * load * expected;
    assert!((body.trusses.internal_j() / work - 1.0).abs() < 5e-3);
}

/// A heavy bar let go from the horizontal: half its mass is at the moving end, `v² = 2 g l` at the bottom, the force there `3 m g`.
#[test]
fn pendulum_bar() {
    let mesh = bars(vec![[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]], 1e-4, steel(), vec![0]);
    let mut body = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false);
    let mut kinetic = 0.0;
    while body.x[1][0] > 0.0 {
        kinetic = body.step(true);
        assert!(body.steps < 1_000_000);
    }
    let mass = body.mass_kg[1];
    let balance = kinetic + body.trusses.internal_j() - body.gravity_j;
    assert!(balance.abs() < 1e-4 * kinetic, "{balance} of {kinetic}");
    assert!((kinetic / (mass * 9.81) - 1.0).abs() < 1e-3, "{kinetic}");
    // T = 4 K(1/√2) sqrt(l/g) for a swing of 90°: a quarter of it down
    let quarter = 1.854_074_677 / 9.81f64.sqrt();
    assert!((body.time_s / quarter - 1.0).abs() < 1e-3, "{} {quarter}", body.time_s);
}

/// A step in velocity runs along a bar at `sqrt(E/ρ)` and leaves the stress `ρ c v`.
#[test]
fn wave_in_a_bar() {
    let count = 200;
    let nodes = (0..=count).map(|i| [0.01 * f64::from(i), 0.0, 0.0]).collect();
    let pairs: Vec<[usize; 2]> = (0..count as usize).map(|i| [i, i + 1]).collect();
    let mesh = bars(nodes, &pairs, 1e-4, steel(), Vec::new());
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let speed = 1.0;
    body.prescribed_m_s[0] = [Some(-speed), Some(0.0), Some(0.0)];
    while body.v[100][0] > -0.5 * speed {
        body.step(false);
        assert!(body.steps < 10_000);
    }
    let c = (STEEL_PA / 7850.0_f64).sqrt();
    let measured = 1.0 / body.time_s;
    assert!((measured / c - 1.0).abs() < 0.02, "{measured} {c}");
    let behind: f64 = body.trusses.bars[20..60].iter().map(|b| b.stress_pa).sum::<f64>() / 40.0;
    assert!((behind / (7850.0 * c * speed) - 1.0).abs() < 0.02, "{behind}");
}

/// Slow elongation to rupture: `W / V = ∫ σ_y dp + σ² / 2E`; the stress before rupture is that of the table.
#[test]
fn plastic_elongation_and_rupture() {
    let (yield_pa, modulus, critical) = (500e6, 1.5e9, 0.08);
    let law = Law {
        hardening: vec![point(0.0, yield_pa), point(1.0, yield_pa + modulus)],
        erosion: Erosion { plastic_strain: critical, ..Erosion::NEVER },
        ..steel()
    };
    let mesh = bars(vec![[0.0; 3], [2.0, 0.0, 0.0]], &[[0, 1]], 1e-4, law, vec![0]);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let step = KernelStep { dt_s: 1e-3, viscous: true };
    let mut before = body.trusses.bars[0];
    let mut ruptures = 0;
    for _ in 0..20_000 {
        // also turned about the fixed end while it is stretched
        let (length, angle) = (body.trusses.bars[0].length_m[1] + 1e-5, 1e-4 * f64::from(ruptures as u32));
        body.x[1] = [length * angle.cos(), length * angle.sin(), 0.0];
        let mut force = vec![[0.0; 3]; 2];
        body.trusses.update(&body.x, step, None, &mut force);
        ruptures += body.trusses.ruptured.len();
        if !body.trusses.bars[0].acts {
            assert_eq!(force, [[0.0; 3]; 2]);
            break;
        }
        before = body.trusses.bars[0];
        assert!((force[1][0] + before.force_n()).abs() < 1e-6 && force[0][0] == -force[1][0]);
    }
    assert_eq!(ruptures, 1);
    let last = yield_pa + modulus * critical;
    assert!((before.stress_pa / last - 1.0).abs() < 1e-4, "{}", before.stress_pa);
    let stretched = (before.length_m[1] / before.length_m[0]).ln();
    assert!((stretched / (critical + last / STEEL_PA) - 1.0).abs() < 1e-3, "{stretched}");
    let work =
        (yield_pa * critical + 0.5 * modulus * critical * critical + 0.5 * last * last / STEEL_PA) * 2e-4;
    let booked = body.trusses.internal_j();
    assert!((booked / work - 1.0).abs() < 1e-3, "{booked} {work}");
}

/// A run records the rupture of a bar with its time, part and strain, and counts it: of two bars pulled at 1 m/s one ruptures, at `t = l (exp ε - 1) / v`.
#[test]
fn a_rupture_is_an_event_of_the_run() {
    let mut mesh = grid([1, 1, 1], [0.2; 3], elastic(), |p| p[2] == 0.0);
    let first = mesh.nodes.len();
    mesh.nodes.extend([[2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 1.0, 0.0], [3.0, 1.0, 0.0]]);
    mesh.fixed.extend([first, first + 2]);
    let weak = Law { erosion: Erosion { principal_strain: 0.02, ..Erosion::NEVER }, ..steel() };
    mesh.parts.extend(["whole".to_string(), "weak".to_string()]);
    for (bar, law) in [steel(), weak].into_iter().enumerate() {
        let nodes = [first + 2 * bar, first + 2 * bar + 1];
        mesh.laws.push(law);
        mesh.trusses.push(Truss { nodes, area_m2: 1e-4, part: bar + 1, law: bar + 1 });
    }
    let driven =
        [first + 1, first + 3].map(|node| DrivenNode { node, axis: 0, velocity_m_s: Curve::constant(1.0) });
    let control = Control { end_time_s: 0.03, history_interval_s: 1e-3, ..Control::default() };
    let model = Model { mesh, driven: driven.to_vec(), control, ..Model::default() };
    let run =
        run_model(&model, &ModelOptions::default(), None, &mut |_| {}).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((run.ruptures.len(), run.summary.ruptured_bars, run.deaths.len()), (1, 1, 0));
    let expected_kg = 2500.0 * 0.008 + 2.0 * 7850.0 * 1e-4;
    assert!((run.summary.mass_kg / expected_kg - 1.0).abs() < 1e-12, "{}", run.summary.mass_kg);
    let rupture = run.ruptures[0];
    assert_eq!((rupture.bar, rupture.part, rupture.plastic_strain), (1, 2, 0.0));
    let step = run.summary.time_step_s;
    let expected = f64::exp(0.02) - 1.0;
    assert!((0.0..2.0 * step).contains(&(rupture.time_s - expected)), "{} {expected}", rupture.time_s);
    assert!((0.02..0.02 + 2.0 * step).contains(&rupture.strain), "{}", rupture.strain);
    // the force of the last step that never acts is in the books
    let last = run.energies.last().unwrap();
    let step_j = 0.5 * STEEL_PA * 0.02 * 1e-4 * step / f64::exp(0.02);
    assert!((0.8..1.3).contains(&(last.released_j / step_j)), "{} {step_j}", last.released_j);
    let largest = run.energies.iter().map(|e| e.residual_j.abs()).fold(0.0, f64::max);
    assert!(largest < 0.3 * last.released_j, "{largest} {}", last.released_j);
}

/// A bar whose ends are driven together ends where its step is a tenth of the first one: the step goes with its length. It was elastic up to there.
#[test]
fn a_bar_that_is_squeezed_flat_ends() {
    let mesh = bars(vec![[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]], 1e-4, steel(), vec![0]);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let speed = 50.0;
    body.v[1] = [-speed, 0.0, 0.0];
    body.prescribed_m_s[1] = [Some(-speed), Some(0.0), Some(0.0)];
    let (initial_j, mut kinetic_j) = (body.kinetic_j(), 0.0);
    while body.trusses.bars[0].acts {
        kinetic_j = body.step(true);
        assert!(body.steps < 1000);
    }
    assert_eq!(body.trusses.ruptured, [0]);
    // ω = 2 c / l, and the step is below 2 / ω by safety and damping
    let shortest = 0.1 * body.first_dt_s * (STEEL_PA / 7850.0_f64).sqrt();
    let length = body.trusses.bars[0].length_m[1];
    assert!(length < shortest && length > shortest - speed * body.dt_s, "{length} {shortest}");
    let expected = 0.5 * STEEL_PA * shortest.ln().powi(2) * 1e-4;
    let booked = body.trusses.internal_j();
    assert!((booked / expected - 1.0).abs() < 0.01, "{booked} {expected}");
    let books = Books::of(&body, kinetic_j, initial_j, 0.0);
    assert!(books.residual_j().abs() < 1e-3 * booked, "{books:?}");
}

/// A run of a deck with such a bar goes on, and tells.
#[test]
fn a_bar_that_is_squeezed_flat_is_noted() {
    let mut mesh = grid([1, 1, 1], [0.2; 3], elastic(), |p| p[2] == 0.0);
    let first = mesh.nodes.len();
    mesh.nodes.extend([[2.0, 0.0, 0.0], [2.3, 0.0, 0.0]]);
    mesh.fixed.push(first);
    mesh.parts.push("strut".to_string());
    mesh.laws.push(steel());
    mesh.trusses.push(Truss { nodes: [first, first + 1], area_m2: 1e-4, part: 1, law: 1 });
    let driven = vec![DrivenNode { node: first + 1, axis: 0, velocity_m_s: Curve::constant(-100.0) }];
    let control = Control { end_time_s: 4e-3, history_interval_s: 1e-3, ..Control::default() };
    let model = Model { mesh, driven, control, ..Model::default() };
    let run =
        run_model(&model, &ModelOptions::default(), None, &mut |_| {}).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((run.ruptures.len(), run.notes.len()), (1, 1));
    assert!(run.notes[0].contains("ruptured ones: 1, the first in part `strut`"), "{:?}", run.notes);
    // the end is driven at 100 m/s until less than 0.03 m of 0.3 m are left
    assert!((0.0027..0.003).contains(&run.ruptures[0].time_s), "{:?}", run.ruptures);
}

/// A cube with two bars, of which the short one asks for the step: it alone gets mass.
#[test]
fn mass_scaling_reaches_bars() {
    let mut mesh = grid([1, 1, 1], [1.0; 3], elastic(), |_| false);
    let first = mesh.nodes.len();
    mesh.nodes.extend([[3.0, 0.0, 0.0], [6.0, 0.0, 0.0], [6.05, 0.0, 0.0]]);
    mesh.parts.extend(["long".to_string(), "short".to_string()]);
    mesh.laws.push(steel());
    for bar in 0..2 {
        let nodes = [first + bar, first + bar + 1];
        mesh.trusses.push(Truss { nodes, area_m2: 1e-3, part: bar + 1, law: 1 });
    }
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let (before_s, before_kg) = (body.dt_s, body.mass_kg.clone());
    let scaling = scale_mass(&mesh, &mut body, 4.0 * before_s, 1.0).unwrap();
    assert!((body.dt_s / before_s - 4.0).abs() < 1e-9, "{} {before_s}", body.dt_s);
    let expected_kg = 15.0 * 7850.0 * 1e-3 * 0.05;
    assert!((scaling.added_kg / expected_kg - 1.0).abs() < 1e-9, "{scaling:?} {expected_kg}");
    assert_eq!((scaling.elements, scaling.parts.len(), &scaling.parts[0].part[..]), (1, 1, "short"));
    let gained: Vec<bool> = body.mass_kg.iter().zip(&before_kg).map(|(now, before)| now > before).collect();
    assert!(gained[first + 1] && gained[first + 2] && gained.iter().filter(|g| **g).count() == 2);
}

/// Unloading and loading again in the other direction is elastic until the grown yield stress.
#[test]
fn hardening_is_isotropic() {
    let law = Law { hardening: vec![point(0.0, 400e6), point(1.0, 2400e6)], ..steel() };
    let mesh = bars(vec![[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]], 1e-4, law, vec![0]);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let step = KernelStep { dt_s: 1.0, viscous: false };
    let mut to = |strain: f64| {
        body.x[1][0] = f64::exp(strain);
        body.trusses.update(&body.x, step, None, &mut [[0.0; 3]; 2]);
        body.trusses.bars[0]
    };
    let peak = to(0.02);
    let expected = (400e6 + 2e9 * 0.02) / (1.0 + 2e9 / STEEL_PA);
    assert!((peak.stress_pa / expected - 1.0).abs() < 1e-12, "{} {expected}", peak.stress_pa);
    let back = to(0.02 - 1.9 * expected / STEEL_PA);
    assert_eq!(back.plastic_strain, peak.plastic_strain);
    assert!((back.stress_pa + 0.9 * expected).abs() < 1.0);
    let reversed = to(0.0);
    assert!(reversed.plastic_strain > peak.plastic_strain && reversed.stress_pa < -expected);
}

/// Ties of all nodes of bars, in the order of the nodes.
fn embed_bars(mesh: &Mesh) -> Vec<Tie> {
    let mut nodes: Vec<usize> = mesh.trusses.iter().flat_map(|t| t.nodes).collect();
    nodes.sort_unstable();
    nodes.dedup();
    embed(mesh, &nodes).expect("all inside")
}

/// Nodes at known places in irregular elements come back with weights that give their position.
#[test]
fn bars_are_tied_to_the_elements_that_hold_them() {
    let mut mesh = grid([3, 3, 3], [1.0; 3], elastic(), |_| false);
    super::mesh::distort(&mut mesh.nodes, 0.06, 9, |p| p.iter().all(|c| *c > 0.01 && *c < 0.99));
    let first = mesh.nodes.len();
    let mut random = Random::after(3);
    for _ in 0..50 {
        mesh.nodes.push(std::array::from_fn(|_| 0.5 + 0.5 * random.symmetric()));
    }
    mesh.nodes.push([1.0, 0.5, 0.25]); // on the surface
    for n in first..mesh.nodes.len() - 1 {
        mesh.trusses.push(Truss { nodes: [n, n + 1], area_m2: 1e-4, part: 0, law: 0 });
    }
    mesh.trusses.push(Truss { nodes: [0, first], area_m2: 1e-4, part: 0, law: 0 });
    let ties = embed_bars(&mesh);
    assert_eq!(ties.len(), 51, "a node of a hexahedron needs no tie");
    for tie in &ties {
        assert!((tie.masters.iter().map(|m| m.1).sum::<f64>() - 1.0).abs() < 1e-14);
        for i in 0..3 {
            let at: f64 = tie.masters.iter().map(|(n, w)| w * mesh.nodes[*n][i]).sum();
            assert!((at - mesh.nodes[tie.node][i]).abs() < 1e-6, "{tie:?}");
        }
        assert!(tie.masters.iter().all(|(n, _)| mesh.elements[tie.element].nodes.contains(n)));
    }
    assert!(ties[50].masters.len() <= 4, "a node on a face hangs on that face");
}

#[test]
fn a_bar_node_outside_is_an_error_that_names_it() {
    let mut nodes = hexahedron(0.0, 0).to_vec();
    nodes.push([0.5, 1.2, 0.5]);
    let mesh = of_hexahedra(nodes, vec![[0, 1, 2, 3, 4, 5, 6, 7]], elastic(), Vec::new());
    let error = embed(&mesh, &[8]).expect_err("outside");
    assert_eq!(error.node, 8);
    assert!(error.to_string().contains("bar node 8 at (0.5000, 1.2000, 0.5000)"), "{error}");
}

/// A concrete bar along x, 4 m long and 1 m wide, held at one end, with a steel bar in its axis.
fn reinforced(area_m2: f64) -> Mesh {
    let concrete = Law { poisson_ratio: 0.0, ..elastic() };
    let mut mesh = grid([8, 1, 1], [4.0, 1.0, 1.0], concrete, |p| p[0] == 0.0);
    let first = mesh.nodes.len();
    mesh.nodes.extend((0..=16).map(|i| [0.25 * f64::from(i), 0.5, 0.5]));
    mesh.laws.push(steel());
    mesh.trusses.extend((0..16).map(|i| Truss {
        nodes: [first + i, first + i + 1],
        area_m2,
        part: 0,
        law: 1,
    }));
    mesh.ties = embed_bars(&mesh);
    // A node on the held face hangs on held nodes.
    assert_eq!(mesh.ties.len(), 17);
    mesh
}

fn pulled(mesh: &Mesh, force_n: f64) -> Dynamics {
    let mut body = Dynamics::new(mesh, 0.0, RigidSurfaces::default(), false);
    for n in (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][0] == 4.0 && !body.ties.is_tied(*n)) {
        body.applied_n[n][0] = 0.25 * force_n;
    }
    equilibrate(&mut body).unwrap();
    body
}

/// Tension member: concrete and steel share the force as `E A` does.
#[test]
fn reinforced_tension_member() {
    let (area, force) = (0.02, 1e5);
    let mesh = reinforced(area);
    let body = pulled(&mesh, force);
    let (steel_n, concrete_n) = (STEEL_PA * area, 30e9);
    for bar in &body.trusses.bars {
        let share = bar.force_n() / force;
        assert!((share / (steel_n / (steel_n + concrete_n)) - 1.0).abs() < 1e-4, "{share}");
    }
    let tip = super::mesh::nearest(&mesh, [4.0, 0.0, 0.0]);
    let longer = body.x[tip][0] - 4.0;
    assert!((longer / (force * 4.0 / (steel_n + concrete_n)) - 1.0).abs() < 1e-4, "{longer:e}");
}

/// The concrete around a bar goes: the bar nodes in it are free, with their own small mass, and the bar alone bears on. The time step
/// follows from each bar's own mass, so that this is stable; energy stays.
#[test]
fn a_bar_outlives_the_concrete_around_it() {
    let mesh = reinforced(0.02);
    let mut body = pulled(&mesh, 1e5);
    let mass: f64 = body.mass_kg.iter().sum();
    let stored = |body: &Dynamics| body.blocks.energies_j().iter().sum::<f64>() + body.trusses.internal_j();
    let start = stored(&body);
    let gone = (0..8).find(|e| (mesh.center(*e)[0] - 2.25).abs() < 1e-9).unwrap();
    body.blocks.set_share(gone, 0.0);
    let acting = body.ties.acting();
    let mut worst: f64 = 0.0;
    while body.time_s < 0.008 {
        let kinetic = body.step(true);
        let balance = kinetic + stored(&body) - start - body.driven_j - body.ties.released_j;
        worst = worst.max(balance.abs() / (kinetic + stored(&body)));
    }
    assert!(worst < 0.02, "energy {worst:e}");
    let freed = acting - body.ties.acting();
    assert!((1..=3).contains(&freed), "{freed}");
    assert!((body.mass_kg.iter().sum::<f64>() / mass - 1.0).abs() < 1e-12);
    let reach = body.x.iter().zip(&mesh.nodes).map(|(x, p)| (x[0] - p[0]).abs()).fold(0.0, f64::max);
    // Twice the static elongation of the bar over the gap, at most, and that of the rest.
    let static_m = 1e5 * 0.75 / (STEEL_PA * 0.02) + 1e5 * 4.0 / 30e9;
    assert!(reach < 2.5 * static_m && reach > 0.5 * static_m, "{reach:e} against {static_m:e}");
}

/// A piece cut out of a mesh keeps the bars in it with their ties.
#[test]
fn a_piece_keeps_its_bars() {
    let mesh = reinforced(0.02);
    let (piece, old) = mesh.cut_out(|e| mesh.center(e)[0] < 2.0);
    assert_eq!((piece.elements.len(), piece.trusses.len(), piece.ties.len()), (4, 8, 9));
    for (tie, node) in piece.ties.iter().map(|t| (t, old[t.node])) {
        let before = mesh.ties.iter().find(|t| t.node == node).unwrap();
        assert_eq!(piece.nodes[tie.node], mesh.nodes[node]);
        let masters: Vec<_> = tie.masters.iter().map(|(m, w)| (old[*m], *w)).collect();
        assert_eq!(masters, before.masters);
        assert_eq!(piece.center(tie.element), mesh.center(before.element));
    }
}
