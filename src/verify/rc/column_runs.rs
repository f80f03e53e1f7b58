//! Tested columns bent by the RC submodel, and what the comparison says of all of them together.
//!
//! Each column stands on a block of uncracked concrete, as the tests stood on stubs and footings, out of which its bars slip. It is meshed from its report's data, loaded
//! by its axial force and bent to [`UNTIL_RAD`] or until a fifth of its largest moment is left. One that comes near its shear strength is bent again, to and fro
//! ([`super::column_shear`]), and its cycles are compared. How a history is read: [`super::column_envelope`].
//!
//! **Drifts that were not reached.** A test whose lateral force had not fallen to 80 % when it ended counts with its last drift, and so does a bend. Where the test had
//! not fallen, a bend that bears more drift than the test saw counts with the test's: neither has fallen then, and the ratio is 1.
//! No column is left out: one that cannot be bent counts in no mean, and fails the figure of its own.

use super::column_envelope::{Computed, Reading};
use super::column_shear;
use crate::material::concrete::ConcreteLaw;
use crate::material::rebar::Buckling;
use crate::rc::anchorage::Anchorage;
use crate::rc::bend::{Bend, bend};
use crate::rc::drive::Path;
use crate::rc::member::{Joint, RcMember};
use crate::verify::columns::{Failure, SPECIMENS, Specimen};
use rayon::prelude::*;
use std::sync::Mutex;

/// Drift to which columns are bent.
pub const UNTIL_RAD: f64 = 0.08;
/// Direction of the push: along the depth \[deg\].
const PUSH_DEG: f64 = 90.0;

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
    /// Whether columns near their shear strength are cycled.
    pub cycled: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { elements: 8.0, joint: Joint::Block, slip: true, until_rad: UNTIL_RAD, cycled: true }
    }
}

/// A tested column and its computation.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnRun {
    /// The test.
    pub specimen: &'static Specimen,
    /// Hexahedra.
    pub elements: usize,
    /// What one push gave, or why nothing.
    pub monotonic: Result<Computed, String>,
    /// What cycles gave, of a column near its shear strength.
    pub cycled: Option<Result<Computed, String>>,
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
    /// What is compared with the test: the cycles of a cycled column, else the push.
    pub fn computed(&self) -> Result<&Computed, &String> {
        self.cycled.as_ref().unwrap_or(&self.monotonic).as_ref()
    }

    /// Mean of the two directions' largest moments \[N m\].
    pub fn measured_nm(&self) -> f64 {
        0.5 * (self.specimen.peak_moment_nm[0] + self.specimen.peak_moment_nm[1])
    }

    /// Measured over computed largest moment.
    pub fn moment_ratio(&self) -> Option<f64> {
        Some(self.measured_nm() / self.computed().ok()?.peak_nm)
    }

    /// Drifts at 80 % of the lateral force as they are compared.
    pub fn drifts(&self) -> Option<Drifts> {
        let of_bend = self.computed().ok()?.drift_at_80;
        let measured = self.specimen.drift_at_80;
        let computed = if self.specimen.fell { of_bend } else { of_bend.min(measured) };
        Some(Drifts { measured, computed })
    }

    /// Measured over computed drift at 80 % of the lateral force.
    pub fn drift_ratio(&self) -> Option<f64> {
        self.drifts().map(|d| d.measured / d.computed)
    }

    /// Largest lateral force of the push over the shear strength of the undamaged column, `V_p / V_o`.
    pub fn shear_share(&self) -> Option<f64> {
        Some(self.monotonic.as_ref().ok()?.lateral_n / column_shear::strength_n(self.specimen))
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
    let work = Mutex::new(Work::of(&chosen, options));
    let one = |(column, specimen): (usize, &&'static Specimen)| {
        let tell = |news: News| {
            let mut work = work.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            work.hear(column, news);
            progress(work.share(), &work.words());
        };
        let done = one(specimen, options, &tell);
        tell(News::Done);
        done
    };
    chosen.par_iter().with_max_len(1).enumerate().map(one).collect()
}

/// What a column tells of its work.
#[derive(Debug, Clone, Copy, PartialEq)]
enum News {
    /// Share of the push.
    Pushed(f64),
    /// Share of the cycles.
    Cycled(f64),
    /// All done.
    Done,
}

/// The work of all columns, for the share that is done.
struct Work {
    /// Expected work by column: the push, the cycles.
    whole: Vec<[f64; 2]>,
    done: Vec<[f64; 2]>,
    is_done: Vec<bool>,
    is_cycling: Vec<bool>,
    /// Share told last: it does not fall when a column turns out to be cycled.
    told: f64,
}

impl Work {
    /// Work is the time of the path times elements over time step, `L / h²` in a mesh of so many elements over the depth `h`. Until its push is done, a
    /// column counts as cycled if the rule says so for its measured moment.
    fn of(chosen: &[&Specimen], options: &Options) -> Self {
        let times = [&[options.until_rad][..], &column_shear::turns_rad(options.until_rad)];
        let [push, cycles] = times.map(|turns| Path::through(turns, 1.0).duration_s());
        let one = |s: &&Specimen| {
            let weight = s.length_m / s.depth_m.max(s.width_m).powi(2);
            let measured_n = s.peak_moment_nm[0].max(s.peak_moment_nm[1]) / s.length_m;
            let is_cycled =
                options.cycled && column_shear::is_critical(measured_n, column_shear::strength_n(s));
            [weight * push, if is_cycled { weight * cycles } else { 0.0 }]
        };
        let count = chosen.len();
        Self {
            whole: chosen.iter().map(one).collect(),
            done: vec![[0.0; 2]; count],
            is_done: vec![false; count],
            is_cycling: vec![false; count],
            told: 0.0,
        }
    }

    fn hear(&mut self, column: usize, news: News) {
        let whole = self.whole[column];
        match news {
            News::Pushed(share) => self.done[column][0] = share * whole[0],
            News::Cycled(share) => {
                self.is_cycling[column] = true;
                self.done[column] = [whole[0], share * whole[1]];
            }
            News::Done => {
                self.is_cycling[column] = false;
                self.is_done[column] = true;
                self.done[column] = whole;
            }
        }
    }

    fn share(&mut self) -> f64 {
        let sum = |all: &[[f64; 2]]| all.iter().flatten().sum::<f64>();
        self.told = self.told.max(sum(&self.done) / sum(&self.whole).max(f64::MIN_POSITIVE));
        self.told
    }

    fn words(&self) -> String {
        let count = |flags: &[bool]| flags.iter().filter(|f| **f).count();
        let text = format!("{} of {} columns done", count(&self.is_done), self.whole.len());
        match count(&self.is_cycling) {
            0 => text,
            cycling => format!("{text}, {cycling} in cycles"),
        }
    }
}

/// Bends one column.
fn one(specimen: &'static Specimen, options: &Options, tell: &dyn Fn(News)) -> ColumnRun {
    let mut input = specimen.section();
    input.steel.buckling =
        Some(Buckling::between_ties(specimen.tie_spacing_m, specimen.bars.1, &input.steel));
    let concrete = ConcreteLaw::of_strength(specimen.fc_pa);
    let size_m = specimen.width_m.max(specimen.depth_m) / options.elements;
    let sizes = [specimen.length_m, size_m];
    let member = match RcMember::half(&input, &concrete, options.joint, sizes, PUSH_DEG) {
        Ok(member) if options.slip => {
            member.anchored(&Anchorage::LONG, input.steel, &input.bars, specimen.fc_pa)
        }
        Ok(member) => member,
        Err(error) => {
            return ColumnRun { specimen, elements: 0, monotonic: Err(error.to_string()), cycled: None };
        }
    };
    let monotonic = bent(specimen, &member, vec![options.until_rad], &|share| tell(News::Pushed(share)));
    let strength_n = column_shear::strength_n(specimen);
    let is_critical = monotonic.as_ref().is_ok_and(|c| column_shear::is_critical(c.lateral_n, strength_n));
    let cycled = (options.cycled && is_critical).then(|| {
        let turns_rad = column_shear::turns_rad(options.until_rad);
        bent(specimen, &member, turns_rad, &|share| tell(News::Cycled(share)))
    });
    ColumnRun { specimen, elements: member.mesh.elements.len(), monotonic, cycled }
}

/// Bends a column through turning points and reads its figures.
fn bent(
    specimen: &Specimen,
    member: &RcMember,
    turns_rad: Vec<f64>,
    progress: &dyn Fn(f64),
) -> Result<Computed, String> {
    let axial_n = specimen.axial_force_n();
    let load = Bend { axial_n, direction_deg: PUSH_DEG, turns_rad, pace: 1.0 };
    let bent = bend(member, &load, false, progress).map_err(|e| e.to_string())?;
    let reading = Reading { axial_n, length_m: member.length_m, last_drift: specimen.last_drift };
    let read = reading.read(&bent.points, &bent.turned_at, bent.ending)?;
    Ok(Computed { kinetic_share: bent.kinetic_share, energy_error: bent.energies.residual_share, ..read })
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
        let logarithms: Vec<f64> = ratios.iter().map(|r| libm::log(*r)).collect();
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
    use crate::rc::bend::Ending;

    fn computed(drift_at_80: f64) -> Computed {
        Computed {
            peak_nm: 1.0,
            peak_drift: 0.01,
            lateral_n: 1.0,
            drift_at_80,
            fell: false,
            ending: Ending::Path,
            kinetic_share: 0.0,
            energy_error: 0.0,
        }
    }

    #[test]
    fn a_test_that_had_not_fallen_caps_the_drift_of_the_bend() {
        let find = |fell: bool| SPECIMENS.iter().find(|s| s.fell == fell).unwrap();
        let run = |specimen, drift_at_80| ColumnRun {
            specimen,
            elements: 1,
            monotonic: Ok(computed(drift_at_80)),
            cycled: None,
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
    fn cycles_are_compared_where_there_are_any() {
        let specimen = SPECIMENS.iter().find(|s| s.fell).unwrap();
        let pushed = ColumnRun { specimen, elements: 1, monotonic: Ok(computed(0.08)), cycled: None };
        assert_eq!(pushed.drifts().unwrap().computed, 0.08);
        let cycled = ColumnRun { cycled: Some(Ok(computed(0.02))), ..pushed.clone() };
        assert_eq!(cycled.drifts().unwrap().computed, 0.02);
        assert_eq!(cycled.shear_share(), Some(1.0 / column_shear::strength_n(specimen)));
        let failed = ColumnRun { cycled: Some(Err("off".into())), ..pushed };
        assert!(failed.computed().is_err() && failed.drift_ratio().is_none());
    }

    #[test]
    fn the_share_done_counts_cycles_and_never_falls() {
        let names = ["Ohno L1", "Lynn 2CLH18"];
        let chosen = names.map(|n| SPECIMENS.iter().find(|s| s.name == n).unwrap());
        let mut work = Work::of(&chosen, &Options::default());
        assert!(work.whole[0][1] == 0.0 && work.whole[1][1] > 5.0 * work.whole[1][0], "{:?}", work.whole);
        let mut last = 0.0;
        for (column, news) in [
            (0, News::Pushed(0.5)),
            (1, News::Pushed(1.0)),
            (0, News::Done),
            (1, News::Cycled(0.1)),
            (1, News::Cycled(0.9)),
        ] {
            work.hear(column, news);
            let share = work.share();
            assert!(share > last && share < 1.0, "{share}");
            last = share;
        }
        assert_eq!(work.words(), "1 of 2 columns done, 1 in cycles");
        work.hear(1, News::Done);
        assert_eq!((work.share(), work.words()), (1.0, "2 of 2 columns done".to_string()));
        let pushes = Work::of(&chosen, &Options { cycled: false, ..Options::default() });
        assert!(pushes.whole.iter().all(|w| w[1] == 0.0));
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
