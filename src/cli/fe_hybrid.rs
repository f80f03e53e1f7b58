//! `fallwerk fe --hybrid`: options, words and files of a run with rigid parts.

use super::knowledge::{self, KnowledgeArgs, Switch};
use super::verdict::percent;
use super::{Failure, study};
use crate::base::units::in_table;
use crate::building::Building;
use crate::fe::hybrid::{HybridRecord, HybridSettings, Reason};
use crate::fe::mesh::Mesh;
use crate::generate::{Accuracy, Derive, Wishes, generate, rigid_elements};
use crate::study::{self as studies, Study};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// Value of `--hybrid` without one.
const AUTO: &str = "auto";
/// The value for the partition that rules make.
const RULES: &str = "rules";
/// What is told of a run whose rigid parts may not deform again.
pub(super) const STAYS_RIGID: &str = "switching is off: what has become rigid stays so whatever meets or loads it, which is for comparison only";

/// Options of rigid parts.
#[derive(clap::Args)]
pub(super) struct Options {
    /// Move parts that do not deform as rigid bodies: those that become quiet while it runs (auto), those that are rigid bodies by
    /// the rules (rules), or those that a study found rigid (a record of `fallwerk study`); they deform again where contact or
    /// their loads ask for it
    #[arg(long, value_name = "auto|rules|STUDY", num_args = 0..=1, default_missing_value = AUTO, require_equals = true)]
    hybrid: Option<String>,
    /// Strain rate in 1/s below which parts become rigid [default: 0.025]
    #[arg(long, value_name = "RATE", requires = "hybrid", allow_negative_numbers = true)]
    rigid_rate: Option<f64>,
    /// Time in seconds for which they have to be that quiet [default: 0.02]
    #[arg(long, value_name = "S", requires = "hybrid", allow_negative_numbers = true)]
    rigid_after: Option<f64>,
    /// Time in seconds after a charge for which nothing begins to count as quiet [default: 0.15]
    #[arg(long, value_name = "S", requires = "hybrid", allow_negative_numbers = true)]
    rigid_settle: Option<f64>,
    /// Time in seconds between two checks of the loads on rigid parts [default: 0.008]
    #[arg(long, value_name = "S", requires = "hybrid", allow_negative_numbers = true)]
    rigid_check: Option<f64>,
    /// Plastic strain that these loads may not cause in a rigid part [default: 0.0002]
    #[arg(long, value_name = "STRAIN", requires = "hybrid", allow_negative_numbers = true)]
    rigid_overload: Option<f64>,
    /// Rings of elements that deform again around a contact, a flowing or an overloaded element [default: 2]
    #[arg(long, value_name = "N", requires = "hybrid")]
    rigid_rings: Option<usize>,
    /// Whether rigid parts deform again where contact, flow beside them or their loads ask for it; off: for comparison only, what has become rigid stays so
    #[arg(long, value_enum, default_value = "on", requires = "hybrid")]
    rigid_switching: Switch,
}

impl Options {
    /// Whether rigid parts are asked for.
    pub(super) fn is_given(&self) -> bool {
        self.hybrid.is_some()
    }

    /// The settings, if rigid parts are asked for.
    pub(super) fn settings(
        &self,
        building: &Building,
        mesh_size_m: Option<f64>,
        knowledge: &KnowledgeArgs,
    ) -> Result<Option<HybridSettings>, Failure> {
        let Some(partition) = &self.hybrid else { return Ok(None) };
        let default = HybridSettings::default();
        let rigid_from_start = if partition == AUTO {
            None
        } else if partition == RULES {
            Some(of_rules(building, mesh_size_m, knowledge)?)
        } else {
            let study = study::read(Path::new(partition)).map_err(|why| {
                let record = "give auto, rules, or a record that `fallwerk study run` wrote";
                Failure::input(format!("--hybrid={partition}: {}; {record}", why.message))
            })?;
            let (mesh, _) = Mesh::of(building, mesh_size_m.unwrap_or(building.settings.mesh_size_m));
            Some(of_study(partition, &study, building, &mesh)?)
        };
        Ok(Some(HybridSettings {
            rate_1_s: self.rigid_rate.unwrap_or(default.rate_1_s),
            quiet_s: self.rigid_after.unwrap_or(default.quiet_s),
            settle_s: self.rigid_settle.unwrap_or(default.settle_s),
            check_s: self.rigid_check.unwrap_or(default.check_s),
            overload_strain: self.rigid_overload.unwrap_or(default.overload_strain),
            rings: self.rigid_rings.unwrap_or(default.rings),
            rigid_from_start,
            softens: self.rigid_switching == Switch::On,
            ..default
        }))
    }
}

/// The elements that are parts of rigid bodies in the model with the fewest bodies that the rules make.
fn of_rules(
    building: &Building,
    mesh_size_m: Option<f64>,
    knowledge: &KnowledgeArgs,
) -> Result<Vec<bool>, Failure> {
    let rules = knowledge::rules(knowledge.rules.as_deref())?;
    let mut store = knowledge::library(knowledge.library.as_deref(), false)?;
    let wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Fast };
    let generated = generate(building, &rules, &mut store, wishes, &|_| {})
        .map_err(|e| Failure::input(format!("--hybrid=rules: {e}")))?;
    let (mesh, _) = Mesh::of(building, mesh_size_m.unwrap_or(building.settings.mesh_size_m));
    Ok(rigid_elements(building, &mesh, &generated.model))
}

/// The elements that a study found rigid; it has to be one of this building.
fn of_study(path: &str, study: &Study, building: &Building, mesh: &Mesh) -> Result<Vec<bool>, Failure> {
    let known = |id: &String| building.members.iter().any(|m| m.id == *id);
    let members =
        study.facts.members.iter().map(|m| &m.member).chain(study.facts.ends.iter().map(|e| &e.member));
    match members.into_iter().find(|id| !known(id)) {
        Some(id) => Err(Failure::input(format!(
            "--hybrid={path}: the study is of `{}`, whose member `{id}` is not in `{}`; run `fallwerk study run` with this building",
            study.building, building.name
        ))),
        None => Ok(studies::rigid_elements(building, mesh, &study.facts)),
    }
}

/// The word for a reason.
fn word(reason: Reason) -> &'static str {
    match reason {
        Reason::Quiet => "quiet",
        Reason::Contact => "contact",
        Reason::Flow => "flow",
        Reason::Overload => "overload",
        Reason::Remnant => "remnant",
        Reason::Charge => "charge",
        Reason::Asked => "asked",
    }
}

/// Switches and elements that switched, by reason.
fn by_reason(hybrid: &HybridRecord) -> BTreeMap<Reason, [usize; 2]> {
    let mut counts = BTreeMap::new();
    for switch in &hybrid.switches {
        let [switches, elements] = counts.entry(switch.reason).or_insert([0, 0]);
        *switches += 1;
        *elements += switch.elements;
    }
    counts
}

/// The summary in words.
pub(super) fn words(hybrid: &HybridRecord) -> String {
    let mean = hybrid.rigid_share.iter().sum::<f64>() / hybrid.rigid_share.len().max(1) as f64;
    let mut text = format!(
        "  rigid parts: {} of the elements in the mean, {} of the element work left out; switches changed the energy by {:.2} kJ\n",
        percent(mean),
        percent(hybrid.skipped_share),
        1e-3 * hybrid.switched_j.last().copied().unwrap_or(0.0)
    );
    for (reason, [switches, elements]) in by_reason(hybrid) {
        let _ = writeln!(text, "    {}: {switches} switches of {elements} elements", word(reason));
    }
    let _ =
        writeln!(text, "    checks of their loads: {}, factorisations: {}", hybrid.checks, hybrid.factors);
    text
}

/// The summary as JSON.
pub(super) fn json(hybrid: &HybridRecord) -> Value {
    json!({
        "rigid_share": hybrid.rigid_share,
        "skipped_share": hybrid.skipped_share,
        "switched_j": hybrid.switched_j.last(),
        "switches": hybrid.switches.len(),
        "checks": hybrid.checks,
        "factors": hybrid.factors,
    })
}

/// The partition over time.
pub(super) fn partition_csv(times_s: &[f64], hybrid: &HybridRecord) -> String {
    let mut text = String::from("time_s,rigid_share,sets,switched_j\n");
    for (i, time_s) in times_s.iter().enumerate() {
        let (share, sets, switched_j) = (hybrid.rigid_share[i], hybrid.sets[i], hybrid.switched_j[i]);
        let _ = writeln!(text, "{},{share},{sets},{switched_j}", in_table(*time_s));
    }
    text
}

/// All switches.
pub(super) fn switches_csv(hybrid: &HybridRecord) -> String {
    let mut text = String::from("time_s,to,reason,elements,rigid,sets,energy_j\n");
    for s in &hybrid.switches {
        let to = if matches!(s.reason, Reason::Quiet) { "rigid" } else { "deformable" };
        let reason = word(s.reason);
        let _ =
            writeln!(text, "{},{to},{reason},{},{},{},{}", s.time_s, s.elements, s.rigid, s.sets, s.energy_j);
    }
    text
}
