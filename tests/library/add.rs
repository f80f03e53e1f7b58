//! Curves from tests and other programs.

use fallwerk::base::source::Source;
use fallwerk::library::add::entry_of;
use fallwerk::library::entry::{Direction, Loading};
use fallwerk::library::meta::{EXAMPLE, EXAMPLE_CURVE, json_schema};
use fallwerk::library::{Entry, EntryKind, Origin, Store};

fn made(curve: &str, meta: &str) -> Result<Entry, String> {
    entry_of(Source::new("curve.csv", curve), Source::new("meta.toml", meta))
        .map_err(|found| found.iter().map(|d| d.render(false)).collect())
}

#[test]
fn the_example_makes_an_entry_that_is_stored_and_read_back() {
    let entry = made(EXAMPLE_CURVE, EXAMPLE).unwrap();
    assert_eq!((entry.kind, entry.origin, entry.schema), (EntryKind::ColumnHinge, Origin::Test, 2));
    assert!(
        entry.key.starts_with("column_hinge/350x350-l1000-bottom-ground-fc35-r320-s75@"),
        "{}",
        entry.key
    );
    let forces: Vec<f64> = entry.axes[0].envelopes.iter().map(|l| l.axial_force_n).collect();
    assert_eq!(forces, [0.0, 600e3]);
    assert_eq!(entry.axes[0].envelopes[1].points[3], [0.025, 262e3]);
    assert_eq!(entry.validity.rotation_rad, Some([0.0, 0.06]));
    let source = entry.provenance.inputs.source.as_ref().unwrap();
    assert_eq!((source.loading, source.second_order_included), (Loading::Monotonic, false));
    let text = entry.to_text().unwrap();
    assert!(!text.contains("kinetic_energy_ratio") && !text.contains("mesh_size_m"), "absent, not zero");
    assert!(entry.hinge().unwrap_err().to_string().contains("about both axes"));
    let room = tempfile::tempdir().unwrap();
    Store::open(room.path()).unwrap().put(&entry).unwrap();
    assert_eq!(Store::open(room.path()).unwrap().get(&entry.key).unwrap(), entry);
    // What is said of a curve belongs to its inputs.
    let other = made(EXAMPLE_CURVE, &EXAMPLE.replace("75 mm", "150 mm")).unwrap();
    assert_ne!(other.provenance.inputs_hash, entry.provenance.inputs_hash);
}

#[test]
fn the_schema_knows_the_keys_of_the_example() {
    let schema = json_schema();
    let features = &schema["properties"]["features"]["properties"];
    for key in ["width", "depth", "tie_spacing", "concrete_strength"] {
        assert!(features[key].is_object() && EXAMPLE.contains(&format!("{key} =")), "{key}");
    }
    assert_eq!(schema["properties"]["origin"]["enum"], serde_json::json!(["test", "program"]));
}

#[test]
fn all_errors_of_both_files_come_at_once_with_place_and_remedy() {
    let curve = "rotaton [mrad], moment [kNmm], axial force\n1,2,3\n";
    let meta = "schema = 1\nkind = \"colum_hinge\"\norigin = \"test\"\n[features]\nwidth = \"350 MPa\"\ndepht = 0.3\n\
                [source]\ncitation = \"x\"\n[loading]\nkind = \"monotonic\"\nsecond_order = \"no\"\n";
    let told = made(curve, meta).unwrap_err();
    for words in [
        "unknown column `rotaton`",
        "did you mean `rotation`?",
        "`kNmm` is no unit of `moment`",
        "the column `axial force` has no unit",
        "--> curve.csv:1:1",
        "`colum_hinge` is no `kind`",
        "did you mean `column_hinge`?",
        "unknown key `depht`",
        "the source needs the key `by`",
        "`no` is no `second_order`",
        "--> meta.toml:",
    ] {
        assert!(told.contains(words), "{words}\n{told}");
    }
}

#[test]
fn rows_are_checked_one_by_one() {
    let header = "rotation [rad]; moment [N m]; axial force [kN]\n";
    let told = |rows: &str| made(&format!("{header}{rows}"), EXAMPLE).unwrap_err();
    let back = told("0;0;0\n0.01;100;0\n0.005;90;0\n");
    assert!(
        back.contains("the rotation goes back, from 0.01 to 0.005") && back.contains("curve.csv:4:1"),
        "{back}"
    );
    assert!(back.contains("envelope (backbone)"), "{back}");
    let words = told("0;0;0\n0,01;100;0\nx;1;0\n");
    assert!(
        words.contains("the decimal separator is a point: `0.01`") && words.contains("`x` is no number"),
        "{words}"
    );
    assert!(told("0;0\n").contains("2 cells in a row of a table with 3 columns"));
    assert!(told("").contains("no row below the header"));
    assert!(told("0;0;0\n").contains("a curve of a single point"));
    assert!(told("-0.01;0;0\n0.01;1;0\n").contains("begins at a negative rotation"));
    assert!(told("0;0;0\n0.01;-100;0\n").contains("makes no resistance curve"));
    let nan = told("0;0;0\n0.01;nan;0\n");
    assert!(nan.contains("`nan` is no number") && nan.contains("leave out rows"), "{nan}");
    assert!(!nan.contains("decimal separator"), "{nan}");
}

/// One wrong sign, or a first row that is missing, changes the stiffness of all levels.
#[test]
fn curves_begin_at_the_origin_and_resist_their_rotation() {
    let curve = |rows: &str| format!("rotation [mrad], moment [kN m], axial force [kN]\n{rows}");
    let told = |rows: &str| made(&curve(rows), EXAMPLE).unwrap_err();
    let wrong = told("0,0,0\n4,98,0\n10,-142,0\n60,80,0\n");
    assert!(wrong.contains("a moment of -142000 N m") && wrong.contains("curve.csv:4:1"), "{wrong}");
    let late = told("4,98,0\n10,142,0\n60,80,0\n");
    assert!(late.contains("begins at 0.004 rad and 98000 N m") && late.contains("curve.csv:2:1"), "{late}");
    assert!(told("0,5,0\n10,142,0\n60,80,0\n").contains("begins at 0 rad and 5000 N m"));
    // past the peak the axial force may turn a member further, if the moments include that
    let falls = curve("0,0,0\n4,98,0\n10,142,0\n60,-8,0\n");
    assert!(made(&falls, EXAMPLE).unwrap_err().contains("a moment of -8000 N m"));
    let included = EXAMPLE.replace("\"not_included\"", "\"included\"");
    assert_ne!(included, EXAMPLE);
    let entry = made(&falls, &included);
    assert!(!entry.as_ref().is_err_and(|e| e.contains("a moment of")), "{entry:?}");
}

/// An entry holds where both of its axes do.
#[test]
fn an_entry_holds_at_the_axial_forces_of_both_axes() {
    let curve = |forces: &[(u8, u32)]| {
        let level = |(axis, force): &(u8, u32)| {
            format!("{axis},0,0,{force}\n{axis},4,98,{force}\n{axis},10,176,{force}\n{axis},60,80,{force}\n")
        };
        let rows: String = forces.iter().map(level).collect();
        made(&format!("axis, rotation [mrad], moment [kN m], axial force [kN]\n{rows}"), EXAMPLE).unwrap()
    };
    let entry = curve(&[(1, 0), (1, 600), (2, 300), (2, 900)]);
    assert_eq!(entry.validity.axial_force_n, [300e3, 600e3]);
    assert!(fallwerk::library::add::doubts(&entry).is_empty());
    let told = fallwerk::library::add::doubts(&curve(&[(1, 0), (2, 600)]));
    assert!(told.len() == 1 && told[0].contains("no axial force is known about both"), "{told:?}");
}

/// Newtons where kilonewtons are meant make no impossible entry, but one that is hardly meant.
#[test]
fn axial_forces_next_to_nothing_are_doubted() {
    let curve = |force: &str| {
        format!("rotation [mrad], moment [kN m], axial force [N]\n0,0,{force}\n4,98,{force}\n60,80,{force}\n")
    };
    let doubts = |force: &str| fallwerk::library::add::doubts(&made(&curve(force), EXAMPLE).unwrap());
    let told = doubts("600");
    assert!(told.len() == 1 && told[0].contains("is it N where kN is meant?"), "{told:?}");
    assert!(doubts("0").is_empty() && doubts("600000").is_empty());
}

/// A header with the wrong unit makes numbers that no member has.
#[test]
fn implausible_numbers_and_empty_sources_are_refused() {
    let told = |curve: &str| made(curve, EXAMPLE).unwrap_err();
    let curve = |rotation: &str, moment: &str| {
        format!("rotation [{rotation}], moment [{moment}], axial force [kN]\n0,0,0\n4,98,0\n60,80,0\n")
    };
    assert!(made(&curve("mrad", "kN m"), EXAMPLE).is_ok());
    let words = told(&curve("rad", "kN m"));
    assert!(words.contains("a rotation of 60 rad") && words.contains("check the units"), "{words}");
    assert!(told(&curve("mrad", "MN m")).contains("a largest moment of 98000000 N m"));
    assert!(told(&curve("mrad", "N m")).contains("a largest moment of 98 N m"));
    let force = curve("mrad", "kN m").replace("80,0", "80,4e6");
    assert!(
        told(&force.replace("4,98,0", "4,98,4e6").replace("0,0,0", "0,0,4e6")).contains("an axial force of")
    );
    let spring = EXAMPLE.replace("\"column_hinge\"", "\"axial_spring\"");
    let told = |curve: &str| made(curve, &spring).unwrap_err();
    assert!(told("displacement [m], force [kN]\n0,0\n1,100\n20,90\n").contains("a displacement of 20 m"));
    assert!(told("displacement [mm], force [MN]\n0,0\n1,1e6\n").contains("a force of"));
    let nobody = EXAMPLE.replace("by = \"nobody\"", "by = \" \"");
    let words = made(EXAMPLE_CURVE, &nobody).unwrap_err();
    assert!(words.contains("`by` is empty") && words.contains("by = \" \""), "{words}");
}

#[test]
fn curve_and_description_must_fit_together() {
    let springs = "displacement [mm], force [kN]\n-2,-30\n-1,-20\n0,0\n1,100\n5,140\n";
    let told = made(springs, EXAMPLE).unwrap_err();
    assert!(told.contains("a `column_hinge` has a curve of moment over rotation"), "{told}");
    let told = made("rotation [%], moment [kNm]\n0,0\n1,100\n2,90\n", EXAMPLE).unwrap_err();
    assert!(
        told.contains("the axial force is not known") && told.contains("add `axial_force = \"0 kN\"`"),
        "{told}"
    );
    let twice = EXAMPLE.replace("# axial_force = \"600 kN\"", "axial_force = \"600 kN\"");
    assert!(made(EXAMPLE_CURVE, &twice).unwrap_err().contains("given twice"));
    let end = EXAMPLE.replace("end = \"bottom\"", "end = \"lower\"");
    let told = made(EXAMPLE_CURVE, &end).unwrap_err();
    assert!(told.contains("a `column_hinge` has no `lower` end") && told.contains("write `bottom` or `top`"));
    let program = EXAMPLE.replace("origin = \"test\"", "origin = \"program\"");
    assert!(made(EXAMPLE_CURVE, &program).unwrap_err().contains("needs the key `program`"));
    let entry = made(springs, &EXAMPLE.replace("\"column_hinge\"", "\"axial_spring\"")).unwrap();
    assert_eq!((entry.springs[0].direction, entry.axes.len()), (Direction::Axial, 0));
    assert!(
        (entry.springs[0].stiffness_n_m - 1e8).abs() < 1.0,
        "secant to 70 kN: {}",
        entry.springs[0].stiffness_n_m
    );
    assert_eq!(entry.validity.displacement_m, Some([-0.002, 0.005]));
}

#[test]
fn a_second_axis_and_the_parts_of_a_joint_make_a_hinge() {
    let curve = "axis, rotation [mrad], moment [kN m], axial force [kN]\n1,0,0,0\n1,5,100,0\n1,50,90,0\n\
                 2,0,0,0\n2,5,80,0\n2,50,70,0\n";
    let hinge = "[hinge]\naxial_stiffness_n_m = 3.1e9\nshear_stiffness_n_m = [1.1e8, 1.2e8]\n\
                 torsional_stiffness_nm_rad = 4.4e7\noffset = \"0.2 m\"\n";
    let entry = made(curve, &format!("{EXAMPLE}\n{hinge}")).unwrap();
    let parts = entry.hinge().unwrap();
    assert_eq!((parts.offset_m, parts.stiffness.shear_n_m), (0.2, [1.1e8, 1.2e8]));
    assert!(parts.axes[0].curve.peak_nm() > parts.axes[1].curve.peak_nm());
}
