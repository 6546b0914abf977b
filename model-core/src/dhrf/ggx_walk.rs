//! The nodes for GGX facets with Smith's masking: circles r = const in the plane of slopes.
//!
//! The density of slopes σ²/(π (σ² + r²)²), r² = x² + y², is round and Smith's masking has no kink: the only line in the
//! plane is the horizon of the views, a circle around (tan θ_s, 0). With c_s, c_v the cosines of source and view, r_s and r_v
//! Smith's radii and W = c_v r_s + c_s r_v,
//!
//! ```text
//! DHRF_spec = ∬ σ²/(π (σ² + r²)²) F (c_s + x sin θ_s) 2 c_v/W r dr dψ          (K = 4π)
//! c_v = 2 r sin θ_s (cos ψ − cos ψ_h)/(1 + r²),    cos ψ_h = (r² − 1)/(2 r tan θ_s)
//! ```
//!
//! - Whole circles, r < r₀ = tan(45° − θ_s/2): equal steps in ψ, as many as the nearest zero of c_v asks for, which are few
//!   on small circles. Along r the variable y = (1 + r²/σ²)^(−¼) flattens the heavy tail, and its square root about r₀
//!   resolves the layer where c_v is about σ.
//! - Arcs ψ < ψ_h, r₀ < r < 1/r₀: Gauss–Legendre in ψ, even about 0 and crowded at ψ_h; across them v = a/(1 + a),
//!   a = (r/σ)^(1/γ), which treats all scales between r₀, σ and 1/r₀ alike, in the sin² map anchored at both ends, in which
//!   ψ_h is nearly analytic.

use super::slopes::SlopePlane;
use super::table::Table;
use crate::Real;
use crate::masking::ellipsoid;

/// The constants of one grade.
#[derive(Clone, Copy)]
pub(super) struct GgxConstants {
    /// Circles: rows + rows_tail ln(1 + r₀²/σ²).
    pub(super) rows: f64,
    pub(super) rows_tail: f64,
    /// Nodes on a circle: around/(arcosh|cos ψ_h| + around_edge).
    pub(super) around: f64,
    pub(super) around_edge: f64,
    /// Arcs: arcs + arcs_grazing ln(1/r₀) − arcs_smooth ln(1 + r₀²/σ²).
    pub(super) arcs: f64,
    pub(super) arcs_grazing: f64,
    pub(super) arcs_smooth: f64,
    /// Nodes on an arc: along − along_smooth ln(1 + r₀²/σ²).
    pub(super) along: f64,
    pub(super) along_smooth: f64,
    /// Of the nodes on an arc: ψ/ψ_h = z (1 + crowd (1 − z²)), from 0 to ½.
    pub(super) crowd: f64,
    /// γ of the variable across the arcs.
    pub(super) gamma: f64,
}

impl GgxConstants {
    /// The largest order met for σ ≥ 0.01 and θ_s ≤ 89.9°; beyond, orders stay there.
    pub(super) const fn largest_order(&self) -> usize {
        // ln(1 + 100²) and ln tan(45° + 89.9°/2)
        let rows = self.rows + 9.2104 * self.rows_tail;
        let arcs = self.arcs + 7.0442 * self.arcs_grazing;
        let along = 2.0 * (self.along * (1.0 + ROUGH_ALONG) + 0.9999);
        let across = if rows > arcs { rows } else { arcs };
        let largest = (if across > along { across } else { along } + 0.9999) as usize;
        if largest < LARGEST_TABLE { largest } else { LARGEST_TABLE }
    }
}

/// Beyond σ = 1, per unit of σ: so many times the circles and the nodes along an arc more.
const ROUGH_ROWS: f64 = 0.8;
const ROUGH_ALONG: f64 = 0.35;

/// `nodes.rs` ends here.
const LARGEST_TABLE: usize = 64;

/// A grade as a type, so that a program links the tables of only the grades it names.
pub(super) trait GgxRule {
    const CONSTANTS: GgxConstants;
    /// The largest order of the table.
    const ORDERS: usize;
    const LEGENDRE: Table;
}

/// One node of the rule: a facet slope.
pub(super) struct GgxNode<T> {
    /// cos θ_a on the facet.
    pub(super) cos_theta_a: T,
    /// Weight of F there; the weights sum to the DHRF of facets that are perfect mirrors, F ≡ 1.
    pub(super) weight: T,
    /// σ ∂ ln(weight)/∂σ of the integrand.
    pub(super) log_slope: T,
}

/// What all nodes share.
struct Frame<T> {
    cos_s: T,
    sin_s: T,
    sigma2: T,
    sigma: T,
    /// r_s
    source: T,
}

impl<T: Real> Frame<T> {
    /// The node at slope (r cos ψ, r sin ψ); `excess` is (1 + r²) c_v.
    #[inline(always)]
    fn node(&self, r: T, cos_psi: T, excess: T, weight: T) -> GgxNode<T> {
        let Frame { cos_s, sin_s, sigma2, sigma, source } = *self;
        let r2 = r.squared();
        let inverse = T::ONE / (T::ONE + r2);
        // √(1 + r²) cos θ_a, > 0 wherever the view is above the horizon; the maxima absorb rounding there
        let cosine = (cos_s + r * cos_psi * sin_s).max(T::ZERO);
        let cos_v = (excess * inverse).max(T::ZERO).min(T::ONE);
        let view = ellipsoid(cos_v, sigma);
        let inverse_w = T::ONE / (cos_v * source + cos_s * view);
        let sin2_v = T::ONE - cos_v.squared();
        GgxNode {
            cos_theta_a: (cosine * inverse.sqrt()).min(T::ONE),
            weight: weight * cosine * (T::TWO * cos_v * inverse_w),
            log_slope: T::TWO * (r2 - sigma2) / (r2 + sigma2)
                - sigma2 * inverse_w * (cos_v * sin_s.squared() / source + cos_s * sin2_v / view),
        }
    }
}

/// Visits every node. Their number depends on θ_s, σ and the grade only; no search, no estimate, no recursion.
#[inline(always)]
pub(super) fn walk<T: Real, R: GgxRule>(plane: &SlopePlane<T>, sigma: T, mut visit: impl FnMut(GgxNode<T>)) {
    walk_with(&R::CONSTANTS, R::ORDERS, R::LEGENDRE, plane, sigma, &mut visit);
}

#[inline(always)]
pub(super) fn walk_with<T: Real>(
    c: &GgxConstants,
    orders: usize,
    legendre: Table,
    plane: &SlopePlane<T>,
    sigma: T,
    visit: &mut impl FnMut(GgxNode<T>),
) {
    let (cos_s, sin_s, tan_s) = (plane.cos_theta_s, plane.sin_theta_s, plane.tan_theta_s);
    let (x0, x1) = plane.horizon();
    let (near, far) = (-x0, x1);
    let sigma2 = sigma.squared();
    let source = (cos_s.squared() + sigma2 * sin_s.squared()).sqrt();
    let frame = Frame { cos_s, sin_s, sigma2, sigma, source };

    // u = 1/(1 + r²/σ²) at r₀, and its complement; neither loses digits
    let reach2 = (near / sigma).squared();
    let u_near = T::ONE / (T::ONE + reach2);
    let rest_near = reach2 * u_near;
    let log_reach = (T::ONE + reach2).ln();

    let root_near = u_near.sqrt();
    let y_near = root_near.sqrt();
    let span = rest_near / ((T::ONE + y_near) * (T::ONE + root_near));
    // On very rough surfaces the scale of the integrand is that of 1 + r², no longer σ. Nothing changes for σ ≤ 1.
    let excess = (sigma - T::ONE).max(T::ZERO).min(T::ONE);
    let rows =
        order_of(T::lit(c.rows) * (T::ONE + T::lit(ROUGH_ROWS) * excess) + T::lit(c.rows_tail) * log_reach, orders);
    legendre.whole(rows, |z: T, weight: T| {
        let q = T::HALF * (T::ONE + z);
        let y = y_near + span * q.squared();
        let y2 = y.squared();
        let rest = span * (T::HALF * (T::ONE - z)) * (T::ONE + q) * (T::ONE + y) * (T::ONE + y2);
        let r2 = sigma2 * rest / y2.squared();
        let r = r2.sqrt();
        // r dr σ²/(σ² + r²)² = −du/2, and u = y⁴: over 2π, averaged around the circle
        let weight = weight * q * span * T::lit(4.0) * (y * y2);
        // 1/|cos ψ_h|, at most 1; 0 at normal incidence, where one node is enough
        let nearness = (T::TWO * r * tan_s / (T::ONE - r2)).max(T::ZERO).min(T::ONE);
        let decay = ((T::ONE + (T::ONE - nearness.squared()).sqrt()) / nearness).ln();
        let around = order_of(T::lit(c.around) / (decay + T::lit(c.around_edge)), 2 * orders);
        let count = T::lit(around as f64);
        let weight = weight / count;
        let level = cos_s * (T::ONE - r2);
        // ψ = (j + ½) π/around: one sine and cosine for the circle, then rotations
        let (sin_half, cos_half) = (T::HALF * T::PI / count).sin_cos();
        let (sin_step, cos_step) = (T::TWO * sin_half * cos_half, T::ONE - T::TWO * sin_half.squared());
        let (mut sin_psi, mut cos_psi) = (sin_half, cos_half);
        for _ in 0..around {
            visit(frame.node(r, cos_psi, level + T::TWO * (r * sin_s) * cos_psi, weight));
            (sin_psi, cos_psi) = (sin_psi * cos_step + cos_psi * sin_step, cos_psi * cos_step - sin_psi * sin_step);
        }
    });

    if !(far > near) {
        return;
    }
    // a = (r/σ)^(1/γ) and v = a/(1 + a), each with its complement: no difference loses digits
    let gamma = T::lit(c.gamma);
    let root = |x: T| (x.ln() / gamma).exp();
    let (a_near, a_far) = (root(near / sigma), root(far / sigma));
    let v_near = a_near / (T::ONE + a_near);
    let rest_far = T::ONE / (T::ONE + a_far);
    let span = (a_far - a_near) * rest_far / (T::ONE + a_near);
    let arcs = order_of(T::lit(c.arcs) + T::lit(c.arcs_grazing) * far.ln() - T::lit(c.arcs_smooth) * log_reach, orders);
    let along = order_of(
        T::lit(c.along) * (T::ONE + T::lit(ROUGH_ALONG) * excess) - T::lit(c.along_smooth) * log_reach,
        orders / 2,
    );
    legendre.whole(arcs, |z: T, weight: T| {
        let (sin, cos) = (T::lit(core::f64::consts::FRAC_PI_4) * (T::ONE + z)).sin_cos();
        let v = v_near + span * sin.squared();
        let inverse_rest = T::ONE / (rest_far + span * cos.squared());
        let a = v * inverse_rest;
        let scaled = (gamma * a.ln()).exp();
        let r = sigma * scaled;
        // sin²(ψ_h/2); the limits absorb rounding at the two ends
        let half2 = ((far - r) * (r + near) / (T::lit(4.0) * r * tan_s)).max(T::ZERO).min(T::ONE);
        let half = half2.sqrt().asin();
        // With ρ = r/σ = a^γ: r dr σ²/(σ² + r²)² = γ ρ²/a dv/((1 + ρ²)² (1 − v)²), dv = 2 sin cos span · (π/4) dz; times
        // 2/π · ψ_h along the arc.
        let density = gamma * scaled.squared() / a / (T::ONE + scaled.squared()).squared() * inverse_rest.squared();
        let weight = weight * density * (T::TWO * sin * cos * span) * half;
        for (place, along_weight) in legendre.half::<T>(2 * along) {
            // crowds the nodes at the horizon, where c_v ≈ σ makes a layer
            let crowd = T::lit(c.crowd);
            let place2 = place.squared();
            let along_weight = along_weight * (T::ONE + crowd - T::lit(3.0) * crowd * place2);
            let sin2 = (half * (place * (T::ONE + crowd - crowd * place2))).sin().squared();
            let excess = T::lit(4.0) * (r * sin_s) * (half2 - sin2);
            visit(frame.node(r, T::ONE - T::TWO * sin2, excess, weight * along_weight));
        }
    });
}

/// The number of nodes for a wish `v`: rounded up, at least 1, at most what the table holds.
#[inline(always)]
fn order_of<T: Real>(v: T, largest: usize) -> usize {
    // the cast saturates; NaN gives 0
    let order = (v + T::lit(0.9999)).to_usize();
    // not `clamp`, which panics where it does not know that largest ≥ 1
    order.min(largest).max(1)
}
