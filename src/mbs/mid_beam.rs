//! A beam with hinges at its ends that a joint in its middle stands for.

use super::math::{self, V3};
use super::model::{Bending, Bushing};
use super::stance::Chord;
use crate::curve::{BeamEnds, MiddleSprings, SpanLoad};

/// A beam with hinges at its ends: the curve of its bending axis is theirs.
#[derive(Debug, Clone)]
pub(super) struct MidBeam {
    /// Bending axis (1 or 2).
    pub axis: usize,
    /// Half its length, by the sense in which a rotation about the axis moves it along the other one \[m\].
    lever_m: f64,
    /// Half its length with the sense of axis 0, and the length between its hinges at which it is free of axial force \[m\].
    pub reach_m: f64,
    pub free_m: f64,
    /// Where its axial force acts, and the gap, in the last evaluation.
    pub chord: Chord,
    pub gap: V3,
    /// What its weight adds, and the share of it that is borne: none in free fall.
    load: SpanLoad,
    pub borne: f64,
    /// Smoothed acceleration of its floor along gravity where it is, over gravity.
    pub falls: f64,
    /// Work done against it \[J\].
    pub against_load_j: f64,
    /// The hinges.
    pub ends: BeamEnds,
}

impl MidBeam {
    /// Of a joint whose axis 0 points from A's side to B's with a sense of `outward`.
    pub fn of(joint: &Bushing, outward: f64, gravity: V3) -> Option<Box<Self>> {
        let beam = joint.beam.as_ref()?;
        let half = beam.half_length_m;
        let axis = 1 + joint.bending.iter().position(|b| matches!(b, Bending::Curve { .. }))?;
        // a rotation about axis 1 moves what lies on positive axis 0 along negative axis 2, one about axis 2 along positive axis 1
        let lever_m = if axis == 1 { half } else { -half };
        // displacements and rotations are those of B against A
        let across = outward * math::dot(joint.axes[3 - axis], gravity);
        let load = beam.span.map(|s| SpanLoad::uniform(s.mass_kg_m * across, s.length_m, lever_m));
        let (load, ends) = (load.unwrap_or_default(), BeamEnds::default());
        let reach_m = outward * half;
        Some(Box::new(Self {
            axis,
            lever_m,
            reach_m,
            free_m: 2.0 * half,
            chord: Chord { arm: [-reach_m, 0.0, 0.0], ..Chord::along_axis([0.0; 3]) },
            gap: [0.0; 3],
            load,
            borne: 1.0,
            falls: 0.0,
            against_load_j: 0.0,
            ends,
        }))
    }

    /// The other axis across, along which it bears shear.
    pub fn across(&self) -> usize {
        3 - self.axis
    }

    /// Of its weight, what is borne.
    pub fn load(&self) -> SpanLoad {
        self.load.times(self.borne)
    }

    /// Its springs in the middle, for the stiffness of its joint about and along its axes.
    pub fn springs(&self, rotation: V3, translation: V3) -> MiddleSprings {
        MiddleSprings {
            turn_nm_rad: rotation[self.axis],
            shear_n_m: translation[self.across()],
            lever_m: self.lever_m,
            load: self.load(),
        }
    }

    /// Half its length with its sense, times the stiffness against shear \[N\].
    pub fn shear_lever_n(&self, translation: V3) -> f64 {
        self.lever_m * translation[self.across()]
    }

    /// Whether its weight bends it.
    pub fn is_loaded(&self) -> bool {
        self.load != SpanLoad::default()
    }

    /// Moment in the middle \[N m\] and shear \[N\] for moments at the ends.
    pub fn of_ends(&self, [start, end]: [f64; 2]) -> [f64; 2] {
        [0.5 * (start + end), 0.5 * (end - start) / self.lever_m]
    }

    /// What is plastic of the rotation \[rad\] and of the gap across \[m\].
    pub fn plastic(&self) -> [f64; 2] {
        self.ends.plastic(self.lever_m)
    }
}
