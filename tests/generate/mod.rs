//! The generated model of the reference building: what is in it, and that every part says why.

mod between;
mod carried;
mod charges;
mod events;
mod known;
mod lines;
mod overrides;
mod rates;
mod review;
mod rigid;
mod skipping;
mod stiffness;
mod stumps;
mod undemanded;
mod walls;
mod webs;

use fallwerk::base::tree::Format;
use fallwerk::building::partition::Partition;
use fallwerk::building::{Building, EXAMPLE, parse};
use fallwerk::generate::{Accuracy, Derive, GenerateError, Generated, Why, Wishes, generate};
use fallwerk::library::Store;
use fallwerk::mbs::latent::merge;
use fallwerk::mbs::model::{Bending, Broken, Bushing, Face, Met, Range, Trigger};
use fallwerk::rules::{Action, RuleBase};
use std::path::Path;

fn reference(change: impl Fn(String) -> String) -> Building {
    parse(&change(EXAMPLE.to_string()), Format::Toml, "reference").expect("the reference is sound")
}

fn knowledge() -> (RuleBase, Store, tempfile::TempDir) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let cache = tempfile::tempdir().unwrap();
    let rules = RuleBase::load(&root.join("rules")).expect("the shipped rules are sound");
    let store =
        Store::open_with_cache(&root.join("library"), cache.path()).expect("the shipped library is sound");
    (rules, store, cache)
}

/// How far tracked points of a model move at most \[m\].
fn moved_m(model: &fallwerk::mbs::model::Model) -> f64 {
    let run = fallwerk::mbs::simulate(model).unwrap();
    run.tracked.iter().flat_map(|p| &p.displacement_m).flatten().fold(0.0_f64, |a, u| a.max(u.abs()))
}

/// The shipped rules, but for floors that fold where their beams may yield and do not bend.
fn folding() -> RuleBase {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = RuleBase::sources(&root.join("rules")).expect("the shipped rules can be read");
    for source in &mut sources {
        source.text =
            source.text.replace("wish.accuracy in ['balanced', 'fine']", "wish.accuracy == 'balanced'");
    }
    sources.push(fallwerk::rules::Source {
        name: "folds.toml".into(),
        text: r#"
schema = 1

[[rule]]
id = "seed/test-floor-may-fold"
words = "A floor may fold wherever a beam may yield."
applies_to = "member_end"
when = "member.kind == 'beam' and wish.accuracy == 'fine' and end.demand_ratio > 0.5"
action = "latent_hinge"
priority = 14
source = "assumption: of this test"
"#
        .into(),
    });
    RuleBase::from_sources(sources).expect("sound rules")
}

fn generated(building: &Building) -> Result<Generated, GenerateError> {
    let (rules, mut store, _cache) = knowledge();
    generate(building, &rules, &mut store, Derive::Never, &|_| {})
}

#[test]
fn the_reference_needs_no_curve_that_is_not_shipped() {
    let model = generated(&reference(|t| t)).expect("the library holds all entries").model;
    assert_eq!(
        model.bodies.len(),
        2 + 10 * 2 + 3 * 4,
        "twelve columns, ten of them in two pieces, a piece of each floor to a column"
    );
    assert_eq!(
        model.bushings.len(),
        24 + 3 * 4 + 10,
        "both ends of twelve columns, the beams of three floors, and the sections of the columns that are not charged"
    );
    // where a floor bends the joint is its own: the column alone, as a cantilever from the hinge to its middle
    let hinge = model.bushings.iter().find(|b| b.id == "C1-A2.top").unwrap();
    let Bending::Curve { curve, .. } = &hinge.bending[0] else { panic!("elastic") };
    let arm = hinge.point_m[2] - 1.5;
    let [bending, shear] = [16.5e9 * 0.4_f64.powi(4) / 12.0, 5.0 / 6.0 * 16.5e9 / 2.4 * 0.16];
    let alone = arm * arm / (1.5_f64.powi(3) / (3.0 * bending) + 1.5 / shear);
    assert!((model.curves[curve].stiffness_nm_rad / alone - 1.0).abs() < 1e-9);
    assert_eq!(model.events.len(), 2);
    model.check().expect("a sound model");
}

#[test]
fn columns_and_walls_on_held_footings_stand_on_the_ground() {
    let text = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("buildings").join("six-storey.toml"),
    );
    let building = parse(&text.unwrap(), Format::Toml, "six-storey").expect("a sound building");
    let (rules, mut store, _cache) = knowledge();
    let wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Fast };
    let generated = generate(&building, &rules, &mut store, wishes, &|_| {}).unwrap();
    assert!(generated.model.bodies.iter().all(|b| !b.id.starts_with("F-")));
    for foot in ["C1-E3.bottom", "W1-b.bottom-1"] {
        let joint = generated.model.bushings.iter().find(|b| b.id == foot).unwrap();
        assert_eq!(joint.body_a, None, "{foot}");
    }
    assert!(generated.notes.iter().any(|n| n.starts_with("footings that are held")));
    // as long as they were bodies of their own there was no static equilibrium
    let mut still = generated.model;
    (still.events, still.settings.end_time_s) = (Vec::new(), 0.02);
    fallwerk::mbs::simulate(&still).expect("it stands before the charges");
}

#[test]
fn the_wish_for_accuracy_divides_spans_and_panels() {
    let (rules, mut store, _cache) = knowledge();
    let wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Fine };
    let model = generate(&reference(|t| t), &rules, &mut store, wishes, &|_| {}).unwrap().model;
    // each beam has a web in three pieces, and springs between these beside those of the pieces
    assert_eq!(model.bodies.len(), 2 + 10 * 2 + 3 * 9 + 12 * 3);
    let latent = model.bushings.iter().filter(|b| b.latent.is_some()).count();
    assert_eq!(latent, 10 + 12 * (3 * 2 + 2));
    assert_eq!(model.bushings.len(), 24 + 3 * 12 + 12 * 2 + latent);
    let mass = |m: &fallwerk::mbs::model::Model| m.bodies.iter().map(|b| b.mass_kg).sum::<f64>();
    let balanced = generated(&reference(|t| t)).unwrap().model;
    assert!((mass(&model) / mass(&balanced) - 1.0).abs() < 1e-12);
    model.check().expect("a sound model");
}

#[test]
fn bodies_carry_the_mass_and_inertia_of_the_solids() {
    let building = reference(|t| t);
    let model = generated(&building).unwrap().model;
    let volume: f64 = Partition::of(&building).volumes(building.members.len()).iter().sum();
    let mass: f64 = model.bodies.iter().map(|b| b.mass_kg).sum();
    assert!((mass / (2500.0 * volume) - 1.0).abs() < 1e-12);
    // a column: 0.4 x 0.4 x 3.0 m between slab and beam, the first storey's alike
    let latent: Vec<bool> = model.bushings.iter().map(|b| b.latent.is_some()).collect();
    let whole = merge(&model, &latent).model;
    let column = whole.bodies.iter().find(|b| b.id == "C1-A2/1").unwrap();
    let m: f64 = 2500.0 * 0.16 * 3.0;
    assert!((column.mass_kg - m).abs() < 1e-6);
    assert!((column.inertia_kg_m2[0][0] / (m * (0.16 + 9.0) / 12.0) - 1.0).abs() < 1e-9);
    assert!((column.inertia_kg_m2[2][2] / (m * 0.32 / 12.0) - 1.0).abs() < 1e-9);
    assert!((column.position_m[2] - 1.5).abs() < 1e-9);
}

#[test]
fn every_part_names_members_rules_and_entries() {
    let generated = generated(&reference(|t| t)).unwrap();
    let (rules, ..) = knowledge();
    for body in &generated.model.bodies {
        assert!(!body.origin.members.is_empty() && !body.origin.rules.is_empty(), "{}", body.id);
    }
    for joint in &generated.model.bushings {
        // the springs of a floor follow from the building, those of a column end from the library
        let is_floor = joint.beam.is_some();
        assert!(joint.origin.entries.is_empty() == is_floor, "{}", joint.id);
        assert!(joint.origin.rules.len() >= if is_floor { 1 } else { 2 }, "{}", joint.id);
        assert!(joint.origin.rules.iter().all(|r| rules.rule(r).is_some()));
    }
    for part in
        generated.model.bodies.iter().map(|b| &b.id).chain(generated.model.bushings.iter().map(|j| &j.id))
    {
        assert!(generated.trace.iter().any(|r| r.part == *part && !r.words.is_empty()), "{part}");
    }
}

/// Two pieces of a floor are joined by its slab and by the beam between them, not by the beam along the other edge of the first.
#[test]
fn joints_of_floors_name_what_goes_through_them() {
    let model = generated(&reference(|t| t)).unwrap().model;
    let named = |id: &str| &model.bushings.iter().find(|j| j.id == id).unwrap().origin.members;
    assert_eq!(*named("S1/1-1|S1/1-2"), ["B1-A1-A2", "S1", "S1:C1-A1|C1-A2"]);
    assert_eq!(*named("S1/1-1|S1/2-1"), ["B1-A1-B1", "S1", "S1:C1-A1|C1-B1"]);
}

#[test]
fn a_missing_curve_is_named_and_not_replaced() {
    let other = reference(|t| t.replace("[0, \"10.5 MPa\"]", "[0, \"11 MPa\"]"));
    match generated(&other) {
        Err(GenerateError::Missing { ends, .. }) => {
            assert!(ends.iter().any(|e| e.starts_with("C1")), "{ends:?}")
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_slow_removal_is_named_as_a_difference_between_the_models() {
    let building = {
        let mut b = reference(|t| t);
        b.settings.removal_duration_s = 0.02;
        b
    };
    let notes = generated(&building).unwrap().notes;
    assert!(notes.iter().any(|n| n.contains("0.02 s to remove")), "{notes:?}");
}

#[test]
fn without_rules_there_is_no_model() {
    let (_, mut store, _cache) = knowledge();
    let none = RuleBase::from_sources(Vec::new()).expect("no rules are no error");
    let error = generate(&reference(|t| t), &none, &mut store, Derive::Never, &|_| {}).unwrap_err();
    assert!(matches!(error, GenerateError::Gap(_)), "{error}");
}

/// The reference without its charges: it stands.
fn standing() -> Building {
    reference(|text| {
        let from = text.find("[[events]]").expect("events");
        let to = from + text[from..].find("\n\n\n").expect("the next chapter");
        format!("{}{}", &text[..from], &text[to..])
    })
}

#[test]
fn floors_of_a_building_that_stands_bend_about_its_columns() {
    let building = standing();
    let generated = generated(&building).unwrap();
    let model = &generated.model;
    assert_eq!(model.bodies.len(), 12 + 3 * 4, "twelve columns, a piece of each floor to a column");
    assert_eq!(model.bushings.len(), 24 + 3 * 4, "hinges at columns, and four springs in each floor");
    let volume: f64 = Partition::of(&building).volumes(building.members.len()).iter().sum();
    let mass: f64 = model.bodies.iter().map(|b| b.mass_kg).sum();
    assert!((mass / (2500.0 * volume) - 1.0).abs() < 1e-12);
    let spring = model.bushings.iter().find(|b| b.id == "S1/1-1|S1/2-1").expect("between the front columns");
    let (rules, ..) = knowledge();
    let elastic = |id: &String| rules.rule(id).is_some_and(|r| r.action == Action::MergeElastic);
    assert!(!spring.origin.rules.is_empty() && spring.origin.rules.iter().all(elastic));
    // a beam of 0.3 x 0.5 m with its flange, over the clear span: stiffer than its web, less than three times so
    let span = model.bodies.iter().find(|b| b.id == "C1-B1").unwrap().position_m[0]
        - model.bodies.iter().find(|b| b.id == "C1-A1").unwrap().position_m[0];
    let web = 16.5e9 * 0.3 * 0.5_f64.powi(3) / 12.0 / (span - 0.4);
    let Bending::Curve { curve, .. } = &spring.bending[0] else { panic!("{:?}", spring.bending) };
    let curve = &model.curves[curve];
    let stiffness = curve.stiffness_nm_rad / web;
    assert!((1.0..3.0).contains(&stiffness), "{stiffness}");
    // its ends are those of the beam and bear more than its web alone by plastic theory
    assert_eq!(spring.beam.as_ref().unwrap().ends, ["B1-A1-B1.start", "B1-A1-B1.end"]);
    let plastic = 10.5e6 * 0.3 * 0.5_f64.powi(2) / 4.0;
    let at_rest = curve.levels.iter().find(|l| l.axial_force_n == 0.0).unwrap().peak_nm();
    assert!((1.0..6.0).contains(&(at_rest / plastic)), "{at_rest} {plastic}");
    // at rest under dead load it stays there
    let mut still = model.clone();
    still.settings.end_time_s = 0.2;
    let run = fallwerk::mbs::simulate(&still).unwrap();
    let moved =
        run.tracked.iter().flat_map(|p| &p.displacement_m).flatten().fold(0.0_f64, |a, u| a.max(u.abs()));
    assert!(moved < 1e-5 && run.first_ground_contact_s.is_none(), "{moved}");
}

#[test]
fn curves_of_a_smaller_column_are_scaled_from_a_similar_one() {
    let building = reference(|text| {
        text.replacen("width = \"400 mm\" ", "width = \"350 mm\" ", 1).replacen(
            "depth = \"400 mm\" ",
            "depth = \"350 mm\" ",
            1,
        )
    });
    let (rules, mut store, _cache) = knowledge();
    let missing = generate(&building, &rules, &mut store, Derive::Never, &|_| {}).unwrap_err().to_string();
    assert!(missing.contains("--derive=similar"), "{missing}");
    let scaled = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap();
    assert!(scaled.derived.is_empty());
    let told = scaled.notes.iter().filter(|n| n.contains("curves scaled from column_hinge/400x400")).count();
    assert!(told >= 3, "{:?}", scaled.notes);
    let foot = scaled.model.bushings.iter().find(|b| b.id == "C1-A2.bottom").unwrap();
    let entry = &scaled.entries[&foot.origin.entries[0]];
    let own =
        store.keys().into_iter().find(|k| k.contains("400x400") && k.contains("bottom-ground")).unwrap();
    let from = store.get(&own).unwrap();
    assert_eq!(entry.provenance.inputs.settings["scaled_from"], own);
    let ratio = 350.0 / 400.0_f64;
    // the foot is as stiff about both axes and has the mean of what pushes about both gave
    let (a, b) = (from.axes[0].curve.between(&from.axes[1].curve, 0.5).unwrap(), &entry.axes[0].curve);
    for (x, y) in a.levels.iter().zip(&b.levels) {
        assert!((y.axial_force_n - ratio.powi(2) * x.axial_force_n).abs() < 1e-3);
        assert!((y.peak_nm() / x.peak_nm() / ratio.powi(3) - 1.0).abs() < 1e-7);
        assert!((y.fracture_rotation_rad / x.fracture_rotation_rad * ratio - 1.0).abs() < 1e-7);
    }
    scaled.model.check().expect("a sound model");
}

/// Moments go with `b h²` of the axis that they are about: a column of twice the area bears four times as much about one axis and twice as much about the other, and a building turned by a right angle has them the other way round.
#[test]
fn curves_of_a_rectangular_column_are_scaled_about_each_axis() {
    let (rules, mut store, _cache) = knowledge();
    for (sides, along) in [([400.0, 600.0], 0), ([600.0, 400.0], 1)] {
        let building = reference(|text| {
            let width = format!("width = \"{} mm\" ", sides[0]);
            let depth = format!("depth = \"{} mm\" ", sides[1]);
            text.replacen("width = \"400 mm\" ", &width, 1).replacen("depth = \"400 mm\" ", &depth, 1)
        });
        let scaled = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap();
        let foot = scaled.model.bushings.iter().find(|b| b.id == "C1-A2.bottom").unwrap();
        let entry = &scaled.entries[&foot.origin.entries[0]];
        let from = entry.provenance.inputs.settings["scaled_from"].as_str().unwrap();
        assert!(from.contains("400x400"), "{from}");
        let from = store.get(from).unwrap();
        let a = from.axes[0].curve.between(&from.axes[1].curve, 0.5).unwrap();
        for axis in 0..2 {
            // of the section, the first axis is along its width
            let depth = if axis == along { 1.5 } else { 1.0 };
            let b = &entry.axes[axis].curve;
            for (x, y) in a.levels.iter().zip(&b.levels) {
                assert!((y.axial_force_n - 1.5 * x.axial_force_n).abs() < 1e-3);
                assert!((y.peak_nm() / x.peak_nm() / (1.5 * depth) - 1.0).abs() < 1e-7, "{sides:?} {axis}");
                let rotation = y.fracture_rotation_rad / x.fracture_rotation_rad;
                assert!((rotation * depth - 1.0).abs() < 1e-7, "{sides:?} {axis}: {rotation}");
            }
        }
        assert!(scaled.notes.iter().any(|n| n.contains("width")), "{:?}", scaled.notes);
    }
}

#[test]
fn without_any_entry_the_curves_are_those_of_the_sections() {
    let building = reference(|text| text);
    let (rules, mut full, _cache) = knowledge();
    let empty = tempfile::tempdir().unwrap();
    let mut store = Store::open(empty.path()).unwrap();
    let of_sections = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap();
    assert!(
        of_sections.notes.iter().any(|n| n.contains("layer of elements by layer")),
        "{:?}",
        of_sections.notes
    );
    assert!(of_sections.doubts.iter().any(|d| d.why.iter().any(|w| matches!(w, Why::Scaled(..)))));
    let derived = generate(&building, &rules, &mut full, Derive::Never, &|_| {}).unwrap();
    let contact = |generated: &Generated| {
        let run = fallwerk::mbs::simulate_carefully(&generated.model).unwrap();
        run.first_ground_contact_s.expect("it falls")
    };
    let [own, other] = [contact(&of_sections), contact(&derived)];
    assert!((own / other - 1.0).abs() < 0.05, "{own} {other}");
}

#[test]
fn the_wish_for_speed_leaves_floors_in_one_body() {
    let scene = fallwerk::study::plan::Scene::of(1, 1);
    let building = parse(&scene.toml(), Format::Toml, "scene").expect("a sound building");
    let (rules, mut store, _cache) = knowledge();
    let mut floors = |accuracy| {
        let wishes = Wishes { derive: Derive::Similar, accuracy };
        let model = generate(&building, &rules, &mut store, wishes, &|_| {}).unwrap().model;
        model.bodies.iter().filter(|b| b.id.starts_with("S1")).count()
    };
    // the building stands, so that its floor bends unless few bodies count more
    assert_eq!(floors(Accuracy::Fast), 1);
    assert!(floors(Accuracy::Balanced) > 1);
    assert!(floors(Accuracy::Fine) >= floors(Accuracy::Balanced));
    assert_eq!(Accuracy::default(), Accuracy::Balanced);
}

/// In bending one way the springs along and across of a whole slab are a plate, `D = E t³ / (12 (1 - ν²))`, but for columns, over which strips are stiffer; `generate::panels` has the patch tests of all curvatures.
#[test]
fn a_slab_without_beams_is_a_plate_of_pieces_in_both_directions() {
    let building = reference(|t| t.replace("beams = \"perimeter\"", "beams = \"none\""));
    let (rules, mut store, _cache) = knowledge();
    let wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Balanced };
    let model = generate(&building, &rules, &mut store, wishes, &|_| {}).unwrap().model;
    let pieces = model.bodies.iter().filter(|b| b.id.starts_with("S1/")).count();
    assert_eq!(pieces, 9, "a piece to a column, to the middle of a span and to the middle of the panel");
    let slab = building.members.iter().find(|m| m.id == "S1").unwrap();
    let (size, law) = (slab.solid.size(), building.law_of(slab));
    let columns = ["C1-A1", "C1-B2"].map(|id| building.members.iter().find(|m| m.id == id).unwrap().solid);
    let stiffness = |b: &Bending| match b {
        Bending::Curve { curve, .. } => model.curves[curve].stiffness_nm_rad,
        Bending::Elastic { stiffness_nm_rad } => *stiffness_nm_rad,
    };
    let floor = |b: &&Bushing| b.id.starts_with("S1/");
    for axis in 0..2 {
        let side_m = 0.5 * (columns[1].center()[axis] - columns[0].center()[axis]);
        let at_m = columns[0].center()[axis] + 0.5 * side_m;
        let here = |b: &&Bushing| floor(b) && (b.point_m[axis] - at_m).abs() < 0.2;
        let (mut along, mut across, mut bending) = (0, 0, 0.0);
        for spring in model.bushings.iter().filter(here) {
            if spring.axial_stiffness_n_m == 0.0 {
                // a diagonal turns by `a² κ / L`
                let length_m = side_m / spring.axes[0][axis].abs();
                bending += stiffness(&spring.bending[0]) * (side_m * side_m / length_m).powi(2) / side_m;
                across += 1;
            } else if spring.axes[0][axis].abs() > 0.5 {
                bending += side_m
                    * spring.bending.iter().filter(|b| b.curve().is_some()).map(stiffness).sum::<f64>();
                along += 1;
            }
        }
        let plate = law.youngs_modulus_pa / (12.0 * (1.0 - law.poisson_ratio.powi(2)))
            * size[2].powi(3)
            * size[1 - axis];
        assert_eq!((along, across), (3, 4));
        let ratio = bending / plate;
        assert!((1.0..1.08).contains(&ratio), "{axis}: {ratio}");
    }
    model.check().expect("a sound model");
}

/// Pieces in the tangent planes of `w = c x y` at the axes, as in a panel whose corner gives way, meet without gaps, also at the edges, whose pieces lie on one side of their axis; so a floor is as stiff against
/// twist as [`a_slab_without_beams_is_a_plate_of_pieces_in_both_directions`] finds its springs.
#[test]
fn a_twisted_floor_has_no_gaps_between_its_pieces() {
    let (rules, mut store, _cache) = knowledge();
    let wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Balanced };
    for beams in ["none", "perimeter"] {
        let building = reference(|t| t.replace("beams = \"perimeter\"", &format!("beams = \"{beams}\"")));
        let model = generate(&building, &rules, &mut store, wishes, &|_| {}).unwrap().model;
        let columns =
            ["C1-A1", "C1-B2"].map(|id| building.members.iter().find(|m| m.id == id).unwrap().solid.center());
        let pieces = model.bodies.iter().filter(|b| b.id.starts_with("S1/")).count();
        let divisions = if pieces == 4 { 1.0 } else { 2.0 };
        let node = |id: &str| -> [f64; 2] {
            let cell: Vec<f64> =
                id["S1/".len()..].split('-').map(|k| k.parse::<f64>().unwrap() - 1.0).collect();
            std::array::from_fn(|i| columns[0][i] + (columns[1][i] - columns[0][i]) * cell[i] / divisions)
        };
        let mut count = 0;
        // springs across panels hold no points
        for spring in model.bushings.iter().filter(|b| b.id.starts_with("S1/") && b.axial_stiffness_n_m > 0.0)
        {
            let sides = [spring.body_a.as_deref().unwrap(), spring.body_b.as_str()].map(|id| {
                let [x, y] = node(id);
                x * spring.point_m[1] + y * spring.point_m[0] - x * y
            });
            assert!((sides[0] - sides[1]).abs() < 1e-9, "{beams} {}: {sides:?}", spring.id);
            count += 1;
        }
        assert_eq!(count, if pieces == 4 { 4 } else { 12 }, "{beams}");
    }
}

#[test]
fn elastic_stiffness_of_an_end_is_that_of_its_curves() {
    let building = reference(|t| t);
    let (_, store, _cache) = knowledge();
    let partition = Partition::of(&building);
    let (mesh, _) = fallwerk::fe::mesh::Mesh::of(&building, building.settings.mesh_size_m);
    let ends = fallwerk::building::ends::member_ends(&building, &partition);
    for id in ["C1-A2.bottom", "C1-A2.top", "C2-A2.bottom"] {
        let end = ends.iter().find(|e| e.id == id).unwrap();
        let wanted = fallwerk::library::derive::Wanted::of(&building, &partition, &mesh, end).unwrap();
        let entry = store.get(&wanted.key().unwrap()).expect("shipped");
        let own = fallwerk::rc::elastic::elastic(&wanted.model, entry.hinge_offset_m.unwrap()).unwrap();
        let axial = own.axial_n_m / entry.stiffness.unwrap().axial_n_m;
        // the axial stiffness of an entry is of a static state too, the rotational one the largest secant of pushes that take their time
        println!("{id}: axial {axial:.4} of the entry's");
        assert!((axial - 1.0).abs() < 0.005, "{id}: {axial}");
        for (axis, stiffness) in entry.axes.iter().zip(own.bending_nm_rad) {
            let ratio = stiffness / axis.curve.stiffness_nm_rad;
            println!("{id}: bending {ratio:.4}");
            assert!((0.99..1.005).contains(&ratio), "{id}: {ratio}");
        }
    }
}

#[test]
fn a_floor_without_curves_for_its_lines_stays_in_one_piece_where_curves_are_scaled() {
    let scene = fallwerk::study::plan::Scene::of(1, 26);
    let building = parse(&scene.toml(), Format::Toml, "scene").expect("a sound building");
    let (rules, (_, mut store, _cache)) = (folding(), knowledge());
    let mut fine = |derive| {
        let wishes = Wishes { derive, accuracy: Accuracy::Fine };
        generate(&building, &rules, &mut store, wishes, &|_| {})
    };
    let missing = fine(Derive::Never).unwrap_err().to_string();
    assert!(missing.contains("B1-A1-B1.start"), "{missing}");
    let scaled = fine(Derive::Similar).unwrap();
    // columns before its obstacle have sections, the floor has none
    assert!(scaled.model.bushings.iter().all(|b| b.latent.is_none() || b.id.contains(".section-")));
    let told: Vec<&String> = scaled.notes.iter().filter(|n| n.contains("stays in one piece")).collect();
    assert_eq!(told.len(), 1, "{:?}", scaled.notes);
    assert!(told[0].starts_with("S1 stays"), "{told:?}");
    scaled.model.check().expect("a sound model");
}
