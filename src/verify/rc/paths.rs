//! Strain paths of all six components: bounds, dissipation, other axes, other steps.

use crate::base::random::Random;
use crate::material::concrete::{ConcreteLaw, ConcretePoint, ConcreteState, Surface};
use crate::verify::rotation::rotation;
use crate::verify::{Case, Figure};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

type Tensor = [f64; 6];

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "point-random-paths",
            "200 random cyclic strain paths with shear, 200 steps each, steps up to 1 % (amplitudes 1e-5 to 1 %): no stress that is not a number or lies outside \
             of the surfaces. Steps of 1 % are cut into 64 sub-steps, which are seven times longer than the law wants; the excess is theirs.",
            || random(200),
        ),
        Case::long("point-random-paths-2000", "The same with 2,000 paths.", || random(2000)),
        Case::short(
            "point-dissipation",
            "40 random closed strain cycles with shear, twice round, in steps of 1e-6: dissipation is the work less the change of the stored energy σ : e / 2 (e: \
             strain less plastic strain; cracks close along secants). It never falls, and no work is gained from the virgin state.",
            || dissipation(40, Surface::FULL),
        ),
        Case::long("point-dissipation-300", "The same with 300 cycles.", || dissipation(300, Surface::FULL)),
        Case::short(
            "point-crack-cycle",
            "The smallest cycle that gains energy if a crack under compression bears less than one without: opened once to 0.2 %, then round and round: compressed \
             across, opened, released, closed. Work of the third round over what the open crack stores.",
            crack_cycle,
        ),
        Case::short(
            "point-axes",
            "20 random strain paths and the same paths in turned axes: largest difference of the turned stresses over f_c, in steps of up to 1e-5 and of up to 0.2 %.",
            axes,
        ),
        Case::short(
            "point-steps",
            "A path with cracking, crushing under lateral pressure and shear in steps of 1e-6, 1e-5 and 1e-4: largest difference at its corners over the largest stress. \
             Its last third opens cracks in crushed concrete and crushes it again: there the error is of first order in the law's sub-steps (a quarter of the \
             cracking strain, 2e-5; steps of 1e-5 are taken whole), 1.8 % at their length, 0.1 % at 1e-6.",
            steps,
        ),
    ]
}

fn law() -> ConcreteLaw {
    ConcreteLaw::of_strength(30e6)
}

fn point_of(law: &ConcreteLaw) -> Result<ConcretePoint, String> {
    ConcretePoint::new(law, 0.1).map_err(|e| e.to_string())
}

/// Numbers in -1..1, always the same for a seed.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut random = Random::after(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d);
    move || random.symmetric()
}

/// An amplitude between 10^-5 and 10^-2 of strain, or of fewer decades.
fn amplitude(next: &mut impl FnMut() -> f64, decades: f64) -> f64 {
    0.5e-2 * libm::pow(10.0, -0.5 * decades * (1.0 + next()))
}

/// Principal values in falling order.
fn principal(t: &Tensor) -> [f64; 3] {
    let values = Matrix3::new(t[0], t[3], t[5], t[3], t[1], t[4], t[5], t[4], t[2]).symmetric_eigenvalues();
    let mut values = [values[0], values[1], values[2]];
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// Lubliner's measure of compression over `f_c`, with the correction between the meridians.
fn compression_share(s: &[f64; 3], law: &ConcreteLaw) -> f64 {
    let (r, k) = (law.surface.biaxial_ratio, law.surface.meridian_ratio);
    let (alpha, gamma) = ((r - 1.0) / (2.0 * r - 1.0), 3.0 * (1.0 - k) / (2.0 * k - 1.0));
    let mean = (s[0] + s[1] + s[2]) / 3.0;
    let d = s.map(|v| v - mean);
    let mises = (1.5 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2])).sqrt();
    let cosine = (13.5 * d[0] * d[1] * d[2] / mises.powi(3).max(1e-9)).clamp(-1.0, 1.0);
    let lode = 1.0 + law.surface.lode_amplitude * 1.5 * 3f64.sqrt() * cosine * (1.0 - cosine * cosine);
    let value = 3.0 * alpha * mean + lode * mises - gamma * (-s[0]).max(0.0);
    value / (1.0 - alpha) / law.compressive_strength_pa
}

/// Not numbers, excess over the surface of compression, over the tensile strength, over the tensile strength beside compression; the last three relative.
fn wander(point: &ConcretePoint, law: &ConcreteLaw, seed: u64) -> [f64; 4] {
    let mut next = numbers(seed);
    let size = amplitude(&mut next, 3.0);
    let (mut state, mut at, mut found) = (ConcreteState::default(), [0.0; 6], [0.0, 0.0, 0.0, 0.0_f64]);
    for _ in 0..200 {
        let goal: Tensor = std::array::from_fn(|_| size * next());
        let stress = point.respond(&mut state, &std::array::from_fn(|i| goal[i] - at[i]));
        at = goal;
        if stress.iter().any(|s| !s.is_finite()) {
            found[0] += 1.0;
            continue;
        }
        let s = principal(&stress);
        let tension = s[0] / law.tensile_strength_pa;
        let beside = 1.0 - 0.8 * (-s[2] / law.compressive_strength_pa).clamp(0.0, 1.0);
        let now = [compression_share(&s, law) - 1.0, tension - 1.0, tension / beside - 1.0];
        (1..4).for_each(|i| found[i] = found[i].max(now[i - 1]));
    }
    found
}

fn random(paths: u64) -> Result<Vec<Figure>, String> {
    let law = law();
    let point = point_of(&law)?;
    let worse = |a: [f64; 4], b: [f64; 4]| [a[0] + b[0], a[1].max(b[1]), a[2].max(b[2]), a[3].max(b[3])];
    let found = (0..paths).into_par_iter().map(|p| wander(&point, &law, p)).reduce(|| [0.0; 4], worse);
    let row = |what: &str, ours: f64, band: f64| Figure::absolute(what, "-", [0.0, ours], band, "law");
    Ok(vec![
        row("stresses that are not numbers", found[0], 0.0),
        row("largest excess over the surface of compression, of f_c", found[1], 5e-3),
        row("largest excess over the tensile strength, of it", found[2], 1e-6),
        row("largest excess over the tensile strength beside compression, of it", found[3], 1e-4),
    ])
}

/// Walks straight to a strain in steps; `seen` has the stress before and after and the step.
fn walk(
    point: &ConcretePoint,
    state: &mut ConcreteState,
    [at, stress]: [&mut Tensor; 2],
    goal: &Tensor,
    step: f64,
    mut seen: impl FnMut(&ConcreteState, f64, &Tensor),
) {
    let way: Tensor = std::array::from_fn(|i| goal[i] - at[i]);
    let count = (way.iter().fold(0.0, |m: f64, s| m.max(s.abs())) / step).ceil().max(1.0);
    let part = way.map(|w| w / count);
    for _ in 0..count as usize {
        let now = point.respond(state, &part);
        let work = (0..6).map(|i| 0.5 * (stress[i] + now[i]) * part[i] * weight(i)).sum();
        *stress = now;
        seen(state, work, &now);
    }
    *at = *goal;
}

/// How often a component stands in the tensor.
fn weight(i: usize) -> f64 {
    if i < 3 { 1.0 } else { 2.0 }
}

/// Largest fall of the dissipation and least work, over the largest energy seen.
fn falls(point: &ConcretePoint, seed: u64) -> [f64; 2] {
    let mut next = numbers(seed);
    let size = amplitude(&mut next, 2.0);
    let corners: Vec<Tensor> = (0..5).map(|_| std::array::from_fn(|_| size * next())).collect();
    let (mut state, mut at, mut stress) = (ConcreteState::default(), [0.0; 6], [0.0; 6]);
    let (mut work, mut top, mut fall, mut least, mut scale) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for corner in corners.iter().chain(&corners) {
        walk(point, &mut state, [&mut at, &mut stress], corner, 1e-6, |state, done, now| {
            work += done;
            let stored: f64 = (0..6).map(|i| 0.5 * weight(i) * now[i] * state.mechanical[i]).sum();
            let dissipated = work - stored;
            top = top.max(dissipated);
            fall = fall.max(top - dissipated);
            least = least.min(work);
            scale = scale.max(work).max(stored);
        });
    }
    [fall / scale, least / scale]
}

fn dissipation(cycles: u64, surface: Surface) -> Result<Vec<Figure>, String> {
    let point = point_of(&ConcreteLaw { surface, ..law() })?;
    let worse = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].min(b[1])];
    let [fall, least] = (0..cycles).into_par_iter().map(|c| falls(&point, c)).reduce(|| [0.0; 2], worse);
    let source = "second law; trapezoidal rule";
    Ok(vec![
        Figure::absolute("largest fall of the dissipation, of the energy", "-", [0.0, fall], 1e-4, source),
        Figure::absolute("least work since the virgin state, of the energy", "-", [0.0, least], 1e-9, source),
    ])
}

fn crack_cycle() -> Result<Vec<Figure>, String> {
    let point = point_of(&law())?;
    let (mut state, mut at, mut stress) = (ConcreteState::default(), [0.0; 6], [0.0; 6]);
    let (wide, pressed) = (2e-3, -6e-4);
    let corner = |open: f64, across: f64| [open, 0.0, across, 0.0, 0.0, 0.0];
    let mut go = |goal: Tensor| {
        let mut work = 0.0;
        walk(&point, &mut state, [&mut at, &mut stress], &goal, 1e-6, |_, done, _| work += done);
        work
    };
    go(corner(wide, 0.0));
    let stored = -go(corner(0.0, 0.0));
    let mut rounds = [0.0; 3];
    for round in &mut rounds {
        for goal in [corner(0.0, pressed), corner(wide, pressed), corner(wide, 0.0), corner(0.0, 0.0)] {
            *round += go(goal);
        }
    }
    let source = "no gain; trapezoidal rule";
    Ok(vec![Figure::absolute("work of the third round", "-", [0.0, rounds[2] / stored], 1e-4, source)])
}

fn turned(t: &Tensor, q: &Matrix3<f64>) -> Tensor {
    let m = q * Matrix3::new(t[0], t[3], t[5], t[3], t[1], t[4], t[5], t[4], t[2]) * q.transpose();
    [m[(0, 0)], m[(1, 1)], m[(2, 2)], m[(0, 1)], m[(1, 2)], m[(2, 0)]]
}

/// Largest difference of turned stresses over `f_c` in paths with steps of up to a size.
fn largest_difference(size: f64, count: usize) -> Result<f64, String> {
    let law = law();
    let point = point_of(&law)?;
    let mut largest: f64 = 0.0;
    for path in 0..20 {
        let mut next = numbers(1000 + path);
        let axis = Vector3::new(next(), next(), next());
        let q = rotation(3.0 * axis);
        let mut states = [ConcreteState::default(); 2];
        let mut way = [0.0; 6];
        for k in 0..count {
            if k % 40 == 0 {
                way = std::array::from_fn(|_| size * next());
            }
            let straight = point.respond(&mut states[0], &way);
            let other = point.respond(&mut states[1], &turned(&way, &q));
            let expected = turned(&straight, &q);
            for i in 0..6 {
                largest = largest.max((other[i] - expected[i]).abs() / law.compressive_strength_pa);
            }
        }
    }
    Ok(largest)
}

fn axes() -> Result<Vec<Figure>, String> {
    let (small, large) = (largest_difference(1e-5, 1600)?, largest_difference(2e-3, 400)?);
    Ok(vec![
        Figure::absolute("steps of up to 1e-5", "-", [0.0, small], 1e-9, "objectivity"),
        Figure::absolute("steps of up to 0.2 %", "-", [0.0, large], 1e-9, "objectivity"),
    ])
}

fn steps() -> Result<Vec<Figure>, String> {
    let law = law();
    let point = point_of(&law)?;
    let corners: [Tensor; 6] = [
        [2e-4, 0.0, 5e-5, 1e-4, 0.0, 0.0],
        [4e-4, -1e-4, -1e-3, 2e-4, -1e-4, 0.0],
        [-2e-4, -2e-4, -3e-3, 2e-4, 3e-4, 1e-4],
        [-3e-4, -1e-4, -2e-3, 0.0, 3e-4, -1e-4],
        [1e-3, 5e-4, -1e-3, 2e-4, 0.0, 0.0],
        [0.0, 0.0, -5e-3, 0.0, 1e-3, 0.0],
    ];
    let at_corners = |step: f64| {
        let (mut state, mut at, mut stress) = (ConcreteState::default(), [0.0; 6], [0.0; 6]);
        corners.map(|goal| {
            walk(&point, &mut state, [&mut at, &mut stress], &goal, step, |_, _, _| ());
            stress
        })
    };
    let fine = at_corners(1e-6);
    let largest = |of: &[Tensor]| of.iter().flatten().fold(0.0, |m: f64, s| m.max(s.abs()));
    let difference = |step: f64, part: std::ops::Range<usize>| {
        let other = at_corners(step);
        let gaps: Vec<Tensor> =
            part.clone().map(|c| std::array::from_fn(|i| other[c][i] - fine[c][i])).collect();
        largest(&gaps) / largest(&fine[part])
    };
    let mut figures = Vec::new();
    for step in [1e-5, 1e-4] {
        let what = format!("steps of {step:e} against 1e-6");
        let last = format!("{what}, last third");
        figures.push(Figure::absolute(what, "-", [0.0, difference(step, 0..4)], 0.01, "same path"));
        figures.push(Figure::absolute(
            last,
            "-",
            [0.0, difference(step, 4..6)],
            0.03,
            "same path, first order",
        ));
    }
    Ok(figures)
}
