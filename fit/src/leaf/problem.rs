//! What was measured of a leaf, what is sought, and what cannot be.

use std::vec;
use std::vec::Vec;

use leafbrdf_core::DirectionVectors;
use leafbrdf_prospect::table::{self, FIRST_NM, LAST_NM, columns_of};
use leafbrdf_prospect::{Coupling, Parameter, Prospect, Version};

use super::error::LeafError;
use super::parameters::{COUNT, GAIN, NAMES, Treatment, interior, place};
use super::recipe::{Interior, RECOMMENDED, Recipe};
use super::report::LeafFit;
use super::{joint, recommended};
use crate::FitError;
use crate::bounds::Interval;
use crate::hemispherical::Free;
use crate::surface::model::{N, PARAMETERS, SIGMA};
use crate::surface::{SurfaceOptions, Treatment as SurfaceTreatment};

/// Measured BRDF of one leaf: directions × wavelengths.
#[derive(Clone, Copy, Debug)]
pub struct DirectionalData<'a> {
    /// Wavelengths, nm, rising; those outside PROSPECT's 400–2500 nm are left out by every method.
    pub wavelengths_nm: &'a [f64],
    /// One pair of directions a column, in the instrument's frame.
    pub directions: &'a [DirectionVectors<f64>],
    /// BRDF in sr⁻¹, band after band, one value a direction; NaN where missing.
    pub brdf: &'a [f64],
    /// Standard deviation of each value in sr⁻¹, in the same order, > 0; without it every value counts the same.
    pub sd: Option<&'a [f64]>,
}

/// How a leaf is inverted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The interior by a [`Recipe`], then the surface.
    #[default]
    Recommended,
    /// Surface first, then the interior (§4.6).
    TwoStep,
    /// Everything at once.
    Joint,
}

impl Method {
    /// Name in files and on the command line: `recommended`, `two-step`, `joint`.
    pub const fn name(self) -> &'static str {
        match self {
            Method::Recommended => "recommended",
            Method::TwoStep => "two-step",
            Method::Joint => "joint",
        }
    }
}

/// Where `two-step` takes n and σ from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SurfaceFrom {
    /// The means of n and σ over separately fitted bands, as the paper (Table 4).
    #[default]
    Bands,
    /// One n and σ for all bands.
    Surface,
}

/// What is sought, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafOptions {
    /// The method.
    pub method: Method,
    /// Version of PROSPECT.
    pub version: Version,
    /// C_car = ratio · C_ab, where it is tied.
    pub car_per_cab: Option<f64>,
    /// The surface: facets, diffuse term, convention for K, what becomes of n, σ, a, b and the tilts.
    pub surface: SurfaceOptions,
    /// Constants of [`Method::Recommended`].
    pub recipe: &'static Recipe,
    /// From the interior to k_L, for the other methods.
    pub coupling: Coupling,
    /// The interior of the other methods.
    pub interior: Interior,
    /// Where `two-step` takes the surface from.
    pub surface_from: SurfaceFrom,
    /// What the caller decides of interior, gain and offset, by place in [`NAMES`]: the rest is the method's.
    pub treatments: Vec<(usize, Treatment)>,
    /// The interior's parameters have the recipe's priors in the other methods too.
    pub content_priors: bool,
    /// Starts of the caller's own, tried beside the method's.
    pub starts: Vec<[f64; COUNT]>,
    /// Only the caller's starts.
    pub only_starts: bool,
    /// Stop where the predicted decrease is below this share of the cost.
    pub tolerance: f64,
    /// The most steps a search.
    pub max_iterations: u32,
}

impl LeafOptions {
    /// The default of a method. `recommended`: GGX facets, P1 diffuse term and tilt; the others: the paper's surface.
    pub fn new(method: Method) -> Self {
        LeafOptions {
            method,
            version: Version::D,
            car_per_cab: None,
            surface: match method {
                Method::Recommended => SurfaceOptions::paper().with_ggx().with_p1().with_tilt(),
                _ => SurfaceOptions::paper(),
            },
            recipe: RECOMMENDED,
            coupling: Coupling::Bousquet,
            interior: Interior::Plain,
            surface_from: SurfaceFrom::default(),
            treatments: Vec::new(),
            content_priors: false,
            starts: Vec::new(),
            only_starts: false,
            tolerance: 1e-10,
            max_iterations: 200,
        }
    }

    /// What the caller decides of a parameter.
    pub(super) fn decided(&self, place: usize) -> Option<Treatment> {
        self.treatments.iter().find(|(other, _)| *other == place).map(|(_, treatment)| *treatment)
    }

    /// Does the version know this constituent, as a parameter of its own?
    pub(super) fn has(&self, parameter: Parameter) -> bool {
        match parameter {
            Parameter::NStruct => true,
            Parameter::Car if self.car_per_cab.is_some() => false,
            // dry matter is prot + cbc there
            Parameter::Cm if self.version == Version::Pro => self.decided(place(Parameter::Cm)).is_some(),
            other => self.version.constituents().contains(&other),
        }
    }

    /// The model, on a table.
    pub(super) fn prospect<'a>(&self, view: table::View<'a, f64>) -> Result<Prospect<'a, f64>, LeafError> {
        let model = Prospect::new(view);
        Ok(match self.car_per_cab {
            Some(ratio) => model.with_car_per_cab(ratio)?,
            None => model,
        })
    }

    /// The surface's six as this page's list has them.
    pub(super) fn of_surface(&self, one: &SurfaceTreatment<f64>) -> Treatment {
        match *one {
            SurfaceTreatment::Held(value) => Treatment::Held(value),
            SurfaceTreatment::Free { bounds, prior } => {
                Treatment::Free { bounds, prior: prior.map(|prior| super::Prior::plain(prior.mean, prior.sd)) }
            }
        }
    }

    fn check(&self) -> Result<(), LeafError> {
        for (at, treatment) in &self.treatments {
            let Some(name) = NAMES.get(*at).filter(|_| *at >= PARAMETERS) else {
                return Err(LeafError::Place { place: *at });
            };
            if let Some(parameter) = interior(*at) {
                let known = parameter == Parameter::NStruct || self.version.constituents().contains(&parameter);
                let present = !matches!(treatment, Treatment::Held(value) if *value == 0.0);
                if !known && present {
                    let error = leafbrdf_prospect::Error::NotInVersion { parameter, version: self.version };
                    return Err(error.into());
                }
                if parameter == Parameter::Car && self.car_per_cab.is_some() && present {
                    return Err(leafbrdf_prospect::Error::CarGivenAndTied.into());
                }
                let (lowest, highest) = parameter.limits();
                match treatment {
                    Treatment::Held(value) if !(*value >= lowest && *value <= highest) => {
                        return Err(leafbrdf_prospect::Error::Outside { parameter, value: *value }.into());
                    }
                    Treatment::Free { bounds, .. }
                        if !(bounds.lower >= lowest && bounds.upper <= highest && bounds.lower < bounds.upper) =>
                    {
                        return Err(LeafError::Bounds { name, lowest, highest });
                    }
                    _ => {}
                }
            } else if let Treatment::Free { bounds, .. } = treatment {
                let (lowest, highest) = coupling_bounds(*at);
                if !(bounds.lower >= lowest && bounds.upper <= highest && bounds.lower < bounds.upper) {
                    return Err(LeafError::Bounds { name, lowest, highest });
                }
            }
        }
        Ok(())
    }
}

/// Bounds of gain and offset.
fn coupling_bounds(place: usize) -> (f64, f64) {
    if place == GAIN { (0.1, 10.0) } else { (-1.0, 1.0) }
}

/// The interval of a parameter where nobody says another: what is possible where a logarithmic prior keeps it, else what leaves
/// have.
pub fn default_bounds(place: usize, log_prior: bool) -> Interval<f64> {
    match interior(place) {
        Some(parameter) if log_prior => {
            let (lowest, highest) = parameter.limits();
            Interval::new(lowest, highest)
        }
        Some(parameter) => Free::<f64>::new(parameter).bounds,
        None => {
            let (lower, upper) = coupling_bounds(place);
            Interval::new(lower, upper)
        }
    }
}

/// The leaf as the methods see it: wavelengths that PROSPECT knows, in reflectance.
pub(super) struct Leaf<'a> {
    pub data: DirectionalData<'a>,
    /// Place of each wavelength that takes part, in the data.
    pub bands: Vec<usize>,
    pub wavelengths_nm: Vec<f64>,
    /// The coefficient tables at these wavelengths.
    columns: Vec<f64>,
    version: Version,
    /// Directions with any value at all.
    pub seen: usize,
}

impl<'a> Leaf<'a> {
    fn new(data: &DirectionalData<'a>, version: Version) -> Result<Self, LeafError> {
        let directions = data.directions.len();
        let expected = data.wavelengths_nm.len() * directions;
        for (what, slice) in [("brdf", Some(data.brdf)), ("sd", data.sd)] {
            if let Some(slice) = slice
                && (slice.len() != expected || expected == 0)
            {
                return Err(FitError::Length { what, found: slice.len(), expected }.into());
            }
        }
        if let Some(index) = data.brdf.iter().position(|y| y.is_infinite()) {
            return Err(FitError::NotFinite { what: "brdf", index }.into());
        }
        if let Some(sd) = data.sd
            && let Some(index) =
                sd.iter().zip(data.brdf).position(|(sd, y)| !y.is_nan() && !(*sd > 0.0 && sd.is_finite()))
        {
            return Err(FitError::NotFinite { what: "sd (or is not positive)", index }.into());
        }
        let known = |nm: f64| nm >= f64::from(FIRST_NM) && nm <= f64::from(LAST_NM);
        let usable = |band: usize| data.brdf[band * directions..(band + 1) * directions].iter().any(|y| !y.is_nan());
        let bands: Vec<usize> =
            (0..data.wavelengths_nm.len()).filter(|&band| known(data.wavelengths_nm[band]) && usable(band)).collect();
        if bands.is_empty() {
            let ends = [data.wavelengths_nm.first(), data.wavelengths_nm.last()];
            let [first, last] = ends.map(|nm| nm.copied().unwrap_or(f64::NAN));
            return Err(LeafError::NothingMeasured { first, last });
        }
        let wavelengths_nm: Vec<f64> = bands.iter().map(|&band| data.wavelengths_nm[band]).collect();
        let columns = tabulate(version, &wavelengths_nm)?;
        let value = |band: usize, v: usize| data.brdf[band * directions + v];
        let seen = (0..directions).filter(|&v| bands.iter().any(|&band| !value(band, v).is_nan())).count();
        Ok(Leaf { data: *data, bands, wavelengths_nm, columns, version, seen })
    }

    /// PROSPECT's table at every wavelength.
    pub fn view(&self) -> Result<table::View<'_, f64>, LeafError> {
        Ok(view(self.version, &self.wavelengths_nm, &self.columns)?)
    }

    /// π · BRDF, direction by direction, at some of the bands.
    pub fn brf(&self, places: &[usize]) -> Vec<f64> {
        self.gather(self.data.brdf, places)
    }

    /// π · sd in the same order.
    pub fn sd(&self, places: &[usize]) -> Option<Vec<f64>> {
        Some(self.gather(self.data.sd?, places))
    }

    fn gather(&self, values: &[f64], places: &[usize]) -> Vec<f64> {
        let directions = self.data.directions.len();
        let of = |v: usize| move |&place: &usize| values[self.bands[place] * directions + v] * core::f64::consts::PI;
        (0..directions).flat_map(|v| places.iter().map(of(v))).collect()
    }

    /// BRDF of the bands that take part, band after band.
    pub fn brdf(&self) -> Vec<f64> {
        self.rows(self.data.brdf)
    }

    /// The same of any array of the data's shape.
    pub fn rows(&self, values: &[f64]) -> Vec<f64> {
        let directions = self.data.directions.len();
        self.bands.iter().flat_map(|&band| values[band * directions..(band + 1) * directions].iter().copied()).collect()
    }
}

/// The coefficient tables of a version at these wavelengths.
pub(super) fn tabulate(version: Version, wavelengths_nm: &[f64]) -> Result<Vec<f64>, leafbrdf_prospect::Error> {
    let mut columns = vec![0.0; columns_of(version) * wavelengths_nm.len()];
    table::full(version).at_wavelengths(wavelengths_nm, &mut columns)?;
    Ok(columns)
}

/// The same as the model takes them.
pub(super) fn view<'a>(
    version: Version,
    wavelengths_nm: &'a [f64],
    columns: &'a [f64],
) -> Result<table::View<'a, f64>, leafbrdf_prospect::Error> {
    table::View::from_columns(version, table::Wavelengths::Listed(wavelengths_nm), columns)
}

/// Inverts a leaf.
///
/// # Errors
/// [`LeafError`], before any search begins.
pub fn fit(data: &DirectionalData<'_>, options: &LeafOptions) -> Result<LeafFit, LeafError> {
    options.check()?;
    let leaf = Leaf::new(data, options.version)?;
    match options.method {
        Method::Recommended => recommended::fit(&leaf, options),
        Method::TwoStep | Method::Joint => joint::fit(&leaf, options),
    }
}

/// Two values of n or σ need a third direction: k_L takes one.
pub(super) const LEAST_DIRECTIONS: usize = 3;

/// Where n and σ are held when there are fewer directions: the paper's start (Table 3).
pub(super) const UNSEEN_SURFACE: [(usize, f64); 2] = [(N, 1.47), (SIGMA, 0.3)];
