//! Datasets of MSC Adams Solver (`.adm`): parts, markers, joints, forces, contacts, requests.
//!
//! Numbers are plain decimals, angles radians; every argument stands on a line of its own. A part's frame is that of the body, with its origin at the centre of
//! mass. Rods are `GCON` statements, which Adams Solver (C++) knows and the older FORTRAN solver does not.
//!
//! | file | owns |
//! |---|---|
//! | `statement` | how a statement is written |
//! | `joint` | joints |
//! | `force` | springs, hinges, bushings, applied forces |
//! | `contact` | shapes and contacts |

mod contact;
mod force;
mod joint;
mod statement;

use super::Notes;
use super::number::list;
use crate::mbs::Model;
use crate::mbs::math::{M3, V3, mul_t, qmat, qunit, sub};
use crate::mbs::model::Body;
use statement::{Dataset, GROUND, number, reuler};

/// The model with what writing needs to know.
struct Writer<'a> {
    model: &'a Model,
    data: Dataset,
    notes: &'a mut Notes,
    /// Marker of the centre of mass of each body.
    centres: Vec<usize>,
    /// Origin of the ground.
    origin: usize,
    /// Splines so far.
    splines: usize,
}

/// The file.
pub(super) fn write(model: &Model, notes: &mut Notes) -> String {
    let mut w = Writer { model, data: Dataset::default(), notes, centres: Vec::new(), origin: 0, splines: 0 };
    w.parts();
    w.joints();
    w.forces();
    w.contacts();
    w.rest();
    let body = w.data.text;
    let mut head = Dataset::default();
    head.text += &format!("ADAMS/View model name: {}\n", super::number::word(&model.name));
    head.comment(&format!("Model \"{}\", SI units, angles in radians.", model.name.replace('\n', " ")));
    for note in &notes.0 {
        head.comment(&format!("left out: {}: {}", note.id, note.text));
    }
    head.section("UNITS");
    let units = ["FORCE = NEWTON", "MASS = KILOGRAM", "LENGTH = METER", "TIME = SECOND"];
    head.statement("UNITS/", &units.map(String::from));
    head.text + &body + "END\n"
}

impl Writer<'_> {
    /// Number of the part of a body, or of the ground.
    fn part(&self, id: Option<&str>) -> usize {
        id.and_then(|id| self.model.bodies.iter().position(|b| b.id == id)).map_or(GROUND, |i| i + 2)
    }

    fn body(&self, part: usize) -> Option<&Body> {
        part.checked_sub(2).and_then(|i| self.model.bodies.get(i))
    }

    /// A marker at a global point with global axes (rows), both at the start.
    fn marker_at(&mut self, part: usize, point: V3, axes: Option<&M3>) -> usize {
        let (x, r) =
            self.body(part).map_or(([0.0; 3], qmat([1.0, 0.0, 0.0, 0.0])), |b| (b.position_m, turn(b)));
        let local = axes.map(|rows| rows.map(|row| mul_t(&r, row)));
        let identity = qmat([1.0, 0.0, 0.0, 0.0]);
        // without axes a marker has those of its part; a global frame on a turned part is said
        let axes = local.unwrap_or(identity);
        self.data.marker(part, mul_t(&r, sub(point, x)), Some(&axes))
    }

    fn parts(&mut self) {
        self.data.section("GROUND");
        self.data.named("PART", GROUND, "ground", &["GROUND".into()]);
        self.origin = self.data.marker(GROUND, [0.0; 3], None);
        self.data.section("PARTS");
        for (i, body) in self.model.bodies.iter().enumerate() {
            // the marker of the centre is the next one after the statement that names it
            let centre = self.origin + 1 + i;
            let mut arguments = vec![number("MASS", body.mass_kg), format!("CM = {centre}"), inertia(body)];
            arguments.push(format!("QG = {}", list(&body.position_m, ", ")));
            arguments.extend(reuler(&turn(body)));
            let [vx, vy, vz] = body.velocity_m_s;
            // angular velocities along the axes of the centre's marker, those of the body
            let [wx, wy, wz] = mul_t(&turn(body), body.angular_velocity_rad_s);
            let speeds = [("VX", vx), ("VY", vy), ("VZ", vz), ("WX", wx), ("WY", wy), ("WZ", wz)];
            arguments.extend(speeds.iter().filter(|(_, v)| *v != 0.0).map(|(name, v)| number(name, *v)));
            self.data.named("PART", i + 2, &body.id, &arguments);
            self.centres.push(self.data.marker(i + 2, [0.0; 3], None));
        }
    }

    /// Gravity, requests, output.
    fn rest(&mut self) {
        self.data.section("GRAVITY AND OUTPUT");
        let [x, y, z] = self.model.gravity_m_s2;
        let gravity = [number("IGRAV", x), number("JGRAV", y), number("KGRAV", z)];
        self.data.statement("ACCGRAV/", &gravity);
        for (i, point) in self.model.tracked.iter().enumerate() {
            let part = self.part(Some(&point.body));
            let marker = self.marker_at(part, point.point_m, None);
            let of = format!("I = {marker}, J = {}", self.origin);
            let comment = format!("COMMENT = {}", point.id.replace(['\n', ','], " "));
            self.data.named("REQUEST", i + 1, &point.id, &["DISPLACEMENT".into(), of, comment]);
        }
        self.data.statement("OUTPUT/", &["REQSAVE".into()]);
    }
}

/// Rotation of a body, from its frame to the ground.
fn turn(body: &Body) -> M3 {
    qmat(qunit(body.orientation))
}

/// Moments, then products if there are any: those of Adams are the integrals of `x y dm`, the negative of the tensor's.
fn inertia(body: &Body) -> String {
    let m = &body.inertia_kg_m2;
    let product = |i: usize, j: usize| -0.5 * (m[i][j] + m[j][i]);
    let products = [product(0, 1), product(0, 2), product(1, 2)];
    let mut values = vec![m[0][0], m[1][1], m[2][2]];
    if products.iter().any(|p| *p != 0.0) {
        values.extend(products);
    }
    format!("IP = {}", list(&values, ", "))
}
