//! Unstructured grids as VTK XML files (`.vtu`) and series of them over time (`.pvd`), as ParaView opens them.
//!
//! Format: "VTK File Formats" (Kitware), XML `UnstructuredGrid`, version 1.0: a head in XML names the arrays and where each begins; their
//! values follow as raw little-endian bytes, each array behind its length in bytes as `UInt64`. Nothing is compressed.

use std::fmt::Write as _;
use std::io::{self, Write};

/// Type of the values of an [`Array`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// 32-bit floating point numbers.
    Float32,
    /// 64-bit floating point numbers.
    Float64,
    /// 32-bit signed integers.
    Int32,
    /// 64-bit signed integers.
    Int64,
    /// Bytes.
    UInt8,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Float32 => "Float32",
            Self::Float64 => "Float64",
            Self::Int32 => "Int32",
            Self::Int64 => "Int64",
            Self::UInt8 => "UInt8",
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::Float32 | Self::Int32 => 4,
            Self::Float64 | Self::Int64 => 8,
            Self::UInt8 => 1,
        }
    }
}

/// Components of a symmetric tensor in the order of VTK.
pub const SYMMETRIC: &[&str] = &["XX", "YY", "ZZ", "XY", "YZ", "XZ"];

/// A named array of tuples.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    name: &'static str,
    kind: Kind,
    components: usize,
    labels: &'static [&'static str],
    bytes: Vec<u8>,
}

impl Array {
    fn of<const N: usize>(
        name: &'static str,
        kind: Kind,
        components: usize,
        values: impl Iterator<Item = [u8; N]>,
    ) -> Self {
        let mut bytes = Vec::with_capacity(N * values.size_hint().0);
        values.for_each(|v| bytes.extend_from_slice(&v));
        Self { name, kind, components, labels: &[], bytes }
    }

    /// Floating point numbers, `components` a tuple. Values are rounded to 32 bits.
    pub fn floats(name: &'static str, components: usize, values: impl Iterator<Item = f64>) -> Self {
        Self::of(name, Kind::Float32, components, values.map(|v| (v as f32).to_le_bytes()))
    }

    /// Floating point numbers of 64 bits.
    pub fn doubles(name: &'static str, components: usize, values: impl Iterator<Item = f64>) -> Self {
        Self::of(name, Kind::Float64, components, values.map(f64::to_le_bytes))
    }

    /// Whole numbers.
    pub fn integers(name: &'static str, values: impl Iterator<Item = i32>) -> Self {
        Self::of(name, Kind::Int32, 1, values.map(i32::to_le_bytes))
    }

    /// Identifiers, which may need more than 32 bits.
    pub fn identifiers(name: &'static str, values: impl Iterator<Item = i64>) -> Self {
        Self::of(name, Kind::Int64, 1, values.map(i64::to_le_bytes))
    }

    /// Symmetric tensors, components in the order of [`SYMMETRIC`].
    pub fn tensors(name: &'static str, values: impl Iterator<Item = [f64; 6]>) -> Self {
        Self { labels: SYMMETRIC, ..Self::floats(name, 6, values.flatten()) }
    }

    /// Number of tuples.
    pub fn tuples(&self) -> usize {
        self.bytes.len() / (self.components * self.kind.bytes())
    }

    /// The line of the head that names the array, whose bytes begin at `offset` of the appended data.
    fn tag(&self, offset: usize, field: bool, head: &mut String) {
        let _ = write!(head, "        <DataArray type=\"{}\" Name=\"{}\"", self.kind.name(), self.name);
        let _ = write!(head, " NumberOfComponents=\"{}\"", self.components);
        if field {
            let _ = write!(head, " NumberOfTuples=\"{}\"", self.tuples());
        }
        for (i, label) in self.labels.iter().enumerate() {
            let _ = write!(head, " ComponentName{i}=\"{label}\"");
        }
        let _ = writeln!(head, " format=\"appended\" offset=\"{offset}\"/>");
    }
}

/// Cells by type, in the order in which they are added.
#[derive(Debug, Clone, Default)]
pub struct Cells {
    nodes: Vec<i32>,
    ends: Vec<i32>,
    types: Vec<u8>,
}

impl Cells {
    /// Type of a vertex.
    pub const VERTEX: u8 = 1;
    /// Type of a straight line between two points.
    pub const LINE: u8 = 3;
    /// Type of a hexahedron: bottom face counter-clockwise seen from above, then top face.
    pub const HEXAHEDRON: u8 = 12;

    /// Adds a cell.
    pub fn push(&mut self, kind: u8, nodes: &[usize]) {
        self.nodes.extend(nodes.iter().map(|n| *n as i32));
        self.ends.push(self.nodes.len() as i32);
        self.types.push(kind);
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.types.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.types.is_empty()
    }
}

/// A grid at one time.
#[derive(Debug, Clone)]
pub struct UnstructuredGrid {
    /// Time \[s\], shown by viewers.
    pub time_s: f64,
    /// Point positions, three components \[m\].
    pub points: Array,
    /// Cells.
    pub cells: Cells,
    /// Values at points.
    pub point_data: Vec<Array>,
    /// Values of cells.
    pub cell_data: Vec<Array>,
}

impl UnstructuredGrid {
    /// Writes the file.
    ///
    /// # Errors
    /// As `out` reports them.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let time = Array::doubles("TimeValue", 1, std::iter::once(self.time_s));
        let cells = [
            Array::integers("connectivity", self.cells.nodes.iter().copied()),
            Array::integers("offsets", self.cells.ends.iter().copied()),
            Array::of("types", Kind::UInt8, 1, self.cells.types.iter().map(|t| [*t])),
        ];
        let mut head = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <UnstructuredGrid>\n",
        );
        let groups: [(&str, Vec<&Array>); 5] = [
            ("FieldData", vec![&time]),
            ("PointData", self.point_data.iter().collect()),
            ("CellData", self.cell_data.iter().collect()),
            ("Points", vec![&self.points]),
            ("Cells", cells.iter().collect()),
        ];
        let mut offset = 0;
        for (name, arrays) in &groups {
            let _ = writeln!(head, "      <{name}>");
            for array in arrays {
                array.tag(offset, *name == "FieldData", &mut head);
                offset += 8 + array.bytes.len();
            }
            let _ = writeln!(head, "      </{name}>");
            if *name == "FieldData" {
                let (points, count) = (self.points.tuples(), self.cells.len());
                let _ = writeln!(head, "    <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{count}\">");
            }
        }
        head.push_str("    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_");
        out.write_all(head.as_bytes())?;
        for array in groups.iter().flat_map(|(_, arrays)| arrays) {
            out.write_all(&(array.bytes.len() as u64).to_le_bytes())?;
            out.write_all(&array.bytes)?;
        }
        out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
    }

    /// Length of all arrays \[bytes\], a little less than that of the file.
    pub fn bytes(&self) -> usize {
        let data = self.point_data.iter().chain(&self.cell_data);
        let cells = 4 * (self.cells.nodes.len() + self.cells.ends.len()) + self.cells.types.len();
        self.points.bytes.len() + data.map(|a| a.bytes.len()).sum::<usize>() + cells
    }
}

/// The text of a `.pvd` file: the files of a series with their times \[s\]. File names must need no escapes in XML.
pub fn collection(files: impl Iterator<Item = (f64, String)>) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n",
    );
    for (time_s, file) in files {
        let _ = writeln!(text, "    <DataSet timestep=\"{time_s}\" group=\"\" part=\"0\" file=\"{file}\"/>");
    }
    text.push_str("  </Collection>\n</VTKFile>\n");
    text
}
