//! Vertical edges of walls: walls that share a face beside each other are joined there.
//!
//! Two springs on each face, at a quarter and at three quarters of its height, stand for half of it each. Between the middles of both walls, `L` apart, they are as stiff as the wall is there, `E A / L` along
//! the normal and `G A_s / L` across, and they bear what the weaker of both laws bears: the squash load `f A` either way, slip in shear as foot and head do ([`slip`]). Moments about a horizontal axis go as couples of
//! the two, and none about the edge itself, where a wall is thin. Out of its plane a wall that ends at the face of another one is a plate that bends from there to its middle: `3 E I / L³`, up to `f h t² / 4 L` of its thickness `t` and the height `h`.
//!
//! Walls and columns beside them are not joined: both turn about their feet together, at heights that are not one in the model, and what holds them together holds up what falls across the wall
//! (docs/decisions/columns-and-walls.md).

use super::bodies::Bodies;
use super::joints::{Place, axes};
use super::sections::slip;
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::building::{Building, Homogenised, MemberKind};
use crate::graph::Structure;
use crate::mbs::model::{Bushing, Origin};

/// Where on the height of a face its springs stand.
const AT: [f64; 2] = [0.25, 0.75];

/// The springs at all vertical edges between bodies.
pub fn springs(&Place { building, bodies, .. }: &Place<'_>, structure: &Structure) -> Vec<Bushing> {
    let is_wall = |m: &usize| building.members[*m].kind == MemberKind::Wall;
    let solid = |m: usize| Some((m, structure.boxes(m).iter().copied().reduce(Aabb::around)?));
    let solids: Vec<(usize, Aabb)> = (0..building.members.len()).filter(is_wall).filter_map(solid).collect();
    let near = Boxes::of(solids.iter().map(|(_, s)| *s));
    let mut springs = Vec::new();
    for (i, (a, one)) in solids.iter().enumerate() {
        for j in near.near(one, COORDINATE_TOLERANCE_M).into_iter().filter(|j| *j > i) {
            let (b, other) = solids[j];
            if let Some(edge) = Edge::between(one, &other) {
                springs.extend(edge.springs(building, bodies, [*a, b]));
            }
        }
    }
    springs
}

/// A vertical face that two solids share.
struct Edge {
    /// Axis of its normal.
    normal: usize,
    /// From the first to the second solid: 1 along the axis, -1 against it.
    sense: f64,
    /// The face: flat along the normal \[m\].
    face: Aabb,
    /// From the middle of the one to that of the other along the normal \[m\].
    apart_m: f64,
}

impl Edge {
    fn between(one: &Aabb, other: &Aabb) -> Option<Self> {
        let overlap = |i: usize| [one.min[i].max(other.min[i]), one.max[i].min(other.max[i])];
        let is_common = |i: usize| overlap(i)[1] - overlap(i)[0] > COORDINATE_TOLERANCE_M;
        let touches = |i: &usize| {
            let [low, high] = overlap(*i);
            (high - low).abs() < COORDINATE_TOLERANCE_M
        };
        let normal = [0, 1].into_iter().find(touches)?;
        if !is_common(1 - normal) || !is_common(2) {
            return None;
        }
        let [min, max] = [0, 1].map(|side| [0, 1, 2].map(|i| overlap(i)[side]));
        let way = other.center()[normal] - one.center()[normal];
        Some(Self { normal, sense: way.signum(), face: Aabb { min, max }, apart_m: way.abs() })
    }

    /// Stiffness \[N/m\] and capacity \[N\] of a spring level with the ground across the normal, if along the edge it has these.
    fn level(
        &self,
        building: &Building,
        members: [usize; 2],
        along: [f64; 2],
        (law, flow_pa): (&Homogenised, f64),
    ) -> [f64; 2] {
        let size = |m: usize| building.members[m].solid.size();
        let ends_here = |m: &usize| size(*m)[self.normal] > size(*m)[1 - self.normal];
        let mut ending = members.into_iter().filter(ends_here);
        let (Some(one), None) = (ending.next(), ending.next()) else { return along };
        let (thick_m, height_m) = (size(one)[1 - self.normal], 0.5 * self.face.size()[2]);
        let stiffness = 0.25 * law.youngs_modulus_pa * height_m * (thick_m / self.apart_m).powi(3);
        let bears = flow_pa * 0.25 * height_m * thick_m * thick_m / self.apart_m;
        [along[0].min(stiffness), along[1].min(bears)]
    }

    fn springs(&self, building: &Building, bodies: &Bodies, members: [usize; 2]) -> Vec<Bushing> {
        let laws = members.map(|m| building.law_of(&building.members[m]));
        let flows_pa = [0, 1].map(|i| {
            let first = laws[i].hardening.first().map_or(0.0, |p| p.stress_pa);
            building.strength_factor(&building.members[members[i]].id) * first
        });
        let weaker = usize::from(flows_pa[1] < flows_pa[0]);
        let (law, size) = (laws[weaker], self.face.size());
        let area_m2 = 0.5 * size[1 - self.normal] * size[2];
        let squash_n = flows_pa[weaker] * area_m2;
        let elongation_m = law.critical_plastic_strain * building.settings.mesh_size_m.min(self.apart_m);
        let slips = slip(Some(squash_n), Some(elongation_m));
        let shear_n_m = 5.0 / 6.0 * law.shear_modulus_pa() * area_m2 / self.apart_m;
        let capacity_n = slips.map_or(0.0, |(capacity, _)| capacity[0]);
        // the vertical one of the springs across is the second with a normal along x, the first with one along y
        let order = |[vertical, level]: [f64; 2]| {
            if self.normal == 0 { [level, vertical] } else { [vertical, level] }
        };
        let level = self.level(building, members, [shear_n_m, capacity_n], (law, flows_pa[weaker]));
        let [one, other] = members.map(|m| building.members[m].id.as_str());
        let mut list = Vec::new();
        for (k, at) in AT.into_iter().enumerate() {
            let mut point_m = self.face.center();
            point_m[2] = self.face.min[2] + at * size[2];
            let [Some(a), Some(b)] = members.map(|m| bodies.of(m, point_m)) else { continue };
            if a == b {
                continue;
            }
            let [from, to] = [a, b].map(|i| &bodies.list[i]);
            let mut rules: Vec<String> =
                [from, to].iter().flat_map(|body| body.origin.rules.clone()).collect();
            rules.sort_unstable();
            rules.dedup();
            list.push(Bushing {
                axial_stiffness_n_m: law.youngs_modulus_pa * area_m2 / self.apart_m,
                shear_stiffness_n_m: order([shear_n_m, level[0]]),
                tensile_capacity_n: Some(squash_n),
                tensile_elongation_m: Some(elongation_m),
                shear_capacity_n: Some(order([capacity_n, level[1]])),
                shear_slip_m: slips.map(|u| u.1),
                compressive_capacity_n: Some(squash_n),
                associated_flow: true,
                origin: Origin { members: vec![one.into(), other.into()], rules, entries: Vec::new() },
                ..Bushing::free(
                    format!("{one}/{other}.edge-{}", k + 1),
                    Some(from.id.clone()),
                    to.id.clone(),
                    point_m,
                    axes(self.normal, self.sense),
                )
            });
        }
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_a_vertical_face_and_no_line() {
        let solid = |min, max| Aabb { min, max };
        let wall = solid([0.0, 0.0, 0.0], [4.0, 0.2, 3.0]);
        let beside = solid([3.8, 0.2, 0.5], [4.0, 5.0, 2.5]);
        let edge = Edge::between(&wall, &beside).unwrap();
        assert_eq!((edge.normal, edge.sense), (1, 1.0));
        assert_eq!((edge.face.min, edge.face.max), ([3.8, 0.2, 0.5], [4.0, 0.2, 2.5]));
        assert!((edge.apart_m - 2.5).abs() < 1e-12);
        assert_eq!(Edge::between(&beside, &wall).unwrap().sense, -1.0);
        // one that stands on it, one that touches it along a line, one 1 mm away
        assert!(Edge::between(&wall, &solid([0.0, 0.0, 3.0], [4.0, 0.2, 6.0])).is_none());
        assert!(Edge::between(&wall, &solid([4.0, 0.2, 0.0], [4.2, 5.0, 3.0])).is_none());
        assert!(Edge::between(&wall, &solid([0.0, 0.201, 0.0], [4.0, 0.4, 3.0])).is_none());
    }
}
