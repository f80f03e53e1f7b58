//! `fallwerk check`: reads a building file and says what is in it, or all that is wrong with it.

use super::{Outcome, colour_on_stderr, print};
use crate::base::diagnostic::Diagnostic;
use crate::building::partition::Partition;
use crate::building::{Building, Inspection, MemberKind, inspect_file};
use crate::fe::apart::tied_members;
use crate::fe::mesh::Mesh;
use crate::fe::quality::{Quality, sliver_note};
use crate::fe::tie::left_out_notes;
use crate::fe::weld;
use serde_json::json;
use std::path::PathBuf;

/// Check a building file: all errors at once, or a summary
///
/// Reads a building (.toml or .json) and reports every error with its line, what was found there and
/// what would be right. If there is none, prints members by kind, volume and mass.
/// Exit codes: 0 the file is good (warnings do not count), 1 it has errors, 2 it cannot be read.
#[derive(clap::Args)]
pub struct Arguments {
    /// The building file
    file: PathBuf,
    /// Also make the FE mesh and show its quality
    #[arg(long)]
    mesh: bool,
    /// Print JSON for programs instead of text
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Outcome {
    let mut inspection = inspect_file(&arguments.file);
    let quality = inspection.building.as_ref().filter(|_| arguments.mesh).and_then(|building| {
        let (quality, error) = mesh_quality(building);
        error.into_iter().for_each(|e| inspection.diagnostics.add(e));
        quality
    });
    let unreadable = inspection.diagnostics.items().iter().any(|d| d.code == "unreadable");
    let outcome = match inspection.building {
        Some(_) if inspection.diagnostics.errors() == 0 => Outcome::Done,
        None if unreadable => Outcome::BadInput,
        _ => Outcome::CheckFailed,
    };
    if arguments.json {
        print(&format!("{:#}\n", as_json(&inspection, quality)));
        return outcome;
    }
    if !inspection.diagnostics.items().is_empty() {
        eprint!("{}", inspection.diagnostics.render(colour_on_stderr()));
    }
    if let Some(building) = &inspection.building {
        print(&summary(building));
        if let Some((quality, notes)) = quality {
            print(&mesh_words(&quality, &notes));
        }
    }
    outcome
}

/// Number, volume \[m³\] and mass \[kg\] of the members of one kind.
struct Share {
    kind: &'static str,
    count: usize,
    volume_m3: f64,
    mass_kg: f64,
}

fn shares(building: &Building) -> Vec<Share> {
    let volumes = Partition::of(building).volumes(building.members.len());
    let kinds = [
        (MemberKind::Column, "columns"),
        (MemberKind::Beam, "beams"),
        (MemberKind::Slab, "slabs"),
        (MemberKind::Wall, "walls"),
        (MemberKind::Footing, "footings"),
        (MemberKind::Brace, "braces"),
    ];
    let share = |(kind, name)| {
        let mut share = Share { kind: name, count: 0, volume_m3: 0.0, mass_kg: 0.0 };
        for (member, volume) in building.members.iter().zip(&volumes).filter(|(m, _)| m.kind == kind) {
            share.count += 1;
            share.volume_m3 += volume;
            share.mass_kg += volume * building.law_of(member).density_kg_m3;
        }
        share
    };
    kinds.into_iter().map(share).filter(|s| s.count > 0).collect()
}

fn summary(building: &Building) -> String {
    let shares = shares(building);
    let mut text = format!("{}\n", building.name);
    // all of these words have an `s` for many
    let word = |many: &'static str, count| if count == 1 { many.trim_end_matches('s') } else { many };
    for share in &shares {
        text += &format!(
            "  {:4} {:10} {:9.3} m3 {:9.2} t\n",
            share.count,
            word(share.kind, share.count),
            share.volume_m3,
            share.mass_kg / 1e3
        );
    }
    let total = |of: fn(&Share) -> f64| shares.iter().map(of).sum::<f64>();
    text += &format!(
        "  {:4} {:10} {:9.3} m3 {:9.2} t\n",
        building.members.len(),
        word("members", building.members.len()),
        total(|s| s.volume_m3),
        total(|s| s.mass_kg) / 1e3
    );
    text += &format!(
        "  supports: {}, obstacles: {}, preparations: {}, events: {}\n",
        building.supports.len(),
        building.obstacles.len(),
        building.preparation.len(),
        building.events.len()
    );
    text
}

/// Quality of the building's mesh with remarks on it, and what makes it useless.
fn mesh_quality(building: &Building) -> (Option<(Quality, Vec<String>)>, Option<Diagnostic>) {
    let size_m = building.settings.mesh_size_m;
    let (mesh, snapped) = Mesh::of(building, size_m);
    let welded = weld::check(building, &mesh, size_m).err();
    let error = welded.map(|w| Diagnostic::error("closed-gap", w.problem()).help(w.remedy()));
    let Some(quality) = Quality::of(&mesh, &snapped) else { return (None, error) };
    let mut notes: Vec<String> = sliver_note(building, &quality, size_m).into_iter().collect();
    notes.extend(left_out_notes(&mesh));
    let tied = tied_members(building, &mesh);
    if !tied.is_empty() {
        notes.push(format!("tied with a mesh of their own: {}", tied.join(", ")));
    }
    (Some((quality, notes)), error)
}

fn mesh_words(quality: &Quality, notes: &[String]) -> String {
    let mut text = format!("  {} elements; {}\n", quality.all.elements, quality.line());
    let [low, high] = quality.volume_ratio;
    text += &format!(
        "  warpage up to {:.1} deg, real over meshed volume {low:.3} to {high:.3}, tied nodes: {}\n",
        quality.all.warpage_deg, quality.tied_nodes
    );
    let mut parts: Vec<_> = quality.parts.iter().collect();
    parts.sort_by(|a, b| a.1.step_s.total_cmp(&b.1.step_s));
    for (id, part) in parts.iter().take(5) {
        text += &format!(
            "    {id:16} {:6} elements, edges {:.3} to {:.3} m, step {:.4} ms\n",
            part.elements,
            part.edge_m[0],
            part.edge_m[1],
            1e3 * part.step_s
        );
    }
    notes.iter().for_each(|note| text += &format!("  note: {note}\n"));
    text
}

fn as_json(inspection: &Inspection, quality: Option<(Quality, Vec<String>)>) -> serde_json::Value {
    let summary = inspection.building.as_ref().map(|building| {
        let shares = shares(building);
        let kinds: Vec<_> = shares
            .iter()
            .map(|s| json!({ "kind": s.kind, "count": s.count, "volume_m3": s.volume_m3, "mass_kg": s.mass_kg }))
            .collect();
        json!({
            "name": building.name,
            "members": kinds,
            "volume_m3": shares.iter().map(|s| s.volume_m3).sum::<f64>(),
            "mass_kg": shares.iter().map(|s| s.mass_kg).sum::<f64>(),
            "supports": building.supports.len(),
            "obstacles": building.obstacles.len(),
            "preparation": building.preparation.len(),
            "events": building.events.len(),
        })
    });
    let mut value = json!({
        "ok": inspection.building.is_some() && inspection.diagnostics.errors() == 0,
        "summary": summary,
        "diagnostics": inspection.diagnostics.to_json(),
    });
    if let Some((quality, notes)) = quality {
        value["mesh"] = json!(quality);
        value["mesh"]["notes"] = json!(notes);
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tree::Format;
    use crate::building::{EXAMPLE, Member, parse};

    #[test]
    fn one_member_is_no_members() {
        let mut building = parse(EXAMPLE, Format::Toml, "example.toml").unwrap();
        assert!(summary(&building).contains("12 columns "));
        let is_column = |m: &Member| m.kind == MemberKind::Column;
        let column = building.members.iter().position(is_column).unwrap();
        building.members = vec![building.members[column].clone()];
        let text = summary(&building);
        assert!(text.contains("   1 column  ") && text.contains("   1 member  "), "{text}");
    }
}
