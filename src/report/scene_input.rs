//! The 3D scene of a report: the FE skin and the MBS boxes over common frame times.

use crate::base::geom::Aabb;
use std::collections::BTreeMap;

/// Both collapses at the same frame times. Global axes, z up, m and s.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    /// Frame times \[s\], increasing, common to both runs.
    pub time_s: Vec<f64>,
    /// Height of the ground \[m\]; `None`: no ground is drawn.
    pub ground_level_m: Option<f64>,
    /// Obstacles.
    pub obstacles: Vec<SceneObstacle>,
    /// Charges, marked until they fire.
    pub charges: Vec<SceneCharge>,
    /// The FE run.
    pub fe: Option<FeScene>,
    /// The MBS run.
    pub mbs: Option<MbsScene>,
}

/// A rigid, immovable box.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneObstacle {
    /// Name.
    pub label: String,
    /// Its solid \[m\].
    pub solid: Aabb,
}

/// A charge.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneCharge {
    /// Its id.
    pub label: String,
    /// What it takes away, e.g. "C1-A1".
    pub what: String,
    /// Middle of that in the initial state \[m\].
    pub point_m: [f64; 3],
    /// Ignition time \[s\].
    pub time_s: f64,
}

/// The FE run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FeScene {
    /// Parts that elements belong to.
    pub parts: Vec<ScenePart>,
    /// Elements that own faces.
    pub elements: Vec<SceneElement>,
    /// Visible faces; [`faces_of_hexes`] makes them from the mesh.
    pub faces: Vec<SceneFace>,
    /// Node positions per frame \[m\]: `frames_m[frame][node]`. A non-finite position is replaced by
    /// the node's last finite one.
    pub frames_m: Vec<Vec<[f32; 3]>>,
    /// Equivalent plastic strain of the elements, for colouring.
    pub plastic_strain: PlasticStrain,
}

/// A part of the FE mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ScenePart {
    /// Part id (member id).
    pub id: String,
    /// Colour group, e.g. "column"; the same words as in [`SceneBody::group`] give the same colours.
    pub group: String,
}

/// An element of the FE mesh.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SceneElement {
    /// Index into [`FeScene::parts`].
    pub part: u32,
    /// Time at which it is eroded or removed \[s\]; `None`: never.
    pub death_s: Option<f64>,
}

/// A quadrilateral face, shown from its birth until the death of its element.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SceneFace {
    /// Node indices around the face.
    pub nodes: [u32; 4],
    /// Index into [`FeScene::elements`].
    pub element: u32,
    /// Time at which it becomes visible \[s\], the death of the neighbour; `None`: from the start.
    pub birth_s: Option<f64>,
}

/// Plastic strain of the elements.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum PlasticStrain {
    /// Not recorded: the view does not offer this colouring.
    #[default]
    None,
    /// At the frames: `values[frame][element]`.
    Frames(Vec<Vec<f32>>),
}

/// The MBS run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MbsScene {
    /// Bodies.
    pub bodies: Vec<SceneBody>,
    /// Poses per frame: `frames[frame][body]`.
    pub frames: Vec<Vec<Pose>>,
    /// What the building stands on and is no body of the model, such as held footings.
    pub fixed: Vec<SceneObstacle>,
    /// Boxes that get shorter.
    pub crushed: Vec<CrushedBox>,
    /// How many rigid compounds the bodies move as, a frame each; empty: not told.
    pub compounds: Vec<u32>,
}

/// A box that gets shorter at one of its faces.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CrushedBox {
    /// Index of the body and of its box.
    pub place: [usize; 2],
    /// Axis of the box (0 to 2) and 1 or -1 for the face along or against it.
    pub face: (usize, f64),
    /// By how much it is shorter, per frame \[m\].
    pub depth_m: Vec<f64>,
}

/// A rigid body made of boxes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneBody {
    /// Body id.
    pub id: String,
    /// Colour group, e.g. "slab".
    pub group: String,
    /// Boxes in the body frame.
    pub boxes: Vec<BodyBox>,
    /// Time at which the body appears (after a split) \[s\]; `None`: from the start.
    pub appears_s: Option<f64>,
    /// Time at which the body is removed \[s\]; `None`: never.
    pub removed_s: Option<f64>,
}

/// A box in a body frame.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BodyBox {
    /// Centre \[m\].
    pub center_m: [f64; 3],
    /// Half edge lengths \[m\].
    pub half_extents_m: [f64; 3],
}

/// Position and orientation of a body frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Origin of the body frame \[m\].
    pub position_m: [f64; 3],
    /// Quaternion `[w, x, y, z]`, body to global.
    pub orientation: [f64; 4],
}

impl Default for Pose {
    fn default() -> Self {
        Self { position_m: [0.0; 3], orientation: [1.0, 0.0, 0.0, 0.0] }
    }
}

/// Local faces of a hexahedron, nodes 0-3 around the bottom, 4-7 above them; seen from outside
/// anticlockwise.
const HEX_FACES: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// The faces of a hexahedral mesh that are visible at some time.
///
/// `hexes[e]` are the nodes of `elements[e]`: 0-3 around the bottom, 4-7 above them. A face of one
/// element is part of the skin. A face of two elements that die at different times belongs to the survivor,
/// born when its neighbour dies. Elements without partner in the other list are ignored.
pub fn faces_of_hexes(hexes: &[[u32; 8]], elements: &[SceneElement]) -> Vec<SceneFace> {
    let mut first: BTreeMap<[u32; 4], (u32, [u32; 4])> = BTreeMap::new();
    let mut inner = Vec::new();
    for (e, (hex, _)) in hexes.iter().zip(elements).enumerate() {
        for local in HEX_FACES {
            let nodes = local.map(|i| hex[i]);
            let mut key = nodes;
            key.sort_unstable();
            match first.remove(&key) {
                Some(other) => inner.push((other, (e as u32, nodes))),
                None => _ = first.insert(key, (e as u32, nodes)),
            }
        }
    }
    let mut faces: Vec<SceneFace> =
        first.into_values().map(|(element, nodes)| SceneFace { nodes, element, birth_s: None }).collect();
    let death = |e: u32| elements[e as usize].death_s.unwrap_or(f64::INFINITY);
    for (a, b) in inner {
        let (early, late) = if death(a.0) < death(b.0) { (a, b) } else { (b, a) };
        if death(early.0) < death(late.0) {
            faces.push(SceneFace { nodes: late.1, element: late.0, birth_s: Some(death(early.0)) });
        }
    }
    faces.sort_by_key(|f| (f.element, f.nodes));
    faces
}
