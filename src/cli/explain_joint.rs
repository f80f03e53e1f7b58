//! What a joint of a model bears, in words.

use crate::mbs::Model;
use crate::mbs::model::{Bending, Bushing};

/// Its resistances, a line each.
pub(super) fn resistance_text(model: &Model, joint: &Bushing) -> String {
    let bending: Vec<String> = joint.bending.iter().map(|b| bending_words(model, b)).collect();
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
    ];
    let most: Vec<String> = most.into_iter().flatten().collect();
    match most.is_empty() {
        true => text + "  elastic under forces\n",
        false => text + &format!("  bears at most: {}\n", most.join(", ")),
    }
}

fn bending_words(model: &Model, bending: &Bending) -> String {
    match bending {
        Bending::Elastic { stiffness_nm_rad } => format!("elastic, {stiffness_nm_rad:.3e} N m/rad"),
        Bending::Curve { curve, strength_factor } => {
            let Some(own) = model.curves.get(curve) else { return format!("curve {curve}") };
            let breaks = own.levels.iter().map(|l| l.fracture_rotation_rad).fold(0.0, f64::max);
            format!(
                "elastic with {:.3e} N m/rad, yields at up to {:.1} kN m by its axial force, breaks at up to {breaks:.3} rad",
                own.stiffness_nm_rad,
                strength_factor * own.peak_nm() / 1e3
            )
        }
    }
}
