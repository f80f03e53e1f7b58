//! Packs the 3D scene for the viewer: a JSON head with offsets into one block of bytes.
//!
//! Blocks (little endian):
//! - `positions`: per node, per axis, the quantised positions of all frames
//!   ([`super::codec::push_series`]). Nodes that no face uses are left out. A node whose faces are all
//!   gone stays where it was: eroded fragments flying off would coarsen the quantisation for nothing.
//! - `faces`: per face four node indices and the element (u32), then the birth time (f32, -1e30: from the
//!   start).
//! - `elements`: per element its death time (f32, 1e30: never) and part (u32).
//! - `strain`: per element the changes of its 8 bit strain: number of changes, then frame difference and
//!   value, all variable length.
//! - `poses`: per frame and body position and quaternion w, x, y, z (f32).

use super::ReportError;
use super::codec::{Quantiser, push_series, push_varint};
use super::input::HingeSite;
use super::scene_input::{FeScene, MbsScene, PlasticStrain, Pose, Scene, SceneCharge, SceneObstacle};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A packed scene.
pub struct PackedScene {
    /// The head, JSON.
    pub head: Value,
    /// The block of bytes.
    pub bytes: Vec<u8>,
    /// Largest quantisation step of the FE positions \[m\].
    pub step_m: Option<f64>,
    /// Colour groups, each with the number of its colour.
    pub groups: Vec<(String, usize)>,
    /// Largest plastic strain, if there is one to colour by.
    pub max_plastic_strain: Option<f64>,
}

/// A block's place in the bytes: `[offset, length]`.
fn append(bytes: &mut Vec<u8>, block: &[u8]) -> Value {
    let place = json!([bytes.len(), block.len()]);
    bytes.extend_from_slice(block);
    place
}

/// Checks and packs a scene with its hinge markers.
pub fn pack(scene: &Scene, sites: &[HingeSite]) -> Result<PackedScene, ReportError> {
    check(scene)?;
    let groups = groups_of(scene);
    let mut bytes = Vec::new();
    let mut step_m = None;
    let mut max_strain = None;
    let fe = scene.fe.as_ref().map(|fe| {
        let quantiser = pack_fe(fe, &scene.time_s, &groups, &mut bytes);
        step_m = Some(quantiser.1.step_m.iter().copied().fold(0.0, f64::max));
        max_strain = quantiser.2;
        quantiser.0
    });
    let mbs = scene.mbs.as_ref().map(|mbs| pack_mbs(mbs, &groups, &mut bytes));
    let (view_min, view_max) = view_box(scene);
    let head = json!({
        "times": scene.time_s,
        "ground": scene.ground_level_m,
        "view": [view_min, view_max],
        "obstacles": solids(&scene.obstacles),
        "fe": fe,
        "mbs": mbs,
        "charges": scene.charges.iter().map(|c| charge(c, scene)).collect::<Vec<_>>(),
        "markers": sites.iter().map(|s| marker(s, scene)).collect::<Vec<_>>(),
    });
    Ok(PackedScene { head, bytes, step_m, groups, max_plastic_strain: max_strain })
}

/// Boxes that do not move.
fn solids(list: &[SceneObstacle]) -> Value {
    let one = |o: &SceneObstacle| json!({ "label": o.label, "center": o.solid.center(), "half": o.solid.size().map(|s| 0.5 * s) });
    list.iter().map(one).collect()
}

fn expect(what: &str, expected: usize, found: usize) -> Result<(), ReportError> {
    if expected == found { Ok(()) } else { Err(ReportError::Length { what: what.into(), expected, found }) }
}

fn below(what: &str, index: u32, count: usize) -> Result<(), ReportError> {
    if (index as usize) < count {
        Ok(())
    } else {
        Err(ReportError::Index { what: what.into(), index, count })
    }
}

fn check(scene: &Scene) -> Result<(), ReportError> {
    let frames = scene.time_s.len();
    if !scene.time_s.iter().all(|t| t.is_finite()) || scene.time_s.windows(2).any(|w| w[1] <= w[0]) {
        return Err(ReportError::Times { what: "scene frames".into() });
    }
    if let Some(fe) = &scene.fe {
        expect("FE frames of the scene", frames, fe.frames_m.len())?;
        let nodes = fe.frames_m.first().map_or(0, Vec::len);
        for frame in &fe.frames_m {
            expect("nodes of an FE frame", nodes, frame.len())?;
        }
        for face in &fe.faces {
            below("element of a face", face.element, fe.elements.len())?;
            for node in face.nodes {
                below("node of a face", node, nodes)?;
            }
        }
        for element in &fe.elements {
            below("part of an element", element.part, fe.parts.len())?;
        }
        match &fe.plastic_strain {
            PlasticStrain::None => {}
            PlasticStrain::Frames(list) => {
                expect("frames of plastic strain", frames, list.len())?;
                for values in list {
                    expect("plastic strains of a frame", fe.elements.len(), values.len())?;
                }
            }
        }
    }
    if let Some(mbs) = &scene.mbs {
        expect("MBS frames of the scene", frames, mbs.frames.len())?;
        for frame in &mbs.frames {
            expect("poses of an MBS frame", mbs.bodies.len(), frame.len())?;
        }
        if !mbs.compounds.is_empty() {
            expect("compounds of the MBS", frames, mbs.compounds.len())?;
        }
    }
    Ok(())
}

/// Kinds of members whose colour is the same in every report, in the order of the colours.
const COLOURED: [&str; 5] = ["beam", "column", "slab", "footing", "wall"];
/// Colours that there are.
const COLOURS: usize = 8;

/// The groups of a scene with their colours: those of [`COLOURED`] have their own, others the rest in turns.
fn groups_of(scene: &Scene) -> Vec<(String, usize)> {
    let fe = scene.fe.iter().flat_map(|fe| fe.parts.iter().map(|p| &p.group));
    let mbs = scene.mbs.iter().flat_map(|mbs| mbs.bodies.iter().map(|b| &b.group));
    let mut groups: Vec<String> = fe.chain(mbs).cloned().collect();
    groups.sort();
    groups.dedup();
    let mut others = (COLOURED.len()..COLOURS).cycle();
    let colour = |group: String| {
        let own = COLOURED.iter().position(|c| *c == group).or_else(|| others.next());
        (group, own.unwrap_or(0))
    };
    groups.into_iter().map(colour).collect()
}

fn group_index(groups: &[(String, usize)], group: &str) -> usize {
    groups.iter().find(|(name, _)| name == group).map_or(0, |(_, colour)| *colour)
}

/// Nodes used by faces, each with the number of frames in which it is needed.
fn used_nodes(fe: &FeScene, time_s: &[f64]) -> BTreeMap<u32, usize> {
    let mut needed = BTreeMap::new();
    for face in &fe.faces {
        let death = fe.elements[face.element as usize].death_s.unwrap_or(f64::INFINITY);
        // One frame beyond the death, because the view interpolates up to it.
        let frames = (time_s.partition_point(|&t| t < death) + 1).min(time_s.len());
        for node in face.nodes {
            let entry = needed.entry(node).or_insert(1);
            *entry = frames.max(*entry);
        }
    }
    needed
}

/// The track of a node: not moving once it is not needed, not-a-number replaced by the last number.
fn track(fe: &FeScene, node: u32, needed: usize) -> Vec<[f64; 3]> {
    let mut last = [0.0; 3];
    let mut out = Vec::with_capacity(fe.frames_m.len());
    for (i, frame) in fe.frames_m.iter().enumerate() {
        let p = frame[node as usize];
        if i < needed.max(1) && p.iter().all(|x| x.is_finite()) {
            last = p.map(f64::from);
        }
        out.push(last);
    }
    out
}

fn pack_fe(
    fe: &FeScene,
    time_s: &[f64],
    groups: &[(String, usize)],
    bytes: &mut Vec<u8>,
) -> (Value, Quantiser, Option<f64>) {
    let used = used_nodes(fe, time_s);
    let tracks: Vec<Vec<[f64; 3]>> = used.iter().map(|(&node, &needed)| track(fe, node, needed)).collect();
    let (min, max) = bounds(tracks.iter().flatten().copied()).unwrap_or(([0.0; 3], [1.0; 3]));
    let quantiser = Quantiser::of_box(min, max);
    let mut positions = Vec::with_capacity(tracks.len() * time_s.len() * 3);
    for track in &tracks {
        for axis in 0..3 {
            push_series(&mut positions, track.iter().map(|p| quantiser.encode(axis, p[axis])));
        }
    }
    let new_index: BTreeMap<u32, u32> = used.keys().zip(0_u32..).map(|(&node, i)| (node, i)).collect();
    let mut faces = Vec::with_capacity(fe.faces.len() * 24);
    for face in &fe.faces {
        for node in face.nodes {
            faces.extend_from_slice(&new_index[&node].to_le_bytes());
        }
        faces.extend_from_slice(&face.element.to_le_bytes());
        faces.extend_from_slice(&(face.birth_s.unwrap_or(-1e30) as f32).to_le_bytes());
    }
    let mut elements = Vec::with_capacity(fe.elements.len() * 8);
    for element in &fe.elements {
        elements.extend_from_slice(&(element.death_s.unwrap_or(1e30) as f32).to_le_bytes());
        elements.extend_from_slice(&element.part.to_le_bytes());
    }
    let strain = pack_strain(fe);
    let head = json!({
        "nodes": tracks.len(),
        "faces": append(bytes, &faces),
        "elements": append(bytes, &elements),
        "positions": append(bytes, &positions),
        "origin": quantiser.origin_m,
        "step": quantiser.step_m,
        "parts": fe.parts.iter().map(|p| json!([p.id, group_index(groups, &p.group)])).collect::<Vec<_>>(),
        "strain": strain.as_ref().map(|(max, block)| json!({ "max": max, "data": append(bytes, block) })),
    });
    (head, quantiser, strain.map(|s| s.0))
}

/// The largest strain and the packed changes of the 8 bit strains.
fn pack_strain(fe: &FeScene) -> Option<(f64, Vec<u8>)> {
    let frames: Vec<&Vec<f32>> = match &fe.plastic_strain {
        PlasticStrain::None => return None,
        PlasticStrain::Frames(list) => list.iter().collect(),
    };
    let max = frames.iter().copied().flatten().copied().filter(|v| v.is_finite()).fold(0.0_f32, f32::max);
    let scale = if max > 0.0 { 255.0 / max } else { 0.0 };
    let mut out = Vec::new();
    for element in 0..fe.elements.len() {
        let mut changes = Vec::new();
        let (mut last, mut last_frame) = (0_u8, 0);
        for (i, values) in frames.iter().enumerate() {
            let value = (values[element] * scale).round().clamp(0.0, 255.0) as u8; // NaN becomes 0
            if value != last {
                changes.push((i - last_frame, value));
                (last, last_frame) = (value, i);
            }
        }
        push_varint(&mut out, changes.len() as u32);
        for (frames, value) in changes {
            push_varint(&mut out, frames as u32);
            push_varint(&mut out, u32::from(value));
        }
    }
    Some((f64::from(max), out))
}

fn pack_mbs(mbs: &MbsScene, groups: &[(String, usize)], bytes: &mut Vec<u8>) -> Value {
    let mut poses = Vec::new();
    let mut last = vec![Pose::default(); mbs.bodies.len()];
    for frame in &mbs.frames {
        for (pose, last) in frame.iter().zip(&mut last) {
            if pose.position_m.iter().chain(&pose.orientation).all(|x| x.is_finite()) {
                *last = *pose;
            }
            for x in last.position_m.iter().chain(&last.orientation) {
                poses.extend_from_slice(&(*x as f32).to_le_bytes());
            }
        }
    }
    json!({
        "bodies": mbs.bodies.iter().map(|b| json!({
            "id": b.id, "group": group_index(groups, &b.group), "appears": b.appears_s, "removed": b.removed_s,
            "boxes": b.boxes.iter().map(|x| json!([x.center_m, x.half_extents_m])).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "fixed": solids(&mbs.fixed),
        "crushed": mbs.crushed.iter().map(|c| json!({
            "place": c.place, "axis": c.face.0, "sign": c.face.1, "depth": c.depth_m,
        })).collect::<Vec<_>>(),
        "poses": append(bytes, &poses),
        "compounds": mbs.compounds,
    })
}

/// The smallest box around finite points.
fn bounds(points: impl Iterator<Item = [f64; 3]>) -> Option<([f64; 3], [f64; 3])> {
    points.filter(|p| p.iter().all(|x| x.is_finite())).fold(None, |acc, p| {
        let (min, max) = acc.unwrap_or((p, p));
        Some((std::array::from_fn(|i| min[i].min(p[i])), std::array::from_fn(|i| max[i].max(p[i]))))
    })
}

/// What the camera looks at: the initial state and the middle 96 % of the final one.
fn view_box(scene: &Scene) -> ([f64; 3], [f64; 3]) {
    let mut points = Vec::new();
    let mut last = Vec::new();
    if let Some(fe) = &scene.fe {
        let wide = |f: &Vec<[f32; 3]>| f.iter().map(|p| p.map(f64::from)).collect::<Vec<_>>();
        points.extend(fe.frames_m.first().map(wide).unwrap_or_default());
        last.extend(fe.frames_m.last().map(wide).unwrap_or_default());
    }
    if let Some(mbs) = &scene.mbs {
        let centres = |f: &Vec<Pose>| f.iter().map(|p| p.position_m).collect::<Vec<_>>();
        if scene.fe.is_none() {
            points.extend(mbs.frames.first().map(|f| corners(mbs, f)).unwrap_or_default());
        }
        last.extend(mbs.frames.last().map(centres).unwrap_or_default());
    }
    let mut middle = [[0.0; 2]; 3];
    for (axis, range) in middle.iter_mut().enumerate() {
        let mut x: Vec<f64> = last.iter().map(|p| p[axis]).filter(|x| x.is_finite()).collect();
        x.sort_by(f64::total_cmp);
        if let Some(n) = x.len().checked_sub(1) {
            *range = [x[n * 2 / 100], x[n - n * 2 / 100]];
        }
    }
    if !last.is_empty() {
        points.extend([0, 1].map(|side| [middle[0][side], middle[1][side], middle[2][side]]));
    }
    bounds(points.into_iter()).unwrap_or(([-5.0, -5.0, 0.0], [5.0, 5.0, 5.0]))
}

fn corners(mbs: &MbsScene, poses: &[Pose]) -> Vec<[f64; 3]> {
    let mut out = Vec::new();
    for (body, pose) in mbs.bodies.iter().zip(poses) {
        for b in &body.boxes {
            for k in 0..8 {
                let local = std::array::from_fn(|i| {
                    b.center_m[i] + if k >> i & 1 == 1 { b.half_extents_m[i] } else { -b.half_extents_m[i] }
                });
                let turned = rotate(pose.orientation, local);
                out.push(std::array::from_fn(|i| pose.position_m[i] + turned[i]));
            }
        }
    }
    out
}

/// Rotates a vector by a unit quaternion: `v + 2 w (q × v) + 2 q × (q × v)`.
fn rotate([w, x, y, z]: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let t = cross([x, y, z], v).map(|c| 2.0 * c);
    let u = cross([x, y, z], t);
    std::array::from_fn(|i| v[i] + w * t[i] + u[i])
}

fn marker(site: &HingeSite, scene: &Scene) -> Value {
    let fe_node = scene.fe.as_ref().and_then(|fe| nearest_node(fe, &scene.time_s, site.point_m));
    let carrier = scene.mbs.as_ref().and_then(|mbs| {
        let named = site.body.as_ref().and_then(|id| mbs.bodies.iter().position(|b| &b.id == id));
        let lasting = |i: &usize| mbs.bodies[*i].removed_s.is_none();
        carrier(mbs, site.point_m, named, lasting)
    });
    json!({
        "label": site.member_end,
        "point": site.point_m,
        // without FE there is nothing that it could have evaluated
        "fe": site.fe_zone.or(scene.fe.is_none().then_some(false)), "feTime": site.fe_first_s,
        "mbs": site.mbs_hinge, "mbsTime": site.mbs_yielded_s, "slight": site.mbs_slight_s, "fractured": site.mbs_fractured_s,
        "latent": site.mbs_latent, "live": site.mbs_live_s,
        "gone": site.removed_s,
        "node": fe_node,
        "body": carrier.map(|c| c.0), "local": carrier.map(|c| c.1),
    })
}

/// A charge is carried by what is nearest in the first frame, also by what it takes away.
fn charge(charge: &SceneCharge, scene: &Scene) -> Value {
    let node = scene.fe.as_ref().and_then(|fe| nearest_node(fe, &scene.time_s, charge.point_m));
    let carrier = scene.mbs.as_ref().and_then(|mbs| carrier(mbs, charge.point_m, None, |_| true));
    json!({
        "label": charge.label, "what": charge.what, "point": charge.point_m, "time": charge.time_s,
        "node": node, "body": carrier.map(|c| c.0), "local": carrier.map(|c| c.1),
    })
}

/// Index (among the used nodes) of the node nearest to a point in the first frame; of equally near ones
/// the one that is needed longest, then the first.
fn nearest_node(fe: &FeScene, time_s: &[f64], point: [f64; 3]) -> Option<usize> {
    let first = fe.frames_m.first()?;
    let mut best: Option<(usize, f64, usize)> = None;
    for (i, (&node, &needed)) in used_nodes(fe, time_s).iter().enumerate() {
        let p = first[node as usize].map(f64::from);
        let d = distance(p, point);
        let nearer = best.is_none_or(|(_, b, n)| d < b - 1e-6 || (d < b + 1e-6 && needed > n));
        if nearer {
            best = Some((i, d, needed));
        }
    }
    best.map(|b| b.0)
}

/// The body that carries a marker, and the marker's place in the body frame: the named one, or the nearest of those that may.
fn carrier(
    mbs: &MbsScene,
    point_m: [f64; 3],
    named: Option<usize>,
    may: impl Fn(&usize) -> bool,
) -> Option<(usize, [f64; 3])> {
    let poses = mbs.frames.first()?;
    let local = |i: usize| {
        let ([w, x, y, z], p) = (poses[i].orientation, poses[i].position_m);
        rotate([w, -x, -y, -z], std::array::from_fn(|k| point_m[k] - p[k]))
    };
    if let Some(i) = named {
        return Some((i, local(i)));
    }
    let gap = |i: usize| {
        let at = local(i);
        let to = |b: &super::scene_input::BodyBox| {
            let d: [f64; 3] =
                std::array::from_fn(|k| ((at[k] - b.center_m[k]).abs() - b.half_extents_m[k]).max(0.0));
            distance(d, [0.0; 3])
        };
        mbs.bodies[i].boxes.iter().map(to).fold(f64::INFINITY, f64::min)
    };
    let nearest = (0..poses.len()).filter(may).min_by(|&a, &b| gap(a).total_cmp(&gap(b)))?;
    Some((nearest, local(nearest)))
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}
