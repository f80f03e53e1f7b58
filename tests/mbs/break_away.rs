//! Webs of beams below a slab: one body with it until the seam between them bears what it can.

use super::support::*;
use fallwerk::mbs::latent::Latent;
use fallwerk::mbs::math;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::EventKind;
use fallwerk::mbs::system::System;
use fallwerk::mbs::{RunResult, simulate};

const SLAB_M: [f64; 3] = [2.0, 1.5, 0.25];
const WEB_M: [f64; 3] = [1.6, 0.3, 0.3];
/// Height of the seam.
const SEAM_M: f64 = 3.0;

/// A slab with a web below it, joined by two bushings that bear a tension and a shear force each \[N\], without gravity.
fn slab_with_web(tension_n: Option<f64>, shear_n: Option<f64>) -> Model {
    let mut m = model("web", 0.1, 0.001);
    m.gravity_m_s2 = [0.0; 3];
    m.bodies.push(solid("slab", [0.0, 0.0, SEAM_M + 0.5 * SLAB_M[2]], SLAB_M));
    m.bodies.push(solid("web", [0.0, 0.0, SEAM_M - 0.5 * WEB_M[2]], WEB_M));
    for (id, x) in [("seam-1", -0.25 * WEB_M[0]), ("seam-2", 0.25 * WEB_M[0])] {
        let point = [x, 0.0, SEAM_M];
        let ends = [elastic(1e8), elastic(1e8)];
        m.bushings.push(Bushing {
            latent: Some("web".into()),
            tensile_capacity_n: tension_n,
            shear_capacity_n: shear_n.map(|v| [v; 2]),
            ..joint(id, Some("slab"), "web", point, 1e10, 1e8, ends)
        });
    }
    m
}

fn live(run: &RunResult) -> Vec<&str> {
    let ids = run.events.iter().filter_map(|e| match &e.kind {
        EventKind::Live { joint, .. } => Some(joint.as_str()),
        _ => None,
    });
    ids.collect()
}

/// A slab that moves on a spring is pulled by at most `v √(k M)`; of that the web's share of the mass goes through the seam, half of it through either bushing.
#[test]
fn a_web_is_pulled_off_where_its_share_of_a_pull_is_what_the_seam_bears() {
    let (stiffness, speed) = (2e7, 2.0);
    let [slab, web] = [0, 1].map(|i| slab_with_web(None, None).bodies[i].mass_kg);
    let pull = speed * (stiffness * (slab + web)).sqrt();
    let of_seam = 0.5 * web / (slab + web) * pull;
    let run = |share: f64| {
        let mut m = slab_with_web(Some(share * of_seam), None);
        let spring =
            joint("spring", None, "slab", [0.0, 0.0, SEAM_M], stiffness, 1e6, [elastic(1e6), elastic(1e6)]);
        m.bushings.push(spring);
        m.bodies.iter_mut().for_each(|b| b.velocity_m_s = [0.0, 0.0, -speed]);
        m.settings.time_step_s = Some(1e-5);
        simulate(&m).unwrap()
    };
    let holds = run(1.001);
    assert_eq!(live(&holds), Vec::<&str>::new());
    for record in &holds.latent {
        assert!((record.largest_share * 1.001 - 1.0).abs() < 1e-5, "{record:?}");
    }
    let parts = run(0.999);
    assert_eq!(live(&parts), ["seam-1", "seam-2"]);
    // at the extreme of the spring: a quarter of a period after the start
    let quarter = 0.5 * std::f64::consts::PI * ((slab + web) / stiffness).sqrt();
    let time_s = parts.events.iter().find(|e| matches!(e.kind, EventKind::Live { .. })).unwrap().time_s;
    let reached = 0.999_f64.asin() / (0.5 * std::f64::consts::PI) * quarter;
    assert!((time_s - reached).abs() < 5e-5, "{time_s} {reached}");
    assert!(parts.energy_error < 1e-4, "{}", parts.energy_error);
    // it flies on, and the spring takes the slab back
    let height = |body: usize| parts.frames.last().unwrap().position_m[body][2];
    let gap = height(0) - height(1) - 0.5 * (SLAB_M[2] + WEB_M[2]);
    assert!(gap > 0.02, "{gap}");
}

/// What slides on its web is slowed down by a steady force, `μ g` times its mass; the slab's share of it goes through the seam.
#[test]
fn a_web_is_sheared_off_where_a_steady_blow_is_what_the_seam_bears() {
    let friction = 0.4;
    let run = |share: f64| {
        let [slab, _] = [0, 1].map(|i| slab_with_web(None, None).bodies[i].mass_kg);
        let of_seam = 0.5 * slab * friction * G;
        let mut m = slab_with_web(None, Some(share * of_seam));
        m.gravity_m_s2 = [0.0, 0.0, -G];
        m.contact.ground = Some(GroundPlane { level_m: SEAM_M - WEB_M[2], friction, restitution: 0.0 });
        m.bodies.iter_mut().for_each(|b| b.velocity_m_s = [3.0, 0.0, 0.0]);
        simulate(&m).unwrap()
    };
    let holds = run(1.01);
    assert_eq!(live(&holds), Vec::<&str>::new());
    for record in &holds.latent {
        assert!((record.largest_share * 1.01 - 1.0).abs() < 2e-3, "{record:?}");
    }
    assert_eq!(live(&run(0.99)), ["seam-1", "seam-2"]);
}

/// Momentum and angular momentum of all bodies, about the origin.
fn momenta(system: &System) -> [[f64; 3]; 2] {
    let mut sum = [[0.0; 3]; 2];
    for body in &system.bodies[..system.count()] {
        sum[0] = math::add(sum[0], body.p);
        sum[1] = math::add(sum[1], math::add(body.l, math::cross(body.x, body.p)));
    }
    sum
}

#[test]
fn a_web_that_breaks_away_takes_its_momenta_with_it() {
    let mut m = slab_with_web(None, None);
    let about = [0.7, -1.1, 2.3];
    for body in &mut m.bodies {
        let arm = math::sub(body.position_m, [0.3, 0.2, 0.1]);
        body.velocity_m_s = math::add([1.0, -2.0, 4.0], math::cross(about, arm));
        body.angular_velocity_rad_s = about;
    }
    let (mut latent, merged) = Latent::new(&m).unwrap();
    let system = System::new(&merged.unwrap()).unwrap();
    assert_eq!(system.count(), 1);
    let parting = latent.parting(&system, 0);
    assert_eq!(parting.live.len(), 2, "both bushings of a seam give way together");
    let (parted, _) = latent.part(&m, &system, &parting).unwrap();
    assert_eq!(parted.count(), 2);
    for (before, after) in momenta(&system).into_iter().zip(momenta(&parted)) {
        let off = math::norm(math::sub(after, before));
        assert!(off < 1e-12 * math::norm(before), "{before:?} {after:?}");
    }
}

/// `Aᵀ B A` of 3 by 3 matrices.
fn around(a: [[f64; 3]; 3], b: [[f64; 3]; 3], c: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    math::matmul(&math::matmul(&math::transpose(&a), &b), &c)
}

/// Inertia that halves of a beam have together goes on where one of them is of two pieces that move as one, whatever centre it is given for.
#[test]
fn pieces_that_are_one_share_inertia_as_a_whole() {
    let mut whole = super::shared_mass::halves();
    whole.shared_masses.push(super::shared_mass::shared());
    whole.bodies[0].angular_velocity_rad_s = [0.0, 0.02, 0.0];
    whole.bodies[1].angular_velocity_rad_s = [0.0, -0.02, 0.0];
    let mut pieces = whole.clone();
    let first = whole.bodies[0].clone();
    // two pieces of half the mass on both sides of its centre
    let arm = [0.4, 0.001, 0.002];
    let own = |i: usize, j: usize| {
        let steiner = if i == j { math::dot(arm, arm) } else { 0.0 } - arm[i] * arm[j];
        0.5 * first.inertia_kg_m2[i][j] - 0.5 * first.mass_kg * steiner
    };
    let inertia_kg_m2 = std::array::from_fn(|i| std::array::from_fn(|j| own(i, j)));
    let piece = |id: &str, sense: f64| {
        let off = math::scale(sense, arm);
        Body {
            id: id.into(),
            mass_kg: 0.5 * first.mass_kg,
            inertia_kg_m2,
            position_m: math::add(first.position_m, off),
            velocity_m_s: math::cross(first.angular_velocity_rad_s, off),
            shapes: Vec::new(),
            ..first.clone()
        }
    };
    pieces.bodies[0] = piece("a", 1.0);
    pieces.bodies.push(piece("web", -1.0));
    let ends = [elastic(1e9), elastic(1e9)];
    let seam = joint("seam", Some("a"), "web", first.position_m, 1e9, 1e9, ends);
    pieces.bushings.push(Bushing { latent: Some("seam".into()), ..seam });
    // of the velocities of the piece those of the whole: its centre is farther by -arm
    let motion = [[1.0, -arm[1], arm[0]], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let one = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for block in &mut pieces.shared_masses[0].blocks {
        let [p, q] = block.pair.map(|k| if k == 0 { motion } else { one });
        block.added = around(p, block.added, q);
        if block.pair == [0, 0] {
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                block.added[j][i] = block.added[i][j];
            }
        }
    }
    let [a, b, without] =
        [whole.clone(), pieces, Model { shared_masses: Vec::new(), ..whole }].map(|m| simulate(&m).unwrap());
    let most = a.tracked[0].displacement_m.iter().map(|u| u[2].abs()).fold(0.0, f64::max);
    let off = |x: &RunResult, y: &RunResult| {
        let all = x
            .tracked
            .iter()
            .zip(&y.tracked)
            .flat_map(|(p, q)| p.displacement_m.iter().zip(&q.displacement_m));
        all.map(|(u, v)| math::norm(math::sub(*u, *v))).fold(0.0, f64::max)
    };
    assert!(off(&a, &b) < 1e-9 * most, "{} of {most}", off(&a, &b));
    assert!(off(&a, &without) > 1e-2 * most, "{} of {most}", off(&a, &without));
}

/// What is said of a pair of bodies is said of all that is one with them, by the first of them.
#[test]
fn a_rule_for_a_pair_names_the_first_of_what_is_one() {
    let falls_on = |names: Option<[&str; 2]>| {
        let mut m = slab_with_web(None, None);
        m.gravity_m_s2 = [0.0, 0.0, -G];
        m.settings.end_time_s = 1.0;
        m.bodies.push(solid("block", [0.0, 0.0, 1.0], [1.0, 1.0, 0.5]));
        m.bushings.push(joint(
            "foot",
            None,
            "block",
            [0.0, 0.0, 0.75],
            1e8,
            1e8,
            [elastic(1e8), elastic(1e8)],
        ));
        m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
        m.contact.pairs.extend(names.map(|[a, b]| PairRule {
            a: a.into(),
            b: b.into(),
            ignore: true,
            friction: None,
            restitution: None,
            rolling_m: None,
        }));
        simulate(&m)
    };
    let height = |run: &RunResult| run.frames.last().unwrap().position_m[1][2];
    let (rests, passes) = (falls_on(None).unwrap(), falls_on(Some(["slab", "block"])).unwrap());
    assert!(height(&rests) > 1.2 && height(&passes) < -1.0, "{} {}", height(&rests), height(&passes));
    let error = falls_on(Some(["web", "block"])).unwrap_err().to_string();
    assert!(
        error.contains("contact.pairs[0]: names \"web\", which latent bushings hold to \"slab\""),
        "{error}"
    );
}
