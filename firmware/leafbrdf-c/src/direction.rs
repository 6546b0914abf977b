//! Directions prepared once, for tables: what one pair of directions contributes, whatever the leaf.

use core::mem::MaybeUninit;

use leafbrdf_core::{Degrees, DirectionTerms, Refused};

use crate::number::{Number, float, number};
use crate::status::{LB_ERR_NULL, lb_status};
use crate::surface::{self, give, lb_cosines, lb_leaf};

/// One pair of directions, prepared: three numbers that lb_brdf_at and (as arrays) the fit read.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lb_direction {
    /// Cosine of the incidence angle on the facet.
    pub cos_theta_a: f32,
    /// Squared tangent of the facet's tilt.
    pub tan2_alpha: f32,
    /// pi G/(K cos theta_s cos theta_v), the constant K of the normalization included.
    pub lobe_weight: f32,
}

impl lb_direction {
    #[inline(always)]
    fn new(terms: Result<DirectionTerms<Number>, Refused>) -> Result<Self, lb_status> {
        let terms = terms.map_err(surface::direction)?;
        Ok(lb_direction {
            cos_theta_a: float(terms.cos_theta_a),
            tan2_alpha: float(terms.tan2_alpha),
            lobe_weight: float(terms.weight),
        })
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
    let directions = Degrees::new(number(theta_s_deg), number(theta_v_deg), number(phi_v_deg));
    let value =
        || lb_direction::new(DirectionTerms::try_at_degrees(directions, surface::normalization(normalization)?));
    give(out, value())
}

/// Prepares one pair of directions from sines and cosines.
#[unsafe(no_mangle)]
pub extern "C" fn lb_direction_from_cosines(
    at: Option<&lb_cosines>,
    normalization: u32,
    direction: Option<&mut MaybeUninit<lb_direction>>,
) -> lb_status {
    let (Some(at), Some(out)) = (at, direction) else { return LB_ERR_NULL };
    let value =
        || lb_direction::new(DirectionTerms::try_at_cosines(&at.numbers(), surface::normalization(normalization)?));
    give(out, value())
}

/// BRDF of a leaf in sr^-1 at a prepared direction: the cheapest way. The direction's normalization holds; that of the
/// leaf must be a valid one, and is not looked at otherwise. The direction is not checked.
#[unsafe(no_mangle)]
pub extern "C" fn lb_brdf_at(
    leaf: Option<&lb_leaf>,
    at: Option<&lb_direction>,
    brdf: Option<&mut MaybeUninit<f32>>,
) -> lb_status {
    let (Some(leaf), Some(at), Some(out)) = (leaf, at, brdf) else { return LB_ERR_NULL };
    let value = || {
        leaf.check_k_lambert()?;
        let surface = leaf.surface()?;
        let terms = DirectionTerms {
            cos_theta_a: number(at.cos_theta_a),
            tan2_alpha: number(at.tan2_alpha),
            weight: number(at.lobe_weight),
        };
        Ok(float(leaf.diffuse() + terms.brdf(surface.index(), surface.sigma())))
    };
    give(out, value())
}
