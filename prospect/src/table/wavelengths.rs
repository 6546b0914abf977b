//! The wavelengths of a table: evenly spaced, or any rising list.

use leafbrdf_core::Real;

use crate::error::Error;

/// Wavelengths of a table, nm, rising.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wavelengths<'a, T> {
    /// `first`, `first + step`, …
    Even {
        /// First wavelength, nm.
        first: T,
        /// Step, nm, > 0.
        step: T,
        /// Number of wavelengths.
        len: usize,
    },
    /// Any rising list.
    Listed(&'a [T]),
}

impl<T: Real> Wavelengths<'_, T> {
    /// Number of wavelengths.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Wavelengths::Even { len, .. } => *len,
            Wavelengths::Listed(list) => list.len(),
        }
    }

    /// True without any wavelength.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The wavelength of a band, nm.
    #[must_use]
    pub fn get(&self, band: usize) -> Option<T> {
        match self {
            Wavelengths::Even { first, step, len } => (band < *len).then(|| *first + *step * T::lit(band as f64)),
            Wavelengths::Listed(list) => list.get(band).copied(),
        }
    }

    /// The last wavelength, nm.
    #[must_use]
    pub fn last(&self) -> Option<T> {
        self.len().checked_sub(1).and_then(|band| self.get(band))
    }

    /// All of them in order, nm.
    pub fn iter(&self) -> impl Iterator<Item = T> + '_ {
        (0..self.len()).filter_map(|band| self.get(band))
    }

    /// The band at or below `wavelength`, and how far towards the next one it lies, in [0, 1].
    ///
    /// # Errors
    ///
    /// [`Error::Wavelength`] outside the table.
    pub fn locate(&self, wavelength: T) -> Result<(usize, T), Error> {
        let first = self.get(0).unwrap_or(T::ZERO);
        let last = self.last().unwrap_or(T::ZERO);
        if self.is_empty() || !(wavelength >= first && wavelength <= last) {
            return Err(Error::Wavelength { value: wavelength.to_f64(), first: first.to_f64(), last: last.to_f64() });
        }
        // bisection: lower ≤ wavelength < upper
        let (mut lower, mut upper) = (0, self.len());
        while upper - lower > 1 {
            let middle = lower + (upper - lower) / 2;
            if self.get(middle).is_some_and(|w| w <= wavelength) {
                lower = middle;
            } else {
                upper = middle;
            }
        }
        match (self.get(lower), self.get(lower + 1)) {
            (Some(below), Some(above)) => Ok((lower, (wavelength - below) / (above - below))),
            _ => Ok((lower, T::ZERO)),
        }
    }
}

/// Refuses wavelengths that do not rise from one to the next.
pub(super) fn rising<T: Real>(wavelengths: Wavelengths<'_, T>) -> Result<(), Error> {
    let mut before: Option<T> = None;
    for (position, wavelength) in wavelengths.iter().enumerate() {
        let rises = before.is_none_or(|before| wavelength > before);
        if !(rises && wavelength.is_finite()) {
            return Err(Error::WavelengthOrder { position });
        }
        before = Some(wavelength);
    }
    Ok(())
}
