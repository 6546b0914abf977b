//! N from reflectance alone, where leaves hardly absorb.

use leafbrdf_prospect::{Lanes, LeafParams, Prospect};

use super::HemisphericalError;
use crate::bounds::Interval;

/// A number of plates that follows from the near-infrared plateau of the reflectance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PriorN<T> {
    /// N.
    pub n_struct: T,
    /// Its standard deviation over leaves of unknown water and dry matter; see [`n_prior`].
    pub standard_deviation: T,
    /// The wavelength that it was taken at, nm.
    pub wavelength_nm: T,
}

/// The plateau's wavelengths, nm, the better one first: between the absorption of water and dry matter, beyond all pigments.
const PLATEAU_NM: [f64; 2] = [1131.0, 800.0];
/// Bands this far from the plateau's wavelength are averaged, nm.
const HALF_WIDTH_NM: f64 = 5.0;

/// N such that the modelled plateau has the measured reflectance: a prior for inversions without transmittance.
///
/// Féret et al. (2008) and the R package prospect take N from the ratio R/(1 − R) at 1131 nm, or at 800 nm without the short-wave
/// infrared, by a regression over random leaves. Here the equation itself is solved: at these wavelengths hardly anything
/// absorbs, so R rises with N, and one N fits the mean reflectance of the bands within 5 nm. The little that water and
/// dry matter absorb there is that of an ordinary leaf (C_w = 0.012 cm, C_m = 0.0065 g cm⁻²); leaves that differ from it by a
/// factor of two either way shift N by the standard deviation given. Over 1,000 leaves whose water and dry matter scatter by that factor
/// independently: bias −0.05, median error 0.10, 80 % within the standard deviation (`examples/hemispherical.rs`).
///
/// - `model`: on the bands that were measured.
/// - `reflectance`: fractions, one a band; bands with a NaN are passed over.
/// - `bounds`: of N; the answer is the bound where the plateau lies beyond.
///
/// # Errors
/// [`HemisphericalError::NoPlateau`] without a usable band near either wavelength.
///
/// ```
/// use leafbrdf_fit::Interval;
/// use leafbrdf_fit::hemispherical::n_prior;
/// use leafbrdf_prospect::{LeafParams, Prospect, Version, table};
/// let model = Prospect::new(table::full(Version::D));
/// let leaf = LeafParams { cab: 40.0, cw: 0.015, cm: 0.005, ..LeafParams::with_n_struct(1.7) };
/// let (mut r, mut t) = (vec![0.0; 2101], vec![0.0; 2101]);
/// model.spectrum(&leaf, &mut r, &mut t).unwrap();
/// let prior = n_prior(&model, &r, Interval::new(1.0, 5.0)).unwrap();
/// assert!((prior.n_struct - 1.7).abs() < 0.1);
/// ```
pub fn n_prior<T: Lanes>(
    model: &Prospect<'_, T>,
    reflectance: &[T],
    bounds: Interval<T>,
) -> Result<PriorN<T>, HemisphericalError> {
    let view = model.view();
    if reflectance.len() != view.len() {
        let (found, expected) = (reflectance.len(), view.len());
        return Err(HemisphericalError::Length { what: "reflectance", found, expected });
    }
    for nm in PLATEAU_NM {
        let mut bands = Plateau { model, reflectance, nm };
        let Some(measured) = bands.mean(|_, measured| Some(measured)) else { continue };
        let ordinary = |share: f64| {
            let mut leaf = LeafParams::with_n_struct(T::ONE);
            leaf.cw = T::lit(0.012 * share);
            leaf.cm = T::lit(0.0065 * share);
            leaf
        };
        let n_struct = bands.solve(measured, ordinary(1.0), bounds)?;
        // half and double the absorber: one standard deviation either way
        let (thin, thick) =
            (bands.solve(measured, ordinary(0.5), bounds)?, bands.solve(measured, ordinary(2.0), bounds)?);
        let standard_deviation = T::HALF * (thick - thin).abs();
        return Ok(PriorN { n_struct, standard_deviation, wavelength_nm: T::lit(nm) });
    }
    Err(HemisphericalError::NoPlateau)
}

/// The bands within reach of one wavelength.
struct Plateau<'a, 'b, T> {
    model: &'a Prospect<'b, T>,
    reflectance: &'a [T],
    nm: f64,
}

impl<T: Lanes> Plateau<'_, '_, T> {
    /// Mean over the plateau's usable bands of a function of band and measured reflectance.
    fn mean(&mut self, mut of: impl FnMut(usize, T) -> Option<T>) -> Option<T> {
        let (mut sum, mut count) = (T::ZERO, T::ZERO);
        for (band, (nm, measured)) in self.model.view().wavelengths().iter().zip(self.reflectance).enumerate() {
            if (nm - T::lit(self.nm)).abs() <= T::lit(HALF_WIDTH_NM) && measured.is_finite() {
                sum += of(band, *measured)?;
                count += T::ONE;
            }
        }
        (count > T::ZERO).then(|| sum / count)
    }

    /// The N at which the modelled mean is `measured`: bisection, since R rises with N.
    fn solve(&mut self, measured: T, mut leaf: LeafParams<T>, bounds: Interval<T>) -> Result<T, HemisphericalError> {
        let Interval { mut lower, mut upper } = bounds;
        let model = self.model;
        // to 1e-9 of N, and to rounding in single precision
        for _ in 0..32 {
            leaf.n_struct = T::HALF * (lower + upper);
            model.band(&leaf, 0)?;
            let modelled = self.mean(|band, _| model.band(&leaf, band).ok().map(|optics| optics.reflectance));
            if modelled.is_some_and(|modelled| modelled < measured) {
                lower = leaf.n_struct;
            } else {
                upper = leaf.n_struct;
            }
        }
        Ok(T::HALF * (lower + upper))
    }
}
