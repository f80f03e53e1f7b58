//! Which line of a deck keeps its model from being run: the values that are good by themselves, and not with the elements.

use super::error::{At, DeckErrors};
use super::raw::Raw;
use super::read::Ids;
use crate::base::diagnostic::Diagnostic;
use crate::base::source::Source;
use crate::fe::mass_scaling::MassScalingError;
use crate::fe::model_run::ModelError;
use crate::fe::run::FeError;
use std::sync::Arc;

/// Where in the files of a deck those values stand.
#[derive(Debug, Clone, Default)]
pub struct Places {
    files: Vec<Arc<Source>>,
    end_time: Option<At>,
    mass_scaling: Option<At>,
    /// The material of each part.
    materials: Vec<Option<At>>,
    step_safety: Option<f64>,
}

impl Places {
    pub(super) fn of(files: Vec<Arc<Source>>, raw: &Raw) -> Self {
        Self {
            files,
            end_time: raw.end_time_at,
            mass_scaling: raw.mass_scaling_at,
            materials: raw.parts.iter().map(|p| Some(raw.materials.get(&p.material)?.1)).collect(),
            step_safety: raw.step_safety,
        }
    }

    /// The message about the line that is to blame for an error; `None` if it is none of the deck's. `own_end`: the end time is that of the deck.
    pub fn blame(&self, error: &ModelError, own_end: bool) -> Option<DeckErrors> {
        let (code, at) = match error {
            ModelError::MassScaling(_) => ("mass-scaling", self.mass_scaling),
            ModelError::TooLong { .. } | ModelError::TooShort { .. } if own_end => {
                ("end-time", self.end_time)
            }
            ModelError::NoStep { part, .. } => ("time-step", self.materials.get(*part).copied().flatten()),
            _ => return None,
        };
        let at = at?;
        let text = error.to_string();
        let (message, help) = match error {
            ModelError::MassScaling(_) => (&text[..], ""),
            _ => text.split_once("; ").unwrap_or((&text, "")),
        };
        let mut item = Diagnostic::error(code, message).at((at.start..at.end).into(), "");
        match error {
            ModelError::MassScaling(MassScalingError::TooMuch { limit, allowed_s, .. }) => {
                let least =
                    rounded_down(allowed_s / self.step_safety.unwrap_or(crate::fe::dynamics::STEP_SAFETY));
                item = item.help(format!(
                    "DT2MS = -{least:e} adds no more than {limit:.0} %; without it no mass is added"
                ));
            }
            _ => item = item.help(help),
        }
        Some(DeckErrors::one(self.files.get(at.file)?.clone(), item))
    }
}

impl Ids {
    /// Why a run stopped, with the identifiers of the deck and remedies that a deck has; `None` if it says what is wrong as it is.
    pub fn words(&self, error: &FeError) -> Option<String> {
        match error {
            FeError::Unsound(diagnosis) => {
                Some(diagnosis.by_ids(&self.nodes, &self.elements, &self.trusses).to_string())
            }
            FeError::Contact { .. } => {
                let text = error.to_string();
                let what = text.split_once("; try ").map_or(&text[..], |(what, _)| what);
                Some(format!("{what}; try smaller elements there, or take the *CONTACT out of the deck"))
            }
            _ => None,
        }
    }
}

/// The number with three digits that is not above a positive one.
fn rounded_down(value: f64) -> f64 {
    let digits = format!("{value:.2e}").parse::<f64>().unwrap_or(value);
    if digits <= value { digits } else { format!("{:.2e}", 0.995 * value).parse().unwrap_or(value) }
}

#[cfg(test)]
mod tests {
    use super::rounded_down;

    #[test]
    fn three_digits_that_are_not_above() {
        for (value, expected) in [(1.2345e-5, 1.23e-5), (1.2399e-5, 1.23e-5), (9.999, 9.95), (2.0, 2.0)] {
            let got = rounded_down(value);
            assert!((got - expected).abs() < 0.006 * expected && got <= value, "{value}: {got}");
        }
    }
}
