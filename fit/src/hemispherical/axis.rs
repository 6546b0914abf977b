//! A parameter between its bounds as a number x in [0, 1].
//!
//! Contents act through K = Σ C_i k_i/N, and the answer to more of the same fades: R and T are nearly straight in ln(C₀ + C), C₀ being
//! where an ordinary leaf begins to be dark. The same holds for N. With every x in [0, 1], one measure of damping suits all.

use leafbrdf_core::Real;
use leafbrdf_prospect::Parameter;

use super::Free;
use crate::bounds::Interval;

/// x = (ln(C + C₀) − ln(C_lower + C₀))/width.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis<T> {
    bounds: Interval<T>,
    origin: T,
    first: T,
    width: T,
}

impl<T: Real> Axis<T> {
    pub fn new(free: &Free<T>) -> Self {
        let bounds = free.bounds;
        let origin = T::lit(match free.parameter {
            Parameter::NStruct => 0.0,
            // a fifth of what most leaves stay below
            other => 0.2 * other.typical().1,
        });
        let first = (bounds.lower + origin).ln();
        Axis { bounds, origin, first, width: (bounds.upper + origin).ln() - first }
    }

    /// The parameter at x, and dC/dx.
    pub fn value_and_slope(&self, x: T) -> (T, T) {
        let shifted = (self.first + x * self.width).exp();
        (self.at(x, shifted), self.width * shifted)
    }

    /// The parameter at x; the bounds themselves at 0 and 1.
    pub fn value(&self, x: T) -> T {
        self.at(x, (self.first + x * self.width).exp())
    }

    fn at(&self, x: T, shifted: T) -> T {
        if x <= T::ZERO {
            self.bounds.lower
        } else if x >= T::ONE {
            self.bounds.upper
        } else {
            // the clip absorbs rounding only
            self.bounds.clip(shifted - self.origin)
        }
    }

    /// x of a parameter; of the nearest bound where it lies outside.
    pub fn place(&self, value: T) -> T {
        ((self.bounds.clip(value) + self.origin).ln() - self.first) / self.width
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_comes_back_from_its_axis() {
        for parameter in Parameter::ALL {
            let free = Free::<f64>::new(parameter);
            let axis = Axis::new(&free);
            assert_eq!(axis.value(0.0), free.bounds.lower);
            assert_eq!(axis.value(1.0), free.bounds.upper);
            for share in [0.01, 0.2, 0.7, 0.99] {
                let value = free.bounds.lower + share * free.bounds.width();
                // a few roundings of exp and ln of numbers up to 5
                assert!((axis.value(axis.place(value)) / value - 1.0).abs() < 1e-12, "{parameter:?}");
            }
        }
    }

    #[test]
    fn the_slope_is_that_of_the_value() {
        let axis = Axis::new(&Free::<f64>::new(Parameter::Cab));
        for x in [0.1, 0.5, 0.9] {
            let h = 1e-5;
            let difference = (axis.value(x + h) - axis.value(x - h)) / (2.0 * h);
            // central difference: h² times a third derivative of order 1
            assert!((axis.value_and_slope(x).1 / difference - 1.0).abs() < 1e-8);
        }
    }
}
