//! The MBS solver against closed forms and converged references.

mod batch;
mod beam;
mod break_away;
mod carry;
mod catenary;
mod contact;
mod crushing;
mod event_rules;
mod export;
mod frame;
mod hinge;
mod ideal;
mod impact;
mod input;
mod latent;
mod motion;
mod near;
mod onset;
mod overlap;
mod relative;
mod shared_mass;
mod sleep;
mod soften;
mod statics;
mod support;
mod turning;
