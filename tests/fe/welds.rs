//! Gaps of a building are gaps of its mesh, or the mesh is refused.

use fallwerk::base::tree::Format;
use fallwerk::building::{Building, EXAMPLE, parse, read};
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::run::{FeError, FeOptions, run};
use fallwerk::fe::weld::{Welds, check};
use std::path::Path;

/// The reference building with further members and settings; the right edge of its slabs is at x = 6.2 m, the soffit of the first at 3.25 m.
fn building(members: &str, mesh: &str) -> Building {
    let text = EXAMPLE.replacen("[[supports]]", &format!("{members}\n[[supports]]"), 1) + mesh;
    parse(&text, Format::Toml, "a.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn bar(id: &str, kind: &str, from: [f64; 3], to: [f64; 3]) -> String {
    let section = if kind == "column" { "column" } else { "beam" };
    format!(
        "[[members]]\nid = \"{id}\"\nkind = \"{kind}\"\nsection = \"{section}\"\nfrom = {from:?}\nto = {to:?}\n\n"
    )
}

/// A column of its own beside the building, as far from the first slab.
fn beside(gap_m: f64, mesh: &str) -> Building {
    let x = 6.4 + gap_m;
    building(&bar("C1-X", "column", [x, 2.5, 0.0], [x, 2.5, 3.5]), mesh)
}

fn check_at(building: &Building, size_m: f64) -> Result<(), Welds> {
    check(building, &Mesh::of(building, size_m).0, size_m)
}

#[test]
fn a_gap_closed_by_the_mesh_is_refused() {
    let joint = beside(0.05, "");
    let welds = check_at(&joint, 0.4).unwrap_err();
    let slab = welds.pairs.iter().find(|w| w.members == ["S1", "C1-X"]).unwrap_or_else(|| panic!("{welds}"));
    assert!((slab.gap_m - 0.05).abs() < 1e-9 && (slab.size_below_m - 0.2).abs() < 1e-9, "{slab:?}");
    let options = FeOptions { end_time_s: Some(0.01), ..FeOptions::default() };
    let error = run(&joint, &options, &mut |_| ()).unwrap_err();
    let words = error.to_string();
    assert!(matches!(error, FeError::Welded(_)) && error.is_input(), "{words}");
    for word in ["`S1` and `C1-X` (50.0 mm", "mesh size of 0.4 m", "below 0.200 m", "[[mesh.refine]]"] {
        assert!(words.contains(word), "{word}: {words}");
    }
}

#[test]
fn a_gap_stays_open_in_fine_elements() {
    check_at(&beside(0.05, ""), 0.19).unwrap_or_else(|e| panic!("{e}"));
    check_at(&beside(0.25, ""), 0.4).unwrap_or_else(|e| panic!("{e}"));
    let below = |gap_m: f64| building(&bar("C1-X", "column", [3.0, 2.5, 0.0], [3.0, 2.5, 3.25 - gap_m]), "");
    check_at(&below(0.0), 0.4).unwrap_or_else(|e| panic!("{e}"));
    assert!(check_at(&below(0.002), 0.4).is_err());
}

/// One of the members beside the gap in finer elements is enough; the mesh is the coarse one elsewhere.
#[test]
fn refinement_of_a_member_keeps_its_gaps_open() {
    let refined = |size: f64| {
        beside(0.05, &format!("\n[[mesh.refine]]\nmembers = [\"C1-X\"]\nsize = {size}\nends = 0.4\n"))
    };
    check_at(&refined(0.19), 0.4).unwrap_or_else(|e| panic!("{e}"));
    assert!(check_at(&refined(0.21), 0.4).is_err(), "a quarter of it is more than the gap");
    let (mesh, _) = Mesh::of(&refined(0.19), 0.4);
    let column = mesh.parts.iter().position(|p| p == "C1-X").unwrap();
    let of = |own: bool| {
        let elements = mesh.elements.iter().filter(move |e| (e.part == column) == own);
        elements.flat_map(|e| e.nodes).collect::<std::collections::BTreeSet<_>>()
    };
    assert!(of(true).is_disjoint(&of(false)));
}

/// A column with a mesh of its own ends 30 mm below the slab: its head is not tied to it.
#[test]
fn a_tie_across_a_gap_is_refused() {
    let tied = |top: f64| {
        let columns = bar("C1-X", "column", [2.9, 2.5, 0.0], [2.9, 2.5, top])
            + &bar("C1-Y", "column", [3.05, 1.3, 0.0], [3.05, 1.3, top]);
        building(&columns, "\n[mesh]\ntie_below = 0.2\n")
    };
    check_at(&tied(3.5), 0.4).unwrap_or_else(|e| panic!("{e}"));
    let welds = check_at(&tied(3.22), 0.4).unwrap_err();
    let pairs: Vec<&[String; 2]> = welds.pairs.iter().map(|w| &w.members).collect();
    assert_eq!(pairs, [&["S1", "C1-X"], &["S1", "C1-Y"]]);
    assert!(welds.pairs.iter().all(|w| (w.gap_m - 0.03).abs() < 1e-9), "{welds}");
}

/// Two beams narrower than the column whose faces they meet share its edge in the mesh; the column is between them.
#[test]
fn what_a_third_member_joins_is_no_gap() {
    let members = bar("C1-X", "column", [3.0, 2.5, 0.0], [3.0, 2.5, 3.25])
        + &bar("BX", "beam", [3.2, 2.5, 3.5], [5.85, 2.5, 3.5])
        + &bar("BY", "beam", [3.0, 2.7, 3.5], [3.0, 4.85, 3.5]);
    check_at(&building(&members, ""), 0.4).unwrap_or_else(|e| panic!("{e}"));
}

/// A column that passes through an opening of the slab, 60 mm off its edges.
#[test]
fn a_gap_in_an_opening_is_one() {
    let with_opening = |half_m: f64| {
        let [x, y] = [[3.0 - half_m, 3.0 + half_m], [2.5 - half_m, 2.5 + half_m]];
        let opening =
            format!("slab_openings = [{{ from = [{}, {}], to = [{}, {}] }}]", x[0], y[0], x[1], y[1]);
        let text = EXAMPLE.replacen("slab_section =", &format!("{opening}\nslab_section ="), 1);
        let column = bar("C1-X", "column", [3.0, 2.5, 0.0], [3.0, 2.5, 3.5]);
        let text = text.replacen("[[supports]]", &format!("{column}[[supports]]"), 1);
        parse(&text, Format::Toml, "a.toml").unwrap_or_else(|e| panic!("{e}"))
    };
    check_at(&with_opening(0.35), 0.4).unwrap_or_else(|e| panic!("{e}"));
    let welds = check_at(&with_opening(0.26), 0.4).unwrap_err();
    assert_eq!(welds.pairs.len(), 1, "{welds}");
    assert!((welds.pairs[0].gap_m - 0.06).abs() < 1e-9, "{welds}");
}

#[test]
fn the_buildings_of_the_repository_have_no_gap_that_their_mesh_closes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("buildings");
    let mut count = 0;
    for folder in [folder.clone(), folder.join("heldout")] {
        for file in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if file.extension().is_none_or(|e| e != "toml") {
                continue;
            }
            let building = read(&file).unwrap_or_else(|e| panic!("{e}"));
            let checked = check_at(&building, building.settings.mesh_size_m);
            checked.unwrap_or_else(|e| panic!("{}: {e}", file.display()));
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}
