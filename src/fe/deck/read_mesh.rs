//! Nodes, elements, parts, sections, sets, boxes and curves.

use super::card::{Cards, Names};
use super::error::At;
use super::groups::EVERYWHERE;
use super::raw::{Defined, Raw, RawBeam, RawNode, RawPart, RawSection, RawSolid, Who};

/// Reads the block if it is one of these; says whether it was.
pub(super) fn read(cards: &mut Cards<'_, '_>, raw: &mut Raw) -> bool {
    let (keyword, titled) = without_title(&cards.block.keyword);
    match keyword {
        // these have no option _TITLE: no line of theirs would be passed over
        "KEYWORD" | "COMMENT" | "TITLE" | "NODE" | "ELEMENT_SOLID" | "ELEMENT_BEAM" | "PART" if titled => {
            return false;
        }
        "KEYWORD" | "COMMENT" => {}
        "TITLE" => raw.title = cards.title().map_or(String::new(), |(text, _)| text.to_string()),
        "NODE" => nodes(cards, raw),
        "ELEMENT_SOLID" => solids(cards, raw),
        "ELEMENT_BEAM" => beams(cards, raw),
        "PART" => parts(cards, raw),
        "SECTION_SOLID" => solid_sections(cards, raw, titled),
        "SECTION_BEAM" => beam_sections(cards, raw, titled),
        "SET_NODE" | "SET_NODE_LIST" => list(cards, &mut raw.node_sets, titled),
        "SET_NODE_LIST_GENERATE" => ranges(cards, raw, titled),
        "SET_NODE_GENERAL" => general(cards, raw, titled),
        "SET_PART" | "SET_PART_LIST" => list(cards, &mut raw.part_sets, titled),
        "SET_SOLID" => list(cards, &mut raw.solid_sets, titled),
        "DEFINE_BOX" => boxes(cards, raw, titled),
        "DEFINE_CURVE" => curve(cards, raw, titled),
        _ => return false,
    }
    true
}

/// A keyword without `_TITLE`, and whether it had it.
pub(super) fn without_title(keyword: &str) -> (&str, bool) {
    match keyword.strip_suffix("_TITLE") {
        Some(base) => (base, true),
        None => (keyword, false),
    }
}

/// Enters a definition; a second one with the same identifier is an error.
pub(super) fn define<T>(cards: &mut Cards<'_, '_>, into: &mut Defined<T>, id: u64, item: T, at: At) {
    if let Some((_, first)) = into.get(&id) {
        let keyword = &cards.block.keyword;
        let same = if first.file == at.file { "" } else { " in another file" };
        let mut item = crate::base::diagnostic::Diagnostic::error(
            "duplicate-id",
            format!("*{keyword}: {id} is defined twice{same}"),
        )
        .at((at.start..at.end).into(), "again here")
        .help("give one of them another identifier");
        if first.file == at.file {
            item = item.also((first.start..first.end).into(), "first here");
        }
        cards.messages.push(at.file, item);
        return;
    }
    into.insert(id, (item, at));
}

fn nodes(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    const NAMES: Names = &["NID", "X", "Y", "Z", "TC", "RC"];
    loop {
        cards.skip_blank();
        let Some(card) = cards.card_of(NAMES, &[8, 16, 16, 16, 8, 8]) else { return };
        let Some(id) = cards.required_id(&card, 0) else { continue };
        let x = [cards.real(&card, 1), cards.real(&card, 2), cards.real(&card, 3)];
        let held = cards.whole(&card, 4).unwrap_or(0);
        if !(0..=7).contains(&held) {
            cards.refuse(&card, 4, "a code of held translations is 0 to 7");
        }
        raw.nodes.push(RawNode { id, x, held: held.clamp(0, 7) as u8, at: card.at });
    }
}

fn solids(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    const NAMES: Names = &["EID", "PID", "N1", "N2", "N3", "N4", "N5", "N6", "N7", "N8"];
    const NODES: Names = &["N1", "N2", "N3", "N4", "N5", "N6", "N7", "N8", "N9", "N10"];
    loop {
        cards.skip_blank();
        let Some(card) = cards.card_of(NAMES, &[8; 10]) else { return };
        let (id, part) = (cards.required_id(&card, 0), cards.required_id(&card, 1));
        // With the nodes on a line of their own, the first line holds two numbers only.
        let (source, first) =
            if card.len() > 2 { (Some(card.clone()), 2) } else { (cards.card_of(NODES, &[8; 10]), 0) };
        let Some(source) = source else {
            let message = format!("*ELEMENT_SOLID {}: its nodes are missing", id.unwrap_or(0));
            cards.messages.error(
                card.at,
                "missing-card",
                message,
                "",
                "eight nodes in this line or the next",
            );
            return;
        };
        let mut nodes = [0; 8];
        let mut good = true;
        for (i, node) in nodes.iter_mut().enumerate() {
            match cards.id(&source, first + i) {
                Some(found) => *node = found,
                None => good = false,
            }
        }
        if source.len() > first + 8
            && (first == 0 && (cards.id(&source, 8), cards.id(&source, 9)) != (Some(0), Some(0)))
        {
            cards.refuse(&source, 8, "only hexahedra with eight nodes are read");
            good = false;
        }
        if let (Some(id), Some(part), true) = (id, part, good) {
            raw.solids.push(RawSolid { id, part, nodes, at: card.at });
        }
    }
}

fn beams(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    const NAMES: Names = &["EID", "PID", "N1", "N2", "N3", "RT1", "RR1", "RT2", "RR2", "LOCAL"];
    loop {
        cards.skip_blank();
        let Some(card) = cards.card_of(NAMES, &[8; 10]) else { return };
        let ids = [0, 1, 2, 3].map(|i| cards.required_id(&card, i));
        for field in 5..9 {
            cards.must_be_zero(&card, field, "bars transmit axial force only: no releases");
        }
        if let [Some(id), Some(part), Some(a), Some(b)] = ids {
            raw.beams.push(RawBeam { id, part, nodes: [a, b], at: card.at });
        }
    }
}

fn parts(cards: &mut Cards<'_, '_>, raw: &mut Raw) {
    const NAMES: Names = &["PID", "SECID", "MID", "EOSID", "HGID", "GRAV", "ADPOPT", "TMID"];
    while cards.more() {
        let name = cards.title().map_or("", |(text, _)| text).to_string();
        let Some(card) = cards.required(NAMES) else { return };
        let id = cards.required_id(&card, 0);
        let (section, material) = (cards.required_id(&card, 1), cards.required_id(&card, 2));
        cards.must_be_zero(&card, 3, "equations of state are not supported; use a material without one");
        let hourglass = cards.id(&card, 4);
        cards.must_be_zero(&card, 5, "loads by density are not supported; use *LOAD_BODY");
        cards.must_be_zero(&card, 6, "adaptive meshes are not supported");
        if let (Some(id), Some(section), Some(material), Some(hourglass)) = (id, section, material, hourglass)
        {
            let name = if name.is_empty() { format!("part {id}") } else { name };
            raw.parts.push(RawPart { id, name, section, material, hourglass, at: card.at });
        }
    }
}

fn solid_sections(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    const NAMES: Names = &["SECID", "ELFORM", "AET"];
    while cards.more() {
        cards.skip_title(titled);
        let Some(card) = cards.required(NAMES) else { return };
        let (id, form) = (cards.required_id(&card, 0), cards.whole(&card, 1));
        cards.must_be_zero(&card, 2, "ambient elements are not supported");
        let full = match form {
            Some(0 | 1) => false,
            Some(2) => true,
            Some(-1 | -2) => {
                let text = "ELFORM -1 and -2 are computed as 2: fully integrated, volume strain averaged";
                cards.messages.note(card.place(1), text);
                true
            }
            Some(_) => {
                cards.refuse(&card, 1, "ELFORM is 1 (one point) or 2, -1, -2 (fully integrated)");
                continue;
            }
            None => continue,
        };
        if let Some(id) = id {
            define(cards, &mut raw.sections, id, RawSection::Solid { full }, card.place(0));
        }
    }
}

fn beam_sections(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    const FIRST: Names = &["SECID", "ELFORM", "SHRF", "QR", "CST", "SCOOR", "NSM"];
    const TRUSS: Names = &["A", "RAMPT", "STRESS"];
    while cards.more() {
        cards.skip_title(titled);
        let Some(card) = cards.required(FIRST) else { return };
        let (id, form) = (cards.required_id(&card, 0), cards.whole(&card, 1));
        cards.must_be_zero(&card, 6, "non-structural mass is not supported");
        let Some(second) = cards.required(TRUSS) else { return };
        if form != Some(3) {
            if form.is_some() {
                cards.refuse(&card, 1, "beams are bars with axial force only: ELFORM 3");
            }
            continue;
        }
        let area = cards.positive(&second, 0);
        cards.must_be_zero(&second, 1, "bars start without stress");
        cards.must_be_zero(&second, 2, "bars start without stress");
        if let Some(id) = id {
            define(cards, &mut raw.sections, id, RawSection::Truss { area }, card.place(0));
        }
    }
}

const EIGHT: Names = &["ID1", "ID2", "ID3", "ID4", "ID5", "ID6", "ID7", "ID8"];
const SET: Names = &["SID", "DA1", "DA2", "DA3", "DA4", "SOLVER"];

fn list(cards: &mut Cards<'_, '_>, into: &mut Defined<Vec<u64>>, titled: bool) {
    cards.skip_title(titled);
    let Some(head) = cards.required(SET) else { return };
    let id = cards.required_id(&head, 0);
    let mut items = Vec::new();
    loop {
        cards.skip_blank();
        let Some(card) = cards.card(EIGHT) else { break };
        for field in 0..card.len().min(8) {
            if let Some(item) = cards.id(&card, field).filter(|i| *i > 0) {
                items.push(item);
            }
        }
    }
    if let Some(id) = id {
        define(cards, into, id, items, head.place(0));
    }
}

fn ranges(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    cards.skip_title(titled);
    let Some(head) = cards.required(SET) else { return };
    let id = cards.required_id(&head, 0);
    let mut items = Vec::new();
    loop {
        cards.skip_blank();
        let Some(card) =
            cards.card(&["B1BEG", "B1END", "B2BEG", "B2END", "B3BEG", "B3END", "B4BEG", "B4END"])
        else {
            break;
        };
        for pair in 0..card.len().min(8).div_ceil(2) {
            if let (Some(from), Some(to)) = (cards.id(&card, 2 * pair), cards.id(&card, 2 * pair + 1)) {
                match (from, to) {
                    (0, 0) => {}
                    (from, to) if from <= to => items.push([from, to]),
                    _ => cards.refuse(&card, 2 * pair + 1, "a range ends at or after its beginning"),
                }
            }
        }
    }
    if let Some(id) = id {
        define(cards, &mut raw.node_ranges, id, items, head.place(0));
    }
}

/// A set of all nodes, of nodes by identifier, of parts.
fn general(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    const NAMES: Names = &["OPTION", "E1", "E2", "E3", "E4", "E5", "E6", "E7"];
    cards.skip_title(titled);
    let Some(head) = cards.required(SET) else { return };
    let id = cards.required_id(&head, 0);
    let mut items = Vec::new();
    loop {
        cards.skip_blank();
        let Some(card) = cards.card(NAMES) else { break };
        let of: fn(u64) -> Who = match &card.text(0).to_uppercase()[..] {
            "ALL" => {
                items.push(Who::All);
                continue;
            }
            "NODE" => Who::Node,
            "PART" => Who::Part,
            _ => {
                cards.refuse(&card, 0, "ALL, NODE or PART; other ways to make sets are not supported");
                continue;
            }
        };
        for field in 1..card.len().min(8) {
            items.extend(cards.id(&card, field).filter(|i| *i > 0).map(of));
        }
    }
    if let Some(id) = id {
        define(cards, &mut raw.node_general, id, items, head.place(0));
    }
}

fn boxes(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    const NAMES: Names = &["BOXID", "XMN", "XMX", "YMN", "YMX", "ZMN", "ZMX"];
    while cards.more() {
        cards.skip_title(titled);
        let Some(card) = cards.required(NAMES) else { return };
        let mut sides = [0, 1, 2].map(|i| [cards.real(&card, 1 + 2 * i), cards.real(&card, 2 + 2 * i)]);
        for (i, [least, most]) in sides.into_iter().enumerate() {
            if least > most {
                cards.refuse(
                    &card,
                    1 + 2 * i,
                    "the lower limit comes first, and then one that is not below it",
                );
            }
            if least > most || least.is_nan() || most.is_nan() {
                sides = EVERYWHERE;
            }
        }
        if let Some(id) = cards.required_id(&card, 0) {
            define(cards, &mut raw.boxes, id, sides, card.place(0));
        }
    }
}

/// Values are `SFA (a + OFFA)` over `SFO (o + OFFO)`.
fn curve(cards: &mut Cards<'_, '_>, raw: &mut Raw, titled: bool) {
    const NAMES: Names = &["LCID", "SIDR", "SFA", "SFO", "OFFA", "OFFO", "DATTYP", "LCINT"];
    cards.skip_title(titled);
    let Some(head) = cards.required(NAMES) else { return };
    let id = cards.required_id(&head, 0);
    if cards.whole(&head, 1) == Some(1) {
        cards.refuse(&head, 1, "a curve for dynamic relaxation only is not supported; SIDR is 0 or 2");
    }
    let (sfa, sfo) = (cards.real_or(&head, 2, 1.0), cards.real_or(&head, 3, 1.0));
    let (offa, offo) = (cards.real(&head, 4), cards.real(&head, 5));
    let mut points: Vec<[f64; 2]> = Vec::new();
    loop {
        cards.skip_blank();
        let Some(card) = cards.card_of(&["A1", "O1"], &[20; 2]) else { break };
        let (a, o) = (cards.real(&card, 0), cards.real(&card, 1));
        // no sum with a zero offset: it would turn -0 into 0
        let moved = |value: f64, offset: f64| if offset == 0.0 { value } else { value + offset };
        let point = [sfa * moved(a, offa), sfo * moved(o, offo)];
        if points.last().is_some_and(|last| point[0] <= last[0]) {
            cards.refuse(&card, 0, "abscissas increase from point to point");
        }
        if point.iter().all(|v| v.is_finite()) {
            points.push(point);
        } else if !a.is_nan() && !o.is_nan() {
            cards.refuse(&card, 1, "with its scale and offset it is too large");
        }
    }
    if points.is_empty() {
        let message = format!("*{}: the curve has no points", cards.block.keyword);
        cards.messages.error(
            head.at,
            "missing-card",
            message,
            "",
            "a line with abscissa and ordinate for each point",
        );
    }
    if let Some(id) = id {
        define(cards, &mut raw.curves, id, points, head.place(0));
    }
}
