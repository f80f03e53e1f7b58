//! When an element fails, what becomes of it, and what then leaves the structure.
//!
//! Three criteria, the first and the last looked at in every pass of the kernel ([`super::sweep`], which leaves the forces of such elements out):
//! * **plastic strain**: the equivalent plastic strain reaches that of the law;
//! * **principal strain**: the largest logarithmic principal strain `ln λ_max` of the mean deformation gradient
//!   `F = Σ_I x_I ⊗ b_I` reaches that of the law, `b_I` being the mean gradient of the shape functions in the reference positions
//!   (Flanagan and Belytschko 1981, equation 23), so that `F` is the volume mean over the reference element. It is computed from
//!   node positions, only for laws that ask, every [`STRAIN_CHECK_STEPS`] steps: it may be found late by that many steps times the
//!   rate of the strain (4 steps of 0.1 ms at 10 1/s: 0.004);
//! * **collapse of the time step**: the step that the element allows falls below a share of the first step, or its volume is lost. Bars end at the
//!   same share ([`super::truss`]).
//!
//! An eroded element exerts nothing any more. Its mass stays with its nodes; a node without an acting element is free debris.
//! The [`ErosionTable`] tells what each failure took: mass, work of the stresses, the elastic part of it (which could have been
//! recovered and is lost with the element), hourglass and viscous work, and the kinetic energy and momentum that its share of the nodes
//! carries on. **Release**: the work of a step is booked as `(f_n + f_{n+1}) / 2 · Δu` (central differences), but the end force
//! of an element that dies in the step never acts. `f_{n+1} · Δu / 2` is therefore taken off again as [`ErosionTable::released_j`].

use super::blocks::Failing;
use super::dynamics::{Death, Dynamics};
use super::hexahedron::{gradient, to_nodes, to_patterns, volume_m3};
use super::mesh::Mesh;
use super::split::{self, Split};
use crate::base::vector::{V3, dot};
use serde::{Deserialize, Serialize};

/// An element whose own critical step falls below this share of the first step has collapsed.
pub const STEP_COLLAPSE: f64 = 0.1;
/// Steps between two looks at principal strains.
pub const STRAIN_CHECK_STEPS: u64 = 4;

/// What becomes of an element that reaches its erosion strain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// It is deleted.
    #[default]
    Erode,
    /// It is detached from its neighbours and lives on as a block of debris.
    Split,
}

/// Settings, watched elements and books of a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Failure {
    /// Share of the first time step below which an element's own critical step counts as collapsed; 0: never.
    pub step_collapse: f64,
    /// What becomes of elements that reach their erosion strain. Elements whose step has collapsed are always deleted.
    pub fate: Fate,
    /// Steps between two looks at principal strains.
    pub strain_check_steps: u64,
    /// What has failed so far.
    pub table: ErosionTable,
    /// Elements detached in the last step, with the nodes they got: new outer faces.
    pub splits: Vec<Split>,
    watched: Vec<Watched>,
}

/// What failed elements took out of the structure.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Loss {
    /// Elements.
    pub elements: usize,
    /// Their mass \[kg\]; it stays with the nodes.
    pub mass_kg: f64,
    /// Work of their stresses \[J\].
    pub internal_j: f64,
    /// Elastic part of it at the end \[J\]: of the mean stress, hourglass stresses left out.
    pub elastic_j: f64,
    /// Work against hourglass control \[J\].
    pub hourglass_j: f64,
    /// Work against bulk viscosity \[J\].
    pub viscous_j: f64,
    /// Kinetic energy of their mass at the end \[J\]; it stays with the nodes.
    pub kinetic_j: f64,
    /// Momentum of their mass at the end \[kg m/s\]; it stays with the nodes.
    pub momentum_kg_m_s: [f64; 3],
}

/// Nodes with mass that belong to no acting element.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FreeNodes {
    /// Nodes.
    pub nodes: usize,
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Kinetic energy \[J\].
    pub kinetic_j: f64,
    /// Momentum \[kg m/s\].
    pub momentum_kg_m_s: [f64; 3],
}

/// The books of failure.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ErosionTable {
    /// Deleted at the critical plastic strain.
    pub plastic_strain: Loss,
    /// Deleted at the critical principal strain.
    pub principal_strain: Loss,
    /// Deleted because the time step or the volume collapsed.
    pub step_collapse: Loss,
    /// Detached as debris blocks: their energy stays in the balance.
    pub split: Loss,
    /// Work booked for forces that no longer acted \[J\], to be taken off the work of the elements.
    pub released_j: f64,
    /// Debris nodes when the table was closed.
    pub free: FreeNodes,
}

impl ErosionTable {
    /// Deleted elements of all causes.
    pub fn eroded(&self) -> usize {
        [self.plastic_strain, self.principal_strain, self.step_collapse].iter().map(|l| l.elements).sum()
    }

    /// Elastic energy lost with deleted elements \[J\].
    pub fn elastic_j(&self) -> f64 {
        self.plastic_strain.elastic_j + self.principal_strain.elastic_j + self.step_collapse.elastic_j
    }
}

/// An element whose principal strain is watched.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Watched {
    element: usize,
    /// Mean gradient of the shape functions in the reference positions \[1/m\].
    gradient: [V3; 8],
    limit: f64,
}

impl Failure {
    /// The default settings for a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let watched = mesh
            .elements
            .iter()
            .enumerate()
            .filter(|(_, e)| mesh.laws[e.law].erosion.principal_strain.is_finite())
            .map(|(element, e)| Watched {
                element,
                gradient: mean_gradient(&e.nodes.map(|n| mesh.nodes[n])),
                limit: mesh.laws[e.law].erosion.principal_strain,
            })
            .collect();
        Self {
            step_collapse: STEP_COLLAPSE,
            fate: Fate::default(),
            strain_check_steps: STRAIN_CHECK_STEPS,
            table: ErosionTable::default(),
            splits: Vec::new(),
            watched,
        }
    }
}

impl Failure {
    /// Squared frequency bound above which an element has collapsed \[1/s²\].
    pub(super) fn largest_bound_1_s2(&self, first_dt_s: f64) -> f64 {
        if self.step_collapse > 0.0 {
            (2.0 / (self.step_collapse * first_dt_s)).powi(2)
        } else {
            f64::INFINITY
        }
    }
}

/// Ends or detaches the elements that fail in this step.
pub(super) fn fail(body: &mut Dynamics) {
    body.deaths.clear();
    body.failure.splits.clear();
    let mut failed = in_the_pass(body);
    if !body.failure.watched.is_empty() && body.steps.is_multiple_of(body.failure.strain_check_steps.max(1)) {
        for torn in by_principal_strain(body, &failed) {
            body.blocks.take_out(torn.element, &torn.force_n);
            failed.push(torn);
        }
    }
    let sums_n: Vec<[f64; 3]> = match body.failure.fate {
        Fate::Split if !failed.is_empty() => (0..body.x.len()).map(|n| body.internal_n(n)).collect(),
        _ => Vec::new(),
    };
    let mut own_n = Vec::new();
    for Failed { element, cause, work_j, force_n } in failed {
        let loss = loss(body, element);
        let split = cause != Death::Collapsed && body.failure.fate == Fate::Split;
        let table = &mut body.failure.table;
        match cause {
            _ if split => &mut table.split,
            Death::Torn => &mut table.principal_strain,
            Death::Collapsed => &mut table.step_collapse,
            _ => &mut table.plastic_strain,
        }
        .add(&loss);
        if split {
            let split = split::split(body, element);
            body.failure.splits.push(split);
            body.deaths.push((element, Death::Split));
            own_n.push((element, force_n));
            continue;
        }
        body.failure.table.released_j += 0.5 * work_j;
        body.blocks.set_share(element, 0.0);
        body.deaths.push((element, cause));
    }
    if !body.failure.splits.is_empty() {
        connect(body, sums_n, &own_n);
    }
}

/// Connects elements and nodes anew after splits; the forces of this step go to the nodes they belong to now.
fn connect(body: &mut Dynamics, sums_n: Vec<[f64; 3]>, own_n: &[(usize, [[f64; 3]; 8])]) {
    body.blocks.connect(&body.x);
    body.blocks.put_in(sums_n.into_iter().enumerate());
    for (element, force_n) in own_n {
        body.blocks.put_in(body.blocks.nodes_of(*element).into_iter().zip(*force_n));
    }
    if let Some(contact) = &mut body.body_contact {
        contact.follow_splits(body.blocks.element_nodes(), body.x.len());
    }
}

/// An element that fails.
struct Failed {
    element: usize,
    cause: Death,
    /// Work of its forces over the last increment \[J\].
    work_j: f64,
    /// Its forces, which are not in the sums at the nodes \[N\].
    force_n: [[f64; 3]; 8],
}

/// Elements that the pass of the kernel found failing.
fn in_the_pass(body: &Dynamics) -> Vec<Failed> {
    let found = |(element, failing): (usize, Failing)| {
        let (block, lane) = body.blocks.of_element(element);
        let eroded = block.state.plastic_strain[lane] >= block.material.lanes().critical_strain[lane];
        let cause = if eroded { Death::Eroded } else { Death::Collapsed };
        Failed { element, cause, work_j: failing.work_j, force_n: failing.force_n }
    };
    body.blocks.failing().into_iter().map(found).collect()
}

/// Watched elements past their critical principal strain that are not in `failed`, in element order.
fn by_principal_strain(body: &Dynamics, failed: &[Failed]) -> Vec<Failed> {
    let torn = |w: &&Watched| {
        body.blocks.share(w.element) > 0.0
            && !body.blocks.is_detached(w.element)
            && principal_strain(&w.gradient, &body.blocks.nodes_of(w.element).map(|n| body.x[n])) >= w.limit
    };
    body.failure
        .watched
        .iter()
        .filter(torn)
        .filter(|w| failed.iter().all(|f| f.element != w.element))
        .map(|w| torn_now(body, w.element))
        .collect()
}

impl Loss {
    fn add(&mut self, more: &Loss) {
        self.elements += more.elements;
        self.mass_kg += more.mass_kg;
        self.internal_j += more.internal_j;
        self.elastic_j += more.elastic_j;
        self.hourglass_j += more.hourglass_j;
        self.viscous_j += more.viscous_j;
        self.kinetic_j += more.kinetic_j;
        for i in 0..3 {
            self.momentum_kg_m_s[i] += more.momentum_kg_m_s[i];
        }
    }
}

/// What an element takes with it.
fn loss(body: &Dynamics, element: usize) -> Loss {
    let (block, lane) = body.blocks.of_element(element);
    let mass_kg = block.material.mass_kg[lane];
    let mut loss = Loss {
        elements: 1,
        mass_kg,
        internal_j: block.state.internal_j[lane],
        elastic_j: elastic_j(body, element),
        hourglass_j: block.state.hourglass_j[lane],
        viscous_j: block.state.viscous_j[lane],
        ..Loss::default()
    };
    for n in body.blocks.nodes_of(element) {
        let v = body.v[n];
        loss.kinetic_j += mass_kg / 16.0 * dot(v, v);
        for i in 0..3 {
            loss.momentum_kg_m_s[i] += mass_kg / 8.0 * v[i];
        }
    }
    loss
}

/// Elastic energy of the mean stress \[J\]: `V (s:s / 4G + σ_m² / 2K)`.
pub fn elastic_j(body: &Dynamics, element: usize) -> f64 {
    let (block, lane) = body.blocks.of_element(element);
    let volume = volume_m3(&body.blocks.nodes_of(element).map(|n| body.x[n]));
    if volume.is_nan() || volume <= 0.0 {
        return 0.0;
    }
    let material = block.material.lanes();
    let (lambda, mu) = (material.lambda_pa[lane], material.mu_pa[lane]);
    let s: [f64; 6] = std::array::from_fn(|i| block.state.stress[i][lane]);
    let mean = (s[0] + s[1] + s[2]) / 3.0;
    let mut deviator = 0.0;
    for i in 0..3 {
        deviator += (s[i] - mean) * (s[i] - mean) + 2.0 * s[i + 3] * s[i + 3];
    }
    let bulk = lambda + 2.0 / 3.0 * mu;
    block.state.share[lane] * volume * (deviator / (4.0 * mu) + mean * mean / (2.0 * bulk))
}

/// An element past its principal strain, with the forces of its stresses.
fn torn_now(body: &Dynamics, element: usize) -> Failed {
    let force_n = body.blocks.element_force(element, &body.x);
    let nodes = body.blocks.nodes_of(element);
    let work = body.taken_s * force_n.iter().zip(nodes).map(|(f, n)| dot(*f, body.v[n])).sum::<f64>();
    let work_j = if work.is_finite() { work } else { 0.0 };
    Failed { element, cause: Death::Torn, work_j, force_n }
}

/// Nodes with mass that belong to no acting element.
pub fn free_nodes(body: &Dynamics) -> FreeNodes {
    let mut free = FreeNodes::default();
    for n in 0..body.x.len() {
        let mass = body.mass_kg[n];
        if mass > 0.0 && body.blocks.elements_at(n).all(|e| body.blocks.share(e) == 0.0) {
            free.nodes += 1;
            free.mass_kg += mass;
            free.kinetic_j += 0.5 * mass * dot(body.v[n], body.v[n]);
            for i in 0..3 {
                free.momentum_kg_m_s[i] += mass * body.v[n][i];
            }
        }
    }
    free
}

/// Mean gradient of the shape functions of a hexahedron \[1/m\].
pub fn mean_gradient(nodes: &[V3; 8]) -> [V3; 8] {
    let mut patterns = [[0.0; 3]; 7];
    for i in 0..3 {
        let sums = to_patterns(nodes.map(|n| n[i]));
        for k in 0..7 {
            patterns[k][i] = sums[k];
        }
    }
    let (e, volume) = gradient(&patterns);
    let mut out = [[0.0; 3]; 8];
    for i in 0..3 {
        let mut coefficients = [0.0; 7];
        for k in 0..6 {
            coefficients[k] = e[k][i] / (64.0 * volume);
        }
        let nodal = to_nodes(coefficients);
        for n in 0..8 {
            out[n][i] = nodal[n];
        }
    }
    out
}

/// Largest logarithmic principal strain of the mean deformation gradient, given the reference gradient of the shape functions and the current
/// node positions \[m\].
pub fn principal_strain(reference: &[V3; 8], x: &[V3; 8]) -> f64 {
    let mut f = [[0.0; 3]; 3]; // columns of F: f[j] = Σ_I x_I b_Ij
    for (b, x) in reference.iter().zip(x) {
        for j in 0..3 {
            for i in 0..3 {
                f[j][i] += x[i] * b[j];
            }
        }
    }
    let c = [
        dot(f[0], f[0]),
        dot(f[1], f[1]),
        dot(f[2], f[2]),
        dot(f[0], f[1]),
        dot(f[1], f[2]),
        dot(f[2], f[0]),
    ];
    0.5 * libm::log(largest_eigenvalue(&c))
}

/// Largest eigenvalue of a symmetric 3 x 3 matrix `xx, yy, zz, xy, yz, zx` (Smith 1961, Commun. ACM 4, 168).
fn largest_eigenvalue(a: &[f64; 6]) -> f64 {
    let mean = (a[0] + a[1] + a[2]) / 3.0;
    let d = [a[0] - mean, a[1] - mean, a[2] - mean];
    let off = a[3] * a[3] + a[4] * a[4] + a[5] * a[5];
    let spread = ((dot(d, d) + 2.0 * off) / 6.0).sqrt();
    if spread == 0.0 {
        return mean;
    }
    let determinant = d[0] * (d[1] * d[2] - a[4] * a[4]) - a[3] * (a[3] * d[2] - a[4] * a[5])
        + a[5] * (a[3] * a[4] - d[1] * a[5]);
    let angle = libm::acos((0.5 * determinant / (spread * spread * spread)).clamp(-1.0, 1.0)) / 3.0;
    mean + 2.0 * spread * libm::cos(angle)
}
