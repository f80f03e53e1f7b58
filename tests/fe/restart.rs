//! Checkpoints: a run that was interrupted ends with the same bytes, and nothing but its own checkpoint is gone on from.

use super::mesh::{bilinear, grid, ground};
use fallwerk::base::tree::Format;
use fallwerk::building::inspect;
use fallwerk::fe::contact::{BodyContact, RigidSurfaces};
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::erosion::Fate;
use fallwerk::fe::law::ElementForm;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::model::ContactSettings;
use fallwerk::fe::restart::{FORMAT, Head, RestartError, decode, encode};
use fallwerk::fe::run::{Attached, Checkpoints, FeError, FeOptions, run_with};
use fallwerk::fe::vtu::{Frame, FrameSink, WrittenFrame};
use fallwerk::verify::fe::slab_model::{Breadth, SlabModel};
use std::fs;
use std::path::Path;
use std::process::Command;

fn head() -> Head {
    Head {
        program_version: "1.2.3".into(),
        model_hash: [7; 32],
        mesh_size_m: 0.4,
        form: None,
        on_failure: Fate::Erode,
        body_contact: true,
        mass_scaling_step_s: None,
        frames_every: Some(5),
        time_s: 0.5,
    }
}

fn there_and_back(body: &Dynamics) -> Dynamics {
    decode(&encode(&head(), body).unwrap(), Path::new("state"), &head()).unwrap()
}

/// A plastic block falls on rough ground, sliding, and erodes. Whatever a state holds shows in its debug text, with all digits: a field
/// that is not in the checkpoint makes the texts differ at once, or the states later.
#[test]
fn a_state_goes_on_from_a_checkpoint_as_if_it_had_not_stopped() {
    let mut law = bilinear(30e9, 0.2, 2500.0, 2e6, 0.0);
    law.erosion.plastic_strain = 0.02;
    let mesh = grid([3, 5, 6], [0.6, 1.0, 1.2], law, |_| false);
    let mut body = Dynamics::new(&mesh, 9.81, ground(-0.001, 0.5), false);
    body.v.iter_mut().zip(&mesh.nodes).for_each(|(v, x)| *v = [2.0 + x[2], x[0], -20.0]);
    // no field may stand at the value that it would have if it were forgotten
    body.damping_1_s = 0.02;
    body.applied_n[3] = [100.0, 0.0, -50.0];
    body.prescribed_m_s[100][1] = Some(0.25);
    body.other_n = vec![[0.0, 1.0, 0.0]; mesh.nodes.len()];
    let mut deaths = [0; 2];
    let advance = |body: &mut Dynamics, deaths: &mut usize| {
        for _ in 0..150 {
            body.step(true);
            *deaths += body.deaths.len();
        }
    };
    while deaths[0] < 6 && body.steps < 1000 {
        body.step(true);
        deaths[0] += body.deaths.len();
    }
    let touched = body.contact_j;
    let mut other = there_and_back(&body);
    assert!(format!("{body:?}") == format!("{other:?}"), "the checkpoint does not hold the whole state");
    advance(&mut body, &mut deaths[1]);
    advance(&mut other, &mut 0);
    assert!(format!("{body:?}") == format!("{other:?}"), "the states part");
    assert!(deaths.iter().all(|d| *d > 0), "elements die before and after: {deaths:?}");
    assert!(touched[0] < 0.0 && body.contact_j[0] != touched[0], "contact before and after");
}

/// What a state holds is in the checkpoint without exception.
#[test]
fn no_field_of_a_state_is_left_out() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/fe");
    let files: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    assert!(files.len() > 15);
    for file in files.iter().filter(|f| f.is_file()) {
        let text = fs::read_to_string(file).unwrap();
        for word in ["skip", "default"].map(|w| format!("serde({w}")) {
            assert!(!text.contains(&word), "{}: {word}", file.display());
        }
    }
}

/// The encoding has no names: with a field more or less the bytes of an older checkpoint mean something else. The states of two small bodies at rest, one of concrete
/// with bars, one of a homogenised law in contact, have a length that changes with the fields of their types (and with the tables of concrete).
#[test]
fn a_format_has_one_layout_of_the_state() {
    let slab = SlabModel::new(4, Breadth::Strip, [1.0, 1.0]).mesh;
    let concrete = Dynamics::new(&slab, 9.81, RigidSurfaces::default(), false);
    let mesh = grid([2, 1, 1], [0.4, 0.2, 0.2], bilinear(30e9, 0.2, 2500.0, 2e6, 0.0), |_| false);
    let mut block = Dynamics::new(&mesh, 9.81, ground(0.0, 0.5), false);
    block.body_contact = Some(Box::new(BodyContact::new(&mesh, ContactSettings { friction: 0.5 })));
    let [concrete, block] = [concrete, block].map(|body| encode(&head(), &body).unwrap().len());
    let words = "the state of a run has another layout: raise FORMAT in src/fe/restart.rs, then write it here with the new lengths";
    assert_eq!((FORMAT, concrete, block), (18, 172_977, 4376), "{words}");
}

#[test]
fn every_damaged_byte_is_found() {
    let state: Vec<f64> = (0..50).map(|i| 1.0 / f64::from(i)).collect();
    let good = encode(&head(), &state).unwrap();
    let back = |bytes: &[u8]| decode::<Vec<f64>>(bytes, Path::new("x.checkpoint"), &head());
    let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&back(&good).unwrap()), bits(&state));
    for at in 0..good.len() {
        let mut bad = good.clone();
        bad[at] ^= 0x10;
        let error = back(&bad).unwrap_err();
        match at {
            0..8 => assert!(matches!(error, RestartError::NotACheckpoint { .. }), "{at}: {error}"),
            _ => assert!(matches!(error, RestartError::Damaged { .. }), "{at}: {error}"),
        }
        assert!(error.to_string().contains("x.checkpoint"));
        assert!(back(&good[..at]).is_err(), "cut after {at} bytes");
    }
    assert!(matches!(back(&[&good[..], b"x"].concat()), Err(RestartError::Damaged { .. })));
    // whole, but of another shape than the program expects
    let other = decode::<Vec<f32>>(&good, Path::new("x"), &head());
    assert!(matches!(other, Err(RestartError::Damaged { .. })));
}

#[test]
fn a_checkpoint_of_another_run_is_refused_by_name() {
    let bytes = encode(&head(), &1.0f64).unwrap();
    let refused = |own: Head| decode::<f64>(&bytes, Path::new("x"), &own).unwrap_err().to_string();
    assert_eq!(decode::<f64>(&bytes, Path::new("x"), &Head { time_s: 9.0, ..head() }), Ok(1.0));
    for (own, words) in [
        (Head { program_version: "1.2.4".into(), ..head() }, "version 1.2.3"),
        (Head { model_hash: [8; 32], ..head() }, "building"),
        (Head { mesh_size_m: 0.5, ..head() }, "--mesh-size 0.4"),
        (Head { frames_every: None, ..head() }, "--vtu-every 5"),
        (
            Head { form: Some(ElementForm::FullyIntegrated), ..head() },
            "written with --form asqbi, this run has --form full",
        ),
        (Head { on_failure: Fate::Split, ..head() }, "this run has --on-failure split"),
        (
            Head { body_contact: false, ..head() },
            "written with contact of its parts, this run has --no-body-contact",
        ),
        (Head { mass_scaling_step_s: Some(1e-4), ..head() }, "this run has --mass-scaling-step 0.0001"),
    ] {
        let message = refused(own);
        assert!(message.contains(words), "{words}: {message}");
    }
    // the default by its name is no difference
    let named = Head { form: Some(ElementForm::default()), ..head() };
    assert_eq!(decode::<f64>(&bytes, Path::new("x"), &named), Ok(1.0));
}

/// Fails at an output, as a full disk does.
struct Full(usize);

impl FrameSink for Full {
    fn frame(&mut self, frame: &Frame<'_>) -> Result<(), String> {
        if frame.output < self.0 { Ok(()) } else { Err("no space left".into()) }
    }
    fn written(&self) -> &[WrittenFrame] {
        &[]
    }
    fn resume(&mut self, _: &Mesh, _: Vec<WrittenFrame>) -> Result<(), String> {
        Ok(())
    }
    fn every(&self) -> usize {
        1
    }
}

/// A run stops because an output cannot be written, and goes on from the last checkpoint before.
#[test]
fn a_run_that_failed_goes_on_from_its_last_checkpoint() {
    let room = tempfile::tempdir().unwrap();
    let file = room.path().join("run.checkpoint");
    let building = inspect(fallwerk::building::EXAMPLE, Format::Toml, "b.toml").building.unwrap();
    let options = FeOptions {
        mesh_size_m: Some(1.0),
        end_time_s: Some(0.08),
        keep_frames: true,
        ..FeOptions::default()
    };
    let run = |full: usize, resume: bool, options: &FeOptions| {
        let mut sink = Full(full);
        let mut seen = Vec::new();
        let attached = Attached {
            frames: Some(&mut sink),
            checkpoints: Some(Checkpoints { path: file.clone(), every_s: 0.02 }),
            resume: resume.then(|| file.clone()),
        };
        let result = run_with(&building, options, attached, &mut |p| seen.push(p.checkpoints));
        (result, seen)
    };
    let (whole, seen) = run(99, false, &options);
    let whole = whole.unwrap();
    assert_eq!(seen, [0, 1, 1, 2, 2, 3, 3, 4]);
    fs::remove_file(&file).unwrap();
    let (stopped, seen) = run(6, false, &options);
    assert_eq!(stopped.unwrap_err(), FeError::Output("no space left".into()));
    assert_eq!(seen, [0, 1, 1, 2, 2]);
    let before = fs::read(&file).unwrap();
    let short = FeOptions { end_time_s: Some(0.02), ..options.clone() };
    let error = run(99, true, &short).0.unwrap_err().to_string();
    assert!(error.contains("--end-time"), "{error}");
    assert_eq!(fs::read(&file).unwrap(), before, "a refused run writes nothing");
    let (resumed, seen) = run(99, true, &options);
    let resumed = resumed.unwrap();
    assert_eq!(seen, [0, 1, 1, 2], "outputs 5 to 8");
    assert_eq!((&whole.times_s, &whole.tracked), (&resumed.times_s, &resumed.tracked));
    assert_eq!((&whole.energies, &whole.deaths), (&resumed.energies, &resumed.deaths));
    assert_eq!((&whole.frames, &whole.strain_rates), (&resumed.frames, &resumed.strain_rates));
    assert_eq!(whole.frames.len(), 9);
    assert_eq!(fs::read_dir(room.path()).unwrap().count(), 1, "one file, and nothing temporary");
}

fn fallwerk(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let out =
        Command::new(env!("CARGO_BIN_EXE_fallwerk")).args(arguments).current_dir(folder).output().unwrap();
    (out.status.code().unwrap(), String::from_utf8(out.stderr).unwrap())
}

fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(contents(&path).into_iter().map(|(n, bytes)| (format!("{name}/{n}"), bytes)));
        } else {
            found.push((name, fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

/// A collapse stopped in its middle, with elements eroding and debris on the ground before and after: all files are the same.
#[test]
fn a_collapse_in_two_parts_leaves_the_same_files() {
    let room = tempfile::tempdir().unwrap();
    let at = room.path();
    fs::write(at.join("b.toml"), fallwerk::building::EXAMPLE).unwrap();
    let common = ["fe", "b.toml", "--mesh-size", "1.0", "--vtu-every", "10"];
    let run = |more: &[&str]| fallwerk(at, &[&common[..], more].concat());
    assert_eq!(run(&["--end-time", "1.9", "--threads", "1", "-o", "whole"]).0, 0);
    let whole = contents(&at.join("whole"));
    let events = String::from_utf8(whole.iter().find(|f| f.0 == "fe-events.csv").unwrap().1.clone()).unwrap();
    let mut parts = [0, 0];
    for line in events.lines().filter(|l| l.contains(",eroded,")) {
        let time: f64 = line.split(',').next().unwrap().parse().unwrap();
        parts[usize::from(time > 1.65)] += 1;
    }
    assert!(parts[0] > 3 && parts[1] > 3, "elements erode before and after: {parts:?}");
    assert!(events.contains(",contact,"), "{events}");
    // the parts with other numbers of threads than the whole and each other
    let checkpoint = ["--checkpoint-every", "0.5", "--checkpoint", "half", "-o", "run"];
    let first = run(&[&["--end-time", "1.65", "--threads", "2"], &checkpoint[..]].concat());
    assert_eq!(first.0, 0, "{}", first.1);
    assert!(contents(&at.join("run")) != whole && at.join("half").is_file());
    let second = run(&["--end-time", "1.9", "--threads", "3", "--resume", "half", "-o", "run"]);
    assert_eq!(second.0, 0, "{}", second.1);
    let names = |files: &[(String, Vec<u8>)]| files.iter().map(|f| f.0.clone()).collect::<Vec<_>>();
    let parts = contents(&at.join("run"));
    assert_eq!(names(&parts), names(&whole));
    for (a, b) in parts.iter().zip(&whole) {
        assert!(a == b, "{} differs", a.0);
    }
    assert!(!at.join("run.unfinished").exists());
    // what is refused, before anything is computed
    fs::write(at.join("b.toml"), fallwerk::building::EXAMPLE.replace("9.81 m/s2", "9.80 m/s2")).unwrap();
    for (arguments, words) in [
        (&["--resume", "half", "-o", "run"][..], "belongs to another run"),
        (&["--resume", "b.toml", "-o", "run"], "no checkpoint"),
        (&["--resume", "absent", "-o", "run"], "absent"),
        (&["--checkpoint-every", "0", "-o", "run"], "--checkpoint-every"),
        (&["--checkpoint-every", "1", "--checkpoint", "no/where", "-o", "run"], "no/where"),
    ] {
        let (code, err) = run(arguments);
        assert!(code != 0 && err.contains(words), "{arguments:?}: {code} {err}");
    }
    assert!(contents(&at.join("run")) == whole, "a refused run changes nothing");
    assert!(!at.join("run.unfinished").exists());
}
