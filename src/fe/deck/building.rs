//! The FE model of a building as a model that a deck can hold.

use crate::building::Building;
use crate::building::partition::Partition;
use crate::building::tracked::tracked_points;
use crate::fe::mesh::Mesh;
use crate::fe::model::{BodyLoad, ContactSettings, Control, Curve, Model, RigidPlane};
use crate::fe::run::FeOptions;
use crate::fe::weld::{self, Welds};

/// A building's model with what a deck does not say of it.
#[derive(Debug, Clone)]
pub struct BuildingDeck {
    /// The model.
    pub model: Model,
    /// What whoever runs the deck has to know: dead load, contact, charges, obstacles.
    pub comments: Vec<String>,
}

/// Mesh, gravity, ground, contact of the parts and tracked points of a building. Of the options of its FE run mesh size, form of the
/// elements, end time, mass scaling and contact count; the others are of the run, not of the model.
///
/// # Errors
/// If the mesh joins members that stand apart.
pub fn of_building(building: &Building, options: &FeOptions) -> Result<BuildingDeck, Welds> {
    let settings = &building.settings;
    let size_m = options.mesh_size_m.unwrap_or(settings.mesh_size_m);
    let (mut mesh, _) = Mesh::of(building, size_m);
    weld::check(building, &mesh, size_m)?;
    if let Some(form) = options.form {
        mesh.laws.iter_mut().for_each(|law| law.form = form);
    }
    let mut comments = vec![
        "Units: m, kg, s, N, Pa.".to_string(),
        "Gravity acts from the beginning of the run at its full value; fallwerk itself starts a building from its static state under dead load.".into(),
    ];
    // as in the FE run of the building
    let body_contact = options.body_contact.then_some(ContactSettings { friction: building.ground.friction });
    comments.push(match body_contact {
        Some(contact) => {
            format!("The parts touch each other, with the friction of the ground: {}.", contact.friction)
        }
        None => "There is no contact between the parts: they pass through each other.".into(),
    });
    for charge in &building.events {
        let stretch = charge.stretch_m.map_or(String::new(), |[a, b]| format!(", {a} to {b} m along it"));
        comments.push(format!(
            "Charge {}: member {}{stretch} loses its elements at {} s. Not in this deck: give its parts an erosion time (FAILTM of *MAT_ADD_EROSION, on a material of their own).",
            charge.id, charge.member, charge.time_s
        ));
    }
    for obstacle in &building.obstacles {
        comments.push(format!(
            "Obstacle {}: rigid box {:?} to {:?}, friction {}. Not in this deck: give it as *RIGIDWALL_GEOMETRIC_PRISM.",
            obstacle.id, obstacle.solid.min, obstacle.solid.max, obstacle.friction
        ));
    }
    let ground = RigidPlane {
        point_m: [0.0, 0.0, building.ground.level_m],
        normal: [0.0, 0.0, 1.0],
        friction: building.ground.friction,
        nodes: None,
    };
    let control = Control {
        end_time_s: options.end_time_s.unwrap_or(settings.end_time_s),
        mass_scaling_step_s: options.mass_scaling_step_s,
        state_interval_s: settings.output_interval_s,
        history_interval_s: settings.output_interval_s,
        history_nodes: history_nodes(building, &mesh),
        ..Control::default()
    };
    let gravity = BodyLoad { axis: 2, acceleration_m_s2: Curve::constant(-settings.gravity_m_s2) };
    let model = Model {
        title: building.name.clone(),
        mesh,
        body_loads: vec![gravity],
        walls: vec![ground],
        body_contact,
        control,
        ..Model::default()
    };
    Ok(BuildingDeck { model, comments })
}

/// The node of its member nearest to each tracked point.
fn history_nodes(building: &Building, mesh: &Mesh) -> Vec<usize> {
    let nearest = |member: &str, to: [f64; 3]| {
        let part = building.members.iter().position(|m| m.id == member)?;
        let own = mesh.elements.iter().filter(|e| e.part == part).flat_map(|e| e.nodes);
        let distance = |n: &usize| (0..3).map(|i| (mesh.nodes[*n][i] - to[i]).powi(2)).sum::<f64>();
        own.min_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)))
    };
    let mut nodes: Vec<usize> = Vec::new();
    for point in tracked_points(building, &Partition::of(building)) {
        if let Some(node) = nearest(&point.member, point.point_m)
            && !nodes.contains(&node)
        {
            nodes.push(node);
        }
    }
    nodes
}
