//! The catalogue of features: what a rule may ask about, of which subjects, in which unit.
//!
//! This is the only place where features are named; rule files are checked against it when they are
//! loaded, and subjects when they are evaluated.

use super::value::{SubjectKind, Value};
use SubjectKind::{ContactEvent, FractureEvent, Member, MemberEnd, Section, SlabLine, WallEnd};

/// Type of a feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FeatureType {
    /// A number in the given unit (`1` for a ratio, `count` for how many or which one).
    Number {
        /// SI unit.
        unit: &'static str,
    },
    /// One of these names.
    Names(&'static [&'static str]),
    /// True or false.
    Flag,
}

/// One feature.
#[derive(Debug, Clone, Copy)]
pub struct Feature {
    /// Name in conditions.
    pub name: &'static str,
    /// Type and unit.
    pub kind: FeatureType,
    /// The least and the most that a number can be.
    pub range: [f64; 2],
    /// Which subjects have it.
    pub subjects: &'static [SubjectKind],
    /// What it is.
    pub meaning: &'static str,
}

/// Any number.
pub const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

impl Feature {
    /// A number that is never below zero.
    const fn positive(self) -> Self {
        Self { range: [0.0, f64::INFINITY], ..self }
    }

    /// A number from zero to one.
    const fn share(self) -> Self {
        Self { range: [0.0, 1.0], ..self }
    }

    /// Its range in words.
    pub fn range_words(&self) -> String {
        match self.range {
            [least, most] if most.is_finite() => format!("from {least} to {most}"),
            [least, _] if least.is_finite() => format!("at least {least}"),
            _ => "any number".to_string(),
        }
    }

    /// Whether a value fits the type.
    pub fn admits(&self, value: &Value) -> bool {
        match (self.kind, value) {
            (FeatureType::Number { .. }, Value::Number(x)) => x.is_finite(),
            (FeatureType::Names(names), Value::Name(name)) => names.contains(&name.as_str()),
            (FeatureType::Flag, Value::Flag(_)) => true,
            _ => false,
        }
    }

    /// The type in words.
    pub fn type_words(&self) -> String {
        match self.kind {
            FeatureType::Number { unit: "1" } => "a ratio".to_string(),
            FeatureType::Number { unit: "count" } => "a count".to_string(),
            FeatureType::Number { unit } => format!("a number in {unit}"),
            FeatureType::Names(names) => format!("one of '{}'", names.join("', '")),
            FeatureType::Flag => "true or false".to_string(),
        }
    }
}

/// Names of `member.kind`.
pub const MEMBER_KINDS: &[&str] = &["column", "beam", "slab", "wall", "footing"];

const ALL: &[SubjectKind] = &SubjectKind::ALL;
const PARTS: &[SubjectKind] = &[Member, MemberEnd, Section, SlabLine, WallEnd];
const WHOLE: &[SubjectKind] = &[Member, MemberEnd, SlabLine, WallEnd];
const LINES: &[SubjectKind] = &[SlabLine, WallEnd];
const EVENTS: &[SubjectKind] = &[ContactEvent, FractureEvent];

const fn number(
    name: &'static str,
    unit: &'static str,
    subjects: &'static [SubjectKind],
    meaning: &'static str,
) -> Feature {
    Feature { name, kind: FeatureType::Number { unit }, range: ANY, subjects, meaning }
}

const fn names(
    name: &'static str,
    names: &'static [&'static str],
    subjects: &'static [SubjectKind],
    meaning: &'static str,
) -> Feature {
    Feature { name, kind: FeatureType::Names(names), range: ANY, subjects, meaning }
}

const fn flag(name: &'static str, subjects: &'static [SubjectKind], meaning: &'static str) -> Feature {
    Feature { name, kind: FeatureType::Flag, range: ANY, subjects, meaning }
}

/// All features, by name.
pub const CATALOGUE: &[Feature] = &[
    number(
        "building.charged_share",
        "1",
        WHOLE,
        "largest share of a storey's columns that charges take away",
    ).share(),
    number(
        "building.demand_ratio",
        "1",
        WHOLE,
        "largest elastic demand after the removal over capacity among the column ends (see end.demand_ratio); unknown for a mechanism",
    ).positive(),
    number("building.ignition_span", "s", WHOLE, "time from the first charge to the last one").positive(),
    number(
        "building.law_demand_ratio",
        "1",
        WHOLE,
        "building.demand_ratio with the capacity of the homogenised law, which the FE model is made of",
    ).positive(),
    flag(
        "building.mechanism",
        WHOLE,
        "after the removal parts of the frame can move freely: there is no elastic state",
    ),
    names(
        "collapse.phase",
        &["before_contact", "after_contact"],
        ALL,
        "before or after the first contact of a falling part",
    ),
    number(
        "contact.approach_speed",
        "m/s",
        &[ContactEvent],
        "speed at which the two parts approach along the contact normal",
    ).positive(),
    names("contact.partner", &["ground", "obstacle", "part"], &[ContactEvent], "what the part has met"),
    number(
        "critical_strain_rate",
        "1/s",
        ALL,
        "strain rate above which a part does not count as rigid (seed paper, equation 2)",
    ).positive(),
    names(
        "end.adjoining",
        &["slab", "beam", "column", "wall", "footing", "ground", "none"],
        &[MemberEnd],
        "what the end is joined to",
    ),
    number(
        "end.charge_distance",
        "1",
        &[MemberEnd],
        "distance in plan to the nearest column that a charge takes away, over the longest span between columns",
    ).positive(),
    flag("end.clamped", &[MemberEnd], "the end is held by a support"),
    number(
        "end.column_demand_ratio",
        "1",
        &[MemberEnd],
        "of a beam end: the largest demand ratio of the column ends at its joint",
    ).positive(),
    number(
        "end.demand_ratio",
        "1",
        &[MemberEnd],
        "elastic axial force and moments after the removal, all alike, over those that the section can just bear",
    ).positive(),
    number(
        "end.demand_ratio_before",
        "1",
        &[MemberEnd],
        "end.demand_ratio before the removal",
    ).positive(),
    number(
        "end.joint_strength",
        "1",
        &[MemberEnd],
        "at the joint: moment capacity of the beams over that of the columns, of the homogenised law at the axial forces under dead load",
    ).positive(),
    number(
        "end.law_demand_ratio",
        "1",
        &[MemberEnd],
        "end.demand_ratio with the capacity of the homogenised law, which the FE model is made of",
    ).positive(),
    flag("end.over_charge", &[MemberEnd], "a charge takes a column away below the end"),
    names(
        "end.position",
        &["bottom", "top", "start", "end"],
        &[MemberEnd],
        "which end: bottom and top of a column, start and end of a beam",
    ),
    number("event.time", "s", EVENTS, "time since the first ignition"),
    number(
        "floor.slenderness",
        "1",
        &[Member, SlabLine],
        "of a slab or beam: longest stretch of its floor between columns that stand, or beyond the last of them, before and after each charge, over the depth of the deepest beam, or of the slab where there is none",
    ).positive(),
    names(
        "fracture.place",
        &["end", "span"],
        &[FractureEvent],
        "whether the part broke at an end or in between",
    ),
    number(
        "line.beam_demand_ratio",
        "1",
        &[SlabLine],
        "largest end.law_demand_ratio of the ends of the beam that runs along the line; unknown without one",
    ).positive(),
    number(
        "line.charge_distance",
        "1",
        LINES,
        "distance in plan of its middle to the nearest column that a charge takes away, over the longest span between columns",
    ).positive(),
    flag("line.clamped", &[WallEnd], "the wall stands on a support there"),
    number(
        "line.demand_ratio",
        "1",
        LINES,
        "of a slab: w l² / 8 of its weight over its plastic moment, as if it bridged its stretch between the columns that stand after the removal by itself; twice the stretch where it hangs over the last of them. Of the end of a wall: elastic demand after the removal over the capacity of the homogenised law",
    ).positive(),
    flag("line.has_beam", &[SlabLine], "a beam runs along the line from column to column"),
    number(
        "line.length",
        "m",
        LINES,
        "of a slab: between the faces of its columns; of a wall: its clear height",
    ).positive(),
    flag("line.over_charge", &[SlabLine], "charges take away the columns at one of its ends, or columns below them"),
    names("line.position", &["bottom", "top"], &[WallEnd], "foot or head of the wall"),
    number("line.slenderness", "1", LINES, "line.length over thickness").positive(),
    number(
        "member.axial_ratio",
        "1",
        PARTS,
        "dead-load axial force over area times first yield stress, compression positive",
    ),
    number("member.axial_ratio_after", "1", PARTS, "the same after the removal; unknown for a mechanism"),
    number(
        "member.charge_distance",
        "1",
        &[Member],
        "distance in plan of its centre to the nearest column that a charge takes away, over the longest span between columns",
    ).positive(),
    flag("member.charged", PARTS, "a charge removes the member or a stretch of it"),
    number("member.fall_height", "m", PARTS, "height of its underside above the ground"),
    number("member.impact_speed", "m/s", PARTS, "speed of a free fall from there to the ground").positive(),
    names(
        "member.kind",
        MEMBER_KINDS,
        ALL,
        "kind of the member (of the member that was struck or broke, for an event)",
    ),
    number("member.length", "m", PARTS, "clear length along the axis; the longer side of a plate").positive(),
    number(
        "member.obstacle_distance",
        "1",
        PARTS,
        "distance in plan to the nearest obstacle over the height of its top above the ground: what topples reaches it up to 1; unknown without obstacles",
    ).positive(),
    number("member.slenderness", "1", PARTS, "clear length over least width of the section").positive(),
    number("member.span_over_depth", "1", PARTS, "of a beam: clear length over depth").positive(),
    number("member.storey", "count", PARTS, "storey, counted from 1 below").positive(),
    number("member.storey_share", "1", PARTS, "storey over number of storeys").share(),
    number(
        "member.strain_rate",
        "1/s",
        ALL,
        "largest strain rate of the member's body between its ends, over the time considered",
    ).positive(),
    flag("member.weakened", PARTS, "preparatory work has reduced its strength"),
    number(
        "section.demand_ratio",
        "1",
        &[Section],
        "elastic moment after the removal over moment capacity at this section",
    ).positive(),
    number(
        "section.position",
        "1",
        &[Section],
        "place along the member, 0 at the lower end or start, 1 at the other",
    ).share(),
    number(
        "section.strain_rate",
        "1/s",
        &[Section],
        "largest strain rate around the section over the time considered",
    ).positive(),
    number("storeys", "count", ALL, "number of storeys of the building").positive(),
    names(
        "wish.accuracy",
        &["fast", "balanced", "fine"],
        WHOLE,
        "the level of detail that the analyst asks for",
    ),
];

/// The feature with this name. The catalogue is in the order of the names.
pub fn find(name: &str) -> Option<&'static Feature> {
    CATALOGUE.binary_search_by(|feature| feature.name.cmp(name)).ok().map(|place| &CATALOGUE[place])
}

/// The known name most like an unknown one, if any is like it.
pub fn suggestion<'a>(unknown: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|name| (strsim::jaro_winkler(unknown, name), name))
        .filter(|(likeness, _)| *likeness > 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(a.1)))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_catalogue_is_sorted_and_without_doubles() {
        assert!(CATALOGUE.windows(2).all(|w| w[0].name < w[1].name));
        assert!(CATALOGUE.iter().all(|f| !f.subjects.is_empty() && !f.meaning.is_empty()));
    }

    #[test]
    fn suggestions_are_near_or_absent() {
        let known = || CATALOGUE.iter().map(|f| f.name);
        assert_eq!(suggestion("membr.kind", known()), Some("member.kind"));
        assert_eq!(suggestion("colour", known()), None);
    }
}
