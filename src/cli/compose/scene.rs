//! The 3D scene: the skin of the FE mesh, if there was such a run, and the boxes of the MBS bodies over common times.

use super::Pieces;
use super::partition::count_compounds;
use crate::building::{Building, Charge, Member, MemberKind};
use crate::fe::dynamics::Death;
use crate::fe::result::{FeRun, KeptFrame};
use crate::generate::is_ground;
use crate::mbs::Model;
use crate::mbs::latent;
use crate::mbs::model::Body;
use crate::mbs::result::CrushedHistory;
use crate::report::{
    BodyBox, CrushedBox, FeScene, MbsScene, PlasticStrain, Pose, Scene, SceneBody, SceneCharge, SceneElement,
    SceneFace, SceneObstacle, ScenePart, faces_of_hexes,
};

/// Colour group of a member; the same word in both views.
fn group(building: &Building, member: &str) -> String {
    let word = match building.member(member).map(|m| m.kind) {
        Some(MemberKind::Column) => "column",
        Some(MemberKind::Beam) => "beam",
        Some(MemberKind::Slab) => "slab",
        Some(MemberKind::Wall) => "wall",
        Some(MemberKind::Footing) => "footing",
        Some(MemberKind::Brace) | None => "other",
    };
    word.to_string()
}

/// The same of a body: that of the member it is named after, of a piece the one before the slash, else of the first one that it stands for.
fn group_of_body(building: &Building, body: &Body) -> String {
    let named = body.id.split('/').next().filter(|id| building.member(id).is_some());
    group(building, named.or(body.origin.members.first().map(String::as_str)).unwrap_or(&body.id))
}

/// The scene of the runs.
pub fn scene(p: &Pieces) -> Scene {
    let outputs = kept(p);
    Scene {
        time_s: outputs.iter().map(|o| p.times_s()[*o]).collect(),
        ground_level_m: Some(p.building.ground.level_m),
        obstacles: p
            .building
            .obstacles
            .iter()
            .map(|o| SceneObstacle { label: o.id.clone(), solid: o.solid })
            .collect(),
        charges: p.building.events.iter().filter_map(|c| charge(p.building, c)).collect(),
        fe: p.against.as_ref().map(|a| fe_scene(p, a.fe)),
        mbs: Some(mbs_scene(p, &outputs)),
    }
}

/// A charge in the middle of what it takes away.
fn charge(building: &Building, charge: &Charge) -> Option<SceneCharge> {
    let member = building.member(&charge.member)?;
    let mut point_m = member.solid.center();
    if let (Some([from, to]), None) = (charge.stretch_m, &member.inclined) {
        point_m[member.axis] = member.solid.min[member.axis] + 0.5 * (from + to);
    }
    Some(SceneCharge { label: charge.id.clone(), what: what(charge), point_m, time_s: charge.time_s })
}

/// What a charge takes away, in words.
pub(super) fn what(charge: &Charge) -> String {
    match charge.stretch_m {
        Some([from, to]) => format!("{} from {from} to {to} m of its length", charge.member),
        None => charge.member.clone(),
    }
}

/// Most bytes of poses in a scene of the MBS alone.
const MOST_POSE_BYTES: usize = 20_000_000;
/// Bytes of a pose: seven numbers of single precision.
const POSE_BYTES: usize = 28;

/// Outputs that are drawn: those of which the FE run has a frame and that all runs reached, or of the MBS alone at equal distances as many as a page can hold.
pub(super) fn kept(p: &Pieces) -> Vec<usize> {
    match &p.against {
        Some(a) => reached(p, a.fe).map(|f| f.output).collect(),
        None => {
            let every = (POSE_BYTES * p.mbs.bodies.len() * p.outputs()).div_ceil(MOST_POSE_BYTES).max(1);
            let last = p.outputs().checked_sub(1);
            (0..p.outputs()).filter(|o| o % every == 0 || Some(*o) == last).collect()
        }
    }
}

/// Frames of an FE run at times that all runs reached.
fn reached<'a>(p: &Pieces, fe: &'a FeRun) -> impl Iterator<Item = &'a KeptFrame> {
    let outputs = p.outputs();
    fe.frames.iter().filter(move |f| f.output < outputs)
}

/// The elements of an FE run with their ends, and the faces that are visible at some time.
pub(super) struct Skin {
    pub(super) elements: Vec<SceneElement>,
    pub(super) faces: Vec<SceneFace>,
}

impl Skin {
    pub(super) fn of(run: &FeRun) -> Self {
        let mesh = &run.mesh;
        let mut elements: Vec<SceneElement> =
            mesh.elements.iter().map(|e| SceneElement { part: e.part as u32, death_s: None }).collect();
        for death in run.deaths.iter().filter(|d| d.cause != Death::Split) {
            elements[death.element].death_s.get_or_insert(death.time_s);
        }
        let hexes: Vec<[u32; 8]> = mesh.elements.iter().map(|e| e.nodes.map(|n| n as u32)).collect();
        let faces = faces_of_hexes(&hexes, &elements);
        Self { elements, faces }
    }
}

fn fe_scene(p: &Pieces, fe: &FeRun) -> FeScene {
    let mesh = &fe.mesh;
    let Skin { elements, faces } = Skin::of(fe);
    FeScene {
        parts: mesh
            .parts
            .iter()
            .map(|id| ScenePart { id: id.clone(), group: group(p.building, id) })
            .collect(),
        faces,
        elements,
        frames_m: reached(p, fe).map(|f| f.nodes_m.clone()).collect(),
        plastic_strain: PlasticStrain::Frames(reached(p, fe).map(|f| f.plastic_strain.clone()).collect()),
    }
}

/// Footings that are ground in the MBS.
pub(super) fn held(building: &Building) -> impl Iterator<Item = &Member> {
    building.members.iter().enumerate().filter(|(i, _)| is_ground(building, *i)).map(|(_, m)| m)
}

/// When a charge takes a body away \[s\].
pub(super) fn removed_s(model: &Model, body: &str) -> Option<f64> {
    let events = model.events.iter().filter(|e| e.remove_bodies.iter().any(|b| b == body));
    events.map(|e| e.time_s).reduce(f64::min)
}

fn mbs_scene(p: &Pieces, outputs: &[usize]) -> MbsScene {
    let model = &p.generated.model;
    let body = |body: &Body| SceneBody {
        id: body.id.clone(),
        group: group_of_body(p.building, body),
        boxes: body
            .shapes
            .iter()
            .map(|s| {
                let [center_m, half_extents_m] = s.bounds();
                BodyBox { center_m, half_extents_m }
            })
            .collect(),
        appears_s: None,
        removed_s: removed_s(model, &body.id),
    };
    let poses = |frame: &crate::mbs::result::Frame| {
        let pairs = frame.position_m.iter().zip(&frame.orientation);
        pairs.map(|(position, turn)| Pose { position_m: *position, orientation: *turn }).collect()
    };
    let compounds = |output: usize| {
        let (_, moving) = count_compounds(&latent::compounds(model, p.mbs, p.mbs.times_s[output]));
        moving as u32
    };
    MbsScene {
        bodies: model.bodies.iter().map(body).collect(),
        frames: outputs.iter().map(|o| poses(&p.mbs.frames[*o])).collect(),
        fixed: held(p.building).map(|m| SceneObstacle { label: m.id.clone(), solid: m.solid }).collect(),
        crushed: p.mbs.crushed.iter().filter_map(|c| crushed_box(p, c, outputs)).collect(),
        compounds: outputs.iter().map(|o| compounds(*o)).collect(),
    }
}

/// A face that is crushed in the run.
fn crushed_box(p: &Pieces, face: &CrushedHistory, outputs: &[usize]) -> Option<CrushedBox> {
    let body = p.generated.model.bodies.iter().position(|b| b.id == face.body)?;
    let depth_m: Vec<f64> = outputs.iter().map(|o| face.depth_m[*o]).collect();
    depth_m.iter().any(|depth| *depth > 0.0).then(|| CrushedBox {
        place: [body, face.shape],
        face: face.face.axis(),
        depth_m,
    })
}
