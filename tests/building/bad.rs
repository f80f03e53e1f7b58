//! Malformed and absurd files: each must give exactly the messages of its snapshot.

use fallwerk::base::tree::Format;
use fallwerk::building::{inspect, read};
use std::path::{Path, PathBuf};

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/building/bad");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn messages_of_bad_files() {
    let files = files();
    assert!(files.len() >= 30);
    for path in files {
        let name = path.file_name().unwrap().to_str().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let inspection = inspect(&text, Format::of_path(&path).unwrap(), name);
        assert!(inspection.building.is_none(), "{name} was accepted");
        assert!(inspection.diagnostics.errors() > 0, "{name} has no error");
        let json = inspection.diagnostics.to_json();
        assert_eq!(json.as_array().unwrap().len(), inspection.diagnostics.items().len());
        let mut settings = insta::Settings::clone_current();
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| insta::assert_snapshot!(name, inspection.diagnostics.render(false)));
    }
}

/// Every error of a file at once, not only the first.
#[test]
fn errors_come_together() {
    let text = fallwerk::building::EXAMPLE
        .replace("kind = \"steel\" ", "kind = \"steal\" ")
        .replace("width = \"300 mm\"", "width = \"300 MPa\"")
        .replace("x = [0, 6] ", "x = [6, 0] ")
        .replace("friction = 0.5", "friktion = 0.5");
    let found = inspect(&text, Format::Toml, "a.toml").diagnostics;
    let codes: Vec<&str> = found.items().iter().map(|d| d.code).collect();
    assert_eq!(codes, ["unknown-word", "wrong-unit", "not-increasing", "unknown-key"]);
    for item in found.items() {
        assert!(!item.help.is_empty() || item.code == "wrong-unit", "{item:?}");
    }
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let message = |name: &str| read(&path(name)).unwrap_err().render(false);
    std::fs::write(path("house.toml"), "schema = 1").unwrap();
    assert!(message("huose.toml").contains("there is no such file"));
    assert!(message("huose.toml").contains("house.toml`?"));
    assert!(read(folder.path()).unwrap_err().render(false).contains("this is a directory"));
    std::fs::write(path("binary.toml"), [0x7f, b'E', b'L', b'F', 0xff, 0xfe, 0]).unwrap();
    assert!(message("binary.toml").contains("not a text file: byte 4"));
    std::fs::write(path("house.ifc"), "ISO-10303-21;").unwrap();
    assert!(message("house.ifc").contains("neither in .toml nor in .json"));
}

/// A wall or column that stands on the ground beside supported ones would sink onto it when the run begins.
#[test]
fn feet_without_a_support_are_told() {
    let text = fallwerk::building::EXAMPLE.replacen("members = [\"C1-*\"]", "members = [\"C1-A*\"]", 1);
    let found = inspect(&text, Format::Toml, "a.toml").diagnostics;
    let told = found.render(false);
    assert_eq!((found.errors(), found.warnings()), (0, 1), "{told}");
    assert!(told.contains("2 members stand on the ground without a support"), "{told}");
    assert!(told.contains("`C1-B1` and `C1-B2`"), "{told}");
}

/// What stands on a footing is held by it, and footings need supports wherever the ground is above their feet.
#[test]
fn footings_are_told_in_place_of_what_stands_on_them() {
    let footings = |held: &str| {
        let pad = |id: &str, x: i32| {
            format!(
                "[[members]]\nid = \"{id}\"\nkind = \"footing\"\nsection = \"slab\"\nfrom = [{}, -1, 0]\nto = [{}, 1, 0]\n\n",
                x - 1,
                x + 1
            )
        };
        let pads = format!("{}{}[[supports]]", pad("F1", 0), pad("F2", 6));
        let text = fallwerk::building::EXAMPLE.replacen("[[supports]]", &pads, 1).replacen(
            "members = [\"C1-*\"]",
            &format!("members = [\"C1-A2\", \"C1-B2\"{held}]"),
            1,
        );
        inspect(&text, Format::Toml, "a.toml").diagnostics.render(false)
    };
    let told = footings(", \"F1\", \"F2\"");
    assert!(!told.contains("without a support"), "{told}");
    let told = footings("");
    assert!(
        told.contains("2 members stand on the ground without a support") && told.contains("`F1` and `F2`"),
        "{told}"
    );
}

/// Stretches that end and begin at one place do not overlap, also where the place has another last digit.
#[test]
fn stretches_that_meet_do_not_overlap() {
    let found = |from: &str| {
        let text = fallwerk::building::EXAMPLE
            .replace("member = \"C1-A1\"", "member = \"C1-A1\"\nstretch = [0, 0.30000000000000004]")
            .replace("member = \"C1-B1\"", &format!("member = \"C1-A1\"\nstretch = [{from}, 0.6]"));
        inspect(&text, Format::Toml, "a.toml").diagnostics
    };
    assert_eq!(found("0.3").errors(), 0, "{}", found("0.3").render(false));
    let told = found("0.29").render(false);
    assert!(told.contains("of which 0.29 to 0.30000000000000004 m are already removed"), "{told}");
}

/// Two columns with a beam of 0.3 m and a slab over them, and what is said of it if the columns end at this level.
fn two_columns_up_to(level_m: f64) -> fallwerk::base::diagnostic::Diagnostics {
    let head = fallwerk::building::EXAMPLE.split("[grid]").next().unwrap().to_string();
    let column = |x: f64| {
        format!(
            "[[members]]\nid = \"C{x}\"\nkind = \"column\"\nsection = \"column\"\nfrom = [{x}, 0, 0]\nto = [{x}, 0, {level_m}]\n"
        )
    };
    let flat = |id: &str, from: &str, to: &str| {
        format!("[[members]]\nid = \"{id}\"\nkind = \"{id}\"\nsection = \"{id}\"\nfrom = {from}\nto = {to}\n")
    };
    let rest = "[[supports]]\nmembers = [\"C*\"]\n[ground]\nlevel = 0\nfriction = 0.5\n[[events]]\nid = \"e\"\nmember = \"C0\"\ntime = 0\n\
        [settings]\nend_time = \"1 s\"\noutput_interval = \"10 ms\"\nremoval_duration = 0\ngravity = 9.81\nmesh_size = 0.4\ncritical_strain_rate = 0.25\n";
    let text = [
        head,
        column(0.0),
        column(6.0),
        flat("beam", "[0, 0, 3.5]", "[6, 0, 3.5]"),
        flat("slab", "[-0.2, -0.2, 3.5]", "[6.2, 0.2, 3.5]"),
        rest.to_string(),
    ];
    inspect(&text.concat(), Format::Toml, "a.toml").diagnostics
}

/// Plans give clear heights: columns up to the soffit of their beams leave a part of the joint to no member.
#[test]
fn joints_that_no_member_fills_are_told() {
    for level_m in [3.5, 3.25] {
        let found = two_columns_up_to(level_m);
        assert!(found.items().is_empty(), "{level_m}: {}", found.render(false));
    }
    let told = two_columns_up_to(3.0).render(false);
    // over each column of 0.4 by 0.4 m the beam, 0.3 m wide, fills the half on its side of the axis, 0.25 m high below the slab
    let words =
        "2 columns end below the beams on them, and of the joints above them 0.05 m3 belong to no member";
    assert!(told.contains(words) && told.contains("`C0` and `C6`"), "{told}");
    assert!(
        told.contains("let columns end at the top of their beams, `C0` at 3.5 m in place of 3 m"),
        "{told}"
    );
}

/// The reference building, whose first slab has its soffit at 3.25 m, with a column up to a level in the middle of it, and further members.
fn told_of_column_up_to(level_m: f64, members: &str) -> String {
    let column = format!(
        "[[members]]\nid = \"C1-X\"\nkind = \"column\"\nsection = \"column\"\nfrom = [3, 2.5, 0]\nto = [3, 2.5, {level_m}]\n\n"
    );
    let more = format!("{column}{members}[[supports]]");
    let text = fallwerk::building::EXAMPLE.replacen("[[supports]]", &more, 1);
    inspect(&text, Format::Toml, "a.toml").diagnostics.render(false)
}

/// The mesh joins what stands 1 mm apart, load paths and multibody models do not: such a building is refused.
#[test]
fn gaps_narrower_than_any_joint_are_refused() {
    for level_m in [3.25, 3.249_999_5, 3.248, 3.2] {
        assert_eq!(told_of_column_up_to(level_m, ""), "0 warnings in a.toml\n", "{level_m}");
    }
    for (level_m, gap_mm) in [(3.24999, "0.01"), (3.2495, "0.5"), (3.249, "1")] {
        let told = told_of_column_up_to(level_m, "");
        let words = [
            format!(
                "error[narrow-gap]: the column `C1-X` and the slab `S1` are {gap_mm} mm apart, at (3.000, 2.500, 3.2"
            ),
            format!("its face is at z = {level_m} m"),
            "end `C1-X` at z = 3.25 m, or leave more than 1 mm between them".to_string(),
        ];
        for words in words {
            assert!(told.contains(&words), "{words}: {told}");
        }
        assert!(told.contains("1 error in"), "{told}");
    }
}

/// Beams that end inside a column are joined by it.
#[test]
fn narrow_gaps_inside_a_third_member_are_none() {
    let beam = |id: &str, from: f64, to: f64| {
        format!(
            "[[members]]\nid = \"{id}\"\nkind = \"beam\"\nsection = \"beam\"\nfrom = [{from}, 2.5, 3.5]\nto = [{to}, 2.5, 3.5]\n\n"
        )
    };
    let beams = beam("BX", 0.15, 2.99975) + &beam("BY", 3.00025, 5.0);
    let told = told_of_column_up_to(3.5, &beams);
    assert!(!told.contains("error"), "{told}");
    // the slab fills the upper half; the lower one is open over a column that ends under the beams
    let told = told_of_column_up_to(3.0, &beams);
    assert!(
        told.contains("the beam `BY` and the beam `BX` are 0.5 mm apart, at (3.000, 2.500, 3.250) m"),
        "{told}"
    );
}

/// Numbers in the units of drawings: MPa without the unit, centimetres, weights per volume.
#[test]
fn slips_of_units_are_told() {
    let told = |from: &str, to: &str| {
        let text = fallwerk::building::EXAMPLE.replacen(from, to, 1);
        assert_ne!(text, fallwerk::building::EXAMPLE, "{from}");
        inspect(&text, Format::Toml, "a.toml").diagnostics.render(false)
    };
    let stress = told("\"10.5 MPa\"", "10.5");
    assert!(stress.contains("`hardening` is 10.5 Pa, which is out of range"), "{stress}");
    assert!(stress.contains("did you mean `\"10.5 MPa\"`?"), "{stress}");
    let span = told("x = [0, 6]", "x = [0, 600]");
    assert!(span.contains("warning[long-span]: x axes are 600 m apart"), "{span}");
    assert!(span.contains("plain numbers are metres"), "{span}");
    let weight = told("density = \"2500 kg/m3\"", "density = 25");
    assert!(weight.contains("a weight of 25 kN/m3 is a density of about 2550 kg/m3"), "{weight}");
}

/// A footing whose top is at the level of the ground: a charge on it lets nothing fall.
#[test]
fn charges_on_footings_that_the_ground_replaces_are_told() {
    let told = |level: &str| {
        let footing = "[[members]]\nid = \"F1\"\nkind = \"footing\"\nsection = \"slab\"\nfrom = [-1, -1, 0]\nto = [1, 1, 0]\n\n[[supports]]";
        let text = fallwerk::building::EXAMPLE
            .replacen("[[supports]]", footing, 1)
            .replacen("members = [\"C1-*\"]", "members = [\"C1-A2\", \"C1-B*\", \"F1\"]", 1)
            .replacen("member = \"C1-A1\"", "member = \"F1\"", 1)
            .replacen("level = 0 ", &format!("level = {level} "), 1)
            .replacen("[grid]", "[grid]\nbase = 0", 1);
        inspect(&text, Format::Toml, "a.toml").diagnostics.render(false)
    };
    let flush = told("0");
    let words = "warning[charge-on-footing]: the charge `front-left` takes the footing `F1`, and `C1-A1` then stands on the ground, at 0 m";
    assert!(flush.contains(words), "{flush}");
    assert!(flush.contains("charge `C1-A1` in place of the footing"), "{flush}");
    let pit = told("-2");
    assert!(!pit.contains("charge-on-footing"), "{pit}");
}
