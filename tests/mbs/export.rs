//! Exports against readers that know nothing of the writers: what they rebuild is the model.

use fallwerk::export::{Exported, Target, export};
use fallwerk::mbs::Model;
use fallwerk::mbs::ideal::start::fitting_velocities;
use fallwerk::mbs::math::{M3, V3, add, axpy, cross, matmul, mul, norm, qexp, qmat, qmul, sub};
use fallwerk::mbs::model::{Body, Joint, JointKind};
use fallwerk::verify::mbs::models;
use std::collections::BTreeMap;
use std::process::Command;

fn of(file: &str) -> Model {
    models::all().into_iter().find(|n| n.file == file).unwrap_or_else(|| panic!("{file}")).model
}

fn written(model: &Model, target: Target) -> Exported {
    export(model, target).unwrap()
}

/// A chain of turned bodies with every kind of joint, springs and loads, that moves as its joints allow.
fn chain() -> Model {
    let mut model = strained_chain();
    let fitting = fitting_velocities(&model).unwrap().expect("the chain is strained");
    for (body, [v, w]) in model.bodies.iter_mut().zip(fitting) {
        (body.velocity_m_s, body.angular_velocity_rad_s) = (v, w);
    }
    model
}

/// The same with velocities that do not fit its joints.
fn strained_chain() -> Model {
    let kinds = [
        "spherical",
        "revolute",
        "universal",
        "cylindrical",
        "prismatic",
        "fixed",
        "planar",
        "point_on_line",
        "rod",
    ];
    let mut bodies = Vec::new();
    let mut joints = Vec::new();
    for (i, kind) in kinds.iter().enumerate() {
        let x = i as f64;
        let q = qexp([0.3 + 0.1 * x, -0.2 * x, 0.5]);
        bodies.push(serde_json::json!({
            "id": format!("b{i}"), "mass_kg": 1.0 + x, "position_m": [x, 0.1 * x, -0.3], "orientation": q,
            "inertia_kg_m2": [[1.0, 0.1, 0.05], [0.1, 1.2, -0.02], [0.05, -0.02, 0.9]],
            "velocity_m_s": [0.1, 0.2, 0.3], "angular_velocity_rad_s": [0.4, -0.5, 0.6]}));
        let mut joint = serde_json::json!({
            "id": format!("j{i}"), "kind": kind, "body_b": format!("b{i}"), "point_m": [x - 0.5, 0.2, 0.4]});
        if i > 0 {
            joint["body_a"] = format!("b{}", i - 1).into();
        }
        if !matches!(*kind, "spherical" | "fixed" | "rod") {
            joint["axis"] = serde_json::json!([0.6, 0.0, 1.6]);
        }
        match *kind {
            "universal" => joint["axis_b"] = serde_json::json!([0.0, 3.0, 0.0]),
            "rod" => joint["point_b_m"] = serde_json::json!([x, 0.1, 0.2]),
            _ => {}
        }
        joints.push(joint);
    }
    let value = serde_json::json!({
        "schema": "fallwerk-mbs/2", "name": "all -- kinds", "gravity_m_s2": [0.0, 0.0, -9.81],
        "bodies": bodies, "joints": joints,
        "forces": [
            {"kind": "spring", "id": "s", "body_a": "b0", "body_b": "b4", "point_a_m": [0, 0, 0], "point_b_m": [4, 0, 0],
             "stiffness_n_m": 100, "damping_n_s_m": 3},
            {"kind": "torsion", "id": "t", "body_a": "b0", "body_b": "b1", "axis": [0.3, 0, 0.8], "stiffness_nm_rad": 7},
            {"kind": "torsion", "id": "nowhere", "body_a": "b0", "body_b": "b8", "axis": [0, 0, 1], "stiffness_nm_rad": 7},
            {"kind": "force", "id": "f", "body": "b2", "point_m": [2, 0, 0], "force_n": [1, 2, 3], "from_to_s": [0.1, 0.2]},
            {"kind": "torque", "id": "m", "body": "b3", "torque_nm": [1, 2, 3]}],
        "tracked": [{"id": "end", "body": "b8", "point_m": [9, 0, 0]}]});
    let model: Model = serde_json::from_value(value).unwrap();
    model.check().unwrap();
    model
}

fn near(a: V3, b: V3, tolerance: f64, what: &str) {
    assert!(norm(sub(a, b)) < tolerance, "{what}: {a:?} {b:?}");
}

fn rotation(body: &Body) -> M3 {
    qmat(body.orientation)
}

// ---- Adams

/// A statement of a dataset.
#[derive(Debug, Default)]
struct Statement {
    name: String,
    number: usize,
    words: Vec<String>,
    values: BTreeMap<String, String>,
}

impl Statement {
    fn numbers(&self, key: &str) -> Option<Vec<f64>> {
        let text = self.values.get(key)?;
        Some(text.split(',').map(|v| v.trim().parse().unwrap_or_else(|_| panic!("{key} = {text}"))).collect())
    }
    fn vector(&self, key: &str) -> V3 {
        self.numbers(key).map_or([0.0; 3], |v| [v[0], v[1], v[2]])
    }
    fn marker(&self, key: &str) -> usize {
        self.numbers(key).unwrap_or_else(|| panic!("{self:?} has no {key}"))[0] as usize
    }
}

/// Reads a dataset: comments go, lines that begin with a comma belong to the statement above.
fn statements(text: &str) -> Vec<Statement> {
    let mut joined: Vec<String> = Vec::new();
    for line in text.lines().skip(1).map(|l| l.split('!').next().unwrap().trim()).filter(|l| !l.is_empty()) {
        match line.strip_prefix(',') {
            Some(rest) => {
                let last = joined.last_mut().unwrap();
                last.push_str(if last.ends_with('\\') { " " } else { "," });
                last.push_str(rest);
            }
            None => joined.push(line.into()),
        }
    }
    assert_eq!(joined.pop().as_deref(), Some("END"));
    joined.iter().map(|s| statement(s)).collect()
}

fn statement(text: &str) -> Statement {
    let (head, rest) = text.split_once('/').unwrap_or_else(|| panic!("{text}"));
    let mut s = Statement { name: head.into(), ..Statement::default() };
    let mut key = String::new();
    for (i, part) in rest.split(',').map(str::trim).enumerate() {
        if i == 0 {
            s.number = if part.is_empty() { 0 } else { part.parse().unwrap_or_else(|_| panic!("{text}")) };
        } else if let Some((name, value)) = part.split_once('=') {
            key = name.trim().into();
            assert!(s.values.insert(key.clone(), value.trim().into()).is_none(), "{key} twice: {text}");
        } else if key.is_empty() || part.chars().all(|c| c.is_ascii_uppercase() || c == '_') {
            s.words.push(part.into());
        } else {
            let value = s.values.get_mut(&key).unwrap();
            value.push(',');
            value.push_str(part);
        }
    }
    s
}

/// Body-fixed turns about z, x, z.
fn euler(angles: V3) -> M3 {
    let about = |axis: usize, angle: f64| {
        let mut r = [0.0; 3];
        r[axis] = angle;
        qmat(qexp(r))
    };
    matmul(&matmul(&about(2, angles[0]), &about(0, angles[1])), &about(2, angles[2]))
}

/// A dataset, rebuilt.
struct Rebuilt {
    statements: Vec<Statement>,
    /// Origin and rotation of each part, by number.
    parts: BTreeMap<usize, (V3, M3)>,
    /// Part, origin and rotation of each marker.
    markers: BTreeMap<usize, (usize, V3, M3)>,
}

impl Rebuilt {
    fn read(text: &str) -> Self {
        let statements = statements(text);
        let mut parts = BTreeMap::new();
        let mut markers = BTreeMap::new();
        for s in statements.iter().filter(|s| s.name == "PART") {
            parts.insert(s.number, (s.vector("QG"), euler(s.vector("REULER"))));
        }
        for s in statements.iter().filter(|s| s.name == "MARKER") {
            let part = s.marker("PART");
            let (x, r) = parts[&part];
            let place = (part, add(x, mul(&r, s.vector("QP"))), matmul(&r, &euler(s.vector("REULER"))));
            assert!(markers.insert(s.number, place).is_none(), "marker {} twice", s.number);
        }
        Self { statements, parts, markers }
    }

    fn all(&self, name: &str) -> Vec<&Statement> {
        self.statements.iter().filter(|s| s.name == name).collect()
    }

    fn column(&self, marker: usize, k: usize) -> V3 {
        let r = self.markers[&marker].2;
        [r[0][k], r[1][k], r[2][k]]
    }
}

fn check_bodies(model: &Model, data: &Rebuilt) {
    let parts = data.all("PART");
    assert_eq!(parts.len(), model.bodies.len() + 1);
    assert_eq!(parts[0].words, ["GROUND"]);
    for (body, part) in model.bodies.iter().zip(&parts[1..]) {
        assert_eq!(part.numbers("MASS").unwrap(), [body.mass_kg]);
        let (x, r) = data.parts[&part.number];
        near(x, body.position_m, 1e-12, &body.id);
        let (owner, centre, axes) = data.markers[&part.marker("CM")];
        assert_eq!(owner, part.number);
        near(centre, body.position_m, 1e-12, &body.id);
        let ip = part.numbers("IP").unwrap();
        let products = if ip.len() == 6 { [ip[3], ip[4], ip[5]] } else { [0.0; 3] };
        let m = &body.inertia_kg_m2;
        assert_eq!([ip[0], ip[1], ip[2]], [m[0][0], m[1][1], m[2][2]]);
        assert_eq!(products.map(|p| 0.0 - p), [m[0][1], m[0][2], m[1][2]]);
        let one = |key: &str| part.numbers(key).map_or(0.0, |v| v[0]);
        near([one("VX"), one("VY"), one("VZ")], body.velocity_m_s, 1e-12, &body.id);
        let turning = mul(&axes, [one("WX"), one("WY"), one("WZ")]);
        near(turning, body.angular_velocity_rad_s, 1e-12, &body.id);
        for (row, other) in r.iter().zip(&rotation(body)) {
            near(*row, *other, 1e-12, &body.id);
        }
    }
}

fn check_joint(joint: &Joint, data: &Rebuilt, number: usize) {
    let name = match joint.kind {
        JointKind::Spherical => "SPHERICAL",
        JointKind::Revolute => "REVOLUTE",
        JointKind::Universal => "HOOKE",
        JointKind::Cylindrical => "CYLINDRICAL",
        JointKind::Prismatic => "TRANSLATIONAL",
        JointKind::Fixed => "FIXED",
        JointKind::Planar => "PLANAR",
        JointKind::PointOnLine | JointKind::Rod => return,
    };
    let s =
        data.all("JOINT").into_iter().find(|s| s.number == number).unwrap_or_else(|| panic!("{}", joint.id));
    assert_eq!(s.words, [name]);
    let [i, j] = ["I", "J"].map(|k| s.marker(k));
    for marker in [i, j] {
        near(data.markers[&marker].1, joint.point_m, 1e-12, &joint.id);
    }
    assert_ne!(data.markers[&i].0, data.markers[&j].0);
    let along = |marker: usize, k: usize, axis: V3| {
        let sine = norm(cross(data.column(marker, k), axis)) / norm(axis);
        assert!(sine < 1e-12, "{}: {sine}", joint.id);
    };
    match (joint.axis, joint.axis_b) {
        (Some(a), Some(b)) => {
            along(i, 0, a);
            along(j, 1, b);
        }
        (Some(axis), None) => {
            along(i, 2, axis);
            along(j, 2, axis);
        }
        _ => {}
    }
}

#[test]
fn an_adams_dataset_gives_parts_markers_and_joints_back() {
    let mut models: Vec<Model> =
        ["a02-four-bars-2", "a03-squeezer", "topple-flow", "frame4", "portal"].map(of).into();
    models.push(chain());
    for model in &models {
        let exported = written(model, Target::Adams);
        let data = Rebuilt::read(&exported.text);
        check_bodies(model, &data);
        for (i, joint) in model.joints.iter().enumerate() {
            check_joint(joint, &data, i + 1);
        }
        let gravity = &data.all("ACCGRAV")[0];
        let g = ["IGRAV", "JGRAV", "KGRAV"].map(|k| gravity.numbers(k).unwrap()[0]);
        assert_eq!(g, model.gravity_m_s2);
        let requests = data.all("REQUEST");
        assert_eq!(requests.len(), model.tracked.len());
        for (point, s) in model.tracked.iter().zip(requests) {
            near(data.markers[&s.marker("I")].1, point.point_m, 1e-12, &point.id);
        }
        assert_eq!(data.all("BUSHING").len(), model.bushings.len());
        for (bushing, s) in model.bushings.iter().zip(data.all("BUSHING")) {
            let k = s.numbers("K").unwrap();
            assert_eq!(k[0], bushing.axial_stiffness_n_m);
            near(data.column(s.marker("J"), 0), bushing.axes[0], 1e-12, &bushing.id);
            near(data.column(s.marker("I"), 2), bushing.axes[2], 1e-12, &bushing.id);
        }
    }
}

/// Other programs take velocities as they are, or those of joints alone: what is written fits the joints, as it does in a run, and a note says so.
#[test]
fn velocities_that_do_not_fit_are_written_as_they_run() {
    let (strained, fitting) = (strained_chain(), chain());
    for target in [Target::Adams, Target::Mjcf { loose: false }] {
        let [own, other] = [&strained, &fitting].map(|m| written(m, target));
        assert!(other.notes.iter().all(|n| n.id != "bodies"));
        let note = own.notes.iter().find(|n| n.id == "bodies").expect("a note");
        assert!(note.text.contains("do not fit the joints"), "{}", note.text);
    }
    let data = Rebuilt::read(&written(&strained, Target::Adams).text);
    check_bodies(&fitting, &data);
}

/// What events at t = 0 set free starts with the velocity given, along the rail that is left: `(3, 0, 0)` along `(0.6, 0, 0.8)` is `3 · 0.6 (0.6, 0, 0.8)`, in a run and in what is written.
#[test]
fn joints_that_go_at_once_hold_no_initial_velocity() {
    let fixed = |body: &str| serde_json::json!({"id": "gone", "kind": "fixed", "body_a": body, "body_b": "a", "point_m": [0, 0, 0]});
    let rail = serde_json::json!({
        "id": "rail", "kind": "prismatic", "body_b": "a", "point_m": [0, 0, 0], "axis": [0.6, 0, 0.8]});
    let body = |id: &str, x: f64, vx: f64| {
        serde_json::json!({
            "id": id, "mass_kg": 1, "inertia_kg_m2": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]],
            "position_m": [x, 0, 0], "velocity_m_s": [vx, 0, 0]})
    };
    let events = [
        serde_json::json!({"id": "e", "time_s": 0, "release": ["gone"]}),
        serde_json::json!({"id": "e", "time_s": 0, "remove_bodies": ["b"]}),
    ];
    for event in events {
        let is_removal = event.get("release").is_none();
        let model: Model = serde_json::from_value(serde_json::json!({
            "schema": "fallwerk-mbs/2", "name": "debris", "gravity_m_s2": [0, 0, 0],
            "bodies": [body("a", 0.0, 3.0), body("b", 1.0, 0.0)], "joints": [fixed("b"), rail], "events": [event],
            "tracked": [{"id": "p", "body": "a", "point_m": [0, 0, 0]}],
            "settings": {"end_time_s": 1, "output_interval_s": 0.5, "reactions": true}}))
        .unwrap();
        model.check().unwrap();
        let result = fallwerk::mbs::simulate(&model).unwrap();
        let went = result.tracked[0].displacement_m.last().unwrap();
        near(*went, [1.08, 0.0, 1.44], 1e-9, "displacement");
        // 0.5 · 1.8²
        assert!((result.energies.kinetic_j[0] - 1.62).abs() < 1e-9, "{:?}", result.energies.kinetic_j);
        assert!(result.energy_error < 1e-9, "{}", result.energy_error);
        assert!(result.reactions.iter().all(|r| r.force_n.iter().flatten().all(|f| f.abs() < 1e-9)));
        let [v, w] = fitting_velocities(&model).unwrap().expect("it is strained")[0];
        near(v, [1.08, 0.0, 1.44], 1e-12, "velocity");
        near(w, [0.0; 3], 1e-12, "angular velocity");
        let mut fitting = model.clone();
        fitting.bodies[0].velocity_m_s = [1.08, 0.0, 1.44];
        fitting.bodies.truncate(if is_removal { 1 } else { 2 });
        check_bodies(&fitting, &Rebuilt::read(&written(&model, Target::Adams).text));
    }
}

#[test]
fn an_adams_dataset_keeps_to_the_form_of_seen_ones() {
    let known = [
        "UNITS",
        "PART",
        "MARKER",
        "JOINT",
        "JPRIM",
        "GCON",
        "SPRINGDAMPER",
        "VFORCE",
        "VTORQUE",
        "BUSHING",
        "SPLINE",
        "GRAPHICS",
        "CONTACT",
        "ACCGRAV",
        "REQUEST",
        "OUTPUT",
    ];
    for named in models::all().into_iter().filter(|n| n.file != "pile-1000") {
        let text = written(&named.model, Target::Adams).text;
        assert!(text.starts_with("ADAMS/View model name: "));
        for line in text.lines().filter(|l| !l.starts_with('!')) {
            assert!(line.len() <= 80, "{}: {line}", named.file);
            // no exponents: some readers know none
            let exponent =
                line.as_bytes().windows(2).any(|w| w[0].is_ascii_digit() && matches!(w[1], b'e' | b'E'));
            assert!(!exponent, "{}: {line}", named.file);
        }
        let data = Rebuilt::read(&text);
        for s in &data.statements {
            assert!(known.contains(&s.name.as_str()), "{s:?}");
        }
        for s in data.all("SPLINE") {
            let x = s.numbers("X").unwrap();
            assert!(x.len() >= 4 && x.windows(2).all(|p| p[1] > p[0]), "{x:?}");
            assert_eq!(x.len(), s.numbers("Y").unwrap().len());
        }
    }
    // loads with a span, rods and points on lines have statements of their own
    let data = Rebuilt::read(&written(&chain(), Target::Adams).text);
    assert!(data.all("VFORCE")[0].values["FX"].contains("IF(TIME-0.1:0"));
    assert!(data.all("GCON")[0].values["FUNCTION"].starts_with("DM("));
    assert_eq!(data.all("JPRIM")[0].words, ["INLINE"]);
    assert_eq!(data.all("SPRINGDAMPER").len(), 3);
}

// ---- MJCF

/// An element with its attributes and children.
#[derive(Debug, Default)]
struct Element {
    name: String,
    attributes: BTreeMap<String, String>,
    children: Vec<Element>,
}

impl Element {
    fn numbers(&self, key: &str) -> Vec<f64> {
        self.attributes.get(key).map_or(Vec::new(), |t| t.split(' ').map(|v| v.parse().unwrap()).collect())
    }
    fn vector(&self, key: &str) -> V3 {
        self.numbers(key).try_into().unwrap_or([0.0; 3])
    }
    fn named<'a>(&'a self, name: &str, found: &mut Vec<&'a Element>) {
        for child in &self.children {
            if child.name == name {
                found.push(child);
            }
            child.named(name, found);
        }
    }
    fn all(&self, name: &str) -> Vec<&Element> {
        let mut found = Vec::new();
        self.named(name, &mut found);
        found
    }
}

/// Reads the little of XML that a file of elements and attributes needs.
fn xml(text: &str) -> Element {
    let (before, rest) = text.split_once("<!--").unwrap();
    let (comment, rest) = rest.split_once("-->").unwrap();
    assert!(!comment.contains("--"), "two hyphens in a comment");
    let text = before.to_string() + rest;
    let mut stack = vec![Element::default()];
    for tag in text.split('<').skip(1) {
        let tag = tag.trim().strip_suffix('>').unwrap_or_else(|| panic!("{tag}"));
        if tag.starts_with('?') {
            continue;
        }
        if let Some(name) = tag.strip_prefix('/') {
            let done = stack.pop().unwrap();
            assert_eq!(done.name, name);
            stack.last_mut().unwrap().children.push(done);
            continue;
        }
        let (tag, ends) = tag.strip_suffix('/').map_or((tag, false), |t| (t, true));
        let (name, mut rest) = tag.split_once(' ').unwrap_or((tag, ""));
        let mut element = Element { name: name.into(), ..Element::default() };
        while let Some((key, after)) = rest.split_once("=\"") {
            let (value, after) = after.split_once('"').unwrap();
            assert!(
                element.attributes.insert(key.trim().into(), value.into()).is_none(),
                "{key} twice in {tag}"
            );
            rest = after;
        }
        if ends {
            stack.last_mut().unwrap().children.push(element);
        } else {
            stack.push(element);
        }
    }
    assert_eq!(stack.len(), 1, "elements left open");
    stack.pop().unwrap()
}

/// Global poses of all bodies below an element, by name, with the body's element.
fn poses<'a>(element: &'a Element, x: V3, q: [f64; 4], found: &mut Vec<(&'a Element, V3, [f64; 4])>) {
    for body in element.children.iter().filter(|c| c.name == "body") {
        let place = add(x, mul(&qmat(q), body.vector("pos")));
        let own: [f64; 4] = body.numbers("quat").try_into().unwrap_or([1.0, 0.0, 0.0, 0.0]);
        let turn = qmul(q, own);
        found.push((body, place, turn));
        poses(body, place, turn, found);
    }
}

fn check_mjcf(model: &Model, loose: bool) -> Element {
    let root = xml(&written(model, Target::Mjcf { loose }).text);
    let mut found = Vec::new();
    poses(root.all("worldbody")[0], [0.0; 3], [1.0, 0.0, 0.0, 0.0], &mut found);
    found.retain(|(b, ..)| !b.all("inertial").is_empty() && !b.attributes["name"].starts_with("surface "));
    for body in &model.bodies {
        let copies: Vec<_> =
            found.iter().filter(|(b, ..)| b.attributes["name"].split('#').next() == Some(&body.id)).collect();
        let inertial =
            |b: &Element| b.children.iter().find(|c| c.name == "inertial").map(|i| i.numbers("mass")[0]);
        let mass: f64 = copies.iter().filter_map(|(b, ..)| inertial(b)).sum();
        assert!((mass - body.mass_kg).abs() < 1e-9 * mass, "{}: {mass}", body.id);
        for (_, x, q) in copies {
            near(*x, body.position_m, 1e-12, &body.id);
            for (row, other) in qmat(*q).iter().zip(&rotation(body)) {
                near(*row, *other, 1e-12, &body.id);
            }
        }
    }
    // the joint of a chain is where the model has it, along its axis
    for joint in model.joints.iter().filter(|j| j.kind == JointKind::Revolute) {
        let own = found.iter().find_map(|(b, x, q)| {
            let same = |c: &&Element| c.name == "joint" && c.attributes["name"] == joint.id;
            b.children.iter().find(same).map(|j| (j, *x, *q))
        });
        if let Some((element, x, q)) = own {
            let axis = joint.axis.unwrap();
            near(add(x, mul(&qmat(q), element.vector("pos"))), joint.point_m, 1e-12, &joint.id);
            let sine = norm(cross(mul(&qmat(q), element.vector("axis")), axis)) / norm(axis);
            assert!(sine < 1e-12, "{}", joint.id);
        }
    }
    root
}

#[test]
fn an_mjcf_file_gives_bodies_and_joints_back() {
    for named in models::all().into_iter().filter(|n| n.file != "pile-1000") {
        check_mjcf(&named.model, false);
        check_mjcf(&named.model, true);
    }
    let root = check_mjcf(&chain(), false);
    // eight joints of a chain, the rod is a tendon: 3 + 1 + 2 + 2 + 1 + 0 + 3 + 4 velocities and 6 of the body on the rod
    let key = root.all("key")[0];
    assert_eq!(key.numbers("qvel").len(), 3 + 1 + 2 + 2 + 1 + 3 + 4 + 6);
    assert_eq!(key.numbers("qpos").len(), 4 + 1 + 2 + 2 + 1 + 3 + 5 + 7);
}

#[test]
fn velocities_of_the_key_frame_move_the_bodies_as_the_model_says() {
    // four-bars: all verticals turn at -1 rad/s, couplers against them at +1
    let root = check_mjcf(&of("a02-four-bars-2"), false);
    let speeds = root.all("key")[0].numbers("qvel");
    assert_eq!(speeds.len(), 5);
    assert!(
        speeds.iter().all(|s| s.abs() == 1.0) && speeds.contains(&-1.0) && speeds.contains(&1.0),
        "{speeds:?}"
    );
    // a body of the chain's first joint, a ball: its angular velocity in its own frame
    let model = chain();
    let root = check_mjcf(&model, false);
    let turning = root.all("key")[0].numbers("qvel");
    let first: V3 = [turning[0], turning[1], turning[2]];
    let body = &model.bodies[0];
    near(mul(&rotation(body), first), body.angular_velocity_rad_s, 1e-12, "ball");
}

#[test]
fn loops_with_springs_are_cut_in_a_body_and_welded() {
    // four columns carry one slab through bushings: one is the tree, three are copies
    let root = check_mjcf(&of("portal"), false);
    let welds = root.all("weld");
    assert_eq!(welds.len(), 3);
    assert_eq!(root.all("joint").len(), 8 * 6);
    // hinges that break: by default springs in the tree, with loose joints constraints that can be switched off
    let frame = of("frame4");
    let (tree, loose) = (check_mjcf(&frame, false), check_mjcf(&frame, true));
    assert_eq!(tree.all("joint").len(), frame.joints.len());
    assert_eq!((loose.all("freejoint").len(), loose.all("joint").len()), (17, 0));
    let ids: Vec<&str> = loose.all("connect").iter().map(|c| c.attributes["name"].as_str()).collect();
    assert_eq!(ids, frame.joints.iter().map(|j| j.id.as_str()).collect::<Vec<_>>());
}

/// Between the ends of a bushing rotations come first, so that its springs turn with the second body; from that to the first one it is the other way round.
#[test]
fn springs_of_bushings_turn_with_the_second_body() {
    let body = |id: &str, z: f64| serde_json::json!({"id": id, "mass_kg": 1.0, "position_m": [0, 0, z], "inertia_kg_m2": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]});
    for (a, b) in [("m", "n"), ("n", "m")] {
        let bending = serde_json::json!({"kind": "elastic", "stiffness_nm_rad": 5});
        let model: Model = serde_json::from_value(serde_json::json!({
            "schema": fallwerk::mbs::model::MODEL_SCHEMA, "name": "pair", "gravity_m_s2": [0, 0, 0],
            "bodies": [body("m", 0.0), body("n", 2.0)],
            "bushings": [{
                "id": "soft", "body_a": a, "body_b": b, "point_m": [0, 0, 1], "axes": [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
                "axial_stiffness_n_m": 30, "shear_stiffness_n_m": [10, 20], "torsional_stiffness_nm_rad": 6,
                "bending": [bending, bending]}],
            "settings": {"end_time_s": 1, "output_interval_s": 0.1}}))
        .unwrap();
        let root = check_mjcf(&model, false);
        let hangs = |e: &&Element| e.children.iter().any(|c| c.name == "joint");
        let child = root.all("body").into_iter().find(hangs).unwrap();
        let joints = child.children.iter().filter(|c| c.name == "joint");
        let kinds: Vec<&str> = joints.map(|j| j.attributes["type"].as_str()).collect();
        let [first, last] =
            if child.attributes["name"] == b { ["hinge", "slide"] } else { ["slide", "hinge"] };
        assert_eq!(kinds, [first, first, first, last, last, last], "{a} {b}");
    }
}

/// Contact is softer than connections: as stiff as the step allows it throws up what slides.
#[test]
fn contacts_give_way_over_many_steps() {
    for (step_s, contact_s) in [(1e-4, 0.01), (1e-3, 0.02)] {
        let mut model = of("sliding-box");
        model.settings.time_step_s = Some(step_s);
        let root = check_mjcf(&model, false);
        let solref = |name: &str| {
            root.all("default")[0].children.iter().find(|c| c.name == name).unwrap().numbers("solref")
        };
        assert_eq!(root.all("option")[0].numbers("timestep"), [step_s]);
        assert_eq!((solref("geom"), solref("equality")), (vec![contact_s, 1.0], vec![2.0 * step_s, 1.0]));
    }
}

#[test]
fn anchors_of_constraints_lie_on_the_joint() {
    let model = of("a04-bricard");
    let root = check_mjcf(&model, false);
    let ends = root.all("connect");
    assert_eq!(ends.len(), 2, "the loop closes in one revolute");
    let bodies: BTreeMap<&str, &Body> = model.bodies.iter().map(|b| (b.id.as_str(), b)).collect();
    let places: Vec<V3> = ends
        .iter()
        .map(|c| {
            let body = bodies[c.attributes["body1"].as_str()];
            add(body.position_m, mul(&rotation(body), c.vector("anchor")))
        })
        .collect();
    let id = ends[0].attributes["name"].split(':').next().unwrap();
    let joint = model.joints.iter().find(|j| j.id == id).unwrap();
    near(axpy(places[0], 1.0, sub(places[1], places[0])), places[1], 1e-15, "sum");
    near([0, 1, 2].map(|k: usize| 0.5 * (places[0][k] + places[1][k])), joint.point_m, 1e-12, id);
    assert!(norm(cross(sub(places[1], places[0]), joint.axis.unwrap())) < 1e-12);
}

// ---- JSON and the command

#[test]
fn the_normalised_file_is_the_same_model_and_stays_as_it_is() {
    for model in [chain(), of("frame4"), of("portal")] {
        let text = written(&model, Target::Json).text;
        let back: Model = serde_json::from_str(&text).unwrap();
        back.check().unwrap();
        assert_eq!(written(&back, Target::Json).text, text);
        let axis = back.joints.iter().find_map(|j| j.axis);
        assert!(axis.is_none_or(|a| (norm(a) - 1.0).abs() < 1e-15));
        assert_eq!(back.bodies.len(), model.bodies.len());
    }
}

/// A hinge flows about each axis of its first body: about an oblique one it bears what all three bear together.
#[test]
fn a_hinge_about_an_oblique_axis_keeps_its_plastic_moment_in_mjcf() {
    let value = serde_json::json!({
        "schema": "fallwerk-mbs/2", "name": "oblique", "gravity_m_s2": [0.0, 0.0, 0.0],
        "bodies": [{"id": "b", "mass_kg": 1.0, "position_m": [0.0, 0.0, 0.0], "orientation": [1.0, 0.0, 0.0, 0.0],
            "inertia_kg_m2": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            "velocity_m_s": [0.0, 0.0, 0.0], "angular_velocity_rad_s": [0.0, 0.0, 0.0]}],
        "joints": [{"id": "j", "kind": "revolute", "body_b": "b", "point_m": [0.0, 0.0, 0.0], "axis": [1.0, 1.0, 1.0]}],
        "forces": [{"kind": "hinge", "id": "h", "body_b": "b", "stiffness_nm_rad": 1e5, "capacity": [[0.0, 2.0]], "joint": "j"}],
        "settings": {"end_time_s": 1.0, "output_interval_s": 0.1}
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("oblique.json");
    std::fs::write(&path, value.to_string()).unwrap();
    let text = written(&Model::read(&path).unwrap(), Target::Mjcf { loose: false }).text;
    let (_, after) = text.split_once("springyield=\"").unwrap();
    let yields: f64 = after.split('"').next().unwrap().parse().unwrap();
    assert!((yields * 1e5 / (2.0 * 3.0_f64.sqrt()) - 1.0).abs() < 1e-9, "{yields}");
}

#[test]
fn what_is_left_out_is_named_and_strict_makes_it_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("chain.json");
    std::fs::write(&path, written(&chain(), Target::Json).text).unwrap();
    let run = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fallwerk"));
        command.arg("export").arg(&path).args(more).output().unwrap()
    };
    let mjcf = run(&["--to", "mjcf"]);
    assert!(mjcf.status.success());
    let said = String::from_utf8(mjcf.stderr).unwrap();
    assert!(said.contains("left out: nowhere:"), "{said}");
    assert!(said.contains("left out: f:"), "{said}");
    assert!(
        String::from_utf8(mjcf.stdout).unwrap().contains("left out: nowhere:"),
        "not at the head of the file"
    );
    let output = folder.path().join("chain.xml");
    let strict = run(&["--to", "mjcf", "--strict", "-o", output.to_str().unwrap()]);
    assert_eq!(strict.status.code(), Some(2));
    assert!(!output.exists());
    let json = run(&["--to", "json", "--strict", "-o", output.to_str().unwrap()]);
    assert!(json.status.success() && json.stderr.is_empty());
    assert_eq!(std::fs::read_to_string(&output).unwrap(), std::fs::read_to_string(&path).unwrap());
    let wrong = run(&["--to", "adams", "--loose"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8(wrong.stderr).unwrap().contains("--loose"));
}
