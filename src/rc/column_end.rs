//! A section of the submodel from a building's column end.

use super::section_file::RcSection;
use crate::building::ends::member_ends;
use crate::building::partition::Partition;
use crate::building::{Building, Material, MemberKind, Steel};
use crate::material::concrete::ConcreteLaw;
use crate::material::fibre::{FibreOptions, SectionInput};
use crate::material::rebar::{Buckling, Hardening, LoopShape, RebarLaw};

impl RcSection {
    /// The end `id` (such as `C1-A1.bottom`) of a column: its section, its materials with the strengths of the file, and half its clear
    /// height as the length.
    ///
    /// # Errors
    /// In words with the remedy, if there is no such end, or its section has no bars.
    pub fn of_column_end(building: &Building, id: &str) -> Result<Self, String> {
        let partition = Partition::of(building);
        let ends = member_ends(building, &partition);
        let is_column = |m: usize| building.members[m].kind == MemberKind::Column;
        let Some(end) = ends.iter().find(|e| e.id == id && is_column(e.member)) else {
            let known: Vec<&str> =
                ends.iter().filter(|e| is_column(e.member)).map(|e| e.id.as_str()).collect();
            let help = match crate::base::diagnostic::closest(id, known.iter().copied()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("ends are named like `{}`", known.first().unwrap_or(&"C1-A1.bottom")),
            };
            return Err(format!("there is no column end `{id}`\n  = help: {help}"));
        };
        let section = &building.sections[&building.members[end.member].section];
        let (Material::Concrete(concrete), Material::Steel(steel)) =
            (&building.materials[&section.concrete], &building.materials[&section.steel])
        else {
            return Err(format!("the section `{}` names no concrete and steel", section.id));
        };
        let law = ConcreteLaw {
            youngs_modulus_pa: concrete.youngs_modulus_pa,
            poisson_ratio: concrete.poisson_ratio,
            density_kg_m3: concrete.density_kg_m3,
            ..ConcreteLaw::of_strength(concrete.strength_pa)
        };
        law.check().map_err(|e| format!("{e}\n  = help: correct the concrete `{}`", section.concrete))?;
        let options = FibreOptions { deduct_bars: true, history: true };
        let input =
            SectionInput::of_building(section, concrete, bars_of(steel), steel.yield_strength_pa, options);
        let mut input = input.ok_or_else(|| {
            format!(
                "the section `{}` of {id} has no bars\n  = help: the submodel needs a reinforced rectangle",
                section.id
            )
        })?;
        let thin = input.bars.iter().map(|b| b.diameter_m).fold(f64::INFINITY, f64::min);
        let steel = input.steel;
        input.steel.buckling = input.ties.map(|t| Buckling::between_ties(t.spacing_m, thin, &steel));
        Ok(Self {
            name: format!("{} {id}", building.name),
            member: MemberKind::Column,
            input,
            concrete: law,
            length_m: 0.5 * end.clear_m,
            anchorage: None,
        })
    }
}

/// Bars of a building's steel, with a straight line of hardening to its ultimate strength.
fn bars_of(steel: &Steel) -> RebarLaw {
    let yield_strain = steel.yield_strength_pa / steel.youngs_modulus_pa;
    let slope =
        (steel.ultimate_strength_pa - steel.yield_strength_pa) / (steel.ultimate_strain - yield_strain);
    RebarLaw {
        youngs_modulus_pa: steel.youngs_modulus_pa,
        yield_strength_pa: steel.yield_strength_pa,
        hardening: Hardening::Bilinear { ratio: slope.max(0.0) / steel.youngs_modulus_pa },
        ultimate_strain: steel.ultimate_strain,
        loops: LoopShape::default(),
        buckling: None,
    }
}
