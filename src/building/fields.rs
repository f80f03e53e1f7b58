//! Values out of a tree beside its table of keys. Nothing is reported here: what is not as the table
//! wants it is `None`, and [`super::structure`] has said why.

use super::format::{Kind, Table};
use super::structure::quantity_of;
use crate::base::source::Span;
use crate::base::tree::{Node, Value};

/// Something with its place in the file.
#[derive(Debug, Clone)]
pub struct Placed<T> {
    /// The thing.
    pub item: T,
    /// Its place.
    pub span: Span,
}

/// A table of the file with what it may contain.
#[derive(Clone, Copy)]
pub struct Fields<'a> {
    /// The table.
    pub node: &'a Node,
    /// Its keys.
    pub table: &'static Table,
}

impl<'a> Fields<'a> {
    /// The value of a key.
    pub fn child(&self, key: &str) -> Option<&'a Node> {
        debug_assert!(self.table.key(key).is_some(), "{key} is not a key of {}", self.table.noun);
        self.node.get(key)
    }

    /// Place of a value, or of the table if there is none.
    pub fn span(&self, key: &str) -> Span {
        self.node.get(key).unwrap_or(self.node).span
    }

    /// A number in SI within its range.
    pub fn number(&self, key: &str) -> Option<f64> {
        number_of(self.child(key)?, &self.table.key(key)?.kind)
    }

    /// A whole number.
    pub fn count(&self, key: &str) -> Option<usize> {
        match (&self.child(key)?.value, &self.table.key(key)?.kind) {
            (Value::Number(value), Kind::Count(min, max))
                if value.fract() == 0.0 && *value >= f64::from(*min) && *value <= f64::from(*max) =>
            {
                Some(*value as usize)
            }
            _ => None,
        }
    }

    /// A text; of a choice only a supported word.
    pub fn text(&self, key: &str) -> Option<&'a str> {
        let text = self.child(key)?.text()?;
        match &self.table.key(key)?.kind {
            Kind::Choice(words, _) if !words.contains(&text) => None,
            _ => Some(text),
        }
    }

    /// A list or tuple of numbers; `None` if any of them is wrong.
    pub fn numbers(&self, key: &str) -> Option<Vec<f64>> {
        let node = self.child(key)?;
        let Value::List(items) = &node.value else { return None };
        match &self.table.key(key)?.kind {
            Kind::List(of, min, max) if (*min..=*max).contains(&items.len()) => {
                items.iter().map(|item| number_of(item, of)).collect()
            }
            Kind::Tuple(kinds) if kinds.len() == items.len() => {
                items.iter().zip(*kinds).map(|(item, kind)| number_of(item, kind)).collect()
            }
            _ => None,
        }
    }

    /// A point \[m\].
    pub fn point(&self, key: &str) -> Option<[f64; 3]> {
        self.numbers(key)?.try_into().ok()
    }

    /// A number, or a default if the key is not there; `None` if it is there and wrong.
    pub fn number_or(&self, key: &str, default: f64) -> Option<f64> {
        if self.child(key).is_none() { Some(default) } else { self.number(key) }
    }
}

/// The SI value of a node that is a quantity within its range.
pub fn number_of(node: &Node, kind: &Kind) -> Option<f64> {
    let Kind::Quantity(quantity) = kind else { return None };
    let value = quantity_of(node, quantity.dimension).ok()?;
    (value >= quantity.min && value <= quantity.max).then_some(value)
}
