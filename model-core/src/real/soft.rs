//! The arithmetic of `f32` in integers, for a Cortex-M0: what IEEE 754 asks for to the last bit, product and sum at half of the
//! instructions of the compiler's own routines, everything at a third to a half of their stack. None of those is linked then.
//!
//! Every NaN that comes out is the one of [`f32::NAN`].

use super::fixed::mul_high;

const SIGN: u32 = 0x8000_0000;
const IMPLICIT: u32 = 0x0080_0000;
const INFINITY: u32 = 0x7F80_0000;

/// a · b.
#[inline(never)]
pub(crate) fn mul(a: f32, b: f32) -> f32 {
    let (ua, ub) = (a.to_bits(), b.to_bits());
    let (ea, eb) = ((ua << 1) >> 24, (ub << 1) >> 24);
    let mut exponent = ea + eb;
    let high = product((ua << 8) | SIGN, (ub << 8) | SIGN, &mut exponent);
    // both normal, and the result well inside the normal range: biased exponents ea + eb − 127 (+ 1)
    if ea.wrapping_sub(1) >= 254 || eb.wrapping_sub(1) >= 254 || exponent.wrapping_sub(129) >= 252 {
        return rare_product(ua, ub);
    }
    // to 24 bits, ties to even; a carry raises the exponent, as it should
    let rounded = (high + 0x3F + ((high >> 7) & 1)) >> 7;
    f32::from_bits(((ua ^ ub) & SIGN) | (((exponent - 128) << 23) + rounded))
}

/// The product of two numbers in [2³¹, 2³²) as one in [2³⁰, 2³¹): its upper digits, and whether anything stands below them.
#[inline(always)]
fn product(a: u32, b: u32, exponent: &mut u32) -> u32 {
    // 24 bits each: the lower 16 of 48
    let low = (a >> 8).wrapping_mul(b >> 8) << 16;
    let high = mul_high(a, b) | u32::from(low != 0);
    if high < SIGN {
        return high;
    }
    *exponent += 1;
    (high >> 1) | (high & 1)
}

/// The product where an operand or the result is not a normal number. 0 times what is finite, no rarity in the tail of a lobe,
/// comes before what takes more stack.
#[cold]
#[inline(never)]
fn rare_product(ua: u32, ub: u32) -> f32 {
    const INFINITE: u32 = INFINITY << 1;
    if (ua << 1 == 0 && ub << 1 < INFINITE) || (ub << 1 == 0 && ua << 1 < INFINITE) {
        return f32::from_bits((ua ^ ub) & SIGN);
    }
    rarer_product(ua, ub)
}

/// The same but for the zeros.
#[cold]
#[inline(never)]
fn rarer_product(ua: u32, ub: u32) -> f32 {
    let sign = (ua ^ ub) & SIGN;
    let (a, b) = (ua & !SIGN, ub & !SIGN);
    if a > INFINITY || b > INFINITY {
        return f32::NAN;
    }
    if a == INFINITY || b == INFINITY {
        return if a == 0 || b == 0 { f32::NAN } else { f32::from_bits(sign | INFINITY) };
    }
    let ((ma, ea), (mb, eb)) = (normal(a), normal(b));
    let mut carry = 0;
    let high = product(ma << 8, mb << 8, &mut carry);
    packed(sign, ea + eb - 127 + carry as i32, high)
}

/// a/b.
#[inline(never)]
pub(crate) fn div(a: f32, b: f32) -> f32 {
    let (ua, ub) = (a.to_bits(), b.to_bits());
    let sign = (ua ^ ub) & SIGN;
    let (a, b) = (ua & !SIGN, ub & !SIGN);
    if a.wrapping_sub(1) >= INFINITY - 1 || b.wrapping_sub(1) >= INFINITY - 1 {
        // a zero, an infinity or NaN; equal are 0/0 and ∞/∞
        if a > INFINITY || b > INFINITY || a == b {
            return f32::NAN;
        }
        return f32::from_bits(sign | if a == INFINITY || b == 0 { INFINITY } else { 0 });
    }
    let ((mut rest, ea), (divisor, eb)) = (normal(a), normal(b));
    let mut exponent = ea - eb + 127;
    if rest < divisor {
        rest <<= 1;
        exponent -= 1;
    }
    // one word from here on
    let exponent = at_once(exponent as u32) as i32;
    let rest = at_once(rest);
    // 1/divisor by Newton's method, y ← y (2 − divisor y): 6e-2, 3e-3 and 6e-5 in 16 bits (Q15), 4e-9 in 32 (Q30)
    let short = divisor >> 8;
    let mut y = 92_521 - ((short * 61_681) >> 16);
    for _ in 0..2 {
        y = (y * (0x1_0000 - ((short * y) >> 16))) >> 15;
    }
    let y = y << 15;
    let y = mul_high(y, at_once(1 << 31) - mul_high(divisor << 8, y)) << 2;
    // 26 digits of the quotient, a few units off in the 30th; what is left is exact modulo 2³²
    let mut digits = mul_high(rest << 7, y) >> 4;
    let mut left = (rest << 25).wrapping_sub(digits.wrapping_mul(divisor)) as i32;
    if left < 0 {
        digits -= 1;
        left += divisor as i32;
    } else if left >= divisor as i32 {
        digits += 1;
        left -= divisor as i32;
    }
    let digits = (digits << 5) | u32::from(left != 0);
    if (exponent - 1) as u32 >= 253 {
        return packed(sign, exponent, digits);
    }
    let rounded = (digits + 0x3F + ((digits >> 7) & 1)) >> 7;
    f32::from_bits(sign | ((((exponent - 1) as u32) << 23) + rounded))
}

/// The same number, computed here and not later: between two others, so that only one is kept.
#[inline(always)]
fn at_once(x: u32) -> u32 {
    #[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
    {
        super::root::unseen(x)
    }
    #[cfg(not(all(target_arch = "arm", not(target_abi = "eabihf"))))]
    {
        x
    }
}

/// The mantissa of 24 bits and the biased exponent of a magnitude that is neither 0 nor infinite.
#[inline(always)]
fn normal(magnitude: u32) -> (u32, i32) {
    if magnitude < IMPLICIT {
        let zeros = magnitude.leading_zeros() - 8;
        return (magnitude << zeros, 1 - zeros as i32);
    }
    ((magnitude & (IMPLICIT - 1)) | IMPLICIT, (magnitude >> 23) as i32)
}

/// The number with this biased exponent and a mantissa in [2³⁰, 2³¹): rounded to 24 bits or to what a subnormal number has.
#[cold]
#[inline(never)]
fn packed(sign: u32, exponent: i32, mantissa: u32) -> f32 {
    let (mut field, mut kept) = (exponent - 1, mantissa);
    if field < 0 {
        let shift = (-field) as u32;
        kept = mantissa.unbounded_shr(shift);
        kept |= u32::from(kept.unbounded_shl(shift) != mantissa);
        field = 0;
    }
    let rounded = (kept + 0x3F + ((kept >> 7) & 1)) >> 7;
    let bits = if field >= 254 { INFINITY } else { ((field as u32) << 23) + rounded };
    f32::from_bits(sign | bits)
}

/// a + b.
#[inline(never)]
pub(crate) fn add(a: f32, b: f32) -> f32 {
    let (mut ua, mut ub) = (a.to_bits(), b.to_bits());
    if (ua << 1) < (ub << 1) {
        core::mem::swap(&mut ua, &mut ub);
    }
    // |a| ≥ |b|
    let (mut exponent, mut eb) = ((ua << 1) >> 24, (ub << 1) >> 24);
    if exponent == 255 {
        let nan = (ua << 1) > (INFINITY << 1) || ua ^ ub == SIGN;
        return if nan { f32::NAN } else { f32::from_bits(ua) };
    }
    // three more bits: guard, round, and whether anything stands below
    let (mut sum, mut full) = ((ua & (IMPLICIT - 1)) << 3, (ub & (IMPLICIT - 1)) << 3);
    // subnormal numbers have the exponent 1 and no implicit bit
    if exponent == 0 {
        exponent = 1
    } else {
        sum |= IMPLICIT << 3
    }
    if eb == 0 {
        eb = 1
    } else {
        full |= IMPLICIT << 3
    }
    let distance = exponent - eb;
    if distance > 26 {
        return f32::from_bits(ua);
    }
    let mut mb = full >> distance;
    if mb << distance != full {
        mb |= 1;
    }
    if (ua ^ ub) & SIGN == 0 {
        sum += mb;
        if sum >= IMPLICIT << 4 {
            sum = (sum >> 1) | (sum & 1);
            exponent += 1;
        }
    } else {
        sum -= mb;
        if sum == 0 {
            return 0.0;
        }
        // shifts by one are the rule; no loop, so that the compiler may drop a sum that nobody needs
        if sum < IMPLICIT << 3 {
            let zeros = if sum >= IMPLICIT << 2 { 1 } else { sum.leading_zeros() - 5 };
            let zeros = if zeros < exponent { zeros } else { exponent - 1 };
            sum <<= zeros;
            exponent -= zeros;
        }
    }
    let rounded = (sum + 3 + ((sum >> 3) & 1)) >> 3;
    let bits = ((exponent - 1) << 23) + rounded;
    f32::from_bits((ua & SIGN) | if bits < INFINITY { bits } else { INFINITY })
}

/// 1, made where it stands: kept for the next use it would cost a word of the stack.
#[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
#[allow(unsafe_code)] // here and next
#[inline(always)]
pub(crate) fn one() -> f32 {
    let one: u32;
    // SAFETY: two instructions on a register
    unsafe { core::arch::asm!("movs {0}, #127", "lsls {0}, {0}, #23", out(reg) one, options(nomem, nostack)) };
    f32::from_bits(one)
}

/// a − b. A call of its own: two subtractions that change a sign in place would keep the bit for it between them.
#[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
#[inline(never)]
pub(crate) fn sub(a: f32, b: f32) -> f32 {
    add(a, -b)
}

/// −1, 0 or 1 as a is below, equal to or above b; 2 where one of them is NaN.
#[inline(never)]
pub(crate) fn compare(a: f32, b: f32) -> i32 {
    // the order of integers; −0 is 0
    let key = |x: f32| {
        let magnitude = (x.to_bits() & !SIGN) as i32;
        if x.to_bits() >= SIGN { -magnitude } else { magnitude }
    };
    let (a, b) = (key(a), key(b));
    let most = INFINITY as i32;
    if a > most || b > most || a < -most || b < -most {
        return 2;
    }
    i32::from(a > b) - i32::from(a < b)
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
    fn every_operation_is_the_hardwares_to_the_last_bit() {
        let all = operands();
        let same = |ours: f32, theirs: f32| ours.to_bits() == theirs.to_bits() || (ours.is_nan() && theirs.is_nan());
        let mut count = 0_u64;
        for a in &all {
            for b in &all {
                assert!(same(super::mul(*a, *b), a * b), "{a:e} * {b:e}: {:e} {:e}", super::mul(*a, *b), a * b);
                assert!(same(super::add(*a, *b), a + b), "{a:e} + {b:e}: {:e} {:e}", super::add(*a, *b), a + b);
                assert!(same(super::div(*a, *b), a / b), "{a:e} / {b:e}: {:e} {:e}", super::div(*a, *b), a / b);
                let order = a.partial_cmp(b).map_or(2, |order| order as i32);
                assert_eq!(super::compare(*a, *b), order, "{a:e} {b:e}");
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
            assert!(same(super::div(a, b), a / b), "{a:e} / {b:e}");
        }
        println!("{count} pairs");
        assert!(count > 1_000_000);
    }
}
