//! Entries of column ends scaled by the laws of similarity, where the library has none for exactly an end.
//!
//! Two columns of homogenised laws whose hardening tables have the same form, depth `h` across the axis of bending and width `b` along it, yield stress `f` (times the strength factor of preparation), length `l` to the point of inflection:
//!
//! | quantity | scales with |
//! |---|---|
//! | moment | `f b h²` |
//! | axial force | `f b h` |
//! | elastic rotational stiffness | `E b h³ / l` |
//! | plastic rotation | `ε_c s / h`: the critical strain over a zone one element `s` long, across the depth |
//! | axial stiffness, shear stiffness | `E b h / l` |
//! | torsional stiffness | `E b h³ / l` with the smaller side as `h` |
//!
//! So a rectangular section has factors of its own about either axis. Lengths (place of the hinge, elongations) scale with the mean of both sides. Rotational and axial stiffness depend on the joint as well: they are computed for the end itself ([`elastic`]), so that the table's serve only where that
//! fails. Measured by leaving out one of 26 derived entries in turn: moments within 9 % (half of them within 1 %), rotations at fracture within 30 % in four of five levels, ends at walls and at slabs that give way first left aside; scaled stiffnesses would be off by factors
//! of 0.6 to 1.7 (docs/library.md).

use super::derive::{DeriveError, Wanted};
use super::derive_contact::WantedContact;
use super::entry::{
    Adjoining, AxisRecord, Branch, ColumnEnd, Computed, Entry, EntryKind, Features, Inputs, Origin,
    SpringRecord, Stiffness, Validity,
};
use super::interpolate;
use super::layered::layered;
use super::store::Indexed;
use super::{Store, StoreError};
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::rc::elastic::elastic;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Farthest entry that is scaled: the logarithm of the ratio of depths, and half of those of slenderness and of strength.
pub const FARTHEST: f64 = 1.0;
/// Range of the peak moment without axial force over `f b h²` of a whole section (0.42 for two elements across the depth): one outside is of a column that other members partly own.
const WHOLE: [f64; 2] = [0.25, 0.75];

/// Logarithm of a ratio of sides or stiffnesses below which they count as equal: meshes make half of it, beams at one side of a column 0.07 to 0.7.
const ALIKE: f64 = 0.02;

/// What similarity needs to know of an end.
#[derive(Debug, Clone, Copy)]
struct Size {
    width_m: f64,
    depth_m: f64,
    length_m: f64,
    strength_pa: f64,
    modulus_pa: f64,
    strain: f64,
    mesh_m: f64,
}

/// Factors from one end to another about an axis.
#[derive(Debug, Clone, Copy)]
struct Bent {
    moment: f64,
    stiffness: f64,
    rotation: f64,
}

/// Factors from one end to another.
#[derive(Debug, Clone, Copy)]
struct Factors {
    about: [Bent; 2],
    force: f64,
    torsion: f64,
    spring: f64,
    length: f64,
}

/// An entry made for an end without a run.
#[derive(Debug, Clone)]
pub struct Similar {
    /// The entry.
    pub entry: Entry,
    /// In words, where its curves are from.
    pub words: String,
    /// How far that is: logarithms of the ratios of depths, of slenderness and of strength, the latter halved, together; farther than any of these where it is not from another entry.
    pub distance: f64,
}

/// The entries that may be scaled. Only those are read that are nearest to something asked for.
#[derive(Debug, Default)]
pub struct Candidates {
    list: Vec<Candidate>,
    /// Entries read so far; none for those that are not of the whole section.
    read: RefCell<BTreeMap<String, Option<Entry>>>,
}

/// An entry that may be scaled.
#[derive(Debug)]
struct Candidate {
    key: String,
    size: Size,
    /// Which end of a column, and what adjoins it.
    place: Place,
}

type Place = (Option<ColumnEnd>, Option<Adjoining>);

impl Candidates {
    /// Those of a kind in a library.
    pub fn of(store: &Store, kind: EntryKind) -> Self {
        let submodel = |e: &Indexed| e.kind == kind && e.origin == Origin::Submodel && !e.deprecated;
        let candidate = |(key, e): (&String, &Indexed)| {
            let place = (e.features.end, e.features.adjoining);
            Size::of(&e.features).map(|size| Candidate { key: key.clone(), size, place })
        };
        let list = store.index.iter().filter(|(_, e)| submodel(e)).filter_map(candidate).collect();
        Self { list, read: RefCell::default() }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// An entry of the library, if it is of a whole section.
    fn read(&self, store: &Store, candidate: &Candidate) -> Result<Option<Entry>, StoreError> {
        if let Some(known) = self.read.borrow().get(&candidate.key) {
            return Ok(known.clone());
        }
        let entry = Some(store.get(&candidate.key)?).filter(|entry| candidate.size.is_whole(entry));
        self.read.borrow_mut().insert(candidate.key.clone(), entry.clone());
        Ok(entry)
    }

    /// The nearest entry scaled to a column end; the one of its section ([`layered`]) if there is none near enough for the same kind of end, `None` if there is none of that either.
    ///
    /// # Errors
    /// If an entry cannot be read, or it cannot be written as JSON.
    pub fn scaled(&self, store: &Store, wanted: &Wanted) -> Result<Option<Similar>, DeriveError> {
        let Some(size) = Size::of(&wanted.features) else { return Ok(None) };
        let place = (wanted.features.end, wanted.features.adjoining);
        let of_place = self.list.iter().filter(|c| c.place == place);
        let mut near: Vec<(f64, &Candidate)> =
            of_place.map(|c| (c.size.distance(&size), c)).filter(|(d, _)| *d <= FARTHEST).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.key.cmp(&b.1.key)));
        for (distance, candidate) in near {
            if let Some(entry) = self.read(store, candidate)? {
                return Ok(Some(Similar::of(wanted, [candidate.size, size], &entry, distance)?));
            }
        }
        let words =
            "of its section, layer of elements by layer: no entry is similar enough to be scaled".to_string();
        Ok(layered(wanted)?.map(|entry| Similar { entry, words, distance: 2.0 * FARTHEST }))
    }
}

impl Candidates {
    /// The nearest entry of an end that is crushed, scaled: forces with `f b h`, shortenings with the length. `None` if there is none.
    ///
    /// # Errors
    /// If the entry cannot be read, or it cannot be written as JSON.
    pub fn crushing(&self, store: &Store, wanted: &WantedContact) -> Result<Option<Similar>, DeriveError> {
        let Some(size) = Size::of(&wanted.features) else { return Ok(None) };
        let near = self.list.iter().map(|c| (c.size.distance(&size), c));
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.key.cmp(&b.1.key)));
        let Some((distance, candidate)) = nearest else { return Ok(None) };
        let Some(entry) = self.read(store, candidate)? else { return Ok(None) };
        let force = candidate.size.to(&size).force;
        let length = size.length_m / candidate.size.length_m;
        let scaled = |record: &SpringRecord| {
            let mut record = record.clone();
            record.stiffness_n_m *= force / length;
            for level in &mut record.levels {
                level.points.iter_mut().for_each(|p| *p = [length * p[0], force * p[1]]);
                level.dissipated_j = level.dissipated_j.map(|work| force * length * work);
            }
            record
        };
        let mut inputs = wanted.inputs.clone();
        inputs.settings.insert("scaled_from".into(), entry.key.clone().into());
        let reach = entry.validity.displacement_m.map(|range| range.map(|s| length * s));
        let computed = Computed {
            springs: entry.springs.iter().map(scaled).collect(),
            compressive_capacity_n: entry.compressive_capacity_n.map(|n| force * n),
            quality: entry.quality.clone(),
            validity: Validity { displacement_m: reach, ..entry.validity },
            ..Computed::default()
        };
        let words = format!("scaled from {} (force {force:.2}, length {length:.2} of its own)", entry.key);
        let entry = Entry::unthinned(entry.kind, entry.origin, wanted.features.clone(), inputs, computed)?;
        Ok(Some(Similar { entry, words, distance }))
    }
}

impl Similar {
    /// An entry of one size scaled to what is wanted, of another.
    fn of(
        wanted: &Wanted,
        [own, size]: [Size; 2],
        entry: &Entry,
        distance: f64,
    ) -> Result<Self, serde_json::Error> {
        let mut inputs: Inputs = wanted.inputs.clone();
        inputs.settings.insert("scaled_from".into(), entry.key.clone().into());
        // what is elastic costs little to compute for the end itself
        let offset_m = own.to(&size).length * entry.hinge_offset_m.unwrap_or_default();
        let elastic = elastic(&wanted.model, offset_m).ok();
        let mut computed = about_own_axes(entry, [own, size], elastic.as_ref().map(|e| e.bending_nm_rad));
        if let Some(own) = elastic {
            for (axis, stiffness) in computed.axes.iter_mut().zip(own.bending_nm_rad) {
                axis.curve.stiffness_nm_rad = stiffness;
            }
            computed.stiffness = computed.stiffness.map(|s| Stiffness { axial_n_m: own.axial_n_m, ..s });
        }
        let scaled = Entry::unthinned(entry.kind, entry.origin, wanted.features.clone(), inputs, computed)?;
        let [depth, strength] = [size.depth_m / own.depth_m, size.strength_pa / own.strength_pa];
        let width = size.width_m / own.width_m;
        let sides = if (width - depth).abs() < 1e-6 {
            format!("depth {depth:.2}")
        } else {
            format!("depth {depth:.2}, width {width:.2}")
        };
        let slenderness = (size.length_m / size.depth_m) / (own.length_m / own.depth_m);
        let words = format!(
            "scaled from {} ({sides}, strength {strength:.2}, slenderness {slenderness:.2} of its own)",
            entry.key
        );
        Ok(Self { entry: scaled, words, distance })
    }
}

/// An entry scaled to an end with the elastic stiffnesses given, about its axes.
///
/// Where the column of the entry is square, its axes differ by what adjoins it (beams, an edge of the floor), which lies as it does in its own building. So
/// the axis that is as stiff beside the other one as that of the end, whose stiffness is known, serves it, and an end as stiff about both has the mean of
/// both: a building turned by a right angle has the same curves.
fn about_own_axes(entry: &Entry, [own, size]: [Size; 2], stiffness_nm_rad: Option<[f64; 2]>) -> Computed {
    let along = own.to(&size).applied(entry);
    let square = (own.width_m / own.depth_m - 1.0).abs() < ALIKE;
    let (Some(wanted), true, 2) = (stiffness_nm_rad, square, entry.axes.len()) else { return along };
    let turned = Entry { axes: entry.axes.iter().rev().cloned().collect(), ..entry.clone() };
    let across = own.to(&size).applied(&turned);
    let [first, second] = [&along, &across].map(|scaled| {
        let [a, b] = [0, 1].map(|axis: usize| scaled.axes[axis].curve.stiffness_nm_rad / wanted[axis]);
        libm::log(a / b).abs()
    });
    if (first - second).abs() > ALIKE {
        return if first < second { along } else { across };
    }
    let mean: Option<Vec<AxisRecord>> =
        along.axes.iter().zip(&across.axes).map(|(a, b)| interpolate::axis(a, b, 0.5)).collect();
    Computed { axes: mean.unwrap_or_else(|| along.axes.clone()), ..along }
}

impl Size {
    fn of(features: &Features) -> Option<Self> {
        let law = features.law.as_ref()?;
        let factor = features.further.get("strength_factor").copied().unwrap_or(1.0);
        Some(Self {
            width_m: features.width_m,
            depth_m: features.depth_m,
            length_m: features.length_to_inflection_m?,
            strength_pa: factor * law.yield_stress_pa,
            modulus_pa: law.youngs_modulus_pa,
            strain: law.critical_plastic_strain,
            mesh_m: features.mesh_size_m?,
        })
    }

    /// Whether an entry is of the whole section.
    fn is_whole(&self, entry: &Entry) -> bool {
        entry.axes.iter().enumerate().all(|(k, axis)| {
            let plastic = self.about(k).moment_nm();
            axis.curve
                .free_level()
                .is_some_and(|level| (WHOLE[0]..WHOLE[1]).contains(&(level.peak_nm() / plastic)))
        })
    }

    /// With the side across a bending axis as its depth: that of the first one is across the first.
    fn about(self, axis: usize) -> Self {
        if axis == 0 { self } else { Self { width_m: self.depth_m, depth_m: self.width_m, ..self } }
    }

    /// What moments scale with \[N m\].
    fn moment_nm(&self) -> f64 {
        self.strength_pa * self.width_m * self.depth_m.powi(2)
    }

    /// In the mean of both axes, so that a building turned by a right angle has the same entries.
    fn distance(&self, other: &Self) -> f64 {
        0.5 * [0, 1].map(|axis| self.about(axis).distance_across(&other.about(axis))).iter().sum::<f64>()
    }

    fn distance_across(&self, other: &Self) -> f64 {
        let ratio = |a: f64, b: f64| libm::log(a / b).abs();
        ratio(self.depth_m, other.depth_m)
            + ratio(self.width_m / self.depth_m, other.width_m / other.depth_m)
            + 0.5 * ratio(self.length_m / self.depth_m, other.length_m / other.depth_m)
            + 0.5 * ratio(self.strength_pa, other.strength_pa)
    }

    fn to(self, other: &Self) -> Factors {
        let of = |f: &dyn Fn(&Self) -> f64| f(other) / f(&self);
        let spring = of(&|s| s.modulus_pa * s.width_m * s.depth_m / s.length_m);
        let smaller = |s: &Self| s.width_m.min(s.depth_m);
        Factors {
            about: [0, 1].map(|axis| self.about(axis).bent(&other.about(axis))),
            force: of(&|s| s.strength_pa * s.width_m * s.depth_m),
            torsion: spring * of(&|s| smaller(s).powi(2)),
            spring,
            length: of(&|s| s.width_m + s.depth_m),
        }
    }

    /// About the axis that its depth is across.
    fn bent(&self, other: &Self) -> Bent {
        let of = |f: &dyn Fn(&Self) -> f64| f(other) / f(self);
        Bent {
            moment: of(&Self::moment_nm),
            stiffness: of(&|s| s.modulus_pa * s.width_m * s.depth_m.powi(3) / s.length_m),
            rotation: of(&|s| s.strain * s.mesh_m / s.depth_m),
        }
    }
}

impl Factors {
    fn applied(&self, entry: &Entry) -> Computed {
        let axis = |(bent, record): (&Bent, &AxisRecord)| AxisRecord {
            envelopes: Vec::new(),
            curve: bent.curve(self.force, &record.curve),
            reverse: record
                .reverse
                .as_ref()
                .map(|branch| Branch { envelopes: Vec::new(), curve: bent.curve(self.force, &branch.curve) }),
        };
        let force = entry.validity.axial_force_n.map(|n| self.force * n);
        let least = self.about[0].rotation.min(self.about[1].rotation);
        let rotation = entry.validity.rotation_rad.map(|range| range.map(|r| least * r));
        Computed {
            axes: self.about.iter().zip(&entry.axes).map(axis).collect(),
            springs: Vec::new(),
            stiffness: entry.stiffness.map(|s| Stiffness {
                axial_n_m: self.spring * s.axial_n_m,
                shear_n_m: s.shear_n_m.map(|k| self.spring * k),
                torsion_nm_rad: self.torsion * s.torsion_nm_rad,
            }),
            tensile_capacity_n: entry.tensile_capacity_n.map(|n| self.force * n),
            tensile_elongation_m: entry.tensile_elongation_m.map(|u| self.length * u),
            compressive_capacity_n: entry.compressive_capacity_n.map(|n| self.force * n),
            bearing_capacity_n: entry.bearing_capacity_n.map(|n| self.force * n),
            hinge_offset_m: entry.hinge_offset_m.map(|u| self.length * u),
            quality: entry.quality.clone(),
            validity: Validity { axial_force_n: force, rotation_rad: rotation, displacement_m: None },
        }
    }
}

impl Bent {
    /// A curve with axial forces times a factor.
    fn curve(&self, force: f64, curve: &ResistanceCurve) -> ResistanceCurve {
        let level = |level: &CapacityLevel| CapacityLevel {
            axial_force_n: force * level.axial_force_n,
            capacity: level.capacity.iter().map(|[r, m]| [self.rotation * r, self.moment * m]).collect(),
            fracture_rotation_rad: self.rotation * level.fracture_rotation_rad,
        };
        ResistanceCurve {
            stiffness_nm_rad: self.stiffness * curve.stiffness_nm_rad,
            levels: curve.levels.iter().map(level).collect(),
            cyclic: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Size, about_own_axes};
    use crate::library::entry::Entry;

    /// A head with beams that make it twice as stiff about axis 2.
    const HEAD: &str =
        include_str!("../../library/column_hinge/700x700-l1200-top-beam-m400@01e7016b5ac9763b.json");

    #[test]
    fn what_adjoins_a_square_column_turns_with_the_building() {
        let entry = Entry::from_text(HEAD).unwrap();
        let size = Size::of(&entry.features).unwrap();
        let peaks = |stiffness_nm_rad| {
            let scaled = about_own_axes(&entry, [size, size], Some(stiffness_nm_rad));
            [0, 1].map(|axis: usize| scaled.axes[axis].curve.free_level().unwrap().peak_nm())
        };
        let [weak, stiff] = peaks([1.0, 2.0]);
        assert!(stiff > 1.03 * weak, "{weak} {stiff}");
        assert_eq!(peaks([2.0, 1.0]), [stiff, weak]);
        let [first, second] = peaks([1.0, 1.0]);
        assert!((first / second - 1.0).abs() < 1e-8, "{first} {second}");
        assert!(weak < first && first < stiff, "{first}");
    }
}
