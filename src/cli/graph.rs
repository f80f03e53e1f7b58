//! `fallwerk graph`: the structure graph of a building, its load paths and its elastic demands.

use crate::building::Building;
use crate::graph::demand::StateSummary;
use crate::graph::paths::{charged_members, cut_members};
use crate::graph::{Demands, EndState, Structure, VerticalPath, demands};
use serde_json::json;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::PathBuf;

/// Displacement above which a linear state is no state of the building \[m\]: columns of a storey that lean by a tenth of a radian.
const LINEAR_M: f64 = 0.3;
/// What is said of one that is larger.
const LARGE: &str = " (linear theory means nothing at such displacements: the building falls)";

/// Show members, connections, load paths and elastic demands of a building
///
/// Finds which members touch, what stands on what, what hangs once the charges have gone off, and the
/// linear elastic forces at all member ends before and after, against the capacity of the sections.
/// Exit codes: 0 done, 2 the building cannot be read.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The building file
    pub file: PathBuf,
    /// Print JSON for programs instead of text
    #[arg(long)]
    pub json: bool,
}

/// What the command prints for a building.
pub fn run(arguments: &Arguments, building: &Building) -> String {
    let structure = Structure::of(building);
    let demands = demands(&structure, building);
    if arguments.json {
        format!("{:#}\n", as_json(building, &structure, &demands))
    } else {
        text(building, &structure, &demands)
    }
}

/// Everything as JSON.
fn as_json(building: &Building, structure: &Structure, demands: &Demands) -> serde_json::Value {
    let removed: BTreeSet<usize> = charged_members(building).union(&cut_members(building)).copied().collect();
    let names = |set: &[usize]| set.iter().map(|m| building.members[*m].id.clone()).collect::<Vec<_>>();
    let clusters: Vec<_> = structure
        .storey_bodies()
        .iter()
        .map(|set| json!({ "members": names(set), "mass": structure.mass_of(set) }))
        .collect();
    json!({
        "schema": "fallwerk-graph/1",
        "name": building.name,
        "members": structure.members().collect::<Vec<_>>(),
        "connections": structure.connections().collect::<Vec<_>>(),
        "supports": structure.supports().collect::<Vec<_>>(),
        "ends": structure.ends,
        "near_misses": structure.near_misses,
        "notes": structure.notes,
        "storey_bodies": clusters,
        "removed": names(&removed.iter().copied().collect::<Vec<_>>()),
        "load_paths_after": structure.load_paths(building, &removed),
        "demands": demands,
        "warnings": demands.warnings(building),
    })
}

/// Everything as text. `write!` to a `String` cannot fail.
fn text(building: &Building, structure: &Structure, demands: &Demands) -> String {
    let mut out = format!("{}\n", building.name);
    members(&mut out, structure);
    connections(&mut out, structure);
    bodies(&mut out, building, structure);
    paths(&mut out, building, structure);
    states(&mut out, building, demands);
    out
}

fn members(out: &mut String, structure: &Structure) {
    let _ = writeln!(out, "\nMembers{:>27}{:>12}   centre (m)", "volume (m3)", "mass (t)");
    for member in structure.members() {
        let (m, c) = (&member.mass, member.mass.center_m);
        let _ = writeln!(
            out,
            "  {:<20}{:>12.4}{:>12.3}   {:.3} {:.3} {:.3}",
            member.id,
            m.volume_m3,
            m.mass_kg / 1e3,
            milli(c[0]),
            milli(c[1]),
            milli(c[2])
        );
    }
}

fn connections(out: &mut String, structure: &Structure) {
    let _ = writeln!(out, "\nConnections{:>34}   normal   eccentricity of the first (mm)", "area (m2)");
    for c in structure.connections() {
        let e = c.eccentricity_m[0].map(|v| tenth(v * 1e3));
        let normal = ["x", "y", "z"][c.faces[0].axis];
        let _ = writeln!(
            out,
            "  {:<33}{:>10.4}   {normal:<6}   {:.1} {:.1} {:.1}",
            c.id, c.area_m2, e[0], e[1], e[2]
        );
    }
    let _ = writeln!(out, "\nSupports");
    for support in structure.supports() {
        let _ = writeln!(out, "  {:<33}{:>10.4}", support.id, support.contact.area_m2);
    }
    for miss in &structure.near_misses {
        let [a, b] = &miss.members;
        let axis = ["x", "y", "z"][miss.axis];
        let _ = writeln!(
            out,
            "  warning: {a} and {b} do not touch: a gap of {:.1} mm along {axis}",
            miss.gap_m * 1e3
        );
    }
    for note in &structure.notes {
        let _ = writeln!(out, "  warning: {note}");
    }
}

fn bodies(out: &mut String, building: &Building, structure: &Structure) {
    let _ = writeln!(out, "\nStorey bodies (slabs with the beams that they touch)");
    let all = structure.storey_bodies();
    if all.iter().all(|set| set.len() < 2) {
        let _ = writeln!(out, "  none: no slab touches a beam");
    }
    for set in all.iter().filter(|set| set.len() > 1) {
        let mass = structure.mass_of(set);
        let names: Vec<&str> = set.iter().map(|m| building.members[*m].id.as_str()).collect();
        let c = mass.center_m;
        let _ = writeln!(
            out,
            "  {:.3} t at {:.3} {:.3} {:.3} m: {}",
            mass.mass_kg / 1e3,
            c[0],
            c[1],
            c[2],
            names.join(", ")
        );
    }
}

fn paths(out: &mut String, building: &Building, structure: &Structure) {
    let removed: BTreeSet<usize> = charged_members(building).union(&cut_members(building)).copied().collect();
    if removed.is_empty() {
        return;
    }
    let names: Vec<&str> = removed.iter().map(|m| building.members[*m].id.as_str()).collect();
    let _ = writeln!(out, "\nVertical load paths lost without {}", names.join(", "));
    let intact = structure.load_paths(building, &BTreeSet::new());
    for path in structure.load_paths(building, &removed) {
        if path.vertical == intact[path.member].vertical {
            continue;
        }
        let state = match &path.vertical {
            VerticalPath::Kept => continue,
            VerticalPath::Lost => "lost".to_string(),
            VerticalPath::Partial { lost } => format!("lost at {}", lost.join(", ")),
        };
        let _ =
            writeln!(out, "  {:<20}{state}; connected to {} supports", path.member_id, path.supports.len());
    }
}

fn states(out: &mut String, building: &Building, demands: &Demands) {
    let states = [("before", Some(&demands.before)), ("after", demands.after.as_ref())];
    let _ = writeln!(out, "\nElastic dead-load states");
    for (name, summary) in states.iter().filter_map(|(name, s)| s.map(|s| (name, s))) {
        let line = match summary {
            StateSummary::Equilibrium {
                weight_n,
                reaction_sum_n,
                largest_displacement_m,
                unplaced,
                not_held,
                ..
            } => {
                let rest = if unplaced.is_empty() {
                    String::new()
                } else {
                    format!("; resting on nothing: {}", unplaced.join(", "))
                };
                let rest = if not_held.is_empty() {
                    rest
                } else {
                    format!("; a building beside has no equilibrium, not held: {}{rest}", not_held.join(", "))
                };
                let rest = if *largest_displacement_m > LINEAR_M { format!("{LARGE}{rest}") } else { rest };
                format!(
                    "weight {:.3} kN, supports {:.3} kN, largest displacement {:.2} mm{rest}",
                    weight_n / 1e3,
                    reaction_sum_n[2] / 1e3,
                    largest_displacement_m * 1e3
                )
            }
            StateSummary::Mechanism(mechanism) => format!("no equilibrium; {mechanism}"),
            StateSummary::Failed { reason } => format!("no solution: {reason}"),
        };
        let _ = writeln!(out, "  {name:<8}{line}");
    }
    for warning in demands.warnings(building) {
        let _ = writeln!(out, "  warning: {warning}");
    }
    let _ = writeln!(
        out,
        "\nMember ends: N (compression +), M1, M2; demand/capacity of the reinforced section and of the homogenised law"
    );
    let head = format!("{:>10}{:>10}{:>10}{:>8}{:>8}", "N kN", "M1 kNm", "M2 kNm", "RC", "hom.");
    let _ = writeln!(out, "  {:<20}{head}  |{head}", "");
    for end in &demands.ends {
        let _ = writeln!(
            out,
            "  {:<20}{}  |{}",
            end.id,
            columns(end.before.as_ref()),
            columns(end.after.as_ref())
        );
    }
}

fn columns(state: Option<&EndState>) -> String {
    match state {
        None => format!("{:>10}{:>10}{:>10}{:>8}{:>8}", "-", "-", "-", "-", "-"),
        Some(s) => format!(
            "{:>10.1} {:>9.1} {:>9.1} {:>7.3} {:>7.3}",
            tenth(s.forces.axial_n / 1e3),
            tenth(s.forces.moment_nm[0] / 1e3),
            tenth(s.forces.moment_nm[1] / 1e3),
            s.section.ratio,
            s.homogenised.ratio
        ),
    }
}

/// Rounded to one decimal, without a sign on zero.
fn tenth(value: f64) -> f64 {
    (value * 10.0).round() / 10.0 + 0.0
}

/// Rounded to three decimals, without a sign on zero.
fn milli(value: f64) -> f64 {
    (value * 1e3).round() / 1e3 + 0.0
}
