//! Rotations with the same digits on every processor: those of `nalgebra` take sines of the system's library.

use nalgebra::{Matrix3, Vector3};

/// The matrix of a rotation vector \[rad\] (Rodrigues).
pub fn rotation(turn_rad: Vector3<f64>) -> Matrix3<f64> {
    let angle = turn_rad.norm();
    if angle == 0.0 {
        return Matrix3::identity();
    }
    let axis = turn_rad / angle;
    let (sin, cos) = libm::sincos(angle);
    Matrix3::identity() * cos + axis.cross_matrix() * sin + axis * axis.transpose() * (1.0 - cos)
}
