//! The arithmetic behind the interface: which number type computes.

use leafbrdf_core::real::device::F32;

/// What the equations compute with: no `f64`, no system library, no fused multiply-add, the same bits on every target.
pub type Number = F32;

/// From C.
#[inline(always)]
pub fn number(x: f32) -> Number {
    F32(x)
}

/// To C.
#[inline(always)]
pub fn float(x: Number) -> f32 {
    x.0
}
