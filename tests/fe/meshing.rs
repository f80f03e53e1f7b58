//! Meshes of buildings: openings, refinement, columns with a mesh of their own, quality.

use fallwerk::base::tree::Format;
use fallwerk::building::partition::Partition;
use fallwerk::building::{Building, EXAMPLE, parse, read};
use fallwerk::fe::apart::tied_members;
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::preload::equilibrate;
use fallwerk::fe::quality::{Quality, sliver_note};
use fallwerk::fe::run::{FeOptions, run};
use fallwerk::fe::tie::{LeftOut, left_out, left_out_notes};
use fallwerk::graph::Structure;

fn building(change: impl Fn(String) -> String) -> Building {
    parse(&change(EXAMPLE.into()), Format::Toml, "a.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// The reference building with a column at (x, 2.5) in the first storey.
fn with_column(x: f64, mesh: &str) -> Building {
    let column = format!(
        "[[members]]\nid = \"C1-X\"\nkind = \"column\"\nsection = \"column\"\nfrom = [{x}, 2.5, 0]\nto = [{x}, 2.5, 3.5]\n\n[[supports]]"
    );
    building(|text| text.replacen("[[supports]]", &column, 1) + mesh)
}

/// Mass, centre and inertia of a part about its centre, from its elements (boxes).
fn mass_of_part(mesh: &Mesh, part: usize, density: f64) -> (f64, [f64; 3], [f64; 3]) {
    let boxes: Vec<([f64; 3], [f64; 3], f64)> = (0..mesh.elements.len())
        .filter(|e| mesh.elements[*e].part == part)
        .map(|e| {
            let nodes = mesh.elements[e].nodes.map(|n| mesh.nodes[n]);
            let size: [f64; 3] = std::array::from_fn(|i| nodes[6][i] - nodes[0][i]);
            (mesh.center(e), size, density * mesh.elements[e].smear * size.iter().product::<f64>())
        })
        .collect();
    let mass: f64 = boxes.iter().map(|b| b.2).sum();
    let center: [f64; 3] = std::array::from_fn(|i| boxes.iter().map(|b| b.2 * b.0[i]).sum::<f64>() / mass);
    let square = |b: &([f64; 3], [f64; 3], f64), i: usize| {
        b.2 * (b.1[i].powi(2) / 12.0 + (b.0[i] - center[i]).powi(2))
    };
    let inertia =
        std::array::from_fn(|i| boxes.iter().map(|b| square(b, (i + 1) % 3) + square(b, (i + 2) % 3)).sum());
    (mass, center, inertia)
}

/// A slab with a stairwell and a wall with a door: partition, graph (whence the rigid bodies) and FE mesh have the same mass, centre and inertia.
#[test]
fn openings_are_missing_in_all_models() {
    let whole = building(|t| t);
    let cut = building(|text| {
        text.replace("slab_overhang = \"200 mm\"", "slab_overhang = \"200 mm\"\nslab_openings = [{ from = [1.5, 2], to = [4.1, 3.2] }]")
            .replacen("[[supports]]", "[[members]]\nid = \"W1\"\nkind = \"wall\"\nsection = \"slab\"\nfrom = [6.075, 0.2, 0]\nto = [6.075, 4.8, 3]\nopenings = [{ from = [1, 0], to = [2, \"2.1 m\"] }]\n\n[[supports]]", 1)
    });
    let index = |id: &str| cut.members.iter().position(|m| m.id == id).unwrap();
    let (slab, wall) = (index("S1"), index("W1"));
    let volumes = Partition::of(&cut).volumes(cut.members.len());
    let uncut = Partition::of(&whole).volumes(whole.members.len());
    assert!((uncut[slab] - volumes[slab] - 2.6 * 1.2 * 0.25).abs() < 1e-9);
    assert!((volumes[wall] - 0.25 * (4.6 * 3.0 - 2.1)).abs() < 1e-9, "{}", volumes[wall]);
    let (mesh, _) = Mesh::of(&cut, 0.4);
    let structure = Structure::of(&cut);
    for part in [slab, wall] {
        let (mass, center, inertia) = mass_of_part(&mesh, part, 2500.0);
        let rigid = structure.mass_of(&[part]);
        assert!((mass / rigid.mass_kg - 1.0).abs() < 1e-9, "{mass} against {}", rigid.mass_kg);
        assert!((mass / (2500.0 * volumes[part]) - 1.0).abs() < 1e-9);
        for i in 0..3 {
            assert!((center[i] - rigid.center_m[i]).abs() < 0.01, "{center:?} against {:?}", rigid.center_m);
            assert!(
                (inertia[i] / rigid.inertia_kg_m2[i][i] - 1.0).abs() < 0.02,
                "{inertia:?} against {:?}",
                rigid.inertia_kg_m2
            );
        }
    }
    let in_opening = |p: [f64; 3]| p[0] > 1.6 && p[0] < 4.0 && p[1] > 2.1 && p[1] < 3.1;
    assert!((0..mesh.elements.len()).all(|e| mesh.elements[e].part != slab || !in_opening(mesh.center(e))));
}

/// Element heights of the columns near their ends and in between.
#[test]
fn refinement_near_member_ends() {
    let fine = building(|t| t + "\n[[mesh.refine]]\nmembers = [\"C1-*\"]\nsize = 0.2\nends = 0.8\n");
    let (mesh, _) = Mesh::of(&fine, 0.4);
    let (coarse, _) = Mesh::of(&building(|t| t), 0.4);
    let heights = |mesh: &Mesh, from: f64, to: f64| {
        let of = |e: &fallwerk::fe::mesh::Element| mesh.nodes[e.nodes[4]][2] - mesh.nodes[e.nodes[0]][2];
        let inside = (0..mesh.elements.len()).filter(|e| (from..to).contains(&mesh.center(*e)[2]));
        inside.map(|e| of(&mesh.elements[e])).fold([f64::INFINITY, 0.0], |[a, b], h| [h.min(a), h.max(b)])
    };
    assert!(heights(&mesh, 0.0, 0.8).iter().all(|h| (h - 0.2).abs() < 1e-9));
    assert!(heights(&mesh, 0.8, 2.6)[0] > 0.3);
    assert_eq!(heights(&mesh, 3.5, 6.5), heights(&coarse, 3.5, 6.5), "the next storey is as before");
    assert!(mesh.elements.len() > coarse.elements.len());
}

/// A column off the lines of the others: its own mesh, tied at the head, the same mass, and a dead-load state that bears the weight.
#[test]
fn a_column_off_the_grid_is_tied() {
    let joined = with_column(2.9, "");
    let tied = with_column(2.9, "\n[mesh]\ntie_below = 0.3\n");
    // Another column 0.15 m off the line of the first: its faces would make slivers.
    let second = "[[members]]\nid = \"C1-Y\"\nkind = \"column\"\nsection = \"column\"\nfrom = [3.05, 1.3, 0]\nto = [3.05, 1.3, 3.5]\n\n[[supports]]";
    let with_second = |b: &str| {
        let text = EXAMPLE.replacen(
            "[[supports]]",
            &second.replace("C1-Y", "C1-X").replace("3.05, 1.3", "2.9, 2.5"),
            1,
        );
        parse(&(text.replacen("[[supports]]", second, 1) + b), Format::Toml, "a.toml")
            .unwrap_or_else(|e| panic!("{e}"))
    };
    assert!(Mesh::of(&joined, 0.4).0.ties.is_empty());
    assert!(Mesh::of(&tied, 0.4).0.ties.is_empty(), "nothing is near the first one");
    let (free, tied) = (with_second(""), with_second("\n[mesh]\ntie_below = 0.2\n"));
    let ((conforming, _), (mesh, snapped)) = (Mesh::of(&free, 0.4), Mesh::of(&tied, 0.4));
    assert!(conforming.ties.is_empty());
    assert_eq!(tied_members(&tied, &mesh).len(), 1);
    assert_eq!(mesh.ties.len(), 9, "the head, three by three nodes; the foot is held");
    assert!(snapped.iter().all(|s| !s.member.starts_with("C1-X") && !s.member.starts_with("C1-Y")));
    let mass =
        |mesh: &Mesh| (0..27).map(|p| mass_of_part(mesh, p, 2500.0).0).filter(|m| m.is_finite()).sum::<f64>();
    assert!((mass(&mesh) / mass(&conforming) - 1.0).abs() < 1e-9);
    let mut body = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false);
    equilibrate(&mut body).unwrap();
    let weight = body.mass_kg.iter().sum::<f64>() * 9.81;
    let held: f64 = mesh.fixed.iter().map(|n| body.internal_n(*n)[2] + body.mass_kg[*n] * 9.81).sum();
    assert!((held / weight - 1.0).abs() < 1e-8, "{held} against {weight}");
    let part = tied.members.iter().position(|m| m.id == tied_members(&tied, &mesh)[0]).unwrap();
    let foot: f64 = mesh
        .fixed
        .iter()
        .filter(|n| body.blocks.elements_at(**n).any(|e| mesh.elements[e].part == part))
        .map(|n| body.internal_n(*n)[2] + body.mass_kg[*n] * 9.81)
        .sum();
    assert!(foot > 3.0 * mass_of_part(&mesh, part, 2500.0).0 * 9.81, "it carries some of the slab: {foot}");
}

/// The note on slivers names the planes and members, and a mesh without slivers has none.
#[test]
fn slivers_are_named() {
    let plain = building(|t| t);
    let quality = |b: &Building| {
        let (mesh, snapped) = Mesh::of(b, 0.4);
        Quality::of(&mesh, &snapped).unwrap()
    };
    assert_eq!(sliver_note(&plain, &quality(&plain), 0.4), None);
    let off = with_column(0.32, ""); // its faces at 0.12 and 0.52 m, that of C1-A1 at 0.2 m, snapped
    assert_eq!(sliver_note(&off, &quality(&off), 0.4), None);
    let off = with_column(0.5 - 0.18, "");
    assert!((quality(&off).all.step_s / quality(&plain).all.step_s) <= 1.0);
    let off = with_column(0.52, ""); // its face at 0.32 m, that of C1-A1 at 0.2 m
    let note = sliver_note(&off, &quality(&off), 0.4).expect("planes 0.12 m apart");
    assert!(note.contains("x = 0.200 m") && note.contains("x = 0.320 m (`C1-X`)"), "{note}");
}

/// The building for runs of full size: its element count and time step are what its dimensions were chosen for.
#[test]
fn the_six_storey_building_has_no_slivers() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("buildings/six-storey.toml");
    let building = read(&path).unwrap_or_else(|e| panic!("{e}"));
    let (mesh, snapped) = Mesh::of(&building, building.settings.mesh_size_m);
    assert!((80_000..90_000).contains(&mesh.elements.len()));
    assert!(snapped.is_empty(), "{snapped:?}");
    let quality = Quality::of(&mesh, &snapped).unwrap();
    assert!(quality.all.step_s > 3e-5 && quality.all.aspect < 3.0 && quality.all.scaled_jacobian > 0.999);
    assert_eq!(sliver_note(&building, &quality, building.settings.mesh_size_m), None);
}

/// Materials and sections of the reference building with other members on the columns `C*`.
fn small(members: &str) -> Building {
    let head = EXAMPLE.split("[grid]").next().unwrap();
    let tail = "[[supports]]\nmembers = [\"C*\"]\n\n[ground]\nlevel = 0\nfriction = 0.5\n\n[settings]\nmesh_size = 0.2\n";
    parse(&format!("{head}{members}{tail}"), Format::Toml, "a.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// A slab of 2 m by 2 m on one column in its middle.
fn table(rotation: &str) -> Building {
    small(&format!(
        "[[members]]\nid = \"C\"\nkind = \"column\"\nsection = \"column\"\nfrom = [0, 0, 0]\nto = [0, 0, 3.5]\n{rotation}\n\n\
         [[members]]\nid = \"S\"\nkind = \"slab\"\nsection = \"slab\"\nfrom = [-1, -1, 3.5]\nto = [1, 1, 3.5]\n\n"
    ))
}

/// Two columns 5 m apart on a diagonal and a beam between their axes.
fn diagonal() -> Building {
    small(
        "[[members]]\nid = \"C1\"\nkind = \"column\"\nsection = \"column\"\nfrom = [0, 0, 0]\nto = [0, 0, 3.5]\n\n\
         [[members]]\nid = \"C2\"\nkind = \"column\"\nsection = \"column\"\nfrom = [4, 3, 0]\nto = [4, 3, 3.5]\n\n\
         [[members]]\nid = \"B\"\nkind = \"beam\"\nsection = \"beam\"\nfrom = [-0.5, 1.5, 3.5]\nto = [4.5, 1.5, 3.5]\nrotation_deg = 36.86989764584402\n\n",
    )
}

/// Dead-load state; the reactions must bear the weight.
fn at_rest(mesh: &Mesh) -> Dynamics {
    assert!(left_out(mesh).iter().all(Option::is_none), "{:?}", left_out_notes(mesh));
    let mut body = Dynamics::new(mesh, 9.81, RigidSurfaces::default(), false);
    equilibrate(&mut body).unwrap();
    let weight = body.mass_kg.iter().sum::<f64>() * 9.81;
    let held: f64 = mesh.fixed.iter().map(|n| body.internal_n(*n)[2] + body.mass_kg[*n] * 9.81).sum();
    assert!((held / weight - 1.0).abs() < 1e-8, "{held} against {weight}");
    body
}

/// Mean sinking of the nodes of a part at a height \[m\].
fn sunk(mesh: &Mesh, body: &Dynamics, part: usize, height: f64) -> f64 {
    let mut nodes: Vec<usize> =
        mesh.elements.iter().filter(|e| e.part == part).flat_map(|e| e.nodes).collect();
    nodes.retain(|n| (mesh.nodes[*n][2] - height).abs() < 1e-9);
    nodes.sort_unstable();
    nodes.dedup();
    assert!(!nodes.is_empty());
    nodes.iter().map(|n| mesh.nodes[*n][2] - body.x[*n][2]).sum::<f64>() / nodes.len() as f64
}

/// A turned column bears the slab on it with the stiffness `E A / L`, and its direction does not matter.
#[test]
fn a_turned_column_bears_its_slab() {
    let shortening = |rotation: &str| {
        let building = table(rotation);
        let (mesh, snapped) = Mesh::of(&building, 0.2);
        assert!(snapped.is_empty(), "{snapped:?}");
        let mass: f64 = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false).mass_kg.iter().sum();
        let expected = 2500.0 * (4.0 * 0.25 + 0.16 * 3.25);
        assert!((mass / expected - 1.0).abs() < 1e-9, "{mass} against {expected}");
        (sunk(&mesh, &at_rest(&mesh), 0, 3.25), mesh.ties.len())
    };
    let (plain, no_ties) = shortening("");
    assert_eq!(no_ties, 0);
    let law = table("");
    let modulus = law.law_of(&law.members[0]).youngs_modulus_pa;
    let load = 9.81 * 2500.0 * (4.0 * 0.25 + 0.5 * 0.16 * 3.25);
    let exact = load * 3.25 / (modulus * 0.16);
    assert!((plain / exact - 1.0).abs() < 0.03, "{plain:e} against {exact:e}");
    let whole = shortening("rotation_deg = 360");
    for angle in [90.0, 30.0, 45.0, -17.5] {
        let (turned, ties) = shortening(&format!("rotation_deg = {angle}"));
        assert_eq!(ties, 9);
        assert!((turned / plain - 1.0).abs() < 0.02, "{angle}: {turned:e} against {plain:e}");
        if angle == 90.0 {
            assert!((turned / whole.0 - 1.0).abs() < 1e-9, "{turned:e} against {:e}", whole.0);
        }
    }
}

/// A turned beam is mitred to its columns: it has the volume that they leave it, its ends are tied, and both columns bear half the weight.
#[test]
fn a_turned_beam_butts_against_its_columns() {
    let building = diagonal();
    let (mesh, snapped) = Mesh::of(&building, 0.2);
    let quality = Quality::of(&mesh, &snapped).unwrap();
    assert!(quality.all.scaled_jacobian > 0.55, "{}", quality.all.scaled_jacobian);
    assert!(quality.volume_ratio.iter().all(|r| (r - 1.0).abs() < 0.01), "{:?}", quality.volume_ratio);
    assert_eq!(tied_members(&building, &mesh), ["B"]);
    // By counting points of the gross beam outside the columns.
    let (cosine, sine) = (0.8, 0.6);
    let (long, wide) = (5000, 300);
    let mut outside = 0_usize;
    for i in 0..long {
        for j in 0..wide {
            let [a, b] =
                [5.0 * (i as f64 + 0.5) / long as f64 - 2.5, 0.3 * (j as f64 + 0.5) / wide as f64 - 0.15];
            let (x, y) = (2.0 + a * cosine - b * sine, 1.5 + a * sine + b * cosine);
            let inside = |cx: f64, cy: f64| (x - cx).abs() < 0.2 && (y - cy).abs() < 0.2;
            outside += usize::from(!inside(0.0, 0.0) && !inside(4.0, 3.0));
        }
    }
    let counted = 0.5 * 5.0 * 0.3 * outside as f64 / (long * wide) as f64;
    let volume = Partition::of(&building).volumes(3)[2];
    assert!((volume / counted - 1.0).abs() < 1e-3, "{volume} against {counted}");
    let body = at_rest(&mesh);
    let total = body.mass_kg.iter().sum::<f64>();
    assert!((total / (2500.0 * (volume + 2.0 * 0.16 * 3.5)) - 1.0).abs() < 1e-9);
    let foot: f64 = (mesh.fixed.iter().filter(|n| mesh.nodes[**n][0] < 1.0))
        .map(|n| body.internal_n(*n)[2] + body.mass_kg[*n] * 9.81)
        .sum();
    assert!((foot / (0.5 * 9.81 * total) - 1.0).abs() < 1e-6, "{foot}");
}

/// With contact of the building with itself, a member that is tied to its neighbours stays at rest beside them.
#[test]
fn turned_members_stay_at_rest() {
    for building in [table("rotation_deg = 30"), diagonal()] {
        let options = FeOptions { end_time_s: Some(0.05), ..FeOptions::default() };
        let result = run(&building, &options, &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
        let moved = result
            .tracked
            .iter()
            .flat_map(|t| &t.displacement_m)
            .flatten()
            .fold(0.0_f64, |a, u| a.max(u.abs()));
        assert!(!result.tracked.is_empty() && moved < 1e-7, "{moved:e}");
    }
}

/// Ties that cannot act are named.
#[test]
fn ties_that_do_not_act_are_reported() {
    let (mut mesh, _) = Mesh::of(&table("rotation_deg = 30"), 0.2);
    assert!(left_out_notes(&mesh).is_empty());
    let [first, second] = [0, 1].map(|i| mesh.ties[i].clone());
    mesh.fixed.push(first.node);
    mesh.ties.push(second.clone());
    let mut on_master = second;
    on_master.node = on_master.masters[0].0;
    mesh.ties.push(on_master);
    let found: Vec<LeftOut> = left_out(&mesh).into_iter().flatten().collect();
    assert_eq!(found, [LeftOut::Held, LeftOut::Twice, LeftOut::Master]);
    let notes = left_out_notes(&mesh);
    assert!(notes[0].contains("1 node is not tied: held by a support") && notes.len() == 3, "{notes:?}");
}

/// Slender columns, whose faces lie as far from the edge of the slab as faces may that are merged, and ends of beams midway between the faces of a column: all four corners are alike.
#[test]
fn corners_of_a_symmetric_frame_have_the_same_elements() {
    for size in ["400 mm", "350 mm", "300 mm"] {
        let slender = |text: String| {
            let text = text.replacen("width = \"400 mm\"", "width = \"200 mm\"", 1);
            let text = text.replacen("depth = \"400 mm\"", "depth = \"200 mm\"", 1);
            text.replacen("mesh_size = \"400 mm\"", &format!("mesh_size = \"{size}\""), 1)
        };
        let building = building(slender);
        let (mesh, snapped) = Mesh::of(&building, building.settings.mesh_size_m);
        let elements = |id: String| {
            let part = building.members.iter().position(|m| m.id == id).unwrap();
            mesh.elements.iter().filter(|e| e.part == part).count()
        };
        let ratio = |id: &str| snapped.iter().find(|s| s.member == id).map_or(1.0, |s| s.volume_ratio);
        for storey in 1..=3 {
            let of = |corner: &str| format!("C{storey}-{corner}");
            for corner in ["A2", "B1", "B2"] {
                assert_eq!(elements(of(corner)), elements(of("A1")), "{corner} {size}");
                let [a, b] = [ratio(&of(corner)), ratio(&of("A1"))];
                assert!((a / b - 1.0).abs() < 1e-9, "{corner} {size}: {a} {b}");
            }
        }
    }
}
