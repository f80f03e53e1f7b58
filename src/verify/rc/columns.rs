//! Tested columns: figures of all bends together. The targets are those of a model that beats section analysis, not those of the present law.

use super::column_runs::{self, ColumnRun, Options, Spread};
use crate::verify::columns::SPECIMENS;
use crate::verify::{Case, Figure};

const TESTS: &str = "23 tested columns (src/verify/columns.rs)";
const SHEAR: &str = "tests of Lynn (1999) and Sezen (2002): below 4 %";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![Case::complete(
        "columns-tested",
        "23 tested columns on a block out of which their bars slip, each bent once to a drift of 8 % in elements of an eighth of its depth; those whose lateral force exceeds 0.8 of the \
         shear strength of ASCE 41 are bent again in cycles of 0.5 to 6 %, which are then compared. Measured over computed largest moment within the drifts of the test (mean 0.95 \
         to 1.10, variation at most 0.10) and drift at 80 % of the lateral force (median 0.80 to 1.25, standard deviation of the logarithm at most 0.45); columns that \
         failed in shear lose 20 % of their lateral force below 4 %. Every column: rc-columns.md.",
        || Ok(figures(&column_runs::run(&Options::default(), "", &|_, _| ()))),
    )]
}

/// Figures of all columns together; what cannot be computed is not a number, and fails.
pub fn figures(runs: &[ColumnRun]) -> Vec<Figure> {
    let ratios = |of: &dyn Fn(&ColumnRun) -> Option<f64>| {
        Spread::of(&runs.iter().filter_map(of).collect::<Vec<f64>>())
    };
    let moments = ratios(&ColumnRun::moment_ratio);
    let drifts = ratios(&ColumnRun::drift_ratio);
    let value = |spread: Option<Spread>, of: fn(Spread) -> f64| spread.map_or(f64::NAN, of);
    let bent = runs.iter().filter(|r| r.computed().is_ok()).count();
    let band = |what: &str, [low, high]: [f64; 2], ours: f64| {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        Figure::absolute(what, "-", [middle, ours], half * (1.0 + 1e-12), TESTS)
    };
    let mut figures = vec![
        Figure::absolute("columns bent", "-", [SPECIMENS.len() as f64, bent as f64], 0.0, TESTS),
        band("measured over computed moment, mean", [0.95, 1.10], value(moments, |s| s.mean)),
        band("measured over computed moment, variation", [0.0, 0.10], value(moments, |s| s.variation)),
        band("measured over computed drift at 80 %, median", [0.80, 1.25], value(drifts, |s| s.median)),
        band("measured over computed drift at 80 %, deviation", [0.0, 0.45], value(drifts, |s| s.sigma_ln)),
    ];
    figures.extend(runs.iter().filter(|r| r.is_shear_critical()).map(|r| {
        let ours = r.computed().map_or(f64::NAN, |c| c.drift_at_80);
        let what =
            format!("{}: drift at 80 %, {:.1} % measured", r.specimen.name, 100.0 * r.specimen.drift_at_80);
        Figure::absolute(what, "-", [0.02, ours], 0.02, SHEAR)
    }));
    figures
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rc::bend::Ending;
    use crate::verify::rc::column_envelope::Computed;

    /// Runs whose moments and drifts are the measured ones over the given ratios.
    fn runs(moment: f64, drift: f64) -> Vec<ColumnRun> {
        let run = |specimen: &'static crate::verify::columns::Specimen| {
            let [a, b] = specimen.peak_moment_nm;
            let computed = Computed {
                peak_nm: 0.5 * (a + b) / moment,
                peak_drift: 0.01,
                lateral_n: 1.0,
                drift_at_80: specimen.drift_at_80 / drift,
                fell: true,
                ending: Ending::Path,
                kinetic_share: 0.0,
                energy_error: 0.0,
            };
            ColumnRun { specimen, elements: 1, monotonic: Ok(computed), cycled: None }
        };
        SPECIMENS.iter().map(run).collect()
    }

    #[test]
    fn what_the_tests_measured_passes_and_what_is_off_or_missing_fails() {
        let failing = |runs: &[ColumnRun]| figures(runs).iter().filter(|f| !f.passes()).count();
        let good = runs(1.0, 1.0);
        assert_eq!((figures(&good).len(), failing(&good)), (11, 0));
        assert_eq!(failing(&runs(0.9, 1.0)), 1);
        assert_eq!(failing(&runs(1.0, 1.3)), 1);
        // twice too ductile: the median, and the columns whose drift then lies beyond 4 %
        let beyond = SPECIMENS.iter().filter(|s| s.failure != crate::verify::columns::Failure::Flexure);
        let beyond = beyond.filter(|s| 2.0 * s.drift_at_80 > 0.04).count();
        assert_eq!(failing(&runs(1.0, 0.5)), 1 + beyond);
        let mut missing = good.clone();
        missing[20].monotonic = Err("crushed".into());
        assert_eq!(failing(&missing), 2);
        // a push does not stand in for cycles that are missing
        let mut off = good.clone();
        off[20].cycled = Some(Err("off".into()));
        assert_eq!(failing(&off), 2);
        assert_eq!(failing(&good[..1]), 5, "of one column alone nothing is said");
    }
}
