//! Directions prepared once, for tables: what one pair of directions contributes, whatever the leaf.

use core::mem::MaybeUninit;

use leafbrdf_core::{Dielectric, DirectionTerms, Geometry, Real};

use crate::number::{Number, float, number};
use crate::status::{LB_ERR_K_LAMBERT, LB_ERR_N, LB_ERR_NULL, LB_ERR_SIGMA, lb_status};
use crate::surface::{from_degrees, give, lb_cosines, lb_leaf, normalization};

/// One pair of directions, prepared: three numbers that the fit and lb_brdf_at read. Keep it in a constant table.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lb_direction {
    /// Cosine of the incidence angle on the facet.
    pub cos_theta_a: f32,
    /// Squared tangent of the facet's tilt.
    pub tan2_alpha: f32,
    /// pi G/(K cos theta_s cos theta_v), the constant K of the normalization included.
    pub weight: f32,
}

impl lb_direction {
    fn new(geometry: &Geometry<Number>, code: u32) -> Result<Self, lb_status> {
        let terms = DirectionTerms::new(geometry, normalization(code)?);
        Ok(lb_direction {
            cos_theta_a: float(terms.cos_theta_a),
            tan2_alpha: float(terms.tan2_alpha),
            weight: float(terms.weight),
        })
    }

    /// As the model reads it.
    #[inline(always)]
    pub(crate) fn terms(&self) -> DirectionTerms<Number> {
        DirectionTerms {
            cos_theta_a: number(self.cos_theta_a),
            tan2_alpha: number(self.tan2_alpha),
            weight: number(self.weight),
        }
    }
}

/// Prepares one pair of directions from angles in degrees (ranges as in lb_brdf_from_degrees).
///
/// - normalization: LB_BOUSQUET_2005 or LB_COOK_TORRANCE; n and sigma fitted with these directions belong to it.
#[unsafe(no_mangle)]
pub extern "C" fn lb_direction_from_degrees(
    theta_s_deg: f32,
    theta_v_deg: f32,
    phi_v_deg: f32,
    normalization: u32,
    direction: Option<&mut MaybeUninit<lb_direction>>,
) -> lb_status {
    let Some(out) = direction else { return LB_ERR_NULL };
    let geometry = from_degrees(theta_s_deg, theta_v_deg, phi_v_deg);
    give(out, geometry.and_then(|geometry| lb_direction::new(&geometry, normalization)))
}

/// Prepares one pair of directions from sines and cosines.
#[unsafe(no_mangle)]
pub extern "C" fn lb_direction_from_cosines(
    at: Option<&lb_cosines>,
    normalization: u32,
    direction: Option<&mut MaybeUninit<lb_direction>>,
) -> lb_status {
    let (Some(at), Some(out)) = (at, direction) else { return LB_ERR_NULL };
    give(out, at.checked().and_then(|geometry| lb_direction::new(&geometry, normalization)))
}

/// BRDF of a leaf in sr^-1 at a prepared direction: the cheapest way. The direction's normalization holds; that of the
/// leaf is not looked at.
#[unsafe(no_mangle)]
pub extern "C" fn lb_brdf_at(
    leaf: Option<&lb_leaf>,
    at: Option<&lb_direction>,
    brdf: Option<&mut MaybeUninit<f32>>,
) -> lb_status {
    let (Some(leaf), Some(at), Some(out)) = (leaf, at, brdf) else { return LB_ERR_NULL };
    let value = |leaf: &lb_leaf| {
        let index = Dielectric::new(number(leaf.n)).map_err(|_| LB_ERR_N)?;
        if !(leaf.sigma >= 1e-9 && leaf.sigma <= 1e3) {
            return Err(LB_ERR_SIGMA);
        }
        if !(leaf.k_lambert >= 0.0 && leaf.k_lambert <= 1.0) {
            return Err(LB_ERR_K_LAMBERT);
        }
        let diffuse = number(leaf.k_lambert) * Number::lit(core::f64::consts::FRAC_1_PI);
        Ok(float(diffuse + at.terms().brdf(index, number(leaf.sigma))))
    };
    give(out, value(leaf))
}
