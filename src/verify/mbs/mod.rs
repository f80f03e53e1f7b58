//! Cases of the multibody solver.

mod breaking;
pub mod catenary;
mod chimney;
mod contact;
mod crosswise;
mod fractures;
mod hinges;
mod iftomm;
mod impact;
mod leaning;
mod linkages;
pub mod models;
pub mod onset;
mod pancake;
mod parting;
mod pendulums;
pub mod pile;
mod rates;
mod spin;
mod turning;

use super::{Case, Figure};
use crate::mbs::ideal::Mechanism;
use crate::mbs::ideal::march::{Course, March, march};
use crate::mbs::ideal::motion::point_at;
use crate::mbs::math::V3;

/// All cases.
pub fn cases() -> Vec<Case> {
    let mut all = iftomm::cases();
    all.extend(pendulums::cases());
    all.extend(hinges::cases());
    all.extend(catenary::cases());
    all.extend(onset::cases());
    all.extend(leaning::cases());
    all.extend(crosswise::cases());
    all.extend(spin::cases());
    all.extend(turning::cases());
    all.extend(contact::cases());
    all.extend(impact::cases());
    all.extend(linkages::cases());
    all.extend(pancake::cases());
    all.extend(parting::cases());
    all.extend(fractures::cases());
    all.extend(breaking::cases());
    all.extend(rates::cases());
    all.extend(chimney::cases());
    all
}

/// Mechanisms with a point whose path is known, for benchmarks.
pub fn known() -> Vec<Known> {
    vec![
        iftomm::a01(),
        iftomm::a02_2(),
        iftomm::a02_40(),
        iftomm::a02_80(),
        iftomm::a03(),
        iftomm::a04(),
        hinges::topple_flow(),
        hinges::topple_elastic(),
        hinges::frame4(),
    ]
}

/// A mechanism with a point whose path is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// What it is.
    pub name: &'static str,
    /// Name of its model file among [`models::all`].
    pub file: &'static str,
    /// The mechanism.
    pub mechanism: Mechanism,
    /// Body of the point, and the point in its frame \[m\].
    pub point: (usize, V3),
    /// Times \[s\] and places \[m\]; times are outputs.
    pub track: Vec<(f64, V3)>,
    /// Simulated time, interval of outputs \[s\].
    pub end_s: f64,
    /// Interval of outputs \[s\].
    pub output_s: f64,
}

impl Known {
    fn of(mechanism: Mechanism, body: usize, point: V3) -> Self {
        Self {
            name: "",
            file: "",
            mechanism,
            point: (body, point),
            track: Vec::new(),
            end_s: 1.0,
            output_s: 1.0,
        }
    }

    /// Runs it with an error tolerance of the steps.
    ///
    /// # Errors
    /// In words, if it stops.
    pub fn run(&self, tolerance: f64) -> Result<Course, String> {
        let wanted = March { end_s: self.end_s, tolerance, output_s: self.output_s, in_space: false };
        march(&self.mechanism, &wanted).map_err(|e| e.to_string())
    }

    /// Distances from the known path \[m\].
    pub fn distances_m(&self, course: &Course) -> Vec<f64> {
        let away = |(time, place): &(f64, V3)| {
            let ours =
                point_at(&course.states[(time / self.output_s).round() as usize], self.point.0, self.point.1);
            (0..3).map(|i| (ours[i] - place[i]).powi(2)).sum::<f64>().sqrt()
        };
        self.track.iter().map(away).collect()
    }

    /// The known path as a table `time_s,x_m,y_m,z_m`.
    pub fn csv(&self) -> String {
        let row = |(time, [x, y, z]): &(f64, V3)| format!("{time},{x},{y},{z}\n");
        "time_s,x_m,y_m,z_m\n".to_string() + &self.track.iter().map(row).collect::<String>()
    }

    /// Runs it; distances and, with a limit \[J\], the energy error.
    fn figures(
        &self,
        tolerance: f64,
        allowed_m: f64,
        source: &'static str,
        energy_j: Option<f64>,
    ) -> Result<Vec<Figure>, String> {
        Ok(self.figures_of(&self.run(tolerance)?, allowed_m, source, energy_j))
    }

    fn figures_of(
        &self,
        course: &Course,
        allowed_m: f64,
        source: &'static str,
        energy_j: Option<f64>,
    ) -> Vec<Figure> {
        let pairs = self.track.iter().zip(self.distances_m(course));
        let of_point = |((time, _), away): (&(f64, V3), f64)| {
            Figure::absolute(format!("distance at {time} s"), "m", [0.0, away], allowed_m, source)
        };
        let mut figures: Vec<Figure> = pairs.map(of_point).collect();
        figures.extend(energy_j.map(|limit| {
            Figure::absolute("energy error", "J", [0.0, course.energy_change_j], limit, "conservation")
        }));
        figures
    }
}
