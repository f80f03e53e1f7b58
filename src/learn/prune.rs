//! How far a tree is cut back: by cost-complexity, with the price of a leaf from a cross-validation by building.

use super::tree::{Node, Row, Table, cost};
use std::collections::{BTreeMap, BTreeSet};

/// Most parts that the buildings are divided into; with fewer buildings each is a part of its own.
const FOLDS: usize = 20;

/// A tree and what it costs in buildings that it has not seen.
#[derive(Debug, Clone)]
pub struct Validated {
    /// The tree, of all buildings.
    pub tree: Node,
    /// Price of a leaf.
    pub price: f64,
    /// Costs of the buildings, each by a tree that was grown without it.
    pub costs: Vec<(usize, f64)>,
    /// Costs of the same buildings by the rules in place.
    pub held_costs: Vec<(usize, f64)>,
    /// For each decided place of a building by a tree grown without it: probability of a yes, building, and whether it is one.
    pub predictions: Vec<(f64, usize, bool)>,
    /// Places about which the rules in place decide, since a tree does not.
    pub open: usize,
    /// Misses and false alarms of trees in buildings that they have not seen.
    pub errors: [usize; 2],
    /// The same of the rules in place.
    pub held_errors: [usize; 2],
}

impl Validated {
    /// Mean cost of a building.
    pub fn cost(&self) -> f64 {
        mean(&self.costs)
    }

    /// The same of the rules in place.
    pub fn held_cost(&self) -> f64 {
        mean(&self.held_costs)
    }

    /// Mean square of the distance between probability and truth, each building weighing the same.
    pub fn brier(&self) -> f64 {
        let mut sums = BTreeMap::<usize, [f64; 2]>::new();
        for (probability, building, yes) in &self.predictions {
            let [sum, count] = sums.entry(*building).or_default();
            *sum += (probability - f64::from(u8::from(*yes))).powi(2);
            *count += 1.0;
        }
        sums.values().map(|[sum, count]| sum / count).sum::<f64>() / sums.len().max(1) as f64
    }
}

fn mean(costs: &[(usize, f64)]) -> f64 {
    costs.iter().map(|(_, cost)| cost).sum::<f64>() / costs.len().max(1) as f64
}

/// A tree on all places, cut back to the simplest one that is no worse in other buildings than the best by more than the standard error of
/// their difference.
pub fn validated(table: &Table) -> Validated {
    let full = table.grown(|_| true);
    let prices = prices(&full);
    let parts = parts(table);
    let grown: Vec<Node> = parts.iter().map(|part| table.grown(|b| !part.contains(&b))).collect();
    let costs: Vec<Vec<(usize, f64)>> =
        prices.iter().map(|price| costs(table, &parts, &pruned(&grown, *price))).collect();
    let best = (0..costs.len()).reduce(|a, b| if mean(&costs[b]) <= mean(&costs[a]) { b } else { a });
    let best = best.unwrap_or(0);
    let no_worse = |i: &usize| {
        let [difference, error] = difference(&costs[*i], &costs[best]);
        difference <= error
    };
    let chosen = (best..costs.len()).rev().find(no_worse).unwrap_or(best);
    let trees = pruned(&grown, prices[chosen]);
    let (mut predictions, mut open) = (Vec::new(), 0);
    let (mut errors, mut held_errors) = ([0; 2], [0; 2]);
    for (part, tree) in parts.iter().zip(&trees) {
        for row in table.rows.iter().filter(|row| part.contains(&row.building)) {
            let decided = decided(table, tree, row);
            match decided {
                Some((probability, _)) => predictions.push((probability, row.building, row.yes)),
                None => open += 1,
            }
            let answer = decided.map_or(row.held, |(_, answer)| answer);
            errors[usize::from(answer)] += usize::from(answer != row.yes);
            held_errors[usize::from(row.held)] += usize::from(row.held != row.yes);
        }
    }
    let held = by_building(table, table.rows.iter().map(|row| (row, row.held)));
    let tree = full.pruned(prices[chosen]);
    Validated {
        tree,
        price: prices[chosen],
        costs: costs[chosen].clone(),
        held_costs: held,
        predictions,
        open,
        errors,
        held_errors,
    }
}

/// Prices of a leaf, one for each tree of the sequence that cutting back gives, ascending.
fn prices(full: &Node) -> Vec<f64> {
    let (mut bounds, mut tree) = (vec![0.0], full.pruned(0.0));
    while let Some(price) = tree.next_price() {
        bounds.push(price);
        tree = full.pruned(price);
    }
    // in the middle of the range in which a tree stays the same, since those of the parts change elsewhere
    let mut prices: Vec<f64> = bounds.windows(2).map(|w| (w[0] * w[1]).sqrt()).collect();
    prices.push(2.0 * bounds[bounds.len() - 1] + 1e-6);
    prices
}

/// Parts of the buildings, each with about as many that have a yes.
fn parts(table: &Table) -> Vec<BTreeSet<usize>> {
    let mut order = table.buildings();
    let with_yes: BTreeSet<usize> = table.rows.iter().filter(|r| r.yes).map(|r| r.building).collect();
    order.sort_by_key(|b| (with_yes.contains(b), *b));
    let count = FOLDS.min(order.len());
    let mut parts = vec![BTreeSet::new(); count];
    for (i, building) in order.into_iter().enumerate() {
        parts[i % count].insert(building);
    }
    parts
}

fn pruned(trees: &[Node], price: f64) -> Vec<Node> {
    trees.iter().map(|tree| tree.pruned(price)).collect()
}

/// What the tree decides about a place: probability of a yes and answer; `None`: the rules in place decide. They do where the place lies outside the values that the leaf was learned from.
pub fn decided(table: &Table, tree: &Node, row: &Row) -> Option<(f64, bool)> {
    let leaf = tree.leaf(&row.values)?;
    let inside = |column: usize| {
        let range = range(table, leaf, column)?;
        row.values[column].map(|x| (range[0]..=range[1]).contains(&x))
    };
    let path = path(tree, leaf);
    let numbers = path.iter().filter(|c| table.columns[**c].kind == super::tree::Kind::Number);
    let all_inside = numbers.into_iter().all(|c| inside(*c) == Some(true));
    leaf.count.answer().filter(|_| all_inside).map(|answer| (leaf.count.probability(), answer))
}

/// Columns asked on the way to a leaf, from the root.
fn path(tree: &Node, leaf: &Node) -> Vec<usize> {
    let mut columns = Vec::new();
    let mut node = tree;
    while let Some(split) = &node.split {
        columns.push(split.column);
        node = if contains(&split.low, leaf) { &split.low } else { &split.high };
    }
    columns
}

fn contains(node: &Node, leaf: &Node) -> bool {
    node.leaves().iter().any(|l| std::ptr::eq(*l, leaf))
}

/// The least and the largest value of a column in a leaf; `None` if none is known there.
pub fn range(table: &Table, leaf: &Node, column: usize) -> Option<[f64; 2]> {
    let values = leaf.rows.iter().filter_map(|i| table.rows[*i].values[column]);
    values.fold(None, |range: Option<[f64; 2]>, x| Some(range.map_or([x, x], |r| [r[0].min(x), r[1].max(x)])))
}

/// Costs of the buildings of each part by the tree that was grown without it.
fn costs(table: &Table, parts: &[BTreeSet<usize>], trees: &[Node]) -> Vec<(usize, f64)> {
    let answers = table.rows.iter().filter_map(|row| {
        let part = parts.iter().position(|p| p.contains(&row.building))?;
        let answer = decided(table, &trees[part], row).map_or(row.held, |(_, answer)| answer);
        Some((row, answer))
    });
    by_building(table, answers)
}

/// Mean cost of the places of each building.
fn by_building<'a>(table: &Table, answers: impl Iterator<Item = (&'a Row, bool)>) -> Vec<(usize, f64)> {
    let weights = table.weights();
    let mut sums: BTreeMap<usize, f64> = weights.keys().map(|b| (*b, 0.0)).collect();
    for (row, answer) in answers {
        if let Some(sum) = sums.get_mut(&row.building) {
            *sum += weights[&row.building] * cost(row, answer);
        }
    }
    sums.into_iter().collect()
}

/// Mean difference of the costs of the buildings, and its standard error.
fn difference(costs: &[(usize, f64)], best: &[(usize, f64)]) -> [f64; 2] {
    let differences: Vec<f64> = costs.iter().zip(best).map(|((_, a), (_, b))| a - b).collect();
    let count = differences.len().max(1) as f64;
    let mean = differences.iter().sum::<f64>() / count;
    let square: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum();
    [mean, (square / (count * (count - 1.0).max(1.0))).sqrt()]
}
