//! `--model leaf`: the surface and the interior of a whole leaf from its directional reflectance.

mod summary;

use std::io;
use std::path::Path;

use leafbrdf_core::{Angle, Diffuse, DomainError, Grade, Illumination, P2};
use leafbrdf_fit::AtBound;
use leafbrdf_fit::leaf::parameters::{GAIN, NAMES, OFFSET, interior, place};
use leafbrdf_fit::leaf::{DirectionalData, Interior, Knowledge, LeafFit, LeafOptions, Method, Treatment, dhrf, fit};
use leafbrdf_fit::surface::DiffuseKind;
use leafbrdf_fit::surface::model::{
    DIFFUSE_A, DIFFUSE_B, DIFFUSE_E, N, PARAMETERS, SIGMA, TILT_IN_PLANE, TILT_LATERAL,
};
use leafbrdf_prospect::{Coupling, Parameter, Version, table};

use super::tables::{self, Band, Budget, OneSurface, write_bands, write_budgets};
use super::{FitFailure, LeafValues, Selected};
use crate::measurement::Measurement;

/// One leaf, inverted.
#[derive(Clone, Debug)]
pub struct LeafOutcome {
    /// What was fitted.
    pub selected: Selected,
    /// The result.
    pub fit: LeafFit,
    /// How.
    pub options: LeafOptions,
    /// What the user should know before using the numbers.
    pub warnings: Vec<String>,
    /// DHRF_spec, its standard error, and the diffuse term's DHRF for k_L = 1, at every source angle.
    dhrf: Vec<Budget>,
}

/// Inverts the selected data.
///
/// # Errors
/// What the solver refuses, in words.
pub fn fit_leaf(leaf: &Measurement, selected: Selected, options: &LeafOptions) -> Result<LeafOutcome, FitFailure> {
    let data = DirectionalData {
        wavelengths_nm: &selected.wavelengths_nm,
        directions: &selected.vectors,
        brdf: &selected.brdf,
        sd: selected.sd.as_deref(),
    };
    let fit = fit(&data, options).map_err(|error| FitFailure(error.to_string()))?;
    let sought: Vec<&str> =
        (0..NAMES.len()).filter(|&i| fit.knowledge[i] == Knowledge::NoDegreesOfFreedom).map(|i| NAMES[i]).collect();
    if !sought.is_empty() {
        let values = match fit.n_effective {
            all if all == fit.n_obs as f64 => format!("{all} values"),
            fewer => format!("{} values, worth {fewer:.1} independent ones,", fit.n_obs),
        };
        let remedy = "Measure more directions or wavelengths, or hold parameters with --fix or --hold";
        return Err(FitFailure::exact(&values, sought.len() as f64, &sought, remedy));
    }
    let mut outcome = LeafOutcome { selected, fit, options: options.clone(), warnings: Vec::new(), dhrf: Vec::new() };
    let sources = outcome.selected.sources_deg();
    let budget = sources.into_iter().map(|theta| outcome.budget(theta)).collect::<Result<_, DomainError>>();
    outcome.dhrf = budget.map_err(|error| FitFailure(error.to_string()))?;
    outcome.warnings = outcome.warn(leaf);
    Ok(outcome)
}

/// By what to multiply a parameter in files: angles are in degrees there.
fn unit(i: usize) -> f64 {
    if i == TILT_IN_PLANE || i == TILT_LATERAL { 1.0_f64.to_degrees() } else { 1.0 }
}

impl LeafOutcome {
    /// The coupling that k_L was made by.
    fn coupling(&self) -> Coupling {
        if self.fit.method == Method::Recommended { Coupling::GainOffset } else { self.options.coupling }
    }

    /// The inside of the leaf.
    fn interior(&self) -> Interior {
        self.fit.recipe.as_ref().map_or(self.options.interior, |report| report.interior)
    }

    /// Has the model this parameter at all?
    fn has(&self, i: usize) -> bool {
        match i {
            N | SIGMA => self.fit.has_surface,
            DIFFUSE_A | DIFFUSE_B => self.fit.has_surface && self.options.surface.diffuse != DiffuseKind::Lambert,
            DIFFUSE_E => self.fit.has_surface && self.options.surface.diffuse == DiffuseKind::P2,
            _ if i < PARAMETERS => self.fit.has_surface && self.fit.treatments[i] != Treatment::Held(0.0),
            GAIN => self.coupling() == Coupling::GainOffset,
            OFFSET => matches!(self.coupling(), Coupling::GainOffset | Coupling::Offset),
            _ => match interior(i) {
                Some(Parameter::NStruct) => true,
                Some(Parameter::Cm) if self.fit.version == Version::Pro => true,
                Some(parameter) => self.fit.version.constituents().contains(&parameter),
                None => false,
            },
        }
    }

    /// Has the user given this parameter of the interior, the gain or the offset a prior?
    fn is_given_a_prior(&self, i: usize) -> bool {
        self.options.treatments.iter().any(|(at, treatment)| *at == i && treatment.prior().is_some())
    }

    /// Do the data, or whoever held it, say what it is?
    fn is_known(&self, i: usize) -> bool {
        match self.fit.knowledge[i] {
            Knowledge::NotIdentifiable => false,
            // the method's wide prior is no result; one that the user gave is what they know
            Knowledge::PriorOnly => self.is_given_a_prior(i),
            _ => true,
        }
    }

    /// Dry matter that was fitted as C_prot + C_cbc.
    fn split_dry_matter(&self, i: usize) -> bool {
        i == place(Parameter::Cm) && self.fit.version == Version::Pro && self.fit.x[i] == 0.0
    }

    /// The value in the unit of files; `None` where the model has no such parameter, or nothing is known of it.
    fn value(&self, i: usize) -> Option<f64> {
        if !self.has(i) {
            return None;
        }
        let parts = [Parameter::Prot, Parameter::Cbc].map(place);
        if self.split_dry_matter(i) {
            return parts.iter().all(|&part| self.is_known(part)).then(|| self.fit.interior().cm);
        }
        if i == place(Parameter::Car) && self.fit.car_per_cab.is_some() {
            return self.is_known(place(Parameter::Cab)).then(|| self.fit.interior().car);
        }
        if i == N && self.fit.scaled_index {
            return Some(self.fit.x[N] * self.mean_index());
        }
        self.is_known(i).then(|| self.fit.x[i] * unit(i))
    }

    fn standard_error(&self, i: usize) -> Option<f64> {
        self.value(i)?;
        match interior(i) {
            Some(parameter) => self.fit.interior_se(parameter),
            None if i == N && self.fit.scaled_index => Some(self.fit.standard_errors[N]? * self.mean_index()),
            None => self.fit.standard_errors[i].map(|error| error * unit(i)),
        }
    }

    /// PROSPECT's refractive index, mean over the fitted wavelengths.
    fn mean_index(&self) -> f64 {
        let sum: f64 = self.fit.wavelengths_nm.iter().map(|nm| self.index_at(*nm)).sum();
        sum / self.fit.wavelengths_nm.len() as f64
    }

    fn index_at(&self, nm: f64) -> f64 {
        let band = (nm - 400.0).round().clamp(0.0, 2100.0) as usize;
        table::full(self.fit.version).refractive_index(band).unwrap_or(f64::NAN)
    }

    /// n and σ of a wavelength.
    fn surface_at(&self, nm: f64) -> [Option<f64>; 2] {
        let n =
            if self.fit.scaled_index && self.has(N) { Some(self.fit.x[N] * self.index_at(nm)) } else { self.value(N) };
        [n, self.value(SIGMA)]
    }

    /// DHRF at θ_s from the leaf's own normal: a tilt in the holder has no part in it.
    fn budget(&self, theta_s_deg: f64) -> Result<Budget, DomainError> {
        let angle = Angle::from_degrees(theta_s_deg);
        let nothing = Budget { theta_s_deg, specular: f64::NAN, specular_se: f64::NAN, diffuse: 1.0 };
        let diffuse = match self.options.surface.diffuse {
            // P1 is P2 with e = 0
            DiffuseKind::P1 | DiffuseKind::P2 if self.fit.has_surface => {
                let [a, b, e] = [DIFFUSE_A, DIFFUSE_B, DIFFUSE_E].map(|i| self.fit.x[i]);
                P2::new(a, b, e)?.hemispherical(angle.cos())
            }
            _ => 1.0,
        };
        let ([Some(n), Some(sigma)], true) = ([self.value(N), self.value(SIGMA)], self.fit.has_surface) else {
            return Ok(Budget { diffuse, ..nothing });
        };
        let surface = &self.options.surface;
        let gradient = dhrf(surface.facets, surface.normalization, n, sigma, &Illumination::new(angle)?, Grade::E10)?;
        let c = &self.fit.covariance;
        let open = |i: usize| self.fit.treatments[i].is_free() && self.fit.at_bound[i] == AtBound::Free;
        let unknown = [N, SIGMA].iter().any(|&i| open(i) && self.fit.standard_errors[i].is_none());
        let specular_se =
            if unknown { f64::NAN } else { Budget::specular_se(&gradient, [c[N][N], c[N][SIGMA], c[SIGMA][SIGMA]]) };
        Ok(Budget { theta_s_deg, specular: gradient.value, specular_se, diffuse })
    }

    /// The leaf's row of `leaves.csv`.
    pub fn values(&self) -> LeafValues {
        let of = |parameter: Parameter| self.value(place(parameter));
        LeafValues {
            normalization: Some(self.options.surface.normalization.name().to_string()),
            n: self.value(N),
            sigma: self.value(SIGMA),
            tilt_deg: [self.value(TILT_IN_PLANE), self.value(TILT_LATERAL)],
            surface_se: [N, SIGMA, TILT_IN_PLANE, TILT_LATERAL].map(|i| self.standard_error(i)),
            p1: [self.value(DIFFUSE_A), self.value(DIFFUSE_B)],
            p1_se: [self.standard_error(DIFFUSE_A), self.standard_error(DIFFUSE_B)],
            p2_e: [self.value(DIFFUSE_E), self.standard_error(DIFFUSE_E)],
            kinds: Some([self.options.surface.facets.name(), self.options.surface.diffuse.name()]),
            prospect: Parameter::ALL.map(of),
            prospect_se: Parameter::ALL.map(|parameter| self.standard_error(place(parameter))),
            method: Some(self.fit.method.name()),
            gain_and_offset: [self.value(GAIN), self.value(OFFSET)],
            gain_and_offset_se: [self.standard_error(GAIN), self.standard_error(OFFSET)],
            rmse: self.fit.rmse,
            r2: self.fit.r2,
            bands: self.fit.wavelengths_nm.len(),
            warnings: self.warnings.clone(),
        }
    }

    /// One line for people.
    pub fn line(&self) -> String {
        let numbers: Vec<String> = (0..NAMES.len())
            .filter(|&i| self.fit.knowledge[i] != Knowledge::Held || i == place(Parameter::NStruct))
            .filter_map(|i| {
                let error = self.standard_error(i).map_or(String::new(), |error| format!(" ± {error:.1e}"));
                Some(format!("{} {}{error}", NAMES[i], brief(self.value(i)?)))
            })
            .collect();
        // a single value has no spread that could be explained
        let r2 = if self.fit.r2.is_finite() { format!("{:.4}", self.fit.r2) } else { "undefined".to_string() };
        format!(
            "{} bands, {}, rmse {:.3e} sr^-1, R2 {r2}",
            self.fit.wavelengths_nm.len(),
            numbers.join(", "),
            self.fit.rmse
        )
    }

    /// `sigma=upper;n=lower`, or nothing.
    fn at_bound(&self) -> String {
        tables::at_bound(NAMES.into_iter().zip(self.fit.at_bound))
    }

    /// Writes `bands.csv` and `dhrf.csv` into a folder, each whole or not at all.
    ///
    /// # Errors
    /// The system's.
    pub fn write_tables(&self, folder: &Path) -> io::Result<()> {
        let (fit, surface) = (&self.fit, &self.options.surface);
        let leaf = OneSurface {
            at_bound: &self.at_bound(),
            shape: [DIFFUSE_A, DIFFUSE_B, DIFFUSE_E, TILT_IN_PLANE, TILT_LATERAL].map(|i| self.value(i)),
            facets: surface.facets.name(),
            diffuse: surface.diffuse.name(),
            normalization: surface.normalization,
        };
        let status = if fit.termination.converged() { "converged" } else { "max_iterations" };
        let bands = fit.wavelengths_nm.iter().enumerate().map(|(place, nm)| {
            let ((squares, n_obs), k_l) = (fit.squares[place], fit.k_lambert[place]);
            Band {
                wavelength_nm: *nm,
                k_l: Some(k_l),
                surface: self.surface_at(*nm),
                rmse: Some((squares / n_obs as f64).sqrt()),
                n_obs,
                status,
                k_l_se: fit.k_lambert_se[place],
                surface_se: [N, SIGMA].map(|i| self.standard_error(i)),
                note: if k_l < 0.0 { "k_l negative" } else { "" },
            }
        });
        write_bands(folder, &leaf, bands)?;

        let bands = fit.wavelengths_nm.iter().zip(&fit.k_lambert);
        let rows = bands.flat_map(|(nm, k_l)| self.dhrf.iter().map(|budget| (*nm, budget.with_k_lambert(*k_l))));
        write_budgets(folder, surface.normalization, rows)
    }
}

/// Four digits.
fn brief(value: f64) -> String {
    if value.abs() >= 0.1 || value == 0.0 { format!("{value:.3}") } else { format!("{value:.3e}") }
}
