//! Impacts with rebound of several bodies at once.

use super::contact::{ball, energy, ground, last, model, run};
use crate::mbs::model::{BodyContact, Model};
use crate::mbs::result::RunResult;
use crate::verify::{Case, Figure};

const G: f64 = 9.81;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "impact-216",
            "SimBenchmark: 216 elastic balls in a cube fall 1.1 m on the ground, for 10 s: the energy that contacts make or take.",
            cube,
        ),
        Case::short(
            "impact-cradle",
            "Newton's cradle of five balls with gaps of 1 mm: one after the other.",
            cradle,
        ),
        Case::short(
            "impact-chain",
            "The same without gaps: Moreau's impact law, in which all contacts are hit at once.",
            chain,
        ),
        Case::short(
            "impact-stacked",
            "A ball of 1 kg above one of 3 kg, 10 mm apart, dropped from 1 m without loss: the light one rises to four times the height.",
            stacked,
        ),
    ]
}

fn elastic(mut m: Model) -> Model {
    m.contact.bodies = Some(BodyContact { friction: 0.0, restitution: 1.0 });
    m
}

/// Largest energy \[J\] that contacts made, and took.
fn made_and_taken(result: &RunResult) -> [f64; 2] {
    let taken = &result.energies.contact_damping_j;
    [taken.iter().fold(0.0, |m: f64, e| m.max(-e)), taken.iter().fold(0.0, |m: f64, e| m.max(*e))]
}

fn cube() -> Result<Vec<Figure>, String> {
    let mut m = elastic(model(10.0, 0.1));
    m.contact.ground = ground(0.0, 1.0);
    for i in 0..216 {
        let at = [i % 6, i / 6 % 6, i / 36].map(|v| 0.21 * f64::from(v));
        let shake = 1e-3 * f64::from((i * 7 + 3) % 11) / 11.0;
        ball(&mut m, 10.0, 0.1, [at[0] + shake, at[1] - shake, at[2] + 1.101]);
    }
    // the potential energy above that of balls on the ground
    let stored: f64 = m.bodies.iter().map(|b| b.mass_kg * G * (b.position_m[2] - 0.1)).sum();
    let result = run(&m)?;
    let [made, taken] = made_and_taken(&result).map(|j| j / stored);
    let source = "SimBenchmark (leggedrobotics), elastic 666: energy is conserved";
    Ok(vec![
        Figure::absolute("energy made, share of that stored", "-", [0.0, made], 1e-6, source),
        Figure::absolute("energy lost, share of that stored", "-", [0.0, taken], 1e-6, source),
        energy(&result, 1e-9),
    ])
}

/// Five balls of 1 kg in a line, the others at rest 0.5 m from the first one, which comes with 2 m/s; their velocities after 1 s.
fn line(gap_m: f64) -> Result<(RunResult, Vec<f64>), String> {
    let mut m = elastic(model(1.0, 0.1));
    m.gravity_m_s2 = [0.0; 3];
    // steps of the leapfrog, in which impacts are spread over a step: those of buildings
    m.settings.time_step_s = Some(1e-3);
    for i in 0..5 {
        let start = if i == 0 { -0.5 } else { 0.0 };
        ball(&mut m, 1.0, 0.1, [start + (0.2 + gap_m) * f64::from(i), 0.0, 0.0]);
    }
    m.bodies[0].velocity_m_s[0] = 2.0;
    let result = run(&m)?;
    let [before, after] = [2, 1].map(|back| &result.frames[result.frames.len() - back].position_m);
    let speeds = before.iter().zip(after).map(|(a, b)| (b[0] - a[0]) / 0.1).collect();
    Ok((result, speeds))
}

fn cradle() -> Result<Vec<Figure>, String> {
    let (result, speeds) = line(1e-3)?;
    let others = speeds[..4].iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let source = "impacts of two equal balls one after the other: they exchange their velocities";
    // it leaves when the first one has come to the second and the three others have crossed their gaps
    let begin = (0.5 + 4e-3) / 2.0;
    Ok(vec![
        Figure::relative("velocity of the last ball", "m/s", [2.0, speeds[4]], 1e-9, source),
        Figure::absolute("velocity of the others", "m/s", [0.0, others], 1e-9, source),
        Figure::relative(
            "place of the last ball after 1 s",
            "m",
            [4.0 * 0.201 + 2.0 * (1.0 - begin), last(&result).position_m[4][0]],
            1e-9,
            source,
        ),
        energy(&result, 1e-12),
    ])
}

fn chain() -> Result<Vec<Figure>, String> {
    let (result, speeds) = line(0.0)?;
    let source =
        "Moreau 1988: u⁺ = -e u⁻ in all closed contacts, so 2 v/n for n - 1 balls, 2 v/n - v for the first";
    let off = speeds[1..].iter().fold(0.0, |m: f64, v| m.max((v - 0.8).abs()));
    let [made, taken] = made_and_taken(&result);
    Ok(vec![
        Figure::relative("velocity of the first ball", "m/s", [-1.2, speeds[0]], 1e-6, source),
        Figure::absolute("largest error of another's velocity", "m/s", [0.0, off], 1e-6, source),
        Figure::absolute("energy made or lost", "J", [0.0, made.max(taken)], 1e-6, "conservation"),
    ])
}

fn stacked() -> Result<Vec<Figure>, String> {
    let mut m = elastic(model(1.2, 1e-3));
    m.contact.ground = ground(0.0, 1.0);
    let gap = 0.01;
    ball(&mut m, 3.0, 0.1, [0.0, 0.0, 1.1]);
    ball(&mut m, 1.0, 0.05, [0.0, 0.0, 1.25 + gap]);
    let result = run(&m)?;
    // to the ground in t; the lower one comes up with v, both are pulled alike, so they meet after gap/(2 v); masses 3 : 1 exchange to 0 and 2 v
    let (t, v) = ((2.0 / G).sqrt(), (2.0 * G).sqrt());
    let meet = gap / (2.0 * v);
    let [low, high] = [v - G * meet, -v - G * meet];
    let [low, high] = [0.5 * low + 0.5 * high, 1.5 * low - 0.5 * high];
    let place = 0.1 + v * meet - 0.5 * G * meet * meet;
    let upper = |time: f64| {
        let s = time - t - meet;
        place + 0.15 + high * s - 0.5 * G * s * s
    };
    let lower = |time: f64| {
        let s = time - t - meet;
        place + low * s - 0.5 * G * s * s
    };
    let source = "closed form: two impacts, one after the other";
    let at = |i: usize, body: usize| result.frames[i].position_m[body][2];
    Ok(vec![
        Figure::absolute("height of the light ball at 1.2 s", "m", [upper(1.2), at(1200, 1)], 1e-6, source),
        Figure::absolute("height of the heavy one at 0.455 s", "m", [lower(0.455), at(455, 0)], 1e-6, source),
        energy(&result, 1e-9),
    ])
}
