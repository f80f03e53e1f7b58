//! A piece of a member crushed or pulled apart: its mesh, and what section analysis says of it.

use super::member::RcMember;
use super::section_file::RcSection;
use crate::material::concrete::{ConcreteLaw, LawError};
use crate::material::fibre::FibreSection;
use crate::material::fibre_concrete::{self, Confinement};

/// Points of the fibre section's line.
const LINE_POINTS: usize = 200;

/// By how much the middle layer of a piece is weaker.
const WEAKER: f64 = 0.03;

/// Length of a piece \[m\]: whole spacings of the ties, about the larger side of the section.
pub fn piece_length_m(section: &RcSection, depths: f64) -> f64 {
    let side = section.input.size_m[0].max(section.input.size_m[1]);
    match section.input.ties {
        Some(ties) => ties.spacing_m * (depths * side / ties.spacing_m).round().max(1.0),
        None => depths * side,
    }
}

/// The mesh of a piece of a length \[m\].
///
/// # Errors
/// If the concrete does not suit the elements.
pub fn piece(
    section: &RcSection,
    concrete: &ConcreteLaw,
    length_m: f64,
    mesh_size_m: f64,
) -> Result<RcMember, LawError> {
    let mut member = RcMember::piece(&section.input, concrete, length_m, mesh_size_m)?;
    weaken(&mut member, concrete);
    Ok(member)
}

/// Makes the layer nearest to mid-length a little weaker. Without it every layer of a uniform piece crushes or cracks at once, and its energy is that of
/// so many fracture zones.
fn weaken(member: &mut RcMember, concrete: &ConcreteLaw) {
    let mesh = &mut member.mesh;
    let Some(law) = mesh.elements.first().map(|e| e.law) else { return };
    let mut weak = mesh.laws[law].clone();
    weak.concrete = Some(ConcreteLaw {
        compressive_strength_pa: (1.0 - WEAKER) * concrete.compressive_strength_pa,
        tensile_strength_pa: (1.0 - WEAKER) * concrete.tensile_strength_pa,
        ..concrete.clone()
    });
    let heights: Vec<f64> = (0..mesh.elements.len()).map(|e| mesh.center(e)[2]).collect();
    let off = |height: &f64| (height - 0.5 * member.length_m).abs();
    let least = heights.iter().map(off).fold(f64::INFINITY, f64::min);
    // of two layers equally near the upper one
    let above = |height: &f64| off(height) < least + 1e-6 && *height > 0.5 * member.length_m - 1e-6;
    let chosen: Vec<bool> = heights.iter().map(above).collect();
    mesh.laws.push(weak);
    let index = mesh.laws.len() - 1;
    mesh.elements.iter_mut().zip(chosen).filter(|(_, c)| *c).for_each(|(e, _)| e.law = index);
    mesh.elements.sort_by_key(|e| e.law);
}

/// Squash load `f_c (A - A_s) + f_y A_s` \[N\].
pub fn squash_n(section: &RcSection) -> f64 {
    let (area, steel) = (section.input.area_m2(), section.steel_m2());
    section.concrete.compressive_strength_pa * (area - steel) + section.input.steel.yield_strength_pa * steel
}

/// Load of the core with Mander's strength once the cover has spalled, `f_cc (A_cc - A_s) + f_y A_s` \[N\]; `None` without ties.
pub fn confined_n(section: &RcSection) -> Option<f64> {
    let core = Confinement::of(&section.input)?;
    let steel = section.steel_m2();
    let concrete = core.core_m[0] * core.core_m[1] - steel;
    Some(core.strength_pa * concrete + section.input.steel.yield_strength_pa * steel)
}

/// `[shortening (m), force (N)]` of the fibre section under uniform strain: Mander's concrete in core and cover, bars by their own line in compression.
pub fn fibre_line(section: &RcSection, length_m: f64, until: f64) -> Vec<[f64; 2]> {
    let input = &section.input;
    let [core, cover] = FibreSection::of(input, fibre_concrete::ConcreteLaw::Mander).curves();
    let steel = section.steel_m2();
    let core_m2 = Confinement::of(input).map_or(0.0, |c| c.core_m[0] * c.core_m[1]);
    let inner = if core_m2 > 0.0 { core_m2 - steel } else { 0.0 };
    let outer = input.area_m2() - steel - inner;
    let force = |strain: f64| {
        let bars = if strain > 0.0 { input.steel.compressed_pa(strain) } else { 0.0 };
        core.stress_pa(strain) * inner + cover.stress_pa(strain) * outer + bars * steel
    };
    (0..=LINE_POINTS)
        .map(|i| until * (i as f64 / LINE_POINTS as f64).powi(2))
        .map(|strain| [strain * length_m, force(strain)])
        .collect()
}

/// Cracking load under uniform strain, `f_t (A + (E_s / E_c - 1) A_s)` \[N\].
pub fn cracking_n(section: &RcSection) -> f64 {
    let ratio = section.input.steel.youngs_modulus_pa / section.concrete.youngs_modulus_pa;
    let (area, steel) = (section.input.area_m2(), section.steel_m2());
    section.concrete.tensile_strength_pa * (area + (ratio - 1.0) * steel)
}

/// Tension of the bars at yield and at their ultimate strain \[N\].
pub fn bars_n(section: &RcSection) -> [f64; 2] {
    let bars = &section.input.steel;
    [bars.yield_strength_pa, bars.monotonic_pa(bars.ultimate_strain)].map(|s| s * section.steel_m2())
}

/// Axial stiffness of a piece, `(E_c A + (E_s - E_c) A_s) / l` \[N/m\].
pub fn stiffness_n_m(section: &RcSection, length_m: f64) -> f64 {
    let (ec, es) = (section.concrete.youngs_modulus_pa, section.input.steel.youngs_modulus_pa);
    (ec * section.input.area_m2() + (es - ec) * section.steel_m2()) / length_m
}
