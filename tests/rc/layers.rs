//! Section of the mesh without a run, against the submodel of column ends that stands in the library.

use fallwerk::library::{Entry, EntryKind, Origin, Store};
use fallwerk::rc::layers::{AT_JOINT, Layer, Layers, POLE};
use std::collections::BTreeMap;
use std::path::Path;

/// The entries of column ends of the homogenised submodel, each with its section: two elements across.
fn ends() -> Vec<Entry> {
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("library");
    let cache = tempfile::tempdir().unwrap();
    let store = Store::open_with_cache(&library, cache.path()).unwrap();
    let own = |e: &Entry| {
        e.kind == EntryKind::ColumnHinge && e.origin == Origin::Submodel && e.features.mesh_size_m.is_some()
    };
    let all = store.keys().into_iter().filter(|k| k.starts_with("column_hinge/"));
    all.map(|key| store.get(&key).unwrap()).filter(own).collect()
}

fn percentile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}

#[test]
fn a_joint_lends_the_row_at_it_what_is_said_of_it() {
    let mut ratios: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    let mut poles = Vec::new();
    let ends = ends();
    for entry in &ends {
        let Some(law) = &entry.provenance.inputs.law else { continue };
        let (width, depth) = (entry.features.width_m, entry.features.depth_m);
        let strength = entry.features.further.get("strength_factor").copied().unwrap_or(1.0);
        let half = |side: f64| Layer {
            area_m2: 0.5 * width * depth,
            at_m: 0.25 * side * depth,
            depth_m: 0.5 * depth,
            strength,
            law,
        };
        let section = Layers::of(vec![half(-1.0), half(1.0)]).unwrap();
        let (length, size) =
            (entry.features.length_to_inflection_m.unwrap(), entry.features.mesh_size_m.unwrap());
        let row = length / (length / size).round().max(1.0);
        poles.push(entry.hinge_offset_m.unwrap() / row);
        let curve = &entry.axes[0].curve;
        let free = section.curve(row, curve.stiffness_nm_rad);
        for [share, _] in AT_JOINT {
            let at = |c: &fallwerk::curve::ResistanceCurve| {
                let peaks: Vec<[f64; 2]> = c.levels.iter().map(|l| [l.axial_force_n, l.peak_nm()]).collect();
                fallwerk::base::piecewise::interpolate(&peaks, share * section.squash_n)
            };
            ratios.entry((1e3 * share) as i64).or_default().push(at(curve) / at(&free));
        }
    }
    assert!(poles.len() >= 40, "{}", poles.len());
    let mut found = Vec::new();
    for ([share, lent], (_, own)) in AT_JOINT.into_iter().zip(&mut ratios) {
        let [low, middle, high] = [0.1, 0.5, 0.9].map(|p| percentile(own, p));
        println!("{share}: {low:.3} {middle:.3} {high:.3}, said {lent}");
        found.push((middle / lent - 1.0).abs());
    }
    let pole = percentile(&mut poles, 0.5);
    println!("pole {pole:.3}, said {POLE}");
    assert!(found.iter().all(|off| *off < 0.06), "{found:?}");
    assert!((pole - POLE).abs() < 0.1, "{pole}");
}
