//! Which entry is found.

use super::{entry_of, features, law};
use fallwerk::building::Homogenised;
use fallwerk::library::entry::{Adjoining, ColumnEnd};
use fallwerk::library::{Entry, Features, Put, Store, StoreError};

#[test]
fn an_exact_match_comes_first_then_the_nearest_and_beyond_the_tolerance_none() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    let law = law(12e6);
    let at = |width: f64| features(width, ColumnEnd::Bottom, Adjoining::Ground, &law);
    assert!(store.find(&at(0.4), f64::MAX).unwrap().is_none(), "an empty library has nothing");
    for width in [0.3, 0.4, 0.5] {
        store.put(&entry_of(at(width), law.clone(), 1, 1)).unwrap();
    }
    let exact = store.find(&at(0.4), 0.0).unwrap().unwrap();
    assert!(exact.fit.exact && exact.fit.distance == 0.0 && exact.entry.features.width_m == 0.4);

    // 0.42 against 0.40 in both depths: sqrt(2 * (2 ln 1.05)^2).
    let near = store.find(&at(0.42), 0.2).unwrap().unwrap();
    assert!(!near.fit.exact && near.entry.features.width_m == 0.4);
    assert!((near.fit.distance - 2f64.sqrt() * 2.0 * 1.05f64.ln()).abs() < 1e-12, "{}", near.fit.distance);
    assert!(near.fit.reason.contains("width_m is 0.4 instead of 0.42"), "{}", near.fit.reason);

    assert!(store.find(&at(0.42), 0.1).unwrap().is_none());
    let told = store.nearest(&at(0.42)).unwrap();
    assert!(told.key.contains("400x400"));

    // No distance bridges another end or another support.
    let head = features(0.4, ColumnEnd::Top, Adjoining::Ground, &law);
    assert!(store.find(&head, 1e9).unwrap().is_none());
    assert!(store.nearest(&head).unwrap().fit.reason.contains("bottom end at a ground instead of top end"));
}

#[test]
fn another_law_with_equal_features_is_near_but_not_exact() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    let (a, mut b) = (law(12e6), law(12e6));
    b.poisson_ratio = 0.19;
    let wanted = |law| features(0.4, ColumnEnd::Top, Adjoining::Slab, law);
    store.put(&entry_of(wanted(&a), a.clone(), 1, 1)).unwrap();
    let found = store.find(&wanted(&b), 0.0).unwrap().unwrap();
    assert!(!found.fit.exact && found.fit.distance == 0.0, "{:?}", found.fit);
    store.put(&entry_of(wanted(&b), b.clone(), 1, 1)).unwrap();
    assert!(store.find(&wanted(&b), 0.0).unwrap().unwrap().fit.exact);
    // Of two exact matches the newer procedure counts.
    store.put(&entry_of(wanted(&b), b.clone(), 3, 1)).unwrap();
    store.put(&entry_of(wanted(&b), b.clone(), 2, 1)).unwrap();
    let found = store.find(&wanted(&b), 0.0).unwrap().unwrap();
    assert_eq!(found.entry.provenance.inputs.submodel_version, Some(3));
}

/// A law, an end of it, and its entries by two versions of the submodel, which are stored.
fn two_versions(store: &mut Store) -> (Homogenised, Features, [Entry; 2]) {
    let law = law(12e6);
    let wanted = features(0.4, ColumnEnd::Top, Adjoining::Slab, &law);
    let entries = [1, 2].map(|version| entry_of(wanted.clone(), law.clone(), version, 1));
    store.put_all(&entries).unwrap();
    (law, wanted, entries)
}

#[test]
fn deprecated_entries_are_kept_but_not_found() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    let (_, wanted, [old, new]) = two_versions(&mut store);
    assert!(store.deprecate(&old.key, Some(&old.key), Some("x")).is_err());
    assert!(matches!(
        store.deprecate(&old.key, Some("column_hinge/x@0000000000000000"), Some("x")),
        Err(StoreError::NotFound { .. })
    ));
    store.deprecate(&new.key, None, Some("locks")).unwrap();
    assert!(
        store.deprecate(&old.key, Some(&new.key), Some("x")).is_err(),
        "a deprecated successor helps nobody"
    );
    assert_eq!(store.find(&wanted, 0.0).unwrap().unwrap().entry, old);
    drop(store);
    let store = Store::open(room.path()).unwrap();
    assert_eq!(store.get(&new.key).unwrap().deprecated.unwrap().reason, "locks");
    assert_eq!(store.find(&wanted, 0.0).unwrap().unwrap().entry, old);
}

/// Whether it is computed again or given again, with the same or other results.
#[test]
fn entries_that_are_stored_again_stay_deprecated() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    let (law, wanted, [old, new]) = two_versions(&mut store);
    store.deprecate(&old.key, Some(&new.key), Some("locks")).unwrap();
    assert_eq!(store.put(&old).unwrap(), Put::Unchanged);
    let other = entry_of(wanted.clone(), law.clone(), 1, 2);
    assert_eq!(other.key, old.key);
    assert_eq!(store.put(&other).unwrap(), Put::Replaced);
    let why = store.deprecation(&old.key).unwrap().unwrap();
    assert_eq!((why.reason.as_str(), why.successor.as_ref()), ("locks", Some(&new.key)));
    assert_eq!(store.deprecation(&new.key).unwrap(), None);
}

#[test]
fn keys_may_be_shortened_but_not_ambiguously() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    let law = law(12e6);
    let make = |w: f64| entry_of(features(w, ColumnEnd::Top, Adjoining::Slab, &law), law.clone(), 1, 1);
    let (a, b) = (make(0.4), make(0.5));
    store.put_all(&[a.clone(), b.clone()]).unwrap();
    let hash = a.key.split('@').nth(1).unwrap();
    assert_eq!(store.resolve(&hash[..8]).unwrap(), a.key);
    assert_eq!(store.resolve("column_hinge/500").unwrap(), b.key);
    assert_eq!(store.resolve("500x500").unwrap(), b.key);
    let message = store.resolve("column_hinge/").unwrap_err().to_string();
    assert!(message.contains("could mean 2 entries"), "{message}");
    let message = store.get(&a.key.replace("top", "tip")).unwrap_err().to_string();
    assert!(message.contains(&format!("did you mean `{}`", a.key)), "{message}");
}
