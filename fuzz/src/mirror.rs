//! The perfect mirror: reflects everything, whatever the angle.

use std::cell::Cell;

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

/// F ≡ 1, counting how often it is asked for.
#[derive(Clone, Copy)]
pub(crate) struct Counting<'a> {
    pub calls: &'a Cell<usize>,
}

impl<T: Real> Index<T> for Counting<'_> {
    fn fresnel(self, cos_theta_a: T) -> T {
        self.calls.set(self.calls.get() + 1);
        Mirror.fresnel(cos_theta_a)
    }

    fn fresnel_with_slope(self, cos_theta_a: T) -> (T, T) {
        self.calls.set(self.calls.get() + 1);
        Mirror.fresnel_with_slope(cos_theta_a)
    }
}
