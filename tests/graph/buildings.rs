//! Buildings made in Rust.

use fallwerk::base::geom::Aabb;
use fallwerk::building::*;
use std::collections::BTreeMap;

/// An empty building with the materials and sections of the reference frame.
pub fn empty() -> Building {
    let concrete =
        Concrete { density_kg_m3: 2500.0, strength_pa: 30e6, youngs_modulus_pa: 33e9, poisson_ratio: 0.2 };
    let steel = Steel {
        yield_strength_pa: 500e6,
        ultimate_strength_pa: 540e6,
        ultimate_strain: 0.05,
        youngs_modulus_pa: 200e9,
    };
    let law = Homogenised {
        density_kg_m3: 2500.0,
        youngs_modulus_pa: 33e9,
        poisson_ratio: 0.2,
        hardening: vec![HardeningPoint { plastic_strain: 0.0, stress_pa: 20e6 }],
        critical_plastic_strain: 0.1,
        rate_factor: None,
        critical_principal_strain: None,
    };
    let materials = BTreeMap::from([
        ("c30".to_string(), Material::Concrete(concrete)),
        ("b500".to_string(), Material::Steel(steel)),
        ("rc".to_string(), Material::Homogenised(law)),
    ]);
    let bar = |x_m: f64, y_m: f64| Bar { x_m, y_m, diameter_m: 0.020 };
    let steps = [-0.15, 0.0, 0.15];
    let column_bars = steps.iter().flat_map(|x| steps.iter().map(move |y| bar(*x, *y)));
    let column_bars = column_bars.filter(|b| b.x_m != 0.0 || b.y_m != 0.0).collect();
    let beam_bars = [-0.1, 0.0, 0.1].iter().flat_map(|x| [bar(*x, -0.2), bar(*x, 0.2)]).collect();
    let rectangle = |width_m, depth_m, bars| SectionShape::Rectangle {
        width_m,
        depth_m,
        bars,
        ties: Some(Ties { diameter_m: 0.008, spacing_m: 0.15 }),
    };
    let plate = SectionShape::Plate {
        thickness_m: 0.25,
        bar_diameter_m: 0.010,
        bar_spacing_m: 0.15,
        bar_cover_m: 0.035,
    };
    let section = |id: &str, shape| {
        let section =
            Section { id: id.into(), shape, concrete: "c30".into(), steel: "b500".into(), law: "rc".into() };
        (id.to_string(), section)
    };
    Building {
        name: "test".into(),
        description: String::new(),
        materials,
        sections: BTreeMap::from([
            section("column", rectangle(0.4, 0.4, column_bars)),
            section("beam", rectangle(0.3, 0.5, beam_bars)),
            section("slab", plate),
        ]),
        members: Vec::new(),
        supports: Vec::new(),
        ground: Ground { level_m: 0.0, friction: 0.5 },
        obstacles: Vec::new(),
        preparation: Vec::new(),
        events: Vec::new(),
        settings: Settings::default(),
        overrides: Vec::new(),
    }
}

/// Adds a member between two corners.
pub fn add(building: &mut Building, id: &str, kind: MemberKind, min: [f64; 3], max: [f64; 3]) {
    let size: [f64; 3] = std::array::from_fn(|i| max[i] - min[i]);
    let (section, axis) = match kind {
        MemberKind::Beam => ("beam", if size[0] > size[1] { 0 } else { 1 }),
        MemberKind::Column => ("column", 2),
        MemberKind::Wall => ("slab", if size[0] < size[1] { 0 } else { 1 }),
        _ => ("slab", 2),
    };
    let solid = Aabb { min, max };
    let (id, section, openings) = (id.into(), section.into(), Vec::new());
    building.members.push(Member {
        id,
        kind,
        section,
        solid,
        axis,
        storey: None,
        openings,
        rotation_deg: 0.0,
        inclined: None,
    });
}

/// Holds the bottom of a member.
pub fn support(building: &mut Building, id: &str) {
    building.supports.push(Support { member: id.into(), face: Face::Bottom });
}

/// A charge on a whole member.
pub fn charge(building: &mut Building, id: &str) {
    building.events.push(Charge {
        id: format!("charge-{id}"),
        member: id.into(),
        stretch_m: None,
        time_s: 0.0,
    });
}

/// A coordinate without rounding noise, as the reader gives it.
fn clean(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

/// The three-storey reference frame with its two charges: columns at x = 0, 6 (A, B) and y = 0, 5 (1, 2).
pub fn reference() -> Building {
    let mut b = empty();
    let (xs, ys) = ([("A", 0.0), ("B", 6.0)], [("1", 0.0), ("2", 5.0)]);
    for storey in 1..=3 {
        let (low, top) = (3.5 * (storey - 1) as f64, 3.5 * storey as f64);
        for (column, x) in xs {
            for (row, y) in ys {
                let id = format!("C{storey}-{column}{row}");
                let max = [clean(x + 0.2), clean(y + 0.2), top];
                add(&mut b, &id, MemberKind::Column, [clean(x - 0.2), clean(y - 0.2), low], max);
            }
        }
        for (row, y) in ys {
            let id = format!("B{storey}-A{row}-B{row}");
            let (min, max) = ([-0.2, clean(y - 0.15), top - 0.5], [6.2, clean(y + 0.15), top]);
            add(&mut b, &id, MemberKind::Beam, min, max);
        }
        for (column, x) in xs {
            let id = format!("B{storey}-{column}1-{column}2");
            let (min, max) = ([clean(x - 0.15), 0.2, top - 0.5], [clean(x + 0.15), 4.8, top]);
            add(&mut b, &id, MemberKind::Beam, min, max);
        }
        add(&mut b, &format!("S{storey}"), MemberKind::Slab, [-0.2, -0.2, top - 0.25], [6.2, 5.2, top]);
    }
    for (column, _) in xs {
        for (row, _) in ys {
            support(&mut b, &format!("C1-{column}{row}"));
        }
    }
    charge(&mut b, "C1-A1");
    charge(&mut b, "C1-B1");
    b
}
