//! Contact shapes, ground, obstacles, and who may touch whom.

use serde::{Deserialize, Serialize};

/// The name of the ground among what bodies may meet.
pub const GROUND: &str = "ground";

/// A contact shape in the body frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A box.
    Box {
        /// Centre \[m\].
        center_m: [f64; 3],
        /// Half edge lengths \[m\].
        half_extents_m: [f64; 3],
        /// Orientation quaternion `[w, x, y, z]` in the body; `None`: edges along the body axes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        orientation: Option<[f64; 4]>,
    },
    /// A sphere.
    Sphere {
        /// Centre \[m\].
        center_m: [f64; 3],
        /// Radius \[m\].
        radius_m: f64,
    },
    /// The convex hull of points.
    Hull {
        /// At least four points that do not lie in a plane \[m\].
        points_m: Vec<[f64; 3]>,
    },
}

impl Shape {
    /// A box with edges along the body axes.
    pub fn cuboid(center_m: [f64; 3], half_extents_m: [f64; 3]) -> Self {
        Self::Box { center_m, half_extents_m, orientation: None }
    }

    /// Half edge lengths of a box \[m\].
    pub fn half_extents_m(&self) -> Option<[f64; 3]> {
        match self {
            Self::Box { half_extents_m, .. } => Some(*half_extents_m),
            _ => None,
        }
    }

    /// Points whose convex hull holds the shape: corners of boxes, points of hulls, corners of the box around a sphere \[m\].
    pub fn corners(&self) -> Vec<[f64; 3]> {
        let around = |center: [f64; 3], half: [f64; 3], turn: [f64; 4]| {
            let r = crate::mbs::math::qmat(turn);
            let corner = |c: usize| {
                let local = std::array::from_fn(|i| if c >> i & 1 == 0 { -half[i] } else { half[i] });
                crate::mbs::math::add(center, crate::mbs::math::mul(&r, local))
            };
            (0..8).map(corner).collect()
        };
        match self {
            Self::Box { center_m, half_extents_m, orientation } => {
                around(*center_m, *half_extents_m, orientation.unwrap_or([1.0, 0.0, 0.0, 0.0]))
            }
            Self::Sphere { center_m, radius_m } => around(*center_m, [*radius_m; 3], [1.0, 0.0, 0.0, 0.0]),
            Self::Hull { points_m } => points_m.clone(),
        }
    }

    /// Centre and half edge lengths of the box along the body axes around the shape \[m\].
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let corners = self.corners();
        let end = |i: usize, sign: f64| corners.iter().map(|c| sign * c[i]).fold(f64::NEG_INFINITY, f64::max);
        let of = |i: usize| [-end(i, -1.0), end(i, 1.0)];
        [
            std::array::from_fn(|i| 0.5 * (of(i)[0] + of(i)[1])),
            std::array::from_fn(|i| 0.5 * (of(i)[1] - of(i)[0])),
        ]
    }
}

/// What can touch.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Rigid horizontal ground.
    #[serde(default)]
    pub ground: Option<GroundPlane>,
    /// Rigid planes that do not move.
    #[serde(default)]
    pub planes: Vec<ObstaclePlane>,
    /// Rigid immovable boxes.
    #[serde(default)]
    pub obstacles: Vec<ObstacleBox>,
    /// Contact between bodies; `None` switches it off.
    #[serde(default)]
    pub bodies: Option<BodyContact>,
    /// What holds for single pairs; later ones win.
    #[serde(default)]
    pub pairs: Vec<PairRule>,
    /// Rolling-resistance arm where two solids meet \[m\]: they bear a moment against rolling of up to this times the force between them.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rolling_m: f64,
    /// Faces of boxes that are crushed by what they strike.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub crushing: Vec<CrushedFace>,
}

/// A face of a box, such as the end of a column, that bears no more than a force, and gets shorter under more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CrushedFace {
    /// Id of the body.
    pub body: String,
    /// Which of its shapes, a box.
    #[serde(default)]
    pub shape: usize,
    /// Which face.
    pub face: Face,
    /// Shortening so far \[m\] from 0 and the force that the whole face bears then \[N\]; constant beyond the last point.
    pub force_n: Vec<[f64; 2]>,
    /// How that grows with the speed at which what it strikes comes nearer; `None`: not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_factor: Option<FaceRate>,
    /// Library entry that the curve is from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subsystem: Option<String>,
}

/// Factor `1 + (v / c)^(1 / p)` on the force that a face bears, with the speed `v` of its fastest contact point along the normal at the start of a step (Cowper and Symonds 1957).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FaceRate {
    /// `c` \[m/s\].
    pub speed_m_s: f64,
    /// `p`, 1 to 20.
    pub exponent: f64,
}

/// A face of a box by the axis of the box that it looks along.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Face {
    /// Against x.
    #[serde(rename = "-x")]
    LowX,
    /// Along x.
    #[serde(rename = "+x")]
    HighX,
    /// Against y.
    #[serde(rename = "-y")]
    LowY,
    /// Along y.
    #[serde(rename = "+y")]
    HighY,
    /// Against z.
    #[serde(rename = "-z")]
    LowZ,
    /// Along z.
    #[serde(rename = "+z")]
    HighZ,
}

impl Face {
    /// Its axis (0 to 2), and 1 or -1 for along or against it.
    pub fn axis(self) -> (usize, f64) {
        match self {
            Self::LowX => (0, -1.0),
            Self::HighX => (0, 1.0),
            Self::LowY => (1, -1.0),
            Self::HighY => (1, 1.0),
            Self::LowZ => (2, -1.0),
            Self::HighZ => (2, 1.0),
        }
    }
}

/// What holds for one pair of bodies, or of a body and the `"ground"`, a plane or an obstacle. Of bodies that latent bushings hold together the first one may be named: what is said of it holds for all as long as they are one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairRule {
    /// Id of a body.
    pub a: String,
    /// Id of a body, a plane or an obstacle, or `"ground"`.
    pub b: String,
    /// They pass through each other.
    #[serde(default)]
    pub ignore: bool,
    /// Coulomb friction coefficient; `None`: that of the surface.
    #[serde(default)]
    pub friction: Option<f64>,
    /// Coefficient of restitution; `None`: that of the surface.
    #[serde(default)]
    pub restitution: Option<f64>,
    /// Rolling-resistance arm \[m\]; `None`: that of all contacts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rolling_m: Option<f64>,
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Contact {
    /// Whether any two solids resist rolling.
    pub fn resists_rolling(&self) -> bool {
        self.rolling_m > 0.0 || self.pairs.iter().any(|p| p.rolling_m.is_some_and(|rolling| rolling > 0.0))
    }
}

/// The half space behind a rigid plane.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObstaclePlane {
    /// Unique id.
    pub id: String,
    /// A point of it \[m\].
    pub point_m: [f64; 3],
    /// Its outer normal, of any length.
    pub normal: [f64; 3],
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Coefficient of restitution.
    #[serde(default = "restitution")]
    pub restitution: f64,
}

/// Coefficient of restitution unless a file says otherwise: concrete on concrete at the speeds of a collapse.
pub const RESTITUTION: f64 = 0.1;

fn restitution() -> f64 {
    RESTITUTION
}

/// Rigid ground plane `z = level`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundPlane {
    /// Height \[m\].
    pub level_m: f64,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Coefficient of restitution, 0 to 1.
    #[serde(default = "restitution")]
    pub restitution: f64,
}

/// Rigid box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObstacleBox {
    /// Unique id.
    pub id: String,
    /// Lower corner \[m\].
    pub min_m: [f64; 3],
    /// Upper corner \[m\].
    pub max_m: [f64; 3],
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Coefficient of restitution, 0 to 1.
    #[serde(default = "restitution")]
    pub restitution: f64,
}

/// Contact between bodies. Bodies that an intact joint or bushing connects do not touch each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyContact {
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Coefficient of restitution, 0 to 1.
    #[serde(default = "restitution")]
    pub restitution: f64,
}
