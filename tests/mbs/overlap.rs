//! What begins inside something else stays there, and a warning tells.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::simulate;

const KEPT: &str = "contacts keep such an overlap and do not push the solids apart";

fn scene() -> Model {
    let mut m = model("overlap", 0.02, 0.01);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    m
}

/// Remarks about overlaps.
fn told(m: &Model) -> Vec<String> {
    let warnings = simulate(m).unwrap().warnings;
    warnings.into_iter().filter(|w| w.contains("keep such an overlap")).collect()
}

fn ball(id: &str, position_m: [f64; 3], radius_m: f64) -> Body {
    let mut body = solid(id, position_m, [1.0; 3]);
    body.shapes = vec![Shape::Sphere { center_m: [0.0; 3], radius_m }];
    body
}

fn hull(id: &str, position_m: [f64; 3], half_m: f64) -> Body {
    let mut body = solid(id, position_m, [1.0; 3]);
    body.shapes = vec![Shape::Hull { points_m: Shape::cuboid([0.0; 3], [half_m; 3]).corners() }];
    body
}

#[test]
fn a_body_under_the_ground_is_told() {
    let mut m = scene();
    m.bodies.push(solid("a", [0.0, 0.0, -3.0], [1.0; 3]));
    let [said] = &told(&m)[..] else { panic!("{:?}", told(&m)) };
    assert!(
        said.starts_with("at the start \"a\" is 3.5000 m inside \"ground\", more than a tenth"),
        "{said}"
    );
    assert!(said.contains(KEPT), "{said}");
    m.contact.pairs.push(PairRule {
        a: "a".into(),
        b: "ground".into(),
        ignore: true,
        friction: None,
        restitution: None,
        rolling_m: None,
    });
    assert!(told(&m).is_empty(), "who passes through is in nothing");
}

/// All kinds of solids, bodies and obstacles, turned or not: what overlaps by more than a tenth of the thinner one is told, with its depth.
#[test]
fn solids_in_each_other_are_told_with_their_depth() {
    let said = |bodies: Vec<Body>| {
        let mut m = scene();
        m.contact.obstacles.push(ObstacleBox {
            id: "wall".into(),
            min_m: [5.0, -9.0, 0.0],
            max_m: [6.0, 9.0, 9.0],
            friction: 0.5,
            restitution: 0.0,
        });
        m.bodies = bodies;
        told(&m).join("\n")
    };
    let cube = |id: &str, at: [f64; 3]| solid(id, at, [1.0; 3]);
    let mut turned = cube("b", [0.0, 0.0, 0.5 + 0.5 + 0.5_f64.sqrt() - 0.2]);
    turned.orientation = {
        let half = std::f64::consts::FRAC_PI_8;
        [half.cos(), half.sin(), 0.0, 0.0]
    };
    for (bodies, expected) in [
        (vec![cube("a", [0.0, 0.0, 0.5]), cube("b", [0.0, 0.0, 0.9])], "\"a\" is 0.6000 m inside \"b\""),
        (vec![cube("a", [0.0, 0.0, 0.5]), turned], "\"a\" is 0.2000 m inside \"b\""),
        (vec![cube("a", [0.0, 0.0, 0.5]), ball("b", [0.3, 0.0, 1.1], 0.3)], "\"a\" is 0.2000 m inside \"b\""),
        (
            vec![ball("a", [0.0, 0.0, 0.5], 0.5), ball("b", [0.0, 0.0, 0.5], 0.5)],
            "\"a\" is 1.0000 m inside \"b\"",
        ),
        (vec![cube("a", [0.0, 0.0, 0.5]), hull("b", [0.0, 0.0, 1.1], 0.3)], "\"a\" is 0.2000 m inside \"b\""),
        (vec![hull("a", [4.7, 0.0, 3.0], 0.5)], "\"a\" is 0.2000 m inside \"wall\""),
        (vec![cube("a", [4.6, 0.0, 3.0])], ""),
        (vec![cube("a", [0.0, 0.0, 0.45]), cube("b", [0.0, 0.0, 1.44])], ""),
        // beside each other on a wide slab: the line between the centres lies in both
        (vec![solid("slab", [0.0, 0.0, 0.1], [9.0, 9.0, 0.2]), ball("b", [3.0, 3.0, 0.7], 0.5)], ""),
        (vec![solid("slab", [0.0, 0.0, 0.1], [9.0, 9.0, 0.2]), hull("b", [3.0, 3.0, 0.7], 0.5)], ""),
    ] {
        let said = said(bodies);
        match expected {
            "" => assert_eq!(said, ""),
            _ => assert!(
                said.starts_with(&format!("at the start {expected}, more than")),
                "{expected}: {said}"
            ),
        }
    }
}

#[test]
fn many_overlaps_are_one_remark() {
    let mut m = scene();
    for i in 0..6 {
        let [x, depth] = [3.0 * f64::from(i), 0.2 + 0.1 * f64::from(i)];
        m.bodies.push(solid(&format!("b{i}"), [x, 0.0, 0.5 - depth], [1.0; 3]));
    }
    let [said] = &told(&m)[..] else { panic!("{:?}", told(&m)) };
    let expected = "at the start \"b5\" is 0.7000 m inside \"ground\", \"b4\" is 0.6000 m inside \"ground\", \"b3\" is 0.5000 m inside \"ground\" and 3 more pairs overlap, more than";
    assert!(said.starts_with(expected), "{said}");
}

/// Bodies that a joint or a bushing connects do not touch, so that they may overlap.
#[test]
fn joined_bodies_may_overlap() {
    let mut m = scene();
    m.bodies.push(solid("a", [0.0, 0.0, 0.5], [1.0; 3]));
    m.bodies.push(solid("b", [0.0, 0.0, 1.2], [1.0; 3]));
    assert_eq!(told(&m).len(), 1);
    m.bushings.push(joint("j", Some("a"), "b", [0.0, 0.0, 0.85], 1e8, 1e7, [elastic(1e7), elastic(1e7)]));
    assert!(told(&m).is_empty());
    m.bushings.clear();
    m.joints.push(Joint {
        id: "pin".into(),
        kind: JointKind::Fixed,
        body_a: Some("a".into()),
        body_b: "b".into(),
        point_m: [0.0, 0.0, 0.85],
        axis: None,
        axis_b: None,
        point_b_m: None,
        origin: Origin::default(),
    });
    assert!(told(&m).is_empty());
    // in models with ideal joints as well
    m.bodies.push(solid("c", [0.0, 0.0, 2.0], [1.0; 3]));
    let [said] = &told(&m)[..] else { panic!("{:?}", told(&m)) };
    assert!(said.starts_with("at the start \"b\" is 0.2000 m inside \"c\""), "{said}");
}
