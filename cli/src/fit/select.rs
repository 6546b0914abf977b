//! Which wavelengths and directions of a measurement take part in a fit, and what is left out and why.

use std::str::FromStr;

use leafbrdf_core::{Angle, DirectionVectors, Geometry};

use super::FitFailure;
use crate::measurement::{Direction, Measurement};

/// `FIRST:LAST[:STEP]` in nm, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WavelengthRange {
    /// First wavelength, nm.
    pub first: f64,
    /// Last wavelength, nm.
    pub last: f64,
    /// Distance from one wavelength to the next, nm; without it, every wavelength of the file in between.
    pub step: Option<f64>,
}

impl WavelengthRange {
    /// Does this wavelength take part? With a step, only multiples of it from the first on (to 10⁻⁶ of a step).
    pub fn contains(&self, wavelength_nm: f64) -> bool {
        let on_grid = |step: f64| {
            let steps = (wavelength_nm - self.first) / step;
            (steps - steps.round()).abs() < 1e-6
        };
        wavelength_nm >= self.first && wavelength_nm <= self.last && self.step.is_none_or(on_grid)
    }
}

impl FromStr for WavelengthRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong =
            || format!("expected FIRST:LAST or FIRST:LAST:STEP in nm, such as 480:879 or 400:2400:10, not {text}");
        let numbers: Vec<f64> =
            text.split(':').map(|part| part.trim().parse()).collect::<Result<_, _>>().map_err(|_| wrong())?;
        let (first, last, step) = match numbers[..] {
            [first, last] => (first, last, None),
            [first, last, step] => (first, last, Some(step)),
            _ => return Err(wrong()),
        };
        let finite = numbers.iter().all(|x| x.is_finite());
        if !finite || first > last || first <= 0.0 || step.is_some_and(|step| step <= 0.0) {
            return Err(wrong());
        }
        if last < 100.0 {
            return Err(format!("{text} looks like µm: wavelengths are in nm, such as 480:879"));
        }
        Ok(WavelengthRange { first, last, step })
    }
}

/// What the user asks to take part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    /// Wavelengths; all without it.
    pub wavelengths: Option<WavelengthRange>,
    /// The largest θ_v in degrees (§2.3: 70°, beyond which the paper's goniometer lost signal).
    pub max_theta_v_deg: f64,
    /// Standard deviations of the file are used as weights; without, every value counts the same.
    pub use_sd: bool,
}

impl Default for Selection {
    fn default() -> Self {
        Selection { wavelengths: None, max_theta_v_deg: 70.0, use_sd: true }
    }
}

/// The part of a measurement that is fitted, in sr⁻¹, and the count of the rest.
#[derive(Clone, Debug)]
pub struct Selected {
    /// Wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
    /// θ_s of each direction, degrees.
    pub theta_s_deg: Vec<f64>,
    /// One geometry a direction.
    pub geometries: Vec<Geometry<f64>>,
    /// The same directions in degrees.
    pub directions: Vec<Direction>,
    /// The same directions as vectors, for leaves that may be tilted.
    pub vectors: Vec<DirectionVectors<f64>>,
    /// BRDF in sr⁻¹, band by band; NaN where missing.
    pub brdf: Vec<f64>,
    /// Standard deviations in the same order, where the file has them and they are asked for.
    pub sd: Option<Vec<f64>>,
    /// Values that take part.
    pub used: usize,
    /// Values left out because they are missing in the file.
    pub missing: usize,
    /// Values left out because θ_v is above the limit.
    pub beyond_theta_v: usize,
    /// Values left out because their wavelength is not asked for.
    pub other_wavelengths: usize,
    /// Of the values that take part, those below zero.
    pub negative: usize,
    /// Directions left out because θ_v is above the limit.
    pub directions_left_out: usize,
}

impl Selected {
    /// Takes the asked part of a measurement.
    ///
    /// # Errors
    /// A sentence where no wavelength, no direction or no value is left, or a value that takes part has no positive sd.
    pub fn new(leaf: &Measurement, selection: &Selection) -> Result<Self, FitFailure> {
        let bands: Vec<usize> = (0..leaf.wavelengths_nm.len())
            .filter(|&band| selection.wavelengths.is_none_or(|range| range.contains(leaf.wavelengths_nm[band])))
            .collect();
        if bands.is_empty() {
            let (first, last) = (leaf.wavelengths_nm.first(), leaf.wavelengths_nm.last());
            return Err(FitFailure(format!(
                "no wavelength is left by --wavelengths: the file has {} to {} nm",
                first.map_or_else(String::new, f64::to_string),
                last.map_or_else(String::new, f64::to_string),
            )));
        }
        let kept: Vec<usize> = (0..leaf.directions.len())
            .filter(|&i| leaf.directions[i].theta_v_deg <= selection.max_theta_v_deg)
            .collect();
        if kept.is_empty() {
            return Err(FitFailure(format!(
                "no direction has theta_v ≤ {}°: raise --max-theta-v",
                selection.max_theta_v_deg
            )));
        }
        let deg = Angle::from_degrees;
        let geometries = kept
            .iter()
            .map(|&i| {
                let d = &leaf.directions[i];
                Geometry::from_angles(deg(d.theta_s_deg), deg(d.theta_v_deg), deg(d.phi_v_deg))
                    .map_err(|error| FitFailure(error.to_string()))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let vectors = kept
            .iter()
            .map(|&i| {
                let d = &leaf.directions[i];
                DirectionVectors::from_angles(deg(d.theta_s_deg), deg(d.theta_v_deg), deg(d.phi_v_deg))
                    .map_err(|error| FitFailure(error.to_string()))
            })
            .collect::<Result<Vec<_>, _>>()?;

        let width = leaf.directions.len();
        let take = |all: &[f64]| -> Vec<f64> {
            bands.iter().flat_map(|&band| kept.iter().map(move |&i| all[band * width + i])).collect()
        };
        let brdf = take(&leaf.brdf());
        let sd = if selection.use_sd { leaf.brdf_sd().map(|sd| take(&sd)) } else { None };
        if let Some(sd) = &sd
            && let Some(place) = brdf.iter().zip(sd).position(|(y, sd)| !y.is_nan() && !(*sd > 0.0))
        {
            let (band, direction) = (bands[place / kept.len()], &leaf.directions[kept[place % kept.len()]]);
            return Err(FitFailure(format!(
                "the value at {} nm, theta_s {}°, theta_v {}°, phi_v {}° has no positive sd: complete the column sd, or leave \
                 it out with --ignore-sd",
                leaf.wavelengths_nm[band], direction.theta_s_deg, direction.theta_v_deg, direction.phi_v_deg
            )));
        }
        let missing = brdf.iter().filter(|y| y.is_nan()).count();
        let negative = brdf.iter().filter(|y| **y < 0.0).count();
        if missing == brdf.len() {
            return Err(FitFailure("no usable value is left: all that were asked for are missing".to_string()));
        }
        Ok(Selected {
            wavelengths_nm: bands.iter().map(|&band| leaf.wavelengths_nm[band]).collect(),
            theta_s_deg: kept.iter().map(|&i| leaf.directions[i].theta_s_deg).collect(),
            geometries,
            directions: kept.iter().map(|&i| leaf.directions[i]).collect(),
            vectors,
            used: brdf.len() - missing,
            missing,
            beyond_theta_v: bands.len() * (width - kept.len()),
            other_wavelengths: (leaf.wavelengths_nm.len() - bands.len()) * width,
            negative,
            directions_left_out: width - kept.len(),
            brdf,
            sd,
        })
    }

    /// The distinct source zenith angles, ascending, degrees.
    pub fn sources_deg(&self) -> Vec<f64> {
        let mut sources = self.theta_s_deg.clone();
        sources.sort_by(f64::total_cmp);
        sources.dedup();
        sources
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_a_range_take_part_and_steps_are_counted_from_the_first() {
        let range: WavelengthRange = "480:490:5".parse().unwrap();
        let taken: Vec<f64> = (478..=491).map(f64::from).filter(|nm| range.contains(*nm)).collect();
        assert_eq!(taken, [480.0, 485.0, 490.0]);
    }

    #[test]
    fn a_range_that_is_none_is_refused_with_an_example() {
        for text in ["480", "a:b", "900:400", "400:900:0", "400:900:1:2", "NaN:500"] {
            let error = text.parse::<WavelengthRange>().unwrap_err();
            assert!(error.contains("480:879"), "{error}");
        }
        assert!("0.48:0.88".parse::<WavelengthRange>().unwrap_err().contains("µm"));
    }
}
