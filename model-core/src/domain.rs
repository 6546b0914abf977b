//! What the model accepts, in one place: from power of two to power of two, so that a device compares the bits of a number with
//! constants that fit into an instruction. Least and largest.

/// n.
pub const N: [f64; 2] = [1.0, (1 << 14) as f64];
/// σ: its square, and what is divided by it, stay in the range of `f32`.
pub const SIGMA: [f64; 2] = [1.0 / (1 << 30) as f64, (1 << 10) as f64];
/// Cosines of zenith angles where a function takes them unchecked otherwise: from 1 nrad above the horizon no product leaves the range
/// of `f32`.
pub const COS: [f64; 2] = [1.0 / (1 << 30) as f64, 1.0];
