//! What goes into the model: parameters with names, units, usual and possible ranges.

use leafbrdf_core::Real;

use crate::both::pick;
use crate::error::Error;

/// The published versions of the model, which share the plate equations and differ in their coefficient tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Version {
    /// PROSPECT-5B (Féret et al. 2008): chlorophylls, carotenoids, brown pigments, water, dry matter.
    P5B,
    /// PROSPECT-D (Féret et al. 2017): the same and anthocyanins.
    D,
    /// PROSPECT-PRO (Féret et al. 2021): the same and dry matter split into proteins and other carbon-based constituents.
    Pro,
}

impl Version {
    /// The absorbing constituents of this version, in the order of the table's columns.
    #[must_use]
    pub const fn constituents(self) -> &'static [Parameter] {
        use Parameter::{Cab, Cant, Car, Cbc, Cbrown, Cm, Cw, Prot};
        match self {
            Version::P5B => &[Cab, Car, Cbrown, Cw, Cm],
            Version::D => &[Cab, Car, Cant, Cbrown, Cw, Cm],
            Version::Pro => &[Cab, Car, Cant, Cbrown, Cw, Cm, Prot, Cbc],
        }
    }

    /// The version called `5B`, `D` or `PRO`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Version> {
        [Version::P5B, Version::D, Version::Pro].into_iter().find(|version| version.name() == name)
    }

    /// `5B`, `D` or `PRO`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Version::P5B => "5B",
            Version::D => "D",
            Version::Pro => "PRO",
        }
    }
}

/// One parameter of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// N: number of plates.
    NStruct,
    /// C_ab: chlorophylls a and b.
    Cab,
    /// C_car: carotenoids.
    Car,
    /// C_ant: anthocyanins.
    Cant,
    /// C_brown: brown pigments.
    Cbrown,
    /// C_w: equivalent water thickness.
    Cw,
    /// C_m: dry matter.
    Cm,
    /// C_prot: proteins.
    Prot,
    /// C_cbc: carbon-based constituents other than proteins.
    Cbc,
}

impl Parameter {
    /// Every parameter, in the order of [`LeafParams`].
    pub const ALL: [Parameter; 9] = [
        Parameter::NStruct,
        Parameter::Cab,
        Parameter::Car,
        Parameter::Cant,
        Parameter::Cbrown,
        Parameter::Cw,
        Parameter::Cm,
        Parameter::Prot,
        Parameter::Cbc,
    ];

    /// The parameter of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Parameter> {
        Parameter::ALL.into_iter().find(|parameter| parameter.name() == name)
    }

    /// Name, as the field of [`LeafParams`].
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.facts().name
    }

    /// Unit; empty for a pure number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        self.facts().unit
    }

    /// Range that most leaves fall in (lowest, highest), in [`Parameter::unit`]. Values outside are accepted.
    #[must_use]
    pub const fn typical(self) -> (f64, f64) {
        self.facts().typical
    }

    /// Range that is accepted, in [`Parameter::unit`]. Values outside are impossible or, most likely, in another unit.
    #[must_use]
    pub const fn limits(self) -> (f64, f64) {
        self.facts().limits
    }

    const fn facts(self) -> Facts {
        // (unit, what one of ours is worth in it), the likeliest mistake first
        const PIGMENT: &[(&str, f64)] = &[("mg m⁻²", 10.0), ("µg m⁻²", 1e4)];
        const ANTHOCYANIN: &[(&str, f64)] = &[("mg m⁻²", 10.0), ("µg m⁻²", 1e4)];
        const WATER: &[(&str, f64)] = &[("mg cm⁻²", 1e3), ("g m⁻²", 1e4), ("mm", 10.0), ("µm", 1e4)];
        const MATTER: &[(&str, f64)] = &[("g m⁻²", 1e4), ("mg cm⁻²", 1e3), ("kg m⁻²", 10.0), ("µg cm⁻²", 1e6)];
        match self {
            Parameter::NStruct => Facts::new("n_struct", "", (1.0, 3.0), (1.0, 10.0), &[]),
            Parameter::Cab => Facts::new("cab", "µg cm⁻²", (0.0, 100.0), (0.0, 300.0), PIGMENT),
            Parameter::Car => Facts::new("car", "µg cm⁻²", (0.0, 30.0), (0.0, 100.0), PIGMENT),
            Parameter::Cant => Facts::new("cant", "µg cm⁻²", (0.0, 40.0), (0.0, 200.0), ANTHOCYANIN),
            Parameter::Cbrown => Facts::new("cbrown", "", (0.0, 1.0), (0.0, 10.0), &[]),
            Parameter::Cw => Facts::new("cw", "cm", (0.001, 0.08), (0.0, 1.0), WATER),
            Parameter::Cm => Facts::new("cm", "g cm⁻²", (0.001, 0.04), (0.0, 0.2), MATTER),
            Parameter::Prot => Facts::new("prot", "g cm⁻²", (0.0001, 0.003), (0.0, 0.05), MATTER),
            Parameter::Cbc => Facts::new("cbc", "g cm⁻²", (0.0005, 0.035), (0.0, 0.2), MATTER),
        }
    }

    /// The unit in which `value` would be an ordinary leaf, and what it is in ours.
    pub(crate) fn likely(self, value: f64) -> Option<(&'static str, f64)> {
        let (lowest, highest) = self.typical();
        self.facts().other_units.iter().find_map(|&(unit, per_ours)| {
            let converted = value / per_ours;
            (converted >= lowest && converted <= highest).then_some((unit, converted))
        })
    }
}

struct Facts {
    name: &'static str,
    unit: &'static str,
    typical: (f64, f64),
    limits: (f64, f64),
    limits_single: (f32, f32),
    other_units: &'static [(&'static str, f64)],
}

impl Facts {
    const fn new(
        name: &'static str,
        unit: &'static str,
        typical: (f64, f64),
        limits: (f64, f64),
        other_units: &'static [(&'static str, f64)],
    ) -> Facts {
        let limits_single = (limits.0 as f32, limits.1 as f32);
        Facts { name, unit, typical, limits, limits_single, other_units }
    }
}

/// A leaf's interior: structure and contents per leaf area.
///
/// Absent constituents are 0, so that `LeafParams { cab: 40.0, cw: 0.01, ..LeafParams::with_n_struct(1.5) }` says all.
/// Ranges are checked where a spectrum is computed; see [`Parameter::limits`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeafParams<T> {
    /// N, number of plates, unitless, ≥ 1.
    pub n_struct: T,
    /// C_ab, chlorophylls a + b, µg cm⁻².
    pub cab: T,
    /// C_car, carotenoids, µg cm⁻².
    pub car: T,
    /// C_ant, anthocyanins, µg cm⁻² (versions D and PRO). The coefficients published with PRO are labelled per nmol, but are
    /// the same numbers as those of D, per µg.
    pub cant: T,
    /// C_brown, brown pigments, arbitrary units.
    pub cbrown: T,
    /// C_w, equivalent water thickness, cm (the same number in g cm⁻²).
    pub cw: T,
    /// C_m, dry matter, g cm⁻².
    pub cm: T,
    /// C_prot, proteins, g cm⁻² (version PRO).
    pub prot: T,
    /// C_cbc, carbon-based constituents other than proteins, g cm⁻² (version PRO).
    pub cbc: T,
}

impl<T: Real> LeafParams<T> {
    /// A leaf of `n_struct` plates that absorbs nothing.
    #[must_use]
    pub fn with_n_struct(n_struct: T) -> Self {
        let zero = T::ZERO;
        LeafParams {
            n_struct,
            cab: zero,
            car: zero,
            cant: zero,
            cbrown: zero,
            cw: zero,
            cm: zero,
            prot: zero,
            cbc: zero,
        }
    }

    /// The value of one parameter.
    #[must_use]
    pub fn get(&self, parameter: Parameter) -> T {
        match parameter {
            Parameter::NStruct => self.n_struct,
            Parameter::Cab => self.cab,
            Parameter::Car => self.car,
            Parameter::Cant => self.cant,
            Parameter::Cbrown => self.cbrown,
            Parameter::Cw => self.cw,
            Parameter::Cm => self.cm,
            Parameter::Prot => self.prot,
            Parameter::Cbc => self.cbc,
        }
    }

    /// Replaces the value of one parameter.
    pub fn set(&mut self, parameter: Parameter, value: T) {
        match parameter {
            Parameter::NStruct => self.n_struct = value,
            Parameter::Cab => self.cab = value,
            Parameter::Car => self.car = value,
            Parameter::Cant => self.cant = value,
            Parameter::Cbrown => self.cbrown = value,
            Parameter::Cw => self.cw = value,
            Parameter::Cm => self.cm = value,
            Parameter::Prot => self.prot = value,
            Parameter::Cbc => self.cbc = value,
        }
    }

    /// Checks every value against [`Parameter::limits`] and against what the version knows.
    ///
    /// # Errors
    ///
    /// [`Error::Outside`] for an impossible or probably mis-scaled value, [`Error::NotInVersion`] for a constituent that
    /// the version has no coefficients for.
    ///
    /// ```
    /// use leafbrdf_prospect::{LeafParams, Version};
    /// let leaf = LeafParams { cm: 20.0, ..LeafParams::with_n_struct(1.5) };
    /// assert_eq!(
    ///     leaf.check(Version::D).unwrap_err().to_string(),
    ///     "cm = 20 g cm⁻² is outside 0 to 0.2 g cm⁻²: did you mean 20 g m⁻² = 0.002 g cm⁻²?"
    /// );
    /// ```
    pub fn check(&self, version: Version) -> Result<(), Error> {
        for parameter in Parameter::ALL {
            let value = self.get(parameter);
            // compared as `T`, so that 0.2 is the limit in single precision too
            let (double, single) = (parameter.facts().limits, parameter.facts().limits_single);
            let (lowest, highest) = (pick(double.0, single.0), pick(double.1, single.1));
            if !(value >= lowest && value <= highest) {
                return Err(Error::Outside { parameter, value: value.to_f64() });
            }
            let known = parameter == Parameter::NStruct || version.constituents().contains(&parameter);
            if !known && value != T::ZERO {
                return Err(Error::NotInVersion { parameter, version });
            }
        }
        Ok(())
    }

    /// Parameters of `version` outside their [typical range](Parameter::typical): possible, but worth a second look.
    ///
    /// A constituent of 0 is absent and not reported.
    pub fn unusual(&self, version: Version) -> impl Iterator<Item = Parameter> + '_ {
        Parameter::ALL.into_iter().filter(move |&parameter| {
            let value = self.get(parameter);
            let (lowest, highest) = parameter.typical();
            let known = parameter == Parameter::NStruct || version.constituents().contains(&parameter);
            known && value != T::ZERO && !(value >= T::lit(lowest) && value <= T::lit(highest))
        })
    }
}
