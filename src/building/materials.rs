//! Materials and sections of a building file, and what can be wrong with them by themselves.

use super::fields::{Fields, Placed, number_of};
use super::format::{
    BAR, BAR_LAYER, BARS_AROUND, CONCRETE, HOMOGENISED, Kind, MESH, PLATE, RATE_FACTOR, RECTANGLE, STEEL,
    TIES,
};
use super::model::{
    Bar, Concrete, CowperSymonds, HardeningPoint, Homogenised, Material, Section, SectionShape, Steel, Ties,
};
use super::structure::{is_id, list_words};
use crate::base::diagnostic::{Diagnostic, closest, quoted};
use crate::base::source::Span;
use crate::base::tree::Node;
use crate::base::units::{Dimension, show};
use std::collections::BTreeMap;

/// Smallest concrete cover that passes, face to bar surface \[m\]: the least value of EN 1992-1-1, 4.4.1.2.
pub const LEAST_COVER_M: f64 = 0.010;

/// What the file defines under an id; `item.0` is its kind, `item.1` is missing if it has errors.
pub type Defined<T> = BTreeMap<String, Placed<(String, Option<T>)>>;

/// Reads `[materials]`.
pub fn materials(root: &Node, found: &mut Vec<Diagnostic>) -> Defined<Material> {
    let entries = root.get("materials").map_or(&[][..], Node::entries);
    let read = |node: &Node, found: &mut Vec<Diagnostic>| match node.get("kind").and_then(Node::text) {
        Some("concrete") => concrete(Fields { node, table: &CONCRETE }),
        Some("steel") => steel(Fields { node, table: &STEEL }, found),
        Some("homogenised") => homogenised(Fields { node, table: &HOMOGENISED }, found),
        _ => None,
    };
    let define = |entry: &crate::base::tree::Entry| {
        let kind = entry.node.get("kind").and_then(Node::text).unwrap_or_default().to_string();
        let item = (kind, read(&entry.node, found));
        (entry.key.clone(), Placed { item, span: entry.key_span })
    };
    entries.iter().map(define).collect()
}

fn concrete(fields: Fields<'_>) -> Option<Material> {
    Some(Material::Concrete(Concrete {
        density_kg_m3: fields.number("density")?,
        strength_pa: fields.number("strength")?,
        youngs_modulus_pa: fields.number("youngs_modulus")?,
        poisson_ratio: fields.number("poisson_ratio")?,
    }))
}

fn steel(fields: Fields<'_>, found: &mut Vec<Diagnostic>) -> Option<Material> {
    let (yielding, ultimate) = (fields.number("yield_strength"), fields.number("ultimate_strength"));
    if let (Some(yielding), Some(ultimate)) = (yielding, ultimate)
        && ultimate < yielding
    {
        let error = Diagnostic::error("bad-material", "the ultimate strength is below the yield strength")
            .at(fields.span("ultimate_strength"), show(ultimate, Dimension::Stress))
            .also(fields.span("yield_strength"), show(yielding, Dimension::Stress))
            .help("B500B has a yield strength of 500 MPa and an ultimate strength of at least 540 MPa");
        found.push(error);
    }
    Some(Material::Steel(Steel {
        yield_strength_pa: yielding?,
        ultimate_strength_pa: ultimate?,
        ultimate_strain: fields.number("ultimate_strain")?,
        youngs_modulus_pa: fields.number("youngs_modulus")?,
    }))
}

fn homogenised(fields: Fields<'_>, found: &mut Vec<Diagnostic>) -> Option<Material> {
    let hardening = hardening(fields, found);
    let rate_factor = match fields.child("rate_factor") {
        Some(node) => {
            let fields = Fields { node, table: &RATE_FACTOR };
            Some(CowperSymonds { c_1_s: fields.number("c")?, p: fields.number("p")? })
        }
        None => None,
    };
    let critical_principal_strain = match fields.child("critical_principal_strain") {
        Some(_) => Some(fields.number("critical_principal_strain")?),
        None => None,
    };
    Some(Material::Homogenised(Homogenised {
        density_kg_m3: fields.number("density")?,
        youngs_modulus_pa: fields.number("youngs_modulus")?,
        poisson_ratio: fields.number("poisson_ratio")?,
        hardening: hardening?,
        critical_plastic_strain: fields.number("critical_plastic_strain")?,
        rate_factor,
        critical_principal_strain,
    }))
}

fn hardening(fields: Fields<'_>, found: &mut Vec<Diagnostic>) -> Option<Vec<HardeningPoint>> {
    let Kind::List(Kind::Tuple([strain_kind, stress_kind]), ..) = fields.table.key("hardening")?.kind else {
        return None;
    };
    let mut points: Vec<HardeningPoint> = Vec::new();
    let mut complete = true;
    for pair in fields.child("hardening")?.items() {
        let [strain, stress] = pair.items() else { return None };
        let (Some(plastic_strain), Some(stress_pa)) =
            (number_of(strain, strain_kind), number_of(stress, stress_kind))
        else {
            complete = false;
            continue;
        };
        let table = |message: String, span: Span, label: &str| {
            Diagnostic::error("bad-hardening", message).at(span, label)
        };
        match points.last() {
            None if plastic_strain != 0.0 && complete => {
                let message = "the hardening table does not begin at strain 0".to_string();
                found.push(table(message, strain.span, "must be 0: the initial yield stress"));
            }
            Some(last) if plastic_strain <= last.plastic_strain => {
                let message = "the strains of the hardening table do not increase".to_string();
                found.push(table(message, strain.span, &format!("not above {}", last.plastic_strain)));
            }
            _ => {}
        }
        points.push(HardeningPoint { plastic_strain, stress_pa });
    }
    complete.then_some(points)
}

/// Reads `[sections]`.
pub fn sections(root: &Node, materials: &Defined<Material>, found: &mut Vec<Diagnostic>) -> Defined<Section> {
    let mut sections = BTreeMap::new();
    for entry in root.get("sections").map_or(&[][..], Node::entries) {
        let node = &entry.node;
        let kind = node.get("kind").and_then(Node::text).unwrap_or_default();
        let (table, shape) = match kind {
            "rectangle" => (&RECTANGLE, rectangle(Fields { node, table: &RECTANGLE }, entry.key_span, found)),
            "plate" => (&PLATE, plate(Fields { node, table: &PLATE }, found)),
            _ => (&PLATE, None),
        };
        let fields = Fields { node, table };
        let mut material = |key, wanted| material_id(fields, key, wanted, materials, found);
        let (concrete, steel, law) =
            (material("concrete", "concrete"), material("steel", "steel"), material("law", "homogenised"));
        let section = || {
            Some(Section {
                id: entry.key.clone(),
                shape: shape?,
                concrete: concrete?,
                steel: steel?,
                law: law?,
            })
        };
        let item = (kind.to_string(), section());
        sections.insert(entry.key.clone(), Placed { item, span: entry.key_span });
    }
    sections
}

fn material_id(
    fields: Fields<'_>,
    key: &str,
    wanted: &str,
    materials: &Defined<Material>,
    found: &mut Vec<Diagnostic>,
) -> Option<String> {
    let id = fields.node.get(key)?.text()?;
    let of_kind: Vec<&str> = materials
        .iter()
        .filter(|(id, m)| m.item.0 == wanted && is_id(id))
        .map(|(id, _)| id.as_str())
        .collect();
    // A material whose own kind is wrong may be the one that is meant.
    let possible = materials.iter().filter(|(_, m)| m.item.0 == wanted || m.item.1.is_none());
    let possible = possible.filter(|(id, _)| is_id(id));
    let help = || match closest(id, possible.map(|(id, _)| id.as_str())) {
        Some(near) => Some(format!("did you mean `{near}`?")),
        None if of_kind.is_empty() => Some(format!("define one with `kind = \"{wanted}\"`")),
        None => Some(format!("the {wanted} materials of this file are {}", list_words(&of_kind))),
    };
    match materials.get(id) {
        None => {
            let error = Diagnostic::error("unknown-id", format!("there is no material {}", quoted(id)))
                .at(fields.span(key), "not defined")
                .help_if(help());
            found.push(error);
            None
        }
        Some(material)
            if ["concrete", "steel", "homogenised"].contains(&material.item.0.as_str())
                && material.item.0 != wanted =>
        {
            let message = format!(
                "`{key}` needs a {wanted} material, but {} is of kind `{}`",
                quoted(id),
                material.item.0
            );
            let error = Diagnostic::error("wrong-kind", message)
                .at(fields.span(key), "")
                .also(material.span, "defined here")
                .help_if(help());
            found.push(error);
            None
        }
        Some(_) => Some(id.to_string()),
    }
}

fn rectangle(fields: Fields<'_>, header: Span, found: &mut Vec<Diagnostic>) -> Option<SectionShape> {
    let (width_m, depth_m) = (fields.number("width")?, fields.number("depth")?);
    let size = [width_m, depth_m];
    let ties = match fields.child("ties") {
        Some(node) => Some(ties(Fields { node, table: &TIES })?),
        None => None,
    };
    let bars = section_bars(fields, size, ties.map_or(0.0, |t| t.diameter_m), header, found)?;
    Some(SectionShape::Rectangle { width_m, depth_m, bars, ties })
}

/// Bars of a rectangle of `size` \[m\] from the keys `bars_around`, `bar_layers` and `bars`; `header` is where to say that there are none. What
/// lies outside, too near to a face for ties of `tie_diameter` \[m\], or in another bar, is reported.
pub fn section_bars(
    fields: Fields<'_>,
    size: [f64; 2],
    tie_diameter: f64,
    header: Span,
    found: &mut Vec<Diagnostic>,
) -> Option<Vec<Bar>> {
    let mut bars: Vec<Placed<Bar>> = Vec::new();
    if let Some(node) = fields.child("bars_around") {
        let fields = Fields { node, table: &BARS_AROUND };
        check_edge(fields, "edge_distance", size[0].min(size[1]), found);
        let made = around(fields, size)?;
        bars.extend(made.into_iter().map(|item| Placed { item, span: node.span }));
    }
    for node in fields.child("bar_layers").map_or(&[][..], Node::items) {
        let fields = Fields { node, table: &BAR_LAYER };
        check_edge(fields, "edge_distance", size[1], found);
        check_edge(fields, "side_distance", size[0], found);
        let made = layer(fields, size)?;
        bars.extend(made.into_iter().map(|item| Placed { item, span: node.span }));
    }
    for node in fields.child("bars").map_or(&[][..], Node::items) {
        let bar = Fields { node, table: &BAR };
        let item = Bar { x_m: bar.number("x")?, y_m: bar.number("y")?, diameter_m: bar.number("diameter")? };
        bars.push(Placed { item, span: node.span });
    }
    if bars.is_empty() {
        let error = Diagnostic::error("no-bars", "this section has no bars")
            .at(header, "plain concrete is not supported")
            .help("add `bars_around = { per_face = 3, diameter = \"20 mm\", edge_distance = \"50 mm\" }`");
        found.push(error);
    }
    check_bars(&bars, size, tie_diameter, found);
    Some(bars.into_iter().map(|bar| bar.item).collect())
}

fn ties(fields: Fields<'_>) -> Option<Ties> {
    Some(Ties { diameter_m: fields.number("diameter")?, spacing_m: fields.number("spacing")? })
}

/// Evenly spaced positions from `-half` to `half`; one alone sits in the middle.
fn spread(count: usize, half: f64) -> Vec<f64> {
    if count == 1 {
        return vec![0.0];
    }
    let last = (count - 1) as f64;
    // Symmetric to the last bit: both halves are computed from the distance to the middle.
    (0..count).map(|i| half * (2.0 * i as f64 - last) / last).collect()
}

fn around(fields: Fields<'_>, [width, depth]: [f64; 2]) -> Option<Vec<Bar>> {
    let (count, edge) = (fields.count("per_face")?, fields.number("edge_distance")?);
    let diameter_m = fields.number("diameter")?;
    let columns = spread(count, 0.5 * width - edge);
    let rows = spread(count, 0.5 * depth - edge);
    let mut bars = Vec::new();
    for (j, &y_m) in rows.iter().enumerate() {
        for (i, &x_m) in columns.iter().enumerate() {
            if i == 0 || j == 0 || i + 1 == count || j + 1 == count {
                bars.push(Bar { x_m, y_m, diameter_m });
            }
        }
    }
    Some(bars)
}

fn layer(fields: Fields<'_>, [width, depth]: [f64; 2]) -> Option<Vec<Bar>> {
    let edge = fields.number("edge_distance")?;
    let side = fields.number_or("side_distance", edge)?;
    let height = 0.5 * depth - edge;
    let y_m = if fields.text("face")? == "bottom" { -height } else { height };
    let diameter_m = fields.number("diameter")?;
    let positions = spread(fields.count("count")?, 0.5 * width - side);
    Some(positions.into_iter().map(|x_m| Bar { x_m, y_m, diameter_m }).collect())
}

/// A distance from a face that leads past the middle of the section, so that the bars would lie at the other face.
fn check_edge(fields: Fields<'_>, key: &'static str, side_m: f64, found: &mut Vec<Diagnostic>) {
    let Some(distance) = fields.child(key).and_then(|_| fields.number(key)) else { return };
    if distance > 0.5 * side_m {
        let message = format!("`{key}` leads past the middle of the section");
        let error = Diagnostic::error("bar-outside", message)
            .at(fields.span(key), format!("the section is {} there", show(side_m, Dimension::Length)))
            .help(format!(
                "at most {}, measured from the face to the bar centres",
                show(0.5 * side_m, Dimension::Length)
            ));
        found.push(error);
    }
}

/// Bars outside the section, too near to its face, or in each other; one message a place.
fn check_bars(bars: &[Placed<Bar>], size: [f64; 2], tie_diameter: f64, found: &mut Vec<Diagnostic>) {
    let mut reported: Vec<Span> = Vec::new();
    let mut report = |span: Span, error: Diagnostic| {
        if !reported.contains(&span) {
            reported.push(span);
            found.push(error);
        }
    };
    let mm = |value: f64| format!("{:.0} mm", value * 1e3);
    for bar in bars {
        let Bar { x_m, y_m, diameter_m } = bar.item;
        let to_face = (0.5 * size[0] - x_m.abs()).min(0.5 * size[1] - y_m.abs());
        let cover = to_face - 0.5 * diameter_m;
        if cover < -1e-9 {
            let message = format!("the bar at x = {}, y = {} is not inside the section", mm(x_m), mm(y_m));
            let error = Diagnostic::error("bar-outside", message).at(
                bar.span,
                format!("the section is {} x {}, the origin its centre", mm(size[0]), mm(size[1])),
            );
            report(bar.span, error);
        } else if cover - tie_diameter < LEAST_COVER_M - 1e-9 {
            let ties = if tie_diameter > 0.0 { "the ties" } else { "the bars" };
            let needed = LEAST_COVER_M + tie_diameter + 0.5 * diameter_m;
            let message = format!("the cover of {ties} is {}", mm(cover - tie_diameter));
            let error = Diagnostic::error("small-cover", message)
                .at(bar.span, format!("at least {} is needed", mm(LEAST_COVER_M)))
                .help(format!("put the bar centres at least {} from the face", mm(needed)));
            report(bar.span, error);
        }
    }
    for (i, a) in bars.iter().enumerate() {
        for b in &bars[i + 1..] {
            let distance = libm::hypot(a.item.x_m - b.item.x_m, a.item.y_m - b.item.y_m);
            let needed = 0.5 * (a.item.diameter_m + b.item.diameter_m);
            if distance < needed - 1e-9 {
                let message = format!("two bars overlap: their centres are {} apart", mm(distance));
                let mut error = Diagnostic::error("bars-overlap", message)
                    .at(b.span, format!("their surfaces touch at {}", mm(needed)));
                if a.span != b.span {
                    error = error.also(a.span, "the other bar");
                }
                report(b.span, error);
            }
        }
    }
}

fn plate(fields: Fields<'_>, found: &mut Vec<Diagnostic>) -> Option<SectionShape> {
    let thickness_m = fields.number("thickness")?;
    let node = fields.child("mesh")?;
    let mesh = Fields { node, table: &MESH };
    let bar_diameter_m = mesh.number("diameter")?;
    let bar_cover_m = mesh.number("edge_distance")?;
    let cover = bar_cover_m - 0.5 * bar_diameter_m;
    let place = mesh.span("edge_distance");
    if cover < LEAST_COVER_M - 1e-9 {
        let message = format!("the cover of the mesh is {}", show(cover, Dimension::Length));
        let error = Diagnostic::error("small-cover", message)
            .at(place, format!("at least {} is needed", show(LEAST_COVER_M, Dimension::Length)));
        found.push(error);
    }
    // Both directions lie in one layer each; the two faces' meshes must not meet in the middle.
    if bar_cover_m + bar_diameter_m > 0.5 * thickness_m {
        let error = Diagnostic::error("bar-outside", "the meshes of both faces meet in the plate's middle")
            .at(place, format!("the plate is {} thick", show(thickness_m, Dimension::Length)));
        found.push(error);
    }
    Some(SectionShape::Plate {
        thickness_m,
        bar_diameter_m,
        bar_spacing_m: mesh.number("spacing")?,
        bar_cover_m,
    })
}
