//! The right to write: a lock on `library/.cache/lock`, given back when the process ends, however it ends.
//!
//! The file says who holds the lock, for the message that others see.

use super::journal::utc;
use std::fs::{self, File, TryLockError};
use std::io::Write;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// How often the lock is asked for: a process that is just ending, or being started by one that holds the lock,
/// keeps it for some milliseconds longer.
const TRIES: u32 = 20;
/// Words of the command line that are told: the subcommand may stand behind options (`library --library DIR --json derive`).
const HELD_WORDS: usize = 6;
/// Most characters of what another process says of itself.
const MOST_TOLD: usize = 400;
/// Pause between two tries.
const PAUSE: Duration = Duration::from_millis(10);

/// The lock, as long as it lives.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Lock {
    /// Takes the lock of a library folder.
    ///
    /// # Errors
    /// Why not, in words: who holds it, as far as known, or what the file system said.
    pub fn take(library: &Path) -> Result<Self, String> {
        let folder = library.join(".cache");
        let path = folder.join("lock");
        let mut file = fs::create_dir_all(&folder)
            .and_then(|()| File::options().create(true).truncate(false).write(true).open(&path))
            .map_err(|e| format!("{}: {e}", path.display()))?;
        for _ in 0..TRIES {
            match file.try_lock() {
                Ok(()) => {
                    // Without these words, on a full disk say, the lock is as good.
                    let _ = file.set_len(0).and_then(|()| file.write_all(holder().as_bytes()));
                    return Ok(Self { _file: file });
                }
                Err(TryLockError::WouldBlock) => std::thread::sleep(PAUSE),
                Err(TryLockError::Error(e)) => return Err(format!("{}: {e}", path.display())),
            }
        }
        let words = fs::read_to_string(&path).unwrap_or_default();
        let words: String = words.lines().next().unwrap_or_default().chars().take(MOST_TOLD).collect();
        Err(match words.as_str() {
            "" => "another process has it open".to_string(),
            words => format!("another process has it open ({words})"),
        })
    }
}

/// This process in words: number, command, since when.
fn holder() -> String {
    let command: Vec<String> = std::env::args_os()
        .take(HELD_WORDS)
        .map(|word| {
            let name = Path::new(&word).file_name().unwrap_or(&word).to_string_lossy().into_owned();
            name.chars().filter(|c| !c.is_control()).take(40).collect()
        })
        .collect();
    format!("process {}, `{}`, since {}\n", std::process::id(), command.join(" "), utc(SystemTime::now()))
}
