//! Crushing of the end of a member that strikes something: a prism of a homogenised law that is driven against a rough, rigid face.
//!
//! The prism is the member up to its point of inflection, in elements of the building's size. Its far section stays plane and is driven along the axis; the near one meets the face with friction. Layers of elements
//! flow together, harden, and erode one after the other: what is above falls onto what is left. The force at the far section over its way is the resistance of the end to crushing. The run is slow
//! ([`SPEED_M_S`]), so that waves do not count; laws that know the strain rate are taken without it.

use crate::building::Homogenised;
use crate::fe::contact::{BodyContact, RigidSurfaces};
use crate::fe::dynamics::Dynamics;
use crate::fe::grid::ELEMENTS_ACROSS;
use crate::fe::law::Law;
use crate::fe::mesh::{Element, Mesh};
use crate::fe::model::ContactSettings;

/// Shortening at which a member that stays straight has lost half of its force to layers that erode, over the rupture strain of its law times its length: 0.95 if all layers were strained alike (`(1 - exp(-ε)) / ε`); those at its
/// ends are held across and strained less. 0.72 to 0.83 of columns of 2.5 to 3.5 m at rupture strains of 0.05 to 0.2 (`tests/rc/crushing.rs`).
pub const CRUSHED_SHARE: f64 = 0.8;
/// Speed of the far section \[m/s\], reached after [`RAMP_S`] \[s\].
pub const SPEED_M_S: f64 = 2.0;
/// See [`SPEED_M_S`].
const RAMP_S: f64 = 0.01;
/// Share of the length to which a prism is crushed.
const UNTIL: f64 = 0.5;
/// Intervals of the way over which the force is averaged, over the length: elastic, while layers flow together, and after the first of them eroded, when layers fall onto each other.
const SAMPLES: [f64; 3] = [1e-4, 5e-3, 5e-2];
/// Share of the length up to which the first of them holds.
const ELASTIC: f64 = 4e-3;
/// Share of the largest force below which layers have eroded.
const ERODED: f64 = 0.5;

/// The end of a member.
#[derive(Debug, Clone, PartialEq)]
pub struct Prism {
    /// Sides of the section \[m\].
    pub section_m: [f64; 2],
    /// Length to the point of inflection \[m\].
    pub length_m: f64,
    /// Size of the elements \[m\].
    pub mesh_size_m: f64,
    /// Its law.
    pub law: Homogenised,
    /// Further factor on its strength.
    pub strength: f64,
    /// Coefficient of friction on the face and of the prism with itself.
    pub friction: f64,
}

/// Resistance of an end to crushing.
#[derive(Debug, Clone, PartialEq)]
pub struct Crushing {
    /// `[shortening (m), force (N)]`, shortenings increasing, from zero.
    pub points: Vec<[f64; 2]>,
    /// Work of the drive \[J\].
    pub work_j: f64,
    /// Largest kinetic over internal energy beyond a shortening of a hundredth of the length.
    pub kinetic_share: f64,
    /// Elements, and how many of them eroded.
    pub elements: [usize; 2],
}

/// A prism that cannot be crushed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CrushingError {
    /// The run produced numbers that are not finite.
    #[error("end of {0:.3} m by {1:.3} m: not finite at a shortening of {2:.4} m")]
    NotFinite(f64, f64, f64),
}

impl Prism {
    /// Crushes it.
    ///
    /// # Errors
    /// If the run does not stay finite.
    pub fn crush(&self) -> Result<Crushing, CrushingError> {
        let (mesh, far) = self.mesh();
        let mut surfaces = RigidSurfaces::default();
        surfaces.ground = Some((0.0, self.friction));
        let mut body = Dynamics::new(&mesh, 0.0, surfaces, false);
        body.body_contact =
            Some(Box::new(BodyContact::new(&mesh, ContactSettings { friction: self.friction })));
        let mut line = Line::default();
        let (mut kinetic_share, mut eroded) = (0.0_f64, 0);
        let way = |body: &Dynamics| self.length_m - body.x[far[0]][2];
        while way(&body) < UNTIL * self.length_m {
            let speed = SPEED_M_S * (body.time_s / RAMP_S).min(1.0);
            for n in &far {
                body.prescribed_m_s[*n] = [Some(0.0), Some(0.0), Some(-speed)];
            }
            body.step(false);
            eroded += body.deaths.len();
            let at = way(&body);
            let force = -far.iter().map(|n| body.internal_n(*n)[2]).sum::<f64>();
            line.add(at, force, self.length_m);
            if body.steps.is_multiple_of(1024) {
                if body.broken_node().is_some() {
                    let [a, b] = self.section_m;
                    return Err(CrushingError::NotFinite(a, b, at));
                }
                if at > 0.01 * self.length_m {
                    let internal = body.blocks.energies_j()[0].max(1.0);
                    kinetic_share = kinetic_share.max(body.kinetic_j() / internal);
                }
            }
        }
        let (points, work_j) = (line.points(), line.work_j());
        Ok(Crushing { points, work_j, kinetic_share, elements: [mesh.elements.len(), eroded] })
    }

    /// Elements along each side and the length.
    fn counts(&self) -> [usize; 3] {
        let across = |m: f64| ((m / self.mesh_size_m).round() as usize).max(ELEMENTS_ACROSS);
        let [a, b] = self.section_m.map(across);
        [a, b, ((self.length_m / self.mesh_size_m).round() as usize).max(1)]
    }

    /// The prism on the plane z = 0, and the nodes of its far section.
    fn mesh(&self) -> (Mesh, Vec<usize>) {
        let counts = self.counts();
        let size = [self.section_m[0], self.section_m[1], self.length_m];
        let stride = [1, counts[0] + 1, (counts[0] + 1) * (counts[1] + 1)];
        let at = |i: usize, k: usize| size[i] * k as f64 / counts[i] as f64;
        let mut nodes = Vec::new();
        for z in 0..=counts[2] {
            for y in 0..=counts[1] {
                nodes.extend((0..=counts[0]).map(|x| [at(0, x), at(1, y), at(2, z)]));
            }
        }
        let cells = (0..counts[2]).flat_map(|z| (0..counts[1]).map(move |y| [y, z]));
        let first = cells.flat_map(|[y, z]| (0..counts[0]).map(move |x| x + stride[1] * y + stride[2] * z));
        let bottom = |n: usize| [n, n + 1, n + 1 + stride[1], n + stride[1]];
        let element = |n: usize| {
            let ([a, b, c, d], [e, f, g, h]) = (bottom(n), bottom(n + stride[2]));
            let nodes = [a, b, c, d, e, f, g, h];
            Element { nodes, part: 0, law: 0, smear: 1.0, strength: self.strength }
        };
        let elements = first.map(element).collect();
        let far = (stride[2] * counts[2]..nodes.len()).collect();
        // the run is slow: no effect of the rate belongs to it
        let law = Law { rate: None, ..Law::from(&self.law) };
        (Mesh { nodes, elements, laws: vec![law], parts: vec!["end".into()], ..Mesh::default() }, far)
    }
}

/// Means of the force over intervals of the way: their work is that of the drive.
#[derive(Debug, Default)]
struct Line {
    /// End of each interval and mean force over it.
    means: Vec<[f64; 2]>,
    work: f64,
    at: f64,
    from: f64,
    peak: f64,
    eroded: bool,
}

impl Line {
    /// Takes in the force at a way.
    fn add(&mut self, way: f64, force: f64, length: f64) {
        self.work += force * (way - self.at);
        self.at = way;
        let phase = if self.eroded { 2 } else { usize::from(way >= ELASTIC * length) };
        let sample = SAMPLES[phase];
        if way - self.from >= sample * length {
            let mean = (self.work / (way - self.from)).max(0.0);
            self.peak = self.peak.max(mean);
            self.eroded |= mean < ERODED * self.peak;
            self.means.push([way, mean]);
            (self.work, self.from) = (0.0, way);
        }
    }

    /// Points in the middle of each interval, from zero; the work up to the last one is that of the means within a hundredth of it.
    fn points(&self) -> Vec<[f64; 2]> {
        let mut from = 0.0;
        let middle = |[to, mean]: &[f64; 2]| {
            let at = 0.5 * (from + to);
            from = *to;
            [at, *mean]
        };
        std::iter::once([0.0, 0.0]).chain(self.means.iter().map(middle)).collect()
    }

    /// Work of the drive.
    fn work_j(&self) -> f64 {
        let mut from = 0.0;
        let part = |[to, mean]: &[f64; 2]| mean * (to - std::mem::replace(&mut from, *to));
        self.means.iter().map(part).sum()
    }
}
