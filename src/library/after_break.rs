//! What column ends bear once their first layer of elements has broken, as pushes of submodels show it.
//!
//! Layer by layer a section has broken as a whole when its layers have ([`crate::rc::layers`]); in a submodel, what is left of the row at the joint, the rows beside it and the concrete beneath bear on. Where the first layer breaks, what is left then, and until when, are medians of the 39
//! column ends of the homogenised submodel in the library, about both axes (`tests/library/layered.rs`); rotations are multiples of `ε_r s / z`, at which the centre of the outermost element, `z` from the middle, has the rupture strain `ε_r` if all of the rotation is in one row of the length `s`.

use crate::base::piecewise::interpolate;
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::rc::pushover::LARGEST_ROTATION;

/// Rotation at which the moment has fallen below [`BROKEN`] of its peak, over that multiple, at axial forces over the squash load.
pub const BREAKS: [[f64; 2]; 5] = [[-0.1, 1.13], [0.0, 1.17], [0.1, 1.51], [0.2, 1.17], [0.4, 0.9]];
/// Mean moment from 1.15 to 2.2 times that rotation, over the peak.
pub const LEFT: [[f64; 2]; 5] = [[-0.1, 0.10], [0.0, 0.18], [0.1, 0.22], [0.2, 0.12], [0.4, 0.12]];
/// Rotation from which on less than a twentieth of the peak is left, over the same multiple; pushes end at [`LARGEST_ROTATION`].
pub const ENDS: [[f64; 2]; 5] = [[-0.1, 3.0], [0.0, 4.0], [0.1, 3.8], [0.2, 1.75], [0.4, 2.1]];
/// Share of the peak below which the first layer has broken.
pub const BROKEN: f64 = 0.7;
/// Length of a fall of the moment, of the rotation at which it begins.
const FALL: f64 = 0.05;

/// A curve of a section with what is left of it once it breaks, for its squash load \[N\] and the rotation at which its outermost element breaks \[rad\].
pub fn as_pushed(curve: &ResistanceCurve, squash_n: f64, rupture_rad: f64) -> ResistanceCurve {
    let ends = ENDS.map(|[share, end]| [share, (end * rupture_rad).min(LARGEST_ROTATION)]);
    let fracture_rotation_rad = ends.iter().map(|end| end[1]).fold(0.0, f64::max) * (1.0 + FALL);
    let level = |level: &CapacityLevel| {
        let share = level.axial_force_n / squash_n;
        let of = |table: &[[f64; 2]]| interpolate(table, share);
        let breaks_rad = of(&BREAKS) * rupture_rad;
        let ends_rad = of(&ends).max(2.0 * FALL * breaks_rad + breaks_rad);
        let peak = level.peak_nm();
        let mut capacity = up_to_break(level, breaks_rad);
        let left = of(&LEFT) * peak;
        capacity.push([breaks_rad * (1.0 + FALL), left]);
        capacity.extend([[ends_rad, left], [ends_rad * (1.0 + FALL), 0.0]]);
        CapacityLevel { axial_force_n: level.axial_force_n, capacity, fracture_rotation_rad }
    };
    ResistanceCurve { levels: curve.levels.iter().map(level).collect(), ..curve.clone() }
}

/// A level up to where it breaks, which comes to lie at a given rotation; the knee stays where it is.
fn up_to_break(level: &CapacityLevel, breaks_rad: f64) -> Vec<[f64; 2]> {
    let peak = level.peak_nm();
    let at_peak = level.capacity.iter().position(|p| p[1] == peak).unwrap_or(0);
    let falls = level.capacity.iter().skip(at_peak).position(|p| p[1] < BROKEN * peak);
    let whole = &level.capacity[..falls.map_or(level.capacity.len(), |n| at_peak + n).max(1)];
    let last = whole[whole.len() - 1][0];
    if last <= 0.0 {
        return vec![whole[0], [breaks_rad, whole[0][1]]];
    }
    // evenly more from nothing at the knee to all of it at the end
    let more = (breaks_rad / last - 1.0).max(-0.5);
    let mut moved: Vec<[f64; 2]> =
        whole.iter().map(|[x, moment]| [(x * (1.0 + more * x / last)).min(breaks_rad), *moment]).collect();
    let end = moved.len() - 1;
    moved[end][0] = breaks_rad;
    moved.dedup_by(|later, kept| later[0] <= kept[0]);
    moved
}
