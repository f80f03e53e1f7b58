//! Keys: a readable path and the hash of what the entry was computed from.
//!
//! `column_hinge/400x400-l1625-bottom-ground-m100@0123456789abcdef`: kind, section width and depth,
//! length to the point of zero moment, end, what adjoins, mesh size (all in mm), hash. The key is
//! the path of the record below the library folder, without `.json`.

use super::entry::{Adjoining, ColumnEnd, EntryKind, Features};
use crate::base::hash::ContentHash;

/// The key of an entry whose inputs have this hash.
pub fn key_of(kind: EntryKind, features: &Features, inputs: &ContentHash) -> String {
    let mm = |length_m: f64| (length_m * 1000.0).round() as i64;
    format!(
        "{}/{}x{}-l{}-{}-{}-m{}@{}",
        kind.name(),
        mm(features.width_m),
        mm(features.depth_m),
        mm(features.length_to_inflection_m),
        end_name(features.end),
        adjoining_name(features.adjoining),
        mm(features.mesh_size_m),
        inputs.short()
    )
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

pub(super) fn end_name(end: ColumnEnd) -> &'static str {
    match end {
        ColumnEnd::Top => "top",
        ColumnEnd::Bottom => "bottom",
    }
}

pub(super) fn adjoining_name(adjoining: Adjoining) -> &'static str {
    match adjoining {
        Adjoining::Slab => "slab",
        Adjoining::Beam => "beam",
        Adjoining::Ground => "ground",
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
