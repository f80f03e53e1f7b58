//! Element forms under test: what each is compared with, and what it may miss that by.

use crate::fe::law::{ElementForm, Hourglass, Law};

/// A form with the references of the cases that depend on it.
///
/// The fully integrated form and the viscous control have counterparts in OpenRadioss, with results on the same meshes. The others are
/// compared with the limit of fine meshes, and their tolerances say how far two or four elements of them across a section are from it.
#[derive(Debug, Clone, Copy)]
pub struct TestedForm {
    /// Name on the command line and in the names of cases.
    pub name: &'static str,
    /// The form.
    pub form: ElementForm,
    /// Elastic cantilever, 20 and 40 or more elements long.
    pub elastic: [Swing; 2],
    /// Plastic cantilever, 20 and 40 or more elements long.
    pub plastic: [Tip; 2],
    /// Taylor's bar of 1152 and of 9216 elements.
    pub taylor: [Taylor; 2],
    /// Tolerance on the observed order of a static deflection; `None`: the static solve has no stiffness against hourglass modes.
    pub order: Option<f64>,
}

/// The elastic cantilever under sudden gravity.
#[derive(Debug, Clone, Copy)]
pub struct Swing {
    /// First peak of the tip \[mm\].
    pub peak_mm: f64,
    /// Its time \[s\].
    pub peak_s: f64,
    /// Time at which the tip is back \[s\].
    pub back_s: f64,
    /// Tip at 0.1, 0.3 and 0.5 s \[mm\]; `None`: not compared, since a form that is too soft or too stiff is late or early.
    pub tip_mm: Option<[f64; 3]>,
    /// Relative tolerance of displacements.
    pub tolerance: f64,
    /// Where it comes from.
    pub source: &'static str,
}

/// The tip of the plastic cantilever at 0.5 s.
#[derive(Debug, Clone, Copy)]
pub struct Tip {
    /// Displacement \[mm\].
    pub mm: f64,
    /// Relative tolerance.
    pub tolerance: f64,
    /// Where it comes from.
    pub source: &'static str,
}

/// Taylor's bar; each value with its tolerance.
#[derive(Debug, Clone, Copy)]
pub struct Taylor {
    /// Final length \[mm\], relative.
    pub length_mm: [f64; 2],
    /// Foot radius \[mm\], relative.
    pub foot_mm: [f64; 2],
    /// Largest plastic strain, absolute.
    pub strain: [f64; 2],
    /// Where the last two come from.
    pub source: &'static str,
}

const LIMIT: &str = "mesh limit of OpenRadioss (80x8x8, HEPH)";
const PLASTIC_LIMIT: &str = "mesh limit of OpenRadioss, 655 to 665 mm";
const SAME_FULL: &str = "OpenRadioss (Isolid 17, eight points), same mesh";
const SAME_VISCOUS: &str = "OpenRadioss (Isolid 1, viscous control), same mesh";
const HEPH: &str = "OpenRadioss (HEPH, Icpre 2); published codes 6.9 to 7.2 mm, 2.5 to 3.2";

/// The limit of fine meshes.
const fn limit(tolerance: f64) -> Swing {
    let tip_mm = Some([-23.929, -18.539, -9.881]);
    Swing { peak_mm: -24.995, peak_s: 0.08952, back_s: 0.18053, tip_mm, tolerance, source: LIMIT }
}

/// The limit of fine meshes for a form that vibrates at another frequency on a coarse one.
const fn limit_of_peak(tolerance: f64) -> Swing {
    Swing { tip_mm: None, ..limit(tolerance) }
}

const fn plastic_limit(tolerance: f64) -> Tip {
    Tip { mm: -660.0, tolerance, source: PLASTIC_LIMIT }
}

/// Taylor's bar against the one-point form with physical stabilisation of OpenRadioss.
const fn taylor(strain: f64, [length, foot, band]: [f64; 3]) -> Taylor {
    Taylor { length_mm: [21.5, length], foot_mm: [7.16, foot], strain: [strain, band], source: HEPH }
}

const TAYLOR: [Taylor; 2] = [taylor(2.68, [0.01, 0.03, 0.35]), taylor(3.10, [0.01, 0.03, 0.35])];

const fn tested(name: &'static str, hourglass: Hourglass) -> TestedForm {
    TestedForm {
        name,
        form: ElementForm::OnePoint(hourglass),
        elastic: [limit(0.005); 2],
        plastic: [plastic_limit(0.12), plastic_limit(0.03)],
        taylor: TAYLOR,
        order: Some(0.25),
    }
}

/// The forms that the solver has.
pub const FORMS: &[TestedForm] = &[
    tested("asqbi", Hourglass::Asqbi),
    TestedForm { elastic: [limit_of_peak(0.12), limit_of_peak(0.03)], ..tested("ads", Hourglass::Ads) },
    TestedForm { elastic: [limit_of_peak(0.02), limit_of_peak(0.01)], ..tested("asmd", Hourglass::Asmd) },
    TestedForm {
        elastic: [limit_of_peak(0.3), limit_of_peak(0.08)],
        // n layers that bear no bending of their own yield 1 / (1 - 1/n²), whose observed order from 2, 4 and 8 is 2.39
        order: Some(0.4),
        ..tested("fb-stiffness", Hourglass::Stiffness { coefficient: 0.05 })
    },
    TestedForm {
        elastic: [
            Swing {
                peak_mm: -33.244,
                peak_s: 0.10362,
                back_s: 0.20852,
                tip_mm: Some([-33.117, -31.915, -29.852]),
                tolerance: 0.005,
                source: SAME_VISCOUS,
            },
            Swing {
                peak_mm: -26.661,
                peak_s: 0.09246,
                back_s: 0.18645,
                tip_mm: None,
                tolerance: 0.005,
                source: "mesh limit, softer by 1 / (1 - 1/n²): four layers of constant stress",
            },
        ],
        plastic: [
            Tip { mm: -725.7, tolerance: 0.02, source: SAME_VISCOUS },
            Tip { mm: -678.9, tolerance: 0.02, source: SAME_VISCOUS },
        ],
        taylor: [
            Taylor {
                length_mm: [21.64, 0.01],
                foot_mm: [6.76, 0.03],
                strain: [2.34, 0.35],
                source: SAME_VISCOUS,
            },
            Taylor {
                length_mm: [21.50, 0.01],
                foot_mm: [7.06, 0.03],
                strain: [3.01, 0.35],
                source: SAME_VISCOUS,
            },
        ],
        order: None,
        ..tested("fb-viscous", Hourglass::Viscous { coefficient: 0.1 })
    },
    TestedForm {
        form: ElementForm::FullyIntegrated,
        elastic: [
            Swing {
                peak_mm: -24.581,
                peak_s: 0.08908,
                back_s: 0.17910,
                tip_mm: Some([-23.386, -17.380, -8.402]),
                tolerance: 0.005,
                source: SAME_FULL,
            },
            limit_of_peak(0.01),
        ],
        plastic: [
            Tip { mm: -586.5, tolerance: 0.01, source: SAME_FULL },
            Tip { mm: -634.6, tolerance: 0.01, source: SAME_FULL },
        ],
        taylor: [
            Taylor {
                length_mm: [21.51, 0.01],
                foot_mm: [7.03, 0.03],
                strain: [2.51, 0.35],
                source: SAME_FULL,
            },
            taylor(3.10, [0.01, 0.03, 0.35]),
        ],
        ..tested("full", Hourglass::Asqbi)
    },
];

impl TestedForm {
    /// A law with this form.
    pub fn law(&self, law: Law) -> Law {
        Law { form: self.form, ..law }
    }
}

/// The form with this name.
///
/// # Errors
/// If there is none.
pub fn form(name: &str) -> Result<TestedForm, String> {
    let names: Vec<&str> = FORMS.iter().map(|f| f.name).collect();
    let found = FORMS.iter().find(|f| f.name == name).copied();
    found.ok_or_else(|| format!("no element form `{name}`; there are: {}", names.join(", ")))
}
