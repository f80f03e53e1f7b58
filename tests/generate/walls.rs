//! Walls on springs between ground and floors, on one piece of a floor or on the seam between two.

use super::{knowledge, moved_m, reference};
use fallwerk::base::tree::Format;
use fallwerk::building::{Building, parse};
use fallwerk::generate::{Accuracy, Derive, Wishes, generate};
use fallwerk::graph::{ContactFace, Structure};
use fallwerk::mbs::model::{Bending, Bushing, Model};

#[test]
fn walls_stand_on_springs_between_ground_and_floor() {
    let scene = fallwerk::study::plan::Scene::of(1, 1);
    assert!(scene.has_wall && scene.heights_m.len() == 1);
    let building = parse(&scene.toml(), Format::Toml, "scene").expect("a sound building");
    let (rules, mut store, _cache) = knowledge();
    let generated = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap();
    let springs: Vec<_> = generated.model.bushings.iter().filter(|b| b.id.starts_with("W1.")).collect();
    let ids: Vec<&str> = springs.iter().map(|b| b.id.as_str()).collect();
    assert_eq!(ids, ["W1.bottom-1", "W1.bottom-2", "W1.top-1", "W1.top-2"]);
    for spring in &springs {
        assert_eq!(spring.body_a.is_none(), spring.id.contains("bottom"), "{}", spring.id);
        let end = spring.id.rsplit_once('-').unwrap().0;
        assert_eq!(spring.body_b, "W1");
        assert_eq!(spring.origin.members, ["W1", end]);
    }
    // both halves in a row: the height over the stiffness of the whole area
    let wall = building.members.iter().find(|m| m.id == "W1").unwrap();
    let body = generated.model.bodies.iter().find(|b| b.id == "W1").unwrap();
    let height = 2.0 * body.position_m[2];
    let size = wall.solid.size();
    let whole = 16.5e9 * size[0] * size[1] / height;
    let series: f64 = 0.5 * springs[..2].iter().map(|b| b.axial_stiffness_n_m).sum::<f64>();
    assert!((series / whole - 1.0).abs() < 1e-9, "{series} {whole}");
    // both halves together yield like the whole section: f A
    let first = building.law_of(wall).hardening[0].stress_pa;
    let squash: f64 = springs[..2].iter().filter_map(|b| b.compressive_capacity_n).sum();
    assert!((squash / (first * size[0] * size[1]) - 1.0).abs() < 1e-9, "{squash}");
    let along = usize::from(size[1] > size[0]);
    // and out of the plane as one element across does in plane strain: h sqrt(G / E) = 2/√3 f, M = h l t² / 6; it hardens by a sixth
    let yields = 2.0 / 3.0_f64.sqrt() * 2.4_f64.sqrt() * first * size[along] * size[1 - along].powi(2) / 6.0;
    let Bending::Curve { curve, .. } = &springs[0].bending[along] else { panic!("elastic out of the plane") };
    let levels = &generated.model.curves[curve].levels;
    let at_rest = levels.iter().find(|l| l.axial_force_n == 0.0).unwrap();
    let ratio = 2.0 * at_rest.capacity[0][1] / yields;
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
    // N² of the squash load is lost
    let high = &levels[levels.len() - 1];
    let share: f64 = high.axial_force_n / (0.5 * squash);
    assert!((high.peak_nm() / at_rest.peak_nm() / (1.0 - share * share) - 1.0).abs() < 1e-9);
    // out of the plane a wall between floors is a beam: 12 E I / h³ in sway, E I / h in pure bending
    let bending = 16.5e9 * 0.5 * size[along] * size[1 - along].powi(3) / 12.0;
    let stiffness = generated.model.curves[curve].stiffness_nm_rad;
    assert!((stiffness * height / (6.0 * bending) - 1.0).abs() < 1e-9, "{stiffness}");
    let carry = springs[2].carry_over.as_ref().unwrap();
    assert_eq!((carry.bushing.as_str(), carry.flexibility_rad_nm[1 - along]), ("W1.bottom-1", 0.0));
    let both = 2.0 / (1.0 / stiffness + 2.0 * carry.flexibility_rad_nm[along]);
    assert!((both * height / (4.0 * bending) - 1.0).abs() < 1e-9, "{both}");
    let mut still = generated.model.clone();
    still.events.clear();
    still.settings.end_time_s = 0.1;
    let moved = moved_m(&still);
    assert!(moved < 1e-5, "{moved}");
}

/// A wall between two rows of columns stands on the seam between the pieces of these: each of them bears half of its springs, and the building moves as its mirror image does. (With all of a spring on one of the pieces
/// the other lay loose against the wall.)
#[test]
fn a_wall_on_a_seam_stands_on_the_pieces_at_both_of_its_sides() {
    let wall = "\n[[members]]\nid = \"W2\"\nkind = \"wall\"\nsection = \"slab\"\nfrom = [1, 2.5, 3.5]\nto = [5, 2.5, 6.75]\n\n[[events]]";
    let model = |row: &str| {
        let building = reference(|t| {
            let t = t.replacen("\n[[events]]", wall, 1);
            t.replace("member = \"C1-A1\"", &format!("member = \"C1-A{row}\""))
                .replace("member = \"C1-B1\"", &format!("member = \"C1-B{row}\""))
        });
        let (rules, mut store, _cache) = knowledge();
        let wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Balanced };
        generate(&building, &rules, &mut store, wishes, &|_| {}).unwrap().model
    };
    let mut front = model("1");
    let springs: Vec<&Bushing> = front.bushings.iter().filter(|b| b.id.starts_with("W2.")).collect();
    let ids: Vec<&str> = springs.iter().map(|b| b.id.as_str()).collect();
    assert_eq!(ids[..4], ["W2.bottom-1a", "W2.bottom-1b", "W2.bottom-2a", "W2.bottom-2b"]);
    assert_eq!(ids[4..], ["W2.top-1a", "W2.top-1b", "W2.top-2a", "W2.top-2b"]);
    assert_ne!(springs[0].body_a, springs[1].body_a);
    let whole = 16.5e9 * 4.0 * 0.25 / (0.5 * 3.25);
    let sum: f64 = springs[..4].iter().map(|b| b.axial_stiffness_n_m).sum();
    assert!((sum / whole - 1.0).abs() < 1e-9, "{sum} {whole}");
    let Bending::Curve { curve, .. } = &springs[0].bending[0] else { panic!("elastic out of the plane") };
    let out_of_plane = 6.0 * 16.5e9 * 1.0 * 0.25_f64.powi(3) / 12.0 / 3.25;
    assert!((front.curves[curve].stiffness_nm_rad / out_of_plane - 1.0).abs() < 1e-9);
    let mut rear = model("2");
    let ends = [&mut front, &mut rear].map(|model| {
        model.settings.end_time_s = 0.8;
        let run = fallwerk::mbs::simulate(model).unwrap();
        let tops = ["C3-A1.top", "C3-A2.top"].map(|id| {
            let point = run.tracked.iter().find(|p| p.id == id).unwrap();
            *point.displacement_m.last().unwrap()
        });
        assert!(run.steps < 500, "{}", run.steps);
        tops
    });
    for (a, b) in ends[0].iter().zip(ends[1].iter().rev()) {
        let off = [a[0] - b[0], a[1] + b[1], a[2] - b[2]].iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        assert!(off < 1e-4, "{a:?} {b:?}");
    }
    assert!(ends[0][0][2] < -0.5, "it falls: {ends:?}");
}

/// A shaft of four walls that share vertical edges, one of which loses its foot: the others hold it, as they do in FE (shared nodes), and the tops of walls are tracked where nothing else is.
#[test]
fn walls_hold_each_other_at_vertical_edges() {
    let wall = |id: &str, from: [f64; 3], to: [f64; 3]| {
        format!(
            "[[members]]\nid = \"{id}\"\nkind = \"wall\"\nsection = \"slab\"\nfrom = {from:?}\nto = {to:?}\n\n"
        )
    };
    let mut members = String::new();
    for storey in 0..3 {
        let (low, high) = (3.0 * storey as f64, 3.0 * (storey + 1) as f64);
        members += &wall(&format!("E{storey}"), [3.0, 0.125, low], [3.0, 2.875, high]);
        members += &wall(&format!("W{storey}"), [0.0, 0.125, low], [0.0, 2.875, high]);
        members += &wall(&format!("N{storey}"), [-0.125, 3.0, low], [3.125, 3.0, high]);
        members += &wall(&format!("S{storey}"), [-0.125, 0.0, low], [3.125, 0.0, high]);
    }
    let building = reference(|text| {
        let (head, tail) = (text.find("[grid]").unwrap(), text.find("[[supports]]").unwrap());
        let text = format!("{}{members}{}", &text[..head], &text[tail..]);
        let events = text.find("[[events]]").unwrap();
        let rest = text[events..].find("[settings]").unwrap();
        let only = "[[events]]\nid = \"a\"\nmember = \"E0\"\ntime = 0\n\n";
        let text = format!("{}{only}{}", &text[..events], &text[events + rest..]);
        text.replacen("members = [\"C1-*\"]", "members = [\"*0\"]", 1)
    });
    let (rules, mut store, _cache) = knowledge();
    let generated = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap();
    let edges: Vec<&Bushing> = generated.model.bushings.iter().filter(|b| b.id.contains(".edge-")).collect();
    // four edges of two springs in each storey
    assert_eq!(edges.len(), 3 * 4 * 2);
    let one = edges.iter().find(|b| b.origin.members.contains(&"E1".to_string())).unwrap();
    let (area, apart) = (0.25 * 1.5, 0.5 * 0.25 + 0.5 * 2.75);
    assert!((one.axial_stiffness_n_m / (16.5e9 * area / apart) - 1.0).abs() < 1e-9, "{one:?}");
    assert!((one.compressive_capacity_n.unwrap() / (10.5e6 * area) - 1.0).abs() < 1e-9);
    let mut model = generated.model.clone();
    model.settings.end_time_s = 0.8;
    let run = fallwerk::mbs::simulate_carefully(&model).unwrap();
    assert_eq!(run.first_ground_contact_s, None);
    assert!(run.tracked.iter().any(|t| t.id == "E2.top"));
    let lowest = |u: &[[f64; 3]]| u.iter().map(|u| u[2]).fold(0.0, f64::min);
    let sunk = run.tracked.iter().map(|t| lowest(&t.displacement_m)).fold(0.0, f64::min);
    assert!(sunk > -0.005, "{sunk}");
}

/// Walls that stand on walls are joined once, over the length that they share, as stiff as half of both one behind the other, with what the thinner one bears. (Joined by the springs of each of them they bore twice as much.)
#[test]
fn a_wall_on_a_wall_is_joined_to_it_once() {
    let model = |upper: [f64; 2], section: &str, openings: &str| {
        let [from, to] = upper;
        model_of(&reference(|text| {
            let members = format!(
                "\n[sections.thin]\nkind = \"plate\"\nconcrete = \"C30\"\nsteel = \"B500\"\nlaw = \"RC\"\nthickness = 0.2\n\
                 mesh = {{ diameter = 0.01, spacing = 0.15, edge_distance = 0.03 }}\n\
                 [[members]]\nid = \"W1\"\nkind = \"wall\"\nsection = \"slab\"\nfrom = [8, 0, 0]\nto = [8, 4, 3]\n{openings}\n\
                 [[members]]\nid = \"W2\"\nkind = \"wall\"\nsection = \"{section}\"\nfrom = [8, {from}, 3]\nto = [8, {to}, 5]\n\n[[supports]]"
            );
            text.replacen("\n[[supports]]", &members, 1).replacen("[\"C1-*\"]", "[\"C1-*\", \"W1\"]", 1)
        }))
    };
    let both = |model: &Model, ids: &[&str], thickness_m: f64, length_m: f64| {
        let between: Vec<&Bushing> =
            model.bushings.iter().filter(|b| b.body_a.is_some() && b.id.starts_with('W')).collect();
        assert_eq!(between.iter().map(|b| b.id.as_str()).collect::<Vec<_>>(), ids);
        let stiffness: f64 = between.iter().map(|b| b.axial_stiffness_n_m).sum();
        let known = 16.5e9 * length_m / (0.5 * 3.0 / 0.25 + 0.5 * 2.0 / thickness_m);
        assert!((stiffness / known - 1.0).abs() < 1e-9, "{stiffness} {known}");
        // curves of the joint, not those of the other end of the wall
        let of_both = model.curves.keys().filter(|id| id.contains("W1") && id.contains("W2")).count();
        assert!(of_both > 0, "{:?}", model.curves.keys());
        let bears: f64 = between.iter().filter_map(|b| b.compressive_capacity_n).sum();
        assert!((bears / (10.5e6 * thickness_m * length_m) - 1.0).abs() < 1e-9, "{bears}");
    };
    both(&model([0.0, 4.0], "slab", ""), &["W2.bottom-1", "W2.bottom-2"], 0.25, 4.0);
    both(&model([1.0, 3.0], "slab", ""), &["W2.bottom-1", "W2.bottom-2"], 0.25, 2.0);
    both(&model([0.0, 4.0], "thin", ""), &["W2.bottom-1", "W2.bottom-2"], 0.2, 4.0);
    both(&model([-1.0, 5.0], "slab", ""), &["W1.top-1", "W1.top-2"], 0.25, 4.0);
    // where the lower one is open at its head the upper one has nothing to stand on
    let open = "openings = [{ from = [0.8, 2], to = [3.2, 3] }]";
    let ids = ["W1.top-1", "W1.top-2", "W1.top-3", "W1.top-4"];
    both(&model([0.0, 4.0], "slab", open), &ids, 0.25, 1.6);
}

/// The reference building with a wall between its rear columns that stands on the ground, 0.2 to 5.8 m along x and 3 m high.
fn with_wall(openings: &str) -> Building {
    let wall = format!(
        "\n[[members]]\nid = \"W1\"\nkind = \"wall\"\nsection = \"slab\"\nfrom = [0.2, 5, 0]\nto = [5.8, 5, 3]\n{openings}\n\n[[supports]]"
    );
    reference(|text| {
        text.replacen("\n[[supports]]", &wall, 1).replacen(
            "members = [\"C1-*\"]",
            "members = [\"C1-*\", \"W1\"]",
            1,
        )
    })
}

fn model_of(building: &Building) -> Model {
    let (rules, mut store, _cache) = knowledge();
    generate(building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap().model
}

/// All springs at an end of a wall along x, 3 m high and 0.25 m thick, are together as stiff and as strong as its half there with a contact face.
fn assert_bears(model: &Model, end: &str, face: &ContactFace) {
    let springs: Vec<&Bushing> = model.bushings.iter().filter(|b| b.id.starts_with(end)).collect();
    let sum = |of: &dyn Fn(&Bushing) -> f64| springs.iter().copied().map(of).sum::<f64>();
    let is = |what: &str, ours: f64, theirs: f64, within: f64| {
        assert!((ours / theirs - 1.0).abs() < within, "{what} of {end}: {ours}, not {theirs}");
    };
    let (youngs_pa, yield_pa, half_m, area) = (16.5e9, 10.5e6, 1.5, face.area_m2);
    is("axial stiffness", sum(&|b| b.axial_stiffness_n_m), youngs_pa * area / half_m, 1e-9);
    let shear = 5.0 / 6.0 * youngs_pa / 2.4 * area / half_m;
    is("shear stiffness", sum(&|b| b.shear_stiffness_n_m[1]), shear, 1e-9);
    is("strength", sum(&|b| b.compressive_capacity_n.unwrap()), yield_pa * area, 1e-9);
    let slips = yield_pa * area / 3.0_f64.sqrt();
    is("strength in shear", sum(&|b| b.shear_capacity_n.unwrap()[0]), slips, 1e-9);
    // in its plane: couples about the centroid, and what each spring bears itself
    let couple = |b: &Bushing| b.axial_stiffness_n_m * (b.point_m[0] - face.centroid_m[0]).powi(2);
    let own = |b: &Bushing| {
        let Bending::Elastic { stiffness_nm_rad } = b.bending[1] else {
            panic!("{} yields in its plane", b.id)
        };
        stiffness_nm_rad
    };
    let in_plane = youngs_pa * face.second_moments_m4[1] / half_m;
    is("in-plane stiffness", sum(&|b| couple(b) + own(b)), in_plane, 1e-9);
    // out of it: 6 E I / h of a beam in sway, and the moment at which two elements across yield in plane strain, with a hourglass stress as large as that in their centre
    let curve = |b: &Bushing| {
        let Bending::Curve { curve, .. } = &b.bending[0] else {
            panic!("{} is elastic out of its plane", b.id)
        };
        &model.curves[curve]
    };
    let sway = 6.0 * youngs_pa * face.second_moments_m4[0] / (2.0 * half_m);
    is("stiffness out of the plane", sum(&|b| curve(b).stiffness_nm_rad), sway, 1e-9);
    let flows = |b: &Bushing| {
        let level = curve(b).levels.iter().find(|l| l.axial_force_n == 0.0).unwrap();
        level.capacity[0][1]
    };
    let moment = 2.0 / 3.0_f64.sqrt() * yield_pa / (1.0_f64 + 1.0 / 2.4).sqrt() * area * 0.25 / 3.0;
    is("moment out of the plane", sum(&flows), moment, 0.01);
}

/// The springs of the wall at its foot and head stand for the faces that the structure graph finds there, in m², at places along x.
fn assert_stands(openings: &str, areas_m2: [f64; 2], at_m: [&[f64]; 2]) {
    let building = with_wall(&format!("openings = [{openings}]"));
    let structure = Structure::of(&building);
    let foot = &structure.supports().find(|s| s.member_id == "W1").unwrap().contact;
    let head = &structure.connection("W1.top/B1-A2-B2").unwrap().faces[0];
    let model = model_of(&building);
    for (k, (end, face)) in [("W1.bottom-", foot), ("W1.top-", head)].into_iter().enumerate() {
        assert!((face.area_m2 - areas_m2[k]).abs() < 1e-9, "{face:?}");
        assert_bears(&model, end, face);
        let springs: Vec<&Bushing> = model.bushings.iter().filter(|b| b.id.starts_with(end)).collect();
        assert_eq!(springs.len(), at_m[k].len());
        for (i, (spring, x)) in springs.iter().zip(at_m[k]).enumerate() {
            assert_eq!(spring.id, format!("{end}{}", i + 1));
            assert!((spring.point_m[0] - x).abs() < 1e-9, "{} at {:?}", spring.id, spring.point_m);
        }
    }
}

/// A door, a wider one, and a door beside an opening at the head. (Two springs at the quarter points of the whole wall had the strength of all of it, and stood in the doors.)
#[test]
fn a_wall_with_openings_bears_what_is_left_of_its_foot_and_head() {
    let door = "{ from = [1, 0], to = [2, \"2.1 m\"] }";
    assert_stands(door, [1.15, 1.4], [&[0.4, 0.8, 2.95, 4.85], &[0.4, 0.8, 1.25, 1.75, 2.95, 4.85]]);
    let wide = "{ from = [1, 0], to = [5, \"2.1 m\"] }";
    assert_stands(wide, [0.4, 1.4], [&[0.4, 0.8, 5.2, 5.6], &[0.4, 0.8, 2.0, 4.0, 5.2, 5.6]]);
    let both = format!("{door}, {{ from = [3, 2.5], to = [4, 3] }}");
    let feet = [0.4, 0.8, 2.25, 2.75, 3.25, 3.75, 4.45, 5.35];
    let heads = [0.4, 0.8, 1.25, 1.75, 2.25, 2.75, 4.45, 5.35];
    assert_stands(&both, [1.15, 1.15], [&feet, &heads]);
}

/// Piers are beams from foot to head; a lintel over a door has a head alone. Each pier stands on springs of its own, so that it makes no contact with the ground on which it stands: it touched it at 0 s, and without a door the building does at 1.765 s.
#[test]
fn piers_beside_a_door_stand_on_the_ground() {
    let [plain, door] =
        ["", "openings = [{ from = [1, 0], to = [2, \"2.1 m\"] }]"].map(|o| model_of(&with_wall(o)));
    let carried = |k: usize| {
        let top = door.bushings.iter().find(|b| b.id == format!("W1.top-{k}")).unwrap();
        top.carry_over.as_ref().map(|carry| carry.bushing.as_str())
    };
    let feet = [1, 2, 5, 6].map(carried);
    assert_eq!(feet, ["W1.bottom-1", "W1.bottom-2", "W1.bottom-3", "W1.bottom-4"].map(Some));
    assert_eq!([carried(3), carried(4)], [None, None]);
    let [without_s, with_s] = [plain, door].map(|mut model| {
        model.settings.end_time_s = 2.0;
        fallwerk::mbs::simulate(&model).unwrap().first_ground_contact_s.unwrap()
    });
    assert!((with_s / without_s - 1.0).abs() < 0.05, "{with_s} s with a door, {without_s} s without");
}
