//! The beam element: stiffness, consistent loads, and the way from nodes to end points.

use crate::base::vector::{cross, norm, sub, unit};

/// Elastic properties of a beam's section in its own axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamSection {
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Shear modulus \[Pa\].
    pub shear_modulus_pa: f64,
    /// Area \[m²\].
    pub area_m2: f64,
    /// Shear areas along axes 1 and 2 \[m²\]; infinite without shear deformation.
    pub shear_area_m2: [f64; 2],
    /// Torsion constant \[m⁴\].
    pub torsion_m4: f64,
    /// Second moments of area about axes 1 and 2 \[m⁴\].
    pub inertia_m4: [f64; 2],
    /// The slab that bends with it about axis 1, and is in the second moment of area.
    pub flange: Option<Flange>,
}

/// Second moments of area of a beam and the slab that bends with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flange {
    /// Each about its own centre \[m⁴\].
    pub apart_m4: f64,
    /// As one section with all of the slab beside the beam \[m⁴\].
    pub whole_m4: f64,
    /// As one section with what of the slab bends with the beam under moments that keep their sense over the span \[m⁴\].
    pub long_m4: f64,
}

impl BeamSection {
    /// A rectangle of `width_m` along axis 1 and `depth_m` along axis 2. Shear areas 5/6 A; torsion constant
    /// `a b³ (1/3 − 0.21 b/a (1 − b⁴/(12 a⁴)))`, a >= b (Young and Budynas, *Roark's Formulas*, table 10.1).
    pub fn rectangle(youngs_modulus_pa: f64, poisson_ratio: f64, [width_m, depth_m]: [f64; 2]) -> Self {
        let area_m2 = width_m * depth_m;
        let (a, b) = (width_m.max(depth_m), width_m.min(depth_m));
        let slim = b / a;
        Self {
            youngs_modulus_pa,
            shear_modulus_pa: youngs_modulus_pa / (2.0 * (1.0 + poisson_ratio)),
            area_m2,
            shear_area_m2: [5.0 / 6.0 * area_m2; 2],
            torsion_m4: a * b.powi(3) * (1.0 / 3.0 - 0.21 * slim * (1.0 - slim.powi(4) / 12.0)),
            inertia_m4: [width_m * depth_m.powi(3) / 12.0, depth_m * width_m.powi(3) / 12.0],
            flange: None,
        }
    }
}

/// A uniform load on a stretch of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineLoad {
    /// First and last point of the stretch as shares of the length, 0..1.
    pub stretch: [f64; 2],
    /// Load along the global axes \[N/m\].
    pub force_n_m: [f64; 3],
    /// Torque about the element's first axis \[N m/m\].
    pub torque_nm_m: f64,
}

/// A beam between two end points, each tied rigidly to a node.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Name of the member it belongs to, for messages.
    pub member: String,
    /// Node indices.
    pub nodes: [usize; 2],
    /// End points; where they are not at the nodes the link is rigid \[m\].
    pub ends_m: [[f64; 3]; 2],
    /// Direction of axis 1; what is not normal to the element is ignored. Axis 2 = axis 0 × axis 1.
    pub axis1: [f64; 3],
    /// Section.
    pub section: BeamSection,
    /// Loads.
    pub loads: Vec<LineLoad>,
}

/// Square matrix of the twelve end degrees of freedom, `[end 1: u, r, end 2: u, r]`.
pub type Matrix12 = [[f64; 12]; 12];
/// Vector of the twelve end degrees of freedom.
pub type Vector12 = [f64; 12];

/// Bending planes: `(translation, rotation, sign)` with `rotation = sign · d translation / dx`.
const PLANES: [(usize, usize, f64); 2] = [(1, 5, 1.0), (2, 4, -1.0)];

impl Element {
    /// Length between the end points \[m\].
    pub fn length_m(&self) -> f64 {
        norm(sub(self.ends_m[1], self.ends_m[0]))
    }

    /// Rows: axes 0, 1, 2.
    pub fn axes(&self) -> [[f64; 3]; 3] {
        let along = unit(sub(self.ends_m[1], self.ends_m[0]));
        let in_axis: f64 = (0..3).map(|i| self.axis1[i] * along[i]).sum();
        let axis1 = unit(std::array::from_fn(|i| self.axis1[i] - in_axis * along[i]));
        [along, axis1, cross(along, axis1)]
    }

    /// Stiffness in local axes at the end points.
    pub fn stiffness(&self) -> Matrix12 {
        let (s, length) = (&self.section, self.length_m());
        let mut k = [[0.0; 12]; 12];
        let mut spring = |i: usize, value: f64| {
            k[i][i] += value;
            k[i + 6][i + 6] += value;
            k[i][i + 6] -= value;
            k[i + 6][i] -= value;
        };
        spring(0, s.youngs_modulus_pa * s.area_m2 / length);
        spring(3, s.shear_modulus_pa * s.torsion_m4 / length);
        for (plane, (u, r, sign)) in PLANES.into_iter().enumerate() {
            let bending = s.youngs_modulus_pa * s.inertia_m4[1 - plane];
            let phi = self.shear_ratio(plane);
            let c = bending / (length.powi(3) * (1.0 + phi));
            let (l6, l4, l2) = (6.0 * length, (4.0 + phi) * length * length, (2.0 - phi) * length * length);
            let rows = [[12.0, l6, -12.0, l6], [l6, l4, -l6, l2], [-12.0, -l6, 12.0, -l6], [l6, l2, -l6, l4]];
            let at = [u, r, u + 6, r + 6];
            let turn = [1.0, sign, 1.0, sign];
            for i in 0..4 {
                for j in 0..4 {
                    k[at[i]][at[j]] += c * turn[i] * turn[j] * rows[i][j];
                }
            }
        }
        k
    }

    /// `Φ = 12 E I / (G A_s L²)` of a bending plane.
    fn shear_ratio(&self, plane: usize) -> f64 {
        let (s, length) = (&self.section, self.length_m());
        let bending = s.youngs_modulus_pa * s.inertia_m4[1 - plane];
        12.0 * bending / (s.shear_modulus_pa * s.shear_area_m2[plane] * length * length)
    }

    /// Consistent loads in local axes at the end points. The shape functions solve the homogeneous beam
    /// equation, so the end forces are exact. Two Gauss points integrate their cubics exactly.
    pub fn equivalent_load(&self) -> Vector12 {
        let (axes, length) = (self.axes(), self.length_m());
        let mut p = [0.0; 12];
        for load in &self.loads {
            let local: [f64; 3] =
                std::array::from_fn(|row| (0..3).map(|i| axes[row][i] * load.force_n_m[i]).sum());
            let (mid, half) =
                (0.5 * (load.stretch[0] + load.stretch[1]), 0.5 * (load.stretch[1] - load.stretch[0]));
            for x in [mid - half / 3f64.sqrt(), mid + half / 3f64.sqrt()] {
                let weight = half * length;
                p[0] += weight * local[0] * (1.0 - x);
                p[6] += weight * local[0] * x;
                p[3] += weight * load.torque_nm_m * (1.0 - x);
                p[9] += weight * load.torque_nm_m * x;
                for (plane, (u, r, sign)) in PLANES.into_iter().enumerate() {
                    let n = shape(x, length, self.shear_ratio(plane));
                    for (slot, value, turn) in
                        [(u, n[0], 1.0), (r, n[1], sign), (u + 6, n[2], 1.0), (r + 6, n[3], sign)]
                    {
                        p[slot] += weight * local[u] * value * turn;
                    }
                }
            }
        }
        p
    }

    /// From the degrees of freedom of the two nodes (global) to those of the end points (local): rigid offset, then
    /// rotation.
    pub fn from_nodes(&self, node_points_m: [[f64; 3]; 2]) -> Matrix12 {
        let axes = self.axes();
        let mut b = [[0.0; 12]; 12];
        for end in 0..2 {
            let arm = sub(self.ends_m[end], node_points_m[end]);
            for row in 0..3 {
                for j in 0..3 {
                    b[6 * end + row][6 * end + j] = axes[row][j];
                    b[6 * end + 3 + row][6 * end + 3 + j] = axes[row][j];
                }
                // u + θ × arm, component along the axis e: θ · (arm × e).
                let lever = cross(arm, axes[row]);
                for j in 0..3 {
                    b[6 * end + row][6 * end + 3 + j] = lever[j];
                }
            }
        }
        b
    }
}

/// Shape functions of the deflection for unit end deflections and slopes, `x` in 0..1.
fn shape(x: f64, length: f64, phi: f64) -> [f64; 4] {
    let (x2, x3) = (x * x, x * x * x);
    let d = 1.0 + phi;
    [
        (1.0 - 3.0 * x2 + 2.0 * x3 + phi * (1.0 - x)) / d,
        length * (x - 2.0 * x2 + x3 + 0.5 * phi * (x - x2)) / d,
        (3.0 * x2 - 2.0 * x3 + phi * x) / d,
        length * (-x2 + x3 - 0.5 * phi * (x - x2)) / d,
    ]
}
