//! Disjoint sets as lists.

use petgraph::unionfind::UnionFind;
use std::collections::BTreeMap;

/// The sets of some elements: each in the order in which its elements are given, sets by the first of them.
pub fn groups(sets: &UnionFind<usize>, elements: impl IntoIterator<Item = usize>) -> Vec<Vec<usize>> {
    let mut places = BTreeMap::new();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for element in elements {
        let place = *places.entry(sets.find(element)).or_insert(groups.len());
        match groups.get_mut(place) {
            Some(group) => group.push(element),
            None => groups.push(vec![element]),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_come_by_their_first_element_whatever_their_root() {
        let mut sets = UnionFind::new(6);
        sets.union(5, 1);
        sets.union(4, 2);
        sets.union(2, 0);
        assert_eq!(groups(&sets, [1, 2, 3, 4, 5]), [vec![1, 5], vec![2, 4], vec![3]]);
        assert_eq!(groups(&sets, []), Vec::<Vec<usize>>::new());
    }
}
