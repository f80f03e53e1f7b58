//! Member ends of the RC submodel beside section analysis: strength, stiffness, first yield.
//!
//! Each bend is run in concrete and steel to beyond its peak. The member stands on a plane of symmetry, which is what section analysis
//! describes, and its bars do not buckle, as in the references.

use super::sections::{s1, s2, s3, s4};
use crate::material::concrete::ConcreteLaw;
use crate::material::fibre::{CurvaturePoint, FibreOptions, FibreSection, SectionInput};
use crate::material::fibre_concrete;
use crate::material::fibre_response::Milestones;
use crate::rc::bend::{Bend, Bent, bend as rc_bend};
use crate::rc::member::{Joint, RcMember};
use crate::rc::series::Figures;
use crate::verify::{Case, Figure};
use rayon::prelude::*;

const OPENSEES: &str = "OpenSees 3.7.1 (Concrete04, Steel01, HingeRadau): 0.98 to 1.12 of its fibre section";
const STRIPS: &str = "strip solver of another author (Mander's concrete): first of bar yield, edge at 0.002";
const FIBRE: &str = "own fibre section (Mander's concrete, bars displace nothing): 0.98 to 1.12 of it";
const OWN_YIELD: &str = "own fibre section: first of bar yield, edge at 0.002";
const BEAM: &str = "3 E_cm I_g / L of the gross section";
const OPENSEES_SLOPE: &str = "OpenSees 3.7.1 (Concrete04, Steel01, HingeRadau)";
const OWN_SLOPE: &str = "3 EI / L of the own fibre section (Mander's concrete)";
const STATIC: &str = "usual limit of quasi-static runs";
const FINE: &str = "the same member in elements of 25 mm";

/// Length to the point of zero moment \[m\].
const LENGTH_M: f64 = 1.75;
/// Share of the cracking moment without axial force up to which the slope is taken.
const SLOPE_SHARE: f64 = 0.5;
/// Curvature times depth up to which the fibre section is bent.
const FIBRE_REACH: f64 = 0.4;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "member-coarse",
            "S2 in elements of 75 mm to 12 mrad: what CI can afford of the cases below. Under n = 0.1 the peak lies beyond; the first yield under n = 0.3 is in member-s2.",
            || {
                let light = Load { to_peak: false, ..bend(0.1, 0.012) };
                let heavy = Load { to_yield: false, ..bend(0.3, 0.012) };
                of_section("S2", &s2(), 0.075, &[light, heavy], &COARSE)
            },
        ),
        Case::long(
            "member-s1",
            "S1 of section-confinement (400 mm, 30 MPa) as a member end of 1.75 m in elements of 50 mm under n = N / (f_c A). Bars and shear make the first slope 8 % \
             larger than that of the gross section (bars + 15 %, shear - 4 %). First yield is that of a bar under n = 0 and 0.1, and that of the compressed edge (a strain of 0.002) beyond; \
             its moment is that in the middle of the length over which the strain is measured. At n = 0 the peak is that of the hardening bars, and depends on how far they are followed.",
            || {
                let bends = [bend(0.0, 0.1), bend(0.1, 0.05), bend(0.3, 0.025), bend(0.6, 0.015)];
                of_section("S1", &s1(), 0.05, &bends, &S1)
            },
        ),
        Case::long("member-s2", "S2 of section-confinement (300 mm, 25 MPa), as before.", || {
            let bends = [bend(0.0, 0.11), bend(0.1, 0.05), bend(0.3, 0.025), bend(0.6, 0.015)];
            of_section("S2", &s2(), 0.05, &bends, &S2)
        }),
        Case::long(
            "member-s3",
            "S3, a beam: 300 x 500 mm, three bars of 20 mm at the bottom and two of 16 mm at the top, 40 mm from the faces, ties of 8 mm at 150 mm, 30 MPa, both senses of \
             bending; otherwise as before. Positive: the bottom is pulled.",
            || {
                let positive = bend(0.0, 0.06);
                let negative = Load { direction_deg: 270.0, ..positive };
                Ok([("S3 positive", positive), ("S3 negative", negative)]
                    .into_par_iter()
                    .map(|(name, load)| of_section(name, &s3(), 0.05, &[load], &[None]))
                    .collect::<Result<Vec<_>, _>>()?
                    .concat())
            },
        ),
        Case::long(
            "member-s4",
            "S4: 500 mm, 40 MPa, twelve bars of 25 mm, 50 mm from the faces, ties of 10 mm at 100 mm with four legs each way: confined by far more than S1 and S2.",
            || {
                let bends = [bend(0.0, 0.08), bend(0.1, 0.05), bend(0.3, 0.04), bend(0.6, 0.04)];
                of_section("S4", &s4(), 0.05, &bends, &[None; 4])
            },
        ),
        Case::complete("member-mesh-s1", "S1 under n = 0.3 in elements of 50 and 25 mm.", || {
            sensitivity("S1", &s1(), bend(0.3, 0.05))
        }),
        Case::complete("member-mesh-s2", "S2 under n = 0.3 in elements of 50 and 25 mm.", || {
            sensitivity("S2", &s2(), bend(0.3, 0.06))
        }),
    ]
}

/// Peak by OpenSees, first yield by the strip solver \[kN m\], and OpenSees' slope of moment over chord rotation at [`SLOPE_SHARE`] of the cracking moment \[MN m\] (without axial force
/// its fibres, which bear no tension, are cracked from the start: there the slope is that of the gross section); `None`: the own fibre section is the reference.
type Reference = Option<[f64; 3]>;

const S1: [Reference; 4] = [
    Some([239.7, 172.9, f64::NAN]),
    Some([286.3, 236.5, 116.19]),
    Some([356.2, 294.5, 113.42]),
    Some([349.4, 263.6, 104.17]),
];
const S2: [Reference; 4] = [
    Some([59.8, 48.6, f64::NAN]),
    Some([78.9, 73.1, 32.40]),
    Some([115.4, 99.8, 31.46]),
    Some([111.7, 90.1, 28.23]),
];
/// Of the short case, which is bent to its peak under n = 0.3 only.
const COARSE: [Reference; 2] = [S2[1], S2[2]];

/// How a member is bent.
#[derive(Debug, Clone, Copy)]
struct Load {
    share: f64,
    direction_deg: f64,
    until_rad: f64,
    /// Whether its largest moment is compared.
    to_peak: bool,
    /// Whether its first yield is.
    to_yield: bool,
}

fn bend(share: f64, until_rad: f64) -> Load {
    Load { share, direction_deg: 90.0, until_rad, to_peak: true, to_yield: true }
}

/// A bent member.
struct Ran {
    bent: Bent,
    figures: Figures,
    length_m: f64,
}

/// Bends a member of a section.
fn run(input: &SectionInput, load: Load, mesh_size_m: f64) -> Result<Ran, String> {
    let concrete = ConcreteLaw::of_strength(input.concrete_strength_pa);
    let member =
        RcMember::half(input, &concrete, Joint::Symmetry, [LENGTH_M, mesh_size_m], load.direction_deg)
            .map_err(|e| e.to_string())?;
    let axial_n = load.share * input.concrete_strength_pa * input.area_m2();
    let push = Bend::monotonic(axial_n, load.direction_deg, load.until_rad);
    let bent = rc_bend(&member, &push, false, &|_| ()).map_err(|e| format!("n = {}: {e}", load.share))?;
    let figures = Figures::of(&bent.points).ok_or("no positive moment")?;
    Ok(Ran { bent, figures, length_m: member.length_m })
}

/// Figures of a section under several loads.
fn of_section(
    name: &str,
    input: &SectionInput,
    mesh_size_m: f64,
    loads: &[Load],
    references: &[Reference],
) -> Result<Vec<Figure>, String> {
    let options = FibreOptions { deduct_bars: false, history: true };
    let input = &SectionInput { options, ..input.clone() };
    let of_load = |(load, other): (&Load, &Reference)| {
        let ran = run(input, *load, mesh_size_m)?;
        let reference = match other {
            Some(reference) => *reference,
            None => milestones(input, &fibre(input, *load))?,
        };
        let [peak, yielded, slope] = reference;
        let sources =
            if other.is_some() { [OPENSEES, STRIPS, OPENSEES_SLOPE] } else { [FIBRE, OWN_YIELD, OWN_SLOPE] };
        let (slope, slope_source) =
            if load.share > 0.0 { (slope, sources[2]) } else { (gross_slope(input, ran.length_m), BEAM) };
        let slopes = [slope, secant_slope(input, ran.bent.points.iter().map(|p| [p[0], p[1]]))?];
        let say = |what: &str| format!("{name}, n = {}: {what}", load.share);
        let mut figures = vec![
            Figure::relative(say("slope at the start"), "MN m", slopes, 0.10, slope_source),
            Figure::absolute(say("kinetic share"), "-", [0.0, ran.bent.kinetic_share], 0.05, STATIC),
        ];
        if load.to_yield {
            let moments = [yielded, first_yield(input, &ran)];
            figures.insert(0, Figure::relative(say("first yield"), "kN m", moments, 0.07, sources[1]));
        }
        if load.to_peak {
            let ratio = 1e-3 * ran.figures.peak_nm / peak;
            let what = say(&format!("peak over {peak:.1} kN m"));
            figures.insert(0, Figure::absolute(what, "-", [1.05, ratio], 0.07, sources[0]));
        }
        Ok(figures)
    };
    let all: Result<Vec<_>, String> = loads.par_iter().zip(references).with_max_len(1).map(of_load).collect();
    Ok(all?.concat())
}

/// The own fibre section under a load.
fn fibre(input: &SectionInput, load: Load) -> Vec<CurvaturePoint> {
    let force = load.share * input.concrete_strength_pa * input.area_m2();
    let curvatures = FibreSection::curvatures_to(FIBRE_REACH / input.size_m[1]);
    let section = FibreSection::of(input, fibre_concrete::ConcreteLaw::Mander);
    section.moment_curvature(force, load.direction_deg.to_radians(), &curvatures)
}

/// Its peak and first yield \[kN m\], and `3 / L` of its secant stiffness at [`SLOPE_SHARE`] of the cracking moment \[MN m\].
fn milestones(input: &SectionInput, points: &[CurvaturePoint]) -> Result<[f64; 3], String> {
    let m = Milestones::of(input, points).ok_or("the fibre section has no moment")?;
    let yielded = m.first_yield.ok_or("the fibre section does not yield")?;
    let stiffness = secant_slope(input, points.iter().map(|p| [p.curvature_1_m, p.moment_nm]))?;
    Ok([m.peak[1] / 1e3, yielded[1] / 1e3, 3.0 * stiffness / LENGTH_M])
}

/// `3 E_cm I_g / L` \[MN m\].
fn gross_slope(input: &SectionInput, length_m: f64) -> f64 {
    let [width, depth] = input.size_m;
    3e-6 * input.youngs_modulus_pa * width * depth.powi(3) / 12.0 / length_m
}

/// Secant of moments over rotations or curvatures at [`SLOPE_SHARE`] of the cracking moment `f_t b h² / 6`, times 1e-6.
fn secant_slope(input: &SectionInput, points: impl Iterator<Item = [f64; 2]>) -> Result<f64, String> {
    let [width, depth] = input.size_m;
    let moment = SLOPE_SHARE * input.tensile_strength_pa * width * depth * depth / 6.0;
    let points: Vec<[f64; 2]> = points.collect();
    let rising = points.windows(2).find(|w| w[1][1] >= moment).ok_or("the cracking moment is not reached")?;
    let share = (moment - rising[0][1]) / (rising[1][1] - rising[0][1]);
    Ok(1e-6 * moment / (rising[0][0] + share * (rising[1][0] - rising[0][0])))
}

/// Moment at which a bar or the compressed face yields first, in the middle of the length over which its strain is measured \[kN m\]; NaN: never.
fn first_yield(input: &SectionInput, ran: &Ran) -> f64 {
    let progress: Vec<f64> =
        ran.bent.strains.iter().map(|s| s.to_yield(input.steel.yield_strain())).collect();
    let Some(k) = progress.iter().position(|p| *p >= 1.0).filter(|k| *k > 0) else { return f64::NAN };
    let share = (1.0 - progress[k - 1]) / (progress[k] - progress[k - 1]);
    let [before, after] = [k - 1, k].map(|i| ran.bent.points[i][1]);
    let height_m = ran.bent.strains[k].height_m(input.steel.yield_strain());
    (1.0 - height_m / ran.length_m) * (before + share * (after - before)) / 1e3
}

/// Peak and loss of strength in elements of 50 and of 25 mm.
fn sensitivity(name: &str, input: &SectionInput, load: Load) -> Result<Vec<Figure>, String> {
    let runs: Result<Vec<Ran>, String> =
        [0.05, 0.025].par_iter().with_max_len(1).map(|size| run(input, load, *size)).collect();
    let figures: Vec<Figures> = runs?.iter().map(|r| r.figures).collect();
    let [coarse, fine] = [figures[0], figures[1]];
    let fallen = |f: Figures| f.rotation_80_rad.map_or(f64::NAN, |r| 1e3 * r);
    let say = |what: &str| format!("{name}, n = {}: {what}", load.share);
    let peaks = [fine.peak_nm / 1e3, coarse.peak_nm / 1e3];
    Ok(vec![
        Figure::relative(say("peak"), "kN m", peaks, 0.05, FINE),
        Figure::relative(say("rotation at 80 %"), "mrad", [fallen(fine), fallen(coarse)], 0.15, FINE),
    ])
}
