//! DHRF_spec of GGX facets with Smith's masking, by nodes of their own.

use super::ggx_walk::{GgxNode, GgxRule, walk};
use super::grade::{E4d, E6, E8, E10};
use super::slopes::SlopePlane;
use super::{DhrfGradient, Grade, Illumination};
use crate::{Index, Real};

impl<T: Real> Illumination<T> {
    /// DHRF_spec of a GGX–Smith surface under K = 4π, unitless, in [0, 1].
    ///
    /// Arguments as for [`dhrf`](Self::dhrf), accuracy and cost: see [`Grade`].
    ///
    /// ```
    /// use leafbrdf_core::{Angle, Dielectric, Grade, Illumination};
    /// // the tail keeps less of the light in one reflection than a Gaussian of the same σ does
    /// let zenith = Illumination::new(Angle::from_degrees(0.0_f64))?;
    /// let ggx = zenith.dhrf_ggx(Dielectric::new(1.5)?, 0.5, Grade::E10);
    /// let beckmann = zenith.dhrf(Dielectric::new(1.5)?, 0.5, Grade::E10);
    /// assert!((ggx - 0.0282).abs() < 1e-4 && (beckmann - 0.0366).abs() < 1e-3);
    /// # Ok::<(), leafbrdf_core::DomainError>(())
    /// ```
    #[inline]
    pub fn dhrf_ggx<I: Index<T>>(&self, index: I, sigma: T, grade: Grade) -> T {
        let sum = match grade {
            Grade::E4d => value::<T, I, E4d>(&self.plane, index, sigma),
            Grade::E6 => value::<T, I, E6>(&self.plane, index, sigma),
            Grade::E8 => value::<T, I, E8>(&self.plane, index, sigma),
            Grade::E10 => value::<T, I, E10>(&self.plane, index, sigma),
        };
        // DHRF ≤ 1 exactly (energy, F ≤ 1): the minimum takes away the excess that is quadrature error
        sum.min(T::ONE)
    }

    /// The same with its derivatives with respect to n and σ, from the same nodes: the derivatives of the integral.
    #[inline]
    pub fn dhrf_ggx_with_gradient<I: Index<T>>(&self, index: I, sigma: T, grade: Grade) -> DhrfGradient<T> {
        let sums = match grade {
            Grade::E4d => gradient::<T, I, E4d>(&self.plane, index, sigma),
            Grade::E6 => gradient::<T, I, E6>(&self.plane, index, sigma),
            Grade::E8 => gradient::<T, I, E8>(&self.plane, index, sigma),
            Grade::E10 => gradient::<T, I, E10>(&self.plane, index, sigma),
        };
        DhrfGradient { value: sums.value.min(T::ONE), ..sums }
    }

    /// How often the Fresnel factor is evaluated for this σ by [`dhrf_ggx`](Self::dhrf_ggx), whatever the index.
    #[inline]
    pub fn evaluations_ggx(&self, sigma: T, grade: Grade) -> usize {
        match grade {
            Grade::E4d => count::<T, E4d>(&self.plane, sigma),
            Grade::E6 => count::<T, E6>(&self.plane, sigma),
            Grade::E8 => count::<T, E8>(&self.plane, sigma),
            Grade::E10 => count::<T, E10>(&self.plane, sigma),
        }
    }
}

fn value<T: Real, I: Index<T>, R: GgxRule>(plane: &SlopePlane<T>, index: I, sigma: T) -> T {
    let mut sum = T::ZERO;
    walk::<T, R>(plane, sigma, |node| sum += node.weight * index.fresnel(node.cos_theta_a));
    sum
}

fn gradient<T: Real, I: Index<T>, R: GgxRule>(plane: &SlopePlane<T>, index: I, sigma: T) -> DhrfGradient<T> {
    let (mut sum, mut sum_n, mut sum_sigma) = (T::ZERO, T::ZERO, T::ZERO);
    walk::<T, R>(plane, sigma, |GgxNode { cos_theta_a, weight, log_slope }| {
        let (f, f_n) = index.fresnel_with_slope(cos_theta_a);
        let weighted = weight * f;
        sum += weighted;
        sum_n += weight * f_n;
        sum_sigma += weighted * log_slope;
    });
    DhrfGradient { value: sum, d_n: sum_n, d_sigma: sum_sigma / sigma }
}

fn count<T: Real, R: GgxRule>(plane: &SlopePlane<T>, sigma: T) -> usize {
    let mut nodes = 0;
    walk::<T, R>(plane, sigma, |_| nodes += 1);
    nodes
}
