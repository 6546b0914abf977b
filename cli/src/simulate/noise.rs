//! What an instrument adds to a value, from a seed.

use leafbrdf_core::{Portable, Real};

use crate::measurement::Metadata;

/// Independent Gaussian noise of standard deviation √((relative · value)² + absolute²).
#[derive(Clone, Debug)]
pub struct Noise {
    /// Part that grows with the signal, unitless.
    pub relative: f64,
    /// Part that is always there, sr⁻¹ of BRDF.
    pub absolute: f64,
    gauss: Gauss,
}

impl Noise {
    /// 1 % of the value and 0.003 sr⁻¹: the paper gives no error of its instrument (§2.2).
    pub const RELATIVE: f64 = 0.01;
    /// See [`RELATIVE`](Self::RELATIVE).
    pub const ABSOLUTE: f64 = 0.003;

    /// Noise of the given size.
    pub fn new(relative: f64, absolute: f64, seed: u64) -> Self {
        Noise { relative, absolute, gauss: Gauss::new(seed) }
    }

    /// Whether nothing is added to any value.
    pub fn is_nothing(&self) -> bool {
        self.relative == 0.0 && self.absolute == 0.0
    }

    /// The standard deviation that is added to a value, sr⁻¹.
    pub fn sd(&self, brdf: f64) -> f64 {
        let proportional = self.relative * brdf;
        (proportional * proportional + self.absolute * self.absolute).sqrt()
    }

    /// Size and seed as a line of a file's header.
    pub fn describe(&self, seed: u64, metadata: &mut Metadata) {
        let Noise { relative, absolute, .. } = self;
        let text = format!("Gaussian, sd^2 = ({relative} of the value)^2 + ({absolute} sr^-1)^2, seed {seed}");
        metadata.push("noise", if self.is_nothing() { "none".to_string() } else { text });
    }

    /// A value with noise, sr⁻¹; a missing one (NaN) stays missing.
    pub fn on(&mut self, brdf: f64) -> f64 {
        brdf + self.sd(brdf) * self.gauss.draw()
    }
}

/// Standard normal numbers: uniform ones by SplitMix64 (Steele, Lea & Flood 2014, doi:10.1145/2714064.2660195), made normal by
/// Marsaglia's polar method (Marsaglia & Bray 1964). Integer arithmetic, square root and the crate's own logarithm: the same
/// numbers on every machine.
#[derive(Clone, Debug)]
pub struct Gauss {
    state: u64,
    spare: Option<f64>,
}

impl Gauss {
    /// The sequence that belongs to a seed.
    pub fn new(seed: u64) -> Self {
        Gauss { state: seed, spare: None }
    }

    /// The next 64 bits.
    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [−1, 1), on multiples of 2⁻⁵².
    fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * f64::EPSILON - 1.0
    }

    /// The next number of mean 0 and standard deviation 1.
    pub fn draw(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (x, y) = (self.uniform(), self.uniform());
            let r2 = x * x + y * y;
            if r2 > 0.0 && r2 < 1.0 {
                let scale = (-2.0 * Portable(r2).ln().0 / r2).sqrt();
                self.spare = Some(y * scale);
                return x * scale;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // First outputs of SplitMix64 for seed 1234567, as published with the algorithm's reference code.
    #[test]
    fn the_bits_are_those_of_splitmix64() {
        let mut gauss = Gauss::new(1_234_567);
        let bits: Vec<u64> = (0..3).map(|_| gauss.bits()).collect();
        assert_eq!(bits, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
    }

    // Over a million draws the standard errors are 0.001, 0.0014, 0.0005 (share beyond 1 sd): five of them are allowed.
    #[test]
    fn a_million_numbers_have_mean_0_variance_1_and_68_percent_within_one_sd() {
        let mut gauss = Gauss::new(1);
        let draws: Vec<f64> = (0..1_000_000).map(|_| gauss.draw()).collect();
        let mean = draws.iter().sum::<f64>() / 1e6;
        let variance = draws.iter().map(|x| x * x).sum::<f64>() / 1e6;
        let within = draws.iter().filter(|x| x.abs() < 1.0).count() as f64 / 1e6;
        assert!(mean.abs() < 0.005 && (variance - 1.0).abs() < 0.007, "{mean} {variance}");
        assert!((within - 0.682_689).abs() < 0.0024, "{within}");
    }

    #[test]
    fn noise_grows_with_the_signal_from_its_floor() {
        let noise = Noise::new(0.01, 0.003, 1);
        assert_eq!(noise.sd(0.0), 0.003);
        assert!((noise.sd(0.4) - 0.005).abs() < 1e-15);
    }
}
