//! Checks of joints, bushings and forces.

use super::{List, ORTHONORMAL_TOLERANCE, closest, orthonormality_error};
use crate::mbs::latent::held_together;
use crate::mbs::math;
use crate::mbs::model::{
    Beam, Bending, Bushing, CarryOver, Force, Joint, JointKind, Model, OBLIQUE, RateFactor,
};
use std::collections::{BTreeMap, BTreeSet};

/// Share of its free length below which the ends of a spring are one point: rounding gives it a direction.
const LEAST_LENGTH: f64 = 1e-9;

/// Shear capacity at least \[N\].
const LEAST_SHEAR_N: f64 = 1e-6;

/// Ids of bodies.
type Known<'a> = BTreeSet<&'a str>;

/// What is asked of all bushings to check what one of them carries over to.
struct Members<'a> {
    ids: BTreeSet<&'a str>,
    by_id: BTreeMap<&'a str, &'a Bushing>,
    /// Places of the bushings that name one as the other end of their member.
    named: BTreeMap<&'a str, Vec<usize>>,
    /// Bodies that latent bushings hold together have the same number.
    held: BTreeMap<&'a str, usize>,
}

impl<'a> Members<'a> {
    fn of(model: &'a Model) -> Self {
        let mut named: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (i, bushing) in model.bushings.iter().enumerate() {
            if let Some(carry) = &bushing.carry_over {
                named.entry(&carry.bushing).or_default().push(i);
            }
        }
        let ids = model.bushings.iter().map(|b| b.id.as_str()).collect();
        // of equal ids, which are a mistake of their own, the first one counts
        let by_id = model.bushings.iter().rev().map(|b| (b.id.as_str(), b)).collect();
        let latent: Vec<bool> = model.bushings.iter().map(|b| b.latent.is_some()).collect();
        let held = match latent.contains(&true) {
            true => model.bodies.iter().map(|b| b.id.as_str()).zip(held_together(model, &latent)).collect(),
            false => BTreeMap::new(),
        };
        Self { ids, by_id, named, held }
    }

    /// Whether latent bushings hold two bodies together.
    fn are_one(&self, a: &str, b: &str) -> bool {
        self.held.get(a).zip(self.held.get(b)).is_some_and(|(a, b)| a == b)
    }
}

pub(super) fn check(model: &Model, known: &Known<'_>, list: &mut List) {
    for (i, joint) in model.joints.iter().enumerate() {
        check_joint(joint, &format!("joints[{i}]"), known, list);
    }
    let mut hinges: BTreeMap<&str, usize> = BTreeMap::new();
    model.bushings.iter().flat_map(Bushing::hinges).for_each(|name| *hinges.entry(name).or_default() += 1);
    let members = Members::of(model);
    let is_own = |name: &str| hinges.get(name) == Some(&1) && !members.ids.contains(name);
    for (i, bushing) in model.bushings.iter().enumerate() {
        let path = format!("bushings[{i}]");
        check_bushing(model, bushing, &path, known, list);
        if let Some(carry) = &bushing.carry_over {
            check_carry_over(model, (i, bushing), carry, &members, &format!("{path}.carry_over"), list);
        }
        if let Some(beam) = &bushing.beam {
            check_beam(model, bushing, beam, &format!("{path}.beam"), &is_own, list);
        }
    }
    for (i, force) in model.forces.iter().enumerate() {
        check_force(model, force, &format!("forces[{i}]"), known, list);
    }
}

/// Bodies that exist and are two.
fn check_bodies(a: Option<&str>, b: &str, path: &str, known: &Known<'_>, list: &mut List) {
    if let Some(a) = a {
        list.known(known, a, &format!("{path}.body_a"));
        list.require(a != b, &format!("{path}.body_b"), || {
            format!("is \"{a}\", the same as body_a; expected two different bodies")
        });
    }
    list.known(known, b, &format!("{path}.body_b"));
}

fn check_joint(joint: &Joint, path: &str, known: &Known<'_>, list: &mut List) {
    use JointKind::{Cylindrical, Planar, PointOnLine, Prismatic, Revolute, Rod, Universal};
    check_bodies(joint.body_a.as_deref(), &joint.body_b, path, known, list);
    list.place(&format!("{path}.point_m"), &joint.point_m);
    let needs_axis =
        matches!(joint.kind, Revolute | Universal | Cylindrical | Prismatic | Planar | PointOnLine);
    list.there(joint.axis.is_some(), needs_axis, &format!("{path}.axis"), "a vector", joint.kind);
    list.there(
        joint.axis_b.is_some(),
        joint.kind == Universal,
        &format!("{path}.axis_b"),
        "a vector",
        joint.kind,
    );
    list.there(
        joint.point_b_m.is_some(),
        joint.kind == Rod,
        &format!("{path}.point_b_m"),
        "a point",
        joint.kind,
    );
    for (name, axis) in [("axis", joint.axis), ("axis_b", joint.axis_b)] {
        if let Some(axis) = axis {
            list.direction(&format!("{path}.{name}"), axis);
        }
    }
    if let Some(cosine) = joint.cosine() {
        list.require(cosine.abs() <= OBLIQUE, &format!("{path}.axis_b"), || {
            format!("is not at a right angle to axis (cosine {cosine:.1e}, at most {OBLIQUE:.0e}); turn the joint's bodies or give the axis across")
        });
    }
    if let (Rod, Some(b)) = (joint.kind, joint.point_b_m) {
        list.place(&format!("{path}.point_b_m"), &b);
        list.require(math::norm(math::sub(b, joint.point_m)) > 0.0, &format!("{path}.point_b_m"), || {
            "is the same as point_m: a rod needs a length; use a spherical joint".into()
        });
    }
}

fn check_bushing(model: &Model, joint: &Bushing, path: &str, known: &Known<'_>, list: &mut List) {
    check_bodies(joint.body_a.as_deref(), &joint.body_b, path, known, list);
    list.place(&format!("{path}.point_m"), &joint.point_m);
    let off = orthonormality_error(&joint.axes);
    list.require(off <= ORTHONORMAL_TOLERANCE, &format!("{path}.axes"), || {
        format!("rows are not orthonormal and right-handed (off by {off:.1e}, allowed {ORTHONORMAL_TOLERANCE:.0e})")
    });
    list.not_negative(&format!("{path}.axial_stiffness_n_m"), joint.axial_stiffness_n_m);
    for k in 0..2 {
        list.not_negative(&format!("{path}.shear_stiffness_n_m[{k}]"), joint.shear_stiffness_n_m[k]);
        let at = format!("{path}.bending[{k}]");
        match &joint.bending[k] {
            Bending::Elastic { stiffness_nm_rad } => {
                list.not_negative(&format!("{at}.stiffness_nm_rad"), *stiffness_nm_rad);
            }
            Bending::Curve { curve, strength_factor } => {
                list.require(model.curves.contains_key(curve), &format!("{at}.curve"), || {
                    format!(
                        "\"{curve}\" is not in curves{}",
                        closest(curve, model.curves.keys().map(String::as_str))
                    )
                });
                list.positive(&format!("{at}.strength_factor"), *strength_factor);
            }
        }
    }
    list.not_negative(&format!("{path}.torsional_stiffness_nm_rad"), joint.torsional_stiffness_nm_rad);
    if let Some(t) = joint.crushing_shortening_m {
        let path = format!("{path}.crushing_shortening_m");
        list.positive(&path, t);
        list.without_ideal(model, &path);
    }
    if let Some(capacity) = joint.shear_capacity_n {
        let path = format!("{path}.shear_capacity_n");
        for (k, c) in capacity.iter().enumerate() {
            list.require(*c >= LEAST_SHEAR_N && c.is_finite(), &format!("{path}[{k}]"), || {
                format!(
                    "is {c:e}, expected at least {LEAST_SHEAR_N:e} N: a slip of the exponent or the unit?"
                )
            });
        }
        list.without_ideal(model, &path);
        list.require(joint.joint.is_none(), &path, || {
            "needs the shear springs of the bushing, but a joint holds its point: leave out one of both"
                .into()
        });
    }
    if let Some(slip) = joint.shear_slip_m {
        let path = format!("{path}.shear_slip_m");
        list.positive(&path, slip);
        list.require(joint.shear_capacity_n.is_some(), &path, || {
            "needs a shear_capacity_n at which the bushing slips; leave out one or give both".into()
        });
        list.require(joint.latent.is_none() && joint.beam.is_none(), &path, || {
            "is for bushings that are neither latent nor in the middle of a beam: leave it out".into()
        });
    }
    if let Some(factor) = &joint.rate_factor {
        check_rate_factor(model, joint, factor, &format!("{path}.rate_factor"), list);
    }
    if let Some(t) = joint.tensile_elongation_m {
        list.not_negative(&format!("{path}.tensile_elongation_m"), t);
        list.require(joint.tensile_capacity_n.is_some(), &format!("{path}.tensile_elongation_m"), || {
            "needs a tensile_capacity_n at which the bushing stretches; leave out one or give both".into()
        });
    }
    if let Some(t) = joint.tensile_capacity_n {
        list.not_negative(&format!("{path}.tensile_capacity_n"), t);
    }
    if let Some(c) = joint.compressive_capacity_n {
        list.positive(&format!("{path}.compressive_capacity_n"), c);
    }
    check_hardening(model, joint, &format!("{path}.compressive_hardening"), list);
    check_fading(model, joint, &format!("{path}.compressive_fading"), list);
    if let Some(id) = &joint.joint {
        check_held(model, joint, id, path, list);
    }
}

/// Shares of the compressive capacity over plastic shortening.
fn check_hardening(model: &Model, bushing: &Bushing, path: &str, list: &mut List) {
    let points = &bushing.compressive_hardening;
    let [Some(first), Some(last)] = [points.first(), points.last()] else { return };
    let grows = points.windows(2).all(|p| p[1][0] > p[0][0] && p[1][1] >= p[0][1]);
    let is_sound = first[0] == 0.0 && first[1] > 0.0 && last[1] <= 1.0 && last[0].is_finite() && grows;
    list.require(is_sound, path, || {
        format!("is {points:?}, expected plastic shortenings that grow from 0 and shares above 0 that do not fall, up to 1")
    });
    list.require(bushing.compressive_capacity_n.is_some() && bushing.joint.is_none(), path, || {
        "needs compressive_capacity_n, and no joint that holds the point: leave it out".into()
    });
    list.without_ideal(model, path);
}

/// Shares of the compressive capacity that are left over plastic rotation.
fn check_fading(model: &Model, bushing: &Bushing, path: &str, list: &mut List) {
    let points = &bushing.compressive_fading;
    let [Some(first), Some(last)] = [points.first(), points.last()] else { return };
    let fades = points.windows(2).all(|p| p[1][0] > p[0][0] && p[1][1] <= p[0][1]);
    let is_sound = *first == [0.0, 1.0] && last[1] > 0.0 && last[0].is_finite() && fades;
    list.require(is_sound, path, || {
        format!("is {points:?}, expected plastic rotations that grow from 0 and shares above 0 that do not grow, from 1 on")
    });
    let has_hinge = bushing.bending.iter().any(|b| b.curve().is_some()) && bushing.beam.is_none();
    list.require(
        bushing.compressive_capacity_n.is_some() && bushing.joint.is_none() && has_hinge,
        path,
        || "needs compressive_capacity_n and a curve about axis 1 or 2, no beam, and no joint that holds the point: leave it out".into(),
    );
    list.without_ideal(model, path);
}

/// A member between two bushings is body `b` of both, and bends about the same axes at both.
fn check_carry_over(
    model: &Model,
    (own, bushing): (usize, &Bushing),
    carry: &CarryOver,
    members: &Members<'_>,
    path: &str,
    list: &mut List,
) {
    list.without_ideal(model, path);
    let at = format!("{path}.bushing");
    list.among(&members.ids, &carry.bushing, &at, "a bushing");
    let Some(other) = members.by_id.get(carry.bushing.as_str()) else { return };
    let is_one = other.body_b == bushing.body_b || members.are_one(&other.body_b, &bushing.body_b);
    list.require(other.id != bushing.id && is_one, &at, || {
        format!(
            "\"{}\" is not at the other end of \"{}\", expected a bushing with the same body_b, or one that latent bushings hold to it",
            other.id, bushing.body_b
        )
    });
    let named = [&other.id, &bushing.id].map(|id| members.named.get(id.as_str()));
    let third = named.into_iter().flatten().flatten().filter(|i| **i != own).min();
    if let Some(third) = third.map(|i| &model.bushings[*i]) {
        list.require(false, &at, || {
            format!("\"{}\" carries over to one of both already: leave out one of them", third.id)
        });
    }
    let plain = |b: &Bushing| b.beam.is_none() && b.joint.is_none() && b.latent.is_none();
    list.require(plain(bushing) && plain(other), path, || {
        "stands between bushings of which one is latent, on a joint or in the middle of a beam".into()
    });
    for k in [1, 2] {
        let cosine = math::dot(bushing.axes[k], other.axes[k]);
        list.require((cosine.abs() - 1.0).abs() <= ORTHONORMAL_TOLERANCE, &at, || {
            format!(
                "axis {k} of \"{}\" is not parallel to that of this bushing (cosine {cosine:.3})",
                other.id
            )
        });
    }
    for (k, d) in carry.flexibility_rad_nm.into_iter().enumerate() {
        list.not_negative(&format!("{path}.flexibility_rad_nm[{k}]"), d);
    }
}

/// A bushing whose point an ideal joint holds.
fn check_held(model: &Model, bushing: &Bushing, id: &str, path: &str, list: &mut List) {
    use JointKind::{Revolute, Spherical, Universal};
    let joints: BTreeSet<&str> = model.joints.iter().map(|j| j.id.as_str()).collect();
    list.among(&joints, id, &format!("{path}.joint"), "an ideal joint");
    if let Some(joint) = model.joints.iter().find(|j| j.id == id) {
        let same = joint.body_a == bushing.body_a && joint.body_b == bushing.body_b;
        list.require(same, &format!("{path}.joint"), || {
            format!("\"{id}\" has other bodies, expected the same body_a and body_b as the bushing's")
        });
        let holds = matches!(joint.kind, Spherical | Revolute | Universal);
        list.require(holds, &format!("{path}.joint"), || {
            format!("\"{id}\" does not hold a point and leave it turning, expected a spherical, revolute or universal joint")
        });
    }
    let [s1, s2] = bushing.shear_stiffness_n_m;
    let stiff = [
        ("axial_stiffness_n_m", bushing.axial_stiffness_n_m),
        ("shear_stiffness_n_m[0]", s1),
        ("shear_stiffness_n_m[1]", s2),
    ];
    for (name, k) in stiff {
        list.require(k == 0.0, &format!("{path}.{name}"), || {
            format!("is {k}, expected 0: joint \"{id}\" holds the point")
        });
    }
    let flows = [
        ("tensile_elongation_m", bushing.tensile_elongation_m),
        ("compressive_capacity_n", bushing.compressive_capacity_n),
        ("crushing_shortening_m", bushing.crushing_shortening_m),
    ];
    for (name, value) in flows {
        list.require(value.is_none(), &format!("{path}.{name}"), || {
            format!("has no meaning: joint \"{id}\" neither stretches nor crushes; leave it out")
        });
    }
    list.require(!bushing.associated_flow, &format!("{path}.associated_flow"), || {
        format!("has no meaning: joint \"{id}\" does not shorten; leave it out")
    });
}

fn check_rate_factor(model: &Model, bushing: &Bushing, factor: &RateFactor, path: &str, list: &mut List) {
    let RateFactor { rotation_rad_s, elongation_m_s, exponent } = factor;
    for (k, rate) in rotation_rad_s.iter().enumerate() {
        list.positive(&format!("{path}.rotation_rad_s[{k}]"), *rate);
    }
    if let Some(rate) = elongation_m_s {
        list.positive(&format!("{path}.elongation_m_s"), *rate);
    }
    list.rate_exponent(&format!("{path}.exponent"), *exponent);
    list.require(bushing.flows(), path, || {
        "has nothing to act on: the bushing has no curve and does not flow along itself; leave it out".into()
    });
    list.require(elongation_m_s.is_none() || bushing.flows_along(), &format!("{path}.elongation_m_s"), || {
        "has nothing to act on: the bushing has no compressive_capacity_n, and no tensile_capacity_n with a \
         tensile_elongation_m; leave it out"
            .into()
    });
    list.without_ideal(model, path);
}

fn check_force(model: &Model, force: &Force, path: &str, known: &Known<'_>, list: &mut List) {
    match force {
        Force::Spring {
            body_a,
            body_b,
            point_a_m,
            point_b_m,
            length_m,
            stiffness_n_m,
            damping_n_s_m,
            ..
        } => {
            check_bodies(body_a.as_deref(), body_b, path, known, list);
            list.place(&format!("{path}.point_a_m"), point_a_m);
            list.place(&format!("{path}.point_b_m"), point_b_m);
            if let Some(length) = length_m {
                list.not_negative(&format!("{path}.length_m"), *length);
                let apart = math::norm(math::sub(*point_b_m, *point_a_m));
                let is_point = *stiffness_n_m > 0.0 && apart < LEAST_LENGTH * *length;
                list.require(!is_point, &format!("{path}.point_b_m"), || {
                    format!("is at point_a_m: a spring of {length} m that begins at {apart:e} m has no direction; move one of its points")
                });
            }
            list.not_negative(&format!("{path}.stiffness_n_m"), *stiffness_n_m);
            list.not_negative(&format!("{path}.damping_n_s_m"), *damping_n_s_m);
        }
        Force::Torsion { body_a, body_b, axis, stiffness_nm_rad, damping_nm_s_rad, .. } => {
            check_bodies(body_a.as_deref(), body_b, path, known, list);
            list.direction(&format!("{path}.axis"), *axis);
            list.not_negative(&format!("{path}.stiffness_nm_rad"), *stiffness_nm_rad);
            list.not_negative(&format!("{path}.damping_nm_s_rad"), *damping_nm_s_rad);
        }
        Force::Hinge { body_a, body_b, stiffness_nm_rad, capacity, fracture_rad, joint, .. } => {
            check_bodies(body_a.as_deref(), body_b, path, known, list);
            list.positive(&format!("{path}.stiffness_nm_rad"), *stiffness_nm_rad);
            check_capacity(capacity, &format!("{path}.capacity"), list);
            if let Some(f) = fracture_rad {
                list.positive(&format!("{path}.fracture_rad"), *f);
            }
            if let Some(joint) = joint {
                let joints: BTreeSet<&str> = model.joints.iter().map(|j| j.id.as_str()).collect();
                list.among(&joints, joint, &format!("{path}.joint"), "an ideal joint");
                if let Some(opened) = model.joints.iter().find(|j| j.id == *joint) {
                    let ends = |a: &Option<String>, b: &String| BTreeSet::from([a.clone(), Some(b.clone())]);
                    let same = ends(&opened.body_a, &opened.body_b) == ends(body_a, body_b);
                    list.require(same, &format!("{path}.joint"), || {
                        format!(
                            "\"{joint}\" joins other bodies, expected one between the two bodies of the hinge"
                        )
                    });
                }
            }
        }
        Force::Force { body, point_m, force_n, from_to_s, .. } => {
            list.known(known, body, &format!("{path}.body"));
            list.place(&format!("{path}.point_m"), point_m);
            list.finite(&format!("{path}.force_n"), force_n);
            check_span(*from_to_s, path, list);
        }
        Force::Torque { body, torque_nm, from_to_s, .. } => {
            list.known(known, body, &format!("{path}.body"));
            list.finite(&format!("{path}.torque_nm"), torque_nm);
            check_span(*from_to_s, path, list);
        }
    }
}

fn check_span(span: Option<[f64; 2]>, path: &str, list: &mut List) {
    if let Some([from, to]) = span {
        list.require(from.is_finite() && to > from, &format!("{path}.from_to_s"), || {
            format!("is [{from}, {to}], expected two times, the later one second")
        });
    }
}

fn check_capacity(points: &[[f64; 2]], path: &str, list: &mut List) {
    list.require(points.first().is_some_and(|p| p[0] == 0.0), path, || {
        "does not begin at a rotation of 0, expected [[0, capacity], [rotation, capacity], ...]".into()
    });
    for (i, p) in points.iter().enumerate() {
        list.not_negative(&format!("{path}[{i}][1]"), p[1]);
        let rises = i == 0 || p[0] > points[i - 1][0];
        list.require(rises && p[0].is_finite(), &format!("{path}[{i}][0]"), || {
            format!("is {}, expected above the rotation before it", p[0])
        });
    }
}

impl List {
    /// A value that is there exactly if it is needed.
    fn there(&mut self, is_there: bool, needed: bool, path: &str, what: &str, kind: JointKind) {
        let name = serde_json::to_value(kind).ok().and_then(|v| v.as_str().map(str::to_string));
        let name = name.unwrap_or_default();
        self.require(is_there || !needed, path, || format!("is missing: a {name} joint needs {what} here"));
        self.require(needed || !is_there, path, || {
            format!("has no meaning for a {name} joint; leave it out")
        });
    }

    /// What models with ideal joints and forces know nothing of.
    pub(super) fn without_ideal(&mut self, model: &Model, path: &str) {
        self.require(!model.is_ideal(), path, || {
            "needs a model without ideal joints and forces: leave it out".into()
        });
    }

    /// A vector of finite numbers and some length.
    pub(super) fn direction(&mut self, path: &str, v: [f64; 3]) {
        let length = math::norm(v);
        self.require(length > 0.0 && length.is_finite(), path, || {
            format!("is {v:?}, expected a vector with a direction")
        });
    }
}

/// A beam needs one axis with a curve, shear stiffness along the other, and names of its own.
fn check_beam(
    model: &Model,
    bushing: &Bushing,
    beam: &Beam,
    path: &str,
    is_own: &dyn Fn(&str) -> bool,
    list: &mut List,
) {
    list.positive(&format!("{path}.half_length_m"), beam.half_length_m);
    let curves: Vec<usize> = (0..2).filter(|k| bushing.bending[*k].curve().is_some()).collect();
    list.require(curves.len() == 1, path, || {
        format!(
            "has {} bending axes with a curve, expected one: that in whose plane its ends are hinges",
            curves.len()
        )
    });
    // bending about axis 1 goes with shear along axis 2
    if let [k] = curves[..] {
        list.require(bushing.shear_stiffness_n_m[1 - k] > 0.0, path, || {
            format!("needs shear_stiffness_n_m[{}] > 0: the ends take their moments from it as well", 1 - k)
        });
    }
    if let Some(span) = &beam.span {
        list.not_negative(&format!("{path}.span.mass_kg_m"), span.mass_kg_m);
        list.require(span.length_m >= 2.0 * beam.half_length_m, &format!("{path}.span.length_m"), || {
            format!(
                "is {} m, expected at least {} m, which is between the hinges",
                span.length_m,
                2.0 * beam.half_length_m
            )
        });
    }
    list.require(bushing.latent.is_none() && bushing.joint.is_none(), path, || {
        "stands in a bushing that is latent or on a joint: leave out one of them".into()
    });
    list.require(!model.is_ideal(), path, || {
        "needs a model without ideal joints and forces: leave it out, the curve then stands at the bushing's point".into()
    });
    for (k, name) in beam.ends.iter().enumerate() {
        list.require(is_own(name), &format!("{path}.ends[{k}]"), || {
            format!("\"{name}\" is the name of another hinge or bushing, expected one of its own")
        });
    }
}
