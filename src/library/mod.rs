//! The store of subsystems: hinges with their resistance curves.
//!
//! The text records in `library/<kind>/` are the truth; each is addressed by the hash of what it was
//! computed from and carries a checksum. A working copy in sled lies in `library/.cache/`; it is compared with the
//! text whenever somebody who may write opens it, and built again if anything differs; who only reads does without it. No query returns an entry that
//! was not asked for: beyond the tolerance the answer is "none".
//!
//! | file | owns |
//! |---|---|
//! | [`entry`], `features`, `parts` | the record: text form; by what it is found; curves, quality, provenance |
//! | `key`, `check`, `thin` | keys; soundness of a record; thinning below the size limit |
//! | `text`, `cache`, `lock` | the text folder; the working copy; the right to write |
//! | [`store`] | opening, reading, writing |
//! | `succession` | successors of deprecated entries |
//! | [`journal`], `history` | the journal of events; what the store tells it |
//! | [`find`], `query`, `interpolate` | the distance between features; queries; an entry between two |
//! | [`derive`], [`derive_strip`], [`derive_contact`] | entries computed by the homogenised submodel: member ends, strips of slabs, ends that strike something |
//! | [`layered`], [`after_break`], [`similar`] | entries of column ends that the library has no own entry for: from layers of elements, with what is left of them once they break; by similarity |
//! | [`rc`], [`mesh_check`], [`rc_kinds`], [`rc_springs`] | entries of sections in concrete and steel: bending, and how much it depends on the mesh; columns, beams, slabs, walls; springs |
//! | [`add`], [`curve_file`], [`meta`] | entries from tests and other programs: the curve, what is said of it |
//! | [`exchange`] | verify, export, import |
//! | `error` | what can go wrong with the store |

pub mod add;
pub mod after_break;
mod cache;
mod check;
pub mod curve_file;
pub mod derive;
pub mod derive_contact;
pub mod derive_strip;
pub mod entry;
mod error;
pub mod exchange;
pub mod features;
pub mod find;
mod history;
mod interpolate;
pub mod journal;
mod key;
pub mod layered;
mod lock;
pub mod mesh_check;
pub mod meta;
mod parts;
mod query;
pub mod rc;
pub mod rc_kinds;
pub mod rc_springs;
pub mod similar;
pub mod store;
pub mod succession;
mod text;
pub mod thin;

pub use entry::{Computed, Deprecation, Entry, EntryKind, Features, Inputs, Origin};
pub use error::StoreError;
pub use find::Query;
pub use key::{is_key, key_of};
pub use query::{Answer, Found, Nearest, Rivals};
pub use store::{Opened, Put, Store};
pub use thin::thinned;
