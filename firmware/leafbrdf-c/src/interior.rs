//! PROSPECT on a slice of its table in flash: reflectance and transmittance of a leaf's interior.

use core::mem::MaybeUninit;

use leafbrdf_core::Real;
use leafbrdf_prospect::table::{TableD, View};
use leafbrdf_prospect::{Interface, LeafParams, Version, plates};

use crate::border::slice_mut;
use crate::number::{Number, float, number};
use crate::status::{LB_ERR_COUNT, LB_ERR_INTERIOR, LB_ERR_NULL, LB_OK, lb_status};

/// First wavelength of the slice of PROSPECT-D that is built in, nm.
pub const LB_SLICE_FIRST_NM: u16 = 400;
/// Step of the slice, nm.
pub const LB_SLICE_STEP_NM: u16 = 5;
/// Bands of the slice: 400, 405, ... 1000 nm, 4.4 KB of flash.
pub const LB_SLICE_BANDS: u32 = 121;

// Another instrument needs other bands: these three constants are all there is to change.
static SLICE: TableD<f32, { LB_SLICE_BANDS as usize }> =
    TableD::<f32, { LB_SLICE_BANDS as usize }>::cut::<LB_SLICE_FIRST_NM, LB_SLICE_STEP_NM>();

/// The interior of a leaf: PROSPECT-D's structure and contents.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lb_interior {
    /// N, number of plates, 1 to 10.
    pub n_struct: f32,
    /// C_ab, chlorophylls a + b, ug cm^-2, 0 to 300.
    pub cab: f32,
    /// C_car, carotenoids, ug cm^-2, 0 to 100.
    pub car: f32,
    /// C_ant, anthocyanins, ug cm^-2, 0 to 200.
    pub cant: f32,
    /// C_brown, brown pigments, arbitrary units, 0 to 10.
    pub cbrown: f32,
    /// C_w, equivalent water thickness, cm, 0 to 1.
    pub cw: f32,
    /// C_m, dry matter, g cm^-2, 0 to 0.2.
    pub cm: f32,
}

impl lb_interior {
    /// # Errors
    /// [`LB_ERR_INTERIOR`] for a value outside its limits.
    pub(crate) fn checked(&self) -> Result<LeafParams<f32>, lb_status> {
        let leaf = LeafParams {
            n_struct: self.n_struct,
            cab: self.cab,
            car: self.car,
            cant: self.cant,
            cbrown: self.cbrown,
            cw: self.cw,
            cm: self.cm,
            prot: 0.0,
            cbc: 0.0,
        };
        leaf.check(Version::D).map_err(|_| LB_ERR_INTERIOR)?;
        Ok(leaf)
    }
}

/// The model at one wavelength: the plate's faces, and what the constituents absorb.
pub(crate) struct Wavelength {
    pub faces: Interface<Number>,
    /// Sum of content x coefficient without C_ab.
    pub others: Number,
    /// Coefficient of C_ab and what is tied to it, cm^2 ug^-1.
    pub cab: Number,
}

impl Wavelength {
    /// A band of the slice, or a place `beyond` it by a fraction of the step, every column interpolated.
    #[inline(always)]
    pub fn new(leaf: &LeafParams<f32>, car_per_cab: f32, band: usize, beyond: f32) -> Option<Self> {
        let view: View<'_, f32> = SLICE.view();
        let below = view.interface(band)?;
        let above = view.interface(band + 1).unwrap_or(below);
        let between = |below: f32, above: f32| number(below + (above - below) * beyond);
        let faces = Interface {
            t_alpha: between(below.t_alpha, above.t_alpha),
            t_90: between(below.t_90, above.t_90),
            t_21: between(below.t_21, above.t_21),
        };
        // C_ab first: the order of PROSPECT-D's columns
        let contents = [leaf.car, leaf.cant, leaf.cbrown, leaf.cw, leaf.cm];
        let mut columns = view.coefficients().map(|column| {
            let below = column.get(band).copied().unwrap_or(0.0);
            between(below, column.get(band + 1).copied().unwrap_or(below))
        });
        let mut cab = columns.next()?;
        let mut others = Number::ZERO;
        let mut tied = number(car_per_cab);
        for (column, content) in columns.zip(contents) {
            others += number(content) * column;
            // C_car, the first of them, goes with C_ab
            cab += tied * column;
            tied = Number::ZERO;
        }
        Some(Wavelength { faces, others, cab })
    }
}

/// Reflectance and transmittance of a leaf's interior in neighbouring bands of the slice, fractions (PROSPECT-D).
///
/// - first_band: 0 is LB_SLICE_FIRST_NM, the next LB_SLICE_STEP_NM further.
/// - bands: how many, 1 to LB_SLICE_BANDS - first_band.
/// - reflectance, transmittance: room for so many values.
///
/// # Safety
/// `reflectance` and `transmittance` point to room for `bands` values each that nothing else uses during the call, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lb_prospect_slice(
    interior: Option<&lb_interior>,
    first_band: u32,
    bands: u32,
    reflectance: *mut MaybeUninit<f32>,
    transmittance: *mut MaybeUninit<f32>,
) -> lb_status {
    let Some(interior) = interior else { return LB_ERR_NULL };
    let spectrum = || {
        if first_band >= LB_SLICE_BANDS || bands == 0 || bands > LB_SLICE_BANDS - first_band {
            return Err(LB_ERR_COUNT);
        }
        // SAFETY: the caller's promise about pointer and length
        let (reflectance, transmittance) =
            unsafe { (slice_mut(reflectance, bands)?, slice_mut(transmittance, bands)?) };
        let leaf = interior.checked()?;
        let n_struct = number(leaf.n_struct);
        for ((band, r), t) in (first_band as usize..).zip(reflectance).zip(transmittance) {
            let Wavelength { faces, others, cab } = Wavelength::new(&leaf, 0.0, band, 0.0).ok_or(LB_ERR_COUNT)?;
            let optics = plates(faces, (others + number(leaf.cab) * cab) / n_struct, n_struct);
            r.write(float(optics.reflectance));
            t.write(float(optics.transmittance));
        }
        Ok(LB_OK)
    };
    spectrum().unwrap_or_else(|status| status)
}
