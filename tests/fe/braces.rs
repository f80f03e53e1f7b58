//! Braces: bars between two points in any direction, cut at their neighbours' faces and tied to them.

use fallwerk::base::tree::Format;
use fallwerk::building::partition::Partition;
use fallwerk::building::{Building, EXAMPLE, parse};
use fallwerk::fe::apart::tied_members;
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::{Death, Dynamics};
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::preload::equilibrate;
use fallwerk::fe::quality::Quality;
use fallwerk::fe::run::{FeOptions, run};
use fallwerk::fe::tie::left_out;

/// Modulus of braces and frames \[Pa\].
const SOFT_PA: f64 = 1e9;

/// A building of some members on the materials of the reference building and two elastic laws without lateral strain, `SOFT` and `HARD`
/// (sixty times as stiff); `strut` is 0.2 m by 0.3 m.
fn building(members: &str, tail: &str) -> Building {
    let head = EXAMPLE.split("# ---- Sections").next().unwrap();
    let law = |id: &str, modulus: &str| {
        format!(
            "[materials.{id}]\nkind = \"homogenised\"\ndensity = 2500\nyoungs_modulus = \"{modulus} GPa\"\npoisson_ratio = 0\n\
             hardening = [[0, \"900 MPa\"]]\ncritical_plastic_strain = 2\n\n"
        )
    };
    let bar = |id: &str, width: f64, depth: f64| {
        format!(
            "[sections.{id}]\nkind = \"rectangle\"\nconcrete = \"C30\"\nsteel = \"B500\"\nlaw = \"SOFT\"\nwidth = {width}\ndepth = {depth}\n\
             bars_around = {{ per_face = 2, diameter = \"12 mm\", edge_distance = \"40 mm\" }}\n\n"
        )
    };
    let plate = |id: &str, law: &str, thickness: f64| {
        format!(
            "[sections.{id}]\nkind = \"plate\"\nconcrete = \"C30\"\nsteel = \"B500\"\nlaw = \"{law}\"\nthickness = {thickness}\n\
             mesh = {{ diameter = \"10 mm\", spacing = \"150 mm\", edge_distance = \"30 mm\" }}\n\n"
        )
    };
    let text = [
        head.to_string(),
        law("SOFT", "1"),
        law("HARD", "60"),
        bar("strut", 0.2, 0.3),
        bar("column", 0.4, 0.4),
        bar("beam", 0.4, 0.6),
        plate("plate", "HARD", 0.5),
        members.to_string(),
        format!("[[supports]]\nmembers = [\"F*\"]\n\n[ground]\nlevel = 0\nfriction = 0.5\n\n{tail}"),
    ]
    .concat();
    parse(&text, Format::Toml, "a.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn member(id: &str, kind: &str, section: &str, points: [[f64; 3]; 2], more: &str) -> String {
    let [from, to] = points;
    format!(
        "[[members]]\nid = \"{id}\"\nkind = \"{kind}\"\nsection = \"{section}\"\nfrom = {from:?}\nto = {to:?}\n{more}\n\n"
    )
}

/// A plate on the ground and one 3.5 m above it (top faces), joined by nothing but a brace.
fn two_floors(points: [[f64; 3]; 2], more: &str, tail: &str) -> Building {
    let floors = member("F", "footing", "plate", [[-1.0, -1.0, 0.0], [4.0, 1.0, 0.0]], "")
        + &member("S", "slab", "plate", [[-1.0, -1.0, 3.5], [4.0, 1.0, 3.5]], "");
    building(&(floors + &member("X", "brace", "strut", points, more)), tail)
}

/// Size of the mesh, and of the mesh of the brace.
fn sizes(floors_m: f64, brace_m: f64) -> String {
    format!("[settings]\nmesh_size = {floors_m}\n\n[[mesh.refine]]\nmembers = [\"X\"]\nsize = {brace_m}\n")
}

/// Spreads a force along x over the nodes of a part by their mass and finds the equilibrium without gravity; returns the state and
/// the part's mean displacement along x \[m\].
fn pushed(mesh: &Mesh, part: usize, force_n: f64, guided: bool) -> (Dynamics, f64) {
    let mut body = Dynamics::new(mesh, 0.0, RigidSurfaces::default(), false);
    let mut nodes: Vec<usize> =
        mesh.elements.iter().filter(|e| e.part == part).flat_map(|e| e.nodes).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes.retain(|n| !body.ties.is_tied(*n));
    let mass: f64 = nodes.iter().map(|n| body.mass_kg[*n]).sum();
    for n in &nodes {
        body.applied_n[*n][0] = force_n * body.mass_kg[*n] / mass;
        if guided {
            body.prescribed_m_s[*n][1] = Some(0.0);
            body.prescribed_m_s[*n][2] = Some(0.0);
        }
    }
    equilibrate(&mut body).unwrap();
    let moved = nodes.iter().map(|n| body.mass_kg[*n] * (body.x[*n][0] - mesh.nodes[*n][0])).sum::<f64>();
    (body, moved / mass)
}

/// Axial force in the middle of a brace, tension positive \[N\]: of the elements there on the nodes of their far ends.
fn axial_force(mesh: &Mesh, body: &Dynamics, part: usize, points: [[f64; 3]; 2]) -> f64 {
    let [from, to] = points;
    let length = distance(points);
    let along: [f64; 3] = std::array::from_fn(|i| (to[i] - from[i]) / length);
    let at = |p: [f64; 3]| (0..3).map(|i| along[i] * (p[i] - from[i])).sum::<f64>();
    let (near, far) = ([0, 3, 4, 7], [1, 2, 5, 6]);
    let mut force = 0.0;
    let mut across = 0;
    for e in (0..mesh.elements.len()).filter(|e| mesh.elements[*e].part == part) {
        let mean = |end: [usize; 4]| {
            end.map(|i| at(mesh.nodes[mesh.elements[e].nodes[i]])).iter().sum::<f64>() / 4.0
        };
        if (mean(near)..mean(far)).contains(&(0.5 * length + 1e-6)) {
            let on_nodes = body.blocks.element_force(e, &body.x);
            force += far.map(|k| (0..3).map(|i| on_nodes[k][i] * along[i]).sum::<f64>()).iter().sum::<f64>();
            across += 1;
        }
    }
    assert!(across >= 4, "{across}");
    force
}

fn distance([a, b]: [[f64; 3]; 2]) -> f64 {
    (0..3).map(|i| (b[i] - a[i]).powi(2)).sum::<f64>().sqrt()
}

/// Stiffness of a strut between two rigid floors, one of which moves along x only, and its axial force for a unit force: `E A cos² / L` and
/// that of its clamped ends, `12 E I / L³`, about both axes of its section. `points` are on the floors' faces.
fn bar_theory(building: &Building, points: [[f64; 3]; 2]) -> [f64; 2] {
    let [along, wide, deep] = building.member("X").and_then(|m| m.inclined).unwrap().axes();
    let (length, area) = (distance(points), 0.2 * 0.3);
    let axial = SOFT_PA * area / length * along[0] * along[0];
    let bending = |side: f64| 12.0 * SOFT_PA * area * side * side / 12.0 / length.powi(3);
    let k = axial + bending(0.2) * wide[0] * wide[0] + bending(0.3) * deep[0] * deep[0];
    [k, SOFT_PA * area / length * along[0].abs() / k]
}

/// Stiffness and axial force of [`two_floors`] by FE over [`bar_theory`], less one.
fn off_theory(points: [[f64; 3]; 2], more: &str, fine_m: f64) -> [f64; 2] {
    let building = two_floors(points, more, &sizes(0.5, fine_m));
    let (mesh, snapped) = Mesh::of(&building, 0.5);
    assert!(snapped.is_empty() && left_out(&mesh).iter().all(Option::is_none), "{snapped:?}");
    let (body, moved) = pushed(&mesh, 1, 1e3, true);
    let [k, n] = bar_theory(&building, points);
    [1e3 / moved / k - 1.0, axial_force(&mesh, &body, 2, points) / 1e3 / n - 1.0]
}

/// Between two stiff floors a brace has the stiffness `E A cos² / L` and takes all of the force. Its ends are oblique and cannot strain, which bar theory does
/// not know: the mesh converges to 0.5 % above it, the difference less than half from mesh to mesh.
#[test]
fn a_brace_between_two_floors() {
    let points = [[0.0, 0.0, 0.0], [3.0, 0.0, 3.0]];
    let off = [0.4, 0.2, 0.1, 0.05].map(|fine| off_theory(points, "", fine));
    let limits = [(0.019, 0.005), (0.011, 0.003), (0.0075, 0.003), (0.006, 0.003)];
    for ([k, n], (most_k, most_n)) in off.iter().zip(limits) {
        assert!((0.0..most_k).contains(k) && n.abs() < most_n, "{off:?}");
    }
    let change: Vec<f64> = off.windows(2).map(|w| w[0][0] - w[1][0]).collect();
    assert!(change.windows(2).all(|c| c[1] > 0.0 && c[1] < 0.5 * c[0]), "{change:?}");
}

/// The same for other directions, also out of both planes, and for a rolled section.
#[test]
fn a_brace_in_any_direction() {
    let from = [0.0; 3];
    for (points, more) in [
        ([from, [2.0, 0.0, 3.0]], ""),
        ([[0.0, -0.6, 0.0], [2.4, 0.6, 3.0]], ""),
        ([[2.4, 0.6, 3.0], [0.0, -0.6, 0.0]], ""),
        ([from, [3.0, 0.0, 3.0]], "roll_deg = 45"),
        ([[0.0, -0.6, 0.0], [2.4, 0.6, 3.0]], "roll_deg = -30"),
    ] {
        let [k, n] = off_theory(points, more, 0.1);
        assert!(k.abs() < 0.008 && n.abs() < 0.006, "{points:?} {more}: {k:.4} {n:.4}");
    }
}

/// Its points may lie anywhere between faces and a section's depth beyond them: the brace is cut off or prolonged to the faces.
#[test]
fn a_brace_ends_at_its_neighbours() {
    let made = |from: f64, to: f64| {
        let points = [[from, 0.0, from], [to, 0.0, to]];
        let building = two_floors(points, "", &sizes(0.5, 0.2));
        let volume = Partition::of(&building).volumes(3)[2];
        let (mesh, _) = Mesh::of(&building, 0.5);
        let mass: f64 = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false).mass_kg.iter().sum();
        assert_eq!(tied_members(&building, &mesh), ["X"]);
        assert!((mass / (2500.0 * (volume + 2.0 * 5.0 * 2.0 * 0.5)) - 1.0).abs() < 1e-9);
        (volume, mesh.ties.len(), mesh.nodes.iter().map(|p| p[2]).fold(f64::INFINITY, f64::min))
    };
    let exact = 0.06 * 18f64.sqrt();
    for (from, to) in [(0.0, 3.0), (-0.1, 3.2), (0.1, 2.9)] {
        let (volume, ties, lowest) = made(from, to);
        assert!((volume / exact - 1.0).abs() < 1e-4, "{volume} {exact}");
        assert_eq!((ties, lowest), (18, -0.5));
    }
}

/// Two columns with a beam on them, 6 m wide and 4 m high to the beam's top; with a brace from the foot of one to the joint of the other.
fn frame(brace: bool, tail: &str) -> Building {
    let mut members = member("F1", "footing", "plate", [[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]], "")
        + &member("F2", "footing", "plate", [[5.0, -1.0, 0.0], [7.0, 1.0, 0.0]], "")
        + &member("C1", "column", "column", [[0.0, 0.0, 0.0], [0.0, 0.0, 4.0]], "")
        + &member("C2", "column", "column", [[6.0, 0.0, 0.0], [6.0, 0.0, 4.0]], "")
        + &member("B", "beam", "beam", [[-0.2, 0.0, 4.0], [6.2, 0.0, 4.0]], "");
    if brace {
        members += &member("X", "brace", "strut", DIAGONAL, "");
    }
    building(&members, tail)
}

const DIAGONAL: [[f64; 3]; 2] = [[0.0, 0.0, 0.0], [6.0, 0.0, 3.7]];

/// A braced frame under a horizontal force on its beam. Closed form: the frame's own stiffness and that of the truss made of the brace between the faces that it meets
/// and the column above whose foot it pulls, `1 / k = L / (E A cos²) + tan² h / (E A_c)`; the brace has the force that its stiffness draws. Stiffness within
/// 4 %, axial force within 2 %: the joints give.
#[test]
fn a_braced_frame() {
    for size in [0.4, 0.2] {
        let tail = format!("[settings]\nmesh_size = {size}\n");
        let stiffness = |building: &Building| {
            let (mesh, _) = Mesh::of(building, size);
            assert!(left_out(&mesh).iter().all(Option::is_none));
            let (body, moved) = pushed(&mesh, 4, 1e3, false);
            (1e3 / moved, mesh, body)
        };
        let (frame_n_m, ..) = stiffness(&frame(false, &tail));
        let braced = frame(true, &tail);
        let (braced_n_m, mesh, body) = stiffness(&braced);
        assert!(Quality::of(&mesh, &[]).unwrap().all.scaled_jacobian > 0.5);
        // From the column's face at x = 0.2 to the beam's soffit at z = 3.4.
        let (length, tangent) = (distance(DIAGONAL), 3.7 / 6.0);
        let (clear, cosine) = (length * (3.4 / 3.7 - 0.2 / 6.0), 6.0 / length);
        let truss =
            1.0 / (clear / (SOFT_PA * 0.06 * cosine * cosine) + tangent * tangent * 3.4 / (SOFT_PA * 0.16));
        let expected = frame_n_m + truss;
        assert!((braced_n_m / expected - 1.0).abs() < 0.04, "{size}: {braced_n_m:e} {expected:e}");
        let force = axial_force(&mesh, &body, 5, DIAGONAL);
        let share = 1e3 * truss / expected / cosine;
        assert!((force / share - 1.0).abs() < 0.02, "{size}: {force} {share}");
    }
}

/// Under gravity, with contact of the parts, the braced frame stays at rest; a charge takes a stretch out of the brace along its axis.
#[test]
fn a_braced_frame_at_rest_and_charged() {
    let settings = "[settings]\nmesh_size = 0.4\nend_time = 0.05\n";
    let largest = |building: &Building| {
        let result = run(building, &FeOptions::default(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
        let moved = result.tracked.iter().flat_map(|t| &t.displacement_m).flatten();
        (moved.fold(0.0_f64, |a, u| a.max(u.abs())), result)
    };
    let (moved, result) = largest(&frame(true, settings));
    assert!(!result.tracked.is_empty() && moved < 1e-7 && result.deaths.is_empty(), "{moved:e}");
    let charge = "[[events]]\nid = \"E\"\nmember = \"X\"\ntime = 0\nstretch = [2, 4]\n\n";
    let (moved, result) = largest(&frame(true, &format!("{charge}{settings}")));
    assert!(moved > 1e-7, "{moved:e}");
    let length = distance(DIAGONAL);
    let along = |e: usize| (0..3).map(|i| DIAGONAL[1][i] / length * result.mesh.center(e)[i]).sum::<f64>();
    let gone: Vec<usize> = result.deaths.iter().map(|d| d.element).collect();
    assert!(result.deaths.iter().all(|d| d.cause == Death::Removed) && gone.len() >= 16, "{gone:?}");
    for e in (0..result.mesh.elements.len()).filter(|e| result.mesh.elements[*e].part == 5) {
        assert_eq!((2.0..=4.0).contains(&along(e)), gone.contains(&e), "{}", along(e));
    }
}
