//! Random leaves for PROSPECT.

use leafbrdf_fit::hemispherical::default_free;
use leafbrdf_prospect::{LeafParams, Parameter, Version};

use crate::random::Random;

/// Uniform in N 1–3, C_ab 2–90, C_car 1–25, C_ant 0–15 µg cm⁻², C_brown 0–1, C_w 0.002–0.05 cm, C_m 0.001–0.02, C_prot
/// 0.0002–0.003, C_cbc 0.0008–0.018 g cm⁻², as far as the version has them.
pub fn random_leaf(random: &mut Random, version: Version) -> LeafParams<f64> {
    let mut leaf = LeafParams::with_n_struct(random.uniform(1.0, 3.0));
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
        leaf.set(parameter, random.uniform(from, to));
    }
    leaf
}
