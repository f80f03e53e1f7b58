//! Values that few nodes have.

use serde::{Deserialize, Serialize};
use std::ops::{Index, IndexMut};

/// A value for every node, with a flag for the nodes whose value was ever set: the time loop reads one byte for all others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NodeField<T> {
    values: Vec<T>,
    set: Vec<bool>,
}

impl<T: Clone> NodeField<T> {
    /// `count` nodes with the same value, which counts as not set.
    pub fn new(value: T, count: usize) -> Self {
        Self { values: vec![value; count], set: vec![false; count] }
    }

    /// Whether the value of a node was set.
    #[inline]
    pub fn is_set(&self, node: usize) -> bool {
        self.set[node]
    }

    /// Appends a node with the value of another.
    pub fn push_copy(&mut self, node: usize) {
        self.values.push(self.values[node].clone());
        self.set.push(self.set[node]);
    }

    /// All values.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.values.iter()
    }
}

impl<T> Index<usize> for NodeField<T> {
    type Output = T;

    #[inline]
    fn index(&self, node: usize) -> &T {
        &self.values[node]
    }
}

impl<T> IndexMut<usize> for NodeField<T> {
    fn index_mut(&mut self, node: usize) -> &mut T {
        self.set[node] = true;
        &mut self.values[node]
    }
}
