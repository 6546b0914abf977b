//! The box that a parameter must stay in.

use leafbrdf_core::Real;

use crate::FitError;

/// A closed interval: lower ≤ x ≤ upper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<T> {
    /// Lower bound.
    pub lower: T,
    /// Upper bound.
    pub upper: T,
}

impl<T: Real> Interval<T> {
    /// lower ≤ x ≤ upper; checked when a solver takes it.
    pub const fn new(lower: T, upper: T) -> Self {
        Interval { lower, upper }
    }

    /// x, or the bound it lies beyond.
    #[inline(always)]
    pub(crate) fn clip(self, x: T) -> T {
        x.max(self.lower).min(self.upper)
    }

    /// upper − lower.
    #[inline(always)]
    pub(crate) fn width(self) -> T {
        self.upper - self.lower
    }

    /// `least` ≤ lower < upper ≤ `most`. One copy on a device, where flash counts.
    #[cfg_attr(not(feature = "std"), inline(never))]
    fn is_inside(self, least: T, most: T) -> bool {
        self.lower >= least && self.upper <= most && self.lower < self.upper
    }

    /// The point of the interior nearest to x, at least `margin` of the width away from either bound.
    #[inline(always)]
    pub(crate) fn inside(self, x: T, margin: T) -> T {
        let step = margin * self.width();
        Interval { lower: self.lower + step, upper: self.upper - step }.clip(x)
    }
}

/// Which bound a fitted parameter sits at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum AtBound {
    /// Strictly inside: the bound had no part in the result.
    #[default]
    Free,
    /// At the lower bound, and the data ask for less.
    Lower,
    /// At the upper bound, and the data ask for more.
    Upper,
}

/// Bounds of the three parameters of a band (Table 3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandBounds<T> {
    /// Lambert coefficient k_L, unitless.
    pub k_lambert: Interval<T>,
    /// Refractive index n, unitless.
    pub n: Interval<T>,
    /// Roughness σ, unitless.
    pub sigma: Interval<T>,
}

impl<T: Real> BandBounds<T> {
    /// Table 3: k_L in [0.01, 0.99], n in [1.1, 5], σ in [0.01, 1].
    pub fn table_3() -> Self {
        BandBounds {
            k_lambert: Interval::new(T::lit(0.01), T::lit(0.99)),
            n: Interval::new(T::lit(1.1), T::lit(5.0)),
            sigma: Interval::new(T::lit(0.01), T::ONE),
        }
    }

    /// Are these bounds a box inside the model's domain? The solvers ask before they start.
    ///
    /// # Errors
    /// [`FitError::Bounds`] unless −1 ≤ k_L ≤ 2, 1 < n ≤ 100, 10⁻⁴ ≤ σ ≤ 10, each with lower < upper.
    pub fn check(&self) -> Result<(), FitError> {
        let ordered = |name, expected, interval: Interval<T>, least: T, most: T| {
            if interval.is_inside(least, most) { Ok(()) } else { Err(FitError::Bounds { parameter: name, expected }) }
        };
        ordered("k_l", "-1 ≤ lower < upper ≤ 2", self.k_lambert, -T::ONE, T::TWO)?;
        ordered("n", "1.0001 ≤ lower < upper ≤ 100", self.n, T::lit(1.0001) - T::EPSILON, T::lit(100.0))?;
        ordered("sigma", "1e-4 ≤ lower < upper ≤ 10", self.sigma, T::lit(1e-4), T::lit(10.0))
    }
}
