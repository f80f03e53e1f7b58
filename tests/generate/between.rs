//! Beams that meet columns between their ends: the FE model joins them, the multibody model has no joint there and says so.

use super::generated;
use fallwerk::base::tree::Format;
use fallwerk::building::{EXAMPLE, inspect};
use fallwerk::generate::GenerateError;

/// The reference building with a beam along x in the plane of its front columns, whose top is at 2.5 m.
fn with_beam(from_m: f64, to_m: f64) -> String {
    let beam = format!(
        "[[members]]\nid = \"BX\"\nkind = \"beam\"\nsection = \"beam\"\nfrom = [{from_m}, 0, 2.5]\nto = [{to_m}, 0, 2.5]\n\n"
    );
    EXAMPLE.replacen("[[supports]]", &format!("{beam}[[supports]]"), 1)
}

#[test]
fn a_beam_between_the_ends_of_columns_is_told_and_gets_no_model() {
    // through both columns, up to their axes, and from face to face
    for [from_m, to_m] in [[-0.2, 6.2], [0.0, 6.0], [0.2, 5.8]] {
        let inspection = inspect(&with_beam(from_m, to_m), Format::Toml, "a.toml");
        let told = inspection.diagnostics.render(false);
        assert_eq!((inspection.diagnostics.errors(), inspection.diagnostics.warnings()), (0, 2), "{told}");
        for words in [
            "warning[between-ends]: the beam `BX` meets the column `C1-A1` between its ends, at (0, 0, 2.5) m",
            "the beam `BX` meets the column `C1-B1` between its ends, at (6, 0, 2.5) m",
            "split `C1-B1` at z = 2.5 m",
        ] {
            assert!(told.contains(words), "{words}: {told}");
        }
        let error = generated(&inspection.building.unwrap()).unwrap_err();
        let words = error.to_string();
        assert!(matches!(error, GenerateError::Between(all) if all.len() == 2), "{words}");
        assert!(words.contains("at (0, 0, 2.5) m (and 1 more); split `C1-A1` at z = 2.5 m"), "{words}");
    }
}

/// Beside the columns it meets nothing of them.
#[test]
fn a_beam_that_touches_no_column_is_not_told() {
    let told = inspect(&with_beam(1.0, 5.0), Format::Toml, "a.toml").diagnostics.render(false);
    assert!(!told.contains("between-ends"), "{told}");
}
