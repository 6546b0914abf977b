//! Status codes.

use core::ffi::c_char;

/// What a function says of its call: `LB_OK`, or what was wrong with an argument.
pub type lb_status = i32;

/// Done; the outputs are written.
pub const LB_OK: lb_status = 0;
/// A pointer is null.
pub const LB_ERR_NULL: lb_status = 1;
/// theta_s is outside 0 <= theta_s < 90 degrees, or its sine and cosine do not belong together.
pub const LB_ERR_THETA_S: lb_status = 2;
/// theta_v is outside 0 <= theta_v < 90 degrees, or its sine and cosine do not belong together.
pub const LB_ERR_THETA_V: lb_status = 3;
/// phi_v is outside -360 <= phi_v <= 360 degrees, or its cosine outside -1 to 1.
pub const LB_ERR_PHI_V: lb_status = 4;
/// The cosine of the incidence angle on the facet is outside 0 to 1.
pub const LB_ERR_THETA_A: lb_status = 5;
/// k_lambert is outside 0 <= k_lambert <= 1.
pub const LB_ERR_K_LAMBERT: lb_status = 6;
/// n is outside 1 <= n <= 16384.
pub const LB_ERR_N: lb_status = 7;
/// sigma is outside 2^-30 <= sigma <= 1024.
pub const LB_ERR_SIGMA: lb_status = 8;
/// normalization is neither LB_BOUSQUET_2005 nor LB_COOK_TORRANCE.
pub const LB_ERR_NORMALIZATION: lb_status = 9;
/// Bounds are out of order or outside the model's domain.
pub const LB_ERR_BOUNDS: lb_status = 10;
/// A measured value, a weight or a direction is not finite, or a weight is negative.
pub const LB_ERR_DATA: lb_status = 11;
/// Fewer values than free parameters count.
pub const LB_ERR_TOO_FEW: lb_status = 12;
/// A count is 0, or leads beyond the table.
pub const LB_ERR_COUNT: lb_status = 13;
/// A parameter of PROSPECT is impossible, or probably in another unit.
pub const LB_ERR_INTERIOR: lb_status = 14;
/// A wavelength is outside the slice of PROSPECT, or they do not rise.
pub const LB_ERR_WAVELENGTH: lb_status = 15;

/// What a status means, in one English sentence in ASCII: a constant string, never null.
#[unsafe(no_mangle)]
pub extern "C" fn lb_status_text(status: lb_status) -> *const c_char {
    let text = match status {
        LB_OK => c"done",
        LB_ERR_NULL => c"a pointer is null",
        LB_ERR_THETA_S => c"theta_s: expected 0 <= theta_s < 90 degrees, sin^2 + cos^2 = 1 within 1e-4",
        LB_ERR_THETA_V => c"theta_v: expected 0 <= theta_v < 90 degrees, sin^2 + cos^2 = 1 within 1e-4",
        LB_ERR_PHI_V => c"phi_v: expected -360 to 360 degrees, or a cosine from -1 to 1",
        LB_ERR_THETA_A => c"cos_theta_a: expected 0 to 1",
        LB_ERR_K_LAMBERT => c"k_lambert: expected 0 to 1",
        LB_ERR_N => c"n: expected 1 to 16384",
        LB_ERR_SIGMA => c"sigma: expected 2^-30 to 1024",
        LB_ERR_NORMALIZATION => c"normalization: expected LB_BOUSQUET_2005 or LB_COOK_TORRANCE",
        LB_ERR_BOUNDS => c"bounds: expected lower < upper, inside the model's domain",
        LB_ERR_DATA => c"data: expected finite values and weights >= 0; give missing values weight 0",
        LB_ERR_TOO_FEW => c"data: fewer values than free parameters count",
        LB_ERR_COUNT => c"count: expected at least 1, and no band beyond the table",
        LB_ERR_INTERIOR => c"interior: a parameter of PROSPECT is outside its limits; check its unit",
        LB_ERR_WAVELENGTH => c"wavelengths: expected rising, inside the slice of PROSPECT",
        _ => c"unknown status",
    };
    text.as_ptr()
}

/// The version of this library, major * 65536 + minor * 256 + patch: 0.1.0 is 256.
#[unsafe(no_mangle)]
pub extern "C" fn lb_version() -> u32 {
    const { version(env!("CARGO_PKG_VERSION").as_bytes()) }
}

/// `major.minor.patch` as one number.
const fn version(text: &[u8]) -> u32 {
    let (mut whole, mut part, mut i) = (0, 0, 0);
    while i < text.len() {
        if text[i] == b'.' {
            (whole, part) = ((whole + part) * 256, 0);
        } else {
            part = part * 10 + (text[i] - b'0') as u32;
        }
        i += 1;
    }
    whole + part
}
