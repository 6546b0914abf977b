//! Functions of an `f32` in plain single-precision arithmetic: the same bits on every machine.

/// 2^23 · 1.5: adding it puts an integer into the low bits.
const ROUND_F32: f32 = 12_582_912.0;

/// ln x in single precision; the same steps, the series to z⁵.
#[inline(always)]
pub(crate) fn ln(x: f32) -> f32 {
    const LN2_HI: f32 = f32::from_bits(0x3F31_7200);
    const LN2_LO: f32 = 1.428_606_8e-6;
    const SQRT_HALF: u32 = 0x3F35_04F3;
    let bits = x.to_bits();
    let shifted = bits.wrapping_sub(SQRT_HALF);
    let m = f32::from_bits((shifted & 0x007F_FFFF).wrapping_add(SQRT_HALF));
    let biased = (shifted >> 23) & 0x1FF;
    let signed = (biased ^ 0x100).wrapping_sub(0x100);
    let k = f32::from_bits(ROUND_F32.to_bits().wrapping_add(signed)) - ROUND_F32;

    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let mut p = 2.0 / 11.0;
    p = p * z + 2.0 / 9.0;
    p = p * z + 2.0 / 7.0;
    p = p * z + 2.0 / 5.0;
    p = p * z + 2.0 / 3.0;
    p *= z;
    let half_f2 = 0.5 * f * f;
    let y = k * LN2_HI + (f - (half_f2 - (s * (half_f2 + p) + k * LN2_LO)));
    let y = if x > 0.0 { y } else { f32::NAN };
    let y = if x == 0.0 { f32::NEG_INFINITY } else { y };
    if x < f32::INFINITY { y } else { x }
}

/// Arc sine in radians; NaN outside [−1, 1].
#[inline]
pub(crate) fn asin(x: f32) -> f32 {
    let magnitude = x.abs();
    if magnitude <= 0.5 {
        return x + x * asin_rest(x * x);
    }
    // π/2 − 2 asin √((1 − x)/2)
    let z = 0.5 * (1.0 - magnitude);
    let half = super::root::sqrt(z);
    let angle = core::f32::consts::FRAC_PI_2 - (2.0 * half + 2.0 * (half * asin_rest(z)));
    if x < 0.0 { -angle } else { angle }
}

/// asin(x)/x − 1 by z = x², z ≤ 1/4: 5e-9.
#[inline(always)]
fn asin_rest(z: f32) -> f32 {
    let mut p = 0.042_166_22;
    p = p * z + 0.024_179_56;
    p = p * z + 0.045_470_37;
    p = p * z + 0.074_952_98;
    p = p * z + 0.166_667_52;
    p * z
}
