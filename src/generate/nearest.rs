//! The nearest of many places in plan: a balanced tree laid out in one sorted list, `n log n` to build and `log n` to ask.

/// Places in plan, each with what is known there.
#[derive(Debug, Clone, Default)]
pub struct Nearest<T> {
    places: Vec<([f64; 2], T)>,
}

impl<T: Copy> Nearest<T> {
    /// Of some places.
    pub fn of(mut places: Vec<([f64; 2], T)>) -> Self {
        arrange(&mut places, 0);
        Self { places }
    }

    /// The place nearest to a point, with its distance.
    pub fn to(&self, point: [f64; 2]) -> Option<(f64, [f64; 2], T)> {
        let mut best = None;
        search(&self.places, 0, point, &mut best);
        best.map(|(squared, place, known): (f64, [f64; 2], T)| (squared.sqrt(), place, known))
    }
}

/// Puts the median along the axis into the middle, and does the same with both halves along the other axis.
fn arrange<T>(places: &mut [([f64; 2], T)], axis: usize) {
    if places.len() < 2 {
        return;
    }
    let middle = places.len() / 2;
    let order =
        |a: [f64; 2], b: [f64; 2]| a[axis].total_cmp(&b[axis]).then(a[1 - axis].total_cmp(&b[1 - axis]));
    places.select_nth_unstable_by(middle, |a, b| order(a.0, b.0));
    let (low, high) = places.split_at_mut(middle);
    arrange(low, 1 - axis);
    arrange(&mut high[1..], 1 - axis);
}

/// Of places equally far away the one with the smaller coordinates counts, whatever the order of the list was.
fn search<T: Copy>(
    places: &[([f64; 2], T)],
    axis: usize,
    point: [f64; 2],
    best: &mut Option<(f64, [f64; 2], T)>,
) {
    let middle = places.len() / 2;
    let Some((place, known)) = places.get(middle) else { return };
    let squared = (place[0] - point[0]).powi(2) + (place[1] - point[1]).powi(2);
    if best.is_none_or(|(held, at, _)| squared < held || (squared == held && *place < at)) {
        *best = Some((squared, *place, *known));
    }
    let ahead = point[axis] - place[axis];
    let (near, far) = (&places[..middle], &places[middle + 1..]);
    let (near, far) = if ahead <= 0.0 { (near, far) } else { (far, near) };
    search(near, 1 - axis, point, best);
    if best.is_none_or(|(held, ..)| ahead * ahead <= held) {
        search(far, 1 - axis, point, best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;

    #[test]
    fn the_tree_finds_what_a_walk_through_all_places_finds() {
        let mut random = Random::of(7);
        // Whole numbers, so that places meet and lie in line.
        let mut next = || random.below(256) as f64;
        let places: Vec<([f64; 2], usize)> = (0..300).map(|i| ([next(), next()], i)).collect();
        let tree = Nearest::of(places.clone());
        for _ in 0..300 {
            let point = [next() + 0.5, next()];
            let far = |p: [f64; 2]| ((p[0] - point[0]).powi(2) + (p[1] - point[1]).powi(2)).sqrt();
            let least = places.iter().map(|(p, _)| far(*p)).fold(f64::INFINITY, f64::min);
            assert_eq!(tree.to(point).map(|(distance, ..)| distance), Some(least));
        }
        assert!(Nearest::<()>::of(Vec::new()).to([0.0, 0.0]).is_none());
    }
}
