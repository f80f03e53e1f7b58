//! The review list: its order, what a decision the other way changes, what is not tried and why.

use super::{knowledge, reference};
use fallwerk::building::{Building, Override, OverrideAction};
use fallwerk::generate::{Accuracy, Derive, Generated, Generator, Wishes};
use fallwerk::mbs::{RunResult, simulate_carefully};
use fallwerk::review::{Review, listed, measured};

/// With floors in one piece.
const WISHES: Wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Fast };

/// The reference with rear feet that do not yield, by the analyst.
fn building() -> Building {
    let decided = |target: &str| Override {
        target: target.to_string(),
        action: OverrideAction::ElasticConnection,
        reason: "cased".to_string(),
    };
    Building {
        overrides: vec![decided("C1-A2.bottom"), decided("C1-B2.bottom")],
        ..reference(|t| t.replace("end_time = \"2.5 s\"", "end_time = \"0.6 s\""))
    }
}

fn reviewed(building: &Building, most_runs: usize) -> (Generated, RunResult, Review) {
    let (rules, mut store, _cache) = knowledge();
    let mut generator = Generator::of(building, &rules, &mut store, WISHES).unwrap();
    let generated = generator.model(&building.overrides, &|_| {}).unwrap();
    let run = simulate_carefully(&generated.model).unwrap();
    let review = measured(building, &mut generator, &generated, &run, most_runs);
    (generated, run, review)
}

#[test]
fn decisions_are_sorted_by_what_they_change_and_what_was_not_tried_says_why() {
    let building = building();
    let (generated, run, review) = reviewed(&building, 10);
    assert_eq!(review.items.len(), generated.doubts.len());
    assert!(review.items.iter().enumerate().all(|(i, item)| item.rank == i + 1));
    assert_eq!(review.runs, 2, "{review:#?}");
    // each foot for itself: what the rules say instead of the override, and the same run as without the override in the file
    let foot = review.items.iter().find(|i| i.subjects == ["C1-A2.bottom"]).unwrap();
    assert_eq!((foot.kind.as_str(), foot.otherwise.as_str()), ("override", "what the rules say"));
    let change = foot.change.as_ref().unwrap();
    let (rules, mut store, _cache) = knowledge();
    let other = Building { overrides: building.overrides[1..].to_vec(), ..building.clone() };
    let other = fallwerk::generate::generate(&other, &rules, &mut store, WISHES, &|_| {}).unwrap();
    let other = simulate_carefully(&other.model).unwrap();
    let pairs = run.tracked.iter().zip(&other.tracked);
    let apart = pairs.flat_map(|(a, b)| a.displacement_m.iter().zip(&b.displacement_m)).map(|(u, v)| {
        let squares: f64 = (0..3).map(|i| (u[i] - v[i]).powi(2)).sum();
        squares.sqrt()
    });
    let largest = apart.fold(0.0, f64::max);
    assert!(largest > 0.0 && (change.difference_m - largest).abs() < 1e-12, "{largest} {change:?}");
    // a line that could fold has no curves: not tried, and before what was tried and changes nothing
    let line = review.items.iter().find(|i| i.kind == "overloaded").unwrap();
    assert!(line.untried.as_ref().is_some_and(|why| why.contains("no curves")), "{line:?}");
    let changes: Vec<f64> =
        review.items.iter().filter_map(|i| i.change.as_ref()).map(|c| c.difference_to_contact_m).collect();
    assert!(changes.windows(2).all(|w| w[0] >= w[1]), "{changes:?}");
    assert_eq!(reviewed(&building, 10).2, review, "the same list every time");
}

#[test]
fn runs_are_bounded_and_without_runs_the_order_is_that_of_kinds() {
    let building = building();
    let (generated, _, review) = reviewed(&building, 1);
    assert_eq!((review.runs, review.most_runs), (1, 1));
    assert!(review.items.iter().any(|i| i.untried.as_deref() == Some("more than 1 runs")), "{review:#?}");
    let list = listed(&building, &generated);
    assert_eq!(list.runs, 0);
    let place = |kind: &str| {
        ["overloaded", "conflict", "out of range", "unsure", "scaled", "override", "remark"]
            .iter()
            .position(|k| *k == kind)
            .unwrap()
    };
    assert!(list.items.windows(2).all(|w| place(&w[0].kind) <= place(&w[1].kind)), "{list:#?}");
    assert!(list.items.iter().all(|i| i.change.is_none()));
}
