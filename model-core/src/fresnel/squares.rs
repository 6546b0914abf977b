//! F at a real index by e = n² − 1 and the cosine of incidence, in the fewest operations: for devices.
//!
//! With q = c √(e + c²) and m = 1 − c² = sin²θ_a the two amplitudes of `fresnel.rs` are
//!
//! ```text
//!             e                 q − m                                ⎛           e            ⎞²
//! r_s = ─────────────    r_p = ─────── r_s   so that   F = (q² + m²) ⎜ ────────────────────── ⎟
//!       e + 2 (q + c²)          q + m                                ⎝ (e + 2 (q + c²))(q + m) ⎠
//! ```
//!
//! which nothing cancels in, and c itself does not stand in.

use crate::Real;

/// e = n² − 1 of a checked index, with the digits that it has near n = 1.
#[inline(always)]
pub fn excess<T: Real>(n: T) -> T {
    (n - T::one()) * (n + T::one())
}

/// What F is made of.
struct Parts<T> {
    /// q²
    q2: T,
    q: T,
    m: T,
    /// q + c²
    t: T,
    /// e + 2 (q + c²)
    a: T,
    /// q + m
    d: T,
}

impl<T: Real> Parts<T> {
    #[inline(always)]
    fn new(e: T, c2: T) -> Self {
        let q2 = c2 * (e + c2);
        let m = T::one() - c2;
        let q = q2.sqrt();
        let t = q + c2;
        Parts { q2, q, m, t, a: e + t + t, d: q + m }
    }

    /// F by r = e/(a d).
    #[inline(always)]
    fn fresnel(&self, r: T) -> T {
        (self.q2 + self.m.squared()) * r.squared()
    }
}

/// F, unitless, in [0, 1].
///
/// - `e`: n² − 1 ≥ 0.
/// - `c2`: cos²θ_a, above 0; a rounding above 1 does no harm.
#[inline(always)]
pub fn fresnel<T: Real>(e: T, c2: T) -> T {
    let parts = Parts::new(e, c2);
    parts.fresnel(e / (parts.a * parts.d))
}

/// [`fresnel`] also where there is no surface, n = 1, at grazing incidence, c = 0: 0.
#[inline(always)]
pub fn fresnel_anywhere<T: Real>(e: T, c2: T) -> T {
    let parts = Parts::new(e, c2);
    let a_d = parts.a * parts.d;
    parts.fresnel(if a_d > T::ZERO { e / a_d } else { T::ZERO })
}

/// The same to the last bit, and ∂F/∂e.
#[inline(always)]
pub fn fresnel_with_slope<T: Real>(e: T, c2: T) -> (T, T) {
    let parts = Parts::new(e, c2);
    let Parts { q2, q, m, t, a, d } = parts;
    let a_d = a * d;
    let r = if a_d > T::ZERO { e / a_d } else { T::ZERO };
    let f = parts.fresnel(r);
    let a_d_q = a_d * q;
    let inverse = if a_d_q > T::ZERO { T::ONE / a_d_q } else { T::ZERO };
    let inverse_a_d = inverse * q;
    // ∂q/∂e
    let q1 = T::HALF * c2 * (inverse * a_d);
    let rest = t - e * q1;
    let twice = rest * d * (q2 + m.squared()) * r * inverse_a_d.squared() * T::TWO - f * (q1 * a * inverse_a_d);
    (f, c2 * r.squared() + (twice + twice))
}

/// F and ∂F/∂ln e, for a fit that moves in ln e. With q' = ∂q/∂ln e = e c²/(2q)
///
/// ```text
/// ∂F                        ⎛ 2 (q + c² − q')    q'  ⎞
/// ───── = 2 q q' r² + 2 F · ⎜ ─────────────── − ──── ⎟      r = e/(a d)
/// ∂ln e                     ⎝        a            d  ⎠
/// ```
///
/// - `e`: n² − 1 > 0.
/// - `c2`: cos²θ_a in (0, 1].
#[inline(never)]
pub fn fresnel_with_log_slope<T: Real>(e: T, c2: T) -> (T, T) {
    let parts = Parts::new(e, c2);
    let Parts { q, t, a, d, .. } = parts;
    let a_d = a * d;
    // one division for all
    let inverse = T::ONE / (a_d * q);
    let inverse_a_d = inverse * q;
    let r = e * inverse_a_d;
    let f = parts.fresnel(r);
    let q_q1 = T::HALF * (e * c2);
    let q1 = q_q1 * (inverse * a_d);
    let rest = t - q1;
    let half = q_q1 * r.squared() + f * inverse_a_d * ((rest + rest) * d - q1 * a);
    (f, half + half)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use crate::real::device::F32;
    use crate::{Dielectric, Index};

    const INDICES: [f64; 7] = [1.0001, 1.1, 1.5, 2.2, 5.0, 100.0, 16384.0];
    const COSINES: [f64; 6] = [1e-3, 0.1, 0.42, 0.7, 0.999, 1.0];

    #[test]
    fn f_and_its_slope_are_those_of_the_model() {
        for n in INDICES {
            for c in COSINES {
                let e = super::excess(n);
                let (expected, d_n) = Dielectric::new(n).unwrap().fresnel_with_slope(c);
                // dn/d ln e = e/(2n)
                let expected_slope = 0.5 * (n * n - 1.0) / n * d_n;
                let (f, by_e) = super::fresnel_with_slope(e, c * c);
                assert!((2.0 * n * by_e - d_n).abs() < 1e-9 * f, "{n} {c}: {by_e} {d_n}");
                assert_eq!(f, super::fresnel_anywhere(e, c * c));
                assert_eq!(f, super::fresnel(e, c * c));
                assert!((f / expected - 1.0).abs() < 2e-14, "{n} {c}: {f} {expected}");
                let (f, slope) = super::fresnel_with_log_slope(e, c * c);
                assert!((f / expected - 1.0).abs() < 1e-10, "{n} {c}: {f} {expected}");
                assert!((slope - expected_slope).abs() < 1e-9 * f, "{n} {c}: {slope} {expected_slope}");
            }
        }
    }

    #[test]
    fn in_single_precision_f_has_no_cancellation_either() {
        let mut worst = 0.0_f64;
        for i in 0..4000 {
            let n = F32(1.0 + 1e-4 * 1.002_f32.powi(i % 2000));
            let c2 = F32(1.0 / (1.0 + 0.01 * (i / 7) as f32));
            let exact = Dielectric::new(f64::from(n.0)).unwrap().fresnel(f64::from(c2.0).sqrt());
            let f = super::fresnel(super::excess(n), c2);
            worst = worst.max((f64::from(f.0) / exact - 1.0).abs());
        }
        std::println!("F in single precision: {worst:.2e}");
        assert!(worst < 1.2e-6, "{worst:e}");
    }

    #[test]
    fn grazing_incidence_reflects_all_or_nothing() {
        assert_eq!(super::fresnel_anywhere(F32(1.25), F32(0.0)).0, 1.0);
        assert_eq!(super::fresnel_with_slope(F32(1.25), F32(0.0)), (F32(1.0), F32(0.0)));
        assert_eq!(super::fresnel_anywhere(F32(0.0), F32(0.0)).0, 0.0);
        assert_eq!(super::fresnel_with_slope(F32(0.0), F32(0.0)), (F32(0.0), F32(0.0)));
    }

    #[test]
    fn there_is_no_surface_at_n_1_and_every_square_of_a_cosine_gives_a_share() {
        for c2 in [1e-18_f32, 1e-9, 0.25, 1.0, 1.0 + 2.0 * f32::EPSILON] {
            assert_eq!(super::fresnel(F32(0.0), F32(c2)).0, 0.0, "{c2:e}");
            let (_, slope) = super::fresnel_with_slope(F32(0.0), F32(c2));
            assert_eq!(slope.0, 0.0, "{c2:e}");
            for n in INDICES {
                let f = super::fresnel(super::excess(F32(n as f32)), F32(c2)).0;
                assert!((0.0..=1.000_001).contains(&f), "{n} {c2:e}: {f}");
            }
        }
    }
}
