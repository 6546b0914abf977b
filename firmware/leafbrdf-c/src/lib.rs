//! The C interface of leafbrdf, in single precision.
//!
//! | room | functions |
//! |---|---|
//! | `status` | status codes, `lb_status_text`, `lb_version` |
//! | `surface` | `lb_fresnel`, `lb_brdf`, `lb_brdf_gradient`, `lb_brdf_from_degrees` |
//! | `entry` | `lb_brdf` and `lb_brdf_from_degrees` where there is a floating-point unit |
//! | `direction` | `lb_direction_from_degrees`, `lb_direction_from_cosines`, `lb_brdf_at` |
//! | `hemisphere` | `lb_dhrf` |
//! | `band` | `lb_fit_band`, `lb_fit_bands` |
//! | `interior` | `lb_prospect_slice` |
//! | `chlorophyll` | `lb_fit_cab` |
//!
//! Entry points are thin: they look at pointers and domains, call the model, and write the result. Structs come as `Option<&T>`
//! and results leave through `Option<&mut MaybeUninit<T>>`, both of which are nullable C pointers by the language's
//! guarantee, so null needs no unsafe code. Arrays do: `border.rs` turns pointer and length into a slice, and is
//! the only place with an `unsafe` block. The functions of `entry.rs` begin in assembly.
//!
//! No globals, no heap: what a call needs is in its arguments. Every function may run in any thread or interrupt.

#![no_std]
// C names: lb_leaf, lb_status
#![allow(non_camel_case_types)]

mod band;
mod border;
mod chlorophyll;
mod direction;
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
mod entry;
mod hemisphere;
mod interior;
mod number;
mod status;
mod surface;

pub use band::{
    LB_AT_LOWER_K_LAMBERT, LB_AT_LOWER_N, LB_AT_LOWER_SIGMA, LB_AT_UPPER_K_LAMBERT, LB_AT_UPPER_N, LB_AT_UPPER_SIGMA,
    LB_BAND_MOST_STEPS, LB_WORKSPACE_FLOATS, lb_band, lb_bounds, lb_directions, lb_fit_band, lb_fit_bands,
    lb_workspace,
};
pub use chlorophyll::{LB_CAB_MOST_STEPS, lb_cab, lb_fit_cab};
pub use direction::{lb_brdf_at, lb_direction, lb_direction_from_cosines, lb_direction_from_degrees};
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
pub use entry::{lb_brdf, lb_brdf_from_degrees};
pub use hemisphere::lb_dhrf;
pub use interior::{LB_SLICE_BANDS, LB_SLICE_FIRST_NM, LB_SLICE_STEP_NM, lb_interior, lb_prospect_slice};
pub use status::{
    LB_ERR_BOUNDS, LB_ERR_COUNT, LB_ERR_DATA, LB_ERR_INTERIOR, LB_ERR_K_LAMBERT, LB_ERR_N, LB_ERR_NORMALIZATION,
    LB_ERR_NULL, LB_ERR_PHI_V, LB_ERR_SIGMA, LB_ERR_THETA_A, LB_ERR_THETA_S, LB_ERR_THETA_V, LB_ERR_TOO_FEW,
    LB_ERR_WAVELENGTH, LB_OK, lb_status, lb_status_text, lb_version,
};
pub use surface::{LB_BOUSQUET_2005, LB_COOK_TORRANCE, lb_brdf_gradient, lb_cosines, lb_fresnel, lb_gradient, lb_leaf};
#[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
pub use surface::{lb_brdf, lb_brdf_from_degrees};
