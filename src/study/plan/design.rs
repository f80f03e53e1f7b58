//! Sizes and bars from spans and loads: rules of thumb, and the fibre analysis of sections.

use super::{Beams, milli};

/// Weight of a floor over that of its slab: beams and columns.
const BESIDES_SLAB: f64 = 1.3;
/// Weight of reinforced concrete \[N/m³\].
const WEIGHT_N_M3: f64 = 25e3;
/// Sizes of columns \[m\].
const COLUMN_M: [f64; 2] = [0.25, 0.7];
/// Diameters of bars \[m\].
const DIAMETERS_M: [f64; 8] = [0.012, 0.014, 0.016, 0.018, 0.02, 0.025, 0.028, 0.032];

/// Sizes of a building.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// Side of the square columns, and width of the beams \[m\].
    pub column_m: f64,
    /// Depth of the beams \[m\].
    pub beam_m: f64,
    /// Thickness of the slabs \[m\].
    pub slab_m: f64,
    /// Bars along each face of a column, and their diameter \[m\].
    pub bars: (usize, f64),
    /// Bars at the top and at the bottom of a beam, of 20 mm.
    pub beam_bars: usize,
    /// Yield stress of the law of the FE model \[Pa\].
    pub yield_pa: f64,
    /// Its critical plastic strain.
    pub critical_strain: f64,
}

impl Sizes {
    /// For axes and storeys; columns bear `ratio` of their area times the yield stress at the foot of the most loaded one, with a share `bars` of reinforcement.
    pub(super) fn of(axes_m: &[Vec<f64>; 2], storeys: usize, beams: Beams, ratio: f64, bars: f64) -> Self {
        let longest = |axes: &Vec<f64>| axes.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        let spans = [longest(&axes_m[0]), longest(&axes_m[1])];
        let span = spans[0].max(spans[1]);
        let slab_m = match beams {
            // a slab between beams bears the way of its shorter span
            Beams::All => up(spans[0].min(spans[1]) / 30.0, 0.01).max(0.15),
            Beams::Perimeter | Beams::None => up(span / 27.0, 0.01).max(0.18),
        };
        // an inner column bears a whole bay, one on an edge half of it
        let share = |d: usize| if axes_m[d].len() > 2 { 1.0 } else { 0.5 };
        let floor = BESIDES_SLAB * WEIGHT_N_M3 * slab_m * spans[0] * spans[1] * share(0) * share(1);
        let yield_pa = yield_of(bars);
        let side = (floor * storeys as f64 / (ratio * yield_pa)).sqrt();
        let column_m = up(side, 0.05).clamp(COLUMN_M[0], COLUMN_M[1]);
        let beam_m = up(span / 12.0, 0.05).clamp(0.35, 0.7);
        let beam_bars = ((0.008 * column_m * beam_m) / circle(0.02)).round().max(2.0) as usize;
        Self {
            column_m: milli(column_m),
            beam_m: milli(beam_m),
            slab_m: milli(slab_m),
            bars: bars_of(bars * column_m * column_m),
            beam_bars,
            yield_pa,
            critical_strain: milli(0.06 + 0.1 * column_m),
        }
    }
}

/// The yield stress at which the hinge of a mesh with two elements across bears what a reinforced section does: `0.42 f h³ (1 - n²)` with the axial ratio `n`
/// (buildings/six-storey.toml). Fibre analyses with the strengths of EN 1992-1-1 (parabola and rectangle, C30, B500; 263 kN m for the reference column) of square columns of 250 to 700 mm
/// with the bars of [`bars_of`] at `n = 0.2` give 6.2 to 8.1 MPa for 1.0 %, 9.6 to 10.5 for 1.6 %, 12.4 to 16.1 for 2.4 %: the line through their means, to half a megapascal.
fn yield_of(bars: f64) -> f64 {
    let stress = 1.6e6 + 530e6 * bars;
    (stress / 0.5e6).round() * 0.5e6
}

/// Bars along each face, and their diameter, of a steel area of a square column.
fn bars_of(area_m2: f64) -> (usize, f64) {
    let fits = |count: f64| DIAMETERS_M.into_iter().find(|d| count * circle(*d) >= 0.97 * area_m2);
    // three bars a face are eight, four are twelve, five sixteen
    let choices = [(3, 8.0), (4, 12.0), (5, 16.0)];
    let found = choices.into_iter().find_map(|(face, count)| {
        let diameter = fits(count).filter(|d| *d <= 0.0251 || count == 16.0)?;
        Some((face, diameter))
    });
    found.unwrap_or((5, DIAMETERS_M[DIAMETERS_M.len() - 1]))
}

fn circle(diameter_m: f64) -> f64 {
    0.25 * std::f64::consts::PI * diameter_m * diameter_m
}

/// The next multiple above.
fn up(value: f64, module: f64) -> f64 {
    (value / module - 1e-9).ceil() * module
}
