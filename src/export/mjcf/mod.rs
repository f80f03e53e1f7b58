//! MJCF, the XML of MuJoCo (4.0 or later, for `springyield`).
//!
//! | here | there |
//! |---|---|
//! | joints that form a tree | joints of MuJoCo, exact |
//! | spherical, revolute, fixed joints that close loops | `connect` (two for a revolute), `weld` |
//! | rods | spatial tendons of constant length |
//! | torsion springs, hinges, bushings | springs on joints of the tree; a loop is cut in the body behind them, whose halves are welded |
//! | springs | spatial tendons |
//! | forces and torques | actuators of constant force |
//! | shapes, surfaces, rules for pairs | geoms, `exclude`, `pair` |
//! | tracked points | sites with a position sensor |

mod body;
mod contact;
mod dof;
mod parts;
mod tree;

use super::Notes;
use super::number::{list, plain};
use crate::mbs::Model;
use crate::mbs::frequency::highest_rad_s;
use crate::mbs::system::System;
use body::Writer;

/// Step of a bushing's highest frequency: `FRACTION / ω`.
const FRACTION: f64 = 0.3;
/// Time constant of contact in steps. With 2 a box that slides at 5 m/s is thrown up by 0.2 m whatever the step, with 10 by 10 mm, with 20 by 2 mm
/// (MuJoCo 4.0.0).
const CONTACT_STEPS: f64 = 20.0;
/// Least time constant of contact \[s\]. Below it bodies give way by fractions of a millimetre less, and more steps gain nothing.
const CONTACT_LEAST_S: f64 = 0.01;

/// Lines with their indent.
#[derive(Debug, Default)]
struct Sheet {
    text: String,
    depth: usize,
}

impl Sheet {
    fn line(&mut self, line: &str) {
        self.text.push_str(&"  ".repeat(self.depth));
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn open(&mut self, line: &str) {
        self.line(line);
        self.depth += 1;
    }

    fn close(&mut self, line: &str) {
        self.depth -= 1;
        self.line(line);
    }
}

/// Text in quotes.
fn attribute(text: &str) -> String {
    let safe = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    format!("\"{safe}\"")
}

/// Numbers in quotes.
fn vector(values: &[f64]) -> String {
    format!("\"{}\"", list(values, " "))
}

/// The file.
pub(super) fn write(model: &Model, loose: bool, notes: &mut Notes) -> String {
    let tree = tree::tree(model, loose);
    let sites = parts::sites(model);
    parts::note_unplaced(model, &tree, notes);
    let mut writer = Writer {
        model,
        tree: &tree,
        sites: &sites,
        sheet: Sheet { depth: 1, ..Sheet::default() },
        notes,
        state: [Vec::new(), Vec::new()],
        yields: false,
    };
    writer.sheet.open("<worldbody>");
    contact::surfaces(&mut writer.sheet, model);
    writer.ground_sites();
    for &root in &tree.roots {
        writer.node(root, None);
    }
    writer.sheet.close("</worldbody>");
    let (Sheet { text: bodies, .. }, state, yields) = (writer.sheet, writer.state, writer.yields);

    let step = step_s(model);
    let mut rest = Sheet { depth: 1, ..Sheet::default() };
    contact::pairs(&mut rest, model, notes);
    parts::equalities(&mut rest, model, &tree);
    parts::tendons(&mut rest, model);
    parts::actuators(&mut rest, model, notes);
    parts::sensors(&mut rest, model);
    keyframe(&mut rest, model, &state);

    let mut head = Sheet::default();
    head.line("<?xml version=\"1.0\" encoding=\"utf-8\"?>");
    head.line(&comment(model, loose, notes));
    head.open(&format!("<mujoco model={}>", attribute(&model.name)));
    head.line("<compiler angle=\"radian\" autolimits=\"true\"/>");
    // the springs that yield are right with an explicit spring only; without them and without contact nothing speaks against fourth order
    let smooth = !yields && !has_contact(model);
    head.line(&format!(
        "<option timestep=\"{}\" gravity={} integrator=\"{}\" cone=\"elliptic\" solver=\"Newton\" iterations=\"100\" tolerance=\"1e-12\"/>",
        plain(step),
        vector(&model.gravity_m_s2),
        if smooth { "RK4" } else { "implicitfast" }
    ));
    head.open("<default>");
    let time_constant = |s: f64| format!("solref=\"{} 1\"", plain(s));
    let give = time_constant(contact_s(step));
    head.line(&format!("<geom condim=\"3\" {give} solimp=\"0.9 0.99 0.001 0.5 2\"/>"));
    // as stiff as the step allows
    let stiff = time_constant(2.0 * step);
    head.line(&format!("<equality {stiff} solimp=\"0.9999 0.9999 0.001 0.5 2\"/>"));
    head.close("</default>");
    contact::meshes(&mut head, model);
    head.text + &bodies + &rest.text + "</mujoco>\n"
}

fn has_contact(model: &Model) -> bool {
    let c = &model.contact;
    let anything =
        c.ground.is_some() || c.bodies.is_some() || !c.planes.is_empty() || !c.obstacles.is_empty();
    anything && model.bodies.iter().any(|b| !b.shapes.is_empty())
}

/// The model's own step, or 1 ms, a fiftieth of the output interval, what the stiffest bushing allows: the shortest.
fn step_s(model: &Model) -> f64 {
    let bushings = System::new(model).map(|mut s| highest_rad_s(&mut s)).unwrap_or(0.0);
    let shortest = model.settings.time_step_s.unwrap_or(1e-3f64.min(model.settings.output_interval_s / 50.0));
    if bushings > 0.0 { shortest.min(FRACTION / bushings) } else { shortest }
}

/// Time constant within which contact takes away a depth, with this step \[s\].
fn contact_s(step_s: f64) -> f64 {
    (CONTACT_STEPS * step_s).max(CONTACT_LEAST_S)
}

/// What the format cannot hold, and what of this model is left out.
fn comment(model: &Model, loose: bool, notes: &Notes) -> String {
    let mut text = format!(
        "Model \"{}\", SI units. Load it, then reset to the key frame \"start\" if there is one.\n",
        model.name
    );
    text += "MJCF cannot hold: moments that soften, fracture, capacities that depend on the axial force, weakening and removal in time, restitution.\n";
    text += "Where a hinge yields (springyield) the integrators RK4 and discrete give a false moment; keep implicitfast or Euler.\n";
    if loose {
        text += "Joints that may open are equality constraints with their ids: eq_active switches them off. Moments about them are not in this file.\n";
    }
    for note in &notes.0 {
        text += &format!("left out: {}: {}\n", note.id, note.text);
    }
    // a comment holds no two hyphens in a row
    let mut safe = text.replace("--", "- -");
    while safe.contains("--") {
        safe = safe.replace("--", "- -");
    }
    format!("<!--\n{safe}-->")
}

fn keyframe(sheet: &mut Sheet, model: &Model, [positions, velocities]: &[Vec<f64>; 2]) {
    let moves =
        model.bodies.iter().any(|b| b.velocity_m_s != [0.0; 3] || b.angular_velocity_rad_s != [0.0; 3]);
    if moves {
        sheet.open("<keyframe>");
        sheet.line(&format!("<key name=\"start\" qpos={} qvel={}/>", vector(positions), vector(velocities)));
        sheet.close("</keyframe>");
    }
}
