//! The building file of a scene.

use super::{Beams, Scene, milli};
use crate::building::{BayRange, column_id};
use std::fmt::Write;

/// Simulated time after the last charge \[s\], and more for each storey.
const END_S: [f64; 2] = [2.0, 0.2];

impl Scene {
    /// The building file, TOML.
    pub fn toml(&self) -> String {
        let what = if self.small {
            format!("Building {} of `fallwerk bench buildings --seed {}`", self.number, self.seed)
        } else {
            let option = if self.without.is_empty() { "" } else { " --irregular" };
            format!(
                "Scene {} of the plan with seed {} (`fallwerk study plan{option}`)",
                self.number, self.seed
            )
        };
        let mut text = format!(
            "# {what}; for keys and units see `three-storey-frame.toml`.\n\nschema = 1\nname = \"{}\"\n",
            self.name()
        );
        self.materials(&mut text);
        self.sections(&mut text);
        self.members(&mut text);
        self.surroundings(&mut text);
        self.demolition(&mut text);
        text
    }

    fn materials(&self, text: &mut String) {
        let sizes = &self.sizes;
        let stress = |factor: f64| 1e3 * (factor * sizes.yield_pa * 1e-3).round();
        let _ = write!(
            text,
            "
[materials.C30]
kind = \"concrete\"
density = 2500
strength = \"30 MPa\"
youngs_modulus = \"33 GPa\"
poisson_ratio = 0.2

[materials.B500]
kind = \"steel\"
yield_strength = \"500 MPa\"
ultimate_strength = \"540 MPa\"
ultimate_strain = 0.05
youngs_modulus = \"200 GPa\"

[materials.RC]
kind = \"homogenised\"
density = 2500
youngs_modulus = \"16.5 GPa\"
poisson_ratio = 0.2
hardening = [[0, {:e}], [0.01, {:e}], [0.1, {:e}]]
critical_plastic_strain = {}
",
            stress(1.0),
            stress(1.1),
            stress(7.0 / 6.0),
            sizes.critical_strain
        );
    }

    fn sections(&self, text: &mut String) {
        let s = &self.sizes;
        let [column, beam, slab] = [s.column_m, s.beam_m, s.slab_m].map(mm);
        let common = "concrete = \"C30\"\nsteel = \"B500\"\nlaw = \"RC\"";
        let ties = "ties = { diameter = \"8 mm\", spacing = \"150 mm\" }";
        let bars = |name: &str, depth: f64, bars: &str| {
            format!(
                "\n[sections.{name}]\nkind = \"rectangle\"\n{common}\nwidth = \"{column} mm\"\ndepth = \"{depth} mm\"\n{bars}\n{ties}\n"
            )
        };
        let edge = "edge_distance = \"50 mm\"";
        let (per_face, diameter) = (s.bars.0, mm(s.bars.1));
        let around =
            format!("bars_around = {{ per_face = {per_face}, diameter = \"{diameter} mm\", {edge} }}");
        text.push_str(&bars("column", column, &around));
        if self.beams != Beams::None {
            let layer = |face: &str| {
                format!("{{ face = \"{face}\", count = {}, diameter = \"20 mm\", {edge} }}", s.beam_bars)
            };
            let layers = format!("bar_layers = [{}, {}]", layer("bottom"), layer("top"));
            text.push_str(&bars("beam", beam, &layers));
        }
        let mesh = "mesh = { diameter = \"10 mm\", spacing = \"150 mm\", edge_distance = \"30 mm\" }";
        let plate = |name: &str, thickness: f64| {
            format!(
                "\n[sections.{name}]\nkind = \"plate\"\n{common}\nthickness = \"{thickness} mm\"\n{mesh}\n"
            )
        };
        text.push_str(&plate("slab", slab));
        if self.has_wall {
            text.push_str(&plate("wall", mm(self.wall_m())));
        }
    }

    fn members(&self, text: &mut String) {
        let list = |values: &[f64]| format!("{values:?}");
        let _ = write!(
            text,
            "\n[grid]\nx = {}\ny = {}\nstorey_heights = {}\ncolumn_section = \"column\"\nbeams = \"{}\"\nslab_section = \"slab\"\nslab_overhang = {}\n",
            list(&self.axes_m[0]),
            list(&self.axes_m[1]),
            list(&self.heights_m),
            self.beams.name(),
            milli(0.5 * self.sizes.column_m)
        );
        if self.beams != Beams::None {
            text.push_str("beam_section = \"beam\"\n");
        }
        if !self.without.is_empty() {
            let point = |[i, j]: [usize; 2]| format!("[{}, {}]", self.axes_m[0][i], self.axes_m[1][j]);
            let out = |[a, b]: &BayRange| format!("{{ from = {}, to = {} }}", point(*a), point(*b));
            let _ = writeln!(
                text,
                "without_bays = [{}]",
                self.without.iter().map(out).collect::<Vec<_>>().join(", ")
            );
        }
        if self.has_opening {
            let around = |axes: &[f64]| {
                let [a, b] = [axes[axes.len() - 2], axes[axes.len() - 1]];
                [milli(a + 0.3 * (b - a)), milli(a + 0.7 * (b - a))]
            };
            let [[x0, x1], [y0, y1]] = [around(&self.axes_m[0]), around(&self.axes_m[1])];
            let _ = writeln!(text, "slab_openings = [{{ from = [{x0}, {y0}], to = [{x1}, {y1}] }}]");
        }
        if self.has_wall {
            self.walls(text);
        }
        text.push_str("\n[[supports]]\nmembers = [\"C1-*\"");
        if self.has_wall {
            text.push_str(", \"W1\"");
        }
        text.push_str("]\nface = \"bottom\"\nkind = \"clamped\"\n");
    }

    /// A wall in the first bay of the rear axis through all storeys.
    fn walls(&self, text: &mut String) {
        let (along, half) = (1 - self.fall.0, 0.5 * self.sizes.column_m);
        let rear = self.rows()[self.axes_m[self.fall.0].len() - 1];
        let across = self.axes_m[self.fall.0][rear];
        let ends = [milli(self.axes_m[along][0] + half), milli(self.axes_m[along][1] - half)];
        let point = |end: f64, z: f64| {
            if along == 0 { format!("[{end}, {across}, {z}]") } else { format!("[{across}, {end}, {z}]") }
        };
        let mut below = 0.0;
        for (storey, height) in self.heights_m.iter().enumerate() {
            let above = milli(below + height);
            let top = milli(above - self.beam_over_wall_m());
            let _ = write!(
                text,
                "\n[[members]]\nid = \"W{}\"\nkind = \"wall\"\nsection = \"wall\"\nfrom = {}\nto = {}\n",
                storey + 1,
                point(ends[0], below),
                point(ends[1], top)
            );
            below = above;
        }
    }

    /// How far its shear wall ends below the top of the floor \[m\]: under a beam along y that a wall as wide would leave nothing of. Beams along x come before those along y over the columns,
    /// and keep their ends.
    fn beam_over_wall_m(&self) -> f64 {
        let covers = self.fall.0 == 0 && self.beams != Beams::None && self.wall_m() >= self.sizes.column_m;
        if covers { self.sizes.beam_m } else { 0.0 }
    }

    /// Thickness of its shear wall \[m\]: flush with small columns, else far enough from their faces that no elements are thin. What stands on a flush wall
    /// has no entry like it: small buildings, which are not meshed, have none.
    fn wall_m(&self) -> f64 {
        if self.sizes.column_m <= 0.3 && !self.small { self.sizes.column_m } else { 0.2 }
    }

    fn surroundings(&self, text: &mut String) {
        text.push_str("\n[ground]\nlevel = 0\nfriction = 0.5\n");
        for (i, block) in self.blocks.iter().enumerate() {
            let ([x0, y0], [x1, y1]) = (block.from_m, block.to_m);
            let _ = write!(
                text,
                "\n[[obstacles]]\nid = \"block-{}\"\nfrom = [{x0}, {y0}, 0]\nto = [{x1}, {y1}, {}]\nfriction = 0.5\n",
                i + 1,
                block.height_m
            );
        }
        let Some(obstacle) = self.obstacle else { return };
        let (axis, towards_smaller) = self.fall;
        let half = 0.5 * self.sizes.column_m;
        let reach = |d: usize| {
            [milli(self.axes_m[d][0] - half), milli(self.axes_m[d][self.axes_m[d].len() - 1] + half)]
        };
        let [near, far] = if towards_smaller {
            let near = milli(reach(axis)[0] - obstacle.distance_m);
            [milli(near - 0.4), near]
        } else {
            let near = milli(reach(axis)[1] + obstacle.distance_m);
            [near, milli(near + 0.4)]
        };
        let side = reach(1 - axis);
        let [from, to] =
            [(near, side[0] - 1.0, 0.0), (far, side[1] + 1.0, obstacle.height_m)].map(|(a, b, z)| {
                let b = milli(b);
                if axis == 0 { format!("[{a}, {b}, {z}]") } else { format!("[{b}, {a}, {z}]") }
            });
        let _ = write!(text, "\n[[obstacles]]\nid = \"wall\"\nfrom = {from}\nto = {to}\nfriction = 0.5\n");
    }

    fn demolition(&self, text: &mut String) {
        if let Some(factor) = self.weakened {
            let _ = write!(
                text,
                "\n[[preparation]]\nkind = \"weaken\"\nmembers = [\"C1-*\"]\nstrength_factor = {factor}\n"
            );
        }
        for blast in &self.blasts {
            let [x, y] = blast.axes;
            let member = column_id(blast.storey, x, y);
            let _ = write!(
                text,
                "\n[[events]]\nid = \"charge-{member}\"\nmember = \"{member}\"\ntime = {}\n",
                blast.time_s
            );
        }
        let last_s = self.blasts.iter().map(|blast| blast.time_s).fold(0.0, f64::max);
        let end_s = last_s + END_S[0] + END_S[1] * self.heights_m.len() as f64;
        let _ = write!(text, "\n[settings]\nend_time = {}\n", milli(end_s));
    }
}

/// In millimetres.
fn mm(metres: f64) -> f64 {
    (1e3 * metres).round()
}
