//! Rate factors that a model cannot have. What they do: `verify mbs --case rate`.

use super::support::*;
use fallwerk::mbs::model::*;

fn hinged() -> Model {
    let mut m = model("rates", 0.1, 0.01);
    m.bodies.push(solid("mass", [0.0, 0.0, 1.0], [1.0; 3]));
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    m.bushings.push(Bushing {
        axial_stiffness_n_m: 1e7,
        shear_stiffness_n_m: [1e7; 2],
        torsional_stiffness_nm_rad: 1e7,
        bending: [0, 1].map(|_| Bending::Elastic { stiffness_nm_rad: 1e7 }),
        compressive_capacity_n: Some(1e5),
        rate_factor: Some(RateFactor { rotation_rad_s: [1.0; 2], elongation_m_s: Some(1.0), exponent: 5.0 }),
        ..Bushing::free("link".into(), None, "mass".into(), [0.0; 3], axes)
    });
    m
}

#[test]
fn wrong_rate_factors_are_said() {
    hinged().check().expect("a sound model");
    let said = |change: &dyn Fn(&mut Model)| {
        let mut m = hinged();
        change(&mut m);
        m.check().unwrap_err().to_string()
    };
    let of = |change: fn(&mut RateFactor)| {
        said(&move |m: &mut Model| change(m.bushings[0].rate_factor.as_mut().unwrap()))
    };
    for (text, place) in [
        (of(|f| f.rotation_rad_s[1] = 0.0), "bushings[0].rate_factor.rotation_rad_s[1]"),
        (of(|f| f.elongation_m_s = Some(f64::NAN)), "bushings[0].rate_factor.elongation_m_s"),
        (of(|f| f.exponent = 0.5), "bushings[0].rate_factor.exponent"),
        (said(&|m| m.bushings[0].compressive_capacity_n = None), "bushings[0].rate_factor"),
    ] {
        assert!(text.contains(place), "{place}: {text}");
    }
}
