//! Removal of a member over a stated time.

use fallwerk::base::tree::Format;
use fallwerk::building::{Building, Charge, EXAMPLE, Member, MemberKind, parse};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::{Death, Dynamics};
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::preload::equilibrate;
use fallwerk::fe::result::KeptFrame;
use fallwerk::fe::run::{FeOptions, run};
use std::collections::BTreeSet;

/// One storey, 3 m x 3 m, that stays elastic; one column is removed.
fn small(removal_duration_s: f64) -> Building {
    let text = EXAMPLE
        .replace("x = [0, 6]", "x = [0, 3]")
        .replace("y = [0, 5]", "y = [0, 3]")
        .replace("[\"3.5 m\", \"3.5 m\", \"3.5 m\"]", "[\"3 m\"]")
        .replace("\"10.5 MPa\"", "\"500 MPa\"")
        .replace("\"11.55 MPa\"", "\"501 MPa\"")
        .replace("\"12.25 MPa\"", "\"502 MPa\"");
    let mut building = parse(&text, Format::Toml, "small.toml").unwrap_or_else(|e| panic!("{e}"));
    building.events.truncate(1);
    building.settings.removal_duration_s = removal_duration_s;
    building.settings.end_time_s = removal_duration_s + 0.4;
    building
}

/// Removed slowly, the column leaves the others near their static state; removed at once, the corner swings to about twice that. The energy
/// balance closes in both.
#[test]
fn slow_removal_ends_in_the_static_state_of_the_rest() {
    let building = small(0.6);
    let (mesh, _) = Mesh::of(&building, 0.5);
    let removed = building.members.iter().position(|m| m.id == building.events[0].member).unwrap();
    let (rest, old) = mesh.cut_out(|e| mesh.elements[e].part != removed);
    let at_rest = |mesh: &Mesh| {
        let mut body = Dynamics::new(mesh, building.settings.gravity_m_s2, RigidSurfaces::default(), false);
        equilibrate(&mut body).unwrap();
        body.x
    };
    let (whole, left) = (at_rest(&mesh), at_rest(&rest));
    let sag = |n: usize| whole[old[n]][2] - left[n][2];
    let node = (0..left.len()).max_by(|a, b| sag(*a).total_cmp(&sag(*b))).unwrap();
    let expected = sag(node);
    let options = FeOptions { mesh_size_m: Some(0.5), keep_frames: true, ..FeOptions::default() };
    for (duration, least, most) in [(0.6, 0.9, 1.1), (0.0, 1.5, 2.1)] {
        let found = run(&small(duration), &options, &mut |_| {}).unwrap();
        let sags: Vec<f64> = found
            .frames
            .iter()
            .filter(|frame| found.times_s[frame.output] >= duration)
            .map(|frame| whole[old[node]][2] - f64::from(frame.nodes_m[old[node]][2]))
            .collect();
        let largest = sags.iter().copied().fold(0.0, f64::max) / expected;
        let error = found.summary.energy_error;
        println!("duration {duration}: sag {expected}, largest {largest} of it, energy error {error}");
        assert!((least..most).contains(&largest), "{duration}: {largest}");
        let residual = found.energies.iter().map(|e| e.residual_j.abs()).fold(0.0, f64::max);
        let work = found.energies.iter().map(|e| e.gravity_j).fold(0.0, f64::max);
        assert!(residual < 0.03 * work, "{duration}: {residual} of {work} J");
        assert!(found.deaths.iter().all(|d| mesh.elements[d.element].part == removed));
    }
}

/// All columns at once, over 0.3 s: the support force falls linearly, the floor falls by `g t³ / (6 D)`. Mass of the columns at the nodes of the floor goes with them, and its weight with it.
#[test]
fn what_loses_all_support_over_time_falls_by_the_cube_of_it() {
    let mut building = small(0.3);
    let first = building.events[0].clone();
    let columns = building.members.iter().filter(|m| m.kind == MemberKind::Column);
    let fire = |m: &Member| Charge { id: m.id.clone(), member: m.id.clone(), ..first.clone() };
    building.events = columns.map(fire).collect();
    building.settings.end_time_s = 0.25;
    let options = FeOptions { mesh_size_m: Some(0.5), keep_frames: true, ..FeOptions::default() };
    let found = run(&building, &options, &mut |_| {}).unwrap();
    let (mesh, _) = Mesh::of(&building, 0.5);
    let slab = building.members.iter().position(|m| m.kind == MemberKind::Slab).unwrap();
    let nodes: BTreeSet<usize> =
        mesh.elements.iter().filter(|e| e.part == slab).flat_map(|e| e.nodes).collect();
    let height = |frame: &KeptFrame| {
        nodes.iter().map(|n| f64::from(frame.nodes_m[*n][2])).sum::<f64>() / nodes.len() as f64
    };
    let fallen = height(&found.frames[0]) - height(found.frames.last().unwrap());
    let exact = 9.81 * 0.25f64.powi(3) / (6.0 * 0.3);
    // the floor springs back to its own shape meanwhile: under a millimetre
    assert!((fallen / exact - 1.0).abs() < 0.01, "{fallen} m for {exact} m");
}

/// What stands above a stretch that a charge takes comes down on the ground: the first contact, a free fall over the stretch later.
#[test]
fn columns_that_lose_their_feet_come_down() {
    let mut building = small(0.0);
    let first = building.events[0].clone();
    let columns = building.members.iter().filter(|m| m.kind == MemberKind::Column);
    let fire = |m: &Member| Charge {
        id: m.id.clone(),
        member: m.id.clone(),
        stretch_m: Some([0.0, 1.0]),
        ..first.clone()
    };
    building.events = columns.map(fire).collect();
    building.settings.end_time_s = 0.5;
    let options = FeOptions { mesh_size_m: Some(0.5), ..FeOptions::default() };
    let found = run(&building, &options, &mut |_| {}).unwrap();
    let contact_s = found.summary.first_ground_contact_s.unwrap();
    let fallen_s = first.time_s + (2.0_f64 / 9.81).sqrt();
    assert!((contact_s / fallen_s - 1.0).abs() < 0.01, "{contact_s} {fallen_s}");
}

/// Three storeys press 3 MPa into the column. Elements that kept this stress without stiffness tore themselves apart within 0.27 s.
#[test]
fn a_removal_may_take_as_long_as_it_likes() {
    let mut building = parse(EXAMPLE, Format::Toml, "slow.toml").unwrap_or_else(|e| panic!("{e}"));
    building.settings.removal_duration_s = 2.0;
    building.settings.end_time_s = 0.4;
    let options = FeOptions { mesh_size_m: Some(0.5), ..FeOptions::default() };
    let found = run(&building, &options, &mut |_| {}).unwrap();
    assert!(found.summary.energy_error < 1e-3, "{}", found.summary.energy_error);
    assert!(found.deaths.iter().all(|d| d.cause == Death::Removed));
    // nothing has eroded: 0 in the tables, not -0
    assert!(found.energies.iter().all(|e| e.eroded_j.to_bits() == 0), "{:?}", found.energies[0]);
    // the forces hold back what sinks onto them; their work stands with what leaves with the columns
    let end = found.energies.last().unwrap();
    assert!(end.removed_j < -0.3 * end.gravity_j, "{} of {}", end.removed_j, end.gravity_j);
    // a fifth of the forces is gone: the floors have begun to sag, and no more
    let sags = found.tracked.iter().filter_map(|h| h.displacement_m.last()).map(|u| -u[2]);
    let largest = sags.fold(0.0, f64::max);
    assert!((1e-4..0.02).contains(&largest), "{largest}");
}
