//! Principal directions of a symmetric tensor.

use nalgebra::Matrix3;

/// Principal values in falling order with their directions as columns. `t`: xx, yy, zz, xy, yz, zx.
pub fn principal(t: &[f64; 6]) -> ([f64; 3], Matrix3<f64>) {
    let a = [[t[0], t[3], t[5]], [t[3], t[1], t[4]], [t[5], t[4], t[2]]];
    let eigen = Matrix3::from_fn(|i, j| a[i][j]).symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|i, j| eigen.eigenvalues[*j].total_cmp(&eigen.eigenvalues[*i]));
    let values = order.map(|i| eigen.eigenvalues[i]);
    (values, Matrix3::from_columns(&order.map(|i| eigen.eigenvectors.column(i).into_owned())))
}

/// The tensor with these principal values and directions.
pub fn assemble(values: [f64; 3], q: &Matrix3<f64>) -> [f64; 6] {
    let at = |i: usize, j: usize| (0..3).map(|k| values[k] * q[(i, k)] * q[(j, k)]).sum();
    [at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(1, 2), at(2, 0)]
}
