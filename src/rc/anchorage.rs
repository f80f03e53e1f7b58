//! Slip of bars out of their anchorage in the joint or footing, and their pull-out.
//!
//! **Slip.** Bond is uniform in two steps (Sezen and Setzler 2008, ACI Struct. J. 105(3), 280-289): `u = 1.0 sqrt(f_c)` MPa along the part of a bar that is elastic,
//! `u' = 0.5 sqrt(f_c)` MPa along the part that has yielded. Strains vary linearly along each part, so with `l_d = f_s d_b / 4u` (at most that of `f_y`) and
//! `l_d' = (f_s − f_y) d_b / 4u'` the slip at the end section is `ε_s l_d / 2`, beyond yield `ε_y l_d / 2 + (ε_y + ε_s) l_d' / 2`. Where the anchorage is shorter
//! than this, a hook at its end holds the stress that is left there, and does not slip itself.
//!
//! **Pull-out.** A straight bar whose bond is used up along its length slides: its force stays for 1 mm, falls to 0.4 of it until it has slipped by the distance of
//! its ribs (0.6 diameters), then with the length that is left. Bond over slip of fib Model Code 2010, table 6.1-1, pull-out with good bond: `s_2 − s_1` = 1 mm, `s_3` =
//! clear distance of the ribs, `τ_f = 0.4 τ_max`.
//!
//! **Cycles** ([`SlipLaw::stress_pa`]). Unloading is stiff; a bar that is pushed back meets friction that grows to what it was pulled with, and once it is back bears stiffly;
//! pulled again it aims at its largest slip. Each branch dissipates. A compressed bar that never slipped bears with the initial stiffness.

use super::member::{Joint, RcMember};
use crate::base::piecewise::interpolate;
use crate::building::Bar;
use crate::fe::dynamics::Dynamics;
use crate::material::rebar::{Hardening, RebarLaw};
use serde::Serialize;

/// Bond along the elastic part over `sqrt(f_c)` in MPa.
const ELASTIC_BOND: f64 = 1.0;
/// Bond along the yielded part over that along the elastic part.
const YIELDED_SHARE: f64 = 0.5;
/// Share of the yield strength up to which slip is taken as proportional to stress.
const LINEAR_SHARE: f64 = 0.1;
/// Ratio of stresses of neighbouring points of a slip law below yield.
const POINT_RATIO: f64 = 1.06;
/// Points of a slip law beyond yield.
const YIELDED_POINTS: usize = 40;
/// Slip over which a bar that slides keeps its force \[m\].
const SLIDING_M: f64 = 1e-3;
/// Distance of ribs over the diameter.
const RIB_DISTANCE: f64 = 0.6;
/// Share of the force that friction holds.
const FRICTION_SHARE: f64 = 0.4;
/// Heights counted as that of the end section \[m\].
const SAME_M: f64 = 1e-9;

/// How a bar ends in the joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// Straight: it can be pulled out.
    Straight,
    /// With a hook, which holds what bond leaves.
    Hook,
}

/// Anchorage of a member's bars in its joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Anchorage {
    /// Straight length from the end section to the end of the bar or its hook \[m\]; `None`: long enough.
    pub length_m: Option<f64>,
    /// What is at the end.
    pub ending: Ending,
    /// Bond along the elastic part \[Pa\]; `None`: from the strength of the concrete.
    pub bond_pa: Option<f64>,
    /// Bond along the yielded part \[Pa\]; `None`: half of the other.
    pub yielded_bond_pa: Option<f64>,
}

impl Anchorage {
    /// Bars that slip, long enough, with the bond of the concrete.
    pub const LONG: Self =
        Self { length_m: None, ending: Ending::Straight, bond_pa: None, yielded_bond_pa: None };

    /// One bar of a diameter \[m\] in concrete of a strength \[Pa\].
    pub fn of_bar(&self, steel: RebarLaw, diameter_m: f64, strength_pa: f64) -> EmbeddedBar {
        let elastic = self.bond_pa.unwrap_or(ELASTIC_BOND * (strength_pa * 1e6).sqrt());
        EmbeddedBar {
            steel,
            diameter_m,
            bond_pa: [elastic, self.yielded_bond_pa.unwrap_or(YIELDED_SHARE * elastic)],
            length_m: self.length_m.unwrap_or(f64::INFINITY),
            ending: self.ending,
        }
    }
}

/// A bar in its anchorage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EmbeddedBar {
    /// Law of the bar.
    pub steel: RebarLaw,
    /// Diameter \[m\].
    pub diameter_m: f64,
    /// Bond along the elastic and the yielded part \[Pa\].
    pub bond_pa: [f64; 2],
    /// Length to its end or hook \[m\], may be infinite.
    pub length_m: f64,
    /// What is at the end.
    pub ending: Ending,
}

impl EmbeddedBar {
    /// Slip at the end section \[m\] under a tensile stress \[Pa\]; `None` above the capacity.
    pub fn slip_m(&self, stress_pa: f64) -> Option<f64> {
        if stress_pa > self.capacity_pa() {
            return None;
        }
        let [bond, yielded_bond] = self.bond_pa;
        let (fy, e) = (self.steel.yield_strength_pa, self.steel.youngs_modulus_pa);
        let yielded = self.develop_m(stress_pa - fy, yielded_bond).max(0.0);
        if yielded > self.length_m {
            let at_hook = stress_pa - 4.0 * yielded_bond * self.length_m / self.diameter_m;
            return Some(0.5 * (self.strain_at(stress_pa) + self.strain_at(at_hook)) * self.length_m);
        }
        let (stress, rest) = (stress_pa.min(fy), self.length_m - yielded);
        let elastic = self.develop_m(stress, bond);
        let slip = if elastic <= rest {
            0.5 * stress / e * elastic
        } else {
            let at_hook = stress - 4.0 * bond * rest / self.diameter_m;
            0.5 * (stress + at_hook) / e * rest
        };
        let mean = 0.5 * (fy / e + self.strain_at(stress_pa));
        Some(if yielded > 0.0 { slip + mean * yielded } else { slip })
    }

    /// Stress that bond along the whole length bears \[Pa\]; infinite with a hook.
    pub fn capacity_pa(&self) -> f64 {
        if self.ending == Ending::Hook || !self.length_m.is_finite() {
            return f64::INFINITY;
        }
        let (fy, [bond, yielded_bond]) = (self.steel.yield_strength_pa, self.bond_pa);
        let elastic = 4.0 * bond * self.length_m / self.diameter_m;
        let rest = self.length_m - self.develop_m(fy, bond);
        if rest <= 0.0 { elastic } else { fy + 4.0 * yielded_bond * rest / self.diameter_m }
    }

    /// Length in which a bond \[Pa\] takes up a stress \[Pa\].
    fn develop_m(&self, stress_pa: f64, bond_pa: f64) -> f64 {
        stress_pa * self.diameter_m / (4.0 * bond_pa)
    }

    /// Strain at a stress \[Pa\] in monotonic tension, on the hardening branch beyond yield.
    fn strain_at(&self, stress_pa: f64) -> f64 {
        let s = &self.steel;
        let beyond = stress_pa - s.yield_strength_pa;
        if beyond <= 0.0 {
            return stress_pa / s.youngs_modulus_pa;
        }
        match s.hardening {
            Hardening::Bilinear { ratio } => s.yield_strain() + beyond / (ratio * s.youngs_modulus_pa),
            Hardening::Plateau { start_strain, ultimate_strength_pa, exponent } => {
                let left = (ultimate_strength_pa - stress_pa) / (ultimate_strength_pa - s.yield_strength_pa);
                let left = crate::material::rate::power(left.clamp(1e-12, 1.0), 1.0 / exponent);
                s.ultimate_strain - (s.ultimate_strain - start_strain) * left
            }
        }
    }

    /// The law of its slip.
    pub fn law(&self) -> SlipLaw {
        let ultimate = self.steel.monotonic_pa(self.steel.ultimate_strain);
        let end = ultimate.min(self.capacity_pa());
        let elastic = end.min(self.steel.yield_strength_pa);
        let mut stresses = vec![LINEAR_SHARE * elastic];
        while stresses[stresses.len() - 1] * POINT_RATIO < elastic {
            stresses.push(stresses[stresses.len() - 1] * POINT_RATIO);
        }
        stresses.push(elastic);
        if end > elastic * (1.0 + 1e-9) {
            let step = (end - elastic) / YIELDED_POINTS as f64;
            stresses.extend((1..YIELDED_POINTS).map(|i| elastic + step * i as f64));
            stresses.push(end);
        }
        let mut points = vec![[0.0; 2]];
        points.extend(stresses.iter().filter_map(|s| Some([self.slip_m(*s)?, *s])));
        let stiffness_pa_m = points[1][1] / points[1][0];
        let last = points[points.len() - 1][0];
        let slides = end < ultimate;
        if slides {
            let ribs = (RIB_DISTANCE * self.diameter_m - 2.0 * SLIDING_M).max(SLIDING_M);
            let friction = last + SLIDING_M + ribs;
            points.push([last + SLIDING_M, end]);
            points.push([friction, FRICTION_SHARE * end]);
            points.push([self.length_m.max(friction + SLIDING_M), 0.0]);
        }
        SlipLaw { points, stiffness_pa_m, sliding_m: if slides { last } else { f64::INFINITY } }
    }
}

/// Stress over slip of a bar at the end section.
#[derive(Debug, Clone, PartialEq)]
pub struct SlipLaw {
    /// `[slip (m), stress (Pa)]` in monotonic tension, from zero, slip rising.
    points: Vec<[f64; 2]>,
    /// Slope at the start, of unloading and of compression \[Pa/m\].
    stiffness_pa_m: f64,
    /// Slip at which it begins to slide, infinite if it never does \[m\].
    sliding_m: f64,
}

/// Where a bar is in its slip law; the default is the virgin bar.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SlipState {
    /// Slip \[m\].
    pub slip_m: f64,
    /// Stress, tension positive \[Pa\].
    pub stress_pa: f64,
    /// Largest slip \[m\].
    pub furthest_m: f64,
}

impl SlipLaw {
    /// Slope at the start, of unloading and of compression \[Pa/m\]; none is steeper.
    pub fn stiffness_pa_m(&self) -> f64 {
        self.stiffness_pa_m
    }

    /// Whether a bar has begun to slide.
    pub fn slides(&self, state: &SlipState) -> bool {
        state.furthest_m > self.sliding_m
    }

    /// Stress \[Pa\] in monotonic tension at a slip \[m\] that is not negative.
    pub fn monotonic_pa(&self, slip_m: f64) -> f64 {
        interpolate(&self.points, slip_m)
    }

    /// Takes a bar to a slip \[m\]; the stress \[Pa\].
    pub fn stress_pa(&self, state: &mut SlipState, slip_m: f64) -> f64 {
        let trial = state.stress_pa + self.stiffness_pa_m * (slip_m - state.slip_m);
        let furthest = state.furthest_m;
        let pulled = self.monotonic_pa(furthest);
        let [low, high] = if slip_m >= furthest {
            [0.0, self.monotonic_pa(slip_m)]
        } else if slip_m > 0.0 {
            [-pulled * (1.0 - slip_m / furthest), pulled * slip_m / furthest]
        } else {
            [f64::NEG_INFINITY, 0.0]
        };
        let stress_pa = trial.max(low).min(high);
        *state = SlipState { slip_m, stress_pa, furthest_m: furthest.max(slip_m) };
        stress_pa
    }
}

/// A bar of a member that slips: a node of its own at the end section, on the node of the concrete there.
#[derive(Debug, Clone, PartialEq)]
pub struct BarSlip {
    /// Node of the bar.
    pub node: usize,
    /// Node of the concrete.
    pub onto: usize,
    /// Area \[m²\].
    pub area_m2: f64,
    /// Its law.
    pub law: SlipLaw,
}

impl RcMember {
    /// Lets the bars slip out of the joint: each ends at the end section, in a node of its own that keeps its place across the member.
    /// `bars` and `steel` are those of the section, the strength that of the joint's concrete \[Pa\].
    #[must_use]
    pub fn anchored(
        mut self,
        anchorage: &Anchorage,
        steel: RebarLaw,
        bars: &[Bar],
        strength_pa: f64,
    ) -> Self {
        let height = |mesh: &crate::fe::mesh::Mesh, n: usize| mesh.nodes[n][2];
        let mut is_bar = vec![false; self.mesh.trusses.len()];
        self.bars.iter().for_each(|t| is_bar[*t] = true);
        let mut kept = Vec::with_capacity(is_bar.len());
        self.bars.clear();
        for (t, mut truss) in std::mem::take(&mut self.mesh.trusses).into_iter().enumerate() {
            if is_bar[t] {
                let [low, high] = truss.nodes.map(|n| height(&self.mesh, n));
                if low.max(high) < SAME_M {
                    continue; // in the block: its place takes the slip law
                }
                if low.abs() < SAME_M {
                    let onto = truss.nodes[0];
                    let at = self.mesh.nodes[onto];
                    let away = |b: &&Bar| libm::hypot(b.x_m - at[0], b.y_m - at[1]);
                    let nearest = bars.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
                    let diameter_m = nearest.map_or(0.02, |b| b.diameter_m);
                    let law = anchorage.of_bar(steel, diameter_m, strength_pa).law();
                    truss.nodes[0] = self.mesh.nodes.len();
                    self.mesh.nodes.push(at);
                    self.slips.push(BarSlip { node: truss.nodes[0], onto, area_m2: truss.area_m2, law });
                }
                self.bars.push(kept.len());
            }
            kept.push(truss);
        }
        self.mesh.trusses = kept;
        if self.joint == Joint::Symmetry {
            self.base.extend(self.slips.iter().map(|s| (s.node, 0.0)));
        }
        self
    }
}

/// The slipping bars of a body in motion.
#[derive(Debug)]
pub struct Anchored<'a> {
    slips: &'a [BarSlip],
    states: Vec<SlipState>,
    /// Velocities across the member after the last step \[m/s\].
    last: Vec<[f64; 2]>,
}

impl<'a> Anchored<'a> {
    /// Those of a member. Their nodes get mass, so that a slip law vibrates with a time of at least 2π steps.
    pub fn of(member: &'a RcMember, body: &mut Dynamics) -> Self {
        for slip in &member.slips {
            let mass = 2.0 * slip.law.stiffness_pa_m() * slip.area_m2 * body.dt_s * body.dt_s;
            body.mass_kg[slip.node] += mass;
            body.mass_kg[slip.onto] += mass;
        }
        let count = member.slips.len();
        Self { slips: &member.slips, states: vec![SlipState::default(); count], last: vec![[0.0; 2]; count] }
    }

    /// Forces for the coming step: the bar on the joint, and the joint on the bar.
    pub fn pull(&mut self, body: &mut Dynamics) {
        for (slip, state) in self.slips.iter().zip(&mut self.states) {
            let moved = body.x[slip.node][2] - body.x[slip.onto][2];
            let force = slip.area_m2 * slip.law.stress_pa(state, moved);
            let across = body.other_n.get(slip.node).copied().unwrap_or_default();
            body.applied_n[slip.node] = [0.0, 0.0, -force];
            body.applied_n[slip.onto] = [across[0], across[1], force];
        }
    }

    /// After a step: bars stay where they are across the member; returns the work of that \[J\].
    pub fn hold(&mut self, body: &mut Dynamics) -> f64 {
        let mut work = 0.0;
        for (slip, last) in self.slips.iter().zip(&mut self.last) {
            let mass = body.mass_kg[slip.node];
            for axis in 0..2 {
                let held = body.v[slip.onto][axis];
                let change = held - body.v[slip.node][axis];
                body.x[slip.node][axis] += body.taken_s * change;
                work += 0.5 * mass * change * (held + last[axis]);
                last[axis] = held;
                body.v[slip.node][axis] = held;
            }
        }
        work
    }

    /// Largest slip now \[m\], 0 with full bond.
    pub fn largest_slip_m(&self) -> f64 {
        self.states.iter().map(|s| s.slip_m).fold(0.0, f64::max)
    }

    /// Nodes of the bars that slide out of the joint.
    pub fn sliding(&self) -> impl Iterator<Item = usize> {
        let pairs = self.slips.iter().zip(&self.states);
        pairs.filter(|(slip, state)| slip.law.slides(state)).map(|(slip, _)| slip.node)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;

    fn bar(length_m: Option<f64>, ending: Ending) -> EmbeddedBar {
        let steel = RebarLaw::bilinear(200e9, 500e6, 0.01, 0.075);
        Anchorage { length_m, ending, ..Anchorage::LONG }.of_bar(steel, 0.02, 36e6)
    }

    #[test]
    fn slip_is_the_integral_of_the_strains_along_the_bar() {
        // u = 6 MPa: 400 MPa take 400 · 20 / 24 = 333.3 mm, mean strain 0.001
        assert!((bar(None, Ending::Straight).slip_m(400e6).unwrap() - 3.3333e-4).abs() < 1e-8);
        // beyond yield: 0.00125 · 416.67 + (0.0025 + 0.0275) / 2 · 50 · 20 / 12 mm
        let yielded = 1e-3 * (0.00125 * 416.667 + 0.015 * 83.333);
        assert!((bar(None, Ending::Straight).slip_m(550e6).unwrap() - yielded).abs() < 1e-8);
        // a hook after 200 mm holds 400 - 24 · 10 = 160 MPa
        let hooked = bar(Some(0.2), Ending::Hook).slip_m(400e6).unwrap();
        assert!((hooked - 0.2 * 0.5 * (0.002 + 0.0008)).abs() < 1e-9, "{hooked}");
    }

    #[test]
    fn a_short_straight_bar_is_pulled_out() {
        let short = bar(Some(0.3), Ending::Straight);
        assert!((short.capacity_pa() - 360e6).abs() < 1.0);
        assert_eq!(short.slip_m(361e6), None);
        // 83.3 mm beyond the 416.7 mm of yield bear 12 MPa · 83.33 / 20 mm more
        assert!((bar(Some(0.5), Ending::Straight).capacity_pa() - 550e6).abs() < 1e3);
        let law = short.law();
        let mut state = SlipState::default();
        let stresses: Vec<f64> = (0..400).map(|i| law.stress_pa(&mut state, 1e-3 * f64::from(i))).collect();
        let most = stresses.iter().fold(0.0, |a: f64, b| a.max(*b));
        assert!((most / 360e6 - 1.0).abs() < 1e-9 && law.slides(&state));
        assert!((stresses[20] / 360e6 - 0.4).abs() < 0.05 && stresses[399] == 0.0);
        assert_eq!(bar(Some(0.3), Ending::Hook).capacity_pa(), f64::INFINITY);
    }

    #[test]
    fn no_cycle_of_slip_gives_energy() {
        for case in [bar(None, Ending::Straight), bar(Some(0.3), Ending::Straight)] {
            let law = case.law();
            let mut state = SlipState::default();
            let (mut work, mut least) = (0.0, 0.0f64);
            let mut random = Random::after(5);
            for _ in 0..200 {
                let to = 3e-3 * (random.share() - 0.2);
                let from = state.slip_m;
                for k in 1..=2000 {
                    let (old, at) = (state.stress_pa, state.slip_m);
                    let stress = law.stress_pa(&mut state, from + (to - from) * f64::from(k) / 2000.0);
                    work += 0.5 * (old + stress) * (state.slip_m - at);
                    least = least.min(work);
                }
            }
            assert!(least > -1.0 && work > 0.0, "{least} of {work} J/m2");
        }
    }
}
