//! The journal: what became of the library, when, and by which version of the program.
//!
//! `library/history.txt`, one line an event, lines only ever added:
//!
//! ```text
//! 2026-11-21T10:14:40Z <tab> added <tab> KEY <tab> RECORD <tab> fallwerk 0.1.0 <tab> NOTE <tab> CHECK
//! ```
//!
//! RECORD is the beginning of the record's checksum after the event (`-`: none), CHECK that of the blake3 hash of the
//! line before it. Each line has its own, so that two branches of version control can be merged by keeping both
//! lines. A line is on the disk before the command says it is done. A kill may leave a torn last line: it is recognised,
//! and the next writer cuts it off; an event that was lost is then noted as `found`.

use super::error::StoreError;
use crate::base::hash::ContentHash;
use crate::base::output::{sync_folder, write_atomic};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Name of the file.
pub const JOURNAL_FILE: &str = "history.txt";

const TITLE: &str =
    "# Journal of the library: time (UTC), event, key, record, program, note, check. Lines are only added.\n";

/// What happened to an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Happening {
    /// A new record.
    Added,
    /// A record of the same inputs with another result took its place.
    Replaced,
    /// It is no longer to be used.
    Deprecated,
    /// It came from an exchange file.
    Imported,
    /// A record was there of which the journal did not know: version control, or a writer that was killed.
    Found,
    /// A record of which the journal knew is no longer there.
    Missing,
    /// The journal itself, or a damaged record, was mended.
    Mended,
}

impl Happening {
    const ALL: [(Self, &str); 7] = [
        (Self::Added, "added"),
        (Self::Replaced, "replaced"),
        (Self::Deprecated, "deprecated"),
        (Self::Imported, "imported"),
        (Self::Found, "found"),
        (Self::Missing, "missing"),
        (Self::Mended, "mended"),
    ];

    /// The word in the file.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(what, _)| *what == self).map_or("", |(_, name)| name)
    }
}

/// One line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Event {
    /// When, as `2026-11-21T10:14:40Z`.
    pub time: String,
    /// What.
    pub what: Happening,
    /// Key of the entry; `-` if the journal itself is meant.
    pub key: String,
    /// Beginning of the record's checksum; `-`: none.
    pub record: String,
    /// Program and version.
    pub program: String,
    /// Further words.
    pub note: String,
}

impl Event {
    /// An event of now and of this program.
    pub fn now(what: Happening, key: &str, record: &str, note: &str) -> Self {
        Self {
            time: utc(SystemTime::now()),
            what,
            key: key.to_string(),
            record: record.to_string(),
            program: concat!("fallwerk ", env!("CARGO_PKG_VERSION")).to_string(),
            note: note.split_whitespace().collect::<Vec<_>>().join(" "),
        }
    }

    fn line(&self) -> String {
        let fields =
            [&self.time, self.what.name(), &self.key, &self.record, &self.program, &self.note].join("\t");
        let check = ContentHash::of_bytes(fields.as_bytes()).short();
        format!("{fields}\t{check}\n")
    }

    fn parse(line: &[u8]) -> Option<Self> {
        let (fields, check) = std::str::from_utf8(line).ok()?.rsplit_once('\t')?;
        if ContentHash::of_bytes(fields.as_bytes()).short() != check {
            return None;
        }
        let mut parts = fields.split('\t').map(str::to_string);
        let mut next = || parts.next();
        let (time, word) = (next()?, next()?);
        let what = Happening::ALL.iter().find(|(_, name)| *name == word)?.0;
        Some(Self { time, what, key: next()?, record: next()?, program: next()?, note: next()? })
    }
}

/// What the journal holds.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct History {
    /// The events in their order.
    pub events: Vec<Event>,
    /// Numbers of lines that do not match their checksum, from 1.
    pub damaged_lines: Vec<usize>,
    /// Bytes of a last line that was cut off by a kill or a full disk.
    pub torn_bytes: usize,
    /// Bytes before it.
    #[serde(skip)]
    whole_bytes: usize,
    /// The last line is whole, but for its end.
    #[serde(skip)]
    open_end: bool,
}

impl History {
    fn of(bytes: &[u8]) -> Self {
        let mut history = Self { whole_bytes: bytes.len(), ..Self::default() };
        let mut start = 0;
        for (number, line) in (1..).zip(bytes.split_inclusive(|b| *b == b'\n')) {
            let end = start + line.len();
            let text = line.strip_suffix(b"\n").unwrap_or(line);
            let text = text.strip_suffix(b"\r").unwrap_or(text);
            if let Some(event) = Event::parse(text) {
                history.events.push(event);
                history.open_end = !line.ends_with(b"\n");
            } else if number == 1 && TITLE.as_bytes().starts_with(text) && line.ends_with(b"\n")
                || text.is_empty()
            {
                // The title, or a line between two.
            } else if end == bytes.len() {
                history.torn_bytes = line.len();
                history.whole_bytes = start;
            } else {
                history.damaged_lines.push(number);
            }
            start = end;
        }
        history
    }

    /// What becomes of a torn last line, for the note of the journal.
    fn torn_words(&self) -> String {
        format!("a last line of {} bytes was cut off", self.torn_bytes)
    }

    /// Keys whose last event says that they are missing, sorted.
    pub fn missing(&self) -> Vec<String> {
        let last: BTreeMap<&str, Happening> = self.events.iter().map(|e| (e.key.as_str(), e.what)).collect();
        let missing = last.into_iter().filter(|(_, what)| *what == Happening::Missing);
        missing.map(|(key, _)| key.to_string()).collect()
    }
}

/// The journal of a library folder.
#[derive(Debug, Clone)]
pub struct Journal {
    path: PathBuf,
}

impl Journal {
    /// The journal of this library; it need not exist yet.
    pub fn of(library: &Path) -> Self {
        Self { path: library.join(JOURNAL_FILE) }
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads it. A library without a journal has an empty one.
    ///
    /// # Errors
    /// As the file system reports them.
    pub fn read(&self) -> Result<History, StoreError> {
        match fs::read(&self.path) {
            Ok(bytes) => Ok(History::of(&bytes)),
            Err(e) if e.kind() == ErrorKind::NotFound => Ok(History::default()),
            Err(e) => Err(StoreError::io(&self.path)(e)),
        }
    }

    /// Adds events and brings them to the disk; a torn last line is cut off first. Only the one writer may call this.
    ///
    /// # Errors
    /// As the file system reports them; the lines before are whole.
    pub fn append(&self, events: &[Event]) -> Result<(), StoreError> {
        if events.is_empty() {
            return Ok(());
        }
        let history = self.read()?;
        let new = !self.path.exists();
        let mut text = String::new();
        if history.whole_bytes == 0 {
            text.push_str(TITLE);
        }
        if history.open_end {
            text.push('\n');
        }
        if history.torn_bytes > 0 {
            text.push_str(&Event::now(Happening::Mended, "-", "-", &history.torn_words()).line());
        }
        text.extend(events.iter().map(Event::line));
        let written = File::options().create(true).append(true).open(&self.path).and_then(|mut file| {
            if history.torn_bytes > 0 {
                file.set_len(history.whole_bytes as u64)?;
            }
            file.write_all(text.as_bytes())?;
            file.sync_all()
        });
        written.map_err(StoreError::io(&self.path))?;
        if new && let Some(folder) = self.path.parent() {
            sync_folder(folder).map_err(StoreError::io(folder))?;
        }
        Ok(())
    }

    /// Takes damaged lines and a torn last line out, and keeps the file as it was in `aside`. Returns how many there were.
    ///
    /// # Errors
    /// As the file system reports them.
    pub fn mend(&self, aside: &Path) -> Result<usize, StoreError> {
        let history = self.read()?;
        let count = history.damaged_lines.len() + usize::from(history.torn_bytes > 0);
        if count == 0 {
            return Ok(0);
        }
        fs::copy(&self.path, aside).map_err(StoreError::io(aside))?;
        let mut text = TITLE.to_string();
        text.extend(history.events.iter().map(Event::line));
        let lines: Vec<String> = history.damaged_lines.iter().map(usize::to_string).collect();
        let taken = format!("lines {} did not match their checksums and were taken out", lines.join(", "));
        let notes =
            [(!lines.is_empty()).then_some(taken), (history.torn_bytes > 0).then(|| history.torn_words())];
        let note = notes.into_iter().flatten().collect::<Vec<_>>().join("; ");
        text.push_str(&Event::now(Happening::Mended, "-", "-", &note).line());
        write_atomic(&self.path, text.as_bytes()).map_err(StoreError::io(&self.path))?;
        Ok(count)
    }
}

/// A time as `2026-11-21T10:14:40Z` (proleptic Gregorian calendar; the days by the algorithm `civil_from_days` of
/// H. Hinnant, *chrono-compatible low-level date algorithms*, 2013).
pub fn utc(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}Z", rest / 3600, rest % 3600 / 60, rest % 60)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn times_are_those_of_the_calendar() {
        let at = |s| utc(UNIX_EPOCH + Duration::from_secs(s));
        assert_eq!(at(0), "1970-01-01T00:00:00Z");
        assert_eq!(at(951_782_399), "2000-02-28T23:59:59Z");
        assert_eq!(at(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(at(4_107_542_400), "2100-03-01T00:00:00Z");
        assert_eq!(at(1_795_255_980), "2026-11-21T10:13:00Z");
    }

    fn event(i: usize) -> Event {
        Event::now(Happening::Added, &format!("axial_spring/{i}@0123456789abcdef"), "00ff", "tab\tand\nline")
    }

    #[test]
    fn a_cut_at_any_byte_costs_at_most_the_last_event() {
        let room = tempfile::tempdir().unwrap();
        let journal = Journal::of(room.path());
        journal.append(&[event(1), event(2)]).unwrap();
        let all = fs::read(journal.path()).unwrap();
        let second = all[..all.len() - 1].iter().rposition(|b| *b == b'\n').unwrap() + 1;
        let first = all[..second - 1].iter().rposition(|b| *b == b'\n').unwrap() + 1;
        for cut in 0..all.len() {
            fs::write(journal.path(), &all[..cut]).unwrap();
            journal.append(&[event(3)]).unwrap();
            let history = journal.read().unwrap();
            assert!(history.damaged_lines.is_empty() && history.torn_bytes == 0, "cut at {cut}");
            let kept = usize::from(cut + 1 >= second) + usize::from(cut + 1 >= all.len());
            let known = history.events.iter().filter(|e| e.what == Happening::Added).count();
            assert_eq!(known, kept + 1, "cut at {cut} of {}, lines at {first}, {second}", all.len());
        }
    }

    #[test]
    fn a_flipped_letter_is_named_by_its_line_and_mended() {
        let room = tempfile::tempdir().unwrap();
        let journal = Journal::of(room.path());
        journal.append(&(0..5).map(event).collect::<Vec<_>>()).unwrap();
        let mut bytes = fs::read(journal.path()).unwrap();
        let third = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n').nth(2).unwrap().0 + 5;
        bytes[third] ^= 1;
        fs::write(journal.path(), &bytes).unwrap();
        let history = journal.read().unwrap();
        assert_eq!((history.events.len(), history.damaged_lines.clone()), (4, vec![4]));
        let aside = room.path().join("aside");
        assert_eq!(journal.mend(&aside).unwrap(), 1);
        assert_eq!(fs::read(aside).unwrap(), bytes);
        let mended = journal.read().unwrap();
        assert_eq!((mended.events.len(), mended.damaged_lines.len()), (5, 0));
        assert!(mended.events[4].note.contains("lines 4 did not match"));
        // a torn last line goes as well, without another event
        let whole = fs::read(journal.path()).unwrap();
        fs::write(journal.path(), &whole[..whole.len() - 9]).unwrap();
        assert!(journal.read().unwrap().torn_bytes > 0);
        assert_eq!(journal.mend(&room.path().join("torn")).unwrap(), 1);
        let mended = journal.read().unwrap();
        assert_eq!((mended.events.len(), mended.torn_bytes, mended.damaged_lines.len()), (5, 0, 0));
        assert!(mended.events[4].note.starts_with("a last line of "), "{:?}", mended.events[4]);
    }
}
