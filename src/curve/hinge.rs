//! The plastic hinge about two bending axes.
//!
//! `M = K (θ - θ_p)` per axis, admissible while `f = sqrt((M₁/C₁)² + (M₂/C₂)²) <= 1` with
//! `C_i(α, N)`. A trial moment outside is brought back along the elastic rotation
//! `e = θ - θ_p`: `e := (1 - x/|e|) e`, `Δθ_p = x e/|e|`, `Δα = x`, where `x` solves the scalar equation
//! `1 - x/|e| = 1/f_trial(α + x)`, with the capacities at the *end* of the step. For equal
//! stiffness and capacity of the axes this is the associated closest-point return; otherwise it
//! differs from it, but flow still goes along the moment's own side: `M·e >= 0`. Where both axes flow, the return begins from a trial that has the direction of the elastic rotation at the end of the
//! step ([`turning`]), and the plastic rotation is what is left. Softening faster than the elastic
//! unloading (`-dC/dα > K`) snaps back: the moment falls at once to the next admissible point and the
//! dissipation is booked.
//!
//! Energy: with the trapezoidal work `½(M₀+M₁)·Δθ` of a step, the change of elastic energy
//! `½ΣK e²` is exactly `½(M₀+M₁)·(Δθ-Δθ_p)`; the rest, `½(M₀+M₁)·Δθ_p`, is the dissipation. The sum is exact
//! to round-off in every step, also while the capacity softens or the axial force changes it.

use super::capacity::{AxialLevel, CapacityHint, CapacityTable, Nearby};
use super::onset;
use super::rate::{Rate, is_same};
use super::turning::{self, Turning};

/// State of a hinge.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Hinge2 {
    /// Plastic rotation about both axes \[rad\].
    pub plastic_rad: [f64; 2],
    /// Accumulated plastic rotation \[rad\].
    pub alpha_rad: f64,
    /// Energy dissipated so far \[J\].
    pub dissipated_j: f64,
    /// Moments of the last step \[N m\].
    pub moment_nm: [f64; 2],
    /// Share of the rotation to fracture that is used up: the sum of the increments of plastic rotation, each over the fracture rotation at its axial force (linear damage, as in
    /// Johnson and Cook 1985, Eng. Fract. Mech. 21(1), 31-48). Under constant axial force it is the plastic rotation over the fracture rotation; a short pulse of axial force does not
    /// fracture a hinge that has turned far under another one.
    pub damage: f64,
    /// Whether the hinge has fractured: a damage of 1.
    pub fractured: bool,
    /// Plastic rotation of the last step about both axes \[rad\].
    pub flow_rad: [f64; 2],
    /// The share of that step after which it began to flow; zero: it flowed all the time.
    pub begins: f64,
    /// The share of its flow that was beyond fracture.
    pub beyond: f64,
    /// Whether an axial force lay outside the levels while the hinge was flowing.
    pub out_of_range: bool,
    /// How long the step to the next evaluation is against the one before; zero: rates have jumped in between, or nothing is known.
    pub pace: f64,
    /// Axial force at the start of the step to the next evaluation (compression positive), if it is known: what flows in the step does so under the mean of it and that of its end \[N\].
    pub axial_before_n: Option<f64>,
    /// What the rate of its flow in the step to the next evaluation does to its strength, about both axes; `None`: nothing.
    pub rates: Option<[Rate; 2]>,
    /// The same along its flow.
    rate: Option<Rate>,
    /// Whether it flowed in the last step, and how it was turned in it \[rad\].
    flows: bool,
    /// How far it flowed along itself when it did last \[rad\]: where the search begins, if it has a rate.
    flowed_rad: f64,
    turned_rad: [f64; 2],
    hint: [CapacityHint; 2],
}

/// Where a step begins: the moments, whether the step before flowed, and what it turned the hinge by then.
#[derive(Debug)]
struct Begin {
    moment_nm: [f64; 2],
    flowed: bool,
    turned_rad: [f64; 2],
}

/// Whether moments are those of the same pose once more.
fn are_same(before_nm: [f64; 2], after_nm: [f64; 2]) -> bool {
    (0..2).all(|i| is_same(before_nm[i], after_nm[i]))
}

/// Whether the moments of a [`Hinge2::trial`] are outside by more than rounding.
fn is_outside([f, _]: [f64; 2]) -> bool {
    f > 1.0 && 1.0 - 1.0 / f > 0.0
}

/// [`Hinge2::trial`] by that at rest, for a flow in the time of the rate.
fn rated([f, slope]: [f64; 2], rate: Option<Rate>, x: f64) -> [f64; 2] {
    let Some([factor, growth]) = rate.map(|rate| rate.at(x)) else { return [f, slope] };
    [f / factor, factor * slope + growth / f]
}

/// The law of one axis.
#[derive(Debug, Clone, Copy)]
pub enum AxisLaw<'a> {
    /// Linear elastic with this stiffness \[N m/rad\].
    Elastic(f64),
    /// Elastic-plastic.
    Plastic(&'a CapacityTable),
}

impl AxisLaw<'_> {
    /// Elastic stiffness \[N m/rad\].
    #[inline]
    pub fn stiffness_nm_rad(&self) -> f64 {
        match self {
            Self::Elastic(k) => *k,
            Self::Plastic(table) => table.stiffness_nm_rad(),
        }
    }
}

/// What one step of a hinge did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct HingeStep {
    /// Elastic energy after the step \[J\].
    pub elastic_j: f64,
    /// Whether plastic rotation grew.
    pub flowing: bool,
    /// What the moments have done in the step beyond the mean of its start and end, if it began to flow ([`onset`]) \[N m\].
    pub onset_nm: [f64; 2],
}

/// Relative accuracy of the return to the yield surface, in terms of the moment.
const RETURN_TOLERANCE: f64 = 1e-13;
/// Square of the share of the capacity up to which a bound of the capacity settles that the moment is inside.
pub const WELL_INSIDE: f64 = 1.0 - 1e-9;
/// The same up to which a bound for all axial forces is as good as a nearer one.
pub(super) const FAR_INSIDE: f64 = 0.6;
/// Smallest capacity, relative to the peak: keeps the ratio `M/C` finite at the end of softening.
const CAPACITY_FLOOR: f64 = 1e-9;

impl Hinge2 {
    /// Advances to the rotations `theta_rad` under the axial force (compression positive) and sets
    /// [`Self::moment_nm`].
    #[inline]
    pub fn step(&mut self, laws: [AxisLaw<'_>; 2], theta_rad: [f64; 2], axial_force_n: f64) -> HingeStep {
        let k = laws.map(|law| law.stiffness_nm_rad());
        let e = [theta_rad[0] - self.plastic_rad[0], theta_rad[1] - self.plastic_rad[1]];
        let trial = [k[0] * e[0], k[1] * e[1]];
        let begin = Begin {
            moment_nm: std::mem::replace(&mut self.moment_nm, trial),
            flowed: std::mem::replace(&mut self.flows, false),
            turned_rad: std::mem::take(&mut self.turned_rad),
        };
        self.flow_rad = [0.0; 2];
        let stays =
            HingeStep { elastic_j: 0.5 * (trial[0] * e[0] + trial[1] * e[1]), ..HingeStep::default() };
        if self.is_well_inside(laws, trial, axial_force_n) {
            return stays;
        }
        self.rate = None;
        let levels = self.levels(laws, axial_force_n);
        let first = self.trial(laws, trial, 0.0, levels);
        if !is_outside(first) || (self.rates.is_some() && are_same(begin.moment_nm, trial)) {
            return stays;
        }
        let (step, x) = self.flow(laws, e, levels, &begin, first);
        let mean_n = 0.5 * (self.axial_before_n.unwrap_or(axial_force_n) + axial_force_n);
        let used = x / self.fracture_rotation_rad(laws, mean_n);
        self.damage += used;
        if self.damage >= 1.0 && !self.fractured {
            (self.fractured, self.beyond) = (true, ((self.damage - 1.0) / used).min(1.0));
        }
        step
    }

    /// A step that ends outside: the elastic rotation `e` goes back to the surface. How far along itself \[rad\].
    fn flow(
        &mut self,
        laws: [AxisLaw<'_>; 2],
        mut e: [f64; 2],
        levels: [AxialLevel; 2],
        begin: &Begin,
        first: [f64; 2],
    ) -> (HingeStep, f64) {
        let k = laws.map(|law| law.stiffness_nm_rad());
        let (old, trial) = (begin.moment_nm, self.moment_nm);
        let plastic = laws.map(|law| matches!(law, AxisLaw::Plastic(_)));
        let both = plastic == [true; 2];
        let of_plastic = |e: [f64; 2]| [0, 1].map(|i| if plastic[i] { e[i] } else { 0.0 });
        self.rate = self.rates.map(|rates| Rate::along(rates, of_plastic(e)));
        let leaves =
            (both || !begin.flowed).then(|| self.leaves(laws, [old, trial], levels, 1.0, begin.flowed));
        let mut onset =
            leaves.filter(|(share, inside)| !begin.flowed && *inside && *share < 1.0).map(|l| l.0);
        let turned = match leaves {
            Some((share, _)) if both => self.turn(laws, [old, trial], share, begin.turned_rad, levels),
            _ => None,
        };
        let (from, first) = turned.unwrap_or((e, first));
        let active = of_plastic(from);
        self.rate = self.rates.map(|rates| Rate::along(rates, active));
        let length = (active[0] * active[0] + active[1] * active[1]).sqrt();
        let x = self.solve(laws, [k[0] * from[0], k[1] * from[1]], length, levels, first);
        let flow_rad = [0, 1].map(|i| active[i] * (x / length) + (e[i] - from[i]));
        let mut dissipated_j = 0.0;
        for (i, flow) in flow_rad.into_iter().enumerate() {
            self.plastic_rad[i] += flow;
            e[i] -= flow;
            self.moment_nm[i] = k[i] * e[i];
            dissipated_j += 0.5 * (old[i] + self.moment_nm[i]) * flow;
        }
        if let (Some(share), Some(rate)) = (&mut onset, self.rate) {
            // stiff as it is, it is at what the rate lets it bear as soon as it flows
            *share = self.leaves(laws, [old, trial], levels, rate.at(x)[0], false).0.min(1.0);
        }
        self.dissipated_j += dissipated_j;
        self.alpha_rad += x;
        self.flowed_rad = x;
        (self.flows, self.flow_rad, self.begins) = (true, flow_rad, onset.unwrap_or(0.0));
        let end = self.moment_nm;
        let onset_nm = onset.map_or([0.0; 2], |share| {
            std::array::from_fn(|i| onset::added(old[i], old[i] + share * (trial[i] - old[i]), end[i], share))
        });
        let elastic_j = 0.5 * (end[0] * e[0] + end[1] * e[1]);
        (HingeStep { elastic_j, flowing: true, onset_nm }, x)
    }

    /// The share of a step after which the moments, from where they are at its start straight to where they would be without flow, leave the surface, a `factor` larger than it is, and whether they begin inside. What `flowed` and goes on
    /// outwards does not: where it begins inside, the capacity has grown within the step.
    fn leaves(
        &mut self,
        laws: [AxisLaw<'_>; 2],
        [begin, trial]: [[f64; 2]; 2],
        levels: [AxialLevel; 2],
        factor: f64,
        flowed: bool,
    ) -> (f64, bool) {
        // a s² + b s + c = 0 where the moments are at the capacities
        let (mut a, mut b, mut c) = (0.0, 0.0, -factor * factor);
        for i in 0..2 {
            if let AxisLaw::Plastic(table) = laws[i] {
                let capacity = table.capacity_at(self.alpha_rad, levels[i], &mut self.hint[i]).moment_nm;
                let ease = capacity.max(CAPACITY_FLOOR * table.peak_nm()).powi(-2);
                let change = trial[i] - begin[i];
                a += ease * change * change;
                b += 2.0 * ease * begin[i] * change;
                c += ease * begin[i] * begin[i];
            }
        }
        if flowed && b >= 0.0 {
            return (0.0, false);
        }
        let share = ((b * b - 4.0 * a * c).max(0.0).sqrt() - b) / (2.0 * a);
        (share, c < 0.0)
    }

    /// What the elastic rotation is returned from at the end of a step whose moments leave the surface after a `share` of it, where the step before turned the hinge by `before`, and
    /// [`Self::trial`] there ([`turning`]).
    fn turn(
        &mut self,
        laws: [AxisLaw<'_>; 2],
        [begin, trial]: [[f64; 2]; 2],
        share: f64,
        before: [f64; 2],
        levels: [AxialLevel; 2],
    ) -> Option<([f64; 2], [f64; 2])> {
        let k = laws.map(|law| law.stiffness_nm_rad());
        let turn = [0, 1].map(|i| (trial[i] - begin[i]) / k[i]);
        let stays = are_same(begin, trial);
        self.turned_rad = if stays { before } else { turn };
        if stays {
            return None;
        }
        let share = if (0.0..1.0).contains(&share) { share } else { 0.0 };
        let ahead = turning::ahead(turn, before, self.pace);
        let turning = Turning {
            from: [0, 1].map(|i| begin[i] / k[i] + share * turn[i]),
            path: turn.map(|t| (1.0 - share) * t),
            ahead: ahead.map(|t| (1.0 - share) * t),
            is_rated: self.rate.is_some(),
        };
        let along = |[a, b]: [f64; 2]| [k[0] * a, k[1] * b];
        let reached = turning.trial(|direction, flow| {
            let at_rest = self.surface(laws, along(direction), flow.before + flow.flow, levels);
            let rate = self.rate.map(|rate| rate.within(flow.share));
            let [f, slope] = rated(at_rest, rate, flow.flow);
            [1.0 / f, slope]
        })?;
        let there = self.trial(laws, along(reached), 0.0, levels);
        is_outside(there).then_some((reached, there))
    }

    /// The share of the last step after which it broke; 1 if it did not.
    pub fn broke_at(&self) -> f64 {
        if self.fractured { 1.0 - (1.0 - self.begins) * self.beyond } else { 1.0 }
    }

    /// Takes back the flow after a share of the last step.
    pub fn take_back(&mut self, share: f64) {
        let left = if share > self.begins { (1.0 - share) / (1.0 - self.begins) } else { 1.0 };
        let flow = self.flow_rad.map(|flow| left * flow);
        (0..2).for_each(|k| self.plastic_rad[k] -= flow[k]);
        self.alpha_rad = (self.alpha_rad - libm::hypot(flow[0], flow[1])).max(0.0);
    }

    /// How much shorter the flow of its last step made the member by normality ([`CapacityTable::shortening_m`]) \[m\].
    pub fn shortened_m(&mut self, laws: [AxisLaw<'_>; 2], axial_force_n: f64) -> f64 {
        let levels = self.levels(laws, axial_force_n);
        let mut shortened_m = 0.0;
        for i in 0..2 {
            if let AxisLaw::Plastic(table) = laws[i] {
                let capacity = table.capacity_at(self.alpha_rad, levels[i], &mut self.hint[i]);
                let used =
                    (self.moment_nm[i] / capacity.moment_nm.max(CAPACITY_FLOOR * table.peak_nm())).abs();
                let axis_m = table.shortening_m(levels[i], capacity.moment_nm, axial_force_n);
                shortened_m += used.min(1.0) * self.flow_rad[i].abs() * axis_m;
            }
        }
        shortened_m
    }

    /// Whether a bound without interpolation shows that the moment is inside.
    #[inline]
    fn is_well_inside(&self, laws: [AxisLaw<'_>; 2], trial: [f64; 2], n: f64) -> bool {
        let near = self.bounds(laws, |table, hint| table.nearby(self.alpha_rad, n, hint));
        near.is_some_and(|(_, ease)| (0..2).map(|i| trial[i] * trial[i] * ease[i]).sum::<f64>() < WELL_INSIDE)
    }

    /// About which axial forces \[N\], and with which `1/C²` of both axes \[1/(N m)²\], the moment is elastic while `Σ M_i²/C_i² <` [`WELL_INSIDE`] and the hinge has not flowed
    /// again: those of all axial forces if the present moment is well below them, else those near the present one.
    pub fn elastic_range(&self, laws: [AxisLaw<'_>; 2], axial_force_n: f64) -> Option<([f64; 2], [f64; 2])> {
        let all = self.bounds(laws, |table, hint| table.anywhere(self.alpha_rad, hint));
        let used =
            |ease: [f64; 2]| (0..2).map(|i| self.moment_nm[i] * self.moment_nm[i] * ease[i]).sum::<f64>();
        match all {
            Some((_, ease)) if used(ease) < FAR_INSIDE => all,
            _ => self.bounds(laws, |table, hint| table.nearby(self.alpha_rad, axial_force_n, hint)),
        }
    }

    fn bounds(
        &self,
        laws: [AxisLaw<'_>; 2],
        bound: impl Fn(&CapacityTable, &CapacityHint) -> Option<Nearby>,
    ) -> Option<([f64; 2], [f64; 2])> {
        let (mut force, mut ease) = ([f64::NEG_INFINITY, f64::INFINITY], [0.0; 2]);
        for i in 0..2 {
            if let AxisLaw::Plastic(table) = laws[i] {
                let near = bound(table, &self.hint[i]).filter(|near| near.least_nm > 0.0)?;
                force = [force[0].max(near.force_n[0]), force[1].min(near.force_n[1])];
                ease[i] = 1.0 / (near.least_nm * near.least_nm);
            }
        }
        (!self.fractured).then_some((force, ease))
    }

    #[inline]
    fn levels(&mut self, laws: [AxisLaw<'_>; 2], n: f64) -> [AxialLevel; 2] {
        let mut levels = [AxialLevel::default(); 2];
        for i in 0..2 {
            if let AxisLaw::Plastic(table) = laws[i] {
                levels[i] = table.level(n, &mut self.hint[i]);
            }
        }
        levels
    }

    /// `f_trial(α + x)` and `d(1/f_trial)/dx`, where `x` flows in this step.
    #[inline]
    fn trial(
        &mut self,
        laws: [AxisLaw<'_>; 2],
        trial: [f64; 2],
        x: f64,
        levels: [AxialLevel; 2],
    ) -> [f64; 2] {
        rated(self.surface(laws, trial, x, levels), self.rate, x)
    }

    /// The same at rest.
    #[inline]
    fn surface(
        &mut self,
        laws: [AxisLaw<'_>; 2],
        trial: [f64; 2],
        x: f64,
        levels: [AxialLevel; 2],
    ) -> [f64; 2] {
        let mut f2 = 0.0;
        let mut slope = 0.0;
        for (i, law) in laws.iter().enumerate() {
            if let AxisLaw::Plastic(table) = law {
                let capacity = table.capacity_at(self.alpha_rad + x, levels[i], &mut self.hint[i]);
                let floor = CAPACITY_FLOOR * table.peak_nm();
                let (c, dc) = if capacity.moment_nm > floor {
                    (capacity.moment_nm, capacity.slope_nm_rad)
                } else {
                    (floor, 0.0)
                };
                let q = trial[i] / c;
                f2 += q * q;
                slope += q * q * dc / c;
                self.out_of_range |= capacity.out_of_range && q * q > 1.0;
            }
        }
        let f = f2.sqrt();
        [f, slope / (f2 * f)]
    }

    /// The plastic increment, the zero of `1 - x/|e| - 1/f_trial(α + x)`, which is positive while the moment is outside: Newton from the start of the
    /// step, kept inside a shrinking bracket. `at` is [`Self::trial`] there.
    fn solve(
        &mut self,
        laws: [AxisLaw<'_>; 2],
        trial: [f64; 2],
        length: f64,
        levels: [AxialLevel; 2],
        mut at: [f64; 2],
    ) -> f64 {
        let (mut low, mut high) = (0.0, length);
        let mut x = 0.0;
        if self.rate.is_some() && self.flowed_rad > 0.0 && self.flowed_rad < length {
            x = self.flowed_rad;
            at = self.trial(laws, trial, x, levels);
        }
        for i in 0..100 {
            if i > 0 {
                at = self.trial(laws, trial, x, levels);
            }
            let [f, slope] = at;
            let (g, dg) = (1.0 - x / length - 1.0 / f, -1.0 / length - slope);
            if g.abs() <= RETURN_TOLERANCE {
                break;
            }
            if g > 0.0 {
                low = x;
            } else {
                high = x;
            }
            let newton = x - g / dg;
            x = if dg < 0.0 && newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if high - low <= 1e-15 * length {
                break;
            }
        }
        x
    }

    #[inline]
    /// The smaller fracture rotation of both axes.
    fn fracture_rotation_rad(&mut self, laws: [AxisLaw<'_>; 2], n: f64) -> f64 {
        let mut least = f64::INFINITY;
        for (law, hint) in laws.iter().zip(&mut self.hint) {
            if let AxisLaw::Plastic(table) = law {
                least = least.min(table.fracture_rotation_rad(n, hint));
            }
        }
        least
    }
}
