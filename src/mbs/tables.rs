//! The capacities that joints use, each compiled once in a run, however often bodies part.

use super::model::{Bending, Model};
use crate::curve::{CapacityTable, CurveError, ResistanceCurve};
use std::collections::BTreeMap;
use std::ops::Deref;
use std::sync::Arc;

/// Compiled curves, in the order in which they came to be used; joints know their places. Copies share what they have in common.
#[derive(Debug, Clone, Default)]
pub struct Tables {
    all: Arc<Vec<CapacityTable>>,
    /// Place of each curve with its strength factor (bits).
    places: Arc<BTreeMap<(String, u64), u32>>,
}

impl Tables {
    /// All that the bushings of a model use.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn of(model: &Model) -> Result<Self, CurveError> {
        let mut tables = Self::default();
        for bending in model.bushings.iter().flat_map(|b| &b.bending) {
            if let Bending::Curve { curve, strength_factor } = bending {
                tables.place(&model.curves, curve, *strength_factor)?;
            }
        }
        Ok(tables)
    }

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
        let table = CapacityTable::new(&curves[name], strength_factor)?;
        Arc::make_mut(&mut self.all).push(table);
        Arc::make_mut(&mut self.places).insert(key, place);
        Ok(place)
    }
}

impl Deref for Tables {
    type Target = [CapacityTable];

    fn deref(&self) -> &[CapacityTable] {
        &self.all
    }
}
