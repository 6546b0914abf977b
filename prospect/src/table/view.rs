//! A table as the model reads it.

use leafbrdf_core::Real;

use super::wavelengths::rising;
use super::{MOST_CONSTITUENTS, Wavelengths, columns_of};
use crate::error::Error;
use crate::params::Version;
use crate::plate::Interface;

/// A table as the model reads it: borrowed columns, one value a band.
#[derive(Clone, Copy, Debug)]
pub struct View<'a, T> {
    version: Version,
    wavelengths: Wavelengths<'a, T>,
    t_alpha: &'a [T],
    t_90: &'a [T],
    t_21: &'a [T],
    /// Absorption coefficients in the order of `Version::constituents`.
    k: [&'a [T]; MOST_CONSTITUENTS],
}

impl<'a, T: Real> View<'a, T> {
    /// A table made of the user's own columns, one after the other in one slice: t_av(40°, n), t_av(90°, n), t_av(90°, n)/n²
    /// (see [`crate::interface::t_av`]), then one per constituent in the order of [`Version::constituents`].
    ///
    /// # Errors
    ///
    /// [`Error::Length`] where the slice does not hold that many columns; [`Error::WavelengthOrder`] for wavelengths that do
    /// not rise.
    pub fn from_columns(
        version: Version,
        wavelengths: Wavelengths<'a, T>,
        columns: &'a [T],
    ) -> Result<View<'a, T>, Error> {
        let bands = wavelengths.len();
        let expected = columns_of(version).saturating_mul(bands);
        if bands == 0 || columns.len() != expected {
            return Err(Error::Length { slice: "columns", expected: expected.max(1), found: columns.len() });
        }
        rising(wavelengths)?;
        Ok(View::from_rows(version, wavelengths, columns.chunks_exact(bands)))
    }

    /// Columns of equal, checked length.
    pub(super) fn from_rows(
        version: Version,
        wavelengths: Wavelengths<'a, T>,
        mut rows: impl Iterator<Item = &'a [T]>,
    ) -> Self {
        let mut next = || rows.next().unwrap_or_default();
        let (t_alpha, t_90, t_21) = (next(), next(), next());
        let mut k: [&[T]; MOST_CONSTITUENTS] = Default::default();
        for column in &mut k {
            *column = next();
        }
        View { version, wavelengths, t_alpha, t_90, t_21, k }
    }

    /// The version whose coefficients these are.
    #[must_use]
    pub fn version(&self) -> Version {
        self.version
    }

    /// The wavelengths, nm.
    #[must_use]
    pub fn wavelengths(&self) -> Wavelengths<'a, T> {
        self.wavelengths
    }

    /// Number of bands.
    #[must_use]
    pub fn len(&self) -> usize {
        self.t_alpha.len()
    }

    /// True without any band.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.t_alpha.is_empty()
    }

    /// t_av(40°, n), one value a band. 1 − t_av(40°) is the first-surface reflection that PROSPECULAR's coupling subtracts.
    #[must_use]
    pub fn t_alpha(&self) -> &'a [T] {
        self.t_alpha
    }

    /// t_av(90°, n), one value a band.
    #[must_use]
    pub fn t_90(&self) -> &'a [T] {
        self.t_90
    }

    /// The faces of a plate in one band.
    #[must_use]
    pub fn interface(&self, band: usize) -> Option<Interface<T>> {
        Some(Interface { t_alpha: *self.t_alpha.get(band)?, t_90: *self.t_90.get(band)?, t_21: *self.t_21.get(band)? })
    }

    /// Refractive index n of leaf material in one band (from its two stored transmissivities).
    #[must_use]
    pub fn refractive_index(&self, band: usize) -> Option<T> {
        Some((*self.t_90.get(band)? / *self.t_21.get(band)?).sqrt())
    }

    /// t_av(90°)/n², one value a band.
    pub(crate) fn t_21(&self) -> &'a [T] {
        self.t_21
    }

    /// Absorption coefficients, in the order of [`Version::constituents`], one value a band.
    pub fn coefficients(&self) -> impl Iterator<Item = &'a [T]> + '_ {
        self.k.iter().copied().take(self.version.constituents().len())
    }

    /// One column of coefficients; empty beyond the version's constituents.
    pub(crate) fn coefficient(&self, column: usize) -> &'a [T] {
        self.k.get(column).copied().unwrap_or_default()
    }

    /// A run of neighbouring bands; `None` outside the table.
    #[must_use]
    pub fn bands(&self, range: core::ops::Range<usize>) -> Option<View<'a, T>> {
        let wavelengths = match self.wavelengths {
            Wavelengths::Even { step, .. } => {
                Wavelengths::Even { first: self.wavelengths.get(range.start)?, step, len: range.len() }
            }
            Wavelengths::Listed(list) => Wavelengths::Listed(list.get(range.clone())?),
        };
        let mut k: [&[T]; MOST_CONSTITUENTS] = Default::default();
        for (part, column) in k.iter_mut().zip(self.coefficients()) {
            *part = column.get(range.clone())?;
        }
        Some(View {
            version: self.version,
            wavelengths,
            t_alpha: self.t_alpha.get(range.clone())?,
            t_90: self.t_90.get(range.clone())?,
            t_21: self.t_21.get(range)?,
            k,
        })
    }

    /// The table at other wavelengths, each column interpolated linearly between its neighbours.
    ///
    /// Exact at the table's own wavelengths. Half-way between those of the 1 nm tables, the reflectance of a green leaf differs
    /// by at most 2e-4 (at the red edge) from the mean of its neighbours, and t_av by less than 1e-6 from that of the interpolated n.
    ///
    /// - `wavelengths`: nm, rising, inside the table.
    /// - `columns`: room for [`columns_of`] the version × the number of wavelengths.
    ///
    /// # Errors
    ///
    /// [`Error::Wavelength`], [`Error::WavelengthOrder`], [`Error::Length`].
    ///
    /// ```
    /// use leafbrdf_prospect::{table, Version};
    /// let mut room = [0.0; 9 * 2];
    /// let two = table::full(Version::D).at_wavelengths(&[680.0, 750.5], &mut room)?;
    /// assert_eq!(two.t_alpha()[0], table::full(Version::D).t_alpha()[280]);
    /// # Ok::<(), leafbrdf_prospect::Error>(())
    /// ```
    pub fn at_wavelengths<'b>(&self, wavelengths: &'b [T], columns: &'b mut [T]) -> Result<View<'b, T>, Error> {
        let bands = wavelengths.len();
        let expected = columns_of(self.version).saturating_mul(bands);
        if bands == 0 || columns.len() != expected {
            return Err(Error::Length { slice: "columns", expected: expected.max(1), found: columns.len() });
        }
        for (place, &wavelength) in wavelengths.iter().enumerate() {
            let (band, beyond) = self.wavelengths.locate(wavelength)?;
            let sources = [self.t_alpha, self.t_90, self.t_21].into_iter().chain(self.coefficients());
            for (target, source) in columns.chunks_exact_mut(bands).zip(sources) {
                if let Some(value) = target.get_mut(place) {
                    *value = between(source, band, beyond);
                }
            }
        }
        View::from_columns(self.version, Wavelengths::Listed(wavelengths), columns)
    }
}

/// Linear interpolation of one column, `beyond` the band by a fraction of the way to the next.
pub(crate) fn between<T: Real>(column: &[T], band: usize, beyond: T) -> T {
    match (column.get(band), column.get(band + 1)) {
        (Some(&below), Some(&above)) => below + (above - below) * beyond,
        (Some(&below), None) => below,
        _ => T::ZERO,
    }
}
