//! Hemispherical quantities of a measurement: every wavelength, every θ_s.

use std::collections::HashMap;
use std::fmt;

use leafbrdf_core::{Angle, Geometry, Grade, Illumination, Surface};
use leafbrdf_fit::{AtBound, BandFit, LeafBandsOptions};
use rayon::prelude::*;

use super::{Hemisphere, Integral, IntegrationError, Peak, background};
use crate::fit::{FitFailure, Selected, Selection, WavelengthRange, fit_bands};
use crate::measurement::Measurement;

/// What is integrated, and how.
#[derive(Clone, Debug)]
pub struct HemisphereOptions {
    /// Wavelengths; all without it.
    pub wavelengths: Option<WavelengthRange>,
    /// This θ_s alone, degrees; all without it.
    pub theta_s_deg: Option<f64>,
    /// Views beyond this θ_v, degrees, are left out, and extrapolated.
    pub max_theta_v_deg: f64,
    /// Views count for their mirror images too; see [`Hemisphere::new`].
    pub mirrored: bool,
    /// Fit the bands (θ_v ≤ 70°), subtract the lobe, integrate what is left, and add the lobe's own integral.
    pub subtract: Option<LeafBandsOptions>,
}

impl Default for HemisphereOptions {
    /// All wavelengths, all views, mirrored, nothing subtracted.
    fn default() -> Self {
        HemisphereOptions {
            wavelengths: None,
            theta_s_deg: None,
            max_theta_v_deg: 90.0,
            mirrored: true,
            subtract: None,
        }
    }
}

/// A lobe that was subtracted before the integration, and its integral added behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubtractedLobe {
    /// Its refractive index.
    pub n: f64,
    /// Its roughness.
    pub sigma: f64,
    /// DHRF_spec(n, σ, θ_s).
    pub dhrf: f64,
    /// Standard error by those of n and σ; NaN where the fit gives none.
    pub se: f64,
}

/// One wavelength and θ_s.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredDhrf {
    /// Wavelength, nm.
    pub wavelength_nm: f64,
    /// θ_s, degrees.
    pub theta_s_deg: f64,
    /// Views that take part.
    pub directions: usize,
    /// Share of ∫ cosθ dΩ that they enclose.
    pub enclosed: f64,
    /// The integral: of the values, or of what the lobe leaves of them.
    pub integral: Integral,
    /// The lobe, where one was subtracted.
    pub lobe: Option<SubtractedLobe>,
    /// The specular peak of the values.
    pub peak: Option<Peak>,
}

impl MeasuredDhrf {
    /// DHRF, the lobe's included.
    pub fn dhrf(&self) -> f64 {
        self.integral.dhrf + self.lobe.map_or(0.0, |lobe| lobe.dhrf)
    }

    /// Error of the DHRF, the lobe's included where it is known.
    pub fn error(&self) -> f64 {
        let se = self.lobe.map(|lobe| lobe.se).filter(|se| !se.is_nan()).unwrap_or(0.0);
        self.integral.error().hypot(se)
    }

    /// Share of the DHRF that comes from beyond the outermost directions.
    pub fn extrapolated_share(&self) -> f64 {
        self.integral.extrapolated_share * self.integral.dhrf / self.dhrf()
    }
}

/// Why there is no value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NotMeasured {
    /// The directions do not allow it.
    Integration(IntegrationError),
    /// The lobe to subtract could not be fitted.
    NoLobe,
}

impl fmt::Display for NotMeasured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotMeasured::Integration(error) => error.fmt(f),
            NotMeasured::NoLobe => f.write_str("no lobe can be fitted: too few values with θ_v ≤ 70°"),
        }
    }
}

impl std::error::Error for NotMeasured {}

/// A row for every θ_s and wavelength: (θ_s in degrees, wavelength in nm, result), θ_s ascending.
pub type Rows = Vec<(f64, f64, Result<MeasuredDhrf, NotMeasured>)>;

/// The views of one θ_s.
struct Views {
    theta_s_deg: f64,
    source: Illumination<f64>,
    /// Their places among the measurement's directions.
    places: Vec<usize>,
    /// θ_v and φ_v, degrees.
    angles: Vec<[f64; 2]>,
    geometries: Vec<Geometry<f64>>,
    /// Their means over the bands.
    means: Vec<f64>,
}

/// DHRF and specular peak of a measurement, θ_s by θ_s.
///
/// Missing values are left out of their band's mesh. The result does not depend on the number of threads.
///
/// # Errors
/// No wavelength or no view is left, or the bands cannot be fitted, in words.
pub fn hemispheres(leaf: &Measurement, options: &HemisphereOptions) -> Result<Rows, FitFailure> {
    let selection =
        Selection { wavelengths: options.wavelengths, max_theta_v_deg: options.max_theta_v_deg, use_sd: false };
    // the same messages as for a fit where nothing is left
    Selected::new(leaf, &selection)?;
    let lobes = match &options.subtract {
        Some(bands) => {
            let selection = Selection { wavelengths: options.wavelengths, ..Selection::default() };
            Some(fit_bands(Selected::new(leaf, &selection)?, bands, &|_| ())?)
        }
        None => None,
    };
    let bands: Vec<usize> = (0..leaf.wavelengths_nm.len())
        .filter(|band| options.wavelengths.is_none_or(|range| range.contains(leaf.wavelengths_nm[*band])))
        .collect();
    let (brdf, sd) = (leaf.brdf(), leaf.brdf_sd());

    let mut rows = Rows::new();
    for views in views(leaf, options, &bands, &brdf)? {
        let meshes = meshes(leaf, &views, &bands, &brdf, options.mirrored);
        let of_theta_s = bands.par_iter().enumerate().map(|(place, band)| {
            let wavelength_nm = leaf.wavelengths_nm[*band];
            let row = brdf.get(band * leaf.directions.len()..).unwrap_or(&[]);
            let kept = kept(&views, row);
            let result = (|| {
                let hemisphere = match meshes.get(&kept) {
                    Some(Ok(hemisphere)) => hemisphere,
                    Some(Err(error)) => return Err(NotMeasured::Integration(*error)),
                    None => return Err(NotMeasured::NoLobe),
                };
                let take = |all: &[f64]| -> Vec<f64> { kept.iter().map(|i| all[views.places[*i]]).collect() };
                let values = take(row);
                let sd = sd.as_ref().map(|sd| take(&sd[band * leaf.directions.len()..]));
                let fit = lobes.as_ref().map(|outcome| (outcome, outcome.bands.get(place).and_then(Option::as_ref)));
                let (rest, lobe) = match fit {
                    None => (values.clone(), None),
                    Some((_, None)) => return Err(NotMeasured::NoLobe),
                    Some((outcome, Some(fit))) => {
                        let [_, n, sigma] = fit.parameters;
                        let surface = Surface::new(n, sigma).map_err(|_| NotMeasured::NoLobe)?;
                        let surface = surface.with_normalization(outcome.normalization);
                        let lobe = |i: &usize| surface.brdf(&views.geometries[*i]);
                        let rest = values.iter().zip(&kept).map(|(value, i)| value - lobe(i)).collect();
                        (rest, Some(subtracted(&surface, fit, &views.source)))
                    }
                };
                let angles: Vec<[f64; 2]> = kept.iter().map(|i| views.angles[*i]).collect();
                let means: Vec<f64> = kept.iter().map(|i| views.means[*i]).collect();
                let mut room = Vec::new();
                Ok(MeasuredDhrf {
                    wavelength_nm,
                    theta_s_deg: views.theta_s_deg,
                    directions: kept.len(),
                    enclosed: hemisphere.enclosed(),
                    integral: hemisphere.integrate(&rest, sd.as_deref()),
                    lobe,
                    peak: Peak::find(hemisphere, &angles, &values, &background(&means), &mut room),
                })
            })();
            (views.theta_s_deg, wavelength_nm, result)
        });
        rows.par_extend(of_theta_s);
    }
    Ok(rows)
}

/// The views of every θ_s, θ_s ascending.
fn views(
    leaf: &Measurement,
    options: &HemisphereOptions,
    bands: &[usize],
    brdf: &[f64],
) -> Result<Vec<Views>, FitFailure> {
    let asked = |theta: &f64| options.theta_s_deg.is_none_or(|only| only == *theta);
    let mut sources: Vec<f64> = leaf.directions.iter().map(|d| d.theta_s_deg).filter(asked).collect();
    sources.sort_by(f64::total_cmp);
    sources.dedup();
    let deg = Angle::from_degrees;
    let width = leaf.directions.len();
    let in_words = |error: leafbrdf_core::DomainError| FitFailure(error.to_string());
    let mut all = Vec::new();
    for theta_s_deg in sources {
        let here = |place: &usize| {
            let d = &leaf.directions[*place];
            d.theta_s_deg == theta_s_deg && d.theta_v_deg <= options.max_theta_v_deg
        };
        let places: Vec<usize> = (0..width).filter(here).collect();
        let mean = |place: &usize| {
            let values = bands.iter().map(|band| brdf[band * width + place]).filter(|value| !value.is_nan());
            let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
            sum / count
        };
        let views: Vec<_> = places.iter().map(|place| leaf.directions[*place]).collect();
        all.push(Views {
            theta_s_deg,
            source: Illumination::new(deg(theta_s_deg)).map_err(in_words)?,
            angles: views.iter().map(|d| [d.theta_v_deg, d.phi_v_deg]).collect(),
            geometries: views
                .iter()
                .map(|d| Geometry::from_angles(deg(d.theta_s_deg), deg(d.theta_v_deg), deg(d.phi_v_deg)))
                .collect::<Result<_, _>>()
                .map_err(in_words)?,
            means: places.iter().map(mean).collect(),
            places,
        });
    }
    Ok(all)
}

/// Which views have a value in a band whose values are `row`.
fn kept(views: &Views, row: &[f64]) -> Vec<usize> {
    (0..views.places.len()).filter(|i| row.get(views.places[*i]).is_some_and(|value| !value.is_nan())).collect()
}

/// A mesh for every set of views that some band has: one, where no value is missing.
fn meshes(
    leaf: &Measurement,
    views: &Views,
    bands: &[usize],
    brdf: &[f64],
    mirrored: bool,
) -> HashMap<Vec<usize>, Result<Hemisphere, IntegrationError>> {
    let width = leaf.directions.len();
    let mut sets: Vec<Vec<usize>> =
        bands.iter().map(|band| kept(views, brdf.get(band * width..).unwrap_or(&[]))).collect();
    sets.sort_unstable();
    sets.dedup();
    let mesh = |set: Vec<usize>| {
        let angles: Vec<[f64; 2]> = set.iter().map(|i| views.angles[*i]).collect();
        (set, Hemisphere::new(&angles, mirrored))
    };
    sets.into_par_iter().map(mesh).collect()
}

/// The lobe's integral; its error in first order, a parameter held at its bound adds nothing.
fn subtracted(surface: &Surface<f64>, fit: &BandFit<f64>, source: &Illumination<f64>) -> SubtractedLobe {
    let gradient = surface.dhrf_with_gradient(source, Grade::E8);
    let [_, n, sigma] = fit.parameters;
    let unknown = (1..3).any(|p| fit.standard_errors[p].is_none() && fit.at_bound[p] == AtBound::Free);
    let n_part = gradient.d_n * fit.standard_errors[1].unwrap_or(0.0);
    let sigma_part = gradient.d_sigma * fit.standard_errors[2].unwrap_or(0.0);
    let cross = 2.0 * fit.correlations[2].unwrap_or(0.0) * n_part * sigma_part;
    let se = (n_part * n_part + sigma_part * sigma_part + cross).max(0.0).sqrt();
    SubtractedLobe { n, sigma, dhrf: gradient.value, se: if unknown { f64::NAN } else { se } }
}
