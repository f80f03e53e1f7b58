//! Constraints, loads, initial velocities, rigid walls, contact.

use super::card::{Card, Cards, Names};
use super::raw::{Raw, RawDrive, RawHistory, RawHold, RawStart, RawWall, Who};
use crate::fe::model::ContactSettings;

/// Reads the block if it is one of these; says whether it was.
pub(super) fn read(cards: &mut Cards<'_, '_>, raw: &mut Raw) -> bool {
    let whole = &cards.block.keyword;
    let (keyword, titled) = match whole.strip_suffix("_ID").or_else(|| whole.strip_suffix("_TITLE")) {
        Some(base) => (base, true),
        None => (&whole[..], false),
    };
    match keyword {
        // these have neither _ID nor _TITLE
        _ if titled && (keyword.starts_with("LOAD_BODY") || keyword.starts_with("INITIAL_VELOCITY")) => {
            return false;
        }
        "BOUNDARY_SPC_NODE" | "BOUNDARY_SPC_SET" => holds(cards, raw, titled, keyword.ends_with("SET")),
        "BOUNDARY_PRESCRIBED_MOTION_NODE" | "BOUNDARY_PRESCRIBED_MOTION_SET" => {
            driven(cards, raw, titled, keyword.ends_with("SET"));
        }
        "LOAD_BODY_X" => body_load(cards, raw, 0),
        "LOAD_BODY_Y" => body_load(cards, raw, 1),
        "LOAD_BODY_Z" => body_load(cards, raw, 2),
        "LOAD_NODE_POINT" | "LOAD_NODE_SET" => nodal_loads(cards, raw, titled, keyword.ends_with("SET")),
        "INITIAL_VELOCITY" => velocity(cards, raw),
        "INITIAL_VELOCITY_GENERATION" => velocity_of_parts(cards, raw),
        "INITIAL_VELOCITY_NODE" => velocity_of_nodes(cards, raw),
        "CONTACT_AUTOMATIC_SINGLE_SURFACE" | "CONTACT_ERODING_SINGLE_SURFACE" => {
            contact(cards, raw, titled, keyword.contains("ERODING"));
        }
        _ if keyword.starts_with("RIGIDWALL_PLANAR") => walls(cards, raw, titled, keyword),
        _ => return false,
    }
    true
}

/// A node or a set of nodes.
fn who<'a>(cards: &mut Cards<'a, '_>, card: &Card<'a>, set: bool) -> Option<Who> {
    let id = cards.required_id(card, 0)?;
    Some(if set { Who::Set(id) } else { Who::Node(id) })
}

fn no_local_axes<'a>(cards: &mut Cards<'a, '_>, card: &Card<'a>, field: usize) {
    cards.must_be_zero(card, field, "local coordinate systems are not supported; use the global axes");
}

fn holds(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool, set: bool) {
    const NAMES: Names = &["NID/NSID", "CID", "DOFX", "DOFY", "DOFZ", "DOFRX", "DOFRY", "DOFRZ"];
    while let Some(card) = cards.entry(titled, NAMES) {
        let found = who(cards, &card, set);
        no_local_axes(cards, &card, 1);
        let mut held = [false; 3];
        for (i, held) in held.iter_mut().enumerate() {
            match cards.whole(&card, 2 + i) {
                Some(code @ (0 | 1)) => *held = code == 1,
                Some(_) => cards.refuse(&card, 2 + i, "1 for held, 0 for free"),
                None => {}
            }
        }
        if let Some(who) = found {
            raw.holds.push(RawHold { who, held, at: card.place(0) });
        }
    }
}

/// Axis of a degree of freedom 1 to 3.
fn axis<'a>(cards: &mut Cards<'a, '_>, card: &Card<'a>, field: usize) -> Option<usize> {
    match cards.whole(card, field)? {
        dof @ 1..=3 => Some(dof as usize - 1),
        _ => {
            cards.refuse(card, field, "1, 2 or 3: a translation along x, y or z");
            None
        }
    }
}

/// Curve and factor (blank or 0: 1).
fn history<'a>(
    cards: &mut Cards<'a, '_>,
    card: &Card<'a>,
    curve: usize,
    factor: usize,
) -> Option<RawHistory> {
    let factor = cards.real_or(card, factor, 1.0);
    Some(RawHistory { curve: cards.required_id(card, curve)?, factor })
}

fn driven(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool, set: bool) {
    const NAMES: Names = &["NID/NSID", "DOF", "VAD", "LCID", "SF", "VID", "DEATH", "BIRTH"];
    while let Some(card) = cards.entry(titled, NAMES) {
        let (who, axis) = (who(cards, &card, set), axis(cards, &card, 1));
        cards.must_be_zero(&card, 2, "only velocities are given to nodes: VAD = 0");
        let history = history(cards, &card, 3, 4);
        cards.must_be_zero(&card, 5, "motion along a vector is not supported; give components");
        cards.must_be_never(&card, 6);
        cards.must_be_zero(&card, 7, "what is given acts from the beginning; leave BIRTH out");
        if let (Some(who), Some(axis), Some(history)) = (who, axis, history) {
            raw.driven.push(RawDrive { who, axis, history, at: card.place(0) });
        }
    }
}

/// A positive value accelerates the mass against the axis: it is the acceleration of the base on which the model stands
/// (LS-DYNA Keyword User's Manual I, `*LOAD_BODY`: "positive body load acts in the negative direction").
fn body_load(cards: &mut Cards<'_, '_>, raw: &mut Raw, axis: usize) {
    const NAMES: Names = &["LCID", "SF", "LCIDDR", "XC", "YC", "ZC", "CID"];
    let Some(card) = cards.required(NAMES) else { return };
    let history = history(cards, &card, 0, 1);
    if cards.id(&card, 2).is_some_and(|id| id > 0) {
        cards.messages.note(card.place(2), "LCIDDR has no effect: there is no dynamic relaxation");
    }
    no_local_axes(cards, &card, 6);
    cards.end();
    if let Some(history) = history {
        let history = RawHistory { factor: -history.factor, ..history };
        raw.body_loads.push(RawDrive { who: Who::All, axis, history, at: card.place(0) });
    }
}

fn nodal_loads(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool, set: bool) {
    const NAMES: Names = &["NID/NSID", "DOF", "LCID", "SF", "CID", "M1", "M2", "M3"];
    while let Some(card) = cards.entry(titled, NAMES) {
        let (who, axis, history) =
            (who(cards, &card, set), axis(cards, &card, 1), history(cards, &card, 2, 3));
        no_local_axes(cards, &card, 4);
        if let (Some(who), Some(axis), Some(history)) = (who, axis, history) {
            raw.nodal_loads.push(RawDrive { who, axis, history, at: card.place(0) });
        }
    }
}

fn velocity(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    const FIRST: Names = &["NSID", "NSIDEX", "BOXID", "IRIGID", "ICID"];
    const SECOND: Names = &["VX", "VY", "VZ"];
    const THIRD: Names = &["VXE", "VYE", "VZE"];
    while cards.more() {
        let Some(first) = cards.required(FIRST) else { return };
        let Some(second) = cards.required(SECOND) else { return };
        let ids = [0, 1, 2].map(|i| cards.id(&first, i));
        no_local_axes(cards, &first, 4);
        let velocity = [0, 1, 2].map(|i| cards.real(&second, i));
        let [Some(set), Some(without), Some(inside)] = ids else { continue };
        let without = (without > 0).then(|| {
            let others = cards.card(THIRD);
            (without, others.map(|card| [0, 1, 2].map(|i| cards.real(&card, i))))
        });
        let who = if set == 0 { Who::All } else { Who::Set(set) };
        let inside = (inside > 0).then_some(inside);
        raw.starts.push(RawStart { who, without, inside, velocity, spin: None, at: first.at });
    }
}

fn velocity_of_parts(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    const FIRST: Names = &["ID", "STYP", "OMEGA", "VX", "VY", "VZ", "IVATN", "ICID"];
    const SECOND: Names = &["XC", "YC", "ZC", "NX", "NY", "NZ", "PHASE", "IRIGID"];
    while cards.more() {
        let Some(first) = cards.required(FIRST) else { return };
        let second = cards.card(SECOND);
        let (id, kind) = (cards.id(&first, 0), cards.whole(&first, 1));
        let who = match (id, kind) {
            (Some(0), Some(_)) => Who::All,
            (Some(id), Some(1)) => Who::PartSet(id),
            (Some(id), Some(2)) => Who::Part(id),
            (Some(id), Some(3)) => Who::Set(id),
            (Some(_), Some(_)) => {
                cards.refuse(&first, 1, "1 for a set of parts, 2 for a part, 3 for a set of nodes");
                continue;
            }
            _ => continue,
        };
        no_local_axes(cards, &first, 7);
        let omega = cards.real(&first, 2);
        let velocity = [3, 4, 5].map(|i| cards.real(&first, i));
        let mut spin = None;
        if let Some(second) = second {
            cards.must_be_zero(&second, 6, "velocities are set at the beginning: PHASE = 0");
            let center = [0, 1, 2].map(|i| cards.real(&second, i));
            let axis = [3, 4, 5].map(|i| cards.real(&second, i));
            let length = axis.iter().map(|n| n * n).sum::<f64>().sqrt();
            if omega != 0.0 && (!normal_length(&axis) || axis[0] == -999.0) {
                cards.refuse(&second, 3, "the axis of rotation is given by the components of a vector");
            } else if omega != 0.0 {
                spin = Some((axis.map(|n| omega * n / length), center));
            }
        } else if omega != 0.0 && !omega.is_nan() {
            cards.refuse(&first, 2, "a rotation needs a second line with its axis");
        }
        raw.starts.push(RawStart { who, without: None, inside: None, velocity, spin, at: first.at });
    }
}

fn velocity_of_nodes(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    const NAMES: Names = &["NID", "VX", "VY", "VZ", "VXR", "VYR", "VZR", "ICID"];
    loop {
        cards.skip_blank();
        let Some(card) = cards.card(NAMES) else { return };
        let who = who(cards, &card, false);
        let velocity = [1, 2, 3].map(|i| cards.real(&card, i));
        no_local_axes(cards, &card, 7);
        if let Some(who) = who {
            raw.starts.push(RawStart {
                who,
                without: None,
                inside: None,
                velocity,
                spin: None,
                at: card.place(0),
            });
        }
    }
}

/// Whether the length of a vector can be divided by: neither lost nor without bounds. So is one with an error in it.
fn normal_length(vector: &[f64; 3]) -> bool {
    let square: f64 = vector.iter().map(|c| c * c).sum();
    square.is_normal() || square.is_nan()
}

/// Friction: 0 to 1 Coulomb, exactly 1 no slip.
fn walls(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool, keyword: &str) {
    const FIRST: Names = &["NSID", "NSIDEX", "BOXID", "OFFSET", "BIRTH", "DEATH"];
    const SECOND: Names = &["XT", "YT", "ZT", "XH", "YH", "ZH", "FRIC", "WVEL"];
    let options = &keyword["RIGIDWALL_PLANAR".len()..];
    if let Some(option) = options.split('_').find(|o| !matches!(*o, "" | "ID" | "DISPLAY")) {
        let message = format!("*{}: the option {option} is not supported", cards.block.keyword);
        let help = "walls are infinite and do not move: *RIGIDWALL_PLANAR, with _ID if wanted";
        cards.messages.error(cards.block.at, "unsupported-option", message, "", help);
        return;
    }
    let titled = titled || options.contains("_ID");
    while cards.more() {
        cards.skip_title(titled);
        let (Some(first), Some(second)) = (cards.required(FIRST), cards.required(SECOND)) else { return };
        let (set, without, within) = (cards.id(&first, 0), cards.id(&first, 1), cards.real(&first, 3));
        cards.must_be_zero(&first, 2, "boxes are not supported here; give a set of nodes");
        cards.must_be_zero(&first, 4, "walls stand from the beginning; leave BIRTH out");
        cards.must_be_never(&first, 5);
        let tail = [0, 1, 2].map(|i| cards.real(&second, i));
        let head = [3, 4, 5].map(|i| cards.real(&second, i));
        let friction = cards.real(&second, 6);
        if !(0.0..=1.0).contains(&friction) && !friction.is_nan() {
            cards.refuse(&second, 6, "0 to 1, where 1 means that nothing slips (welding is not supported)");
        }
        cards.must_be_zero(&second, 7, "walls do not move");
        if within < 0.0 {
            cards.refuse(&first, 3, "a distance is not negative");
        }
        if tail == head {
            cards.refuse(
                &second,
                3,
                "the normal points from (XT, YT, ZT) to (XH, YH, ZH), which are the same point",
            );
        } else if !normal_length(&std::array::from_fn(|i| head[i] - tail[i])) {
            cards.refuse(&second, 3, "give the two points of the normal a distance that can be squared");
        }
        if let (Some(set), Some(without)) = (set, without) {
            let friction = if friction == 1.0 { f64::INFINITY } else { friction };
            raw.walls.push(RawWall { set, without, within, tail, head, friction, at: second.at });
        }
        if options.contains("DISPLAY") {
            cards.card(&["PID", "RO", "E", "PR"]);
        }
    }
}

fn contact(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool, eroding: bool) {
    const FIRST: Names = &["SSID", "MSID", "SSTYP", "MSTYP", "SBOXID", "MBOXID"];
    const SECOND: Names = &["FS", "FD", "DC", "VC", "VDC", "PENCHK", "BT", "DT"];
    const THIRD: Names = &["SFS", "SFM", "SST", "MST", "SFST", "SFMT", "FSF", "VSF"];
    cards.skip_title(titled);
    let Some(first) = cards.required(FIRST) else { return };
    let settings = ContactSettings { friction: 0.0 };
    match (cards.id(&first, 0), cards.whole(&first, 2)) {
        (Some(0), Some(_)) | (Some(_), Some(5)) | (None, _) | (_, None) => {}
        (Some(id), Some(2)) => raw.contact_parts = Some((Who::PartSet(id), first.place(0))),
        (Some(id), Some(3)) => raw.contact_parts = Some((Who::Part(id), first.place(0))),
        _ => cards.refuse(&first, 0, "contact is between all outer faces of the model: SSID = 0"),
    }
    cards.must_be_zero(&first, 4, "contact is between all outer faces of the model");
    let second = cards.card(SECOND);
    let third = cards.card(THIRD);
    if eroding {
        cards.card(&["ISYM", "EROSOP", "IADJ"]);
    }
    let mut settings = settings;
    if let Some(card) = second {
        settings.friction = cards.real(&card, 0);
        if settings.friction < 0.0 {
            cards.refuse(&card, 0, "a friction coefficient is not negative (curves are not supported)");
        }
        let dynamic = cards.real(&card, 1);
        if cards.real(&card, 2) != 0.0 && dynamic != settings.friction {
            cards
                .messages
                .note(card.place(1), "friction does not depend on speed: FS acts, FD and DC do not");
        }
        cards.must_be_zero(&card, 6, "contact acts from the beginning; leave BT out");
        cards.must_be_never(&card, 7);
    }
    if let Some(card) = third {
        let factor = cards.real_or(&card, 0, 1.0);
        if factor <= 0.0 {
            cards.refuse(&card, 0, "a factor is positive");
        } else if factor != 1.0 {
            let text = "contact is kinematic and has no stiffness: SFS has no effect";
            cards.messages.note(card.place(0), text);
        }
    }
    if cards.more() {
        cards.messages.note(cards.block.at, "the optional cards of the contact have no effect");
    }
    if raw.contact.replace(settings).is_some() {
        let message = format!("*{}: a second contact of the model with itself", cards.block.keyword);
        cards.messages.error(cards.block.at, "duplicate", message, "", "keep one of them");
    }
}
