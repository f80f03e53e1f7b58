//! Section of the mesh without a run, against the submodel of column ends that stands in the library.

use fallwerk::base::piecewise::interpolate;
use fallwerk::building::Homogenised;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::library::{Entry, EntryKind, Origin, Store};
use fallwerk::rc::layers::{AT_JOINT, Held, KNEE, Layer, Layers, POLE, Rows};
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

/// Two elements across.
fn section([width, depth]: [f64; 2], strength: f64, law: &Homogenised) -> Layers<'_> {
    let half = |side: f64| Layer {
        area_m2: 0.5 * width * depth,
        at_m: 0.25 * side * depth,
        depth_m: 0.5 * depth,
        strength,
        is_plate: false,
        law,
    };
    Layers::of(vec![half(-1.0), half(1.0)]).unwrap()
}

/// From the joint to the point of inflection, and of a row of elements \[m\].
fn lengths(entry: &Entry) -> [f64; 2] {
    let features = &entry.features;
    let [length, size] = [features.length_to_inflection_m, features.mesh_size_m].map(Option::unwrap);
    [length, length / (length / size).round().max(1.0)]
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
        let section = section([width, depth], strength, law);
        let [length, row] = lengths(entry);
        poles.push(entry.hinge_offset_m.unwrap() / row);
        let curve = &entry.axes[0].curve;
        let rows = Rows { row_m: row, shear_span_m: length, held: Held::Free };
        let free = section.curve(&rows, curve.stiffness_nm_rad);
        for [share, _] in AT_JOINT {
            let at = |c: &ResistanceCurve| {
                let peaks: Vec<[f64; 2]> = c.levels.iter().map(|l| [l.axial_force_n, l.peak_nm()]).collect();
                interpolate(&peaks, share * section.squash_n)
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

#[test]
fn a_joint_gives_way_bit_by_bit_as_is_said_of_it() {
    let mut ratios: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for entry in ends() {
        let Some(law) = &entry.provenance.inputs.law else { continue };
        let strength = entry.features.further.get("strength_factor").copied().unwrap_or(1.0);
        let [width, depth] = [entry.features.width_m, entry.features.depth_m];
        let section = section([width, depth], strength, law);
        let [length, row_m] = lengths(&entry);
        let curve = &entry.axes[0].curve;
        let rows = Rows { row_m, shear_span_m: length - POLE * row_m, held: Held::AtJoint };
        let own = section.curve(&rows, curve.stiffness_nm_rad);
        let level = |curve: &ResistanceCurve| {
            let nearest = |a: &&CapacityLevel, b: &&CapacityLevel| {
                a.axial_force_n.abs().total_cmp(&b.axial_force_n.abs())
            };
            curve.levels.iter().min_by(nearest).unwrap().clone()
        };
        let (own, entry) = (level(&own), level(curve));
        let elastic_rad = row_m * own.peak_nm() * 12.0 / (law.youngs_modulus_pa * width * depth.powi(3));
        for [x, _] in KNEE {
            let at = |level: &CapacityLevel| interpolate(&level.capacity, x * elastic_rad);
            ratios.entry((1e3 * x) as i64).or_default().push(at(&own) / at(&entry));
        }
    }
    for (x, own) in &mut ratios {
        let [low, middle, high] = [0.1, 0.5, 0.9].map(|p| percentile(own, p));
        println!("{x}: {low:.3} {middle:.3} {high:.3}");
        assert!(own.len() >= 40 && (middle - 1.0).abs() < 0.04, "{x}: {} {middle}", own.len());
        assert!(low > 0.75 && high < 1.1, "{x}: {low} {high}");
    }
}
