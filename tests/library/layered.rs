//! Curves of column ends from their sections, beside those of the submodel that stand in the library.

use fallwerk::base::piecewise::interpolate;
use fallwerk::building::ends::member_ends;
use fallwerk::building::partition::Partition;
use fallwerk::building::{EXAMPLE, parse};
use fallwerk::curve::ResistanceCurve;
use fallwerk::fe::mesh::Mesh;
use fallwerk::library::derive::Wanted;
use fallwerk::library::layered::layered;
use fallwerk::library::{Entry, Store};
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
