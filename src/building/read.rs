//! From a file to a checked building, or to all of its errors.

use super::fields::Placed;
use super::materials::{Defined, materials, sections};
use super::members::{Members, members};
use super::model::{
    Building, Charge, Ground, Material, Obstacle, Override, Preparation, Section, Settings, Support,
};
use super::{check, overrides, plan, storeys, structure};
use crate::base::diagnostic::{Diagnostic, Diagnostics};
use crate::base::source::{Source, Unreadable};
use crate::base::tree::{self, Format, Node};
use std::path::Path;
use std::sync::Arc;

/// What a file holds: the building, unless there are errors, and all messages (also warnings).
#[derive(Debug, Clone)]
pub struct Inspection {
    /// The building; `None` if there is any error.
    pub building: Option<Building>,
    /// Errors and warnings in the order of their places.
    pub diagnostics: Diagnostics,
}

impl Inspection {
    fn into_result(self) -> Result<Building, Diagnostics> {
        self.building.ok_or(self.diagnostics)
    }
}

/// Reads a building file (`.toml` or `.json`).
pub fn read(path: &Path) -> Result<Building, Diagnostics> {
    inspect_file(path).into_result()
}

/// Reads a building from text; `file_name` appears in messages.
pub fn parse(text: &str, format: Format, file_name: &str) -> Result<Building, Diagnostics> {
    inspect(text, format, file_name).into_result()
}

/// Like [`read`], with warnings also when there is no error.
pub fn inspect_file(path: &Path) -> Inspection {
    let unreadable = |problem| Inspection {
        building: None,
        diagnostics: Diagnostics::unreadable(&path.display().to_string(), problem),
    };
    match Source::read(path) {
        Err(problem) => unreadable(problem),
        Ok(source) => match Format::of_path(path) {
            Some(format) => inspect_source(source, format),
            None => unreadable(Unreadable {
                message: "the name ends neither in .toml nor in .json".into(),
                remedy: "rename the file after its format".into(),
            }),
        },
    }
}

/// Like [`parse`], with warnings also when there is no error.
pub fn inspect(text: &str, format: Format, file_name: &str) -> Inspection {
    inspect_source(Source::new(file_name, text), format)
}

fn inspect_source(source: Source, format: Format) -> Inspection {
    let source = Arc::new(source);
    let mut found = Vec::new();
    let building = if source.text.trim().is_empty() {
        let error = Diagnostic::error("empty", "the file is empty")
            .help("`fallwerk init` writes an example to start from");
        found.push(error);
        None
    } else {
        match tree::parse(&source, format) {
            Ok(root) => draft(&root, &mut found).building(),
            Err(errors) => {
                found.extend(errors);
                None
            }
        }
    };
    let diagnostics = Diagnostics::new(source, found);
    let building = building.filter(|_| diagnostics.errors() == 0);
    Inspection { building, diagnostics }
}

/// What could be read of a file, with its places.
#[derive(Default)]
pub struct Draft {
    pub name: Option<String>,
    pub description: String,
    pub materials: Defined<Material>,
    pub sections: Defined<Section>,
    pub members: Members,
    pub supports: Vec<Placed<Support>>,
    pub ground: Option<Ground>,
    pub obstacles: Vec<Placed<Obstacle>>,
    pub preparation: Vec<Placed<Preparation>>,
    pub events: Vec<Placed<Charge>>,
    pub settings: Settings,
    pub overrides: Vec<Placed<Override>>,
}

fn draft(root: &Node, found: &mut Vec<Diagnostic>) -> Draft {
    found.extend(structure::check(root));
    let other_version = found.iter().any(|d| d.code == "schema-version");
    if other_version || !matches!(root.value, tree::Value::Table(_)) {
        return Draft::default();
    }
    let text = |key: &str| root.get(key).and_then(Node::text).map(|t| t.trim().to_string());
    let materials = materials(root, found);
    let sections = sections(root, &materials, found);
    let ground = plan::ground(root);
    let members = members(root, ground.map(|g| g.level_m), &sections, found);
    let mut settings = plan::settings(root, found);
    settings.meshing = plan::meshing(root, &members, settings.mesh_size_m, found);
    let draft = Draft {
        name: text("name"),
        description: text("description").unwrap_or_default(),
        supports: plan::supports(root, &members, found),
        obstacles: plan::obstacles(root, found),
        preparation: plan::preparation(root, &members, found),
        events: plan::events(root, &members, settings.end_time_s, found),
        overrides: overrides::read(root, &members, found),
        materials,
        sections,
        members,
        ground,
        settings,
    };
    check::check(root, &draft, found);
    draft
}

impl Draft {
    /// The building, if everything in it could be read. It may still have errors of meaning.
    pub fn building(&self) -> Option<Building> {
        fn items<T: Clone>(placed: &[Placed<T>]) -> Vec<T> {
            placed.iter().map(|p| p.item.clone()).collect()
        }
        fn defined<T: Clone>(defined: &Defined<T>) -> Option<std::collections::BTreeMap<String, T>> {
            defined.iter().map(|(id, d)| Some((id.clone(), d.item.1.clone()?))).collect()
        }
        let mut members = items(&self.members.list);
        storeys::number(&mut members);
        Some(Building {
            name: self.name.clone()?,
            description: self.description.clone(),
            materials: defined(&self.materials)?,
            sections: defined(&self.sections)?,
            members,
            supports: items(&self.supports),
            ground: self.ground?,
            obstacles: items(&self.obstacles),
            preparation: items(&self.preparation),
            events: items(&self.events),
            settings: self.settings.clone(),
            overrides: items(&self.overrides),
        })
    }
}
