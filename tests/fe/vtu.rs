//! Grids for viewers, read back by a reader that knows nothing of the writer.

use super::mesh::{bilinear, distort, elastic, grid, ground};
use fallwerk::base::vtu::collection;
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::deck::{DeckOptions, Ids, parse};
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::kernel::KernelStep;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::vtu::{self, Frame, FrameSink, VtuSeries};
use std::collections::BTreeMap;

/// An array as it stands in a file.
struct Read {
    kind: String,
    components: usize,
    bytes: Vec<u8>,
}

impl Read {
    fn floats(&self) -> Vec<f64> {
        assert_eq!(self.kind, "Float32");
        self.bytes.chunks(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect()
    }

    fn integers(&self) -> Vec<i32> {
        assert_eq!(self.kind, "Int32");
        self.bytes.chunks(4).map(|b| i32::from_le_bytes(b.try_into().unwrap())).collect()
    }

    fn identifiers(&self) -> Vec<i64> {
        assert_eq!(self.kind, "Int64");
        self.bytes.chunks(8).map(|b| i64::from_le_bytes(b.try_into().unwrap())).collect()
    }
}

/// A file: number of points and cells, arrays by name, the group in which each stands.
struct File {
    points: usize,
    cells: usize,
    arrays: BTreeMap<String, Read>,
    group: BTreeMap<String, String>,
}

fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    let key = format!(" {name}=\"");
    let begin = tag.find(&key).unwrap_or_else(|| panic!("no {name} in {tag}")) + key.len();
    tag[begin..].split('"').next().unwrap()
}

/// Reads a file by the published format; every byte of the appended data must belong to exactly one array.
fn read(bytes: &[u8]) -> File {
    let marker = b"<AppendedData encoding=\"raw\">";
    let at = bytes.windows(marker.len()).position(|w| w == marker).unwrap();
    let head = std::str::from_utf8(&bytes[..at]).unwrap();
    let begin = at + marker.len() + bytes[at + marker.len()..].iter().position(|b| *b == b'_').unwrap() + 1;
    let data = &bytes[begin..];
    assert!(head.contains("byte_order=\"LittleEndian\"") && head.contains("header_type=\"UInt64\""));
    let (mut arrays, mut group, mut open) = (BTreeMap::new(), BTreeMap::new(), Vec::<&str>::new());
    let (mut points, mut cells, mut used) = (0, 0, 0);
    for tag in head.split('<').skip(2).map(|t| t.split('>').next().unwrap()) {
        let name = tag.split([' ', '/']).find(|w| !w.is_empty()).unwrap();
        match (tag.starts_with('/'), tag.ends_with('/')) {
            (true, _) => assert_eq!(open.pop(), Some(name)),
            (_, false) => open.push(name),
            _ => {}
        }
        if name == "Piece" && !tag.starts_with('/') {
            points = attribute(tag, "NumberOfPoints").parse().unwrap();
            cells = attribute(tag, "NumberOfCells").parse().unwrap();
        }
        if name == "DataArray" {
            let offset: usize = attribute(tag, "offset").parse().unwrap();
            assert_eq!(offset, used, "arrays follow one another: {tag}");
            let length = u64::from_le_bytes(data[offset..offset + 8].try_into().unwrap()) as usize;
            used = offset + 8 + length;
            let key = attribute(tag, "Name").to_string();
            group.insert(key.clone(), open.last().unwrap().to_string());
            let kind = attribute(tag, "type").to_string();
            let components = attribute(tag, "NumberOfComponents").parse().unwrap();
            arrays.insert(key, Read { kind, components, bytes: data[offset + 8..used].to_vec() });
        }
    }
    assert_eq!(&data[used..], b"\n  </AppendedData>\n</VTKFile>\n");
    assert_eq!(open, ["VTKFile"], "all but the file is closed");
    File { points, cells, arrays, group }
}

impl File {
    fn of(frame: &Frame<'_>) -> Self {
        Self::by_ids(frame, None)
    }

    fn by_ids(frame: &Frame<'_>, ids: Option<&Ids>) -> Self {
        let mut bytes = Vec::new();
        vtu::grid(frame, ids).write(&mut bytes).unwrap();
        let file = read(&bytes);
        for (name, array) in &file.arrays {
            let width = match &array.kind[..] {
                "UInt8" => 1,
                "Int64" => 8,
                _ => 4,
            };
            let size = width * array.components;
            match file.group[name].as_str() {
                "PointData" | "Points" => assert_eq!(array.bytes.len(), size * file.points, "{name}"),
                "CellData" => assert_eq!(array.bytes.len(), size * file.cells, "{name}"),
                _ => {}
            }
        }
        file
    }

    fn floats(&self, name: &str) -> Vec<f64> {
        self.arrays[name].floats()
    }

    /// Cells as type and nodes.
    fn cells(&self) -> Vec<(u8, Vec<usize>)> {
        let nodes = self.arrays["connectivity"].integers();
        let ends = self.arrays["offsets"].integers();
        let types = &self.arrays["types"].bytes;
        assert_eq!((types.len(), ends.len()), (self.cells, self.cells));
        assert_eq!(ends.last().copied().unwrap_or(0) as usize, nodes.len());
        let mut from = 0;
        let mut cells = Vec::new();
        for (end, kind) in ends.iter().zip(types) {
            let own = nodes[from..*end as usize].iter().map(|n| *n as usize).collect::<Vec<_>>();
            assert!(own.iter().all(|n| *n < self.points));
            cells.push((*kind, own));
            from = *end as usize;
        }
        cells
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// Volume of a hexahedron as six tetrahedra around the diagonal 0-6.
fn volume(p: &[[f64; 3]]) -> f64 {
    let tetrahedra = [[1, 2], [2, 3], [3, 7], [7, 4], [4, 5], [5, 1]];
    let triple = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        (0..3)
            .map(|i| a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3]))
            .sum::<f64>()
    };
    let edge = minus(p[6], p[0]);
    tetrahedra.iter().map(|[a, b]| triple(minus(p[*a], p[0]), minus(p[*b], p[0]), edge) / 6.0).sum()
}

fn frame<'a>(mesh: &'a Mesh, body: &'a Dynamics, rates: &'a [f32]) -> Frame<'a> {
    let start_m = &mesh.nodes;
    Frame { output: 3, time_s: body.time_s, mesh, body, start_m, strain_rates_1_s: rates }
}

/// A turned block under a known uniform stress: the stress field is in global axes, cells fill the volume.
#[test]
fn stress_is_global_and_cells_fill_the_volume() {
    let mut mesh = grid([2, 3, 4], [0.6, 0.9, 1.2], elastic(), |_| false);
    // turn the mesh 30 degrees about z: element frames no longer are the global one
    let (s, c) = (0.5, 0.75f64.sqrt());
    mesh.nodes.iter_mut().for_each(|p| *p = [c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]]);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let strain = 1e-5;
    for (v, x) in body.v.iter_mut().zip(&mesh.nodes) {
        *v = [strain * x[0] / body.dt_s, 0.0, 0.0];
    }
    body.v[5][2] = 1e-7; // one more, to tell the components of velocity apart
    body.step(false);
    body.update_elements(KernelStep { dt_s: body.dt_s, viscous: false }, body.dt_s); // at the positions reached
    let rates: Vec<f32> = (0..24).map(|e| e as f32).collect();
    let file = File::of(&frame(&mesh, &body, &rates));
    assert_eq!((file.points, file.cells), (60, 24));
    assert_eq!(file.arrays["TimeValue"].bytes, body.time_s.to_le_bytes());
    let (e, nu) = (30e9, 0.2);
    let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let expected = [lambda + e / (1.0 + nu), lambda, lambda, 0.0, 0.0, 0.0].map(|m| m * strain);
    let stress = file.floats("stress_pa");
    for cell in stress.chunks(6) {
        for (a, b) in cell.iter().zip(expected) {
            assert!((a - b).abs() < 1e-4 * expected[0], "{cell:?} {expected:?}");
        }
    }
    assert!((file.floats("mises_pa")[7] / (e / (1.0 + nu) * strain) - 1.0).abs() < 1e-3);
    let points: Vec<[f64; 3]> = file.floats("Points").chunks(3).map(|p| p.try_into().unwrap()).collect();
    let cells = file.cells();
    let total: f64 = cells
        .iter()
        .map(|(kind, nodes)| {
            assert_eq!((*kind, nodes.len()), (12, 8));
            let v = volume(&nodes.iter().map(|n| points[*n]).collect::<Vec<_>>());
            assert!((v / 0.027 - 1.0).abs() < 1e-4);
            v
        })
        .sum();
    assert!((total / 0.648 - 1.0).abs() < 2e-5, "{total}");
    assert_eq!(file.floats("strain_rate_1_s"), (0..24).map(f64::from).collect::<Vec<_>>());
    assert_eq!(file.arrays["element"].integers(), (0..24).collect::<Vec<_>>());
    for (n, u) in file.floats("displacement_m").chunks(3).enumerate() {
        assert!((u[0] - strain * mesh.nodes[n][0]).abs() < 1e-10, "{n} {u:?}");
        assert_eq!([u[1] as f32, u[2] as f32], [1, 2].map(|i| (body.x[n][i] - mesh.nodes[n][i]) as f32));
    }
    let v = file.floats("velocity_m_s");
    for i in 0..3 {
        assert_eq!(v[3 * 5 + i] as f32, body.v[5][i] as f32);
    }
}

/// Eroded elements are left out; nodes that nothing holds any more are vertices; removed mass is neither.
#[test]
fn only_what_acts_is_shown() {
    let mut law = bilinear(30e9, 0.2, 2500.0, 2e6, 0.0);
    law.erosion.plastic_strain = 0.02;
    let mut mesh = grid([3, 3, 6], [0.3, 0.3, 0.6], law, |_| false);
    distort(&mut mesh.nodes, 0.003, 9, |_| true);
    let mut body = Dynamics::new(&mesh, 9.81, ground(-0.001, 0.5), false);
    body.v.iter_mut().for_each(|v| *v = [0.0, 0.0, -25.0]);
    let mut dead = std::collections::BTreeSet::new();
    while dead.len() < 12 && body.steps < 4000 {
        body.step(false);
        dead.extend(body.deaths.iter().map(|d| d.0));
    }
    let rates = vec![0.0; mesh.elements.len()];
    assert!(dead.len() >= 12 && dead.len() < mesh.elements.len(), "{}", dead.len());
    let held: std::collections::BTreeSet<usize> =
        (0..mesh.elements.len()).filter(|e| !dead.contains(e)).flat_map(|e| mesh.elements[e].nodes).collect();
    let check = |body: &Dynamics, gone: &[usize]| {
        let file = File::of(&frame(&mesh, body, &rates));
        let cells = file.cells();
        let shown: Vec<i32> = file.arrays["element"].integers();
        let solid: Vec<i32> = shown.iter().copied().filter(|e| *e >= 0).collect();
        let alive = |e: &usize| !dead.contains(e);
        assert_eq!(solid, (0..mesh.elements.len()).filter(alive).map(|e| e as i32).collect::<Vec<_>>());
        let free: Vec<usize> =
            cells.iter().filter(|(kind, _)| *kind == 1).map(|(_, nodes)| nodes[0]).collect();
        let expected: Vec<usize> =
            (0..mesh.nodes.len()).filter(|n| !held.contains(n) && !gone.contains(n)).collect();
        assert_eq!(free, expected);
        let strain = file.floats("plastic_strain");
        for (cell, e) in shown.iter().enumerate().filter(|(_, e)| **e >= 0) {
            assert_eq!(strain[cell] as f32, body.blocks.plastic_strain(*e as usize) as f32);
        }
        free
    };
    let free = check(&body, &[]);
    assert!(!free.is_empty());
    body.mass_kg[free[0]] = 0.0;
    check(&body, &free[..1]);
}

#[test]
fn a_series_is_listed_and_gone_on_with_only_if_it_is_whole() {
    let room = tempfile::tempdir().unwrap();
    let mesh = grid([1, 1, 1], [1.0; 3], elastic(), |_| false);
    let body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let rates = [0.0];
    let mut series = VtuSeries::new(room.path(), 2);
    let at = |output: usize| Frame { output, time_s: 0.25 * output as f64, ..frame(&mesh, &body, &rates) };
    for output in 0..=5 {
        series.frame(&at(output)).unwrap();
    }
    let list = std::fs::read_to_string(room.path().join("collapse.pvd")).unwrap();
    let sets: Vec<(f64, String)> = list
        .split("<DataSet")
        .skip(1)
        .map(|tag| (attribute(tag, "timestep").parse().unwrap(), attribute(tag, "file").to_string()))
        .collect();
    assert_eq!(sets.iter().map(|s| s.0).collect::<Vec<_>>(), [0.0, 0.5, 1.0]);
    assert_eq!(list, collection(sets.iter().cloned()));
    for (_, file) in &sets {
        let file = read(&std::fs::read(room.path().join(file)).unwrap());
        assert_eq!((file.points, file.cells), (8, 1));
    }
    let legend = std::fs::read_to_string(room.path().join("vtu/parts.csv")).unwrap();
    assert_eq!(legend, "part,name\n0,body\n");
    // gone on with behind output 3: the grid of output 4 goes, those before must be the ones that were written
    let written = series.written()[..2].to_vec();
    let mut next = VtuSeries::new(room.path(), 2);
    next.resume(&mesh, written.clone()).unwrap();
    assert!(!room.path().join(&sets[2].1).exists() && room.path().join(&sets[1].1).exists());
    let elsewhere = tempfile::tempdir().unwrap();
    let mut moved = VtuSeries::new(elsewhere.path(), 2).after(room.path());
    moved.resume(&mesh, written.clone()).unwrap();
    assert!(elsewhere.path().join(&sets[1].1).exists());
    std::fs::write(room.path().join(&sets[1].1), "changed").unwrap();
    let error = VtuSeries::new(room.path(), 2).resume(&mesh, written).unwrap_err();
    assert!(error.contains("1 of the 2") && error.contains("frame-00002.vtu"), "{error}");
}

/// The elements of a deck are sorted by law, those of a part that comes first in the deck first; grids name them as the deck does.
#[test]
fn grids_of_decks_have_its_identifiers() {
    const DECK: &str = "*KEYWORD\n*CONTROL_TERMINATION\n1.0\n*PART\nslab, \"left\" 3,4\n20,1,20,0,1\n*PART\nother\n30,1,30,0,1\n\
        *PART\nbars\n5,2,5\n*SECTION_SOLID\n1,1\n*SECTION_BEAM\n2,3\n1e-4\n*HOURGLASS\n1,6,1.0\n\
        *MAT_ELASTIC\n20,2500.,3e10,0.2\n*MAT_ELASTIC\n30,2000.,3e10,0.2\n*MAT_ELASTIC\n5,7800.,2e11,0.3\n\
        *NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n9,0,0,2\n10,1,0,2\n11,1,1,2\n13,0,1,2\n\
        *ELEMENT_SOLID\n100,30,1,2,3,4,5,6,7,8\n114,20,5,6,7,8,9,10,11,13\n*ELEMENT_BEAM\n7,5,1,9\n*END\n";
    let deck = parse(DECK, "ids.k", DeckOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let mesh = &deck.model.mesh;
    let mut body = Dynamics::new(mesh, 0.0, RigidSurfaces::default(), false);
    let rates = [0.0; 2];
    let of = |body: &Dynamics| {
        let file = File::by_ids(&frame(mesh, body, &rates), Some(&deck.ids));
        assert_eq!(
            file.arrays["node"].identifiers(),
            deck.ids.nodes.iter().map(|id| *id as i64).collect::<Vec<_>>()
        );
        ["part", "element"].map(|name| file.arrays[name].identifiers())
    };
    // not those of their order
    assert_eq!((deck.ids.nodes[0], deck.ids.nodes[11]), (1, 13));
    assert_eq!(of(&body), [[20, 30, 5], [114, 100, 7]]);
    let room = tempfile::tempdir().unwrap();
    VtuSeries::new(room.path(), 1).by_ids(&deck.ids).frame(&frame(mesh, &body, &rates)).unwrap();
    let legend = std::fs::read_to_string(room.path().join("vtu/parts.csv")).unwrap();
    assert_eq!(legend, "part,name\n20,\"slab, \"\"left\"\" 3,4\"\n30,other\n5,bars\n");
    // the outer nodes of an element that has died are debris, four of them in no other element; the bar holds one
    body.blocks.set_share(0, 0.0);
    assert_eq!(of(&body), [[30, 5, 20, 20, 20], [100, 7, -1, -1, -1]]);
}
