//! The capacities that joints use, each compiled once in a run, however often bodies part.

use crate::curve::{CapacityTable, CurveError, ResistanceCurve};
use std::collections::BTreeMap;
use std::ops::Deref;

/// Compiled curves, in the order in which they came to be used; joints know their places.
#[derive(Debug, Clone, Default)]
pub struct Tables {
    all: Vec<CapacityTable>,
    /// Place of each curve with its strength factor (bits).
    places: BTreeMap<(String, u64), u32>,
}

impl Tables {
    /// Place of a curve with a strength factor.
    ///
    /// # Errors
    /// If the curve cannot be compiled.
    pub fn place(
        &mut self,
        curves: &BTreeMap<String, ResistanceCurve>,
        name: &str,
        strength_factor: f64,
    ) -> Result<u32, CurveError> {
        let key = (name.to_string(), strength_factor.to_bits());
        if let Some(place) = self.places.get(&key) {
            return Ok(*place);
        }
        let place = self.all.len() as u32;
        self.all.push(CapacityTable::new(&curves[name], strength_factor)?);
        self.places.insert(key, place);
        Ok(place)
    }
}

impl Deref for Tables {
    type Target = [CapacityTable];

    fn deref(&self) -> &[CapacityTable] {
        &self.all
    }
}
