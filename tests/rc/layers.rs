//! Section of the mesh without a run, against the submodel of column ends that stands in the library.

use fallwerk::base::tree::Format;
use fallwerk::building::{EXAMPLE, parse};
use fallwerk::curve::CapacityLevel;
use fallwerk::rc::layers::{Layer, Layers};
use std::path::Path;

/// Two elements across a column of 400 mm, against pushes of the piece of mesh around its ends.
#[test]
fn two_layers_bear_what_column_ends_bear() {
    let building = parse(EXAMPLE, Format::Toml, "example.toml").unwrap();
    let column = building.members.iter().find(|m| m.id == "C1-A1").unwrap();
    let law = building.law_of(column);
    let half = |at_m: f64| Layer { area_m2: 0.08, at_m, depth_m: 0.2, strength: 1.0, law };
    let section = Layers::of(vec![half(-0.1), half(0.1)]).unwrap();
    let row_m = 0.43;
    let curve = section.curve(row_m, 1e7);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("library/column_hinge");
    // the moments of the submodel are those at the end, half a row from the middle of the row that yields
    let ends = [
        (1.286, "l1286-bottom-ground-m400@dc3a09f4c564b7b6"),
        (1.714, "l1714-top-beam-m400@2b79a3a23da00716"),
    ];
    for (length_m, name) in ends {
        let text = std::fs::read_to_string(root.join(format!("400x400-{name}.json"))).unwrap();
        let record: serde_json::Value = serde_json::from_str(&text).unwrap();
        let levels: Vec<CapacityLevel> =
            serde_json::from_value(record["axes"][0]["curve"]["levels"].clone()).unwrap();
        for level in levels.iter().filter(|l| l.axial_force_n >= 0.0) {
            let share = level.axial_force_n / section.squash_n;
            let near = |w: &&[CapacityLevel]| {
                w[0].axial_force_n <= level.axial_force_n && level.axial_force_n < w[1].axial_force_n
            };
            let pair = curve.levels.windows(2).find(near).unwrap();
            let weight = (level.axial_force_n - pair[0].axial_force_n)
                / (pair[1].axial_force_n - pair[0].axial_force_n);
            let peak = pair[0].peak_nm() + weight * (pair[1].peak_nm() - pair[0].peak_nm());
            let ratio = peak * length_m / (length_m - 0.5 * row_m) / level.peak_nm();
            println!(
                "{name} n = {share:.2}: {:.1} kN m, submodel {:.1}, {ratio:.3}",
                peak / 1e3,
                level.peak_nm() / 1e3
            );
            assert!((ratio - 1.0).abs() < 0.08, "{name}, n = {share:.2}: {ratio:.3}");
        }
    }
}
