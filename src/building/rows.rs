//! Rows on which columns stand.

/// Columns nearer to each other than this along x or y stand in one row \[m\].
pub const SAME_ROW_M: f64 = 0.75;
/// How far a member may be above or below a floor that it meets \[m\].
pub const MEETS_M: f64 = 1e-3;

/// A row of columns, or an axis of none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Its place \[m\].
    pub at_m: f64,
    /// Mean width of the columns in it; none: zero \[m\].
    pub width_m: f64,
}

impl Row {
    /// The row nearest to a place.
    pub fn nearest(rows: &[Self], at_m: f64) -> usize {
        let distance = |i: &usize| (rows[*i].at_m - at_m).abs();
        (0..rows.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    }
}

/// Places and widths gathered in rows, in order.
pub fn rows(mut places: Vec<[f64; 2]>) -> Vec<Row> {
    places.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut groups: Vec<Vec<[f64; 2]>> = Vec::new();
    for place in places {
        match groups.last_mut().filter(|g| place[0] - g[0][0] < SAME_ROW_M) {
            Some(group) => group.push(place),
            None => groups.push(vec![place]),
        }
    }
    let mean = |g: &[[f64; 2]], i: usize| g.iter().map(|p| p[i]).sum::<f64>() / g.len() as f64;
    groups.iter().map(|g| Row { at_m: mean(g, 0), width_m: mean(g, 1) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_out_of_line_stand_in_one_row() {
        let rows = rows(vec![[5.0, 0.4], [0.0, 0.4], [0.2, 0.6], [5.0, 0.4]]);
        assert_eq!(rows.len(), 2);
        assert!((rows[0].at_m - 0.1).abs() < 1e-12 && (rows[0].width_m - 0.5).abs() < 1e-12, "{rows:?}");
        assert_eq!([0.0, 2.5, 2.6, 9.0].map(|at| Row::nearest(&rows, at)), [0, 0, 1, 1]);
    }
}
