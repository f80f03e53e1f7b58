//! What can go wrong with the store.

use std::io;
use std::path::{Path, PathBuf};

/// An error of the store.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The file system refused.
    #[error("{path}: {source}")]
    Io {
        /// What was being read or written.
        path: PathBuf,
        /// The file system's answer.
        source: io::Error,
    },
    /// The records are written, and the journal could not be.
    #[error(
        "{path}: {source}; the records are stored, only the journal lacks them: the next command that writes to the library notes them"
    )]
    Untold {
        /// The journal.
        path: PathBuf,
        /// The file system's answer.
        source: io::Error,
    },
    /// A text record does not hold what was once written.
    #[error(
        "{path}: damaged record: {what}; restore the file (version control, `library import`) or derive it again"
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// No record has this key.
    #[error("no entry `{key}` in the library{hint}")]
    NotFound {
        /// The key asked for.
        key: String,
        /// A suggestion, or empty.
        hint: String,
    },
    /// The store can be read only.
    #[error("the library can only be read: {why}")]
    ReadOnly {
        /// Why.
        why: String,
    },
    /// An entry that must not be stored.
    #[error("entry `{key}`: {what}")]
    Invalid {
        /// Its key.
        key: String,
        /// What is wrong.
        what: String,
    },
    /// A file in the place of an export.
    #[error("{path}: there is a file that is no export of a library; name another one")]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// An export into the library itself.
    #[error("{path}: lies in the library, whose files are its records; name a file outside it")]
    Inside {
        /// The file.
        path: PathBuf,
    },
    /// An exchange file that cannot be imported; nothing was changed.
    #[error("{path}: {what}; nothing was imported")]
    Import {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
}

impl StoreError {
    pub(super) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        move |source| Self::Io { path: path.to_path_buf(), source }
    }
}
