//! The arithmetic behind the interface: which number type computes.

/// What the equations compute with. Same bits on every target: no fused multiply-add, no system library.
pub type Number = f32;

/// From C.
#[inline(always)]
pub fn number(x: f32) -> Number {
    x
}

/// To C.
#[inline(always)]
pub fn float(x: Number) -> f32 {
    x
}
