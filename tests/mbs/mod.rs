//! The MBS solver against closed forms and converged references.

mod contact;
mod export;
mod frame;
mod hinge;
mod input;
mod motion;
mod statics;
mod support;
