//! √x of an `f32`, correctly rounded: by the floating-point unit where there is one, else in integers. The same bits.

#[cfg(any(test, not(all(target_arch = "arm", target_abi = "eabihf"))))]
use super::fixed::mul_high;

/// √x; NaN for x < 0.
#[inline(always)]
pub(crate) fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    {
        by_instruction(x)
    }
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    {
        in_integers(x)
    }
}

/// The same number, by a way that the compiler cannot see through: of products of halves it would make one of 64 bits, which
/// a Cortex-M0 has only as a call that costs twice as much.
#[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
#[allow(unsafe_code)]
#[inline(always)]
pub(crate) fn unseen(x: u32) -> u32 {
    let same: u32;
    // SAFETY: no instruction at all
    unsafe { core::arch::asm!("/* {0} */", inlateout(reg) x => same, options(pure, nomem, nostack, preserves_flags)) };
    same
}

/// (√x, √y), in fewer moves than one by one.
#[inline(always)]
pub(crate) fn sqrt_of_both(x: f32, y: f32) -> (f32, f32) {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    {
        both_by_instruction(x, y)
    }
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    {
        (in_integers(x), in_integers(y))
    }
}

/// VSQRT. `core` offers no square root, and the one of the `libm` crate costs 48 instructions instead of 5. Stable assembly may
/// clobber a register of this unit, but not take one as operand: hence the moves.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[allow(unsafe_code)] // here and next: an instruction that stable Rust reaches by assembly only
#[inline(always)]
fn by_instruction(x: f32) -> f32 {
    let result: u32;
    // SAFETY: no memory, no stack, no flags; what is written is declared. The ABI of this target (eabihf) says that the unit is
    // there.
    unsafe {
        core::arch::asm!(
            "vmov s15, {x}",
            "vsqrt.f32 s15, s15",
            "vmov {x}, s15",
            x = inlateout(reg) x.to_bits() => result,
            out("s15") _,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    f32::from_bits(result)
}

/// VSQRT twice.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[allow(unsafe_code)]
#[inline(always)]
fn both_by_instruction(x: f32, y: f32) -> (f32, f32) {
    let (root_x, root_y): (u32, u32);
    // SAFETY: as above
    unsafe {
        core::arch::asm!(
            "vmov s14, s15, {x}, {y}",
            "vsqrt.f32 s14, s14",
            "vsqrt.f32 s15, s15",
            "vmov {x}, {y}, s14, s15",
            x = inlateout(reg) x.to_bits() => root_x,
            y = inlateout(reg) y.to_bits() => root_y,
            out("s14") _,
            out("s15") _,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    (f32::from_bits(root_x), f32::from_bits(root_y))
}

/// The root in integers: 1/√x by Newton's method from a table of 96 bytes, the last bit by the remainder.
#[cfg(any(test, not(all(target_arch = "arm", target_abi = "eabihf"))))]
#[inline(never)]
fn in_integers(x: f32) -> f32 {
    // 256 (1/√m − 1) in the middle of each 128th of [1/4, 1): 1 %
    #[rustfmt::skip]
    const TABLE: [u8; 96] = [
        252, 244, 237, 230, 223, 217, 211, 205, 199, 194, 188, 183, 178, 173, 169, 164,
        160, 156, 152, 148, 144, 140, 136, 133, 129, 126, 123, 119, 116, 113, 110, 107,
        105, 102, 99, 97, 94, 91, 89, 87, 84, 82, 80, 77, 75, 73, 71, 69,
        67, 65, 63, 61, 59, 57, 55, 54, 52, 50, 48, 47, 45, 44, 42, 40,
        39, 37, 36, 34, 33, 31, 30, 29, 27, 26, 25, 23, 22, 21, 20, 18,
        17, 16, 15, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1,
    ];
    let bits = x.to_bits();
    let mut exponent = (bits >> 23) as i32;
    let mut mantissa = bits & 0x007F_FFFF;
    // one test for zeros, subnormals, infinity, NaN and what is negative
    if (exponent - 1) as u32 >= 254 {
        if bits << 1 == 0 || bits == f32::INFINITY.to_bits() || bits << 1 > 0xFF00_0000 {
            return x;
        }
        if bits >> 31 == 1 {
            return f32::NAN;
        }
        let zeros = mantissa.leading_zeros() - 8;
        mantissa <<= zeros;
        exponent = 1 - zeros as i32;
    } else {
        mantissa |= 0x0080_0000;
    }
    // x = m · 4^k, m in [1/4, 1), Q32; 127 is odd
    let odd = (exponent & 1) as u32;
    let m = mantissa << (8 - odd);
    let k = (exponent + odd as i32) >> 1;

    // y = 1/√m, Q30: y ← y (3 − m y²)/2 leaves 1.5 times the error squared: 1e-2, 1.5e-4, 3e-8
    let seed = TABLE.get((m >> 25).wrapping_sub(32) as usize).copied().unwrap_or(0);
    let mut y = (1 << 30) + (u32::from(seed) << 22);
    for _ in 0..2 {
        let m_y2 = mul_high(m, mul_high(y, y) << 1);
        y = mul_high(y, ((3 << 29) - m_y2) << 1) << 1;
    }
    // the root's 25 bits, a few units off; its square is compared modulo 2³², which holds the difference
    let mut root = mul_high(m, y) >> 5;
    let mut rest = (m << 18).wrapping_sub(root.wrapping_mul(root)) as i32;
    for _ in 0..3 {
        if rest < 0 {
            root -= 1;
            rest += 2 * root as i32 + 1;
        }
    }
    for _ in 0..3 {
        if rest > 2 * root as i32 {
            rest -= 2 * root as i32 + 1;
            root += 1;
        }
    }
    // the last bit is half a unit; a tie cannot occur, for the square of an odd root of 25 bits has more digits than m
    let rounded = (root + 1) >> 1;
    f32::from_bits((((k + 62) as u32) << 23).wrapping_add(rounded))
}

#[cfg(test)]
mod tests {
    extern crate std;

    #[test]
    fn the_root_in_integers_is_the_hardware_root_for_every_kind_of_number() {
        let mut bits = 0_u32;
        // a stride without a common factor with 2³²: some 430,000 numbers of every exponent, both signs, NaN among them
        for _ in 0..(1 << 32) / 9973_u64 {
            bits = bits.wrapping_add(9973);
            let x = f32::from_bits(bits);
            let (ours, theirs) = (super::in_integers(x), x.sqrt());
            assert!(
                ours.to_bits() == theirs.to_bits() || (ours.is_nan() && theirs.is_nan()),
                "{x:e}: {ours:e} {theirs:e}"
            );
        }
        for x in [0.0, -0.0, f32::INFINITY, f32::MIN_POSITIVE, f32::from_bits(1), f32::MAX, 1.0, 4.0] {
            assert_eq!(super::in_integers(x).to_bits(), x.sqrt().to_bits(), "{x:e}");
        }
    }
}
