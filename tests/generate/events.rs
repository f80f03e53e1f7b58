//! Rules about contacts and fractures in generated models: what is left of them, and that they fire while the model runs.

use super::*;
use fallwerk::mbs::result::EventKind;
use fallwerk::mbs::simulate;
use fallwerk::rules::Source;

/// The shipped rules and some of a test.
fn with(rules: &str) -> RuleBase {
    let (shipped, ..) = knowledge();
    let source = Source { name: "test.toml".into(), text: format!("schema = 1\n{rules}") };
    shipped.with(vec![source]).expect("sound rules")
}

fn rule(id: &str, about: &str, when: &str, action: &str, parameters: &str) -> String {
    format!(
        "\n[[rule]]\nid = \"test/{id}\"\nwords = \"A test.\"\napplies_to = \"{about}\"\nwhen = \"{when}\"\naction = \"{action}\"\nparameters = {{ {parameters} }}\npriority = 100\nsource = \"assumption: of this test\"\n"
    )
}

fn of(rules: &RuleBase) -> fallwerk::mbs::Model {
    let (_, mut store, _cache) = knowledge();
    generate(&reference(|t| t), rules, &mut store, Derive::Never, &|_| {}).unwrap().model
}

/// The seed's rules ask for hinges in what is struck or breaks.
#[test]
fn the_rules_about_events_stand_in_the_model() {
    let generated = generated(&reference(|t| t)).unwrap();
    let model = &generated.model;
    let of = |id: &str| model.event_rules.iter().find(|r| r.id == id).unwrap_or_else(|| panic!("{id}"));
    let ground = of("seed/ground-contact-subsystem");
    let Trigger::Contact { partners, approach_speed_m_s, .. } = &ground.on else { panic!("{:?}", ground.on) };
    assert_eq!(partners, &[Met::Ground, Met::Obstacle]);
    assert!(approach_speed_m_s.is_any() && !ground.nearest);
    assert_eq!((ground.bodies.len(), ground.watch.len()), (20, 10));
    let fracture = of("seed/fracture-subsystem");
    assert!(fracture.nearest);
    let Trigger::Fracture { places, after_contact, .. } = &fracture.on else { panic!("{:?}", fracture.on) };
    assert_eq!((places.as_slice(), *after_contact), ([Broken::End, Broken::Span].as_slice(), None));
    // charged columns vanish whole, with their one body
    assert!(model.bodies.iter().any(|b| b.id == "C1-A1") && model.bodies.iter().all(|b| b.id != "C1-A2"));
    // the section is that of the end, without what the joint lends to it
    let bushing = |id: &str| model.bushings.iter().find(|b| b.id == id).unwrap();
    let curve = |b: &Bushing| model.curves[b.bending[0].curve().unwrap()].clone();
    let (end, section) = (curve(bushing("C2-A2.bottom")), curve(bushing("C2-A2.section-1")));
    for (a, b) in end.levels.iter().zip(&section.levels) {
        // where the axial force has no lever about the hinge of the end yet
        let lends = a.capacity[0][1] / b.capacity[0][1];
        assert!((1.1..1.4).contains(&lends), "{lends}");
    }
    // a J2 material bears 1/sqrt(3) of its tensile stress in pure shear, and strains by sqrt(3) of its plastic strain
    let tears_n = bushing("C2-A2.section-1").tensile_capacity_n.unwrap();
    let [v1, v2] = bushing("C2-A2.section-1").shear_capacity_n.unwrap();
    assert!(((v1 / tears_n).powi(2) * 3.0 - 1.0).abs() < 1e-12 && v1 == v2, "{v1} {v2} of {tears_n}");
    let end = bushing("C2-A2.bottom");
    assert_eq!((end.shear_capacity_n, bushing("C2-A2.section-1").shear_slip_m), (Some([v1, v2]), None));
    assert!((end.shear_slip_m.unwrap() / end.tensile_elongation_m.unwrap()).powi(2) - 3.0 < 1e-12);
    let why: Vec<&str> =
        generated.trace.iter().filter(|r| r.part == "C2-A2.section-1").map(|r| r.rule.as_str()).collect();
    assert_eq!(why, ["seed/subdivide-columns-late", "seed/section-latent-late"]);
}

/// Each of them is told with its members, what is left of its condition and what was carried out at once.
#[test]
fn the_trace_tells_the_rules_about_events() {
    let generated = generated(&reference(|t| t)).unwrap();
    let ids: Vec<&str> = generated.event_rules.iter().map(|r| r.id.as_str()).collect();
    assert_eq!(ids, generated.model.event_rules.iter().map(|r| r.id.as_str()).collect::<Vec<_>>());
    let of = |id: &str| generated.event_rules.iter().find(|r| r.rule == id).unwrap_or_else(|| panic!("{id}"));
    let ground = of("seed/ground-contact-subsystem");
    assert_eq!((ground.members.len(), ground.members[0].as_str()), (10, "C1-A2"));
    assert_eq!((ground.question.as_str(), ground.action.as_str()), ("change", "insert_subsystem"));
    assert_eq!(ground.remains, "it meets the ground or an obstacle");
    assert!(ground.when.contains("contact.partner in") && ground.words.starts_with("Where a part meets"));
    assert!(ground.done.as_ref().is_some_and(|d| d.contains("crushed")), "{ground:?}");
    assert_eq!(of("seed/contact-recheck").remains, "it meets the ground, an obstacle or another part");
    let fracture = of("seed/fracture-subsystem");
    assert_eq!((fracture.remains.as_str(), &fracture.done), ("it breaks", &None));
    assert!(fracture.then.contains("nearest"));
    // of what is left of ranges and phases
    let rule = rule(
        "late",
        "fracture_event",
        "collapse.phase == 'after_contact' and fracture.place == 'span' and event.time <= 1.5",
        "keep_model",
        "",
    );
    let (_, mut store, _cache) = knowledge();
    let own = generate(&reference(|t| t), &with(&rule), &mut store, Derive::Never, &|_| {}).unwrap();
    let late = own.event_rules.iter().find(|r| r.rule == "test/late").unwrap();
    assert_eq!(late.remains, "it breaks between its ends, after something has met, 1.5 s of the run or less");
    assert_eq!(late.then, "the model stays as it is");
}

/// Rules about events that are not asked are named, with what they are about.
#[test]
fn rules_about_events_that_are_not_asked_are_named() {
    let base = generated(&reference(|t| t)).unwrap().unasked;
    let about = |list: &[fallwerk::generate::Unasked], rule: &str| -> Vec<String> {
        let own = list.iter().filter(|u| u.rules.iter().any(|r| r == rule));
        own.map(|u| format!("{}: {}", u.about, u.why)).collect()
    };
    let stay = "these stay as they are generated";
    assert_eq!(about(&base, "seed/subdivide-floors-late"), [format!("beams and slabs: {stay}")]);
    assert_eq!(about(&base, "seed/section-latent-late"), [format!("sections of beams and slabs: {stay}")]);
    assert_eq!(about(&base, "seed/contact-subsystem"), [format!("beams and slabs: {stay}")]);
    assert_eq!(about(&base, "seed/subdivide-columns-late"), Vec::<String>::new(), "it is asked");
    // those that what is known of the building refutes, and those that do not need an event, are not among them
    for rule in ["learned/floors-late/low-building-charged-share", "seed/floor-yields", "seed/floor-bends"] {
        assert_eq!(about(&base, rule), Vec::<String>::new(), "{rule}");
    }
    let ends = base.iter().find(|u| u.about == "ends of beams").unwrap();
    assert!(ends.rules.iter().all(|r| r.starts_with("learned/beam-ends-late/")), "{ends:?}");
    assert!(ends.members.contains(&"B1-A1-B1".to_string()) && !ends.members.contains(&"C1-A1".to_string()));
    assert!(ends.words().starts_with("rules learned/beam-ends-late/"), "{}", ends.words());

    let unasked = |accuracy: Accuracy, when: &str| {
        let (_, mut store, _cache) = knowledge();
        let rules = with(&rule("own", "contact_event", when, "keep_model", ""));
        let wishes = Wishes { derive: Derive::Never, accuracy };
        about(&generate(&reference(|t| t), &rules, &mut store, wishes, &|_| {}).unwrap().unasked, "test/own")
    };
    assert_eq!(unasked(Accuracy::Balanced, "member.kind == 'slab'"), [format!("slabs: {stay}")]);
    assert_eq!(
        unasked(Accuracy::Balanced, "member.strain_rate > 0.25 and contact.approach_speed > 1"),
        [
            format!("beams and slabs: {stay}"),
            "columns: a run does not evaluate member.strain_rate".to_string()
        ]
    );
    assert_eq!(
        unasked(Accuracy::Fast, "member.kind == 'column'"),
        ["columns: none of them may break between its ends"]
    );
    assert!(unasked(Accuracy::Balanced, "member.kind == 'column'").is_empty());
}

/// What is known beforehand is decided beforehand, the rest is left for the run.
#[test]
fn what_is_left_of_a_condition_is_what_is_not_known_yet() {
    let model = of(&with(&rule(
        "fast",
        "contact_event",
        "contact.approach_speed > 3 and (contact.partner == 'obstacle' or event.time <= 1.5) and member.kind == 'column' and storeys >= 2",
        "insert_subsystem",
        "subsystem = 'hinge', place = 'nearest_section'",
    )));
    let own: Vec<_> = model.event_rules.iter().filter(|r| r.id.starts_with("test/fast")).collect();
    assert_eq!(own.iter().map(|r| r.id.as_str()).collect::<Vec<_>>(), ["test/fast/1", "test/fast/2"]);
    let at_least = Range { least: Some(3.0), most: None };
    let ask = |partners: &[Met], time_s: Range| Trigger::Contact {
        partners: partners.to_vec(),
        approach_speed_m_s: at_least,
        time_s,
    };
    assert_eq!(own[0].on, ask(&[Met::Obstacle], Range::default()));
    assert_eq!(
        own[1].on,
        ask(&[Met::Ground, Met::Obstacle, Met::Part], Range { least: None, most: Some(1.5) })
    );
    assert!(own.iter().all(|r| r.nearest && r.question == "change"));
    // a rule about slabs, or of what nobody knows, is never true of a column
    for when in ["member.kind == 'slab'", "member.strain_rate > 0.25"] {
        let model = of(&with(&rule("other", "contact_event", when, "keep_model", "")));
        assert!(model.event_rules.iter().all(|r| !r.id.starts_with("test/")), "{when}");
    }
    let rules = with(&rule("odd", "contact_event", "event.time < 2 * event.time", "keep_model", ""));
    let (_, mut store, _cache) = knowledge();
    let error =
        generate(&reference(|t| t), &rules, &mut store, Derive::Never, &|_| {}).unwrap_err().to_string();
    assert!(error.contains("rule `test/odd` compares `event.time` with another feature"), "{error}");
}

/// A rule that another one supersedes is asked where that one does not fire, or is outside its range, whatever their priorities.
#[test]
fn superseded_rules_are_asked_where_the_other_one_does_not_fire() {
    const SEED: &str = "seed/ground-contact-subsystem";
    let own = |when: &str, range: &str| {
        let own =
            rule("own", "contact_event", when, "keep_model", "").replace("priority = 100", "priority = 0");
        with(&format!("{own}supersedes = ['{SEED}']\nrange = {{ {range} }}\n"))
    };
    let asked = |rules: &RuleBase| -> Vec<(Range, Range)> {
        let rules = of(rules).event_rules.into_iter().filter(|r| r.id.starts_with(SEED));
        let on = rules.map(|r| match r.on {
            Trigger::Contact { approach_speed_m_s, time_s, .. } => (approach_speed_m_s, time_s),
            other => panic!("{other:?}"),
        });
        on.collect()
    };
    let (any, most) = (Range::default(), |x: f64| Range { least: None, most: Some(x) });
    assert_eq!(asked(&own("contact.approach_speed > 3", "")), [(most(3.0), any)]);
    let ranged = asked(&own("contact.approach_speed > 3", "'event.time' = [0, 1.5]"));
    assert_eq!(ranged[..2], [(most(3.0), any), (any, most(0.0))], "slowly, or before the range");
    let after_s = ranged[2].1.least.unwrap();
    assert!(ranged.len() == 3 && (after_s - 1.5).abs() < 1e-4 && ranged[2].0 == any, "{ranged:?}");
    // one that never fires here, is out of its range, or whose range nobody will know, takes nothing
    for (when, range) in [
        ("member.kind == 'slab'", ""),
        ("storeys > 2", "storeys = [5, 9]"),
        ("always", "'member.strain_rate' = [0, 100]"),
    ] {
        assert_eq!(asked(&own(when, range)), [(any, any)], "{when}");
    }
    // and one that always fires all of it
    let rules = own("always", "");
    assert!(asked(&rules).is_empty());
    let (_, mut store, _cache) = knowledge();
    let unasked = generate(&reference(|t| t), &rules, &mut store, Derive::Never, &|_| {}).unwrap().unasked;
    let columns = unasked.iter().find(|u| u.about == "columns" && u.rules.iter().any(|r| r == SEED)).unwrap();
    assert!(columns.why.starts_with("other rules supersede"), "{columns:?}");
}

/// What falls into more cases than a model can ask is refused, and not left out.
#[test]
fn intricate_rules_about_events_are_refused() {
    let pair = |n: u32| format!("(contact.approach_speed > {n} or event.time > {n})");
    let when = (1..=13).map(pair).collect::<Vec<_>>().join(" and ");
    let (shipped, ..) = knowledge();
    let text = format!("schema = 1\n{}", rule("many", "contact_event", &when, "keep_model", ""));
    let problems = shipped.with(vec![Source { name: "test.toml".into(), text }]).unwrap_err();
    let text = format!("{problems:?}");
    assert!(text.contains("rule `test/many` falls into too many cases"), "{text}");
}

/// Columns break between their ends after something has struck them, or they broke away, and not before; rules that keep them whole do.
#[test]
fn columns_break_in_the_run_only_where_rules_say_so() {
    let model = of(&knowledge().0);
    let result = simulate(&model).unwrap();
    let mut asked = std::collections::BTreeSet::new();
    let mut broken = 0;
    for event in &result.events {
        match &event.kind {
            EventKind::Rule { watched, .. } => asked.extend(watched.clone()),
            EventKind::Live { joint, .. } => {
                assert!(asked.contains(joint), "{joint} went live before a rule asked for it");
                broken += 1;
            }
            _ => {}
        }
    }
    assert!(broken >= 3, "{broken} of ten columns");
    let keep: String = ["contact_event", "fracture_event"]
        .iter()
        .flat_map(|about| {
            let keep = |action: &str| {
                rule(&format!("{about}-{action}").replace('_', "-"), about, "always", action, "")
            };
            [keep("keep_model"), keep("keep_rigidity")]
        })
        .collect();
    let whole = simulate(&of(&with(&keep))).unwrap();
    assert!(whole.events.iter().all(|e| !matches!(e.kind, EventKind::Live { .. } | EventKind::Rule { .. })));
    // up to the first blow nothing is different
    let first = result.events.iter().find(|e| matches!(e.kind, EventKind::Rule { .. })).unwrap().time_s;
    let same = result.times_s.iter().filter(|t| **t < first).count();
    assert!(same > 100 && result.frames[..same] == whole.frames[..same]);
    assert_ne!(result.frames.last(), whole.frames.last());
}

/// The seed's contact subsystem: the ends of columns that may be struck are crushed, as a prism of theirs was in the library.
#[test]
fn rules_put_contact_subsystems_in() {
    let generated = generated(&reference(|t| t)).unwrap();
    let faces = &generated.model.contact.crushing;
    // both ends of the ten columns that stay
    assert_eq!(faces.len(), 20);
    // yield stress times area, a little hardened
    let strength_n = 0.16 * 10.5e6;
    for face in faces {
        let (first, last) = (face.force_n[0], face.force_n[face.force_n.len() - 1]);
        assert!(first[0] == 0.0 && (1.0..1.06).contains(&(first[1] / strength_n)), "{first:?}");
        assert!(last[1] < 0.1 * first[1], "what eroded bears nothing: {last:?}");
        let key = face.subsystem.as_ref().unwrap();
        assert!(key.starts_with("contact_crushing/") && generated.entries.contains_key(key), "{key}");
    }
    let of_column =
        |id: &str| faces.iter().filter(|f| f.body.starts_with(id)).map(|f| f.face).collect::<Vec<_>>();
    assert_eq!(of_column("C2-A2"), [Face::LowZ, Face::HighZ]);
    assert_eq!(of_column("C1-A1"), []);
    // only hinges, or nothing at all: no contact subsystem
    for (action, parameters) in
        [("insert_subsystem", "subsystem = 'hinge', place = 'nearest_section'"), ("keep_model", "")]
    {
        let model = of(&with(&rule("rigid", "contact_event", "always", action, parameters)));
        assert!(model.contact.crushing.is_empty(), "{action}");
    }
}

/// Forces go with the area, shortenings with the length; the analyst is told.
#[test]
fn ends_without_an_entry_of_their_own_take_that_of_another_size() {
    let (rules, mut store, _cache) = knowledge();
    let wider = reference(|t| {
        t.replace("width = \"400 mm\"  ", "width = \"450 mm\"  ").replace(
            "depth = \"400 mm\"                # of a column",
            "depth = \"450 mm\"                # of a column",
        )
    });
    let model = |derive, store: &mut _| generate(&wider, &rules, store, derive, &|_| {}).unwrap();
    let similar = model(Derive::Similar, &mut store);
    let face = &similar.model.contact.crushing[0];
    let own = of(&rules);
    let ratio = face.force_n[0][1] / own.contact.crushing[0].force_n[0][1];
    assert!((ratio - 0.45 * 0.45 / 0.16).abs() < 1e-9, "{ratio}");
    assert!(
        similar
            .notes
            .iter()
            .any(|n| n.contains("crushing: no entry of its own, curves scaled from contact_crushing/"))
    );
}

/// At the finest level a column that may fall onto an obstacle has three sections in place of one; those that stand on the ground, or far from it, do not.
#[test]
fn columns_before_an_obstacle_are_divided_more_finely() {
    let (rules, mut store, _cache) = knowledge();
    let wall = Path::new(env!("CARGO_MANIFEST_DIR")).join("buildings/three-storey-frame-wall.toml");
    let wall = parse(&std::fs::read_to_string(wall).unwrap(), Format::Toml, "wall").unwrap();
    let mut sections = |building: &Building, accuracy| {
        let wishes = Wishes { derive: Derive::Similar, accuracy };
        let model = generate(building, &rules, &mut store, wishes, &|_| {}).unwrap().model;
        let of = |id: &str| model.event_rules[0].watch.iter().filter(|s| s.starts_with(id)).count();
        [of("C1-A2."), of("C2-A1."), of("C3-A1.")]
    };
    assert_eq!(sections(&wall, Accuracy::Fine), [1, 3, 3]);
    assert_eq!(sections(&wall, Accuracy::Balanced), [1, 1, 1]);
    assert_eq!(sections(&reference(|t| t), Accuracy::Fine), [1, 1, 1]);
}
