//! From a table's wavelengths to a sensor's bands.
//!
//! Reflectance is what a sensor averages, not absorption: compute a spectrum (or a row of derivatives, which is as linear) at the
//! table's wavelengths, then weigh it with the band's response. Weights depend on wavelengths only and can be kept.

use leafbrdf_core::Real;

use crate::error::Error;
use crate::table::Wavelengths;

/// How a sensor's band answers to light of each wavelength; any positive factor is taken out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Response<'a, T> {
    /// Gaussian: exp(−4 ln 2 ((λ − centre)/fwhm)²), cut off at 2.5 × FWHM on each side, where it is 3e-8.
    Gaussian {
        /// Wavelength of the maximum, nm.
        centre: T,
        /// Full width at half maximum, nm, > 0.
        fwhm: T,
    },
    /// Measured: values ≥ 0 at rising wavelengths, straight lines between, nothing outside.
    Table {
        /// Wavelengths, nm, rising.
        wavelengths: &'a [T],
        /// Response at each, any unit, ≥ 0.
        values: &'a [T],
    },
}

impl<T: Real> Response<'_, T> {
    /// First and last wavelength that count, and the distance over which the response is nearly straight.
    fn support(&self) -> Result<(T, T, T), Error> {
        match *self {
            Response::Gaussian { centre, fwhm } => {
                if !(fwhm > T::ZERO && fwhm.is_finite() && centre.is_finite()) {
                    return Err(Error::Response);
                }
                let reach = T::lit(2.5) * fwhm;
                Ok((centre - reach, centre + reach, fwhm / T::lit(16.0)))
            }
            Response::Table { wavelengths, values } => {
                if wavelengths.len() != values.len() {
                    return Err(Error::Length { slice: "response", expected: wavelengths.len(), found: values.len() });
                }
                let positive = values.iter().any(|&value| value > T::ZERO);
                let allowed = values.iter().all(|&value| value >= T::ZERO && value.is_finite());
                let rising = wavelengths.windows(2).position(|pair| !matches!(pair, [a, b] if a < b));
                if let Some(position) = rising {
                    return Err(Error::WavelengthOrder { position: position + 1 });
                }
                match (wavelengths.first(), wavelengths.last()) {
                    (Some(&first), Some(&last)) if positive && allowed && wavelengths.len() > 1 => {
                        let narrowest = wavelengths
                            .windows(2)
                            .filter_map(|pair| if let [a, b] = pair { Some(*b - *a) } else { None })
                            .fold(last - first, T::min);
                        Ok((first, last, narrowest / T::lit(4.0)))
                    }
                    _ => Err(Error::Response),
                }
            }
        }
    }

    fn at(&self, wavelength: T) -> T {
        match *self {
            Response::Gaussian { centre, fwhm } => {
                let distance = (wavelength - centre) / fwhm;
                (T::lit(-4.0 * core::f64::consts::LN_2) * distance.squared()).exp()
            }
            Response::Table { wavelengths, values } => match Wavelengths::Listed(wavelengths).locate(wavelength) {
                Ok((below, beyond)) => crate::table::between(values, below, beyond),
                Err(_) => T::ZERO,
            },
        }
    }
}

/// Most parts that one step of the table is divided into for a narrow response.
const MOST_PARTS: usize = 256;

/// Weights of a table's wavelengths in one sensor band, summing to 1: the band's value is Σ weight · spectrum.
///
/// The spectrum is taken as straight between wavelengths, and its product with the response integrated in steps no longer than
/// 1/16 of the FWHM (1/4 of a response table's finest step), so that a band narrower than the table's step interpolates.
///
/// - `wavelengths`: those of the table.
/// - `weights`: room for one number a wavelength, overwritten.
///
/// # Errors
///
/// [`Error::Wavelength`] where the response reaches beyond the table: the band's value would be a guess.
/// [`Error::Response`], [`Error::WavelengthOrder`] for an impossible response; [`Error::Length`].
///
/// # Example
///
/// ```
/// use leafbrdf_prospect::{Version, sensor, table};
/// let wavelengths = table::full(Version::D).wavelengths();
/// let mut weights = [0.0; table::BANDS];
/// // Sentinel-2's red edge: a band 15 nm wide around 705 nm
/// sensor::weights(&sensor::Response::Gaussian { centre: 705.0, fwhm: 15.0 }, wavelengths, &mut weights)?;
/// // a spectrum that is straight has its value at the centre
/// let straight = wavelengths.iter().zip(weights).map(|(w, weight)| w * weight).sum::<f64>();
/// assert!((straight - 705.0).abs() < 1e-9);
/// # Ok::<(), leafbrdf_prospect::Error>(())
/// ```
pub fn weights<T: Real>(
    response: &Response<'_, T>,
    wavelengths: Wavelengths<'_, T>,
    weights: &mut [T],
) -> Result<(), Error> {
    if weights.len() != wavelengths.len() {
        return Err(Error::Length { slice: "weights", expected: wavelengths.len(), found: weights.len() });
    }
    let (first, last, step) = response.support()?;
    let (band, _) = wavelengths.locate(first)?;
    wavelengths.locate(last)?;
    weights.fill(T::ZERO);
    let mut total = T::ZERO;
    for at in band.. {
        let (Some(below), Some(above)) = (wavelengths.get(at), wavelengths.get(at + 1)) else { break };
        if below > last {
            break;
        }
        // the part of this step that the response covers, halved until it is fine enough
        let (from, to) = (below.max(first), above.min(last));
        let (width, mut parts) = (to - from, 1_usize);
        while parts < MOST_PARTS && width > step * T::lit(parts as f64) {
            parts *= 2;
        }
        let part = width / T::lit(parts as f64);
        for index in 0..=parts {
            let wavelength = from + part * T::lit(index as f64);
            let end = index == 0 || index == parts;
            let share = response.at(wavelength) * part * if end { T::HALF } else { T::ONE };
            let beyond = (wavelength - below) / (above - below);
            if let Some([lower, upper]) = weights.get_mut(at..at + 2) {
                *lower += share * (T::ONE - beyond);
                *upper += share * beyond;
            }
            total += share;
        }
    }
    if !(total > T::ZERO) {
        return Err(Error::Response);
    }
    for weight in weights.iter_mut() {
        *weight = *weight / total;
    }
    Ok(())
}

/// A spectrum, or a row of derivatives, seen by a sensor band: Σ weight · spectrum, in the spectrum's unit.
///
/// # Errors
///
/// [`Error::Length`] for slices of different length.
pub fn weighted<T: Real>(spectrum: &[T], weights: &[T]) -> Result<T, Error> {
    if spectrum.len() != weights.len() {
        return Err(Error::Length { slice: "spectrum", expected: weights.len(), found: spectrum.len() });
    }
    let mut sum = T::ZERO;
    for (&value, &weight) in spectrum.iter().zip(weights) {
        sum += value * weight;
    }
    Ok(sum)
}
