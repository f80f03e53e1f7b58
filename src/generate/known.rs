//! What is known of members and member ends before any run: the features that rules ask about, for the generator and for
//! those who learn rules from studies alike.
//!
//! Each feature is found by sorting or by looking up in a tree, so that the cost grows as `n log n` with the number of members.

use super::is_column;
use super::known_lines::Lines;
use super::nearest::Nearest;
use super::stretch::stretches;
use crate::building::ends::{End, MemberEnd, member_ends};
use crate::building::lines::{Line, lines};
use crate::building::partition::Partition;
use crate::building::rows::rows;
use crate::building::{Building, Member, MemberKind, Obstacle, Preparation};
use crate::graph::{Demands, EndDemand, EndState, Structure, demands};
use crate::rules::{Subject, SubjectKind, Value};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// How far apart the ends of a beam and a column at one joint may be beyond their sizes \[m\].
const JOINT_TOLERANCE_M: f64 = 0.05;

/// What is known of the parts of a building.
#[derive(Debug, Clone)]
pub struct Known {
    /// Of the members, in the order of the building.
    pub members: Vec<Subject>,
    /// Of the ends of columns and beams, in their order.
    pub ends: Vec<Subject>,
    /// Of the lines of slabs, and the bases and tops of walls.
    pub lines: Vec<Subject>,
}

impl Known {
    /// Of a building of which structure, ends and demands have been found.
    pub fn of(
        building: &Building,
        structure: &Structure,
        (ends, of_plates): (&[MemberEnd], &[Line]),
        demands: &Demands,
    ) -> Self {
        let site = Site::of(building, ends, demands);
        let lengths = clear_lengths(building, &structure.partition);
        let own = |i: usize| site.member(i, lengths[i]);
        let members: Vec<Subject> = (0..building.members.len()).into_par_iter().map(own).collect();
        let joints = Joints::of(building, ends);
        let known = Lines::of(&site, of_plates, &joints);
        let lines = of_plates.iter().map(|line| known.subject(line, &members[line.member])).collect();
        let end = |i: usize| site.end(i, &members, &joints, &structure.partition);
        let ends = (0..ends.len()).into_par_iter().map(end).collect();
        Self { members, ends, lines }
    }

    /// Of a building alone: its elastic demands are computed, no FE run and no library is needed.
    pub fn of_building(building: &Building) -> Self {
        let structure = Structure::of(building);
        let ends = member_ends(building, &structure.partition);
        let plates = lines(building, &structure.partition);
        Self::of(building, &structure, (&ends, &plates), &demands(&structure, building))
    }
}

/// What the parts of a building have in common, and the look-up tables.
pub(super) struct Site<'a> {
    pub building: &'a Building,
    pub ends: &'a [MemberEnd],
    /// Demands of the ends, by id.
    demands: BTreeMap<&'a str, &'a EndDemand>,
    /// The building as a whole.
    common: Vec<(&'static str, Value)>,
    /// Longest span between axes of columns \[m\].
    span_m: f64,
    /// Longest stretch of the floor of each storey between columns that stand, or beyond the last of them \[m\].
    stretch_m: BTreeMap<Option<u32>, f64>,
    /// Depth of the floor of each storey: that of its deepest beam, or of its slabs where there is none \[m\].
    depth_m: BTreeMap<Option<u32>, f64>,
    charged: BTreeSet<&'a str>,
    weakened: BTreeSet<&'a str>,
    held: BTreeSet<&'a str>,
    /// Where columns are taken away: half their sizes and the lowest level from which one is \[m\].
    removed: Nearest<([f64; 2], f64)>,
    /// Axial forces of the bars before and after the charges over area times first yield stress.
    axial: BTreeMap<usize, [Option<f64>; 2]>,
}

impl<'a> Site<'a> {
    fn of(building: &'a Building, ends: &'a [MemberEnd], demands: &'a Demands) -> Self {
        let columns = || building.members.iter().filter(|m| m.kind == MemberKind::Column);
        let span = |axis: usize| {
            let axes = rows(columns().map(|m| [m.solid.center()[axis], 0.0]).collect());
            axes.windows(2).map(|w| w[1].at_m - w[0].at_m).fold(0.0, f64::max)
        };
        let depths = |kind: MemberKind| {
            let mut depths = BTreeMap::<Option<u32>, f64>::new();
            for member in building.members.iter().filter(|m| m.kind == kind) {
                let depth = depths.entry(member.storey).or_default();
                *depth = depth.max(member.solid.size()[2]);
            }
            depths
        };
        let mut depth_m = depths(MemberKind::Slab);
        depth_m.extend(depths(MemberKind::Beam));
        let weakened = building.preparation.iter().filter_map(|p| match p {
            Preparation::Weaken { member, .. } => Some(member.as_str()),
            Preparation::Cut { .. } => None,
        });
        let charged: BTreeSet<&str> = building.events.iter().map(|e| e.member.as_str()).collect();
        let mut site = Self {
            building,
            ends,
            demands: demands.ends.iter().map(|d| (d.id.as_str(), d)).collect(),
            common: Vec::new(),
            span_m: span(0).max(span(1)),
            stretch_m: stretches(building),
            depth_m,
            removed: removed(building, &charged),
            charged,
            weakened: weakened.collect(),
            held: building.supports.iter().map(|s| s.member.as_str()).collect(),
            axial: BTreeMap::new(),
        };
        site.common = site.common(demands);
        site.axial = site.axial_ratios();
        site
    }

    /// What is known of the building as a whole.
    fn common(&self, demands: &Demands) -> Vec<(&'static str, Value)> {
        let building = self.building;
        let storeys = building.members.iter().filter_map(|m| m.storey).max().unwrap_or(0);
        let mut of_storey = BTreeMap::<Option<u32>, [f64; 2]>::new();
        for column in building.members.iter().filter(|m| m.kind == MemberKind::Column) {
            let [gone, all] = of_storey.entry(column.storey).or_default();
            *all += 1.0;
            *gone += f64::from(u8::from(self.charged.contains(column.id.as_str())));
        }
        let share = of_storey.values().map(|[gone, all]| gone / all).fold(0.0, f64::max);
        let times = || building.events.iter().map(|e| e.time_s);
        let (first, last) = (times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max));
        let mechanism = demands.after.as_ref().unwrap_or(&demands.before).free().is_some();
        let mut common: Vec<(&'static str, Value)> = vec![
            ("building.charged_share", share.into()),
            ("building.ignition_span", (last - first).max(0.0).into()),
            ("building.mechanism", mechanism.into()),
            ("collapse.phase", "before_contact".into()),
            ("critical_strain_rate", building.settings.critical_strain_rate_1_s.into()),
            ("storeys", f64::from(storeys).into()),
        ];
        let largest = |ratio: fn(&EndState) -> f64| demands.largest_of_columns(building, ratio);
        let ratio = largest(|s| s.section.ratio).map(|r| ("building.demand_ratio", r.into()));
        let of_law = largest(|s| s.homogenised.ratio).map(|r| ("building.law_demand_ratio", r.into()));
        common.extend(ratio.into_iter().chain(of_law));
        common
    }

    /// Axial forces of the bars over what their gross sections bear at first yield.
    fn axial_ratios(&self) -> BTreeMap<usize, [Option<f64>; 2]> {
        let mut ratios = BTreeMap::<usize, [Option<f64>; 2]>::new();
        for end in self.ends {
            let Some(demand) = self.demands.get(end.id.as_str()) else { continue };
            let member = &self.building.members[end.member];
            let size = member.solid.size();
            let area: f64 = (0..3).filter(|i| *i != end.axis).map(|i| size[i]).product();
            let Some(first) = self.building.law_of(member).hardening.first() else { continue };
            let held = ratios.entry(end.member).or_default();
            for (held, state) in held.iter_mut().zip([&demand.before, &demand.after]) {
                let ratio = state.map(|s| s.forces.axial_n / (area * first.stress_pa));
                *held = (*held).into_iter().chain(ratio).reduce(f64::max);
            }
        }
        ratios
    }

    /// What is known of a member with a clear length \[m\].
    fn member(&self, index: usize, clear_m: Option<f64>) -> Subject {
        let member = &self.building.members[index];
        let id = member.id.as_str();
        let size = member.solid.size();
        let bar = matches!(member.kind, MemberKind::Column | MemberKind::Beam);
        let longest = size.iter().copied().fold(0.0, f64::max);
        let length = if bar { clear_m.unwrap_or(0.0) } else { longest };
        let least = size.iter().copied().fold(f64::INFINITY, f64::min);
        let centre = member.solid.center();
        let [before, after] = self.axial.get(&index).copied().unwrap_or_default();
        let storeys = self.common.iter().find(|(name, _)| *name == "storeys").map(|(_, value)| value);
        let share = member.storey.zip(storeys).and_then(|(storey, all)| match all {
            Value::Number(all) if *all > 0.0 => Some(f64::from(storey) / all),
            _ => None,
        });
        let is_floor = matches!(member.kind, MemberKind::Slab | MemberKind::Beam);
        let stretch = self.stretch_m.get(&member.storey).filter(|_| is_floor);
        let slenderness = stretch.zip(self.depth_m.get(&member.storey)).map(|(long, deep)| long / deep);
        let fall_m = member.solid.min[2] - self.building.ground.level_m;
        let subject =
            self.common.iter().fold(Subject::new(SubjectKind::Member, id), |subject, (name, value)| {
                subject.with(name, value.clone())
            });
        subject
            .with("member.kind", member.kind.name())
            .with("member.charged", self.charged.contains(id))
            .with("member.weakened", self.weakened.contains(id))
            .with("member.length", length)
            .with("member.slenderness", length / least)
            .with("member.fall_height", fall_m)
            .with("member.impact_speed", (2.0 * self.building.settings.gravity_m_s2 * fall_m.max(0.0)).sqrt())
            .with_known("member.obstacle_distance", self.obstacle_distance(member))
            .with_known("member.storey", member.storey.map(f64::from))
            .with_known("member.storey_share", share)
            .with_known("member.axial_ratio", before)
            .with_known("member.axial_ratio_after", after)
            .with_known("member.charge_distance", self.charge_distance([centre[0], centre[1]]))
            .with_known("member.span_over_depth", depth_ratio(member, length))
            .with_known("floor.slenderness", slenderness)
    }

    /// Distance in plan of a member to the nearest obstacle, over the height of its top above the ground.
    fn obstacle_distance(&self, member: &Member) -> Option<f64> {
        let top_m = member.solid.max[2] - self.building.ground.level_m;
        let gap = |o: &Obstacle, i: usize| {
            (o.solid.min[i] - member.solid.max[i]).max(member.solid.min[i] - o.solid.max[i]).max(0.0)
        };
        let distances = self.building.obstacles.iter().map(|o| libm::hypot(gap(o, 0), gap(o, 1)));
        distances.reduce(f64::min).filter(|_| top_m > 0.0).map(|distance| distance / top_m)
    }

    /// Distance in plan to the nearest column that a charge takes away, in longest spans.
    pub fn charge_distance(&self, plan: [f64; 2]) -> Option<f64> {
        let (distance, ..) = self.removed.to(plan).filter(|_| self.span_m > 0.0)?;
        Some(distance / self.span_m)
    }

    /// Whether a charge takes a column away below a place.
    pub fn over_charge(&self, point: [f64; 3]) -> bool {
        self.removed.to([point[0], point[1]]).is_some_and(|(_, at, (half, level))| {
            (0..2).all(|i| (point[i] - at[i]).abs() <= half[i] + JOINT_TOLERANCE_M)
                && level < point[2] - JOINT_TOLERANCE_M
        })
    }

    /// What is known of a member end.
    fn end(&self, index: usize, members: &[Subject], joints: &Joints, partition: &Partition) -> Subject {
        let (building, end) = (self.building, &self.ends[index]);
        let mut subject = members[end.member].clone();
        let of_members = |name: &str| name == "member.charge_distance" || name == "floor.slenderness";
        subject.features.retain(|name, _| !of_members(name));
        let adjoining = end.beyond(partition).map(|m| building.members[m].kind.name());
        let position = match (is_column(building, end.member), end.end) {
            (true, End::Lower) => "bottom",
            (true, End::Upper) => "top",
            (false, End::Lower) => "start",
            (false, End::Upper) => "end",
        };
        let clamped = adjoining.is_none() && self.held.contains(building.members[end.member].id.as_str());
        subject.id.clone_from(&end.id);
        subject.kind = SubjectKind::MemberEnd;
        let after = |i: usize| self.demand(i)?.after;
        let at_joint = joints.columns.get(&index).into_iter().flatten();
        let columns = at_joint.filter_map(|c| Some(after(*c)?.section.ratio)).reduce(f64::max);
        let plan = [end.point_m[0], end.point_m[1]];
        subject
            .with("end.position", position)
            .with("end.clamped", clamped)
            .with("end.adjoining", adjoining.unwrap_or(if clamped { "ground" } else { "none" }))
            .with("end.over_charge", self.over_charge(end.point_m))
            .with_known("end.charge_distance", self.charge_distance(plan))
            .with_known("end.demand_ratio", after(index).map(|s| s.section.ratio))
            .with_known("end.law_demand_ratio", self.law_ratio(index))
            .with_known(
                "end.demand_ratio_before",
                self.demand(index).and_then(|d| Some(d.before?.section.ratio)),
            )
            .with_known("end.column_demand_ratio", columns)
            .with_known("end.joint_strength", self.joint_strength(index, joints))
    }

    /// Whether a member stands on a support.
    pub fn is_held(&self, member: usize) -> bool {
        self.held.contains(self.building.members[member].id.as_str())
    }

    /// Demand ratio of an end after the removal, by the homogenised law.
    pub fn law_ratio(&self, end: usize) -> Option<f64> {
        self.law_ratio_of(&self.ends[end].id)
    }

    /// The same of an end by its id, walls included.
    pub fn law_ratio_of(&self, id: &str) -> Option<f64> {
        Some(self.demands.get(id)?.after?.homogenised.ratio)
    }

    fn demand(&self, end: usize) -> Option<&EndDemand> {
        self.demands.get(self.ends[end].id.as_str()).copied()
    }

    /// Sum of the capacities of the beams at a joint over that of its columns, at the axial forces under dead load.
    fn joint_strength(&self, end: usize, joints: &Joints) -> Option<f64> {
        let (beams, columns) = joints.around(end);
        let sum = |ends: &BTreeSet<usize>, of: fn(f64, f64) -> f64| {
            let capacity = |e: &usize| {
                let [a, b] = self.demand(*e)?.before?.homogenised.capacity_nm;
                Some(of(a, b))
            };
            ends.iter().filter_map(capacity).sum::<f64>()
        };
        let (beams, columns) = (sum(&beams, f64::max), sum(&columns, f64::min));
        (beams > 0.0 && columns > 0.0).then(|| beams / columns)
    }
}

/// Clear length over depth of a beam.
fn depth_ratio(member: &Member, length_m: f64) -> Option<f64> {
    (member.kind == MemberKind::Beam && length_m > 0.0).then(|| length_m / member.solid.size()[2])
}

/// Where charges take columns away.
fn removed(building: &Building, charged: &BTreeSet<&str>) -> Nearest<([f64; 2], f64)> {
    // a stack of charged columns is one place; its plan position is told to the millimetre
    let mut stacks = BTreeMap::<[i64; 2], ([f64; 2], ([f64; 2], f64))>::new();
    let gone = |m: &&Member| m.kind == MemberKind::Column && charged.contains(m.id.as_str());
    for column in building.members.iter().filter(gone) {
        let (centre, size) = (column.solid.center(), column.solid.size());
        let plan = [centre[0], centre[1]];
        let known = ([0.5 * size[0], 0.5 * size[1]], column.solid.min[2]);
        let key = plan.map(|x| (1e3 * x).round() as i64);
        let (_, (half, level)) = stacks.entry(key).or_insert((plan, known));
        *half = [0, 1].map(|i| half[i].max(known.0[i]));
        *level = level.min(known.1);
    }
    Nearest::of(stacks.into_values().collect())
}

/// Lengths of the members along their axes that are their own \[m\]; `None` where other members own all of one.
fn clear_lengths(building: &Building, partition: &Partition) -> Vec<Option<f64>> {
    let mut ranges: Vec<Option<[f64; 2]>> = vec![None; building.members.len()];
    for (cell, owner) in partition.cells() {
        let (own, axis) = (partition.cell_box(cell), building.members[owner].axis);
        let held = ranges[owner].get_or_insert([f64::INFINITY, f64::NEG_INFINITY]);
        *held = [held[0].min(own.min[axis]), held[1].max(own.max[axis])];
    }
    ranges.into_iter().map(|range| range.map(|r| r[1] - r[0])).collect()
}

/// Which ends of beams and columns meet.
pub(super) struct Joints {
    /// Column ends at the joints of beam ends.
    columns: BTreeMap<usize, Vec<usize>>,
    /// Beam ends at the joints of column ends.
    beams: BTreeMap<usize, Vec<usize>>,
}

impl Joints {
    fn of(building: &Building, ends: &[MemberEnd]) -> Self {
        let size = |e: &MemberEnd| building.members[e.member].solid.size();
        let is_beam = |e: &MemberEnd| !is_column(building, e.member);
        let most = |of: &dyn Fn(&MemberEnd) -> f64| {
            (ends.iter().map(of).fold(0.0, f64::max) + JOINT_TOLERANCE_M) * (1.0 + 1e-9)
        };
        let plan = |e: &MemberEnd| if is_beam(e) { 0.0 } else { 0.5 * size(e)[0].max(size(e)[1]) };
        let deep = |e: &MemberEnd| if is_beam(e) { size(e)[2] } else { 0.0 };
        let edge = [most(&plan), most(&plan), most(&deep)];
        let cell = |e: &MemberEnd| [0, 1, 2].map(|i| (e.point_m[i] / edge[i]).floor() as i64);
        let mut at = BTreeMap::<[i64; 3], Vec<usize>>::new();
        for (i, end) in ends.iter().enumerate().filter(|(_, e)| !is_beam(e)) {
            at.entry(cell(end)).or_default().push(i);
        }
        let mut this = Self { columns: BTreeMap::new(), beams: BTreeMap::new() };
        for (i, end) in ends.iter().enumerate().filter(|(_, e)| is_beam(e)) {
            let [x, y, z] = cell(end);
            let around = (0..27).map(|k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
            let near = around.filter_map(|key| at.get(&key)).flatten();
            let mut own: Vec<usize> = near.copied().filter(|c| meets(building, end, &ends[*c])).collect();
            own.sort_unstable();
            own.iter().for_each(|c| this.beams.entry(*c).or_default().push(i));
            this.columns.insert(i, own);
        }
        this
    }

    /// Column ends at the joint of a beam end.
    pub fn columns_at(&self, end: usize) -> impl Iterator<Item = usize> + Clone {
        self.columns.get(&end).into_iter().flatten().copied()
    }

    /// Beam ends and column ends at the joint of an end.
    fn around(&self, end: usize) -> (BTreeSet<usize>, BTreeSet<usize>) {
        let of = |list: &BTreeMap<usize, Vec<usize>>, ends: &BTreeSet<usize>| -> BTreeSet<usize> {
            ends.iter().filter_map(|e| list.get(e)).flatten().copied().collect()
        };
        let own = BTreeSet::from([end]);
        if self.columns.contains_key(&end) {
            let columns = of(&self.columns, &own);
            (of(&self.beams, &columns), columns)
        } else {
            let beams = of(&self.beams, &own);
            let columns = of(&self.columns, &beams);
            (beams, columns)
        }
    }
}

/// Whether a column ends at the joint that a beam frames into.
fn meets(building: &Building, beam: &MemberEnd, column: &MemberEnd) -> bool {
    let size = building.members[column.member].solid.size();
    let deep = building.members[beam.member].solid.size()[2];
    let reach = [0.5 * size[0], 0.5 * size[1], deep];
    (0..3).all(|i| (beam.point_m[i] - column.point_m[i]).abs() <= reach[i] + JOINT_TOLERANCE_M)
}
