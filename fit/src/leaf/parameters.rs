//! The leaf's parameters in one list, and the coordinates in which they are sought.

use leafbrdf_prospect::Parameter;

use crate::band::profile::{f0_from_n, n_from_f0};
use crate::bounds::Interval;
use crate::surface::model;

/// How many parameters a leaf has: seven of its surface, nine of its interior, gain and offset.
pub const COUNT: usize = 18;

/// Where the interior's parameters begin, in the order of [`Parameter::ALL`].
pub(super) const INTERIOR: usize = model::PARAMETERS;
/// The place of g.
pub const GAIN: usize = 16;
/// The place of b.
pub const OFFSET: usize = 17;

/// The place of an interior parameter.
pub const fn place(parameter: Parameter) -> usize {
    INTERIOR + parameter as usize
}

/// The interior's parameter at a place; `None` for those of the surface and of the coupling.
pub fn interior(place: usize) -> Option<Parameter> {
    Parameter::ALL.get(place.checked_sub(INTERIOR)?).copied()
}

/// Names in files, in the order of the list; tilts in degrees there.
pub const NAMES: [&str; COUNT] = [
    "n",
    "sigma",
    "p1_a",
    "p1_b",
    "tilt_in_plane_deg",
    "tilt_lateral_deg",
    "p2_e",
    "n_struct",
    "cab",
    "car",
    "cant",
    "cbrown",
    "cw",
    "cm",
    "prot",
    "cbc",
    "gain",
    "offset",
];

/// What is known of a parameter before the measurement: a normal distribution of it, or of its logarithm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// The centre, in the parameter's own unit.
    pub centre: f64,
    /// Standard deviation, > 0: of ln x where `log`, else of x.
    pub sd: f64,
    /// Of the logarithm?
    pub log: bool,
}

impl Prior {
    /// ln x ~ N(ln `centre`, `sd`).
    pub const fn log(centre: f64, sd: f64) -> Self {
        Prior { centre, sd, log: true }
    }

    /// x ~ N(`centre`, `sd`).
    pub const fn plain(centre: f64, sd: f64) -> Self {
        Prior { centre, sd, log: false }
    }

    /// (x − centre)/sd, or with logarithms, and its slope by x.
    pub(super) fn misfit(&self, x: f64) -> (f64, f64) {
        if self.log {
            ((x / self.centre).ln() / self.sd, 1.0 / (x * self.sd))
        } else {
            ((x - self.centre) / self.sd, 1.0 / self.sd)
        }
    }
}

/// What becomes of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Treatment {
    /// Held at a value.
    Held(f64),
    /// Sought.
    Free {
        /// Within these bounds, in the parameter's unit.
        bounds: Interval<f64>,
        /// What is known beforehand.
        prior: Option<Prior>,
    },
}

impl Treatment {
    /// Sought within bounds of the caller's, with a prior; a logarithm has no place for 0.
    pub(super) fn within(place: usize, bounds: Interval<f64>, prior: Option<Prior>) -> Self {
        let lowest = match (prior, interior(place)) {
            (Some(Prior { log: true, .. }), Some(parameter)) => 1e-5 * parameter.typical().1,
            _ => f64::NEG_INFINITY,
        };
        Treatment::Free { bounds: Interval::new(bounds.lower.max(lowest), bounds.upper), prior }
    }

    /// Is it sought?
    pub const fn is_free(&self) -> bool {
        matches!(self, Treatment::Free { .. })
    }

    /// The prior of a free parameter.
    pub const fn prior(&self) -> Option<Prior> {
        match self {
            Treatment::Free { prior, .. } => *prior,
            Treatment::Held(_) => None,
        }
    }
}

/// The coordinate u of a parameter x, in which its cost is nearly a parabola.
#[derive(Clone, Copy, Debug)]
pub(super) enum Axis {
    /// Held: u is not looked at.
    Held(f64),
    /// u = x.
    Plain(Interval<f64>),
    /// u = ln x.
    Log(Interval<f64>),
    /// u = ln F₀(n).
    Fresnel(Interval<f64>),
    /// u = ln(x + x₀): contents, whose effect fades as they grow, down to 0.
    Shifted(Interval<f64>, f64),
}

impl Axis {
    pub fn new(place: usize, treatment: &Treatment) -> Axis {
        let (bounds, prior) = match *treatment {
            Treatment::Held(value) => return Axis::Held(value),
            Treatment::Free { bounds, prior } => (bounds, prior),
        };
        match place {
            // below 1 it is a coefficient on the tabulated index
            model::N if bounds.lower > 1.0 => Axis::Fresnel(bounds),
            model::N | model::SIGMA | GAIN => Axis::Log(bounds),
            _ => match interior(place) {
                Some(Parameter::NStruct) => Axis::Log(bounds),
                // a logarithmic prior has no place for 0
                Some(_) if prior.is_some_and(|prior| prior.log) => Axis::Log(bounds),
                Some(content) => Axis::Shifted(bounds, 0.2 * content.typical().1),
                None => Axis::Plain(bounds),
            },
        }
    }

    /// The coordinate of a value, moved inside the bounds.
    pub fn coordinate(&self, x: f64) -> f64 {
        match *self {
            Axis::Held(_) => 0.0,
            Axis::Plain(bounds) => bounds.clip(x),
            Axis::Log(bounds) => bounds.clip(x).ln(),
            Axis::Fresnel(bounds) => f0_from_n(bounds.clip(x)).ln(),
            Axis::Shifted(bounds, origin) => (bounds.clip(x) + origin).ln(),
        }
    }

    /// x and dx/du; the bounds themselves at the bounds of u.
    pub fn value(&self, u: f64) -> (f64, f64) {
        let (x, slope) = match *self {
            Axis::Held(value) => return (value, 0.0),
            Axis::Plain(_) => (u, 1.0),
            Axis::Log(_) => (u.exp(), u.exp()),
            Axis::Fresnel(_) => {
                let f0 = u.exp();
                let [n, slope, _] = n_from_f0(f0);
                (n, slope * f0)
            }
            Axis::Shifted(_, origin) => (u.exp() - origin, u.exp()),
        };
        let (Axis::Plain(bounds) | Axis::Log(bounds) | Axis::Fresnel(bounds) | Axis::Shifted(bounds, _)) = *self else {
            return (x, slope);
        };
        let ends = self.bounds();
        let x = match () {
            () if u <= ends.lower => bounds.lower,
            () if u >= ends.upper => bounds.upper,
            // the clip absorbs rounding only: u stays inside its own bounds
            () => bounds.clip(x),
        };
        (x, slope)
    }

    /// The bounds of u; held: a unit interval around 0 that nothing pushes against.
    pub fn bounds(&self) -> Interval<f64> {
        match *self {
            Axis::Held(_) => Interval::new(-1.0, 1.0),
            Axis::Plain(bounds) | Axis::Log(bounds) | Axis::Fresnel(bounds) | Axis::Shifted(bounds, _) => {
                Interval::new(self.coordinate(bounds.lower), self.coordinate(bounds.upper))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_comes_back_from_its_coordinate_with_the_slope_of_its_value() {
        for place in 0..COUNT {
            let (lower, upper) = if place == model::N { (1.1, 3.0) } else { (0.01, 2.0) };
            let treatment = Treatment::Free { bounds: Interval::new(lower, upper), prior: None };
            let axis = Axis::new(place, &treatment);
            let ends = axis.bounds();
            // what is said to sit at a bound sits there, to the bit
            assert_eq!((axis.value(ends.lower).0, axis.value(ends.upper).0), (lower, upper), "{}", NAMES[place]);
            for share in [0.05, 0.4, 0.9] {
                let x = lower + share * (upper - lower);
                let u = axis.coordinate(x);
                let (back, slope) = axis.value(u);
                // a few roundings of ln and exp
                assert!((back - x).abs() < 1e-13 * x.max(1.0), "{}", NAMES[place]);
                let h = 1e-5;
                let difference = (axis.value(u + h).0 - axis.value(u - h).0) / (2.0 * h);
                // central difference: h² times a third derivative of order 10
                assert!((slope - difference).abs() < 1e-8 * slope.abs().max(1.0), "{}", NAMES[place]);
            }
        }
    }

    #[test]
    fn a_prior_is_in_standard_deviations() {
        assert_eq!(Prior::plain(2.0, 0.5).misfit(3.0), (2.0, 2.0));
        let (misfit, slope) = Prior::log(40.0, 1.5).misfit(40.0 * 1.5_f64.exp());
        assert!((misfit - 1.0).abs() < 1e-15 && (slope * 60.0 * 1.5_f64.exp() - 1.0).abs() < 1e-14);
    }
}
