//! What `explain` tells of library entries.

use super::compose::entry_words;
use crate::library::Entry;
use crate::library::entry::{Quality, Validity};
use serde::{Deserialize, Serialize};

/// What is to be known of a library entry without its curves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EntryFacts {
    /// What it describes.
    pub words: String,
    /// How good the computation was.
    pub quality: Quality,
    /// Where it holds.
    pub validity: Validity,
    /// Largest moment of any axial force, about each of its bending axes \[N m\].
    pub peak_moment_nm: Vec<f64>,
    /// Hash of what it was computed from.
    pub inputs_hash: String,
    /// Version of the program that computed it.
    pub program_version: String,
    /// Test or program that its curves are of, and who has published them; none if this program computed them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Why it is no longer to be used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deprecated: Option<String>,
    /// Where its curves come from, if they were made without a run: what else is told is then that of their source.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub made: Option<String>,
}

impl EntryFacts {
    /// Of an entry; `made`: where its curves come from, if they were made without a run.
    pub fn of(entry: &Entry, made: Option<&String>) -> Self {
        let inputs = &entry.provenance.inputs;
        Self {
            made: made.cloned(),
            source: inputs
                .source
                .as_ref()
                .map(|s| format!("{}: {}, by {}", entry.origin.words(), s.citation, s.by)),
            deprecated: entry.deprecated.as_ref().map(|why| why.reason.clone()),
            words: entry_words(entry),
            quality: entry.quality.clone(),
            validity: entry.validity,
            peak_moment_nm: entry.axes.iter().map(|axis| axis.curve.peak_nm()).collect(),
            inputs_hash: entry.provenance.inputs_hash.clone(),
            program_version: entry.provenance.program_version.clone(),
        }
    }
}

/// An entry in the lines of an explanation.
pub fn text(f: &EntryFacts) -> String {
    let peaks: Vec<String> = f.peak_moment_nm.iter().map(|m| format!("{:.1}", m / 1e3)).collect();
    let mut quality: Vec<String> = Vec::new();
    quality.extend(f.quality.elements.map(|n| format!("{n} elements")));
    quality.extend(f.quality.kinetic_energy_ratio.map(|x| format!("kinetic over internal energy {x:.3}")));
    quality.extend(f.quality.asymmetry.map(|x| format!("difference between the senses of rotation {x:.3}")));
    quality.extend(f.quality.mesh_sensitivity.map(|x| format!("sensitivity to the mesh {x:.3}")));
    if quality.is_empty() {
        quality.push("not stated".to_string());
    }
    let made = match (&f.made, &f.source) {
        (None, Some(source)) => format!("from a {source}; added by version {}", f.program_version),
        (Some(made), _) => {
            format!("no entry of its own: curves {made}, computed by version {}", f.program_version)
        }
        (None, None) => format!(
            "computed by version {} from inputs {}",
            f.program_version,
            f.inputs_hash.get(..16).unwrap_or(&f.inputs_hash)
        ),
    };
    let deprecated = f.deprecated.as_ref().map_or(String::new(), |why| format!("    deprecated: {why}\n"));
    format!(
        "{deprecated}    {}\n    peak moment {} kN m; axial force {:.0} to {:.0} kN, rotation up to {:.3} rad\n    \
         quality: {}\n    {made}\n",
        f.words,
        peaks.join(" and "),
        f.validity.axial_force_n[0] / 1e3,
        f.validity.axial_force_n[1] / 1e3,
        f.validity.rotation_rad.map_or(0.0, |range| range[1]),
        quality.join(", "),
    )
}
