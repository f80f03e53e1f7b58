//! Curves of column ends from their sections, beside those of the submodel that stand in the library.

use fallwerk::base::piecewise::interpolate;
use fallwerk::building::ends::member_ends;
use fallwerk::building::partition::Partition;
use fallwerk::building::{EXAMPLE, parse};
use fallwerk::curve::ResistanceCurve;
use fallwerk::fe::mesh::Mesh;
use fallwerk::library::after_break::{BREAKS, BROKEN, ENDS, LEFT};
use fallwerk::library::derive::Wanted;
use fallwerk::library::layered::layered;
use fallwerk::library::{Entry, EntryKind, Origin, Store};
use std::collections::BTreeMap;
use std::path::Path;

/// Peak about the end section at an axial force \[N m\]: that about the hinge, on the line through the point of inflection.
fn peak(curve: &ResistanceCurve, entry: &Entry, length_m: f64, axial_force_n: f64) -> f64 {
    let offset = entry.hinge_offset_m.unwrap();
    let levels: Vec<[f64; 2]> = curve.levels.iter().map(|l| [l.axial_force_n, l.peak_nm()]).collect();
    interpolate(&levels, axial_force_n) * length_m / (length_m - offset)
}

#[test]
fn the_section_bears_what_the_submodel_bears() {
    let building = parse(EXAMPLE, fallwerk::base::tree::Format::Toml, "example.toml").unwrap();
    let partition = Partition::of(&building);
    let (mesh, _) = Mesh::of(&building, building.settings.mesh_size_m);
    let cache = tempfile::tempdir().unwrap();
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("library");
    let store = Store::open_with_cache(&library, cache.path()).unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for end in member_ends(&building, &partition).iter().filter(|e| e.axis == 2) {
        let wanted = Wanted::of(&building, &partition, &mesh, end).unwrap();
        let key = wanted.key().unwrap();
        if !seen.insert(key.clone()) {
            continue;
        }
        let own = store.get(&key).unwrap();
        let found = layered(&wanted).unwrap().unwrap();
        assert_ne!(found.key, own.key, "an entry of other inputs has another key");
        assert!(found.hinge().is_ok());
        let squash = own.compressive_capacity_n.unwrap();
        let close = |a: f64, b: f64, by: f64, what: &str| {
            println!("{} {what}: {a:.4e} {b:.4e} {:.3}", end.id, a / b);
            assert!((a / b - 1.0).abs() < by, "{} {what}: {a:.4e}, submodel {b:.4e}", end.id);
        };
        for k in 0..2 {
            let (a, b) = (&found.axes[k].curve, &own.axes[k].curve);
            for share in [0.0, 0.1, 0.2, 0.3] {
                let at = |curve, entry| peak(curve, entry, wanted.model.length_m, share * squash);
                close(at(a, &found), at(b, &own), 0.15, &format!("peak at {share}"));
            }
            close(a.stiffness_nm_rad, b.stiffness_nm_rad, 0.5, "stiffness");
            let ends = [a, b].map(|curve| curve.levels[0].fracture_rotation_rad);
            close(ends[0], ends[1], 0.35, "fracture rotation");
        }
        let [a, b] = [&found, &own].map(|e| e.stiffness.unwrap());
        close(a.axial_n_m, b.axial_n_m, 0.02, "axial stiffness");
        close(a.shear_n_m[0], b.shear_n_m[0], 1e-6, "shear stiffness");
        close(a.torsion_nm_rad, b.torsion_nm_rad, 1e-6, "torsion");
        close(found.tensile_capacity_n.unwrap(), own.tensile_capacity_n.unwrap(), 1e-3, "tension");
        close(found.tensile_elongation_m.unwrap(), own.tensile_elongation_m.unwrap(), 1e-3, "elongation");
        close(found.compressive_capacity_n.unwrap(), squash, 0.02, "crushing");
    }
    assert!(seen.len() >= 2);
}

/// Where pushes of the column ends of the library break, over `ε_r s / z`, what is left of their peak then, and where it is next to nothing: medians, beside what the tables say.
#[test]
fn what_is_left_of_broken_ends_is_what_pushes_show() {
    let cache = tempfile::tempdir().unwrap();
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("library");
    let store = Store::open_with_cache(&library, cache.path()).unwrap();
    let mut seen: BTreeMap<i32, [Vec<f64>; 3]> = BTreeMap::new();
    for key in store.keys() {
        let entry = store.get(&key).unwrap();
        let inputs = &entry.provenance.inputs;
        let (EntryKind::ColumnHinge, Origin::Submodel, Some(law)) = (entry.kind, entry.origin, &inputs.law)
        else {
            continue;
        };
        let f = &entry.features;
        let length_m = f.length_to_inflection_m.unwrap();
        let row_m = length_m / (length_m / f.mesh_size_m.unwrap()).round().max(1.0);
        let squash_n = law.hardening[0].stress_pa * f.width_m * f.depth_m;
        for (axis, depth_m) in entry.axes.iter().zip([f.depth_m, f.width_m]) {
            // two elements across
            let multiple = law.critical_plastic_strain * row_m / (0.25 * depth_m);
            for push in &axis.envelopes {
                let peak = push.points.iter().map(|p| p[1]).fold(0.0, f64::max);
                let breaks =
                    push.points.iter().find(|p| p[0] > 0.3 * multiple && p[1] < BROKEN * peak).map(|p| p[0]);
                let Some(breaks) = breaks else { continue };
                let share = (10.0 * push.axial_force_n / squash_n).round() as i32;
                let [at, left, ends] = seen.entry(share).or_default();
                at.push(breaks / multiple);
                let after: Vec<f64> = push
                    .points
                    .iter()
                    .filter(|p| p[0] > 1.15 * breaks && p[0] < 2.2 * breaks)
                    .map(|p| p[1])
                    .collect();
                if !after.is_empty() {
                    left.push(after.iter().sum::<f64>() / after.len() as f64 / peak);
                }
                let gone = push.points.iter().find(|p| p[0] > breaks && p[1] < 0.05 * peak);
                ends.push(gone.or(push.points.last()).unwrap()[0] / multiple);
            }
        }
    }
    for share in [-1, 0, 1, 2, 4] {
        let medians = seen.get_mut(&share).unwrap().each_mut().map(|all| {
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        });
        let said = [&BREAKS, &LEFT, &ENDS].map(|table| interpolate(table, f64::from(share) / 10.0));
        println!("{share}: {medians:.3?}, said {said:.3?}");
        for (median, (said, by)) in medians.into_iter().zip(said.into_iter().zip([0.05, 0.03, 0.1])) {
            assert!((median - said).abs() < by, "{share}: {median} {said}");
        }
    }
}
