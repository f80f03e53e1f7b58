//! Checkpoints: the whole state of a run in a file, from which it goes on to the same bytes as if it had never stopped.
//!
//! Layout, numbers little-endian:
//!
//! | bytes | content |
//! |---|---|
//! | 8 | [`MAGIC`] |
//! | 4 | [`FORMAT`] |
//! | 8 | length of the head, then of the state (8 more) |
//! | ... | head: [`Head`] |
//! | ... | state: whatever the run derives `Serialize` for |
//! | 32 | blake3 hash of all bytes before |
//!
//! Head and state are encoded by `postcard`, which keeps every bit of a number but no names of fields: a new field of a state is
//! in the file as soon as its type derives `Serialize` and `Deserialize`, and changes what the bytes mean. So a state is read only by the
//! program version that wrote it; raise [`FORMAT`] whenever a state changes between versions of the same number.

use super::erosion::Fate;
use super::law::{ElementForm, Hourglass};
use crate::base::output::write_atomic;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// First bytes of a checkpoint.
pub const MAGIC: [u8; 8] = *b"FWFECKPT";
/// Version of the file layout and of the states in it.
pub const FORMAT: u32 = 18;
/// Bytes before the head.
const PREFIX: usize = 8 + 4 + 8 + 8;
/// Bytes of the checksum.
const CHECKSUM: usize = 32;

/// What a checkpoint belongs to. A run may go on only from a checkpoint with the same entries, but for the time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Version of the program that wrote it.
    pub program_version: String,
    /// Hash of the model: for a building that of its file's content, without the end time.
    pub model_hash: [u8; 32],
    /// Element size \[m\].
    pub mesh_size_m: f64,
    /// Element form of all elements; `None`: the default.
    pub form: Option<ElementForm>,
    /// What becomes of elements that reach their erosion strain.
    pub on_failure: Fate,
    /// Whether parts of the building touch each other.
    pub body_contact: bool,
    /// Time step to be reached by mass scaling \[s\].
    pub mass_scaling_step_s: Option<f64>,
    /// Every how many outputs a frame is written, `None`: no frames.
    pub frames_every: Option<usize>,
    /// Time reached \[s\].
    pub time_s: f64,
}

/// Why a checkpoint cannot be written or gone on from.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RestartError {
    /// The file system refused.
    #[error("{path}: {what}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The file system's answer.
        what: String,
    },
    /// Another kind of file.
    #[error("{path} is no checkpoint of an FE run")]
    NotACheckpoint {
        /// The file.
        path: PathBuf,
    },
    /// Written by another version.
    #[error(
        "{path} was written by {found}, this program is {own}; go on with the version that wrote it, or run from the start"
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// The version that wrote it, as far as the file tells.
        found: String,
        /// Version of this program.
        own: String,
    },
    /// Bytes were changed or lost.
    #[error("{path} is damaged ({what}); use an older checkpoint, or run from the start")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        what: String,
    },
    /// It belongs to another run.
    #[error("{path} belongs to another run: {what}")]
    OtherRun {
        /// The file.
        path: PathBuf,
        /// What differs and what to do.
        what: String,
    },
}

/// The file version as it is compared and shown.
fn version(program: &str, format: u32) -> String {
    format!("version {program} (checkpoint format {format})")
}

impl Head {
    /// What differs from the head of the run that wants to go on; `None` if it may.
    fn difference(&self, own: &Self) -> Option<String> {
        if self.model_hash != own.model_hash {
            return Some(
                "the building has changed, or is another one; give the building file of the first part"
                    .into(),
            );
        }
        if self.mesh_size_m.to_bits() != own.mesh_size_m.to_bits() {
            let (theirs, ours) = (self.mesh_size_m, own.mesh_size_m);
            return Some(format!(
                "its mesh size is {theirs} m, here it is {ours} m; give --mesh-size {theirs}"
            ));
        }
        let mut options = self.options().into_iter().zip(own.options());
        let (theirs, ours) = options.find(|(theirs, ours)| theirs != ours)?;
        Some(format!("it was written with {theirs}, this run has {ours}; give the same"))
    }

    /// The options that a run goes on with, in words.
    fn options(&self) -> [String; 5] {
        let form = self.form.unwrap_or_default();
        [
            self.frames_every.map_or("no grids".into(), |n| format!("--vtu-every {n}")),
            format!("--form {}", form_name(form)),
            match self.on_failure {
                Fate::Erode => "--on-failure erode".into(),
                Fate::Split => "--on-failure split".into(),
            },
            if self.body_contact { "contact of its parts" } else { "--no-body-contact" }.into(),
            self.mass_scaling_step_s
                .map_or("no mass scaling".into(), |step| format!("--mass-scaling-step {step}")),
        ]
    }
}

/// The form as it is named on the command line, with a coefficient of its own where it has one.
fn form_name(form: ElementForm) -> String {
    match form {
        ElementForm::FullyIntegrated => "full".into(),
        ElementForm::OnePoint(Hourglass::Asqbi) => "asqbi".into(),
        ElementForm::OnePoint(Hourglass::Ads) => "ads".into(),
        ElementForm::OnePoint(Hourglass::Asmd) => "asmd".into(),
        ElementForm::OnePoint(Hourglass::Stiffness { coefficient }) => {
            format!("fb-stiffness ({coefficient})")
        }
        ElementForm::OnePoint(Hourglass::Viscous { coefficient }) => format!("fb-viscous ({coefficient})"),
    }
}

/// The bytes of a checkpoint.
///
/// # Errors
/// If the state cannot be encoded (a sequence whose length is not known beforehand).
pub fn encode<S: Serialize>(head: &Head, state: &S) -> Result<Vec<u8>, String> {
    let words = |e: postcard::Error| e.to_string();
    let head = postcard::to_stdvec(head).map_err(words)?;
    let mut bytes = Vec::with_capacity(1 << 20);
    bytes.extend_from_slice(&MAGIC);
    bytes.extend_from_slice(&FORMAT.to_le_bytes());
    bytes.extend_from_slice(&(head.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&[0; 8]);
    bytes.extend_from_slice(&head);
    let begin = bytes.len();
    let mut bytes = postcard::to_extend(state, bytes).map_err(words)?;
    let length = (bytes.len() - begin) as u64;
    bytes[PREFIX - 8..PREFIX].copy_from_slice(&length.to_le_bytes());
    let checksum = blake3::hash(&bytes);
    bytes.extend_from_slice(checksum.as_bytes());
    Ok(bytes)
}

/// Writes a checkpoint; whoever reads the file, also after a crash, finds the one before or this one.
///
/// # Errors
/// As the file system reports them.
pub fn write<S: Serialize>(path: &Path, head: &Head, state: &S) -> Result<(), RestartError> {
    let io = |what: String| RestartError::Io { path: path.to_path_buf(), what };
    let bytes = encode(head, state).map_err(io)?;
    write_atomic(path, &bytes).map_err(|e| {
        io(format!(
            "the checkpoint cannot be written: {e}; make room, or name another file with --checkpoint"
        ))
    })
}

/// Reads a checkpoint that `own` may go on from.
///
/// # Errors
/// If the file is no checkpoint, of another version, damaged, or belongs to another run.
pub fn read<S: DeserializeOwned>(path: &Path, own: &Head) -> Result<S, RestartError> {
    let bytes = std::fs::read(path)
        .map_err(|e| RestartError::Io { path: path.to_path_buf(), what: format!("cannot be read: {e}") })?;
    decode(&bytes, path, own)
}

/// [`read`] from bytes; `path` is named in errors.
///
/// # Errors
/// As [`read`].
pub fn decode<S: DeserializeOwned>(bytes: &[u8], path: &Path, own: &Head) -> Result<S, RestartError> {
    let path = || path.to_path_buf();
    let damaged = |what: &str| RestartError::Damaged { path: path(), what: what.into() };
    if !bytes.starts_with(&MAGIC) {
        return Err(RestartError::NotACheckpoint { path: path() });
    }
    let number = |from: usize| {
        let eight = bytes.get(from..from + 8)?;
        usize::try_from(u64::from_le_bytes(eight.try_into().ok()?)).ok()
    };
    let short = || damaged("it ends too early");
    let (head_length, length) = (number(12).ok_or_else(short)?, number(20).ok_or_else(short)?);
    let end = PREFIX.checked_add(head_length).and_then(|n| n.checked_add(length)).ok_or_else(short)?;
    if bytes.len() != end.saturating_add(CHECKSUM) {
        return Err(damaged("its length is not the one it names"));
    }
    if blake3::hash(&bytes[..end]) != blake3::Hash::from_bytes(bytes[end..].try_into().map_err(|_| short())?)
    {
        return Err(damaged("its checksum does not fit"));
    }
    let format = u32::from_le_bytes(bytes[8..12].try_into().map_err(|_| short())?);
    let own_version = version(&own.program_version, FORMAT);
    let other = |found| RestartError::Version { path: path(), found, own: own_version.clone() };
    if format != FORMAT {
        return Err(other(format!("a version with checkpoint format {format}")));
    }
    let head: Head = postcard::from_bytes(&bytes[PREFIX..PREFIX + head_length])
        .map_err(|e| damaged(&format!("head: {e}")))?;
    if head.program_version != own.program_version {
        return Err(other(version(&head.program_version, format)));
    }
    if let Some(what) = head.difference(own) {
        return Err(RestartError::OtherRun { path: path(), what });
    }
    match postcard::take_from_bytes(&bytes[PREFIX + head_length..end]) {
        Ok((state, [])) => Ok(state),
        Ok((_, rest)) => Err(damaged(&format!("{} bytes are left over", rest.len()))),
        Err(e) => Err(damaged(&format!("state: {e}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_another_format_is_refused_by_its_number() {
        let head = Head {
            program_version: "1.2.3".into(),
            model_hash: [7; 32],
            mesh_size_m: 0.4,
            form: None,
            on_failure: Fate::Erode,
            body_contact: true,
            mass_scaling_step_s: None,
            frames_every: None,
            time_s: 0.5,
        };
        let good = encode(&head, &1.0f64).unwrap();
        let of_format = |format: u32| {
            let mut bytes = good[..good.len() - CHECKSUM].to_vec();
            bytes[MAGIC.len()..MAGIC.len() + 4].copy_from_slice(&format.to_le_bytes());
            let checksum = blake3::hash(&bytes);
            bytes.extend_from_slice(checksum.as_bytes());
            decode::<f64>(&bytes, Path::new("old.checkpoint"), &head)
        };
        assert_eq!(of_format(FORMAT), Ok(1.0));
        for format in [0, FORMAT - 1, FORMAT + 1] {
            let message = of_format(format).unwrap_err().to_string();
            let expected = format!(
                "old.checkpoint was written by a version with checkpoint format {format}, this program is version 1.2.3 (checkpoint format {FORMAT}); \
                 go on with the version that wrote it, or run from the start"
            );
            assert_eq!(message, expected);
        }
    }
}
