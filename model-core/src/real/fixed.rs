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
        let middle = super::root::unseen(a1 * b0 + ((a0 * b0) >> 16));
        let other = a0 * b1 + (middle & 0xFFFF);
        a1 * b1 + (middle >> 16) + (other >> 16)
    }
}

/// `value` · 2^`exponent`, rounded to the nearest `f32`, ties to even; 2^`exponent` and the result must be normal numbers.
#[inline(always)]
pub(crate) fn scaled(value: u32, exponent: i32) -> f32 {
    let rounded = value as f32;
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    {
        // exact
        rounded * f32::from_bits(((127 + exponent) << 23) as u32)
    }
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    {
        let bits = rounded.to_bits().wrapping_add((exponent << 23) as u32);
        if value == 0 { 0.0 } else { f32::from_bits(bits) }
    }
}

/// (`value` · 2^`exponent`)², rounded once: `value` is moved up first, so that a small one keeps its digits.
#[inline(always)]
pub(crate) fn square(value: u32, exponent: i32) -> f32 {
    // 0 stays 0
    let zeros = (value | 1).leading_zeros();
    let leading = value << zeros;
    scaled(mul_high(leading, leading), 2 * (exponent - zeros as i32) + 32)
}

/// x · 2^`bits` for x ≥ 0, cut off: 0 below one unit, `u32::MAX` where it does not fit.
#[inline(always)]
pub(crate) fn truncated(x: f32, bits: u32) -> u32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    {
        // exact, and one instruction
        (x * f32::from_bits((127 + bits) << 23)) as u32
    }
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    {
        truncated_in_integers(x, bits)
    }
}

#[cfg(any(test, not(all(target_arch = "arm", target_abi = "eabihf"))))]
#[inline(always)]
fn truncated_in_integers(x: f32, bits: u32) -> u32 {
    let mantissa = (x.to_bits() << 8) | 0x8000_0000;
    let shift = (158 - bits).wrapping_sub((x.to_bits() >> 23) & 0xFF);
    if shift as i32 >= 0 { mantissa.unbounded_shr(shift) } else { u32::MAX }
}

/// High word of the 64-bit product of two signed numbers.
#[inline(always)]
fn signed_mul_high(a: i32, b: i32) -> i32 {
    #[cfg(not(all(target_arch = "arm", not(target_abi = "eabihf"))))]
    {
        ((i64::from(a) * i64::from(b)) >> 32) as i32
    }
    // as `mul_high`: the upper halves carry the signs
    #[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
    {
        let (a1, a0, b1, b0) = (a >> 16, a & 0xFFFF, b >> 16, b & 0xFFFF);
        let middle = super::root::unseen(((a1 * b0) as u32).wrapping_add(((a0 as u32) * (b0 as u32)) >> 16)) as i32;
        let other = a0 * b1 + (middle & 0xFFFF);
        a1 * b1 + (middle >> 16) + (other >> 16)
    }
}

/// log₂e, Q31.
const LOG2_E: u32 = 0xB8AA_3B29;

/// 2^(f/2³²), Q30, and half a unit of the 24th bit: ready to be cut off.
#[cfg_attr(all(target_arch = "arm", not(target_abi = "eabihf")), inline(never))]
#[cfg_attr(not(all(target_arch = "arm", not(target_abi = "eabihf"))), inline(always))]
fn power(f: u32) -> u32 {
    // 2^((i + 1/2)/16), Q30, and that half unit
    const MIDDLES: [i32; 16] = [
        0x4166_C38B,
        0x444C_077F,
        0x4752_1D04,
        0x4A7A_7813,
        0x4DC6_9D1B,
        0x5138_21C0,
        0x54D0_AD99,
        0x5891_FAFF,
        0x5C7D_D7E2,
        0x6096_26A3,
        0x64DC_DF01,
        0x6954_0F07,
        0x6DFD_DC0A,
        0x72DC_83B2,
        0x77F2_5D0C,
        0x7D41_D9AB,
    ];
    // 2^(w/16) − 1 = w (A₁ + w (A₂ + w A₃)) for −1/2 ≤ w < 1/2, Q32: 1.2e-9
    const A: [i32; 3] = [0x0B17_2180, 0x003D_801A, 0xE35A];
    let w = ((f << 4) ^ 0x8000_0000) as i32;
    let slope = A[0].wrapping_add(signed_mul_high(w, A[1].wrapping_add(signed_mul_high(w, A[2]))));
    // the index has four bits
    let middle = MIDDLES[(f >> 28) as usize];
    middle.wrapping_add(signed_mul_high(signed_mul_high(w, slope), middle)) as u32
}

/// eˣ. Below 2⁻¹²⁶, the smallest normal number: 0; above 2¹²⁶: infinite.
#[cfg_attr(all(target_arch = "arm", not(target_abi = "eabihf")), inline(never))]
#[cfg_attr(not(all(target_arch = "arm", not(target_abi = "eabihf"))), inline(always))]
pub(crate) fn exp(x: f32) -> f32 {
    /// ln 2¹²⁶
    const FAR: u32 = 0x42AE_AC50;

    let bits = x.to_bits();
    let sign = ((bits as i32) >> 31) as u32;
    let magnitude = bits & 0x7FFF_FFFF;
    if magnitude >= FAR {
        return match (magnitude > f32::INFINITY.to_bits(), sign) {
            (true, _) => x,
            (false, 0) => f32::INFINITY,
            (false, _) => 0.0,
        };
    }
    // |x| log₂e, Q24 (a subnormal number becomes 0 by the shift)
    let mantissa = (bits << 8) | 0x8000_0000;
    let exponent = (bits >> 23) & 0xFF;
    let y = mul_high(mantissa, LOG2_E).unbounded_shr(133_u32.wrapping_sub(exponent));
    // x log₂e = k + f/2³², f ≥ 0, in the middle of what the shift cut off; for negative x the complement, which is a unit
    // of 2⁻³² short of it
    let k = ((y >> 24) ^ sign) as i32;
    let f = ((y << 8) | 0x80) ^ sign;
    // a carry raises the exponent, as it should
    f32::from_bits((((k + 126) as u32) << 23) + (power(f) >> 7))
}

/// What [`decay`] gives is larger by this.
pub(crate) const DECAY_GAIN: f64 = 2.0;
/// What [`decay`] counts in: −2⁻²⁴ log_e 2. A power of two by the constant that a caller multiplies with anyway.
pub(crate) const DECAY_UNIT: f64 = -core::f64::consts::LN_2 / 16_777_216.0;

/// 2 exp(−x `DECAY_UNIT`) = 2 · 2^(x/2²⁴) for x ≤ 0: 8e-7. From 2⁻¹²⁷ down it fades linearly, to 0 at 2⁻¹²⁸ and beyond.
#[cfg_attr(all(target_arch = "arm", not(target_abi = "eabihf")), inline(never))]
#[cfg_attr(not(all(target_arch = "arm", not(target_abi = "eabihf"))), inline(always))]
pub(crate) fn decay(x: f32) -> f32 {
    // k + f, f in [0, 1), Q24
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    let y = x as i32;
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    let y = truncated(f32::from_bits(x.to_bits() & 0x7FFF_FFFF), 0).min(1 << 31).wrapping_neg() as i32;
    // 2ᶠ = 1 + f − f p(f), p in Q26; all but one of its constants fit into an instruction of a Cortex-M4
    let f = (y as u32) << 8;
    let p = 0x0009_5000 + mul_high(f, 0x0001_E800);
    let p = 0x0039_0039 + mul_high(f, p);
    let p = 0x00F6_00F6 + mul_high(f, p);
    let p = 20_592_990 - mul_high(f, p);
    // 1 + f is the mantissa already, and k the exponent, 0 where y saturates
    f32::from_bits((0x4000_0000 + (y >> 1)) as u32 - (mul_high(f, p) >> 3))
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

/// 90° as [`sine`] takes it.
const QUARTER: u32 = 90 << 25;

/// The sines and cosines of a pair of directions, Q30: 1e-9.
pub(crate) struct Sines {
    pub sin_theta_s: u32,
    pub cos_theta_s: u32,
    pub sin_theta_v: u32,
    pub cos_theta_v: u32,
    /// |cos(φ_v/2)|
    pub cos_half_phi: u32,
}

/// Angles in degrees, 0 ≤ θ < 90 and |φ| ≤ 360.
#[inline(always)]
pub(crate) fn direction(theta_s: f32, theta_v: f32, phi_v: f32) -> Sines {
    direction_by(sine, theta_s, theta_v, phi_v)
}

/// The same without a call: 250 bytes more, 60 instructions less where there is a floating-point unit.
#[inline(always)]
pub(crate) fn direction_here(theta_s: f32, theta_v: f32, phi_v: f32) -> Sines {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    {
        direction_by(|r| in_turn(sine_here(in_turn(r))), theta_s, theta_v, phi_v)
    }
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    {
        direction_by(sine, theta_s, theta_v, phi_v)
    }
}

/// The same number; nothing of what it leads to begins before what precedes it here has ended, so that fewer are kept.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[allow(unsafe_code)]
#[inline(always)]
fn in_turn(x: u32) -> u32 {
    let same: u32;
    // SAFETY: no instruction at all
    unsafe { core::arch::asm!("/* {0} */", inlateout(reg) x => same, options(nomem, nostack, preserves_flags)) };
    same
}

#[inline(always)]
fn direction_by(sine: impl Fn(u32) -> u32, theta_s: f32, theta_v: f32, phi_v: f32) -> Sines {
    // degrees in units of 2⁻²⁵, so that a complement is exact
    let (s, v) = (truncated(theta_s, 25), truncated(theta_v, 25));
    // |φ|/2, Q24; cos is even about 180°, and what is left of 90° has all the digits near the mirror direction
    let half = truncated(f32::from_bits(phi_v.to_bits() & 0x7FFF_FFFF), 23);
    // in this order: what a caller makes of two sines, or of two cosines, replaces them
    Sines {
        cos_half_phi: sine(half.abs_diff(QUARTER / 2) << 1),
        sin_theta_s: sine(s),
        sin_theta_v: sine(v),
        cos_theta_s: sine(QUARTER - s),
        cos_theta_v: sine(QUARTER - v),
    }
}

/// The sine, Q30, of an angle from 0° to 90°, in degrees Q25.
#[inline(never)]
fn sine(r: u32) -> u32 {
    sine_here(r)
}

#[inline(always)]
fn sine_here(r: u32) -> u32 {
    // sin(128° r)/r by z = r², r ≤ 90/128, Q30: 4e-11
    let z = mul_high(r, r) as i32;
    let sum = 0x003E_8224_i32.wrapping_add(signed_mul_high(-0x0002_B529, z));
    let sum = (-0x0386_CCF4_i32).wrapping_add(signed_mul_high(sum, z));
    let sum = 0x1DAD_945E_i32.wrapping_add(signed_mul_high(sum, z));
    let sum = (-0x76EE_0830_i32).wrapping_add(signed_mul_high(sum, z));
    let sum = 0x8EFA_3513_u32.wrapping_add(signed_mul_high(sum, z) as u32);
    mul_high(r, sum)
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
    (if x.to_bits() >> 31 == 1 { -sin } else { sin }, cos)
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

#[cfg(test)]
mod tests {
    extern crate std;

    /// A device with a floating-point unit converts by it: the same numbers, saturation included.
    #[test]
    fn what_is_cut_off_in_integers_is_what_the_conversion_of_the_hardware_gives() {
        for bits in (0..0x7F80_0000_u32).step_by(4999) {
            let x = f32::from_bits(bits);
            for places in [0, 23, 25] {
                let scale = (1_u32 << places) as f32;
                assert_eq!(super::truncated_in_integers(x, places), (x * scale) as u32, "{x:e} {places}");
            }
        }
    }

    #[test]
    fn the_decay_is_within_8e_7_and_ends_in_0() {
        let mut worst = 0.0_f64;
        for i in 0..2_000_000_u32 {
            let x = i as f32 * (-127.0 * 16_777_216.0 / 2e6);
            let exact = super::DECAY_GAIN * (-f64::from(x) * super::DECAY_UNIT).exp();
            worst = worst.max((f64::from(super::decay(x)) / exact - 1.0).abs());
        }
        std::println!("decay: {worst:.3e}");
        assert!(worst <= 8e-7, "{worst:e}");
        let mut last = f32::MIN_POSITIVE;
        for i in 0..=1000 {
            let fading = super::decay(-16_777_216.0 * (127.0 + 0.001 * i as f32));
            assert!((0.0..=last).contains(&fading), "{i}: {fading:e}");
            last = fading;
        }
        for far in [128.0, 200.0, 1e6, f32::INFINITY] {
            assert_eq!(super::decay(-16_777_216.0 * far).to_bits(), 0, "{far}");
        }
        assert_eq!(super::decay(0.0), 2.0);
        assert_eq!(super::decay(-0.0), 2.0);
    }
}
