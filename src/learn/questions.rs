//! What is learned: questions about places, what a study answers, and what a rule then decides.

use super::Case;
use crate::building::lines::Line;
use crate::rules::{Subject, SubjectKind};
use crate::study::{EndZone, MemberFacts};
use crate::validate::LIMIT_TO_CONTACT;
use std::collections::BTreeMap;

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
    /// Phase of the collapse in which its rules hold; [`ANY_PHASE`]: in any.
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

/// The phase of questions about what a model is generated for whatever happens later.
pub const ANY_PHASE: &str = "any";

const OF_LINE: &[&str] = &[
    "line.demand_ratio",
    "line.beam_demand_ratio",
    "line.over_charge",
    "line.charge_distance",
    "line.has_beam",
    "line.position",
    "line.clamped",
    "line.slenderness",
    "line.length",
    "building.demand_ratio",
    "building.law_demand_ratio",
    "building.mechanism",
    "building.charged_share",
    "floor.slenderness",
    "member.storey",
    "member.storey_share",
    "member.fall_height",
    "member.weakened",
];

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
    ("line.beam_demand_ratio", true),
    ("line.charge_distance", false),
    ("line.demand_ratio", true),
    ("line.over_charge", true),
    ("member.axial_ratio", true),
    ("member.axial_ratio_after", true),
    ("member.charge_distance", false),
    ("member.weakened", true),
];

const COLUMN_ELASTIC: &str = "a column end that is joined rigidly loses its elastic stiffness, on which the deflection of a building that stands rests; a hinge that does not turn costs nothing but its springs";
const STRIP_ELASTIC: &str = "most that counts as elastic flows a little, and a strip that cannot costs more than one that may and does not: with elastic strips in all buildings whose demand is at most twice their capacity, e to contact of the 56 of the plan that stand is 0.231 in the median and 0.609 at the 90th percentile, for 0.178 and 0.432";
const WALL_ELASTIC: &str = "a wall that may yield and does not costs nothing but its curve; one that cannot holds up a building that falls";
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

const LINE_YIELDS: Answer = Answer {
    action: "latent_hinge",
    parameters: "",
    words: "yields",
    supersedes: &["seed/slab-line-yields"],
    refused: None,
};
const LINE_STAYS: Answer = Answer {
    action: "elastic_connection",
    words: "stays elastic",
    refused: Some(STRIP_ELASTIC),
    ..LINE_YIELDS
};
const WALL_YIELDS: Answer = Answer { supersedes: &["seed/wall-end-yields"], ..LINE_YIELDS };
const WALL_STAYS: Answer =
    Answer { supersedes: &["seed/wall-end-yields"], refused: Some(WALL_ELASTIC), ..LINE_STAYS };

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
    Question {
        name: "slab-lines",
        words: "Which strips of slabs between columns, with the beams in them, have a plastic strain above 0.0005 in the whole run?",
        subject: SubjectKind::SlabLine,
        condition: "member.kind == 'slab'",
        phase: ANY_PHASE,
        yes: LINE_YIELDS,
        no: LINE_STAYS,
        turned_round: false,
        features: OF_LINE,
        places: |case| lines(case, SubjectKind::SlabLine),
    },
    Question {
        name: "wall-ends",
        words: "Which feet and heads of walls have a plastic strain above 0.0005 in the whole run?",
        subject: SubjectKind::WallEnd,
        condition: "member.kind == 'wall'",
        phase: ANY_PHASE,
        yes: WALL_YIELDS,
        no: WALL_STAYS,
        turned_round: false,
        features: OF_LINE,
        places: |case| lines(case, SubjectKind::WallEnd),
    },
];

/// Plastic strain from which a line has yielded: the elastic strain at first yield of the laws of the plan is 0.0004 to 0.0006, so that such a line has bent about twice as far as it would elastically.
const YIELDED: f64 = 5e-4;

/// How far the end of a beam may be outside a line, and how deep below its slab \[m\].
const ON_LINE_M: f64 = 1e-3;
const BELOW_M: f64 = 1.0;

/// Slab lines or wall ends, and whether they yield, with the ends of the beams that run along them.
fn lines(case: &Case, kind: SubjectKind) -> Vec<(&Subject, bool)> {
    let facts = &case.study.facts;
    let zones: BTreeMap<&str, &EndZone> = facts.lines.iter().map(|zone| (zone.id.as_str(), zone)).collect();
    let yielding = facts.ends.iter().filter(|zone| zone.plastic_strain > YIELDED);
    let beams: Vec<(usize, [f64; 3])> =
        yielding.filter_map(|zone| Some((case.axis_of_beam(&zone.member)?, zone.point_m))).collect();
    let mut list = Vec::new();
    for (subject, line) in case.known.lines.iter().zip(&case.lines).filter(|(s, _)| s.kind == kind) {
        if let Some(zone) = zones.get(subject.id.as_str()) {
            let with_beam = || beams.iter().any(|(axis, at)| *axis == line.axis && is_along(line, *at));
            list.push((subject, zone.plastic_strain > YIELDED || with_beam()));
        }
    }
    list
}

/// Whether the end of a beam at a place is on a line of a slab.
fn is_along(line: &Line, point_m: [f64; 3]) -> bool {
    let reach_m = [ON_LINE_M, ON_LINE_M, line.clear.size()[2] + BELOW_M];
    (0..3).all(|i| (line.clear.min[i] - reach_m[i]..=line.clear.max[i] + reach_m[i]).contains(&point_m[i]))
}

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
