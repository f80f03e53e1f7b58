//! Which parts are rigid and which deform: the share over time as a chart, and pictures of the runs at some times.
//!
//! A picture is a parallel projection, drawn as SVG: faces that look away are left out, the others are painted from the rear to the front. Faces are
//! small beside the building, so that the depth of their centres orders them. Coordinates are whole units, and neighbours in the order with one style share a path.

use super::ReportError;
use super::chart::{Chart, Series, escape, seconds};
use super::input::FirstContact;
use super::plots::{check, contact_marks};
use crate::base::geom::Aabb;
use crate::base::vector::{cross, dot, norm, sub};
use std::fmt::Write;

/// Rigid and deforming parts over time, as shares and pictures.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PartitionView {
    /// Times of the shares \[s\], increasing.
    pub time_s: Vec<f64>,
    /// Share of the FE run's elements that strain no faster than the critical rate.
    pub fe_share: Vec<f64>,
    /// Share of the FE run's elements that never strained faster until then.
    pub fe_never_share: Vec<f64>,
    /// Share of the hybrid run's elements that are in rigid parts; empty: no such run.
    pub hybrid_share: Vec<f64>,
    /// Height of the ground \[m\].
    pub ground_level_m: Option<f64>,
    /// Box around the building before it moves \[m\]: no picture cuts into it.
    pub building_m: Option<Aabb>,
    /// The runs at some times.
    pub moments: Vec<Moment>,
}

/// The runs at one time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Moment {
    /// Which time it is, e.g. "at the first contact".
    pub label: String,
    /// The time \[s\].
    pub time_s: f64,
    /// One picture a run.
    pub pictures: Vec<Picture>,
}

/// One run at one time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Picture {
    /// The run, e.g. "FE".
    pub run: String,
    /// What the picture shows in figures.
    pub words: String,
    /// Faces.
    pub facets: Vec<Facet>,
    /// Places at which something has happened.
    pub marks: Vec<Mark>,
}

/// A place at which something has happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Where \[m\].
    pub point_m: [f64; 3],
    /// What.
    pub kind: MarkKind,
}

/// What has happened at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MarkKind {
    /// A hinge has yielded.
    Yielded,
    /// A latent section has gone live.
    Live,
    /// A hinge has separated.
    Broken,
}

/// A quadrilateral; seen from outside its corners go anticlockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    /// Corners \[m\].
    pub corners_m: [[f64; 3]; 4],
    /// What it belongs to.
    pub kind: FacetKind,
}

/// What a face belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FacetKind {
    /// A part that is rigid.
    Rigid,
    /// A part that deforms.
    Deforming,
    /// A part that deformed before.
    Deformed,
    /// An obstacle.
    Obstacle,
}

/// The chart and the pictures for the page.
#[derive(Debug, serde::Serialize)]
pub(super) struct Section {
    chart: String,
    rows: Vec<Row>,
    /// Whether there are obstacles in the pictures.
    obstacles: bool,
}

#[derive(Debug, serde::Serialize)]
struct Row {
    label: String,
    pictures: Vec<String>,
}

/// Draws the view.
pub(super) fn section(view: &PartitionView, contact: &FirstContact) -> Result<Section, ReportError> {
    let camera = Camera::of(view);
    let row = |m: &Moment| Row {
        label: format!("{}, t = {}", m.label, seconds(m.time_s)),
        pictures: m.pictures.iter().map(|p| camera.picture(p, view.ground_level_m)).collect(),
    };
    let mut facets = view.moments.iter().flat_map(|m| &m.pictures).flat_map(|p| &p.facets);
    Ok(Section {
        chart: share_chart(view, contact)?,
        rows: view.moments.iter().map(row).collect(),
        obstacles: facets.any(|f| f.kind == FacetKind::Obstacle),
    })
}

fn share_chart(view: &PartitionView, contact: &FirstContact) -> Result<String, ReportError> {
    let lines = [
        ("FE: elements that do not strain faster than the critical rate", "fe", &view.fe_share),
        ("FE: elements that never did until then", "fe faint", &view.fe_never_share),
        ("hybrid: elements in rigid parts", "hybrid", &view.hybrid_share),
    ];
    let given: Vec<_> = lines.into_iter().filter(|l| !l.2.is_empty()).collect();
    let lengths: Vec<usize> = given.iter().map(|l| l.2.len()).collect();
    check("shares of rigid elements", &view.time_s, &lengths)?;
    let points = |shares: &[f64]| view.time_s.iter().zip(shares).map(|(t, s)| [*t, 100.0 * s]).collect();
    let end = view.time_s.last().copied().unwrap_or(0.0);
    let chart = Chart {
        title: "Rigid share of the elements".into(),
        x: ("time".into(), "s".into()),
        y: ("share".into(), "%".into()),
        series: given
            .iter()
            .map(|(label, class, shares)| Series {
                label: (*label).into(),
                class: (*class).into(),
                points: points(shares),
            })
            .collect(),
        marks: contact_marks(contact),
        shade: contact.fe_s.filter(|t| t.is_finite()).map(|t| [t, end]),
        y_range: Some([0.0, 100.0]),
        is_time: true,
        ..Chart::default()
    };
    Ok(chart.to_html())
}

/// Width of a picture in its own units.
const WIDTH: f64 = 1000.0;
/// Share of the corners beyond which a picture may cut off what flies away, at each side.
const CUT: f64 = 0.002;
/// Where the pictures are seen from: about the vertical axis, and above the horizon \[rad\].
const YAW_PITCH: [f64; 2] = [-0.62, 0.3];
/// Direction of the light.
const LIGHT: [f64; 3] = [0.48, -0.44, 0.76];
/// Margin around the scene \[m\].
const MARGIN_M: f64 = 0.6;

/// Corners of a box.
fn corners_of(solid: Aabb) -> [[f64; 3]; 8] {
    let ends = [solid.min, solid.max];
    std::array::from_fn(|k| std::array::from_fn(|axis| ends[k >> axis & 1][axis]))
}

/// A parallel projection that shows all pictures at one scale.
struct Camera {
    right: [f64; 3],
    up: [f64; 3],
    back: [f64; 3],
    /// Left and upper edge \[m\].
    corner_m: [f64; 2],
    /// Units a metre.
    scale: f64,
    height: f64,
    /// Plan of the ground \[m\].
    ground_m: [[f64; 2]; 2],
}

impl Camera {
    fn of(view: &PartitionView) -> Self {
        let [(sy, cy), (sp, cp)] = YAW_PITCH.map(f64::sin_cos);
        let back = [cp * cy, cp * sy, sp];
        let right = [-sy, cy, 0.0];
        let up = cross(back, right);
        let pictures = view.moments.iter().flat_map(|m| &m.pictures);
        let corners = |p: &Picture| p.facets.iter().flat_map(|f| f.corners_m).collect::<Vec<[f64; 3]>>();
        let points: Vec<Vec<[f64; 3]>> = pictures.map(corners).collect();
        // What most of each picture needs: debris that flies away may be cut off.
        let range = |of: &dyn Fn([f64; 3]) -> f64| {
            let standing = |of: &dyn Fn([f64; 3]) -> f64| {
                let at = view.building_m.map(|solid| corners_of(solid).map(of))?;
                let [low, high] =
                    [at.iter().copied().reduce(f64::min)?, at.iter().copied().reduce(f64::max)?];
                Some([low - MARGIN_M, high + MARGIN_M])
            };
            let middle = |points: &Vec<[f64; 3]>| {
                let mut at: Vec<f64> = points.iter().map(|p| of(*p)).filter(|v| v.is_finite()).collect();
                at.sort_by(f64::total_cmp);
                let last = at.len().checked_sub(1)?;
                let cut = (CUT * at.len() as f64) as usize;
                Some([at[cut] - MARGIN_M, at[last - cut] + MARGIN_M])
            };
            let ranges = points.iter().filter_map(middle).chain(standing(&of));
            ranges.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or([0.0, 1.0])
        };
        let (x, y) = (range(&|p| dot(right, p)), range(&|p| -dot(up, p)));
        let scale = WIDTH / (x[1] - x[0]);
        Self {
            right,
            up,
            back,
            corner_m: [x[0], y[0]],
            scale,
            height: ((y[1] - y[0]) * scale).ceil(),
            ground_m: [range(&|p| p[0]), range(&|p| p[1])],
        }
    }

    fn place(&self, p: [f64; 3]) -> [f64; 2] {
        [
            (dot(self.right, p) - self.corner_m[0]) * self.scale,
            (-dot(self.up, p) - self.corner_m[1]) * self.scale,
        ]
    }

    fn picture(&self, picture: &Picture, ground_m: Option<f64>) -> String {
        let mut out = String::new();
        let (run, words) = (escape(&picture.run), escape(&picture.words));
        let _ = write!(
            out,
            "<figure class=\"picture\"><figcaption><b>{run}</b> {words}</figcaption>\
             <svg viewBox=\"0 0 {WIDTH} {}\" role=\"img\" aria-label=\"{run}: {words}\">",
            self.height
        );
        if let Some(z) = ground_m {
            let [x, y] = self.ground_m;
            let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
            let path = quad(corners.map(|[x, y]| self.place([x, y, z])));
            let _ = write!(out, "<path class=\"ground\" d=\"{path}\"/>");
        }
        self.faces(&mut out, &picture.facets);
        let mut marks: Vec<Mark> = picture.marks.clone();
        marks.retain(|m| m.point_m.iter().all(|c| c.is_finite()));
        // what matters more is drawn over the rest
        marks.sort_by_key(|m| m.kind);
        for mark in marks {
            let [x, y] = self.place(mark.point_m);
            let _ = match mark.kind {
                MarkKind::Yielded => write!(out, "<circle cx=\"{x:.0}\" cy=\"{y:.0}\" r=\"11\"/>"),
                MarkKind::Live => {
                    write!(out, "<path class=\"live\" d=\"M{x:.0} {y:.0}m0-17l17 17-17 17-17-17z\"/>")
                }
                MarkKind::Broken => {
                    let cross = format!("M{x:.0} {y:.0}m-12-12l24 24m0-24l-24 24");
                    write!(out, "<path class=\"halo\" d=\"{cross}\"/><path class=\"broken\" d=\"{cross}\"/>")
                }
            };
        }
        out.push_str("</svg></figure>");
        out
    }

    /// Paints what looks here, from the rear to the front.
    fn faces(&self, out: &mut String, facets: &[Facet]) {
        let mut painted: Vec<(f64, String, String)> = Vec::new();
        for facet in facets {
            let c = facet.corners_m;
            if !c.iter().flatten().all(|x| x.is_finite()) {
                continue;
            }
            let normal = cross(sub(c[2], c[0]), sub(c[3], c[1]));
            let length = norm(normal);
            if dot(normal, self.back) <= 0.0 {
                continue;
            }
            let depth: f64 = c.iter().map(|p| dot(self.back, *p)).sum();
            painted.push((
                depth,
                class(facet.kind, dot(normal, LIGHT) / length),
                quad(c.map(|p| self.place(p))),
            ));
        }
        painted.sort_by(|a, b| a.0.total_cmp(&b.0));
        for group in painted.chunk_by(|a, b| a.1 == b.1) {
            let _ = write!(out, "<path class=\"{}\" d=\"", group[0].1);
            group.iter().for_each(|(_, _, path)| out.push_str(path));
            out.push_str("\"/>");
        }
    }
}

/// Style class of a face: what it belongs to and one of three tones.
fn class(kind: FacetKind, light: f64) -> String {
    let letter = match kind {
        FacetKind::Rigid => 'r',
        FacetKind::Deforming => 'd',
        FacetKind::Deformed => 'w',
        FacetKind::Obstacle => 'o',
    };
    let tone = match light {
        l if l > 0.55 => 0,
        l if l > 0.1 => 1,
        _ => 2,
    };
    format!("{letter}{tone}")
}

/// A closed path through four points in whole units.
fn quad(corners: [[f64; 2]; 4]) -> String {
    let at = corners.map(|p| p.map(|c| c.round().clamp(-1e6, 1e6) as i64));
    let mut path = format!("M{} {}", at[0][0], at[0][1]);
    for (from, to) in at.iter().zip(&at[1..]) {
        let _ = write!(path, "l{} {}", to[0] - from[0], to[1] - from[1]);
    }
    path.push('z');
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facet(corners_m: [[f64; 3]; 4], kind: FacetKind) -> Facet {
        Facet { corners_m, kind }
    }

    fn roof(z: f64) -> [[f64; 3]; 4] {
        [[0.0, 0.0, z], [4.0, 0.0, z], [4.0, 4.0, z], [0.0, 4.0, z]]
    }

    fn view(facets: Vec<Facet>) -> PartitionView {
        let picture = Picture { run: "FE".into(), words: "<b>".into(), facets, marks: Vec::new() };
        let moment = Moment { label: "end".into(), time_s: 2.5, pictures: vec![picture] };
        PartitionView {
            time_s: vec![0.0, 1.0],
            fe_share: vec![1.0, 0.5],
            ground_level_m: Some(0.0),
            moments: vec![moment],
            ..PartitionView::default()
        }
    }

    #[test]
    fn near_faces_hide_far_ones_and_those_that_look_away_are_left_out() {
        let mut down = roof(1.0);
        down.reverse();
        let facets = vec![
            facet(roof(3.0), FacetKind::Deforming),
            facet(roof(0.1), FacetKind::Rigid),
            facet(down, FacetKind::Obstacle),
        ];
        let section = section(&view(facets), &FirstContact::default()).unwrap();
        let picture = &section.rows[0].pictures[0];
        let place = |class: &str| picture.find(&format!("<path class=\"{class}\"")).unwrap();
        assert!(place("ground") < place("r0") && place("r0") < place("d0"), "{picture}");
        assert!(!picture.contains("class=\"o") && picture.contains("&lt;b&gt;"));
        assert_eq!(section.rows[0].label, "end, t = 2.500 s");
    }

    #[test]
    fn marks_are_told_apart_by_their_form_and_what_separates_is_on_top() {
        let kinds = [MarkKind::Broken, MarkKind::Yielded, MarkKind::Live];
        let mut view = view(vec![facet(roof(0.1), FacetKind::Rigid)]);
        view.moments[0].pictures[0].marks =
            kinds.map(|kind| Mark { point_m: [1.0, 1.0, 3.0], kind }).to_vec();
        let lost = Mark { point_m: [f64::NAN; 3], kind: MarkKind::Live };
        view.moments[0].pictures[0].marks.push(lost);
        let drawn = section(&view, &FirstContact::default()).unwrap();
        let picture = &drawn.rows[0].pictures[0];
        let place = |what: &str| picture.find(what).unwrap();
        let order =
            [place("class=\"r0\""), place("<circle"), place("class=\"live\""), place("class=\"broken\"")];
        assert!(order.is_sorted() && picture.matches("class=\"live\"").count() == 1, "{picture}");
    }

    #[test]
    fn a_face_that_is_nowhere_is_left_out_and_an_empty_view_is_drawn() {
        let mut lost = roof(3.0);
        lost[2][1] = f64::NAN;
        let drawn = section(&view(vec![facet(lost, FacetKind::Rigid)]), &FirstContact::default()).unwrap();
        assert!(!drawn.rows[0].pictures[0].contains("NaN"));
        let empty = section(&PartitionView::default(), &FirstContact::default()).unwrap();
        assert!(empty.rows.is_empty() && empty.chart.contains("Not recorded"));
    }

    /// Debris that flies off may be cut; a building of which little is meshed finely may not.
    #[test]
    fn a_picture_never_cuts_into_the_building() {
        let fine = (0..2000).map(|_| facet(roof(0.0), FacetKind::Rigid));
        let tower = [[0.0, 0.0, 30.0], [4.0, 0.0, 30.0], [4.0, 4.0, 30.0], [0.0, 4.0, 30.0]];
        let mut view = view(fine.chain([facet(tower, FacetKind::Rigid)]).collect());
        assert!(Camera::of(&view).place(tower[0])[1] < 0.0, "cut without a box");
        view.building_m = Some(Aabb::from_corners([0.0; 3], [4.0, 4.0, 30.0]));
        let camera = Camera::of(&view);
        let inside = |p: [f64; 3]| {
            let [x, y] = camera.place(p);
            (0.0..=WIDTH).contains(&x) && (0.0..=camera.height).contains(&y)
        };
        assert!(tower.into_iter().all(inside));
    }

    #[test]
    fn shares_have_to_fit_their_times() {
        let mut view = view(Vec::new());
        view.hybrid_share = vec![0.5];
        assert!(matches!(section(&view, &FirstContact::default()), Err(ReportError::Length { .. })));
    }
}
