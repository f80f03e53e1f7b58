//! Control of the run and of what is recorded.

use super::card::{Cards, Names};
use super::raw::{Raw, Who};
use super::read_material::bulk_viscosity;

/// Keywords that change what is written or how elsewhere, and nothing here.
const WITHOUT_EFFECT: &[&str] = &[
    "CONTROL_ENERGY",
    "CONTROL_OUTPUT",
    "CONTROL_UNITS",
    "CONTROL_ACCURACY",
    "CONTROL_SOLUTION",
    "CONTROL_SOLID",
    "CONTROL_SHELL",
    "CONTROL_CONTACT",
    "CONTROL_CPU",
    "CONTROL_PARALLEL",
    "CONTROL_RIGID",
    "CONTROL_STRUCTURED",
    "CONTROL_SUBCYCLE",
    "CONTROL_MPP_DECOMPOSITION_METHOD",
    "CONTROL_MPP_IO_NODUMP",
    "CONTROL_CHECK_SHELL",
    "DATABASE_EXTENT_BINARY",
    "DATABASE_EXTENT_INTFOR",
    "DATABASE_EXTENT_SSSTAT",
    "DATABASE_ABSTAT",
    "DATABASE_DEFGEO",
    "DATABASE_DISBOUT",
    "DATABASE_JNTFORC",
    "DATABASE_NCFORC",
    "DATABASE_RBDOUT",
    "DATABASE_SECFORC",
    "DATABASE_SSSTAT",
    "DATABASE_SWFORC",
    "DATABASE_TPRINT",
    "DATABASE_CROSS_SECTION_PLANE",
    "DATABASE_CROSS_SECTION_PLANE_ID",
    "DATABASE_CROSS_SECTION_SET",
    "DATABASE_CROSS_SECTION_SET_ID",
    "DATABASE_NODAL_FORCE_GROUP",
    "DATABASE_HISTORY_BEAM_SET",
    "DATABASE_HISTORY_SHELL",
    "DATABASE_HISTORY_SHELL_SET",
    "DATABASE_BINARY_D3PART",
    "DATABASE_BINARY_D3DRLF",
    "DATABASE_BINARY_BLSTFOR",
    "DATABASE_FORMAT",
    "DATABASE_ELOUT",
    "DATABASE_RCFORC",
    "DATABASE_RWFORC",
    "DATABASE_SPCFORC",
    "DATABASE_SLEOUT",
    "DATABASE_NODFOR",
    "DATABASE_BNDOUT",
    "DATABASE_DEFORC",
    "DATABASE_HISTORY_SOLID",
    "DATABASE_HISTORY_SOLID_SET",
    "DATABASE_HISTORY_BEAM",
    "DATABASE_BINARY_D3THDT",
    "DATABASE_BINARY_D3DUMP",
    "DATABASE_BINARY_RUNRSF",
    "DATABASE_BINARY_INTFOR",
];

/// Reads the block if it is one of these; says whether it was.
pub(super) fn read(cards: &mut Cards<'_, '_>, raw: &mut Raw) -> bool {
    match &cards.block.keyword[..] {
        "CONTROL_TERMINATION" => termination(cards, raw),
        "CONTROL_TIMESTEP" => time_step(cards, raw),
        "CONTROL_BULK_VISCOSITY" => {
            if let Some(card) = cards.card(&["Q1", "Q2", "TYPE"]) {
                bulk_viscosity(cards, &card, 0, 1);
            }
            cards.end();
        }
        "CONTROL_DYNAMIC_RELAXATION" => cards.messages.note(
            cards.block.at,
            "*CONTROL_DYNAMIC_RELAXATION has no effect: loads of a deck act from the beginning of the run",
        ),
        "DATABASE_BINARY_D3PLOT" => states(cards, raw),
        "DATABASE_NODOUT" => interval(cards, |raw| &mut raw.history_interval, raw),
        "DATABASE_GLSTAT" | "DATABASE_MATSUM" => interval(cards, |raw| &mut raw.energy_interval, raw),
        "DATABASE_HISTORY_NODE" => history_nodes(cards, raw, false),
        "DATABASE_HISTORY_NODE_SET" => history_nodes(cards, raw, true),
        "DATABASE_HISTORY_NODE_ID" => named_history_nodes(cards, raw),
        keyword if WITHOUT_EFFECT.contains(&keyword) => {
            if keyword != "CONTROL_ENERGY" {
                cards.messages.note(cards.block.at, format!("*{keyword} has no effect"));
            }
        }
        _ => return false,
    }
    true
}

fn termination(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    const NAMES: Names = &["ENDTIM", "ENDCYC", "DTMIN", "ENDENG", "ENDMAS"];
    let Some(card) = cards.required(NAMES) else { return };
    let end = cards.positive(&card, 0);
    raw.end_time_at = Some(card.place(0));
    for field in 1..5 {
        let value = cards.real(&card, field);
        if value != 0.0 && value.abs() < 1e8 {
            let text = "ENDCYC, DTMIN, ENDENG and ENDMAS have no effect: the run ends at ENDTIM";
            cards.messages.note(card.place(field), text);
        }
    }
    cards.end();
    if raw.end_time.replace(end).is_some() {
        twice(cards);
    }
}

/// A keyword that a deck has once.
pub(super) fn twice(cards: &mut Cards<'_, '_>) {
    let message = format!("*{} stands twice in the deck", cards.block.keyword);
    cards.messages.error(cards.block.at, "duplicate", message, "", "keep one of them");
}

fn time_step(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    const NAMES: Names = &["DTINIT", "TSSFAC", "ISDO", "TSLIMT", "DT2MS", "LCTM", "ERODE", "MS1ST"];
    const SECOND: Names = &["DT2MSF", "DT2MSLC", "IMSCL"];
    let Some(card) = cards.required(NAMES) else { return };
    if cards.real(&card, 0) != 0.0 {
        cards.messages.note(card.place(0), "DTINIT has no effect: the first step follows from the elements");
    }
    let safety = cards.real_or(&card, 1, crate::fe::dynamics::STEP_SAFETY);
    if safety <= 0.0 || safety > 1.0 {
        cards.refuse(&card, 1, "a share of the critical step, above 0 and at most 1");
    }
    if raw.step_safety.replace(safety).is_some() {
        twice(cards);
    }
    let least = cards.real(&card, 4);
    if least > 0.0 {
        cards.refuse(
            &card,
            4,
            "mass is only ever added: give a negative DT2MS, the least step of an element",
        );
    } else if least < 0.0 {
        raw.mass_scaling = Some(-least * safety);
        raw.mass_scaling_at = Some(card.place(4));
        if cards.whole(&card, 7) == Some(0) {
            let text = "mass is added once, before the first step, as with MS1ST = 1";
            cards.messages.note(card.place(4), text);
        }
    }
    cards.must_be_zero(&card, 5, "a curve that limits the step is not supported");
    if let Some(second) = cards.card(SECOND) {
        for field in 0..SECOND.len() {
            let remedy = "mass is added once to the elements that need it, by DT2MS alone; leave it out";
            cards.must_be_zero(&second, field, remedy);
        }
    }
    cards.end();
}

/// The interval of field `DT`; blank or 0 asks for nothing.
fn interval(cards: &mut Cards<'_, '_>, slot: fn(&mut Raw) -> &mut Option<f64>, raw: &mut Raw) {
    let Some(card) = cards.required(&["DT", "BINARY", "LCUR"]) else { return };
    let value = cards.real(&card, 0);
    if value < 0.0 {
        cards.refuse(&card, 0, "an interval is not negative");
    }
    if cards.id(&card, 2).is_some_and(|id| id > 0) {
        cards.messages.note(card.place(2), "LCUR has no effect: the interval is DT");
    }
    if value > 0.0 {
        let slot = slot(raw);
        *slot = Some(slot.map_or(value, |v| v.min(value)));
    }
}

/// States at an interval, or `NPLTC` of them, which goes before.
fn states(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    let Some(card) = cards.required(&["DT", "LCDT", "BEAM", "NPLTC", "PSETID"]) else { return };
    let value = cards.real(&card, 0);
    if value < 0.0 {
        cards.refuse(&card, 0, "an interval is not negative");
    }
    cards.must_be_zero(&card, 1, "states are written at a constant interval");
    match cards.id(&card, 3) {
        Some(0) | None => {}
        Some(count) => raw.state_count = Some(count),
    }
    if value > 0.0 {
        raw.state_interval = Some(raw.state_interval.map_or(value, |v| v.min(value)));
    }
}

fn history_nodes(cards: &mut Cards<'_, '_>, raw: &mut Raw, sets: bool) {
    const NAMES: Names = &["ID1", "ID2", "ID3", "ID4", "ID5", "ID6", "ID7", "ID8"];
    loop {
        cards.skip_blank();
        let Some(card) = cards.card(NAMES) else { return };
        for field in 0..card.len().min(8) {
            if let Some(id) = cards.id(&card, field).filter(|id| *id > 0) {
                raw.history.push((if sets { Who::Set(id) } else { Who::Node(id) }, card.place(field)));
            }
        }
    }
}

/// A node and its heading in each line.
fn named_history_nodes(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    loop {
        cards.skip_blank();
        let Some(card) = cards.card_of(&["ID", "HEADING"], &[10, 70]) else { return };
        if let Some(id) = cards.required_id(&card, 0) {
            raw.history.push((Who::Node(id), card.place(0)));
        }
    }
}
