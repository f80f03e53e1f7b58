//! Writing and reading records.

use super::{computed, entry, entry_of};
use fallwerk::library::{Entry, EntryKind, Opened, Origin, Put, Store, StoreError};
use std::fs;

#[test]
fn what_is_put_comes_back_bit_for_bit() {
    let room = tempfile::tempdir().unwrap();
    let entries: Vec<Entry> = (0..12).map(entry).collect();
    {
        let mut store = Store::open(room.path()).unwrap();
        for entry in &entries {
            assert_eq!(store.put(entry).unwrap(), Put::Added);
            assert_eq!(store.put(entry).unwrap(), Put::Unchanged);
            assert_eq!(store.get(&entry.key).unwrap(), *entry);
        }
    }
    let store = Store::open(room.path()).unwrap();
    assert_eq!(*store.opened(), Opened::Checked, "a copy that was closed in good order is taken as it is");
    let mut sorted = entries.clone();
    sorted.sort_by(|a, b| a.key.cmp(&b.key));
    assert_eq!(store.list().unwrap(), sorted);
    for entry in &entries {
        let path = room.path().join(format!("{}.json", entry.key));
        assert_eq!(fs::read_to_string(path).unwrap(), entry.to_text().unwrap());
    }
}

#[test]
fn records_stay_below_the_limit() {
    let large = {
        let small = entry(3);
        Entry::new(
            EntryKind::ColumnHinge,
            Origin::Submodel,
            small.features.clone(),
            small.provenance.inputs.clone(),
            computed(3, 7, 2000),
        )
        .unwrap()
    };
    let size = large.to_text().unwrap().len();
    assert!(size < 16_000 && size > 8_000, "{size}");
    assert_eq!(large.axes[0].envelopes.len(), 7, "no level is lost");
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    store.put(&large).unwrap();
    // An entry that cannot be thinned enough is refused, with the number.
    let huge = Entry::new(
        EntryKind::ColumnHinge,
        Origin::Submodel,
        large.features.clone(),
        large.provenance.inputs.clone(),
        computed(3, 80, 2000),
    )
    .unwrap();
    let message = store.put(&huge).unwrap_err().to_string();
    assert!(message.contains("the limit is 16000"), "{message}");
}

#[test]
fn the_key_changes_with_every_input_and_only_with_inputs() {
    let base = entry(4);
    let p = base.provenance.inputs.clone();
    assert_eq!(
        entry_of(base.features.clone(), p.law.clone().unwrap(), 1, 77).key,
        base.key,
        "the result is no input"
    );
    assert_ne!(entry_of(base.features.clone(), p.law.clone().unwrap(), 2, 4).key, base.key);
    let mut law = p.law.clone().unwrap();
    law.critical_plastic_strain = f64::from_bits(law.critical_plastic_strain.to_bits() + 1);
    assert_ne!(entry_of(base.features.clone(), law, 1, 4).key, base.key);
}

#[test]
fn unsound_entries_are_refused_and_nothing_is_written() {
    type Spoil = fn(&mut Entry);
    let faults: [(Spoil, &str); 10] = [
        (|e| e.key = "../../etc/x@0123456789abcdef".into(), "key"),
        (|e| e.axes[1].envelopes[2].points[3][1] = f64::NAN, "axes[1]: envelopes[2]"),
        (|e| e.axes[0].envelopes[0].points.swap(1, 2), "must increase"),
        (|e| e.axes[0].curve.levels[0].capacity[1][1] = -1.0, "never be negative"),
        (|e| e.stiffness.as_mut().unwrap().axial_n_m = 0.0, "stiffness.axial_n_m"),
        (|e| e.compressive_capacity_n = Some(-5.0), "`compressive_capacity_n` must be positive, is -5"),
        (|e| e.tensile_elongation_m = Some(-1.0), "`tensile_elongation_m` must be positive"),
        (|e| e.bearing_capacity_n = Some(0.0), "`bearing_capacity_n` must be positive"),
        (|e| e.hinge_offset_m = Some(-3.0), "`hinge_offset_m` must not be negative, is -3"),
        (|e| e.provenance.inputs.law.as_mut().unwrap().density_kg_m3 = 1.0, "inputs_hash"),
    ];
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    for (spoil, expected) in faults {
        let (good, mut bad) = (entry(1), entry(2));
        spoil(&mut bad);
        let error = store.put_all(&[good, bad]).unwrap_err();
        assert!(
            matches!(error, StoreError::Invalid { .. }) && error.to_string().contains(expected),
            "{error}"
        );
        assert!(store.keys().is_empty());
    }
    assert!(!room.path().join("column_hinge").exists());
}

/// Curves are thinned until a record just fits; that it is no longer to be used, and what is in its place, can be said all the same.
#[test]
fn a_record_of_the_largest_size_can_be_deprecated() {
    let room = tempfile::tempdir().unwrap();
    let (small, base) = (entry(1), entry(2));
    let padded = |bytes: usize| {
        let mut inputs = base.provenance.inputs.clone();
        inputs.settings.insert("padding".to_string(), "x".repeat(bytes).into());
        Entry::new(base.kind, base.origin, base.features.clone(), inputs, computed(2, 5, 20)).unwrap()
    };
    let large = padded(15_999 - padded(0).to_text().unwrap().len());
    assert_eq!(large.to_text().unwrap().len(), 15_999);
    let mut store = Store::open(room.path()).unwrap();
    store.put_all(&[small.clone(), large.clone()]).unwrap();
    let longest = "ä".repeat(500);
    let refused = store.deprecate(&large.key, None, Some(&format!("{longest}!"))).unwrap_err().to_string();
    assert!(refused.contains("has 501 characters; use at most 500"), "{refused}");
    store.deprecate(&large.key, Some(&small.key), Some(&longest)).unwrap();
    drop(store);
    let store = Store::open(room.path()).unwrap();
    assert_eq!(*store.opened(), Opened::Checked);
    assert_eq!(store.get(&large.key).unwrap().deprecated.unwrap().reason, longest);
    let blobs = fs::read_dir(room.path().join(".cache/db/blobs")).map_or(0, |items| items.count());
    assert_eq!(blobs, 0, "the working copy keeps it with the others");
}

#[test]
fn a_new_result_of_the_same_inputs_replaces_the_record() {
    let room = tempfile::tempdir().unwrap();
    let first = entry(6);
    let second = entry_of(first.features.clone(), first.provenance.inputs.law.clone().unwrap(), 1, 7);
    let mut store = Store::open(room.path()).unwrap();
    store.put(&first).unwrap();
    assert_eq!(store.put(&second).unwrap(), Put::Replaced);
    drop(store);
    assert_eq!(Store::open(room.path()).unwrap().get(&first.key).unwrap(), second);
}

#[test]
fn a_large_batch_goes_in_and_comes_out() {
    let room = tempfile::tempdir().unwrap();
    let entries: Vec<Entry> = (0..600).map(entry).collect();
    let timed = |name: &str, start: std::time::Instant| {
        println!("{name}: {:.0} ms", start.elapsed().as_secs_f64() * 1e3)
    };
    let start = std::time::Instant::now();
    let mut store = Store::open(room.path()).unwrap();
    assert!(store.put_all(&entries).unwrap().iter().all(|p| *p == Put::Added));
    timed("put 600", start);
    drop(store);
    let start = std::time::Instant::now();
    let mut store = Store::open(room.path()).unwrap();
    timed("open 600, checked", start);
    assert_eq!(*store.opened(), Opened::Checked);
    let start = std::time::Instant::now();
    assert_eq!(store.rebuild().unwrap(), 600);
    timed("rebuild 600", start);
    let start = std::time::Instant::now();
    assert!(entries.iter().all(|e| store.get(&e.key).unwrap() == *e));
    timed("get 600", start);
    let bytes: u64 =
        store.keys().iter().map(|k| fs::metadata(room.path().join(format!("{k}.json"))).unwrap().len()).sum();
    println!("mean record: {} bytes", bytes / 600);
}

#[test]
fn records_of_schema_1_are_read_kept_and_written_as_they_are() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("library/column_hinge");
    let mut count = 0;
    for item in fs::read_dir(folder).unwrap() {
        let path = item.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        if !text.contains("\"schema\": 1") {
            continue;
        }
        let entry = Entry::from_text(&text).unwrap();
        assert_eq!((entry.schema, entry.origin), (1, Origin::Submodel));
        assert_eq!(entry.to_text().unwrap(), text, "{}", path.display());
        assert!(path.ends_with(format!("{}.json", entry.key)));
        assert!(entry.hinge().is_ok());
        // Schema 1 has no other origin.
        let mut foreign = entry.clone();
        foreign.origin = Origin::RcSubmodel;
        assert!(Store::open(tempfile::tempdir().unwrap().path()).unwrap().put(&foreign).is_err());
        count += 1;
    }
    assert_eq!(count, 3);
}
