//! The frame solver against closed forms.

use fallwerk::graph::frame::*;

/// A section without shear deformation; `stretch` scales the axial stiffness.
fn slender(stretch: f64) -> BeamSection {
    let section = BeamSection::rectangle(30e9, 0.2, [0.3, 0.5]);
    BeamSection { shear_area_m2: [f64::INFINITY; 2], area_m2: stretch * section.area_m2, ..section }
}

fn element(nodes: [usize; 2], frame: &Frame, section: BeamSection) -> Element {
    let ends_m = nodes.map(|n| frame.nodes[n].point_m);
    let upright = (ends_m[0][2] - ends_m[1][2]).abs() > 0.1;
    let axis1 = if upright { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    Element {
        member: format!("bar {}-{}", nodes[0], nodes[1]),
        nodes,
        ends_m,
        axis1,
        section,
        loads: Vec::new(),
    }
}

fn close(computed: f64, exact: f64, tolerance: f64) {
    assert!((computed - exact).abs() <= tolerance * exact.abs(), "computed {computed}, exact {exact}");
}

/// Tip deflection `P L³/3EI + P L/G A_s`, slope `P L²/2EI`, clamp moment `P L`, in both planes, with torsion.
#[test]
fn cantilever() {
    let section = BeamSection::rectangle(30e9, 0.2, [0.3, 0.5]);
    let (length, force, torque) = (2.0, 10e3, 4e3);
    let mut frame = Frame::default();
    frame.nodes.push(FrameNode::clamped("wall", [0.0; 3]));
    frame.nodes.push(FrameNode::free("tip", [length, 0.0, 0.0]));
    frame.nodes[1].load = [0.0, force, -force, torque, 0.0, 0.0];
    frame.elements.push(element([0, 1], &frame, section));
    let solution = frame.solve().unwrap();
    let u = solution.displacement[1];
    let shear = force * length / (section.shear_modulus_pa * section.shear_area_m2[0]);
    let bend = |inertia: f64| force * length.powi(3) / (3.0 * 30e9 * inertia);
    close(u[1], bend(section.inertia_m4[1]) + shear, 1e-10);
    close(u[2], -bend(section.inertia_m4[0]) - shear, 1e-10);
    close(u[4], force * length * length / (2.0 * 30e9 * section.inertia_m4[0]), 1e-10);
    close(u[3], torque * length / (section.shear_modulus_pa * section.torsion_m4), 1e-10);
    let wall = solution.forces[0][0];
    close(wall.moment_nm[0], force * length, 1e-10);
    close(wall.torsion_nm, torque, 1e-10);
    // A load downwards stretches the top: positive about axis 1. One along +y stretches -y: the fibres at
    // negative axis 1, positive about axis 2.
    close(wall.moment_nm[1], force * length, 1e-10);
    close(solution.reactions[0].1[2], force, 1e-12);
}

/// A rigid offset moves the clamp: the same as a cantilever from the offset point, read at the node.
#[test]
fn rigid_offset() {
    let section = BeamSection::rectangle(30e9, 0.2, [0.3, 0.5]);
    let mut frame = Frame::default();
    frame.nodes.push(FrameNode::clamped("wall", [0.0; 3]));
    frame.nodes.push(FrameNode::free("tip", [2.5, 0.0, 0.3]));
    frame.nodes[1].load[2] = -10e3;
    let mut bar = element([0, 1], &frame, section);
    bar.ends_m = [[0.2, 0.0, 0.0], [2.2, 0.0, 0.0]];
    bar.axis1 = [0.0, 1.0, 0.0];
    frame.elements.push(bar);
    let solution = frame.solve().unwrap();
    close(solution.forces[0][0].moment_nm[0], 10e3 * 2.3, 1e-10);
    close(solution.forces[0][1].moment_nm[0], 10e3 * 0.3, 1e-10);
    close(solution.reactions[0].1[4], -10e3 * 2.5, 1e-10);
}

/// Clamped at both ends under its own weight: `w L²/12` at the clamps, also with shear deformation; a partial
/// load `w` on the left half gives `11 w L²/192` and `5 w L²/192`.
#[test]
fn clamped_beam() {
    let (length, load) = (6.0, 3678.75);
    for (stretch, moments) in [([0.0, 1.0], [1.0 / 12.0; 2]), ([0.0, 0.5], [11.0 / 192.0, 5.0 / 192.0])] {
        let mut frame = Frame::default();
        frame.nodes.push(FrameNode::clamped("left", [0.0; 3]));
        frame.nodes.push(FrameNode::free("middle", [0.4 * length, 0.0, 0.0]));
        frame.nodes.push(FrameNode::clamped("right", [length, 0.0, 0.0]));
        for (nodes, from, to) in [([0, 1], 0.0, 0.4), ([1, 2], 0.4, 1.0)] {
            let mut bar = element(nodes, &frame, slender(1.0));
            let clipped = [stretch[0], stretch[1]].map(|x: f64| ((x - from) / (to - from)).clamp(0.0, 1.0));
            bar.loads.push(LineLoad { stretch: clipped, force_n_m: [0.0, 0.0, -load], torque_nm_m: load });
            frame.elements.push(bar);
        }
        let solution = frame.solve().unwrap();
        close(solution.forces[0][0].moment_nm[0], moments[0] * load * length * length, 1e-9);
        close(solution.forces[1][1].moment_nm[0], moments[1] * load * length * length, 1e-9);
        // a torque goes to both ends by the distances from the other one
        let right = 0.5 * (stretch[1] - stretch[0]) * (stretch[0] + stretch[1]);
        for (reaction, share) in solution.reactions.iter().zip([stretch[1] - stretch[0] - right, right]) {
            close(reaction.1[3], -share * load * length, 1e-9);
        }
        close(solution.reaction_sum_n()[2], load * length * (stretch[1] - stretch[0]), 1e-12);
    }
}

/// Portal with clamped feet (Kleinlogel, *Rahmenformeln*): `k = I_b h/(I_c L)`. Uniform load on the beam: feet
/// `w L²/(12 (k + 2))`, corners twice that. Side load `P` at the beam: feet `P h/2 (3k + 1)/(6k + 1)`, corners
/// `P h/2 · 3k/(6k + 1)`.
#[test]
fn portal() {
    let (height, width, load, side) = (3.5, 6.0, 20e3, 50e3);
    let k = height / width;
    for lateral in [false, true] {
        let mut frame = Frame::default();
        for (id, x, z) in [
            ("left foot", 0.0, 0.0),
            ("left", 0.0, height),
            ("right", width, height),
            ("right foot", width, 0.0),
        ] {
            let mut node = FrameNode::free(id, [x, 0.0, z]);
            node.fixed = if z == 0.0 { [true; 6] } else { [false, true, false, true, false, true] };
            frame.nodes.push(node);
        }
        // Columns whose inertia about the bending axis (y) equals the beam's.
        let beam = slender(1e4);
        let column = BeamSection { inertia_m4: [beam.inertia_m4[1], beam.inertia_m4[0]], ..beam };
        for (nodes, section) in [([0, 1], column), ([1, 2], beam), ([3, 2], column)] {
            frame.elements.push(element(nodes, &frame, section));
        }
        let (foot, corner);
        if lateral {
            frame.nodes[1].load[0] = 0.5 * side;
            frame.nodes[2].load[0] = 0.5 * side;
            foot = side * height / 2.0 * (3.0 * k + 1.0) / (6.0 * k + 1.0);
            corner = side * height / 2.0 * 3.0 * k / (6.0 * k + 1.0);
        } else {
            frame.elements[1].loads.push(LineLoad {
                stretch: [0.0, 1.0],
                force_n_m: [0.0, 0.0, -load],
                torque_nm_m: 0.0,
            });
            foot = load * width * width / (12.0 * (k + 2.0));
            corner = 2.0 * foot;
        }
        let solution = frame.solve().unwrap();
        for column in [0, 2] {
            close(solution.forces[column][0].moment_nm[1].abs(), foot, 1e-4);
            close(solution.forces[column][1].moment_nm[1].abs(), corner, 1e-4);
        }
        close(solution.forces[1][0].moment_nm[0].abs(), corner, 1e-4);
        if !lateral {
            close(solution.forces[0][0].axial_n, 0.5 * load * width, 1e-9);
        }
    }
}

/// A diaphragm makes two cantilevers share a horizontal force by stiffness.
#[test]
fn diaphragm() {
    let mut frame = Frame::default();
    for x in [0.0, 4.0] {
        frame.nodes.push(FrameNode::clamped("foot", [x, 0.0, 0.0]));
        frame.nodes.push(FrameNode::free("top", [x, 0.0, 3.0]));
    }
    let section = slender(1.0);
    let stiff = BeamSection { inertia_m4: section.inertia_m4.map(|i| 3.0 * i), ..section };
    frame.elements.push(element([0, 1], &frame, section));
    frame.elements.push(element([2, 3], &frame, stiff));
    frame.diaphragms.push(Diaphragm { nodes: vec![1, 3] });
    frame.nodes[1].load[0] = 40e3;
    let solution = frame.solve().unwrap();
    assert!((solution.displacement[1][0] - solution.displacement[3][0]).abs() < 1e-15);
    close(solution.forces[0][0].moment_nm[1].abs(), 10e3 * 3.0, 1e-9);
    close(solution.forces[1][0].moment_nm[1].abs(), 30e3 * 3.0, 1e-9);
}

/// A part that nothing holds is named.
#[test]
fn loose_part_is_named() {
    let mut frame = Frame::default();
    for x in [0.0, 1.0, 2.0, 3.0] {
        frame.nodes.push(FrameNode::free("n", [x, 0.0, 0.0]));
    }
    frame.nodes[0].fixed = [true; 6];
    frame.elements.push(element([0, 1], &frame, slender(1.0)));
    frame.elements.push(element([2, 3], &frame, slender(1.0)));
    let error = frame.solve().unwrap_err();
    assert_eq!(error, FrameError::Mechanism(Mechanism { members: vec!["bar 2-3".into()] }));
}

/// Held at one point against translation only: it can turn, although every part has a support.
#[test]
fn hinged_bar_is_a_mechanism() {
    let mut frame = Frame::default();
    for x in [0.0, 2.0, 4.0] {
        frame.nodes.push(FrameNode::free("n", [x, 0.0, 0.0]));
    }
    frame.nodes[0].fixed = [true, true, true, true, false, true];
    frame.nodes[2].fixed = [false, true, false, false, false, false];
    frame.elements.push(element([0, 1], &frame, slender(1.0)));
    frame.elements.push(element([1, 2], &frame, slender(1.0)));
    let error = frame.solve().unwrap_err();
    let both = Mechanism { members: vec!["bar 0-1".into(), "bar 1-2".into()] };
    assert_eq!(error, FrameError::Mechanism(both));
    frame.nodes[2].fixed[2] = true;
    assert!(frame.solve().is_ok());
}
