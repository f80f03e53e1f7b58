//! One figure of a case and its judgement.

use serde::Serialize;

/// How far a figure may lie from its reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Share of the reference's size.
    Relative(f64),
    /// In the figure's own unit: for references that are zero, and for published bands.
    Absolute(f64),
}

impl Tolerance {
    /// Whether `ours` is near enough to `reference`; never if either is not a number.
    pub fn holds(self, reference: f64, ours: f64) -> bool {
        let difference = (ours - reference).abs();
        match self {
            Self::Relative(share) => difference <= share * reference.abs(),
            Self::Absolute(band) => difference <= band,
        }
    }
}

/// A computed figure beside its reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Case it belongs to; filled when the case runs.
    pub case: String,
    /// What it is.
    pub quantity: String,
    /// Unit, `-` for pure numbers.
    pub unit: &'static str,
    /// What it should be.
    pub reference: f64,
    /// What it is.
    pub ours: f64,
    /// How far off it may be.
    pub tolerance: Tolerance,
    /// Where the reference comes from.
    pub source: &'static str,
}

impl Figure {
    /// A figure with a tolerance relative to the reference. `values` are `[reference, ours]`.
    pub fn relative(
        quantity: impl Into<String>,
        unit: &'static str,
        values: [f64; 2],
        tolerance: f64,
        source: &'static str,
    ) -> Self {
        Self::new(quantity.into(), unit, values, Tolerance::Relative(tolerance), source)
    }

    /// A figure with a tolerance in its own unit. `values` are `[reference, ours]`.
    pub fn absolute(
        quantity: impl Into<String>,
        unit: &'static str,
        values: [f64; 2],
        tolerance: f64,
        source: &'static str,
    ) -> Self {
        Self::new(quantity.into(), unit, values, Tolerance::Absolute(tolerance), source)
    }

    fn new(
        quantity: String,
        unit: &'static str,
        [reference, ours]: [f64; 2],
        tolerance: Tolerance,
        source: &'static str,
    ) -> Self {
        Self { case: String::new(), quantity, unit, reference, ours, tolerance, source }
    }

    /// Whether it lies within its tolerance.
    pub fn passes(&self) -> bool {
        self.tolerance.holds(self.reference, self.ours)
    }
}

/// The figure as it stands in JSON.
#[derive(Serialize)]
struct Row<'a> {
    case: &'a str,
    quantity: &'a str,
    unit: &'a str,
    reference: f64,
    ours: Option<f64>,
    tolerance: f64,
    tolerance_kind: &'a str,
    pass: bool,
    source: &'a str,
}

impl Serialize for Figure {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (tolerance, tolerance_kind) = match self.tolerance {
            Tolerance::Relative(share) => (share, "relative"),
            Tolerance::Absolute(band) => (band, "absolute"),
        };
        let row = Row {
            case: &self.case,
            quantity: &self.quantity,
            unit: self.unit,
            reference: self.reference,
            ours: self.ours.is_finite().then_some(self.ours),
            tolerance,
            tolerance_kind,
            pass: self.passes(),
            source: self.source,
        };
        row.serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_reference_fails() {
        let figure = |reference, ours| Figure::relative("peak", "mm", [reference, ours], 0.01, "beam theory");
        assert!(figure(-25.0, -24.8).passes());
        assert!(!figure(-24.0, -24.8).passes());
        assert!(!figure(25.0, -24.8).passes(), "the sign counts");
        assert!(!figure(0.0, 1e-9).passes(), "a relative tolerance of zero admits nothing");
        let zero = |ours| Figure::absolute("residual", "-", [0.0, ours], 1e-9, "exact");
        assert!(zero(-1e-9).passes() && !zero(2e-9).passes());
    }

    #[test]
    fn what_is_not_a_number_fails() {
        for ours in [f64::NAN, f64::INFINITY] {
            assert!(!Tolerance::Relative(1.0).holds(1.0, ours));
            assert!(!Tolerance::Absolute(1.0).holds(1.0, ours));
            assert!(!Tolerance::Absolute(1.0).holds(f64::NAN, 1.0));
            let figure = Figure::relative("x", "-", [1.0, ours], 0.1, "s");
            let json = serde_json::to_value(&figure).unwrap();
            assert!(json["ours"].is_null() && json["pass"] == false);
        }
    }
}
