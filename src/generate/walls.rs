//! Walls between floors: rigid plates on springs at base and top that yield.
//!
//! A wall storey of height `h` is as stiff as half of its height at either end: `E A / (h/2)`, `G A_s / (h/2)` and, about its own plane, `E I / (h/2)`. Each end has two springs, in the middles of its halves, which bear the
//! moment in its plane as a couple.
//!
//! Out of its plane a wall is a beam between floors: springs `6 E I / h` that carry over to each other ([`CarryOver`]).
//!
//! Where openings reach foot or head, each strip of the wall beside or over them has springs of its own, at those of its ends that are there ([`piers`]): piers of the whole height as beams, lintels with what the face at their head bears.
//!
//! Where a spring stands on a seam between two pieces of a floor, each piece has its share of it.
//!
//! A wall that stands directly on another one, in line with it, is joined to it once: by the springs of that which openings cut, of the shorter of both, or of the upper one, as stiff as the halves of both one behind the other, with what the weaker section bears.
//!
//! Walls yield axially at the squash load `f A` of the homogenised law either way, and out of the plane by the elements across their thickness, in plane strain ([`crate::rc::layers`]), times `1 - (N/N_p)²`.
//! In shear they slip at the shear capacity of the law ([`slip`]).

use super::bodies::Bodies;
use super::decide::Decision;
use super::joints::{Place, axes, stands};
use super::piers::{self, Strip};
use super::sections::slip;
use crate::base::geom::Aabb;
use crate::building::gaps::JUST_BEYOND_M;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::building::{Building, Homogenised, MemberKind};
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::graph::Structure;
use crate::mbs::model::{Bending, Bushing, CarryOver, Origin};
use crate::rc::around::edges_between;
use crate::rc::layers::{Held, Layer, Layers, Rows};
use std::collections::BTreeMap;

/// How far from a spring the pieces are looked for that it may stand on \[m\]: less than any piece is wide.
const BESIDE_M: f64 = 1e-3;

/// Axial forces of the levels of a curve over the squash load.
const LEVELS: [f64; 7] = [-0.95, -0.75, -0.4, 0.0, 0.4, 0.75, 0.95];

/// The springs of all walls that are bodies of their own, and their curves by id, for the planes of a mesh along x, y and z \[m\].
pub fn springs(
    &Place { building, bodies, .. }: &Place<'_>,
    structure: &Structure,
    decision: &Decision,
    planes: &[Vec<f64>; 3],
) -> (Vec<Bushing>, BTreeMap<String, ResistanceCurve>) {
    let walls = (0..building.members.len()).filter(|m| building.members[*m].kind == MemberKind::Wall);
    let (mut springs, mut curves) = (Vec::new(), BTreeMap::new());
    for wall in walls {
        let Some(whole) = Half::of(building, structure, wall) else { continue };
        let halves = whole.strips(building, structure, bodies);
        for (part, spring) in of_wall(building, structure, (bodies, decision), (&whole, &halves)) {
            curves.entry(part.curve_id(building)).or_insert_with(|| part.curve(planes));
            springs.push(spring);
        }
    }
    (springs, curves)
}

/// Half of a wall storey, or of a strip of it, in its length and in its height, or a share of it.
#[derive(Clone, Copy)]
struct Half<'a> {
    wall: usize,
    /// Number of its strip where openings cut the wall into several.
    strip: Option<usize>,
    /// Whether it has a foot, and a head.
    ends: [bool; 2],
    /// Whether openings cut the wall into strips.
    is_cut: bool,
    /// How much of it a spring stands for.
    share: f64,
    law: &'a Homogenised,
    /// Share of its strength that preparation leaves.
    strength: f64,
    solid: Aabb,
    /// Axis of its length.
    along: usize,
    length_m: f64,
    thickness_m: f64,
    height_m: f64,
    /// The wall that it stands on or bears, in line with it, and what of this section is as stiff as the half of that one \[m\].
    beyond: Option<(usize, f64)>,
    mesh_m: f64,
}

impl<'a> Half<'a> {
    fn of(building: &'a Building, structure: &Structure, wall: usize) -> Option<Self> {
        let member = &building.members[wall];
        let solid = structure.boxes(wall).iter().copied().reduce(Aabb::around)?;
        let size = solid.size();
        let along = usize::from(size[1] > size[0]);
        Some(Self {
            wall,
            strip: None,
            ends: [true; 2],
            is_cut: piers::reach_an_end(&member.openings, &solid),
            share: 1.0,
            law: building.law_of(member),
            strength: building.strength_factor(&member.id),
            solid,
            along,
            length_m: 0.5 * size[along],
            thickness_m: size[1 - along],
            height_m: 0.5 * size[2],
            beyond: None,
            mesh_m: building.settings.mesh_size_m,
        })
    }

    /// The halves of the strips of a whole wall: itself, if no opening reaches its foot or head.
    fn strips(&self, building: &Building, structure: &Structure, bodies: &Bodies) -> Vec<Self> {
        if !self.is_cut {
            return vec![*self];
        }
        let faces = [0, 1].map(|end| face(building, structure, bodies, self, end));
        let strips = piers::strips(&faces, self.along).into_iter().enumerate();
        strips.map(|(k, strip)| self.cut(k, strip)).collect()
    }

    /// The half of a strip of it.
    fn cut(&self, number: usize, Strip { along_m, ends }: Strip) -> Self {
        let (along, mut solid) = (self.along, self.solid);
        (solid.min[along], solid.max[along]) = (along_m[0], along_m[1]);
        Self { strip: Some(number), ends, solid, length_m: 0.5 * solid.size()[along], ..*self }
    }

    /// What springs at its foot (`end` 0) or head stand for, of this part of it and with this wall beyond; nothing where the springs of that one join both.
    fn joint(&self, part: Half<'a>, beyond: Option<Half<'a>>, end: usize) -> Option<Half<'a>> {
        match beyond {
            Some(other) if other.along == self.along => self.joins(&other, end).then(|| part.in_line(other)),
            _ => Some(part),
        }
    }

    /// The joint between it and a half of a wall in line with it above or below: the section of the weaker one, as stiff as both one behind the other.
    fn in_line(&self, other: Half<'a>) -> Self {
        let mut solid = other.solid;
        (solid.min[self.along], solid.max[self.along]) =
            (self.solid.min[self.along], self.solid.max[self.along]);
        let other = Half { solid, length_m: self.length_m, share: self.share, ..other };
        let axial = |half: &Half| half.law.youngs_modulus_pa * half.thickness_m / half.height_m;
        let (weaker, stronger) =
            if other.squash_n() < self.squash_n() { (&other, self) } else { (self, &other) };
        let beyond = Some((other.wall, weaker.height_m * axial(weaker) / axial(stronger)));
        Self { wall: self.wall, strip: self.strip, ends: self.ends, beyond, ..*weaker }
    }

    /// Whether its springs, at its foot (`end` 0) or head, join it to a wall in line with it there, and not that one's: strips stand where both meet, and the points of the shorter wall do.
    fn joins(&self, other: &Half<'_>, end: usize) -> bool {
        if self.is_cut != other.is_cut {
            return self.is_cut;
        }
        let longer_m = self.length_m - other.length_m;
        if longer_m.abs() < COORDINATE_TOLERANCE_M { end == 0 } else { longer_m < 0.0 }
    }

    /// How much of its section is as stiff as what a spring of it stands for \[m\].
    fn reach_m(&self) -> f64 {
        self.height_m + self.beyond.map_or(0.0, |(_, reach_m)| reach_m)
    }

    /// Where its spring stands at its foot (`end` 0) or head \[m\].
    fn point_m(&self, side: usize, end: usize) -> [f64; 3] {
        let mut point_m = self.solid.center();
        point_m[self.along] = self.solid.min[self.along] + (0.5 + side as f64) * self.length_m;
        point_m[2] = if end == 0 { self.solid.min[2] } else { self.solid.max[2] };
        point_m
    }

    fn curve_id(&self, building: &Building) -> String {
        let wall = &building.members[self.wall].id;
        let strip = self.strip.map_or_else(String::new, |k| format!("/strip-{}", k + 1));
        let share = if self.share < 1.0 { format!("/{}", self.share) } else { String::new() };
        let joint =
            self.beyond.map_or_else(String::new, |(other, _)| format!("/{}", building.members[other].id));
        format!("wall/{wall}{strip}{share}{joint}")
    }

    /// Its share of the length \[m\].
    fn own_m(&self) -> f64 {
        self.share * self.length_m
    }

    /// Force at which the section flows \[N\].
    fn squash_n(&self) -> f64 {
        let first = self.law.hardening.first().map_or(0.0, |p| p.stress_pa);
        self.strength * first * self.own_m() * self.thickness_m
    }

    /// Elastic stiffness out of the plane in sway, `6 E I / h` \[N m/rad\].
    fn out_of_plane(&self) -> f64 {
        3.0 * self.law.youngs_modulus_pa * self.own_m() * self.thickness_m.powi(3) / 12.0 / self.reach_m()
    }

    /// What the springs at base and top carry over to each other: out of the plane they are a beam.
    fn carry_over(&self, foot: String) -> CarryOver {
        let flexibility = 1.0 / self.out_of_plane();
        CarryOver {
            bushing: foot,
            flexibility_rad_nm: if self.along == 0 { [flexibility, 0.0] } else { [0.0, flexibility] },
        }
    }

    /// A spring of it that does not yield.
    fn elastic(&self, spring: Bushing) -> Bushing {
        let out_of_plane = Bending::Elastic { stiffness_nm_rad: self.out_of_plane() };
        let [about_x, about_y] = spring.bending;
        Bushing {
            bending: if self.along == 0 { [out_of_plane, about_y] } else { [about_x, out_of_plane] },
            tensile_capacity_n: None,
            tensile_elongation_m: None,
            shear_capacity_n: None,
            shear_slip_m: None,
            compressive_capacity_n: None,
            associated_flow: false,
            ..spring
        }
    }

    /// Bending out of the plane, by the elements across its thickness.
    fn curve(&self, planes: &[Vec<f64>; 3]) -> ResistanceCurve {
        let edges = |axis: usize| edges_between(&planes[axis], [self.solid.min[axis], self.solid.max[axis]]);
        let row_m = edges(2).windows(2).map(|z| z[1] - z[0]).fold(0.0, f64::max);
        let across = edges(1 - self.along);
        let layers = Layer::between(&across, self.own_m(), self.strength, true, self.law);
        let rows = Rows { row_m, shear_span_m: self.height_m, held: Held::OneWay };
        let without = Layers::of(layers.collect()).map(|layers| layers.weaker(&rows, 0.0));
        let level = |share: f64| {
            let mut level = CapacityLevel { axial_force_n: share * self.squash_n(), ..without.clone()? };
            level.scale(1.0 - share * share);
            Some(level)
        };
        let levels = LEVELS.into_iter().filter_map(level).collect();
        ResistanceCurve { stiffness_nm_rad: self.out_of_plane(), levels, cyclic: None }
    }
}

/// The springs of a wall, those at its foot first, each with what it stands for.
fn of_wall<'a>(
    building: &'a Building,
    structure: &Structure,
    (bodies, decision): (&Bodies, &Decision),
    (whole, halves): (&Half<'a>, &[Half<'a>]),
) -> Vec<(Half<'a>, Bushing)> {
    let wall = &building.members[whole.wall].id;
    let (mut list, mut feet) = (Vec::new(), BTreeMap::new());
    let both = |half: &Half<'a>| [0, 1].map(|side| (side, parts(building, structure, bodies, half, side)));
    let sides: Vec<_> = halves.iter().flat_map(|half| both(half).map(|own| (half.ends, own))).collect();
    for (end, name) in [(0, "bottom"), (1, "top")] {
        let line = format!("{wall}.{name}");
        let there = sides.iter().enumerate().filter(|(_, (ends, _))| ends[end]);
        for (number, (place, (_, (side, parts)))) in there.enumerate() {
            for (k, (part, neighbours)) in parts.iter().enumerate() {
                let Some(Beyond { body, wall: next }) = neighbours[end] else { continue };
                let next = next.and_then(|next| Half::of(building, structure, next));
                let Some(joint) = whole.joint(*part, next, end) else { continue };
                let letter = if parts.len() > 1 { ["a", "b", "c", "d"][k] } else { "" };
                let id = format!("{line}-{}{letter}", number + 1);
                let mut own = spring(building, bodies, &joint, body, (id, part.point_m(*side, end)));
                if decision.elastic_lines.contains(&line) {
                    own = joint.elastic(own);
                }
                own.origin.members.push(line.clone());
                if end == 0 {
                    feet.insert((place, k), own.id.clone());
                } else {
                    own.carry_over = feet.remove(&(place, k)).map(|foot| part.carry_over(foot));
                }
                list.push((joint, own));
            }
        }
    }
    list
}

/// What a spring at an end of a wall leads to.
#[derive(Clone, Copy, PartialEq)]
struct Beyond {
    /// A body, or the ground.
    body: Option<usize>,
    /// The wall that is there.
    wall: Option<usize>,
}

/// Nothing if there is no spring.
type Neighbour = Option<Beyond>;

/// What a wall meets beyond a place at its foot (`end` 0) or head \[m\] that is of the body `own`.
fn neighbour(
    building: &Building,
    structure: &Structure,
    bodies: &Bodies,
    (wall, own): (usize, usize),
    (end, at): (usize, [f64; 3]),
) -> Neighbour {
    let outside = [at[0], at[1], at[2] + if end == 0 { -JUST_BEYOND_M } else { JUST_BEYOND_M }];
    let next = structure.partition.member_at(outside);
    let other = next.and_then(|member| bodies.of(member, outside));
    let is_joined = other.is_some() || stands(building, wall, (2, at), next);
    let wall = next.filter(|member| building.members[*member].kind == MemberKind::Wall);
    (is_joined && other != Some(own)).then_some(Beyond { body: other, wall })
}

/// The cells of a wall that meet something at its foot (`end` 0) or head: its contact face there.
fn face(building: &Building, structure: &Structure, bodies: &Bodies, whole: &Half, end: usize) -> Vec<Aabb> {
    let level = |b: &Aabb| if end == 0 { b.min[2] } else { b.max[2] };
    let level_m = level(&whole.solid);
    let meets = |b: &Aabb| {
        let [x, y, _] = b.center();
        let (wall, at) = (whole.wall, [x, y, level_m]);
        let beyond = |own| neighbour(building, structure, bodies, (wall, own), (end, at));
        bodies.of(wall, at).is_some_and(|own| beyond(own).is_some())
    };
    let is_in_it = |b: &Aabb| (level(b) - level_m).abs() < COORDINATE_TOLERANCE_M && meets(b);
    structure.boxes(whole.wall).iter().copied().filter(is_in_it).collect()
}

/// A half of a wall in the parts that stand between the same bodies, found beside its spring at base and top: one, unless that is on a seam of a floor.
fn parts<'a>(
    building: &Building,
    structure: &Structure,
    bodies: &Bodies,
    half: &Half<'a>,
    side: usize,
) -> Vec<(Half<'a>, [Neighbour; 2])> {
    let mut parts: Vec<(Half, [Neighbour; 2])> = Vec::new();
    for beside in [[-BESIDE_M; 2], [-BESIDE_M, BESIDE_M], [BESIDE_M, -BESIDE_M], [BESIDE_M; 2]] {
        let neighbours = [0, 1].map(|end| {
            let mut at = half.point_m(side, end);
            let own = bodies.of(half.wall, at).filter(|_| half.ends[end])?;
            (0..2).for_each(|i| at[i] += beside[i]);
            neighbour(building, structure, bodies, (half.wall, own), (end, at))
        });
        match parts.iter_mut().find(|part| part.1 == neighbours) {
            Some((part, _)) => part.share += 0.25,
            None => parts.push((Half { share: 0.25, ..*half }, neighbours)),
        }
    }
    parts
}

fn spring(
    building: &Building,
    bodies: &Bodies,
    half: &Half,
    other: Option<usize>,
    (id, point_m): (String, [f64; 3]),
) -> Bushing {
    let Half { wall, law, along, length_m, thickness_m, .. } = *half;
    let (area, reach_m) = (half.own_m() * thickness_m, half.reach_m());
    let shear = 5.0 / 6.0 * area * law.shear_modulus_pa() / reach_m;
    let member = &building.members[wall].id;
    let out_of_plane = Bending::Curve { curve: half.curve_id(building), strength_factor: 1.0 };
    let in_plane = Bending::Elastic {
        stiffness_nm_rad: law.youngs_modulus_pa * area * length_m.powi(2) / 12.0 / reach_m,
    };
    let torsion = law.shear_modulus_pa() * half.own_m() * thickness_m.powi(3) / 3.0 / reach_m;
    let (squash_n, elongation_m) = (half.squash_n(), law.critical_plastic_strain * half.mesh_m);
    let slips = slip(Some(squash_n), Some(elongation_m));
    let name = |i: usize| bodies.list[i].id.clone();
    let own = bodies.of(wall, point_m).map(name).unwrap_or_default();
    Bushing {
        axial_stiffness_n_m: law.youngs_modulus_pa * area / reach_m,
        shear_stiffness_n_m: [shear; 2],
        torsional_stiffness_nm_rad: torsion,
        // axes 1 and 2 are x and y: bending about x is out of the plane of a wall along x
        bending: if along == 0 { [out_of_plane, in_plane] } else { [in_plane, out_of_plane] },
        tensile_capacity_n: Some(squash_n),
        tensile_elongation_m: Some(elongation_m),
        shear_capacity_n: slips.map(|u| u.0),
        shear_slip_m: slips.map(|u| u.1),
        compressive_capacity_n: Some(squash_n),
        associated_flow: true,
        origin: Origin {
            members: vec![member.clone()],
            rules: bodies.list.iter().find(|b| b.id == own).map_or(Vec::new(), |b| b.origin.rules.clone()),
            entries: Vec::new(),
        },
        ..Bushing::free(id, other.map(name), own.clone(), point_m, axes(2, 1.0))
    }
}
