//! `--model bands`: k_L, n, σ at each wavelength (§4.2), and the hemispherical budget that follows (§4.4).

use std::io;
use std::path::Path;

use leafbrdf_core::{Angle, Grade, Illumination, Normalization, Surface};
use leafbrdf_fit::{AtBound, BandFit, BandResult, Identifiability, LeafBandsOptions, LeafData, why_no_error};
use rayon::prelude::*;

use super::tables::{self, BAND_COLUMNS, Budget, write_budgets};
use super::{FitFailure, Selected};
use crate::output::{Cell, Format, TableWriter};

/// The bands of one leaf, fitted.
#[derive(Clone, Debug)]
pub struct BandsOutcome {
    /// What was fitted.
    pub selected: Selected,
    /// One result a wavelength.
    pub bands: Vec<BandResult>,
    /// The convention for K.
    pub normalization: Normalization,
    /// DHRF of each wavelength and source angle, wavelength by wavelength.
    dhrf: Vec<Budget>,
}

/// Fits every band of the selected data, and integrates each result over the hemisphere for every θ_s of the data.
///
/// # Errors
/// What the solver refuses, in words.
pub fn fit_bands(
    selected: Selected,
    options: &LeafBandsOptions,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<BandsOutcome, FitFailure> {
    let data = LeafData { geometries: &selected.geometries, brdf: &selected.brdf, sd: selected.sd.as_deref() };
    let bands = leafbrdf_fit::fit_bands(&data, options, progress)?;
    if bands.iter().all(Option::is_none) {
        let why = "no wavelength has the 3 values that k_l, n and sigma take at least. Measure more directions, or hold parameters with \
                   --model surface, as with --hold n=1.5";
        return Err(FitFailure(why.to_string()));
    }
    let exact = |fit: &BandFit<f64>| fit.identifiability.contains(&Identifiability::NoDegreesOfFreedom);
    let mut fits = bands.iter().flatten().peekable();
    if fits.peek().is_some() && fits.all(exact) {
        // a band that is met exactly is told among others; alone it is no result
        let most = bands.iter().flatten().map(|fit| fit.n_obs).max().unwrap_or(0);
        let free = |fit: &BandFit<f64>, p: usize| fit.at_bound[p] == AtBound::Free;
        let sought = |p: &usize| bands.iter().flatten().any(|fit| free(fit, *p));
        let names: Vec<&str> = (0..3).filter(sought).map(|p| PARAMETERS[p]).collect();
        let values = format!("{most} values in the fullest of {} bands", bands.len());
        let remedy = "Measure more directions, or hold parameters with --model surface, as with --hold n=1.5";
        return Err(FitFailure::exact(&values, names.len() as f64, &names, remedy));
    }

    let sources = selected
        .sources_deg()
        .into_iter()
        .map(|theta| Ok((theta, Illumination::new(Angle::from_degrees(theta))?)))
        .collect::<Result<Vec<_>, leafbrdf_core::DomainError>>()
        .map_err(|error| FitFailure(error.to_string()))?;
    let dhrf = bands
        .par_iter()
        .flat_map_iter(|band| sources.iter().map(|(theta, source)| dhrf(band, *theta, source, options.normalization)))
        .collect();
    Ok(BandsOutcome { selected, bands, normalization: options.normalization, dhrf })
}

fn dhrf(band: &BandResult, theta_s_deg: f64, source: &Illumination<f64>, normalization: Normalization) -> Budget {
    let nothing = Budget { theta_s_deg, diffuse: f64::NAN, specular: f64::NAN, specular_se: f64::NAN };
    let Some(fit) = band else { return nothing };
    let [k_l, n, sigma] = fit.parameters;
    let Ok(surface) = Surface::new(n, sigma) else { return nothing };
    let gradient = surface.with_normalization(normalization).dhrf_with_gradient(source, Grade::E10);
    // first-order propagation; a parameter held at its bound adds nothing, one without an error leaves none to give
    let unknown = (1..3).any(|p| fit.standard_errors[p].is_none() && fit.at_bound[p] == AtBound::Free);
    let n_part = gradient.d_n * fit.standard_errors[1].unwrap_or(0.0);
    let sigma_part = gradient.d_sigma * fit.standard_errors[2].unwrap_or(0.0);
    let cross = 2.0 * fit.correlations[2].unwrap_or(0.0) * n_part * sigma_part;
    let error = (n_part * n_part + sigma_part * sigma_part + cross).max(0.0).sqrt();
    let specular_se = if unknown { f64::NAN } else { error };
    Budget { theta_s_deg, diffuse: k_l, specular: gradient.value, specular_se }
}

/// Names of k_L, n, σ in files.
pub(super) const PARAMETERS: [&str; 3] = ["k_l", "n", "sigma"];

/// One word on how the fit of a band ended.
pub(super) fn status(band: &BandResult) -> &'static str {
    match band {
        None => "too_few_values",
        Some(fit) if fit.termination.converged() => "converged",
        Some(_) => "max_iterations",
    }
}

/// Why standard errors are missing, parameter by parameter, or nothing.
fn note(fit: &BandFit<f64>) -> String {
    let reasons =
        PARAMETERS.iter().enumerate().filter_map(|(p, name)| Some(format!("{name} {}", why_no_error(fit, p)?)));
    reasons.collect::<Vec<_>>().join("; ")
}

/// Writes `bands.csv` and `dhrf.csv` into a folder, each whole or not at all.
///
/// # Errors
/// The system's.
pub fn write_bands(folder: &Path, outcome: &BandsOutcome) -> io::Result<()> {
    let others = [
        "corr_k_l_n",
        "corr_k_l_sigma",
        "corr_n_sigma",
        "chi2",
        "iterations",
        "starts",
        "second_chi2",
        "second_k_l",
        "second_n",
        "second_sigma",
        "note",
        "normalization",
    ];
    let columns = [&BAND_COLUMNS[..], &others].concat();
    let mut table = TableWriter::create(Some(&folder.join("bands.csv")), Some(Format::Csv), &columns)?;
    let convention = Cell::Text(outcome.normalization.name());
    for (place, (wavelength, band)) in outcome.selected.wavelengths_nm.iter().zip(&outcome.bands).enumerate() {
        let mut row = vec![Cell::Number(*wavelength)];
        let (at_bound, note);
        match band {
            None => {
                row.extend([Cell::Empty; 4]);
                row.extend([Cell::Empty, Cell::Text(status(band)), Cell::Empty]);
                row.extend([Cell::Empty; 13]);
                row.push(Cell::Text("fewer than 3 values: nothing can be fitted"));
            }
            Some(fit) => {
                at_bound = tables::at_bound(PARAMETERS.into_iter().zip(fit.at_bound));
                note = self::note(fit);
                row.extend(fit.parameters.map(Cell::Number));
                row.extend([
                    Cell::Number((outcome.squares(place) / fit.n_obs as f64).sqrt()),
                    Cell::Count(fit.n_obs as u64),
                ]);
                row.extend([Cell::Text(status(band)), Cell::Text(&at_bound)]);
                row.extend(fit.standard_errors.map(Cell::or_empty));
                row.extend(fit.correlations.map(Cell::or_empty));
                row.extend([
                    Cell::Number(fit.chi2),
                    Cell::Count(fit.iterations.into()),
                    Cell::Count(fit.starts.into()),
                ]);
                row.push(Cell::or_empty(fit.second.map(|second| second.chi2)));
                row.extend((0..3).map(|p| Cell::or_empty(fit.second.map(|second| second.parameters[p]))));
                row.push(Cell::Text(&note));
            }
        }
        row.push(convention);
        table.row(&row)?;
    }
    table.finish()?;

    let sources = outcome.dhrf.len() / outcome.bands.len().max(1);
    let rows = outcome.selected.wavelengths_nm.iter().zip(outcome.dhrf.chunks(sources.max(1)));
    let rows = rows.flat_map(|(nm, budgets)| budgets.iter().map(|budget| (*nm, *budget)));
    write_budgets(folder, outcome.normalization, rows)
}

impl BandsOutcome {
    /// Σ (BRDF_measured − BRDF_modelled)² of one band, in sr⁻², whatever the weights were.
    pub(super) fn squares(&self, band: usize) -> f64 {
        let Some(Some(fit)) = self.bands.get(band) else { return f64::NAN };
        if self.selected.sd.is_none() {
            return fit.chi2;
        }
        let [k_l, n, sigma] = fit.parameters;
        let Ok(surface) = Surface::new(n, sigma) else { return f64::NAN };
        let surface = surface.with_normalization(self.normalization);
        let width = self.selected.geometries.len();
        let values = self.selected.brdf.iter().skip(band * width).take(width);
        let residuals = values.zip(&self.selected.geometries).filter(|(y, _)| !y.is_nan());
        residuals.map(|(y, g)| (y - k_l / std::f64::consts::PI - surface.brdf(g)).powi(2)).sum()
    }
}
