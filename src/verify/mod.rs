//! The verification manual: cases with closed-form or published answers, run live.
//!
//! A case is a small model whose answer is known from elsewhere: a closed form, a publication, or another program on the same
//! mesh. It yields figures, and each figure is judged by a tolerance that stands beside it with the source of its
//! reference. No figure is stored: `fallwerk verify` computes all of them again.
//!
//! | file | owns |
//! |---|---|
//! | `figure` | a figure, its tolerance and the judgement |
//! | `suite` | cases, their choice by name, running them side by side |
//! | `manual` | the table for a terminal, the JSON list, the Markdown page |
//! | `columns` | tested columns of reinforced concrete: data |
//! | `rotation` | rotation matrices, the same on all processors |
//! | `fe/` | the cases of the explicit finite element solver |
//! | `mbs/` | the cases of the multibody solver |
//! | `rc/` | the cases of reinforced concrete: material point, bar, section, member end, tested columns |

pub mod columns;
pub mod fe;
pub mod figure;
pub mod manual;
pub mod mbs;
pub mod rc;
mod rotation;
pub mod suite;

pub use figure::{Figure, Tolerance};
pub use suite::{Case, Failed, Form, select};
