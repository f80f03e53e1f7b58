//! What is said of rule files that are wrong: each message with file, line and marked text.

use super::{base, rule};
use fallwerk::rules::{RuleBase, Source};

fn message(rules: &[String]) -> String {
    base(rules).expect_err("this must not load")
}

#[test]
fn faults_of_one_rule_are_named_with_what_would_be_right() {
    for (lines, expected) in [
        (
            &["when = \"membr.kind == 'column'\""][..],
            "test.toml:6:9: unknown feature `membr.kind`; did you mean `member.kind`?",
        ),
        (&["when = \"member.kind == 'colunm'\""], "not 'colunm'; did you mean 'column'?"),
        (&["when = \"member.kind == column\""], "unknown feature `column`"),
        (&["when = \"member.kind < 'column'\""], "it can be equal or not, but not less or greater"),
        (&["when = \"member.length == true\""], "`member.length` is a number in m, not true"),
        (
            &["when = \"member.length > member.slenderness\""],
            "`member.length` is a number in m, `member.slenderness` is a ratio",
        ),
        (&["when = \"member.charged == member.weakened\""], "cannot be compared: only numbers can"),
        (&["when = \"end.clamped\""], "a member has no feature `end.clamped` (only: member_end)"),
        (&["when = \"member.kind = 'column'\""], "equality is written `==`"),
        (&["when = \"(member.charged\""], "expected `)`, found the end"),
        (
            &["when = \"member.slenderness < 3 and member.slenderness > 4\""],
            "the condition of `a` can never hold",
        ),
        (
            &["when = \"member.kind == 'beam' and member.slenderness < -1\""],
            "the condition of `a` can never hold; the comparison `member.slenderness < -1` of `a` never holds: `member.slenderness` is at least 0",
        ),
        (
            &["applies_to = \"slab_line\"", "action = \"latent_hinge\"", "when = \"member.kind == 'beam'\""],
            "the condition of `a` can never hold; a slab_line belongs to a slab",
        ),
        (&["when = \"member.storey_share > 1\""], "`member.storey_share` is from 0 to 1"),
        (&["applies_to = \"members\""], "unknown kind of subject `members`; did you mean `member`?"),
        (&["action = \"hnge\""], "unknown action `hnge`; did you mean `hinge`?"),
        (
            &["action = \"hinge\"", "parameters = { curve = \"library\" }"],
            "action `hinge` is for member_end, not for a member",
        ),
        (&["parameters = { colour = 1 }"], "unknown parameter of `rigid_body` `colour`; known: none"),
        (&["action = \"subdivide\""], "action `subdivide` needs the parameter `pieces`"),
        (
            &["action = \"subdivide\"", "parameters = { pieces = 1 }"],
            "`pieces` must be a whole number, at least 2 and at most 50, not 1",
        ),
        (
            &["action = \"subdivide\"", "parameters = { pieces = 4000000000 }"],
            "`pieces` must be a whole number, at least 2 and at most 50, not 4000000000",
        ),
        (
            &["action = \"subdivide\"", "parameters = { pieces = 2, least_length_m = 0 }"],
            "`least_length_m` must be a number above 0, in m",
        ),
        (
            &["action = \"merge_rigid\"", "parameters = { with = \"all\" }"],
            "one of 'adjoining_slab', 'storey_floor'",
        ),
        (&["range = { member.kind = [0, 1] }"], "unknown feature `member`"),
        (&["range = { \"member.kind\" = [0, 1] }"], "only numbers have a range"),
        (&["range = { storeys = [3, 1] }"], "a range goes from low to high, not from 3 to 1"),
        (&["supersedes = [\"b\"]"], "`a` supersedes `b`, which does not exist"),
        (&["supersedes = [\"a\"]"], "`a` supersedes itself"),
        (&["words = \" \""], "`words` must say the rule"),
        (&["source = \"\""], "`source` must say where"),
        (&["id = \"A b\""], "use small letters"),
        (&["priority = \"high\""], "expected i64"),
        (&["colour = 1"], "unknown field `colour`"),
    ] {
        let found = message(&[rule("a", lines)]);
        // A range by a bare dotted key is a TOML table: any message that names the place will do.
        if lines[0].starts_with("range = { member.kind") {
            assert!(found.contains("test.toml:10:"), "{found}");
            continue;
        }
        assert!(found.contains(expected), "{lines:?}: {found}");
        assert!(found.starts_with("test.toml:"), "{found}");
    }
}

/// A chain of comparisons is read to its end, and told at the first that is too many.
#[test]
fn conditions_are_no_novels() {
    let when = |count: usize| {
        let words: Vec<String> = (0..count).map(|i| format!("member.length > {i}.5")).collect();
        format!("when = \"{}\"", words.join(" and "))
    };
    assert!(base(&[rule("a", &[&when(256)])]).is_ok());
    let found = message(&[rule("a", &[&when(30_000)])]);
    assert!(found.starts_with("test.toml:6:") && found.contains("has at most 256; make several"), "{found}");
    // of a long line what is around the place is shown
    let lines: Vec<Vec<char>> = found.lines().map(|line| line.chars().collect()).collect();
    assert!(lines.len() == 3 && lines[1].len() < 300 && lines[2].len() < 300, "{found}");
    let mark: String = lines[1].iter().zip(&lines[2]).filter(|(_, m)| **m == '^').map(|(c, _)| *c).collect();
    assert_eq!(mark, "256.5");
}

#[test]
fn ids_are_no_novels() {
    assert!(base(&[rule(&"a".repeat(200), &[])]).is_ok());
    assert!(message(&[rule(&"a".repeat(201), &[])]).contains("an id of 201 characters: use at most 200"));
}

#[test]
fn the_mark_stands_below_the_fault() {
    let found = message(&[rule("a", &["when = \"member.kind == 'beam' or membr.charged\""])]);
    let lines: Vec<&str> = found.lines().collect();
    assert_eq!(lines.len(), 3, "{found}");
    let at = lines[1].find("membr.charged").unwrap();
    assert_eq!(lines[2].find('^').unwrap(), at);
    assert_eq!(lines[2].matches('^').count(), "membr.charged".len());
    // Also in a condition over several lines.
    let found = message(&[rule("a", &["when = \"\"\"\nmember.kind == 'beam'\n  or membr.charged\"\"\""])]);
    assert!(found.starts_with("test.toml:8:6:") && found.contains("8 |   or membr.charged"), "{found}");
}

#[test]
fn what_cannot_be_superseded_is_told_from_what_is_not_there() {
    let faulty = rule("b", &["action = \"fly\""]);
    let found = message(&[rule("a", &["supersedes = [\"b\"]"]), faulty]);
    assert!(found.contains("`a` supersedes `b`, which has an error of its own"), "{found}");
    let of = |id: &str, other: &str| rule(id, &[&format!("supersedes = [\"{other}\"]")]);
    let found = message(&[of("x", "a"), of("a", "b"), of("b", "c"), of("c", "a")]);
    assert!(found.contains("`a` supersedes itself through `b`, `c`"), "{found}");
    assert_eq!(found.matches("supersedes itself").count(), 1, "{found}");
}

#[test]
fn all_problems_are_found_at_once_and_in_order() {
    let found = message(&[
        rule("a", &["when = \"x == 1 and y == 2\"", "action = \"z\""]),
        rule("b", &["priority = 11"]),
        rule("b", &["priority = 12"]),
    ]);
    let heads: Vec<&str> = found.lines().filter(|l| l.starts_with("test.toml:")).collect();
    assert_eq!(heads.len(), 4, "{found}");
    assert!(heads[0].contains("`x`") && heads[1].contains("`y`") && heads[2].contains("`z`"));
    assert!(heads[3].contains("the id `b` is taken by the rule in test.toml:11"), "{}", heads[3]);
}

#[test]
fn files_that_are_no_rule_files_are_refused() {
    let load = |text: &str| {
        let source = Source { name: "x.toml".into(), text: text.into() };
        RuleBase::from_sources(vec![source]).unwrap_err().to_string()
    };
    assert!(load("schema = ").starts_with("x.toml:1:"));
    assert!(load("").contains("missing field `schema`"));
    assert!(load("schema = 2").contains("schema 2; this program reads schema 1"));
    assert!(load("schema = 1\n[[rule]]\nid = \"a\"").contains("x.toml:2:1: missing field"));
    assert!(load("schema = 1\n[[rules]]").contains("unknown field `rules`"));
    let absent = RuleBase::load(std::path::Path::new("/absent/rules")).unwrap_err().to_string();
    assert!(absent.starts_with("/absent/rules: "), "{absent}");
}

#[test]
fn contradicting_rules_are_a_conflict_only_where_both_can_hold() {
    let columns = rule("a", &[]);
    let subdivide = |when: &str, priority: &str| {
        let when = format!("when = \"{when}\"");
        let priority = format!("priority = {priority}");
        rule("b", &[&when, "action = \"subdivide\"", "parameters = { pieces = 2 }", &priority])
    };
    let found = message(&[columns.clone(), subdivide("member.slenderness > 5", "10")]);
    assert!(
        found.contains("conflict: `b` (subdivide) and `a` (rigid_body, test.toml:3) both have priority 10"),
        "{found}"
    );
    assert!(found.contains("when member.kind == 'column' and member.slenderness > 5"), "{found}");
    base(&[columns.clone(), subdivide("member.slenderness > 5", "11")]).unwrap();
    base(&[columns.clone(), subdivide("member.slenderness > 5 and member.kind != 'column'", "10")]).unwrap();
    // The same action with other parameters contradicts too; the same decision twice does not.
    let four = rule("c", &["action = \"subdivide\"", "parameters = { pieces = 4 }"]);
    assert!(message(&[subdivide("always", "10"), four]).contains("conflict"));
    base(&[columns, rule("c", &["when = \"storeys > 3\""])]).unwrap();
}

/// A rule replaces what it supersedes within its range only; outside it two rules of one priority would be told apart by their ids.
#[test]
fn a_superseding_rule_conflicts_outside_its_range() {
    let own = |lines: &[&str]| {
        let fixed = ["action = \"subdivide\"", "parameters = { pieces = 2 }", "supersedes = [\"b\"]"];
        base(&[rule("a", &[&fixed[..], lines].concat()), rule("b", &[])])
    };
    let range = "range = { storeys = [1, 2] }";
    let when = |storeys: &str| format!("when = \"member.kind == 'column' and {storeys}\"");
    own(&[]).unwrap();
    let found = own(&[range]).unwrap_err();
    assert!(found.contains("conflict: `b`") && found.contains("storeys < 1"), "{found}");
    assert!(found.contains("`a` supersedes the other one within its range only: give it a higher priority"));
    let found = own(&[range, &when("storeys >= 2")]).unwrap_err();
    assert!(found.contains("when member.kind == 'column' and storeys >= 2 and storeys > 2;"), "{found}");
    own(&[range, &when("storeys >= 1 and storeys <= 2")]).unwrap();
    own(&[range, "priority = 11"]).unwrap();
    // a bound with six digits has 1/3 within it
    let third = "range = { \"member.storey_share\" = [0.333333, 1] }";
    own(&[third, &when("member.storey_share >= 0.3333333")]).unwrap();
    // all that it can be is within the range, but it may be unknown
    let all = "range = { \"member.storey_share\" = [0, 1] }";
    let found = own(&[all]).unwrap_err();
    assert!(found.contains("when member.kind == 'column' and member.storey_share is not known;"), "{found}");
    own(&[all, &when("member.storey_share >= 0")]).unwrap();
}

#[test]
fn gaps_are_named_with_a_case() {
    let found = base(&[
        rule("a", &["when = \"member.kind in ['column', 'beam', 'slab'] and member.strain_rate <= critical_strain_rate\""]),
        rule("b", &["when = \"member.kind == 'slab' and member.strain_rate > critical_strain_rate\""]),
        rule("c", &["when = \"member.kind in ['wall', 'footing']\""]),
    ])
    .unwrap()
    .gaps();
    let words: Vec<String> = found.iter().map(ToString::to_string).collect();
    let about_members: Vec<&String> = words.iter().filter(|w| w.contains("for a member of")).collect();
    assert_eq!(about_members.len(), 2, "{words:#?}");
    assert!(
        about_members[0].contains("a member of a column when critical_strain_rate < member.strain_rate"),
        "{}",
        about_members[0]
    );
    assert!(
        words.iter().any(|w| w.contains("how it resists rotation for a member_end of a column when always"))
    );
}
