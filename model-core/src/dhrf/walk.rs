//! The walk over the nodes: columns x = const between the kinks, then along each column.

use super::grade::{Constants, Rule};
use super::slopes::SlopePlane;
use crate::Real;

/// One node of the rule: a facet slope.
pub(super) struct Node<T> {
    /// cos θ_a on the facet.
    pub(super) cos_theta_a: T,
    /// Weight of F there; the weights sum to the DHRF of a perfect mirror, F ≡ 1.
    pub(super) weight: T,
    /// tan²α/σ².
    pub(super) scaled_slope2: T,
}

/// One column: slopes of equal x.
struct Column<T> {
    x: T,
    /// x/σ
    u: T,
    /// of the outer rule, 2/π exp(−u²) included
    weight: T,
    /// y_k, or 0 where there is no plateau
    edge: T,
    /// W on the plateau
    height: T,
    /// y_h
    horizon: T,
}

/// A stretch of x between two kinks.
struct Segment<T> {
    from: T,
    to: T,
    /// Zeros of y_k² (or of y_h² where there is no plateau). They anchor the map x = A + (B − A) sin²θ, in which y_k and
    /// y_h are nearly analytic, so that the rule converges exponentially.
    anchors: (T, T),
    plateau: Plateau,
    /// Correction to the number of nodes.
    offset: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Plateau {
    None,
    /// W = w
    Low,
    /// W = 2
    High,
}

/// Visits every node. Their number depends on θ_s, σ and the grade only; no search, no estimate, no recursion.
#[inline(always)]
pub(super) fn walk<T: Real, R: Rule>(plane: &SlopePlane<T>, sigma: T, mut visit: impl FnMut(Node<T>)) {
    let c = R::CONSTANTS;
    if T::lit(c.smooth) * sigma <= plane.smooth_radius() {
        smooth::<T, R>(plane, sigma, &mut visit);
        return;
    }
    let (x0, x1) = plane.horizon;
    let (b1, b2) = plane.plateau;
    let (tan, cot) = (plane.tan_theta_s, plane.cot_theta_s);
    let segments = [
        Segment { from: x0, to: b1, anchors: (x0, x1), plateau: Plateau::None, offset: c.ax0 },
        Segment { from: b1, to: b2.min(cot), anchors: (b1, b2), plateau: Plateau::Low, offset: 0.0 },
        // empty below 45°
        Segment { from: cot, to: tan, anchors: (T::ZERO, tan), plateau: Plateau::High, offset: 0.0 },
        Segment { from: b2.max(tan), to: x1, anchors: (x0, x1), plateau: Plateau::None, offset: c.ax2 },
    ];
    let reach = T::lit(c.lx) * sigma;
    let excess = excess_roughness(sigma);
    for segment in segments {
        let from = segment.from.max(-reach);
        let to = segment.to.min(reach);
        if to <= from {
            continue;
        }
        if c.ghx > 0 && from == -reach && to == reach {
            // the whole Gaussian: only the plateau w ≤ 2 contains x = 0
            R::HERMITE.whole(c.ghx, |u: T, weight: T| {
                let x = sigma * u;
                let edge2 = (x - b1) * (b2 - x) * plane.plateau_shape(x);
                let column = Column {
                    x,
                    u,
                    weight: weight * T::lit(core::f64::consts::FRAC_2_PI),
                    edge: edge2.max(T::ZERO).sqrt(),
                    height: plane.w(x),
                    horizon: plane.horizon2(x).max(T::ZERO).sqrt(),
                };
                walk_column::<T, R>(plane, sigma, &column, &mut visit);
            });
            continue;
        }
        let wish = T::lit(c.ax + segment.offset) + T::lit(c.bx) * ((to - from) / sigma) + T::lit(c.rough_x) * excess;
        let order = order_of(wish, R::LEGENDRE_ORDERS);
        let (a, b) = segment.anchors;
        let span = b - a;
        let theta = |x: T| ((x - a) / span).max(T::ZERO).sqrt().min(T::ONE).asin();
        let (start, end) = (theta(from), theta(to));
        let half_step = T::HALF * (end - start);
        let middle = T::HALF * (end + start);
        R::LEGENDRE.whole(order, |z: T, weight: T| {
            let (sin, cos) = (middle + half_step * z).sin_cos();
            let x = a + span * sin.squared();
            let u = x / sigma;
            // √((x − A)(B − x)), without taking the differences
            let chord = span * sin * cos;
            let (edge, height, horizon) = match segment.plateau {
                Plateau::None => (T::ZERO, T::ZERO, chord),
                Plateau::Low => {
                    (chord * plane.plateau_shape(x).sqrt(), plane.w(x), plane.horizon2(x).max(T::ZERO).sqrt())
                }
                Plateau::High => (chord, T::TWO, plane.horizon2(x).max(T::ZERO).sqrt()),
            };
            // dx/σ = 2 (B − A) sinθ cosθ dθ/σ
            let dx = T::TWO * chord * half_step / sigma;
            let weight = T::lit(core::f64::consts::FRAC_2_PI) * weight * dx * (-u.squared()).exp();
            let column = Column { x, u, weight, edge, height, horizon };
            walk_column::<T, R>(plane, sigma, &column, &mut visit);
        });
    }
}

/// The nodes of one column: the plateau, then the part where masking or shadowing acts, y_k < y < y_h.
///
/// The integrand is even in y: the positive half of a rule of 2m points on [−y, y] has the strength of 2m points.
#[inline(always)]
fn walk_column<T: Real, R: Rule>(plane: &SlopePlane<T>, sigma: T, column: &Column<T>, visit: &mut impl FnMut(Node<T>)) {
    let c: Constants = R::CONSTANTS;
    let Column { x, u, horizon, .. } = *column;
    let u2 = u.squared();
    let excess = excess_roughness(sigma);
    let more = T::lit(c.rough_y) * excess - T::lit(c.cu) * u2;
    let cos_base = plane.cos_theta_s + x * plane.sin_theta_s;
    let one_x2 = T::ONE + x.squared();

    // `v` is y/σ; `height` is W, or None for the masked branch 4w/R² − 2 = 2 (y_h − y)(y_h + y)/R²
    let mut node = |v: T, weight: T, height: Option<T>| {
        let y = sigma * v;
        let inverse_r2 = T::ONE / (one_x2 + y.squared());
        let height = match height {
            Some(height) => height,
            None => T::TWO * (horizon - y) * (horizon + y) * inverse_r2,
        };
        let v2 = v.squared();
        visit(Node {
            // the minimum absorbs rounding: an index may take √(1 − cos²)
            cos_theta_a: (cos_base * inverse_r2.sqrt()).min(T::ONE),
            weight: column.weight * weight * height * (-v2).exp(),
            scaled_slope2: u2 + v2,
        });
    };

    let reach = (T::lit(c.ly * c.ly) - T::lit(c.kap) * u2).max(T::ONE).sqrt();
    let top = (horizon / sigma).min(reach);
    let edge = column.edge / sigma;
    if edge <= T::ZERO {
        let m = order_of(T::lit(c.a1) + more + T::lit(c.b1) * top, R::LEGENDRE_ORDERS / 2);
        for (z, weight) in R::LEGENDRE.half(2 * m) {
            node(top * z, weight * top, None);
        }
        return;
    }

    // v = p q/√(1 − q²) gathers the nodes where the Gaussian is
    let end = edge.min(reach);
    let m = order_of(T::lit(c.a1) + more + T::lit(c.b1) * end, R::LEGENDRE_ORDERS / 2);
    let p = T::lit(c.py) / (T::ONE + T::lit(c.rough_p) * excess);
    let q_end = end / (p.squared() + end.squared()).sqrt();
    for (z, weight) in R::LEGENDRE.half(2 * m) {
        let q = q_end * z;
        let inverse = T::ONE / (T::ONE - q.squared());
        let p_root = p * inverse.sqrt();
        node(p_root * q, weight * q_end * p_root * inverse, Some(column.height));
    }

    let half_width = T::HALF * (top - edge);
    if half_width > T::ZERO {
        let order = order_of(T::lit(c.a2) + more + T::lit(2.0 * c.b2) * half_width, R::LEGENDRE_ORDERS);
        let middle = edge + half_width;
        R::LEGENDRE.whole(order, |z: T, weight: T| node(middle + half_width * z, weight * half_width, None));
    }
}

/// The cheap rule where no kink lies within `smooth`·σ: Gauss–Hermite in both slopes.
#[inline(always)]
fn smooth<T: Real, R: Rule>(plane: &SlopePlane<T>, sigma: T, visit: &mut impl FnMut(Node<T>)) {
    let c = R::CONSTANTS;
    R::HERMITE.whole(c.smooth_x, |u: T, weight_x: T| {
        let x = sigma * u;
        let w = plane.w(x);
        let low = w.min(T::TWO);
        let cos_base = plane.cos_theta_s + x * plane.sin_theta_s;
        let one_x2 = T::ONE + x.squared();
        for (v, weight_y) in R::HERMITE.half::<T>(2 * c.smooth_y) {
            let y = sigma * v;
            let inverse_r2 = T::ONE / (one_x2 + y.squared());
            // 4w/R² − 2 matters only for the outermost nodes, if at all
            let height = low.min(T::lit(4.0) * w * inverse_r2 - T::TWO).max(T::ZERO);
            visit(Node {
                cos_theta_a: (cos_base * inverse_r2.sqrt()).max(T::ZERO).min(T::ONE),
                weight: T::lit(core::f64::consts::FRAC_2_PI) * weight_x * weight_y * height,
                scaled_slope2: u.squared() + v.squared(),
            });
        }
    });
}

/// σ − 1 on very rough surfaces, else 0: there the scale of the integrand is that of 1 + x² + y², no longer the Gaussian's.
/// Stays at 1 beyond σ = 2, where the tables end and no accuracy is promised.
#[inline(always)]
fn excess_roughness<T: Real>(sigma: T) -> T {
    (sigma - T::ONE).max(T::ZERO).min(T::ONE)
}

/// The number of nodes for a wish `v`: rounded up, at least 1, at most what the table holds.
#[inline(always)]
fn order_of<T: Real>(v: T, largest: usize) -> usize {
    // the cast saturates; NaN gives 0
    let order = (v + T::lit(0.9999)).to_usize();
    order.clamp(1, largest)
}
