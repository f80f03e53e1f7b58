//! Tested columns bent by the RC submodel, and what the comparison says of all of them together.
//!
//! Each column stands on a block of uncracked concrete, as the tests stood on stubs and footings, out of which its bars slip. It is meshed from its report's data, loaded by its axial force and bent to [`UNTIL_RAD`] or until a fifth of its largest moment is left. The lateral
//! force is that of the bend less the second-order moment, `V = (M - N w) / L` with the tip displacement `w`, as the tests' was.
//!
//! **Drifts that were not reached.** A test whose lateral force had not fallen to 80 % when it ended counts with its last drift, and so does a bend. Where the test had
//! not fallen, a bend that bears more drift than the test saw counts with the test's: neither has fallen then, and the ratio is 1.
//! No column is left out: one that cannot be bent counts in no mean, and fails the figure of its own.

use crate::material::concrete::ConcreteLaw;
use crate::material::rebar::Buckling;
use crate::rc::anchorage::Anchorage;
use crate::rc::bend::{Bend, BendError, Bent, bend};
use crate::rc::member::{Joint, RcMember};
use crate::verify::columns::{Failure, SPECIMENS, Specimen};
use rayon::prelude::*;
use std::sync::Mutex;

/// Drift to which columns are bent.
pub const UNTIL_RAD: f64 = 0.08;
/// Direction of the push: along the depth \[deg\].
const PUSH_DEG: f64 = 90.0;
/// Share of the largest lateral force whose drift is compared.
const FALLEN_SHARE: f64 = 0.8;

/// How columns are bent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Elements over the larger side of the section.
    pub elements: f64,
    /// What they stand on.
    pub joint: Joint,
    /// Whether bars slip out of it.
    pub slip: bool,
    /// Drift to which they are bent.
    pub until_rad: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { elements: 8.0, joint: Joint::Block, slip: true, until_rad: UNTIL_RAD }
    }
}

/// A computed column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Computed {
    /// Largest moment at the base \[N m\].
    pub peak_nm: f64,
    /// Drift there.
    pub peak_drift: f64,
    /// Largest lateral force \[N\].
    pub lateral_n: f64,
    /// Drift at which it has fallen to 80 %, or the last one.
    pub drift_at_80: f64,
    /// Whether it fell.
    pub fell: bool,
    /// Whether the moment fell to a fifth of its peak.
    pub failed: bool,
    /// Largest kinetic over internal energy.
    pub kinetic_share: f64,
}

/// A tested column and its computation.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnRun {
    /// The test.
    pub specimen: &'static Specimen,
    /// Hexahedra.
    pub elements: usize,
    /// What was computed, or why nothing.
    pub computed: Result<Computed, String>,
}

/// The drifts that are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drifts {
    /// Of the test.
    pub measured: f64,
    /// Of the bend, not beyond the end of a test that had not fallen.
    pub computed: f64,
}

impl ColumnRun {
    /// Mean of the two directions' largest moments \[N m\].
    pub fn measured_nm(&self) -> f64 {
        0.5 * (self.specimen.peak_moment_nm[0] + self.specimen.peak_moment_nm[1])
    }

    /// Measured over computed largest moment.
    pub fn moment_ratio(&self) -> Option<f64> {
        Some(self.measured_nm() / self.computed.as_ref().ok()?.peak_nm)
    }

    /// Drifts at 80 % of the lateral force as they are compared.
    pub fn drifts(&self) -> Option<Drifts> {
        let of_bend = self.computed.as_ref().ok()?.drift_at_80;
        let measured = self.specimen.drift_at_80;
        let computed = if self.specimen.fell { of_bend } else { of_bend.min(measured) };
        Some(Drifts { measured, computed })
    }

    /// Measured over computed drift at 80 % of the lateral force.
    pub fn drift_ratio(&self) -> Option<f64> {
        self.drifts().map(|d| d.measured / d.computed)
    }

    /// Whether the test ended in shear, with or without bars that had yielded.
    pub fn is_shear_critical(&self) -> bool {
        self.specimen.failure != Failure::Flexure
    }
}

/// Bends the columns whose name contains `name` (all of them if it is empty) on the threads of the present pool, in the order of
/// [`SPECIMENS`]; `progress` is told the share done and what is under way.
pub fn run(options: &Options, name: &str, progress: &(dyn Fn(f64, &str) + Sync)) -> Vec<ColumnRun> {
    let chosen: Vec<&'static Specimen> = SPECIMENS.iter().filter(|s| s.name.contains(name)).collect();
    let shares = Mutex::new(vec![0.0; chosen.len()]);
    let tell = |column: usize, share: f64| {
        let mut all = shares.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        all[column] = share;
        let finished = all.iter().filter(|s| **s >= 1.0).count();
        let sum: f64 = all.iter().sum();
        progress(sum / all.len() as f64, &format!("{finished} of {} columns done", all.len()));
    };
    let one = |(column, specimen): (usize, &&'static Specimen)| {
        let done = one(specimen, options, &|share| tell(column, share));
        tell(column, 1.0);
        done
    };
    chosen.par_iter().with_max_len(1).enumerate().map(one).collect()
}

/// Bends one column.
fn one(specimen: &'static Specimen, options: &Options, progress: &dyn Fn(f64)) -> ColumnRun {
    let mut input = specimen.section();
    input.steel.buckling = Some(Buckling::between_ties(specimen.tie_spacing_m, specimen.bars.1));
    let concrete = ConcreteLaw::of_strength(specimen.fc_pa);
    let size_m = specimen.width_m.max(specimen.depth_m) / options.elements;
    let sizes = [specimen.length_m, size_m];
    let member = match RcMember::half(&input, &concrete, options.joint, sizes, PUSH_DEG) {
        Ok(member) if options.slip => {
            member.anchored(&Anchorage::LONG, input.steel, &input.bars, specimen.fc_pa)
        }
        Ok(member) => member,
        Err(error) => return ColumnRun { specimen, elements: 0, computed: Err(error.to_string()) },
    };
    let computed = load(&member, specimen.axial_force_n(), options.until_rad, progress)
        .map_err(|e| e.to_string())
        .and_then(|bent| {
            let read = read(&bent.points, specimen.axial_force_n(), member.length_m)?;
            Ok(Computed { failed: bent.failed(), kinetic_share: bent.kinetic_share, ..read })
        });
    ColumnRun { specimen, elements: member.mesh.elements.len(), computed }
}

/// The loading protocol: pushed once, in one direction. The tests went back and forth.
fn load(member: &RcMember, axial_n: f64, until_rad: f64, progress: &dyn Fn(f64)) -> Result<Bent, BendError> {
    bend(member, &Bend::monotonic(axial_n, PUSH_DEG, until_rad), false, progress)
}

/// Reads the figures of a bend's points.
fn read(points: &[[f64; 3]], axial_n: f64, length_m: f64) -> Result<Computed, String> {
    let largest = |values: &[f64]| {
        (0..values.len())
            .reduce(|a, b| if values[b] > values[a] { b } else { a })
            .filter(|i| values[*i] > 0.0)
    };
    let drifts: Vec<f64> = points.iter().map(|p| p[0]).collect();
    let moments: Vec<f64> = points.iter().map(|p| p[1]).collect();
    let lateral: Vec<f64> = points.iter().map(|p| (p[1] - axial_n * p[0] * length_m) / length_m).collect();
    let (Some(peak), Some(most)) = (largest(&moments), largest(&lateral)) else {
        return Err("no positive moment".into());
    };
    let level = FALLEN_SHARE * lateral[most];
    let fall = (most + 1..lateral.len()).find(|i| lateral[*i] < level);
    let crossed = |i: usize| {
        let share = (lateral[i - 1] - level) / (lateral[i - 1] - lateral[i]);
        drifts[i - 1] + share * (drifts[i] - drifts[i - 1])
    };
    Ok(Computed {
        peak_nm: moments[peak],
        peak_drift: drifts[peak],
        lateral_n: lateral[most],
        drift_at_80: fall.map_or(drifts[drifts.len() - 1], crossed),
        fell: fall.is_some(),
        failed: false,
        kinetic_share: 0.0,
    })
}

/// Spread of ratios.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// How many.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation of the sample over the mean.
    pub variation: f64,
    /// Median.
    pub median: f64,
    /// Standard deviation of the sample's natural logarithms.
    pub sigma_ln: f64,
}

impl Spread {
    /// Of positive ratios; `None` of fewer than two.
    pub fn of(ratios: &[f64]) -> Option<Self> {
        if ratios.len() < 2 {
            return None;
        }
        let deviation = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
            (mean, (squares / (values.len() - 1) as f64).sqrt())
        };
        let (mean, sigma) = deviation(ratios);
        let logarithms: Vec<f64> = ratios.iter().map(|r| r.ln()).collect();
        let mut sorted = ratios.to_vec();
        sorted.sort_by(f64::total_cmp);
        let half = sorted.len() / 2;
        let median =
            if sorted.len() % 2 == 1 { sorted[half] } else { 0.5 * (sorted[half - 1] + sorted[half]) };
        Some(Self {
            count: ratios.len(),
            mean,
            variation: sigma / mean,
            median,
            sigma_ln: deviation(&logarithms).1,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lateral_force_loses_the_second_order_moment() {
        let points = [[0.0, 0.0, 0.0], [0.01, 100e3, 0.0], [0.02, 100e3, 0.0], [0.03, 90e3, 0.0]];
        // V = (M - N w) / L with N = 1 MN, L = 2 m: 0, 40, 30, 15 kN; 32 kN between the second and the third
        let c = read(&points, 1e6, 2.0).unwrap();
        assert!((c.lateral_n - 40e3).abs() < 1e-6 && (c.drift_at_80 - 0.018).abs() < 1e-12 && c.fell);
        let none = read(&points, 0.0, 2.0).unwrap();
        assert!(!none.fell && none.drift_at_80 == 0.03 && none.peak_drift == 0.01);
    }

    #[test]
    fn a_test_that_had_not_fallen_caps_the_drift_of_the_bend() {
        let find = |fell: bool| SPECIMENS.iter().find(|s| s.fell == fell).unwrap();
        let run = |specimen, drift_at_80| ColumnRun {
            specimen,
            elements: 1,
            computed: Ok(Computed {
                peak_nm: 1.0,
                peak_drift: 0.01,
                lateral_n: 1.0,
                drift_at_80,
                fell: false,
                failed: false,
                kinetic_share: 0.0,
            }),
        };
        assert_eq!(run(find(false), 0.08).drift_ratio(), Some(1.0));
        let early = run(find(false), 0.01).drift_ratio().unwrap();
        assert!((early - find(false).drift_at_80 / 0.01).abs() < 1e-12 && early > 1.0);
        let fallen = find(true);
        assert_eq!(run(fallen, 0.08).drift_ratio(), Some(fallen.drift_at_80 / 0.08));
        let lasted: Vec<&str> = SPECIMENS.iter().filter(|s| !s.fell).map(|s| s.name).collect();
        assert_eq!(lasted.len(), 6, "{lasted:?}");
    }

    #[test]
    fn spread_of_three_ratios() {
        let s = Spread::of(&[1.0, 0.5, 2.0]).unwrap();
        assert_eq!((s.count, s.median), (3, 1.0));
        assert!((s.mean - 3.5 / 3.0).abs() < 1e-15 && (s.sigma_ln - 2f64.ln()).abs() < 1e-15);
        // deviations -1/6, -2/3, 5/6: squares sum to 7/6
        assert!((s.variation - (7.0f64 / 12.0).sqrt() / (3.5 / 3.0)).abs() < 1e-15);
        assert_eq!(Spread::of(&[1.0]), None);
    }
}
