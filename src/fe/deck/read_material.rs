//! Materials, erosion, hourglass control.

use super::card::{Card, Cards, Names};
use super::raw::{Raw, RawErosion, RawMaterial, RawPlastic};
use super::read_control::twice;
use super::read_mesh::{define, without_title};
use crate::fe::law::{CowperSymonds, Hourglass};
use crate::fe::limit::{BULK_LINEAR, BULK_QUADRATIC};

/// Hourglass coefficient where a deck gives none.
pub(super) const DEFAULT_COEFFICIENT: f64 = 0.1;

/// Reads the block if it is one of these; says whether it was.
pub(super) fn read(cards: &mut Cards<'_, '_>, raw: &mut Raw) -> bool {
    let (keyword, titled) = without_title(&cards.block.keyword);
    match keyword {
        "MAT_ELASTIC" | "MAT_001" => elastic(cards, raw, titled),
        "MAT_PLASTIC_KINEMATIC" | "MAT_003" => kinematic(cards, raw, titled),
        "MAT_PIECEWISE_LINEAR_PLASTICITY" | "MAT_024" => piecewise(cards, raw, titled),
        "MAT_ADD_EROSION" | "MAT_000" => erosion(cards, raw, titled),
        "HOURGLASS" => hourglass(cards, raw, titled),
        "CONTROL_HOURGLASS" if !titled => control_hourglass(cards, raw),
        _ => return false,
    }
    true
}

/// Density, modulus and Poisson's ratio of fields 1 to 3.
fn elasticity<'a>(cards: &mut Cards<'a, '_>, card: &Card<'a>) -> [f64; 3] {
    let poisson = cards.real(card, 3);
    if poisson <= -1.0 || poisson >= 0.5 {
        cards.refuse(card, 3, "Poisson's ratio lies between -1 and 0.5");
    }
    [cards.positive(card, 1), cards.positive(card, 2), poisson]
}

/// A modulus over total strain, below Young's modulus.
fn tangent<'a>(cards: &mut Cards<'a, '_>, card: &Card<'a>, field: usize, youngs: f64) -> f64 {
    let tangent = cards.real(card, field);
    if tangent < 0.0 || tangent >= youngs {
        cards.refuse(card, field, "a tangent modulus is at least 0 and less than E");
    }
    tangent
}

/// `C`, `P` and the form `VP`. The rate is that of the plastic strain (`crate::material::rate`), which is the rate of VP = 1; that of VP = 0
/// is the rate of the total strain (Altair, reference of the LS-DYNA input of Radioss, `*MAT_024`). Also whether VP is 1.
fn rate<'a>(
    cards: &mut Cards<'a, '_>,
    card: &Card<'a>,
    [c, p, vp]: [usize; 3],
) -> (Option<CowperSymonds>, bool) {
    let (c_1_s, exponent) = (cards.real(card, c), cards.real(card, p));
    let form = cards.whole(card, vp);
    match form {
        Some(0) if c_1_s > 0.0 => cards.messages.note(
            card.place(vp),
            "VP = 0: the rate factor takes the rate of the plastic strain, elsewhere that of the total strain; in steady flow they are the same",
        ),
        Some(0 | 1) | None => {}
        Some(_) => cards.refuse(card, vp, "the rate factor acts on the yield stress: VP is 0 (or 1)"),
    }
    if c_1_s == 0.0 || c_1_s.is_nan() {
        return (None, false);
    }
    if c_1_s < 0.0 {
        cards.refuse(card, c, "a strain rate is positive");
    }
    if exponent <= 0.0 {
        cards.refuse(card, p, "the exponent of the rate law is positive");
    }
    (Some(CowperSymonds { c_1_s, p: exponent }), form == Some(1))
}

/// Whether the yield stress changes with plastic strain: VP = 1 elsewhere adds the rate factor times SIGY to the hardening table (d3view,
/// "Yield Stress and Strain-rate Dependency in MAT_024 and the significance of SIGY").
fn hardens(plastic: &RawPlastic) -> bool {
    match plastic {
        RawPlastic::Elastic => false,
        RawPlastic::Bilinear { tangent, .. } => *tangent > 0.0,
        RawPlastic::Points(points) => points.len() > 1,
        RawPlastic::Curve(_) => true,
    }
}

/// A failure strain; blank or 0 is none.
fn failure<'a>(cards: &mut Cards<'a, '_>, card: &Card<'a>, field: usize) -> f64 {
    let strain = cards.real_or(card, field, f64::INFINITY);
    if strain < 0.0 {
        cards.refuse(card, field, "give a strain, or 0 for no erosion (user routines are not supported)");
    }
    if strain >= 1e20 { f64::INFINITY } else { strain }
}

fn elastic(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    const NAMES: Names = &["MID", "RO", "E", "PR", "DA", "DB", "K"];
    cards.skip_title(titled);
    let Some(card) = cards.required(NAMES) else { return };
    let [density, youngs, poisson] = elasticity(cards, &card);
    for field in 4..7 {
        cards.must_be_zero(&card, field, "damping of beams and fluids are not supported; leave it out");
    }
    let (plastic, rate) = (RawPlastic::Elastic, None);
    let failure_strain = f64::INFINITY;
    enter(cards, raw, &card, RawMaterial { density, youngs, poisson, plastic, rate, failure_strain });
}

fn kinematic(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    const FIRST: Names = &["MID", "RO", "E", "PR", "SIGY", "ETAN", "BETA"];
    const SECOND: Names = &["SRC", "SRP", "FS", "VP"];
    cards.skip_title(titled);
    let Some(card) = cards.required(FIRST) else { return };
    let [density, youngs, poisson] = elasticity(cards, &card);
    let yield_stress = cards.positive(&card, 4);
    let tangent = tangent(cards, &card, 5, youngs);
    let beta = cards.real(&card, 6);
    if beta != 1.0 && tangent != 0.0 && !beta.is_nan() {
        cards.refuse(&card, 6, "kinematic hardening is not supported: BETA = 1 (isotropic)");
    }
    let (mut found_rate, mut failure_strain) = (None, f64::INFINITY);
    if let Some(second) = cards.card(SECOND) {
        (found_rate, _) = rate(cards, &second, [0, 1, 3]);
        failure_strain = failure(cards, &second, 2);
    }
    let plastic = RawPlastic::Bilinear { yield_stress, tangent };
    enter(
        cards,
        raw,
        &card,
        RawMaterial { density, youngs, poisson, plastic, rate: found_rate, failure_strain },
    );
}

fn piecewise(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    const FIRST: Names = &["MID", "RO", "E", "PR", "SIGY", "ETAN", "FAIL", "TDEL"];
    const SECOND: Names = &["C", "P", "LCSS", "LCSR", "VP"];
    const STRAINS: Names = &["EPS1", "EPS2", "EPS3", "EPS4", "EPS5", "EPS6", "EPS7", "EPS8"];
    const STRESSES: Names = &["ES1", "ES2", "ES3", "ES4", "ES5", "ES6", "ES7", "ES8"];
    cards.skip_title(titled);
    let Some(card) = cards.required(FIRST) else { return };
    let [density, youngs, poisson] = elasticity(cards, &card);
    let failure_strain = failure(cards, &card, 6);
    cards.must_be_zero(&card, 7, "elements erode at the solver's own limit of the time step; leave TDEL out");
    let (mut found_rate, mut plastic_rate, mut curve, mut points) = (None, None, Some(0), Vec::new());
    if let Some(second) = cards.card(SECOND) {
        let viscoplastic;
        (found_rate, viscoplastic) = rate(cards, &second, [0, 1, 4]);
        plastic_rate = viscoplastic.then(|| second.place(4));
        curve = cards.id(&second, 2);
        cards.must_be_zero(&second, 3, "curves of the rate effect are not supported; give C and P");
        if let Some(strains) = cards.card(STRAINS) {
            points = table(cards, &strains, STRESSES);
        }
    }
    let plastic = match curve {
        Some(0) if points.is_empty() => {
            let yield_stress = cards.positive(&card, 4);
            RawPlastic::Bilinear { yield_stress, tangent: tangent(cards, &card, 5, youngs) }
        }
        Some(0) => RawPlastic::Points(points),
        Some(curve) => RawPlastic::Curve(curve),
        None => RawPlastic::Elastic,
    };
    if let Some(place) = plastic_rate.filter(|_| hardens(&plastic)) {
        let text = "VP = 1: the rate factor acts on the hardening table as a whole, elsewhere on SIGY alone";
        cards.messages.note(place, text);
    }
    enter(
        cards,
        raw,
        &card,
        RawMaterial { density, youngs, poisson, plastic, rate: found_rate, failure_strain },
    );
}

/// The points of a hardening table whose stresses stand in the line after its strains.
fn table<'a>(cards: &mut Cards<'a, '_>, strains: &Card<'a>, names: Names) -> Vec<[f64; 2]> {
    let given: [f64; 8] = std::array::from_fn(|i| cards.real(strains, i));
    let Some(stresses) = cards.card(names) else {
        if let Some(first) = given.iter().position(|strain| *strain != 0.0) {
            cards.refuse(
                strains,
                first,
                "the line after it holds the stresses ES1 to ES8; leave both out for SIGY and ETAN",
            );
        }
        return Vec::new();
    };
    let mut points: Vec<[f64; 2]> = (0..8).map(|i| [given[i], cards.real(&stresses, i)]).collect();
    // zeros at the end, or throughout, are no points
    points.truncate(points.iter().rposition(|p| *p != [0.0; 2]).map_or(0, |i| i + 1));
    check_points(cards, strains, &stresses, &points);
    points
}

/// The table begins at plastic strain 0, strains increase, stresses are positive.
fn check_points<'a>(cards: &mut Cards<'a, '_>, strains: &Card<'a>, stresses: &Card<'a>, points: &[[f64; 2]]) {
    for (i, [strain, stress]) in points.iter().enumerate() {
        if i == 0 && *strain != 0.0 && !strain.is_nan() {
            cards.refuse(strains, 0, "the table begins at plastic strain 0, with the initial yield stress");
        }
        if i > 0 && *strain <= points[i - 1][0] {
            cards.refuse(strains, i, "plastic strains increase from point to point");
        }
        if *stress <= 0.0 {
            cards.refuse(stresses, i, "yield stresses are positive");
        }
    }
}

fn enter<'a>(cards: &mut Cards<'a, '_>, raw: &mut Raw, card: &Card<'a>, material: RawMaterial) {
    cards.end();
    if let Some(id) = cards.required_id(card, 0) {
        define(cards, &mut raw.materials, id, material, card.place(0));
    }
}

fn erosion(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    const FIRST: Names = &["MID", "EXCL", "MXPRES", "MNEPS", "EFFEPS", "VOLEPS", "NUMFIP", "NCS"];
    const SECOND: Names = &["MNPRES", "SIGP1", "SIGVM", "MXEPS", "EPSSH", "SIGTH", "IMPULSE", "FAILTM"];
    const ONLY: &str = "elements erode at MXEPS (largest principal strain) or EFFEPS only; leave it out";
    cards.skip_title(titled);
    let Some(first) = cards.required(FIRST) else { return };
    let material = cards.required_id(&first, 0);
    let exclude = cards.real(&first, 1);
    let plastic_strain = criterion(cards, &first, 4, exclude);
    for field in [2, 3, 5] {
        refuse_unless_excluded(cards, &first, field, exclude, ONLY);
    }
    let failed_points = cards.real(&first, 6);
    if failed_points != 0.0 && failed_points != 1.0 {
        cards.refuse(
            &first,
            6,
            "an element erodes by the mean over its points, not by a number of them: leave NUMFIP out, or 1",
        );
    }
    let criteria = cards.real(&first, 7);
    if criteria > 1.0 {
        cards.refuse(&first, 7, "one criterion that is met is enough: NCS = 1");
    }
    let mut principal_strain = f64::INFINITY;
    if let Some(second) = cards.card(SECOND) {
        principal_strain = criterion(cards, &second, 3, exclude);
        for field in [0, 1, 2, 4, 5, 6, 7] {
            refuse_unless_excluded(cards, &second, field, exclude, ONLY);
        }
        if principal_strain <= 0.0 {
            cards.refuse(&second, 3, "give a positive strain (curves and tables are not supported)");
        }
    }
    further_criteria(cards, exclude, ONLY);
    if plastic_strain <= 0.0 {
        cards.refuse(&first, 4, "give a positive strain (curves and tables are not supported)");
    } else if plastic_strain.is_finite() {
        cards.messages.note(
            first.place(4),
            "EFFEPS is compared with the equivalent plastic strain, without its elastic part",
        );
    }
    cards.end();
    if let Some(material) = material {
        raw.erosions.push(RawErosion { material, plastic_strain, principal_strain, at: first.place(0) });
    }
}

/// The lines after the second: damage, forming limits, steps. They may be there, and ask for nothing.
fn further_criteria(cards: &mut Cards<'_, '_>, exclude: f64, why: &str) {
    const LINES: [(Names, &[usize]); 3] = [
        (&["IDAM"], &[0]),
        (
            &["LCFLD", "NSFF", "EPSTHIN", "ENGCRT", "RADCRT", "LCEPS12", "LCEPS13", "LCEPSMX"],
            &[0, 2, 3, 4, 5, 6, 7],
        ),
        (&["DTEFLT", "VOLFRAC", "MXTMP", "DTMIN"], &[0, 2, 3]),
    ];
    for (names, fields) in LINES {
        let Some(card) = cards.card(names) else { return };
        for field in fields {
            refuse_unless_excluded(cards, &card, *field, exclude, why);
        }
    }
}

/// The value of a criterion; infinite if it is blank, 0 or the number that stands for "not used".
fn criterion<'a>(cards: &mut Cards<'a, '_>, card: &Card<'a>, field: usize, exclude: f64) -> f64 {
    let value = cards.real(card, field);
    if value == 0.0 || value == exclude { f64::INFINITY } else { value }
}

fn refuse_unless_excluded<'a>(
    cards: &mut Cards<'a, '_>,
    card: &Card<'a>,
    field: usize,
    exclude: f64,
    why: &str,
) {
    let value = cards.real(card, field);
    if value != 0.0 && value != exclude && !value.is_nan() {
        cards.refuse(card, field, why);
    }
}

/// Hourglass control by its number and coefficient; `None` after an error.
fn control<'a>(
    cards: &mut Cards<'a, '_>,
    card: &Card<'a>,
    kind: usize,
    coefficient: usize,
) -> Option<Option<Hourglass>> {
    let value = cards.real(card, coefficient);
    if value < 0.0 {
        cards.refuse(card, coefficient, "a coefficient is positive");
    }
    let coefficient_used = if value == 0.0 { DEFAULT_COEFFICIENT } else { value };
    Some(Some(match cards.whole(card, kind)? {
        0 if value == 0.0 => return Some(None),
        0..=3 => Hourglass::Viscous { coefficient: coefficient_used },
        4 | 5 => Hourglass::Stiffness { coefficient: coefficient_used },
        number @ (6 | 7 | 9) => {
            if value != 1.0 {
                let text =
                    "the assumed-strain hourglass stiffness (IHQ 6, 7, 9) acts in full, as with QM = 1";
                cards.messages.note(card.place(coefficient), text);
            }
            if number != 6 {
                let text = "IHQ 7 and 9 are computed as 6: assumed strain in rate form (Belytschko and Bindeman 1993)";
                cards.messages.note(card.place(kind), text);
            }
            Hourglass::Asqbi
        }
        _ => {
            cards.refuse(
                card,
                kind,
                "IHQ is 1 to 3 (viscous), 4 or 5 (stiffness), 6, 7 or 9 (assumed strain)",
            );
            return None;
        }
    }))
}

fn hourglass(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    const NAMES: Names = &["HGID", "IHQ", "QM", "IBQ", "Q1", "Q2", "QB/VDC", "QW"];
    while cards.more() {
        cards.skip_title(titled);
        let Some(card) = cards.required(NAMES) else { return };
        let id = cards.required_id(&card, 0);
        bulk_viscosity(cards, &card, 4, 5);
        let Some(found) = control(cards, &card, 1, 2) else { continue };
        if found.is_none() {
            let text = "IHQ of *HOURGLASS is 0: viscous, coefficient 0.1, also beside *CONTROL_HOURGLASS";
            cards.messages.note(card.at, text);
        }
        if let Some(id) = id {
            let item = found.unwrap_or(Hourglass::Viscous { coefficient: DEFAULT_COEFFICIENT });
            define(cards, &mut raw.hourglass, id, item, card.place(0));
        }
    }
}

fn control_hourglass(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    let Some(card) = cards.card(&["IHQ", "QH"]) else { return };
    if let Some(Some(found)) = control(cards, &card, 0, 1)
        && raw.default_hourglass.replace(found).is_some()
    {
        twice(cards);
    }
    cards.end();
}

/// Coefficients of the bulk viscosity are those of the solver.
pub(super) fn bulk_viscosity<'a>(
    cards: &mut Cards<'a, '_>,
    card: &Card<'a>,
    quadratic: usize,
    linear: usize,
) {
    for (field, own) in [(quadratic, BULK_QUADRATIC), (linear, BULK_LINEAR)] {
        let value = cards.real_or(card, field, own);
        if value != own && !value.is_nan() {
            let text = format!(
                "bulk viscosity has the coefficients {BULK_QUADRATIC} and {BULK_LINEAR}, not those given"
            );
            cards.messages.note(card.place(field), text);
        }
    }
}
