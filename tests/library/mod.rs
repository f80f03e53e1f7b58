//! The store of subsystems: records survive a damaged working copy, damaged text is named and refused.

mod add;
mod commands;
mod damage;
mod diff;
mod exchange;
mod grids;
mod interpolation;
mod journal;
mod layered;
mod queries;
mod records;
mod torture;

use fallwerk::building::{Bar, HardeningPoint, Homogenised, Section, SectionShape, Ties};
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::library::entry::{
    Adjoining, AxisRecord, ColumnEnd, EnvelopeLevel, LawFeatures, Quality, Stiffness, Validity,
};
use fallwerk::library::{Computed, Entry, EntryKind, Features, Inputs, Origin};

/// A homogenised law with this first yield stress \[Pa\].
pub fn law(yield_stress_pa: f64) -> Homogenised {
    Homogenised {
        density_kg_m3: 2500.0,
        youngs_modulus_pa: 33e9,
        poisson_ratio: 0.2,
        hardening: vec![
            HardeningPoint { plastic_strain: 0.0, stress_pa: yield_stress_pa },
            HardeningPoint { plastic_strain: 0.1, stress_pa: 1.3 * yield_stress_pa },
        ],
        critical_plastic_strain: 0.12,
        rate_factor: None,
        critical_principal_strain: None,
    }
}

/// Features of a square column end.
pub fn features(width_m: f64, end: ColumnEnd, adjoining: Adjoining, law: &Homogenised) -> Features {
    Features {
        width_m,
        depth_m: width_m,
        length_to_inflection_m: Some(1.625),
        end: Some(end),
        adjoining: Some(adjoining),
        law: Some(LawFeatures::of("rc", law)),
        mesh_size_m: Some(0.1),
        rc: None,
        further: Default::default(),
    }
}

/// An entry whose numbers depend on `seed`; different seeds have different inputs.
pub fn entry(seed: u32) -> Entry {
    let width_m = 0.2 + 0.01 * f64::from(seed % 40);
    let law = law(12e6 + 1e3 * f64::from(seed));
    let (end, adjoining) = if seed.is_multiple_of(2) {
        (ColumnEnd::Bottom, Adjoining::Ground)
    } else {
        (ColumnEnd::Top, Adjoining::Beam)
    };
    entry_of(features(width_m, end, adjoining, &law), law, 1, seed)
}

/// An entry with these features.
pub fn entry_of(features: Features, law: Homogenised, submodel_version: u32, seed: u32) -> Entry {
    let inputs = Inputs {
        section: Some(section(features.width_m)),
        law: Some(law),
        geometry: [("length_m".to_string(), 2.0 * features.length_to_inflection_m.unwrap())].into(),
        settings: [("levels".to_string(), serde_json::json!([0.0, 0.2, 0.4]))].into(),
        submodel_version: Some(submodel_version),
        ..Inputs::default()
    };
    Entry::new(EntryKind::ColumnHinge, Origin::Submodel, features, inputs, computed(seed, 5, 60)).unwrap()
}

fn section(width_m: f64) -> Section {
    let bar = |x_m: f64, y_m: f64| Bar { x_m, y_m, diameter_m: 0.02 };
    let c = width_m / 2.0 - 0.05;
    Section {
        id: "column".into(),
        shape: SectionShape::Rectangle {
            width_m,
            depth_m: width_m,
            bars: vec![bar(c, c), bar(-c, c), bar(c, -c), bar(-c, -c)],
            ties: Some(Ties { diameter_m: 0.008, spacing_m: 0.15 }),
        },
        concrete: "c30".into(),
        steel: "b500".into(),
        law: "rc".into(),
    }
}

/// Curves with `levels` axial forces and `points` points each.
pub fn computed(seed: u32, levels: u32, points: u32) -> Computed {
    let moment = |level: u32, x: f64| {
        (1e5 + 3.7e3 * f64::from(seed % 97)) * (1.0 + 0.1 * f64::from(level)) * (x / 0.013).tanh()
    };
    let axis = |factor: f64| AxisRecord {
        envelopes: (0..levels)
            .map(|level| EnvelopeLevel {
                axial_force_n: 2e5 * f64::from(level),
                points: (0..points)
                    .map(|i| f64::from(i) * 0.1 / 59.0)
                    .map(|x| [x, factor * moment(level, x)])
                    .collect(),
                fracture_rotation_rad: (level > 2).then_some(0.09),
            })
            .collect(),
        curve: ResistanceCurve {
            stiffness_nm_rad: factor * moment(0, 1e-6) / 1e-6,
            levels: (0..levels)
                .map(|level| CapacityLevel {
                    axial_force_n: 2e5 * f64::from(level),
                    capacity: (0..points)
                        .map(|i| f64::from(i) * 0.1 / 59.0)
                        .map(|x| [x, factor * moment(level, 0.05 + x)])
                        .collect(),
                    fracture_rotation_rad: 0.1,
                })
                .collect(),
            cyclic: None,
        },
        reverse: None,
    };
    Computed {
        axes: vec![axis(1.0), axis(1.01)],
        springs: vec![],
        stiffness: Some(Stiffness { axial_n_m: 3.1e9, shear_n_m: [1.1e8, 1.2e8], torsion_nm_rad: 4.4e7 }),
        tensile_capacity_n: Some(1.2e6),
        tensile_elongation_m: Some(0.12),
        compressive_capacity_n: Some(1.2e6),
        bearing_capacity_n: None,
        hinge_offset_m: Some(0.3),
        quality: Quality {
            kinetic_energy_ratio: Some(0.011),
            elements: Some(5000),
            asymmetry: Some(0.002),
            ..Quality::default()
        },
        validity: Validity {
            axial_force_n: [0.0, 8e5],
            rotation_rad: Some([0.0, 0.1]),
            displacement_m: None,
        },
    }
}
