//! Elements that are rigid by the rules, and by a study, for FE runs with rigid parts.

use super::*;
use fallwerk::fe::mesh::Mesh;
use fallwerk::generate::rigid_elements;
use fallwerk::study::{self, Study};

fn mesh(building: &Building) -> Mesh {
    Mesh::of(building, building.settings.mesh_size_m).0
}

/// Share of the elements of a member that are rigid.
fn share(mesh: &Mesh, rigid: &[bool], member: &str) -> f64 {
    let part = mesh.parts.iter().position(|p| p == member).unwrap();
    let own: Vec<bool> =
        (0..rigid.len()).filter(|e| mesh.elements[*e].part == part).map(|e| rigid[e]).collect();
    own.iter().filter(|r| **r).count() as f64 / own.len() as f64
}

#[test]
fn bodies_of_the_model_are_rigid_up_to_their_hinges() {
    let building = reference(|t| t);
    let (rules, mut store, _cache) = knowledge();
    let mut rigid = |accuracy| {
        let wishes = Wishes { derive: Derive::Similar, accuracy };
        let model = generate(&building, &rules, &mut store, wishes, &|_| {}).unwrap().model;
        rigid_elements(&building, &mesh(&building), &model)
    };
    let mesh = mesh(&building);
    let fast = rigid(Accuracy::Fast);
    assert_eq!(fast.len(), mesh.elements.len());
    // floors whole, columns between the zones at their ends
    assert_eq!((share(&mesh, &fast, "S1"), share(&mesh, &fast, "B2-A1-B1")), (1.0, 1.0));
    let column = share(&mesh, &fast, "C2-A2");
    assert!((0.3..0.8).contains(&column), "{column}");
    for end in fallwerk::building::ends::member_ends(&building, &Partition::of(&building)) {
        if end.id.starts_with("C2-A2.") {
            let zone: Vec<usize> = study::end_zone(&mesh, &end).collect();
            assert!(!zone.is_empty() && zone.iter().all(|e| !fast[*e]), "{}", end.id);
        }
    }
    // where floors bend, they deform
    let balanced = rigid(Accuracy::Balanced);
    assert_eq!(share(&mesh, &balanced, "S1"), 0.0);
    assert_eq!(share(&mesh, &balanced, "C2-A2"), column);
}

#[test]
fn what_a_study_found_quiet_is_rigid() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
    let study: Study = serde_json::from_str(&read("kb/studies/s1-003.json")).unwrap();
    let building = parse(&read("kb/plan/s1-003.toml"), Format::Toml, "s1-003").unwrap();
    let mesh = mesh(&building);
    let rigid = study::rigid_elements(&building, &mesh, &study.facts);
    let (mut still, mut zones) = (0, 0);
    for end in fallwerk::building::ends::member_ends(&building, &Partition::of(&building)) {
        let zone = study.facts.ends.iter().find(|z| z.id == end.id);
        let quiet = zone.is_some_and(|z| z.first_s.is_none());
        still += usize::from(quiet);
        zones += usize::from(!quiet);
        assert!(study::end_zone(&mesh, &end).all(|e| rigid[e] == quiet), "{}", end.id);
    }
    assert!(zones > 10, "{zones} ends with zones, {still} without");
}
