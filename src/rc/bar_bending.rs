//! Bending stiffness of the longitudinal bars.
//!
//! Bars are trusses on the nodes of the concrete: a chain with a hinge at every node. Compressed to yield, such a chain folds from node to node once the concrete around it is
//! crushed and holds it no more. Real bars bend: the Euler load of one of 16 mm over half waves of 25 mm is a hundred times its yield force. What they do between two
//! ties is in their axial law ([`crate::material::rebar::Buckling`]), whose stress is a mean over that length; it takes the line between the ties as straight.
//!
//! Between two neighbouring elements of a bar with unit vectors `t₁`, `t₂` the moment is `M = E I |t₂ - t₁| / l`, `l` the mean of both lengths: the bending energy of a discrete
//! elastic rod (Bergou, Wardetzky, Robinson, Audoly, Grinspun, ACM Trans. Graph. 27 (2008), article 63), without degrees of freedom of its own. The forces on the three nodes are its
//! derivatives, in equilibrium in any position: with `e = M (t₂ - t₁) / |t₂ - t₁|`, `-(e - (e · t₁) t₁) / l₁` on the first, `-(e - (e · t₂) t₂) / l₂` on the last, the opposite of both
//! on the middle one. Elastic up to the plastic moment `f_y d³ / 6` of a round bar, then constant; compression does not lower it, as its law has its own loss. A bar is hinged where it ends.
//!
//! Bars in tension are kept straight by their force and are left without: their bending would be dowel action, and bars that are tied to the nodes of the concrete, which neither splits nor
//! bears under them, would have far too much of it (a fold within one element of 60 mm in each of eight bars of 29 mm: 360 kN; with it, columns that failed in shear kept 80 % to drifts of 4 to 5 %).
//!
//! **Time step.** A chain vibrates in bending with `ω² <= 16 E I / (ρ A l⁴) = (d / l)² E / (ρ l²)`, along itself with `4 E / (ρ l²)`, which bounds the step already ([`crate::fe::truss`]):
//! bending does not shorten it as long as elements are longer than half a diameter.

use super::member::{BARS, RcMember};
use crate::fe::dynamics::Dynamics;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Share of the yield strength in tension at which a bar has no bending resistance any more.
const PULLED: f64 = 0.1;

/// The bending of all bars of a member in motion. Its forces count as applied; it hands back what else acts on these nodes. The default: bars without.
#[derive(Debug, Default)]
pub(super) struct BarBending {
    joints: Vec<Joint>,
    /// Nodes of the bars, each once, and the forces on them besides \[N\].
    nodes: Vec<usize>,
    besides_n: Vec<[f64; 3]>,
}

/// Two neighbouring elements of a bar.
#[derive(Debug)]
struct Joint {
    trusses: [usize; 2],
    nodes: [usize; 3],
    /// What takes the forces across the member: the nodes themselves, or that of the concrete on which the end of a slipping bar stays.
    across: [usize; 3],
    /// Yield strength of the bar \[Pa\].
    yield_pa: f64,
    bent: Bent,
}

/// The bend between two elements.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bent {
    /// `E I` over the mean length of both \[N m\].
    stiffness_nm: f64,
    /// Plastic moment \[N m\].
    plastic_nm: f64,
    /// Part of `t₂ - t₁` that stays.
    rest: Vector3<f64>,
}

impl Bent {
    /// Of a share of a round bar's section \[m, Pa\].
    fn of(diameter_m: f64, share: f64, [modulus_pa, yield_pa]: [f64; 2], length_m: f64) -> Self {
        let inertia_m4 = share * PI * diameter_m.powi(4) / 64.0;
        Self {
            stiffness_nm: modulus_pa * inertia_m4 / length_m,
            plastic_nm: share * yield_pa * diameter_m.powi(3) / 6.0,
            rest: Vector3::zeros(),
        }
    }

    /// Forces on the three nodes at their places, with this share of the plastic moment \[m, N\].
    fn forces_n(&mut self, x: [Vector3<f64>; 3], share: f64) -> [Vector3<f64>; 3] {
        let along = [x[1] - x[0], x[2] - x[1]];
        let lengths = along.map(|a| a.norm());
        let t = [along[0] / lengths[0], along[1] / lengths[1]];
        let mut moment = self.stiffness_nm * (t[1] - t[0] - self.rest);
        let size = moment.norm();
        let most = share * self.plastic_nm;
        if size > most {
            let held = moment * (most / size);
            self.rest += (moment - held) / self.stiffness_nm;
            moment = held;
        }
        let across = |k: usize| (moment - t[k] * moment.dot(&t[k])) / lengths[k];
        let [first, last] = [-across(0), -across(1)];
        [first, -(first + last), last]
    }
}

impl BarBending {
    /// Of a member at rest.
    pub fn of(member: &RcMember) -> Self {
        let (mesh, mut joints) = (&member.mesh, Vec::new());
        for pair in member.bars.windows(2) {
            let [low, high] = [pair[0], pair[1]].map(|t| &mesh.trusses[t]);
            let Some(law) = mesh.laws[BARS].rebar.filter(|_| low.nodes[1] == high.nodes[0]) else { continue };
            let nodes = [low.nodes[0], low.nodes[1], high.nodes[1]];
            let [x0, x1, x2] = nodes.map(|n| Vector3::from(mesh.nodes[n]));
            let share = if member.mirrored.contains(&nodes[1]) { member.share } else { 1.0 };
            let diameter_m = (4.0 * low.area_m2 / (PI * share)).sqrt();
            let length_m = 0.5 * ((x1 - x0).norm() + (x2 - x1).norm());
            let strengths_pa = [law.youngs_modulus_pa, law.yield_strength_pa];
            let bent = Bent::of(diameter_m, share, strengths_pa, length_m);
            let onto = |n: usize| member.slips.iter().find(|s| s.node == n).map_or(n, |s| s.onto);
            joints.push(Joint {
                trusses: [pair[0], pair[1]],
                nodes,
                across: nodes.map(onto),
                yield_pa: strengths_pa[1],
                bent,
            });
        }
        let mut nodes: Vec<usize> = joints.iter().flat_map(|j| j.nodes.into_iter().chain(j.across)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        Self { joints, besides_n: vec![[0.0; 3]; nodes.len()], nodes }
    }

    /// Adds its forces to those applied in the coming step.
    pub fn push(&mut self, body: &mut Dynamics) {
        for (besides, n) in self.besides_n.iter_mut().zip(&self.nodes) {
            *besides = body.applied_n[*n];
        }
        for joint in &mut self.joints {
            if joint.trusses.iter().any(|t| !body.trusses.bars[*t].acts) {
                continue;
            }
            let stresses = joint.trusses.iter().map(|t| body.trusses.bars[*t].stress_pa);
            let pulled = (stresses.fold(0.0, f64::max) / (PULLED * joint.yield_pa)).min(1.0);
            let forces = joint.bent.forces_n(joint.nodes.map(|n| Vector3::from(body.x[n])), 1.0 - pulled);
            for (k, force) in forces.into_iter().enumerate() {
                body.applied_n[joint.across[k]][0] += force[0];
                body.applied_n[joint.across[k]][1] += force[1];
                body.applied_n[joint.nodes[k]][2] += force[2];
            }
        }
    }

    /// Takes them away again, when the step and what belongs to it is done.
    pub fn release(&self, body: &mut Dynamics) {
        for (besides, n) in self.besides_n.iter().zip(&self.nodes) {
            body.applied_n[*n] = *besides;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: [f64; 2] = [200e9, 500e6];

    fn at(x: f64, z: f64) -> Vector3<f64> {
        Vector3::new(x, 0.0, z)
    }

    #[test]
    fn a_bar_bent_to_a_circle_bears_its_curvature_times_stiffness() {
        let (l, radius) = (0.025, 10.0);
        let mut bent = Bent::of(0.016, 1.0, STEEL, l);
        let angle = l / radius;
        let on_circle = |k: f64| at(radius * (1.0 - (k * angle).cos()), radius * (k * angle).sin());
        let x = [on_circle(-1.0), on_circle(0.0), on_circle(1.0)];
        let f = bent.forces_n(x, 1.0);
        let wanted = 200e9 * PI * 0.016f64.powi(4) / 64.0 / radius;
        assert!((f[0].norm() * l / wanted - 1.0).abs() < 1e-5, "{} {wanted}", f[0].norm() * l);
        assert!(f[0][0] < 0.0 && f[1][0] > 0.0 && f[2][0] < 0.0); // they straighten it
        let sum = f[0] + f[1] + f[2];
        let turn = x[0].cross(&f[0]) + x[1].cross(&f[1]) + x[2].cross(&f[2]);
        assert!(sum.norm() < 1e-9 * f[1].norm() && turn.norm() < 1e-9 * f[1].norm());
    }

    #[test]
    fn a_folding_chain_is_held_as_the_discrete_rod_says() {
        // displacements ± w from node to node: each node is pushed back by 16 E I w / l³
        let (l, w) = (0.025, 1e-6);
        let mut bent = Bent::of(0.016, 1.0, STEEL, l);
        let x = |k: i32| at(if k % 2 == 0 { w } else { -w }, l * f64::from(k));
        let force = bent.forces_n([x(0), x(1), x(2)], 1.0)[2][0]
            + bent.forces_n([x(1), x(2), x(3)], 1.0)[1][0]
            + bent.forces_n([x(2), x(3), x(4)], 1.0)[0][0];
        let wanted = -16.0 * 200e9 * PI * 0.016f64.powi(4) / 64.0 * w / l.powi(3);
        assert!((force / wanted - 1.0).abs() < 1e-6, "{force} {wanted}");
    }

    #[test]
    fn beyond_the_plastic_moment_the_bend_stays() {
        let l = 0.05;
        let mut bent = Bent::of(0.02, 0.5, STEEL, l);
        let straight = [at(0.0, 0.0), at(0.0, l), at(0.0, 2.0 * l)];
        let folded = [at(0.0, 0.0), at(0.0, l), at(0.3 * l, 2.0 * l)];
        assert_eq!(bent.forces_n(straight, 1.0)[0], Vector3::zeros());
        let plastic = 0.5 * 500e6 * 0.02f64.powi(3) / 6.0;
        assert!(bent.forces_n(folded, 1.0)[0].norm() * l <= plastic * (1.0 + 1e-12));
        assert!(bent.forces_n(folded, 1.0)[0].norm() * l > 0.9 * plastic);
        assert!(bent.forces_n(straight, 1.0)[0][0] * l > 0.9 * plastic); // to be straight again it has to be bent back
    }
}
