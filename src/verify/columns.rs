//! Tested columns: reinforced concrete cantilevers (or halves of double-ended columns) under constant axial force and lateral cycles.
//!
//! Properties are those of the original reports. Peak moments are those at the base, with the moment of the axial force over the drift, on the positive and the
//! negative envelope of the measured histories. `drift_at_80` is the drift at which the lateral force had fallen to 80 % of its maximum, or the last one
//! of the test where it had not.

use crate::building::Bar;
use crate::material::fibre::{FibreOptions, SectionInput};
use crate::material::fibre_concrete::TieInput;
use crate::material::rate::power;
use crate::material::rebar::{Hardening, LoopShape, RebarLaw};

/// What ended a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// Bending.
    Flexure,
    /// Shear after the bars had yielded.
    FlexureShear,
    /// Shear.
    Shear,
}

/// A tested column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Specimen {
    /// First author and the report's name of it.
    pub name: &'static str,
    /// Authors and year of the report.
    pub source: &'static str,
    /// Side across the direction of bending \[m\].
    pub width_m: f64,
    /// Side in the direction of bending \[m\].
    pub depth_m: f64,
    /// Shear span \[m\].
    pub length_m: f64,
    /// Cylinder strength of the concrete \[Pa\].
    pub fc_pa: f64,
    /// Yield strength of the longitudinal bars \[Pa\].
    pub fy_long_pa: f64,
    /// Yield strength of the ties \[Pa\].
    pub fy_tie_pa: f64,
    /// Number and diameter \[m\] of the longitudinal bars.
    pub bars: (usize, f64),
    /// Bars at each face that bending compresses or pulls, and at each of the other two, with the corners.
    pub face_bars: [usize; 2],
    /// Concrete outside the ties \[m\].
    pub cover_to_tie_m: f64,
    /// Diameter of the ties \[m\].
    pub tie_diameter_m: f64,
    /// Spacing of the ties \[m\].
    pub tie_spacing_m: f64,
    /// Legs of a tie in each direction; a diagonal counts in part.
    pub legs: f64,
    /// Axial force over `f_c A_g`.
    pub axial_share: f64,
    /// What ended the test.
    pub failure: Failure,
    /// Largest base moment in positive and negative direction \[N m\].
    pub peak_moment_nm: [f64; 2],
    /// Drift at 80 % of the largest lateral force, or the last one of the test.
    pub drift_at_80: f64,
    /// Largest drift of the test.
    pub last_drift: f64,
    /// Whether the lateral force fell to 80 % before the test ended.
    pub fell: bool,
}

impl Specimen {
    /// The section, bending about its width; bars harden from 0.008 to 1.4 f_y at 0.10 along a parabola; ties hold all bars where
    /// they have more than two legs. Bars displace concrete and remember.
    pub fn section(&self) -> SectionInput {
        let ties = TieInput {
            diameter_m: self.tie_diameter_m,
            spacing_m: self.tie_spacing_m,
            yield_strength_pa: self.fy_tie_pa,
            ultimate_strain: 0.10,
            legs: [self.legs; 2],
            cover_m: self.cover_to_tie_m,
            all_bars_held: self.legs > 2.0,
        };
        let hardening = Hardening::Plateau {
            start_strain: 0.008,
            ultimate_strength_pa: 1.4 * self.fy_long_pa,
            exponent: 2.0,
        };
        let mpa = self.fc_pa / 1e6;
        SectionInput {
            size_m: [self.width_m, self.depth_m],
            bars: self.bars_at(),
            concrete_strength_pa: self.fc_pa,
            tensile_strength_pa: 0.3e6 * power(mpa, 2.0 / 3.0),
            youngs_modulus_pa: 22e9 * power(0.1 * mpa, 0.3),
            ties: Some(ties),
            steel: RebarLaw {
                youngs_modulus_pa: 200e9,
                yield_strength_pa: self.fy_long_pa,
                hardening,
                ultimate_strain: 0.10,
                loops: LoopShape::default(),
                buckling: None,
            },
            options: FibreOptions { deduct_bars: true, history: true },
        }
    }

    /// Bars around the section; bending is along the depth.
    fn bars_at(&self) -> Vec<Bar> {
        let diameter_m = self.bars.1;
        let inset = self.cover_to_tie_m + self.tie_diameter_m + 0.5 * diameter_m;
        let half = [0.5 * self.width_m - inset, 0.5 * self.depth_m - inset];
        let spread = |count: usize, half: f64, k: usize| half * (2.0 * k as f64 / (count - 1) as f64 - 1.0);
        let [across, along] = self.face_bars;
        let mut bars = Vec::with_capacity(self.bars.0);
        for k in 0..across {
            let x_m = spread(across, half[0], k);
            bars.extend([half[1], -half[1]].map(|y_m| Bar { x_m, y_m, diameter_m }));
        }
        for k in 1..along - 1 {
            let y_m = spread(along, half[1], k);
            bars.extend([half[0], -half[0]].map(|x_m| Bar { x_m, y_m, diameter_m }));
        }
        bars
    }

    /// Axial force \[N\].
    pub fn axial_force_n(&self) -> f64 {
        self.axial_share * self.fc_pa * self.width_m * self.depth_m
    }
}

/// The columns.
pub const SPECIMENS: [Specimen; 23] = [
    Specimen {
        name: "Gill No. 1",
        source: "Gill, Park and Priestley (1979)",
        width_m: 0.55,
        depth_m: 0.55,
        length_m: 1.2,
        fc_pa: 23.1e6,
        fy_long_pa: 375e6,
        fy_tie_pa: 297e6,
        bars: (12, 0.024),
        face_bars: [4, 4],
        cover_to_tie_m: 0.04,
        tie_diameter_m: 0.01,
        tie_spacing_m: 0.08,
        legs: 4.0,
        axial_share: 0.2597,
        failure: Failure::Flexure,
        peak_moment_nm: [837_770.0, 876_910.0],
        drift_at_80: 0.02822,
        last_drift: 0.02822,
        fell: false,
    },
    Specimen {
        name: "Gill No. 4",
        source: "Gill, Park and Priestley (1979)",
        width_m: 0.55,
        depth_m: 0.55,
        length_m: 1.2,
        fc_pa: 23.5e6,
        fy_long_pa: 375e6,
        fy_tie_pa: 294e6,
        bars: (12, 0.024),
        face_bars: [4, 4],
        cover_to_tie_m: 0.038,
        tie_diameter_m: 0.012,
        tie_spacing_m: 0.062,
        legs: 4.0,
        axial_share: 0.6,
        failure: Failure::Flexure,
        peak_moment_nm: [902_510.0, 899_860.0],
        drift_at_80: 0.01303,
        last_drift: 0.01303,
        fell: false,
    },
    Specimen {
        name: "Ang No. 3",
        source: "Ang, Priestley and Park (1981)",
        width_m: 0.4,
        depth_m: 0.4,
        length_m: 1.6,
        fc_pa: 23.6e6,
        fy_long_pa: 427e6,
        fy_tie_pa: 320e6,
        bars: (12, 0.016),
        face_bars: [4, 4],
        cover_to_tie_m: 0.0245,
        tie_diameter_m: 0.012,
        tie_spacing_m: 0.1,
        legs: 4.0,
        axial_share: 0.38,
        failure: Failure::Flexure,
        peak_moment_nm: [336_500.0, 325_320.0],
        drift_at_80: 0.03183,
        last_drift: 0.03183,
        fell: true,
    },
    Specimen {
        name: "Soesianawati No. 1",
        source: "Soesianawati, Park and Priestley (1986)",
        width_m: 0.4,
        depth_m: 0.4,
        length_m: 1.6,
        fc_pa: 46.5e6,
        fy_long_pa: 446e6,
        fy_tie_pa: 364e6,
        bars: (12, 0.016),
        face_bars: [4, 4],
        cover_to_tie_m: 0.013,
        tie_diameter_m: 0.007,
        tie_spacing_m: 0.085,
        legs: 4.0,
        axial_share: 0.1,
        failure: Failure::Flexure,
        peak_moment_nm: [353_810.0, 333_100.0],
        drift_at_80: 0.0489,
        last_drift: 0.06129,
        fell: true,
    },
    Specimen {
        name: "Soesianawati No. 2",
        source: "Soesianawati, Park and Priestley (1986)",
        width_m: 0.4,
        depth_m: 0.4,
        length_m: 1.6,
        fc_pa: 44e6,
        fy_long_pa: 446e6,
        fy_tie_pa: 360e6,
        bars: (12, 0.016),
        face_bars: [4, 4],
        cover_to_tie_m: 0.013,
        tie_diameter_m: 0.008,
        tie_spacing_m: 0.078,
        legs: 4.0,
        axial_share: 0.3,
        failure: Failure::Flexure,
        peak_moment_nm: [481_020.0, 460_870.0],
        drift_at_80: 0.03143,
        last_drift: 0.0617,
        fell: true,
    },
    Specimen {
        name: "Watson No. 5",
        source: "Watson and Park (1989)",
        width_m: 0.4,
        depth_m: 0.4,
        length_m: 1.6,
        fc_pa: 41e6,
        fy_long_pa: 474e6,
        fy_tie_pa: 372e6,
        bars: (12, 0.016),
        face_bars: [4, 4],
        cover_to_tie_m: 0.013,
        tie_diameter_m: 0.008,
        tie_spacing_m: 0.081,
        legs: 4.0,
        axial_share: 0.5,
        failure: Failure::Flexure,
        peak_moment_nm: [535_230.0, 516_660.0],
        drift_at_80: 0.02292,
        last_drift: 0.02432,
        fell: true,
    },
    Specimen {
        name: "Watson No. 7",
        source: "Watson and Park (1989)",
        width_m: 0.4,
        depth_m: 0.4,
        length_m: 1.6,
        fc_pa: 42e6,
        fy_long_pa: 474e6,
        fy_tie_pa: 308e6,
        bars: (12, 0.016),
        face_bars: [4, 4],
        cover_to_tie_m: 0.013,
        tie_diameter_m: 0.012,
        tie_spacing_m: 0.096,
        legs: 4.0,
        axial_share: 0.7,
        failure: Failure::Flexure,
        peak_moment_nm: [525_470.0, 432_580.0],
        drift_at_80: 0.01021,
        last_drift: 0.01614,
        fell: true,
    },
    Specimen {
        name: "Tanaka No. 1",
        source: "Tanaka and Park (1990)",
        width_m: 0.4,
        depth_m: 0.4,
        length_m: 1.6,
        fc_pa: 25.6e6,
        fy_long_pa: 474e6,
        fy_tie_pa: 333e6,
        bars: (8, 0.02),
        face_bars: [3, 3],
        cover_to_tie_m: 0.04,
        tie_diameter_m: 0.012,
        tie_spacing_m: 0.08,
        legs: 3.0,
        axial_share: 0.1999,
        failure: Failure::Flexure,
        peak_moment_nm: [290_410.0, 283_220.0],
        drift_at_80: 0.03936,
        last_drift: 0.08094,
        fell: true,
    },
    Specimen {
        name: "Tanaka No. 7",
        source: "Tanaka and Park (1990)",
        width_m: 0.55,
        depth_m: 0.55,
        length_m: 1.65,
        fc_pa: 32.1e6,
        fy_long_pa: 511e6,
        fy_tie_pa: 325e6,
        bars: (12, 0.02),
        face_bars: [4, 4],
        cover_to_tie_m: 0.04,
        tie_diameter_m: 0.012,
        tie_spacing_m: 0.09,
        legs: 4.0,
        axial_share: 0.3,
        failure: Failure::Flexure,
        peak_moment_nm: [1_073_100.0, 1_115_400.0],
        drift_at_80: 0.04976,
        last_drift: 0.05026,
        fell: true,
    },
    Specimen {
        name: "Ohno L1",
        source: "Ohno and Nishioka (1984)",
        width_m: 0.4,
        depth_m: 0.4,
        length_m: 1.6,
        fc_pa: 24.8e6,
        fy_long_pa: 362e6,
        fy_tie_pa: 325e6,
        bars: (8, 0.019),
        face_bars: [4, 2],
        cover_to_tie_m: 0.0315,
        tie_diameter_m: 0.009,
        tie_spacing_m: 0.1,
        legs: 2.0,
        axial_share: 0.032,
        failure: Failure::Flexure,
        peak_moment_nm: [195_540.0, 202_740.0],
        drift_at_80: 0.05129,
        last_drift: 0.05129,
        fell: false,
    },
    Specimen {
        name: "Atalay No. 1S1",
        source: "Atalay and Penzien (1975)",
        width_m: 0.305,
        depth_m: 0.305,
        length_m: 1.676,
        fc_pa: 29.1e6,
        fy_long_pa: 367e6,
        fy_tie_pa: 363e6,
        bars: (4, 0.022),
        face_bars: [2, 2],
        cover_to_tie_m: 0.032,
        tie_diameter_m: 0.0095,
        tie_spacing_m: 0.076,
        legs: 2.0,
        axial_share: 0.0986,
        failure: Failure::Flexure,
        peak_moment_nm: [112_270.0, 103_990.0],
        drift_at_80: 0.02498,
        last_drift: 0.02498,
        fell: false,
    },
    Specimen {
        name: "Atalay No. 5S1",
        source: "Atalay and Penzien (1975)",
        width_m: 0.305,
        depth_m: 0.305,
        length_m: 1.676,
        fc_pa: 29.4e6,
        fy_long_pa: 429e6,
        fy_tie_pa: 392e6,
        bars: (4, 0.022),
        face_bars: [2, 2],
        cover_to_tie_m: 0.032,
        tie_diameter_m: 0.0095,
        tie_spacing_m: 0.076,
        legs: 2.0,
        axial_share: 0.1953,
        failure: Failure::Flexure,
        peak_moment_nm: [138_990.0, 145_180.0],
        drift_at_80: 0.03081,
        last_drift: 0.03081,
        fell: false,
    },
    Specimen {
        name: "Atalay No. 10",
        source: "Atalay and Penzien (1975)",
        width_m: 0.305,
        depth_m: 0.305,
        length_m: 1.676,
        fc_pa: 32.4e6,
        fy_long_pa: 363e6,
        fy_tie_pa: 392e6,
        bars: (4, 0.022),
        face_bars: [2, 2],
        cover_to_tie_m: 0.032,
        tie_diameter_m: 0.0095,
        tie_spacing_m: 0.127,
        legs: 2.0,
        axial_share: 0.2658,
        failure: Failure::Flexure,
        peak_moment_nm: [151_160.0, 151_210.0],
        drift_at_80: 0.02391,
        last_drift: 0.03014,
        fell: true,
    },
    Specimen {
        name: "Saatcioglu U1",
        source: "Saatcioglu and Ozcebe (1989)",
        width_m: 0.35,
        depth_m: 0.35,
        length_m: 1.0,
        fc_pa: 43.6e6,
        fy_long_pa: 430e6,
        fy_tie_pa: 470e6,
        bars: (8, 0.025),
        face_bars: [3, 3],
        cover_to_tie_m: 0.0225,
        tie_diameter_m: 0.01,
        tie_spacing_m: 0.15,
        legs: 2.0,
        axial_share: 0.0,
        failure: Failure::Flexure,
        peak_moment_nm: [276_200.0, 251_300.0],
        drift_at_80: 0.04851,
        last_drift: 0.084,
        fell: true,
    },
    Specimen {
        name: "Saatcioglu U3",
        source: "Saatcioglu and Ozcebe (1989)",
        width_m: 0.35,
        depth_m: 0.35,
        length_m: 1.0,
        fc_pa: 34.8e6,
        fy_long_pa: 430e6,
        fy_tie_pa: 470e6,
        bars: (8, 0.025),
        face_bars: [3, 3],
        cover_to_tie_m: 0.0225,
        tie_diameter_m: 0.01,
        tie_spacing_m: 0.075,
        legs: 2.0,
        axial_share: 0.1407,
        failure: Failure::Flexure,
        peak_moment_nm: [283_580.0, 281_980.0],
        drift_at_80: 0.0511,
        last_drift: 0.072,
        fell: true,
    },
    Specimen {
        name: "Saatcioglu U4",
        source: "Saatcioglu and Ozcebe (1989)",
        width_m: 0.35,
        depth_m: 0.35,
        length_m: 1.0,
        fc_pa: 32e6,
        fy_long_pa: 438e6,
        fy_tie_pa: 470e6,
        bars: (8, 0.025),
        face_bars: [3, 3],
        cover_to_tie_m: 0.0225,
        tie_diameter_m: 0.01,
        tie_spacing_m: 0.05,
        legs: 2.0,
        axial_share: 0.1531,
        failure: Failure::Flexure,
        peak_moment_nm: [366_760.0, 331_420.0],
        drift_at_80: 0.0929,
        last_drift: 0.102,
        fell: true,
    },
    Specimen {
        name: "Saatcioglu U6",
        source: "Saatcioglu and Ozcebe (1989)",
        width_m: 0.35,
        depth_m: 0.35,
        length_m: 1.0,
        fc_pa: 37.3e6,
        fy_long_pa: 437e6,
        fy_tie_pa: 425e6,
        bars: (8, 0.025),
        face_bars: [3, 3],
        cover_to_tie_m: 0.026,
        tie_diameter_m: 0.0064,
        tie_spacing_m: 0.065,
        legs: 6.0,
        axial_share: 0.1313,
        failure: Failure::Flexure,
        peak_moment_nm: [387_200.0, 358_760.0],
        drift_at_80: 0.089,
        last_drift: 0.0898,
        fell: false,
    },
    Specimen {
        name: "Lynn 3CLH18",
        source: "Lynn (1999)",
        width_m: 0.4572,
        depth_m: 0.4572,
        length_m: 1.4732,
        fc_pa: 26.9e6,
        fy_long_pa: 331e6,
        fy_tie_pa: 399.9e6,
        bars: (8, 0.0318),
        face_bars: [3, 3],
        cover_to_tie_m: 0.0381,
        tie_diameter_m: 0.0095,
        tie_spacing_m: 0.4572,
        legs: 2.0,
        axial_share: 0.0895,
        failure: Failure::Shear,
        peak_moment_nm: [415_820.0, 383_580.0],
        drift_at_80: 0.01,
        last_drift: 0.02091,
        fell: true,
    },
    Specimen {
        name: "Lynn 2CLH18",
        source: "Lynn (1999)",
        width_m: 0.4572,
        depth_m: 0.4572,
        length_m: 1.4732,
        fc_pa: 33.1e6,
        fy_long_pa: 331e6,
        fy_tie_pa: 399.9e6,
        bars: (8, 0.0254),
        face_bars: [3, 3],
        cover_to_tie_m: 0.0381,
        tie_diameter_m: 0.0095,
        tie_spacing_m: 0.4572,
        legs: 2.0,
        axial_share: 0.0727,
        failure: Failure::FlexureShear,
        peak_moment_nm: [368_940.0, 360_990.0],
        drift_at_80: 0.02593,
        last_drift: 0.03136,
        fell: true,
    },
    Specimen {
        name: "Lynn 2CMH18",
        source: "Lynn (1999)",
        width_m: 0.4572,
        depth_m: 0.4572,
        length_m: 1.4732,
        fc_pa: 25.5e6,
        fy_long_pa: 331e6,
        fy_tie_pa: 399.9e6,
        bars: (8, 0.0254),
        face_bars: [3, 3],
        cover_to_tie_m: 0.0381,
        tie_diameter_m: 0.0095,
        tie_spacing_m: 0.4572,
        legs: 2.0,
        axial_share: 0.2837,
        failure: Failure::FlexureShear,
        peak_moment_nm: [472_120.0, 471_850.0],
        drift_at_80: 0.00957,
        last_drift: 0.05464,
        fell: true,
    },
    Specimen {
        name: "Sezen No. 1",
        source: "Sezen (2002)",
        width_m: 0.4572,
        depth_m: 0.4572,
        length_m: 1.4732,
        fc_pa: 21.1e6,
        fy_long_pa: 434.4e6,
        fy_tie_pa: 476e6,
        bars: (8, 0.0287),
        face_bars: [3, 3],
        cover_to_tie_m: 0.0651,
        tie_diameter_m: 0.0095,
        tie_spacing_m: 0.3048,
        legs: 3.4,
        axial_share: 0.1512,
        failure: Failure::FlexureShear,
        peak_moment_nm: [463_500.0, 481_820.0],
        drift_at_80: 0.02554,
        last_drift: 0.04962,
        fell: true,
    },
    Specimen {
        name: "Sezen No. 2",
        source: "Sezen (2002)",
        width_m: 0.4572,
        depth_m: 0.4572,
        length_m: 1.4732,
        fc_pa: 21.1e6,
        fy_long_pa: 434.4e6,
        fy_tie_pa: 476e6,
        bars: (8, 0.0287),
        face_bars: [3, 3],
        cover_to_tie_m: 0.0651,
        tie_diameter_m: 0.0095,
        tie_spacing_m: 0.3048,
        legs: 3.4,
        axial_share: 0.6051,
        failure: Failure::FlexureShear,
        peak_moment_nm: [476_930.0, 563_810.0],
        drift_at_80: 0.01522,
        last_drift: 0.01876,
        fell: true,
    },
    Specimen {
        name: "Sezen No. 4",
        source: "Sezen (2002)",
        width_m: 0.4572,
        depth_m: 0.4572,
        length_m: 1.4732,
        fc_pa: 21.8e6,
        fy_long_pa: 434.4e6,
        fy_tie_pa: 476e6,
        bars: (8, 0.0287),
        face_bars: [3, 3],
        cover_to_tie_m: 0.0651,
        tie_diameter_m: 0.0095,
        tie_spacing_m: 0.3048,
        legs: 3.4,
        axial_share: 0.1464,
        failure: Failure::FlexureShear,
        peak_moment_nm: [454_080.0, 354_580.0],
        drift_at_80: 0.02888,
        last_drift: 0.05656,
        fell: true,
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::fibre::FibreSection;
    use crate::material::fibre_concrete::{ConcreteLaw, Confinement};

    /// Confined strength \[MPa\], ultimate strain and peak moment \[kN m\] by another program on the same data, in the order of the columns. It deducts
    /// displaced concrete, its bars do not remember, and between corner bars alone it counts the distance of the centres in the place of the clear one.
    const OTHER: [[f64; 3]; SPECIMENS.len()] = [
        [34.32, 0.024686, 719.35],
        [42.613, 0.03451, 870.35],
        [39.206, 0.034498, 310.56],
        [54.643, 0.013204, 317.79],
        [55.428, 0.016808, 433.96],
        [52.212, 0.01753, 473.9],
        [58.537, 0.023178, 449.6],
        [42.062, 0.034524, 279.38],
        [47.335, 0.025099, 872.63],
        [27.616, 0.016782, 188.93],
        [36.152, 0.026654, 99.362],
        [36.973, 0.02792, 127.22],
        [36.029, 0.018689, 140.84],
        [46.911, 0.013958, 251.6],
        [43.278, 0.025589, 294.26],
        [45.131, 0.035053, 312.1],
        [55.025, 0.026024, 321.47],
        [27.081, 0.007451, 449.63],
        [33.271, 0.006809, 343.34],
        [25.67, 0.0076406, 420.39],
        [23.109, 0.018363, 424.38],
        [23.109, 0.018363, 422.97],
        [23.811, 0.017939, 426.77],
    ];

    #[test]
    fn fibre_peaks_of_all_columns() {
        let curvatures = FibreSection::curvatures_to(0.4);
        let mut mean = 0.0;
        for (s, [strength, ultimate, moment]) in SPECIMENS.iter().zip(OTHER) {
            let mut input = s.section();
            assert_eq!(input.bars.len(), s.bars.0, "{}", s.name);
            let c = Confinement::of(&input).unwrap();
            let ratios = [c.strength_pa / 1e6 / strength, c.ultimate_strain / ultimate];
            let close = if s.legs > 2.0 { 1e-4 } else { 5e-2 };
            assert!(ratios.iter().all(|r| (r - 1.0).abs() < close), "{}: {ratios:?}", s.name);
            input.options = FibreOptions { deduct_bars: true, history: false };
            let section = FibreSection::of(&input, ConcreteLaw::Mander);
            let upward = std::f64::consts::FRAC_PI_2;
            let points = section.moment_curvature(s.axial_force_n(), upward, &curvatures);
            let peak = points.iter().map(|p| p.moment_nm).fold(0.0, f64::max);
            assert!((peak / 1e3 / moment - 1.0).abs() < 0.02, "{}: {peak} for {moment}", s.name);
            let measured = 0.5 * (s.peak_moment_nm[0] + s.peak_moment_nm[1]);
            mean += measured / peak / SPECIMENS.len() as f64;
        }
        // the tests are some 8 % stronger than plane sections
        assert!((mean - 1.08).abs() < 0.02, "{mean}");
    }
}
