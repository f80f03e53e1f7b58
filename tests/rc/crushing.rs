//! Crushing of the end of a member against closed forms.

use fallwerk::building::{HardeningPoint, Homogenised};
use fallwerk::rc::crushing::{CRUSHED_SHARE, Prism};

fn prism(friction: f64, hardening: &[[f64; 2]]) -> Prism {
    let hardening = hardening
        .iter()
        .map(|[plastic_strain, stress_pa]| HardeningPoint {
            plastic_strain: *plastic_strain,
            stress_pa: *stress_pa,
        })
        .collect();
    Prism {
        section_m: [0.4, 0.3],
        length_m: 1.5,
        mesh_size_m: 0.1,
        law: Homogenised {
            density_kg_m3: 2500.0,
            youngs_modulus_pa: 30e9,
            poisson_ratio: 0.2,
            hardening,
            critical_plastic_strain: 0.2,
            rate_factor: None,
            critical_principal_strain: None,
        },
        strength: 1.0,
        friction,
    }
}

fn at(points: &[[f64; 2]], way: f64) -> f64 {
    fallwerk::base::piecewise::interpolate(points, way)
}

/// The law flows at its true stress and keeps its volume: `F = f A / (1 - s / L)` after `E A / L`. The far section does not spread, which confines the elements at it.
#[test]
fn an_end_flows_as_a_whole_at_its_yield_stress() {
    let (strength, area, length) = (30e6, 0.12, 1.5);
    let crushing = prism(0.0, &[[0.0, strength]]).crush().unwrap();
    let stiffness = at(&crushing.points, 7e-4) / 7e-4 / (30e9 * area / length);
    let flow = |way: f64| at(&crushing.points, way) * (1.0 - way / length) / (strength * area);
    println!("stiffness {stiffness:.3}, flow {:.3} {:.3} {:.3}", flow(0.01), flow(0.05), flow(0.15));
    assert!((stiffness - 1.0).abs() < 0.02);
    for way in [0.01, 0.05, 0.15] {
        assert!((flow(way) - 1.0).abs() < 0.02, "{way}: {}", flow(way));
    }
    // uniform strain: layers are gone after L (1 - exp(-ε)) at most
    let gone = length * (1.0 - (-0.2_f64).exp());
    assert!(at(&crushing.points, 1.05 * gone) < 0.2 * strength * area);
    let drawn: f64 =
        crushing.points.windows(2).map(|w| 0.5 * (w[0][1] + w[1][1]) * (w[1][0] - w[0][0])).sum();
    println!(
        "work {:.0} J, of the line {drawn:.0} J, kinetic {:.1e}",
        crushing.work_j, crushing.kinetic_share
    );
    assert!((drawn / crushing.work_j - 1.0).abs() < 0.03);
    assert!(crushing.kinetic_share < 0.05);
}

#[test]
fn hardening_raises_the_resistance_and_a_weakened_end_bears_its_share() {
    let law = [[0.0, 30e6], [0.2, 45e6]];
    let whole = prism(0.6, &law).crush().unwrap();
    let area = 0.12;
    // uniform: true strain ln(1 / (1 - s / L)), less what is elastic
    let way = 0.12_f64;
    let strain = -(1.0 - way / 1.5).ln();
    let expected = (30e6 + 15e6 * (strain - 1e-3) / 0.2) * area / (1.0 - way / 1.5);
    println!("{:.4}", at(&whole.points, way) / expected);
    // both ends are held across
    assert!((at(&whole.points, way) / expected - 1.0).abs() < 0.03);
    let weak = Prism { strength: 0.5, ..prism(0.6, &law) }.crush().unwrap();
    let half = at(&weak.points, way) / at(&whole.points, way);
    println!("{half:.4}");
    assert!((half - 0.5).abs() < 0.01);
}

/// What generated models take for the shortening at which columns are crushed; both ends are held across.
#[test]
fn a_column_is_crushed_at_the_share_of_its_rupture_strain_that_models_have() {
    let law = [[0.0, 10.5e6], [0.01, 11.55e6], [0.1, 12.25e6]];
    let column = |critical_plastic_strain: f64, length_m: f64, side: f64, hardening: &[[f64; 2]]| {
        let like = prism(0.5, hardening);
        let law = Homogenised { critical_plastic_strain, youngs_modulus_pa: 16.5e9, ..like.law.clone() };
        Prism { section_m: [side; 2], length_m, mesh_size_m: 0.4, law, ..like }
    };
    let cases = [
        (0.1, 2.5, 0.4, &law[..]),
        (0.1, 2.5, 0.3, &law[..]),
        (0.1, 3.5, 0.4, &law[..]),
        (0.1, 3.2, 0.6, &law[..]),
        (0.1, 2.5, 0.4, &law[..1]),
        (0.05, 2.5, 0.4, &law[..]),
        (0.2, 2.5, 0.4, &law[..]),
    ];
    for (critical, length, side, hardening) in cases {
        let points = column(critical, length, side, hardening).crush().unwrap().points;
        let most = points.iter().map(|p| p[1]).fold(0.0, f64::max);
        let top = points.iter().position(|p| p[1] == most).unwrap();
        let lost = points[top..].iter().find(|p| p[1] < 0.5 * most).unwrap()[0];
        let share = lost / (critical * length);
        println!("rupture strain {critical}, {length} m by {side} m: {share:.3}");
        assert!((share / CRUSHED_SHARE - 1.0).abs() < 0.12, "{share}");
    }
}
