//! The perfect mirror: reflects everything, whatever the angle.

use leafbrdf_core::{Index, Real};

/// F ≡ 1.
#[derive(Clone, Copy)]
pub(crate) struct Mirror;

impl<T: Real> Index<T> for Mirror {
    fn fresnel(self, _: T) -> T {
        T::ONE
    }

    fn fresnel_with_slope(self, _: T) -> (T, T) {
        (T::ONE, T::ZERO)
    }
}
