//! What of a floor crosses a cut between two of its pieces: beams with their flanges, strips, and the slab beside them.

use super::cells::Piece;
use super::junction;
use super::panels::Given;
use crate::building::rows::MEETS_M;
use crate::building::{Building, MemberKind};
use crate::graph::frame::Element;
use crate::graph::shear_lag::{Stretch, bending_n_m2};
use crate::rc::layers::Held;

/// Share of the torsion constant of a rectangle that a strip of a plate has in either direction (Hambly, Bridge Deck Behaviour, 1976, section 3.4).
const PLATE_TORSION: f64 = 0.5;

/// A cut between two pieces of a floor, in the middle between their axes.
#[derive(Debug, Clone)]
pub struct Cut {
    /// Direction of the span.
    pub axis: usize,
    /// The pieces on its lower and its upper side, by their places in the floor.
    pub pieces: [usize; 2],
    /// Where the spring is \[m\].
    pub point_m: [f64; 3],
    /// Faces of the columns on both sides, or of what else the slab ends at \[m\].
    pub faces_m: [f64; 2],
    /// What holds the rows of elements at its ends.
    pub held: Held,
    /// The axes that it is between \[m\].
    pub axes_m: [f64; 2],
    /// What bends along the span, and that with what of its beams bends in their joints \[m\].
    pub length_m: f64,
    pub bends_m: f64,
    /// The section in the plane of the floor.
    pub plane: InPlane,
    /// What crosses it.
    pub sum: Crossing,
    /// What of the resistance of its slab springs across panels have.
    pub given: Given,
    /// The lines of slabs that it is on, and whether what crosses it may yield.
    pub lines: Vec<String>,
    pub yields: bool,
}

/// Sums over the beams that cross a cut.
#[derive(Debug, Clone, Copy, Default)]
pub struct Crossing {
    /// Bending stiffness about the horizontal axis \[N m²\] against rotation and against displacement across ([`crate::graph::shear_lag`]).
    pub bending: f64,
    pub across: f64,
    /// Torsional stiffness, and what of it slabs have \[N m²\].
    pub torsion: f64,
    pub slab_torsion: f64,
    /// What the junctions of beams and slabs have besides \[N m²\].
    pub junctions: f64,
    /// Shear stiffness in vertical direction \[N\].
    pub shear: f64,
    /// Heights of the beams, times their bending stiffness \[N m³\].
    pub level: f64,
    /// Whether a beam crosses it.
    pub has_beam: bool,
    /// Share of the width of the section in which a slab bends for itself, neither in beams nor in strips.
    pub plate_share: f64,
}

impl Crossing {
    /// Of those beams and strips of a floor that cross a cut in the section of a piece, and of the slab beside them; none if there are none.
    pub fn of(
        beams: &[(&Element, MemberKind)],
        (axis, at_m): (usize, f64),
        section: &InPlane,
        stretch: &Stretch,
    ) -> Option<Self> {
        let mut sum = Self::default();
        // widths of slab that bend, and that twist, in beams and strips
        let (mut bent_m, mut twisted_m) = (0.0, 0.0);
        for (element, kind) in beams {
            let [p, q] = element.ends_m;
            let crosses = (p[axis] - at_m) * (q[axis] - at_m) < 0.0;
            if !crosses || p[1 - axis] < section.edges[0] || p[1 - axis] > section.edges[1] {
                continue;
            }
            let g = element.section.shear_modulus_pa;
            // along axis 1 a beam is as wide as its web, also where a slab is its flange
            let shear_m2 = 1.2 * element.section.shear_area_m2[1];
            let web_m = (12.0 * element.section.inertia_m4[1] / shear_m2).sqrt();
            let in_slab_m = (element.section.area_m2 - shear_m2) / section.thickness_m.max(MEETS_M);
            let is_strip = *kind == MemberKind::Slab;
            bent_m += web_m + in_slab_m;
            twisted_m += web_m;
            let share = if is_strip { PLATE_TORSION } else { 1.0 };
            let torsion = share * g * element.section.torsion_m4;
            if !is_strip && section.slab_m > 0.0 {
                let [low_m, high_m] = [-0.5, 0.5].map(|k| p[1 - axis] + k * web_m);
                // a slab that ends beside the web is none
                let least_m = 0.5 * section.thickness_m;
                let beside = [section.edges[0] < low_m - least_m, section.edges[1] > high_m + least_m];
                let sides = beside.iter().filter(|goes_on| **goes_on).count();
                let depth_m = shear_m2 / web_m;
                sum.junctions += g * junction::torsion_m4([web_m, depth_m], section.thickness_m, sides);
            }
            sum.slab_torsion += if is_strip { torsion } else { 0.0 };
            let bending = bending_n_m2(&element.section, stretch);
            sum.add(bending, torsion, g * element.section.shear_area_m2[1], p[2]);
            sum.has_beam = true;
        }
        for plate in &section.plates {
            let share = plate.width_m / section.slab_m;
            let left = |used_m: f64| (section.slab_m - used_m).max(0.0) * share;
            let [e, g] = plate.moduli_pa;
            let cubed = plate.thickness_m.powi(3);
            let torsion = PLATE_TORSION * g * left(twisted_m) * cubed / 3.0;
            sum.slab_torsion += torsion;
            sum.add(
                [e * left(bent_m) * cubed / 12.0; 2],
                torsion,
                5.0 / 6.0 * g * left(bent_m) * plate.thickness_m,
                plate.level_m,
            );
        }
        let width_m = section.edges[1] - section.edges[0];
        sum.plate_share = ((section.slab_m - bent_m) / width_m).clamp(0.0, 1.0);
        (sum.bending > 0.0).then_some(sum)
    }

    /// Share of its bending stiffness that the slabs of a section have by themselves.
    pub fn slab_share(&self, section: &InPlane) -> f64 {
        section.slab_nm().map_or(0.0, |(bending, _)| section.slab_m * bending / self.bending)
    }

    /// What holds the rows of elements at the ends of a cut through a floor with spans that a slab bridges by itself.
    pub fn held(&self, has_columns: bool) -> Held {
        match (self.has_beam, has_columns) {
            (true, _) => Held::AtJoint,
            (false, true) => Held::OverColumns,
            (false, false) => Held::OneWay,
        }
    }

    /// Adds a beam or a plate at a height.
    fn add(&mut self, [bending, across]: [f64; 2], torsion: f64, shear: f64, level_m: f64) {
        self.bending += bending;
        self.across += across;
        self.torsion += torsion;
        self.shear += shear;
        self.level += bending * level_m;
    }
}

impl Cut {
    /// Stiffnesses of its spring against rotation about the horizontal \[N m/rad\] and against vertical displacement \[N/m\]: in their joints beams bend, but do not shear.
    pub fn in_the_middle(&self) -> [f64; 2] {
        let Crossing { bending, across, shear, .. } = self.sum;
        in_the_middle([bending, across], shear * self.bends_m / self.length_m, self.bends_m)
    }
}

/// Stiffnesses against rotation \[N m/rad\] and against displacement across \[N/m\] of the springs in the middle of a beam of bending stiffness `E I`, which may differ for both, and shear stiffness `G A_s`.
pub fn in_the_middle([bending, across]: [f64; 2], shear: f64, length_m: f64) -> [f64; 2] {
    [bending / length_m, 1.0 / (length_m.powi(3) / (12.0 * across) + length_m / shear)]
}

/// The section of a piece where it meets the next one, in the plane of the floor.
#[derive(Debug, Clone, Default)]
pub struct InPlane {
    /// Its edges across the span \[m\].
    pub edges: [f64; 2],
    /// Axial stiffness, shear stiffness \[N\] and bending stiffness about the vertical \[N m²\].
    pub axial: f64,
    pub shear: f64,
    pub bending: f64,
    /// Height of its centre, by axial stiffness \[m\].
    pub level_m: f64,
    /// Mass per length along the span \[kg/m\].
    pub mass_kg_m: f64,
    /// Its slabs, their width together and the greatest thickness \[m\].
    pub plates: Vec<Plate>,
    pub slab_m: f64,
    pub thickness_m: f64,
}

/// A slab in a section.
#[derive(Debug, Clone)]
pub struct Plate {
    pub width_m: f64,
    pub thickness_m: f64,
    /// Height of its middle \[m\].
    pub level_m: f64,
    /// Young's and shear modulus \[Pa\].
    pub moduli_pa: [f64; 2],
}

impl InPlane {
    pub fn of(building: &Building, piece: &Piece, axis: usize) -> Self {
        let across = 1 - axis;
        let end = piece.boxes.iter().map(|(_, b)| b.max[axis]).fold(f64::NEG_INFINITY, f64::max);
        let mut this = Self { edges: [f64::INFINITY, f64::NEG_INFINITY], ..Self::default() };
        for (member, solid) in piece.boxes.iter().filter(|(_, b)| b.max[axis] > end - MEETS_M) {
            let law = building.law_of(&building.members[*member]);
            let size = solid.size();
            let area = size[across] * size[2];
            this.edges[0] = this.edges[0].min(solid.min[across]);
            this.edges[1] = this.edges[1].max(solid.max[across]);
            this.mass_kg_m += law.density_kg_m3 * area;
            this.axial += law.youngs_modulus_pa * area;
            this.level_m += law.youngs_modulus_pa * area * solid.center()[2];
            this.shear += 5.0 / 6.0 * area * law.shear_modulus_pa();
            if building.members[*member].kind == MemberKind::Slab {
                this.slab_m += size[across];
                this.thickness_m = this.thickness_m.max(size[2]);
                this.plates.push(Plate {
                    width_m: size[across],
                    thickness_m: size[2],
                    level_m: solid.center()[2],
                    moduli_pa: [law.youngs_modulus_pa, law.shear_modulus_pa()],
                });
            }
        }
        this.level_m /= this.axial;
        let width = (this.edges[1] - this.edges[0]).max(0.0);
        this.bending = this.axial * width * width / 12.0;
        this
    }

    /// Bending stiffness of its slabs by themselves, `E t³ / 12` of a unit of their width \[N m\], and their Poisson's ratio; none without slabs.
    pub fn slab_nm(&self) -> Option<(f64, f64)> {
        let own = |p: &Plate| p.moduli_pa[0] * p.width_m * p.thickness_m.powi(3) / 12.0;
        let bending = self.plates.iter().map(own).sum::<f64>() / self.slab_m;
        let [e, g] = self.plates.first()?.moduli_pa;
        Some((bending, e / (2.0 * g) - 1.0))
    }

    /// Mean height of the middle of its slabs \[m\]; none without slabs.
    pub fn slab_level_m(&self) -> Option<f64> {
        let sum: f64 = self.plates.iter().map(|p| p.width_m * p.level_m).sum();
        (self.slab_m > 0.0).then_some(sum / self.slab_m)
    }
}

#[cfg(test)]
impl InPlane {
    /// Of a slab by itself.
    pub fn of_slab(plate: Plate) -> Self {
        let Plate { width_m, thickness_m, level_m, .. } = plate;
        let (edges, plates) = ([0.0, width_m], vec![plate]);
        Self { edges, level_m, plates, slab_m: width_m, thickness_m, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::frame::BeamSection;

    #[test]
    fn rigid_halves_with_springs_in_the_middle_are_the_beam() {
        let section = BeamSection::rectangle(16.5e9, 0.2, [0.4, 0.6]);
        let length = 5.2;
        let beam = Element {
            member: "B".into(),
            nodes: [0, 1],
            ends_m: [[0.0; 3], [length, 0.0, 0.0]],
            axis1: [0.0, 1.0, 0.0],
            section,
            loads: Vec::new(),
        };
        let exact = beam.stiffness();
        let bending = section.youngs_modulus_pa * section.inertia_m4[0];
        let [turn, shear] =
            in_the_middle([bending; 2], section.shear_modulus_pa * section.shear_area_m2[1], length);
        // displacement across and rotation about axis 1 of both ends; what they do to the springs
        let freedoms = [2, 4, 8, 10];
        let half = 0.5 * length;
        let rotation = [0.0, -1.0, 0.0, 1.0];
        let gap = [-1.0, half, 1.0, half];
        for i in 0..4 {
            for j in 0..4 {
                let k = turn * rotation[i] * rotation[j] + shear * gap[i] * gap[j];
                let wanted = exact[freedoms[i]][freedoms[j]];
                let scale = (exact[freedoms[i]][freedoms[i]] * exact[freedoms[j]][freedoms[j]]).sqrt();
                assert!((k - wanted).abs() < 1e-12 * scale, "{i} {j}: {k} {wanted}");
            }
        }
    }

    #[test]
    fn a_slab_twists_as_a_plate_also_beside_beams() {
        let [width, thickness] = [3.0, 0.2];
        let plate = Plate { width_m: width, thickness_m: thickness, level_m: 3.0, moduli_pa: [16.5e9, 7e9] };
        let section = InPlane::of_slab(plate);
        let stretch = Stretch { span_m: 4.6, ends_m: [0.2, 4.8], beyond_m: [None; 2] };
        let per_width = 7e9 * thickness.powi(3) / 6.0;
        let alone = Crossing::of(&[], (0, 2.5), &section, &stretch).unwrap();
        assert!((alone.torsion / (width * per_width) - 1.0).abs() < 1e-12);
        assert!((alone.bending / (16.5e9 * width * thickness.powi(3) / 12.0) - 1.0).abs() < 1e-12);
        assert_eq!(alone.level / alone.bending, 3.0);
        // a beam of 0.4 m with a flange of 1 m: 2.6 m of slab twist, 1.6 m bend for themselves
        let mut own = BeamSection::rectangle(16.5e9, 0.2, [0.4, 0.6]);
        own.area_m2 += thickness;
        let beam = Element {
            member: "B".into(),
            nodes: [0, 1],
            ends_m: [[0.0, 0.2, 2.9], [5.0, 0.2, 2.9]],
            axis1: [0.0, 1.0, 0.0],
            section: own,
            loads: Vec::new(),
        };
        let both = Crossing::of(&[(&beam, MemberKind::Beam)], (0, 2.5), &section, &stretch).unwrap();
        let torsion = own.shear_modulus_pa * own.torsion_m4 + 2.6 * per_width;
        assert!((both.torsion / torsion - 1.0).abs() < 1e-9, "{} {torsion}", both.torsion);
        let bending = 16.5e9 * (own.inertia_m4[0] + 1.6 * thickness.powi(3) / 12.0);
        assert!((both.bending / bending - 1.0).abs() < 1e-9, "{} {bending}", both.bending);
    }
}
