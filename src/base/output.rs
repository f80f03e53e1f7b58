//! Output that is whole or absent: files written by replacement, and result folders that appear at once.
//!
//! [`write_atomic`] writes a temporary sibling, brings it to the disk, renames it over the target and
//! brings the folder entry to the disk. Whoever reads the target, also after a crash, sees the old
//! content or the new, never a part.
//!
//! [`OutputFolder`] does the same for a folder of results: it is filled under a temporary sibling name and
//! renamed into place at the end. An older result folder of this program (it holds the marker
//! file [`MARKER`], which names what was written) is replaced by results of the same kind ([`Results`]); one of another kind, a folder that is not ours, or holds something else, is never touched. A long run that may be interrupted fills
//! [`OutputFolder::unfinished`], a sibling `NAME.unfinished` that stays once there is something to go on from.

use super::results::Results;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Name of the file by which a result folder of this program is known.
pub const MARKER: &str = ".fallwerk-output";

/// First line of the marker; the names of what was written follow, a line each.
const MARKER_TEXT: &str =
    "Results of fallwerk. This folder is replaced as a whole by the next run with the same target.\n";

/// Prefix of temporary names; readers of a folder skip names that begin so.
pub const TEMPORARY_PREFIX: &str = ".fallwerk-tmp-";

/// Why a result folder could not be made.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The target exists and was not made by this program.
    #[error(
        "{path}: exists and is not a result folder of fallwerk (no {MARKER} in it); name another folder or remove it"
    )]
    NotOurs {
        /// The target.
        path: PathBuf,
    },
    /// The target cannot be a result folder.
    #[error("{path}: {what}")]
    BadTarget {
        /// The target.
        path: PathBuf,
        /// What is wrong with it.
        what: &'static str,
    },
    /// The target holds something that was not written by this program.
    #[error(
        "{path}: is not a result of fallwerk, and would be lost with the folder; move it, or name another folder"
    )]
    Foreign {
        /// What it holds.
        path: PathBuf,
    },
    /// The target holds results of another kind.
    #[error("{path}: holds {results}, which would be lost; name another folder, or remove this one")]
    OtherResults {
        /// The target.
        path: PathBuf,
        /// What it holds.
        results: Results,
    },
    /// The file system refused.
    #[error("{path}: {source}")]
    Io {
        /// What was being read or written.
        path: PathBuf,
        /// The file system's answer.
        source: io::Error,
    },
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> OutputError + '_ {
    move |source| OutputError::Io { path: path.to_path_buf(), source }
}

/// A number that differs between all temporary names of this process.
fn next_number() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// The folder that holds `path` (`.` for a bare name).
fn parent_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Replaces the content of a file: temporary sibling, fsync, rename, fsync of the folder.
///
/// # Errors
/// As the file system reports them; the target then holds its old content.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_renamed(path, bytes)?;
    sync_folder(parent_of(path))
}

/// Whether a command may replace what is at a path: not what it `reads`, nor a file whose name has none of the `endings` of what it makes.
///
/// # Errors
/// What is there, and what to do about it.
pub fn may_write(path: &Path, endings: &[&str], reads: &[&Path]) -> Result<(), String> {
    let Ok(real) = path.canonicalize() else { return Ok(()) };
    let shown = path.display();
    if reads.iter().any(|other| other.canonicalize().is_ok_and(|other| other == real)) {
        return Err(format!("{shown} is what is read, and would be replaced; give another name"));
    }
    let is_made = path.extension().is_some_and(|e| endings.iter().any(|own| e.eq_ignore_ascii_case(own)));
    if real.is_file() && !is_made {
        let names: Vec<String> = endings.iter().map(|e| format!(".{e}")).collect();
        let names = names.join(" or ");
        return Err(format!("{shown} exists and does not end in {names}; give another name, or remove it"));
    }
    Ok(())
}

/// Whether a file at a path would lie in a folder, or below it.
pub fn is_within(path: &Path, folder: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    real(parent_of(path)).zip(real(folder)).is_some_and(|(parent, folder)| parent.starts_with(folder))
}

/// [`write_atomic`] without the last step: for many files in one folder, followed by one [`sync_folder`].
///
/// # Errors
/// As the file system reports them; the target then holds its old content.
pub fn write_renamed(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let temporary =
        parent_of(path).join(format!("{TEMPORARY_PREFIX}{}-{}", std::process::id(), next_number()));
    let written = File::create(&temporary)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&temporary, path));
    if written.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    written
}

/// Brings the entries of a folder (names, renames) to the disk.
///
/// # Errors
/// As the file system reports them.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    // Folders cannot be opened as files everywhere; where they can, their entries are to be synced.
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// A result folder being filled. Dropping it without [`OutputFolder::commit`] leaves nothing behind.
#[derive(Debug)]
pub struct OutputFolder {
    target: PathBuf,
    temporary: PathBuf,
    results: Results,
    /// Whether what was written stays if the folder is not committed.
    kept: AtomicBool,
    committed: bool,
}

impl OutputFolder {
    /// Begins a folder for results of a kind; the target itself is not touched before [`OutputFolder::commit`].
    ///
    /// What an earlier run left behind when it was killed is cleared, and a result folder it had set
    /// aside is put back.
    ///
    /// # Errors
    /// If the target exists and is not ours, holds results that these [may not replace](Results::may_replace), has no name of its own (`.`, `..`, `/`), or cannot be written.
    pub fn create(target: &Path, results: Results) -> Result<Self, OutputError> {
        let bad = |what| OutputError::BadTarget { path: target.to_path_buf(), what };
        let name = target
            .file_name()
            .ok_or_else(|| bad("is not the name of a new folder"))?
            .to_string_lossy()
            .into_owned();
        let parent = parent_of(target);
        fs::create_dir_all(parent).map_err(at(parent))?;
        recover(target, &name).map_err(at(target))?;
        may_replace(target, results)?;
        let temporary = parent.join(format!(".{name}.part-{}-{}", std::process::id(), next_number()));
        fs::create_dir(&temporary).map_err(at(target))?;
        Self::begin(target, temporary, results, false)
    }

    fn begin(target: &Path, temporary: PathBuf, results: Results, kept: bool) -> Result<Self, OutputError> {
        let kept = AtomicBool::new(kept);
        let folder = Self { target: target.to_path_buf(), temporary, results, kept, committed: false };
        folder.write(MARKER, MARKER_TEXT.as_bytes())?;
        Ok(folder)
    }

    /// Where an interrupted run leaves its part of the results.
    pub fn unfinished_path(target: &Path) -> PathBuf {
        let name = target.file_name().unwrap_or_default().to_string_lossy();
        target.with_file_name(format!("{name}.unfinished"))
    }

    /// As [`OutputFolder::create`], but under a name that does not change, [`OutputFolder::unfinished_path`]. It goes if it
    /// is dropped, unless [`OutputFolder::keep`] was called. `resume`: go on with one that was kept, if there is one.
    ///
    /// # Errors
    /// As [`OutputFolder::create`]; also if a kept one is there and `resume` is not given, or it is not ours.
    pub fn unfinished(target: &Path, results: Results, resume: bool) -> Result<Self, OutputError> {
        drop(Self::create(target, results)?); // all that is to be checked and cleared
        let temporary = Self::unfinished_path(target);
        match fs::create_dir(&temporary) {
            Ok(()) => Self::begin(target, temporary, results, false),
            Err(e) if e.kind() != io::ErrorKind::AlreadyExists => Err(at(&temporary)(e)),
            Err(_) if !temporary.join(MARKER).is_file() => Err(OutputError::NotOurs { path: temporary }),
            Err(_) if resume => Self::begin(target, temporary, results, true),
            Err(_) => Err(OutputError::BadTarget {
                path: temporary,
                what: "holds a run that is under way or was interrupted; go on with it (--resume), or remove the folder",
            }),
        }
    }

    /// Keeps what is written from now on, also if the folder is never committed.
    pub fn keep(&self) {
        self.kept.store(true, Ordering::Relaxed);
    }

    /// Where to write until the folder is committed.
    pub fn path(&self) -> &Path {
        &self.temporary
    }

    /// Where the folder will lie.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Writes one file; `name` may have folders in it, which are made.
    ///
    /// # Errors
    /// As the file system reports them.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, OutputError> {
        let path = self.temporary.join(name);
        let parent = parent_of(&path);
        fs::create_dir_all(parent).map_err(at(parent))?;
        fs::write(&path, bytes).map_err(at(&path))?;
        Ok(path)
    }

    /// Puts the folder in its place and returns the target.
    ///
    /// # Errors
    /// If the target has meanwhile become a folder that is not ours or holds other results, or the file system refuses; an
    /// older result folder is then still in place.
    pub fn commit(mut self) -> Result<PathBuf, OutputError> {
        let names = names_in(&self.temporary).map_err(at(&self.temporary))?;
        let listed = names.iter().filter(|name| *name != MARKER).map(|name| format!("{name}\n"));
        self.write(MARKER, (MARKER_TEXT.to_string() + &listed.collect::<String>()).as_bytes())?;
        sync_tree(&self.temporary).map_err(at(&self.temporary))?;
        may_replace(&self.target, self.results)?;
        let name = self.target.file_name().unwrap_or_default().to_string_lossy();
        let aside =
            self.target.with_file_name(format!(".{name}.old-{}-{}", std::process::id(), next_number()));
        let had_older = self.target.exists();
        if had_older {
            fs::rename(&self.target, &aside).map_err(at(&self.target))?;
        }
        if let Err(error) = fs::rename(&self.temporary, &self.target) {
            if had_older {
                let _ = fs::rename(&aside, &self.target);
            }
            return Err(at(&self.target)(error));
        }
        self.committed = true;
        sync_folder(parent_of(&self.target)).map_err(at(&self.target))?;
        if had_older {
            fs::remove_dir_all(&aside).map_err(at(&aside))?;
        }
        Ok(self.target.clone())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        if !self.committed && !*self.kept.get_mut() {
            let _ = fs::remove_dir_all(&self.temporary);
        }
    }
}

/// Whether the target is absent, empty, or a result folder of ours that such results may replace.
fn may_replace(target: &Path, results: Results) -> Result<(), OutputError> {
    let Ok(meta) = fs::symlink_metadata(target) else { return Ok(()) };
    if !meta.is_dir() {
        let what = match meta.is_symlink() {
            true => {
                "is a symbolic link, which would be replaced in place of what it leads to; name the folder itself"
            }
            false => "exists and is not a folder; name another one",
        };
        return Err(OutputError::BadTarget { path: target.to_path_buf(), what });
    }
    let names = names_in(target).map_err(at(target))?;
    let Ok(marker) = fs::read_to_string(target.join(MARKER)) else {
        return if names.is_empty() {
            Ok(())
        } else {
            Err(OutputError::NotOurs { path: target.to_path_buf() })
        };
    };
    let written: Vec<&str> = marker.lines().skip(1).collect();
    let is_foreign = |name: &&String| *name != MARKER && !written.contains(&name.as_str());
    if let Some(name) = names.iter().find(is_foreign).filter(|_| !written.is_empty()) {
        return Err(OutputError::Foreign { path: target.join(name) });
    }
    match Results::among(&names) {
        Some(older) if !results.may_replace(older) => {
            Err(OutputError::OtherResults { path: target.to_path_buf(), results: older })
        }
        _ => Ok(()),
    }
}

/// What a folder holds, in order.
fn names_in(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for item in fs::read_dir(folder)? {
        names.push(item?.file_name().to_string_lossy().into_owned());
    }
    names.sort_unstable();
    Ok(names)
}

/// Clears what killed runs left beside the target: unfinished folders go; a finished folder that was
/// set aside returns to its place if the place is empty.
fn recover(target: &Path, name: &str) -> io::Result<()> {
    for item in fs::read_dir(parent_of(target))? {
        let path = item?.path();
        let Some(found) = path.file_name().and_then(|n| n.to_str()) else { continue };
        let owner = |kind: &str| {
            let rest = found.strip_prefix(&format!(".{name}.{kind}-"))?;
            rest.split('-').next()?.parse::<u32>().ok()
        };
        let ours = || path.join(MARKER).is_file();
        if owner("part").is_some_and(is_gone) && ours() {
            fs::remove_dir_all(&path)?;
        } else if owner("old").is_some_and(is_gone) && ours() {
            if target.exists() {
                fs::remove_dir_all(&path)?;
            } else {
                fs::rename(&path, target)?;
            }
        }
    }
    Ok(())
}

/// Whether a process no longer runs. Unknown (no `/proc`) counts as running.
fn is_gone(process: u32) -> bool {
    Path::new("/proc/self").exists() && !Path::new("/proc").join(process.to_string()).exists()
}

fn sync_tree(folder: &Path) -> io::Result<()> {
    for item in fs::read_dir(folder)? {
        let path = item?.path();
        let meta = fs::symlink_metadata(&path)?;
        if meta.is_dir() {
            sync_tree(&path)?;
        } else if meta.is_file() {
            File::open(&path)?.sync_all()?;
        }
    }
    sync_folder(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_appears_whole_and_replaces_only_our_own() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("out/run");
        let first = OutputFolder::create(&target, Results::Model).unwrap();
        first.write("a/b.txt", b"one").unwrap();
        assert!(!target.exists());
        first.commit().unwrap();
        assert_eq!(fs::read(target.join("a/b.txt")).unwrap(), b"one");

        let second = OutputFolder::create(&target, Results::Model).unwrap();
        second.write("c.txt", b"two").unwrap();
        drop(second);
        assert!(target.join("a/b.txt").exists(), "an abandoned run changes nothing");

        let note = target.join("my note.txt");
        fs::write(&note, b"keep").unwrap();
        let refused = OutputFolder::create(&target, Results::Model).unwrap_err().to_string();
        assert!(refused.contains("my note.txt") && refused.contains("move it"), "{refused}");
        fs::remove_file(&note).unwrap();

        let third = OutputFolder::create(&target, Results::Model).unwrap();
        third.write("c.txt", b"three").unwrap();
        third.commit().unwrap();
        assert!(target.join("c.txt").exists() && !target.join("a").exists());
        assert_eq!(fs::read_dir(target.parent().unwrap()).unwrap().count(), 1, "nothing is left beside it");
    }

    #[test]
    fn results_are_replaced_by_their_like_only() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("run");
        let write = |results: Results| {
            OutputFolder::create(&target, results).and_then(|folder| {
                folder.write("trace.json", b"")?;
                folder.write(
                    if results == Results::Validation { "validation.json" } else { "mbs.json" },
                    b"",
                )?;
                folder.commit()
            })
        };
        for results in [Results::Model, Results::Model, Results::Validation, Results::Validation] {
            write(results).unwrap();
        }
        for results in [
            Results::Model,
            Results::Fe,
            Results::Deck,
            Results::Simulation,
            Results::Section,
            Results::Cases,
        ] {
            let refused = write(results).unwrap_err().to_string();
            let told = refused.contains("run: holds the results of a run with --validate");
            assert!(told && refused.contains("name another folder"), "{refused}");
        }
        assert!(target.join("validation.json").exists());
        // also where they turn up while a run is under way
        let late = room.path().join("late");
        let run = OutputFolder::create(&late, Results::Fe).unwrap();
        fs::rename(&target, &late).unwrap();
        assert!(matches!(run.commit(), Err(OutputError::OtherResults { .. })));
        assert!(late.join("validation.json").exists());
    }

    #[test]
    fn an_unfinished_folder_stays_once_it_is_kept() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("run");
        drop(OutputFolder::unfinished(&target, Results::Fe, false).unwrap());
        assert_eq!(fs::read_dir(room.path()).unwrap().count(), 0, "nothing was kept");
        let first = OutputFolder::unfinished(&target, Results::Fe, false).unwrap();
        first.write("part.txt", b"half").unwrap();
        first.keep();
        drop(first);
        assert!(matches!(
            OutputFolder::unfinished(&target, Results::Fe, false),
            Err(OutputError::BadTarget { .. })
        ));
        let second = OutputFolder::unfinished(&target, Results::Fe, true).unwrap();
        assert_eq!(fs::read(second.path().join("part.txt")).unwrap(), b"half");
        second.commit().unwrap();
        assert!(target.join("part.txt").is_file());
        assert_eq!(fs::read_dir(room.path()).unwrap().count(), 1);
        let foreign = OutputFolder::unfinished_path(&target);
        fs::create_dir(&foreign).unwrap();
        assert!(matches!(
            OutputFolder::unfinished(&target, Results::Fe, true),
            Err(OutputError::NotOurs { .. })
        ));
    }

    #[test]
    fn a_foreign_folder_is_never_touched() {
        let room = tempfile::tempdir().unwrap();
        let target = room.path().join("thesis");
        fs::create_dir(&target).unwrap();
        fs::write(target.join("chapter.txt"), "years of work").unwrap();
        assert!(matches!(OutputFolder::create(&target, Results::Model), Err(OutputError::NotOurs { .. })));
        // It also holds when the folder turns up while a run is under way.
        let late = room.path().join("late");
        let run = OutputFolder::create(&late, Results::Model).unwrap();
        fs::rename(&target, &late).unwrap();
        assert!(matches!(run.commit(), Err(OutputError::NotOurs { .. })));
        assert_eq!(fs::read_to_string(late.join("chapter.txt")).unwrap(), "years of work");
        assert!(matches!(
            OutputFolder::create(Path::new(".."), Results::Model),
            Err(OutputError::BadTarget { .. })
        ));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_folder_is_told_as_such() {
        let room = tempfile::tempdir().unwrap();
        let [folder, link] = ["folder", "link"].map(|name| room.path().join(name));
        fs::create_dir(&folder).unwrap();
        std::os::unix::fs::symlink(&folder, &link).unwrap();
        let refused = OutputFolder::create(&link, Results::Model).unwrap_err().to_string();
        assert!(
            refused.contains("link: is a symbolic link") && refused.contains("name the folder"),
            "{refused}"
        );
        fs::write(room.path().join("file"), "").unwrap();
        let refused =
            OutputFolder::create(&room.path().join("file"), Results::Model).unwrap_err().to_string();
        assert!(refused.contains("file: exists and is not a folder"), "{refused}");
    }

    #[test]
    fn what_a_killed_run_left_is_cleared_or_put_back() {
        let room = tempfile::tempdir().unwrap();
        let gone = u32::MAX - 7; // above the largest process id Linux gives out
        for kind in ["part", "old"] {
            let path = room.path().join(format!(".run.{kind}-{gone}-0"));
            fs::create_dir(&path).unwrap();
            fs::write(path.join(MARKER), "").unwrap();
            fs::write(path.join(kind), "").unwrap();
        }
        let target = room.path().join("run");
        let run = OutputFolder::create(&target, Results::Model).unwrap();
        assert!(target.join("old").exists());
        assert!(!room.path().join(format!(".run.part-{gone}-0")).exists());
        drop(run);
    }

    #[test]
    fn a_file_is_replaced_and_no_temporary_stays() {
        let room = tempfile::tempdir().unwrap();
        let path = room.path().join("file.json");
        write_atomic(&path, b"one").unwrap();
        write_atomic(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert!(write_atomic(&room.path().join("absent/file"), b"x").is_err());
        assert_eq!(fs::read_dir(room.path()).unwrap().count(), 1);
    }
}
