//! From a deck to a model: the entry points, parameters, and which reader takes which keyword.

use super::assemble::assemble;
use super::blame::Places;
use super::card::{Cards, Parameters};
use super::error::{DeckErrors, Messages, Note};
use super::lines::{Block, Splitter, read_file};
use super::raw::Raw;
use super::{number, read_control, read_load, read_material, read_mesh};
use crate::base::diagnostic::{Diagnostic, closest, quoted};
use crate::base::source::{Source, Unreadable};
use crate::fe::model::Model;
use std::path::Path;

/// How a deck is read.
#[derive(Debug, Clone, Copy, Default)]
pub struct DeckOptions {
    /// Unknown keywords are noted and left out instead of being errors.
    pub skip_unknown: bool,
    /// When the run is to end, if not at the deck's own time \[s\]: curves have to span the run. The model keeps the time of the deck.
    pub end_time_s: Option<f64>,
}

/// The identifiers that a deck gives to what the model knows by index.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Ids {
    /// Of the nodes.
    pub nodes: Vec<u64>,
    /// Of the hexahedra.
    pub elements: Vec<u64>,
    /// Of the bars.
    pub trusses: Vec<u64>,
    /// Of the parts.
    pub parts: Vec<u64>,
}

/// A deck that has been read.
#[derive(Debug, Clone)]
pub struct Deck {
    /// The model.
    pub model: Model,
    /// Identifiers by index.
    pub ids: Ids,
    /// What has no effect, or another one than elsewhere.
    pub notes: Vec<Note>,
    /// Where the values stand that may keep the model from being run.
    pub places: Places,
}

/// Endings of the names of decks.
pub const DECK_ENDINGS: [&str; 4] = ["k", "key", "dyn", "keyword"];

/// Whether a file is to be read as a keyword deck: by its ending, or else by its first line that is no comment.
pub fn is_deck(path: &Path) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match &ending[..] {
        known if DECK_ENDINGS.contains(&known) => true,
        "toml" | "json" => false,
        _ => {
            use std::io::Read;
            let mut head = Vec::new();
            let opened = std::fs::File::open(path).and_then(|f| f.take(65_536).read_to_end(&mut head));
            let text = String::from_utf8_lossy(&head);
            let text = text.trim_start_matches('\u{feff}');
            let mut lines = text.lines().filter(|l| !l.trim().is_empty() && !l.starts_with('$'));
            opened.is_ok() && lines.next().is_some_and(|l| l.starts_with('*'))
        }
    }
}

/// Reads a deck and the files it includes.
pub fn read(path: &Path, options: DeckOptions) -> Result<Deck, DeckErrors> {
    match read_file(path) {
        Ok(source) => of_source(source, Some(path), options, &read_file),
        Err(problem) => {
            let mut messages = Messages::default();
            messages.push(0, Diagnostic::error("unreadable", problem.message).help(problem.remedy));
            of_messages(messages, Source::new(path.display().to_string(), ""))
        }
    }
}

/// Reads a deck from text, which may not include files; `file_name` appears in messages.
pub fn parse(text: &str, file_name: &str, options: DeckOptions) -> Result<Deck, DeckErrors> {
    let none = |_: &Path| {
        Err(Unreadable {
            message: "a deck given as text has no files beside it".into(),
            remedy: "put the text of the file in its place".into(),
        })
    };
    of_source(Source::new(file_name, text), None, options, &none)
}

fn of_messages(messages: Messages, source: Source) -> Result<Deck, DeckErrors> {
    let notes = messages.finish(&[source.into()])?;
    Ok(Deck { model: Model::default(), ids: Ids::default(), notes, places: Places::default() })
}

fn of_source(
    source: Source,
    path: Option<&Path>,
    options: DeckOptions,
    open: &dyn Fn(&Path) -> Result<Source, Unreadable>,
) -> Result<Deck, DeckErrors> {
    let mut messages = Messages::default();
    if source.text.trim().is_empty() {
        messages
            .push(0, Diagnostic::error("empty", "the deck is empty").help("a deck begins with `*KEYWORD`"));
        return of_messages(messages, source);
    }
    let split = Splitter::run(source, path, open, &mut messages);
    let mut raw = Raw::default();
    let mut parameters = Parameters::new();
    for block in &split.blocks {
        let text = &split.files[block.at.file].text[..];
        if block.keyword == "PARAMETER" || block.keyword == "PARAMETER_LOCAL" {
            read_parameters(block, text, &mut parameters, &mut messages);
            continue;
        }
        let mut cards = Cards::new(block, text, &parameters, &mut messages);
        let known = read_mesh::read(&mut cards, &mut raw)
            || read_material::read(&mut cards, &mut raw)
            || read_load::read(&mut cards, &mut raw)
            || read_control::read(&mut cards, &mut raw);
        if !known {
            unknown(block, options, &mut messages);
        }
    }
    let assembled = assemble(&raw, options.end_time_s, &mut messages);
    let notes = messages.finish(&split.files)?;
    let (model, ids) = assembled.unwrap_or_default();
    let places = Places::of(split.files, &raw);
    Ok(Deck { model, ids, notes, places })
}

/// Keywords that are read; options `_TITLE` and `_ID` are understood where they exist.
pub(super) const KEYWORDS: &[&str] = &[
    "KEYWORD",
    "TITLE",
    "END",
    "INCLUDE",
    "INCLUDE_PATH",
    "INCLUDE_PATH_RELATIVE",
    "PARAMETER",
    "COMMENT",
    "NODE",
    "ELEMENT_SOLID",
    "ELEMENT_BEAM",
    "PART",
    "SECTION_SOLID",
    "SECTION_BEAM",
    "SET_NODE_LIST",
    "SET_NODE_LIST_GENERATE",
    "SET_NODE_GENERAL",
    "SET_NODE",
    "SET_PART_LIST",
    "SET_PART",
    "SET_SOLID",
    "DEFINE_BOX",
    "DEFINE_CURVE",
    "MAT_ELASTIC",
    "MAT_PLASTIC_KINEMATIC",
    "MAT_PIECEWISE_LINEAR_PLASTICITY",
    "MAT_ADD_EROSION",
    "HOURGLASS",
    "CONTROL_HOURGLASS",
    "BOUNDARY_SPC_NODE",
    "BOUNDARY_SPC_SET",
    "BOUNDARY_PRESCRIBED_MOTION_NODE",
    "BOUNDARY_PRESCRIBED_MOTION_SET",
    "LOAD_BODY_X",
    "LOAD_BODY_Y",
    "LOAD_BODY_Z",
    "LOAD_NODE_POINT",
    "LOAD_NODE_SET",
    "INITIAL_VELOCITY",
    "INITIAL_VELOCITY_GENERATION",
    "INITIAL_VELOCITY_NODE",
    "RIGIDWALL_PLANAR",
    "CONTACT_AUTOMATIC_SINGLE_SURFACE",
    "CONTACT_ERODING_SINGLE_SURFACE",
    "CONTROL_TERMINATION",
    "CONTROL_TIMESTEP",
    "CONTROL_BULK_VISCOSITY",
    "CONTROL_ENERGY",
    "CONTROL_DYNAMIC_RELAXATION",
    "DATABASE_BINARY_D3PLOT",
    "DATABASE_NODOUT",
    "DATABASE_GLSTAT",
    "DATABASE_MATSUM",
    "DATABASE_HISTORY_NODE",
    "DATABASE_HISTORY_NODE_SET",
];

fn unknown(block: &Block, options: DeckOptions, messages: &mut Messages) {
    if options.skip_unknown {
        messages.note(block.at, format!("*{} is left out: it is not known here", block.keyword));
        return;
    }
    let message = format!("keyword {} is not known", quoted(&format!("*{}", block.keyword)));
    let near = closest(&block.keyword, KEYWORDS.iter().copied());
    let help = match near {
        _ if block.keyword.starts_with("PARAMETER_EXPRESSION") => {
            "expressions are not computed: put their values into *PARAMETER".into()
        }
        Some(near) => format!("did you mean `*{near}`? --skip-unknown leaves unknown keywords out"),
        None => {
            "take it out; --skip-unknown leaves unknown keywords out (docs/decks.md lists the known ones)"
                .into()
        }
    };
    messages.error(block.at, "unknown-keyword", message, "", &help);
}

/// `*PARAMETER`: up to four pairs of a name, with its type before it, and a value.
fn read_parameters(block: &Block, text: &str, parameters: &mut Parameters, messages: &mut Messages) {
    const NAMES: &[&str] = &["PRMR1", "VAL1", "PRMR2", "VAL2", "PRMR3", "VAL3", "PRMR4", "VAL4"];
    let before = parameters.clone();
    let mut cards = Cards::new(block, text, &before, messages);
    loop {
        cards.skip_blank();
        let Some(card) = cards.card(NAMES) else { return };
        for pair in 0..4 {
            let named = card.text(2 * pair);
            if named.is_empty() {
                continue;
            }
            let (kind, name) = named.split_at(named.chars().next().map_or(0, char::len_utf8));
            let name = name.trim();
            let kind_known = matches!(kind, "R" | "r" | "I" | "i");
            if !kind_known || name.is_empty() || !name.chars().all(|c| c.is_alphanumeric() || c == '_') {
                cards.refuse(&card, 2 * pair, "a name with its type before it: `R name` or `I name`");
                continue;
            }
            let value = match number::real(card.text(2 * pair + 1)) {
                Some(value) => value,
                None => cards.real(&card, 2 * pair + 1),
            };
            if value.is_finite() {
                parameters.insert(name.to_uppercase(), value);
            }
        }
    }
}
