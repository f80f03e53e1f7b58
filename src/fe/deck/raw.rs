//! What stands in a deck, by identifiers, before anything refers to anything.

use super::error::At;
use crate::fe::law::{CowperSymonds, Hourglass};
use std::collections::BTreeMap;

/// Things with identifiers, each with the place of its definition.
pub(super) type Defined<T> = BTreeMap<u64, (T, At)>;

/// A node.
#[derive(Debug, Clone, Copy)]
pub(super) struct RawNode {
    pub id: u64,
    pub x: [f64; 3],
    /// Code of the held translations, 0 to 7.
    pub held: u8,
    pub at: At,
}

/// A solid with eight nodes.
#[derive(Debug, Clone, Copy)]
pub(super) struct RawSolid {
    pub id: u64,
    pub part: u64,
    pub nodes: [u64; 8],
    pub at: At,
}

/// A beam with two nodes.
#[derive(Debug, Clone, Copy)]
pub(super) struct RawBeam {
    pub id: u64,
    pub part: u64,
    pub nodes: [u64; 2],
    pub at: At,
}

/// A part.
#[derive(Debug, Clone)]
pub(super) struct RawPart {
    pub id: u64,
    pub name: String,
    pub section: u64,
    pub material: u64,
    pub hourglass: u64,
    pub at: At,
}

/// A section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum RawSection {
    Solid { full: bool },
    Truss { area: f64 },
}

/// A material.
#[derive(Debug, Clone)]
pub(super) struct RawMaterial {
    pub density: f64,
    pub youngs: f64,
    pub poisson: f64,
    pub plastic: RawPlastic,
    pub rate: Option<CowperSymonds>,
    pub failure_strain: f64,
}

/// Yield stress over plastic strain.
#[derive(Debug, Clone)]
pub(super) enum RawPlastic {
    Elastic,
    Bilinear { yield_stress: f64, tangent: f64 },
    Points(Vec<[f64; 2]>),
    Curve(u64),
}

/// Erosion added to a material.
#[derive(Debug, Clone, Copy)]
pub(super) struct RawErosion {
    pub material: u64,
    pub plastic_strain: f64,
    pub principal_strain: f64,
    pub at: At,
}

/// Which nodes.
#[derive(Debug, Clone)]
pub(super) enum Who {
    All,
    Node(u64),
    Set(u64),
    Part(u64),
    PartSet(u64),
}

/// A curve over time with a factor, by its identifier.
#[derive(Debug, Clone, Copy)]
pub(super) struct RawHistory {
    pub curve: u64,
    pub factor: f64,
}

/// Held components.
#[derive(Debug, Clone)]
pub(super) struct RawHold {
    pub who: Who,
    pub held: [bool; 3],
    pub at: At,
}

/// A load or a given velocity along an axis.
#[derive(Debug, Clone)]
pub(super) struct RawDrive {
    pub who: Who,
    pub axis: usize,
    pub history: RawHistory,
    pub at: At,
}

/// A velocity field at the start.
#[derive(Debug, Clone)]
pub(super) struct RawStart {
    pub who: Who,
    pub without: Option<(u64, Option<[f64; 3]>)>,
    pub inside: Option<u64>,
    pub velocity: [f64; 3],
    /// Angular velocity vector and a point of its axis.
    pub spin: Option<([f64; 3], [f64; 3])>,
    pub at: At,
}

/// A rigid plane.
#[derive(Debug, Clone)]
pub(super) struct RawWall {
    pub set: u64,
    pub without: u64,
    pub within: f64,
    pub tail: [f64; 3],
    pub head: [f64; 3],
    pub friction: f64,
    pub at: At,
}

/// All of a deck.
#[derive(Debug, Default)]
pub(super) struct Raw {
    pub title: String,
    pub nodes: Vec<RawNode>,
    pub solids: Vec<RawSolid>,
    pub beams: Vec<RawBeam>,
    pub parts: Vec<RawPart>,
    pub sections: Defined<RawSection>,
    pub materials: Defined<RawMaterial>,
    pub hourglass: Defined<Hourglass>,
    pub default_hourglass: Option<Hourglass>,
    pub erosions: Vec<RawErosion>,
    pub curves: Defined<Vec<[f64; 2]>>,
    pub node_sets: Defined<Vec<u64>>,
    /// Ranges of sets given by `_GENERATE`, both ends inside.
    pub node_ranges: Defined<Vec<[u64; 2]>>,
    /// What sets given by `_GENERAL` are made of.
    pub node_general: Defined<Vec<Who>>,
    pub part_sets: Defined<Vec<u64>>,
    pub solid_sets: Defined<Vec<u64>>,
    pub boxes: Defined<[[f64; 2]; 3]>,
    pub holds: Vec<RawHold>,
    pub body_loads: Vec<RawDrive>,
    pub nodal_loads: Vec<RawDrive>,
    pub driven: Vec<RawDrive>,
    pub starts: Vec<RawStart>,
    pub walls: Vec<RawWall>,
    pub contact: Option<crate::fe::model::ContactSettings>,
    /// Parts between which contact is asked for, which have to be all.
    pub contact_parts: Option<(Who, At)>,
    pub end_time: Option<f64>,
    /// Where it stands.
    pub end_time_at: Option<At>,
    pub step_safety: Option<f64>,
    pub mass_scaling: Option<f64>,
    /// Where it stands.
    pub mass_scaling_at: Option<At>,
    pub state_interval: Option<f64>,
    pub state_count: Option<u64>,
    pub history_interval: Option<f64>,
    pub energy_interval: Option<f64>,
    pub history: Vec<(Who, At)>,
}
