//! What one pass over the directions gives: sums of the lobe, or of its derivatives, and of what they leave of the data.

use leafbrdf_core::Real;

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

/// F and ∂F/∂ln e at a real index, e = n² − 1, under the cosine of incidence c.
///
/// With g = √(e + c²): r_s = e/(g + c)² and e ∂r_s/∂e = r_s c/g; r_p likewise. One division serves them all.
#[inline(never)]
pub(super) fn fresnel<T: Real>(e: T, c: T) -> (T, T) {
    let c2 = c.squared();
    let g = (e + c2).sqrt();
    let u = g + c;
    let v = (e * c + c) + g;
    let (u2, v2) = (u.squared(), v.squared());
    let u2_v2 = u2 * v2;
    let inverse = T::ONE / (u2_v2 * g);
    let e_g_inverse = e * g * inverse;
    let r_s = e_g_inverse * v2;
    let q = e_g_inverse * u2;
    let c_g = c * inverse * u2_v2;
    let r_p = q * (e * c2 + (T::TWO * c2 - T::ONE));
    let r_s2 = r_s.squared();
    let f = T::HALF * (r_s2 + r_p.squared());
    // e + 2c² − 1
    let slope = c_g * (r_s2 + r_p * q * (e + (T::TWO * c2 - T::ONE)));
    (f, slope)
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
/// The scan (`kappa` is 0): u = D₀ F, v = D₀ ∂F/∂ln e for σ² and its halves, D₀ = exp(−tan²α/σ²)(1 + tan²α)² weight; the rung's factor
/// 1/(πσ²) is left out, and from rung to rung the exponential is squared `squarings` times. d = y − a.
///
/// The search (`kappa` is 1/(πσ²)), for one set of sums: u = ∂s/∂ln e, v = ∂s/∂ln σ of the lobe s. d = y − a − s.
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
    let searching = kappa > T::ZERO;
    let negligible = if searching { T::ZERO } else { T::lit(NEGLIGIBLE) };
    for sums in sums.iter_mut() {
        *sums = Sums { u: zero, v: zero, u_u: zero, u_v: zero, v_v: zero, d_u: zero, d_v: zero };
    }
    let Data { directions, band } = data;
    let terms = directions.cos_theta_a.iter().zip(directions.tan2_alpha).zip(directions.weight);
    for ((((cos_theta_a, tan2_alpha), weight), y), w) in terms.zip(band.brdf).zip(band.weight) {
        let (f, slope) = fresnel(e, *cos_theta_a);
        let base = *weight * (T::ONE + *tan2_alpha).squared();
        let tau = *tan2_alpha * inv_sigma2;
        let mut lobe = (-tau).exp();
        let (mut u, mut v) = (base * f, base * slope);
        let mut d = *y - a;
        if searching {
            lobe *= kappa;
            // ∂ ln D/∂ ln σ = 2 (tan²α/σ² − 1)
            d -= lobe * u;
            (u, v) = (v, u * (T::TWO * tau - T::TWO));
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

#[cfg(test)]
mod tests {
    use leafbrdf_core::{Dielectric, Index};

    #[test]
    fn f_and_its_slope_are_those_of_the_model() {
        for n in [1.0001, 1.1, 1.5, 2.2, 5.0, 100.0_f64] {
            for c in [1e-3, 0.1, 0.42, 0.7, 1.0] {
                let (f, slope) = super::fresnel((n - 1.0) * (n + 1.0), c);
                let (expected, d_n) = Dielectric::new(n).unwrap().fresnel_with_slope(c);
                // dn/d ln e = e/(2n)
                let expected_slope = 0.5 * (n * n - 1.0) / n * d_n;
                assert!((f / expected - 1.0).abs() < 1e-10, "{n} {c}: {f} {expected}");
                assert!((slope - expected_slope).abs() < 1e-9 * f, "{n} {c}: {slope} {expected_slope}");
            }
        }
    }
}
