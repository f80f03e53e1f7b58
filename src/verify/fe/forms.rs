//! Element forms under test, with what each may miss the references by.

use crate::fe::law::{ElementForm, Hourglass, Law};

/// A form and the tolerances it is held to. They differ because the forms do: a viscous hourglass control lets a section two
/// elements deep bend by a third too much.
#[derive(Debug, Clone, Copy)]
pub struct TestedForm {
    /// Name on the command line and in the names of cases.
    pub name: &'static str,
    /// The form.
    pub form: ElementForm,
    /// Elastic cantilever, 20 and 40 or more elements long: relative error of displacements.
    pub elastic: [f64; 2],
    /// Plastic cantilever, 20 and 40 or more elements long: relative error of the tip.
    pub plastic: [f64; 2],
    /// Taylor's bar: relative error of length, foot radius; absolute one of the largest plastic strain.
    pub taylor: [f64; 3],
}

/// The forms that the solver has.
pub const FORMS: &[TestedForm] = &[TestedForm {
    name: "asqbi",
    form: ElementForm::OnePoint(Hourglass::Asqbi),
    elastic: [0.005, 0.005],
    plastic: [0.12, 0.03],
    taylor: [0.01, 0.03, 0.35],
}];

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
