//! Lines of bars across a member: bars that nearly share one are meshed on it, and tie legs lie on them.

use crate::building::Bar;
use crate::material::fibre::SectionInput;

/// Distance below which two lines of bars are meshed as one \[m\], and over the size of the elements: elements between them would be slivers, whose time
/// step the whole run would have.
pub(super) const ONE_LINE_M: f64 = 0.01;
const ONE_LINE_SIZES: f64 = 0.25;
/// Coordinates closer than this are one \[m\].
const SAME_M: f64 = 1e-6;

/// The section as it is meshed in elements of a size \[m\]: bars whose lines lie closer together than 10 mm and a quarter of an element stand on a common line through the
/// centre of their areas. Where many follow each other so closely, lines are spread evenly from the first to the last. Bars that come to stand
/// on each other count as one of their area (as a bundle does, EN 1992-1-1, 8.9.1). All other coordinates stay as they are.
pub(super) fn aligned(section: &SectionInput, size_m: f64) -> SectionInput {
    let limit_m = ONE_LINE_M.min(ONE_LINE_SIZES * size_m) - SAME_M;
    let mut aligned = section.clone();
    for axis in 0..2 {
        align(&mut aligned.bars, axis, limit_m);
    }
    let mut bars: Vec<Bar> = Vec::with_capacity(aligned.bars.len());
    for bar in aligned.bars {
        let same = |b: &&mut Bar| (b.x_m - bar.x_m).abs() < SAME_M && (b.y_m - bar.y_m).abs() < SAME_M;
        match bars.iter_mut().find(same) {
            Some(there) => there.diameter_m = libm::hypot(there.diameter_m, bar.diameter_m),
            None => bars.push(bar),
        }
    }
    aligned.bars = bars;
    aligned
}

/// A coordinate of a bar.
fn place(bar: &mut Bar, axis: usize) -> &mut f64 {
    if axis == 0 { &mut bar.x_m } else { &mut bar.y_m }
}

/// Moves bars onto common lines across one axis.
fn align(bars: &mut [Bar], axis: usize, limit_m: f64) {
    let at: Vec<f64> = bars.iter().map(|b| [b.x_m, b.y_m][axis]).collect();
    let mut order: Vec<usize> = (0..bars.len()).collect();
    order.sort_by(|a, b| at[*a].total_cmp(&at[*b]));
    for group in order.chunk_by(|a, b| at[*b] - at[*a] < limit_m) {
        let first = at[group[0]];
        let spread = at[group[group.len() - 1]] - first;
        if spread < SAME_M {
            continue;
        }
        let squares = || group.iter().map(|i| bars[*i].diameter_m * bars[*i].diameter_m);
        let centre =
            group.iter().zip(squares()).map(|(i, d2)| at[*i] * d2).sum::<f64>() / squares().sum::<f64>();
        let gaps = (spread / limit_m).floor();
        for i in group {
            let line = ((at[*i] - first) / spread * gaps).round();
            *place(&mut bars[*i], axis) = if gaps > 0.0 { first + spread * line / gaps } else { centre };
        }
    }
}

/// Tie legs on each of some lines of bars, in all as many as there are: one on each outer line and the rest shared by the inner lines; without inner lines the
/// outer ones share them all.
pub(super) fn leg_weights(lines: usize, legs: f64) -> Vec<f64> {
    if lines <= 2 {
        return vec![legs / lines as f64; lines];
    }
    let each = (legs - 2.0).max(0.0) / (lines - 2) as f64;
    (0..lines).map(|i| if i == 0 || i + 1 == lines { 1.0 } else { each }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::source::Source;
    use crate::rc::member::{Joint, RcMember};
    use crate::rc::section_file::{EXAMPLE, RcSection, read};

    fn section(bars: &[[f64; 3]]) -> RcSection {
        let mut section = read(&Source::new("section.toml", EXAMPLE)).unwrap();
        section.input.bars =
            bars.iter().map(|[x, y, d]| Bar { x_m: 1e-3 * x, y_m: 1e-3 * y, diameter_m: 1e-3 * d }).collect();
        section
    }

    fn near(found: f64, wanted_mm: f64) {
        assert!((found - 1e-3 * wanted_mm).abs() < 1e-12, "{found} for {wanted_mm} mm");
    }

    /// Bars of 25 and 16 mm that lie on one tie: their centres are 4.5 mm apart.
    #[test]
    fn bars_that_nearly_share_a_line_stand_on_it() {
        let corners =
            [[-160.0, -160.0, 25.0], [160.0, -160.0, 25.0], [-164.5, 164.5, 16.0], [164.5, 164.5, 16.0]];
        let mixed = section(&corners);
        let found = aligned(&mixed.input, 0.05).bars;
        // (25^2 160 + 16^2 164.5) / (25^2 + 16^2) = 161.3076
        let line: f64 = (625.0 * 160.0 + 256.0 * 164.5) / 881.0;
        for (bar, [x, y, d]) in found.iter().zip(corners) {
            near(bar.x_m, line.copysign(x));
            near(bar.y_m, y);
            near(bar.diameter_m, d);
        }
        // as many elements as with common lines, half and whole, and none is a sliver
        let plain = section(&corners.map(|[x, y, _]| [x.signum() * 160.0, y, 20.0]));
        let count =
            |s: &RcSection| RcMember::hexahedra(&s.input, &s.concrete, Joint::Symmetry, s.length_m, 0.05);
        assert_eq!(count(&mixed), count(&plain));
        let sizes_m = [mixed.length_m, 0.05];
        let half = RcMember::half(&mixed.input, &mixed.concrete, Joint::Symmetry, sizes_m, 90.0).unwrap();
        assert_eq!((half.mirror, 2 * half.mesh.elements.len()), (Some(0), count(&mixed)));
    }

    #[test]
    fn lines_apart_stay_as_they_are_to_the_last_bit() {
        let example = read(&Source::new("section.toml", EXAMPLE)).unwrap();
        assert_eq!(aligned(&example.input, 0.05), example.input);
        // 10 mm apart; 5 mm in elements of 20 mm
        let apart = section(&[[-160.0, 0.0, 20.0], [-150.0, 100.0, 20.0], [160.0, 0.0, 20.0]]);
        assert_eq!(aligned(&apart.input, 0.05), apart.input);
        let close = section(&[[-160.0, 0.0, 20.0], [-155.0, 100.0, 20.0], [160.0, 0.0, 20.0]]);
        assert_eq!(aligned(&close.input, 0.02), close.input);
        near(aligned(&close.input, 0.05).bars[1].x_m, -157.5);
    }

    /// A row of six bars at 8 mm each: 40 mm make four gaps of 10 mm. Two touching bars of 9 mm are one of twice the area.
    #[test]
    fn rows_are_spread_evenly_and_bundles_are_one_bar() {
        let row: Vec<[f64; 3]> =
            (0..6).map(f64::from).map(|i| [8.0 * i - 20.0, 60.0 * i - 150.0, 16.0]).collect();
        let found = aligned(&section(&row).input, 0.05).bars;
        for (bar, x) in found.iter().zip([-20.0, -10.0, 0.0, 0.0, 10.0, 20.0]) {
            near(bar.x_m, x);
        }
        let bundle = section(&[[-4.5, -160.0, 9.0], [4.5, -160.0, 9.0], [0.0, 160.0, 20.0]]);
        let found = aligned(&bundle.input, 0.05).bars;
        assert_eq!(found.len(), 2);
        near(found[0].diameter_m, 9.0 * std::f64::consts::SQRT_2);
    }

    #[test]
    fn every_leg_lies_on_a_line_of_bars() {
        assert_eq!(leg_weights(2, 2.0), [1.0, 1.0]);
        assert_eq!(leg_weights(3, 2.0), [1.0, 0.0, 1.0]);
        assert_eq!(leg_weights(4, 4.0), [1.0; 4]);
        assert_eq!(leg_weights(3, 4.0), [1.0, 2.0, 1.0]);
        // without an inner line
        assert_eq!(leg_weights(2, 6.0), [3.0, 3.0]);
        assert_eq!(leg_weights(1, 2.0), [2.0]);
    }
}
