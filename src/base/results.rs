//! What a result folder holds, told by its files, and what may replace it.

use std::fmt;

/// The file of a comparison with FE.
pub const VALIDATION_FILE: &str = "validation.json";

/// Results that commands write into a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Results {
    /// Of `generate-mbs --validate`.
    Validation,
    /// Of `generate-mbs`.
    Model,
    /// Of `fe` with a building.
    Fe,
    /// Of `fe` with a deck.
    Deck,
    /// Of `simulate`.
    Simulation,
    /// Of `rc`.
    Section,
    /// Of `verify mbs --models`.
    Cases,
}

/// Files that only one kind of results has; a name that begins with a dot is an ending. A validation has the files of a model as well, and comes first.
const FILES: [(&str, Results); 8] = [
    (VALIDATION_FILE, Results::Validation),
    ("trace.json", Results::Model),
    ("fe-displacements.csv", Results::Fe),
    ("histories.csv", Results::Deck),
    ("hinges.csv", Results::Simulation),
    ("curves.csv", Results::Section),
    ("history.csv", Results::Section),
    (".path.csv", Results::Cases),
];

impl Results {
    /// The results in a folder that holds files of these names; `None`: none that are known.
    pub fn among(names: &[String]) -> Option<Self> {
        let is_it = |name: &str, file: &str| name == file || file.starts_with('.') && name.ends_with(file);
        let found = FILES.iter().find(|(file, _)| names.iter().any(|name| is_it(name, file)));
        found.map(|(_, results)| *results)
    }

    /// Whether these may take the place of others without a question: of those of the same kind, and a validation of the model alone, which it has as well.
    pub fn may_replace(self, others: Self) -> bool {
        self == others || (self, others) == (Self::Validation, Self::Model)
    }
}

impl fmt::Display for Results {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Validation => "the results of a run with --validate",
            Self::Model => "the results of generate-mbs",
            Self::Fe => "the results of fe",
            Self::Deck => "the results of fe with a deck",
            Self::Simulation => "the results of simulate",
            Self::Section => "the results of rc",
            Self::Cases => "the models of verify mbs",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_known_by_their_files() {
        let of = |names: &[&str]| Results::among(&names.iter().map(ToString::to_string).collect::<Vec<_>>());
        assert_eq!(of(&["mbs-hinges.csv", "trace.json", "validation.json"]), Some(Results::Validation));
        assert_eq!(of(&["mbs-hinges.csv", "trace.json"]), Some(Results::Model));
        assert_eq!(of(&["fe-displacements.csv", "fe.json"]), Some(Results::Fe));
        assert_eq!(of(&["fe.json", "histories.csv"]), Some(Results::Deck));
        assert_eq!(of(&["hinges.csv", "result.json"]), Some(Results::Simulation));
        assert_eq!(of(&["curves.csv", "result.json"]), Some(Results::Section));
        assert_eq!(of(&["history.csv", "result.json"]), Some(Results::Section));
        assert_eq!(of(&["A01.json", "A01.path.csv"]), Some(Results::Cases));
        assert_eq!(of(&["c.txt"]), None);
        assert!(Results::Validation.may_replace(Results::Model));
        assert!(!Results::Model.may_replace(Results::Validation));
    }
}
