//! `--model surface`: one n and σ for the leaf (with options: a tilt, the diffuse term's a and b), k_L at each wavelength, and the
//! hemispherical budget that follows.

mod summary;

use std::io;
use std::path::Path;

use leafbrdf_core::{Angle, Diffuse, DomainError, Grade, Illumination, P2, Surface};
use leafbrdf_fit::surface::model::{DIFFUSE_A, DIFFUSE_B, DIFFUSE_E, N, SIGMA, TILT_IN_PLANE, TILT_LATERAL};
use leafbrdf_fit::surface::{DiffuseKind, FacetKind, Knowledge, SurfaceData, SurfaceFit, SurfaceOptions, Treatment};
use leafbrdf_fit::{AtBound, Interval};

use super::tables::{self, Band, Budget, OneSurface, write_bands, write_budgets};
use super::{FitFailure, LeafValues, Selected};
use crate::measurement::Measurement;

/// One leaf's surface, fitted.
#[derive(Clone, Debug)]
pub struct SurfaceOutcome {
    /// What was fitted.
    pub selected: Selected,
    /// The result.
    pub fit: SurfaceFit,
    /// How.
    pub options: SurfaceOptions,
    /// What the user should know before using the numbers.
    pub warnings: Vec<String>,
    /// Between which k_L counts as plausible (Table 3); nothing is held there.
    k_l_bounds: Interval<f64>,
    /// DHRF_spec, its standard error, and the diffuse term's DHRF for k_L = 1, at every source angle.
    dhrf: Vec<Budget>,
}

/// Fits one surface to the selected data.
///
/// `k_l_bounds`: between which values k_L is plausible; k_L outside are counted and told, not held.
///
/// # Errors
/// What the solver refuses, in words.
pub fn fit_surface(
    leaf: &Measurement,
    selected: Selected,
    options: &SurfaceOptions,
    k_l_bounds: Interval<f64>,
) -> Result<SurfaceOutcome, FitFailure> {
    let data = SurfaceData { directions: &selected.vectors, brdf: &selected.brdf, sd: selected.sd.as_deref() };
    let fit = leafbrdf_fit::surface::fit_surface(&data, options)?;
    exact(&selected, &fit)?;
    let sources = selected.sources_deg();
    let dhrf = sources.into_iter().map(|theta| dhrf(&fit, options, theta)).collect::<Result<_, _>>();
    let dhrf = dhrf.map_err(|error: DomainError| FitFailure(error.to_string()))?;
    let mut outcome =
        SurfaceOutcome { selected, fit, options: options.clone(), warnings: Vec::new(), k_l_bounds, dhrf };
    outcome.warnings = outcome.warn(leaf);
    Ok(outcome)
}

/// Refuses a surface that any measurement in these directions would have fitted.
fn exact(selected: &Selected, fit: &SurfaceFit) -> Result<(), FitFailure> {
    if !fit.errors.knowledge.contains(&Knowledge::NoDegreesOfFreedom) {
        return Ok(());
    }
    let width = selected.vectors.len();
    let seen = |v: &usize| selected.brdf.iter().skip(*v).step_by(width).any(|y| !y.is_nan());
    let directions = (0..width).filter(seen).count();
    let sought: Vec<usize> = (0..PARAMETERS.len()).filter(|&i| is_open(fit, i) && !fit.unseen[i]).collect();
    // a prior is a value too
    let count: f64 = sought.iter().map(|&i| 1.0 - fit.errors.prior_share[i]).sum();
    let names: Vec<&str> = ["k_l"].into_iter().chain(sought.iter().map(|&i| PARAMETERS[i].0)).collect();
    let values = format!("{directions} directions");
    Err(FitFailure::exact(
        &values,
        1.0 + count,
        &names,
        "Measure more directions, or hold parameters, as with --hold n=1.5",
    ))
}

/// DHRF_spec of the leaf's own surface at θ_s from the leaf's normal: a tilt in the holder has no part in it.
fn dhrf(fit: &SurfaceFit, options: &SurfaceOptions, theta_s_deg: f64) -> Result<Budget, DomainError> {
    let angle = Angle::from_degrees(theta_s_deg);
    let source = Illumination::new(angle)?;
    let [n, sigma, a, b, _, _, e] = fit.x;
    let gradient = match options.facets {
        FacetKind::Beckmann => {
            Surface::new(n, sigma)?.with_normalization(options.normalization).dhrf_with_gradient(&source, Grade::E10)
        }
        FacetKind::Ggx => {
            Surface::ggx(n, sigma)?.with_normalization(options.normalization).dhrf_with_gradient(&source, Grade::E10)
        }
    };
    let diffuse = match options.diffuse {
        DiffuseKind::Lambert => 1.0,
        // P1 is P2 with e = 0
        DiffuseKind::P1 | DiffuseKind::P2 => P2::new(a, b, e)?.hemispherical(angle.cos()),
    };
    // first-order propagation; a parameter held, or at its bound, adds nothing, one without an error leaves none to give
    let errors = &fit.errors;
    let unknown = [N, SIGMA].iter().any(|&i| errors.standard_errors[i].is_none() && is_open(fit, i));
    let c = &errors.covariance;
    let specular_se =
        if unknown { f64::NAN } else { Budget::specular_se(&gradient, [c[N][N], c[N][SIGMA], c[SIGMA][SIGMA]]) };
    Ok(Budget { theta_s_deg, specular: gradient.value, specular_se, diffuse })
}

/// Is a parameter sought, and not at a bound?
fn is_open(fit: &SurfaceFit, i: usize) -> bool {
    fit.parameters[i].is_free() && fit.at_bound[i] == AtBound::Free
}

/// Names of n, σ, a, b, t_x, t_y, e in files, and by what to multiply them there: angles are in degrees.
const PARAMETERS: [(&str, f64); 7] = [
    ("n", 1.0),
    ("sigma", 1.0),
    ("p1_a", 1.0),
    ("p1_b", 1.0),
    ("tilt_in_plane_deg", 180.0 / core::f64::consts::PI),
    ("tilt_lateral_deg", 180.0 / core::f64::consts::PI),
    ("p2_e", 1.0),
];

impl SurfaceOutcome {
    /// Has the model this parameter: n and σ always, a and b of P1 and P2, e of P2, a tilt that was asked for or held elsewhere than at 0?
    fn has(&self, i: usize) -> bool {
        match i {
            N | SIGMA => true,
            DIFFUSE_A | DIFFUSE_B => self.options.diffuse != DiffuseKind::Lambert,
            DIFFUSE_E => self.options.diffuse == DiffuseKind::P2,
            _ => self.options.parameters[i] != Treatment::Held(0.0),
        }
    }

    /// Its value in the unit of files; `None` where the model has no such parameter, or cannot see it.
    fn value(&self, i: usize) -> Option<f64> {
        (self.has(i) && !self.fit.unseen[i]).then(|| self.fit.x[i] * PARAMETERS[i].1)
    }

    fn standard_error(&self, i: usize) -> Option<f64> {
        self.fit.errors.standard_errors[i].map(|error| error * PARAMETERS[i].1)
    }

    /// Wavelengths that have any value.
    fn fitted(&self) -> usize {
        self.fit.bands.iter().filter(|band| band.k_lambert.is_some()).count()
    }

    /// The leaf's row of `leaves.csv`.
    pub fn values(&self) -> LeafValues {
        LeafValues {
            normalization: Some(self.options.normalization.name().to_string()),
            n: self.value(N),
            sigma: self.value(SIGMA),
            tilt_deg: [self.value(TILT_IN_PLANE), self.value(TILT_LATERAL)],
            surface_se: [N, SIGMA, TILT_IN_PLANE, TILT_LATERAL].map(|i| self.standard_error(i)),
            p1: [self.value(DIFFUSE_A), self.value(DIFFUSE_B)],
            p1_se: [self.standard_error(DIFFUSE_A), self.standard_error(DIFFUSE_B)],
            p2_e: [self.value(DIFFUSE_E), self.standard_error(DIFFUSE_E)],
            kinds: Some([self.options.facets.name(), self.options.diffuse.name()]),
            rmse: self.fit.rmse,
            r2: self.fit.r2,
            bands: self.fitted(),
            warnings: self.warnings.clone(),
            ..LeafValues::default()
        }
    }

    /// One line for people.
    pub fn line(&self) -> String {
        let numbers: Vec<String> = (0..PARAMETERS.len())
            .filter_map(|i| {
                let error = self.standard_error(i).map_or(String::new(), |error| format!(" ± {error:.1e}"));
                Some(format!("{} {:.4}{error}", PARAMETERS[i].0, self.value(i)?))
            })
            .collect();
        format!(
            "{} bands, {}, rmse {:.3e} sr^-1, R2 {:.4}",
            self.fitted(),
            numbers.join(", "),
            self.fit.rmse,
            self.fit.r2
        )
    }

    /// `sigma=upper;n=lower`, or nothing.
    fn at_bound(&self) -> String {
        tables::at_bound(PARAMETERS.iter().map(|(name, _)| *name).zip(self.fit.at_bound))
    }

    /// Why standard errors are missing, parameter by parameter, or nothing.
    fn note(&self) -> String {
        let reasons = (0..PARAMETERS.len()).filter(|&i| self.has(i)).filter_map(|i| {
            let why = match self.fit.errors.knowledge[i] {
                Knowledge::Identified => return None,
                Knowledge::Held => "held",
                Knowledge::AtBound => "held at its bound",
                Knowledge::NotIdentifiable => "not identifiable from these directions",
                Knowledge::NoDegreesOfFreedom => "no more values than parameters",
            };
            Some(format!("{} {why}", PARAMETERS[i].0))
        });
        reasons.collect::<Vec<_>>().join("; ")
    }

    /// Writes `bands.csv` and `dhrf.csv` into a folder, each whole or not at all.
    ///
    /// # Errors
    /// The system's.
    pub fn write_tables(&self, folder: &Path) -> io::Result<()> {
        let leaf = OneSurface {
            at_bound: &self.at_bound(),
            shape: [DIFFUSE_A, DIFFUSE_B, DIFFUSE_E, TILT_IN_PLANE, TILT_LATERAL].map(|i| self.value(i)),
            facets: self.options.facets.name(),
            diffuse: self.options.diffuse.name(),
            normalization: self.options.normalization,
        };
        let note = self.note();
        let converged = if self.fit.termination.converged() { "converged" } else { "max_iterations" };
        let bands = || self.selected.wavelengths_nm.iter().zip(&self.fit.bands);
        let rows = bands().map(|(nm, band)| {
            let fitted = band.k_lambert.is_some();
            Band {
                wavelength_nm: *nm,
                k_l: band.k_lambert,
                surface: [N, SIGMA].map(|i| self.value(i).filter(|_| fitted)),
                rmse: fitted.then(|| (band.squares / band.n_obs as f64).sqrt()),
                n_obs: band.n_obs,
                status: if fitted { converged } else { "too_few_values" },
                k_l_se: band.k_lambert_se,
                surface_se: [N, SIGMA].map(|i| self.standard_error(i).filter(|_| fitted)),
                note: &note,
            }
        });
        write_bands(folder, &leaf, rows)?;

        let of_band = |k_l: Option<f64>, budget: &Budget| budget.with_k_lambert(k_l.unwrap_or(f64::NAN));
        let rows = bands().flat_map(|(nm, band)| self.dhrf.iter().map(|one| (*nm, of_band(band.k_lambert, one))));
        write_budgets(folder, self.options.normalization, rows)
    }
}
