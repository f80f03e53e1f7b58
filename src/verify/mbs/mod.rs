//! Cases of the multibody solver.

mod hinges;
mod iftomm;
mod pendulums;

use super::Case;

/// All cases.
pub fn cases() -> Vec<Case> {
    let mut all = iftomm::cases();
    all.extend(pendulums::cases());
    all.extend(hinges::cases());
    all
}
