//! Simulated measurements: directions like a laboratory's, leaves with a known truth, noise with a seed.
#![allow(dead_code)]

mod random;

use leafbrdf_core::{Angle, Geometry, Leaf, Normalization, Surface};

pub use random::Random;

/// 41 directions at one θ_s: nadir, and θ_v 10–60° at seven azimuths, as on a hemispherical goniometer.
pub fn hemisphere(theta_s: f64) -> Vec<Geometry<f64>> {
    let mut directions = vec![(0.0, 0.0)];
    for phi in [0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0] {
        directions.extend((1..=6).map(|i| (10.0 * f64::from(i), phi)));
    }
    // the source blocks the two views nearest to it
    directions.retain(|&(theta_v, phi)| !(phi == 0.0 && (10.0..=20.0).contains(&theta_v)));
    directions.iter().map(|&(theta_v, phi)| geometry(theta_s, theta_v, phi)).collect()
}

pub fn geometry(theta_s: f64, theta_v: f64, phi_v: f64) -> Geometry<f64> {
    let deg = Angle::from_degrees;
    Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap()
}

/// BRDF in sr⁻¹ of a leaf with these parameters.
pub fn brdf(geometries: &[Geometry<f64>], [k_l, n, sigma]: [f64; 3], normalization: Normalization) -> Vec<f64> {
    let leaf = Leaf::new(k_l, Surface::new(n, sigma).unwrap().with_normalization(normalization)).unwrap();
    geometries.iter().map(|g| leaf.brdf(g)).collect()
}

/// χ² of Eq. 11, by the plain sum over the printed model.
pub fn chi2(geometries: &[Geometry<f64>], y: &[f64], parameters: [f64; 3], normalization: Normalization) -> f64 {
    brdf(geometries, parameters, normalization)
        .iter()
        .zip(y)
        .filter(|(_, y)| !y.is_nan())
        .map(|(m, y)| (m - y).powi(2))
        .sum()
}
