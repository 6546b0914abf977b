//! Elementary functions of an `f32` in integers: the same bits on every machine, no call into `f64`, and on a core without
//! a floating-point unit several times cheaper than polynomials in software arithmetic.
//!
//! An angle is held as a fraction of the quarter turn with 32 or more bits, so that its complement and its half are exact;
//! a result is rounded to `f32` once. Qk: an integer that stands for itself times 2⁻ᵏ. Errors: `tests/device.rs`.

/// High word of a 64-bit product.
#[inline(always)]
pub(crate) fn mul_high(a: u32, b: u32) -> u32 {
    #[cfg(not(all(target_arch = "arm", not(target_abi = "eabihf"))))]
    {
        ((u64::from(a) * u64::from(b)) >> 32) as u32
    }
    // A Cortex-M0 multiplies 32 × 32 → 32 bits only; its library's 64-bit product costs twice this.
    #[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
    {
        let (a1, a0, b1, b0) = (a >> 16, a & 0xFFFF, b >> 16, b & 0xFFFF);
        let middle = a1 * b0 + ((a0 * b0) >> 16);
        let other = a0 * b1 + (middle & 0xFFFF);
        a1 * b1 + (middle >> 16) + (other >> 16)
    }
}

/// `value` · 2^`exponent`, rounded to the nearest `f32`, ties to even; the result must be a normal number or 0.
#[inline(always)]
pub(crate) fn scaled(value: u32, exponent: i32) -> f32 {
    let rounded = value as f32;
    let bits = rounded.to_bits().wrapping_add((exponent << 23) as u32);
    if value == 0 { 0.0 } else { f32::from_bits(bits) }
}

/// (`value` · 2^`exponent`)², rounded once: `value` is moved up first, so that a small one keeps its digits.
#[inline(always)]
pub(crate) fn square(value: u32, exponent: i32) -> f32 {
    let zeros = value.leading_zeros();
    let leading = value.unbounded_shl(zeros);
    scaled(mul_high(leading, leading), 2 * (exponent - zeros as i32) + 32)
}

/// eˣ. Below 2⁻¹²⁶, the smallest normal number: 0; above 2¹²⁶: infinite.
#[inline(always)]
pub(crate) fn exp(x: f32) -> f32 {
    const LOG2_E: u32 = 0xB8AA_3B29; // Q31
    // 2^(i/16), Q30
    const POWERS: [u32; 16] = [
        0x4000_0000,
        0x42D5_61B4,
        0x45CA_E0F2,
        0x48E1_E9BA,
        0x4C1B_F829,
        0x4F7A_9931,
        0x52FF_6B55,
        0x56AC_1F75,
        0x5A82_799A,
        0x5E84_51D0,
        0x62B3_9509,
        0x6712_460B,
        0x6BA2_7E66,
        0x7066_6F76,
        0x7560_6374,
        0x7A92_BE8B,
    ];
    // 2^(w/16) − 1 = w (A₁ + w (A₂ + w A₃)) on [0, 1), Q36: 1.4e-9
    const A: [u32; 3] = [0xB172_1F54, 0x03D7_CB27, 0x000E_821F];
    /// ln 2¹²⁶
    const FAR: u32 = 0x42AE_AC50;

    let bits = x.to_bits();
    let sign = ((bits as i32) >> 31) as u32;
    if bits & 0x7FFF_FFFF >= FAR {
        // infinite, or NaN where x is
        return if x < 0.0 { 0.0 } else { x + f32::INFINITY };
    }
    // |x| log₂e, Q24 (a subnormal number becomes 0 by the shift)
    let mantissa = (bits << 8) | 0x8000_0000;
    let exponent = (bits >> 23) & 0xFF;
    let y = mul_high(mantissa, LOG2_E).unbounded_shr(133_u32.wrapping_sub(exponent));
    // x log₂e = k + f/2³², f ≥ 0, in the middle of what the shift cut off; for negative x the complement, which is a unit
    // of 2⁻³² short of it
    let k = ((y >> 24) ^ sign) as i32;
    let f = ((y << 8) | 0x80) ^ sign;
    let w = f << 4;
    let series = mul_high(w, A[0] + mul_high(w, A[1] + mul_high(w, A[2])));
    // the index has four bits
    let power = POWERS[(f >> 28) as usize];
    let result = power + (mul_high(power, series) >> 4);
    // to 24 bits; a carry raises the exponent, as it should
    f32::from_bits((((k + 126) as u32) << 23) + ((result + 0x40) >> 7))
}

/// Sine and cosine, Q31, of r in units of the quarter turn, Q32, 0 ≤ r ≤ 1/2.
#[inline]
fn sin_cos_of_quarter(r: u32) -> (u32, u32) {
    let z = mul_high(r, r);
    (mul_high(r, sine_over_angle(z)), cosine(z))
}

/// sin(π r/2)/r by z = r², Q32 → Q31: 3e-9.
#[inline(always)]
fn sine_over_angle(z: u32) -> u32 {
    const S: [u32; 4] = [0xC90F_DA94, 0x52AE_EE40, 0x0A32_F489, 0x0096_C986];
    S[0] - mul_high(z, S[1] - mul_high(z, S[2] - mul_high(z, S[3])))
}

/// cos(π r/2) by z = r², Q32 → Q31: 5e-11.
#[inline(always)]
fn cosine(z: u32) -> u32 {
    const C: [u32; 5] = [0x8000_0000, 0x9DE9_E638, 0x2078_3B84, 0x02AB_8AF6, 0x001D_9C36];
    C[0] - mul_high(z, C[1] - mul_high(z, C[2] - mul_high(z, C[3] - mul_high(z, C[4]))))
}

/// Sine and cosine, Q31, of a zenith angle in degrees, 0 ≤ θ < 90: 1e-9 absolute.
#[inline(always)]
pub(crate) fn zenith_sin_cos(degrees: f32) -> (u32, u32) {
    let (mantissa, exponent) = per_ninety(degrees);
    // θ/90, Q32; exponent ≤ 133: below 128°
    let theta = if exponent == 133 { mantissa << 1 } else { mantissa.unbounded_shr(132_u32.wrapping_sub(exponent)) };
    // beyond 45°: that of the complement, exactly
    let beyond = theta > 1 << 31;
    let (sin, cos) = sin_cos_of_quarter(if beyond { theta.wrapping_neg() } else { theta });
    if beyond { (cos, sin) } else { (sin, cos) }
}

/// |cos(φ/2)|, Q31, for φ in degrees, |φ| ≤ 360: 1e-9 absolute.
#[inline(always)]
pub(crate) fn cos_of_half_azimuth(degrees: f32) -> u32 {
    const QUARTER: u32 = 1 << 31;
    let (mantissa, exponent) = per_ninety(degrees);
    // |φ|/180, Q31; exponent ≤ 135: below 512°
    let half = if exponent == 135 { mantissa << 1 } else { mantissa.unbounded_shr(134_u32.wrapping_sub(exponent)) };
    // cos² is even about 90°
    let half = if half > QUARTER { half.wrapping_neg() } else { half };
    let beyond = half > QUARTER / 2;
    let (sin, cos) = sin_cos_of_quarter(if beyond { QUARTER - half } else { half } << 1);
    if beyond { sin } else { cos }
}

/// |x|/90 as an integer and the biased exponent of x: |x|/90 = integer · 2^(exponent − 164).
#[inline(always)]
fn per_ninety(x: f32) -> (u32, u32) {
    const PER_NINETY: u32 = 0xB60B_60B6; // 2³⁸/90
    let bits = x.to_bits();
    (mul_high((bits << 8) | 0x8000_0000, PER_NINETY), (bits >> 23) & 0xFF)
}

/// Sine and cosine of an angle in radians; NaN for what is not finite.
pub(crate) fn sin_cos(x: f32) -> (f32, f32) {
    let magnitude = x.to_bits() & 0x7FFF_FFFF;
    // |x| < 2⁻¹²: sin x = x and cos x = 1 to the last bit
    if magnitude < 0x3980_0000 {
        return (x, 1.0);
    }
    if magnitude >= 0x7F80_0000 {
        return (f32::NAN, f32::NAN);
    }
    // in quarter turns modulo 4: q + a/2⁶², |a| ≤ 2⁶¹
    let turned = quarter_turns(magnitude);
    let q = (turned.wrapping_add(1 << 61) >> 62) as u32;
    let signed = turned.wrapping_sub(u64::from(q) << 62) as i64;
    let a = signed.unsigned_abs();
    let r = (a >> 30) as u32;
    let z = mul_high(r, r);
    let cos = scaled(cosine(z), -31);
    // sin by its relative precision: all the bits that a has
    let zeros = a.leading_zeros();
    let leading = (a.unbounded_shl(zeros) >> 32) as u32;
    let sin = scaled(mul_high(leading, sine_over_angle(z)), -29 - zeros as i32);
    let sin = if signed < 0 { -sin } else { sin };
    let (sin, cos) = match q & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    };
    (if x < 0.0 { -sin } else { sin }, cos)
}

/// |x| · 2/π modulo 4, Q62, from the bits of |x| ≥ 2⁻¹²: as many digits of 2/π as x shifts out (Payne and Hanek 1983).
#[inline(always)]
fn quarter_turns(bits: u32) -> u64 {
    // 2/π · 2⁻³⁷
    const TWO_OVER_PI: [u32; 8] =
        [0, 0x0517_CC1B, 0x7272_20A9, 0x4FE1_3ABE, 0x8FA9_A6EE, 0x06DB_14AC, 0xC9E2_1C82, 0x0FF2_8B1D];
    let mantissa = (bits & 0x007F_FFFF) | 0x0080_0000;
    // the first bit of 2/π that matters: 0 for 2⁻¹² ≤ |x| < 2⁻¹¹, at most 139
    let first = (bits >> 23) - 115;
    let word = |i: u32| {
        let pair = TWO_OVER_PI.get((first >> 5) as usize + i as usize..).and_then(|rest| rest.first_chunk::<2>());
        let [high, low] = pair.copied().unwrap_or([0; 2]);
        let shift = first & 31;
        if shift == 0 { high } else { (high << shift) | (low >> (32 - shift)) }
    };
    let product = |i: u32| u64::from(mantissa) * u64::from(word(i));
    (product(0) << 32).wrapping_add(product(1)).wrapping_add(product(2) >> 32)
}
