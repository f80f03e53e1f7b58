//! The reference building to the end of its run, contact included: what its model is held to.

use super::commands::fallwerk;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The command of the quick start. Its results stay in the build folder (`tmp/three-storey-frame`).
#[test]
fn the_reference_building_is_followed_beyond_the_first_contact() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let building = root.join("buildings/three-storey-frame.toml");
    let building = building.to_str().unwrap();
    let (code, out, err) =
        fallwerk(root, &["generate-mbs", building, "--validate", "-o", folder.join(RUN).to_str().unwrap()]);
    assert_eq!(code, 0, "{out}{err}");
    let read = |name: &str| fs::read_to_string(folder.join(RUN).join(name)).unwrap();
    let validation: Value = serde_json::from_str(&read("validation.json")).unwrap();
    let figure = |name: &str| validation[name].as_f64().unwrap_or_else(|| panic!("{name}: {validation}"));
    assert!(figure("e_to_contact") <= 0.05, "{}", figure("e_to_contact"));
    assert!(figure("e_total") <= 0.15, "{}", figure("e_total"));
    assert!(figure("footprint_overlap") >= 0.8, "{}", figure("footprint_overlap"));
    // the whole lies between its parts
    let (to, after) = (figure("e_to_contact"), figure("e_after_contact"));
    assert!(to < figure("e_total") && figure("e_total") < after && after < 0.16, "{to} {after}");
    books_close(&read("fe-energies.csv"));
    let page = read("report.html");
    counts_never_fall(&page);
    hinges_without_a_zone_are_told(&page);
    for check in ["Displacement error over the whole run", "Debris footprint", "e after it"] {
        assert!(page.contains(check), "{check}");
    }
}

const RUN: &str = "three-storey-frame";

/// The columns of the energies are all that the balance has.
fn books_close(table: &str) {
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut preloaded_j = None;
    for line in lines {
        let numbers: Vec<f64> = line.split(',').map(|n| n.parse().unwrap()).collect();
        let sum = |of: &[&str]| -> f64 {
            of.iter().map(|name| numbers[names.iter().position(|n| n == name).unwrap()]).sum()
        };
        let there = sum(&["kinetic_j", "internal_j", "hourglass_j", "viscous_j"]);
        let supplied = sum(&["gravity_j", "contact_j", "friction_j", "removed_j", "released_j"]);
        let missing = there - supplied - sum(&["residual_j"]);
        assert!((missing - *preloaded_j.get_or_insert(there)).abs() < 1e-6 * there.abs(), "{line}");
    }
}

/// A hinge at a place that FE does not look at has its rotation all the same.
fn hinges_without_a_zone_are_told(page: &str) {
    let rows = page.split("FE not evaluated</td>").skip(1).map(|row| row.split("</tr>").next().unwrap());
    let rotations: Vec<&str> = rows.map(|row| row.rsplit("<td class=\"num\">").nth(1).unwrap()).collect();
    assert!(!rotations.is_empty() && rotations.iter().all(|r| !r.starts_with('–')), "{rotations:?}");
}

/// The captions of the MBS pictures say what has happened so far.
fn counts_never_fall(page: &str) {
    let captions = page.split("<figcaption><b>MBS</b> ").skip(1);
    let counts = captions.map(|c| {
        let hinges = c.split("hinges: ").nth(1).unwrap().split('<').next().unwrap();
        hinges.split(' ').filter_map(|word| word.parse().ok()).collect::<Vec<usize>>()
    });
    let counts: Vec<Vec<usize>> = counts.collect();
    assert!(counts.len() == 4 && counts.iter().all(|c| c.len() == 3), "{counts:?}");
    assert!(counts.windows(2).all(|w| w[0].iter().zip(&w[1]).all(|(a, b)| a <= b)), "{counts:?}");
    assert!(counts[3][0] > 0 && counts[3][2] > 0, "{counts:?}");
}
