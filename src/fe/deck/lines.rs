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
    /// How wide its fields are.
    pub columns: Columns,
}

/// How wide the fields of lines with fixed columns are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Columns {
    /// 10, in nodes and elements 8 and 16, in curves 20.
    #[default]
    Standard,
    /// The same with 10 in place of 8 (`I10=Y`, `%`).
    Ten,
    /// 20 throughout (`LONG=Y`, `+`).
    Long,
}

impl Columns {
    /// Columns of a field that has `standard` columns in the standard format.
    pub fn width(self, standard: usize) -> usize {
        match self {
            Self::Standard => standard,
            Self::Ten => standard.max(10),
            Self::Long => 20,
        }
    }

    /// The format that a sign after a keyword stands for.
    fn of_sign(sign: char) -> Option<Self> {
        match sign {
            '+' => Some(Self::Long),
            '%' => Some(Self::Ten),
            '-' => Some(Self::Standard),
            _ => None,
        }
    }
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
    /// Format of the file that is being read, where a keyword has no sign of its own.
    columns: Columns,
    /// Folder of the deck.
    home: PathBuf,
    /// Folders of `*INCLUDE_PATH`.
    folders: Vec<PathBuf>,
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
    if let Some(zero) = bytes.iter().position(|b| *b == 0) {
        let line = 1 + bytes[..zero].iter().filter(|b| **b == b'\n').count();
        let message = format!("this is not a text file: there is a zero byte in line {line}");
        return Err(problem(message, "give a keyword deck"));
    }
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => error.into_bytes().into_iter().map(char::from).collect(),
    };
    // editors on Windows put a mark before the text
    let text = text.strip_prefix('\u{feff}').map(String::from).unwrap_or(text);
    Ok(Source::new(path.display().to_string(), text))
}

impl<'a> Splitter<'a> {
    /// Splits a deck and all that it includes.
    pub fn run(main: Source, path: Option<&Path>, open: Open<'a>, messages: &mut Messages) -> Self {
        let home = path.and_then(Path::parent).unwrap_or(Path::new("")).to_path_buf();
        let mut this = Self {
            files: Vec::new(),
            blocks: Vec::new(),
            open,
            columns: Columns::default(),
            home: home.clone(),
            folders: Vec::new(),
        };
        let mut stack: Vec<PathBuf> = path.map(canonical).into_iter().collect();
        this.file(main, &home, &mut stack, messages);
        this
    }

    fn file(&mut self, source: Source, folder: &Path, stack: &mut Vec<PathBuf>, messages: &mut Messages) {
        let file = self.files.len();
        let source = Arc::new(source);
        self.files.push(source.clone());
        let text = &source.text[..];
        let mut open: Option<Block> = None;
        let mut start = 0;
        while start < text.len() {
            let stop = text[start..].find('\n').map_or(text.len(), |i| start + i);
            let line = text[start..stop].trim_end_matches('\r');
            let at = At { file, start, end: start + line.len() };
            start = stop + 1;
            if line.starts_with('$') {
                continue;
            }
            if line.starts_with('*') {
                self.close(open.take(), folder, stack, messages);
                // in an included file, `*END` ends that file only
                let Some(block) = self.keyword(line, at, messages) else { return };
                open = Some(block);
            } else if let Some(block) = &mut open {
                block.lines.push(at);
            } else if !line.trim().is_empty() {
                let message = format!("{} stands before any keyword", quoted(line));
                messages.error(at, "no-keyword", message, "", "a deck begins with `*KEYWORD`");
                return;
            }
        }
        self.close(open, folder, stack, messages);
    }

    /// A keyword line: its name, a sign for the format, and text that means nothing (`*ELEMENT_SOLID (ten nodes format)`).
    /// `None` for `*END`.
    fn keyword(&mut self, line: &str, at: At, messages: &mut Messages) -> Option<Block> {
        let text = line[1..].trim().to_uppercase();
        let mut words = text.split_whitespace();
        let first = words.next().unwrap_or("");
        let block =
            |keyword: &str, columns| Block { keyword: keyword.into(), at, lines: Vec::new(), columns };
        match first {
            "END" => return None,
            "KEYWORD" | "KEYWORD_ID" | "KEYWORD_JOBID" => {
                self.deck_format(&words.collect::<Vec<_>>().join(" "), at, messages);
                return Some(block("KEYWORD", self.columns));
            }
            "COMMENT" => return Some(block(first, self.columns)),
            _ => {}
        }
        if let Some((name, columns)) =
            first.chars().last().and_then(Columns::of_sign).map(|c| (&first[..first.len() - 1], c))
        {
            return Some(block(name, columns));
        }
        let mut columns = self.columns;
        if let Some(word) = words.next() {
            match word.chars().next().filter(|_| word.len() == 1).and_then(Columns::of_sign) {
                Some(own) => columns = own,
                None if word.starts_with('(') => {}
                None => messages.note(at, format!("*{first}: the text after the keyword has no effect")),
            }
        }
        Some(block(first, columns))
    }

    /// Options of `*KEYWORD`. `LONG=S` is the standard format: it is about a file that another program writes.
    fn deck_format(&mut self, options: &str, at: At, messages: &mut Messages) {
        let options = options.replace(" =", "=").replace("= ", "=");
        let (mut long, mut ten) = (false, false);
        for option in options.split(' ') {
            match option.split_once('=') {
                Some(("LONG", kind)) => long = matches!(kind, "Y" | "YES" | "K"),
                Some(("I10", kind)) => ten = matches!(kind, "Y" | "YES"),
                _ => {}
            }
        }
        let given = match (long, ten) {
            (true, _) => Columns::Long,
            (_, true) => Columns::Ten,
            _ => Columns::Standard,
        };
        if at.file == 0 {
            self.columns = given;
        } else if given != self.columns && given != Columns::Standard {
            let text = "LONG and I10 have no effect in an included file: it has the format of the deck, or that of the sign after its *INCLUDE";
            messages.note(at, text);
        }
    }

    fn close(
        &mut self,
        block: Option<Block>,
        folder: &Path,
        stack: &mut Vec<PathBuf>,
        messages: &mut Messages,
    ) {
        let Some(block) = block else { return };
        match &block.keyword[..] {
            "INCLUDE" => self.include(&block, folder, stack, messages),
            "INCLUDE_PATH" | "INCLUDE_PATH_RELATIVE" => {
                let names = self.paths(&block);
                self.folders.extend(names.into_iter().map(|(name, _)| self.home.join(name)));
            }
            _ => self.blocks.push(block),
        }
    }

    /// The names in a block, one a line, continued by ` +`. Backslashes count as slashes.
    fn paths(&self, block: &Block) -> Vec<(String, At)> {
        let mut names = Vec::new();
        let mut name = String::new();
        for (index, at) in block.lines.iter().enumerate() {
            let line = self.files[at.file].text[at.start..at.end].trim();
            match line.strip_suffix(" +") {
                Some(part) if index + 1 < block.lines.len() => name.push_str(part.trim_end()),
                _ => {
                    name.push_str(line);
                    if !name.is_empty() {
                        names.push((std::mem::take(&mut name).replace('\\', "/"), *at));
                    }
                }
            }
        }
        names
    }

    /// The file of this name beside the one that includes it, else beside the deck, else in the folders of `*INCLUDE_PATH`.
    fn found(&self, name: &str, folder: &Path) -> PathBuf {
        let others = std::iter::once(&self.home).chain(&self.folders).map(|f| f.join(name));
        let first = folder.join(name);
        if first.exists() {
            return first;
        }
        others.into_iter().find(|p| p.exists()).unwrap_or(first)
    }

    fn include(&mut self, block: &Block, folder: &Path, stack: &mut Vec<PathBuf>, messages: &mut Messages) {
        for (name, at) in self.paths(block) {
            let path = self.found(&name, folder);
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
                messages.error(at, "include-loop", message, "", remedy);
                continue;
            }
            match (self.open)(&path) {
                Err(problem) => {
                    let message =
                        format!("*INCLUDE {}: {}", quoted(&path.to_string_lossy()), problem.message);
                    let remedy = format!(
                        "{}; paths are taken from the folder of the file that includes, from that of the deck and from those of *INCLUDE_PATH",
                        problem.remedy
                    );
                    messages.error(at, "unreadable", message, "", &remedy);
                }
                Ok(source) => {
                    stack.push(known);
                    let below = path.parent().unwrap_or(Path::new("")).to_path_buf();
                    let outside = std::mem::replace(&mut self.columns, block.columns);
                    self.file(source, &below, stack, messages);
                    self.columns = outside;
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
