//! Walls with openings that reach their foot or head, cut into strips.
//!
//! A door leaves a wall piers to stand on. Cut where the faces of its foot and head begin and end, a wall is a row of strips: a pier has a foot and a head, a lintel over a door a head alone, a parapet under an opening a foot alone.
//! Each strip has springs of its own ([`super::walls`]), so that those at an end have the area and the second moments of the face there, and those at foot and head of a pier belong to one beam.

use crate::base::geom::Aabb;
use crate::building::partition::COORDINATE_TOLERANCE_M;

/// A length of a wall over which its foot is there throughout or not at all, and so is its head.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strip {
    /// From where to where along the wall \[m\].
    pub along_m: [f64; 2],
    /// Whether it has a foot, and a head.
    pub ends: [bool; 2],
}

/// Whether one of the openings of a wall reaches foot or head of the box around it.
pub fn reach_an_end(openings: &[Aabb], solid: &Aabb) -> bool {
    let reaches = |o: &Aabb| {
        o.min[2] < solid.min[2] + COORDINATE_TOLERANCE_M || o.max[2] > solid.max[2] - COORDINATE_TOLERANCE_M
    };
    openings.iter().any(reaches)
}

/// The strips of a wall by the faces of its foot and head, each in boxes, from low to high coordinates along it.
pub fn strips(faces: &[Vec<Aabb>; 2], along: usize) -> Vec<Strip> {
    let mut edges: Vec<f64> = faces.iter().flatten().flat_map(|b| [b.min[along], b.max[along]]).collect();
    edges.sort_by(f64::total_cmp);
    edges.dedup_by(|later, earlier| *later - *earlier < COORDINATE_TOLERANCE_M);
    let mut list: Vec<Strip> = Vec::new();
    for edge in edges.windows(2) {
        let middle_m = 0.5 * (edge[0] + edge[1]);
        let is_there = |b: &Aabb| b.min[along] < middle_m && middle_m < b.max[along];
        let ends = [0, 1].map(|end| faces[end].iter().any(is_there));
        match list.last_mut() {
            Some(last) if last.ends == ends => last.along_m[1] = edge[1],
            _ => list.push(Strip { along_m: [edge[0], edge[1]], ends }),
        }
    }
    list.retain(|strip| strip.ends.contains(&true));
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxed(along_m: [f64; 2], level_m: [f64; 2]) -> Aabb {
        Aabb { min: [4.9, along_m[0], level_m[0]], max: [5.1, along_m[1], level_m[1]] }
    }

    #[test]
    fn a_wall_is_cut_where_its_faces_begin_and_end() {
        // a door from 1 to 2 m, an opening at the head from 3 to 4 m, and one of the full height from 5 to 6 m; planes of other members cut the cells at 2.5 m and across the wall
        let foot = [[0.0, 1.0], [2.0, 2.5], [2.5, 3.0], [3.0, 4.0], [4.0, 5.0], [6.0, 7.0]];
        let head = [[0.0, 1.0], [1.0, 2.0], [2.0, 2.5], [2.5, 3.0], [4.0, 5.0], [4.0, 5.0], [6.0, 7.0]];
        let faces = [
            foot.iter().map(|a| boxed(*a, [0.0, 1.0])).collect(),
            head.iter().map(|a| boxed(*a, [2.0, 3.0])).collect(),
        ];
        let strip = |from: f64, to: f64, ends: [bool; 2]| Strip { along_m: [from, to], ends };
        let expected = [
            strip(0.0, 1.0, [true, true]),
            strip(1.0, 2.0, [false, true]),
            strip(2.0, 3.0, [true, true]),
            strip(3.0, 4.0, [true, false]),
            strip(4.0, 5.0, [true, true]),
            strip(6.0, 7.0, [true, true]),
        ];
        assert_eq!(strips(&faces, 1), expected);
        assert!(strips(&[Vec::new(), Vec::new()], 1).is_empty());
    }

    #[test]
    fn windows_reach_neither_foot_nor_head() {
        let solid = boxed([0.0, 7.0], [0.0, 3.0]);
        let reaches = |low: f64, high: f64| reach_an_end(&[boxed([1.0, 2.0], [low, high])], &solid);
        assert!(!reach_an_end(&[], &solid) && !reaches(0.9, 2.1));
        assert!(reaches(0.0, 2.1) && reaches(0.9, 3.0) && reaches(0.9, 3.5));
    }
}
