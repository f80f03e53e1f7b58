//! What is left of a turned member or brace between its neighbours.
//!
//! A turned member yields to every other: it butts against their faces. Along a column the common clear height counts, as with columns that are
//! not turned. Beams and walls that lie wholly under a slab or on a footing end at its face; each line along their axis then runs from the face that it
//! meets at one end to that at the other: the ends are mitred, no corner dips into a neighbour, and no volume counts twice.
//!
//! So do all lines along a brace, whatever its direction: at the corner of a column and a beam its end has two faces. Its axis says where it runs; how long it is
//! its neighbours decide. Where it ends less than [`Inclined::slack_m`](super::inclined::Inclined::slack_m) before a face it is prolonged, and as much of it may come out behind a neighbour,
//! such as the corners of its end behind a thin slab: that is cut off. Its whole end must meet neighbours.

use super::model::{Member, MemberKind};
use super::partition::COORDINATE_TOLERANCE_M;
use super::turned::TurnedBox;
use crate::base::geom::Aabb;
use crate::base::units::round_to_digits;

/// Lines across the section in each direction on which the volume is summed.
const VOLUME_LINES: usize = 64;
/// Lines across the section on which the clear shape is judged.
const JUDGED_LINES: usize = 5;
/// How far lines stay off the member's faces, as a share of half its width: a line in the face of a neighbour meets it.
const INSET: f64 = 1e-4;
/// Lines across the section in each direction on which two braces are tested for a common volume.
const OVERLAP_LINES: usize = 9;
/// Steepest mitre, as length over width: a member that meets a face under less than about 27 degrees is refused.
const STEEPEST: f64 = 2.0;
/// Least share of the gross length that must be left.
const LEAST_LEFT: f64 = 0.25;
/// How near to a neighbour's solid a point counts as lying on it \[m\].
const ON_FACE_M: f64 = 1e-3;

/// The clear shape of a turned member.
#[derive(Debug, Clone)]
pub struct Clear {
    /// The gross shape.
    pub gross: TurnedBox,
    /// Its own long axis: 2 of a column, the horizontal one of a beam or wall, 0 of a brace.
    pub axis: usize,
    /// How far its ends may be prolonged or cut off \[m\]; `None`: not a brace.
    slack_m: Option<f64>,
    /// Clear extent along its own axes, from the centre \[m\]; along the axis of a beam or wall still gross, of a brace that of its centre line.
    pub range_m: [[f64; 2]; 3],
    /// Members that it overlaps or touches, with their ids.
    neighbours: Vec<Neighbour>,
}

/// A line along a member.
struct Line {
    length_m: f64,
    /// Free stretch about the middle, from the centre \[m\].
    range_m: [f64; 2],
    /// Neighbours that it ends at.
    met: [Option<usize>; 2],
    /// Neighbour beyond which there is another free stretch.
    beyond: Option<usize>,
}

#[derive(Debug, Clone)]
struct Neighbour {
    id: String,
    solid: Aabb,
    openings: Vec<Aabb>,
}

/// Why a turned member cannot be modelled: what is wrong and what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotClear {
    /// As the end of a sentence that begins with the member.
    pub problem: String,
    /// Remedy.
    pub remedy: &'static str,
}

impl Clear {
    /// The clear shape of one of some members.
    pub fn of(members: &[&Member], index: usize) -> Self {
        let member = members[index];
        let gross = TurnedBox::of(member);
        let neighbour =
            |m: &&Member| Neighbour { id: m.id.clone(), solid: m.solid, openings: m.openings.clone() };
        let axis = match member.kind {
            MemberKind::Wall => 1 - member.axis,
            _ => member.axis,
        };
        let slack_m = member.inclined.map(|i| i.slack_m());
        let around = gross.longer(axis, slack_m.unwrap_or(0.0));
        let near =
            |m: &&Member| !m.is_skew() && around.separation_m(&TurnedBox::of(m)) < COORDINATE_TOLERANCE_M;
        let mut clear = Self {
            axis,
            slack_m,
            range_m: gross.half_m.map(|h| [-h, h]),
            neighbours: members
                .iter()
                .enumerate()
                .filter(|(i, m)| *i != index && near(m))
                .map(|(_, m)| neighbour(m))
                .collect(),
            gross,
        };
        if slack_m.is_some() {
            clear.range_m[axis] = clear.free([0.0; 2]).range_m;
        } else if axis == 2 {
            clear.trim_column();
        } else {
            clear.trim_height();
        }
        clear
    }

    /// The height that is clear over the whole section.
    fn trim_column(&mut self) {
        let ranges: Vec<[f64; 2]> = self.lines(9).into_iter().map(|line| self.free(line).range_m).collect();
        self.range_m[2] =
            ranges.into_iter().fold(self.range_m[2], |[low, high], r| [r[0].max(low), r[1].min(high)]);
    }

    /// A beam or wall wholly under a slab, or on a footing, ends at its face.
    fn trim_height(&mut self) {
        let (corners, bounds) = (self.gross.corners(), self.gross.bounds());
        let [bottom, top] = self.range_m[2].map(|z| z + self.gross.center_m[2]);
        for neighbour in &self.neighbours {
            let solid = &neighbour.solid;
            let covers = corners.iter().all(|c| {
                (0..2).all(|i| {
                    c[i] > solid.min[i] - COORDINATE_TOLERANCE_M
                        && c[i] < solid.max[i] + COORDINATE_TOLERANCE_M
                })
            });
            let open = |o: &Aabb| (0..2).all(|i| o.min[i] < bounds.max[i] && o.max[i] > bounds.min[i]);
            if !covers || neighbour.openings.iter().any(open) {
                continue;
            }
            if solid.max[2] > top - COORDINATE_TOLERANCE_M {
                self.range_m[2][1] = self.range_m[2][1].min(solid.min[2] - self.gross.center_m[2]);
            } else if solid.min[2] < bottom + COORDINATE_TOLERANCE_M {
                self.range_m[2][0] = self.range_m[2][0].max(solid.max[2] - self.gross.center_m[2]);
            }
        }
    }

    /// The two own axes across the long one.
    pub fn across(&self) -> [usize; 2] {
        [[1, 2], [0, 2], [0, 1]][self.axis]
    }

    /// Lines over the clear section, `count` in each direction, the outer ones just inside its edges.
    fn lines(&self, count: usize) -> Vec<[f64; 2]> {
        let [a, b] = self.across().map(|i| self.range_m[i]);
        let at = |[low, high]: [f64; 2], k: usize| low + (high - low) * k as f64 / (count - 1) as f64;
        (0..count * count).map(|k| [at(a, k % count), at(b, k / count)]).collect()
    }

    /// A point of the middle section at an offset across the member, not nearer to the faces than [`INSET`], along its own axes.
    fn inset(&self, offset: [f64; 2]) -> [f64; 3] {
        let mut local = [0.0; 3];
        for (i, value) in self.across().into_iter().zip(offset) {
            let inside = (1.0 - INSET) * self.gross.half_m[i];
            local[i] = value.clamp(-inside, inside);
        }
        local
    }

    /// The free stretch about the middle of the line at an offset across the member.
    fn free(&self, offset: [f64; 2]) -> Line {
        let local = self.inset(offset);
        let (from, along) = (self.gross.to_global(local), self.gross.direction(self.axis));
        let (half, slack) = (self.gross.half_m[self.axis], self.slack_m.unwrap_or(0.0));
        let mut blocked: Vec<([f64; 2], usize)> = Vec::new();
        for (n, neighbour) in self.neighbours.iter().enumerate() {
            let Some(inside) = within(&neighbour.solid, from, along) else { continue };
            let mut parts = vec![inside];
            for open in neighbour.openings.iter().filter_map(|o| within(o, from, along)) {
                parts = parts.into_iter().flat_map(|p| without(p, open)).collect();
            }
            blocked.extend(parts.into_iter().map(|p| (p, n)));
        }
        let (mut low, mut high) = (-half - slack, half + slack);
        for ([from, to], _) in &blocked {
            if from + to < 0.0 {
                low = low.max(*to);
            } else {
                high = high.min(*from);
            }
        }
        let lost = |range: [f64; 2]| {
            let rest = blocked
                .iter()
                .fold(vec![range], |rest, (b, _)| rest.into_iter().flat_map(|p| without(p, *b)).collect());
            rest.iter().any(|[a, b]| b - a > COORDINATE_TOLERANCE_M.max(slack))
        };
        let at = |end: f64| blocked.iter().find(|(b, _)| b.contains(&end)).map(|(_, n)| *n);
        let beyond = if lost([-half, low]) {
            at(low)
        } else if lost([high, half]) {
            at(high)
        } else {
            None
        };
        Line { length_m: high - low, range_m: [low, high], met: [at(low), at(high)], beyond }
    }

    /// Clear extent of a line along the member at an offset across it, from the centre \[m\].
    pub fn range_at(&self, offset: [f64; 2]) -> [f64; 2] {
        if self.axis == 2 { self.range_m[2] } else { self.free(offset).range_m }
    }

    /// Whether a point of the member lies on a face of a neighbour.
    pub fn meets(&self, point_m: [f64; 3]) -> bool {
        self.neighbours.iter().any(|n| {
            let open = |o: &Aabb| o.contains(point_m, -ON_FACE_M);
            n.solid.contains(point_m, ON_FACE_M) && !n.openings.iter().any(open)
        })
    }

    /// Volume outside the neighbours \[m³\]. Exact if the member's ends meet plane faces; else by [`VOLUME_LINES`] across.
    pub fn volume_m3(&self) -> f64 {
        let [a, b] = self.across();
        let even = |i: usize| -> Vec<[f64; 2]> {
            let h = self.gross.half_m[i];
            let at = |k: usize| -h + 2.0 * h * k as f64 / VOLUME_LINES as f64;
            (0..VOLUME_LINES).map(|k| [at(k), at(k + 1)]).collect()
        };
        let second = if b == 2 { self.layers() } else { even(b) };
        let mut sum = 0.0;
        for q in &second {
            for p in even(a) {
                let length = self.free([0.5 * (p[0] + p[1]), 0.5 * (q[0] + q[1])]).length_m;
                sum += length.max(0.0) * (p[1] - p[0]) * (q[1] - q[0]);
            }
        }
        sum
    }

    /// Stretches of the height between the neighbours' horizontal faces, from the centre \[m\].
    fn layers(&self) -> Vec<[f64; 2]> {
        let [low, high] = self.range_m[2];
        let mut levels = vec![low, high];
        for neighbour in &self.neighbours {
            for solid in neighbour.openings.iter().chain([&neighbour.solid]) {
                levels.extend([solid.min[2], solid.max[2]].map(|z| z - self.gross.center_m[2]));
            }
        }
        levels.retain(|z| (low..=high).contains(z));
        levels.sort_by(f64::total_cmp);
        levels.windows(2).map(|w| [w[0], w[1]]).filter(|[a, b]| b - a > COORDINATE_TOLERANCE_M).collect()
    }

    /// Lowest point of its clear shape \[m\].
    pub fn lowest_m(&self) -> f64 {
        let ends = self.lines(JUDGED_LINES).into_iter().flat_map(|offset| {
            self.range_at(offset).map(|at| {
                let mut local = self.inset(offset);
                local[self.axis] = at;
                self.gross.to_global(local)[2]
            })
        });
        ends.fold(f64::INFINITY, f64::min)
    }

    /// Whether its clear shape and that of another have more than [`ON_FACE_M`] of depth in common, by points along its lines.
    pub fn overlaps(&self, other: &Self) -> bool {
        let within = |local: [f64; 3], clear: &Self| {
            let inside =
                |i: usize, [low, high]: [f64; 2]| local[i] > low + ON_FACE_M && local[i] < high - ON_FACE_M;
            let across = clear.across();
            across.iter().all(|i| inside(*i, clear.range_m[*i]))
                && inside(clear.axis, clear.range_at(across.map(|i| local[i])))
        };
        let across = self.across();
        let widest = across.iter().map(|i| self.range_m[*i][1] - self.range_m[*i][0]).fold(0.0, f64::max);
        self.lines(OVERLAP_LINES).into_iter().any(|offset| {
            let [low, high] = self.range_at(offset);
            let count = ((high - low) * OVERLAP_LINES as f64 / widest).ceil().max(1.0) as usize;
            (0..=count).any(|k| {
                let mut local = [0.0; 3];
                across.iter().zip(offset).for_each(|(i, value)| local[*i] = value);
                local[self.axis] = low + (high - low) * k as f64 / count as f64;
                within(other.gross.to_local(self.gross.to_global(local)), other)
            })
        })
    }

    /// What is wrong with the ends of a brace.
    fn loose_end(&self, lines: &[Line]) -> Option<NotClear> {
        for end in 0..2 {
            let met = lines.iter().filter_map(|line| line.met[end]).next();
            if lines.iter().all(|line| line.met[end].is_some()) {
                continue;
            }
            let mut local = [0.0; 3];
            local[self.axis] = [-1.0, 1.0][end] * self.gross.half_m[self.axis];
            let [x, y, z] = self.gross.to_global(local).map(|c| round_to_digits(c, 4));
            let name = ["`from`", "`to`"][end];
            return Some(match met {
                None => NotClear {
                    problem: format!("touches nothing at {name}, ({x}, {y}, {z}) m"),
                    remedy: "let its axis run into a column, beam, slab, wall or footing along the axes",
                },
                Some(n) => NotClear {
                    problem: format!(
                        "meets `{}` at {name}, ({x}, {y}, {z}) m, only with a part of its end",
                        self.neighbours[n].id
                    ),
                    remedy: "its whole end must meet neighbours: move the point to the middle of a face or joint, or put a footing under it",
                },
            });
        }
        None
    }

    /// What keeps the member from being modelled, if anything.
    pub fn problem(&self) -> Option<NotClear> {
        let lines = self.lines(JUDGED_LINES);
        let free: Vec<_> = lines.iter().map(|line| self.free(*line)).collect();
        let gross = 2.0 * self.gross.half_m[self.axis];
        let [low, high] = self.range_m[self.axis];
        let height = self.range_m[2][1] - self.range_m[2][0];
        let shortest = free.iter().map(|f| f.length_m).fold(high - low, f64::min);
        if let Some(n) = free.iter().find_map(|f| f.beyond) {
            return Some(NotClear {
                problem: format!("passes through `{}`", self.neighbours[n].id),
                remedy: if self.slack_m.is_some() {
                    "a brace ends in its neighbours: divide it there, or move it aside"
                } else {
                    "a turned member ends in its neighbours: divide it there"
                },
            });
        }
        if shortest < LEAST_LEFT * gross || height < LEAST_LEFT * 2.0 * self.gross.half_m[2] {
            return Some(NotClear {
                problem: "lies mostly inside other members".into(),
                remedy: if self.slack_m.is_some() {
                    "a brace yields to all others; let it run between them"
                } else {
                    "a turned member yields to all others; describe only what stands between them"
                },
            });
        }
        if self.slack_m.is_some()
            && let Some(loose) = self.loose_end(&free)
        {
            return Some(loose);
        }
        if self.axis == 2 {
            return None;
        }
        let widths =
            self.across().map(|i| (self.range_m[i][1] - self.range_m[i][0]) / (JUDGED_LINES - 1) as f64);
        let steep = |a: usize, b: usize, width: f64| {
            (0..2).any(|end| (free[a].range_m[end] - free[b].range_m[end]).abs() > STEEPEST * width)
        };
        let jagged = (0..lines.len()).any(|k| {
            (k % JUDGED_LINES > 0 && steep(k, k - 1, widths[0]))
                || (k >= JUDGED_LINES && steep(k, k - JUDGED_LINES, widths[1]))
        });
        jagged.then(|| {
            let ids: Vec<String> = self.neighbours.iter().map(|n| format!("`{}`", n.id)).collect();
            NotClear {
                problem: format!("meets its neighbours ({}) at too flat an angle or only in part", ids.join(", ")),
                remedy: if self.slack_m.is_some() {
                    "let its whole end meet faces under at least 27 degrees"
                } else {
                    "let its whole end meet a face under at least 27 degrees, and its top lie wholly under a slab or not at all"
                },
            }
        })
    }
}

/// Stretch of a line inside a box.
fn within(solid: &Aabb, from: [f64; 3], along: [f64; 3]) -> Option<[f64; 2]> {
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for i in 0..3 {
        let [a, b] = [solid.min[i] - from[i], solid.max[i] - from[i]];
        if along[i].abs() < 1e-12 {
            if a >= -COORDINATE_TOLERANCE_M || b <= COORDINATE_TOLERANCE_M {
                return None;
            }
            continue;
        }
        let (p, q) = (a / along[i], b / along[i]);
        low = low.max(p.min(q));
        high = high.min(p.max(q));
    }
    (high - low > COORDINATE_TOLERANCE_M).then_some([low, high])
}

/// A stretch without another.
fn without([low, high]: [f64; 2], [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    [[low, high.min(from)], [low.max(to), high]].into_iter().filter(|[a, b]| a < b).collect()
}
