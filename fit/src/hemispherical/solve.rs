//! From spectra to the best leaf: several deterministic starts, the best minimum, and what the others say.

use leafbrdf_core::Real;
use leafbrdf_prospect::{Lanes, LeafParams};

use super::axis::Axis;
use super::misfit::{BLOCK, Misfit};
use super::report::{Found, HemisphericalFit};
use super::{Free, HemisphericalError, HemisphericalProblem};
use crate::band::Weights;
use crate::bounds::Interval;
use crate::solver::{Minimum, SolverOptions, minimize};

/// How spectra are inverted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HemisphericalOptions<T> {
    /// Stop where the predicted decrease is below this share of χ².
    pub tolerance: T,
    /// The most steps a start.
    pub max_iterations: u32,
    /// What the weights mean for the standard errors.
    pub weights: Weights,
    /// Residuals of neighbouring wavelengths that resemble each other count as fewer values; see [`HemisphericalFit::n_effective`].
    /// Has no effect on the parameters.
    pub correlated_residuals: bool,
    /// The error of measurement below which nobody should believe a spectrum, a fraction (0.005: half a per cent of the reference
    /// panel). Decides what counts as identifiable, nothing else; with [`Weights::Absolute`] it has no part.
    pub least_error: T,
}

impl<T: Lanes> Default for HemisphericalOptions<T> {
    /// 10⁻¹⁰ of χ² in double precision, 10⁻⁴ in single; 100 steps; relative weights, correlated residuals, 0.005.
    fn default() -> Self {
        HemisphericalOptions {
            tolerance: if T::EPSILON < T::lit(1e-10) { T::lit(1e-10) } else { T::lit(1e-4) },
            max_iterations: 100,
            weights: Weights::Relative,
            correlated_residuals: true,
            least_error: T::lit(0.005),
        }
    }
}

/// Leaves to start from: green, pale, thick and dark, brown. Together they see every part of the box.
pub fn starts<T: Real>() -> [LeafParams<T>; 4] {
    [
        [1.5, 40.0, 8.0, 1.0, 0.05, 0.012, 0.006],
        [1.2, 6.0, 2.0, 0.5, 0.02, 0.006, 0.003],
        [2.2, 70.0, 15.0, 5.0, 0.2, 0.03, 0.015],
        [1.8, 4.0, 4.0, 3.0, 1.0, 0.002, 0.008],
    ]
    .map(|leaf| {
        let [n_struct, cab, car, cant, cbrown, cw, cm] = leaf.map(T::lit);
        // one sixth of the dry matter is protein
        let prot = cm / T::lit(6.0);
        LeafParams { n_struct, cab, car, cant, cbrown, cw, cm, prot, cbc: cm - prot }
    })
}

/// Numbers of workspace for `parameters` free ones: what is fastest. A sixty-fourth of it is enough.
pub const fn workspace_len(parameters: usize) -> usize {
    BLOCK * (2 + 2 * parameters)
}

/// Inverts spectra for `P` free parameters: a bounded Gauss–Newton search from each start, and the best of their minima.
///
/// - `starts`: leaves to start from, of which the free parameters matter, moved inside the bounds; [`starts`] without any.
/// - `workspace`: at least 2 + 2P numbers, [`workspace_len`] for full speed.
///
/// # Errors
/// [`HemisphericalError`], before any search begins.
///
/// ```
/// use leafbrdf_fit::hemispherical::{self, Free, HemisphericalOptions, HemisphericalProblem, Measured, Spectra};
/// use leafbrdf_prospect::{LeafParams, Parameter, Prospect, Version, table};
///
/// // a spectrometer with 121 bands in the visible and near infrared
/// static BANDS: table::TableD<f64, 121> = table::TableD::<f64, 121>::cut::<400, 5>();
/// let model = Prospect::new(BANDS.view());
/// let leaf = LeafParams { cab: 42.0, car: 9.0, cw: 0.01, cm: 0.007, ..LeafParams::with_n_struct(1.6) };
/// let (mut r, mut t) = ([0.0; 121], [0.0; 121]);
/// model.spectrum(&leaf, &mut r, &mut t)?;
///
/// let problem = HemisphericalProblem {
///     model,
///     spectra: Spectra {
///         reflectance: Some(Measured { values: &r, weights: None }),
///         transmittance: Some(Measured { values: &t, weights: None }),
///     },
///     held: LeafParams { cw: 0.01, ..LeafParams::with_n_struct(1.5) },
/// };
/// let free = [Parameter::NStruct, Parameter::Cab, Parameter::Car, Parameter::Cm].map(Free::new);
/// let mut workspace = [0.0; hemispherical::workspace_len(4)];
/// let fit = hemispherical::fit(&problem, &free, &[], &HemisphericalOptions::default(), &mut workspace)?;
/// assert!((fit.leaf.cab - 42.0).abs() < 1e-6 && (fit.leaf.n_struct - 1.6).abs() < 1e-8);
/// # Ok::<(), hemispherical::HemisphericalError>(())
/// ```
pub fn fit<T: Lanes, const P: usize>(
    problem: &HemisphericalProblem<'_, T>,
    free: &[Free<T>; P],
    starts: &[LeafParams<T>],
    options: &HemisphericalOptions<T>,
    workspace: &mut [T],
) -> Result<HemisphericalFit<T, P>, HemisphericalError> {
    if P == 0 {
        return Err(HemisphericalError::NothingFree);
    }
    for (i, one) in free.iter().enumerate() {
        one.check()?;
        if free.iter().take(i).any(|other| other.parameter == one.parameter) {
            return Err(HemisphericalError::Twice { parameter: one.parameter });
        }
    }
    let n_obs = problem.spectra.check(problem.model.view().len())?;
    let least = 2 + 2 * P;
    if workspace.len() < least {
        return Err(HemisphericalError::Length { what: "workspace", found: workspace.len(), expected: least });
    }
    let mut misfit =
        Misfit { problem, parameters: free.map(|free| free.parameter), axes: free.map(|f| Axis::new(&f)), workspace };
    // Every rule of the model shows in the middle of the box, where no free parameter is 0.
    let middle = misfit.leaf(&[T::HALF; P]);
    problem.model.band(&middle, 0)?;

    let mut search = Search { best: None, second: None, iterations: 0, starts: 0, agreeing: 0 };
    for start in starts {
        search.begin(&mut misfit, start, options);
    }
    if starts.is_empty() {
        for start in &self::starts() {
            search.begin(&mut misfit, start, options);
        }
    }
    let Search { best: Some(best), second, iterations, starts, agreeing } = search else {
        return Err(HemisphericalError::NothingMeasured);
    };
    let leaf = misfit.leaf(&best.x);
    let residuals = misfit.residuals(&leaf)?;
    let found = Found {
        leaf,
        minimum: best,
        slopes: misfit.slopes(&best.x),
        residuals,
        n_obs,
        second: second
            .filter(|other| distinct(&best, other))
            .map(|other| (misfit.leaf(&other.x), other.evaluation.cost)),
        iterations,
        starts,
        agreeing,
    };
    Ok(HemisphericalFit::new(&found, free, options))
}

/// The searches so far.
struct Search<T, const P: usize> {
    best: Option<Minimum<T, P>>,
    second: Option<Minimum<T, P>>,
    iterations: u32,
    starts: u32,
    agreeing: u32,
}

impl<T: Lanes, const P: usize> Search<T, P> {
    fn begin(&mut self, misfit: &mut Misfit<'_, '_, T, P>, start: &LeafParams<T>, options: &HemisphericalOptions<T>) {
        let mut x = [T::ZERO; P];
        for ((x, axis), parameter) in x.iter_mut().zip(&misfit.axes).zip(&misfit.parameters) {
            *x = axis.place(start.get(*parameter));
        }
        let solver = SolverOptions {
            tolerance: options.tolerance,
            max_iterations: options.max_iterations,
            // a third of the way from one bound to the other
            max_step: [T::lit(0.35); P],
        };
        let found = minimize(misfit, &[Interval::new(T::ZERO, T::ONE); P], &x, &solver);
        self.iterations += found.iterations;
        self.starts += 1;
        let Some(leader) = self.best else {
            self.best = Some(found);
            self.agreeing = 1;
            return;
        };
        let (winner, loser) =
            if found.evaluation.cost < leader.evaluation.cost { (found, leader) } else { (leader, found) };
        self.best = Some(winner);
        if !distinct(&winner, &loser) {
            self.agreeing += 1;
            return;
        }
        if found.evaluation.cost < leader.evaluation.cost {
            self.agreeing = 1;
        }
        if self.second.is_none_or(|other| loser.evaluation.cost < other.evaluation.cost) {
            self.second = Some(loser);
        }
    }
}

/// Two minima are distinct where a parameter differs by more than a thousandth of its interval.
fn distinct<T: Lanes, const P: usize>(a: &Minimum<T, P>, b: &Minimum<T, P>) -> bool {
    a.x.iter().zip(&b.x).any(|(a, b)| (*a - *b).abs() > T::lit(1e-3))
}
