//! A small decision tree: yes or no at places of buildings, with a miss that costs more than a false alarm.
//!
//! Each building weighs the same, however many places it has, since places of one building are no independent evidence. A split is the one
//! that lowers the Gini impurity of the costs most (Breiman, Friedman, Olshen, Stone, Classification and Regression Trees, 1984); a split that
//! says the opposite of what mechanics asks for is not made but kept beside the node. Places that do not know the feature of a split
//! are in neither branch: about them the rules in place decide, as they do about places that are in no branch with enough buildings.

use std::collections::BTreeMap;

/// What missing a yes costs, a false alarm costing 1. Above this ratio of its probability to that of a no, 1 : 4, a place counts as a yes.
///
/// An assumption about consequences: a hinge that is not there holds a storey or a floor together for the whole run, a latent hinge too many
/// costs the run time of a body.
pub const MISS_COST: f64 = 4.0;
/// Fewest buildings on either side of a split.
pub const SPLIT_BUILDINGS: usize = 3;
/// Fewest buildings behind a rule that is used.
pub const RULE_BUILDINGS: usize = 5;
/// Fewest buildings with a yes behind a rule that says yes.
pub const YES_BUILDINGS: usize = 3;
/// Largest share of places that may not know the feature of a split.
const MOST_UNKNOWN: f64 = 0.2;
/// Most splits above a leaf.
const DEPTH: usize = 4;
/// Gains and costs that differ by less are equal.
const SAME: f64 = 1e-9;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number,
    /// 1 for true, 0 for false.
    Flag,
    /// 1 if the name is this one, else 0.
    Is(&'static str),
}

/// A feature, or one name of a feature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Name of the feature.
    pub feature: &'static str,
    /// What is held.
    pub kind: Kind,
    /// What mechanics asks for: with a larger value a yes becomes more (`Some(true)`) or less (`Some(false)`) likely.
    pub more: Option<bool>,
}

/// A place with its answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Number of its building.
    pub building: usize,
    /// Id of the place.
    pub place: String,
    /// Values of the columns; `None`: not known.
    pub values: Vec<Option<f64>>,
    /// What the study shows.
    pub yes: bool,
    /// What the rules in place say.
    pub held: bool,
}

/// Places and yeses by building.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Count(pub BTreeMap<usize, [usize; 2]>);

impl Count {
    /// Of some rows.
    pub fn of<'a>(rows: impl Iterator<Item = &'a Row>) -> Self {
        let mut count = Self::default();
        for row in rows {
            let [places, yes] = count.0.entry(row.building).or_default();
            *places += 1;
            *yes += usize::from(row.yes);
        }
        count
    }

    /// Places.
    pub fn places(&self) -> usize {
        self.0.values().map(|[places, _]| places).sum()
    }

    /// Places with a yes.
    pub fn yes(&self) -> usize {
        self.0.values().map(|[_, yes]| yes).sum()
    }

    /// Probability of a yes at such a place of another building: the mean of the shares of the buildings, after Laplace.
    pub fn probability(&self) -> f64 {
        let shares: f64 = self.0.values().map(|[places, yes]| *yes as f64 / *places as f64).sum();
        (shares + 1.0) / (self.0.len() as f64 + 2.0)
    }

    /// The answer that costs less.
    pub fn says(&self) -> bool {
        self.probability() * MISS_COST > 1.0 - self.probability() + SAME
    }

    /// The same, if there are enough buildings behind it.
    pub fn answer(&self) -> Option<bool> {
        let says = self.says();
        let with_yes = self.0.values().filter(|[_, yes]| *yes > 0).count();
        (self.0.len() >= RULE_BUILDINGS && (!says || with_yes >= YES_BUILDINGS)).then_some(says)
    }
}

/// Cost of an answer at a place.
pub fn cost(row: &Row, answer: bool) -> f64 {
    match (row.yes, answer) {
        (true, false) => MISS_COST,
        (false, true) => 1.0,
        _ => 0.0,
    }
}

/// A node of a tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Numbers of its rows.
    pub rows: Vec<usize>,
    /// Their places and yeses.
    pub count: Count,
    /// Cost if it were a leaf.
    cost: f64,
    /// How it is divided.
    pub split: Option<Box<Split>>,
    /// The best split, if that contradicts mechanics.
    pub refused: Option<Box<Split>>,
}

/// Two branches.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// Number of the column.
    pub column: usize,
    /// Values up to this one go to `low`.
    pub threshold: f64,
    /// Up to the threshold.
    pub low: Node,
    /// Above it.
    pub high: Node,
    /// Cost of the places that do not know the feature.
    unknown: f64,
}

/// Places to learn from.
#[derive(Debug, Clone)]
pub struct Table {
    /// The columns; of equally good splits that of the first is made.
    pub columns: Vec<Column>,
    /// The places.
    pub rows: Vec<Row>,
}

impl Table {
    /// Numbers of the buildings that have places in it.
    pub fn buildings(&self) -> Vec<usize> {
        Count::of(self.rows.iter()).0.into_keys().collect()
    }

    /// The full tree on the places of some buildings.
    pub fn grown(&self, of: impl Fn(usize) -> bool) -> Node {
        let rows: Vec<usize> = (0..self.rows.len()).filter(|i| of(self.rows[*i].building)).collect();
        let weights = self.weights();
        self.node(rows, &weights, 0)
    }

    /// What a place of each building weighs: all of a building together weigh 1.
    pub fn weights(&self) -> BTreeMap<usize, f64> {
        let places = Count::of(self.rows.iter());
        places.0.into_iter().map(|(building, [places, _])| (building, 1.0 / places as f64)).collect()
    }

    fn node(&self, rows: Vec<usize>, weights: &BTreeMap<usize, f64>, depth: usize) -> Node {
        let count = Count::of(rows.iter().map(|i| &self.rows[*i]));
        let answer = count.answer();
        let of = |i: &usize| {
            let row = &self.rows[*i];
            weights[&row.building] * cost(row, answer.unwrap_or(row.held))
        };
        let mut node = Node { cost: rows.iter().map(of).sum(), rows, count, split: None, refused: None };
        if depth < DEPTH {
            let (best, refused) = self.best(&node.rows, weights);
            node.split = best.map(|cut| Box::new(self.split(&node.rows, cut, weights, depth)));
            node.refused = refused.map(|cut| Box::new(self.split(&node.rows, cut, weights, DEPTH)));
        }
        node
    }

    fn split(&self, rows: &[usize], cut: Cut, weights: &BTreeMap<usize, f64>, depth: usize) -> Split {
        let value = |i: &usize| self.rows[*i].values[cut.column];
        let part =
            |of: &dyn Fn(f64) -> bool| rows.iter().copied().filter(|i| value(i).is_some_and(of)).collect();
        let unknown = rows.iter().filter(|i| value(i).is_none()).map(|i| &self.rows[*i]);
        Split {
            column: cut.column,
            threshold: cut.threshold,
            unknown: unknown.map(|row| weights[&row.building] * cost(row, row.held)).sum(),
            low: self.node(part(&|x| x <= cut.threshold), weights, depth + 1),
            high: self.node(part(&|x| x > cut.threshold), weights, depth + 1),
        }
    }

    /// The best split that mechanics allows, and the one that it does not allow if that would be better.
    fn best(&self, rows: &[usize], weights: &BTreeMap<usize, f64>) -> (Option<Cut>, Option<Cut>) {
        let (mut best, mut refused): (Option<Cut>, Option<Cut>) = (None, None);
        for column in 0..self.columns.len() {
            for cut in self.cuts(rows, column, weights) {
                let held = if cut.against { &mut refused } else { &mut best };
                if held.as_ref().is_none_or(|h| cut.gain > h.gain + SAME) {
                    *held = Some(cut);
                }
            }
        }
        let least = best.as_ref().map_or(0.0, |b| b.gain);
        (best, refused.filter(|r| r.gain > least + SAME))
    }

    /// All splits at a column that lower the impurity.
    fn cuts(&self, rows: &[usize], column: usize, weights: &BTreeMap<usize, f64>) -> Vec<Cut> {
        let mut known: Vec<(f64, &Row)> =
            rows.iter().filter_map(|i| Some((self.rows[*i].values[column]?, &self.rows[*i]))).collect();
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let side = |rows: &mut dyn Iterator<Item = &Row>| {
            let mut side = Side::default();
            rows.for_each(|row| side.add(row, weights[&row.building]));
            side
        };
        let is_unknown = |row: &&Row| row.values[column].is_none();
        let all = side(&mut rows.iter().map(|i| &self.rows[*i]));
        let unknown = side(&mut rows.iter().map(|i| &self.rows[*i]).filter(is_unknown));
        if unknown.total() > MOST_UNKNOWN * all.total() {
            return Vec::new();
        }
        let whole = all.impurity() - unknown.impurity();
        let mut high = side(&mut known.iter().map(|(_, row)| *row));
        let (mut low, mut found) = (Side::default(), Vec::new());
        for pair in known.windows(2) {
            let [(at, row), (next, _)] = [pair[0], pair[1]];
            low.add(row, weights[&row.building]);
            high.take(row, weights[&row.building]);
            if at == next || low.buildings() < SPLIT_BUILDINGS || high.buildings() < SPLIT_BUILDINGS {
                continue;
            }
            let gain = whole - low.impurity() - high.impurity();
            let against = self.columns[column].more.is_some_and(|more| {
                let rise = high.share() - low.share();
                rise.abs() > SAME && (rise > 0.0) != more
            });
            if gain > SAME {
                found.push(Cut { column, threshold: between(at, next), gain, against });
            }
        }
        found
    }
}

/// A possible split.
#[derive(Debug, Clone, Copy)]
struct Cut {
    column: usize,
    threshold: f64,
    gain: f64,
    against: bool,
}

/// The places on one side of a split.
#[derive(Default)]
struct Side {
    /// Weights of the no and of the yes.
    weight: [f64; 2],
    places: BTreeMap<usize, usize>,
}

impl Side {
    fn add(&mut self, row: &Row, weight: f64) {
        self.weight[usize::from(row.yes)] += weight;
        *self.places.entry(row.building).or_default() += 1;
    }

    fn take(&mut self, row: &Row, weight: f64) {
        self.weight[usize::from(row.yes)] -= weight;
        if let Some(places) = self.places.get_mut(&row.building) {
            *places -= 1;
            if *places == 0 {
                self.places.remove(&row.building);
            }
        }
    }

    fn total(&self) -> f64 {
        self.weight[0] + self.weight[1]
    }

    fn buildings(&self) -> usize {
        self.places.len()
    }

    fn impurity(&self) -> f64 {
        let (no, yes) = (self.weight[0].max(0.0), MISS_COST * self.weight[1].max(0.0));
        if no + yes > 0.0 { 2.0 * no * yes / (no + yes) } else { 0.0 }
    }

    fn share(&self) -> f64 {
        self.weight[1] / self.total()
    }
}

impl Node {
    /// Its leaves.
    pub fn leaves(&self) -> Vec<&Node> {
        match &self.split {
            None => vec![self],
            Some(split) => [split.low.leaves(), split.high.leaves()].concat(),
        }
    }

    /// Cost of its leaves.
    pub fn cost(&self) -> f64 {
        self.split.as_ref().map_or(self.cost, |s| s.low.cost() + s.high.cost() + s.unknown)
    }

    /// The smallest tree of least cost, if a leaf costs so much.
    pub fn pruned(&self, of_leaf: f64) -> Self {
        let mut pruned = self.clone();
        if let Some(split) = &self.split {
            let split = Split { low: split.low.pruned(of_leaf), high: split.high.pruned(of_leaf), ..**split };
            pruned.split = Some(Box::new(split));
            let leaves = pruned.leaves().len() as f64;
            if self.cost <= pruned.cost() + of_leaf * (leaves - 1.0) + SAME {
                pruned.split = None;
            }
        }
        pruned
    }

    /// The price of a leaf at which the next branch goes; `None` for a leaf.
    pub fn next_price(&self) -> Option<f64> {
        let split = self.split.as_ref()?;
        let own = (self.cost - self.cost()) / (self.leaves().len() as f64 - 1.0);
        [Some(own), split.low.next_price(), split.high.next_price()].into_iter().flatten().reduce(f64::min)
    }

    /// The leaf that a place belongs to; `None` if it does not know a feature.
    pub fn leaf(&self, values: &[Option<f64>]) -> Option<&Node> {
        match &self.split {
            None => Some(self),
            Some(split) if values[split.column]? <= split.threshold => split.low.leaf(values),
            Some(split) => split.high.leaf(values),
        }
    }
}

impl Split {
    /// How much less the two branches cost than the node they divide.
    pub fn saves(&self, node: &Node) -> f64 {
        node.cost - (self.low.cost + self.high.cost + self.unknown)
    }
}

/// The decimal with the fewest digits from `low` on and below `high`, near their middle.
pub fn between(low: f64, high: f64) -> f64 {
    let middle = 0.5 * low + 0.5 * high;
    let size = low.abs().max(high.abs()).max(f64::MIN_POSITIVE);
    let first = -(libm::log10(size).ceil() as i32);
    for digits in first..first + 17 {
        let text = if digits > 0 {
            format!("{middle:.*}", digits as usize)
        } else {
            let unit = 10_f64.powi(-digits);
            format!("{}", (middle / unit).round() * unit)
        };
        if let Some(value) = text.parse::<f64>().ok().filter(|v| low <= *v && *v < high) {
            return value + 0.0;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::between;

    #[test]
    fn thresholds_are_short_decimals_between_their_neighbours() {
        assert_eq!(between(1.73, 2.31), 2.0);
        assert_eq!(between(1.731, 1.789), 1.76);
        assert_eq!(between(0.0, 1.0), 0.5);
        assert_eq!(between(130.0, 190.0), 160.0);
        assert_eq!(between(-0.4, 0.3), 0.0);
        assert_eq!(between(0.0061, 0.0065), 0.0063);
    }
}
