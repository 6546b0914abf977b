//! The value of `--normalization`.

use clap::ValueEnum;
use leafbrdf_core::Normalization;

/// The constant K of Eq. 10.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum NormalizationName {
    /// K = 2π², Eq. 10 as printed
    #[value(name = "bousquet2005")]
    Bousquet2005,
    /// K = 4π, as derived; conserves energy
    #[value(name = "cook-torrance")]
    CookTorrance,
}

impl From<NormalizationName> for Normalization {
    fn from(name: NormalizationName) -> Self {
        match name {
            NormalizationName::Bousquet2005 => Normalization::Bousquet2005,
            NormalizationName::CookTorrance => Normalization::CookTorrance,
        }
    }
}
