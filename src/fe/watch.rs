//! Watch over a run: the energy balance, numbers, and motion that flips from step to step.
//!
//! A run is looked at when it records and every [`LOOK_STEPS`] steps. It is stopped with a [`Diagnosis`] when
//!
//! * a position, velocity or energy is **not a number**;
//! * the **balance** is off by more than [`ENERGY_LIMIT`] of the largest energy, in either direction;
//! * **hourglass** control has given more than that share of it: what it takes it stores or loses, so nothing is to come back;
//! * the work booked as **released** with dying elements and rupturing bars exceeds that share of the supplied energy: what dies has grown within a step;
//! * a part **alternates**. The balance does not show a time step beyond the limit, as central differences conserve their own
//!   energy whatever the step: the kinetic energy, half the product of the velocities before and after the step, turns negative as the strain energy grows.
//!   A bound tells. For any stresses, elements with the stored energy U exert on their nodes the forces f with
//!   `Σ f²/m <= 2 ω² U`, ω² being the largest squared frequency (Rayleigh; element by element after Irons and Treharne 1971). With a stable step
//!   `Δt <= 2/ω` the energy `Δt² Σ f²/(8 m)` of the velocity changes of a step is never above U, for all nodes of a part and the elements at
//!   them. A motion beyond the limit is soon that of the highest mode alone, and exceeds it.
//!
//! Stored energy is that of the stress with bulk viscosity, and of hourglass stresses ([`hourglass::stored_j`]). Parts with viscous hourglass control, whose
//! forces store nothing, and parts with an element turned inside out are not watched for alternation.

use super::dynamics::Dynamics;
use super::hexahedron::volume_m3;
use super::hourglass;
use super::law::{ElementForm, Hourglass};
use super::mesh::Mesh;
use super::run::FeError;
use crate::base::vector::{V3, norm, sub};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Share of the largest energy at which a run is stopped: residual, hourglass work that is gained, released work.
pub const ENERGY_LIMIT: f64 = 0.10;
/// Steps between two looks at most.
pub const LOOK_STEPS: u64 = 256;
/// Steps before the balance of a run that starts from nothing is judged.
const FIRST_JUDGED_STEP: u64 = 50;
/// Energy of alternating motion, over the stored energy of the body, below which it is rounding.
const SIGNIFICANT: f64 = 1e-9;

/// Energies of a body and works on it at one time \[J\].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Books {
    /// Time \[s\].
    pub time_s: f64,
    /// Energy at the start.
    pub initial_j: f64,
    /// Kinetic energy at the full step.
    pub kinetic_j: f64,
    /// Work of stresses, eroded elements included.
    pub internal_j: f64,
    /// Work against hourglass control.
    pub hourglass_j: f64,
    /// Work against bulk viscosity.
    pub viscous_j: f64,
    /// Work of accelerations on all mass.
    pub body_loads_j: f64,
    /// Work of nodal forces, given motions and damping.
    pub driven_j: f64,
    /// Work of contact normal forces.
    pub contact_j: f64,
    /// Work of friction.
    pub friction_j: f64,
    /// Energy that left with removed members.
    pub removed_j: f64,
    /// Work booked for forces of dying elements, rupturing bars and ended ties that no longer acted.
    pub released_j: f64,
    /// What hand-overs between deformable and rigid parts added.
    pub switched_j: f64,
}

impl Books {
    /// Of a body whose kinetic energy at the full step, energy at the start and energy lost with removed members are given \[J\].
    pub fn of(body: &Dynamics, kinetic_j: f64, initial_j: f64, removed_j: f64) -> Self {
        let [solids_j, hourglass_j, viscous_j] = body.blocks.energies_j();
        let [contact_j, friction_j] = body.contact_j;
        Self {
            time_s: body.time_s,
            initial_j,
            kinetic_j,
            internal_j: solids_j + body.trusses.internal_j(),
            hourglass_j,
            viscous_j,
            body_loads_j: body.gravity_j,
            driven_j: body.driven_j,
            contact_j,
            friction_j,
            removed_j,
            released_j: body.ties.released_j + body.failure.table.released_j + body.trusses.released_j,
            switched_j: body.hybrid.as_ref().map_or(0.0, |h| h.books.switched_j),
        }
    }

    /// What is there and has not been supplied \[J\].
    pub fn residual_j(&self) -> f64 {
        let supplied = self.initial_j
            + self.body_loads_j
            + self.driven_j
            + self.contact_j
            + self.friction_j
            + self.removed_j
            + self.released_j
            + self.switched_j;
        self.kinetic_j + self.internal_j + self.hourglass_j + self.viscous_j - supplied
    }

    /// The measure of residuals: the largest of kinetic and internal energy, work of loads, and of drives \[J\].
    pub fn largest_j(&self) -> f64 {
        (self.kinetic_j + self.internal_j).max(self.body_loads_j.abs()).max(self.driven_j.abs())
    }

    /// The entry that has changed most since `before`, and its change \[J\]; one that is not a number comes first.
    fn grown(&self, before: &Self) -> (&'static str, f64) {
        let change = |name: &'static str, of: fn(&Self) -> f64| (name, of(self) - of(before));
        let all = [
            change("kinetic energy", |b| b.kinetic_j),
            change("work of stresses", |b| b.internal_j),
            change("hourglass work", |b| b.hourglass_j),
            change("work of bulk viscosity", |b| b.viscous_j),
            change("work of contact", |b| b.contact_j),
            change("work of friction", |b| b.friction_j),
            change("work of loads", |b| b.body_loads_j),
            change("work of given motions", |b| b.driven_j),
            change("work released by dying elements", |b| b.released_j),
            change("energy of switches to rigid parts", |b| b.switched_j),
        ];
        let size = |(_, change): &(&str, f64)| if change.is_nan() { f64::INFINITY } else { change.abs() };
        all.into_iter().fold(all[0], |most, one| if size(&one) > size(&most) { one } else { most })
    }
}

/// What is wrong.
#[derive(Debug, Clone, PartialEq)]
pub enum Trouble {
    /// A node without finite position or velocity, or none but an energy.
    NotFinite(Option<usize>),
    /// Residual over the largest energy.
    Balance(f64),
    /// Hourglass work, below zero, over the largest energy.
    Hourglass(f64),
    /// Released work over supplied energy.
    Released(f64),
    /// A part whose nodes alternate, and the time step over the stability limit of that motion.
    Alternates(String, f64),
}

/// An element or node with its part and position.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Index, or identifier in a deck.
    pub index: usize,
    /// Part.
    pub part: String,
    /// Centre or position \[m\].
    pub at_m: V3,
    /// Time step \[s\] of an element, speed \[m/s\] of a node.
    pub value: f64,
    /// Whether the element is a bar.
    pub is_bar: bool,
}

/// Why a run was stopped, and where to look.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// Time \[s\].
    pub time_s: f64,
    /// What is wrong.
    pub trouble: Trouble,
    /// Time of the last look at which all was well \[s\].
    pub sound_s: f64,
    /// The entry of the books that has changed most since, and its change \[J\].
    pub grown: (&'static str, f64),
    /// The time step in use \[s\].
    pub step_s: f64,
    /// Element or bar that asks for the smallest step.
    pub smallest: Option<Place>,
    /// Node with the largest speed.
    pub fastest: Option<Place>,
}

impl Diagnosis {
    /// The same with the identifiers that a deck gives to nodes, elements and bars in the place of their indices.
    #[must_use]
    pub fn by_ids(&self, nodes: &[u64], elements: &[u64], bars: &[u64]) -> Self {
        let id = |ids: &[u64], index: usize| ids.get(index).map_or(index, |id| *id as usize);
        let named = |place: &Option<Place>, ids: &[u64]| {
            place.clone().map(|place| Place { index: id(ids, place.index), ..place })
        };
        let trouble = match self.trouble {
            Trouble::NotFinite(Some(node)) => Trouble::NotFinite(Some(id(nodes, node))),
            ref other => other.clone(),
        };
        let asking = if self.smallest.as_ref().is_some_and(|p| p.is_bar) { bars } else { elements };
        let (smallest, fastest) = (named(&self.smallest, asking), named(&self.fastest, nodes));
        Self { trouble, smallest, fastest, ..self.clone() }
    }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at t = {:.6} s ", self.time_s)?;
        match &self.trouble {
            Trouble::NotFinite(Some(n)) => write!(f, "node {n} has no finite position or velocity")?,
            Trouble::NotFinite(None) => write!(f, "the energies are not finite")?,
            Trouble::Balance(share) => {
                write!(f, "the energy balance is off by {:+.1} % of the largest energy", 100.0 * share)?;
            }
            Trouble::Hourglass(share) => write!(
                f,
                "hourglass control has given {:.1} % of the largest energy, where it can only take",
                -100.0 * share
            )?,
            Trouble::Released(share) => write!(
                f,
                "elements died by forces that had grown within a step: the work released with them is {:.1} % of the energy supplied",
                100.0 * share
            )?,
            Trouble::Alternates(part, share) => write!(
                f,
                "part `{part}` flips from step to step with more energy than its elements hold: the time step is {share:.2} of the limit of that motion or more"
            )?,
        }
        let (name, change_j) = self.grown;
        write!(
            f,
            "; since t = {:.6} s, when all was well, the {name} changed most, by {change_j:.3e} J",
            self.sound_s
        )?;
        if let Some(p) = &self.smallest {
            let (e, part, at, step) = (p.index, &p.part, p.at_m, p.value);
            let kind = if p.is_bar { "bar" } else { "element" };
            write!(
                f,
                "; the step is {:.3e} s, the shortest is asked for by {kind} {e} of part `{part}` at x = {at:.3?} m: {step:.3e} s",
                self.step_s
            )?;
        }
        if let Some(p) = &self.fastest {
            let (n, part, at, speed) = (p.index, &p.part, p.at_m, p.value);
            write!(f, "; the fastest node is {n} of part `{part}` at x = {at:.3?} m: {speed:.3e} m/s")?;
        }
        write!(f, "; try a smaller share of the stability limit, a finer mesh there, or no mass scaling")
    }
}

/// What has been seen so far. Part of checkpoints.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Watch {
    /// Energy below which nothing is judged \[J\]; zero: judge from step 50 on, or at the end.
    floor_j: f64,
    /// Largest energy so far \[J\].
    pub largest_j: f64,
    /// Largest sum of the energy at the start, work of loads and of drives \[J\].
    supplied_j: f64,
    last: Books,
    /// Whether the run is over, so that it is judged however few its steps are.
    is_over: bool,
}

impl Watch {
    /// A watch that judges balances against at least `floor_j` \[J\].
    pub fn new(floor_j: f64) -> Self {
        Self { floor_j, ..Self::default() }
    }

    /// Looks at a body.
    ///
    /// # Errors
    /// With a diagnosis if it is not sound.
    pub fn look(&mut self, mesh: &Mesh, body: &Dynamics, books: &Books) -> Result<(), FeError> {
        self.largest_j = self.largest_j.max(books.largest_j());
        let supplied_j = books.initial_j.abs() + books.body_loads_j.abs() + books.driven_j.abs();
        self.supplied_j = self.supplied_j.max(supplied_j);
        match self.trouble(mesh, body, books) {
            None => {
                self.last = *books;
                Ok(())
            }
            Some(trouble) => Err(FeError::Unsound(Box::new(self.diagnosis(mesh, body, books, trouble)))),
        }
    }

    /// The next look is at the end of the run.
    pub fn end(&mut self) {
        self.is_over = true;
    }

    /// Whether balances are judged yet.
    pub fn judges(&self, body: &Dynamics) -> bool {
        self.floor_j > 0.0 || (self.is_over || body.steps >= FIRST_JUDGED_STEP) && self.largest_j > 0.0
    }

    fn trouble(&self, mesh: &Mesh, body: &Dynamics, books: &Books) -> Option<Trouble> {
        if let Some(node) = body.broken_node() {
            return Some(Trouble::NotFinite(Some(node)));
        }
        let residual_j = books.residual_j();
        if !residual_j.is_finite() {
            return Some(Trouble::NotFinite(None));
        }
        if let Some((part, share)) = alternating(mesh, body) {
            return Some(Trouble::Alternates(part, share));
        }
        if !self.judges(body) {
            return None;
        }
        let measure_j = self.largest_j.max(self.floor_j);
        if residual_j.abs() > ENERGY_LIMIT * measure_j {
            return Some(Trouble::Balance(residual_j / measure_j));
        }
        if books.hourglass_j < -ENERGY_LIMIT * measure_j {
            return Some(Trouble::Hourglass(books.hourglass_j / measure_j));
        }
        let supplied_j = self.supplied_j.max(self.floor_j);
        if books.released_j.abs() > ENERGY_LIMIT * supplied_j {
            return Some(Trouble::Released(books.released_j / supplied_j));
        }
        None
    }

    fn diagnosis(&self, mesh: &Mesh, body: &Dynamics, books: &Books, trouble: Trouble) -> Diagnosis {
        Diagnosis {
            time_s: body.time_s,
            trouble,
            sound_s: self.last.time_s,
            grown: books.grown(&self.last),
            step_s: body.taken_s,
            smallest: smallest_step(mesh, body),
            fastest: fastest_node(mesh, body),
        }
    }
}

/// The acting element or bar that asks for the shortest step.
fn smallest_step(mesh: &Mesh, body: &Dynamics) -> Option<Place> {
    let solids = body.blocks.element_bounds_1_s2(&body.x).into_iter().enumerate();
    let bars = body.trusses.bars.iter().enumerate().filter(|(_, bar)| bar.acts);
    let bars = bars.map(|(index, bar)| {
        let [a, b] = bar.nodes.map(|n| body.x[n]);
        (index, bar.bound_1_s2(norm(sub(b, a))))
    });
    let all = solids.map(|(e, bound)| (false, e, bound)).chain(bars.map(|(e, bound)| (true, e, bound)));
    let (is_bar, index, bound) = all.filter(|a| a.2 > 0.0).max_by(|a, b| a.2.total_cmp(&b.2))?;
    let (part, nodes) = if is_bar {
        (mesh.trusses[index].part, body.trusses.bars[index].nodes.to_vec())
    } else {
        (mesh.elements[index].part, body.blocks.nodes_of(index).to_vec())
    };
    let mut at_m = [0.0; 3];
    for n in &nodes {
        (0..3).for_each(|i| at_m[i] += body.x[*n][i] / nodes.len() as f64);
    }
    Some(Place { index, part: mesh.parts[part].clone(), at_m, value: body.step_under_bound_s(bound), is_bar })
}

/// The node with the largest finite speed.
fn fastest_node(mesh: &Mesh, body: &Dynamics) -> Option<Place> {
    let squared = |n: &usize| body.v[*n].iter().map(|c| c * c).sum::<f64>();
    let finite = (0..body.v.len()).filter(|n| squared(n).is_finite());
    let node = finite.max_by(|a, b| squared(a).total_cmp(&squared(b)))?;
    let of_solid = body.blocks.elements_at(node).next().map(|e| mesh.elements[e].part);
    let of_bar = || mesh.trusses.iter().find(|bar| bar.nodes.contains(&node)).map(|bar| bar.part);
    let part = of_solid.or_else(of_bar).map_or("?".to_string(), |part| mesh.parts[part].clone());
    Some(Place { index: node, part, at_m: body.x[node], value: squared(&node).sqrt(), is_bar: false })
}

/// The part that exceeds the bound of the module's head most, with the root of the quotient.
fn alternating(mesh: &Mesh, body: &Dynamics) -> Option<(String, f64)> {
    let viscous = |e: usize| {
        let form = mesh.laws[mesh.elements[e].law].form;
        matches!(form, ElementForm::OnePoint(Hourglass::Viscous { .. }))
    };
    let acts = |e: &usize| body.blocks.share(*e) > 0.0;
    let (mut stored_j, mut flipping_j) = (vec![0.0; mesh.parts.len()], vec![0.0; mesh.parts.len()]);
    let mut part_of = vec![usize::MAX; body.x.len()];
    for n in 0..body.x.len() {
        let (mass, tied) = (body.mass_kg[n], body.ties.is_tied(n));
        let Some(element) = body.blocks.elements_at(n).find(acts) else { continue };
        part_of[n] = mesh.elements[element].part;
        if mass == 0.0 || tied || body.blocks.elements_at(n).any(viscous) {
            continue;
        }
        let force = body.internal_n(n);
        for i in (0..3).filter(|i| body.prescribed_m_s[n][*i].is_none()) {
            flipping_j[part_of[n]] += 0.125 * body.taken_s * body.taken_s * force[i] * force[i] / mass;
        }
    }
    let mut all_j = 0.0;
    for e in (0..body.blocks.elements()).filter(acts) {
        let energy_j = element_stored_j(body, e);
        all_j += if energy_j.is_finite() { energy_j } else { 0.0 };
        let mut parts = body.blocks.nodes_of(e).map(|n| part_of[n]);
        parts.sort_unstable();
        for i in (0..8).filter(|i| *i == 0 || parts[*i] != parts[i - 1]) {
            stored_j[parts[i]] += energy_j;
        }
    }
    let beyond = |p: &usize| flipping_j[*p] > stored_j[*p] && flipping_j[*p] > SIGNIFICANT * all_j;
    let quotient = |p: &usize| (flipping_j[*p] / stored_j[*p]).sqrt();
    let worst = (0..mesh.parts.len()).filter(beyond).max_by(|a, b| quotient(a).total_cmp(&quotient(b)))?;
    Some((mesh.parts[worst].clone(), quotient(&worst)))
}

/// Energy stored in an element by its stresses, with the pressure of bulk viscosity, and by its hourglass stresses \[J\].
fn element_stored_j(body: &Dynamics, element: usize) -> f64 {
    let (block, l) = body.blocks.of_element(element);
    let (material, state) = (block.material.lanes(), &block.state);
    let nodes = body.blocks.nodes_of(element).map(|n| body.x[n]);
    let volume = volume_m3(&nodes);
    let (lambda, mu) = (material.lambda_pa[l], material.mu_pa[l]);
    let density = |stress: [f64; 6]| {
        let s: [f64; 6] = std::array::from_fn(|i| stress[i] + if i < 3 { state.viscous_pa[l] } else { 0.0 });
        let trace = s[0] + s[1] + s[2];
        let normal = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
        let shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
        (normal + 2.0 * shear - lambda / (3.0 * lambda + 2.0 * mu) * trace * trace) / (4.0 * mu)
    };
    let of_stress = match &block.full {
        Some(points) => {
            let each = points.stress.iter().map(|s| density(std::array::from_fn(|i| s[i][l])));
            volume * each.sum::<f64>() / points.stress.len() as f64
        }
        None => volume * density(std::array::from_fn(|i| state.stress[i][l])),
    };
    let stresses = std::array::from_fn(|i| state.hourglass[i][l]);
    let of_hourglass = hourglass::stored_j(material.form, &nodes, [lambda, mu], &stresses);
    let stored = state.share[l] * (of_stress + of_hourglass);
    if stored >= 0.0 { stored } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::{Books, Trouble, Watch, fastest_node, smallest_step};
    use crate::fe::contact::RigidSurfaces;
    use crate::fe::dynamics::Dynamics;
    use crate::fe::law::{ElementForm, Hourglass};
    use crate::fe::mesh::Truss;
    use crate::fe::run::FeError;
    use crate::fe::shapes::{distort, elastic, grid};

    const FORMS: [ElementForm; 5] = [
        ElementForm::OnePoint(Hourglass::Asqbi),
        ElementForm::OnePoint(Hourglass::Ads),
        ElementForm::OnePoint(Hourglass::Asmd),
        ElementForm::OnePoint(Hourglass::Stiffness { coefficient: 0.1 }),
        ElementForm::FullyIntegrated,
    ];

    /// Steps a block that starts with random velocities and looks at it after each step; the first trouble with the number of the step.
    fn first_trouble(form: ElementForm, size_m: [f64; 3], share: f64) -> Option<(u64, Trouble)> {
        let mut mesh = grid([3, 3, 3], size_m, elastic(), |p| p[2] == 0.0);
        mesh.laws.iter_mut().for_each(|law| law.form = form);
        distort(&mut mesh.nodes, 0.02, 3, |p| p[2] > 0.0);
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        body.set_step_safety(share);
        body.failure.step_collapse = 0.0;
        distort(&mut body.v, 1e-3, 7, |_| true);
        for n in &mesh.fixed {
            body.v[*n] = [0.0; 3];
        }
        let (initial_j, mut watch) = (body.kinetic_j(), Watch::new(0.0));
        for step in 1..=600 {
            let kinetic_j = body.step(true);
            let books = Books::of(&body, kinetic_j, initial_j, 0.0);
            match watch.look(&mesh, &body, &books) {
                Ok(()) => {}
                Err(FeError::Unsound(d)) => return Some((step, d.trouble)),
                Err(e) => panic!("{e}"),
            }
        }
        None
    }

    #[test]
    fn bars_are_in_the_places_of_a_diagnosis() {
        let mut mesh = grid([1; 3], [1.0; 3], elastic(), |_| false);
        let (first, part) = (mesh.nodes.len(), mesh.parts.len());
        mesh.nodes.extend([[2.0, 0.0, 0.0], [2.02, 0.0, 0.0]]);
        mesh.parts.push("bars".into());
        mesh.trusses.push(Truss { nodes: [first, first + 1], area_m2: 1e-4, part, law: 0 });
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        body.v[first + 1] = [3.0, 0.0, 4.0];
        let asking = smallest_step(&mesh, &body).unwrap();
        assert_eq!((asking.index, &asking.part[..], asking.is_bar), (0, "bars", true));
        assert!((asking.at_m[0] - 2.01).abs() < 1e-12 && asking.at_m[1..] == [0.0; 2], "{asking:?}");
        assert!((asking.value / body.dt_s - 1.0).abs() < 1e-9, "{asking:?} {}", body.dt_s);
        let fastest = fastest_node(&mesh, &body).unwrap();
        assert_eq!((fastest.index, &fastest.part[..], fastest.value), (first + 1, "bars", 5.0));
        // a bar that has broken asks for nothing
        body.trusses.bars[0].acts = false;
        assert!(smallest_step(&mesh, &body).is_some_and(|p| !p.is_bar && p.index == 0));
    }

    #[test]
    fn alternating_motion_is_found_beyond_the_limit_only() {
        for form in FORMS {
            for size_m in [[3.0, 3.0, 3.0], [3.0, 1.0, 6.0], [6.0, 6.0, 0.6]] {
                assert_eq!(first_trouble(form, size_m, 0.9), None, "{form:?} {size_m:?}");
                assert_eq!(first_trouble(form, size_m, 1.0), None, "{form:?} {size_m:?}");
                // the bound of the fully integrated form is the coarser one
                let beyond = if form == ElementForm::FullyIntegrated { 2.5 } else { 1.6 };
                let found = first_trouble(form, size_m, beyond);
                let Some((_, Trouble::Alternates(_, share))) = found else {
                    panic!("{form:?} {size_m:?}: {found:?}")
                };
                assert!(share > 1.0 && share < beyond + 0.1, "{form:?} {size_m:?}: {share}");
            }
        }
    }
}
