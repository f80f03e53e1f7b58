//! The submodel of a column end, cut from the elements near it instead of from the whole mesh.

use fallwerk::base::hash::ContentHash;
use fallwerk::building::Building;
use fallwerk::building::ends::member_ends;
use fallwerk::building::partition::Partition;
use fallwerk::fe::mesh::Mesh;
use fallwerk::library::derive::Wanted;
use fallwerk::rc::around::{Surroundings, signature};
use std::collections::BTreeMap;
use std::path::Path;

fn read(name: &str) -> Building {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("buildings").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    fallwerk::building::parse(&text, fallwerk::base::tree::Format::Toml, name).unwrap()
}

#[test]
fn a_column_end_asks_for_the_same_entry_from_the_mesh_around_it() {
    // beams, beams at the perimeter with a wall, and a flat slab
    for name in ["three-storey-frame.toml", "three-storey-frame-wall.toml", "heldout/s2-017.toml"] {
        let building = read(name);
        let partition = Partition::of(&building);
        let (mesh, _) = Mesh::of(&building, building.settings.mesh_size_m);
        let around = Surroundings::of(&mesh);
        let mut keys: BTreeMap<ContentHash, String> = BTreeMap::new();
        let ends = member_ends(&building, &partition);
        let columns: Vec<_> = ends.iter().filter(|e| e.axis == 2).collect();
        assert!(columns.len() > 10);
        for end in columns {
            let near = around.near(&mesh, end).unwrap();
            let local = mesh.piece(&near).0;
            assert!(local.elements.len() < mesh.elements.len() && !local.elements.is_empty());
            let whole = Wanted::of(&building, &partition, &mesh, end).unwrap();
            let own = Wanted::of(&building, &partition, &local, end).unwrap();
            assert_eq!(whole.key().unwrap(), own.key().unwrap(), "{name} {}", end.id);
            // not only the key: the same nodes are held, and the piece is the same to the last number
            assert_eq!(whole.model.mesh.nodes, own.model.mesh.nodes, "{name} {}", end.id);
            assert_eq!(whole.model.mesh.fixed, own.model.mesh.fixed, "{name} {}", end.id);
            assert_eq!(whole.model.tip_nodes, own.model.tip_nodes, "{name} {}", end.id);
            // ends of one signature have one key
            let beyond = end.beyond(&partition).map(|m| building.members[m].kind);
            let signature = signature(&building, &mesh, end, beyond, &near);
            let key = own.key().unwrap();
            assert_eq!(*keys.entry(signature).or_insert_with(|| key.clone()), key, "{name} {}", end.id);
        }
    }
}
