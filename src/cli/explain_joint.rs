//! What a joint of a model bears, in words.

use crate::base::piecewise::{interpolate, places};
use crate::curve::ResistanceCurve;
use crate::mbs::Model;
use crate::mbs::model::{Bending, Bushing, RateFactor};

/// Its resistances, a line each.
pub(super) fn resistance_text(model: &Model, joint: &Bushing) -> String {
    let bending: Vec<String> = joint.bending.iter().map(|b| bending_words(model, joint, b)).collect();
    let mut text = match &bending[..] {
        [one, other] if one == other => format!("  bending about both axes: {one}\n"),
        all => {
            (1..).zip(all).map(|(axis, words)| format!("  bending about axis {axis}: {words}\n")).collect()
        }
    };
    if let Some(beam) = &joint.beam {
        text += &format!(
            "  it stands in the middle of a beam, which yields at {} and {}\n",
            beam.ends[0], beam.ends[1]
        );
    }
    let force = |name: &str, value: Option<f64>| value.map(|n| format!("{name} {:.0} kN", n / 1e3));
    let [along_1, along_2] = joint.shear_capacity_n.map_or([None; 2], |v| v.map(Some));
    let most = [
        force("compression", joint.compressive_capacity_n),
        force("tension", joint.tensile_capacity_n),
        force("shear along axis 1", along_1),
        force("along axis 2", along_2),
        joint.shear_slip_m.map(|m| format!("after which it slips by {:.0} mm", m * 1e3)),
    ];
    let most: Vec<String> = most.into_iter().flatten().collect();
    text += &match most.is_empty() {
        true => "  elastic under forces\n".into(),
        false => format!("  bears at most: {}\n", most.join(", ")),
    };
    text + &joint.rate_factor.as_ref().map_or(String::new(), rate_text)
}

fn rate_text(RateFactor { rotation_rad_s, elongation_m_s, exponent }: &RateFactor) -> String {
    let [a, b] = rotation_rad_s;
    let along = elongation_m_s.map_or(String::new(), |c| format!(", {c:.3} m/s along itself"));
    format!(
        "  bears more the faster it flows: twice as much at {a:.3} and {b:.3} rad/s{along} (exponent {exponent})\n"
    )
}

/// That a joint's curves of an entry reach beyond the axial forces \[N\] for which the entry holds, if they do.
pub(super) fn extended_text(
    model: &Model,
    joint: &Bushing,
    entry: &str,
    valid_n: [f64; 2],
) -> Option<String> {
    let own = joint.bending.iter().filter_map(Bending::curve).filter(|id| id.starts_with(entry));
    let [low, high] = own
        .filter_map(|id| model.curves.get(id))
        .map(ResistanceCurve::axial_range_n)
        .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
    let slack = 1e-6 * (valid_n[1] - valid_n[0]).abs();
    (low < valid_n[0] - slack || high > valid_n[1] + slack).then(|| {
        format!(
            "    in the model its curves reach from {:.0} to {:.0} kN: beyond the forces of the entry they are extended\n",
            low / 1e3,
            high / 1e3
        )
    })
}

fn bending_words(model: &Model, joint: &Bushing, bending: &Bending) -> String {
    match bending {
        Bending::Elastic { stiffness_nm_rad } => format!("elastic, {stiffness_nm_rad:.3e} N m/rad"),
        Bending::Curve { curve, strength_factor } => {
            let Some(own) = model.curves.get(curve) else { return format!("curve {curve}") };
            let breaks = own.levels.iter().map(|l| l.fracture_rotation_rad).fold(0.0, f64::max);
            let most = Most::of(own, joint);
            format!(
                "elastic with {:.3e} N m/rad, bears up to {:.1} kN m as it yields (under {:.0} kN, turned by {:.3} rad), breaks at up to {breaks:.3} rad",
                own.stiffness_nm_rad,
                strength_factor * most.moment_nm / 1e3,
                most.axial_force_n / 1e3,
                most.rotation_rad,
            )
        }
    }
}

/// Largest moment that a joint bears, and where.
#[derive(Default)]
struct Most {
    moment_nm: f64,
    /// Compression positive.
    axial_force_n: f64,
    /// Plastic rotation.
    rotation_rad: f64,
}

impl Most {
    /// Over all forces that the joint bears when it has turned: curves may reach beyond them.
    fn of(curve: &ResistanceCurve, joint: &Bushing) -> Self {
        let tension_n = joint.tensile_capacity_n.unwrap_or(f64::INFINITY);
        let mut most = Self::default();
        let points = curve.levels.iter().flat_map(|level| &level.capacity);
        for rotation_rad in places(points.chain(&joint.compressive_fading)) {
            let left = match &joint.compressive_fading[..] {
                [] => 1.0,
                points => interpolate(points, rotation_rad),
            };
            let compression_n = left * joint.compressive_capacity_n.unwrap_or(f64::INFINITY);
            let levels = curve.levels.iter().map(|level| level.axial_force_n);
            for force in levels.map(|n| n.clamp(-tension_n, compression_n.max(0.0))) {
                let moment_nm = match rotation_rad <= curve.fracture_rotation_rad(force) {
                    true => curve.capacity_nm(rotation_rad, force),
                    false => 0.0,
                };
                if moment_nm > most.moment_nm {
                    most = Self { moment_nm, axial_force_n: force, rotation_rad };
                }
            }
        }
        most
    }
}
