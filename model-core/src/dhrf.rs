//! DHRF_spec: the share of the light that the surface sends back into the whole hemisphere (Eqs 12–14), by a quadrature on
//! fixed nodes.
//!
//! ```text
//! DHRF_spec(θ_s; n, σ) = ∫∫ BRDF_spec cosθ_v sinθ_v dθ_v dφ_v
//!                      = 1/(π σ²) ∬ F(n, cosθ_a) W exp(−(x² + y²)/σ²) dx dy      (K = 4π)
//! ```
//!
//! over the slopes x, y of the facets (`slopes.rs`). The masking makes kinks in W, whose places are known in closed form
//! and depend on θ_s alone; between them every factor is smooth, so Gauss rules converge exponentially. Nodes and weights
//! are a function of θ_s and σ only, never of n: no error estimate, no loop of unknown length.
//!
//! Everything here is for K = 4π ([`Normalization::CookTorrance`](crate::Normalization)); the convention of Eq. 10 as
//! printed is a factor 2/π smaller. Facets are Beckmann's, masking is Eq. 7; GGX–Smith has nodes of its own (`ggx_walk.rs`).

use crate::real::device::F32;
use crate::{Angle, Beckmann, DomainError, Ggx, Index, Real, Smith, VCavity};

mod ggx;
mod ggx_grade;
mod ggx_walk;
mod grade;
mod nodes;
mod slopes;
mod table;
mod walk;

use grade::Rule;
use slopes::SlopePlane;
use walk::{Node, walk};

/// How accurately, and at which cost, the hemispherical integral is taken.
///
/// Largest error among 20,000 scattered points for n from 1.1 to 5, σ from 0.01 to 1, θ_s up to 89°, one index in four
/// complex with κ up to 5. Relative for the value; absolute for the logarithmic derivatives (n/D) ∂D/∂n and (σ/D) ∂D/∂σ.
/// Evaluations are those of the Fresnel factor, mean over the same points.
///
/// | grade | `f64` | median | ∂n | ∂σ | `f32` | ∂n | ∂σ | evaluations, at most | mean |
/// |---|---|---|---|---|---|---|---|---|---|
/// | E4d | 1.0e-5 | 6e-7 | 1.1e-4 | 5.5e-5 | 1.1e-5 | 1.1e-4 | 5.6e-5 | 180 | 122 |
/// | E6 | 8.5e-7 | 1e-7 | 7.3e-6 | 1.3e-5 | 2.1e-6 | 2.4e-5 | 1.3e-5 | 270 | 195 |
/// | E8 | 7.3e-9 | 2e-9 | 9.0e-8 | 2.0e-7 | 2.1e-6 | 2.5e-5 | 2.4e-6 | 590 | 405 |
/// | E10 | 5.2e-11 | 3e-12 | 1.2e-10 | 6.8e-10 | 3.0e-6 | 3.5e-5 | 2.2e-6 | 1130 | 792 |
///
/// | elsewhere: `f64` value | E4d | E6 | E8 | E10 |
/// |---|---|---|---|---|
/// | θ_s from 89° to 89.9° | 2.5e-5 | 1.2e-6 | 1.1e-8 | 9.0e-11 |
/// | σ from 0.005 to 0.01 | 1.0e-6 | 3.3e-7 | 4.0e-9 | 6.7e-11 |
/// | σ from 1 to 2 (evaluations: 180, 430, 870, 1670) | 8.2e-5 | 2.1e-6 | 1.0e-8 | 6.7e-11 |
/// | n from 1.001 to 1.1 | 7.0e-5 | 3.8e-6 | 1.3e-8 | 8.0e-11 |
/// | complex index, independent values (metals too) | 1.1e-5 | 7.1e-7 | 6.1e-9 | 5.1e-11 |
///
/// A complex index costs no accuracy. In `f32` nothing beyond E6 is worth its cost. On a smooth surface a Gauss–Hermite rule
/// serves: 8, 15, 18 or 28 evaluations where σ < min(tan(30° − θ_s/3), cot θ_s) divided by 3.3, 3.6, 4.2 or 4.7 (at normal
/// incidence, σ < 0.17 for E4d).
///
/// Where the number of nodes changes with σ or θ_s the value makes a step: at most 5.5e-6 (E4d), 5.8e-7 (E6), 4.1e-9 (E8) of
/// itself, n = 1.5. The gradient is that of the integral and knows nothing of the steps. Outside these regions the value stays
/// finite and within [0, 1], but no accuracy is promised; towards n = 1 the *relative* error of ∂/∂n grows (8e-2 for E4d below
/// 1.1), for the value itself vanishes there.
///
/// GGX facets with Smith's masking have nodes of their own. The same measurements; n from 1.05 keeps the first columns too.
///
/// | GGX | `f64` | median | ∂n | ∂σ | `f32` | ∂n | ∂σ | evaluations, at most | mean |
/// |---|---|---|---|---|---|---|---|---|---|
/// | E4d | 1.0e-5 | 5e-7 | 1.1e-4 | 9.9e-5 | 1.0e-5 | 1.1e-4 | 9.8e-5 | 163 | 117 |
/// | E6 | 7.8e-7 | 3e-8 | 8.3e-6 | 6.3e-6 | 1.4e-6 | 2.2e-5 | 6.2e-6 | 249 | 188 |
/// | E8 | 6.6e-9 | 1e-10 | 1.0e-7 | 5.3e-8 | 2.5e-6 | 2.7e-5 | 2.4e-6 | 485 | 401 |
/// | E10 | 8.0e-11 | 7e-13 | < 2e-9 | < 2e-9 | 3.7e-6 | 3.7e-5 | 2.7e-6 | 993 | 827 |
///
/// | GGX elsewhere: `f64` value | E4d | E6 | E8 |
/// |---|---|---|---|
/// | θ_s from 89° to 89.9° (evaluations: 184, 289, 540, 1079) | 1.1e-5 | 9.7e-7 | 6.4e-9 |
/// | σ from 0.005 to 0.01 | 2.5e-5 | 8.1e-6 | 6.7e-9 |
/// | σ from 1 to 2 (evaluations: 255, 412, 790, 1580) | 4.8e-5 | 5.7e-6 | 7.4e-8 |
/// | n from 1.001 to 1.1 | 3.5e-4 | 1.2e-4 | 1.2e-6 |
///
/// E10's errors there are those against `tests/golden/ggx_dhrf_reference.csv`. Largest step in σ: 5.7e-6, 8.2e-7, 4.9e-9.
///
/// E4d, E6 and E8 are compared with E10; E10 with a reference of 20 times its nodes and with the golden files. All but
/// E10's own errors are printed by `examples/dhrf_accuracy.rs`, bounds are kept by `tests/dhrf.rs`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Grade {
    /// For devices and for fits: 2·10⁻⁵, gradients included 3·10⁻⁴, with at most 180 evaluations of F for any θ_s and σ.
    E4d,
    /// 10⁻⁶, with at most 270 evaluations for σ ≤ 1.
    E6,
    /// 10⁻⁸, with at most 590.
    E8,
    /// 10⁻¹⁰, with at most 1130: for reference values.
    #[default]
    E10,
}

impl Grade {
    /// Every grade, the cheapest first.
    pub const ALL: [Grade; 4] = [Grade::E4d, Grade::E6, Grade::E8, Grade::E10];
}

/// DHRF_spec and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DhrfGradient<T> {
    /// DHRF_spec, unitless.
    pub value: T,
    /// ∂DHRF_spec/∂n.
    pub d_n: T,
    /// ∂DHRF_spec/∂σ.
    pub d_sigma: T,
}

/// Facets and masking whose hemispherical integral has a rule: what [`Surface::dhrf`](crate::Surface::dhrf) needs of them.
pub trait Hemispherical<T: Real> {
    /// DHRF_spec under K = 4π, unitless.
    fn dhrf<I: Index<T>>(source: &Illumination<T>, index: I, sigma: T, grade: Grade) -> T;

    /// The same with its derivatives.
    fn dhrf_with_gradient<I: Index<T>>(source: &Illumination<T>, index: I, sigma: T, grade: Grade) -> DhrfGradient<T>;

    /// How often the Fresnel factor is evaluated.
    fn evaluations(source: &Illumination<T>, sigma: T, grade: Grade) -> usize;
}

impl<T: Real> Hemispherical<T> for (Beckmann, VCavity) {
    #[inline]
    fn dhrf<I: Index<T>>(source: &Illumination<T>, index: I, sigma: T, grade: Grade) -> T {
        source.dhrf(index, sigma, grade)
    }

    #[inline]
    fn dhrf_with_gradient<I: Index<T>>(source: &Illumination<T>, index: I, sigma: T, grade: Grade) -> DhrfGradient<T> {
        source.dhrf_with_gradient(index, sigma, grade)
    }

    #[inline]
    fn evaluations(source: &Illumination<T>, sigma: T, grade: Grade) -> usize {
        source.evaluations(sigma, grade)
    }
}

impl<T: Real> Hemispherical<T> for (Ggx, Smith) {
    #[inline]
    fn dhrf<I: Index<T>>(source: &Illumination<T>, index: I, sigma: T, grade: Grade) -> T {
        source.dhrf_ggx(index, sigma, grade)
    }

    #[inline]
    fn dhrf_with_gradient<I: Index<T>>(source: &Illumination<T>, index: I, sigma: T, grade: Grade) -> DhrfGradient<T> {
        source.dhrf_ggx_with_gradient(index, sigma, grade)
    }

    #[inline]
    fn evaluations(source: &Illumination<T>, sigma: T, grade: Grade) -> usize {
        source.evaluations_ggx(sigma, grade)
    }
}

/// An illumination direction, prepared for hemispherical integrals: all that does not depend on the leaf.
///
/// ```
/// use leafbrdf_core::{Angle, Dielectric, Grade, Illumination};
/// // A smooth surface reflects like a mirror: at normal incidence ((n − 1)/(n + 1))², 4 % for n = 1.5.
/// let zenith = Illumination::new(Angle::from_degrees(0.0_f64))?;
/// let smooth = zenith.dhrf(Dielectric::new(1.5)?, 0.01, Grade::E10);
/// assert!((smooth - 0.04).abs() < 1e-6);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Illumination<T> {
    plane: SlopePlane<T>,
}

impl<T: Real> Illumination<T> {
    /// From the illumination zenith angle θ_s.
    ///
    /// # Errors
    /// [`DomainError`] unless 0° ≤ θ_s < 90°. The stated accuracy holds up to 89.9°.
    pub fn new(theta_s: Angle<T>) -> Result<Self, DomainError> {
        Ok(Illumination { plane: SlopePlane::new(theta_s)? })
    }

    /// DHRF_spec under K = 4π, unitless, in [0, 1].
    ///
    /// - `index`: n, or n + iκ; checked by its constructor.
    /// - `sigma`: roughness, unitless, in [2⁻³⁰, 2¹⁰]; checked by [`Surface::new`](crate::Surface::new), not here.
    ///
    /// Accuracy and cost: see [`Grade`].
    #[inline]
    pub fn dhrf<I: Index<T>>(&self, index: I, sigma: T, grade: Grade) -> T {
        let sum = match grade {
            Grade::E4d => value::<T, I, grade::E4d>(&self.plane, index, sigma),
            Grade::E6 => value::<T, I, grade::E6>(&self.plane, index, sigma),
            Grade::E8 => value::<T, I, grade::E8>(&self.plane, index, sigma),
            Grade::E10 => value::<T, I, grade::E10>(&self.plane, index, sigma),
        };
        // DHRF ≤ 1 exactly (energy, F ≤ 1): the minimum takes away the excess that is quadrature error
        sum.min(T::ONE)
    }

    /// DHRF_spec and its derivatives with respect to n and σ, from the same nodes: the derivatives of the integral, exact up
    /// to the quadrature's error, which [`Grade`] states.
    ///
    /// Arguments as for [`dhrf`](Self::dhrf), which returns the same value to the last bit.
    #[inline]
    pub fn dhrf_with_gradient<I: Index<T>>(&self, index: I, sigma: T, grade: Grade) -> DhrfGradient<T> {
        let sums = match grade {
            Grade::E4d => gradient::<T, I, grade::E4d>(&self.plane, index, sigma),
            Grade::E6 => gradient::<T, I, grade::E6>(&self.plane, index, sigma),
            Grade::E8 => gradient::<T, I, grade::E8>(&self.plane, index, sigma),
            Grade::E10 => gradient::<T, I, grade::E10>(&self.plane, index, sigma),
        };
        DhrfGradient { value: sums.value.min(T::ONE), ..sums }
    }

    /// How often the Fresnel factor is evaluated for this σ: a function of θ_s, σ and the grade, whatever the index.
    #[inline]
    pub fn evaluations(&self, sigma: T, grade: Grade) -> usize {
        match grade {
            Grade::E4d => count::<T, grade::E4d>(&self.plane, sigma),
            Grade::E6 => count::<T, grade::E6>(&self.plane, sigma),
            Grade::E8 => count::<T, grade::E8>(&self.plane, sigma),
            Grade::E10 => count::<T, grade::E10>(&self.plane, sigma),
        }
    }
}

impl Illumination<F32> {
    /// From the illumination zenith angle in degrees, in integers until the last step: less than half of the cost of
    /// [`new`](Self::new), and the same value up to rounding.
    ///
    /// # Errors
    /// [`DomainError`] unless 0 ≤ θ_s < 90. The stated accuracy holds up to 89.9°.
    ///
    /// ```
    /// use leafbrdf_core::{Grade, Illumination, Surface, real::device::F32};
    /// // beech (Table 4) at 60°, as in the paper's convention
    /// let sun = Illumination::from_degrees(F32(60.0))?;
    /// let beech = Surface::new(F32(1.56), F32(0.29))?;
    /// assert!((beech.dhrf(&sun, Grade::E4d).0 - 0.0551).abs() < 1e-4);
    /// # Ok::<(), leafbrdf_core::DomainError>(())
    /// ```
    #[inline]
    pub fn from_degrees(theta_s: F32) -> Result<Self, DomainError> {
        Ok(Illumination { plane: SlopePlane::from_degrees(theta_s)? })
    }
}

fn value<T: Real, I: Index<T>, R: Rule>(plane: &SlopePlane<T>, index: I, sigma: T) -> T {
    let mut sum = T::ZERO;
    walk::<T, R>(plane, sigma, |node| sum += node.weight * index.fresnel(node.cos_theta_a));
    sum
}

fn gradient<T: Real, I: Index<T>, R: Rule>(plane: &SlopePlane<T>, index: I, sigma: T) -> DhrfGradient<T> {
    let (mut sum, mut sum_n, mut sum_sigma) = (T::ZERO, T::ZERO, T::ZERO);
    walk::<T, R>(plane, sigma, |Node { cos_theta_a, weight, scaled_slope2 }| {
        let (f, f_n) = index.fresnel_with_slope(cos_theta_a);
        let weighted = weight * f;
        sum += weighted;
        sum_n += weight * f_n;
        // ∂/∂σ of exp(−tan²α/σ²)/σ² is (tan²α/σ² − 1) · 2/σ of it; the domain and its kinks do not move with σ
        sum_sigma += weighted * (scaled_slope2 - T::ONE);
    });
    DhrfGradient { value: sum, d_n: sum_n, d_sigma: T::TWO * sum_sigma / sigma }
}

fn count<T: Real, R: Rule>(plane: &SlopePlane<T>, sigma: T) -> usize {
    let mut nodes = 0;
    walk::<T, R>(plane, sigma, |_| nodes += 1);
    nodes
}
