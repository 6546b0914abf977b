//! What a fit of one surface seeks, and what it takes as known.

use std::vec::Vec;

use leafbrdf_core::Normalization;

use super::model::{
    DIFFUSE_A, DIFFUSE_B, DIFFUSE_E, DiffuseKind, FacetKind, N, PARAMETERS, SIGMA, TILT_IN_PLANE, TILT_LATERAL,
};
use super::search::{Prior, ScanSize, Treatment};
use crate::FitError;
use crate::bounds::{BandBounds, Interval};

/// What is fitted, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// Distribution of facets, and masking.
    pub facets: FacetKind,
    /// Shape of the diffuse term.
    pub diffuse: DiffuseKind,
    /// The convention for K that n and σ belong to.
    pub normalization: Normalization,
    /// What becomes of n, σ, a, b, t_x, t_y (angles in radians). Where all directions lie in the plane of incidence, a free t_y
    /// is held at 0: they cannot see it.
    pub parameters: [Treatment<f64>; PARAMETERS],
    /// ν, how many independent residuals the measurement counts as where priors are weighed against it; without a number:
    /// directions − 1. All bands of a direction count as one, k_L takes one away.
    pub draws: Option<f64>,
    /// Huber's loss instead of squares: values farther than 1.345 scaled median absolute deviations count less.
    pub robust: bool,
    /// Stop where the predicted decrease is below this share of the cost.
    pub tolerance: f64,
    /// The most steps a search.
    pub max_iterations: u32,
    /// The grid of the scan.
    pub scan: ScanSize,
    /// The most valleys of the scan that are searched.
    pub valleys: usize,
    /// Starts of the caller's own, tried beside the scan's.
    pub starts: Vec<[f64; PARAMETERS]>,
}

impl Default for SurfaceOptions {
    /// [`paper`](Self::paper).
    fn default() -> Self {
        SurfaceOptions::paper()
    }
}

/// The tilt of a leaf before it is measured: 0° ± 3°, and no more than 10° (cross-validated on 33 leaves of a published
/// campaign).
const TILT_SD_DEG: f64 = 3.0;
const TILT_MOST_DEG: f64 = 10.0;

impl SurfaceOptions {
    /// The paper's surface: Beckmann, V-cavities, Lambert, K = 2π², n and σ within Table 3, the leaf level.
    pub fn paper() -> Self {
        let BandBounds { n, sigma, .. } = BandBounds::table_3();
        let mut parameters = [Treatment::Held(0.0); PARAMETERS];
        parameters[N] = Treatment::Free { bounds: n, prior: None };
        parameters[SIGMA] = Treatment::Free { bounds: sigma, prior: None };
        SurfaceOptions {
            facets: FacetKind::Beckmann,
            diffuse: DiffuseKind::Lambert,
            normalization: Normalization::Bousquet2005,
            parameters,
            draws: None,
            robust: false,
            tolerance: 1e-12,
            max_iterations: 100,
            scan: ScanSize::DEFAULT,
            valleys: 8,
            starts: Vec::new(),
        }
    }

    /// GGX facets with Smith's masking, normalised as derived ([`Normalization::CookTorrance`]).
    #[must_use]
    pub fn with_ggx(mut self) -> Self {
        self.facets = FacetKind::Ggx;
        self.normalization = Normalization::CookTorrance;
        self
    }

    /// Beckmann facets and V-cavities; the convention for K as printed.
    #[must_use]
    pub fn with_beckmann(mut self) -> Self {
        self.facets = FacetKind::Beckmann;
        self.normalization = Normalization::Bousquet2005;
        self
    }

    /// Lambert's diffuse term: no a, no b.
    #[must_use]
    pub fn with_lambert(mut self) -> Self {
        self.diffuse = DiffuseKind::Lambert;
        self.parameters[DIFFUSE_A] = Treatment::Held(0.0);
        self.parameters[DIFFUSE_B] = Treatment::Held(0.0);
        self.parameters[DIFFUSE_E] = Treatment::Held(0.0);
        self
    }

    /// The diffuse term P1, with priors a ~ N(0.15, 0.1) and b ~ N(0, 0.1): what 33 leaves of a published campaign have.
    #[must_use]
    pub fn with_p1(mut self) -> Self {
        let free = |mean| Treatment::Free { bounds: Interval::new(-0.9, 0.9), prior: Some(Prior { mean, sd: 0.1 }) };
        self.diffuse = DiffuseKind::P1;
        self.parameters[DIFFUSE_A] = free(0.15);
        self.parameters[DIFFUSE_B] = free(0.0);
        self.parameters[DIFFUSE_E] = Treatment::Held(0.0);
        self
    }

    /// The diffuse term P2: P1 with its priors, and e ~ N(0.1, 0.03).
    ///
    /// The prior of e is what the same 33 leaves have, in sample and where other views are predicted; it is narrow because
    /// e falls with θ_s and is in part the instrument's. The bounds keep every triple positive.
    #[must_use]
    pub fn with_p2(mut self) -> Self {
        let free = |mean, sd, most: f64| Treatment::Free {
            bounds: Interval::new(-most, most),
            prior: Some(Prior { mean, sd }),
        };
        self.diffuse = DiffuseKind::P2;
        self.parameters[DIFFUSE_A] = free(0.15, 0.1, 0.59);
        self.parameters[DIFFUSE_B] = free(0.0, 0.1, 0.59);
        self.parameters[DIFFUSE_E] = free(0.1, 0.03, 0.4);
        self
    }

    /// Both tilts of the leaf free, each N(0°, 3°) and within ±10°.
    #[must_use]
    pub fn with_tilt(mut self) -> Self {
        let most = TILT_MOST_DEG.to_radians();
        let prior = Some(Prior { mean: 0.0, sd: TILT_SD_DEG.to_radians() });
        for place in [TILT_IN_PLANE, TILT_LATERAL] {
            self.parameters[place] = Treatment::Free { bounds: Interval::new(-most, most), prior };
        }
        self
    }

    /// Are the bounds a box inside the model's domain? [`fit_surface`](super::fit_surface) asks before it starts.
    ///
    /// # Errors
    /// [`FitError::Bounds`].
    pub fn check(&self) -> Result<(), FitError> {
        let limits: [(f64, f64, &str, &str); PARAMETERS] = [
            (1.0001, 100.0, "n", "1.0001 ≤ lower < upper ≤ 100"),
            (1e-4, 10.0, "sigma", "1e-4 ≤ lower < upper ≤ 10"),
            (-0.99, 0.99, "p1_a", "-0.99 ≤ lower < upper ≤ 0.99"),
            (-0.99, 0.99, "p1_b", "-0.99 ≤ lower < upper ≤ 0.99"),
            (-0.8, 0.8, "tilt_in_plane", "within ±0.8 rad"),
            (-0.8, 0.8, "tilt_lateral", "within ±0.8 rad"),
            (-0.99, 0.99, "p2_e", "-0.99 ≤ lower < upper ≤ 0.99"),
        ];
        for (one, (least, most, parameter, expected)) in self.parameters.iter().zip(limits) {
            let fine = match *one {
                Treatment::Held(value) => value >= least.min(1.0) && value <= most,
                Treatment::Free { bounds, prior } => {
                    bounds.lower >= least
                        && bounds.upper <= most
                        && bounds.lower < bounds.upper
                        && prior.is_none_or(|prior| prior.sd > 0.0 && prior.mean.is_finite())
                }
            };
            if !fine {
                return Err(FitError::Bounds { parameter, expected });
            }
        }
        Ok(())
    }
}
