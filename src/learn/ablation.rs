//! Sets of rules whose models are compared with each other: what each part of the rules is worth.

use crate::rules::{Problems, RuleBase, Source};

/// A rule that overrules all others: id, kind of subject, condition, action, parameters.
type Overruling = [&'static str; 5];

/// Sets beside the seed rules and the rules given: names, and the rules that overrule all others.
const SETS: &[(&str, &[Overruling])] = &[
    (
        "hinges everywhere",
        &[
            ["column-hinges", "member_end", "member.kind == 'column'", "hinge", "curve = 'library'"],
            ["beam-hinges", "member_end", "member.kind == 'beam'", "latent_hinge", ""],
        ],
    ),
    (
        "hinges nowhere",
        &[
            ["columns-elastic", "member_end", "member.kind == 'column'", "elastic_connection", ""],
            ["beams-rigid", "member_end", "member.kind == 'beam'", "rigid_connection", ""],
        ],
    ),
    (
        "nothing changes after contact",
        &[["columns-whole", "member", "member.kind == 'column'", "rigid_body", ""]],
    ),
    (
        "all floors rigid",
        &[[
            "floors-rigid",
            "member",
            "member.kind in ['slab', 'beam']",
            "merge_rigid",
            "with = 'storey_floor'",
        ]],
    ),
    (
        "all floors bend",
        &[[
            "floors-bend",
            "member",
            "member.kind in ['slab', 'beam']",
            "merge_elastic",
            "with = 'storey_floor'",
        ]],
    ),
];

/// The seed rules alone, the rules given, and these with hinges everywhere, hinges nowhere, columns that stay whole whatever happens, rigid floors, floors that bend; by name.
///
/// # Errors
/// If the rules given have ids or priorities that leave no room for those of the sets.
pub fn sets(rules: &RuleBase) -> Result<Vec<(&'static str, RuleBase)>, Problems> {
    let mut sets = vec![("seed rules alone", rules.only("seed/")), ("the rules given", rules.clone())];
    for (name, own) in SETS {
        let text: String = own.iter().map(toml).collect();
        let source = Source { name: format!("ablation: {name}"), text: format!("schema = 1\n{text}") };
        sets.push((name, rules.with(vec![source])?));
    }
    Ok(sets)
}

fn toml([id, about, when, action, parameters]: &Overruling) -> String {
    format!(
        "[[rule]]\nid = \"ablation/{id}\"\nwords = \"For the comparison of rules.\"\napplies_to = \"{about}\"\nwhen = \"{when}\"\naction = \"{action}\"\n\
         parameters = {{ {parameters} }}\npriority = 1000\nsource = \"assumption: for the comparison of rules\"\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_sets_are_sound() {
        let sets = sets(&RuleBase::seed().unwrap()).unwrap();
        assert_eq!(sets.len(), 2 + SETS.len());
        let count = |name: &str| sets.iter().find(|(n, _)| *n == name).unwrap().1.rules().len();
        assert_eq!(count("hinges nowhere"), count("seed rules alone") + 2);
    }
}
