//! With `std`: free parameters as a list, memory of its own.

use std::vec;
use std::vec::Vec;

use leafbrdf_prospect::{LeafParams, Parameter, Version};

use super::report::{HemisphericalFit, OtherMinimum, Residuals};
use super::solve::{self, HemisphericalOptions, workspace_len};
use super::{Free, HemisphericalError, HemisphericalProblem};
use crate::band::Identifiability;
use crate::bounds::AtBound;
use crate::solver::Termination;

/// What is sought, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafFitOptions {
    /// The free parameters.
    pub free: Vec<Free<f64>>,
    /// Leaves to start from; [`super::starts`] without any.
    pub starts: Vec<LeafParams<f64>>,
    /// Tolerance, weights, and so on.
    pub solver: HemisphericalOptions<f64>,
}

impl LeafFitOptions {
    /// These parameters free, each in its default bounds.
    pub fn new(free: &[Parameter]) -> Self {
        LeafFitOptions {
            free: free.iter().map(|parameter| Free::new(*parameter)).collect(),
            starts: Vec::new(),
            solver: HemisphericalOptions::default(),
        }
    }
}

/// The parameters that a version has: N and every constituent; for PRO without C_m, which is C_prot + C_cbc there.
pub fn default_free(version: Version) -> Vec<Parameter> {
    let constituents = version.constituents().iter().copied();
    core::iter::once(Parameter::NStruct)
        .chain(constituents.filter(|c| version != Version::Pro || *c != Parameter::Cm))
        .collect()
}

/// One free parameter as found.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Which one.
    pub parameter: Parameter,
    /// Its value, in its unit.
    pub value: f64,
    /// Its standard error; `None` where it is held at a bound or not identifiable.
    pub standard_error: Option<f64>,
    /// Whether it sits at a bound.
    pub at_bound: AtBound,
    /// What the spectra can tell about it.
    pub identifiability: Identifiability,
    /// Its correlations with all free parameters, in their order; `None` where either has no standard error.
    pub correlations: Vec<Option<f64>>,
}

impl Estimate {
    /// Why it has no standard error, in a few words; `None` where it has one.
    pub fn why_no_error(&self) -> Option<&'static str> {
        match self.identifiability {
            Identifiability::Identified => None,
            Identifiability::Held if self.at_bound == AtBound::Lower => Some("held at its lower bound"),
            Identifiability::Held => Some("held at its upper bound"),
            Identifiability::NotIdentifiable => Some("not identifiable from these spectra"),
            Identifiability::NoDegreesOfFreedom => Some("no more values than parameters"),
        }
    }
}

/// The best leaf for the spectra.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafFit {
    /// The leaf: free parameters as found, the others as held.
    pub leaf: LeafParams<f64>,
    /// The free parameters, in the order asked for.
    pub estimates: Vec<Estimate>,
    /// χ² = Σ ω (measured − modelled)².
    pub chi2: f64,
    /// √(Σ residual²/n) over all values, a fraction.
    pub rmse: f64,
    /// Values that counted.
    pub n_obs: usize,
    /// As many independent values; see [`HemisphericalFit::n_effective`].
    pub n_effective: f64,
    /// Residuals of the reflectance.
    pub reflectance: Option<Residuals<f64>>,
    /// Residuals of the transmittance.
    pub transmittance: Option<Residuals<f64>>,
    /// Steps over all starts.
    pub iterations: u32,
    /// Starts searched from.
    pub starts: u32,
    /// Of these, how many arrived at this minimum.
    pub agreeing: u32,
    /// Why the search that won ended.
    pub termination: Termination,
    /// The next best distinct place where a search ended.
    pub second: Option<OtherMinimum<f64>>,
}

impl LeafFit {
    /// The estimate of one parameter; `None` where it was held.
    pub fn estimate(&self, parameter: Parameter) -> Option<&Estimate> {
        self.estimates.iter().find(|estimate| estimate.parameter == parameter)
    }
}

/// Inverts spectra for any list of free parameters: [`super::fit`] with memory of its own.
///
/// # Errors
/// As [`super::fit`].
pub fn fit_leaf(
    problem: &HemisphericalProblem<'_, f64>,
    options: &LeafFitOptions,
) -> Result<LeafFit, HemisphericalError> {
    match options.free.len() {
        0 => Err(HemisphericalError::NothingFree),
        1 => sized::<1>(problem, options),
        2 => sized::<2>(problem, options),
        3 => sized::<3>(problem, options),
        4 => sized::<4>(problem, options),
        5 => sized::<5>(problem, options),
        6 => sized::<6>(problem, options),
        7 => sized::<7>(problem, options),
        8 => sized::<8>(problem, options),
        // there are nine parameters: in a longer list one stands twice, and the first nine or the tenth tell which
        9 => sized::<9>(problem, options),
        _ => {
            let twice = options.free.iter().enumerate().find_map(|(i, one)| {
                options.free.iter().take(i).any(|other| other.parameter == one.parameter).then_some(one.parameter)
            });
            Err(twice.map_or(HemisphericalError::NothingFree, |parameter| HemisphericalError::Twice { parameter }))
        }
    }
}

fn sized<const P: usize>(
    problem: &HemisphericalProblem<'_, f64>,
    options: &LeafFitOptions,
) -> Result<LeafFit, HemisphericalError> {
    let Ok(free) = <[Free<f64>; P]>::try_from(options.free.as_slice()) else {
        return Err(HemisphericalError::NothingFree);
    };
    let mut workspace = vec![0.0; workspace_len(P)];
    let fit = solve::fit(problem, &free, &options.starts, &options.solver, &mut workspace)?;
    Ok(fit.into())
}

impl<const P: usize> From<HemisphericalFit<f64, P>> for LeafFit {
    fn from(fit: HemisphericalFit<f64, P>) -> Self {
        let estimate = |i: usize| Estimate {
            parameter: fit.parameters[i],
            value: fit.values[i],
            standard_error: fit.standard_errors[i],
            at_bound: fit.at_bound[i],
            identifiability: fit.identifiability[i],
            correlations: fit.correlations[i].to_vec(),
        };
        LeafFit {
            leaf: fit.leaf,
            estimates: (0..P).map(estimate).collect(),
            chi2: fit.chi2,
            rmse: fit.rmse(),
            n_obs: fit.n_obs,
            n_effective: fit.n_effective,
            reflectance: fit.reflectance,
            transmittance: fit.transmittance,
            iterations: fit.iterations,
            starts: fit.starts,
            agreeing: fit.agreeing,
            termination: fit.termination,
            second: fit.second,
        }
    }
}
