//! √x of an `f32`, correctly rounded: by the floating-point unit where there is one, else in integers. The same bits.

/// √x; NaN for x < 0.
#[inline(always)]
pub(crate) fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    {
        by_instruction(x)
    }
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    {
        by_digits(x)
    }
}

/// VSQRT. `core` offers no square root, and the one of the `libm` crate costs 48 instructions instead of 7.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[allow(unsafe_code)] // the one place: an instruction that stable Rust reaches by assembly only
#[inline(always)]
fn by_instruction(x: f32) -> f32 {
    let result: u32;
    // SAFETY: no memory and no stack; s0, which may not be declared as clobbered on stable, is put back. The ABI of this
    // target (eabihf) says that the unit is there.
    unsafe {
        core::arch::asm!(
            "vmov {saved}, s0",
            "vmov s0, {x}",
            "vsqrt.f32 s0, s0",
            "vmov {x}, s0",
            "vmov s0, {saved}",
            x = inlateout(reg) x.to_bits() => result,
            saved = out(reg) _,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    f32::from_bits(result)
}

/// The root digit by digit, as on paper, in base 2: 24 bits and one more to round by.
#[cfg(any(test, not(all(target_arch = "arm", target_abi = "eabihf"))))]
#[inline]
fn by_digits(x: f32) -> f32 {
    let bits = x.to_bits();
    // zeros, infinity and NaN are their own roots; what is negative has none
    if bits << 1 == 0 || bits == f32::INFINITY.to_bits() || x.is_nan() {
        return x;
    }
    if bits >> 31 == 1 {
        return f32::NAN;
    }
    let mut exponent = (bits >> 23) as i32;
    let mut mantissa = bits & 0x007F_FFFF;
    if exponent == 0 {
        let zeros = mantissa.leading_zeros() - 8;
        mantissa <<= zeros;
        exponent = 1 - zeros as i32;
    } else {
        mantissa |= 0x0080_0000;
    }
    // x = rest · 2^(exponent − 150) with an even power of two: 127 is odd
    let odd = exponent & 1;
    let mut rest = mantissa << (2 - odd);
    let half_exponent = (exponent + odd) >> 1;

    // root² ≤ x < (root + digit)², all at the scale of `digit`
    let (mut root, mut trial, mut digit) = (0_u32, 0_u32, 0x0100_0000_u32);
    while digit != 0 {
        let next = trial + digit;
        if next <= rest {
            rest -= next;
            trial = next + digit;
            root += digit;
        }
        rest <<= 1;
        digit >>= 1;
    }
    // the last bit is half a unit: a tie cannot occur, a root of 25 bits has a square of more than 24
    let rounded = (root + 1) >> 1;
    f32::from_bits((((half_exponent + 62) as u32) << 23).wrapping_add(rounded))
}

#[cfg(test)]
mod tests {
    extern crate std;

    #[test]
    fn the_root_by_digits_is_the_hardware_root_for_every_kind_of_number() {
        let mut bits = 0_u32;
        // a stride without a common factor with 2³²: some 430,000 numbers of every exponent, both signs, NaN among them
        for _ in 0..(1 << 32) / 9973_u64 {
            bits = bits.wrapping_add(9973);
            let x = f32::from_bits(bits);
            let (ours, theirs) = (super::by_digits(x), x.sqrt());
            assert!(
                ours.to_bits() == theirs.to_bits() || (ours.is_nan() && theirs.is_nan()),
                "{x:e}: {ours:e} {theirs:e}"
            );
        }
        for x in [0.0, -0.0, f32::INFINITY, f32::MIN_POSITIVE, f32::from_bits(1), f32::MAX, 1.0, 4.0] {
            assert_eq!(super::by_digits(x).to_bits(), x.sqrt().to_bits(), "{x:e}");
        }
    }
}
