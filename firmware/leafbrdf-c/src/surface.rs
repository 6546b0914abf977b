//! The surface and the leaf at one pair of directions: Fresnel factor, BRDF, gradient.

use core::mem::MaybeUninit;

use leafbrdf_core::{
    Beckmann, Dielectric, DirectionCosines, DomainError, Geometry, Index, Leaf, Normalization, Pair, Real, Refused,
    Surface, VCavity,
};

use crate::border::afresh;
use crate::number::{Number, float, number};
use crate::status::{
    LB_ERR_K_LAMBERT, LB_ERR_N, LB_ERR_NORMALIZATION, LB_ERR_NULL, LB_ERR_PHI_V, LB_ERR_SIGMA, LB_ERR_THETA_A,
    LB_ERR_THETA_S, LB_ERR_THETA_V, LB_OK, lb_status,
};
#[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
use {crate::border::cosines, leafbrdf_core::Degrees};

/// Constant of the specular term as printed in the paper's Eq. 10, 2 pi^2. Fitted values of the paper belong to it.
pub const LB_BOUSQUET_2005: u32 = 0;
/// Constant of the specular term as derived from Eqs 5, 6 and 9, 4 pi: energy-conserving.
pub const LB_COOK_TORRANCE: u32 = 1;

/// A leaf at one wavelength: a Lambertian interior under a specular surface.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lb_leaf {
    /// Lambert coefficient k_L, unitless, 0 to 1.
    pub k_lambert: f32,
    /// Refractive index of the surface, unitless, 1 to 16384.
    pub n: f32,
    /// Roughness of the surface, unitless, 2^-30 to 1024: facets are spread as exp(-tan^2(alpha)/sigma^2).
    pub sigma: f32,
    /// LB_BOUSQUET_2005 or LB_COOK_TORRANCE. An n fitted under one means nothing under the other.
    pub normalization: u32,
}

/// Sines and cosines of one pair of directions, as an instrument with fixed directions keeps them in a table.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lb_cosines {
    /// cos theta_s, above 0: illumination zenith angle.
    pub cos_theta_s: f32,
    /// sin theta_s, 0 to 1.
    pub sin_theta_s: f32,
    /// cos theta_v, above 0: viewing zenith angle.
    pub cos_theta_v: f32,
    /// sin theta_v, 0 to 1.
    pub sin_theta_v: f32,
    /// cos phi_v, -1 to 1: viewing azimuth from the illumination; -1 is the forward, specular side.
    pub cos_phi_v: f32,
}

/// BRDF and its exact derivatives, sr^-1.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lb_gradient {
    /// BRDF.
    pub value: f32,
    /// dBRDF/dk_L.
    pub d_k_lambert: f32,
    /// dBRDF/dn.
    pub d_n: f32,
    /// dBRDF/dsigma.
    pub d_sigma: f32,
}

impl lb_leaf {
    /// k_lambert is inside its domain.
    #[inline(always)]
    pub(crate) fn check_k_lambert(&self) -> Result<(), lb_status> {
        if number(self.k_lambert).is_within(0.0, 1.0) { Ok(()) } else { Err(LB_ERR_K_LAMBERT) }
    }

    /// The convention for K of a leaf that has been checked.
    #[inline(always)]
    fn checked_normalization(&self) -> Normalization {
        if self.normalization == LB_BOUSQUET_2005 { Normalization::Bousquet2005 } else { Normalization::CookTorrance }
    }

    /// k_L/pi, the diffuse part: computed last, so that nothing keeps it meanwhile.
    #[inline(always)]
    pub(crate) fn diffuse(&self) -> Number {
        number(self.k_lambert) * Number::lit(core::f64::consts::FRAC_1_PI)
    }

    /// n, sigma and normalization; k_lambert is not looked at.
    #[inline(always)]
    pub(crate) fn surface(&self) -> Result<Surface<Number>, lb_status> {
        let index = Dielectric::new(number(self.n)).map_err(|_| LB_ERR_N)?;
        let surface = Surface::with_parts(index, number(self.sigma), Beckmann, VCavity).map_err(|_| LB_ERR_SIGMA)?;
        Ok(surface.with_normalization(normalization(self.normalization)?))
    }
}

/// The convention for K.
#[inline(always)]
pub(crate) fn normalization(code: u32) -> Result<Normalization, lb_status> {
    match code {
        LB_BOUSQUET_2005 => Ok(Normalization::Bousquet2005),
        LB_COOK_TORRANCE => Ok(Normalization::CookTorrance),
        _ => Err(LB_ERR_NORMALIZATION),
    }
}

impl lb_cosines {
    #[inline(always)]
    pub(crate) fn numbers(&self) -> DirectionCosines<Number> {
        DirectionCosines {
            cos_theta_s: number(self.cos_theta_s),
            sin_theta_s: number(self.sin_theta_s),
            cos_theta_v: number(self.cos_theta_v),
            sin_theta_v: number(self.sin_theta_v),
            cos_phi_v: number(self.cos_phi_v),
        }
    }
}

/// Which angle the model refused.
#[inline(always)]
pub(crate) fn direction(refused: Refused) -> lb_status {
    match refused {
        Refused::ThetaS => LB_ERR_THETA_S,
        Refused::ThetaV => LB_ERR_THETA_V,
        Refused::PhiV => LB_ERR_PHI_V,
    }
}

/// The same by the name in an error.
#[inline(always)]
fn named(error: DomainError) -> lb_status {
    match error.parameter.as_bytes() {
        [b't', .., b's'] => LB_ERR_THETA_S,
        [b't', .., b'v'] => LB_ERR_THETA_V,
        _ => LB_ERR_PHI_V,
    }
}

/// `Ok` written to its place, or the status.
#[inline(always)]
pub(crate) fn give<T>(out: &mut MaybeUninit<T>, result: Result<T, lb_status>) -> lb_status {
    match result {
        Ok(value) => {
            out.write(value);
            LB_OK
        }
        Err(status) => status,
    }
}

/// Fresnel factor of a facet (Eq. 8): the share of unpolarised light that it reflects, unitless, 0 to 1.
///
/// - n: refractive index, 1 to 16384.
/// - cos_theta_a: cosine of the incidence angle on the facet, 0 to 1.
///
/// Example: n = 1.5 at cos_theta_a = 1 gives 0.04.
#[unsafe(no_mangle)]
pub extern "C" fn lb_fresnel(n: f32, cos_theta_a: f32, fresnel: Option<&mut MaybeUninit<f32>>) -> lb_status {
    let Some(out) = fresnel else { return LB_ERR_NULL };
    if !(0.0..=1.0).contains(&cos_theta_a) {
        return LB_ERR_THETA_A;
    }
    let index = Dielectric::new(number(n)).map_err(|_| LB_ERR_N);
    give(out, index.map(|index| float(index.fresnel(number(cos_theta_a)))))
}

/// BRDF of a leaf in sr^-1 (Eqs 3, 4, 10) from sines and cosines.
///
/// Relative error below 1e-5 where tan^2(alpha)/sigma^2 < 14, 2.5e-5 below 80. That a sine and a cosine belong together
/// is not checked here (lb_brdf_gradient does).
#[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
#[unsafe(no_mangle)]
pub extern "C" fn lb_brdf(
    leaf: Option<&lb_leaf>,
    at: Option<&lb_cosines>,
    brdf: Option<&mut MaybeUninit<f32>>,
) -> lb_status {
    let (Some(leaf), Some(at), Some(out)) = (leaf, at, brdf) else { return LB_ERR_NULL };
    let checked = || {
        leaf.check_k_lambert()?;
        leaf.surface()?;
        Pair::check(cosines(at)).map_err(direction)
    };
    match checked() {
        Ok(()) => leaf_at(afresh(leaf), &Pair::unchecked(cosines(afresh(at))), out),
        Err(status) => status,
    }
}

/// The leaf's BRDF, everything checked.
#[inline(always)]
pub(crate) fn leaf_at(leaf: &lb_leaf, pair: &Pair<Number>, out: &mut MaybeUninit<f32>) -> lb_status {
    let brdf = pair.leaf(
        || number(afresh(leaf).k_lambert),
        || number(afresh(leaf).n),
        || number(afresh(leaf).sigma),
        || afresh(leaf).checked_normalization(),
    );
    out.write(float(brdf));
    LB_OK
}

/// BRDF and its exact derivatives with respect to k_L, n and sigma, sr^-1.
#[unsafe(no_mangle)]
pub extern "C" fn lb_brdf_gradient(
    leaf: Option<&lb_leaf>,
    at: Option<&lb_cosines>,
    gradient: Option<&mut MaybeUninit<lb_gradient>>,
) -> lb_status {
    let (Some(leaf), Some(at), Some(out)) = (leaf, at, gradient) else { return LB_ERR_NULL };
    let value = || {
        let leaf = Leaf::new(number(leaf.k_lambert), leaf.surface()?).map_err(|_| LB_ERR_K_LAMBERT)?;
        let geometry = Geometry::from_cosines(at.numbers()).map_err(named)?;
        let gradient = leaf.brdf_with_gradient(&geometry);
        Ok(lb_gradient {
            value: float(gradient.value),
            d_k_lambert: float(gradient.d_k_lambert),
            d_n: float(gradient.d_n),
            d_sigma: float(gradient.d_sigma),
        })
    };
    give(out, value())
}

/// BRDF of a leaf in sr^-1 from angles in degrees.
///
/// - theta_s_deg, theta_v_deg: zenith angles of illumination and view, 0 <= theta < 90 degrees.
/// - phi_v_deg: azimuth of the view from the illumination, -360 to 360 degrees; 180 is the forward, specular side.
///
/// Where directions are fixed, a table of lb_direction and lb_brdf_at are several times faster.
///
/// Example: laurel (k_lambert 0, n 1.22, sigma 0.078, LB_BOUSQUET_2005) at 60, 60, 180 degrees gives 1.25 sr^-1.
#[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
#[unsafe(no_mangle)]
pub extern "C" fn lb_brdf_from_degrees(
    leaf: Option<&lb_leaf>,
    theta_s_deg: f32,
    theta_v_deg: f32,
    phi_v_deg: f32,
    brdf: Option<&mut MaybeUninit<f32>>,
) -> lb_status {
    let (Some(leaf), Some(out)) = (leaf, brdf) else { return LB_ERR_NULL };
    let directions = Degrees::new(number(theta_s_deg), number(theta_v_deg), number(phi_v_deg));
    let pair = || {
        leaf.check_k_lambert()?;
        leaf.surface()?;
        directions.pair().map_err(direction)
    };
    match pair() {
        Ok(pair) => leaf_at(afresh(leaf), &pair, out),
        Err(status) => status,
    }
}
