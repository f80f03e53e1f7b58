//! Springs, hinges, bushings and applied forces.
//!
//! Adams' splines remember nothing: a hinge follows its curve back where it should unload elastically. AKISPL (Akima 1970) runs smoothly through the points of
//! the curve, so that corners come out rounded.

use super::Writer;
use super::joint::frame_with_z;
use super::statement::number;
use crate::export::BEAM_STAYS_ELASTIC;
use crate::export::backbone::{of_curve, of_hinge};
use crate::export::number::{list, plain};
use crate::mbs::math::{M3, norm, sub};
use crate::mbs::model::{Bending, Bushing, Force};

/// How far a spline goes on beyond its last point \[rad\].
const BEYOND_RAD: f64 = 4.0;
/// Share of the shorter side of a corner over which a spline is rounded.
const ROUND: f64 = 0.02;

/// Numbers of the statements of each kind so far.
#[derive(Default)]
struct Counts {
    springs: usize,
    torques: usize,
    forces: usize,
}

impl Writer<'_> {
    pub(super) fn forces(&mut self) {
        let mut counts = Counts::default();
        if !self.model.forces.is_empty() {
            self.data.section("FORCES");
        }
        for force in &self.model.forces {
            self.force(force, &mut counts);
        }
        if !self.model.bushings.is_empty() {
            self.data.section("BUSHINGS");
        }
        for (i, bushing) in self.model.bushings.iter().enumerate() {
            self.bushing(bushing, i + 1, &mut counts);
        }
    }

    fn force(&mut self, force: &Force, counts: &mut Counts) {
        match force {
            Force::Spring {
                id,
                body_a,
                body_b,
                point_a_m,
                point_b_m,
                length_m,
                stiffness_n_m,
                damping_n_s_m,
            } => {
                let (a, b) = (self.part(body_a.as_deref()), self.part(Some(body_b)));
                let j = self.marker_at(a, *point_a_m, None);
                let i = self.marker_at(b, *point_b_m, None);
                let length = length_m.unwrap_or(norm(sub(*point_b_m, *point_a_m)));
                counts.springs += 1;
                let arguments = [
                    "TRANSLATION".into(),
                    format!("I = {i}"),
                    format!("J = {j}"),
                    number("K", *stiffness_n_m),
                    number("C", *damping_n_s_m),
                    number("LENGTH", length),
                    "FORCE = 0".into(),
                ];
                self.data.named("SPRINGDAMPER", counts.springs, id, &arguments);
            }
            Force::Torsion { id, body_a, body_b, axis, stiffness_nm_rad, damping_nm_s_rad } => {
                let [a, b] = [self.part(body_a.as_deref()), self.part(Some(body_b))];
                let frame = frame_with_z(*axis);
                let at = self.body(b).map_or([0.0; 3], |body| body.position_m);
                let j = self.marker_at(a, at, Some(&frame));
                let i = self.marker_at(b, at, Some(&frame));
                counts.springs += 1;
                let arguments = [
                    "ROTATION".into(),
                    format!("I = {i}"),
                    format!("J = {j}"),
                    number("KT", *stiffness_nm_rad),
                    number("CT", *damping_nm_s_rad),
                    "ANGLE = 0".into(),
                    "TORQUE = 0".into(),
                ];
                self.data.named("SPRINGDAMPER", counts.springs, id, &arguments);
            }
            Force::Hinge { .. } => self.hinge(force, counts),
            Force::Force { id, body, point_m, force_n, from_to_s } => {
                counts.forces += 1;
                let number = counts.forces;
                self.applied(id, ["VFORCE", "F"], number, (body, *point_m), *force_n, *from_to_s);
            }
            Force::Torque { id, body, torque_nm, from_to_s } => {
                counts.torques += 1;
                let at = self.body(self.part(Some(body))).map_or([0.0; 3], |b| b.position_m);
                let number = counts.torques;
                self.applied(id, ["VTORQUE", "T"], number, (body, at), *torque_nm, *from_to_s);
            }
        }
    }

    /// Three torques along the axes that the first body has at the start, over the angles of the second against the first.
    fn hinge(&mut self, force: &Force, counts: &mut Counts) {
        let Force::Hinge { id, body_a, body_b, stiffness_nm_rad, capacity, fracture_rad, .. } = force else {
            return;
        };
        let spline = self.spline(id, &of_hinge(*stiffness_nm_rad, capacity));
        let [a, b] = [self.part(body_a.as_deref()), self.part(Some(body_b))];
        let at = self.body(b).map_or([0.0; 3], |body| body.position_m);
        let axes = self.body(a).map_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], |body| {
            crate::mbs::math::transpose(&super::turn(body))
        });
        counts.torques += 1;
        self.torques(id, counts.torques, [a, b], at, &axes, [Some(spline); 3]);
        self.notes
            .add(id, "it unloads along its curve, not elastically, and its angles are those of AX, AY, AZ");
        if let Some(limit) = fracture_rad {
            self.notes.add(id, format!("fracture at {} rad is left out", plain(*limit)));
        }
    }

    /// A torque on the second part about each axis that has a spline.
    fn torques(
        &mut self,
        id: &str,
        number: usize,
        [a, b]: [usize; 2],
        at: [f64; 3],
        axes: &M3,
        splines: [Option<usize>; 3],
    ) {
        let j = self.marker_at(a, at, Some(axes));
        let i = self.marker_at(b, at, Some(axes));
        let float = self.data.floating(a);
        let mut arguments = vec![format!("I = {i}"), format!("JFLOAT = {float}"), format!("RM = {j}")];
        let term = |k: usize| {
            let axis = ["X", "Y", "Z"][k];
            let value = splines[k].map_or("0".into(), |s| format!("-AKISPL(A{axis}({i},{j}),0,{s},0)"));
            format!("T{axis} = {value}{}", if k < 2 { "\\" } else { "" })
        };
        arguments.extend((0..3).map(term));
        self.data.named("VTORQUE", number, id, &arguments);
    }

    /// Moment over rotation in both senses.
    fn spline(&mut self, id: &str, line: &[[f64; 2]]) -> usize {
        let all = both_senses(line);
        self.splines += 1;
        let [x, y] = [0, 1].map(|k: usize| list(&all.iter().map(|p| p[k]).collect::<Vec<_>>(), "\n, "));
        let name = format!("{id}_spline");
        self.data.named("SPLINE", self.splines, &name, &[format!("X = {x}"), format!("Y = {y}")]);
        self.splines
    }

    fn applied(
        &mut self,
        id: &str,
        [statement, letter]: [&str; 2],
        number: usize,
        (body, at): (&str, [f64; 3]),
        load: [f64; 3],
        span: Option<[f64; 2]>,
    ) {
        let part = self.part(Some(body));
        let i = self.marker_at(part, at, None);
        let float = self.data.floating(super::GROUND);
        let during = span.map_or(String::new(), |[from, to]| {
            format!("*IF(TIME-{}:0,1,1)*IF(TIME-{}:1,0,0)", plain(from), plain(to))
        });
        let mut arguments =
            vec![format!("I = {i}"), format!("JFLOAT = {float}"), format!("RM = {}", self.origin)];
        let term = |k: usize| {
            let end = if k < 2 { "\\" } else { "" };
            format!("{letter}{} = {}{during}{end}", ["X", "Y", "Z"][k], plain(load[k]))
        };
        arguments.extend((0..3).map(term));
        self.data.named(statement, number, id, &arguments);
    }

    fn bushing(&mut self, bushing: &Bushing, number: usize, counts: &mut Counts) {
        let [a, b] = [self.part(bushing.body_a.as_deref()), self.part(Some(&bushing.body_b))];
        // the J marker carries the axes, the force acts at the I marker
        let i = self.marker_at(a, bushing.point_m, Some(&bushing.axes));
        let j = self.marker_at(b, bushing.point_m, Some(&bushing.axes));
        let [s1, s2] = bushing.shear_stiffness_n_m;
        let mut turning = [bushing.torsional_stiffness_nm_rad, 0.0, 0.0];
        let mut splines = [None; 3];
        for k in 0..2 {
            match &bushing.bending[k] {
                Bending::Elastic { stiffness_nm_rad } => turning[k + 1] = *stiffness_nm_rad,
                Bending::Curve { curve, .. } if bushing.beam.is_some() => {
                    turning[k + 1] = self.model.curves.get(curve).map_or(0.0, |c| c.stiffness_nm_rad);
                    self.notes.add(&bushing.id, BEAM_STAYS_ELASTIC);
                }
                Bending::Curve { curve, strength_factor } => {
                    if let Some(curve) = self.model.curves.get(curve) {
                        let name = format!("{}_{}", bushing.id, k + 1);
                        splines[k + 1] = Some(self.spline(&name, &of_curve(curve, *strength_factor)));
                        let text = format!(
                            "bending {}: it unloads along its curve without axial force; fracture and the effect of axial force are left out",
                            k + 1
                        );
                        self.notes.add(&bushing.id, text);
                    }
                }
            }
        }
        let arguments = [
            format!("I = {i}"),
            format!("J = {j}"),
            "C = 0, 0, 0".into(),
            format!("K = {}", list(&[bushing.axial_stiffness_n_m, s1, s2], ", ")),
            "CT = 0, 0, 0".into(),
            format!("KT = {}", list(&turning, ", ")),
            "FORCE = 0, 0, 0".into(),
            "TORQUE = 0, 0, 0".into(),
        ];
        self.data.named("BUSHING", number, &bushing.id, &arguments);
        if splines.iter().any(Option::is_some) {
            counts.torques += 1;
            self.torques(&bushing.id, counts.torques, [a, b], bushing.point_m, &bushing.axes, splines);
        }
        self.notes.add_of_bushing(bushing);
    }
}

/// A line through the origin, odd, with two points on either side of each corner: between them AKISPL is straight, so that only the corner is rounded.
fn both_senses(line: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut right: Vec<[f64; 2]> = line.iter().copied().filter(|p| p[0] > 0.0).collect();
    if let Some([x, m]) = right.last().copied() {
        right.push([x + BEYOND_RAD, m]);
    }
    let mut all: Vec<[f64; 2]> = right.iter().rev().map(|[x, m]| [-x, -m]).collect();
    all.push([0.0, 0.0]);
    all.extend(right);
    let mut dense = vec![all[0]];
    for (i, pair) in all.windows(2).enumerate() {
        let length = |k: usize| all.get(k + 1).map_or(f64::INFINITY, |next| next[0] - all[k][0]);
        let [near, far] = [i.checked_sub(1).map_or(f64::INFINITY, length), length(i + 1)];
        let own = length(i);
        let at = |x: f64| [x, pair[0][1] + (pair[1][1] - pair[0][1]) * (x - pair[0][0]) / own];
        let (first, last) = (ROUND * own.min(near), ROUND * own.min(far));
        let inner =
            [pair[0][0] + first, pair[0][0] + 2.0 * first, pair[1][0] - 2.0 * last, pair[1][0] - last];
        dense.extend(inner.map(at));
        dense.push(pair[1]);
    }
    dense
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_are_odd_and_rise_and_lie_on_the_line() {
        let line = [[0.0, 0.0], [0.006, 120e3], [0.03, 120e3], [0.15, 0.0]];
        let all = both_senses(&line);
        assert!(all.windows(2).all(|p| p[1][0] > p[0][0]), "{all:?}");
        for [x, m] in &all {
            let wanted = crate::base::piecewise::interpolate(&line, x.abs()) * x.signum();
            assert!((m - wanted).abs() < 1e-6, "{x}: {m} {wanted}");
        }
        assert!(all.iter().zip(all.iter().rev()).all(|(a, b)| (a[0] + b[0]).abs() < 1e-12));
    }
}
