//! A study as a record in `kb/studies/`: the evidence behind rules.

use super::Facts;
use crate::fe::result::{FeEnergies, FeRun, History};
use serde::{Deserialize, Serialize, Serializer};

/// Version of the record format.
pub const STUDY_SCHEMA: u32 = 2;
/// Interval of the histories \[s\].
const INTERVAL_S: f64 = 0.1;
/// Displacements are kept in whole millimetres where the largest one is that many; where a building hardly moves, in tenths, hundredths or thousandths, since most points move ten times less than the largest one.
const COARSE_MM: f64 = 300.0;

/// One FE study. Times of the computation are left out, so that the same input gives the same bytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// Always [`STUDY_SCHEMA`].
    pub schema: u32,
    /// Name of the building.
    pub building: String,
    /// Hash of the resolved building.
    pub building_hash: String,
    /// Version of the program.
    pub program_version: String,
    /// Mesh size \[m\].
    pub mesh_size_m: f64,
    /// Elements.
    pub elements: usize,
    /// Time steps.
    pub steps: u64,
    /// Energy error of the run.
    pub energy_error: f64,
    /// Energies; the first records have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energies: Option<Energies>,
    /// Facts.
    pub facts: Facts,
    /// How the tracked points move.
    pub motion: Motion,
}

/// Energies of a run, with four digits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// At the last output before the first ground contact, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_contact: Option<FeEnergies>,
    /// At the end.
    pub end: FeEnergies,
}

impl Energies {
    /// Of a run; `None` if it has none.
    fn of(run: &FeRun) -> Option<Self> {
        let before = |contact_s| {
            let outputs = run.times_s.partition_point(|t| *t <= contact_s);
            run.energies.get(outputs.checked_sub(1)?).map(|e| e.map(four_digits))
        };
        let first_contact = run.summary.first_ground_contact_s.and_then(before);
        Some(Self { first_contact, end: run.energies.last()?.map(four_digits) })
    }
}

/// A number to four digits.
fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Displacements of the tracked points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Interval, from zero on \[s\].
    pub interval_s: f64,
    /// Points.
    pub points: Vec<PointMotion>,
}

/// Displacements of a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointMotion {
    /// Its id.
    pub id: String,
    /// When its elements failed, if they did \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub debris_s: Option<f64>,
    /// Displacements, three numbers a time \[mm\].
    #[serde(serialize_with = "whole_if_whole")]
    pub displacement_mm: Vec<f64>,
}

/// Writes `12` for 12.0: most numbers are whole.
#[expect(clippy::ptr_arg, reason = "serde passes the field")]
fn whole_if_whole<S: Serializer>(values: &Vec<f64>, to: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    #[serde(untagged)]
    enum Number {
        Whole(i64),
        Decimal(f64),
    }
    to.collect_seq(
        values.iter().map(|x| if x.fract() == 0.0 { Number::Whole(*x as i64) } else { Number::Decimal(*x) }),
    )
}

impl Motion {
    /// Of a run.
    pub fn of(run: &FeRun) -> Self {
        let output_s = run.times_s.get(1).copied().unwrap_or(INTERVAL_S);
        let every = (INTERVAL_S / output_s).round().max(1.0) as usize;
        Self { interval_s: every as f64 * output_s, points: points(&run.tracked, every) }
    }
}

/// Every so manieth of some displacements.
fn points(tracked: &[History], every: usize) -> Vec<PointMotion> {
    let all = tracked.iter().flat_map(|h| &h.displacement_m).flatten();
    let largest_mm = 1e3 * all.fold(0.0, |most: f64, x| most.max(x.abs()));
    let digits = libm::log10(COARSE_MM / largest_mm).ceil().clamp(0.0, 3.0) as i32;
    let (per_mm, per_m) = (10f64.powi(digits), 10f64.powi(3 + digits));
    let of = |h: &History| PointMotion {
        id: h.id.clone(),
        debris_s: h.debris_s,
        displacement_mm: (h.displacement_m.iter().step_by(every))
            // the sum takes the sign off a zero
            .flat_map(|u| u.map(|x| (per_m * x).round() / per_mm + 0.0))
            .collect(),
    };
    tracked.iter().map(of).collect()
}

impl Motion {
    /// The times \[s\].
    pub fn times_s(&self) -> Vec<f64> {
        let count = self.points.iter().map(|p| p.displacement_mm.len() / 3).max().unwrap_or(0);
        (0..count).map(|i| i as f64 * self.interval_s).collect()
    }

    /// The displacements, as those of a run.
    pub fn histories(&self) -> Vec<History> {
        let of = |p: &PointMotion| History {
            id: p.id.clone(),
            displacement_m: (p.displacement_mm.chunks_exact(3))
                .map(|u| std::array::from_fn(|i| 1e-3 * u[i]))
                .collect(),
            debris_s: p.debris_s,
        };
        self.points.iter().map(of).collect()
    }
}

impl Study {
    /// A record of a run.
    pub fn new(building: &str, building_hash: String, mesh_size_m: f64, run: &FeRun, facts: Facts) -> Self {
        Self {
            schema: STUDY_SCHEMA,
            building: building.to_string(),
            building_hash,
            program_version: env!("CARGO_PKG_VERSION").to_string(),
            mesh_size_m,
            elements: run.summary.elements,
            steps: run.summary.steps,
            energy_error: run.summary.energy_error,
            energies: Energies::of(run),
            facts,
            motion: Motion::of(run),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(displacement_m: [f64; 3]) -> String {
        let history = History { id: "p".into(), displacement_m: vec![displacement_m], debris_s: None };
        serde_json::to_value(&points(&[history], 1)[0]).unwrap()["displacement_mm"].to_string()
    }

    #[test]
    fn energies_have_four_digits() {
        let words = |x: f64| four_digits(x).to_string();
        assert_eq!(words(1_234_567.0), "1235000");
        assert_eq!(words(-0.000_123_46), "-0.0001235");
        assert_eq!(words(0.0), "0");
    }

    #[test]
    fn small_motions_have_more_digits() {
        assert_eq!(text([3.456_789, -0.000_4, 0.012_34]), "[3457,0,12]");
        assert_eq!(text([0.123_456, 0.01, 0.0]), "[123.5,10,0]");
        assert_eq!(text([-0.021_234, 0.0, 0.0]), "[-21.23,0,0]");
        assert_eq!(text([0.001_234_9, 0.0, 0.0]), "[1.235,0,0]");
        assert_eq!(text([0.0; 3]), "[0,0,0]");
    }
}
