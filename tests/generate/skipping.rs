//! What a run of a generated model leaves out changes nothing.

use super::*;
use fallwerk::mbs::{SolverOptions, simulate_with};

/// A building without the columns of its ground floor: floors and columns come near each other, part and meet again, while sections are looked at. Pairs that had been looked at kept other contact points than pairs that had
/// not, and what lay in the rubble was up to half a metre elsewhere in the end.
#[test]
fn a_collapse_is_the_same_with_all_of_it_computed() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("buildings/heldout/s2-022.toml");
    let mut text = std::fs::read_to_string(file).unwrap();
    for (member, time) in [("C1-B1", 0.0), ("C1-B2", 0.25)] {
        text += &format!("\n[[events]]\nid = \"charge-{member}\"\nmember = \"{member}\"\ntime = {time}\n");
    }
    let building = parse(&text, Format::Toml, "s2-022").unwrap();
    let (rules, mut store, _cache) = knowledge();
    let mut model = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap().model;
    model.settings.end_time_s = 2.5;
    let run = |all: bool| {
        let mut options = SolverOptions { look_always: all, ..SolverOptions::default() };
        options.contact.skip = !all;
        simulate_with(&model, &options).unwrap()
    };
    let [some, every] = [run(false), run(true)];
    let left_alone = [&some, &every].map(|r| r.contact_work.pairs_left_alone);
    assert!(left_alone[0] > 100_000 && left_alone[1] == 0, "{left_alone:?}");
    assert!(some.body_work.bounded_looks > 0 && every.body_work.bounded_looks == 0);
    assert!(some.frames == every.frames, "frames differ");
    assert_eq!(some.energies, every.energies);
    assert_eq!(some.events, every.events);
}
