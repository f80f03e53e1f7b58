//! Keys: a readable path and the hash of what the entry was made from.
//!
//! `column_hinge/400x400-l1625-bottom-ground-m100@0123456789abcdef`: kind, section width and depth,
//! length to the point of zero moment, end, what adjoins, mesh size (all in mm), hash. Reinforced concrete adds its strength
//! (`fc30`, MPa), the reinforcement ratio (`r157`, in hundredths of a percent) and the spacing of the ties (`s150`, mm).
//! What an entry does not state is left out. The key is the path of the record below the library folder, without `.json`.

use super::error::StoreError;
use super::features::{EntryKind, Features};
use crate::base::hash::ContentHash;

/// The key of an entry whose inputs have this hash.
pub fn key_of(kind: EntryKind, features: &Features, inputs: &ContentHash) -> String {
    let whole = |value: f64| value.round() as i64;
    let mm = |length_m: f64| whole(length_m * 1000.0);
    let rc = features.rc.as_ref();
    let parts = [
        Some(format!("{}x{}", mm(features.width_m), mm(features.depth_m))),
        features.length_to_inflection_m.map(|l| format!("l{}", mm(l))),
        features.end.map(|e| e.name().to_string()),
        features.adjoining.map(|a| a.name().to_string()),
        features.mesh_size_m.map(|m| format!("m{}", mm(m))),
        rc.and_then(|r| r.concrete_strength_pa).map(|f| format!("fc{}", whole(f / 1e6))),
        rc.and_then(|r| r.reinforcement_ratio).map(|r| format!("r{}", whole(r * 1e4))),
        rc.and_then(|r| r.tie_spacing_m).map(|s| format!("s{}", mm(s))),
    ];
    let name: Vec<String> = parts.into_iter().flatten().collect();
    format!("{}/{}@{}", kind.name(), name.join("-"), inputs.short())
}

/// Whether a text can be a key: one folder, one name, `@`, 16 hexadecimal digits. Nothing else may
/// become part of a path.
pub fn is_key(text: &str) -> bool {
    let plain = |s: &str| {
        !s.is_empty()
            && s.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_' || b == b'-')
    };
    let Some((path, hash)) = text.split_once('@') else { return false };
    let Some((folder, name)) = path.split_once('/') else { return false };
    plain(folder)
        && plain(name)
        && hash.len() == 16
        && hash.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

/// The one of these keys that is meant by a key, its name without the kind, its hash, or the beginning of any of these; `None` if none is.
///
/// # Errors
/// [`StoreError::NotFound`] if several are.
pub fn meant<'a>(
    keys: impl Iterator<Item = &'a String>,
    text: &str,
) -> Result<Option<&'a String>, StoreError> {
    let begins = |key: &&String| {
        let parts = [Some(key.as_str()), key.split('/').nth(1), key.split('@').nth(1)];
        !text.is_empty() && parts.into_iter().flatten().any(|part| part.starts_with(text))
    };
    let meant: Vec<&String> = keys.filter(begins).collect();
    match meant.as_slice() {
        [] => Ok(None),
        [one] => Ok(Some(*one)),
        several => match several.iter().find(|key| key.as_str() == text) {
            Some(whole) => Ok(Some(*whole)),
            None => Err(StoreError::NotFound {
                key: text.to_string(),
                hint: format!(
                    ": it could mean {} entries, for instance `{}` and `{}`",
                    several.len(),
                    several[0],
                    several[1]
                ),
            }),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::is_key;

    #[test]
    fn only_plain_keys_become_paths() {
        assert!(is_key("column_hinge/400x400-l1625-bottom-ground-m100@0123456789abcdef"));
        for bad in [
            "",
            "column_hinge/a@0123456789abcde",
            "../a@0123456789abcdef",
            "a/../b@0123456789abcdef",
            "/etc/passwd@0123456789abcdef",
            "a/b/c@0123456789abcdef",
            "a/b@0123456789ABCDEF",
            "a/b",
        ] {
            assert!(!is_key(bad), "{bad}");
        }
    }
}
