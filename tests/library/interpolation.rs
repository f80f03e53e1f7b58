//! Queries by some of the features, and entries between two.

use super::{computed, features, law};
use fallwerk::library::entry::{Adjoining, ColumnEnd};
use fallwerk::library::{Answer, Entry, EntryKind, Inputs, Origin, Query, Store};

/// An entry whose moments grow with the length to the point of zero moment, in name and number.
fn at(length_m: f64, origin: Origin, seed: u32) -> Entry {
    let law = law(12e6);
    let mut features = features(0.4, ColumnEnd::Top, Adjoining::Slab, &law);
    features.length_to_inflection_m = Some(length_m);
    let inputs = Inputs {
        submodel_version: Some(1),
        geometry: [("length_m".to_string(), length_m)].into(),
        ..Inputs::default()
    };
    Entry::new(EntryKind::ColumnHinge, origin, features, inputs, computed(seed, 4, 12)).unwrap()
}

fn query(length_m: f64) -> Query {
    Query {
        kind: Some(EntryKind::ColumnHinge),
        numbers: [("length_to_inflection_m".to_string(), length_m), ("width_m".to_string(), 0.4)].into(),
        ..Query::default()
    }
}

#[test]
fn an_entry_between_two_says_so_and_invents_no_strength() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    let (a, b) = (at(1.0, Origin::Submodel, 3), at(2.0, Origin::Submodel, 40));
    store.put_all(&[a.clone(), b.clone(), at(4.0, Origin::Submodel, 50)]).unwrap();
    let Answer::Between(entry) = store.answer(&query(1.25), 0.1, true).unwrap() else {
        panic!("no entry between")
    };
    let said = entry.provenance.inputs.interpolation.as_ref().unwrap();
    assert_eq!((said.entries.clone(), said.share), ([a.key.clone(), b.key.clone()], 0.25));
    assert_eq!((said.feature.as_str(), said.value), ("length_to_inflection_m", 1.25));
    assert_eq!(said.records[0], a.checksum().unwrap().to_string());
    assert_eq!(entry.features.length_to_inflection_m, Some(1.25));
    for axis in 0..2 {
        for (x, n) in [(0.0, 0.0), (0.004, 1.3e5), (0.02, 4.1e5), (0.09, 6e5), (0.3, 2e5)] {
            let [p, q] = [&a, &b].map(|e| e.axes[axis].curve.capacity_nm(x, n));
            let found = entry.axes[axis].curve.capacity_nm(x, n);
            let mixture = p + 0.25 * (q - p);
            assert!(found <= mixture * (1.0 + 1e-15) && found >= mixture * (1.0 - 1e-7), "{found} {mixture}");
        }
    }
    // It is a record like any other: written, read and used.
    assert_eq!(Entry::from_text(&entry.to_text().unwrap()).unwrap(), *entry);
    assert_eq!(entry.hinge().unwrap().offset_m, 0.3);
    assert!(store.keys().iter().all(|key| *key != entry.key), "a query stores nothing");
}

#[test]
fn what_differs_otherwise_is_not_mixed() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    store.put_all(&[at(1.0, Origin::Submodel, 3), at(2.0, Origin::RcSubmodel, 4)]).unwrap();
    let none = |store: &Store, q: &Query| matches!(store.answer(q, 0.1, true).unwrap(), Answer::None(_));
    assert!(none(&store, &query(1.5)), "of two origins");
    assert!(none(&store, &query(2.5)), "outside");
    store.put(&at(2.0, Origin::Submodel, 4)).unwrap();
    assert!(matches!(store.answer(&query(1.5), 0.1, true).unwrap(), Answer::Between(_)));
    assert!(matches!(store.answer(&query(1.5), 0.1, false).unwrap(), Answer::None(Some(_))), "not asked for");
    let mut other = query(1.5);
    other.numbers.insert("width_m".into(), 0.41);
    assert!(none(&store, &other), "two features differ");
    let Answer::Entry(exact) = store.answer(&query(2.0), 0.1, true).unwrap() else { panic!("not found") };
    assert!(exact.fit.exact, "an entry that is there goes before one between two");
}

#[test]
fn a_query_asks_only_for_what_it_names() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    store.put(&at(1.0, Origin::Submodel, 3)).unwrap();
    let Answer::Entry(found) = store.answer(&query(1.05), 0.1, true).unwrap() else { panic!("not found") };
    assert!((found.fit.distance - 1.05f64.ln()).abs() < 1e-12, "{:?}", found.fit);
    assert!(found.fit.reason.contains("length_to_inflection_m is 1 instead of 1.05"));
    let mut unknown = query(1.0);
    unknown.numbers.insert("rc.tie_spacing_m".into(), 0.1);
    let Answer::None(Some(near)) = store.answer(&unknown, 0.1, true).unwrap() else { panic!("found") };
    assert!(near.fit.reason.contains("`rc.tie_spacing_m` is not known of it"), "{}", near.fit.reason);
    let other = Query { kind: Some(EntryKind::BeamHinge), ..Query::default() };
    assert!(matches!(store.answer(&other, 9.0, true).unwrap(), Answer::None(None)));
}
