//! Hexahedra of concrete: the one-point element of [`super::kernel`] with the law of [`crate::material::concrete`] at its centre.
//!
//! **Hourglass control follows the damage.** With the strain energy density of the stress, `σ : e / 2`, and that of undamaged concrete, `e : C : e / 2`, of
//! the same mechanical strain (crack strain included), the share of stiffness left is `t = σ : e / e : C : e`. Hourglass stresses grow with `t` times the
//! elastic stiffness, and fall with `t` when it falls: cracked or crushed elements have no bending resistance of their own. While the
//! centre flows in compression, hourglass stiffness is that of the floor, as in J2 plasticity.
//!
//! **And the strength bounds it.** An element whose centre stays elastic would otherwise bend elastically for ever, and a member few elements deep would be too strong
//! (the case of a slab under blast in `src/verify/fe/slab.rs`). A strip that bears no tension, compressed by `s` on average and crushed at `f`, carries at most the moment
//! `s h² (1 - s / f) / 2`, that is a bending stress of `3 s (1 - s / f)` if it were elastic; to which comes the tensile strength. The Mises stress that hourglass stresses
//! stand for ([`super::hourglass`]) is `1 / sqrt(2 (1 + ν))` of the stress at the faces of an element in plane bending. Beyond that they are scaled down.

use super::kernel::{
    BlockForce, BlockMaterial, BlockState, HOURGLASS_FLOOR, KernelStep, LANES, Lane, deform_lanes,
    resist_lanes,
};
use super::law::Law;
use super::mesh::Mesh;
use crate::material::concrete::{ConcretePoint, ConcreteState, LawError, respond_lanes};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Least share of the elastic stiffness left to hourglass control: without any, cracked regions develop zigzag modes.
pub const LEAST_SHARE: f64 = 0.01;
/// Lengths of elements are rounded to this for the tables of the law \[m\].
const LENGTH_STEP_M: f64 = 1e-3;

/// What a block of concrete elements remembers besides the block's own state.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ConcreteBlock {
    /// History at the centre of each element.
    pub states: [ConcreteState; LANES],
    /// Share of stiffness left to hourglass control.
    pub left: Lane,
    /// Table of each element in [`ConcretePoints`].
    pub points: [u32; LANES],
}

/// Concrete laws for all element lengths of a mesh.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct ConcretePoints {
    /// The laws.
    pub points: Vec<ConcretePoint>,
    /// Law of each element; 0 for other materials.
    of_element: Vec<u32>,
}

impl ConcretePoints {
    /// Tables for the lengths (cube roots of the volumes) of a mesh's concrete elements, and for the shares of concrete in them (their factor on stiffness).
    ///
    /// # Errors
    /// If a law is out of its range, or does not suit the length of an element.
    pub fn of(mesh: &Mesh) -> Result<Self, LawError> {
        let mut this = Self::default();
        if mesh.laws.iter().all(|l| l.concrete.is_none()) {
            return Ok(this);
        }
        let mut known: BTreeMap<(usize, u64, u64), u32> = BTreeMap::new();
        for element in &mesh.elements {
            let Some(law) = &mesh.laws[element.law].concrete else {
                this.of_element.push(0);
                continue;
            };
            let volume = super::hexahedron::volume_m3(&element.nodes.map(|n| mesh.nodes[n]));
            let steps = (libm::cbrt(volume) / LENGTH_STEP_M).round().max(1.0);
            let next = this.points.len() as u32;
            let index = *known.entry((element.law, steps as u64, element.smear.to_bits())).or_insert(next);
            if index == next {
                this.points.push(ConcretePoint::new(&law.thinned(element.smear), steps * LENGTH_STEP_M)?);
            }
            this.of_element.push(index);
        }
        Ok(this)
    }

    /// State of a block of these elements (at most [`LANES`]), if their law is one of concrete.
    pub fn block(&self, law: &Law, elements: &[usize]) -> Option<Box<ConcreteBlock>> {
        law.concrete.as_ref()?;
        let points = std::array::from_fn(|l| self.of_element[elements[l.min(elements.len() - 1)]]);
        Some(Box::new(ConcreteBlock {
            states: [ConcreteState::default(); LANES],
            left: [1.0; LANES],
            points,
        }))
    }
}

impl ConcreteBlock {
    /// Takes one lane of another block.
    pub fn copy_lane(&mut self, to: usize, other: &Self, from: usize) {
        self.states[to] = other.states[from];
        self.left[to] = other.left[from];
        self.points[to] = other.points[from];
    }

    /// Forgets all history.
    pub fn unload(&mut self) {
        self.states = [ConcreteState::default(); LANES];
        self.left = [1.0; LANES];
    }
}

/// Updates a block of concrete elements; arguments and result are those of the one-point kernel, with the concrete's history.
#[expect(clippy::too_many_arguments, reason = "the arguments of the one-point kernel and the history")]
#[inline(always)]
pub fn update(
    x: &BlockForce,
    v: &BlockForce,
    factor: f64,
    material: &BlockMaterial,
    points: &[ConcretePoint],
    state: &mut BlockState,
    concrete: &mut ConcreteBlock,
    force: &mut BlockForce,
    step: KernelStep,
) -> Lane {
    let acts = state.share.map(|s| s > 0.0);
    let own: [&ConcretePoint; LANES] = std::array::from_fn(|l| &points[concrete.points[l] as usize]);
    let (mut s, bent) = deform_lanes(x, v, factor, material, state, step);
    let mut flowed = [0.0; LANES];
    let (mut lambda, mut mu) = ([0.0; LANES], [0.0; LANES]);
    for l in 0..LANES {
        flowed[l] = concrete.states[l].plastic;
        [lambda[l], mu[l]] = own[l].lame_pa();
    }
    let mut mechanical = [[0.0; LANES]; 6];
    respond_lanes(&own, &mut concrete.states, &s.strain, &acts, [&mut s.trial, &mut mechanical]);
    let mut left = [1.0; LANES];
    for l in 0..LANES {
        left[l] = stiffness_left([lambda[l], mu[l]], &lane(&mechanical, l), &lane(&s.trial, l));
    }
    let mut fade = [1.0; LANES];
    for l in (0..LANES).filter(|l| acts[*l]) {
        let flows = concrete.states[l].plastic > flowed[l];
        s.tangent[l] = if flows { left[l].min(HOURGLASS_FLOOR) } else { left[l] };
        let bounded = if bent[l] > least_bent_pa(own[l]) {
            let most = most_bent_pa(own[l], &concrete.states[l], &lane(&s.trial, l));
            if bent[l] > most { most / bent[l] } else { 1.0 }
        } else {
            1.0
        };
        s.tangent[l] *= bounded;
        fade[l] = (left[l] / concrete.left[l]).min(1.0) * bounded;
        concrete.left[l] = left[l];
    }
    for values in &mut state.hourglass {
        for l in 0..LANES {
            values[l] *= fade[l];
        }
    }
    let bound = resist_lanes(&s, material, state, force, step);
    for l in 0..LANES {
        state.plastic_strain[l] = concrete.states[l].plastic;
    }
    bound
}

/// The largest Mises stress of hourglass modes beside a stress at the centre \[Pa\]. `s` is the lower bound `2 q / 3 - σ_m` of the
/// smallest principal stress, exact in uniaxial compression; lateral pressure adds its fourfold to the strength.
fn most_bent_pa(point: &ConcretePoint, state: &ConcreteState, t: &[f64; 6]) -> f64 {
    let mean = (t[0] + t[1] + t[2]) / 3.0;
    let (a, b, c) = (t[0] - t[1], t[1] - t[2], t[2] - t[0]);
    let shear = t[3] * t[3] + t[4] * t[4] + t[5] * t[5];
    let third = (0.5 * (a * a + b * b + c * c) + 3.0 * shear).sqrt() * (2.0 / 3.0);
    let [compressive, tensile] = point.strengths_pa();
    let strength = (1.0 - point.damage(state)) * compressive + 4.0 * (-mean - third).max(0.0);
    let pressed = (third - mean).max(0.0);
    let [lambda, mu] = point.lame_pa();
    let of_faces = ((lambda + mu) / (3.0 * lambda + 2.0 * mu)).sqrt();
    of_faces * (tensile + 3.0 * pressed * (1.0 - pressed / strength).max(0.0))
}

/// The least that [`most_bent_pa`] can be beside any stress \[Pa\]: most elements are below it.
fn least_bent_pa(point: &ConcretePoint) -> f64 {
    let [lambda, mu] = point.lame_pa();
    point.strengths_pa()[1] * ((lambda + mu) / (3.0 * lambda + 2.0 * mu)).sqrt()
}

/// `σ : e / e : C : e` between [`LEAST_SHARE`] and 1; 1 without strain.
#[inline(always)]
fn stiffness_left([lambda, mu]: [f64; 2], e: &[f64; 6], stress: &[f64; 6]) -> f64 {
    let trace = e[0] + e[1] + e[2];
    let twice = |i: usize| if i < 3 { 1.0 } else { 2.0 };
    let (mut squares, mut held) = (0.0, 0.0);
    for i in 0..6 {
        squares += twice(i) * e[i] * e[i];
        held += twice(i) * stress[i] * e[i];
    }
    let elastic = lambda * trace * trace + 2.0 * mu * squares;
    let left = if elastic > 0.0 { held / elastic } else { 1.0 };
    let left = if left > LEAST_SHARE { left } else { LEAST_SHARE };
    if left < 1.0 { left } else { 1.0 }
}

/// One lane.
#[inline(always)]
fn lane(values: &[Lane; 6], l: usize) -> [f64; 6] {
    std::array::from_fn(|i| values[i][l])
}

#[cfg(test)]
mod tests {
    use super::{ConcretePoint, ConcreteState, least_bent_pa, most_bent_pa};
    use crate::material::concrete::ConcreteLaw;

    #[test]
    fn no_stress_makes_the_bound_of_hourglass_stress_smaller_than_its_least() {
        let point = ConcretePoint::new(&ConcreteLaw::of_strength(30e6), 0.05).unwrap();
        let least = least_bent_pa(&point);
        for plastic in [0.0, 1e-3, 1.0] {
            let state = ConcreteState { plastic, ..ConcreteState::default() };
            for pa in [-60e6, -30e6, -10e6, 0.0, 1e6, 3e6] {
                for side in [-5e6, 0.0, 2e6] {
                    let most = most_bent_pa(&point, &state, &[pa, side, side, 0.3 * pa, 0.0, 0.0]);
                    assert!(most >= least, "{plastic} {pa} {side}: {most} {least}");
                }
            }
        }
    }
}
