//! Random leaves for PROSPECT, always the same ones.

use leafbrdf_fit::hemispherical::default_free;
use leafbrdf_prospect::{LeafParams, Parameter, Version};

/// SplitMix64: a fixed sequence of numbers.
pub struct Random(pub u64);

impl Random {
    pub fn uniform(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        from + (to - from) * (z >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// N(0, 1).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform(0.0, 1.0), self.uniform(0.0, 1.0));
        (-2.0 * u.ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
    }

    /// Uniform in N 1–3, C_ab 2–90, C_car 1–25, C_ant 0–15 µg cm⁻², C_brown 0–1, C_w 0.002–0.05 cm, C_m 0.001–0.02, C_prot
    /// 0.0002–0.003, C_cbc 0.0008–0.018 g cm⁻², as far as the version has them.
    pub fn leaf(&mut self, version: Version) -> LeafParams<f64> {
        let mut leaf = LeafParams::with_n_struct(self.uniform(1.0, 3.0));
        for parameter in default_free(version).into_iter().skip(1) {
            let (from, to) = match parameter {
                Parameter::NStruct => (1.0, 3.0),
                Parameter::Cab => (2.0, 90.0),
                Parameter::Car => (1.0, 25.0),
                Parameter::Cant => (0.0, 15.0),
                Parameter::Cbrown => (0.0, 1.0),
                Parameter::Cw => (0.002, 0.05),
                Parameter::Cm => (0.001, 0.02),
                Parameter::Prot => (0.0002, 0.003),
                Parameter::Cbc => (0.0008, 0.018),
            };
            leaf.set(parameter, self.uniform(from, to));
        }
        leaf
    }
}
