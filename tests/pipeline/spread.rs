//! How far runs come apart that differ by next to nothing.

use fallwerk::mbs::model::{Body, BodyContact, GroundPlane, Model, Origin, Shape, TrackedPoint};
use fallwerk::mbs::{RunResult, simulate};
use fallwerk::validate::Spread;
use fallwerk::validate::spread::{NUDGE, UNDECIDED_M, nudged};

/// Cubes of a metre and a kilogram that turn above the ground and hit it and each other.
fn dice(count: u32, end_s: f64) -> Model {
    let mut model = Model::empty("dice", [0.0, 0.0, -10.0], end_s, 0.1);
    model.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.9 });
    model.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.9 });
    for k in 0..count {
        let (id, k) = (format!("b{k}"), f64::from(k));
        let position_m = [0.3 * k, 0.2 * k, 1.5 + 1.2 * k];
        model.bodies.push(Body {
            id: id.clone(),
            mass_kg: 1.0,
            inertia_kg_m2: [[1.0 / 6.0, 0.0, 0.0], [0.0, 1.0 / 6.0, 0.0], [0.0, 0.0, 1.0 / 6.0]],
            position_m,
            orientation: [1.0, 0.0, 0.0, 0.0],
            velocity_m_s: [0.0; 3],
            angular_velocity_rad_s: [1.0 + k, 2.0 - k, 0.5],
            shapes: vec![Shape::cuboid([0.0; 3], [0.5; 3])],
            origin: Origin::default(),
        });
        model.tracked.push(TrackedPoint { id: id.clone(), body: id, point_m: position_m });
    }
    model
}

fn runs(model: &Model) -> Vec<RunResult> {
    (0..3).map(|k| simulate(&nudged(model, f64::from(k))).unwrap()).collect()
}

#[test]
fn what_falls_freely_ends_where_gravity_says() {
    let mut model = dice(2, 0.5);
    (model.contact.ground, model.contact.bodies) = (None, None);
    let spread = Spread::of(&runs(&model)).unwrap();
    let expected = 2.0 * NUDGE * 0.5 * 10.0 * 0.25;
    assert!((spread.largest_m / expected - 1.0).abs() < 1e-3, "{} {expected}", spread.largest_m);
    assert!(spread.words().contains("does not hang on rounding"), "{}", spread.words());
    assert_eq!(Spread::of(&runs(&model)[..1]), None);
}

/// Every impact of edges and corners multiplies the change.
#[test]
fn what_impacts_make_of_a_change_is_told_with_its_place() {
    let spread = Spread::of(&runs(&dice(6, 8.0))).unwrap();
    println!("{}", spread.words());
    assert!(spread.largest_m > UNDECIDED_M, "{spread:?}");
    assert!(spread.median_m <= spread.largest_m && spread.point.starts_with('b'));
    assert!(spread.words().contains("one outcome of several"), "{}", spread.words());
}
