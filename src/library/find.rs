//! Which entry fits a wanted member end best.
//!
//! End and adjoining member must agree. The distance of the rest is
//! `sqrt( Σ_i (w_i ln(a_i / b_i))² )`: with the weights below it estimates the relative change of the
//! moment capacity `~ f b h²` and of the rotation capacity. It orders candidates and bounds what
//! may be used; it is no correction.

use super::entry::Features;
use super::key::{adjoining_name, end_name};

/// How a number is read from the features.
type Number = fn(&Features) -> f64;

/// Weights of the logarithmic ratios. A section depth enters the capacity about its own axis squared;
/// both depths are depths about one of the axes.
const WEIGHTS: [(&str, f64, Number); 8] = [
    ("width_m", 2.0, |f| f.width_m),
    ("depth_m", 2.0, |f| f.depth_m),
    ("length_to_inflection_m", 1.0, |f| f.length_to_inflection_m),
    ("law.yield_stress_pa", 1.0, |f| f.law.yield_stress_pa),
    ("law.peak_stress_pa", 1.0, |f| f.law.peak_stress_pa),
    ("law.critical_plastic_strain", 1.0, |f| f.law.critical_plastic_strain),
    ("law.youngs_modulus_pa", 0.5, |f| f.law.youngs_modulus_pa),
    ("mesh_size_m", 0.5, |f| f.mesh_size_m),
];

/// How far an entry is from what is wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Match {
    /// All features agree, the law to the last digit.
    pub exact: bool,
    /// Distance as above; zero for an exact match, infinite if end or adjoining member differ.
    pub distance: f64,
    /// What differs, largest share first; "exact match" if nothing.
    pub reason: String,
}

/// Compares an entry's features with those wanted.
pub fn compare(entry: &Features, wanted: &Features) -> Match {
    if entry.end != wanted.end || entry.adjoining != wanted.adjoining {
        let reason = format!(
            "{} end at a {} instead of {} end at a {}",
            end_name(entry.end),
            adjoining_name(entry.adjoining),
            end_name(wanted.end),
            adjoining_name(wanted.adjoining)
        );
        return Match { exact: false, distance: f64::INFINITY, reason };
    }
    let mut parts: Vec<(f64, String)> = WEIGHTS
        .iter()
        .map(|(name, weight, value)| {
            (weight * log_ratio(value(entry), value(wanted)), difference(name, value(entry), value(wanted)))
        })
        .collect();
    let names: std::collections::BTreeSet<&String> =
        entry.further.keys().chain(wanted.further.keys()).collect();
    for name in names {
        parts.push(match (entry.further.get(name), wanted.further.get(name)) {
            (Some(a), Some(b)) => (log_ratio(*a, *b), difference(name, *a, *b)),
            _ => (f64::INFINITY, format!("`{name}` is known of one side only")),
        });
    }
    let distance = parts.iter().map(|(d, _)| d * d).sum::<f64>().sqrt();
    parts.retain(|(d, _)| *d != 0.0);
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let exact = parts.is_empty() && entry.law.hash == wanted.law.hash;
    let reason = if exact {
        "exact match".to_string()
    } else if parts.is_empty() {
        "same features, but the laws differ in other numbers".to_string()
    } else {
        parts.into_iter().map(|(_, words)| words).collect::<Vec<_>>().join("; ")
    };
    Match { exact, distance, reason }
}

/// `|ln(a / b)|`; numbers that differ only by rounding (10⁻⁹ relative) count as equal.
fn log_ratio(a: f64, b: f64) -> f64 {
    if (a - b).abs() <= 1e-9 * a.abs().max(b.abs()) {
        0.0
    } else if a / b > 0.0 {
        (a / b).ln().abs()
    } else {
        f64::INFINITY
    }
}

fn difference(name: &str, entry: f64, wanted: f64) -> String {
    format!("{name} is {entry} instead of {wanted}")
}
