//! A member end on a plane of symmetry.
//!
//! Its nodes stay in the plane and are free in it: concrete there dilates, splits and spalls as above it. Only the section as a whole does not slide, and does not turn
//! about the member's axis. What holds it against the shear force acts where the section is compressed, in proportion to the compression, as friction would, and falls to zero at the faces.
//! Held elsewhere, the compressed zone would hang by tension across the section, which splits it along the member: of a section held in its middle, it slid sideways by 0.8 mm before the bars
//! yielded.

use super::member::RcMember;
use crate::fe::dynamics::Dynamics;
use nalgebra::{Matrix3, Vector3};

/// Time over which the compression is averaged \[s\].
const AVERAGED_S: f64 = 5e-4;
/// Compression that counts as spread evenly over the section in addition, so that it is held before it is loaded \[N\].
const EVEN_N: f64 = 1e3;
/// Share that a node on a face takes of what its compression would: a face bears no shear stress, which rises from zero within the first elements. Of a triangle in place of
/// a rectangle, weighted by linear shape functions, a third is left on the face and two thirds on the next node.
const FACE_SHARE: f64 = 1.0 / 3.0;
/// Coordinates closer than this are one \[m\].
const SAME_M: f64 = 1e-6;

/// The nodes of a section on a plane of symmetry, held without work: with `r_i` the share of node `i` in what holds it along an axis, `Σ r_i v_i = 0`, and the same for
/// a turn about the centre of these shares.
pub(super) struct Plane {
    nodes: Vec<usize>,
    /// Share of the area of each, and its place in the section \[m\].
    shares: Vec<f64>,
    places: Vec<[f64; 2]>,
    /// Across each axis: nodes on the faces, each with the next one inwards.
    faces: [Vec<[usize; 2]>; 2],
    /// Compression of each, averaged over time \[N\].
    pressed_n: Vec<f64>,
    /// Motions that are held: along x, along y, the turn. A plane of symmetry across the section holds others already.
    holds: [bool; 3],
    /// Velocities after the last step \[m/s\].
    last: Vec<[f64; 3]>,
}

impl Plane {
    /// The end section of a member.
    pub fn of(member: &RcMember) -> Self {
        let (nodes, shares): (Vec<usize>, Vec<f64>) =
            member.base.iter().copied().filter(|b| b.1 > 0.0).unzip();
        let places: Vec<[f64; 2]> =
            nodes.iter().map(|n| [member.mesh.nodes[*n][0], member.mesh.nodes[*n][1]]).collect();
        let holds = [member.mirror != Some(0), member.mirror != Some(1), member.mirror.is_none()];
        let faces = [0, 1].map(|axis| faces(&places, axis));
        let pressed_n = shares.iter().map(|s| EVEN_N * s).collect();
        let last = vec![[0.0; 3]; nodes.len()];
        Self { nodes, shares, places, faces, pressed_n, holds, last }
    }

    /// Takes the last step's motion of the section to the nearest one, by kinetic energy, that it can have; returns the work of that \[J\].
    pub fn hold(&mut self, body: &mut Dynamics) -> f64 {
        self.press(body);
        let rows = self.rows();
        let (mut along, mut gram) = (Vector3::zeros(), Matrix3::zeros());
        for (n, row) in self.nodes.iter().zip(&rows) {
            for axis in 0..2 {
                let c = Vector3::from(row.map(|r| r[axis]));
                along += c * body.v[*n][axis];
                gram += c * c.transpose() / body.mass_kg[*n];
            }
        }
        for k in (0..3).filter(|k| !self.holds[*k]) {
            gram[(k, k)] = 1.0;
        }
        let impulse = gram.try_inverse().unwrap_or_else(Matrix3::zeros) * along;
        let mut work = 0.0;
        for (i, (n, row)) in self.nodes.iter().zip(&rows).enumerate() {
            let across = |axis: usize| (0..3).map(|k| row[k][axis] * impulse[k]).sum::<f64>();
            for axis in 0..3 {
                let free = body.v[*n][axis];
                let held = if axis < 2 { free - across(axis) / body.mass_kg[*n] } else { 0.0 };
                let change = held - free;
                body.x[*n][axis] += body.taken_s * change;
                // the step booked forces of slipping bars over the motion that it found, not over that of the section
                work += 0.5 * body.taken_s * body.applied_n[*n][axis] * change;
                work += 0.5 * body.mass_kg[*n] * change * (held + self.last[i][axis]);
                self.last[i][axis] = held;
                body.v[*n][axis] = held;
            }
        }
        work
    }

    /// Takes the present compression into its mean.
    fn press(&mut self, body: &Dynamics) {
        let newer = (body.taken_s / AVERAGED_S).min(1.0);
        for ((n, share), pressed) in self.nodes.iter().zip(&self.shares).zip(&mut self.pressed_n) {
            let now = body.internal_n(*n)[2].max(0.0) + EVEN_N * share;
            *pressed += newer * (now - *pressed);
        }
    }

    /// Share of each node's velocities in the motions that are held, `[motion][axis]`.
    fn rows(&self) -> Vec<[[f64; 2]; 3]> {
        let weights = [0, 1].map(|axis: usize| {
            let mut weights = self.pressed_n.clone();
            for [face, next] in &self.faces[axis] {
                weights[*face] = FACE_SHARE * self.pressed_n[*face];
                weights[*next] = (weights[*next] - FACE_SHARE * self.pressed_n[*face]).max(0.0);
            }
            let all: f64 = weights.iter().sum();
            weights.into_iter().map(|w| w / all).collect::<Vec<f64>>()
        });
        let centre = [0, 1].map(|axis: usize| {
            let across = &weights[1 - axis];
            across.iter().zip(&self.places).map(|(r, place)| r * place[axis]).sum::<f64>()
        });
        let held = |motion: usize, r: f64| if self.holds[motion] { r } else { 0.0 };
        let row = |i: usize| {
            let ([rx, ry], [x, y]) = ([weights[0][i], weights[1][i]], self.places[i]);
            [
                [held(0, rx), 0.0],
                [0.0, held(1, ry)],
                [-held(2, rx) * (y - centre[1]), held(2, ry) * (x - centre[0])],
            ]
        };
        (0..self.nodes.len()).map(row).collect()
    }
}

/// Nodes on the faces across an axis, each with the next one inwards.
fn faces(places: &[[f64; 2]], axis: usize) -> Vec<[usize; 2]> {
    let half = places.iter().map(|p| p[axis].abs()).fold(0.0, f64::max);
    let on_face = |i: &usize| places[*i][axis].abs() > half - SAME_M;
    let next = |i: usize| {
        let [own, line] = [places[i][axis], places[i][1 - axis]];
        let inwards = |j: &usize| {
            let [at, other] = [places[*j][axis], places[*j][1 - axis]];
            (other - line).abs() < SAME_M && at * own.signum() < half - SAME_M
        };
        let depth = |j: &usize| (places[*j][axis] - own).abs();
        (0..places.len()).filter(inwards).min_by(|a, b| depth(a).total_cmp(&depth(b)))
    };
    (0..places.len()).filter(on_face).filter_map(|i| Some([i, next(i)?])).collect()
}

#[cfg(test)]
mod tests {
    use super::Plane;
    use crate::building::Bar;
    use crate::fe::contact::RigidSurfaces;
    use crate::fe::dynamics::Dynamics;
    use crate::material::concrete::ConcreteLaw;
    use crate::material::fibre::{FibreOptions, SectionInput};
    use crate::material::rebar::RebarLaw;
    use crate::rc::member::{Joint, RcMember};

    fn section() -> SectionInput {
        let corners = [[0.115, 0.115], [0.115, -0.115], [-0.115, 0.115], [-0.115, -0.115]];
        SectionInput {
            size_m: [0.3, 0.3],
            bars: corners.map(|[x_m, y_m]| Bar { x_m, y_m, diameter_m: 0.016 }).to_vec(),
            concrete_strength_pa: 25e6,
            tensile_strength_pa: 2.565e6,
            youngs_modulus_pa: 28.96e9,
            ties: None,
            steel: RebarLaw::bilinear(200e9, 500e6, 0.01, 0.075),
            options: FibreOptions { deduct_bars: false, history: false },
        }
    }

    #[test]
    fn a_section_may_spread_but_neither_slide_nor_turn() {
        let law = ConcreteLaw::of_strength(25e6);
        let member = RcMember::new(&section(), &law, Joint::Symmetry, 0.6, 0.1).unwrap();
        let mut body = Dynamics::new(&member.mesh, 0.0, RigidSurfaces::default(), false);
        body.step(false);
        let mut plane = Plane::of(&member);
        plane.pressed_n = plane.places.iter().map(|p| 1e5 * (p[1] + 0.1).max(0.0)).collect(); // on one side
        let places = plane.places.clone();
        let held_motions = |plane: &Plane, body: &Dynamics| {
            let rows = plane.rows();
            [0, 1, 2].map(|k| {
                let part = |(n, row): (&usize, &[[f64; 2]; 3])| {
                    row[k][0] * body.v[*n][0] + row[k][1] * body.v[*n][1]
                };
                plane.nodes.iter().zip(&rows).map(part).sum::<f64>().abs()
            })
        };
        for (n, [x, y]) in plane.nodes.clone().into_iter().zip(&places) {
            body.v[n] = [0.3 - 2.0 * y + 0.5 * x, -0.2 + 2.0 * x + 0.7 * y * y, 0.4];
        }
        assert!(held_motions(&plane, &body).iter().all(|v| *v > 1e-2));
        let before = body.kinetic_j();
        plane.hold(&mut body);
        assert!(held_motions(&plane, &body).iter().all(|v| *v < 1e-12));
        assert!(plane.nodes.iter().all(|n| body.v[*n][2] == 0.0));
        assert!(body.kinetic_j() < before);
        // a motion that is allowed stays as it is
        let allowed: Vec<[f64; 3]> = plane.nodes.iter().map(|n| body.v[*n]).collect();
        plane.last.clone_from(&allowed);
        let work = plane.hold(&mut body);
        let moved =
            plane.nodes.iter().zip(&allowed).map(|(n, v)| (body.v[*n][0] - v[0]).hypot(body.v[*n][1] - v[1]));
        let largest = moved.fold(0.0, f64::max);
        assert!(largest < 0.02, "{largest}"); // the mean of the compression has moved by a step
        assert!(work.abs() < 1e-2 * before, "{work}");
        assert!(allowed.iter().any(|v| v[1].abs() > 1e-3));
    }

    #[test]
    fn a_tension_acts_on_the_bars_and_in_the_middle() {
        let law = ConcreteLaw::of_strength(25e6);
        let mut section = section();
        section.bars[0].diameter_m = 0.024;
        section.bars[2].diameter_m = 0.024;
        for whole in [true, false] {
            // half of a section is alike on both sides of the plane of symmetry
            section.bars[1].diameter_m = if whole { 0.02 } else { 0.016 };
            let member = if whole {
                RcMember::new(&section, &law, Joint::Block, 0.6, 0.1)
            } else {
                RcMember::half(&section, &law, Joint::Block, [0.6, 0.1], 90.0)
            };
            let member = member.unwrap();
            assert_eq!(member.pulled.len(), if whole { 4 } else { 2 });
            let arm = |k: usize| member.pulled.iter().map(|(n, s)| s * member.mesh.nodes[*n][k]).sum::<f64>();
            assert!((member.pulled.iter().map(|p| p.1).sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(arm(1).abs() < 1e-12 && (!whole || arm(0).abs() < 1e-12), "{} {}", arm(0), arm(1));
            assert!(
                member.pulled.iter().all(|(n, s)| *s > 0.0 && (member.mesh.nodes[*n][2] - 0.6).abs() < 1e-9)
            );
        }
    }
}
