//! A leaf that does not lie level in its holder: the same two directions, seen from a tilted normal.

use super::{DirectionCosines, Geometry, pair, zenith};
use crate::{Angle, DomainError, Real};

/// The tilt of the leaf normal against the instrument's: n = m/|m| with m = (tan t_x, tan t_y, 1), x towards the source.
///
/// ```
/// use leafbrdf_core::{Angle, Geometry, Tilt};
/// // leaning by 5° towards a source at 40°, the leaf sees it at 35°, and receives that much more of its light
/// let deg = Angle::from_degrees;
/// let tilt = Tilt::new(deg(5.0_f64), deg(0.0))?;
/// let tilted = Geometry::tilted(deg(40.0), deg(20.0), deg(180.0), &tilt)?;
/// assert!((tilted.geometry().cos_theta_s() - deg(35.0).cos()).abs() < 1e-15);
/// assert!((tilted.geometry().cos_theta_v() - deg(25.0).cos()).abs() < 1e-15);
/// assert!((tilted.factor() - deg(35.0).cos() / deg(40.0).cos()).abs() < 1e-15);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt<T> {
    in_plane: Angle<T>,
    lateral: Angle<T>,
    tan_x: T,
    tan_y: T,
    /// 1/|m|
    inverse_length: T,
}

impl<T: Real> Tilt<T> {
    /// From the two angles: `in_plane` t_x > 0 leans the normal towards the source, `lateral` t_y > 0 towards φ_v = 90°.
    ///
    /// # Errors
    /// [`DomainError`] unless both lie within ±80°.
    pub fn new(in_plane: Angle<T>, lateral: Angle<T>) -> Result<Self, DomainError> {
        const EXPECTED: &str = "-80° ≤ tilt ≤ 80°";
        let largest = T::lit(1.396_263_5);
        if !(in_plane.is_finite() && in_plane.radians().abs() <= largest) {
            return Err(DomainError::new("in_plane", EXPECTED));
        }
        if !(lateral.is_finite() && lateral.radians().abs() <= largest) {
            return Err(DomainError::new("lateral", EXPECTED));
        }
        let (tan_x, tan_y) = (in_plane.tan(), lateral.tan());
        let inverse_length = T::ONE / (T::ONE + tan_x.squared() + tan_y.squared()).sqrt();
        Ok(Tilt { in_plane, lateral, tan_x, tan_y, inverse_length })
    }

    /// t_x, the tilt in the plane of incidence.
    #[inline(always)]
    pub fn in_plane(&self) -> Angle<T> {
        self.in_plane
    }

    /// t_y, the tilt across the plane of incidence.
    #[inline(always)]
    pub fn lateral(&self) -> Angle<T> {
        self.lateral
    }

    /// The unit normal (n_x, n_y, n_z) of the leaf: x towards the source's azimuth, z along the instrument's normal.
    #[inline(always)]
    pub fn normal(&self) -> [T; 3] {
        [self.tan_x * self.inverse_length, self.tan_y * self.inverse_length, self.inverse_length]
    }
}

/// One pair of directions as vectors in the instrument's frame: computed once, seen from any number of tilted normals with
/// no trigonometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionVectors<T> {
    sin_theta_s: T,
    cos_theta_s: T,
    inverse_cos_theta_s: T,
    tan_theta_s: T,
    view: [T; 3],
    /// s + v
    sum: [T; 3],
    cos_theta_a: T,
    sin2_theta_a: T,
}

impl<T: Real> DirectionVectors<T> {
    /// From the three angles, as [`Geometry::from_angles`].
    ///
    /// # Errors
    /// [`DomainError`] for an angle outside its range, the instrument's horizon included, and for NaN.
    pub fn from_angles(theta_s: Angle<T>, theta_v: Angle<T>, phi_v: Angle<T>) -> Result<Self, DomainError> {
        let level = Geometry::from_angles(theta_s, theta_v, phi_v)?;
        let (sin_theta_s, cos_theta_s) = zenith(theta_s, "theta_s")?;
        let (sin_theta_v, cos_theta_v) = zenith(theta_v, "theta_v")?;
        let (sin_half, cos_half) = theta_s.half_difference(theta_v).sin_cos();
        let (sin_half_phi, cos_half_phi) = phi_v.scaled(T::HALF).sin_cos();
        let sum_z = cos_theta_s + cos_theta_v;
        // sinθ_s − sinθ_v = (cosθ_s + cosθ_v) tan((θ_s − θ_v)/2): near the mirror direction the sum has its digits
        let sum_x = sum_z * (sin_half / cos_half) + T::TWO * (sin_theta_v * cos_half_phi.squared());
        let view_y = T::TWO * (sin_theta_v * (sin_half_phi * cos_half_phi));
        let view_x = sin_theta_v * (cos_half_phi.squared() - sin_half_phi.squared());
        Ok(DirectionVectors {
            sin_theta_s,
            cos_theta_s,
            inverse_cos_theta_s: T::ONE / cos_theta_s,
            tan_theta_s: sin_theta_s / cos_theta_s,
            view: [view_x, view_y, cos_theta_v],
            sum: [sum_x, view_y, sum_z],
            cos_theta_a: level.cos_theta_a,
            sin2_theta_a: level.sin2_theta_a,
        })
    }

    /// From sines and cosines, as [`Geometry::from_cosines`]; a lateral tilt needs sin φ_v too.
    ///
    /// # Errors
    /// [`DomainError`] for a value outside its range, for NaN, and where a sine and a cosine do not belong together.
    pub fn from_cosines(directions: DirectionCosines<T>, sin_phi_v: T) -> Result<Self, DomainError> {
        let level = Geometry::from_cosines(directions)?;
        let DirectionCosines { cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v } = directions;
        pair(sin_phi_v.abs(), cos_phi_v.abs().max(T::EPSILON), "phi_v")?;
        let view_y = sin_theta_v * sin_phi_v;
        let sum_x = (sin_theta_s - sin_theta_v) + sin_theta_v * (T::ONE + cos_phi_v);
        Ok(DirectionVectors {
            sin_theta_s,
            cos_theta_s,
            inverse_cos_theta_s: T::ONE / cos_theta_s,
            tan_theta_s: sin_theta_s / cos_theta_s,
            view: [sin_theta_v * cos_phi_v, view_y, cos_theta_v],
            sum: [sum_x, view_y, cos_theta_s + cos_theta_v],
            cos_theta_a: level.cos_theta_a,
            sin2_theta_a: level.sin2_theta_a,
        })
    }

    /// The pair as the tilted leaf sees it: no trigonometry, no square root.
    ///
    /// With h = s + v and p = m × h: tan²α = |p|²/(m·h)², in which every component of p is a difference that vanishes on the
    /// tilted mirror direction with its digits kept.
    ///
    /// # Errors
    /// [`DomainError`] where the source or the view is on or below the tilted leaf's horizon; a fit drops such a view.
    #[inline]
    pub fn about(&self, tilt: &Tilt<T>) -> Result<Tilted<T>, DomainError> {
        let Tilt { tan_x, tan_y, inverse_length, .. } = *tilt;
        let ([view_x, view_y, view_z], [sum_x, sum_y, sum_z]) = (self.view, self.sum);
        let cos_theta_s = (self.sin_theta_s * tan_x + self.cos_theta_s) * inverse_length;
        let cos_theta_v = (view_x * tan_x + view_y * tan_y + view_z) * inverse_length;
        if !(cos_theta_s > T::ZERO) {
            return Err(DomainError::new("theta_s", "a source above the tilted leaf's horizon"));
        }
        if !(cos_theta_v > T::ZERO) {
            return Err(DomainError::new("theta_v", "a view above the tilted leaf's horizon"));
        }

        // p = m × h, m·h > 0 because both directions are above the horizon
        let p_x = tan_y * sum_z - sum_y;
        let p_y = sum_x - tan_x * sum_z;
        let p_z = tan_x * sum_y - tan_y * sum_x;
        let inverse_dot = T::ONE / (tan_x * sum_x + tan_y * sum_y + sum_z);
        let tan2_alpha = (p_x.squared() + p_y.squared() + p_z.squared()) * inverse_dot.squared();
        // cosθ_s'/cosθ_s; exactly 1 where there is no tilt
        let factor = (T::ONE + self.tan_theta_s * tan_x) * inverse_length;

        // d(tan t)/dt
        let (sec2_x, sec2_y) = (T::ONE + tan_x.squared(), T::ONE + tan_y.squared());
        // ∂n/∂m_x = (e_x − n_x n)/|m|
        let turn = |component: T, tan: T, cosine: T| (component - tan * inverse_length * cosine) * inverse_length;
        // ∂tan²α/∂m_x = 2 |h|²/(m·h)³ (m × p)_x and |h|² = 4 cos²θ_a
        let steepness = T::lit(8.0) * self.cos_theta_a.squared() * (inverse_dot * inverse_dot.squared());
        let slopes = |sec2: T, source: T, view: T, tan: T, m_cross_p: T| {
            let d_cos_theta_s = sec2 * turn(source, tan, cos_theta_s);
            TiltSlopes {
                cos_theta_s: d_cos_theta_s,
                cos_theta_v: sec2 * turn(view, tan, cos_theta_v),
                tan2_alpha: sec2 * (steepness * m_cross_p),
                factor: d_cos_theta_s * self.inverse_cos_theta_s,
            }
        };
        Ok(Tilted {
            geometry: Geometry {
                cos_theta_s,
                cos_theta_v,
                cos_theta_a: self.cos_theta_a,
                sin2_theta_a: self.sin2_theta_a,
                tan2_alpha,
            },
            factor,
            d_in_plane: slopes(sec2_x, self.sin_theta_s, view_x, tan_x, tan_y * p_z - p_y),
            d_lateral: slopes(sec2_y, T::ZERO, view_y, tan_y, p_x - tan_x * p_z),
        })
    }
}

/// How fast a tilted geometry changes with one of the two tilt angles, per radian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltSlopes<T> {
    /// ∂cosθ_s'/∂t.
    pub cos_theta_s: T,
    /// ∂cosθ_v'/∂t.
    pub cos_theta_v: T,
    /// ∂tan²α'/∂t.
    pub tan2_alpha: T,
    /// ∂(cosθ_s'/cosθ_s)/∂t.
    pub factor: T,
}

/// One pair of directions about a tilted normal. θ_a does not know of the tilt.
///
/// What an instrument with a level reference panel measures is [`factor`](Self::factor) · BRDF of
/// [`geometry`](Self::geometry).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilted<T> {
    geometry: Geometry<T>,
    factor: T,
    d_in_plane: TiltSlopes<T>,
    d_lateral: TiltSlopes<T>,
}

impl<T: Real> Tilted<T> {
    /// The geometry about the tilted normal.
    #[inline(always)]
    pub fn geometry(&self) -> &Geometry<T> {
        &self.geometry
    }

    /// cosθ_s'/cosθ_s: how much more light the tilted leaf receives than the level reference panel.
    #[inline(always)]
    pub fn factor(&self) -> T {
        self.factor
    }

    /// Slopes by t_x.
    #[inline(always)]
    pub fn d_in_plane(&self) -> &TiltSlopes<T> {
        &self.d_in_plane
    }

    /// Slopes by t_y.
    #[inline(always)]
    pub fn d_lateral(&self) -> &TiltSlopes<T> {
        &self.d_lateral
    }
}

impl<T: Real> Geometry<T> {
    /// The pair of directions about the normal of a tilted leaf, from the three angles in the instrument's frame.
    ///
    /// # Errors
    /// [`DomainError`] for an angle outside its range, and where the source or the view is on or below the tilted leaf's
    /// horizon.
    ///
    /// For many tilts of the same directions, see [`DirectionVectors`].
    pub fn tilted(
        theta_s: Angle<T>,
        theta_v: Angle<T>,
        phi_v: Angle<T>,
        tilt: &Tilt<T>,
    ) -> Result<Tilted<T>, DomainError> {
        DirectionVectors::from_angles(theta_s, theta_v, phi_v)?.about(tilt)
    }
}
