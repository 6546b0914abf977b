//! Standard errors that do not count one misfit 25,000 times, and know how large each direction's noise is.

use std::vec;
use std::vec::Vec;

use super::engine::Cost;
use super::error::LeafError;
use super::parameters::{COUNT, Treatment};
use super::report::Knowledge;
use crate::bounds::AtBound;
use crate::matrix::{eigen, form};

/// Errors of the free parameters of one search.
#[derive(Clone, Debug)]
pub(super) struct Errors {
    pub covariance: [[f64; COUNT]; COUNT],
    pub knowledge: [Knowledge; COUNT],
    pub prior_share: [f64; COUNT],
    pub condition: f64,
}

impl Errors {
    pub fn standard_error(&self, i: usize) -> Option<f64> {
        matches!(self.knowledge[i], Knowledge::Identified | Knowledge::PriorOnly)
            .then(|| self.covariance[i][i].max(0.0).sqrt())
    }
}

/// What is left over, as [`Errors`] need it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scatter {
    pub n_obs: usize,
    pub n_effective: f64,
}

/// Residuals of one direction after the other: how much neighbours resemble each other.
pub(super) fn scatter(measured: &[f64], modelled: &[f64], bands: usize) -> Scatter {
    let (mut lagged, mut paired, mut n_obs, mut directions) = (0.0, 0.0, 0, 0.0);
    for (y, f) in measured.chunks_exact(bands.max(1)).zip(modelled.chunks_exact(bands.max(1))) {
        let mut before: Option<f64> = None;
        directions += f64::from(u8::from(y.iter().any(|y| !y.is_nan())));
        for (y, f) in y.iter().zip(f) {
            if y.is_nan() {
                before = None;
                continue;
            }
            n_obs += 1;
            let r = y - f;
            if let Some(before) = before {
                lagged += before * r;
                paired += 0.5 * (before * before + r * r);
            }
            before = Some(r);
        }
    }
    let rho = if paired > 0.0 { f64::clamp(lagged / paired, 0.0, 1.0) } else { 0.0 };
    let n = n_obs as f64;
    // residuals that are the same at all wavelengths are still one draw a direction
    Scatter { n_obs, n_effective: (n * (1.0 - rho) / (1.0 + rho)).clamp(directions, n) }
}

/// How large the residuals are taken to be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Variance {
    /// As the residual model says: the recipe's.
    Stated,
    /// As they are found, neighbours counting as fewer; at least as the standard deviations of the data say.
    Found(Scatter),
}

/// What the values that are worth fewer than they are many leave to judge the errors by.
struct Freedom {
    /// The variance of one residual, times how many of them tell the same.
    factor: f64,
    /// Values over degrees of freedom.
    correlated: f64,
}

impl Freedom {
    /// Every parameter counts as one, whatever is known of it beforehand, as long as that leaves one degree of freedom; where it does not,
    /// parameters with priors count as the share `taken` of the residuals, and no more than one degree is left. `None` without any.
    fn new(scatter: &Scatter, parameters: usize, taken: f64, chi2: f64, known_sd: bool) -> Option<Self> {
        let n = scatter.n_obs as f64;
        let free = (scatter.n_effective - parameters as f64).max((scatter.n_effective - taken).min(1.0));
        if !(free > 0.0) {
            return None;
        }
        let found = chi2 / n * scatter.n_effective / free;
        let known = if known_sd { 1.0 } else { 0.0 };
        Some(Freedom { factor: found.max(known) * n / scatter.n_effective, correlated: n / free })
    }
}

/// Standard errors at `x`.
///
/// - `held`: what is held and may be off, with its standard deviation: ln N, f, the wavelength scale.
pub(super) fn errors(
    cost: &mut Cost<'_>,
    x: &[f64; COUNT],
    at_bound: &[AtBound; COUNT],
    treatments: &[Treatment; COUNT],
    variance: Variance,
    held: Option<[f64; 3]>,
) -> Result<Errors, LeafError> {
    let normal = cost.normal(x, held.is_some())?;
    let mut knowledge: [Knowledge; COUNT] = core::array::from_fn(|i| match (treatments[i].is_free(), at_bound[i]) {
        (false, _) => Knowledge::Held,
        (true, AtBound::Free) => Knowledge::Identified,
        (true, _) => Knowledge::AtBound,
    });
    let free: Vec<usize> = (0..COUNT).filter(|&i| knowledge[i] == Knowledge::Identified).collect();
    // scaled to unit diagonal; rows and columns of what is not free are those of the identity
    let mut prior_precision = [0.0; COUNT];
    let mut scale = [0.0; COUNT];
    for &i in &free {
        if let Some(prior) = cost.priors[i] {
            prior_precision[i] = cost.prior_weight * prior.misfit(x[i]).1.powi(2);
        }
        scale[i] = (normal.matrix[i][i] + prior_precision[i]).max(0.0).sqrt();
    }
    let scaled: [[f64; COUNT]; COUNT] = core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let size = scale[i] * scale[j];
            if i != j && size > 0.0 { normal.matrix[i][j] / size } else { f64::from(u8::from(i == j)) }
        })
    });
    let (values, vectors) = eigen(&scaled);
    let largest = values.iter().copied().fold(0.0, f64::max);
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    // rounding of the normal matrix
    let least = 1e-13 * largest;
    // A⁻¹; 0 for what is not free
    let mut a_inverse = [[0.0; COUNT]; COUNT];
    for (place, value) in values.iter().enumerate() {
        for &i in &free {
            let v = vectors[i][place];
            if !(*value > least) {
                if v * v > 1e-3 {
                    knowledge[i] = Knowledge::NotIdentifiable;
                }
                continue;
            }
            for &j in &free {
                let size = scale[i] * scale[j];
                if size > 0.0 {
                    a_inverse[i][j] += v * vectors[j][place] / (value * size);
                }
            }
        }
    }
    let Freedom { factor, correlated } = match variance {
        Variance::Stated => Freedom { factor: 1.0, correlated: 0.0 },
        Variance::Found(scatter) => {
            // tr(JᵀJ A⁻¹): a parameter that its prior decides takes nothing of the residuals
            let taken = free.iter().map(|&i| 1.0 - (a_inverse[i][i] * prior_precision[i]).min(1.0)).sum();
            Freedom::new(&scatter, free.len(), taken, normal.chi2, cost.measured.sd.is_some()).unwrap_or_else(|| {
                free.iter().for_each(|&i| knowledge[i] = Knowledge::NoDegreesOfFreedom);
                Freedom { factor: 1.0, correlated: 0.0 }
            })
        }
    };
    // x̂ − x = A⁻¹(Jᵀε + wP(μ − x)), A = JᵀJ + wP: the data's part has the variance found, the prior's own is P⁻¹ whatever it was
    // weighed with, and A⁻¹(s²JᵀJ + w²P)A⁻¹ = s²A⁻¹ + A⁻¹(w − s²)wP A⁻¹
    let mut covariance = a_inverse.map(|row| row.map(|a| factor * a));
    for &k in &free {
        let pulled = (cost.prior_weight - factor) * prior_precision[k];
        for &i in &free {
            for &j in &free {
                covariance[i][j] += a_inverse[i][k] * pulled * a_inverse[k][j];
            }
        }
    }
    let mut growth = [1.0; COUNT];
    if correlated > 0.0 {
        let scatter = cost.scatter(x)?;
        for &i in &free {
            let row = &a_inverse[i];
            let more = correlated * form(&scatter, row) - factor * form(&normal.matrix, row);
            if more > 0.0 && covariance[i][i] > 0.0 {
                growth[i] = (1.0 + more / covariance[i][i]).sqrt();
            }
        }
    }
    // what is held moves the estimate by H⁻¹Jᵀ∂M per unit
    if let Some(sds) = held {
        let stated = covariance;
        for (column, sd) in normal.held.iter().zip(sds) {
            let moved: [f64; COUNT] =
                core::array::from_fn(|i| sd * (0..COUNT).map(|j| stated[i][j] * column[j]).sum::<f64>());
            for i in 0..COUNT {
                for j in 0..COUNT {
                    covariance[i][j] += moved[i] * moved[j];
                }
            }
        }
    }
    let mut prior_share = [0.0; COUNT];
    for &i in &free {
        if scale[i] == 0.0 {
            knowledge[i] = Knowledge::NotIdentifiable;
        }
        if prior_precision[i] > 0.0 {
            // the posterior's own variance, in units of the prior's
            prior_share[i] = (a_inverse[i][i] * prior_precision[i]).min(1.0);
        }
        let width = match treatments[i] {
            Treatment::Free { bounds, .. } => bounds.width(),
            Treatment::Held(_) => f64::INFINITY,
        };
        if knowledge[i] == Knowledge::Identified {
            if prior_share[i] > PRIOR_ONLY {
                knowledge[i] = Knowledge::PriorOnly;
            } else if !(growth[i] * covariance[i][i].sqrt() < width) {
                knowledge[i] = Knowledge::NotIdentifiable;
            }
        }
    }
    for i in 0..COUNT {
        for j in 0..COUNT {
            covariance[i][j] *= growth[i] * growth[j];
        }
    }
    Ok(Errors { covariance, knowledge, prior_share, condition: largest / smallest.max(f64::MIN_POSITIVE) })
}

/// More than this share of its prior variance left: the data have said next to nothing.
const PRIOR_ONLY: f64 = 0.9;

/// The spectrum of k_L with errors, and the misfit wavelength by wavelength.
pub(super) struct Spectrum {
    pub k_lambert: Vec<f64>,
    pub squares: Vec<(f64, usize)>,
    pub rmse: f64,
    pub r2: f64,
    pub scatter: Scatter,
}

/// k_L and residuals at x. Values are reflectances, results are in sr⁻¹.
pub(super) fn spectrum(cost: &mut Cost<'_>, x: &[f64; COUNT]) -> Result<Spectrum, LeafError> {
    let modelled = cost.modelled(x)?;
    let diffuse = cost.diffuse(x, false)?;
    let bands = diffuse.k.len();
    let measured = cost.measured.brf;
    let inv_pi = core::f64::consts::FRAC_1_PI;
    let mut squares = vec![(0.0, 0); bands];
    let (mut sum, mut count) = (0.0, 0_usize);
    for (y, f) in measured.chunks_exact(bands).zip(modelled.chunks_exact(bands)) {
        for ((y, f), (square, n)) in y.iter().zip(f).zip(&mut squares).filter(|((y, _), _)| !y.is_nan()) {
            *square += ((y - f) * inv_pi).powi(2);
            *n += 1;
            sum += y * inv_pi;
            count += 1;
        }
    }
    let mean = sum / count as f64;
    let spread: f64 = measured.iter().filter(|y| !y.is_nan()).map(|y| (y * inv_pi - mean).powi(2)).sum();
    let total: f64 = squares.iter().map(|(square, _)| square).sum();
    Ok(Spectrum {
        scatter: scatter(measured, &modelled, bands),
        k_lambert: diffuse.k,
        squares,
        rmse: (total / count as f64).sqrt(),
        r2: 1.0 - total / spread,
    })
}

/// Standard errors of k_L from the covariance of what it is made of.
pub(super) fn diffuse_errors(
    cost: &mut Cost<'_>,
    x: &[f64; COUNT],
    errors: &Errors,
) -> Result<Vec<Option<f64>>, LeafError> {
    let diffuse = cost.diffuse(x, false)?;
    let bands = diffuse.k.len();
    let moving: Vec<usize> = (0..COUNT).filter(|&i| diffuse.slopes[i].len() == bands).collect();
    let unknown = moving
        .iter()
        .any(|&i| matches!(errors.knowledge[i], Knowledge::NotIdentifiable | Knowledge::NoDegreesOfFreedom));
    if unknown {
        return Ok(vec![None; bands]);
    }
    Ok((0..bands)
        .map(|band| {
            let mut variance = 0.0;
            for &i in &moving {
                for &j in &moving {
                    variance += diffuse.slopes[i][band] * errors.covariance[i][j] * diffuse.slopes[j][band];
                }
            }
            Some(variance.max(0.0).sqrt())
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alternating_residuals_count_each_and_smooth_ones_as_few() {
        let measured = [0.0; 400];
        let alternating: Vec<f64> = (0..400).map(|i| if i % 2 == 0 { 0.01 } else { -0.01 }).collect();
        let blocks: Vec<f64> = (0..400).map(|i| if (i / 20) % 2 == 0 { 0.01 } else { -0.01 }).collect();
        assert_eq!(scatter(&measured, &alternating, 400).n_effective, 400.0);
        let rho = 1.0 - 38.0 / 399.0;
        // 19 changes of sign among 399 pairs
        assert!((scatter(&measured, &blocks, 400).n_effective - 400.0 * (1.0 - rho) / (1.0 + rho)).abs() < 1e-9);
    }
}
