//! Stress paths of a material point of concrete.
//!
//! Axis 3 is driven by strain; axes 1 and 2 are each held at a stress, at a ratio of the stress along axis 3, or at a strain. Two
//! unknown strain increments follow from two conditions by Newton's method with **central** differences. One-sided ones fail where both held axes
//! carry the same stress: the largest principal stress then has a kink, and the two columns of a forward Jacobian add up to twice the slope along the
//! diagonal; central ones add up to it. The law is piecewise smooth, so a line search follows, and what it cannot find is
//! sought in halves of the increment, down to 1/256 of it.

use crate::material::concrete::{ConcreteLaw, ConcretePoint, ConcreteState};

/// Largest residual over the shear modulus: some 1e-5 of the strength, which is the resolution of the law's sub-steps.
const RESIDUAL: f64 = 2e-8;
/// Strain of the differences.
const DIFFERENCE: f64 = 1e-10;
/// Largest change of a strain in an iteration.
const STRIDE: f64 = 2e-4;
/// Iterations for an increment.
const ITERATIONS: usize = 60;
/// Halvings of an increment.
const HALVINGS: u32 = 8;

/// What an axis beside the driven one is held at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// A stress \[Pa\].
    Stress(f64),
    /// A share of the stress along axis 3.
    Ratio(f64),
    /// A strain.
    Strain(f64),
}

/// A point on its way.
pub struct Path {
    point: ConcretePoint,
    /// History.
    pub state: ConcreteState,
    /// Strains along the axes.
    pub strain: [f64; 3],
    /// Stresses along the axes \[Pa\].
    pub stress_pa: [f64; 3],
    /// What axes 1 and 2 are held at; may be changed on the way.
    pub hold: [Hold; 2],
    /// Work done so far \[J/m³\].
    pub work_j_m3: f64,
    /// Strain increments of axes 1 and 2 over that of axis 3, last time.
    slope: [f64; 2],
}

/// A trial increment.
struct Trial {
    side: [f64; 2],
    state: ConcreteState,
    stress: [f64; 3],
    residual: [f64; 2],
}

impl Trial {
    fn size(&self) -> f64 {
        self.residual[0].abs().max(self.residual[1].abs())
    }
}

impl Path {
    /// A virgin point of a law in an element of a length \[m\].
    ///
    /// # Errors
    /// If the law does not suit the length.
    pub fn new(law: &ConcreteLaw, length_m: f64, hold: [Hold; 2]) -> Result<Self, String> {
        let point = ConcretePoint::new(law, length_m).map_err(|e| e.to_string())?;
        Ok(Self {
            point,
            state: ConcreteState::default(),
            strain: [0.0; 3],
            stress_pa: [0.0; 3],
            hold,
            work_j_m3: 0.0,
            slope: [0.0; 2],
        })
    }

    /// The law at the point.
    pub fn point(&self) -> &ConcretePoint {
        &self.point
    }

    /// Moves axis 3 by a strain increment; the stress along it \[Pa\].
    ///
    /// # Errors
    /// If no lateral strains fulfil what the axes are held at; says where and by how much not.
    pub fn advance(&mut self, increment: f64) -> Result<f64, String> {
        self.advance_halved(increment, HALVINGS)?;
        Ok(self.stress_pa[2])
    }

    fn advance_halved(&mut self, increment: f64, halvings: u32) -> Result<(), String> {
        match self.solve(increment) {
            Ok(found) => self.keep(&found, increment),
            Err(_) if halvings > 0 => {
                self.advance_halved(0.5 * increment, halvings - 1)?;
                self.advance_halved(0.5 * increment, halvings - 1)?;
            }
            Err(best) => {
                let ([a, b], s) = (best.residual, best.stress);
                return Err(format!(
                    "no lateral strains at strains {:?} for a step of {increment:e}: residuals {a:.1} and {b:.1} Pa at stresses {s:.1?} Pa; \
                     take smaller steps",
                    self.strain
                ));
            }
        }
        Ok(())
    }

    fn keep(&mut self, found: &Trial, increment: f64) {
        let steps = [found.side[0], found.side[1], increment];
        for i in 0..3 {
            self.work_j_m3 += 0.5 * (self.stress_pa[i] + found.stress[i]) * steps[i];
            self.strain[i] += steps[i];
        }
        self.state = found.state;
        self.stress_pa = found.stress;
        if increment != 0.0 {
            self.slope = found.side.map(|s| s / increment);
        }
    }

    fn trial(&self, side: [f64; 2], increment: f64) -> Trial {
        let mut state = self.state;
        let r = self.point.respond(&mut state, &[side[0], side[1], increment, 0.0, 0.0, 0.0]);
        let stress = [r[0], r[1], r[2]];
        let modulus = self.point.lame_pa()[1];
        let residual = std::array::from_fn(|i| match self.hold[i] {
            Hold::Stress(held) => stress[i] - held,
            Hold::Ratio(share) => stress[i] - share * stress[2],
            Hold::Strain(held) => modulus * (self.strain[i] + side[i] - held),
        });
        Trial { side, state, stress, residual }
    }

    /// The increments of axes 1 and 2, or the best found.
    fn solve(&self, increment: f64) -> Result<Trial, Box<Trial>> {
        let modulus = self.point.lame_pa()[1];
        let mut at = self.trial(self.slope.map(|s| s * increment), increment);
        for _ in 0..ITERATIONS {
            if at.size() <= RESIDUAL * modulus {
                return Ok(at);
            }
            let way = self.direction(&at, increment, modulus);
            let reach = (STRIDE / way[0].abs().max(way[1].abs())).min(1.0);
            let tries = (0..14).map(|k| reach * 0.5f64.powi(k));
            let step = |share: f64| {
                self.trial([at.side[0] + share * way[0], at.side[1] + share * way[1]], increment)
            };
            let mut better = tries.map(step).filter(|t| t.size() < at.size());
            let Some(next) = better.next() else { return Err(Box::new(at)) };
            at = next;
        }
        if at.size() <= RESIDUAL * modulus { Ok(at) } else { Err(Box::new(at)) }
    }

    /// Newton's direction; against the residual where the Jacobian is singular.
    fn direction(&self, at: &Trial, increment: f64, modulus: f64) -> [f64; 2] {
        let mut slopes = [[0.0; 2]; 2];
        for k in 0..2 {
            let ends: [Trial; 2] = [DIFFERENCE, -DIFFERENCE].map(|d| {
                let mut side = at.side;
                side[k] += d;
                self.trial(side, increment)
            });
            for i in 0..2 {
                slopes[i][k] = (ends[0].residual[i] - ends[1].residual[i]) / (2.0 * DIFFERENCE);
            }
        }
        let (r, [[a, b], [c, d]]) = (at.residual, slopes);
        let determinant = a * d - b * c;
        let way = [-(r[0] * d - r[1] * b) / determinant, -(r[1] * a - r[0] * c) / determinant];
        if way.iter().all(|w| w.is_finite()) && determinant.abs() > 1e-9 * modulus * modulus {
            way
        } else {
            r.map(|r| -r / (4.0 * modulus))
        }
    }

    /// Drives axis 3 in steps to a total strain; `seen` is called after each.
    ///
    /// # Errors
    /// As [`Path::advance`].
    pub fn drive(&mut self, to: f64, step: f64, mut seen: impl FnMut(&Self)) -> Result<(), String> {
        let from = self.strain[2];
        let count = ((to - from).abs() / step).ceil().max(1.0);
        for _ in 0..count as usize {
            self.advance((to - from) / count)?;
            seen(self);
        }
        Ok(())
    }

    /// Drives axis 3 by steps (signed) until its stress has fallen to a share of its largest size; the peak's strains and stresses \[Pa\].
    ///
    /// # Errors
    /// As [`Path::advance`], or if the stress does not fall within 50,000 steps.
    pub fn peak(&mut self, step: f64, share: f64) -> Result<Peak, String> {
        let mut peak = Peak { strain: self.strain, stress_pa: self.stress_pa };
        for _ in 0..50_000 {
            let now = self.advance(step)? * step.signum();
            if now > peak.stress_pa[2] * step.signum() {
                peak = Peak { strain: self.strain, stress_pa: self.stress_pa };
            } else if now < share * peak.stress_pa[2] * step.signum() {
                return Ok(peak);
            }
        }
        Err(format!("no fall of the stress until strain {:.4}", self.strain[2]))
    }

    /// Unloads axis 3 by steps (signed) until its stress changes sign; the strain free of stress.
    ///
    /// # Errors
    /// As [`Path::advance`], or if there is none within 50,000 steps.
    pub fn release(&mut self, step: f64) -> Result<f64, String> {
        let sign = self.stress_pa[2].signum();
        for _ in 0..50_000 {
            let (strain, before) = (self.strain[2], self.stress_pa[2]);
            let now = self.advance(step)?;
            if now * sign <= 0.0 {
                return Ok(strain + step * before / (before - now));
            }
        }
        Err("the stress does not vanish".into())
    }
}

/// The state at the largest stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Strains along the axes.
    pub strain: [f64; 3],
    /// Stresses along the axes \[Pa\].
    pub stress_pa: [f64; 3],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elastic_paths_have_their_closed_forms() {
        let law = ConcreteLaw::of_strength(30e6);
        let (e, nu) = (law.youngs_modulus_pa, law.poisson_ratio);
        let mut path = Path::new(&law, 0.1, [Hold::Stress(0.0), Hold::Strain(0.0)]).unwrap();
        path.drive(-1e-4, 1e-5, |_| ()).unwrap();
        let plane = -1e-4 * e / (1.0 - nu * nu);
        assert!((path.stress_pa[2] / plane - 1.0).abs() < 1e-4, "{:?}", path.stress_pa);
        assert!((path.stress_pa[1] / (nu * plane) - 1.0).abs() < 1e-3, "{:?}", path.stress_pa);
        assert!((path.work_j_m3 / (-0.5e-4 * plane) - 1.0).abs() < 1e-3);
        let mut path = Path::new(&law, 0.1, [Hold::Ratio(0.5), Hold::Stress(-1e6)]).unwrap();
        path.advance(-1e-4).unwrap();
        let expected = (-1e-4 * e - nu * 1e6) / (1.0 - 0.5 * nu);
        assert!((path.stress_pa[2] / expected - 1.0).abs() < 1e-3, "{:?} {expected}", path.stress_pa);
        assert!((path.strain[1] - (-1e6 - nu * 1.5 * path.stress_pa[2]) / e).abs() < 1e-7);
    }

    /// Where one-sided differences fail: both held axes alike, just past the peak of a short element.
    #[test]
    fn short_elements_are_crushed_to_the_end() {
        let law = ConcreteLaw::of_strength(30e6);
        let mut path = Path::new(&law, 0.025, [Hold::Stress(0.0); 2]).unwrap();
        path.drive(-0.02, 5e-6, |_| ()).unwrap();
        let lateral = path.stress_pa[0].abs().max(path.stress_pa[1].abs());
        assert!(lateral < 1e3 && path.stress_pa[2] < -10e6, "{:?}", path.stress_pa);
    }
}
