//! A plan of studies: a seeded, space-filling set of buildings and of what happens to them.
//!
//! A scene is a point of an Owen-scrambled Sobol sequence (Burley, Practical Hash-based Owen Scrambling, J. Comput. Graph. Tech. 10 (2021) 1): any first
//! so many scenes of a seed cover the ranges evenly, so that a plan may be made longer later without a change of what is there. Its coordinates are
//! frame, spans, floors, strength, and the demolition; sizes follow from them by rules of design, so that no scene is a building that nobody would build.
//!
//! | file | owns |
//! |---|---|
//! | this one | coordinates, the frame and the blasting plan |
//! | `design` | sizes and bars from spans and loads |
//! | `outline` | plans other than rectangles, a series of their own |
//! | `small` | small buildings with random removals and obstacles, outside the plan |
//! | `text` | the building file |

mod design;
mod outline;
mod small;
mod text;

use crate::building::BayRange;
use design::Sizes;

/// Longest edge of a bay and shortest \[m\], and their module.
const SPAN_M: [f64; 3] = [4.0, 8.0, 0.5];
/// Storey heights \[m\].
const HEIGHT_M: [f64; 3] = [2.8, 4.0, 0.1];
/// Most columns of a scene: with more the FE run takes hours.
const MOST_COLUMNS: usize = 60;
/// Most storeys.
const MOST_STOREYS: f64 = 8.0;

/// Which beams a floor has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beams {
    /// On all axes.
    All,
    /// On the outer axes.
    Perimeter,
    /// None: a flat slab.
    None,
}

impl Beams {
    /// The name in a building file.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Perimeter => "perimeter",
            Self::None => "none",
        }
    }
}

/// A charge that removes a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blast {
    /// Storey, from 1.
    pub storey: usize,
    /// Axes along x and y, from 0.
    pub axes: [usize; 2],
    /// Time of ignition \[s\].
    pub time_s: f64,
}

/// A wall in the way of the fall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obstacle {
    /// From the front face of the building \[m\].
    pub distance_m: f64,
    /// Its height \[m\].
    pub height_m: f64,
}

/// A rigid block on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Lower corner along x and y \[m\].
    pub from_m: [f64; 2],
    /// Upper corner \[m\].
    pub to_m: [f64; 2],
    /// Its height \[m\].
    pub height_m: f64,
}

/// A building and its demolition.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Seed of the plan.
    pub seed: u32,
    /// Place in the plan, from 1.
    pub number: u32,
    /// Whether it is no scene of a plan but one of the small buildings for runs that ask about stability.
    pub small: bool,
    /// Axes along x and y \[m\].
    pub axes_m: [Vec<f64>; 2],
    /// Storey heights from below \[m\].
    pub heights_m: Vec<f64>,
    /// Beams.
    pub beams: Beams,
    /// Sizes of sections.
    pub sizes: Sizes,
    /// Axis along which it falls, and whether towards smaller coordinates: where the front is.
    pub fall: (usize, bool),
    /// Charges.
    pub blasts: Vec<Blast>,
    /// Factor on the strength of the ground floor's columns that stay.
    pub weakened: Option<f64>,
    /// A wall before the front.
    pub obstacle: Option<Obstacle>,
    /// Blocks around and under it.
    pub blocks: Vec<Block>,
    /// A shear wall in the first bay of the rear axis.
    pub has_wall: bool,
    /// An opening in the slabs of the last bay.
    pub has_opening: bool,
    /// Bays that are not built, between axes along x and y, of a plan that is no rectangle.
    pub without: Vec<BayRange>,
}

/// What a coordinate of a scene decides; the order is that of the sequence, whose first numbers cover best.
#[derive(Debug, Clone, Copy)]
enum Of {
    BaysX,
    BaysY,
    Storeys,
    Blasting,
    Beams,
    SpanX,
    SpanY,
    AxialRatio,
    Bars,
    Height,
    Fall,
    Delay,
    GroundHeight,
    Uneven,
    Weakened,
    Factor,
    Obstacle,
    Distance,
    ObstacleHeight,
    Wall,
    Opening,
    Outline,
}

/// A point of the sequence.
struct Point {
    seed: u32,
    number: u32,
}

impl Point {
    fn at(&self, of: Of) -> f64 {
        f64::from(sobol_burley::sample(self.number - 1, of as u32, self.seed))
    }

    /// A multiple of a module between two bounds.
    fn module(&self, of: Of, [low, high, module]: [f64; 3]) -> f64 {
        let steps = ((high - low) / module).round() + 1.0;
        milli(low + module * (self.at(of) * steps).floor())
    }

    /// Whether a coordinate is among the first share.
    fn is(&self, of: Of, share: f64) -> bool {
        self.at(of) < share
    }

    /// Which of some choices with these shares.
    fn choice<T: Copy>(&self, of: Of, choices: &[(T, f64)]) -> T {
        let mut rest = self.at(of);
        for (choice, share) in choices {
            if rest < *share {
                return *choice;
            }
            rest -= share;
        }
        choices[choices.len() - 1].0
    }
}

/// How columns are taken away.
#[derive(Debug, Clone, Copy)]
enum Blasting {
    FrontRow,
    FrontRowDelayed,
    Corner,
    Middle,
    RowByRow,
    All,
    TwoStoreys,
}

impl Scene {
    /// The scene with this number, from 1, in the plan of a seed.
    pub fn of(seed: u32, number: u32) -> Self {
        let point = Point { seed, number };
        let bays = [Of::BaysX, Of::BaysY].map(|of| point.choice(of, &[(1, 0.4), (2, 0.35), (3, 0.25)]));
        Self::with_bays(&point, bays)
    }

    fn with_bays(point: &Point, bays: [usize; 2]) -> Self {
        let Point { seed, number } = *point;
        let most = MOST_COLUMNS / ((bays[0] + 1) * (bays[1] + 1));
        // low buildings more often: a storey more costs as much as they do
        let storeys = 1 + (MOST_STOREYS * libm::pow(point.at(Of::Storeys), 1.5)) as usize;
        let storeys = storeys.min(most);
        let spans = [Of::SpanX, Of::SpanY].map(|of| point.module(of, SPAN_M));
        let uneven = point.is(Of::Uneven, 0.2);
        let axes_m = [0, 1].map(|d| axes(bays[d], spans[d], uneven));
        let heights_m = heights(point, storeys);
        let beams =
            point.choice(Of::Beams, &[(Beams::Perimeter, 0.4), (Beams::All, 0.35), (Beams::None, 0.25)]);
        let ratio = 0.12 + 0.18 * point.at(Of::AxialRatio);
        let bars = point.choice(Of::Bars, &[(0.010, 0.34), (0.016, 0.33), (0.024, 0.33)]);
        let sizes = Sizes::of(&axes_m, storeys, beams, ratio, bars);
        let fall = point.choice(Of::Fall, &[((1, true), 0.4), ((0, true), 0.4), ((1, false), 0.2)]);
        let mut scene = Self {
            seed,
            number,
            small: false,
            axes_m,
            heights_m,
            beams,
            sizes,
            fall,
            blasts: Vec::new(),
            weakened: point.is(Of::Weakened, 0.2).then(|| milli(0.6 + 0.3 * point.at(Of::Factor))),
            obstacle: point.is(Of::Obstacle, 0.2).then(|| Obstacle {
                distance_m: point.module(Of::Distance, [1.0, 5.0, 0.5]),
                height_m: point.module(Of::ObstacleHeight, [1.0, 3.0, 0.5]),
            }),
            blocks: Vec::new(),
            has_wall: point.is(Of::Wall, 0.15),
            has_opening: point.is(Of::Opening, 0.15),
            without: Vec::new(),
        };
        scene.blasts = scene.charges(point);
        scene
    }

    /// Its name.
    pub fn name(&self) -> String {
        let series = match (self.small, self.without.is_empty()) {
            (true, _) => "b",
            (_, true) => "s",
            (_, false) => "i",
        };
        format!("{series}{}-{:03}", self.seed, self.number)
    }

    /// Rows of ground-floor columns from the front to the rear: their places on the axis of the fall.
    fn rows(&self) -> Vec<usize> {
        let count = self.axes_m[self.fall.0].len();
        if self.fall.1 { (0..count).collect() } else { (0..count).rev().collect() }
    }

    /// A column of a row.
    fn column(&self, row: usize, place: usize) -> [usize; 2] {
        if self.fall.0 == 0 { [row, place] } else { [place, row] }
    }

    fn charges(&self, point: &Point) -> Vec<Blast> {
        let kind = point.choice(
            Of::Blasting,
            &[
                (Blasting::FrontRow, 0.32),
                (Blasting::RowByRow, 0.22),
                (Blasting::FrontRowDelayed, 0.12),
                (Blasting::TwoStoreys, 0.12),
                (Blasting::All, 0.08),
                // most of these stand
                (Blasting::Corner, 0.07),
                (Blasting::Middle, 0.07),
            ],
        );
        let rows = self.rows();
        let places = self.axes_m[1 - self.fall.0].len();
        // times on the output interval
        let delay_s = 0.05 + 0.01 * (point.at(Of::Delay) * 36.0).floor();
        let blast = |storey: usize, row: usize, place: usize, steps: usize| Blast {
            storey,
            axes: self.column(rows[row], place),
            time_s: milli(delay_s * steps as f64),
        };
        let row = |storey: usize, row: usize, steps: usize| -> Vec<Blast> {
            (0..places).map(|place| blast(storey, row, place, steps)).collect()
        };
        let behind = rows.len() - 1;
        match kind {
            Blasting::FrontRow => row(1, 0, 0),
            Blasting::FrontRowDelayed => (0..places).map(|place| blast(1, 0, place, place)).collect(),
            Blasting::Corner => vec![blast(1, 0, 0, 0)],
            Blasting::Middle => vec![blast(1, 0, places / 2, 0)],
            Blasting::RowByRow => (0..behind).flat_map(|r| row(1, r, r)).collect(),
            Blasting::All => (0..=behind).flat_map(|r| row(1, r, 0)).collect(),
            Blasting::TwoStoreys => {
                let upper = self.heights_m.len().div_ceil(2).max(1);
                let above = if upper > 1 { row(upper, 0, 1) } else { Vec::new() };
                row(1, 0, 0).into_iter().chain(above).collect()
            }
        }
    }
}

/// Axes of so many bays; uneven ones have a last bay of three quarters.
fn axes(bays: usize, span_m: f64, uneven: bool) -> Vec<f64> {
    let mut axes: Vec<f64> = (0..=bays).map(|i| span_m * i as f64).collect();
    if uneven && bays > 1 {
        axes[bays] = milli(axes[bays - 1] + 0.75 * span_m);
    }
    axes
}

fn heights(point: &Point, storeys: usize) -> Vec<f64> {
    let mut heights = vec![point.module(Of::Height, HEIGHT_M); storeys];
    let more = point.at(Of::GroundHeight);
    // a third of the buildings have a high ground floor
    if more < 1.0 / 3.0 {
        heights[0] = milli(heights[0] + 0.1 * (30.0 * more).floor());
    }
    heights
}

/// Rounded to a millimetre, so that the text of a file is short.
fn milli(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tree::Format;
    use crate::building::parse;

    #[test]
    fn a_scene_is_the_same_whatever_the_length_of_the_plan() {
        assert_eq!(Scene::of(1, 7), Scene::of(1, 7));
        assert_ne!(Scene::of(1, 7), Scene::of(2, 7));
        assert_ne!(Scene::of(1, 7), Scene { number: 7, ..Scene::of(1, 8) });
    }

    #[test]
    fn scenes_cover_their_ranges_evenly() {
        let scenes: Vec<Scene> = (1..=128).map(|n| Scene::of(1, n)).collect();
        let share = |is: &dyn Fn(&Scene) -> bool| scenes.iter().filter(|s| is(s)).count() as f64 / 128.0;
        // a random set would be off by 0.04 in every third of these
        for (found, wanted) in [
            (share(&|s| s.axes_m[0].len() == 2), 0.4),
            (share(&|s| s.axes_m[1].len() == 4), 0.25),
            (share(&|s| s.beams == Beams::None), 0.25),
            (share(&|s| s.obstacle.is_some()), 0.2),
            (share(&|s| s.weakened.is_some()), 0.2),
            (share(&|s| s.blasts.len() == 1), 0.14),
        ] {
            assert!((found - wanted).abs() < 0.03, "{found} {wanted}");
        }
        let storeys: Vec<usize> = scenes.iter().map(|s| s.heights_m.len()).collect();
        assert!((1..=8).all(|n| storeys.contains(&n)), "{storeys:?}");
        let columns = |s: &Scene| s.axes_m[0].len() * s.axes_m[1].len() * s.heights_m.len();
        assert!(scenes.iter().all(|s| columns(s) <= MOST_COLUMNS));
    }

    #[test]
    fn every_irregular_scene_is_a_building_without_errors() {
        for number in 1..=120 {
            let scene = Scene::irregular(1, number);
            assert!(!scene.blasts.is_empty() && !scene.without.is_empty());
            let read = parse(&scene.toml(), Format::Toml, &scene.name());
            assert!(read.is_ok(), "{}: {:?}", scene.name(), read.err().map(|e| e.to_string()));
        }
    }

    #[test]
    fn every_small_building_is_one_without_errors() {
        for number in 1..=200 {
            let scene = Scene::small(1, number);
            assert!(!scene.blasts.is_empty());
            let text = scene.toml();
            let read = parse(&text, Format::Toml, &scene.name());
            assert!(read.is_ok(), "{}:\n{text}\n{:?}", scene.name(), read.err().map(|e| e.to_string()));
        }
        assert_eq!(Scene::small(1, 7), Scene::small(1, 7));
        assert_ne!(Scene::small(1, 7), Scene { seed: 1, ..Scene::small(2, 7) });
    }

    #[test]
    fn every_scene_is_a_building_without_errors() {
        for seed in [1, 2] {
            for number in 1..=240 {
                let scene = Scene::of(seed, number);
                let text = scene.toml();
                let read = parse(&text, Format::Toml, &scene.name());
                assert!(read.is_ok(), "{}:\n{text}\n{:?}", scene.name(), read.err().map(|e| e.to_string()));
            }
        }
    }
}
