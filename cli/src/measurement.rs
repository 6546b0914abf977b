//! Leaf measurements: the data model, and the files it is read from and written to.
//!
//! | room | what |
//! |---|---|
//! | `input` | bytes → text: standard input, gzip, byte order mark, line ends, what is not text at all |
//! | `header` | `# key: value` lines |
//! | `cell` | one cell → one number, to the last bit |
//! | `wide`, `long` | the two layouts |
//! | `check` | what the columns of both layouts must satisfy |
//! | `directions` | the directions alone, of these files or of a table of angles |
//! | `azimuth` | the two azimuth conventions |
//! | `write` | both layouts again, outwards |
//!
//! The rules are those of `docs/formats.md`.

mod azimuth;
pub(crate) mod cell;
mod check;
pub(crate) mod columns;
mod directions;
mod error;
pub(crate) mod header;
pub(crate) mod input;
mod long;
pub(crate) mod read;
mod wide;
mod write;

pub use azimuth::Azimuth;
pub use directions::{directions_from_bytes, read_directions};
pub use error::{ReadError, WriteError};
pub use header::Metadata;
pub use read::{ReadOptions, read_bytes, read_path, stem};
pub use write::{WriteOptions, render, write_path};

use std::f64::consts::PI;

/// Which quantity the values of a file are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Quantity {
    /// Bidirectional reflectance factor, π · BRDF, unitless.
    Brf,
    /// Bidirectional reflectance distribution function, sr⁻¹.
    Brdf,
}

impl Quantity {
    /// As it stands in files: `brf` or `brdf`.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Brf => "brf",
            Quantity::Brdf => "brdf",
        }
    }

    pub(crate) fn from_name(name: &str) -> Option<Self> {
        [Quantity::Brf, Quantity::Brdf].into_iter().find(|quantity| name.eq_ignore_ascii_case(quantity.name()))
    }
}

/// How a file is laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Layout {
    /// One column a direction, one row a wavelength.
    Wide,
    /// One row a value.
    Long,
}

/// Where the light comes from and where it is seen, in degrees.
///
/// φ_v is counted from the illumination azimuth, and 180° is the forward (specular) side, whatever the file's own
/// convention was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// θ_s, illumination zenith angle, [0, 90).
    pub theta_s_deg: f64,
    /// θ_v, viewing zenith angle, [0, 90).
    pub theta_v_deg: f64,
    /// φ_v, viewing azimuth, |φ_v| ≤ 360; kept as the file spells it (−30 and 330 are the same direction).
    pub phi_v_deg: f64,
}

impl Direction {
    /// The same three bit patterns for the same direction: φ_v in [0, 360), no negative zero.
    pub(crate) fn key(&self) -> [u64; 3] {
        let phi = if self.phi_v_deg < 0.0 { self.phi_v_deg + 360.0 } else { self.phi_v_deg };
        let phi = if phi >= 360.0 { phi - 360.0 } else { phi };
        [self.theta_s_deg + 0.0, self.theta_v_deg + 0.0, phi + 0.0].map(f64::to_bits)
    }
}

/// How many values a measurement has, and what is odd about them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Numbers, negative ones included.
    pub usable: usize,
    /// Empty cells, `NaN`, `NA`, and pairs of wavelength and direction that a long file has no row for.
    pub missing: usize,
    /// Numbers below zero: noise, kept.
    pub negative: usize,
}

/// One leaf: reflectance at some wavelengths, in some directions.
///
/// Values stand band by band: `values[band * directions.len() + direction]`. They are kept in the quantity of the file,
/// so that writing them back changes no bit; [`Measurement::brdf`] gives what the model is fitted to.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// What to call the leaf: its `sample`, else the stem of the file's name.
    pub name: String,
    /// What the file calls the leaf: its line `# sample: …`, or the cell in its column `sample`.
    pub sample: Option<String>,
    /// The file's `# key: value` lines, except for quantity, azimuth and sample, which are fields of their own.
    pub metadata: Metadata,
    /// What the values are.
    pub quantity: Quantity,
    /// The file's layout.
    pub layout: Layout,
    /// The file's azimuth convention; [`Direction::phi_v_deg`] is `forward_180` always.
    pub azimuth: Azimuth,
    /// Wavelengths in nm, ascending, each once.
    pub wavelengths_nm: Vec<f64>,
    /// Directions in the order of the file, each once.
    pub directions: Vec<Direction>,
    /// One value a band and direction, band by band; NaN where missing.
    pub values: Vec<f64>,
    /// Standard deviations of the values, in the same order and unit; NaN where missing. `None`: the file has none.
    pub sd: Option<Vec<f64>>,
}

impl Measurement {
    /// BRDF in sr⁻¹, band by band, NaN where missing (Eq. 1; BRF/π).
    pub fn brdf(&self) -> Vec<f64> {
        self.in_sr(&self.values)
    }

    /// Standard deviations of the BRDF in sr⁻¹, where the file has them.
    pub fn brdf_sd(&self) -> Option<Vec<f64>> {
        self.sd.as_ref().map(|sd| self.in_sr(sd))
    }

    fn in_sr(&self, values: &[f64]) -> Vec<f64> {
        match self.quantity {
            Quantity::Brdf => values.to_vec(),
            Quantity::Brf => values.iter().map(|value| value / PI).collect(),
        }
    }

    /// The values of one band, one a direction, in the quantity of the file; empty where there is no such band.
    pub fn band(&self, band: usize) -> &[f64] {
        let width = self.directions.len();
        self.values.get(band * width..(band + 1) * width).unwrap_or(&[])
    }

    /// How many values there are, are missing, are negative.
    pub fn counts(&self) -> Counts {
        let missing = self.values.iter().filter(|value| value.is_nan()).count();
        let negative = self.values.iter().filter(|value| **value < 0.0).count();
        Counts { usable: self.values.len() - missing, missing, negative }
    }

    /// The same measurement in another quantity.
    ///
    /// One multiplication by, or division by, the double nearest to π: one rounding. Where a number of at most 12
    /// significant digits stands within that rounding, and leads back to the number it came from, it is taken, so
    /// that a file converted there and back says what it said before.
    #[must_use]
    pub fn into_quantity(mut self, quantity: Quantity) -> Self {
        if quantity != self.quantity {
            let convert = |value: &mut f64| *value = converted(*value, quantity);
            self.values.iter_mut().for_each(convert);
            self.sd.iter_mut().flatten().for_each(convert);
            self.quantity = quantity;
        }
        self
    }

    /// A sentence for the user where the brightest direction lies on the illumination side, as in a file whose azimuth
    /// convention is not the one it was read with.
    ///
    /// For every source direction away from the normal (θ_s ≥ 20°), the brightest direction (mean over the bands) with
    /// cos φ_v > 0.5 is compared with the brightest with cos φ_v < −0.5. The specular peak lies on the forward side, so
    /// the warning is given when the backward one is more than 1.5 times as bright, in every such source direction.
    pub fn azimuth_warning(&self) -> Option<String> {
        let means = self.means();
        let mut sources: Vec<f64> =
            self.directions.iter().map(|d| d.theta_s_deg).filter(|theta| *theta >= 20.0).collect();
        sources.sort_by(f64::total_cmp);
        sources.dedup();
        let brightest = |source: f64, side: f64| {
            let on_side = |d: &Direction| d.theta_s_deg == source && side * d.phi_v_deg.to_radians().cos() > 0.5;
            let oblique = |d: &Direction| d.theta_v_deg > 0.0;
            let of_side = self.directions.iter().zip(&means).filter(|(d, _)| on_side(d) && oblique(d));
            of_side.map(|(_, mean)| *mean).filter(|mean| mean.is_finite()).max_by(f64::total_cmp)
        };
        let mut ratios = sources.iter().filter_map(|&source| match (brightest(source, 1.0), brightest(source, -1.0)) {
            (Some(back), Some(forward)) if forward > 0.0 => Some(back / forward),
            _ => None,
        });
        let first = ratios.next()?;
        let least = ratios.fold(first, f64::min);
        (least > 1.5).then(|| {
            format!(
                "{}: brightest on the illumination side ({least:.1} times the forward side). Read as {}; \
                 if the file has the other convention, say so with --azimuth {}",
                self.name,
                self.azimuth.name(),
                self.azimuth.other().name()
            )
        })
    }

    /// What looks wrong with the file as a whole: its azimuth convention, the scale of its values.
    pub fn warnings(&self) -> Vec<String> {
        self.scale_warning().into_iter().chain(self.azimuth_warning()).collect()
    }

    /// A sentence where the values are too large for a reflectance: per cent, counts, or numbers scaled to integers.
    ///
    /// A white leaf that scatters evenly has BRF 1, and a lobe exceeds that in the few directions that see it: the warning is given
    /// where half of all values lie above a BRF of 1.5.
    pub fn scale_warning(&self) -> Option<String> {
        let mut brdf: Vec<f64> = self.brdf().into_iter().filter(|value| !value.is_nan()).collect();
        brdf.sort_by(f64::total_cmp);
        let middle = PI * brdf.get(brdf.len() / 2)?;
        (middle > 1.5).then(|| {
            format!(
                "half of the values lie above a BRF of {middle:.3}, and a white surface has 1: are they per cent, or scaled? \
                 BRF is expected as a fraction, BRDF in sr^-1"
            )
        })
    }

    /// Mean over the bands of the values of each direction; NaN where there is none.
    fn means(&self) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.directions.len()];
        for row in self.values.chunks_exact(self.directions.len().max(1)) {
            for (sum, value) in sums.iter_mut().zip(row).filter(|(_, value)| !value.is_nan()) {
                *sum = (sum.0 + value, sum.1 + 1.0);
            }
        }
        sums.iter().map(|(sum, count)| sum / count).collect()
    }
}

/// A BRDF as a BRF, or a BRF as a BRDF; see [`Measurement::into_quantity`].
fn converted(value: f64, to: Quantity) -> f64 {
    let brf = |brdf: f64| brdf * PI;
    let brdf = |brf: f64| brf / PI;
    let (plain, back) = match to {
        Quantity::Brf => (brf(value), brdf as fn(f64) -> f64),
        Quantity::Brdf => (brdf(value), brf as fn(f64) -> f64),
    };
    if !plain.is_finite() {
        return plain;
    }
    match format!("{plain:.11e}").parse() {
        Ok(short) if back(short) == value => short,
        _ => plain,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_number_survives_the_way_to_the_other_quantity_and_back() {
        for thousandth in -2000..=2000 {
            let value = f64::from(thousandth) / 1000.0;
            for (to, from) in [(Quantity::Brf, Quantity::Brdf), (Quantity::Brdf, Quantity::Brf)] {
                assert_eq!(converted(converted(value, to), from), value);
            }
        }
    }

    #[test]
    fn a_brf_is_pi_times_the_brdf() {
        // Both roundings are at most half a unit in the last place; the short neighbour at most another one.
        for value in [0.1, 1.0 / 3.0, 1e-7, 0.3, 2.25, 1e5 / 7.0] {
            assert!((converted(value, Quantity::Brf) / (value * PI) - 1.0).abs() < 4e-16);
            assert!((converted(value, Quantity::Brdf) * PI / value - 1.0).abs() < 6e-16);
        }
        assert!(converted(f64::NAN, Quantity::Brf).is_nan());
    }

    #[test]
    fn the_same_direction_has_the_same_key() {
        let key = |phi_v_deg| Direction { theta_s_deg: 30.0, theta_v_deg: 0.0, phi_v_deg }.key();
        assert_eq!(key(-30.0), key(330.0));
        assert_eq!(key(360.0), key(0.0));
        assert_eq!(key(-360.0), key(-0.0));
        assert_ne!(key(30.0), key(-30.0), "mirror images are two directions");
    }
}
