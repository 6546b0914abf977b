//! t_av(α, n): how much isotropic light a smooth interface lets through (Stern 1964; Allen 1973).

use leafbrdf_core::Real;

use crate::both::{numbers, single};

/// Average transmissivity of a plane interface for light arriving from air evenly within a cone, unitless.
///
/// t_av = 1 − (1/sin²α) ∫₀^α F(θ; n) 2 sin θ cos θ dθ, with F the unpolarised Fresnel reflectance: Stern's definition,
/// which Allen solved in closed form. That form subtracts nearly equal numbers as n → 1 or α → 0. Here the integral is taken
/// numerically, by 32 Gauss–Legendre nodes in w, where cos θ = √(n²−1) sinh w: F and the weight become exponentials of w,
/// smooth for every n, and every term is positive.
///
/// - `cone_deg`: half opening angle α of the cone, degrees, in (0, 90]. PROSPECT uses 40 above the leaf, 90 inside.
/// - `n`: refractive index relative to air, ≥ 1.
///
/// Outside these domains the result is NaN.
///
/// Accuracy, `f64`: 2e-15 for 1 ≤ n ≤ 3 and any cone, against 30-digit integration (`tests/golden/t_av_reference.csv`).
///
/// # Example
///
/// At nearly normal incidence glass (n = 1.5) reflects 4 %; PROSPECT's 40° cone hardly changes that.
///
/// ```
/// use leafbrdf_prospect::interface::t_av;
/// assert!((t_av(0.1_f64, 1.5) - 0.96).abs() < 1e-6);
/// assert!((t_av(40.0_f64, 1.5) - 0.9584).abs() < 1e-4);
/// ```
pub fn t_av<T: Real>(cone_deg: T, n: T) -> T {
    let cone = cone_deg * (T::PI / T::lit(180.0));
    if !(n >= T::ONE && cone_deg > T::ZERO && cone_deg <= T::lit(90.0)) {
        return T::lit(f64::NAN);
    }
    let (sin_cone, cos_cone) = cone.sin_cos();
    // cos 90° is 6e-17 in floating point; the integral starts at the horizon itself.
    let cos_cone = if cone_deg < T::lit(90.0) { cos_cone } else { T::ZERO };
    t_av_within(sin_cone, cos_cone, n)
}

/// [`t_av`] from the sine and cosine of the cone's half angle, for n ≥ 1.
pub(crate) fn t_av_within<T: Real>(sin_cone: T, cos_cone: T, n: T) -> T {
    // m² = n² − 1; without a step in index there is nothing to reflect.
    let m2 = (n - T::ONE) * (n + T::ONE);
    if m2 <= T::ZERO {
        return T::ONE;
    }

    // θ from 0 (cos θ = 1) to α. E = e^(−2w) is the s-amplitude (g−c)/(g+c): at normal incidence (n−1)/(n+1).
    // sinh(w(0) − w(α)) = sin²α / (cos 0 · g(α) + cos α · g(0)), g = √(m² + cos²θ): no difference of large numbers.
    let sinh_width = sin_cone.squared() / ((m2 + cos_cone.squared()).sqrt() + cos_cone * n);
    let width = ln_1p(sinh_width + sinh_width.squared() / (T::ONE + (T::ONE + sinh_width.squared()).sqrt()));
    let e_normal = (n - T::ONE) / (n + T::ONE);

    let mut reflected = T::ZERO;
    let mut arriving = T::ZERO;
    let nodes = numbers::<T, 16>(&NODES, const { &single(NODES) });
    for (node, weight) in nodes.zip(numbers::<T, 16>(&WEIGHTS, const { &single(WEIGHTS) })) {
        for side in [T::HALF - T::HALF * node, T::HALF + T::HALF * node] {
            // from normal incidence towards the edge of the cone
            let e = e_normal * (T::TWO * width * side).exp();
            let e2 = e.squared();
            // p-amplitude: [m²(1−E) − 2E] / [m²(1−E) + 2]
            let m2_rest = m2 * (T::ONE - e);
            let r_p = (m2_rest - e - e) / (m2_rest + T::TWO);
            let fresnel = T::HALF * (e2 + r_p.squared());
            // 2 cos θ d(cos θ) = m² sinh 2w dw, up to a constant factor
            let arrives = weight * (T::ONE - e2) / e;
            reflected += arrives * fresnel;
            arriving += arrives;
        }
    }
    T::ONE - reflected / arriving
}

/// ln(1 + u) for u ≥ 0, to full relative precision.
#[inline(always)]
pub(crate) fn ln_1p<T: Real>(u: T) -> T {
    let w = T::ONE + u;
    // What the addition lost. For u < 1 it enters ln w at first order (its own next order is below rounding); for larger u it
    // is below the rounding of ln w, and dividing it by w would be needed to say more.
    let lost = if u < T::ONE { u - (w - T::ONE) } else { T::ZERO };
    w.ln() + lost
}

/// Positive nodes of 32-point Gauss–Legendre quadrature on [−1, 1] (roots of P₃₂ found in 40 digits).
const NODES: [f64; 16] = [
    0.04830766568773832,
    0.1444719615827965,
    0.23928736225213706,
    0.33186860228212767,
    0.42135127613063533,
    0.5068999089322294,
    0.5877157572407623,
    0.6630442669302152,
    0.7321821187402897,
    0.7944837959679424,
    0.84936761373257,
    0.8963211557660521,
    0.9349060759377397,
    0.9647622555875064,
    0.9856115115452684,
    0.9972638618494816,
];

/// Their weights.
const WEIGHTS: [f64; 16] = [
    0.0965400885147278,
    0.09563872007927486,
    0.09384439908080457,
    0.09117387869576389,
    0.08765209300440381,
    0.08331192422694675,
    0.07819389578707031,
    0.0723457941088485,
    0.06582222277636185,
    0.058684093478535544,
    0.050998059262376175,
    0.04283589802222668,
    0.03427386291302143,
    0.02539206530926206,
    0.01627439473090567,
    0.007018610009470096,
];
