//! The verdict in words follows the limits of the validation.

use fallwerk::cli::verdict::{checks, energy_warning, energy_words, percent, sites_words, verdict};
use fallwerk::mbs::model::{Beam, Bushing};
use fallwerk::report::Status;
use fallwerk::validate::measure::Sites;
use fallwerk::validate::{
    Both, Doubt, HybridValidation, LIMIT_SPEED, Undecided, VALIDATION_SCHEMA, Validation,
};

fn good() -> Validation {
    Validation {
        schema: VALIDATION_SCHEMA,
        building: "frame".into(),
        e_to_contact: Some(0.05),
        e_after_contact: Some(0.142),
        e_total: Some(0.14),
        e_total_without_debris: Some(0.12),
        debris: Vec::new(),
        has_obstacle: false,
        largest_displacement_m: Both { fe: 4.0, mbs: 4.1 },
        largest_difference_m: 0.2,
        first_contact_s: Both { fe: Some(1.0), mbs: Some(1.02) },
        hinges: Sites::default(),
        turning_before_contact: Sites::default(),
        turning: Sites::default(),
        missed_column_ends: Vec::new(),
        collapsed: Both { fe: true, mbs: true },
        undecided: Vec::new(),
        energy_error: Both { fe: 0.01, mbs: 0.001 },
        dissipated_j: Both { fe: 1e6, mbs: 1e6 },
        footprint_overlap: 0.8,
        cpu_s: Both { fe: 40.0, mbs: 0.02 },
        wall_s: Both { fe: 40.0, mbs: 0.02 },
        speed_ratio: 2000.0,
        e_curve: Vec::new(),
        e_curve_without_debris: Vec::new(),
        times_s: Vec::new(),
        sites: Vec::new(),
        hybrid: None,
        left_out: Vec::new(),
        spread: None,
    }
}

fn good_hybrid() -> HybridValidation {
    HybridValidation {
        e_to_contact: Some(0.01),
        e_after_contact: Some(0.041),
        e_total: Some(0.04),
        e_total_without_debris: Some(0.03),
        debris: Vec::new(),
        first_contact_s: Some(1.0),
        collapsed: true,
        energy_error: 1e-4,
        dissipated_j: 1e6,
        footprint_overlap: 0.98,
        cpu_s: 18.0,
        wall_s: 18.0,
        cpu_share: 0.45,
        switching: true,
        mean_rigid_share: 0.8,
        skipped_share: 0.7,
        switched_j: -5e3,
        switches: 400,
        e_curve: Vec::new(),
        e_curve_without_debris: Vec::new(),
        rigid_share: Vec::new(),
    }
}

#[test]
fn a_hybrid_run_has_checks_of_its_own_that_decide_nothing() {
    let with = |hybrid| Validation { hybrid: Some(hybrid), ..good() };
    let fine = with(good_hybrid());
    assert_eq!(checks(&fine).len(), checks(&good()).len() + 3);
    assert!(fine.agrees() && failed(&fine).is_empty());
    type Breach = (&'static str, fn(&mut HybridValidation));
    let breaches: [Breach; 3] = [
        ("Hybrid: displacement error", |h| h.e_total = Some(0.08)),
        ("Hybrid: processor time", |h| h.cpu_share = 0.6),
        ("Energy error of the hybrid run", |h| h.energy_error = 0.1),
    ];
    for (label, breach) in breaches {
        let mut hybrid = good_hybrid();
        breach(&mut hybrid);
        let v = with(hybrid);
        let found = failed(&v);
        assert!(found.len() == 1 && found[0].starts_with(label), "{found:?}");
        assert!(v.agrees(), "the MBS is what agrees");
        assert_eq!(verdict(&v).headline, verdict(&good()).headline);
    }
}

fn failed(v: &Validation) -> Vec<String> {
    checks(v).into_iter().filter(|c| c.status == Status::Fail).map(|c| c.label).collect()
}

#[test]
fn a_good_comparison_agrees() {
    let v = good();
    assert!(v.agrees() && failed(&v).is_empty());
    let words = verdict(&v);
    assert_eq!(words.status, Status::Pass);
    assert!(
        words.headline.contains("agrees with FE up to the first contact") && words.headline.contains("0.050")
    );
    assert!(words.detail.contains("collapses in both runs"));
}

#[test]
fn each_breach_is_named_alone() {
    type Breach = (&'static str, fn(&mut Validation));
    let breaches: [Breach; 6] = [
        ("Displacement error", |v| v.e_to_contact = Some(0.4)),
        ("Time of the first ground contact", |v| v.first_contact_s.mbs = Some(1.2)),
        ("Time of the first ground contact", |v| v.first_contact_s.mbs = None),
        ("Collapse", |v| v.collapsed.mbs = false),
        ("Energy error of the FE run", |v| v.energy_error.fe = 0.03),
        ("Energy error of the MBS run", |v| v.energy_error.mbs = 0.5),
    ];
    for (label, breach) in breaches {
        let mut v = good();
        breach(&mut v);
        let found = failed(&v);
        assert!(found.len() == 1 && found[0].starts_with(label), "{label}: {found:?}");
        assert!(!v.agrees());
        let words = verdict(&v);
        assert_eq!(words.status, Status::Fail);
        let rest = &label[1..];
        assert!(
            words.headline.contains("does not agree") && words.headline.contains(rest),
            "{}",
            words.headline
        );
    }
}

/// What is aimed at after contact stands in the checks of buildings that fall, and decides nothing.
#[test]
fn errors_after_contact_are_shown_beside_their_aims() {
    let far =
        Validation { e_total: Some(0.17), e_after_contact: Some(0.1712), footprint_overlap: 0.7, ..good() };
    assert_eq!(failed(&far), ["Displacement error over the whole run", "Debris footprint"]);
    assert!(far.agrees() && verdict(&far).status == Status::Pass);
    let told = checks(&far).into_iter().find(|c| c.label == "Displacement error over the whole run").unwrap();
    assert_eq!(told.value, "e = 0.170, 0.171 after the first contact alone");
    assert!(told.limit.starts_with("≤ 0.15"), "{}", told.limit);
    let walled = Validation { has_obstacle: true, ..far.clone() };
    assert_eq!(failed(&walled), ["Debris footprint"], "0.20 with an obstacle");
    let mut stands = far;
    (stands.collapsed.fe, stands.collapsed.mbs) = (false, false);
    assert!(failed(&stands).is_empty(), "nothing falls, no debris");
}

/// A structure that stands deflects by millimetres; their distance counts, not their ratio.
#[test]
fn a_structure_that_stands_is_judged_by_the_distance() {
    let mut v = good();
    v.e_to_contact = Some(0.9);
    v.first_contact_s = Both { fe: None, mbs: None };
    v.largest_displacement_m = Both { fe: 0.028, mbs: 0.004 };
    v.largest_difference_m = 0.024;
    assert!(!v.agrees(), "it collapses");
    v.collapsed = Both { fe: false, mbs: false };
    assert!(v.agrees() && failed(&v).is_empty());
    let words = verdict(&v).headline;
    assert!(
        words.contains("stands in both, displacements at most 24.0 mm apart (FE 28.0 mm, MBS 4.0 mm)"),
        "{words}"
    );
    let detail = verdict(&v).detail;
    assert!(!detail.contains("debris") && detail.contains("FE shows no zone"), "{detail}");
    v.largest_displacement_m = Both { fe: 2e-5, mbs: 2.4e-5 };
    v.largest_difference_m = 4e-6;
    assert!(verdict(&v).headline.contains("4.0 µm apart (FE 20.0 µm, MBS 24.0 µm)"));
    v.largest_difference_m = 0.06;
    assert!(!v.agrees() && verdict(&v).headline.contains("limit ≤ 0.10, or 50 mm apart"));
    // no error is relative to the round-off of an FE run at rest
    (v.e_to_contact, v.largest_displacement_m.fe) = (Some(0.0), 1e-13);
    let words = verdict(&v).headline;
    assert!(!v.agrees() && words.contains("FE at rest, displacements at most 60.0 mm apart"), "{words}");
    v.largest_difference_m = 3e-4;
    assert!(
        v.agrees() && verdict(&v).headline.contains("stands in both, displacements at most 0.3 mm apart")
    );
}

fn doubt(kind: Doubt, words: &str) -> Vec<Undecided> {
    vec![Undecided { kind, words: words.into() }]
}

/// Two runs that end while the building still comes down say nothing about its collapse, however near they are to each other.
#[test]
fn runs_that_end_early_are_undecided() {
    let early = Validation {
        undecided: doubt(Doubt::StillMoves, "FE run: at the end, 0.5000 s, \"S3\" still moves at 2.9 m/s"),
        collapsed: Both { fe: false, mbs: false },
        first_contact_s: Both { fe: None, mbs: None },
        ..good()
    };
    assert_eq!((early.agreement(), early.agrees()), (None, false));
    let words = verdict(&early);
    assert_eq!(words.status, Status::Unknown);
    assert!(words.headline.contains("is undecided: FE run: at the end, 0.5000 s"), "{}", words.headline);
    assert!(words.detail.starts_with("The structure has not collapsed in either run so far."));
    let undecided: Vec<String> =
        checks(&early).into_iter().filter(|c| c.status == Status::Unknown).map(|c| c.label).collect();
    assert_eq!(undecided, ["Time of the first ground contact", "Collapse"]);
    // one has come down, the other is on its way
    let one = Validation { collapsed: Both { fe: true, mbs: false }, ..early.clone() };
    assert_eq!(one.agreement(), None);
    // what a longer run cannot mend fails all the same
    let far = Validation { e_to_contact: Some(0.9), largest_difference_m: 0.6, ..early };
    assert_eq!((far.agreement(), verdict(&far).status), (Some(false), Status::Fail));
}

/// A building without tracked points has no error of displacements, and no agreement.
#[test]
fn nothing_compared_is_no_agreement() {
    let v = Validation {
        e_to_contact: None,
        e_total: None,
        undecided: doubt(Doubt::NothingCompared, "nothing was compared: no tracked point is in both runs"),
        collapsed: Both { fe: false, mbs: false },
        first_contact_s: Both { fe: None, mbs: None },
        ..good()
    };
    assert_eq!(v.agreement(), None);
    let words = verdict(&v);
    assert!(words.headline.contains("undecided: nothing was compared"), "{}", words.headline);
    assert!(!words.detail.contains("e = "), "{}", words.detail);
    let found = checks(&v);
    assert_eq!((found[0].status, found[0].value.as_str()), (Status::Unknown, "nothing was compared"));
    let json = serde_json::to_value(&v).unwrap();
    assert!(json["e_to_contact"].is_null() && json["hinges"]["precision"].is_null());
}

#[test]
fn slowness_is_shown_but_decides_nothing() {
    let v = Validation { speed_ratio: 0.5 * LIMIT_SPEED, ..good() };
    assert_eq!(failed(&v), ["Speed"]);
    assert!(v.agrees() && verdict(&v).status == Status::Pass);
}

#[test]
fn missed_column_ends_are_shown_and_decide_nothing_about_the_time_before_contact() {
    let v = Validation { missed_column_ends: vec!["C1-A1.top".into()], ..good() };
    assert_eq!(failed(&v), ["FE zones at column ends missed by the MBS"]);
    assert!(v.agrees());
}

#[test]
fn without_contact_the_phase_is_the_whole_run() {
    let v = Validation {
        first_contact_s: Both { fe: None, mbs: None },
        collapsed: Both { fe: false, mbs: false },
        ..good()
    };
    assert!(v.agrees() && verdict(&v).headline.contains("up to the end of the run"));
    assert!(verdict(&v).detail.contains("does not collapse in either run"));
}

#[test]
fn an_energy_error_above_its_limit_is_told_with_it() {
    assert_eq!((energy_words(0.02).as_str(), energy_warning(0.02)), ("2.00 %", None));
    assert_eq!([2.2e-5, 0.0, 1e-3].map(percent), ["0.0022 %", "0.00 %", "0.10 %"], "what there is");
    assert_eq!(energy_words(0.0349), "3.49 %, above the limit of 2 %");
    let said = energy_warning(0.0349).unwrap();
    assert!(said.contains("above the limit of 2 %") && said.contains("settings.time_step_s"), "{said}");
}

#[test]
fn a_share_of_nothing_is_no_number() {
    let sites = |places: &[(bool, bool)]| sites_words(&Sites::of(places.iter().copied()));
    assert_eq!(sites(&[(true, false), (false, false)]), ["-", "0.00", "0.00"]);
    assert_eq!(sites(&[(false, false)]), ["-", "-", "-"]);
    assert_eq!(sites(&[(true, true), (false, true)]), ["0.50", "1.00", "0.67"]);
    let hinges = Sites::of([(true, false), (true, false)].into_iter());
    let said = verdict(&Validation { hinges, ..good() }).detail;
    assert!(
        said.contains("None of 2 FE zones has a hinge that turns plastically by more than 0.02 rad"),
        "{said}"
    );
    assert!(!said.contains("precision") && !said.contains("1.00"), "{said}");
}

/// A beam that bends in its middle has hinges at its ends, under whose names results tell of them.
#[test]
fn hinges_of_a_beam_are_at_its_ends() {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut bushing = Bushing::free("S1/1|S1/2".into(), None, "S1/2".into(), [0.0; 3], axes);
    assert_eq!(bushing.names(), ["S1/1|S1/2"]);
    let ends = ["B1.start", "B1.end"].map(String::from);
    bushing.beam = Some(Beam { half_length_m: 2.0, ends, span: None });
    assert_eq!(bushing.names(), ["B1.start", "B1.end"]);
}
