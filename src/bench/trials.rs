//! The runs of the stability sweep: a small frame that collapses, a member that bends down to the ground, a plate that
//! falls on a block; one parameter at a time is varied.

use crate::base::tree::Format;
use crate::building::{Building, HardeningPoint, Homogenised, Material, parse};
use crate::fe::deck::of_building;
use crate::fe::law::Law;
use crate::fe::model::{BodyLoad, ContactSettings, Control, Curve, Model, RigidPlane};
use crate::fe::model_run::ModelOptions;
use crate::fe::run::FeOptions;
use crate::fe::shapes::{bilinear, grid};
use crate::verify::fe::forms::FORMS;

/// What is run.
pub enum What {
    /// A building from its dead-load state.
    Building(Box<Building>, FeOptions),
    /// A model from its initial velocities.
    Model(Box<Model>, ModelOptions),
}

/// One run of the sweep.
pub struct Trial {
    /// What is varied.
    pub parameter: &'static str,
    /// Its value with unit.
    pub value: String,
    /// The run.
    pub what: What,
    /// Whether nothing but a diagnosis will do: the value lies beyond the limits of the method.
    pub must_stop: bool,
}

/// All trials.
///
/// # Errors
/// If the frame is not a building.
pub fn trials() -> Result<Vec<Trial>, String> {
    let frame = parse(include_str!("mini.toml"), Format::Toml, "mini.toml").map_err(|e| e.to_string())?;
    let mut list = List { frame, trials: Vec::new() };
    list.time_steps();
    list.meshes();
    list.laws();
    list.surroundings();
    list.forms()?;
    Ok(list.trials)
}

/// Shares of the limit of the elements up to which the meshes of frame and member are stable: an assembled mesh allows more than its
/// elements (`docs/fe-time-step.md`).
const FRAME_BEARS: f64 = 1.1;
const MEMBER_BEARS: f64 = 1.2;

struct List {
    frame: Building,
    trials: Vec<Trial>,
}

impl List {
    /// The frame with a change.
    fn frame(
        &mut self,
        parameter: &'static str,
        value: String,
        change: impl Fn(&mut Building, &mut FeOptions),
    ) {
        let (mut building, mut options) = (self.frame.clone(), FeOptions::default());
        change(&mut building, &mut options);
        let what = What::Building(Box::new(building), options);
        self.trials.push(Trial { parameter, value, what, must_stop: false });
    }

    fn model(&mut self, parameter: &'static str, value: String, model: Model) {
        let what = What::Model(Box::new(model), ModelOptions::default());
        self.trials.push(Trial { parameter, value, what, must_stop: false });
    }

    fn time_steps(&mut self) {
        use crate::fe::dynamics::STEP_SAFETY;
        for factor in [0.5, 0.7, 0.9, 1.0, 1.1, 1.2, 1.3, 1.6, 2.5] {
            let share = factor * STEP_SAFETY;
            self.frame("time step over the safe one", format!("{factor}"), move |_, o| {
                o.step_safety = Some(share);
            });
            self.last_must_stop(share > 1.0);
        }
        for factor in [1.2, 1.3, 1.6, 2.5] {
            let share = factor * STEP_SAFETY;
            self.frame("the same, forced", format!("{factor}"), move |_, o| {
                (o.step_safety, o.step_forced) = (Some(share), true);
            });
            self.last_must_stop(share > FRAME_BEARS);
            let mut model = member([10, 2, 2], [1.0, 0.2, 0.2]);
            model.control.step_safety = share;
            self.model("the same, forced, member", format!("{factor}"), model);
            if let Some(Trial { what: What::Model(_, options), .. }) = self.trials.last_mut() {
                options.step_forced = true;
            }
            self.last_must_stop(share > MEMBER_BEARS);
        }
        for ratio in [0.01, 0.02, 0.05, 0.1, 0.2] {
            self.model("impact speed over wave speed, at the limit", format!("{ratio}"), impact(ratio));
        }
    }

    fn last_must_stop(&mut self, must_stop: bool) {
        self.trials.last_mut().into_iter().for_each(|t| t.must_stop = must_stop);
    }

    fn meshes(&mut self) {
        for size in [0.5, 0.4, 0.3, 0.2] {
            self.frame("mesh size, frame", format!("{size} m"), move |_, o| o.mesh_size_m = Some(size));
        }
        for along in [10, 20] {
            let deep = along / 10;
            let value = format!("{} m", 1.0 / along as f64);
            self.model("mesh size, member", value, member([along, 2 * deep, 2 * deep], [1.0, 0.2, 0.2]));
        }
        for aspect in [1, 2, 5, 10, 20] {
            let model = member([40 / aspect, 2, 2], [4.0, 0.2, 0.2]);
            self.model("aspect ratio, member", format!("{aspect}"), model);
        }
    }

    fn laws(&mut self) {
        for share in [-0.05, -0.01, -0.001, 0.0, 0.01, 0.1] {
            self.frame("tangent over Young's modulus", format!("{} %", 100.0 * share), move |b, _| {
                law(b, |l| l.hardening = sloped(l, share * l.youngs_modulus_pa));
            });
        }
        for strain in [0.01, 0.03, 0.1, 0.3, 1.0] {
            self.frame("erosion strain", format!("{strain}"), move |b, _| {
                law(b, |l| l.critical_plastic_strain = strain);
            });
        }
    }

    fn surroundings(&mut self) {
        for friction in [0.0, 0.25, 0.5, 1.0, f64::INFINITY] {
            let value = || if friction.is_finite() { format!("{friction}") } else { "no slip".into() };
            self.frame("friction, frame", value(), move |b, _| b.ground.friction = friction);
            let contact = ContactSettings { friction };
            self.model("friction, plate", value(), plate(Some(contact)));
        }
        for (value, on) in [("on", true), ("off", false)] {
            self.frame("contact of the parts, frame", value.into(), move |_, o| o.body_contact = on);
        }
        self.model("contact of the parts, plate", "off".into(), plate(None));
        for duration in [0.0, 0.001, 0.01, 0.05, 0.2] {
            self.frame("removal time", format!("{duration} s"), move |b, _| {
                b.settings.removal_duration_s = duration;
            });
        }
        for factor in [0.5, 1.0, 2.0, 5.0, 10.0] {
            self.frame("gravity", format!("{factor} g"), move |b, _| b.settings.gravity_m_s2 *= factor);
        }
    }

    fn forms(&mut self) -> Result<(), String> {
        for form in FORMS {
            let mut model = self.sudden()?;
            model.mesh.laws.iter_mut().for_each(|l| l.form = form.form);
            self.model("element form", form.name.into(), model);
        }
        Ok(())
    }

    /// The frame without its front columns, under gravity that acts at once.
    fn sudden(&self) -> Result<Model, String> {
        let mut model = of_building(&self.frame, &FeOptions::default()).map_err(|e| e.to_string())?.model;
        let gone = |part: usize| self.frame.events.iter().any(|e| e.member == model.mesh.parts[part]);
        let kept: Vec<_> = model.mesh.elements.iter().filter(|e| !gone(e.part)).copied().collect();
        model.mesh.elements = kept;
        model.control.history_nodes.clear();
        model.body_contact = Some(ContactSettings::default());
        Ok(model)
    }
}

/// A clamped bar along x that bends down to the ground 0.3 m below it: its plastic moment, at a yield stress that goes with the square of
/// the length, is 0.4 of the moment of its weight.
fn member(counts: [usize; 3], size_m: [f64; 3]) -> Model {
    let law = Law {
        erosion: crate::fe::law::Erosion { plastic_strain: 0.5, ..Default::default() },
        ..bilinear(16.5e9, 0.2, 2500.0, 0.1e6 * size_m[0] * size_m[0], 165e6)
    };
    let ground =
        RigidPlane { point_m: [0.0, 0.0, -0.3], normal: [0.0, 0.0, 1.0], friction: 0.5, nodes: None };
    Model {
        mesh: grid(counts, size_m, law, |p| p[0] == 0.0),
        body_loads: vec![BodyLoad { axis: 2, acceleration_m_s2: Curve::constant(-9.81) }],
        walls: vec![ground],
        body_contact: Some(ContactSettings::default()),
        control: Control { end_time_s: 0.4, ..Control::default() },
        ..Model::default()
    }
}

/// A plate flies obliquely onto a block that lies on the ground, both of a weak law.
fn plate(body_contact: Option<ContactSettings>) -> Model {
    let law = bilinear(16.5e9, 0.2, 2500.0, 4e6, 165e6);
    let mut mesh = grid([3, 3, 2], [0.9, 0.9, 0.6], law.clone(), |_| false);
    let offset = mesh.nodes.len();
    let above = grid([8, 8, 2], [1.6, 1.6, 0.2], law, |_| false);
    mesh.nodes.extend(above.nodes.iter().map(|p| [p[0] - 0.6, p[1] - 0.4, p[2] + 0.65]));
    for mut element in above.elements {
        element.nodes = element.nodes.map(|n| n + offset);
        mesh.elements.push(element);
    }
    let friction = body_contact.map_or(0.5, |c| c.friction);
    let ground = RigidPlane { point_m: [0.0; 3], normal: [0.0, 0.0, 1.0], friction, nodes: None };
    Model {
        initial_velocity_m_s: (offset..mesh.nodes.len()).map(|n| (n, [1.0, 0.3, -3.0])).collect(),
        mesh,
        body_loads: vec![BodyLoad { axis: 2, acceleration_m_s2: Curve::constant(-9.81) }],
        walls: vec![ground],
        body_contact,
        control: Control { end_time_s: 0.6, ..Control::default() },
        ..Model::default()
    }
}

/// A bar of 4 x 4 x 16 cubes of a weak law hits a rigid wall, at the limit of stability itself: the linear part of the bulk viscosity is in
/// that limit, the quadratic one is not.
fn impact(speed_over_wave_speed: f64) -> Model {
    let law = bilinear(16.5e9, 0.2, 2500.0, 20e6, 165e6);
    // E (1 - ν) / ((1 + ν) (1 - 2ν)) = E / 0.9
    let wave_m_s = (16.5e9 / 0.9 / 2500.0_f64).sqrt();
    let mesh = grid([4, 4, 16], [0.4, 0.4, 1.6], law, |_| false);
    let wall = RigidPlane { point_m: [0.0; 3], normal: [0.0, 0.0, 1.0], friction: 0.0, nodes: None };
    let end_time_s = 3.2 / wave_m_s;
    Model {
        initial_velocity_m_s: (0..mesh.nodes.len())
            .map(|n| (n, [0.0, 0.0, -speed_over_wave_speed * wave_m_s]))
            .collect(),
        mesh,
        walls: vec![wall],
        control: Control {
            end_time_s,
            step_safety: 1.0,
            history_interval_s: 0.05 * end_time_s,
            ..Control::default()
        },
        ..Model::default()
    }
}

fn law(building: &mut Building, change: impl Fn(&mut Homogenised)) {
    for material in building.materials.values_mut() {
        if let Material::Homogenised(law) = material {
            change(law);
        }
    }
}

/// Two points: the first yield stress, and a slope until a tenth of it is left or the strain is 1.
fn sloped(law: &Homogenised, slope_pa: f64) -> Vec<HardeningPoint> {
    let first = law.hardening[0];
    let reach = if slope_pa < 0.0 { (0.9 * first.stress_pa / -slope_pa).min(1.0) } else { 1.0 };
    vec![first, HardeningPoint { plastic_strain: reach, stress_pa: first.stress_pa + reach * slope_pa }]
}
