//! The catalogue of actions: what a rule may decide, with which parameters.
//!
//! Each action answers one question (its aspect). Two rules that answer the same question about the same subject
//! differently contradict each other unless one has the higher priority.

use super::value::SubjectKind;
use SubjectKind::{ContactEvent, FractureEvent, Member, MemberEnd, Section, SlabLine, WallEnd};
use serde::Serialize;

/// The question an action answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Aspect {
    /// How the member's volume becomes bodies.
    Body,
    /// What happens to the body when its charge goes off.
    Charge,
    /// Whether it may break away from what it is one body with.
    Parting,
    /// How an end or a section resists rotation.
    Rotation,
    /// How an end resists displacement.
    Translation,
    /// What an event changes in the model.
    Change,
    /// Whether the rigid parts are looked for again.
    Rigidity,
}

impl Aspect {
    /// The question in words.
    pub fn question(self) -> &'static str {
        match self {
            Self::Body => "how the member becomes bodies",
            Self::Charge => "what its charge does",
            Self::Parting => "whether it may break away from its slab",
            Self::Rotation => "how it resists rotation",
            Self::Translation => "how it resists displacement",
            Self::Change => "what the event changes in the model",
            Self::Rigidity => "whether rigid parts are looked for again",
        }
    }

    /// The questions that must have an answer for each subject of a kind.
    pub fn required(kind: SubjectKind) -> &'static [Self] {
        match kind {
            Member => &[Self::Body],
            MemberEnd => &[Self::Rotation, Self::Translation],
            Section | SlabLine | WallEnd => &[Self::Rotation],
            ContactEvent | FractureEvent => &[Self::Change, Self::Rigidity],
        }
    }
}

/// Type of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterType {
    /// A number above zero in this unit.
    Positive(&'static str),
    /// A whole number of at least and at most this.
    Count(u32, u32),
    /// One of these names.
    Names(&'static [&'static str]),
}

/// One parameter of an action.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Name.
    pub name: &'static str,
    /// Type.
    pub kind: ParameterType,
    /// Whether it must be given.
    pub required: bool,
}

/// One action.
#[derive(Debug)]
pub struct ActionSpec {
    /// Which one.
    pub action: Action,
    /// Name in rule files.
    pub name: &'static str,
    /// Question it answers.
    pub aspect: Aspect,
    /// About which subjects.
    pub subjects: &'static [SubjectKind],
    /// Parameters.
    pub parameters: &'static [Parameter],
    /// What it does.
    pub meaning: &'static str,
}

/// What a rule decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// The member is one rigid body.
    RigidBody,
    /// The member is part of one rigid body together with its neighbours.
    MergeRigid,
    /// The member is part of a floor that bends.
    MergeElastic,
    /// The member is several rigid bodies with sections between them.
    Subdivide,
    /// The web of a beam is a body of its own, one with its slab until what joins them reaches its resistance.
    BreakAway,
    /// The body vanishes, with its joints.
    RemoveBody,
    /// A hinge with a resistance curve.
    Hinge,
    /// A section that resists elastically until its demand reaches its resistance.
    LatentHinge,
    /// Springs that do not yield.
    ElasticConnection,
    /// No relative rotation.
    RigidConnection,
    /// Axial and shear springs.
    TranslationalSpring,
    /// No relative displacement.
    RigidTranslation,
    /// A subsystem is put in.
    InsertSubsystem,
    /// The model stays as it is.
    KeepModel,
    /// Rigid parts are looked for again.
    RecheckRigidity,
    /// Rigid parts stay as they are.
    KeepRigidity,
}

impl Action {
    /// Its entry in the catalogue.
    pub fn spec(self) -> &'static ActionSpec {
        // Every variant has an entry (tested); the first is a formality.
        CATALOGUE.iter().find(|spec| spec.action == self).unwrap_or(&CATALOGUE[0])
    }
}

const fn required(name: &'static str, kind: ParameterType) -> Parameter {
    Parameter { name, kind, required: true }
}

const fn optional(name: &'static str, kind: ParameterType) -> Parameter {
    Parameter { name, kind, required: false }
}

/// Most pieces of a member: more would be deeper than long in the slenderest members that there are, and bodies are no finite elements.
const MOST_PIECES: u32 = 50;

/// All actions.
pub static CATALOGUE: &[ActionSpec] = &[
    ActionSpec {
        action: Action::RigidBody,
        name: "rigid_body",
        aspect: Aspect::Body,
        subjects: &[Member],
        parameters: &[],
        meaning: "the member between its ends is one rigid body",
    },
    ActionSpec {
        action: Action::MergeRigid,
        name: "merge_rigid",
        aspect: Aspect::Body,
        subjects: &[Member],
        parameters: &[required("with", ParameterType::Names(&["adjoining_slab", "storey_floor"]))],
        meaning: "the member and those named are one rigid body",
    },
    ActionSpec {
        action: Action::MergeElastic,
        name: "merge_elastic",
        aspect: Aspect::Body,
        subjects: &[Member],
        parameters: &[required("with", ParameterType::Names(&["storey_floor"]))],
        meaning: "the member and those named are one floor, in pieces about its columns with springs in between, which yield at the ends of beams and strips",
    },
    ActionSpec {
        action: Action::Subdivide,
        name: "subdivide",
        aspect: Aspect::Body,
        subjects: &[Member],
        parameters: &[
            required("pieces", ParameterType::Count(2, MOST_PIECES)),
            optional("least_length_m", ParameterType::Positive("m")),
        ],
        meaning: "the member is several rigid bodies joined at latent sections",
    },
    ActionSpec {
        action: Action::BreakAway,
        name: "break_away",
        aspect: Aspect::Parting,
        subjects: &[Member],
        parameters: &[],
        meaning: "the web of a beam below a slab that bends is one body with it until it bears as much there, or at its column, as it can",
    },
    ActionSpec {
        action: Action::RemoveBody,
        name: "remove_body",
        aspect: Aspect::Charge,
        subjects: &[Member],
        parameters: &[],
        meaning: "the body vanishes with its joints at the time of ignition",
    },
    ActionSpec {
        action: Action::Hinge,
        name: "hinge",
        aspect: Aspect::Rotation,
        subjects: &[MemberEnd],
        parameters: &[required("curve", ParameterType::Names(&["library"]))],
        meaning: "a hinge about both bending axes with the resistance curve of the library",
    },
    ActionSpec {
        action: Action::LatentHinge,
        name: "latent_hinge",
        aspect: Aspect::Rotation,
        subjects: &[MemberEnd, Section, SlabLine, WallEnd],
        parameters: &[],
        meaning: "a section that becomes a hinge, or a line of a slab or wall that yields, when its demand reaches its resistance",
    },
    ActionSpec {
        action: Action::ElasticConnection,
        name: "elastic_connection",
        aspect: Aspect::Rotation,
        subjects: &[MemberEnd, SlabLine, WallEnd],
        parameters: &[],
        meaning: "the elastic springs of the hinge or line that would stand there; it does not yield",
    },
    ActionSpec {
        action: Action::RigidConnection,
        name: "rigid_connection",
        aspect: Aspect::Rotation,
        subjects: &[MemberEnd, Section],
        parameters: &[],
        meaning: "no relative rotation",
    },
    ActionSpec {
        action: Action::TranslationalSpring,
        name: "translational_spring",
        aspect: Aspect::Translation,
        subjects: &[MemberEnd],
        parameters: &[required("directions", ParameterType::Names(&["axial", "axial_and_shear"]))],
        meaning: "elastic springs against displacement, and a tensile capacity",
    },
    ActionSpec {
        action: Action::RigidTranslation,
        name: "rigid_translation",
        aspect: Aspect::Translation,
        subjects: &[MemberEnd],
        parameters: &[],
        meaning: "no relative displacement",
    },
    ActionSpec {
        action: Action::InsertSubsystem,
        name: "insert_subsystem",
        aspect: Aspect::Change,
        subjects: &[ContactEvent, FractureEvent],
        parameters: &[
            required("subsystem", ParameterType::Names(&["contact", "hinge", "contact_and_hinge"])),
            required("place", ParameterType::Names(&["at_event", "nearest_section", "highest_demand"])),
        ],
        meaning: "a subsystem is put into the model where the event says",
    },
    ActionSpec {
        action: Action::KeepModel,
        name: "keep_model",
        aspect: Aspect::Change,
        subjects: &[ContactEvent, FractureEvent],
        parameters: &[],
        meaning: "nothing is put in",
    },
    ActionSpec {
        action: Action::RecheckRigidity,
        name: "recheck_rigidity",
        aspect: Aspect::Rigidity,
        subjects: &[ContactEvent, FractureEvent],
        parameters: &[],
        meaning: "which parts are rigid is decided again with what is known after the event",
    },
    ActionSpec {
        action: Action::KeepRigidity,
        name: "keep_rigidity",
        aspect: Aspect::Rigidity,
        subjects: &[ContactEvent, FractureEvent],
        parameters: &[],
        meaning: "rigid parts stay as they are",
    },
];

/// The action with this name.
pub fn find(name: &str) -> Option<&'static ActionSpec> {
    CATALOGUE.iter().find(|spec| spec.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_has_its_own_entry_and_each_question_an_action() {
        for spec in CATALOGUE {
            assert!(std::ptr::eq(spec.action.spec(), spec), "{}", spec.name);
            let json = serde_json::to_value(spec.action).unwrap();
            assert_eq!(json, spec.name);
        }
        for kind in SubjectKind::ALL {
            for aspect in Aspect::required(kind) {
                assert!(CATALOGUE.iter().any(|s| s.aspect == *aspect && s.subjects.contains(&kind)));
            }
        }
    }
}
