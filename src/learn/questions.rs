//! What is learned: questions about places, what a study answers, and what a rule then decides.

use super::Case;
use crate::rules::{Subject, SubjectKind};
use crate::study::{EndZone, MemberFacts};
use crate::validate::LIMIT_TO_CONTACT;

/// What a rule decides if it says yes, or no.
#[derive(Debug)]
pub struct Answer {
    /// Name of the action.
    pub action: &'static str,
    /// Its parameters, as TOML.
    pub parameters: &'static str,
    /// The decision in words, up to where a condition follows.
    pub words: &'static str,
    /// Rules that it replaces within its range.
    pub supersedes: &'static [&'static str],
    /// Why such a rule is not used but listed for review.
    pub refused: Option<&'static str>,
}

/// A question.
#[derive(Debug)]
pub struct Question {
    /// Name, of the rule file and of the rules in it.
    pub name: &'static str,
    /// What is asked.
    pub words: &'static str,
    /// What it is asked about.
    pub subject: SubjectKind,
    /// Which of these.
    pub condition: &'static str,
    /// Phase of the collapse.
    pub phase: &'static str,
    /// If yes.
    pub yes: Answer,
    /// If no.
    pub no: Answer,
    /// Whether a yes is less likely where turning, yielding and falling are more likely.
    pub turned_round: bool,
    /// Features that may be asked; of equally good ones the first is.
    pub features: &'static [&'static str],
    /// The places of a study that it has an answer for.
    pub places: fn(&Case) -> Vec<(&Subject, bool)>,
}

const OF_END: &[&str] = &[
    "end.demand_ratio",
    "end.law_demand_ratio",
    "end.over_charge",
    "end.charge_distance",
    "end.joint_strength",
    "end.column_demand_ratio",
    "end.demand_ratio_before",
    "end.position",
    "end.clamped",
    "building.demand_ratio",
    "building.law_demand_ratio",
    "building.mechanism",
    "building.charged_share",
    "member.axial_ratio",
    "member.axial_ratio_after",
    "member.storey",
    "member.storey_share",
    "member.fall_height",
    "member.slenderness",
    "member.span_over_depth",
    "member.weakened",
];

const OF_MEMBER: &[&str] = &[
    "building.demand_ratio",
    "building.law_demand_ratio",
    "building.mechanism",
    "building.charged_share",
    "floor.slenderness",
    "member.charge_distance",
    "member.axial_ratio",
    "member.axial_ratio_after",
    "member.storey",
    "member.storey_share",
    "member.fall_height",
    "member.slenderness",
    "member.span_over_depth",
    "member.weakened",
];

/// What mechanics asks for: with a larger value of the feature turning, yielding and falling become more (true) or less likely.
/// Features of which it depends are left out.
pub const EXPECTED: &[(&str, bool)] = &[
    ("building.charged_share", true),
    ("building.demand_ratio", true),
    ("building.law_demand_ratio", true),
    ("building.mechanism", true),
    ("end.demand_ratio", true),
    ("end.demand_ratio_before", true),
    ("end.law_demand_ratio", true),
    ("end.over_charge", true),
    ("end.charge_distance", false),
    ("member.axial_ratio", true),
    ("member.axial_ratio_after", true),
    ("member.charge_distance", false),
    ("member.weakened", true),
];

const COLUMN_ELASTIC: &str = "a column end that is joined rigidly loses its elastic stiffness, on which the deflection of a building that stands rests; a hinge that does not turn costs nothing but its springs";
const NOT_DIVIDED: &str = "the generator cannot divide members yet: a rule that asks for it would stop it";

const BEAM_TURNS: Answer = Answer {
    action: "latent_hinge",
    parameters: "",
    words: "may turn",
    supersedes: &["seed/beam-end-rigid", "seed/floor-may-fold"],
    refused: None,
};
const BEAM_STAYS: Answer = Answer { action: "rigid_connection", words: "does not turn", ..BEAM_TURNS };
const COLUMN_TURNS: Answer = Answer {
    action: "hinge",
    parameters: "curve = \"library\"",
    words: "turns",
    supersedes: &[],
    refused: None,
};
const COLUMN_STAYS: Answer = Answer {
    action: "rigid_connection",
    parameters: "",
    words: "does not turn",
    supersedes: &[],
    refused: Some(COLUMN_ELASTIC),
};

/// All questions, in the order of their files.
pub const QUESTIONS: &[Question] = &[
    Question {
        name: "beam-ends",
        words: "Which ends of beams turn by more than 0.02 rad before the first contact?",
        subject: SubjectKind::MemberEnd,
        condition: "member.kind == 'beam'",
        phase: "before_contact",
        yes: BEAM_TURNS,
        no: BEAM_STAYS,
        turned_round: false,
        features: OF_END,
        places: |case| ends(case, "beam", before_contact),
    },
    Question {
        name: "beam-ends-late",
        words: "Which ends of beams turn by more than 0.02 rad in the whole run, or break?",
        subject: SubjectKind::MemberEnd,
        condition: "member.kind == 'beam'",
        phase: "after_contact",
        yes: BEAM_TURNS,
        no: BEAM_STAYS,
        turned_round: false,
        features: OF_END,
        places: |case| ends(case, "beam", whole_run),
    },
    Question {
        name: "column-ends",
        words: "Which ends of columns turn by more than 0.02 rad before the first contact?",
        subject: SubjectKind::MemberEnd,
        condition: "member.kind == 'column'",
        phase: "before_contact",
        yes: COLUMN_TURNS,
        no: COLUMN_STAYS,
        turned_round: false,
        features: OF_END,
        places: |case| ends(case, "column", before_contact),
    },
    Question {
        name: "column-ends-late",
        words: "Which ends of columns turn by more than 0.02 rad in the whole run, or break?",
        subject: SubjectKind::MemberEnd,
        condition: "member.kind == 'column'",
        phase: "after_contact",
        yes: COLUMN_TURNS,
        no: COLUMN_STAYS,
        turned_round: false,
        features: OF_END,
        places: |case| ends(case, "column", whole_run),
    },
    Question {
        name: "floors",
        words: "Which floors bend, in that more than a tenth of their motion before the first contact is none of a rigid body?",
        subject: SubjectKind::Member,
        condition: "member.kind in ['slab', 'beam']",
        phase: "before_contact",
        yes: Answer {
            action: "merge_elastic",
            parameters: "with = \"storey_floor\"",
            words: "bends",
            supersedes: &["seed/floor-one-body", "seed/floor-bends"],
            refused: None,
        },
        no: Answer {
            action: "merge_rigid",
            parameters: "with = \"storey_floor\"",
            words: "moves as a rigid body",
            supersedes: &["seed/floor-one-body", "seed/floor-bends"],
            refused: None,
        },
        // the motion of a building that falls is larger by far than what its floors bend
        turned_round: true,
        features: OF_MEMBER,
        places: floors,
    },
    Question {
        name: "floors-late",
        words: "Which slabs and beams exceed the critical strain rate between their ends in the whole run?",
        subject: SubjectKind::Member,
        condition: "member.kind in ['slab', 'beam']",
        phase: "after_contact",
        yes: Answer {
            action: "subdivide",
            parameters: "pieces = 4",
            words: "yields between its ends",
            supersedes: &[],
            refused: None,
        },
        no: Answer {
            action: "merge_rigid",
            parameters: "with = \"storey_floor\"",
            words: "does not yield between its ends",
            supersedes: &["seed/subdivide-floors-late"],
            refused: None,
        },
        turned_round: false,
        features: OF_MEMBER,
        places: |case| members(case, &["slab", "beam"], |facts| facts.rigid_share < 1.0),
    },
    Question {
        name: "columns",
        words: "Which columns exceed the critical strain rate between their ends before the first contact?",
        subject: SubjectKind::Member,
        condition: "member.kind == 'column'",
        phase: "before_contact",
        yes: Answer {
            action: "subdivide",
            parameters: "pieces = 2",
            words: "yields between its ends",
            supersedes: &["seed/column-one-body"],
            refused: Some(NOT_DIVIDED),
        },
        no: Answer {
            action: "rigid_body",
            parameters: "",
            words: "does not yield between its ends",
            supersedes: &[],
            refused: None,
        },
        turned_round: false,
        features: OF_MEMBER,
        places: |case| members(case, &["column"], |facts| facts.rigid_share_before_contact < 1.0),
    },
];

/// Whether an end turns before the first contact.
fn before_contact(end: &EndZone, contact_s: Option<f64>) -> Option<bool> {
    end.turns_before(contact_s)
}

/// Whether it turns in the whole run, or breaks.
fn whole_run(end: &EndZone, _contact_s: Option<f64>) -> Option<bool> {
    end.turns()
}

fn ends<'a>(
    case: &'a Case,
    kind: &str,
    label: fn(&EndZone, Option<f64>) -> Option<bool>,
) -> Vec<(&'a Subject, bool)> {
    let facts = &case.study.facts;
    let zone = |id: &str| facts.ends.iter().find(|zone| zone.id == id);
    let of = |subject: &'a Subject| {
        is(subject, kind)
            .then(|| label(zone(&subject.id)?, facts.first_contact_s))
            .flatten()
            .map(|yes| (subject, yes))
    };
    case.known.ends.iter().filter_map(of).collect()
}

fn members<'a>(case: &'a Case, kinds: &[&str], label: fn(&MemberFacts) -> bool) -> Vec<(&'a Subject, bool)> {
    let facts = |id: &str| case.study.facts.members.iter().find(|facts| facts.member == id);
    let subjects = case.known.members.iter().filter(|s| kinds.iter().any(|kind| is(s, kind)));
    subjects.filter_map(|s| Some((s, label(facts(&s.id)?)))).collect()
}

/// One slab stands for the floor of a storey. A tenth is what an error before the first contact may be: a model with a rigid floor is wrong by as much at least.
fn floors(case: &Case) -> Vec<(&Subject, bool)> {
    let slab = |storey: u32| {
        let of_storey = |s: &&Subject| s.number("member.storey") == Some(f64::from(storey));
        case.known.members.iter().filter(|s| is(s, "slab")).find(of_storey)
    };
    case.floors.iter().filter_map(|f| Some((slab(f.storey)?, f.not_rigid > LIMIT_TO_CONTACT))).collect()
}

fn is(subject: &Subject, kind: &str) -> bool {
    subject.features.get("member.kind").is_some_and(|value| *value == kind.into())
}
