//! One wavelength: min over k_L, n, σ of χ² = Σ ω (BRDF_measured − k_L/π − BRDF_spec)² (Eq. 11).
//!
//! k_L enters linearly and is eliminated exactly, bounds included. What is left is a function of (ln F₀, ln σ), F₀ = F at normal
//! incidence: in these two the valley of a lobe that is seen from its flank is straight. Its global minimum comes from a coarse scan of the whole box
//! ([`scan`]), every valley of which starts a Newton search with exact second derivatives (`profile.rs`).

pub(crate) mod profile;
mod report;
pub mod scan;
mod solve;

use leafbrdf_core::{DirectionTerms, Real};

use crate::FitError;

#[cfg(feature = "std")]
pub(crate) use report::covariance;
pub use report::{BandFit, Identifiability, Noise, Valley};
pub use solve::{BandOptions, BandSolver, Start, Weights};

/// What all bands share: the direction terms as three slices of one length, and nothing that depends on the wavelength.
///
/// The number of directions must be a multiple of the solver's lane count; fill up with [`PADDING`](Self::padding) and give
/// those places weight 0 in every [`Band`].
#[derive(Clone, Copy, Debug)]
pub struct Directions<'a, T> {
    /// cos θ_a.
    pub cos_theta_a: &'a [T],
    /// tan²α.
    pub tan2_alpha: &'a [T],
    /// G/(K/π cosθ_s cosθ_v).
    pub weight: &'a [T],
}

impl<T: Real> Directions<'_, T> {
    /// A direction that contributes nothing, to fill up with.
    pub fn padding() -> DirectionTerms<T> {
        DirectionTerms { cos_theta_a: T::ONE, tan2_alpha: T::ZERO, weight: T::ZERO }
    }

    /// The number of directions, padding included.
    pub fn len(&self) -> usize {
        self.cos_theta_a.len()
    }

    /// No direction at all.
    pub fn is_empty(&self) -> bool {
        self.cos_theta_a.is_empty()
    }

    pub(crate) fn check(&self, lanes: usize) -> Result<(), FitError> {
        let expected = self.len().next_multiple_of(lanes.max(1));
        for (what, slice) in
            [("cos_theta_a", self.cos_theta_a), ("tan2_alpha", self.tan2_alpha), ("weight", self.weight)]
        {
            if slice.len() != expected {
                return Err(FitError::Length { what, found: slice.len(), expected });
            }
            if let Some(index) = slice.iter().position(|x| !x.is_finite()) {
                return Err(FitError::NotFinite { what, index });
            }
        }
        Ok(())
    }
}

/// The measurements of one wavelength: one value and one weight a direction.
#[derive(Clone, Copy, Debug)]
pub struct Band<'a, T> {
    /// BRDF in sr⁻¹; any finite number where the weight is 0.
    pub brdf: &'a [T],
    /// ω = 1/sd² in sr², or 1 for every value that counts; 0 for missing values and padding.
    pub weight: &'a [T],
}

impl<T: Real> Band<'_, T> {
    pub(crate) fn check(&self, directions: usize) -> Result<(), FitError> {
        for (what, slice) in [("brdf", self.brdf), ("weight", self.weight)] {
            if slice.len() != directions {
                return Err(FitError::Length { what, found: slice.len(), expected: directions });
            }
            if let Some(index) = slice.iter().position(|x| !x.is_finite()) {
                return Err(FitError::NotFinite { what, index });
            }
        }
        if let Some(index) = self.weight.iter().position(|w| *w < T::ZERO) {
            return Err(FitError::NotFinite { what: "weight (negative)", index });
        }
        Ok(())
    }
}
