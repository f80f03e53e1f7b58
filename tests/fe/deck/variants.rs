//! The same model in all the spellings of decks.

use super::{CUBE, good, same, with};
use fallwerk::fe::deck::{DeckOptions, is_deck, parse, read, write};
use fallwerk::fe::law::{ElementForm, Hourglass};
use fallwerk::fe::model::{Constraint, Model};
use std::fs;

#[test]
fn what_the_cube_says() {
    let deck = good(CUBE);
    let model = &deck.model;
    assert_eq!(model.title, "Cube");
    assert_eq!((model.mesh.nodes.len(), model.mesh.elements.len(), &model.mesh.parts[0][..]), (8, 1, "cube"));
    let law = &model.mesh.laws[0];
    assert_eq!(law.form, ElementForm::OnePoint(Hourglass::Stiffness { coefficient: 0.03 }));
    assert_eq!(law.hardening.iter().map(|p| p.stress_pa).collect::<Vec<_>>(), [3e8, 3.5e8, 3.8e8]);
    assert_eq!((law.erosion.plastic_strain, law.erosion.principal_strain), (0.2, 0.3));
    assert_eq!(law.rate.map(|r| (r.c_1_s, r.p)), Some((40.0, 5.0)));
    assert_eq!(model.constraints[0], Constraint { node: 0, held: [true, true, false] });
    assert_eq!(model.constraints.len(), 4);
    assert_eq!(model.initial_velocity_m_s.len(), 8);
    // a positive body load pulls the mass against its axis
    assert_eq!((model.body_loads[0].axis, model.body_loads[0].acceleration_m_s2.at(0.05)), (2, -9.81));
    assert_eq!((model.walls[0].normal, model.walls[0].friction), ([0.0, 0.0, 1.0], 0.4));
    assert_eq!((model.control.step_safety, model.control.end_time_s), (0.8, 0.1));
    assert_eq!(deck.ids.parts, [10]);
}

/// Fields between commas.
fn with_commas() -> String {
    let line = |line: &str| {
        let digit = line.trim_start().starts_with(|c: char| c.is_ascii_digit());
        if !digit {
            return line.to_string();
        }
        let widths: &[usize] = match line.len() {
            56 => &[8, 16, 16, 16],
            80 if line.starts_with("       1      10") => &[8; 10],
            40 if line.trim_start().starts_with("0.0                9") || line.ends_with("9.81") => &[20; 2],
            _ => &[10; 8],
        };
        let mut fields = Vec::new();
        let mut at = 0;
        for width in widths {
            let to = (at + width).min(line.len());
            fields.push(line[at..to].trim());
            at = to;
        }
        fields.join(",")
    };
    CUBE.lines().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn all_spellings_are_one_model() {
    let model = good(CUBE).model;
    let with_erosion = |text: String| text.replace("                                  0.3", ",,,0.3");
    same(&model, &good(&with_erosion(with_commas())).model);
    let mut small = good(&CUBE.replace('\n', "\r\n").to_lowercase()).model;
    assert_eq!(small.title, "cube");
    small.title = model.title.clone();
    same(&model, &small);
    same(&model, &good(&CUBE.replace("2.1e11", "2.1+11").replace("3.0e8", "3.0D8")).model);
    let two_lines = with(CUBE, "       1      10       1", "       1      10\n       1");
    same(&model, &good(&two_lines).model);
    let commented = CUBE.replace('\n', "\n$ *NODE in a comment\n");
    same(&model, &good(&commented).model);
    let parameter = with(CUBE, "*PART\n", "*PARAMETER\nR  e          2.1e11I n                8\n*PART\n")
        .replace("    2.1e11       0.3", "        &E       0.3");
    same(&model, &good(&parameter).model);
    let titled = with(CUBE, "*SET_NODE_LIST\n", "*SET_NODE_LIST_TITLE\nfoot\n");
    same(&model, &good(&titled).model);
    let generated = with(CUBE, "*SET_NODE_LIST\n", "*SET_NODE_LIST_GENERATE\n")
        .replace("         1         2         3         4\n", "         1         4\n");
    same(&model, &good(&generated).model);
}

#[test]
fn long_format_has_twenty_columns() {
    let model = good(CUBE).model;
    let nodes: String = model
        .mesh
        .nodes
        .iter()
        .enumerate()
        .map(|(i, x)| format!("{:>20}{:>20}{:>20}{:>20}\n", i + 1, x[0], x[1], x[2]))
        .collect();
    let begin = CUBE.find("*NODE\n").unwrap();
    let end = CUBE.find("*ELEMENT_SOLID").unwrap();
    for keyword in ["*NODE+", "*NODE +", "*node+"] {
        same(&model, &good(&format!("{}{keyword}\n{nodes}{}", &CUBE[..begin], &CUBE[end..])).model);
    }
    let all = with(CUBE, "*KEYWORD\n", "*KEYWORD LONG=Y\n");
    let marked = all
        .lines()
        .map(|l| {
            if l.starts_with("*KEYWORD") || l == "*END" || l.starts_with("*NODE") || !l.starts_with('*') {
                l.to_string()
            } else {
                format!("{l}-")
            }
        })
        .collect::<Vec<_>>()
        .join("\n");
    let (begin, end) = (marked.find("*NODE\n").unwrap(), marked.find("*ELEMENT_SOLID").unwrap());
    same(&model, &good(&format!("{}*NODE\n{nodes}{}", &marked[..begin], &marked[end..])).model);
}

#[test]
fn included_files_stand_in_their_place() {
    let room = tempfile::tempdir().unwrap();
    let path = |name: &str| room.path().join(name);
    let begin = CUBE.find("*NODE\n").unwrap();
    fs::create_dir(path("mesh")).unwrap();
    fs::write(path("main.k"), format!("{}*INCLUDE\nmesh/nodes.k\n*END\n", &CUBE[..begin])).unwrap();
    fs::write(
        path("mesh/nodes.k"),
        with(&CUBE[begin..], "*ELEMENT_SOLID\n", "*INCLUDE\nsolid.k\n*COMMENT\n"),
    )
    .unwrap();
    fs::write(path("mesh/solid.k"), "*ELEMENT_SOLID\n1,10,1,2,3,4,5,6,7,8\n").unwrap();
    same(&good(CUBE).model, &read(&path("main.k"), DeckOptions::default()).unwrap().model);
    fs::write(path("mesh/solid.k"), "*INCLUDE\n../main.k\n").unwrap();
    let errors = read(&path("main.k"), DeckOptions::default()).unwrap_err();
    assert!(errors.items().any(|d| d.code == "include-loop"), "{errors}");
    fs::write(path("mesh/solid.k"), "*ELEMENT_SOLID\n1,10,1,2,3,4,5,6,7,x\n").unwrap();
    let errors = read(&path("main.k"), DeckOptions::default()).unwrap_err().to_string();
    assert!(errors.contains("solid.k:2:"), "the included file is named: {errors}");
}

#[test]
fn unknown_keywords_may_be_left_out() {
    let text = with(CUBE, "*NODE\n", "*DEFINE_FRICTION_ORIENTATION\n1,2,3\n*NODE\n");
    assert!(parse(&text, "a.k", DeckOptions::default()).is_err());
    let deck = parse(&text, "a.k", DeckOptions { skip_unknown: true, ..DeckOptions::default() }).unwrap();
    same(&deck.model, &good(CUBE).model);
    assert!(deck.notes.iter().any(|n| n.text.contains("*DEFINE_FRICTION_ORIENTATION")), "{:?}", deck.notes);
}

/// An hourglass control that names none does not take that of the deck.
#[test]
fn hourglass_control_without_a_kind_is_noted() {
    let text = with(
        CUBE,
        "        40         5      0.03\n",
        "        40\n*CONTROL_HOURGLASS\n         6       1.0\n",
    );
    let deck = good(&text);
    let viscous = ElementForm::OnePoint(Hourglass::Viscous { coefficient: 0.1 });
    assert_eq!(deck.model.mesh.laws[0].form, viscous);
    assert!(deck.notes.iter().any(|n| n.text.contains("IHQ of *HOURGLASS is 0")), "{:?}", deck.notes);
}

/// Fully integrated elements erode by their mean, which is told where they do.
#[test]
fn erosion_by_the_mean_of_the_points_is_noted() {
    let noted =
        |text: &str| good(text).notes.iter().any(|n| n.text.contains("mean plastic strain of their points"));
    assert!(!noted(CUBE));
    assert!(noted(&with(CUBE, "        20         1\n", "        20         2\n")));
}

/// The rate factor takes the rate of the plastic strain and acts on the whole table: what VP means elsewhere is noted where it is something
/// else, and changes nothing. Decks are written with VP = 1.
#[test]
fn what_the_rate_factor_is_elsewhere() {
    let vp = |text: &str, vp: &str| with(text, "      40.0       5.0\n", &format!("40.,5.,0,0,{vp}\n"));
    let noted = |text: &str| {
        let notes = good(text).notes.into_iter().map(|n| n.text).filter(|n| n.contains("VP ="));
        notes.map(|n| n[..6].to_string()).collect::<Vec<_>>()
    };
    let table = "       0.0      0.05       0.1\n     3.0e8     3.5e8     3.8e8\n";
    let perfect = with(CUBE, table, "");
    for (text, value, expected) in [
        (CUBE, "", &["VP = 0"][..]),
        (CUBE, "0", &["VP = 0"]),
        (CUBE, "1", &["VP = 1"]),
        (&perfect[..], "0", &["VP = 0"]),
        (&perfect[..], "1", &[]),
    ] {
        assert_eq!(noted(&vp(text, value)), expected, "VP {value}");
    }
    for (value, expected) in [("", &["VP = 0"][..]), ("1", &[])] {
        let kinematic = format!("*MAT_003\n31,7850,2.1e11,.3,3e8,1e9,1\n40,5,0,{value}\n*NODE\n");
        assert_eq!(noted(&with(&vp(&perfect, "1"), "*NODE\n", &kinematic)), expected, "*MAT_003, VP {value}");
    }
    let mut model = good(CUBE).model;
    same(&model, &good(&vp(CUBE, "1")).model);
    let second_card = |model: &Model| {
        let text = write(model, &[]).text;
        let line = text.lines().skip_while(|l| !l.starts_with("*MAT_PIECEWISE")).nth(2).unwrap();
        line.split_whitespace().map(|f| f.parse().unwrap()).collect::<Vec<f64>>()
    };
    assert_eq!(second_card(&model), [40.0, 5.0, 0.0, 0.0, 1.0]);
    assert_eq!(noted(&write(&model, &[]).text), ["VP = 1"]);
    model.mesh.laws[0].rate = None;
    assert_eq!(second_card(&model), [0.0, 0.0]);
}

/// Whether a curve spans the run is a question of when the run ends, not of the deck's own time.
#[test]
fn curves_span_the_run_that_is_asked_for() {
    let noted = |text: &str, end_time_s: Option<f64>| {
        let options = DeckOptions { end_time_s, ..DeckOptions::default() };
        let deck = parse(text, "deck.k", options).unwrap();
        assert_eq!(deck.model.control.end_time_s, 0.1);
        deck.notes.iter().any(|n| n.text.contains("curve 7 does not span the run"))
    };
    // the curve of gravity ends at 1 s
    assert_eq!([None, Some(1.0), Some(1.5)].map(|end| noted(CUBE, end)), [false, false, true]);
    let short =
        with(CUBE, "                 1.0                9.81", "                0.05                9.81");
    assert_eq!([None, Some(0.05), Some(0.01)].map(|end| noted(&short, end)), [true, false, false]);
}

/// A node that is asked for several times has one history, in its first place.
#[test]
fn a_node_has_one_history() {
    let cards = "*DATABASE_HISTORY_NODE\n8,7,7\n*DATABASE_HISTORY_NODE_SET\n3\n*DATABASE_HISTORY_NODE_ID\n2,again\n*NODE\n";
    let model = good(&with(CUBE, "*NODE\n", cards)).model;
    assert_eq!(model.control.history_nodes, [7, 6, 0, 1, 2, 3]);
}

/// A node that a set lists twice has its load once.
#[test]
fn a_set_holds_a_node_once() {
    let cards = "*SET_NODE_LIST\n9\n5,6,5\n6,7\n*LOAD_NODE_SET\n9,3,7,1.0\n*NODE\n";
    let model = good(&with(CUBE, "*NODE\n", cards)).model;
    assert_eq!(model.nodal_loads.iter().map(|l| l.node).collect::<Vec<_>>(), [4, 5, 6]);
}

#[test]
fn decks_are_known_by_ending_or_content() {
    let room = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = room.path().join(name);
        fs::write(&path, text).unwrap();
        is_deck(&path)
    };
    assert!(file("a.k", "") && file("a.KEY", "") && file("a.dyn", "") && file("a.inp", "$ x\n*KEYWORD\n"));
    assert!(!file("a.toml", "*KEYWORD") && !file("a.txt", "schema = 1"));
}

/// Velocities by set, box, part with rotation and node; later ones replace earlier ones.
#[test]
fn initial_velocities() {
    let begin = CUBE.find("*INITIAL_VELOCITY").unwrap();
    let end = CUBE.find("*RIGIDWALL").unwrap();
    let deck = |cards: &str| good(&format!("{}{cards}{}", &CUBE[..begin], &CUBE[end..])).model;
    let found = deck(
        "*INITIAL_VELOCITY_GENERATION\n10,2,3.0,1.0,0,0\n0.5,0.5,0,0,0,2.0\n*INITIAL_VELOCITY_NODE\n1,0,0,7\n",
    );
    assert_eq!(found.initial_velocity_m_s[0], (0, [0.0, 0.0, 7.0]));
    // ω × r = 3 ez × (0.5, -0.5, 0)
    assert_eq!(found.initial_velocity_m_s[1], (1, [2.5, 1.5, 0.0]));
    let boxed = "*DEFINE_BOX\n9,-1,2,-1,2,0.5,2\n*INITIAL_VELOCITY\n0,0,9\n0,0,-1\n";
    assert_eq!(deck(boxed).initial_velocity_m_s.iter().map(|v| v.0).collect::<Vec<_>>(), [4, 5, 6, 7]);
    let without = "*INITIAL_VELOCITY\n0,3\n0,0,-1\n0,0,5\n";
    assert_eq!(deck(without).initial_velocity_m_s[0].1, [0.0, 0.0, 5.0]);
    assert_eq!(deck(without).initial_velocity_m_s[4].1, [0.0, 0.0, -1.0]);
}
