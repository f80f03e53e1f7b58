//! Constants of a block as they lie in memory. Elements of a block mostly share all but their mass; then four numbers
//! stand for four lanes, which a large mesh would otherwise read from memory in every step.

use super::kernel::{BlockMaterial, LANES, Lane};
use super::law::ElementForm;
use serde::{Deserialize, Serialize};

/// Material of a block.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PackedMaterial {
    /// Mass of each element \[kg\].
    pub mass_kg: Lane,
    lambda_pa: f64,
    mu_pa: f64,
    yield_scale: f64,
    critical_strain: f64,
    /// Index of the hardening table.
    pub table: usize,
    /// How the elements are integrated.
    pub form: ElementForm,
    /// The full constants, if the elements differ in more than mass.
    varied: Option<Box<BlockMaterial>>,
}

impl PackedMaterial {
    /// Packs constants.
    pub fn new(lanes: &BlockMaterial) -> Self {
        let same = |values: &Lane| values.iter().all(|v| *v == values[0]);
        let shared = same(&lanes.lambda_pa)
            && same(&lanes.mu_pa)
            && same(&lanes.yield_scale)
            && same(&lanes.critical_strain);
        Self {
            mass_kg: lanes.mass_kg,
            lambda_pa: lanes.lambda_pa[0],
            mu_pa: lanes.mu_pa[0],
            yield_scale: lanes.yield_scale[0],
            critical_strain: lanes.critical_strain[0],
            table: lanes.table,
            form: lanes.form,
            varied: (!shared).then(|| Box::new(*lanes)),
        }
    }

    /// The constants by lane.
    #[inline(always)]
    pub fn lanes(&self) -> BlockMaterial {
        if let Some(lanes) = &self.varied {
            return **lanes;
        }
        BlockMaterial {
            lambda_pa: [self.lambda_pa; LANES],
            mu_pa: [self.mu_pa; LANES],
            yield_scale: [self.yield_scale; LANES],
            mass_kg: self.mass_kg,
            critical_strain: [self.critical_strain; LANES],
            table: self.table,
            form: self.form,
        }
    }

    /// Changes the constants of single elements.
    pub fn edit(&mut self, change: impl FnOnce(&mut BlockMaterial)) {
        let mut lanes = self.lanes();
        change(&mut lanes);
        *self = Self::new(&lanes);
    }
}
