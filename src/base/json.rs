//! Reading JSON into values: what does not fit is told with its path in the file, beside line and column.

use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fmt;

/// Why a text is no value of a kind.
#[derive(Debug)]
pub struct JsonError {
    /// Path such as `bodies[3].mass_kg`; empty where the text is no JSON, or for the whole of it.
    pub path: String,
    /// The cause, with line and column where there is a text.
    pub source: serde_json::Error,
}

impl fmt::Display for JsonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.path.is_empty() {
            true => self.source.fmt(f),
            false => write!(f, "{}: {}", self.path, self.source),
        }
    }
}

impl std::error::Error for JsonError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}

/// Reads a text.
///
/// # Errors
/// If it is no JSON, or a value in it does not fit.
pub fn from_text<T: DeserializeOwned>(text: &str) -> Result<T, JsonError> {
    // paths cost time, and large files are mostly sound
    serde_json::from_str(text).map_err(|source| {
        let mut reader = serde_json::Deserializer::from_str(text);
        placed(source, serde_path_to_error::deserialize::<_, T>(&mut reader).err())
    })
}

/// The same for JSON already read.
///
/// # Errors
/// If a value in it does not fit.
pub fn from_value<T: DeserializeOwned>(value: Value) -> Result<T, JsonError> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let path = words(error.path());
        JsonError { path, source: error.into_inner() }
    })
}

fn placed(
    source: serde_json::Error,
    again: Option<serde_path_to_error::Error<serde_json::Error>>,
) -> JsonError {
    let path = again.filter(|_| source.is_data()).map(|e| words(e.path())).unwrap_or_default();
    JsonError { path, source }
}

/// A path; empty for the whole.
fn words(path: &serde_path_to_error::Path) -> String {
    if path.iter().next().is_some() { path.to_string() } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Body {
        #[serde(rename = "mass_kg")]
        _mass_kg: f64,
    }

    #[derive(Debug, Deserialize)]
    struct Model {
        #[serde(rename = "bodies")]
        _bodies: Vec<Body>,
    }

    fn said(text: &str) -> String {
        let of_text = from_text::<Model>(text).unwrap_err().to_string();
        if let Ok(value) = serde_json::from_str(text) {
            let of_value = from_value::<Model>(value).unwrap_err().to_string();
            assert!(of_text.starts_with(&of_value), "{of_text}: {of_value}");
        }
        of_text
    }

    #[test]
    fn what_does_not_fit_is_told_with_its_path() {
        for (text, expected) in [
            (
                r#"{"bodies": [{"mass_kg": 1}, {"mass_kg": "2"}]}"#,
                "bodies[1].mass_kg: invalid type: string \"2\", expected f64 at line 1 column 43",
            ),
            (
                r#"{"bodies": [{"mas_kg": 1}]}"#,
                "bodies[0].mas_kg: unknown field `mas_kg`, expected `mass_kg` at line 1 column 21",
            ),
            (r#"{"bodies": [{}]}"#, "bodies[0]: missing field `mass_kg` at line 1 column 14"),
            ("{}", "missing field `bodies` at line 1 column 2"),
            (r#"{"bodies": [}"#, "expected value at line 1 column 13"),
        ] {
            assert_eq!(said(text), expected);
        }
    }
}
