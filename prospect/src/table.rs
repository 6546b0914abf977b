//! Coefficient tables: complete, cut at compile time, or the user's own.

use leafbrdf_core::Real;

use crate::error::Error;
use crate::params::Version;
use crate::plate::Interface;

mod packed {
    //! Written by `build.rs` from `data/`.
    #![allow(clippy::unreadable_literal, clippy::approx_constant)]
    include!(concat!(env!("OUT_DIR"), "/tables.rs"));
}

/// Bands of a complete table: 400–2500 nm at 1 nm.
pub const BANDS: usize = 2101;
/// First wavelength of the published tables, nm.
pub const FIRST_NM: u16 = 400;
/// Last wavelength of the published tables, nm.
pub const LAST_NM: u16 = 2500;

/// Columns of a table before those of the constituents: t_av(40°), t_av(90°), t_av(90°)/n².
const FACES: usize = 3;
/// The most constituents that a version has.
pub(crate) const MOST_CONSTITUENTS: usize = 8;

/// A table of `N` bands with the `C` columns of one version, ready for flash memory.
///
/// Use the names [`Table5B`], [`TableD`], [`TablePro`]. `cut` takes first wavelength and step in nm as constants, so that only
/// what an instrument needs is kept, and a range outside 400–2500 nm does not compile:
///
/// ```
/// use leafbrdf_prospect::table::TableD;
/// // 400, 405, … 1000 nm in single precision: 4.4 KB
/// static VIS_NIR: TableD<f32, 121> = TableD::<f32, 121>::cut::<400, 5>();
/// assert!(size_of_val(&VIS_NIR) < 5 * 1024);
/// assert_eq!(VIS_NIR.view().wavelengths().last(), Some(1000.0));
/// ```
///
/// ```compile_fail
/// use leafbrdf_prospect::table::TableD;
/// static TOO_LONG: TableD<f32, 422> = TableD::<f32, 422>::cut::<400, 5>();
/// ```
#[derive(Clone, Debug)]
pub struct Table<T, const C: usize, const N: usize> {
    version: Version,
    first_nm: u16,
    step_nm: u16,
    columns: [[T; N]; C],
}

/// A table of PROSPECT-5B with `N` bands.
pub type Table5B<T, const N: usize> = Table<T, 8, N>;
/// A table of PROSPECT-D with `N` bands.
pub type TableD<T, const N: usize> = Table<T, 9, N>;
/// A table of PROSPECT-PRO with `N` bands.
pub type TablePro<T, const N: usize> = Table<T, 11, N>;

/// PROSPECT-5B, 400–2500 nm, 1 nm, double precision.
pub static P5B: Table5B<f64, BANDS> = Table5B::<f64, BANDS>::cut::<FIRST_NM, 1>();
/// PROSPECT-D, 400–2500 nm, 1 nm, double precision.
pub static D: TableD<f64, BANDS> = TableD::<f64, BANDS>::cut::<FIRST_NM, 1>();
/// PROSPECT-PRO, 400–2500 nm, 1 nm, double precision.
pub static PRO: TablePro<f64, BANDS> = TablePro::<f64, BANDS>::cut::<FIRST_NM, 1>();

/// The complete table of a version.
#[cfg(any(feature = "std", feature = "libm"))]
#[must_use]
pub fn full(version: Version) -> View<'static, f64> {
    match version {
        Version::P5B => P5B.view(),
        Version::D => D.view(),
        Version::Pro => PRO.view(),
    }
}

/// True where `bands` wavelengths from `first` in steps of `step` lie in the published tables.
const fn in_range(first: u16, step: u16, bands: usize) -> bool {
    bands >= 1
        && step >= 1
        && first >= FIRST_NM
        && bands <= BANDS
        && first as usize + step as usize * (bands - 1) <= LAST_NM as usize
}

// The three versions times two precisions are written out: eight lines each, and no macro between the reader and the table.

impl<const N: usize> Table<f64, 8, N> {
    /// PROSPECT-5B at `FIRST`, `FIRST + STEP`, … nm.
    #[must_use]
    pub const fn cut<const FIRST: u16, const STEP: u16>() -> Self {
        const { assert!(in_range(FIRST, STEP, N), "wavelengths must lie in 400–2500 nm, step and bands ≥ 1") };
        Table { version: Version::P5B, first_nm: FIRST, step_nm: STEP, columns: cut_f64(packed::P5B, FIRST, STEP) }
    }
}
impl<const N: usize> Table<f32, 8, N> {
    /// PROSPECT-5B at `FIRST`, `FIRST + STEP`, … nm, rounded to single precision.
    #[must_use]
    pub const fn cut<const FIRST: u16, const STEP: u16>() -> Self {
        const { assert!(in_range(FIRST, STEP, N), "wavelengths must lie in 400–2500 nm, step and bands ≥ 1") };
        Table { version: Version::P5B, first_nm: FIRST, step_nm: STEP, columns: cut_f32(packed::P5B, FIRST, STEP) }
    }
}
impl<const N: usize> Table<f64, 9, N> {
    /// PROSPECT-D at `FIRST`, `FIRST + STEP`, … nm.
    #[must_use]
    pub const fn cut<const FIRST: u16, const STEP: u16>() -> Self {
        const { assert!(in_range(FIRST, STEP, N), "wavelengths must lie in 400–2500 nm, step and bands ≥ 1") };
        Table { version: Version::D, first_nm: FIRST, step_nm: STEP, columns: cut_f64(packed::PRO, FIRST, STEP) }
    }
}
impl<const N: usize> Table<f32, 9, N> {
    /// PROSPECT-D at `FIRST`, `FIRST + STEP`, … nm, rounded to single precision.
    #[must_use]
    pub const fn cut<const FIRST: u16, const STEP: u16>() -> Self {
        const { assert!(in_range(FIRST, STEP, N), "wavelengths must lie in 400–2500 nm, step and bands ≥ 1") };
        Table { version: Version::D, first_nm: FIRST, step_nm: STEP, columns: cut_f32(packed::PRO, FIRST, STEP) }
    }
}
impl<const N: usize> Table<f64, 11, N> {
    /// PROSPECT-PRO at `FIRST`, `FIRST + STEP`, … nm.
    #[must_use]
    pub const fn cut<const FIRST: u16, const STEP: u16>() -> Self {
        const { assert!(in_range(FIRST, STEP, N), "wavelengths must lie in 400–2500 nm, step and bands ≥ 1") };
        Table { version: Version::Pro, first_nm: FIRST, step_nm: STEP, columns: cut_f64(packed::PRO, FIRST, STEP) }
    }
}
impl<const N: usize> Table<f32, 11, N> {
    /// PROSPECT-PRO at `FIRST`, `FIRST + STEP`, … nm, rounded to single precision.
    #[must_use]
    pub const fn cut<const FIRST: u16, const STEP: u16>() -> Self {
        const { assert!(in_range(FIRST, STEP, N), "wavelengths must lie in 400–2500 nm, step and bands ≥ 1") };
        Table { version: Version::Pro, first_nm: FIRST, step_nm: STEP, columns: cut_f32(packed::PRO, FIRST, STEP) }
    }
}

/// The first `C` columns at the wanted wavelengths; the callers have checked the range at compile time.
const fn cut_f64<const S: usize, const C: usize, const N: usize>(
    source: &[[f64; BANDS]; S],
    first: u16,
    step: u16,
) -> [[f64; N]; C] {
    let mut columns = [[0.0; N]; C];
    let mut column = 0;
    while column < C {
        let mut band = 0;
        while band < N {
            columns[column][band] = source[column][(first - FIRST_NM) as usize + band * step as usize];
            band += 1;
        }
        column += 1;
    }
    columns
}

/// [`cut_f64`], each value rounded to the nearest `f32`.
const fn cut_f32<const S: usize, const C: usize, const N: usize>(
    source: &[[f64; BANDS]; S],
    first: u16,
    step: u16,
) -> [[f32; N]; C] {
    let mut columns = [[0.0; N]; C];
    let mut column = 0;
    while column < C {
        let mut band = 0;
        while band < N {
            columns[column][band] = source[column][(first - FIRST_NM) as usize + band * step as usize] as f32;
            band += 1;
        }
        column += 1;
    }
    columns
}

impl<T: Real, const C: usize, const N: usize> Table<T, C, N> {
    /// The table as the model reads it.
    #[must_use]
    pub fn view(&self) -> View<'_, T> {
        let wavelengths = Wavelengths::Even {
            first: T::lit(f64::from(self.first_nm)),
            step: T::lit(f64::from(self.step_nm)),
            len: N,
        };
        View::from_rows(self.version, wavelengths, self.columns.iter().map(<[T; N]>::as_slice))
    }
}

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
    fn from_rows(version: Version, wavelengths: Wavelengths<'a, T>, mut rows: impl Iterator<Item = &'a [T]>) -> Self {
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
        let sources = [self.t_alpha, self.t_90, self.t_21].into_iter().chain(self.coefficients());
        for (target, source) in columns.chunks_exact_mut(bands).zip(sources) {
            for (value, &wavelength) in target.iter_mut().zip(wavelengths) {
                let (band, beyond) = self.wavelengths.locate(wavelength)?;
                *value = between(source, band, beyond);
            }
        }
        View::from_columns(self.version, Wavelengths::Listed(wavelengths), columns)
    }
}

/// Columns of a table of this version: three of the plate's faces and one per constituent.
#[must_use]
pub const fn columns_of(version: Version) -> usize {
    FACES + version.constituents().len()
}

/// Linear interpolation of one column, `beyond` the band by a fraction of the way to the next.
pub(crate) fn between<T: Real>(column: &[T], band: usize, beyond: T) -> T {
    match (column.get(band), column.get(band + 1)) {
        (Some(&below), Some(&above)) => below + (above - below) * beyond,
        (Some(&below), None) => below,
        _ => T::ZERO,
    }
}

fn rising<T: Real>(wavelengths: Wavelengths<'_, T>) -> Result<(), Error> {
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
