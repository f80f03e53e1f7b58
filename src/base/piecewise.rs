//! Lines through points.

/// Value at `x` of the line through points `[x, y]` with rising `x`, constant beyond its ends; 0 without points.
pub fn interpolate(points: &[[f64; 2]], x: f64) -> f64 {
    let upper = points.partition_point(|p| p[0] <= x);
    match (upper.checked_sub(1).map(|i| points[i]), points.get(upper)) {
        (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some([_, last]), None) => last,
        (None, Some([_, first])) => *first,
        (None, None) => 0.0,
    }
}

/// Where the points of several lines are, each place once, in rising order.
pub fn places<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Vec<f64> {
    let mut places: Vec<f64> = points.map(|p| p[0]).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

#[cfg(test)]
mod tests {
    use super::interpolate;

    #[test]
    fn straight_between_points_and_constant_beyond() {
        let points = [[1.0, 10.0], [3.0, 20.0], [4.0, 0.0]];
        let values = [0.0, 1.0, 2.0, 3.0, 3.5, 4.0, 9.0].map(|x| interpolate(&points, x));
        assert_eq!(values, [10.0, 10.0, 15.0, 20.0, 10.0, 0.0, 0.0]);
        assert_eq!(interpolate(&[], 1.0), 0.0);
    }
}
