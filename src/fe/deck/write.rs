//! From a model to a deck that other programs run.
//!
//! A block stands in the standard format where its numbers come back from it to the last bit and have their exponents
//! after an `e`, and else in the long format (`*NODE+`, 20 columns). What does not fit 20 columns either (negative numbers of 17 digits below 0.01)
//! goes in as a parameter, which is positive and fits.

use super::normal::{head_of, least_step_of_element, normalised};
use super::number::{common, shortest};
use crate::fe::law::{ElementForm, Hourglass, Law};
use crate::fe::model::{Curve, Model};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// A deck.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// Its text.
    pub text: String,
    /// What of the model it does not say.
    pub notes: Vec<String>,
}

/// One field.
#[derive(Debug, Clone, Copy)]
enum Cell {
    /// An identifier or a code.
    Id(i64),
    /// A number.
    Real(f64),
    /// Nothing.
    Blank,
}
use Cell::{Blank, Id, Real};

/// One line.
enum Row {
    Title(String),
    Card(&'static [usize], Vec<Cell>),
}

const TEN: &[usize] = &[10; 8];
const NODE: &[usize] = &[8, 16, 16, 16, 8, 8];
const ELEMENT: &[usize] = &[8; 10];
const POINT: &[usize] = &[20; 2];

/// Writes a model in SI units; `comments` stand at its head, a line each. Identifiers are indices counted from 1, of the model
/// in its normal form.
pub fn write(model: &Model, comments: &[String]) -> Written {
    let (model, mut notes) = normalised(model);
    let mut deck = Writer::default();
    deck.control(&model);
    deck.parts(&model);
    deck.laws(&model);
    deck.constraints(&model);
    deck.loads(&model);
    deck.walls(&model);
    deck.curves();
    deck.mesh(&model);
    if model.mesh.laws.iter().any(|l| l.hardening.len() > 1) {
        notes.push("yield stresses are constant beyond the last point of their table here; other programs may go on along the last slope".into());
    }
    if model.mesh.laws.iter().any(|l| l.rate.is_some() && l.hardening.len() > 1) {
        notes.push("strain rates raise hardening tables as a whole here; other programs may raise SIGY alone with VP = 1".into());
    }
    let mut text = String::from("*KEYWORD\n");
    for comment in comments.iter().chain(&notes) {
        for line in comment.lines() {
            let _ = writeln!(text, "$ {line}");
        }
    }
    if !model.title.is_empty() {
        let _ = write!(text, "*TITLE\n{}\n", model.title);
    }
    if !deck.parameters.is_empty() {
        text.push_str("*PARAMETER+\n");
        for (index, value) in &deck.named {
            let _ = writeln!(text, "{:>20}{value:>20}", format!("R v{index}"));
        }
    }
    text.push_str(&deck.text);
    text.push_str("*END\n");
    Written { text, notes }
}

#[derive(Default)]
struct Writer {
    text: String,
    /// Number of each parameter by the bits of its value, and in order with their texts.
    parameters: BTreeMap<u64, usize>,
    named: Vec<(usize, String)>,
    /// Curves used, in order.
    curves: Vec<Curve>,
}

impl Writer {
    fn block(&mut self, keyword: &str, rows: &[Row]) {
        if rows.is_empty() {
            return;
        }
        let fits = |row: &Row| match row {
            Row::Title(_) => true,
            Row::Card(widths, cells) => cells.iter().zip(*widths).all(|(cell, width)| match cell {
                Id(id) => id.to_string().len() <= *width,
                Real(x) => common(*x, *width).is_some(),
                Blank => true,
            }),
        };
        let long = !rows.iter().all(fits);
        let _ = writeln!(self.text, "*{keyword}{}", if long { "+" } else { "" });
        for row in rows {
            match row {
                Row::Title(title) => self.text.push_str(title),
                Row::Card(widths, cells) => {
                    for (cell, width) in cells.iter().zip(*widths) {
                        let width = if long { 20 } else { *width };
                        let field = match cell {
                            Id(id) => id.to_string(),
                            Real(x) => shortest(*x, width).unwrap_or_else(|| self.parameter(*x)),
                            Blank => String::new(),
                        };
                        let _ = write!(self.text, "{field:>width$}");
                    }
                }
            }
            while self.text.ends_with(' ') {
                self.text.pop();
            }
            self.text.push('\n');
        }
    }

    /// The name of a parameter with this value; numbers beyond 1e80 lose digits.
    fn parameter(&mut self, x: f64) -> String {
        let size = x.abs();
        let next = self.parameters.len() + 1;
        let index = *self.parameters.entry(size.to_bits()).or_insert(next);
        if index == next {
            let value = shortest(size, 20).unwrap_or_else(|| format!("{size:.11e}"));
            self.named.push((index, value));
        }
        format!("{}&v{index}", if x < 0.0 { "-" } else { "" })
    }

    /// Identifier of a curve.
    fn curve(&mut self, curve: &Curve) -> Cell {
        let index = self.curves.iter().position(|c| c == curve).unwrap_or_else(|| {
            self.curves.push(curve.clone());
            self.curves.len() - 1
        });
        Id(index as i64 + 1)
    }

    fn curves(&mut self) {
        for (index, curve) in std::mem::take(&mut self.curves).iter().enumerate() {
            let mut rows = vec![Row::Card(TEN, vec![Id(index as i64 + 1)])];
            rows.extend(curve.0.iter().map(|p| Row::Card(POINT, vec![Real(p[0]), Real(p[1])])));
            self.block("DEFINE_CURVE", &rows);
        }
    }

    fn card(&mut self, keyword: &str, cells: Vec<Cell>) {
        self.block(keyword, &[Row::Card(TEN, cells)]);
    }

    fn control(&mut self, model: &Model) {
        let control = &model.control;
        self.card("CONTROL_TERMINATION", vec![Real(control.end_time_s)]);
        let least = control
            .mass_scaling_step_s
            .map_or(Blank, |step| Real(-least_step_of_element(step, control.step_safety)));
        let mut step = vec![Real(0.0), Real(control.step_safety)];
        if let Real(_) = least {
            // mass is added once: MS1ST
            step.extend([Blank, Blank, least, Blank, Blank, Id(1)]);
        }
        self.card("CONTROL_TIMESTEP", step);
        self.card("CONTROL_ENERGY", vec![Id(2), Id(2), Id(2)]);
        self.card("DATABASE_BINARY_D3PLOT", vec![Real(control.state_interval_s)]);
        self.card("DATABASE_NODOUT", vec![Real(control.history_interval_s)]);
        self.card("DATABASE_GLSTAT", vec![Real(control.history_interval_s)]);
        let nodes: Vec<Cell> = control.history_nodes.iter().map(|n| id(*n)).collect();
        let rows: Vec<Row> = nodes.chunks(8).map(|c| Row::Card(TEN, c.to_vec())).collect();
        self.block("DATABASE_HISTORY_NODE", &rows);
    }

    /// Parts with their sections and hourglass controls.
    fn parts(&mut self, model: &Model) {
        let mesh = &model.mesh;
        let mut forms: Vec<ElementForm> = Vec::new();
        let mut areas: Vec<f64> = Vec::new();
        let mut controls: Vec<Hourglass> = Vec::new();
        let mut rows = Vec::new();
        for (part, name) in mesh.parts.iter().enumerate() {
            let bar = mesh.trusses.iter().find(|t| t.part == part);
            let law =
                bar.map(|b| b.law).or_else(|| mesh.elements.iter().find(|e| e.part == part).map(|e| e.law));
            let Some(law) = law else { continue };
            let (section, control) = match (bar, mesh.laws[law].form) {
                (Some(bar), _) => (-1 - position(&mut areas, bar.area_m2), Blank),
                (None, ElementForm::OnePoint(control)) => {
                    let one = ElementForm::default();
                    (position(&mut forms, one) + 1, Id(position(&mut controls, control) + 1))
                }
                (None, full) => (position(&mut forms, full) + 1, Blank),
            };
            rows.push(Row::Title(name.clone()));
            rows.push(Row::Card(TEN, vec![id(part), Id(section), id(law), Blank, control]));
        }
        // bars have sections after those of the solids
        for row in &mut rows {
            if let Row::Card(_, cells) = row
                && let Id(section @ ..0) = cells[1]
            {
                cells[1] = Id(forms.len() as i64 - section);
            }
        }
        self.block("PART", &rows);
        for (index, form) in forms.iter().enumerate() {
            let code = if matches!(form, ElementForm::FullyIntegrated) { 2 } else { 1 };
            self.card("SECTION_SOLID", vec![id(index), Id(code)]);
        }
        for (index, area) in areas.iter().enumerate() {
            let first = Row::Card(TEN, vec![id(forms.len() + index), Id(3)]);
            self.block("SECTION_BEAM", &[first, Row::Card(TEN, vec![Real(*area)])]);
        }
        for (index, control) in controls.iter().enumerate() {
            let (kind, coefficient) = match control {
                Hourglass::Viscous { coefficient } => (3, *coefficient),
                Hourglass::Stiffness { coefficient } => (5, *coefficient),
                Hourglass::Asqbi | Hourglass::Ads | Hourglass::Asmd => (6, 1.0),
            };
            self.card("HOURGLASS", vec![id(index), Id(kind), Real(coefficient)]);
        }
    }

    fn laws(&mut self, model: &Model) {
        for (index, law) in model.mesh.laws.iter().enumerate() {
            self.law(index, law);
            if law.erosion.principal_strain.is_finite() {
                let second = vec![Blank, Blank, Blank, Real(law.erosion.principal_strain)];
                let rows = [Row::Card(TEN, vec![id(index)]), Row::Card(TEN, second)];
                self.block("MAT_ADD_EROSION", &rows);
            }
        }
    }

    fn law(&mut self, index: usize, law: &Law) {
        let mut first =
            vec![id(index), Real(law.density_kg_m3), Real(law.youngs_modulus_pa), Real(law.poisson_ratio)];
        let Some(begin) = law.hardening.first() else {
            return self.card("MAT_ELASTIC", first);
        };
        let failure = law.erosion.plastic_strain;
        let failure = if failure.is_finite() { Real(failure) } else { Blank };
        first.extend([Real(begin.stress_pa), Real(0.0), failure]);
        let table = &law.hardening;
        // zeros, not blanks: some programs pass over a blank line
        let mut second = law.rate.map_or(vec![Real(0.0); 2], |r| vec![Real(r.c_1_s), Real(r.p)]);
        if table.len() > 8 {
            let curve = Curve::new(table.iter().map(|p| [p.plastic_strain, p.stress_pa]).collect());
            second.push(self.curve(&curve));
        }
        if law.rate.is_some() {
            second.resize(4, Id(0));
            // VP: the rate is that of the plastic strain
            second.push(Id(1));
        }
        let mut rows = vec![Row::Card(TEN, first), Row::Card(TEN, second)];
        if (2..=8).contains(&table.len()) {
            rows.push(Row::Card(TEN, table.iter().map(|p| Real(p.plastic_strain)).collect()));
            rows.push(Row::Card(TEN, table.iter().map(|p| Real(p.stress_pa)).collect()));
        }
        self.block("MAT_PIECEWISE_LINEAR_PLASTICITY", &rows);
    }

    fn constraints(&mut self, model: &Model) {
        let all = model.mesh.fixed.iter().map(|n| (*n, [true; 3]));
        let some = model.constraints.iter().map(|c| (c.node, c.held));
        let row = |(node, held): (usize, [bool; 3])| {
            let mut cells = vec![id(node), Id(0)];
            cells.extend(held.map(|h| Id(i64::from(h))));
            Row::Card(TEN, cells)
        };
        self.block("BOUNDARY_SPC_NODE", &all.chain(some).map(row).collect::<Vec<_>>());
        let velocity = |(node, v): &(usize, [f64; 3])| {
            Row::Card(TEN, vec![id(*node), Real(v[0]), Real(v[1]), Real(v[2])])
        };
        let rows: Vec<Row> = model.initial_velocity_m_s.iter().map(velocity).collect();
        self.block("INITIAL_VELOCITY_NODE", &rows);
    }

    fn loads(&mut self, model: &Model) {
        for load in &model.body_loads {
            let curve = self.curve(&load.acceleration_m_s2);
            // a positive factor would accelerate the base, and the mass the other way
            self.card(["LOAD_BODY_X", "LOAD_BODY_Y", "LOAD_BODY_Z"][load.axis], vec![curve, Real(-1.0)]);
        }
        let mut rows = Vec::new();
        for load in &model.nodal_loads {
            let curve = self.curve(&load.force_n);
            rows.push(Row::Card(TEN, vec![id(load.node), id(load.axis), curve, Real(1.0)]));
        }
        self.block("LOAD_NODE_POINT", &rows);
        let mut rows = Vec::new();
        for drive in &model.driven {
            let curve = self.curve(&drive.velocity_m_s);
            rows.push(Row::Card(TEN, vec![id(drive.node), id(drive.axis), Id(0), curve, Real(1.0)]));
        }
        self.block("BOUNDARY_PRESCRIBED_MOTION_NODE", &rows);
    }

    fn walls(&mut self, model: &Model) {
        for (index, wall) in model.walls.iter().enumerate() {
            let mut set = Id(0);
            if let Some(nodes) = &wall.nodes {
                set = id(index);
                let nodes: Vec<Cell> = nodes.iter().map(|n| id(*n)).collect();
                let mut rows = vec![Row::Card(TEN, vec![set])];
                rows.extend(nodes.chunks(8).map(|c| Row::Card(TEN, c.to_vec())));
                self.block("SET_NODE_LIST", &rows);
            }
            let friction = if wall.friction.is_finite() { wall.friction } else { 1.0 };
            let (tail, head) = (wall.point_m.map(Real), head_of(wall).map(Real));
            let second = tail.into_iter().chain(head).chain([Real(friction)]).collect();
            self.block("RIGIDWALL_PLANAR", &[Row::Card(TEN, vec![set]), Row::Card(TEN, second)]);
        }
        let Some(contact) = &model.body_contact else { return };
        let erodes = model
            .mesh
            .laws
            .iter()
            .any(|l| l.erosion.plastic_strain.is_finite() || l.erosion.principal_strain.is_finite());
        let mut rows = vec![
            Row::Card(TEN, vec![Id(0)]),
            Row::Card(TEN, vec![Real(contact.friction)]),
            Row::Card(TEN, vec![Real(1.0)]),
        ];
        if erodes {
            rows.push(Row::Card(TEN, vec![Id(0), Id(1), Id(1)]));
        }
        let keyword = if erodes { "ERODING" } else { "AUTOMATIC" };
        self.block(&format!("CONTACT_{keyword}_SINGLE_SURFACE"), &rows);
    }

    fn mesh(&mut self, model: &Model) {
        let mesh = &model.mesh;
        let node =
            |(n, x): (usize, &[f64; 3])| Row::Card(NODE, vec![id(n), Real(x[0]), Real(x[1]), Real(x[2])]);
        self.block("NODE", &mesh.nodes.iter().enumerate().map(node).collect::<Vec<_>>());
        let element = |(e, part, nodes): (usize, usize, &[usize])| {
            let cells = [id(e), id(part)].into_iter().chain(nodes.iter().map(|n| id(*n)));
            Row::Card(ELEMENT, cells.collect())
        };
        let solids = mesh.elements.iter().enumerate().map(|(i, e)| element((i, e.part, &e.nodes)));
        self.block("ELEMENT_SOLID", &solids.collect::<Vec<_>>());
        let first = mesh.elements.len();
        let bars = mesh.trusses.iter().enumerate().map(|(i, t)| element((first + i, t.part, &t.nodes)));
        self.block("ELEMENT_BEAM", &bars.collect::<Vec<_>>());
    }
}

/// Index as an identifier.
fn id(index: usize) -> Cell {
    Id(index as i64 + 1)
}

/// Position of an item, which is entered unless it is there.
fn position<T: PartialEq>(list: &mut Vec<T>, item: T) -> i64 {
    let index = list.iter().position(|l| *l == item).unwrap_or_else(|| {
        list.push(item);
        list.len() - 1
    });
    index as i64
}
