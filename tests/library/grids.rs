//! The grids from which the shipped entries of the RC submodel are derived, and those entries.

use fallwerk::library::rc::{RC_AXIAL_SHARES, RcWanted, Symmetry};
use fallwerk::library::{Entry, EntryKind, Origin};
use fallwerk::rc::series::fibre_peak_nm;
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

/// Shipped entries of the RC submodel.
fn of_submodel() -> Vec<Entry> {
    let folders = ["column_hinge", "beam_hinge", "slab_yield_line"].map(|kind| library().join(kind));
    let files = folders.iter().flat_map(|f| std::fs::read_dir(f).unwrap());
    let read = |f: std::io::Result<std::fs::DirEntry>| {
        Entry::from_text(&std::fs::read_to_string(f.unwrap().path()).unwrap()).unwrap()
    };
    files.map(read).filter(|e| e.origin == Origin::RcSubmodel && e.deprecated.is_none()).collect()
}

/// A push that broke off before the section cracked through tells nothing of its strength; under tension that comes first. Fibres take a quarter of a second a level, so that of the
/// columns every fourth is looked at.
#[test]
fn shipped_levels_under_tension_bear_at_least_half_of_what_fibres_of_their_section_do() {
    let sections: Vec<RcSection> = grids().into_iter().flat_map(|(_, sections)| sections).collect();
    let (columns, floors): (Vec<Entry>, Vec<Entry>) =
        of_submodel().into_iter().partition(|e| e.kind == EntryKind::ColumnHinge);
    let mut looked_at = 0;
    for entry in floors.iter().chain(columns.iter().step_by(4)) {
        let section = of_entry(&sections, entry);
        // strips of slabs are stored for a metre
        let strips = entry.features.width_m / section.input.size_m[0];
        let axis = &entry.axes[0];
        let reverse = axis.reverse.iter().flat_map(|b| &b.envelopes).map(|l| (270.0, l));
        let levels = axis.envelopes.iter().map(|l| (90.0, l)).chain(reverse);
        for (direction_deg, level) in levels.filter(|(_, l)| l.axial_force_n < 0.0) {
            let peak_nm = level.points.iter().map(|p| p[1]).fold(0.0, f64::max) / strips;
            let fibre_nm = fibre_peak_nm(section, level.axial_force_n / strips, direction_deg).unwrap();
            let axial_kn = level.axial_force_n / 1e3;
            assert!(peak_nm > 0.5 * fibre_nm, "{} at {axial_kn} kN: {peak_nm} of {fibre_nm} N m", entry.key);
            looked_at += 1;
        }
    }
    assert!(looked_at > 25, "{looked_at} levels");
}

/// The section that an entry is of.
fn of_entry<'a>(sections: &'a [RcSection], entry: &Entry) -> &'a RcSection {
    let inputs = &entry.provenance.inputs;
    let is_its = |section: &&RcSection| {
        let wanted = RcWanted::of(section, &SeriesOptions::default()).unwrap();
        let [its, of_wanted] = [inputs, &wanted.inputs].map(|i| &i.settings["bars_x_y_diameter_m"]);
        let alike = wanted.features.rc == entry.features.rc && wanted.inputs.geometry == inputs.geometry;
        its == of_wanted && alike
    };
    sections.iter().find(is_its).unwrap_or_else(|| panic!("{} is of no grid", entry.key))
}
