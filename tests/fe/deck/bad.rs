//! Malformed decks: each gives exactly the messages of its snapshot, and none makes the reader panic.

use super::{CUBE, with};
use fallwerk::fe::deck::{DeckOptions, parse};
use proptest::prelude::*;

fn cases() -> Vec<(&'static str, String)> {
    let cube = |from: &str, to: &str| with(CUBE, from, to);
    vec![
        ("unknown_keyword", cube("*ELEMENT_SOLID", "*ELEMENT_SOLLID")),
        ("no_keyword", "schema = 1\n".into()),
        ("empty", " \n".into()),
        ("bad_number", cube("    2.1e11", "   2.1e1x1")),
        ("shifted_columns", cube("        30    7850.0    2.1e11", "        30     7850.0    2.1e11")),
        ("tab", cube("        20         1", "20\t1")),
        (
            "inside_out",
            cube(
                "       1       2       3       4       5       6       7       8",
                "       5       6       7       8       1       2       3       4",
            ),
        ),
        (
            "distorted",
            cube("       1       2       3       4       5", "       1       3       2       4       5"),
        ),
        ("wedge", cube("       5       6       7       8\n*END", "       5       6       7       7\n*END")),
        (
            "dangling",
            cube(
                "        10        20        30         0        40",
                "        10        21        31         0        41",
            ),
        ),
        ("missing_node", cube("       7       8\n*END", "       7       9\n*END")),
        ("duplicate_node", cube("       8             0.0", "       7             0.0")),
        ("duplicate_section", cube("*SECTION_SOLID\n", "*SECTION_SOLID\n        20         2\n")),
        ("beam_in_solid_part", cube("*END", "*ELEMENT_BEAM\n       2      10       1       2       3\n*END")),
        (
            "unsupported_values",
            cube("        20         1", "        20        13")
                .replace("        40         5", "        40         8"),
        ),
        ("moving_wall", cube("*RIGIDWALL_PLANAR", "*RIGIDWALL_PLANAR_MOVING")),
        (
            "wall_without_normal",
            cube("       0.0       0.0       1.0       0.4", "       0.0       0.0       0.0       0.4"),
        ),
        ("no_end_time", cube("*CONTROL_TERMINATION\n       0.1\n", "")),
        (
            "missing_card",
            cube(
                "*RIGIDWALL_PLANAR\n         0\n       0.0       0.0       0.0       0.0       0.0       1.0       0.4",
                "*RIGIDWALL_PLANAR\n         0",
            ),
        ),
        (
            "unknown_parameter",
            cube("    2.1e11", "    &young").replace("*PART\n", "*PARAMETER\nRyoungs     2.1e11\n*PART\n"),
        ),
        ("missing_curve", cube("*LOAD_BODY_Z\n         7", "*LOAD_BODY_Z\n         8")),
        ("hardening_table", cube("       0.0      0.05       0.1", "      0.01      0.05      0.04")),
        ("poisson", cube("    2.1e11       0.3", "   -2.1e11       0.5")),
        ("held_and_moved", cube("*NODE\n", "*BOUNDARY_PRESCRIBED_MOTION_NODE\n1,1,0,7\n*NODE\n")),
        (
            "moved_twice",
            cube("*NODE\n", "*BOUNDARY_PRESCRIBED_MOTION_NODE\n5,1,0,7\n5,2,0,7\n5,1,0,7,2.0\n*NODE\n"),
        ),
        (
            "loose_nodes",
            cube(
                "*NODE\n",
                "*LOAD_NODE_POINT\n9,1,7\n*BOUNDARY_PRESCRIBED_MOTION_SET\n90,1,0,7\n*SET_NODE_LIST\n90\n8,9,10\n*NODE\n10,0.,0.,2.\n9,1.,1.,1.\n",
            ),
        ),
        ("displacement_given", cube("*NODE\n", "*BOUNDARY_PRESCRIBED_MOTION_NODE\n5,1,2,7\n*NODE\n")),
        (
            "kinematic_hardening",
            cube("*NODE\n", "*MAT_PLASTIC_KINEMATIC\n31,7850,2.1e11,.3,3e8,1e9,0\n*NODE\n"),
        ),
        ("include_in_text", cube("*NODE\n", "*INCLUDE\nother.k\n*NODE\n")),
        (
            "several",
            cube("2.1e11", "2.1x11")
                .replace("       0.8", "       1.8")
                .replace("*LOAD_BODY_Z", "*LOAD_BODY_W"),
        ),
    ]
}

#[test]
fn messages_of_bad_decks() {
    for (name, text) in cases() {
        let errors = parse(&text, "deck.k", DeckOptions::default())
            .err()
            .unwrap_or_else(|| panic!("{name} was accepted"));
        let mut settings = insta::Settings::clone_current();
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| insta::assert_snapshot!(name, errors.render(false)));
        for item in errors.items() {
            let plain_number = item.code == "bad-number";
            assert!(!item.help.is_empty() || plain_number, "{name}: {item:?}");
        }
        assert_eq!(errors.to_json().as_array().unwrap().len(), errors.items().count());
    }
}

/// What is given and would be passed over is refused at its line.
#[test]
fn given_fields_are_not_passed_over() {
    let step = |line: &str| {
        with(
            CUBE,
            "       0.0       0.8\n",
            &format!("       0.0       0.8         0       0.0     -1e-5\n{line}\n"),
        )
    };
    assert!(
        parse(
            &step("       0.0         0         0                           0.0"),
            "deck.k",
            DeckOptions::default()
        )
        .is_ok()
    );
    for (text, words) in [
        (step("       0.5"), "deck.k:8:8"),
        (step("         0         7"), "DT2MSLC is `7`"),
        (step("         0         0         1"), "IMSCL is `1`"),
        (step("\n         0         0         1"), "a line too many"),
        (with(CUBE, "       0.1\n", "       0.1\n       0.2\n"), "*CONTROL_TERMINATION: a line too many"),
        (
            with(CUBE, "*NODE\n", "*CONTROL_BULK_VISCOSITY\n1.5,0.06\n2.0,0.1\n*NODE\n"),
            "*CONTROL_BULK_VISCOSITY: a line too many",
        ),
        (with(CUBE, "     3.0e8     3.5e8     3.8e8\n", ""), "EPS2 is `0.05`"),
    ] {
        let errors = parse(&text, "deck.k", DeckOptions::default()).map(|_| text).unwrap_err().to_string();
        assert!(errors.contains(words), "{words}: {errors}");
    }
}

/// What is referred to and has no nodes is an error, told once: a support or a wall would be missing.
#[test]
fn references_without_nodes() {
    let empty = "the set of nodes 9 has no nodes";
    for (cards, words) in [
        (
            "*SET_NODE_LIST_GENERATE\n9\n101,200\n*BOUNDARY_SPC_SET\n9,0,1,1,1\n",
            "none is in its ranges 101 to 200",
        ),
        ("*SET_NODE_GENERAL\n9\nPART\n*LOAD_NODE_SET\n9,3,7,1.0\n", empty),
        ("*SET_NODE_LIST\n9\n*RIGIDWALL_PLANAR\n9\n0,0,0,0,0,1,0\n", empty),
        ("*SET_NODE_LIST\n9\n*BOUNDARY_PRESCRIBED_MOTION_SET\n9,3,0,7\n", empty),
        ("*SET_NODE_LIST\n9\n*DATABASE_HISTORY_NODE_SET\n9\n", empty),
        ("*SET_NODE_LIST\n9\n*INITIAL_VELOCITY\n9\n0,0,1\n", empty),
        (
            "*PART\nidle\n11,20,30,0,40\n*INITIAL_VELOCITY_GENERATION\n11,2,0,0,0,1\n",
            "the part 11 has no nodes",
        ),
        ("*RIGIDWALL_PLANAR\n0,0,0,0.1\n0,0,-1,0,0,0,0\n", "the wall stops no node"),
        (
            "*DEFINE_BOX\n9,2,3,-1,2,-1,2\n*INITIAL_VELOCITY\n0,0,9\n0,0,1\n",
            "the initial velocity is given to no node",
        ),
        ("*DEFINE_BOX\n9,1,0,-1,2,-1,2\n*INITIAL_VELOCITY\n0,0,9\n0,0,1\n", "*DEFINE_BOX: XMN is `1`"),
    ] {
        let text = with(CUBE, "*NODE\n", &format!("{cards}*NODE\n"));
        let errors = parse(&text, "deck.k", DeckOptions::default()).map(|_| cards).unwrap_err();
        let said = errors.to_string();
        assert!(said.contains(words) && said.contains("--> deck.k:"), "{cards}: {said}");
        let items: Vec<_> = errors.items().collect();
        assert!(items.len() == 1 && !items[0].help.is_empty(), "{cards}: {said}");
    }
    // a set to which nothing refers may be empty
    assert!(
        parse(&with(CUBE, "*NODE\n", "*SET_NODE_LIST\n9\n*NODE\n"), "deck.k", DeckOptions::default()).is_ok()
    );
}

/// Controls of the whole model that stand twice would be mixed, or the first one dropped.
#[test]
fn controls_that_stand_twice() {
    for (keyword, cards) in [
        ("CONTROL_TIMESTEP", "*CONTROL_TIMESTEP\n0,0.5,0,0,-1e-5,0,0,1\n"),
        ("CONTROL_TERMINATION", "*CONTROL_TERMINATION\n0.2\n"),
        ("CONTROL_HOURGLASS", "*CONTROL_HOURGLASS\n4,0.1\n*CONTROL_HOURGLASS\n6,1.0\n"),
    ] {
        let text = with(CUBE, "*NODE\n", &format!("{cards}*NODE\n"));
        let said = parse(&text, "deck.k", DeckOptions::default()).map(|_| cards).unwrap_err().to_string();
        assert!(said.contains(&format!("*{keyword} stands twice in the deck")), "{said}");
        assert!(said.contains("keep one of them") && said.contains("1 error in deck.k"), "{said}");
    }
}

/// A number that goes on into the next field is no two numbers; those that fill their fields are.
#[test]
fn numbers_longer_than_their_fields() {
    let of = |text: &str| parse(text, "deck.k", DeckOptions::default());
    let termination = |line: &str| of(&with(CUBE, "       0.1\n", &format!("{line}\n")));
    for line in ["1.23456789012e-2", "1.23456789e-1", "0.12345678012", "1.23456789e5"] {
        let errors = termination(line).unwrap_err().to_string();
        assert!(errors.contains(&format!("`{line}` is longer than its field")), "{line}: {errors}");
        assert!(errors.contains("deck.k:5:1"), "{errors}");
    }
    let noted = termination("0.0123456789").unwrap();
    assert!(noted.notes.iter().any(|n| n.text.contains("read as 0.01234567 and 89")), "{:?}", noted.notes);
    assert_eq!(noted.model.control.end_time_s, 0.01234567);
    assert!(termination("1.2345678901234e-2,").is_ok());
    // full fields side by side
    let full =
        with(CUBE, "        30    7850.0    2.1e11       0.3", "        307.8500E+032.1000E+11.300000000");
    let deck = of(&full).unwrap();
    assert_eq!(deck.model.mesh.laws[0].youngs_modulus_pa, 2.1e11);
    let signed = with(CUBE, "       0.0       0.0      -2.0", "-1.0000E-1-2.0000E-1-2.0000E+0");
    assert_eq!(of(&signed).unwrap().model.initial_velocity_m_s[0].1, [-0.1, -0.2, -2.0]);
}

fn mutated(changes: &[(usize, u8, u8)]) -> String {
    let mut bytes = CUBE.as_bytes().to_vec();
    for &(at, byte, kind) in changes {
        let at = at % bytes.len().max(1);
        match kind % 5 {
            0 => bytes[at] = byte,
            1 => drop(bytes.drain(at..(at + usize::from(byte % 32)).min(bytes.len() - 1))),
            2 => bytes.insert(at, byte),
            3 => bytes[at] = b"0123456789.-+eE,&*$ \n"[usize::from(byte) % 21],
            _ => {
                // a line is repeated somewhere else
                let line = CUBE.lines().nth(usize::from(byte) % CUBE.lines().count()).unwrap();
                let begin = bytes[..at].iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
                bytes.splice(begin..begin, format!("{line}\n").into_bytes());
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_decks_never_panic(changes in prop::collection::vec((0usize..4000, any::<u8>(), any::<u8>()), 1..8), skip_unknown: bool) {
        match parse(&mutated(&changes), "mutated.k", DeckOptions { skip_unknown, ..DeckOptions::default() }) {
            Err(errors) => {
                prop_assert!(errors.items().count() > 0);
                prop_assert!(errors.render(false).contains("error"));
            }
            // what was accepted can be written and read again
            Ok(deck) => {
                let text = fallwerk::fe::deck::write(&deck.model, &[]).text;
                let again = parse(&text, "again.k", DeckOptions::default());
                prop_assert!(again.is_ok(), "{}\n{text}", again.unwrap_err());
            }
        }
    }
}
