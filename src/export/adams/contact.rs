//! Shapes as graphics, and contacts between them.
//!
//! Ground and planes are boxes that reach far beyond the model.

use super::Writer;
use super::joint::frame_with_z;
use super::statement::{GROUND, number};
use crate::mbs::math::{M3, V3, axpy, mul_t, qmat, sub};
use crate::mbs::model::{PairRule, Shape};
use std::collections::BTreeSet;

/// Penalty of a contact \[N/m\].
const PENALTY_N_M: f64 = 1e8;
/// Sliding speeds below which friction sticks and above which it is Coulomb's \[m/s\].
const SPEEDS_M_S: [f64; 2] = [0.001, 0.01];
/// How far ground and planes go beyond the bodies \[m\], and how thick they are \[m\].
const MARGIN_M: [f64; 2] = [50.0, 5.0];
/// Most contacts between bodies.
const MOST_PAIRS: usize = 5000;

/// A shape: its partner's name in rules, its number.
struct Geometry {
    owner: String,
    number: usize,
}

impl Writer<'_> {
    pub(super) fn contacts(&mut self) {
        let c = &self.model.contact;
        if c.ground.is_none() && c.planes.is_empty() && c.obstacles.is_empty() && c.bodies.is_none() {
            return;
        }
        self.data.section("SHAPES");
        let mut count = 0;
        let moving = self.moving(&mut count);
        let fixed = self.fixed(&mut count);
        self.data.section("CONTACTS");
        let mut contacts = 0;
        let joined = self.joined();
        for (own, [friction, restitution]) in &fixed {
            for body in &moving {
                let on_ground =
                    own.owner == "ground" && joined.contains(&(String::new(), body.owner.clone()));
                self.contact(&mut contacts, [body, own], [*friction, *restitution], on_ground);
            }
        }
        let Some(bodies) = &c.bodies else { return };
        let pairs = moving.len() * moving.len().saturating_sub(1) / 2;
        if pairs > MOST_PAIRS {
            let text = format!(
                "contact between bodies is left out: {pairs} pairs, at most {MOST_PAIRS} are written"
            );
            self.notes.add("contact.bodies", text);
            return;
        }
        for (i, a) in moving.iter().enumerate() {
            for b in moving[i + 1..].iter().filter(|b| b.owner != a.owner) {
                let [x, y] = if a.owner < b.owner { [a, b] } else { [b, a] };
                let keeps = joined.contains(&(x.owner.clone(), y.owner.clone()));
                self.contact(&mut contacts, [a, b], [bodies.friction, bodies.restitution], keeps);
            }
        }
    }

    /// Shapes of bodies.
    fn moving(&mut self, count: &mut usize) -> Vec<Geometry> {
        let mut list = Vec::new();
        for (i, body) in self.model.bodies.iter().enumerate() {
            for (k, shape) in body.shapes.iter().enumerate() {
                let name = format!("{}_{}", body.id, k + 1);
                let written = match shape {
                    Shape::Box { center_m, half_extents_m, orientation } => {
                        let turn = qmat(orientation.unwrap_or([1.0, 0.0, 0.0, 0.0]));
                        // a box has its marker in a corner
                        let rows = crate::mbs::math::transpose(&turn);
                        let corner = sub(*center_m, crate::mbs::math::mul(&turn, *half_extents_m));
                        let marker = self.data.marker(i + 2, corner, Some(&rows));
                        Some(box_arguments(marker, half_extents_m.map(|h| 2.0 * h)))
                    }
                    Shape::Sphere { center_m, radius_m } => {
                        let marker = self.data.marker(i + 2, *center_m, None);
                        // scales of an ellipsoid are its diameters
                        let scales = ["XSCALE", "YSCALE", "ZSCALE"].map(|s| number(s, 2.0 * radius_m));
                        let mut arguments = vec!["ELLIPSOID".to_string(), format!("CM = {marker}")];
                        arguments.extend(scales);
                        Some(arguments)
                    }
                    Shape::Hull { .. } => None,
                };
                let Some(arguments) = written else {
                    self.notes
                        .add(&body.id, format!("shape {} is left out: a dataset has no convex hulls", k + 1));
                    continue;
                };
                *count += 1;
                self.data.named("GRAPHICS", *count, &name, &arguments);
                list.push(Geometry { owner: body.id.clone(), number: *count });
            }
        }
        list
    }

    /// Surfaces that do not move, with friction and restitution.
    fn fixed(&mut self, count: &mut usize) -> Vec<(Geometry, [f64; 2])> {
        let c = &self.model.contact;
        let mut list = Vec::new();
        let mut half_spaces = Vec::new();
        half_spaces.extend(c.ground.as_ref().map(|g| {
            ("ground".to_string(), [0.0, 0.0, g.level_m], [0.0, 0.0, 1.0], [g.friction, g.restitution])
        }));
        half_spaces.extend(
            c.planes.iter().map(|p| (p.id.clone(), p.point_m, p.normal, [p.friction, p.restitution])),
        );
        for (id, point, normal, surface) in half_spaces {
            let frame = frame_with_z(normal);
            let (corner, size) = self.half_space(point, &frame);
            self.surface(&mut list, count, &id, (corner, Some(&frame), size), surface);
        }
        for o in &c.obstacles {
            let size = sub(o.max_m, o.min_m);
            self.surface(&mut list, count, &o.id, (o.min_m, None, size), [o.friction, o.restitution]);
        }
        list
    }

    fn surface(
        &mut self,
        list: &mut Vec<(Geometry, [f64; 2])>,
        count: &mut usize,
        id: &str,
        (corner, frame, size): (V3, Option<&M3>, V3),
        surface: [f64; 2],
    ) {
        let marker = self.data.marker(GROUND, corner, frame);
        *count += 1;
        self.data.named("GRAPHICS", *count, id, &box_arguments(marker, size));
        list.push((Geometry { owner: id.into(), number: *count }, surface));
    }

    /// A box below a plane: its lower corner \[m\] and its edges.
    fn half_space(&self, point: V3, frame: &M3) -> (V3, V3) {
        let [margin, depth] = MARGIN_M;
        let seen: Vec<V3> = self
            .model
            .bodies
            .iter()
            .map(|b| crate::mbs::math::mul(frame, sub(b.position_m, point)))
            .collect();
        let end = |k: usize, sign: f64| seen.iter().map(|p| sign * p[k]).fold(0.0, f64::max);
        // as high as the bodies may fall, so far they may go sideways
        let reach = margin + end(2, 1.0);
        let low: V3 = [-end(0, -1.0) - reach, -end(1, -1.0) - reach, -depth];
        let size = [end(0, 1.0) + reach - low[0], end(1, 1.0) + reach - low[1], depth];
        (axpy(point, 1.0, mul_t(frame, low)), size)
    }

    fn joined(&self) -> BTreeSet<(String, String)> {
        let m = self.model;
        let joints = m.joints.iter().map(|j| (j.body_a.clone(), j.body_b.clone()));
        let bushings = m.bushings.iter().map(|j| (j.body_a.clone(), j.body_b.clone()));
        let all = joints.chain(bushings).map(|(a, b)| (a.unwrap_or_default(), b));
        all.map(|(a, b)| if a <= b { (a, b) } else { (b, a) }).collect()
    }

    fn contact(&mut self, count: &mut usize, [a, b]: [&Geometry; 2], surface: [f64; 2], joined: bool) {
        let same = |r: &&PairRule| (r.a == a.owner && r.b == b.owner) || (r.a == b.owner && r.b == a.owner);
        let rule = self.model.contact.pairs.iter().rev().find(same);
        if rule.map_or(joined, |r| r.ignore) {
            return;
        }
        let friction = rule.and_then(|r| r.friction).unwrap_or(surface[0]);
        let restitution = rule.and_then(|r| r.restitution).unwrap_or(surface[1]);
        *count += 1;
        let mut arguments = vec![
            format!("IGEOM = {}", a.number),
            format!("JGEOM = {}", b.number),
            "POISSON".into(),
            number("PENALTY", PENALTY_N_M),
            number("RESTITUTION_COEFFICIENT", restitution),
        ];
        if friction > 0.0 {
            arguments.extend([
                "COULOMB_FRICTION = ON".into(),
                number("MU_STATIC", friction),
                number("MU_DYNAMIC", friction),
                number("STICTION_TRANSITION_VELOCITY", SPEEDS_M_S[0]),
                number("FRICTION_TRANSITION_VELOCITY", SPEEDS_M_S[1]),
            ]);
        }
        let name = format!("{}_{}_{count}", a.owner, b.owner);
        self.data.named("CONTACT", *count, &name, &arguments);
    }
}

fn box_arguments(marker: usize, size: V3) -> Vec<String> {
    let [x, y, z] = size;
    vec!["BOX".into(), format!("CORNER = {marker}"), number("X", x), number("Y", y), number("Z", z)]
}
