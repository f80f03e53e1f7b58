//! Decks with random damage, the same ones in each run: an error with its line, or a model that is written and read again.

use super::foreign::{FULL, SPARSE};
use super::same;
use fallwerk::fe::deck::{DeckOptions, normalised, parse, write};

const CASES: usize = 3000;

const CANTILEVER: &str = include_str!("../../../decks/cantilever.k");
const FALLING_BAR: &str = include_str!("../../../decks/falling-bar.k");

/// Fields that programs trip over.
const FIELDS: [&str; 24] = [
    "1e400",
    "1e308",
    "-1e308",
    "1e-320",
    "99999999999999999999999999",
    "18446744073709551616",
    "-9223372036854775808",
    "2147483648",
    "-1",
    "0",
    "0.0",
    "-0.0",
    "nan",
    "inf",
    "1e",
    "1.0+",
    "&x",
    "-&e",
    "*",
    "$",
    ",",
    ",,,,,,,,,,,",
    "\t",
    "é",
];

/// Xorshift (Marsaglia 2003).
struct Chance(u64);

impl Chance {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }
}

/// Byte of a character boundary at or before `at`.
fn boundary(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0)
}

/// A line with columns `at` to `at + width` replaced.
fn put(line: &str, at: usize, width: usize, field: &str) -> String {
    let (from, to) = (boundary(line, at), boundary(line, at + width));
    format!("{:<at$}{field:>width$}{}", &line[..from], &line[to.max(from)..])
}

fn damage(lines: &mut Vec<String>, chance: &mut Chance) {
    // most of the kinds of lines stand at the head
    let reach = if chance.below(3) > 0 { lines.len().min(110) } else { lines.len() };
    let i = chance.below(reach);
    let Some(line) = lines.get(i).cloned() else { return };
    let field = FIELDS[chance.below(FIELDS.len())];
    let at = boundary(&line, chance.below(line.len() + 1));
    match chance.below(10) {
        0 => drop(lines.remove(i)),
        1 => lines.truncate(i),
        2 => lines[i] = line.chars().rev().collect(),
        3 => lines[i] = put(&line, 10 * chance.below(8), 10, field),
        4 => lines[i] = put(&line, 8 * chance.below(10), 8, field),
        5 => lines[i] = format!("{}{field}{}", &line[..at], &line[at..]),
        6 => lines[i].truncate(at),
        7 => {
            let to = chance.below(lines.len());
            lines.insert(to, line);
        }
        8 => {
            let other = chance.below(lines.len());
            lines.swap(i, other);
        }
        _ => {
            let keywords: Vec<&String> = lines.iter().filter(|l| l.starts_with('*')).collect();
            let keyword = keywords.get(chance.below(keywords.len())).map_or("*END", |k| &k[..]);
            lines[i] = keyword.to_string() + ["", "+", "%", " -", "_TITLE", "_ID", "_SET"][chance.below(7)];
        }
    }
}

#[test]
fn damaged_decks_give_an_error_with_its_line_or_a_model() {
    let mut chance = Chance(0x9e37_79b9_7f4a_7c15);
    let (mut refused, mut accepted) = (0, 0);
    for case in 0..CASES {
        let deck = [SPARSE, FULL, FALLING_BAR, CANTILEVER][case % 4];
        let mut lines: Vec<String> = deck.lines().map(String::from).collect();
        for _ in 0..[1, 1, 1, 3][chance.below(4)] {
            damage(&mut lines, &mut chance);
        }
        let text = lines.join("\n");
        match parse(&text, "deck.k", DeckOptions { skip_unknown: case % 3 == 0, ..DeckOptions::default() }) {
            Err(errors) => {
                refused += 1;
                let said = errors.render(false);
                let placed = said.contains("--> deck.k:") || said.contains("error[empty]");
                assert!(placed && errors.items().count() > 0, "case {case}: {said}\n{text}");
            }
            Ok(deck) => {
                accepted += 1;
                let written = write(&deck.model, &[]).text;
                let again = parse(&written, "again.k", DeckOptions::default());
                let again = again.unwrap_or_else(|e| panic!("case {case}: {e}\n{text}"));
                same(&normalised(&deck.model).0, &again.model);
            }
        }
    }
    assert!(accepted > CASES / 10 && refused > CASES / 3, "{accepted} accepted, {refused} refused");
}
