//! What rules decide and a generated model cannot have: refused with the rule's name and place, or told.

use super::{knowledge, reference};
use fallwerk::generate::{Derive, GenerateError, Generated, generate};
use fallwerk::rules::{RuleBase, Source};

/// The reference with the shipped rules and one that goes before them; its lines stand below `words`.
fn with_rule(lines: &str) -> Result<Generated, GenerateError> {
    let text = format!(
        "schema = 1\n\n[[rule]]\nid = \"own/test\"\nwords = \"Of this test.\"\npriority = 900\nsource = \"a test\"\n{lines}\n"
    );
    let (rules, mut store, _cache) = knowledge();
    let rules: RuleBase = rules.with(vec![Source { name: "own.toml".into(), text }]).expect("sound rules");
    generate(&reference(|t| t), &rules, &mut store, Derive::Never, &|_| {})
}

#[test]
fn what_cannot_be_carried_out_is_refused_with_the_rule_its_place_and_a_remedy() {
    for (lines, told) in [
        (
            "applies_to = \"member_end\"\nwhen = \"member.kind == 'column'\"\naction = \"rigid_connection\"",
            "decides `rigid_connection` for C1-A1.bottom, which no generated model carries out; write `hinge` or `elastic_connection`",
        ),
        (
            "applies_to = \"member_end\"\nwhen = \"member.kind == 'column'\"\naction = \"rigid_translation\"",
            "write `translational_spring`",
        ),
        (
            "applies_to = \"member_end\"\nwhen = \"member.kind == 'beam'\"\naction = \"hinge\"\nparameters = { curve = \"library\" }",
            "write `latent_hinge` or `rigid_connection`",
        ),
        (
            "applies_to = \"member\"\nwhen = \"member.kind == 'column'\"\naction = \"subdivide\"\nparameters = { pieces = 2 }",
            "ask for `collapse.phase == 'after_contact'`",
        ),
        (
            "applies_to = \"member\"\nwhen = \"member.kind == 'slab'\"\naction = \"rigid_body\"",
            "decides `rigid_body` for S1, which no generated model carries out; write `merge_rigid` or `merge_elastic`",
        ),
        (
            "applies_to = \"member\"\nwhen = \"member.kind == 'column'\"\naction = \"merge_rigid\"\nparameters = { with = \"storey_floor\" }",
            "write `rigid_body`",
        ),
        (
            "applies_to = \"member\"\nwhen = \"member.storey == 2\"\naction = \"remove_body\"",
            "ask for `member.charged` in its condition",
        ),
    ] {
        let error = with_rule(lines).expect_err(lines).to_string();
        assert!(error.starts_with("rule `own/test` (own.toml:4) decides "), "{error}");
        assert!(error.contains(told), "{told}\n{error}");
    }
    let charged = "applies_to = \"member\"\nwhen = \"member.charged\"\naction = \"remove_body\"";
    assert_eq!(with_rule(charged).unwrap().model.events.len(), 2);
}

#[test]
fn a_floor_that_bends_as_a_whole_tells_which_of_its_members_a_rule_has_rigid() {
    let rigid = "applies_to = \"member\"\nwhen = \"member.kind == 'beam' and member.storey == 2\"\naction = \"merge_rigid\"\nparameters = { with = \"storey_floor\" }";
    let made = with_rule(rigid).unwrap();
    let [unmet] = &made.unmet[..] else { panic!("{:?}", made.unmet) };
    assert_eq!((unmet.rule.as_str(), unmet.action.as_str()), ("own/test", "merge_rigid"));
    assert!(unmet.members.iter().all(|m| m.starts_with("B2-")) && unmet.members.len() == 4, "{unmet:?}");
    let note = made.notes.iter().find(|n| n.starts_with("rule `own/test` decides `merge_rigid` for B2-"));
    let note = note.unwrap_or_else(|| panic!("{:?}", made.notes));
    assert!(note.contains(", which is not carried out: S2 bends, as is decided about others"), "{note}");
    let all = with_rule(&rigid.replace("member.kind == 'beam' and ", "member.kind in ['slab', 'beam'] and "));
    assert!(all.unwrap().unmet.is_empty(), "the floor is rigid as a whole");
}
