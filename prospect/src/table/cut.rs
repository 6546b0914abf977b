//! Tables of the bands that an instrument needs, made by the compiler.

use leafbrdf_core::Real;

use super::{BANDS, FIRST_NM, LAST_NM, View, Wavelengths};
use crate::params::Version;

mod packed {
    //! Written by `build.rs` from `data/`.
    #![allow(clippy::unreadable_literal, clippy::approx_constant)]
    include!(concat!(env!("OUT_DIR"), "/tables.rs"));
}

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
