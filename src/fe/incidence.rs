//! Which elements stand at which node.

/// Elements at each of `count` nodes, in element order: where the entries of each node start, one more than nodes, and the list.
pub(super) fn elements_of_nodes(elements: &[[u32; 8]], count: usize) -> (Vec<u32>, Vec<u32>) {
    let starts = starts_of(count, elements.as_flattened().iter().map(|n| *n as usize));
    let mut next = starts.clone();
    let mut list = vec![0; starts[count] as usize];
    for (index, nodes) in elements.iter().enumerate() {
        for n in nodes {
            list[next[*n as usize] as usize] = index as u32;
            next[*n as usize] += 1;
        }
    }
    (starts, list)
}

/// Running sums of how often each of `count` keys occurs: where its entries start in a sorted list, one more than keys.
pub(super) fn starts_of(count: usize, keys: impl Iterator<Item = usize>) -> Vec<u32> {
    let mut starts = vec![0u32; count + 1];
    for key in keys {
        starts[key + 1] += 1;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    starts
}
