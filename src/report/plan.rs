//! Plans seen from above: where charges are and when they fire, and where the debris lies.

use super::chart::escape;
use super::number::fixed;
use serde::Serialize;
use std::fmt::Write;

/// When charges fire, and where they are.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BlastingPlan {
    /// The charges.
    pub charges: Vec<PlannedCharge>,
    /// The storeys that have charges, from below.
    pub storeys: Vec<StoreyPlan>,
}

/// A charge of the plan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlannedCharge {
    /// Its id.
    pub id: String,
    /// What it takes away.
    pub what: String,
    /// Name of the storey.
    pub storey: String,
    /// Ignition time \[s\].
    pub time_s: f64,
}

/// A storey seen from above.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StoreyPlan {
    /// Its name.
    pub label: String,
    /// Its members.
    pub parts: Vec<PlanPart>,
}

/// A member seen from above.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanPart {
    /// What it is.
    pub kind: PlanKind,
    /// Lower and upper corner in x and y \[m\].
    pub box_m: [[f64; 2]; 2],
    /// When charges take it or a stretch of it \[s\], in their order; empty: never.
    pub charges_s: Vec<f64>,
}

/// Kinds of members in a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanKind {
    /// A slab.
    Floor,
    /// A beam.
    Beam,
    /// What bears: a column, a wall, a brace.
    Bearing,
}

/// Where debris lies at the end.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DebrisPlan {
    /// Members of the building before it moves, lower and upper corners in x and y \[m\].
    pub building_m: Vec<[[f64; 2]; 2]>,
    /// Obstacles, the same.
    pub obstacles_m: Vec<[[f64; 2]; 2]>,
    /// The runs.
    pub runs: Vec<DebrisOutline>,
}

/// The debris of a run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DebrisOutline {
    /// The run, e.g. "FE".
    pub run: String,
    /// Style class of its line: `fe`, `hybrid` or `mbs`.
    pub class: String,
    /// Closed rings around what is covered, in x and y \[m\]; those around holes run the other way.
    pub outline_m: Vec<Vec<[f64; 2]>>,
    /// Covered area \[m²\].
    pub area_m2: f64,
    /// How far it reaches beyond the box around the plan, towards -x, +x, -y, +y \[m\]; negative: it stays that far inside.
    pub reach_m: [f64; 4],
    /// Highest point above the ground \[m\].
    pub top_m: f64,
    /// How fast it still moves \[m/s\]; `None`: it lies.
    pub speed_m_s: Option<f64>,
}

/// Width of a drawing in its own units.
const WIDTH: f64 = 360.0;
/// Room around what is drawn, in the same units.
const MARGIN: f64 = 26.0;

/// The charges for the page.
#[derive(Debug, Serialize)]
pub(super) struct Blasting {
    rows: Vec<[String; 5]>,
    plans: Vec<String>,
}

/// A table of the charges in the order of their times, and a plan of each storey with charges.
pub(super) fn blasting(plan: &BlastingPlan) -> Blasting {
    let mut charges: Vec<_> = plan.charges.iter().collect();
    charges.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let row = |(i, c): (usize, &&PlannedCharge)| {
        [(i + 1).to_string(), milliseconds(c.time_s), c.id.clone(), c.what.clone(), c.storey.clone()]
    };
    Blasting {
        rows: charges.iter().enumerate().map(row).collect(),
        plans: plan.storeys.iter().map(storey).collect(),
    }
}

/// A time in ms, with a decimal where it has one.
fn milliseconds(time_s: f64) -> String {
    let ms = 1e3 * time_s;
    fixed(ms, usize::from((ms - ms.round()).abs() > 1e-6))
}

/// From metres to the units of a drawing; y points upwards.
struct Scale {
    min_m: [f64; 2],
    units_m: f64,
    height: f64,
}

impl Scale {
    /// That shows all of these points.
    fn of(points: impl Iterator<Item = [f64; 2]>) -> Option<Self> {
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for p in points.filter(|p| p.iter().all(|c| c.is_finite())) {
            for (r, c) in range.iter_mut().zip(p) {
                *r = [r[0].min(c), r[1].max(c)];
            }
        }
        let size = range.map(|r| r[1] - r[0]);
        (size.iter().all(|s| *s > 0.0)).then(|| {
            // a long narrow plan is as high as wide at most
            let units_m = (WIDTH - 2.0 * MARGIN) / size[0].max(size[1]);
            Self { min_m: range.map(|r| r[0]), units_m, height: (size[1] * units_m + 2.0 * MARGIN).ceil() }
        })
    }

    fn at(&self, p: [f64; 2]) -> [f64; 2] {
        [
            MARGIN + (p[0] - self.min_m[0]) * self.units_m,
            self.height - MARGIN - (p[1] - self.min_m[1]) * self.units_m,
        ]
    }

    fn rectangle(&self, out: &mut String, class: &str, [low, high]: [[f64; 2]; 2]) {
        let [[x0, y1], [x1, y0]] = [self.at(low), self.at(high)];
        let _ = write!(
            out,
            "<rect class=\"{class}\" x=\"{x0:.1}\" y=\"{y0:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
            x1 - x0,
            y1 - y0
        );
    }

    /// Start of the drawing, with its name.
    fn begin(&self, name: &str) -> String {
        let name = escape(name);
        format!(
            "<figure class=\"plan\"><figcaption>{name}</figcaption><svg viewBox=\"0 0 {WIDTH} {:.0}\" role=\"img\" aria-label=\"{name}\">",
            self.height
        )
    }

    /// A length to compare with, the directions of the axes, and the end of the drawing.
    fn end(&self, out: &mut String) {
        let length_m = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|m| m * self.units_m > 40.0);
        let length_m = length_m.unwrap_or(100.0);
        let (right, y) = (WIDTH - 8.0, self.height - 8.0);
        let _ = write!(
            out,
            "<path class=\"measure\" d=\"M{:.1} {y:.1}H{right}\"/><text class=\"end\" x=\"{right}\" y=\"{:.1}\">{length_m} m</text>\
             <path class=\"measure\" d=\"M8 {:.1}V{y:.1}H26\"/><text x=\"30\" y=\"{:.1}\">x</text><text x=\"5\" y=\"{:.1}\">y</text></svg></figure>",
            right - length_m * self.units_m,
            y - 4.0,
            y - 18.0,
            y + 3.0,
            y - 22.0,
        );
    }
}

/// The plan of a storey: what bears, and the charges with their times in ms.
fn storey(plan: &StoreyPlan) -> String {
    let corners = plan.parts.iter().flat_map(|p| p.box_m);
    let Some(scale) = Scale::of(corners) else { return String::new() };
    let mut out = scale.begin(&plan.label);
    let of = |kind: PlanKind| plan.parts.iter().filter(move |p| p.kind == kind);
    for (kind, class) in
        [(PlanKind::Floor, "floor"), (PlanKind::Beam, "beam"), (PlanKind::Bearing, "bearing")]
    {
        for part in of(kind) {
            let class = if part.charges_s.is_empty() { class } else { "charged" };
            scale.rectangle(&mut out, class, part.box_m);
        }
    }
    for part in plan.parts.iter().filter(|p| !p.charges_s.is_empty()) {
        let times: Vec<String> = part.charges_s.iter().map(|time_s| milliseconds(*time_s)).collect();
        let text = times.join(", ");
        let (x, y, class) = beside(&scale, part.box_m, &text);
        let _ = write!(out, "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\">{text}</text>");
    }
    scale.end(&mut out);
    out
}

/// Width of a letter of an ignition time, in units of the drawing.
const LETTER: f64 = 7.5;

/// Where a text stands that belongs to a member: to its right; where that would be cut off, to its left; of one as wide as the drawing at the right edge.
fn beside(scale: &Scale, [low, high]: [[f64; 2]; 2], text: &str) -> (f64, f64, &'static str) {
    let middle = 0.5 * (low[1] + high[1]);
    let [[left, y], [right, _]] = [low, high].map(|p| scale.at([p[0], middle]));
    let width = LETTER * text.chars().count() as f64;
    let (x, class) = match (right + 3.0 + width > WIDTH, left - 3.0 - width < 0.0) {
        (false, _) => (right + 3.0, "fires"),
        (true, false) => (left - 3.0, "fires end"),
        (true, true) => (WIDTH - 3.0, "fires end"),
    };
    (x, y + 4.0, class)
}

/// The debris for the page.
#[derive(Debug, Serialize)]
pub(super) struct Debris {
    drawing: String,
    /// Whether obstacles are drawn.
    obstacles: bool,
    rows: Vec<Vec<String>>,
    runs: Vec<String>,
    moving: Option<String>,
}

/// The outlines of the debris over the plan of the building, and how far it reaches.
pub(super) fn debris(plan: &DebrisPlan) -> Debris {
    let outlines = plan.runs.iter().flat_map(|r| r.outline_m.iter().flatten().copied());
    let boxes = plan.building_m.iter().chain(&plan.obstacles_m).flatten().copied();
    let drawing = Scale::of(outlines.chain(boxes)).map_or(String::new(), |scale| {
        let mut out = scale.begin("Debris at the end of the run, seen from above");
        plan.building_m.iter().for_each(|b| scale.rectangle(&mut out, "floor", *b));
        plan.obstacles_m.iter().for_each(|b| scale.rectangle(&mut out, "obstacle", *b));
        for run in &plan.runs {
            let mut path = String::new();
            for ring in &run.outline_m {
                for (i, p) in ring.iter().enumerate() {
                    let [x, y] = scale.at(*p);
                    let _ = write!(path, "{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' });
                }
                path.push('Z');
            }
            let _ = write!(out, "<path class=\"line {}\" d=\"{path}\"/>", escape(&run.class));
        }
        scale.end(&mut out);
        out
    });
    let row = |label: &str, of: &dyn Fn(&DebrisOutline) -> f64, digits: usize| {
        let figure = |r: &DebrisOutline| fixed(of(r), digits);
        std::iter::once(label.to_string()).chain(plan.runs.iter().map(figure)).collect::<Vec<String>>()
    };
    Debris {
        drawing,
        obstacles: !plan.obstacles_m.is_empty(),
        // the outline is one of squares of a tenth of a metre
        rows: vec![
            row("Covered area [m²]", &|r| r.area_m2, 1),
            row("Reach beyond the plan towards −x [m]", &|r| r.reach_m[0], 1),
            row("towards +x [m]", &|r| r.reach_m[1], 1),
            row("towards −y [m]", &|r| r.reach_m[2], 1),
            row("towards +y [m]", &|r| r.reach_m[3], 1),
            row("Highest point above the ground [m]", &|r| r.top_m, 2),
        ],
        runs: plan.runs.iter().map(|r| r.run.clone()).collect(),
        moving: moving(&plan.runs),
    }
}

/// "Not at rest: FE still moves at 13.7 m/s, MBS at 12.9 m/s." with what follows.
fn moving(runs: &[DebrisOutline]) -> Option<String> {
    let speeds = runs.iter().filter_map(|r| Some((&r.run, r.speed_m_s?))).enumerate();
    let told: Vec<String> = speeds
        .map(|(k, (run, speed_m_s))| {
            let verb = if k == 0 { "still moves at" } else { "at" };
            format!("{run} {verb} {} m/s", fixed(speed_m_s, 1))
        })
        .collect();
    let told = told.join(", ");
    (!told.is_empty()).then(|| format!("Not at rest: {told}; what comes to rest may reach farther."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charges_stand_in_the_order_of_their_times() {
        let charge = |id: &str, time_s: f64| PlannedCharge {
            id: id.into(),
            what: format!("C{id}"),
            storey: "1".into(),
            time_s,
        };
        let part = |x: f64, charges_s: &[f64]| PlanPart {
            kind: PlanKind::Bearing,
            box_m: [[x, 0.0], [x + 0.4, 0.4]],
            charges_s: charges_s.to_vec(),
        };
        let plan = BlastingPlan {
            charges: vec![charge("late", 0.25), charge("<first>", 0.0125)],
            storeys: vec![StoreyPlan {
                label: "Storey 1".into(),
                parts: vec![part(0.0, &[0.0125, 0.25]), part(6.0, &[])],
            }],
        };
        let drawn = blasting(&plan);
        assert_eq!(drawn.rows[0], ["1", "12.5", "<first>", "C<first>", "1"]);
        assert_eq!(drawn.rows[1][1], "250");
        let plan = &drawn.plans[0];
        assert_eq!((plan.matches("\"charged\"").count(), plan.matches("\"bearing\"").count()), (1, 1));
        assert!(plan.contains(">12.5, 250</text>") && plan.contains("1 m</text>"), "{plan}");
    }

    /// The drawing ends 26 units beside the building: four digits are wider.
    #[test]
    fn ignition_times_are_not_cut_at_the_right_edge() {
        let scale = Scale::of([[0.0, 0.0], [10.0, 5.0]].into_iter()).unwrap();
        let at = |x: [f64; 2], text| beside(&scale, [[x[0], 1.0], [x[1], 1.4]], text);
        let place = |x, text| (at(x, text).0.round(), at(x, text).2);
        assert_eq!(place([9.6, 10.0], "75"), (337.0, "fires"));
        assert_eq!(place([9.6, 10.0], "1250"), (319.0, "fires end"));
        assert_eq!(place([0.0, 10.0], "1250"), (357.0, "fires end"), "a wall along the whole building");
    }

    #[test]
    fn debris_is_drawn_over_the_plan_with_its_reach() {
        let run = DebrisOutline {
            run: "FE".into(),
            class: "fe".into(),
            outline_m: vec![vec![[0.0, -3.0], [6.0, -3.0], [6.0, 5.0], [0.0, 5.0]]],
            area_m2: 48.0,
            reach_m: [0.0, 0.0, 3.0, 0.0],
            top_m: 1.25,
            speed_m_s: None,
        };
        let plan = DebrisPlan {
            building_m: vec![[[0.0, 0.0], [6.0, 5.0]]],
            obstacles_m: Vec::new(),
            runs: vec![run],
        };
        let drawn = debris(&plan);
        assert!(drawn.drawing.contains("class=\"line fe\"") && !drawn.drawing.contains("NaN"));
        assert_eq!(drawn.rows[3], ["towards −y [m]", "3.0"]);
        assert!(debris(&DebrisPlan::default()).drawing.is_empty());
        assert_eq!(drawn.moving, None);
        let falls = DebrisOutline { speed_m_s: Some(13.72), ..plan.runs[0].clone() };
        let told = moving(&[falls.clone(), DebrisOutline { run: "MBS".into(), ..falls }]).unwrap();
        assert!(told.starts_with("Not at rest: FE still moves at 13.7 m/s, MBS at 13.7 m/s; "), "{told}");
    }
}
