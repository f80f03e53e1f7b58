//! Beams that meet columns between their ends: tie, landing and crane beams.
//!
//! The multibody model joins members at the ends of columns, as floors are. A column that goes on above and below a beam is one body without a joint there, and
//! the beam would hang on nothing; the FE model joins the two.

use super::connect::touch;
use super::model::{Building, MemberKind};
use super::partition::{COORDINATE_TOLERANCE_M, Partition};
use super::tracked::clear_range;
use crate::base::boxes::Boxes;
use crate::base::units::round_to_digits;

/// A beam that meets a column between its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Between {
    /// Index of the beam.
    pub beam: usize,
    /// Index of the column.
    pub column: usize,
    /// Id of the beam.
    pub beam_id: String,
    /// Id of the column.
    pub column_id: String,
    /// On the axis of the column, at the top of the beam \[m\].
    pub at_m: [f64; 3],
}

impl Between {
    /// All of a building, in file order of the beams. Members that are turned or cut away in preparation are left out.
    pub fn all(building: &Building, partition: &Partition) -> Vec<Self> {
        let members = &building.members;
        let of_kind = |kind| {
            let there = members.iter().enumerate().filter(move |(_, m)| m.kind == kind && !m.is_skew());
            there.filter(|(_, m)| !building.is_cut(&m.id))
        };
        let columns = Boxes::numbered(of_kind(MemberKind::Column).map(|(i, m)| (i, m.solid)));
        let mut found = Vec::new();
        for (index, beam) in of_kind(MemberKind::Beam) {
            let [low, high] = [beam.solid.min[2], beam.solid.max[2]];
            for column in columns.near(&beam.solid, 2.0 * COORDINATE_TOLERANCE_M) {
                let goes_on = clear_range(partition, column, 2).is_some_and(|own| {
                    own[0] < low - COORDINATE_TOLERANCE_M && own[1] > high + COORDINATE_TOLERANCE_M
                });
                if !goes_on || !touch(beam, &members[column]) {
                    continue;
                }
                let [x, y, _] = members[column].solid.center();
                found.push(Self {
                    beam: index,
                    column,
                    beam_id: beam.id.clone(),
                    column_id: members[column].id.clone(),
                    at_m: [x, y, high].map(|c| round_to_digits(c, 9)),
                });
            }
        }
        found
    }

    /// What is wrong, as a sentence without its full stop.
    pub fn problem(&self) -> String {
        let [x, y, z] = self.at_m;
        let (beam, column) = (&self.beam_id, &self.column_id);
        format!("the beam `{beam}` meets the column `{column}` between its ends, at ({x}, {y}, {z}) m")
    }

    /// What to do about it.
    pub fn remedy(&self) -> String {
        let (beam, column, z) = (&self.beam_id, &self.column_id, self.at_m[2]);
        format!(
            "split `{column}` at z = {z} m (two members, one above the other), and let `{beam}` run to its axis or through it: the multibody model joins members at the ends of columns"
        )
    }
}
