//! Coefficient tables: complete, cut at compile time, or the user's own.

mod cut;
mod view;
mod wavelengths;

use crate::params::Version;

pub use cut::{Table, Table5B, TableD, TablePro};
pub use view::View;
pub use wavelengths::Wavelengths;

pub(crate) use view::between;

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

/// Columns of a table of this version: three of the plate's faces and one per constituent.
#[must_use]
pub const fn columns_of(version: Version) -> usize {
    FACES + version.constituents().len()
}
