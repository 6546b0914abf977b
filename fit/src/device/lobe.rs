//! What one pass over the directions gives: sums of the lobe, or of its derivatives, and of what they leave of the data.

use leafbrdf_core::Real;
use leafbrdf_core::facet::Falloff;
use leafbrdf_core::fresnel::squares::fresnel_with_log_slope;

use crate::band::{Band, Directions};

/// Sums over the directions, of two columns u and v and of d, what is left of the data: the normal equations of a linear problem
/// of three unknowns (the third column is 1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums<T> {
    pub u: T,
    pub v: T,
    pub u_u: T,
    pub u_v: T,
    pub v_v: T,
    pub d_u: T,
    pub d_v: T,
}

impl<T: Real> Sums<T> {
    pub const ZERO: Self =
        Sums { u: T::ZERO, v: T::ZERO, u_u: T::ZERO, u_v: T::ZERO, v_v: T::ZERO, d_u: T::ZERO, d_v: T::ZERO };

    #[inline(always)]
    fn add(&mut self, w: T, d: T, u: T, v: T) {
        let (w_u, w_v) = (w * u, w * v);
        self.u += w_u;
        self.v += w_v;
        self.u_u += w_u * u;
        self.u_v += w_u * v;
        self.v_v += w_v * v;
        self.d_u += w_u * d;
        self.d_v += w_v * d;
    }
}

/// What is measured, checked: five slices of one length.
#[derive(Clone, Copy)]
pub(super) struct Data<'a, T> {
    pub directions: Directions<'a, T>,
    pub band: Band<'a, T>,
}

/// What the data leave beside a (k_L/π) and, in a search, the lobe: Σ ω d and Σ ω d².
#[derive(Clone, Copy)]
pub(super) struct Rest<T> {
    pub d: T,
    pub d_d: T,
}

/// A rung of the scan adds nothing once its exponential is below this.
const NEGLIGIBLE: f64 = 1e-6;

/// One pass over the directions at `e` and σ². a is k_L/π.
///
/// The scan (`squarings` above 0, `kappa` the inverse of the exponential's gain): u = D₀ F, v = D₀ ∂F/∂ln e for σ² and its halves,
/// D₀ = exp(−tan²α/σ²)(1 + tan²α)² weight; the rung's factor 1/(πσ²) is left out, and from rung to rung the exponential is squared
/// `squarings` times. d = y − a.
///
/// The search (`squarings` is 0, `kappa` 1/(πσ²) over the gain), for one set of sums: u = ∂s/∂ln e, v = ∂s/∂ln σ of the lobe s.
/// d = y − a − s.
#[inline(never)]
pub(super) fn look<T: Real>(
    data: &Data<'_, T>,
    sums: &mut [Sums<T>],
    squarings: u32,
    e: T,
    inv_sigma2: T,
    kappa: T,
    a: T,
) -> Rest<T> {
    // a zero that the compiler does not know, or it would call memset
    #[expect(clippy::eq_op)]
    let zero = e - e;
    let mut rest = Rest { d: T::ZERO, d_d: T::ZERO };
    let searching = squarings == 0;
    let falloff = Falloff::new(inv_sigma2);
    let negligible = if searching { T::ZERO } else { T::lit(NEGLIGIBLE) };
    for sums in sums.iter_mut() {
        *sums = Sums { u: zero, v: zero, u_u: zero, u_v: zero, v_v: zero, d_u: zero, d_v: zero };
    }
    let Data { directions, band } = data;
    let terms = directions.cos_theta_a.iter().zip(directions.tan2_alpha).zip(directions.weight);
    for ((((cos_theta_a, tan2_alpha), weight), y), w) in terms.zip(band.brdf).zip(band.weight) {
        let (f, slope) = fresnel_with_log_slope(e, cos_theta_a.squared());
        let base = *weight * (T::ONE + *tan2_alpha).squared();
        let (decay, log_slope) = falloff.at(*tan2_alpha);
        let mut lobe = decay * kappa;
        let (mut u, mut v) = (base * f, base * slope);
        let mut d = *y - a;
        if searching {
            d -= lobe * u;
            (u, v) = (v, u * log_slope);
        }
        let w_d = *w * d;
        rest.d += w_d;
        rest.d_d += w_d * d;
        for sums in sums.iter_mut() {
            if lobe < negligible {
                break;
            }
            sums.add(*w, d, lobe * u, lobe * v);
            for _ in 0..squarings {
                lobe = lobe.squared();
            }
        }
    }
    rest
}
