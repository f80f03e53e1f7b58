//! Plans other than rectangles: an L, T or U, by bays that are not built.
//!
//! They are a series of their own, so that the scenes of the plan stay what they are. All else is as there, but that they have two or three bays each way and neither shear wall nor opening.

use super::{Blast, Of, Point, Scene};
use crate::building::Bays;

/// Which bays are left out, seen from above.
#[derive(Debug, Clone, Copy)]
enum Outline {
    /// The one at the last axes along x and y.
    FarCorner,
    /// The one at the last axis along x and the first along y.
    NearCorner,
    /// The middle one of the last row along y; of two the first.
    Notch,
    /// All of the last row but one.
    Arm,
}

impl Scene {
    /// The scene with this number, from 1, in the series of irregular plans of a seed.
    pub fn irregular(seed: u32, number: u32) -> Self {
        let point = Point { seed, number };
        let bays = [Of::BaysX, Of::BaysY].map(|of| point.choice(of, &[(2, 0.6), (3, 0.4)]));
        let outline = point.choice(
            Of::Outline,
            &[
                (Outline::FarCorner, 0.3),
                (Outline::NearCorner, 0.3),
                (Outline::Notch, 0.2),
                (Outline::Arm, 0.2),
            ],
        );
        let mut scene = Self::with_bays(&point, bays);
        let [x, y] = bays;
        let (columns, rows) = match outline {
            Outline::FarCorner => ([x - 1, x], [y - 1, y]),
            Outline::NearCorner => ([x - 1, x], [0, 1]),
            Outline::Notch => ([(x - 1) / 2, (x - 1) / 2 + 1], [y - 1, y]),
            Outline::Arm => ([1, x], [y - 1, y]),
        };
        scene.without = vec![[[columns[0], rows[0]], [columns[1], rows[1]]]];
        (scene.has_wall, scene.has_opening) = (false, false);
        let mut built = Bays::all(bays.map(|n| n + 1));
        scene.without.iter().for_each(|out| built.leave_out(*out));
        let standing = |[i, j]: [usize; 2]| built.has_column(i, j);
        let mut blasts: Vec<Blast> =
            scene.blasts.iter().filter(|blast| standing(blast.axes)).copied().collect();
        if blasts.is_empty() {
            // a single column of the front that is not there: the first one that is
            let places = 0..scene.axes_m[1 - scene.fall.0].len();
            let front = places.map(|place| scene.column(scene.rows()[0], place)).find(|axes| standing(*axes));
            blasts.extend(front.map(|axes| Blast { storey: 1, axes, time_s: 0.0 }));
        }
        scene.blasts = blasts;
        scene
    }
}
