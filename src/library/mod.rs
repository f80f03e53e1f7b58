//! The store of subsystems: hinges with their resistance curves.
//!
//! The text records in `library/<kind>/` are the truth; each is addressed by the hash of what it was
//! computed from and carries a checksum. A working copy in sled lies in `library/.cache/`; it is compared with the
//! text at every opening and built again if anything differs. No query returns an entry that
//! was not asked for: beyond the tolerance the answer is "none".
//!
//! | file | owns |
//! |---|---|
//! | [`entry`] | the record: features, curves, provenance, text form |
//! | `key`, `check`, `thin` | keys; soundness of a record; thinning below the size limit |
//! | `text`, `cache` | the text folder; the working copy |
//! | [`store`] | opening, reading, writing, queries |
//! | [`find`] | the distance between features |
//! | [`exchange`] | verify, export, import |

mod cache;
mod check;
pub mod derive;
pub mod entry;
mod error;
pub mod exchange;
pub mod find;
mod key;
pub mod store;
mod text;
mod thin;

pub use entry::{Computed, Entry, EntryKind, Features, Inputs};
pub use error::StoreError;
pub use key::{is_key, key_of};
pub use store::{Found, Nearest, Opened, Put, Store};
pub use thin::thinned;
