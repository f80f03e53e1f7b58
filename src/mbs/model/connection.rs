//! What connects bodies: ideal joints, compliant bushings, forces.

use super::Origin;
use crate::mbs::math;
use serde::{Deserialize, Serialize};

/// An ideal joint between body `a` (or the ground) and body `b`, assembled in the initial poses of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Unique id.
    pub id: String,
    /// What it leaves free.
    pub kind: JointKind,
    /// First body; `None` is the ground.
    #[serde(default)]
    pub body_a: Option<String>,
    /// Second body.
    pub body_b: String,
    /// The joint point in the global frame, initial pose \[m\]; of a rod its end on body `a`.
    pub point_m: [f64; 3],
    /// The end of a rod on body `b`; for rods only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point_b_m: Option<[f64; 3]>,
    /// Axis of the joint in the global frame, initial pose, of any length: of rotation (revolute, cylindrical), of sliding (prismatic,
    /// cylindrical, point on line), across the plane (planar), on body `a` (universal).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<[f64; 3]>,
    /// Axis of a universal joint on body `b`, at a right angle to `axis`; a cosine of up to [`OBLIQUE`] between them is taken for none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis_b: Option<[f64; 3]>,
    /// Provenance.
    #[serde(default)]
    pub origin: Origin,
}

/// Cosine of the angle between the axes of a universal joint that is taken for a right angle: those of drawings are rounded.
pub const OBLIQUE: f64 = 1e-3;
/// Cosine from which that is worth a word.
const SQUARE: f64 = 1e-6;

impl Joint {
    /// Cosine of the angle between the axes of a universal joint; none for others.
    pub fn cosine(&self) -> Option<f64> {
        let (a, b) = self.axis.zip(self.axis_b).filter(|_| self.kind == JointKind::Universal)?;
        Some(math::dot(a, b) / (math::norm(a) * math::norm(b)))
    }

    /// What is taken for the second axis of a universal joint whose axes are not quite at a right angle: the part of it across the first one.
    pub fn squared_axis_b(&self) -> Option<[f64; 3]> {
        self.cosine().filter(|cosine| cosine.abs() > SQUARE)?;
        let (a, b) = self.axis.zip(self.axis_b)?;
        Some(math::axpy(b, -math::dot(a, b) / math::dot(a, a), a))
    }
}

/// What an ideal joint leaves free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// Rotation about all axes.
    Spherical,
    /// Rotation about the axis.
    Revolute,
    /// Rotation about the axis of body `a` and that of body `b`.
    Universal,
    /// Rotation about the axis and sliding along it.
    Cylindrical,
    /// Sliding along the axis.
    Prismatic,
    /// Nothing.
    Fixed,
    /// Sliding across the axis and rotation about it.
    Planar,
    /// Sliding of the point of body `b` along the axis of body `a`, all rotations.
    PointOnLine,
    /// All but the distance of two points: a rod without mass.
    Rod,
}

/// A spring, damper, hinge, or applied force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Force {
    /// Between two points: `k (l - l_0) + d l'`, pulling.
    Spring {
        /// Unique id.
        id: String,
        /// First body; `None` is the ground.
        #[serde(default)]
        body_a: Option<String>,
        /// Second body.
        body_b: String,
        /// Its point on the first body, global frame, initial pose \[m\].
        point_a_m: [f64; 3],
        /// Its point on the second body.
        point_b_m: [f64; 3],
        /// Length without force \[m\]; `None`: that of the initial pose.
        #[serde(default)]
        length_m: Option<f64>,
        /// Stiffness \[N/m\].
        stiffness_n_m: f64,
        /// Damping \[N s/m\].
        #[serde(default)]
        damping_n_s_m: f64,
    },
    /// About an axis that both bodies carry: `k θ + d θ'` against the turn of the second body about it since the initial pose, revolutions counted.
    Torsion {
        /// Unique id.
        id: String,
        /// First body; `None` is the ground.
        #[serde(default)]
        body_a: Option<String>,
        /// Second body.
        body_b: String,
        /// Axis in the global frame, initial pose, of any length.
        axis: [f64; 3],
        /// Stiffness \[N m/rad\].
        stiffness_nm_rad: f64,
        /// Damping \[N m s/rad\].
        #[serde(default)]
        damping_nm_s_rad: f64,
    },
    /// Moments about three axes of the first body, each elastic up to a capacity that depends on the largest rotation about its axis so far;
    /// rotations are the components of the rotation vector of the second body against the first since the initial pose, revolutions about one axis counted.
    Hinge {
        /// Unique id.
        id: String,
        /// First body; `None` is the ground.
        #[serde(default)]
        body_a: Option<String>,
        /// Second body.
        body_b: String,
        /// Elastic stiffness \[N m/rad\].
        stiffness_nm_rad: f64,
        /// `[largest rotation (rad), capacity (N m)]` from zero, straight in between; the last capacity beyond.
        capacity: Vec<[f64; 2]>,
        /// Length of the rotation vector at which it fractures \[rad\]; `None`: never.
        #[serde(default)]
        fracture_rad: Option<f64>,
        /// Joint that opens when it fractures.
        #[serde(default)]
        joint: Option<String>,
    },
    /// A force at a point of a body, constant in the global frame, while it acts.
    Force {
        /// Unique id.
        id: String,
        /// The body.
        body: String,
        /// Its point, global frame, initial pose \[m\].
        point_m: [f64; 3],
        /// Force \[N\].
        force_n: [f64; 3],
        /// When it acts \[s\]; `None`: always.
        #[serde(default)]
        from_to_s: Option<[f64; 2]>,
    },
    /// A torque on a body, constant in the global frame, while it acts.
    Torque {
        /// Unique id.
        id: String,
        /// The body.
        body: String,
        /// Torque \[N m\].
        torque_nm: [f64; 3],
        /// When it acts \[s\]; `None`: always.
        #[serde(default)]
        from_to_s: Option<[f64; 2]>,
    },
}

impl Force {
    /// Its id.
    pub fn id(&self) -> &str {
        match self {
            Self::Spring { id, .. }
            | Self::Torsion { id, .. }
            | Self::Hinge { id, .. }
            | Self::Force { id, .. }
            | Self::Torque { id, .. } => id,
        }
    }

    /// The joint on which it is a hinge.
    pub fn joint(&self) -> Option<&str> {
        if let Self::Hinge { joint, .. } = self { joint.as_deref() } else { None }
    }

    /// The bodies that it acts on: `None` is the ground.
    pub fn bodies(&self) -> Vec<Option<&str>> {
        match self {
            Self::Spring { body_a, body_b, .. }
            | Self::Torsion { body_a, body_b, .. }
            | Self::Hinge { body_a, body_b, .. } => vec![body_a.as_deref(), Some(body_b)],
            Self::Force { body, .. } | Self::Torque { body, .. } => vec![Some(body)],
        }
    }
}

/// A compliant connection with six stiffnesses between body `a` (or the ground) and body `b`.
///
/// In the frame of the connection, carried by `b`, the member, axis 0 is the member axis: translation 0 is axial, 1 and 2
/// are shear; rotation 0 is torsion, 1 and 2 are bending about the axes 1 and 2. It is stress-free
/// in the initial poses of the file, but for the weight of a beam. Bodies moving apart along axis 0 are in tension: apart means along the
/// sense of axis 0 that points from the centre of mass of `a` (from the joint point, if `a` is the ground) to that of `b`; where that is across axis 0, axis 0 itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bushing {
    /// Unique id.
    pub id: String,
    /// First body; `None` is the ground.
    pub body_a: Option<String>,
    /// Second body.
    pub body_b: String,
    /// Its point in the global frame, initial pose \[m\].
    pub point_m: [f64; 3],
    /// Rows are its axes in the global frame, initial pose: orthonormal, right-handed.
    pub axes: [[f64; 3]; 3],
    /// Axial stiffness \[N/m\].
    pub axial_stiffness_n_m: f64,
    /// Shear stiffness along axes 1 and 2 \[N/m\].
    pub shear_stiffness_n_m: [f64; 2],
    /// Torsional stiffness \[N m/rad\].
    pub torsional_stiffness_nm_rad: f64,
    /// Bending about axes 1 and 2.
    pub bending: [Bending; 2],
    /// The beam in whose middle it stands: its curve is then the resistance of both ends of the beam, in place of that at its point. One bending axis has a curve, whose shear stiffness is not zero; it
    /// is neither latent nor on a joint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beam: Option<Beam>,
    /// Ideal joint between the same bodies that holds its point: the bushing is a hinge on it, and opens it when it breaks. The axial force is that of the joint at the end of the step
    /// before; the axial and shear stiffnesses are zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// The section that it is part of, if it is latent: its bodies then move as one until the forces that a bushing of this section would have to bear reach its resistance (bending of its curves,
    /// shear, tension, compression); those of a section give way together. It needs a body on both sides, all its stiffnesses, and a model without ideal joints and forces. `None`: it is live from the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latent: Option<String>,
    /// Tension \[N\] at which it separates; `None`: never.
    #[serde(default)]
    pub tensile_capacity_n: Option<f64>,
    /// Plastic elongation \[m\] that the member bears at its tensile capacity before it separates; `None`: none, it
    /// separates as soon as the capacity is reached.
    #[serde(default)]
    pub tensile_elongation_m: Option<f64>,
    /// Shear forces \[N\] along axes 1 and 2 at which it separates or, with [`Self::shear_slip_m`], slips, together as an ellipse: `(V_1/C_1)² + (V_2/C_2)² = 1`. Not on a joint that holds its point, nor in models with ideal joints and forces; `None`: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear_capacity_n: Option<[f64; 2]>,
    /// Plastic slip \[m\] that it bears at its shear capacity before it separates, along its path; neither latent nor in the middle of a beam. `None`: none, it separates as soon as the capacity is reached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear_slip_m: Option<f64>,
    /// Compression \[N\] at which the member crushes: the axial spring is elastic-perfectly plastic there;
    /// `None`: never. Without it a storey that lands on its columns rebounds elastically.
    #[serde(default)]
    pub compressive_capacity_n: Option<f64>,
    /// How it hardens up to there: share of the compressive capacity at which it flows, from what is above 0 up to 1, over plastic shortening \[m\], from 0 on; both grow. Empty: it flows at the capacity.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub compressive_hardening: Vec<[f64; 2]>,
    /// Share of its compressive capacity that is left over the plastic rotation \[rad\] of its hinge, from `[0, 1]` on, rotations rising and shares falling, above 0: what of a section is broken bears no axial force either
    /// ([`crate::curve::ResistanceCurve::left_under_compression`]). Empty: all of it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub compressive_fading: Vec<[f64; 2]>,
    /// Plastic shortening \[m\] that the member bears at its compressive capacity before it is crushed: the joint then separates, and body `b`, which is the member, touches no other body; not in models with ideal joints and forces; `None`: any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crushing_shortening_m: Option<f64>,
    /// Whether its hinge shortens it as it turns under an axial force, by normality to the surface of its capacities ([`crate::curve::CapacityTable::shortening_m`]).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub associated_flow: bool,
    /// How its strength grows with the rate at which it flows; `None`: not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_factor: Option<RateFactor>,
    /// The bushing at the other end of body `b`, if that is a member that bends between them; in one of both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carry_over: Option<CarryOver>,
    /// Provenance.
    #[serde(default)]
    pub origin: Origin,
}

/// Factor `1 + (v / c)^(1 / p)` on what a bushing bears as it flows (Cowper and Symonds 1957; [`crate::curve::rate`]): on its curves with the rate `v` of plastic rotation, on its tensile and compressive capacities with that of plastic
/// elongation or shortening. What parts at once when a capacity is reached does so without it. Not in models with ideal joints and forces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RateFactor {
    /// `c` of rotation about axes 1 and 2 \[rad/s\].
    pub rotation_rad_s: [f64; 2],
    /// `c` of elongation and shortening \[m/s\]; `None`: these have no factor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elongation_m_s: Option<f64>,
    /// `p`, 1 to 20.
    pub exponent: f64,
}

/// What the ends of a member carry over to each other: a rigid member on rotation springs is a beam in sway only ([`crate::mbs`], `carry.rs`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CarryOver {
    /// The bushing at the other end: its body `b` is the same, and its axes are parallel to those of this one. Neither is latent, on a joint or in the middle of a beam, nor in a model with ideal joints and forces.
    pub bushing: String,
    /// Rotation that a moment at one end and none at the other takes off the one and adds to the other, about axes 1 and 2: `L / (6 E I)` for a beam of length `L` with springs `6 E I / L` \[rad/(N m)\].
    pub flexibility_rad_nm: [f64; 2],
}

/// A beam between two rigid bodies that meet in its middle. With a rotation spring `E I / L` and a shear spring `1 / (L³ / (12 E I) + L / (G A_s))` they are the beam exactly ([`crate::curve::beam`]).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beam {
    /// Half its length: how far the ends are from the point of the bushing along axis 0 \[m\].
    pub half_length_m: f64,
    /// Under which names results tell of the hinges at its ends, the one towards negative axis 0 first. Unique among the bushings.
    pub ends: [String; 2],
    /// What its weight bends; `None`: nothing, its bodies are heavy only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span: Option<Span>,
}

/// A span under its own weight, which is part of that of the bodies: they bear it rigidly, and a beam between clamped faces sags. The moments of that are added in the middle and at the hinges
/// ([`crate::curve::beam`]), for gravity as it acts in the initial poses, and less of them the nearer its bodies are to free fall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Span {
    /// Its length between the faces that it is clamped in, not shorter than the beam between its hinges \[m\].
    pub length_m: f64,
    /// Its mass per length \[kg/m\].
    pub mass_kg_m: f64,
}

/// Rotational resistance about one bending axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Bending {
    /// Linear elastic.
    Elastic {
        /// Stiffness \[N m/rad\].
        stiffness_nm_rad: f64,
    },
    /// Elastic-plastic with a capacity curve that depends on axial force, and fracture.
    Curve {
        /// Id in [`super::Model::curves`].
        curve: String,
        /// Factor on the capacity (preparatory weakening).
        #[serde(default = "one")]
        strength_factor: f64,
    },
}

impl Bending {
    /// Id of its curve, if it has one.
    pub fn curve(&self) -> Option<&String> {
        match self {
            Self::Curve { curve, .. } => Some(curve),
            Self::Elastic { .. } => None,
        }
    }
}

fn one() -> f64 {
    1.0
}

impl Bushing {
    /// Whether anything of it has a limit: a curve, or a capacity in tension, compression or shear.
    pub fn has_capacity(&self) -> bool {
        self.bending.iter().any(|b| matches!(b, Bending::Curve { .. }))
            || self.tensile_capacity_n.is_some()
            || self.compressive_capacity_n.is_some()
            || self.shear_capacity_n.is_some()
    }

    /// Whether it may stretch or shorten plastically at a capacity, rather than part at once.
    pub fn flows_along(&self) -> bool {
        let stretches =
            self.tensile_capacity_n.is_some() && self.tensile_elongation_m.is_some_and(|u| u > 0.0);
        stretches || self.compressive_capacity_n.is_some()
    }

    /// Whether anything of it flows: what a rate has a say in.
    pub fn flows(&self) -> bool {
        self.bending.iter().any(|b| matches!(b, Bending::Curve { .. })) || self.flows_along()
    }

    /// One between two bodies that resists nothing yet, has no limits and no provenance.
    pub fn free(
        id: String,
        body_a: Option<String>,
        body_b: String,
        point_m: [f64; 3],
        axes: [[f64; 3]; 3],
    ) -> Self {
        Self {
            id,
            body_a,
            body_b,
            point_m,
            axes,
            axial_stiffness_n_m: 0.0,
            shear_stiffness_n_m: [0.0; 2],
            torsional_stiffness_nm_rad: 0.0,
            bending: [0, 1].map(|_| Bending::Elastic { stiffness_nm_rad: 0.0 }),
            beam: None,
            joint: None,
            latent: None,
            tensile_capacity_n: None,
            tensile_elongation_m: None,
            shear_capacity_n: None,
            shear_slip_m: None,
            compressive_capacity_n: None,
            compressive_hardening: Vec::new(),
            compressive_fading: Vec::new(),
            crushing_shortening_m: None,
            associated_flow: false,
            rate_factor: None,
            carry_over: None,
            origin: Origin::default(),
        }
    }

    /// Names under which results tell of what it is: its own, or those of the ends of the beam in whose middle it stands.
    pub fn names(&self) -> &[String] {
        self.beam.as_ref().map_or(std::slice::from_ref(&self.id), |beam| &beam.ends)
    }

    /// Names of its hinges in results; none if it is elastic.
    pub fn hinges(&self) -> Vec<&str> {
        let has_curve = self.bending.iter().any(|b| b.curve().is_some());
        if has_curve { self.names().iter().map(String::as_str).collect() } else { Vec::new() }
    }
}
