//! Rules about elastic demands that cannot be asked are told.

use super::{generated, reference};

fn told(building: &fallwerk::building::Building) -> Vec<String> {
    let notes = generated(building).expect("a model").notes;
    notes
        .into_iter()
        .filter(|note| note.contains("rules that ask about demands could not be asked"))
        .collect()
}

#[test]
fn rules_about_demands_that_have_no_solution_are_told() {
    assert_eq!(told(&reference(|t| t)), Vec::<String>::new());
    // all columns of the first storey go: nothing holds what is above
    let building = reference(|text| {
        let all =
            ["A2", "B2"].map(|at| format!("[[events]]\nid = \"{at}\"\nmember = \"C1-{at}\"\ntime = 0.0\n\n"));
        text.replacen("[[events]]", &format!("{}[[events]]", all.concat()), 1)
    });
    let notes = told(&building);
    let [note] = &notes[..] else { panic!("{notes:?}") };
    assert!(note.starts_with("there is no equilibrium after the charges ("), "{note}");
    for part in ["C2-A1", "`learned/", "connect or support", "`building.mechanism`"] {
        assert!(note.contains(part), "{part}: {note}");
    }
}
