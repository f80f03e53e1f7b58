//! The series of bends, the command, and the entries of the library, on a small coarse section.

use fallwerk::base::source::Source;
use fallwerk::building::ends::{End, member_ends};
use fallwerk::building::partition::Partition;
use fallwerk::fe::mesh::Mesh;
use fallwerk::library::derive::Wanted;
use fallwerk::library::rc::{RcDeriveError, RcDerived, RcWanted, Symmetry, no_strength, stopped_early};
use fallwerk::library::{Entry, Origin, Store};
use fallwerk::rc::bend::Ending;
use fallwerk::rc::section_file::read;
use fallwerk::rc::{RcSection, Series, SeriesOptions, series};
use std::process::Command;
use std::sync::OnceLock;

/// 200 mm, four bars, short.
pub const SMALL: &str = r#"
schema = 1
name = "small"
width = "200 mm"
depth = "200 mm"
length = "0.4 m"
bars_around = { per_face = 2, diameter = "14 mm", edge_distance = "35 mm" }
[concrete]
strength = "30 MPa"
[steel]
yield_strength = "500 MPa"
ultimate_strength = "600 MPa"
ultimate_strain = 0.08
[ties]
diameter = "8 mm"
spacing = "100 mm"
yield_strength = "500 MPa"
"#;

pub fn small() -> RcSection {
    read(&Source::new("small.toml", SMALL)).unwrap()
}

pub fn coarse(axial_shares: &[f64]) -> SeriesOptions {
    SeriesOptions {
        axial_shares: axial_shares.to_vec(),
        until_rad: 0.02,
        mesh_size_m: 0.1,
        ..SeriesOptions::default()
    }
}

fn runs() -> &'static Series {
    static RUNS: OnceLock<Series> = OnceLock::new();
    RUNS.get_or_init(|| series::run(&small(), &coarse(&[0.0, 0.2]), &|_, _| {}).unwrap())
}

#[test]
fn a_bend_is_near_its_fibre_section_and_the_number_of_threads_does_not_matter() {
    let both = runs();
    for case in &both.cases {
        let figures = case.figures.expect("there is a peak");
        let ratio = figures.peak_nm / case.fibre_peak_nm.unwrap();
        // two elements over the depth: coarse, but the same section
        assert!((0.6..1.6).contains(&ratio), "n = {}: {ratio:.3}", case.axial_share);
        let bent = case.bent.as_ref().unwrap();
        assert!(
            figures.yield_rotation_rad > 0.0 && figures.yield_rotation_rad <= bent.points.last().unwrap()[0]
        );
        assert!(bent.kinetic_share < 0.2, "{}", bent.kinetic_share);
    }
    assert!(both.cases[1].figures.unwrap().peak_nm > both.cases[0].figures.unwrap().peak_nm);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone = pool.install(|| series::run(&small(), &coarse(&[0.2]), &|_, _| {}).unwrap());
    assert_eq!(alone.cases[0].bent, both.cases[1].bent);
}

#[test]
fn half_a_symmetric_section_bends_like_the_whole() {
    // along both axes of a rectangle, with bars on the planes of symmetry
    let text =
        SMALL.replace("depth = \"200 mm\"", "depth = \"250 mm\"").replace("per_face = 2", "per_face = 3");
    let section = read(&Source::new("half.toml", &text)).unwrap();
    let options = SeriesOptions { directions_deg: vec![0.0, 90.0], until_rad: 0.01, ..coarse(&[0.2]) };
    let half = series::run(&section, &options, &|_, _| {}).unwrap();
    let whole = SeriesOptions { whole: true, ..options };
    let whole = series::run(&section, &whole, &|_, _| {}).unwrap();
    assert_eq!(2 * half.elements[0], whole.elements[0]);
    for (half, whole) in half.cases.iter().zip(&whole.cases) {
        let (half, whole) = (&half.bent.as_ref().unwrap().points, &whole.bent.as_ref().unwrap().points);
        let peak = whole.iter().map(|p| p[1]).fold(0.0, f64::max);
        for (a, b) in half.iter().zip(whole) {
            assert!((a[1] - b[1]).abs() < 0.02 * peak, "{a:?} {b:?}");
        }
    }
}

#[test]
fn an_axial_force_that_is_not_borne_is_told_in_its_case() {
    let crushed = series::run(&small(), &coarse(&[1.5]), &|_, _| {}).unwrap();
    let error = crushed.cases[0].bent.as_ref().unwrap_err().to_string();
    assert!(error.contains("smaller axial force"), "{error}");
    assert!(crushed.cases[0].figures.is_none());
}

fn derived() -> &'static RcDerived {
    static ENTRY: OnceLock<RcDerived> = OnceLock::new();
    ENTRY.get_or_init(|| {
        RcWanted::of(&small(), &coarse(&[-0.05, 0.0, 0.2, 1.5])).unwrap().derive(&|_, _| {}).unwrap()
    })
}

#[test]
fn an_entry_has_both_axes_and_goes_through_the_library() {
    let RcDerived { entry, left_out } = derived();
    assert_eq!(entry.origin, Origin::RcSubmodel);
    assert!(left_out.iter().any(|l| l.starts_with("axial share 1.5")), "{left_out:?}");
    let hinge = entry.hinge().unwrap();
    assert_eq!(hinge.axes[0], hinge.axes[1]);
    let force = small().axial_n(0.2);
    let level = hinge.axes[0].envelopes.iter().find(|e| (e.axial_force_n - force).abs() < 1.0).unwrap();
    let peak = level.points.iter().map(|p| p[1]).fold(0.0, f64::max);
    assert!((peak / runs().cases[1].figures.unwrap().peak_nm - 1.0).abs() < 1e-8);
    assert_eq!(entry.key, RcWanted::of(&small(), &coarse(&[1.5, 0.0, 0.2, -0.05])).unwrap().key().unwrap());
    assert_eq!(&Entry::from_text(&entry.to_text().unwrap()).unwrap(), entry);
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(&room.path().join("library")).unwrap();
    store.put(entry).unwrap();
    assert_eq!(&store.get(&entry.key).unwrap(), entry);
}

#[test]
fn a_homogenised_building_does_not_get_it() {
    let mut entry = derived().entry.clone();
    let building = fallwerk::building::parse(
        fallwerk::building::EXAMPLE,
        fallwerk::base::tree::Format::Toml,
        "reference",
    )
    .unwrap();
    let partition = Partition::of(&building);
    let (mesh, _) = Mesh::of(&building, building.settings.mesh_size_m);
    let ends = member_ends(&building, &partition);
    let foot = ends.iter().find(|e| e.id == "C1-A1.bottom" && e.end == End::Lower).unwrap();
    let wanted = Wanted::of(&building, &partition, &mesh, foot).unwrap();
    // as near as an entry of concrete and steel can be: the same place, size, length and mesh
    let law = wanted.features.law.clone();
    entry.features =
        fallwerk::library::Features { law: None, rc: entry.features.rc.clone(), ..wanted.features.clone() };
    let entry = Entry::new(
        entry.kind,
        entry.origin,
        entry.features.clone(),
        entry.provenance.inputs.clone(),
        fallwerk::library::Computed {
            axes: entry.axes.clone(),
            stiffness: entry.stiffness,
            hinge_offset_m: entry.hinge_offset_m,
            ..Default::default()
        },
    )
    .unwrap();
    assert!(law.is_some());
    assert_ne!(entry.key, wanted.key().unwrap());
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(&room.path().join("library")).unwrap();
    store.put(&entry).unwrap();
    assert!(store.find(&wanted.features, f64::MAX).unwrap().is_none());
    assert_eq!(store.nearest(&wanted.features).unwrap().fit.distance, f64::INFINITY);
}

#[test]
fn symmetry_decides_which_bends_are_needed() {
    let square = small();
    assert_eq!(Symmetry::of(&square).directions_deg(), [90.0]);
    let mut oblong = square.clone();
    oblong.input.size_m[0] = 0.25;
    assert_eq!(Symmetry::of(&oblong).directions_deg(), [90.0, 0.0]);
    let mut one_sided = square.clone();
    one_sided.input.bars.truncate(2);
    assert_eq!(Symmetry::of(&one_sided).directions_deg(), [90.0, 270.0, 0.0]);
}

/// Ten times as long as deep: it swings about rest at the start, which once counted as a moment that is lost.
#[test]
fn a_slender_member_is_bent_to_the_end() {
    let text = SMALL.replace("length = \"0.4 m\"", "length = \"2 m\"");
    let section = read(&Source::new("slender.toml", &text)).unwrap();
    let series = series::run(&section, &coarse(&[0.1]), &|_, _| {}).unwrap();
    let case = &series.cases[0];
    assert_eq!(case.bent.as_ref().unwrap().ending, Ending::Path);
    let ratio = case.figures.unwrap().peak_nm / case.fibre_peak_nm.unwrap();
    assert!((0.9..1.2).contains(&ratio), "{ratio}");
}

/// A push that breaks off far below the fibre section tells no strength; one that reaches its end does, however short.
#[test]
fn a_push_that_broke_off_early_tells_no_strength() {
    let mut case = runs().cases[0].clone();
    assert_eq!(no_strength(&case), None);
    let mut figures = case.figures.unwrap();
    figures.peak_nm = 0.01 * case.fibre_peak_nm.unwrap();
    case.figures = Some(figures);
    case.bent.as_mut().unwrap().ending = Ending::Path;
    assert_eq!(no_strength(&case), None, "it ended at the rotation asked for");
    case.bent.as_mut().unwrap().ending = Ending::Moment;
    assert!(no_strength(&case).unwrap().contains("broke off"));
    case.figures = None;
    assert!(no_strength(&case).unwrap().contains("at most 0.0 kN m"));
}

/// A push that was stopped while it rose is a stiffness, not a resistance; one that ended by failure is what it is.
#[test]
fn a_push_that_stops_before_it_flows_makes_no_curve() {
    let mut case = runs().cases[0].clone();
    assert_eq!(stopped_early(&case), None);
    let first = case.figures.unwrap().yield_rotation_rad;
    case.bent.as_mut().unwrap().points.retain(|p| p[0] < 1.2 * first);
    assert!(stopped_early(&case).unwrap().contains("bend further (`--until`)"));
    case.bent.as_mut().unwrap().ending = Ending::Moment;
    assert_eq!(stopped_early(&case), None);
}

#[test]
fn an_entry_without_a_level_at_rest_is_refused() {
    for share in [1.5, -0.1] {
        let wanted = RcWanted::of(&small(), &coarse(&[share])).unwrap();
        let error = wanted.derive(&|_, _| {}).unwrap_err();
        assert!(matches!(error, RcDeriveError::NoRest), "{error}");
        assert!(error.to_string().contains("`--axial -0.05 0 0.1`"), "{error}");
    }
}

fn fallwerk(folder: &std::path::Path, words: &[&str]) -> (i32, String, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_fallwerk")).args(words).current_dir(folder).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (done.status.code().unwrap(), text(&done.stdout), text(&done.stderr))
}

#[test]
fn the_commands_run_write_and_go_on() {
    let room = tempfile::tempdir().unwrap();
    let folder = room.path();
    std::fs::write(folder.join("small.toml"), SMALL).unwrap();
    let coarse = ["--mesh", "100 mm", "--until", "18mrad", "--axial", "0,0.2"];
    let words = [&["rc", "small.toml"][..], &coarse, &["-o", "out"]].concat();
    let (code, out, err) = fallwerk(folder, &words);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("small: 0.20 x 0.20 m") && out.lines().count() == 6, "{out}");
    let csv = std::fs::read_to_string(folder.join("out/curves.csv")).unwrap();
    assert!(csv.starts_with("axial force [kN],direction [deg],rotation [rad]") && csv.lines().count() > 20);
    assert!(std::fs::read_to_string(folder.join("out/moment-rotation.svg")).unwrap().contains("n = 0.2"));
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("out/result.json")).unwrap()).unwrap();
    assert_eq!(json["bends"].as_array().unwrap().len(), 2);
    assert!(json["bends"][0]["figures"]["peak_nm"].as_f64().unwrap() > 0.0);
    assert!(json["bends"][0].get("seconds").is_none());

    let skew = [
        "rc",
        "small.toml",
        "--mesh",
        "100 mm",
        "--until",
        "8mrad",
        "--axial",
        "0.2",
        "--direction",
        "0,45,90",
    ];
    let (code, _, err) = fallwerk(folder, &[&skew[..], &["-o", "skew"]].concat());
    assert_eq!(code, 0, "{err}");
    let svg = std::fs::read_to_string(folder.join("skew/biaxial.svg")).unwrap();
    assert!(svg.matches("<circle").count() == 4 && svg.contains("n = 0.2"), "{svg}");
    assert!(!folder.join("out/biaxial.svg").exists());

    std::fs::create_dir(folder.join("library")).unwrap();
    let words = [&["library", "derive", "--section", "small.toml"][..], &coarse].concat();
    let (code, out, err) = fallwerk(folder, &words);
    assert_eq!((code, out.as_str()), (0, "1 added, 0 were there already\n"), "{err}");
    let (code, out, _) = fallwerk(folder, &words);
    assert_eq!((code, out.as_str()), (0, "0 added, 1 were there already\n"));

    let (code, out, _) = fallwerk(folder, &["rc", "--example"]);
    assert!(code == 0 && out.contains("[concrete]"));
    std::fs::write(folder.join("bad.toml"), "schema = 1\nname = 3\n").unwrap();
    let (code, _, err) = fallwerk(folder, &["rc", "bad.toml"]);
    assert!(code == 2 && err.contains("bad.toml:2") && err.contains("width"), "{err}");
    let (code, _, err) = fallwerk(folder, &["rc", "small.toml", "--mesh", "3 m"]);
    assert!(
        code == 2 && err.contains("3000 mm") && err.contains("at most half of the smaller side, 100 mm"),
        "{err}"
    );
    let (code, _, err) = fallwerk(folder, &["rc", "small.toml", "--mesh", "10 mm"]);
    assert!(code == 2 && err.contains("hexahedra, more than 5000; use --mesh"), "{err}");
    let (code, _, err) = fallwerk(folder, &["rc", "small.toml", "--cycles", "1mm"]);
    assert!(code == 2 && err.contains("write such as"), "{err}");

    let words = [
        "rc",
        "small.toml",
        "--mesh",
        "100 mm",
        "--axial",
        "0.2",
        "--cycles",
        "0.5%",
        "--repeat",
        "1",
        "-o",
        "loops",
    ];
    let (code, out, err) = fallwerk(folder, &words);
    assert!(code == 0 && out.contains("end of the path") && out.contains("secant"), "{err}");
    let rows = |name: &str| std::fs::read_to_string(folder.join("loops").join(name)).unwrap().lines().count();
    assert_eq!(rows("cycles.csv"), 2);
    assert!(rows("history.csv") > rows("envelope.csv") && rows("envelope.csv") > 20);
    assert!(
        std::fs::read_to_string(folder.join("loops/loops.svg")).unwrap().contains("lateral force over drift")
    );
    let text = std::fs::read_to_string(folder.join("loops/result.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["bends"][0]["ending"]["kind"], "path");
    assert!(json["bends"][0]["cycles"][0]["energy_j"].as_f64().unwrap() > 0.0);
}
