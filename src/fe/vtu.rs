//! The mesh over time for ParaView: what acts at each output, with the fields that show how a building comes down.

use super::deck::Ids;
use super::dynamics::Dynamics;
use super::hexahedron::{frame, to_patterns};
use super::mesh::Mesh;
use crate::base::hash::ContentHash;
use crate::base::output::write_renamed;
use crate::base::vector::{V3, add, dot, scale};
use crate::base::vtu::{Array, Cells, UnstructuredGrid, collection};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the file that ParaView opens.
pub const COLLECTION: &str = "collapse.pvd";
/// Folder of the grids beside it.
pub const FOLDER: &str = "vtu";

/// The state of a run at an output.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// Number of the output, 0 for the dead-load state.
    pub output: usize,
    /// Time \[s\].
    pub time_s: f64,
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The state.
    pub body: &'a Dynamics,
    /// Node positions from which displacements count: those under dead load \[m\].
    pub start_m: &'a [[f64; 3]],
    /// Equivalent strain rate of each element over the output interval that ends here \[1/s\].
    pub strain_rates_1_s: &'a [f32],
}

/// A frame that lies on disk.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WrittenFrame {
    /// Number of the output.
    pub output: usize,
    /// Time \[s\].
    pub time_s: f64,
    /// blake3 hash of the file.
    pub hash: [u8; 32],
}

/// Takes the states of a run as they come; nothing of them is kept in memory by the run.
pub trait FrameSink: Send {
    /// Takes an output. The message of an error says what could not be written where.
    ///
    /// # Errors
    /// If it cannot be written; the run then stops.
    fn frame(&mut self, frame: &Frame<'_>) -> Result<(), String>;

    /// What was written so far, for a checkpoint.
    fn written(&self) -> &[WrittenFrame];

    /// A run goes on behind these frames.
    ///
    /// # Errors
    /// If one is missing or is not the one that was written.
    fn resume(&mut self, mesh: &Mesh, written: Vec<WrittenFrame>) -> Result<(), String>;

    /// Takes every this many outputs. A run that is gone on with must have the same.
    fn every(&self) -> usize;
}

/// What a cell stands for, by its index in the mesh.
#[derive(Debug, Clone, Copy, Default)]
enum Shown {
    #[default]
    Debris,
    Solid(usize),
    Bar(usize),
}

/// Values of a cell.
#[derive(Debug, Clone, Copy, Default)]
struct CellState {
    part: usize,
    shown: Shown,
    plastic_strain: f64,
    strain_rate_1_s: f64,
    stress_pa: [f64; 6],
    internal_j: f64,
    hourglass_share: f64,
}

/// The grid of what acts: hexahedra, bars, and as vertices nodes with mass all whose elements have died. Points are all nodes in
/// the order of the mesh, so that a point has the same number in every frame. Nodes, elements, bars and parts have their `ids` if a deck gives them any.
pub fn grid(frame: &Frame<'_>, ids: Option<&Ids>) -> UnstructuredGrid {
    let (mesh, body) = (frame.mesh, frame.body);
    let (mut cells, mut states) = (Cells::default(), Vec::new());
    let mut held = vec![false; mesh.nodes.len()];
    for (index, element) in mesh.elements.iter().enumerate() {
        if body.blocks.share(index) > 0.0 {
            cells.push(Cells::HEXAHEDRON, &element.nodes);
            states.push(hexahedron(frame, index));
            element.nodes.iter().for_each(|n| held[*n] = true);
        }
    }
    for (index, bar) in mesh.trusses.iter().enumerate() {
        if let Some(state) = bar_state(frame, index) {
            cells.push(Cells::LINE, &bar.nodes);
            states.push(state);
            bar.nodes.iter().for_each(|n| held[*n] = true);
        }
    }
    for node in (0..held.len()).filter(|n| !held[*n] && body.mass_kg[*n] > 0.0) {
        let owner = body.blocks.elements_at(node).next();
        cells.push(Cells::VERTEX, &[node]);
        let part = owner.map_or(0, |e| mesh.elements[e].part);
        states.push(CellState { part, ..CellState::default() });
    }
    let moved = body.x.iter().zip(frame.start_m).flat_map(|(x, x0)| (0..3).map(move |i| x[i] - x0[i]));
    let field = |name, of: fn(&CellState) -> f64| Array::floats(name, 1, states.iter().map(of));
    let [part, element] = names(&states, ids);
    let node = ids.map(|ids| Array::identifiers("node", ids.nodes.iter().map(|id| *id as i64)));
    let floats = [
        Array::floats("displacement_m", 3, moved),
        Array::floats("velocity_m_s", 3, body.v.as_flattened().iter().copied()),
    ];
    UnstructuredGrid {
        time_s: frame.time_s,
        points: Array::floats("Points", 3, body.x.as_flattened().iter().copied()),
        point_data: floats.into_iter().chain(node).collect(),
        cell_data: vec![
            field("plastic_strain", |s| s.plastic_strain),
            field("strain_rate_1_s", |s| s.strain_rate_1_s),
            field("mises_pa", |s| mises(&s.stress_pa)),
            Array::tensors("stress_pa", states.iter().map(|s| s.stress_pa)),
            part,
            field("internal_energy_j", |s| s.internal_j),
            field("hourglass_share", |s| s.hourglass_share),
            element,
        ],
        cells,
    }
}

/// Part and element of the cells: indices, bars having none, or identifiers.
fn names(states: &[CellState], ids: Option<&Ids>) -> [Array; 2] {
    let Some(ids) = ids else {
        let element = |s: &CellState| if let Shown::Solid(index) = s.shown { index as i32 } else { -1 };
        return [
            Array::integers("part", states.iter().map(|s| s.part as i32)),
            Array::integers("element", states.iter().map(element)),
        ];
    };
    let element = |s: &CellState| match s.shown {
        Shown::Solid(index) => ids.elements[index] as i64,
        Shown::Bar(index) => ids.trusses[index] as i64,
        Shown::Debris => -1,
    };
    [
        Array::identifiers("part", states.iter().map(|s| ids.parts[s.part] as i64)),
        Array::identifiers("element", states.iter().map(element)),
    ]
}

fn hexahedron(frame: &Frame<'_>, index: usize) -> CellState {
    let (block, lane) = frame.body.blocks.of_element(index);
    let state = &block.state;
    let (internal_j, hourglass_j) = (state.internal_j[lane], state.hourglass_j[lane]);
    CellState {
        part: frame.mesh.elements[index].part,
        shown: Shown::Solid(index),
        plastic_strain: state.plastic_strain[lane],
        strain_rate_1_s: f64::from(frame.strain_rates_1_s[index]),
        stress_pa: global_stress(frame, index, &state.stress.map(|s| s[lane])),
        internal_j,
        hourglass_share: if internal_j > 0.0 { hourglass_j / internal_j } else { 0.0 },
    }
}

/// State of a bar, its axial stress as a tensor; `None` once it has broken.
fn bar_state(frame: &Frame<'_>, index: usize) -> Option<CellState> {
    let bar = frame.body.trusses.bars.get(index).filter(|b| b.acts)?;
    let [a, b] = bar.nodes.map(|n| frame.body.x[n]);
    let along: V3 = std::array::from_fn(|i| b[i] - a[i]);
    let length = dot(along, along).sqrt();
    let [x, y, z] = along.map(|c| c / length);
    Some(CellState {
        part: frame.mesh.trusses[index].part,
        shown: Shown::Bar(index),
        plastic_strain: bar.plastic_strain,
        stress_pa: [x * x, y * y, z * z, x * y, y * z, z * x].map(|c| c * bar.stress_pa),
        internal_j: bar.internal_j,
        ..CellState::default()
    })
}

/// Stress in global axes from that in the element's frame, both xx, yy, zz, xy, yz, zx \[Pa\]. The frame is that of the kernel: from the
/// directions ξ and η at the current nodes.
fn global_stress(at: &Frame<'_>, index: usize, local: &[f64; 6]) -> [f64; 6] {
    let nodes = at.mesh.elements[index].nodes.map(|n| at.body.x[n]);
    let (mut xi, mut eta) = ([0.0; 3], [0.0; 3]);
    for i in 0..3 {
        let patterns = to_patterns(nodes.map(|n| n[i]));
        (xi[i], eta[i]) = (patterns[0], patterns[1]);
    }
    turned(local, &frame(xi, eta))
}

/// `Rᵀ σ R` of a symmetric tensor, `R` having the rows of a frame.
fn turned(local: &[f64; 6], rows: &[V3; 3]) -> [f64; 6] {
    let [xx, yy, zz, xy, yz, zx] = *local;
    let full = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let half: [V3; 3] =
        full.map(|r| add(add(scale(r[0], rows[0]), scale(r[1], rows[1])), scale(r[2], rows[2])));
    let entry = |i: usize, j: usize| (0..3).map(|a| rows[a][i] * half[a][j]).sum();
    [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)]
}

/// Von Mises stress `sqrt(3/2 s:s)`.
fn mises(s: &[f64; 6]) -> f64 {
    let normal = (s[0] - s[1]).powi(2) + (s[1] - s[2]).powi(2) + (s[2] - s[0]).powi(2);
    (0.5 * normal + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])).sqrt()
}

/// A series of grids in a result folder: `collapse.pvd`, `vtu/frame-00000.vtu`, ..., `vtu/parts.csv`.
#[derive(Debug)]
pub struct VtuSeries {
    folder: PathBuf,
    every: usize,
    /// What a deck calls its elements and parts.
    ids: Option<Ids>,
    /// A folder with the grids of the first part of a run.
    older: Option<PathBuf>,
    written: Vec<WrittenFrame>,
}

impl VtuSeries {
    /// A series in this folder of every `every` outputs (at least 1).
    pub fn new(folder: &Path, every: usize) -> Self {
        Self {
            folder: folder.to_path_buf(),
            every: every.max(1),
            ids: None,
            older: None,
            written: Vec::new(),
        }
    }

    /// Names elements, bars and parts as a deck does, in the place of their indices.
    pub fn by_ids(self, ids: &Ids) -> Self {
        Self { ids: Some(ids.clone()), ..self }
    }

    /// Names a finished result folder: a run that goes on behind its end takes the grids from there.
    pub fn after(self, folder: &Path) -> Self {
        Self { older: Some(folder.to_path_buf()), ..self }
    }

    /// Number of grids written so far.
    pub fn len(&self) -> usize {
        self.written.len()
    }

    /// Whether none was written yet.
    pub fn is_empty(&self) -> bool {
        self.written.is_empty()
    }

    fn file(output: usize) -> String {
        format!("{FOLDER}/frame-{output:05}.vtu")
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), String> {
        let path = self.folder.join(name);
        write_renamed(&path, bytes).map_err(|e| format!("cannot write {}: {e}", path.display()))
    }

    fn put_collection(&self) -> Result<(), String> {
        let files = self.written.iter().map(|frame| (frame.time_s, Self::file(frame.output)));
        self.put(COLLECTION, collection(files).as_bytes())
    }

    /// Whether a frame lies in the folder as it was written; it may be taken from a finished result folder.
    fn has(&self, frame: &WrittenFrame) -> bool {
        let file = Self::file(frame.output);
        let is_it = |bytes: &Vec<u8>| ContentHash::of_bytes(bytes).as_bytes() == &frame.hash;
        if fs::read(self.folder.join(&file)).is_ok_and(|bytes| is_it(&bytes)) {
            return true;
        }
        let older = self.older.as_ref().and_then(|older| fs::read(older.join(&file)).ok()).filter(is_it);
        older.is_some_and(|bytes| self.put(&file, &bytes).is_ok())
    }

    /// Removes grids that a run wrote after the checkpoint from which it is gone on.
    fn clear_later(&self) -> Result<(), String> {
        let folder = self.folder.join(FOLDER);
        let words = |e: std::io::Error| format!("{}: {e}", folder.display());
        for item in fs::read_dir(&folder).map_err(words)? {
            let path = item.map_err(words)?.path();
            let known = self.written.iter().any(|frame| self.folder.join(Self::file(frame.output)) == path);
            if !known && path.extension().is_some_and(|e| e == "vtu") {
                fs::remove_file(&path).map_err(words)?;
            }
        }
        Ok(())
    }

    fn begin(&self, mesh: &Mesh) -> Result<(), String> {
        let folder = self.folder.join(FOLDER);
        fs::create_dir_all(&folder).map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
        let mut legend = csv::Writer::from_writer(Vec::new());
        let all = |e: csv::Error| e.to_string();
        legend.write_record(["part", "name"]).map_err(all)?;
        for (index, name) in mesh.parts.iter().enumerate() {
            let part = self.ids.as_ref().map_or(index as u64, |ids| ids.parts[index]);
            legend.write_record([&part.to_string(), name]).map_err(all)?;
        }
        let legend = legend.into_inner().map_err(|e| e.to_string())?;
        self.put(&format!("{FOLDER}/parts.csv"), &legend)
    }
}

impl FrameSink for VtuSeries {
    fn frame(&mut self, frame: &Frame<'_>) -> Result<(), String> {
        if !frame.output.is_multiple_of(self.every) {
            return Ok(());
        }
        if self.written.is_empty() {
            self.begin(frame.mesh)?;
        }
        let grid = grid(frame, self.ids.as_ref());
        let mut bytes = Vec::with_capacity(grid.bytes() + 4096);
        grid.write(&mut bytes).map_err(|e| e.to_string())?;
        self.put(&Self::file(frame.output), &bytes)?;
        let hash = *ContentHash::of_bytes(&bytes).as_bytes();
        self.written.push(WrittenFrame { output: frame.output, time_s: frame.time_s, hash });
        self.put_collection()
    }

    fn written(&self) -> &[WrittenFrame] {
        &self.written
    }

    fn resume(&mut self, mesh: &Mesh, written: Vec<WrittenFrame>) -> Result<(), String> {
        self.begin(mesh)?;
        self.written = written;
        let missing: Vec<&WrittenFrame> = self.written.iter().filter(|frame| !self.has(frame)).collect();
        let Some(first) = missing.first() else {
            self.clear_later()?;
            return self.put_collection();
        };
        Err(format!(
            "{} of the {} grids before the checkpoint are missing or changed in {}, the first is {}; give the result folder of the first part with --output, or run from the start",
            missing.len(),
            self.written.len(),
            self.folder.display(),
            Self::file(first.output)
        ))
    }

    fn every(&self) -> usize {
        self.every
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_stress_keeps_its_invariants_and_follows_its_axis() {
        let rows = frame([1.0, 2.0, -0.5], [0.3, 1.0, 4.0]);
        let uniaxial = turned(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0], &rows);
        let n = rows[0];
        let expected =
            [n[0] * n[0], n[1] * n[1], n[2] * n[2], n[0] * n[1], n[1] * n[2], n[2] * n[0]].map(|v| 5.0 * v);
        for (a, b) in uniaxial.iter().zip(expected) {
            assert!((a - b).abs() < 1e-14, "{uniaxial:?} {expected:?}");
        }
        let local = [1.0, -2.0, 3.0, 0.5, 4.0, -1.5];
        assert!((mises(&turned(&local, &rows)) - mises(&local)).abs() < 1e-13);
    }
}
