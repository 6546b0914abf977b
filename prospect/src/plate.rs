//! One elementary layer between two smooth faces (Allen et al. 1969): what it reflects, transmits and absorbs.

use leafbrdf_core::Real;

use crate::expint::Transmission;

/// The faces of a plate at one wavelength: transmissivities, unitless, from [`crate::interface::t_av`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface<T> {
    /// t_av(40°, n): from air into the leaf's upper face.
    pub t_alpha: T,
    /// t_av(90°, n): from air into any other face, light isotropic.
    pub t_90: T,
    /// t_av(90°, n)/n²: from inside back into air.
    pub t_21: T,
}

impl<T: Real> Interface<T> {
    /// The faces of a plate of refractive index `n` ≥ 1 under the cone that PROSPECT uses (40°).
    ///
    /// ```
    /// use leafbrdf_prospect::Interface;
    /// let faces = Interface::new(1.5_f64);
    /// assert!((faces.t_90 - 0.9082).abs() < 1e-4);
    /// ```
    #[must_use]
    pub fn new(n: T) -> Self {
        let t_90 = crate::interface::t_av(T::lit(90.0), n);
        Interface { t_alpha: crate::interface::t_av(T::lit(40.0), n), t_90, t_21: t_90 / n.squared() }
    }
}

/// A plate: fractions of the light that falls on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plate<T> {
    /// Reflectance and transmittance for isotropic light.
    pub r: T,
    pub t: T,
    /// 1 − r − t, without cancellation.
    pub a: T,
    /// The same for light within the cone, on the leaf's upper face.
    pub r_top: T,
    pub t_top: T,
    pub a_top: T,
    /// ρτ, ρ = 1 − t₂₁ being the reflectivity of a face from inside, and 1/(1 − ρ²τ²).
    pub rho_tau: T,
    pub inverse: T,
}

/// Slopes of a plate with respect to its absorption coefficient K.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlateSlope<T> {
    /// dr/dK and dR_top/dK.
    pub r: T,
    pub r_top: T,
    /// (dt/dK)/t = (dT_top/dK)/T_top: finite even where t itself underflows.
    pub log_t: T,
}

impl<T: Real> Plate<T> {
    #[inline(always)]
    pub(crate) fn new(faces: Interface<T>, layer: Transmission<T>) -> Self {
        let rho_tau = (T::ONE - faces.t_21) * layer.tau;
        //               1
        // inverse = ─────────,  factored because ρτ may be close to 1
        //           1 − ρ²τ²
        let inverse = T::ONE / ((T::ONE - rho_tau) * (T::ONE + rho_tau));
        let through = layer.tau * faces.t_21 * inverse;
        // 1 − r − t = t₉₀ (1−τ) / (1 − ρτ); with t_α in the place of t₉₀ for the upper face
        let held = layer.absorbed * (T::ONE + rho_tau) * inverse;
        let t = faces.t_90 * through;
        let t_top = faces.t_alpha * through;
        Plate {
            r: (T::ONE - faces.t_90) + rho_tau * t,
            t,
            a: faces.t_90 * held,
            r_top: (T::ONE - faces.t_alpha) + rho_tau * t_top,
            t_top,
            a_top: faces.t_alpha * held,
            rho_tau,
            inverse,
        }
    }

    /// - `log_slope`: (dτ/dK)/τ, from [`crate::expint::transmission_log_slope`].
    #[inline(always)]
    pub(crate) fn slope(&self, log_slope: T) -> PlateSlope<T> {
        //  d ln t    1 + ρ²τ²  d ln τ
        //  ────── = ───────── ──────,   and r = const + ρ τ t
        //    dK      1 − ρ²τ²    dK
        let log_t = log_slope * (T::ONE + self.rho_tau.squared()) * self.inverse;
        let both = self.rho_tau * (log_slope + log_t);
        PlateSlope { r: both * self.t, r_top: both * self.t_top, log_t }
    }
}
