//! K: how strongly one elementary layer absorbs, from the leaf's contents.

use leafbrdf_core::Real;

use crate::error::Error;
use crate::params::{LeafParams, Parameter, Version};
use crate::table::MOST_CONSTITUENTS;

/// The leaf as the equations see it: N and, per constituent of the version, its content in one layer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer<T> {
    /// N − 1 and 1/N.
    pub m: T,
    pub per_plate: T,
    /// C_i/N in the order of `Version::constituents`; unused places are 0.
    pub contents: [T; MOST_CONSTITUENTS],
}

/// How the leaf's parameters act on the contents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rules<T> {
    pub car_per_cab: Option<T>,
    pub allow_cm_with_prot_cbc: bool,
}

impl<T: Real> Rules<T> {
    /// Checks the leaf and works out what is in one layer: K(λ) = Σ C_i k_i(λ)/N.
    pub(crate) fn layer(&self, version: Version, leaf: &LeafParams<T>) -> Result<Layer<T>, Error> {
        leaf.check(version)?;
        let split = leaf.prot > T::ZERO || leaf.cbc > T::ZERO;
        if version == Version::Pro && split && leaf.cm > T::ZERO && !self.allow_cm_with_prot_cbc {
            return Err(Error::DryMatterTwice);
        }
        let mut contents = *leaf;
        if let Some(ratio) = self.car_per_cab {
            if leaf.car > T::ZERO {
                return Err(Error::CarGivenAndTied);
            }
            contents.car = ratio * leaf.cab;
        }
        let per_plate = T::ONE / leaf.n_struct;
        let mut layer = Layer { m: leaf.n_struct - T::ONE, per_plate, contents: [T::ZERO; MOST_CONSTITUENTS] };
        for (content, &constituent) in layer.contents.iter_mut().zip(version.constituents()) {
            *content = contents.get(constituent) * per_plate;
        }
        Ok(layer)
    }

    /// What a parameter changes.
    pub(crate) fn action(&self, version: Version, parameter: Parameter) -> Action<T> {
        let column = |constituent| version.constituents().iter().position(|&known| known == constituent);
        match (parameter, self.car_per_cab) {
            (Parameter::NStruct, _) => Action::Structure,
            (Parameter::Car, Some(_)) => Action::Nothing,
            _ => match column(parameter) {
                Some(own) => {
                    let tied = if parameter == Parameter::Cab { self.car_per_cab } else { None };
                    Action::Content { own, tied: column(Parameter::Car).zip(tied) }
                }
                None => Action::Nothing,
            },
        }
    }
}

/// What a parameter changes in the leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Action<T> {
    /// N.
    Structure,
    /// The content of one constituent (its column), and of one tied to it (its column, and how much of it per unit).
    Content { own: usize, tied: Option<(usize, T)> },
    /// Nothing: unknown to this version, or tied to another.
    Nothing,
}
