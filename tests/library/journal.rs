//! The journal: what happened, also to those who were killed.

use super::entry;
use fallwerk::library::journal::{Happening, Journal};
use fallwerk::library::{Store, exchange};
use std::fs;

fn told(store: &Store) -> Vec<(Happening, String)> {
    store.history().unwrap().events.into_iter().map(|e| (e.what, e.key)).collect()
}

#[test]
fn every_change_is_told_once() {
    let room = tempfile::tempdir().unwrap();
    let (from, to) = (room.path().join("from"), room.path().join("to"));
    let [a, b, c] = [entry(1), entry(2), entry(3)];
    let mut store = Store::open(&from).unwrap();
    store.put(&a).unwrap();
    store.put(&a).unwrap();
    store.put_all(&[b.clone(), c.clone()]).unwrap();
    store.deprecate(&b.key, Some(&c.key), Some("too\tcoarse")).unwrap();
    let expected = [
        (Happening::Added, a.key.clone()),
        (Happening::Added, b.key.clone()),
        (Happening::Added, c.key.clone()),
        (Happening::Deprecated, b.key.clone()),
    ];
    assert_eq!(told(&store), expected);
    let history = store.history().unwrap();
    assert_eq!(history.events[3].note, format!("too coarse; successor {}", c.key));
    assert_eq!(history.events[0].record, a.checksum().unwrap().short());
    let file = room.path().join("all.json");
    exchange::export(&store, &file).unwrap();
    let mut copy = Store::open(&to).unwrap();
    exchange::import(&mut copy, &file).unwrap();
    assert!(told(&copy).iter().all(|(what, _)| *what == Happening::Imported));
    assert_eq!(copy.history().unwrap().events[0].note, "from all.json");
    assert!(store.untold().unwrap().is_empty() && copy.untold().unwrap().is_empty());
}

#[test]
fn what_came_or_went_without_the_journal_is_noted_by_the_next_change() {
    let room = tempfile::tempdir().unwrap();
    let [a, b, c] = [entry(1), entry(2), entry(3)];
    Store::open(room.path()).unwrap().put_all(&[a.clone(), b.clone()]).unwrap();
    // Version control brings one record and takes another, the journal with neither.
    fs::remove_file(room.path().join(format!("{}.json", a.key))).unwrap();
    fs::write(room.path().join(format!("{}.json", c.key)), c.to_text().unwrap()).unwrap();
    let before = fs::read(Journal::of(room.path()).path()).unwrap();
    let mut store = Store::open(room.path()).unwrap();
    let report = exchange::verify(&store).unwrap();
    // What came is no fault; what went is one, until the journal has noted it.
    assert!(!report.is_clean() && report.untold == 1 && report.gone == [a.key.clone()], "{report:?}");
    assert_eq!(fs::read(Journal::of(room.path()).path()).unwrap(), before, "looking changes nothing");
    store.deprecate(&b.key, None, Some("old")).unwrap();
    let words = told(&store);
    assert_eq!(
        words[2..],
        [
            (Happening::Found, c.key.clone()),
            (Happening::Missing, a.key.clone()),
            (Happening::Deprecated, b.key.clone())
        ]
    );
    let report = exchange::verify(&store).unwrap();
    assert!(report.is_clean() && report.untold == 0 && report.missing == [a.key.clone()], "{report:?}");
    // A record that returns is found again; a mended one is told as such.
    fs::write(room.path().join(format!("{}.json", a.key)), a.to_text().unwrap()).unwrap();
    fs::write(room.path().join(format!("{}.json", c.key)), "{").unwrap();
    drop(store);
    let mut store = Store::open(room.path()).unwrap();
    store.put(&c).unwrap();
    let words = told(&store);
    assert_eq!(words[5..], [(Happening::Found, a.key), (Happening::Mended, c.key)]);
}

#[test]
fn a_damaged_journal_hinders_nobody_and_is_mended_by_a_rebuild() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(room.path()).unwrap();
    (0..4).for_each(|seed| assert!(store.put(&entry(seed)).is_ok()));
    let path = Journal::of(room.path()).path().to_path_buf();
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replacen("\tadded\t", "\tadddd\t", 1)).unwrap();
    assert_eq!(store.list().unwrap().len(), 4);
    let report = exchange::verify(&store).unwrap();
    assert_eq!(report.journal, ["line 2 does not match its checksum"]);
    store.rebuild().unwrap();
    assert!(exchange::verify(&store).unwrap().is_clean() && store.untold().unwrap().is_empty());
    let last: Vec<Happening> = told(&store).into_iter().map(|(what, _)| what).rev().take(2).collect();
    assert_eq!(last, [Happening::Found, Happening::Mended]);
    // No journal at all: one begins.
    fs::remove_file(&path).unwrap();
    drop(store);
    Store::open(room.path()).unwrap().put(&entry(9)).unwrap();
    assert_eq!(Store::open(room.path()).unwrap().history().unwrap().events.len(), 5);
}
