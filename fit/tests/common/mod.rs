//! Simulated measurements: directions like a laboratory's, leaves with a known truth, noise with a seed.
#![allow(dead_code)]

use core::f64::consts::PI;

use leafbrdf_core::{Angle, Geometry, Leaf, Normalization, Surface};

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

/// Seeded random numbers (splitmix64, Steele et al. 2014): enough for test data.
pub struct Random(pub u64);

impl Random {
    pub fn uniform(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let unit = ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64;
        from + (to - from) * unit
    }

    /// Standard normal (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform(f64::MIN_POSITIVE, 1.0).ln()).sqrt();
        radius * (2.0 * PI * self.uniform(0.0, 1.0)).cos()
    }
}
