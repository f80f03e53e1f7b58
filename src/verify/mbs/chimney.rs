//! Chimneys that fall and break in the air.
//!
//! A prism of latent sections topples. As long as it is whole, its motion has one coordinate, and what each section bears follows from the motion of the part above: that is the reference,
//! the theory of Varieschi and Kamiya (Am. J. Phys. 71 (2003) 1025) with the size of the section kept in it. A section opens when its moment reaches what it can bear: a bond, and a lever times
//! the axial force. With a lever of half a side that is the moment at which blocks rock about their edges.

use super::contact::{ground, run};
use super::models::{elastic, solid};
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::mbs::math;
use crate::mbs::model::{Bending, Bushing, Model, Shape};
use crate::mbs::result::{EventKind, RunResult};
use crate::verify::{Case, Figure};

const G: f64 = 9.81;
const DENSITY_KG_M3: f64 = 2500.0;
/// Stiffness of latent sections in translation \[N/m\] and bending \[N m/rad\]: what they bear while they are latent does not depend on it, but for the filter of contact loads.
const SECTION: [f64; 2] = [1e9, 1e8];
/// Stiffness of a foot in the axis \[N/m\], and what it resists in rotation over weight times height, so that there is an equilibrium from which to start.
const FOOT_N_M: f64 = 1e8;
const FOOT_BENDING: f64 = 1e-5;
/// What sections of dry blocks bear without axial force, over weight times height: curves have a positive peak.
const DRY: f64 = 1e-6;
/// Step and interval of outputs \[s\].
const STEP_S: f64 = 5e-5;
const OUTPUT_S: f64 = 2e-3;
/// How long a run goes on after the time at which theory has the tower break \[s\]: on a foot in the axis, and over an edge, where the filter lags by 6 ms. Later more blocks come off.
const MARGIN_S: [f64; 2] = [5e-3, 2e-2];

const THEORY: &str = "moment and axial force of a toppling prism (Varieschi and Kamiya, Am. J. Phys. 71 (2003) 1025, with the size of the section)";
const SLENDER: &str = "falling rod: moment m g H sin θ/4 r/H (1 - r/H)², largest at a third (Madsen, Am. J. Phys. 45 (1977) 182)";
const SEEN: &str = "seen on videos of toy towers: 0.50 at about 10°, 0.40 at 30 to 35° (Varieschi and Kamiya, gvarieschi.lmu.build/chimney)";

/// Error of the tilt at the break, of a tower on a foot in its axis. Its spin in the vertical is there at once, so that the axial force vibrates by up to `ω² H/2g`, 1.2e-4 of the weight; in a
/// step it turns by up to 2e-4 of its tilt; the foot resists with 2e-5 of what makes it fall and is compressed by less than 3e-5 of the height: 4e-4 together, doubled for the step of theory and
/// the interpolation between outputs.
const TILT: f64 = 8e-4;
/// The same over an edge on the ground. Loads of contacts reach the sections through a filter that lags by the inverse of the slowest free vibration, `22.4 (EI/m H³)^½` = 155 rad/s here; in
/// that time the tower turns by 0.9 % of its tilt.
const EDGE_TILT: f64 = 1e-2;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "rod-break",
            "A slender rod of 30 pieces topples about its foot; all sections bear the same moment, whatever the axial force: where and at which tilt it breaks.",
            rod,
        ),
        Case::short(
            "chimney-bonds",
            "A chimney of 40 blocks, 20 times as high as wide, topples about its foot; joints bear a bond and rock about their edges: where and at which tilt the first one opens. \
             The stronger the bond, the later and the lower.",
            bonds,
        ),
        Case::short(
            "chimney-edge",
            "A chimney of 24 blocks, 15 times as high as wide, topples over the edge of its lowest block on rough ground; joints bear a bond of 0.014 of weight times height and rock: the same.",
            edge,
        ),
        Case::short(
            "chimney-wooden",
            "The tower of 24 wooden blocks, without any bond. Its slenderness is unknown here: 44 has it open at the tilt that was seen; the height is that of any slender tower.",
            || toy(wooden(), [0.5, 10.0], [1.0 / 48.0, 2.5]),
        ),
        Case::short(
            "chimney-plastic",
            "The tower of 100 plastic bricks. Slenderness and bond are unknown here: with 20 and 0.0117 of weight times height theory has both figures that were seen.",
            || toy(plastic(), [0.4, 32.5], [0.01, 2.5]),
        ),
    ]
}

/// What a tower turns about.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Foot {
    /// A line through its axis.
    Axis,
    /// The edge of its lowest block.
    Edge,
}

/// A prism of latent sections that topples from the vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tower {
    /// Height and side of the square section \[m\].
    height_m: f64,
    side_m: f64,
    blocks: usize,
    /// A section bears this moment \[N m\] and a lever \[m\] times the axial force.
    bond_nm: f64,
    lever_m: f64,
    foot: Foot,
    /// Angular velocity in the vertical \[rad/s\].
    spin_rad_s: f64,
}

/// The first section that opens.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Break {
    /// Blocks below it.
    joint: usize,
    tilt_rad: f64,
    time_s: f64,
}

/// Blocks that rock about their edges, on a foot in the axis, so much higher than wide; the bond is a share of weight times height.
fn blocks(slenderness: f64, blocks: usize, bond: f64) -> Tower {
    let height_m = 6.0;
    let side_m = height_m / slenderness;
    let own = Tower {
        height_m,
        side_m,
        blocks,
        bond_nm: 0.0,
        lever_m: 0.5 * side_m,
        foot: Foot::Axis,
        spin_rad_s: 0.02,
    };
    Tower { bond_nm: bond * own.weight_n() * height_m, ..own }
}

fn wooden() -> Tower {
    blocks(44.0, 24, DRY)
}

fn plastic() -> Tower {
    blocks(20.0, 100, 0.0117)
}

impl Tower {
    fn weight_n(&self) -> f64 {
        DENSITY_KG_M3 * self.side_m * self.side_m * self.height_m * G
    }

    /// From the axis to what it turns about, towards the fall \[m\].
    fn offset_m(&self) -> f64 {
        match self.foot {
            Foot::Axis => 0.0,
            Foot::Edge => 0.5 * self.side_m,
        }
    }

    /// Square of the angular velocity and angular acceleration at a tilt \[rad²/s², rad/s²\]: energy and moment of momentum of a rigid prism.
    fn motion(&self, tilt: f64) -> [f64; 2] {
        let (high, offset) = (0.5 * self.height_m, self.offset_m());
        let lever = libm::hypot(high, offset);
        let inertia = (self.height_m.powi(2) + self.side_m.powi(2)) / 12.0 + lever * lever;
        let past = tilt - libm::atan2(offset, high);
        let fallen = lever * (libm::cos(tilt - past) - libm::cos(past));
        [self.spin_rad_s.powi(2) + 2.0 * G * fallen / inertia, G * lever * libm::sin(past) / inertia]
    }

    /// Moment \[N m\] and axial force \[N\], compression positive, of the section at a share of the height: the equations of motion of the part above.
    fn bears(&self, tilt: f64, share: f64) -> [f64; 2] {
        let [rate2, acceleration] = self.motion(tilt);
        let (offset, up) = (self.offset_m(), 0.5 * (1.0 + share) * self.height_m);
        let (mass, length) = (self.weight_n() / G * (1.0 - share), self.height_m * (1.0 - share));
        // the centre of the part lies `up` above and `offset` behind what the tower turns about
        let across = acceleration * up + rate2 * offset - G * libm::sin(tilt);
        let along = acceleration * offset - rate2 * up + G * libm::cos(tilt);
        let own = mass * (self.side_m.powi(2) + length * length) / 12.0;
        [own * acceleration + mass * across * 0.5 * length, mass * along]
    }

    /// The first section that bears as much as it can, to 1e-5 rad.
    fn breaks(&self) -> Result<Break, String> {
        const TURN: f64 = 1e-5;
        let mut time_s = 0.0;
        for n in 0..(0.5 / TURN * std::f64::consts::PI) as usize {
            let tilt_rad = n as f64 * TURN;
            let used = |i: &usize| {
                let [moment, axial] = self.bears(tilt_rad, *i as f64 / self.blocks as f64);
                moment.abs() / (self.bond_nm + self.lever_m * axial.max(0.0))
            };
            let worst = (1..self.blocks).max_by(|a, b| used(a).total_cmp(&used(b))).unwrap_or(0);
            if used(&worst) >= 1.0 {
                return Ok(Break { joint: worst, tilt_rad, time_s });
            }
            time_s += TURN / self.motion(tilt_rad + 0.5 * TURN)[0].sqrt();
        }
        Err("theory has it fall whole".into())
    }

    /// The multibody model.
    fn model(&self, end_s: f64) -> Model {
        let mut m = Model::empty("chimney", [0.0, 0.0, -G], end_s, OUTPUT_S);
        m.settings.time_step_s = Some(STEP_S);
        m.curves.insert("section".into(), self.curve());
        let (block, spin) = (self.height_m / self.blocks as f64, [0.0, self.spin_rad_s, 0.0]);
        let size = [self.side_m, self.side_m, block];
        for i in 0..self.blocks {
            let z = (i as f64 + 0.5) * block;
            let mut body = solid(&format!("b{i}"), DENSITY_KG_M3, size, [0.0, 0.0, z]);
            body.angular_velocity_rad_s = spin;
            body.velocity_m_s = math::cross(spin, [-self.offset_m(), 0.0, z]);
            m.bodies.push(body);
            if i > 0 {
                m.bushings.push(self.section(i, i as f64 * block));
            }
        }
        match self.foot {
            Foot::Edge => {
                m.contact.ground = ground(2.0, 0.0);
                m.bodies[0].shapes.push(Shape::cuboid([0.0; 3], size.map(|s| 0.5 * s)));
            }
            Foot::Axis => {
                // compressed by the weight from the start, so that it does not vibrate
                m.settings.preload = true;
                m.bushings.push(self.pin());
            }
        }
        m
    }

    /// A latent section.
    fn section(&self, i: usize, z: f64) -> Bushing {
        let id = format!("s{i}");
        let bending = [0; 2].map(|_| Bending::Curve { curve: "section".into(), strength_factor: 1.0 });
        Bushing {
            axial_stiffness_n_m: SECTION[0],
            shear_stiffness_n_m: [SECTION[0]; 2],
            torsional_stiffness_nm_rad: SECTION[1] * self.side_m.powi(2),
            bending,
            latent: Some(id.clone()),
            ..elastic(id, Some(format!("b{}", i - 1)), format!("b{i}"), [0.0, 0.0, z])
        }
    }

    /// The foot in the axis.
    fn pin(&self) -> Bushing {
        let stiffness_nm_rad = FOOT_BENDING * self.weight_n() * self.height_m;
        Bushing {
            axial_stiffness_n_m: FOOT_N_M,
            shear_stiffness_n_m: [FOOT_N_M; 2],
            torsional_stiffness_nm_rad: FOOT_N_M * self.side_m.powi(2),
            bending: [0; 2].map(|_| Bending::Elastic { stiffness_nm_rad }),
            ..elastic("foot".into(), None, "b0".into(), [0.0; 3])
        }
    }

    fn curve(&self) -> ResistanceCurve {
        let level = |axial_force_n: f64| {
            let peak = self.bond_nm + self.lever_m * axial_force_n;
            let capacity = vec![[0.0, peak], [0.1, peak]];
            CapacityLevel { axial_force_n, capacity, fracture_rotation_rad: 0.5 }
        };
        let levels = vec![level(0.0), level(2.0 * self.weight_n())];
        ResistanceCurve { stiffness_nm_rad: SECTION[1], levels, cyclic: None }
    }

    /// Runs the model until after the time at which theory has it break: the first section that opens, and the run.
    fn run(&self, theory: &Break) -> Result<(Break, RunResult), String> {
        let margin_s = MARGIN_S[usize::from(self.foot == Foot::Edge)];
        let result = run(&self.model(theory.time_s + margin_s))?;
        let opens = result.events.iter().find_map(|e| match &e.kind {
            EventKind::Live { joint, with: None } => Some((e.time_s, joint.strip_prefix('s')?.parse().ok()?)),
            _ => None,
        });
        let (time_s, joint) = opens.ok_or("no section opens")?;
        let tilt = |i: usize| 2.0 * libm::asin(result.frames[i].orientation[0][2]);
        let after = result.times_s.partition_point(|t| *t < time_s).clamp(1, result.times_s.len() - 1);
        let [from, to] = [result.times_s[after - 1], result.times_s[after]];
        let tilt_rad = tilt(after - 1) + (time_s - from) / (to - from) * (tilt(after) - tilt(after - 1));
        Ok((Break { joint, tilt_rad, time_s }, result))
    }

    fn share(&self, found: &Break) -> f64 {
        found.joint as f64 / self.blocks as f64
    }

    /// Height and tilt of the break beside those of theory.
    fn figures(&self, what: &str, theory: &Break, found: &Break) -> Vec<Figure> {
        let allowed = if self.foot == Foot::Edge { EDGE_TILT } else { TILT };
        let heights = [self.share(theory), self.share(found)];
        let tilts = [theory.tilt_rad, found.tilt_rad].map(f64::to_degrees);
        vec![
            // the same joint, but for the rounding of a quotient
            Figure::absolute(format!("height over all of the break{what}"), "-", heights, 1e-9, THEORY),
            Figure::relative(format!("tilt then{what}"), "°", tilts, allowed, THEORY),
        ]
    }
}

fn rod() -> Result<Vec<Figure>, String> {
    // reached at a third where sin θ = 0.5
    let own = Tower { lever_m: 0.0, ..blocks(150.0, 30, 0.5 / 27.0) };
    let (found, result) = own.run(&own.breaks()?)?;
    let before = result.times_s.partition_point(|t| *t < found.time_s) - 1;
    let sine = libm::sin(2.0 * libm::asin(result.frames[before].orientation[0][2]));
    let off = |(i, history): (usize, &crate::mbs::result::HingeHistory)| {
        let x = (i + 1) as f64 / own.blocks as f64;
        let moment = history.moment_nm[before];
        let shape = 0.25 * own.weight_n() * own.height_m * sine * x * (1.0 - x).powi(2);
        (libm::hypot(moment[0], moment[1]) - shape).abs() / own.bond_nm
    };
    let worst = result.hinges.iter().enumerate().map(off).fold(0.0, f64::max);
    Ok(vec![
        Figure::absolute("height over all of the break", "-", [1.0 / 3.0, own.share(&found)], 1e-9, SLENDER),
        Figure::relative("tilt then", "°", [30.0, found.tilt_rad.to_degrees()], TILT, SLENDER),
        Figure::absolute(
            "largest error of a moment before, over the largest",
            "-",
            [0.0, worst],
            TILT,
            SLENDER,
        ),
    ])
}

fn bonds() -> Result<Vec<Figure>, String> {
    let mut figures = Vec::new();
    let mut all = Vec::new();
    for (bond, what) in
        [(0.001, ", bond 0.001 m g H"), (0.004, ", bond 0.004 m g H"), (0.0117, ", bond 0.0117 m g H")]
    {
        let own = blocks(20.0, 40, bond);
        let theory = own.breaks()?;
        let (found, _) = own.run(&theory)?;
        figures.extend(own.figures(what, &theory, &found));
        all.push(found);
    }
    let in_order = |w: &[Break]| w[1].tilt_rad > w[0].tilt_rad && w[1].joint < w[0].joint;
    let ordered = all.windows(2).filter(|w| in_order(w)).count() as f64;
    let (what, steps) = ("bonds that break later and lower than the weaker one", (all.len() - 1) as f64);
    figures.push(Figure::absolute(what, "-", [steps, ordered], 0.0, THEORY));
    Ok(figures)
}

fn edge() -> Result<Vec<Figure>, String> {
    let (height_m, side_m) = (6.0, 0.4);
    let (bond_nm, lever_m) = (2000.0, 0.5 * side_m);
    let own = Tower { height_m, side_m, blocks: 24, bond_nm, lever_m, foot: Foot::Edge, spin_rad_s: 0.14 };
    let theory = own.breaks()?;
    let (found, _) = own.run(&theory)?;
    Ok(own.figures("", &theory, &found))
}

/// A toy tower beside theory and what was seen: height over all and tilt \[°\], with how near they were read: the height to half a block of wood or a brick, one tilt to 30 to 35°; "about 10°" is
/// taken as no better.
fn toy(own: Tower, [height, tilt_deg]: [f64; 2], read: [f64; 2]) -> Result<Vec<Figure>, String> {
    let theory = own.breaks()?;
    let (found, _) = own.run(&theory)?;
    let mut figures = own.figures("", &theory, &found);
    let heights = [height, own.share(&found)];
    figures.push(Figure::absolute("height over all, against the test", "-", heights, read[0], SEEN));
    let tilts = [tilt_deg, found.tilt_rad.to_degrees()];
    figures.push(Figure::absolute("tilt, against the test", "°", tilts, read[1], SEEN));
    Ok(figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equations of a slender chimney that falls from rest, as they are published: axial force and bending moment.
    #[test]
    fn a_slender_tower_bears_what_is_published() {
        let own = Tower { spin_rad_s: 0.0, ..blocks(1e4, 20, DRY) };
        let (weight, height) = (own.weight_n(), own.height_m);
        for tilt in [0.1_f64, 0.3, 0.6, 1.0] {
            for share in [0.1, 1.0 / 3.0, 0.5, 0.8] {
                let [moment, axial] = own.bears(tilt, share);
                let squeezed =
                    0.5 * weight * (1.0 - share) * ((5.0 + 3.0 * share) * tilt.cos() - 3.0 * (1.0 + share));
                let bent = -0.25 * weight * height * tilt.sin() * share * (1.0 - share).powi(2);
                assert!((moment.abs() - bent.abs()).abs() < 1e-7 * weight * height, "{moment} {bent}");
                assert!((axial - squeezed).abs() < 1e-7 * weight, "{axial} {squeezed}");
            }
        }
    }

    #[test]
    fn dry_slender_towers_open_in_the_middle() {
        // the joint that opens first has the smallest 1/(x (1 - x)): sin θ = 8 sides over heights, as long as tilts are small
        let own = Tower { spin_rad_s: 0.0, ..blocks(1000.0, 24, 1e-9) };
        let found = own.breaks().unwrap();
        assert!(found.joint == 12 && (found.tilt_rad - 8e-3).abs() < 2e-5, "{found:?}");
    }
}
