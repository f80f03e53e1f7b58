//! Beams that may break away from their slabs: bodies and latent bushings by hand, the same history until something parts, and who says why.

use super::*;
use fallwerk::building::{Override, OverrideAction};
use fallwerk::curve::ResistanceCurve;
use fallwerk::generate::{Alternative, web_of};
use fallwerk::mbs::latent::merge;
use fallwerk::mbs::model::{Body, Model};
use fallwerk::mbs::result::EventKind;
use fallwerk::mbs::{SolverOptions, simulate, simulate_with};
use fallwerk::rules::Source;

const FRONT: &str = "B1-A1-B1";
/// Yield stress of the reference \[Pa\].
const FLOWS_PA: f64 = 10.5e6;
/// Resistance of webs that break away in any case over that of their faces.
const WEAK: f64 = 0.3;

fn overridden(targets: &[&str], more: &[(&str, OverrideAction)]) -> Building {
    let one = |target: &str, action: OverrideAction| Override {
        target: target.to_string(),
        action,
        reason: format!("reason of {target}"),
    };
    let asked = targets.iter().map(|t| one(t, OverrideAction::BreakAway));
    let overrides = asked.chain(more.iter().map(|(t, action)| one(t, *action))).collect();
    Building { overrides, ..reference(|t| t) }
}

/// With all beams.
fn all_breaking() -> Generated {
    let beams: Vec<String> =
        reference(|t| t).members.iter().map(|m| m.id.clone()).filter(|id| id.starts_with('B')).collect();
    breaking(&beams.iter().map(String::as_str).collect::<Vec<_>>())
}

fn breaking(targets: &[&str]) -> Generated {
    let generated = generated(&overridden(targets, &[])).expect("the library holds all entries");
    generated.model.check().expect("a sound model");
    generated
}

fn bushing<'a>(model: &'a Model, id: &str) -> &'a Bushing {
    model.bushings.iter().find(|b| b.id == id).unwrap_or_else(|| panic!("{id}"))
}

fn body<'a>(model: &'a Model, id: &str) -> &'a Body {
    model.bodies.iter().find(|b| b.id == id).unwrap_or_else(|| panic!("{id}"))
}

/// The model that runs first.
fn merged(model: &Model) -> Model {
    let latent: Vec<bool> = model.bushings.iter().map(|b| b.latent.is_some()).collect();
    Model { curves: model.curves.clone(), ..merge(model, &latent).model }
}

/// Half a beam of 0.3 m by 0.25 m below its slab, from the face of its column to the middle of 6 m: 2.8 m.
#[test]
fn webs_have_bodies_and_latent_bushings_with_what_their_faces_bear() {
    let (with, without) = (breaking(&[FRONT]).model, generated(&reference(|t| t)).unwrap().model);
    let new: Vec<&str> = with
        .bodies
        .iter()
        .map(|b| b.id.as_str())
        .filter(|id| without.bodies.iter().all(|b| b.id != *id))
        .collect();
    assert_eq!(new, ["B1-A1-B1/1", "B1-A1-B1/2"]);
    let [length, width, depth] = [2.8, 0.3, 0.25];
    assert!((body(&with, new[0]).mass_kg / (2500.0 * length * width * depth) - 1.0).abs() < 1e-9);
    let own: Vec<&str> = with
        .bushings
        .iter()
        .filter(|b| b.body_b.starts_with("B1-A1-B1/") && b.latent.is_some())
        .map(|b| b.id.as_str())
        .collect();
    let of = |web: &str, end: &str| ["slab-1", "slab-2", end].map(|face| format!("B1-A1-B1/{web}.{face}"));
    assert_eq!(own, [of("1", "start"), of("2", "end")].concat());
    // by hand: sides of the faces, and the length of the elements behind them
    let faces = [("slab-1", [0.5 * length, width], depth), ("start", [width, depth], 2.8 / 7.0)];
    for (face, sides, row_m) in faces {
        let joint = bushing(&with, &format!("B1-A1-B1/1.{face}"));
        assert_eq!((joint.body_a.as_deref(), joint.latent.as_deref()), (Some("S1/1-1"), Some("B1-A1-B1/1")));
        let close = |found: f64, wanted: f64, what: &str| {
            assert!((found / wanted - 1.0).abs() < 1e-6, "{face} {what}: {found} {wanted}")
        };
        let tears_n = FLOWS_PA * sides[0] * sides[1];
        close(joint.tensile_capacity_n.unwrap(), tears_n, "tension");
        close(joint.compressive_capacity_n.unwrap(), tears_n, "compression");
        for shear_n in joint.shear_capacity_n.unwrap() {
            close(shear_n, tears_n / 3.0_f64.sqrt(), "shear");
        }
        close(joint.tensile_elongation_m.unwrap(), 0.1 * row_m, "elongation");
        for k in 0..2 {
            let curve: &ResistanceCurve = &with.curves[joint.bending[k].curve().unwrap()];
            let [across, along] = [sides[k], sides[1 - k]];
            close(curve.levels[0].capacity[0][1], FLOWS_PA * across * along * along / 4.0, "bending");
            close(curve.levels[0].fracture_rotation_rad, 0.1 * row_m / (0.5 * along), "rotation");
        }
    }
}

/// The bodies that run are those without webs, and the springs in the middle of a span add up to the one without, in every part of the law.
#[test]
fn webs_take_nothing_from_what_moves_as_one() {
    let (with, without) = (merged(&all_breaking().model), generated(&reference(|t| t)).unwrap().model);
    let whole = merged(&without);
    assert_eq!(with.bodies.len(), whole.bodies.len());
    for (a, b) in with.bodies.iter().zip(&whole.bodies) {
        assert_eq!(a.id, b.id);
        assert!((a.mass_kg / b.mass_kg - 1.0).abs() < 1e-12, "{}", a.id);
        for i in 0..3 {
            assert!((a.position_m[i] - b.position_m[i]).abs() < 1e-12, "{}", a.id);
            let scale = a.inertia_kg_m2[i][i];
            assert!(
                (0..3).all(|j| (a.inertia_kg_m2[i][j] - b.inertia_kg_m2[i][j]).abs() < 1e-11 * scale),
                "{}",
                a.id
            );
        }
    }
    assert_eq!(with.shared_masses.len(), 3);
    let (whole, slab, web) = (
        bushing(&without, "S1/1-1|S1/2-1"),
        bushing(&with, "S1/1-1|S1/2-1"),
        with.bushings.iter().find(|b| b.id == "B1-A1-B1/1|B1-A1-B1/2").unwrap(),
    );
    let share = web.axial_stiffness_n_m / whole.axial_stiffness_n_m;
    // most of what the section bears is the web's, 0.25 m below a slab of 0.25 m and 2.7 m
    assert!((0.2..0.8).contains(&share), "{share}");
    let numbers = |b: &Bushing| {
        [
            b.axial_stiffness_n_m,
            b.shear_stiffness_n_m[0],
            b.torsional_stiffness_nm_rad,
            b.tensile_capacity_n.unwrap(),
            b.beam.as_ref().unwrap().span.unwrap().mass_kg_m,
        ]
    };
    for ((all, of_slab), of_web) in numbers(whole).into_iter().zip(numbers(slab)).zip(numbers(web)) {
        assert!((of_web / all - share).abs() < 1e-12 && ((of_slab + of_web) / all - 1.0).abs() < 1e-12);
    }
    let curve = |model: &Model, b: &Bushing| {
        b.bending.iter().find_map(|k| k.curve()).map(|id| model.curves[id].clone()).unwrap()
    };
    let (all, own) = (curve(&without, whole), curve(&with, web));
    for (a, b) in all.levels.iter().zip(&own.levels) {
        assert!((b.axial_force_n - share * a.axial_force_n).abs() < 1.0);
        assert!(
            a.capacity
                .iter()
                .zip(&b.capacity)
                .all(|(p, q)| p[0] == q[0] && (q[1] - share * p[1]).abs() < 1e-6)
        );
    }
    assert_eq!(web.beam.as_ref().unwrap().ends, ["B1-A1-B1.start", "B1-A1-B1.end"].map(String::from));
}

/// Until the first blow the histories are the same but for round-off; nothing gives way before a rule has asked for it; and with webs that hold the end is about the same.
#[test]
fn nothing_changes_before_a_beam_breaks_away() {
    let (mut with, mut without) = (all_breaking().model, generated(&reference(|t| t)).unwrap().model);
    // springs become softer one by one: a span in two of them stays stiffer than in one
    (with.settings.soft_after_m, without.settings.soft_after_m) = (None, None);
    // the webs of the reference hold
    for web in with.bushings.iter_mut().filter(|b| b.latent.is_some() && b.id.starts_with('B')) {
        for axis in &mut web.bending {
            if let Bending::Curve { strength_factor, .. } = axis {
                *strength_factor *= WEAK;
            }
        }
        web.shear_capacity_n = web.shear_capacity_n.map(|both| both.map(|n| WEAK * n));
        web.tensile_capacity_n = web.tensile_capacity_n.map(|n| WEAK * n);
        web.compressive_capacity_n = web.compressive_capacity_n.map(|n| WEAK * n);
    }
    let (a, b) = (simulate(&with).unwrap(), simulate(&without).unwrap());
    let first_s = a.events.iter().find(|e| matches!(e.kind, EventKind::Rule { .. })).unwrap().time_s;
    let before = a.times_s.iter().filter(|t| **t < first_s).count();
    assert!(before > 100);
    for (p, q) in a.tracked.iter().zip(&b.tracked) {
        for t in 0..before {
            let off =
                (0..3).map(|i| (p.displacement_m[t][i] - q.displacement_m[t][i]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{} at {}: {off}", p.id, a.times_s[t]);
        }
    }
    let mut asked = std::collections::BTreeSet::new();
    let mut parted = 0;
    for event in &a.events {
        match &event.kind {
            EventKind::Rule { watched, .. } => asked.extend(watched.clone()),
            EventKind::Live { joint, .. } => {
                assert!(asked.contains(joint), "{joint} went live before a rule asked for it");
                parted += usize::from(joint.starts_with('B'));
            }
            _ => {}
        }
    }
    assert!(parted > 0, "no beam breaks away from a floor that strikes the ground");
    assert!(a.energy_error < 0.01, "{}", a.energy_error);
    let hold = |m: &Model| {
        simulate_with(m, &SolverOptions { hold_latent: true, ..SolverOptions::default() }).unwrap()
    };
    let (a, b) = (hold(&with), hold(&without));
    let last = |run: &fallwerk::mbs::RunResult| {
        run.tracked.iter().map(|p| p.displacement_m.last().unwrap()[2]).collect::<Vec<_>>()
    };
    // single pieces of debris come to lie here or there
    let mut off: Vec<f64> = last(&a).into_iter().zip(last(&b)).map(|(p, q)| (p - q).abs()).collect();
    off.sort_by(f64::total_cmp);
    assert!(off[off.len() / 2] < 0.1, "{off:?}");
}

#[test]
fn who_has_a_beam_break_away_is_named_and_so_is_why_others_stay() {
    let generated = breaking(&[FRONT]);
    let own: Vec<_> = generated.trace.iter().filter(|r| r.subject == web_of(FRONT)).collect();
    assert_eq!(own.len(), 6);
    for reason in own {
        assert!(reason.part.starts_with("B1-A1-B1/") && reason.is_of_analyst(), "{reason:?}");
        assert_eq!((reason.action.as_str(), reason.words.as_str()), ("break_away", "reason of B1-A1-B1"));
    }
    let of = |id: &str| generated.event_rules.iter().find(|r| r.id == id).unwrap_or_else(|| panic!("{id}"));
    for id in ["seed/contact-subsystem", "seed/ground-contact-subsystem", "seed/fracture-recheck"] {
        assert!(of(id).members.iter().any(|m| m == FRONT), "{id}");
    }
    let rule = generated.model.event_rules.iter().find(|r| r.id == "seed/contact-recheck").unwrap();
    assert!(
        rule.watch.iter().any(|w| w == "B1-A1-B1/1.slab-1")
            && rule.watch.iter().any(|w| w == "C2-A2.section-1")
    );
    assert!(rule.bodies.iter().any(|b| b == "B1-A1-B1/2"));
    let [stays] = &generated.stays[..] else { panic!("{:?}", generated.stays) };
    assert!(stays.beams.len() == 11 && !stays.beams.iter().any(|b| b == FRONT), "{stays:?}");
    assert!(
        stays.why.contains("`seed/beam-breaks-away`") && stays.why.contains("wish.accuracy"),
        "{}",
        stays.why
    );
    let doubt = generated.doubts.iter().find(|d| d.action == "break_away").unwrap();
    assert_eq!(
        (&doubt.subjects[..], &doubt.alternative),
        (&[FRONT.to_string()][..], &Alternative::Without(FRONT.into()))
    );
    let beams: Vec<_> = generated
        .unasked
        .iter()
        .filter(|u| u.events == "contacts and fractures" && u.about == "beams")
        .collect();
    assert!(!beams.is_empty());
    for group in beams {
        assert_eq!((group.why.as_str(), group.members.len()), ("these stay one with their slabs", 11));
    }
}

/// A beam that ends at another one hangs on its slab alone: what it ends at may break away as well, or not.
#[test]
fn a_beam_that_ends_at_a_beam_hangs_on_its_slab_there() {
    let second = |t: String| {
        t + "\n[[members]]\nid = \"B\"\nkind = \"beam\"\nsection = \"beam\"\nfrom = [1.5, 0, 3.5]\nto = [1.5, 5, 3.5]\n"
    };
    let ends = |targets: &[&str]| -> Vec<String> {
        let building = Building { overrides: overridden(targets, &[]).overrides, ..reference(second) };
        let (rules, mut store, _cache) = knowledge();
        let wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Balanced };
        let model = generate(&building, &rules, &mut store, wishes, &|_| {}).unwrap().model;
        let own = model.bushings.iter().filter(|b| b.latent.is_some() && b.id.starts_with("B/"));
        own.map(|b| b.id.clone()).filter(|id| !id.contains("slab")).collect()
    };
    assert_eq!(ends(&["B"]), ["B/1.start", "B/2.end"]);
    assert_eq!(ends(&["B", FRONT]), ["B/2.end"]);
}

#[test]
fn what_cannot_break_away_is_told() {
    let (rules, mut store, _cache) = knowledge();
    let mut refused = |building: &Building, accuracy: Accuracy| {
        let wishes = Wishes { derive: Derive::Never, accuracy };
        generate(building, &rules, &mut store, wishes, &|_| {}).unwrap_err().to_string()
    };
    let error = refused(&overridden(&[FRONT], &[]), Accuracy::Fast);
    assert_eq!(
        error,
        "the override of B1-A1-B1 cannot be carried out: the floor S1 does not bend; `merge_elastic` has it bend, and so does `--accuracy balanced`"
    );
    let upstand = |t: String| {
        t.replace("beams = \"perimeter\"", "beams = \"none\"")
            + "\n[[members]]\nid = \"B\"\nkind = \"beam\"\nsection = \"beam\"\nfrom = [0, 0, 3.75]\nto = [6, 0, 3.75]\n"
    };
    let building = Building { overrides: overridden(&["B"], &[]).overrides, ..reference(upstand) };
    let error = refused(&building, Accuracy::Balanced);
    assert!(error.contains("the override of B cannot be carried out: no slab lies on it"), "{error}");
}

#[test]
fn a_rule_has_beams_break_away_and_what_it_cannot_have_is_noted() {
    let ask = |when: &str, accuracy: Accuracy| {
        let (shipped, mut store, _cache) = knowledge();
        let text = format!(
            "schema = 1\n[[rule]]\nid = \"test/away\"\nwords = \"A test.\"\napplies_to = \"member\"\nwhen = \"{when}\"\naction = \"break_away\"\npriority = 100\nsource = \"assumption: of this test\"\n"
        );
        let rules = shipped.with(vec![Source { name: "test.toml".into(), text }]).expect("sound rules");
        let wishes = Wishes { derive: Derive::Never, accuracy };
        generate(&reference(|t| t), &rules, &mut store, wishes, &|_| {}).unwrap()
    };
    let webs = |g: &Generated| g.model.bodies.iter().filter(|b| b.id.starts_with('B')).count();
    let all = ask("collapse.phase == 'after_contact' and member.kind == 'beam'", Accuracy::Balanced);
    assert_eq!((webs(&all), all.stays.len()), (24, 0));
    assert!(
        all.trace
            .iter()
            .any(|r| r.rule == "test/away" && r.part == "B2-A1-A2/1.slab-1" && r.action == "break_away")
    );
    assert!(!all.notes.iter().any(|n| n.contains("break away")), "{:?}", all.notes);
    let whole = ask("collapse.phase == 'after_contact' and member.kind == 'beam'", Accuracy::Fast);
    assert_eq!(webs(&whole), 0);
    let note = whole.notes.iter().find(|n| n.contains("cannot break away")).unwrap();
    assert!(note.starts_with("B1-A1-B1, ") && note.contains("the floor S1 does not bend"), "{note}");
    assert!(whole.stays.iter().any(|s| s.why.contains("does not bend")));
    let slabs = ask("member.kind == 'slab'", Accuracy::Balanced);
    assert_eq!(webs(&slabs), 0);
    let note = slabs.notes.iter().find(|n| n.contains("break away from a slab")).unwrap();
    assert_eq!(
        note,
        "rule `test/away` has S1, S2, S3 break away from a slab, which only beams can: ask for `member.kind == 'beam'` in its condition"
    );
}
