//! `leafbrdf-c` as a static library for any target: see `firmware/object`.

#![no_std]

pub use leafbrdf_c::*;

/// A static library must have one. Nothing in this library panics: `.ci/firmware` finds no trace of this function in the object.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

/// A bounds check that can fail: `firmware/object` must refuse it.
#[cfg(feature = "planted-panic")]
#[unsafe(no_mangle)]
pub extern "C" fn lb_planted(place: usize) -> f32 {
    [1.0, 2.0, 3.0][place]
}
