//! The energy balance over a run: whether the sum of all energies holds, and whether contacts and what yields only take.
//!
//! **Energy turned over** is what errors are compared with: the largest value so far of kinetic energy, work of gravity (without sign) and dissipation by what yields together, or of what contacts have
//! taken, or of the work of applied forces on ideal joints; in a model in which nothing happens a scale of it ([`Balance::new`]).

use super::error::SolveError;
use super::result::Energies;

/// What the looks so far show.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Balance {
    /// Sum of all energies at the first look \[J\].
    start_j: Option<f64>,
    /// Energy turned over so far \[J\].
    turnover_j: f64,
    /// Least energy that what contacts make is compared with \[J\].
    contacts_j: f64,
    /// Most that contacts had taken \[J\].
    taken_j: f64,
    /// Largest amount by which contacts gave back of it \[J\].
    made_j: f64,
    /// Most that what yields had dissipated, and the largest amount by which that fell: the sum does not show it, since it is what the sum leaves for it \[J\].
    dissipated_j: f64,
    returned_j: f64,
    /// Largest error of the sum over the energy turned over.
    pub error: f64,
    /// Largest growth of the sum over the energy turned over.
    pub growth: f64,
}

impl Balance {
    /// With the scales of a model in which nothing happens: that of all energies, and of what contacts make, which is more, since weight that passes through a stack does work on it to and fro \[J\].
    pub fn new(scale_j: f64, contacts_j: f64) -> Self {
        Self { turnover_j: scale_j.max(f64::MIN_POSITIVE), contacts_j, ..Self::default() }
    }

    /// Work of the weight \[N\] of bodies on a tenth of their radii \[m\]: the least that what contacts make is compared with \[J\].
    pub fn of_contacts(bodies: impl Iterator<Item = (f64, f64)>) -> f64 {
        bodies.map(|(weight_n, radius_m)| 0.1 * weight_n * radius_m).sum()
    }

    /// Takes in a look, at which so much energy had been turned over, and in whose kinetic energy so much is what forces add in half a step: that rises and falls with every vibration, and is no growth; what contacts hold against forces they take with the next step only. Returns the error of the sum there.
    pub fn note(&mut self, energies: &Energies, kick_j: f64, turned_j: f64) -> f64 {
        let total_j = energies.total_j();
        let start_j = *self.start_j.get_or_insert(total_j);
        // each of the two can be large where a contact is jammed, and they cancel each other then
        let taken_j = energies.contact_damping_j + energies.friction_j;
        self.taken_j = self.taken_j.max(taken_j);
        self.made_j = self.made_j.max(self.taken_j - taken_j - kick_j);
        self.turnover_j = self.turnover_j.max(turned_j).max(taken_j);
        self.dissipated_j = self.dissipated_j.max(energies.plastic_j);
        self.returned_j = self.returned_j.max(self.dissipated_j - energies.plastic_j);
        let grown = (total_j - start_j) / self.turnover_j;
        self.growth = self.growth.max(grown - kick_j / self.turnover_j);
        self.error = self.error.max(grown.abs());
        grown.abs()
    }

    /// Energy turned over so far \[J\].
    pub fn turned_j(&self) -> f64 {
        self.turnover_j
    }

    /// Energy that contacts made, as a share of that turned over. Contacts with friction and rebound only take energy; impulses that
    /// do not settle, as in a jammed mechanism, can make some.
    pub fn made(&self) -> f64 {
        self.made_j / self.turnover_j.max(self.contacts_j)
    }

    /// Energy that what yields gave back of what it had dissipated, as a share of that turned over: a law that breaks the second law of thermodynamics in steps of this length.
    pub fn returned(&self) -> f64 {
        self.returned_j / self.turnover_j
    }

    /// The diagnosis if contacts have made more than a share.
    ///
    /// # Errors
    /// [`SolveError::ContactEnergy`] if so.
    pub fn check_contacts(&self, time_s: f64, limit: f64, step_s: f64) -> Result<(), SolveError> {
        if self.made() <= limit {
            return Ok(());
        }
        Err(SolveError::ContactEnergy { time_s, made_j: self.made_j, share: self.made(), limit, step_s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(kinetic_j: f64, taken_j: f64) -> Energies {
        // jammed: large, and of opposite signs
        Energies { kinetic_j, contact_damping_j: taken_j + 1e6, friction_j: -1e6, ..Energies::default() }
    }

    #[test]
    fn contacts_that_give_back_make_energy() {
        let mut balance = Balance::new(1e-3, 0.0);
        for (kinetic_j, taken_j) in [(100.0, 0.0), (60.0, 40.0), (90.0, 10.0)] {
            let error = balance.note(&look(kinetic_j, taken_j), 0.0, kinetic_j);
            assert!(error < 1e-9, "{error}");
        }
        assert!((balance.made() - 0.3).abs() < 1e-12, "{}", balance.made());
        assert!(balance.check_contacts(1.0, 0.31, 1e-3).is_ok());
        let said = balance.check_contacts(1.0, 0.29, 1e-3).unwrap_err().to_string();
        assert!(said.contains("contacts have made 3.00e1 J"), "{said}");
    }

    /// A body at rest has what its weight adds in half a step of kinetic energy at each output, which its contacts have yet to take.
    #[test]
    fn contacts_that_hold_a_body_at_rest_make_no_energy() {
        let kick_j = 0.2;
        let mut balance = Balance::new(1.0, 0.0);
        for (kinetic_j, taken_j) in [(0.0, 0.0), (kick_j, -kick_j), (kick_j, -kick_j)] {
            balance.note(&look(kinetic_j, taken_j), kick_j, kinetic_j);
        }
        assert_eq!(balance.made(), 0.0);
        balance.note(&look(kick_j + 0.3, -kick_j - 0.3), kick_j, 0.0);
        assert!((balance.made() - 0.3).abs() < 1e-12, "{}", balance.made());
    }

    #[test]
    fn what_contacts_make_is_small_beside_what_bodies_weigh() {
        let contacts_j = Balance::of_contacts([(100.0, 0.4), (50.0, 0.2)].into_iter());
        assert!((contacts_j - 5.0).abs() < 1e-12);
        let mut balance = Balance::new(1e-3, contacts_j);
        for (kinetic_j, taken_j) in [(0.0, 0.0), (0.0, 0.05), (0.05, 0.0)] {
            balance.note(&look(kinetic_j, taken_j), 0.0, 0.0);
        }
        assert!((balance.made() - 0.01).abs() < 1e-9, "{}", balance.made());
    }

    #[test]
    fn what_yields_only_takes() {
        let mut balance = Balance::new(1e-3, 0.0);
        for (kinetic_j, plastic_j) in [(100.0, 0.0), (60.0, 40.0), (70.0, 30.0), (50.0, 50.0)] {
            balance.note(&Energies { kinetic_j, plastic_j, ..Energies::default() }, 0.0, kinetic_j);
        }
        assert!(balance.error < 1e-9 && (balance.returned() - 0.1).abs() < 1e-12, "{}", balance.returned());
    }

    #[test]
    fn work_that_cancels_does_not_hide_an_error_of_the_sum() {
        let mut balance = Balance::new(1e-3, 0.0);
        balance.note(&look(100.0, 0.0), 0.0, 100.0);
        let error = balance.note(&look(90.0, 0.0), 0.0, 90.0);
        assert!((error - 0.1).abs() < 1e-12, "{error}");
    }
}
