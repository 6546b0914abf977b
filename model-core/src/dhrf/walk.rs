//! The walk over the nodes: columns x = const between the kinks, then along each column.
//!
//! One loop over segments, columns, the parts of a column and nodes, with one copy of each formula: on a device the code itself
//! is a cost. What depends on the column alone is computed there; a node of E4d needs one division, one root and nine products
//! for its weight, and its Fresnel factor.

use super::grade::{Foot, Rule};
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

/// Visits every node. Their number depends on θ_s, σ and the grade only; no search, no estimate, no recursion.
#[inline(always)]
pub(super) fn walk<T: Real, R: Rule>(plane: &SlopePlane<T>, sigma: T, mut visit: impl FnMut(Node<T>)) {
    let c = R::CONSTANTS;
    let inverse_sigma = T::ONE / sigma;
    let inverse_sigma2 = inverse_sigma.squared();
    let reach = T::lit(c.lx) * sigma;
    let more_columns = rough(c.rough_x, sigma);
    let more_nodes = rough(c.rough_y, sigma);
    // Where no kink lies within `smooth`·σ, Gauss–Hermite in both slopes; no node of it meets a kink.
    let smooth = T::lit(c.smooth) * sigma <= plane.smooth_radius();
    let mut from = plane.horizon().0.max(-reach);
    for (i, segment) in plane.segments.iter().enumerate() {
        let has_plateau = i == 1 || i == 2;
        let start = from;
        let stop = segment.end.min(reach);
        from = from.max(stop);
        if !(stop > start) || (smooth && i != 1) {
            continue;
        }
        let nodes = match i {
            0 => T::lit(c.ax + c.ax0),
            3 => T::lit(c.ax + c.ax2),
            _ => T::lit(c.ax),
        };
        let length = (stop - start) * inverse_sigma;
        let mut order = rounded_up(nodes + T::lit(c.bx) * length + more_columns, R::LEGENDRE_ORDERS);
        if smooth {
            order = c.smooth_x;
        }
        let (start, stop) = (segment.place(start), segment.place(stop));
        let half_step = T::HALF * (stop - start);
        let middle = T::HALF * (stop + start);
        // on a long segment the columns are drawn to x = 0, where the Gaussian is, or to the end nearer to it
        let mut across = Crowd { k: T::ZERO, pull: T::ZERO };
        if c.crowd_x > 0.0 {
            let peak = (segment.place(T::ZERO) - middle) / half_step;
            across = Crowd::to_peak((T::lit(c.crowd_x) * (length - T::lit(c.crowd_from))).max(T::ZERO), peak);
        }
        // dx/σ = 2 (B − A) sinθ cosθ dθ/σ, dθ = 4 dt/(1 + t²), and 2/π of the whole
        let span = segment.span();
        let step = T::lit(16.0 / core::f64::consts::PI) * (half_step * span * inverse_sigma);
        let table = if smooth { R::HERMITE } else { R::LEGENDRE };
        table.whole(order, |z: T, weight: T| {
            let mut x = sigma * z;
            let mut weight = weight;
            if smooth {
                weight *= T::lit(core::f64::consts::FRAC_2_PI);
            } else {
                // t = tan(θ/4), a rational stand-in for the angle: tan(θ/2) = 2t/(1 − t²)
                let (place, slope) = across.draw(z);
                let t = middle + half_step * place;
                let inverse = T::ONE / (T::ONE + t.squared());
                let sin_half = T::TWO * t * inverse;
                let cos_half = (T::ONE - t) * (T::ONE + t) * inverse;
                let sin = T::TWO * sin_half * cos_half;
                let cos = (cos_half - sin_half) * (cos_half + sin_half);
                x = segment.a + span * sin.squared();
                weight *= step * slope * (sin * cos * inverse);
            }
            let x2 = x.squared();
            let u2 = x2 * inverse_sigma2;
            let w = plane.w(x);
            // W on the plateau
            let height = w.min(T::TWO);
            // What is left of y_h² and y_k² where they are small has few digits; but there W is small, or has no jump.
            let horizon2 = T::TWO * w - (T::ONE + x2);
            let edge2 = T::lit(4.0) * w / (height + T::TWO) - (T::ONE + x2);
            let (horizon, edge) = T::sqrt_of_both(horizon2.max(T::ZERO), edge2.max(T::ZERO));

            let cos_base = plane.cos_theta_s * w;
            let half_height = T::HALF * height;
            let more = more_nodes - T::lit(c.cu) * u2;
            let reach = sigma * (T::lit(c.ly * c.ly) - T::lit(c.kap) * u2).max(T::ONE).sqrt();
            let top = horizon.min(reach);
            let edge = if has_plateau { edge.min(reach) } else { T::ZERO };

            // The integrand is even in y: the positive half of a rule of 2m points on [−y, y] has the strength of 2m points.
            let mut on_plateau = edge > T::ZERO;
            let mut middle = T::ZERO;
            let mut half = if on_plateau { edge } else { top };
            let scaled = half * inverse_sigma;
            let mut order = 2 * rounded_up(T::lit(c.a1) + more + T::lit(c.b1) * scaled, R::LEGENDRE_ORDERS / 2);
            let mut crowd = T::ZERO;
            // q² at the end of the plateau
            let mut compression = T::ZERO;
            if on_plateau {
                match c.foot {
                    Foot::Cubic { crowd: k } => crowd = T::lit(k) * scaled.squared(),
                    Foot::Compressed { p, rough: more } => {
                        let p = T::lit(p) / (T::ONE + rough(more, sigma));
                        let inverse = T::ONE / (p.squared() + scaled.squared());
                        compression = scaled.squared() * inverse;
                        half = sigma * (p * scaled * inverse.sqrt());
                    }
                }
            }
            if smooth {
                (half, crowd, compression, order) = (sigma, T::ZERO, T::ZERO, 2 * c.smooth_y);
            }
            let mut even = true;
            loop {
                // twice, for the node has W/2
                let part = T::TWO * weight * (half * inverse_sigma);
                for (mut z, node_weight) in table.half::<T>(order) {
                    loop {
                        // z (1 − k + k z²): drawn to the foot of the plateau
                        let bend = crowd * z.squared();
                        let rest = T::ONE - (crowd - bend);
                        let mut place = z * rest;
                        let mut slope = rest + (bend + bend);
                        if matches!(c.foot, Foot::Compressed { .. }) && compression > T::ZERO {
                            let inverse = T::ONE / (T::ONE - compression * z.squared());
                            let root = inverse.sqrt();
                            slope = inverse * root;
                            place = z * root;
                        }
                        let y = middle + half * place;
                        let slope2 = x2 + y.squared();
                        let inverse_r2 = T::ONE / (T::ONE + slope2);
                        let half_w = if on_plateau {
                            half_height
                        } else {
                            // 4w/R² − 2 = 2 (y_h − y)(y_h + y)/R²
                            (horizon - y) * (horizon + y) * inverse_r2
                        };
                        let scaled_slope2 = slope2 * inverse_sigma2;
                        visit(Node {
                            // the minimum absorbs rounding: an index may take √(1 − cos²)
                            cos_theta_a: (cos_base * inverse_r2.sqrt()).min(T::ONE),
                            weight: part * node_weight * slope * half_w * R::gaussian(scaled_slope2),
                            scaled_slope2,
                        });
                        if even || !(z > T::ZERO) {
                            break;
                        }
                        z = -z;
                    }
                }
                // then the part where masking or shadowing acts, y_k < y < y_h
                half = T::HALF * (top - edge);
                if !on_plateau || smooth || !(half > T::ZERO) {
                    break;
                }
                on_plateau = false;
                even = false;
                middle = edge + half;
                (crowd, compression) = (T::ZERO, T::ZERO);
                order =
                    rounded_up(T::lit(c.a2) + more + T::lit(2.0 * c.b2) * (half * inverse_sigma), R::LEGENDRE_ORDERS);
            }
        });
    }
}

/// z + (1 − z²)(pull − k z): [−1, 1] onto itself, nodes drawn to where the slope is least, z = pull/(3 k).
struct Crowd<T> {
    k: T,
    pull: T,
}

impl<T: Real> Crowd<T> {
    /// To `peak`, or the end nearer to it, where the slope becomes 1 − `strength`.
    #[inline(always)]
    fn to_peak(strength: T, peak: T) -> Self {
        let peak = peak.max(-T::ONE).min(T::ONE);
        let k = strength / (T::ONE + T::lit(3.0) * peak.squared());
        Crowd { k, pull: T::lit(3.0) * k * peak }
    }

    /// Where z goes, and the slope there.
    #[inline(always)]
    fn draw(&self, z: T) -> (T, T) {
        let rest = T::ONE - z.squared();
        let pull = self.pull - self.k * z;
        (z + rest * pull, T::ONE - self.k * rest - T::TWO * z * pull)
    }
}

/// `more` (σ − 1) on very rough surfaces, else 0: there the scale of the integrand is that of 1 + x² + y², no longer the
/// Gaussian's. Stays as at σ = 2 beyond, where the tables end and no accuracy is promised.
#[inline(always)]
fn rough<T: Real>(more: f64, sigma: T) -> T {
    if more == 0.0 { T::ZERO } else { T::lit(more) * (sigma - T::ONE).max(T::ZERO).min(T::ONE) }
}

/// The whole number above, at least 1, at most `largest`.
#[inline(always)]
fn rounded_up<T: Real>(v: T, largest: usize) -> usize {
    // the cast saturates; NaN gives 0
    (v + T::lit(0.9999)).to_usize().clamp(1, largest)
}
