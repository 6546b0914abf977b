//! `--prospect`, `--model` of `prospect`: which version of PROSPECT.

use clap::ValueEnum;
use clap::builder::PossibleValue;
use leafbrdf_prospect::Version;

/// A version by the name that users write, in any case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VersionName(pub Version);

impl ValueEnum for VersionName {
    fn value_variants<'a>() -> &'a [Self] {
        &[VersionName(Version::P5B), VersionName(Version::D), VersionName(Version::Pro)]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let help = match self.0 {
            Version::P5B => "PROSPECT-5B: chlorophylls, carotenoids, brown pigments, water, dry matter",
            Version::D => "PROSPECT-D: the same and anthocyanins",
            Version::Pro => "PROSPECT-PRO: dry matter split into proteins and other carbon-based constituents",
        };
        Some(PossibleValue::new(self.0.name()).help(help))
    }
}
