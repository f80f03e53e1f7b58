//! Section files, grids of them, and sections of building ends.

use fallwerk::base::source::Source;
use fallwerk::building::EXAMPLE as BUILDING;
use fallwerk::material::rebar::Hardening;
use fallwerk::rc::RcSection;
use fallwerk::rc::section_file::{EXAMPLE, json_schema, read};
use fallwerk::rc::section_grid::SectionGrid;

fn read_text(text: &str) -> Result<RcSection, Vec<fallwerk::base::diagnostic::Diagnostic>> {
    read(&Source::new("section.toml", text))
}

#[test]
fn the_example_is_a_section_with_its_defaults() {
    let section = read_text(EXAMPLE).unwrap();
    assert_eq!((section.input.size_m, section.input.bars.len(), section.length_m), ([0.4, 0.4], 8, 1.5));
    // 8 bars of 20 mm over 400 x 400 mm
    let ratio = section.steel_m2() / section.input.area_m2();
    assert!((ratio - 8.0 * std::f64::consts::PI * 1e-4 / 0.16).abs() < 1e-15);
    assert!((section.axial_n(0.3) - 0.3 * 38e6 * 0.16).abs() < 1e-6);
    let ties = section.input.ties.unwrap();
    // edge distance 40 mm less half a bar and the tie itself
    assert!((ties.cover_m - 0.022).abs() < 1e-12 && ties.legs == [2.0; 2]);
    assert!((section.input.steel.buckling.unwrap().slenderness - 7.5).abs() < 1e-12);
    // straight from yield to the ultimate strength at the ultimate strain
    let steel = section.input.steel;
    assert!((steel.monotonic_pa(0.08) - 620e6).abs() < 1.0, "{}", steel.monotonic_pa(0.08));
    assert!(section.clone().without_buckling().input.steel.buckling.is_none());
    let schema = json_schema().to_string();
    for name in ["bars_around", "crushing_energy_j_m2", "hardening_strain", "all_bars_held"] {
        assert!(schema.contains(name), "{name}");
    }
}

#[test]
fn what_is_stated_takes_the_place_of_the_default() {
    let text = EXAMPLE
        .replace("# youngs_modulus = \"33 GPa\"", "youngs_modulus = \"31 GPa\"")
        .replace("# crushing_energy_j_m2 = 25000", "crushing_energy_j_m2 = 30000")
        .replace("# hardening_strain = 0.015", "hardening_strain = 0.015")
        .replace("# legs = [2, 2]", "legs = [3, 4]");
    let section = read_text(&text).unwrap();
    assert_eq!(section.concrete.youngs_modulus_pa, 31e9);
    assert_eq!(section.input.youngs_modulus_pa, 31e9);
    assert_eq!(section.concrete.crushing_energy_j_m2, 30e3);
    assert_eq!(section.input.ties.unwrap().legs, [3.0, 4.0]);
    assert!(
        matches!(section.input.steel.hardening, Hardening::Plateau { start_strain, .. } if start_strain == 0.015)
    );
}

#[test]
fn all_errors_come_at_once_with_place_value_and_remedy() {
    let text = EXAMPLE
        .replace("width = \"400 mm\"", "width = \"400 kN\"")
        .replace("strength = \"38 MPa\"", "strenght = \"38 MPa\"")
        .replace("ultimate_strength = \"620 MPa\"", "ultimate_strength = \"500 MPa\"")
        .replace("spacing = \"150 mm\"", "spacing = \"15 m\"");
    let found = read_text(&text).unwrap_err();
    let all: Vec<String> = found.iter().map(|d| format!("{d:?}")).collect();
    assert!(found.len() >= 4, "{all:#?}");
    assert!(found.iter().all(|d| d.place.is_some()), "{all:#?}");
    for part in ["strenght", "a force", "below the yield strength", "15 m"] {
        assert!(all.iter().any(|d| d.contains(part)), "{part}: {all:#?}");
    }
    let bars = "bars_around = { per_face = 3, diameter = \"20 mm\", edge_distance = \"40 mm\" }";
    assert!(EXAMPLE.contains(bars));
    let none = read_text(&EXAMPLE.replace(bars, "")).unwrap_err();
    assert_eq!(none[0].code, "no-bars");
    let outside = read_text(&EXAMPLE.replace(bars, "bars = [{ x = 0.3, y = 0, diameter = \"20 mm\" }]"));
    assert_eq!(outside.unwrap_err()[0].code, "bar-outside");
    let layer =
        "bar_layers = [{ face = \"bottom\", count = 3, diameter = \"20 mm\", edge_distance = \"40 mm\" }]";
    let one_line = read_text(&EXAMPLE.replace(bars, layer)).unwrap_err();
    assert_eq!((one_line.len(), one_line[0].code), (1, "ties-without-bars"));
    assert!(format!("{:?}", one_line[0]).contains("one line along the depth"), "{one_line:?}");
    let brittle = EXAMPLE.replace("# peak_strain = 0.002 ", "peak_strain = 0.0011 ");
    assert_eq!(read_text(&brittle).unwrap_err()[0].code, "bad-material");
}

#[test]
fn a_grid_is_every_combination_and_refuses_what_does_not_fit() {
    let base = read_text(EXAMPLE).unwrap();
    let grid = SectionGrid {
        widths_m: vec![0.3, 0.5],
        ratios: vec![0.01, 0.02],
        tie_spacings_m: vec![0.1],
        strengths_pa: vec![30e6],
        ..SectionGrid::default()
    };
    let all = grid.sections(&base).unwrap();
    assert_eq!(all.len(), 4);
    for section in &all {
        let [width, depth] = section.input.size_m;
        assert_eq!(width, depth);
        // bar centres stay 40 mm from the faces
        let reach = section.input.bars.iter().map(|b| b.x_m.abs()).fold(0.0, f64::max);
        assert!((0.5 * width - reach - 0.04).abs() < 1e-12);
        assert_eq!(section.input.ties.unwrap().spacing_m, 0.1);
        let thin = section.input.bars[0].diameter_m;
        assert!((section.input.steel.buckling.unwrap().slenderness - 0.1 / thin).abs() < 1e-9);
        // what the file does not state follows the strength
        let standard = fallwerk::material::concrete::ConcreteLaw::of_strength(30e6);
        assert_eq!(section.concrete, standard);
    }
    let ratios: Vec<f64> = all.iter().map(|s| s.steel_m2() / s.input.area_m2()).collect();
    for (found, wanted) in ratios.iter().zip([0.01, 0.02, 0.01, 0.02]) {
        assert!((found - wanted).abs() < 1e-12);
    }
    let thick = SectionGrid { ratios: vec![0.09], ..SectionGrid::default() };
    assert!(thick.sections(&base).unwrap_err().contains("the cover of the ties is 8 mm"));
}

#[test]
fn bars_of_each_side_keep_their_distance_and_their_cover() {
    // 40 mm from the bottom, 60 mm from the top
    let mut base = read_text(EXAMPLE).unwrap();
    base.input.bars.iter_mut().filter(|b| b.y_m > 0.1).for_each(|b| b.y_m -= 0.02);
    let deeper = SectionGrid { depths_m: vec![0.5], ..SectionGrid::default() };
    let made = deeper.sections(&base).unwrap().remove(0);
    let ends = made.input.bars.iter().fold([0.0f64; 2], |e, b| [e[0].min(b.y_m), e[1].max(b.y_m)]);
    assert!((ends[0] + 0.21).abs() < 1e-12 && (ends[1] - 0.19).abs() < 1e-12, "{ends:?}");
    // 9 % in eight bars are 47.9 mm each: 1 mm of cover 25 mm from the faces
    let mut bare = read_text(EXAMPLE).unwrap();
    bare.input.ties = None;
    bare.input.bars.iter_mut().for_each(|b| (b.x_m, b.y_m) = (b.x_m * 0.175 / 0.16, b.y_m * 0.175 / 0.16));
    let thick = SectionGrid { ratios: vec![0.09], ..SectionGrid::default() };
    assert!(thick.sections(&bare).unwrap_err().contains("the cover of the bars is 1 mm"));
}

#[test]
fn a_building_gives_section_and_half_the_clear_height() {
    let building =
        fallwerk::building::parse(BUILDING, fallwerk::base::tree::Format::Toml, "reference").unwrap();
    let section = RcSection::of_column_end(&building, "C1-A1.bottom").unwrap();
    let partition = fallwerk::building::partition::Partition::of(&building);
    let ends = fallwerk::building::ends::member_ends(&building, &partition);
    let end = ends.iter().find(|e| e.id == "C1-A1.bottom").unwrap();
    assert_eq!(section.length_m, 0.5 * end.clear_m);
    assert_eq!(section.input.size_m, [0.4, 0.4]);
    assert!(section.input.steel.buckling.is_some());
    let wrong = RcSection::of_column_end(&building, "C1-A1.botom").unwrap_err();
    assert!(wrong.contains("did you mean `C1-A1.bottom`?"), "{wrong}");
}
