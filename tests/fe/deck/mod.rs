//! Keyword decks: formats, messages, round trip, runs.

mod bad;
mod documented;
mod foreign;
mod fuzz;
mod round_trip;
mod run;
mod variants;

use fallwerk::fe::deck::{Deck, DeckOptions, parse};

/// A cube of one element on a wall, with a bit of everything.
pub const CUBE: &str = "\
*KEYWORD
*TITLE
Cube
*CONTROL_TERMINATION
       0.1
*CONTROL_TIMESTEP
       0.0       0.8
*DATABASE_NODOUT
      0.01
*DATABASE_BINARY_D3PLOT
      0.02
*DATABASE_HISTORY_NODE
         8
*PART
cube
        10        20        30         0        40
*SECTION_SOLID
        20         1
*HOURGLASS
        40         5      0.03
*MAT_PIECEWISE_LINEAR_PLASTICITY
        30    7850.0    2.1e11       0.3     3.0e8       0.0       0.2
      40.0       5.0
       0.0      0.05       0.1
     3.0e8     3.5e8     3.8e8
*MAT_ADD_EROSION
        30
                                  0.3
*DEFINE_CURVE
         7
                 0.0                9.81
                 1.0                9.81
*LOAD_BODY_Z
         7       1.0
*SET_NODE_LIST
         3
         1         2         3         4
*BOUNDARY_SPC_SET
         3         0         1         1         0
*INITIAL_VELOCITY
         0
       0.0       0.0      -2.0
*RIGIDWALL_PLANAR
         0
       0.0       0.0       0.0       0.0       0.0       1.0       0.4
*NODE
       1             0.0             0.0             0.0
       2             1.0             0.0             0.0
       3             1.0             1.0             0.0
       4             0.0             1.0             0.0
       5             0.0             0.0             1.0
       6             1.0             0.0             1.0
       7             1.0             1.0             1.0
       8             0.0             1.0             1.0
*ELEMENT_SOLID
       1      10       1       2       3       4       5       6       7       8
*END
";

/// A deck that has to be good.
pub fn good(text: &str) -> Deck {
    parse(text, "deck.k", DeckOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// The same numbers to the last bit have the same text.
pub fn same(a: &fallwerk::fe::model::Model, b: &fallwerk::fe::model::Model) {
    let (a, b) = (format!("{a:#?}"), format!("{b:#?}"));
    if let Some((left, right)) = a.lines().zip(b.lines()).find(|(x, y)| x != y) {
        panic!("{left} is not {right}");
    }
    assert_eq!(a.len(), b.len());
}

/// One change of a text that has to be there.
pub fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from:?} is not in the deck");
    text.replacen(from, to, 1)
}
