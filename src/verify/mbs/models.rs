//! The cases as model files: what the solver, the exporters and other programs are run on.
//!
//! `fallwerk verify mbs --models DIR` writes them, each beside a table of the known path of its tracked point where there is one.

use super::iftomm::{bricard_points, squeezer_layout};
use crate::mbs::math::{M3, Q, V3, mul, qexp, qmat, qnorm};
use crate::mbs::model::{
    Bending, Body, BodyContact, Bushing, Force, GroundPlane, Joint, JointKind, Model, Origin, Shape,
    TrackedPoint,
};

/// Length, side \[m\] and density \[kg/m³\] of a column.
const COLUMN: [f64; 3] = [3.5, 0.4, 2500.0];
/// Half the length of a column's contact box \[m\]: it stays clear of slabs and ground while its joints hold.
const COLUMN_HALF: f64 = 1.55;
/// Tilt of the toppling column at the start \[rad\].
const TILT: f64 = 0.2;
/// Elastic stiffness of the hinges \[N m/rad\].
const STIFFNESS: f64 = 2e7;
const IDENTITY: Q = [1.0, 0.0, 0.0, 0.0];
const Y: V3 = [0.0, 1.0, 0.0];
const Z: V3 = [0.0, 0.0, 1.0];

/// A model file of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// Name of the file without its ending.
    pub file: &'static str,
    /// The model.
    pub model: Model,
}

/// All model files.
pub fn all() -> Vec<Named> {
    let named = |file, model| Named { file, model };
    vec![
        named("a01-pendulum", pendulum()),
        named("a02-four-bars-2", four_bars(2)),
        named("a02-four-bars-40", four_bars(40)),
        named("a02-four-bars-80", four_bars(80)),
        named("a03-squeezer", squeezer()),
        named("a04-bricard", bricard()),
        named("topple-flow", topple(3e3, 1.9)),
        named("topple-elastic", topple(60e3, 0.2)),
        named("frame2", frame("frame2", 2.0)),
        named("frame4", frame("frame4", 7.0)),
        named("portal", portal()),
        named("sliding-box", sliding_box()),
        named("pile-1000", pile()),
    ]
}

/// A model without parts.
fn empty(name: &str, gravity_m_s2: V3, end_time_s: f64, output_interval_s: f64) -> Model {
    let mut model = Model::empty(name, gravity_m_s2, end_time_s, output_interval_s);
    model.settings.tolerance = 1e-8;
    model
}

fn diagonal([a, b, c]: V3) -> M3 {
    [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]
}

pub(super) fn body(id: &str, mass_kg: f64, principal_kg_m2: V3, position_m: V3) -> Body {
    Body {
        id: id.into(),
        mass_kg,
        inertia_kg_m2: diagonal(principal_kg_m2),
        position_m,
        orientation: IDENTITY,
        velocity_m_s: [0.0; 3],
        angular_velocity_rad_s: [0.0; 3],
        shapes: Vec::new(),
        origin: Origin::default(),
    }
}

/// A solid box of some density \[kg/m³\]; no contact shape.
pub(super) fn solid(id: &str, density: f64, size_m: V3, position_m: V3) -> Body {
    let [x, y, z] = size_m;
    let mass = density * x * y * z;
    let principal = [y * y + z * z, x * x + z * z, x * x + y * y].map(|s| mass * s / 12.0);
    body(id, mass, principal, position_m)
}

pub(super) fn joint(
    id: String,
    kind: JointKind,
    bodies: [Option<&str>; 2],
    point_m: V3,
    axis: Option<V3>,
) -> Joint {
    Joint {
        id,
        kind,
        body_a: bodies[0].map(str::to_string),
        body_b: bodies[1].unwrap_or_default().to_string(),
        point_m,
        point_b_m: None,
        axis,
        axis_b: None,
        origin: Origin::default(),
    }
}

pub(super) fn revolute(id: String, bodies: [Option<&str>; 2], point_m: V3, axis: V3) -> Joint {
    joint(id, JointKind::Revolute, bodies, point_m, Some(axis))
}

fn tracked(id: &str, body: &str, point_m: V3) -> TrackedPoint {
    TrackedPoint { id: id.into(), body: body.into(), point_m }
}

const DOWN_Y: V3 = [0.0, -9.81, 0.0];
const DOWN_Z: V3 = [0.0, 0.0, -9.81];

fn pendulum() -> Model {
    let mut m = empty("Simple pendulum (IFToMM A01)", DOWN_Y, 10.0, 0.05);
    let at = [-1.0, 0.0, 0.0];
    m.bodies.push(body("bob", 1.0, [1.0; 3], at));
    let rod = joint("rod".into(), JointKind::Rod, [None, Some("bob")], [0.0; 3], None);
    m.joints.push(Joint { point_b_m: Some(at), ..rod });
    m.tracked.push(tracked("bob", "bob", at));
    m
}

/// So many four-bars in a row.
fn four_bars(count: usize) -> Model {
    let mut m = empty(&format!("{count} four-bars in a row (IFToMM A02)"), DOWN_Y, 20.0, 0.05);
    let bar = |id: &str, x: f64, y: f64| body(id, 1.0, [1.0 / 12.0; 3], [x, y, 0.0]);
    let vertical = |i: usize| format!("vertical-{i}");
    for i in 0..=count {
        let (x, id) = (i as f64, vertical(i));
        let (velocity_m_s, angular_velocity_rad_s) = ([0.5, 0.0, 0.0], [0.0, 0.0, -1.0]);
        m.bodies.push(Body { velocity_m_s, angular_velocity_rad_s, ..bar(&id, x, 0.5) });
        m.joints.push(revolute(format!("A{i}"), [None, Some(&id)], [x, 0.0, 0.0], Z));
    }
    for i in 0..count {
        let (x, id) = (i as f64, format!("coupler-{i}"));
        m.bodies.push(Body { velocity_m_s: [1.0, 0.0, 0.0], ..bar(&id, x + 0.5, 1.0) });
        let (left, right) = (vertical(i), vertical(i + 1));
        m.joints.push(revolute(format!("B{i}"), [Some(&left), Some(&id)], [x, 1.0, 0.0], Z));
        let end = revolute(format!("B{}-{i}", i + 1), [Some(&id), Some(&right)], [x + 1.0, 1.0, 0.0], Z);
        m.joints.push(end);
    }
    m.tracked.push(tracked("B0", "vertical-0", [0.0, 1.0, 0.0]));
    m
}

/// Andrews' squeezer.
fn squeezer() -> Model {
    let mut m = empty("Andrews' squeezer (IFToMM A03)", [0.0; 3], 0.05, 0.005);
    let layout = squeezer_layout();
    let ids: Vec<String> = (1..=7).map(|i| format!("K{i}")).collect();
    for (i, id) in ids.iter().enumerate() {
        let orientation = qexp([0.0, 0.0, if i == 0 { layout.crank_rad } else { 0.0 }]);
        let (mass, moment) = layout.masses[i];
        m.bodies.push(Body { orientation, ..body(id, mass, [moment; 3], layout.centres_m[i]) });
    }
    for (i, (bodies, at)) in layout.pins.iter().enumerate() {
        let of = bodies.map(|b| b.map(|b| ids[b].as_str()));
        m.joints.push(revolute(format!("J{}", i + 1), of, *at, Z));
    }
    let [d, c] = layout.spring_m;
    m.forces.push(Force::Spring {
        id: "spring".into(),
        body_a: None,
        body_b: ids[2].clone(),
        point_a_m: c,
        point_b_m: d,
        length_m: Some(0.07785),
        stiffness_n_m: 4530.0,
        damping_n_s_m: 0.0,
    });
    let (body, torque_nm) = (ids[0].clone(), [0.0, 0.0, 0.033]);
    m.forces.push(Force::Torque { id: "motor".into(), body, torque_nm, from_to_s: None });
    m.tracked.push(tracked("F", &ids[0], layout.pins[1].1));
    m
}

/// Bricard's mechanism.
fn bricard() -> Model {
    let mut m = empty("Bricard's mechanism (IFToMM A04)", DOWN_Y, 10.0, 0.05);
    let points = bricard_points();
    let ids: Vec<String> = (1..=5).map(|i| format!("rod-{i}")).collect();
    for (i, id) in ids.iter().enumerate() {
        let (a, b) = (points[i], points[i + 1]);
        let centre: V3 = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
        let principal: V3 = std::array::from_fn(|k| if a[k] != b[k] { 0.02 / 12.0 } else { 1.01 / 12.0 });
        m.bodies.push(body(id, 1.0, principal, centre));
    }
    for (i, axis) in [1, 2, 0, 1, 2, 0].into_iter().enumerate() {
        let of = |b: Option<usize>| b.and_then(|b| ids.get(b)).map(String::as_str);
        let along: V3 = std::array::from_fn(|k| f64::from(u8::from(k == axis)));
        // the last joint joins the last rod to the ground
        let bodies = if i == 5 { [None, of(Some(4))] } else { [of(i.checked_sub(1)), of(Some(i))] };
        m.joints.push(revolute(format!("P{i}"), bodies, points[i], along));
    }
    m.tracked.push(tracked("P3", &ids[1], points[2]));
    m
}

fn hinge(id: String, a: Option<&str>, b: &str, capacity: Vec<[f64; 2]>) -> Force {
    Force::Hinge {
        id,
        body_a: a.map(str::to_string),
        body_b: b.into(),
        stiffness_nm_rad: STIFFNESS,
        capacity,
        fracture_rad: None,
        joint: None,
    }
}

/// A leaning column on a hinge of constant capacity.
fn topple(capacity_nm: f64, end_time_s: f64) -> Model {
    let [length, side, density] = COLUMN;
    let name = format!("Toppling column, hinge of {} kN m", 1e-3 * capacity_nm);
    let mut m = empty(&name, DOWN_Z, end_time_s, 0.01);
    let turn = qexp([0.0, TILT, 0.0]);
    let on_axis = |z: f64| mul(&qmat(turn), [0.0, 0.0, z]);
    let column = solid("column", density, [side, side, length], on_axis(0.5 * length));
    m.bodies.push(Body { orientation: turn, ..column });
    m.joints.push(revolute("base".into(), [None, Some("column")], [0.0; 3], Y));
    m.forces.push(hinge("hinge".into(), None, "column", vec![[0.0, capacity_nm]]));
    m.tracked.push(tracked("top", "column", on_axis(length)));
    m
}

/// Three slabs on columns with hinges at both ends; ground columns stand where `y > missing_below_m`.
fn frame(name: &str, missing_below_m: f64) -> Model {
    let [height, side, density] = COLUMN;
    let mut m = empty(&format!("Falling frame ({name})"), DOWN_Z, 2.0, 0.01);
    let slab = |storey: usize| format!("slab-{storey}");
    let size = [6.4f64, 10.4, 0.25];
    for storey in 1..=3 {
        let at = [3.0, 5.0, height * storey as f64];
        let shapes = vec![Shape::cuboid([0.0; 3], size.map(|s| 0.5 * s))];
        m.bodies.push(Body { shapes, ..solid(&slab(storey), density, size, at) });
    }
    for storey in 1..=3 {
        let below = (storey > 1).then(|| slab(storey - 1));
        for (k, (x, y)) in
            [(0.0, 0.0), (6.0, 0.0), (0.0, 5.0), (6.0, 5.0), (0.0, 10.0), (6.0, 10.0)].iter().enumerate()
        {
            if storey == 1 && *y < missing_below_m {
                continue;
            }
            let (id, foot) = (format!("column-{storey}{}", k + 1), height * (storey - 1) as f64);
            let shapes = vec![Shape::cuboid([0.0; 3], [0.5 * side, 0.5 * side, COLUMN_HALF])];
            let column = solid(&id, density, [side, side, height], [*x, *y, foot + 0.5 * height]);
            m.bodies.push(Body { shapes, ..column });
            let above = slab(storey);
            let ends =
                [("foot", below.as_deref(), id.as_str(), foot), ("head", Some(&*id), &above, foot + height)];
            for (end, a, b, z) in ends {
                let name = format!("{id}-{end}");
                m.joints.push(joint(name.clone(), JointKind::Spherical, [a, Some(b)], [*x, *y, z], None));
                m.forces.push(breaking_hinge(&name, a, b));
            }
        }
    }
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    m.tracked.push(tracked("roof-corner", &slab(3), [6.2, -0.2, 10.5]));
    m
}

/// The hinge of a spherical joint that yields, softens and breaks.
fn breaking_hinge(name: &str, a: Option<&str>, b: &str) -> Force {
    Force::Hinge {
        id: format!("{name}-hinge"),
        body_a: a.map(str::to_string),
        body_b: b.into(),
        stiffness_nm_rad: STIFFNESS,
        capacity: vec![[0.0, 120e3], [0.03, 120e3], [0.15, 0.0]],
        fracture_rad: Some(0.5),
        joint: Some(name.to_string()),
    }
}

/// A slab that swings on four columns with elastic bushings at both ends: loops of compliant connections.
fn portal() -> Model {
    let mut m = empty("Portal on elastic bushings", DOWN_Z, 1.0, 0.01);
    let slab = solid("slab", 2500.0, [4.4, 4.4, 0.25], [0.0, 0.0, 3.0]);
    m.bodies.push(Body { velocity_m_s: [0.5, 0.2, 0.0], ..slab });
    for (k, (x, y)) in [(-2.0, -2.0), (2.0, -2.0), (-2.0, 2.0), (2.0, 2.0)].into_iter().enumerate() {
        let id = format!("column-{}", k + 1);
        m.bodies.push(solid(&id, 2500.0, [0.4, 0.4, 3.0], [x, y, 1.5]));
        for (end, a, b, z) in
            [("foot", None, id.clone(), 0.0), ("head", Some(id.clone()), "slab".into(), 3.0)]
        {
            m.bushings.push(elastic(format!("{id}-{end}"), a, b, [x, y, z]));
        }
    }
    m.tracked.push(tracked("corner", "slab", [2.2, 2.2, 3.0]));
    m
}

/// A bushing whose first axis is up, of one stiffness \[N/m\], from which its body hangs as long as it weighs no more than a strength \[N\].
pub(super) fn held(id: String, body: String, point_m: V3, stiffness_n_m: f64, strength_n: f64) -> Bushing {
    Bushing {
        axial_stiffness_n_m: stiffness_n_m,
        shear_stiffness_n_m: [stiffness_n_m; 2],
        torsional_stiffness_nm_rad: stiffness_n_m,
        bending: [0; 2].map(|_| Bending::Elastic { stiffness_nm_rad: stiffness_n_m }),
        tensile_capacity_n: Some(strength_n),
        ..elastic(id, None, body, point_m)
    }
}

/// A bushing whose first axis is up.
pub(super) fn elastic(id: String, body_a: Option<String>, body_b: String, point_m: V3) -> Bushing {
    Bushing {
        axial_stiffness_n_m: 2e8,
        shear_stiffness_n_m: [1e8, 8e7],
        torsional_stiffness_nm_rad: 3e6,
        bending: [Bending::Elastic { stiffness_nm_rad: 4e6 }, Bending::Elastic { stiffness_nm_rad: 5e6 }],
        ..Bushing::free(id, body_a, body_b, point_m, [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    }
}

/// A box that slides on the ground until friction stops it.
fn sliding_box() -> Model {
    let mut m = empty("Sliding box", DOWN_Z, 1.5, 0.01);
    let size = [1.0, 1.0, 0.2];
    let shapes = vec![Shape::cuboid([0.0; 3], size.map(|s| 0.5 * s))];
    let own = solid("box", 2500.0, size, [0.0, 0.0, 0.1]);
    m.bodies.push(Body { shapes, velocity_m_s: [5.0, 0.0, 0.0], ..own });
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    m.tracked.push(tracked("centre", "box", [0.0, 0.0, 0.1]));
    m
}

/// 1000 cubes of 0.4 m, turned at random, dropped onto the ground.
fn pile() -> Model {
    let mut m = empty("Pile of 1000 cubes", DOWN_Z, 5.0, 0.05);
    let mut next = random(1);
    for i in 0..1000 {
        let [x, y, z] = [i % 10, i / 10 % 10, i / 100].map(|n| 0.72 * f64::from(n));
        let own = solid(&format!("cube-{i:03}"), 2500.0, [0.4; 3], [x - 3.24, y - 3.24, z + 0.5]);
        let shapes = vec![Shape::cuboid([0.0; 3], [0.2; 3])];
        m.bodies.push(Body { shapes, orientation: random_turn(&mut next), ..own });
    }
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    m
}

/// Numbers from -1 to 1 that look random and are the same every time (SplitMix64, Steele, Lea and Flood 2014).
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A turn, all of them equally likely: a point of the unit ball of four dimensions, by rejection.
fn random_turn(next: &mut impl FnMut() -> f64) -> Q {
    loop {
        let q: Q = std::array::from_fn(|_| next());
        let length = qnorm(q);
        if length <= 1.0 && length > 0.1 {
            return q.map(|v| v / length);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mbs::math::{add, norm, scale, sub};
    use crate::verify::mbs::known;

    fn apart(a: V3, b: V3) -> f64 {
        norm(sub(a, b))
    }

    #[test]
    fn every_model_is_accepted_and_its_files_have_different_names() {
        let models = all();
        for named in &models {
            named.model.check().unwrap_or_else(|e| panic!("{}: {e}", named.file));
        }
        let mut names: Vec<&str> = models.iter().map(|n| n.file).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), models.len());
    }

    #[test]
    fn models_are_the_mechanisms_that_the_manual_runs() {
        let models = all();
        for case in known() {
            let named =
                models.iter().find(|n| n.file == case.file).unwrap_or_else(|| panic!("{}", case.file));
            let (m, own) = (&named.model, &case.mechanism);
            assert_eq!(
                (m.bodies.len(), m.joints.len()),
                (own.bodies.len(), own.joints.len()),
                "{}",
                case.file
            );
            assert_eq!(m.forces.len(), own.forces.len(), "{}", case.file);
            assert_eq!(m.gravity_m_s2, own.gravity_m_s2);
            for (a, b) in m.bodies.iter().zip(&own.bodies) {
                assert!(apart(a.position_m, b.position_m) < 1e-14, "{}: {}", case.file, a.id);
                assert!((a.mass_kg - b.mass_kg).abs() < 1e-9 * b.mass_kg, "{}: {}", case.file, a.id);
                let turn: f64 = (0..4).map(|i| a.orientation[i] * b.orientation[i]).sum();
                assert!((turn.abs() - 1.0).abs() < 1e-14);
                assert_eq!(a.velocity_m_s, b.velocity_m_s);
                assert_eq!(a.angular_velocity_rad_s, b.angular_velocity_rad_s);
                for (row, other) in a.inertia_kg_m2.iter().zip(&b.inertia_kg_m2) {
                    assert!(apart(*row, *other) < 1e-9 * norm(*other), "{}: {}", case.file, a.id);
                }
            }
            for (a, b) in m.joints.iter().zip(&own.joints) {
                assert!(apart(a.point_m, b.points_m[0]) < 1e-14, "{}: {}", case.file, a.id);
                if let Some(axis) = a.axis {
                    assert!(
                        apart(scale(1.0 / norm(axis), axis), b.axes[0]) < 1e-14,
                        "{}: {}",
                        case.file,
                        a.id
                    );
                }
            }
            let point = &m.tracked[0];
            let (index, local) = case.point;
            let carrier = &m.bodies[index];
            assert_eq!(carrier.id, point.body);
            let place = add(carrier.position_m, mul(&qmat(carrier.orientation), local));
            assert!(apart(point.point_m, place) < 1e-14, "{}", case.file);
        }
    }
}
