//! What an inversion says: parameters, standard errors, and what cannot be known.

use std::boxed::Box;
use std::vec::Vec;

use leafbrdf_prospect::{LeafParams, Parameter, Version};

use super::engine::leaf_of;
use super::parameters::{COUNT, Treatment, interior, place};
use super::problem::Method;
use super::recipe::{Interior, Recipe};
use crate::bounds::AtBound;
use crate::solver::Termination;

/// What the data tell about a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knowledge {
    /// It has a standard error smaller than the interval it was sought in.
    Identified,
    /// Held by caller or method.
    Held,
    /// At a bound, and held there: the data ask for a value beyond.
    AtBound,
    /// The data do not determine it.
    NotIdentifiable,
    /// Its value is that of its prior: the data add next to nothing.
    PriorOnly,
    /// There are no more independent values than parameters: nothing is left to estimate errors from.
    NoDegreesOfFreedom,
}

impl Knowledge {
    /// Why there is no standard error, or why it should not be trusted; `None` where there is nothing to say.
    pub const fn why(self) -> Option<&'static str> {
        match self {
            Knowledge::Identified => None,
            Knowledge::Held => Some("held"),
            Knowledge::AtBound => Some("held at a bound: the data ask for a value beyond"),
            Knowledge::NotIdentifiable => Some("not identifiable from these data"),
            Knowledge::PriorOnly => Some("known from its prior alone"),
            Knowledge::NoDegreesOfFreedom => Some("no more independent values than parameters"),
        }
    }
}

/// Another place where a search ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OtherLeaf {
    /// The parameters there.
    pub x: [f64; COUNT],
    /// The cost there.
    pub cost: f64,
}

/// What the recommended method did before it fitted the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct RecipeReport {
    /// The recipe.
    pub recipe: &'static Recipe,
    /// The inside of the leaf in the end: the share of the pigments may follow from the dry matter.
    pub interior: Interior,
    /// Directions that the interior was taken from, by their place in the data.
    pub kept: Vec<usize>,
    /// Wavelengths that the interior was taken from, nm.
    pub wavelengths_nm: Vec<f64>,
    /// Their mean reflectance over the kept directions, NaN where missing, and the modelled one.
    pub reflectance: Vec<f64>,
    /// See `reflectance`.
    pub modelled: Vec<f64>,
    /// Its cost: whitened squares and priors.
    pub cost: f64,
    /// Gain and flat offset of the diffuse term beside the surface: k_L = gain · d + offset. The leaf's own gain and offset belong to
    /// the interior step, where the offset holds what the kept directions see of the surface.
    pub diffuse_gain: f64,
    /// See `diffuse_gain`.
    pub diffuse_offset: f64,
}

/// The best leaf for the data.
#[derive(Clone, Debug)]
pub struct LeafFit {
    /// The method.
    pub method: Method,
    /// Version of PROSPECT.
    pub version: Version,
    /// C_car/C_ab, where it is tied.
    pub car_per_cab: Option<f64>,
    /// All parameters, in the order of [`NAMES`](super::parameters::NAMES); tilts in radians.
    pub x: [f64; COUNT],
    /// What became of each.
    pub treatments: [Treatment; COUNT],
    /// Standard errors, in the parameters' units.
    pub standard_errors: [Option<f64>; COUNT],
    /// Covariances of those that have an error, 0 elsewhere.
    pub covariance: Box<[[f64; COUNT]; COUNT]>,
    /// What the data tell.
    pub knowledge: [Knowledge; COUNT],
    /// Share of a parameter's prior variance that is left: 1 where the data say nothing, near 0 where the prior plays no part.
    pub prior_share: [f64; COUNT],
    /// Which parameters sit at a bound.
    pub at_bound: [AtBound; COUNT],
    /// Is there a surface at all? Not from fewer than three directions.
    pub has_surface: bool,
    /// Is n a coefficient on PROSPECT's tabulated index?
    pub scaled_index: bool,
    /// Place of each fitted wavelength in the data.
    pub bands: Vec<usize>,
    /// Fitted wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
    /// k_L(λ).
    pub k_lambert: Vec<f64>,
    /// Standard errors of k_L.
    pub k_lambert_se: Vec<Option<f64>>,
    /// Σ (BRDF_measured − BRDF_modelled)² of each wavelength, sr⁻², and how many values.
    pub squares: Vec<(f64, usize)>,
    /// √(Σ residual²/values), sr⁻¹.
    pub rmse: f64,
    /// 1 − Σ residual²/Σ (value − mean)².
    pub r2: f64,
    /// Values used.
    pub n_obs: usize,
    /// As many independent values, residuals of neighbouring wavelengths being alike: n (1 − ρ)/(1 + ρ), at least one a direction.
    pub n_effective: f64,
    /// The cost that was minimised (of the interior step, for the recommended method).
    pub cost: f64,
    /// What one squared standard deviation of a prior weighed, in units of χ².
    pub prior_weight: f64,
    /// Condition number of the normal matrix scaled to unit diagonal, priors included; the worse of the two steps where there are two.
    pub condition: f64,
    /// Starts searched from.
    pub starts: u32,
    /// Of these, how many arrived at this minimum (cost within 0.1 %).
    pub agreeing: u32,
    /// Steps over all starts.
    pub iterations: u32,
    /// Why the search that won ended.
    pub termination: Termination,
    /// The next best distinct place where a search ended.
    pub second: Option<OtherLeaf>,
    /// What the recommended method did.
    pub recipe: Option<RecipeReport>,
}

impl LeafFit {
    /// PROSPECT's parameters, with carotenoids where they are tied, and dry matter as prot + cbc where these are what was fitted.
    pub fn interior(&self) -> LeafParams<f64> {
        let mut leaf = leaf_of(&self.x);
        if let Some(ratio) = self.car_per_cab {
            leaf.car = ratio * leaf.cab;
        }
        if self.version == Version::Pro && leaf.cm == 0.0 {
            leaf.cm = leaf.prot + leaf.cbc;
        }
        leaf
    }

    /// The standard error of a parameter of [`LeafFit::interior`].
    pub fn interior_se(&self, parameter: Parameter) -> Option<f64> {
        let [prot, cbc] = [Parameter::Prot, Parameter::Cbc].map(place);
        match parameter {
            Parameter::Car if self.car_per_cab.is_some() => {
                Some(self.car_per_cab? * self.standard_errors[place(Parameter::Cab)]?)
            }
            Parameter::Cm if self.version == Version::Pro && self.x[place(Parameter::Cm)] == 0.0 => {
                self.standard_errors[prot]?;
                self.standard_errors[cbc]?;
                let variance =
                    self.covariance[prot][prot] + self.covariance[cbc][cbc] + 2.0 * self.covariance[prot][cbc];
                Some(variance.max(0.0).sqrt())
            }
            other => self.standard_errors[place(other)],
        }
    }

    /// How many k_L are negative: there the surface takes more than all the light.
    pub fn negative_k_lambert(&self) -> usize {
        self.k_lambert.iter().filter(|k| **k < 0.0).count()
    }

    /// The correlation of two parameters; `None` where either has no error.
    pub fn correlation(&self, i: usize, j: usize) -> Option<f64> {
        Some(self.covariance[i][j] / (self.standard_errors[i]? * self.standard_errors[j]?))
    }
}

/// The interior's parameters that a version has none of are held at 0.
pub(super) fn absent(treatments: &mut [Treatment; COUNT], has: impl Fn(Parameter) -> bool) {
    for (i, treatment) in treatments.iter_mut().enumerate() {
        if interior(i).is_some_and(|parameter| !has(parameter)) {
            *treatment = Treatment::Held(0.0);
        }
    }
}
