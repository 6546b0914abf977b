//! The hemispherical integral of the specular term.

use core::mem::MaybeUninit;

use leafbrdf_core::{Grade, Illumination};

use crate::number::{Number, float, number};
use crate::status::{LB_ERR_NULL, LB_ERR_THETA_S, lb_status};
use crate::surface::{give, lb_leaf};

/// DHRF_spec (Eq. 14): the share of the light from theta_s that the surface reflects and that never enters the leaf,
/// unitless. The leaf's whole reflectance is k_lambert more (Eq. 12); k_lambert is not looked at here.
///
/// - theta_s_deg: zenith angle of the illumination, 0 <= theta_s < 90 degrees.
///
/// At most 180 evaluations of the Fresnel factor for any theta_s and sigma; relative error 2e-5, that of `Grade::E4d`, and what
/// single precision adds.
///
/// Example: beech (n 1.56, sigma 0.29, LB_BOUSQUET_2005) at 60 degrees gives 0.0551.
#[unsafe(no_mangle)]
pub extern "C" fn lb_dhrf(
    leaf: Option<&lb_leaf>,
    theta_s_deg: f32,
    dhrf_specular: Option<&mut MaybeUninit<f32>>,
) -> lb_status {
    let (Some(leaf), Some(out)) = (leaf, dhrf_specular) else { return LB_ERR_NULL };
    give(out, specular(leaf, number(theta_s_deg)).map(float))
}

/// For `lb_dhrf` and `lb_fit_cab`: one copy, with the illumination and the rule in one frame of the stack.
#[inline(never)]
pub(crate) fn specular(leaf: &lb_leaf, theta_s_deg: Number) -> Result<Number, lb_status> {
    let surface = leaf.surface()?;
    let source = Illumination::from_degrees(theta_s_deg).map_err(|_| LB_ERR_THETA_S)?;
    Ok(surface.dhrf(&source, Grade::E4d))
}
