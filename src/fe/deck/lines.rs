//! The text of a deck as keyword blocks: comments dropped, included files in their place.

use super::error::{At, Messages};
use crate::base::diagnostic::quoted;
use crate::base::source::{Source, Unreadable};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Largest deck or included file, bytes.
pub const MAX_DECK_BYTES: u64 = 1 << 30;
/// Most files that one deck may include, and how deep they may be nested.
const MOST_FILES: usize = 1000;
const DEEPEST: usize = 32;

/// A keyword with the data lines up to the next one.
#[derive(Debug, Clone)]
pub(super) struct Block {
    /// Keyword in capitals without the star, with its options, without a sign for the format.
    pub keyword: String,
    /// The keyword's place.
    pub at: At,
    /// Data lines, without line ends.
    pub lines: Vec<At>,
    /// Whether fields are 20 columns wide.
    pub long: bool,
}

/// How included files are read.
pub(super) type Open<'a> = &'a dyn Fn(&Path) -> Result<Source, Unreadable>;

/// A deck being split.
pub(super) struct Splitter<'a> {
    /// Files in the order of reading.
    pub files: Vec<Arc<Source>>,
    /// Blocks in the order of reading.
    pub blocks: Vec<Block>,
    open: Open<'a>,
    long: bool,
    ended: bool,
}

/// Reads a file as text: UTF-8, or Latin-1 where it is not.
pub(super) fn read_file(path: &Path) -> Result<Source, Unreadable> {
    let large = std::fs::metadata(path).is_ok_and(|m| m.is_file() && m.len() > MAX_DECK_BYTES);
    let problem = |message: String, remedy: &str| Unreadable { message, remedy: remedy.into() };
    if large {
        return Err(problem("the file is too large".into(), "the largest deck is 1 GiB"));
    }
    let bytes = std::fs::read(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => problem("there is no such file".into(), "check the path"),
        _ => problem(format!("the file cannot be read: {error}"), "give a text file that can be read"),
    })?;
    if bytes.contains(&0) {
        return Err(problem("this is not a text file: it holds a zero byte".into(), "give a keyword deck"));
    }
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => error.into_bytes().into_iter().map(char::from).collect(),
    };
    Ok(Source::new(path.display().to_string(), text))
}

impl<'a> Splitter<'a> {
    /// Splits a deck and all that it includes.
    pub fn run(main: Source, path: Option<&Path>, open: Open<'a>, messages: &mut Messages) -> Self {
        let mut this = Self { files: Vec::new(), blocks: Vec::new(), open, long: false, ended: false };
        let mut stack: Vec<PathBuf> = path.map(canonical).into_iter().collect();
        let folder = path.and_then(Path::parent).unwrap_or(Path::new("")).to_path_buf();
        this.file(main, &folder, &mut stack, messages);
        this
    }

    fn file(&mut self, source: Source, folder: &Path, stack: &mut Vec<PathBuf>, messages: &mut Messages) {
        let file = self.files.len();
        let source = Arc::new(source);
        self.files.push(source.clone());
        let text = &source.text[..];
        let mut open: Option<Block> = None;
        let mut start = 0;
        while start < text.len() && !self.ended {
            let stop = text[start..].find('\n').map_or(text.len(), |i| start + i);
            let line = text[start..stop].trim_end_matches('\r');
            let at = At { file, start, end: start + line.len() };
            start = stop + 1;
            if line.starts_with('$') {
                continue;
            }
            if line.starts_with('*') {
                self.close(open.take(), folder, stack, messages);
                open = self.keyword(line, at, messages);
            } else if let Some(block) = &mut open {
                block.lines.push(at);
            } else if !line.trim().is_empty() && !self.ended {
                let message = format!("{} stands before any keyword", quoted(line));
                messages.error(at, "no-keyword", message, "", "a deck begins with `*KEYWORD`");
                return;
            }
        }
        self.close(open, folder, stack, messages);
    }

    /// A keyword line; `None` for those that need no block.
    fn keyword(&mut self, line: &str, at: At, messages: &mut Messages) -> Option<Block> {
        let words = line[1..].trim().to_uppercase();
        if words == "END" {
            self.ended = true;
            return None;
        }
        if words.split_whitespace().next() == Some("KEYWORD") {
            for option in words.split_whitespace().skip(1) {
                match option.split_once('=') {
                    Some(("LONG", kind)) => self.long = matches!(kind, "Y" | "YES" | "S" | "K"),
                    Some(("I10", "Y" | "YES")) => messages.error(
                        at,
                        "unsupported-format",
                        "*KEYWORD I10=Y: identifiers of ten columns are not read".into(),
                        "",
                        "write the deck in the standard or the long format (LONG=Y), or with commas",
                    ),
                    _ => {}
                }
            }
            return Some(Block { keyword: "KEYWORD".into(), at, lines: Vec::new(), long: false });
        }
        let (keyword, long) = match words.chars().last() {
            Some('+') => (words.trim_end_matches('+').trim_end(), true),
            Some('-') => (words.trim_end_matches('-').trim_end(), false),
            _ => (&words[..], self.long),
        };
        Some(Block { keyword: keyword.to_string(), at, lines: Vec::new(), long })
    }

    fn close(
        &mut self,
        block: Option<Block>,
        folder: &Path,
        stack: &mut Vec<PathBuf>,
        messages: &mut Messages,
    ) {
        let Some(block) = block else { return };
        if block.keyword == "INCLUDE" {
            self.include(&block, folder, stack, messages);
        } else {
            self.blocks.push(block);
        }
    }

    fn include(&mut self, block: &Block, folder: &Path, stack: &mut Vec<PathBuf>, messages: &mut Messages) {
        let mut name = String::new();
        for (index, at) in block.lines.iter().enumerate() {
            let line = self.files[at.file].text[at.start..at.end].trim().to_string();
            if let Some(part) = line.strip_suffix(" +")
                && index + 1 < block.lines.len()
            {
                name.push_str(part.trim_end());
                continue;
            }
            name.push_str(&line);
            if name.is_empty() || self.ended {
                continue;
            }
            let path = folder.join(std::mem::take(&mut name));
            let known = canonical(&path);
            let refused = if stack.contains(&known) {
                Some(("this file is being read already: a loop of *INCLUDE", "take one of them out"))
            } else if stack.len() >= DEEPEST || self.files.len() >= MOST_FILES {
                Some(("too many files are included", "join some of them"))
            } else {
                None
            };
            if let Some((what, remedy)) = refused {
                let message = format!("*INCLUDE {}: {what}", quoted(&path.to_string_lossy()));
                messages.error(*at, "include-loop", message, "", remedy);
                continue;
            }
            match (self.open)(&path) {
                Err(problem) => {
                    let message =
                        format!("*INCLUDE {}: {}", quoted(&path.to_string_lossy()), problem.message);
                    let remedy = format!(
                        "{}; paths are taken from the folder of the file that includes",
                        problem.remedy
                    );
                    messages.error(*at, "unreadable", message, "", &remedy);
                }
                Ok(source) => {
                    stack.push(known);
                    let below = path.parent().unwrap_or(Path::new("")).to_path_buf();
                    self.file(source, &below, stack, messages);
                    stack.pop();
                }
            }
        }
    }
}

/// The same path for all spellings of it, where the file system can say.
fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
}
