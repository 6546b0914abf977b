//! `lb_brdf` and `lb_brdf_from_degrees` where there is a floating-point unit: their checks in assembly, everything that is computed in
//! Rust.
//!
//! The checks cost a third of the call. Compiled, they cost half as much again: bits that were compared as integers move to the unit one
//! by one, a constant for every bound fills a register, registers are saved for them and a frame is made before the first of them. Here
//! bounds are powers of two (`leafbrdf_core::domain`), which an instruction carries; numbers are loaded twice, two at a time to be
//! compared and all at once to compute; and the frame is that of [`at_pair`].
//!
//! What is refused, and as what, is what `surface.rs` refuses on the other targets: `agreement` runs both over every edge of every
//! argument, on every board.

use core::mem::{MaybeUninit, offset_of};

use leafbrdf_core::{Pair, domain, half_vector};

use crate::border::cosines;
use crate::number::number;
use crate::status::{
    LB_ERR_K_LAMBERT, LB_ERR_N, LB_ERR_NORMALIZATION, LB_ERR_NULL, LB_ERR_PHI_V, LB_ERR_SIGMA, LB_ERR_THETA_S,
    LB_ERR_THETA_V, lb_status,
};
use crate::surface::{LB_COOK_TORRANCE, lb_cosines, lb_leaf, leaf_at};

/// Positive numbers have the order of their bits, and what is negative or no number lies above them all: `least` less, a number is
/// inside where its bits are at most the difference.
const fn bits(x: f64) -> u32 {
    (x as f32).to_bits()
}

const fn span([least, most]: [f64; 2]) -> u32 {
    bits(most) - bits(least)
}

// what the loads below suppose
const _: () = {
    assert!(LB_ERR_THETA_V == LB_ERR_THETA_S + 1 && LB_ERR_PHI_V == LB_ERR_THETA_S + 2);
    assert!(offset_of!(lb_leaf, k_lambert) == 0 && offset_of!(lb_leaf, n) == 4);
    assert!(offset_of!(lb_leaf, sigma) == 8 && offset_of!(lb_leaf, normalization) == 12);
    assert!(offset_of!(lb_cosines, cos_theta_s) == 0 && offset_of!(lb_cosines, sin_theta_s) == 4);
    assert!(offset_of!(lb_cosines, cos_theta_v) == 8 && offset_of!(lb_cosines, sin_theta_v) == 12);
    assert!(offset_of!(lb_cosines, cos_phi_v) == 16);
};

/// Checks and loads the leaf at r0; the normalization stays in r3. r12 is lost.
macro_rules! leaf {
    () => {
        concat!(
            // k_lambert, n
            "ldrd r3, r12, [r0]\n",
            "cmp r3, {one}\n",
            "bhi 6f\n",
            "16: sub r12, {n}\n",
            "cmp r12, {n_span}\n",
            "bhi 7f\n",
            // sigma, normalization
            "ldrd r12, r3, [r0, #8]\n",
            "sub r12, {sigma}\n",
            "cmp r12, {sigma_span}\n",
            "bhi 8f\n",
            "cmp r3, {cook_torrance}\n",
            "bhi 9f\n",
            // the first three once more
            "vldmia r0, {{s5-s7}}",
        )
    };
}

/// Where it leads to.
macro_rules! leaf_refused {
    () => {
        concat!(
            // -0 is 0
            "6: cmp r3, #0x80000000\n",
            "beq 16b\n",
            "movs r0, {bad_k_lambert}\n",
            "bx lr\n",
            "7: movs r0, {bad_n}\n",
            "bx lr\n",
            "8: movs r0, {bad_sigma}\n",
            "bx lr\n",
            "9: movs r0, {bad_normalization}\n",
            "bx lr",
        )
    };
}

/// cbindgen:ignore
/// Documented in `surface.rs`.
#[unsafe(no_mangle)]
#[unsafe(naked)]
pub extern "C" fn lb_brdf(
    leaf: Option<&lb_leaf>,
    at: Option<&lb_cosines>,
    brdf: Option<&mut MaybeUninit<f32>>,
) -> lb_status {
    core::arch::naked_asm!(
        ".fpu fpv4-sp-d16",
        "cbz r0, 1f",
        "cbz r1, 1f",
        "cbz r2, 1f",
        leaf!(),
        // from here on r0 is free
        // cosine and sine of theta_s
        "ldrd r0, r12, [r1]",
        "sub r0, {cos}",
        "cmp r0, {cos_span}",
        "bhi 2f",
        "cmp r12, {one}",
        "bhi 22f",
        // of theta_v
        "12: ldrd r0, r12, [r1, #8]",
        "sub r0, {cos}",
        "cmp r0, {cos_span}",
        "bhi 3f",
        "cmp r12, {one}",
        "bhi 33f",
        // cos phi_v, its sign shifted out
        "13: ldr r0, [r1, #16]",
        "lsls r0, r0, #1",
        "cmp r0, {twice_one}",
        "bhi 4f",
        "vldmia r1, {{s0-s4}}",
        "b {at_pair}",
        "1: movs r0, {null}",
        "bx lr",
        // -0 is 0
        "22: cmp r12, #0x80000000",
        "beq 12b",
        "2: movs r0, {bad_theta_s}",
        "bx lr",
        "33: cmp r12, #0x80000000",
        "beq 13b",
        "3: movs r0, {bad_theta_v}",
        "bx lr",
        "4: movs r0, {bad_phi_v}",
        "bx lr",
        leaf_refused!(),
        one = const bits(1.0),
        twice_one = const bits(1.0) << 1,
        n = const bits(domain::N[0]),
        n_span = const span(domain::N),
        sigma = const bits(domain::SIGMA[0]),
        sigma_span = const span(domain::SIGMA),
        cos = const bits(domain::COS[0]),
        cos_span = const span(domain::COS),
        cook_torrance = const LB_COOK_TORRANCE,
        at_pair = sym at_pair,
        null = const LB_ERR_NULL,
        bad_k_lambert = const LB_ERR_K_LAMBERT,
        bad_n = const LB_ERR_N,
        bad_sigma = const LB_ERR_SIGMA,
        bad_normalization = const LB_ERR_NORMALIZATION,
        bad_theta_s = const LB_ERR_THETA_S,
        bad_theta_v = const LB_ERR_THETA_V,
        bad_phi_v = const LB_ERR_PHI_V,
    )
}

/// cbindgen:ignore
/// Documented in `surface.rs`.
#[unsafe(no_mangle)]
#[unsafe(naked)]
pub extern "C" fn lb_brdf_from_degrees(
    leaf: Option<&lb_leaf>,
    theta_s_deg: f32,
    theta_v_deg: f32,
    phi_v_deg: f32,
    brdf: Option<&mut MaybeUninit<f32>>,
) -> lb_status {
    core::arch::naked_asm!(
        ".fpu fpv4-sp-d16",
        "cbz r0, 1f",
        "cbz r1, 1f",
        // three words: nothing that is called here wants a stack aligned to eight bytes
        "push {{r0, r1, lr}}",
        "bl {half_vector}",
        "pop {{r0, r2, lr}}",
        leaf!(),
        "vmov r0, s0",
        "cmp r0, #0",
        "blt 2f",
        // no cosines
        "movs r1, #0",
        "b {at_pair}",
        "1: movs r0, {null}",
        "bx lr",
        // -1, -2 or -3 for the angle that was refused
        "2: vcvt.s32.f32 s0, s0",
        "vmov r0, s0",
        "rsb r0, r0, {before_theta_s}",
        "bx lr",
        leaf_refused!(),
        one = const bits(1.0),
        n = const bits(domain::N[0]),
        n_span = const span(domain::N),
        sigma = const bits(domain::SIGMA[0]),
        sigma_span = const span(domain::SIGMA),
        cook_torrance = const LB_COOK_TORRANCE,
        half_vector = sym half_vector,
        at_pair = sym at_pair,
        null = const LB_ERR_NULL,
        before_theta_s = const LB_ERR_THETA_S - 1,
        bad_k_lambert = const LB_ERR_K_LAMBERT,
        bad_n = const LB_ERR_N,
        bad_sigma = const LB_ERR_SIGMA,
        bad_normalization = const LB_ERR_NORMALIZATION,
    )
}

/// The rest of `lb_brdf` and `lb_brdf_from_degrees`: arguments where the loads above have put them, all of them checked. Where `at` is null
/// the four numbers before the last are the pair itself.
#[inline(never)]
pub(crate) extern "C" fn at_pair(
    cos_theta_s: f32,
    sin_theta_s: f32,
    cos_theta_v: f32,
    sin_theta_v: f32,
    cos_phi_v: f32,
    k_lambert: f32,
    n: f32,
    sigma: f32,
    _r0: u32,
    at: Option<&lb_cosines>,
    out: &mut MaybeUninit<f32>,
    normalization: u32,
) -> lb_status {
    let leaf = lb_leaf { k_lambert, n, sigma, normalization };
    let pair = if at.is_some() {
        let at = lb_cosines { cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v };
        Pair::unchecked(cosines(&at))
    } else {
        let [cos_sum2, h, cos_cos, edge] = [cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v].map(number);
        Pair { cos_sum2, h, cos_cos, edge }
    };
    leaf_at(&leaf, &pair, out)
}
