//! `fallwerk library diff`: numbers one by one, curves by their peaks and the distance of their lines.

use super::commands::fallwerk;
use super::{computed, features, law};
use fallwerk::library::entry::{Adjoining, Branch, ColumnEnd};
use fallwerk::library::{Entry, EntryKind, Inputs, Origin, Store};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// What is told of the two entries of a library, in words and as JSON.
fn told(library: &Path) -> (String, Value) {
    let keys = Store::open_to_read(library).unwrap().keys();
    let [first, second] = keys.as_slice() else { panic!("{keys:?}") };
    let (code, words, err) = fallwerk(library, &["diff", first, second]);
    assert_eq!(code, 0, "{err}");
    let (_, json, _) = fallwerk(library, &["diff", first, second, "--json"]);
    (words, serde_json::from_str(&json).unwrap())
}

fn line<'a>(words: &'a str, beginning: &str) -> &'a str {
    words.lines().find(|line| line.trim_start().starts_with(beginning)).unwrap_or_else(|| panic!("{words}"))
}

#[test]
fn springs_are_compared_by_their_lines_and_stiffnesses() {
    let room = tempfile::tempdir().unwrap();
    let library = room.path().join("library");
    let meta = room.path().join("m.toml");
    let text = "schema = 1\nkind = \"shear_spring\"\norigin = \"test\"\n[features]\nwidth = \"350 mm\"\ndepth = \"350 mm\"\n\
                [source]\ncitation = \"x\"\nby = \"y\"\n\
                [loading]\nkind = \"monotonic\"\nsecond_order = \"not_included\"\ndirection = \"shear_1\"\n";
    fs::write(&meta, text).unwrap();
    for (name, peak) in [("a.csv", 100), ("b.csv", 200)] {
        let curve = room.path().join(name);
        let rows = format!("-5,-{peak}\n-1,-{peak}\n0,0\n1,{peak}\n5,{peak}\n");
        fs::write(&curve, format!("displacement [mm], force [kN]\n{rows}")).unwrap();
        let [curve, meta] = [&curve, &meta].map(|path| path.to_str().unwrap());
        assert_eq!(fallwerk(&library, &["add", curve, "--meta", meta]).0, 0);
    }
    let (words, json) = told(&library);
    assert!(line(&words, "springs[shear1].stiffness_n_m").contains(" %)"), "{words}");
    let row = line(&words, "shear1");
    assert!(row.contains("100.00") && row.contains("200.00") && row.ends_with("50.00 %"), "{words}");
    let rows = json["curves"].as_array().unwrap();
    let mut peaks = ["first_peak_n", "second_peak_n"].map(|name| rows[0][name].as_f64().unwrap());
    peaks.sort_by(f64::total_cmp);
    assert_eq!((rows.len(), peaks, &rows[0]["distance"]), (1, [1e5, 2e5], &0.5.into()), "{json}");
}

/// A hinge whose other sense of rotation has this share of the strength and stiffness of the first.
fn hinge(version: u32, share: f64) -> Entry {
    let law = law(12e6);
    let features = features(0.3, ColumnEnd::Bottom, Adjoining::Ground, &law);
    let mut computed = computed(0, 2, 10);
    let axis = &mut computed.axes[0];
    let mut reverse = Branch { envelopes: axis.envelopes.clone(), curve: axis.curve.clone() };
    reverse.envelopes.iter_mut().flat_map(|level| &mut level.points).for_each(|point| point[1] *= share);
    reverse.curve.stiffness_nm_rad *= share;
    axis.reverse = Some(reverse);
    let inputs = Inputs { law: Some(law), submodel_version: Some(version), ..Inputs::default() };
    Entry::new(EntryKind::ColumnHinge, Origin::Submodel, features, inputs, computed).unwrap()
}

#[test]
fn the_other_sense_of_rotation_and_stiffnesses_are_compared() {
    let room = tempfile::tempdir().unwrap();
    Store::open(room.path()).unwrap().put_all(&[hinge(1, 0.8), hinge(2, 0.4)]).unwrap();
    let (words, json) = told(room.path());
    let stiffness = line(&words, "axes[0].reverse.curve.stiffness_nm_rad");
    assert!(stiffness.contains("(-50.00 %)") || stiffness.contains("(+100.00 %)"), "{words}");
    assert!(line(&words, "axis 1, other sense").ends_with("50.00 %"), "{words}");
    assert!(!words.contains("axes[0].curve") && !words.contains("axis 2, other"), "{words}");
    let distances: Vec<f64> =
        json["curves"].as_array().unwrap().iter().map(|row| row["distance"].as_f64().unwrap()).collect();
    assert_eq!(distances.len(), 6, "two axial forces of three lines: {json}");
    assert!(distances.iter().filter(|d| **d == 0.0).count() == 4, "{json}");
}
