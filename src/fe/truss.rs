//! Two-node bars (reinforcement): axial force only, J2 plasticity in one direction, finite rotation.
//!
//! With the length `l` from the nodes, the strain is logarithmic, `Δε = ln(l_{n+1} / l_n)`; it follows the bar through any rotation and needs no
//! frame. Return to the hardening table (Simo and Hughes 1998, box 1.4): `|σ_trial| - E Δp = σ_y(p + Δp)`, isotropic, with the rate factor of the law.
//! Stress is Cauchy's and the volume `A_0 l_0` is kept, so the force is `N = σ A_0 l_0 / l`, its power `N dl/dt = σ A_0 l_0 dε/dt`, and the work of a step
//! `½ (σ_n + σ_{n+1}) Δε A_0 l_0`: for steel this is the true curve. (With Poisson's ratio instead of constant volume, the elastic force
//! would differ by `(1 - 2ν) ε`, parts in ten thousand.)
//!
//! A bar ruptures when its plastic strain reaches that of the law's erosion, or its strain since the start the law's principal strain. It
//! keeps its mass. The force at the end of the step in which it does never acts: what the work of that step has of it is booked as released, as for elements
//! ([`super::erosion`]); a law with cycles ends that step at stress zero. A bar also ends, and counts as ruptured, where its ends have come together so far
//! that its own time step has collapsed as that of an element would: it would take all others down to its step. The strain at rupture belongs to the length of the bars: it should stand for the length in which a real bar slips from the concrete.
//!
//! **Frequency.** `ω² = 4 (E A / l) / m` with the bar's own mass `m`, half at each end, `A / l` current. By the eigenvalue
//! inequality of Irons and Treharne (1971) for lumped masses the largest over bars and hexahedra bounds that of the mesh, whatever they share.

use super::kernel::KernelStep;
use super::mesh::Mesh;
use crate::base::vector::{V3, add, dot, scale};
use crate::material::j2::HardeningTable;
use crate::material::rebar::{RebarLaw, RebarState};
use serde::{Deserialize, Serialize};

/// All bars of a mesh with their state.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Trusses {
    /// The bars, in the order of the mesh.
    pub bars: Vec<Bar>,
    /// Hardening tables by law.
    tables: Vec<HardeningTable>,
    /// Laws with cycles by law.
    rebars: Vec<Option<RebarLaw>>,
    /// Largest squared frequency bound of the last update \[1/s²\].
    pub bound_1_s2: f64,
    /// Bars that ruptured in the last update.
    pub ruptured: Vec<usize>,
    /// Work booked for forces of rupturing bars that no longer acted \[J\].
    pub released_j: f64,
}

/// The rupture of a bar.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BarRupture {
    /// Index of the bar in [`Mesh::trusses`].
    pub bar: usize,
    /// Index into [`Mesh::parts`].
    pub part: usize,
    /// End of the time step in which it ruptured \[s\].
    pub time_s: f64,
    /// Logarithmic strain since the start.
    pub strain: f64,
    /// Plastic strain.
    pub plastic_strain: f64,
}

/// One bar.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bar {
    /// Node indices.
    pub nodes: [usize; 2],
    /// Index of the law.
    pub law: usize,
    /// Cross-section at the start \[m²\].
    pub area_m2: f64,
    /// Length at the start and now \[m\].
    pub length_m: [f64; 2],
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Plastic strain, and strain since the start, at which it ruptures.
    pub critical_strain: [f64; 2],
    /// Axial Cauchy stress, tension positive \[Pa\]; 0 once ruptured.
    pub stress_pa: f64,
    /// Equivalent plastic strain.
    pub plastic_strain: f64,
    /// Work done on it \[J\].
    pub internal_j: f64,
    /// History in a law with cycles.
    pub rebar: RebarState,
    /// Whether it still acts.
    pub acts: bool,
}

impl Bar {
    /// Axial force, tension positive \[N\].
    pub fn force_n(&self) -> f64 {
        self.stress_pa * self.area_m2 * self.length_m[0] / self.length_m[1]
    }

    /// Logarithmic strain since the start.
    pub fn strain(&self) -> f64 {
        libm::log(self.length_m[1] / self.length_m[0])
    }

    /// Axial stiffness over length, `E A / l` \[N/m\], at a length \[m\].
    fn stiffness_n_m(&self, length_m: f64) -> f64 {
        self.youngs_modulus_pa * self.area_m2 * self.length_m[0] / (length_m * length_m)
    }

    /// Squared bound of its frequencies at a length \[m\], by its own mass \[1/s²\].
    pub fn bound_1_s2(&self, length_m: f64) -> f64 {
        4.0 * self.stiffness_n_m(length_m) / self.mass_kg
    }

    /// Ends it at a new length \[m\] that its time step does not outlive: in this step only the force at its beginning acted.
    fn collapse(&mut self, length_m: f64) {
        self.internal_j += 0.5 * self.force_n() * (length_m - self.length_m[1]);
        self.length_m[1] = length_m.max(f64::MIN_POSITIVE); // its strain is told
        self.stress_pa = 0.0;
        self.acts = false;
    }

    /// Takes it to a new length \[m\] in a law with cycles.
    fn follow(&mut self, length_m: f64, rebar: &RebarLaw) {
        let (before, old) = (self.rebar.strain, self.rebar.stress_pa);
        let strain = length_m / self.length_m[0] - 1.0;
        let stress = rebar.stress(&mut self.rebar, strain);
        self.internal_j += 0.5 * (old + stress) * (strain - before) * self.area_m2 * self.length_m[0];
        self.stress_pa = stress * (1.0 + strain); // test reports divide by the area at the start
        self.length_m[1] = length_m;
        self.acts = !self.rebar.ruptured;
    }

    /// Takes it to a new length \[m\]; returns the work booked for a force that does not act since it ruptured \[J\].
    fn stretch(&mut self, length_m: f64, table: &HardeningTable, step: KernelStep) -> f64 {
        let strain = libm::log(length_m / self.length_m[1]);
        let trial = self.stress_pa + self.youngs_modulus_pa * strain;
        let third = self.youngs_modulus_pa / 3.0; // E in the place of 3 G
        let (increment, _) = if table.has_rate() && step.viscous {
            table.rated_increment(trial.abs(), self.plastic_strain, third, 1.0, step.dt_s)
        } else {
            table.plastic_increment(trial.abs(), self.plastic_strain, third, 1.0)
        };
        let stress = trial - trial.signum() * self.youngs_modulus_pa * increment;
        self.internal_j += 0.5 * (self.stress_pa + stress) * strain * self.area_m2 * self.length_m[0];
        self.stress_pa = stress;
        self.plastic_strain += increment;
        self.length_m[1] = length_m;
        if self.plastic_strain >= self.critical_strain[0] || self.strain() >= self.critical_strain[1] {
            self.stress_pa = 0.0;
            self.acts = false;
            return 0.5 * stress * strain * self.area_m2 * self.length_m[0];
        }
        0.0
    }
}

impl Trusses {
    /// The bars of a mesh, unstressed.
    pub fn of(mesh: &Mesh) -> Self {
        let bars = mesh.trusses.iter().map(|truss| {
            let law = &mesh.laws[truss.law];
            let (_, length) = direction(&mesh.nodes, truss.nodes);
            Bar {
                nodes: truss.nodes,
                law: truss.law,
                area_m2: truss.area_m2,
                length_m: [length; 2],
                mass_kg: law.density_kg_m3 * truss.area_m2 * length,
                youngs_modulus_pa: law.youngs_modulus_pa,
                critical_strain: [law.erosion.plastic_strain, law.erosion.principal_strain],
                stress_pa: 0.0,
                plastic_strain: 0.0,
                internal_j: 0.0,
                rebar: RebarState::default(),
                acts: true,
            }
        });
        let bars: Vec<Bar> = bars.collect();
        let tables =
            if bars.is_empty() { Vec::new() } else { mesh.laws.iter().map(super::law::Law::table).collect() };
        let rebars = mesh.laws.iter().map(|l| l.rebar).collect();
        Self { bars, tables, rebars, bound_1_s2: 0.0, ruptured: Vec::new(), released_j: 0.0 }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bars.is_empty()
    }

    /// Adds the lumped masses to those of the nodes \[kg\].
    pub fn add_mass(&self, mass_kg: &mut [f64]) {
        for bar in &self.bars {
            for n in bar.nodes {
                mass_kg[n] += 0.5 * bar.mass_kg;
            }
        }
    }

    /// Takes the bars to the nodes' positions \[m\] and adds their forces on the nodes \[N\], in the order of the bars. Bars with a squared frequency bound
    /// above `drop_above` \[1/s²\] end.
    pub fn update(&mut self, x: &[V3], step: KernelStep, drop_above: Option<f64>, force_n: &mut [V3]) {
        self.bound_1_s2 = 0.0;
        self.ruptured.clear();
        for (index, bar) in self.bars.iter_mut().enumerate().filter(|(_, b)| b.acts) {
            let (unit, length) = direction(x, bar.nodes);
            let square = bar.bound_1_s2(length);
            match &self.rebars[bar.law] {
                _ if drop_above.is_some_and(|most| square > most) => bar.collapse(length),
                Some(rebar) => bar.follow(length, rebar),
                None => self.released_j += bar.stretch(length, &self.tables[bar.law], step),
            }
            if !bar.acts {
                self.ruptured.push(index);
                continue;
            }
            let pull = scale(bar.force_n(), unit);
            force_n[bar.nodes[0]] = add(force_n[bar.nodes[0]], pull);
            force_n[bar.nodes[1]] = add(force_n[bar.nodes[1]], scale(-1.0, pull));
            self.bound_1_s2 = if square > self.bound_1_s2 { square } else { self.bound_1_s2 };
        }
    }

    /// The bars that ruptured in the last update, which ends at this time \[s\], in the order of the mesh.
    pub fn ruptures(&self, mesh: &Mesh, time_s: f64) -> impl Iterator<Item = BarRupture> {
        self.ruptured.iter().map(move |&index| {
            let bar = &self.bars[index];
            BarRupture {
                bar: index,
                part: mesh.trusses[index].part,
                time_s,
                strain: bar.strain(),
                plastic_strain: bar.plastic_strain,
            }
        })
    }

    /// Work done on all bars \[J\].
    pub fn internal_j(&self) -> f64 {
        self.bars.iter().map(|b| b.internal_j).sum()
    }

    /// Nodes and elastic stiffness of the acting bars: the force on the first node is minus this times the displacement
    /// of the first relative to the second \[N/m\].
    pub fn stiffnesses(&self, x: &[V3]) -> Vec<([usize; 2], [V3; 3])> {
        let acting = self.bars.iter().filter(|b| b.acts);
        acting
            .map(|bar| {
                let (unit, length) = direction(x, bar.nodes);
                let k = bar.stiffness_n_m(length);
                (bar.nodes, unit.map(|c| scale(k * c, unit)))
            })
            .collect()
    }
}

/// Unit vector from the first to the second node, and the length \[m\].
fn direction(x: &[V3], nodes: [usize; 2]) -> (V3, f64) {
    let along: V3 = std::array::from_fn(|i| x[nodes[1]][i] - x[nodes[0]][i]);
    let length = dot(along, along).sqrt();
    (scale(1.0 / length, along), length)
}
