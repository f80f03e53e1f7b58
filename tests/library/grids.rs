//! The grids from which the shipped entries of the RC submodel are derived, and those entries.

use fallwerk::library::rc::{RC_AXIAL_SHARES, RcWanted, Symmetry};
use fallwerk::library::{Entry, Origin};
use fallwerk::rc::{RcSection, SeriesOptions, section_grid};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn library() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("library")
}

/// Grid files by name.
fn grids() -> Vec<(String, Vec<RcSection>)> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(library().join("grids"))
        .unwrap()
        .map(|f| f.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    let read = |path: &PathBuf| {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let sections = section_grid::read_file(path).unwrap_or_else(|found| {
            panic!("{name}: {}", found.iter().map(|d| d.render(false)).collect::<String>())
        });
        (name, sections)
    };
    files.iter().map(read).collect()
}

#[test]
fn the_grids_make_at_least_48_columns_and_each_entry_once() {
    let (mut keys, mut columns) = (BTreeSet::new(), 0);
    for (name, sections) in grids() {
        assert!(!sections.is_empty(), "{name}");
        for section in &sections {
            let options =
                SeriesOptions { axial_shares: RC_AXIAL_SHARES.to_vec(), ..SeriesOptions::default() };
            let wanted = RcWanted::of(section, &options).unwrap();
            assert!(keys.insert(wanted.key().unwrap()), "{name}: {} comes twice", section.name);
            if name.starts_with("columns") {
                columns += 1;
                // five bends an entry: the time that library/README.md states rests on it
                assert_eq!(Symmetry::of(section).directions_deg(), [90.0], "{}", section.name);
                let ratio = section.steel_m2() / section.input.area_m2();
                assert!((0.0099..0.0301).contains(&ratio) && (0.25..=0.7).contains(&section.input.size_m[0]));
            }
        }
    }
    assert!(columns >= 48, "{columns} columns");
}

/// Rotation that a curve must have been computed to if its section still bears something \[rad\].
const LEAST_ROTATION_RAD: f64 = 0.05;

/// Levels of an entry that end before [`LEAST_ROTATION_RAD`] without having failed.
fn short_levels(entry: &Entry) -> Vec<f64> {
    let branches = entry.axes.iter().flat_map(|a| {
        let reverse = a.reverse.as_ref().map(|b| b.envelopes.as_slice());
        [Some(a.envelopes.as_slice()), reverse].into_iter().flatten().flatten()
    });
    branches
        .filter(|l| {
            let last = l.points.last().map_or(0.0, |p| p[0]);
            l.fracture_rotation_rad.is_none() && last < LEAST_ROTATION_RAD - 1e-9
        })
        .map(|l| l.axial_force_n)
        .collect()
}

#[test]
fn shipped_curves_go_to_five_per_cent_or_to_a_fifth_of_their_peak() {
    let mut own = 0;
    for file in std::fs::read_dir(library().join("column_hinge")).unwrap() {
        let path = file.unwrap().path();
        let entry = Entry::from_text(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let mut cut = entry.clone();
        for level in cut.axes.iter_mut().flat_map(|a| &mut a.envelopes) {
            level.fracture_rotation_rad = None;
            level.points.truncate(2);
        }
        assert_eq!(short_levels(&cut).len(), entry.axes.iter().map(|a| a.envelopes.len()).sum::<usize>());
        if entry.origin == Origin::RcSubmodel {
            assert_eq!(short_levels(&entry), Vec::<f64>::new(), "{}", entry.key);
        }
        own += 1;
    }
    assert!(own >= 3, "{own} records");
}
