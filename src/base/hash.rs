//! Canonical JSON text and content hashes.
//!
//! A value is hashed over its canonical form: JSON without white space, object keys sorted, numbers in
//! their shortest exact form. Two files that differ only in layout or in the order of their keys
//! therefore have the same hash; two that differ in the last bit of a number do not. (Reading numbers
//! back exactly needs the feature `float_roundtrip` of `serde_json`, set in `Cargo.toml`.)

use serde::Serialize;
use serde_json::Value;
use std::fmt;

/// A blake3 hash of 256 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContentHash([u8; 32]);

impl ContentHash {
    /// The hash of bytes.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(*blake3::hash(bytes).as_bytes())
    }

    /// The hash of a value's canonical JSON.
    ///
    /// # Errors
    /// If the value cannot be written as JSON (a map with keys that are not text).
    pub fn of_value<T: Serialize + ?Sized>(value: &T) -> Result<Self, serde_json::Error> {
        Ok(Self::of_bytes(canonical_json(value)?.as_bytes()))
    }

    /// The raw bytes.
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }

    /// The first 16 hexadecimal digits: enough to tell apart what one project ever computes
    /// (a collision among 10⁶ records has a chance below 10⁻⁷), short enough for a file name.
    pub fn short(&self) -> String {
        self.to_string()[..16].to_string()
    }
}

impl fmt::Display for ContentHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// The canonical JSON of a value: one line, keys sorted.
///
/// # Errors
/// If the value cannot be written as JSON.
pub fn canonical_json<T: Serialize + ?Sized>(value: &T) -> Result<String, serde_json::Error> {
    let mut value = serde_json::to_value(value)?;
    value.sort_all_objects();
    serde_json::to_string(&value)
}

/// The layout for JSON files that people read and that lie in version control: keys sorted, one
/// member of an object a line, and any array without objects in it (a vector, a list of points) on one line.
///
/// # Errors
/// If the value cannot be written as JSON.
pub fn readable_json<T: Serialize + ?Sized>(value: &T) -> Result<String, serde_json::Error> {
    let mut value = serde_json::to_value(value)?;
    value.sort_all_objects();
    let mut text = String::new();
    write_readable(&value, 0, &mut text)?;
    text.push('\n');
    Ok(text)
}

fn write_readable(value: &Value, depth: usize, text: &mut String) -> Result<(), serde_json::Error> {
    let line = |text: &mut String, depth: usize| {
        text.push('\n');
        text.extend(std::iter::repeat_n("  ", depth));
    };
    match value {
        Value::Object(members) if !members.is_empty() => {
            text.push('{');
            for (i, (name, member)) in members.iter().enumerate() {
                text.push_str(if i == 0 { "" } else { "," });
                line(text, depth + 1);
                text.push_str(&serde_json::to_string(name)?);
                text.push_str(": ");
                write_readable(member, depth + 1, text)?;
            }
            line(text, depth);
            text.push('}');
        }
        Value::Array(items) if items.iter().any(holds_object) => {
            text.push('[');
            for (i, item) in items.iter().enumerate() {
                text.push_str(if i == 0 { "" } else { "," });
                line(text, depth + 1);
                write_readable(item, depth + 1, text)?;
            }
            line(text, depth);
            text.push(']');
        }
        other => text.push_str(&serde_json::to_string(other)?),
    }
    Ok(())
}

fn holds_object(value: &Value) -> bool {
    match value {
        Value::Object(_) => true,
        Value::Array(items) => items.iter().any(holds_object),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn hash_ignores_layout_and_order_but_not_the_last_bit() {
        let a: Value = serde_json::from_str("{\"b\": [1.0, 2.5],\n \"a\": {\"y\": 1, \"x\": 2}}").unwrap();
        let b: Value = serde_json::from_str("{\"a\":{\"x\":2,\"y\":1},\"b\":[1.0,2.5]}").unwrap();
        assert_eq!(ContentHash::of_value(&a).unwrap(), ContentHash::of_value(&b).unwrap());
        let c = json!({"a": {"x": 2, "y": 1}, "b": [1.0, f64::from_bits(2.5f64.to_bits() + 1)]});
        assert_ne!(ContentHash::of_value(&a).unwrap(), ContentHash::of_value(&c).unwrap());
    }

    #[test]
    fn the_hash_is_blake3() {
        // Test vector of the blake3 reference: the empty input.
        assert_eq!(
            ContentHash::of_bytes(b"").to_string(),
            "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262"
        );
        assert_eq!(ContentHash::of_bytes(b"").short(), "af1349b9f5f9a1a6");
    }

    #[test]
    fn numbers_come_back_bit_for_bit() {
        // Values that a parser without exact rounding gets wrong by one unit in the last place.
        for bits in
            (0..20_000u64).map(|i| 0x3f00_0000_0000_0000 + i * 0x0000_1a2b_3c4d_5e6f % 0x0100_0000_0000_0000)
        {
            let number = f64::from_bits(bits);
            let back: f64 = serde_json::from_str(&serde_json::to_string(&number).unwrap()).unwrap();
            assert_eq!(number.to_bits(), back.to_bits());
        }
    }

    #[test]
    fn readable_layout_keeps_points_on_a_line() {
        let text = readable_json(&json!({"z": [[0.0, 1.0], [2.0, 3.0]], "a": [{"k": 1}], "e": {}})).unwrap();
        assert_eq!(
            text,
            "{\n  \"a\": [\n    {\n      \"k\": 1\n    }\n  ],\n  \"e\": {},\n  \"z\": [[0.0,1.0],[2.0,3.0]]\n}\n"
        );
    }
}
