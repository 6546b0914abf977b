//! Random numbers, the same ones for the same seed.

use core::f64::consts::PI;

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
