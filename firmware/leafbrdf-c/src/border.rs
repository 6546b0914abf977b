//! Where C's pointers become Rust's slices: all the unsafe code there is.

use crate::status::{LB_ERR_NULL, lb_status};

/// `count` values at `pointer`.
///
/// # Errors
/// [`LB_ERR_NULL`] for a null pointer.
///
/// # Safety
/// A pointer that is not null is aligned and points to `count` initialised values that nobody changes during `'a`.
#[inline(always)]
pub unsafe fn slice<'a, T>(pointer: *const T, count: u32) -> Result<&'a [T], lb_status> {
    if pointer.is_null() {
        return Err(LB_ERR_NULL);
    }
    // SAFETY: not null; the rest is the caller's promise
    Ok(unsafe { core::slice::from_raw_parts(pointer, count as usize) })
}

/// `count` values at `pointer`, to write.
///
/// # Errors
/// [`LB_ERR_NULL`] for a null pointer.
///
/// # Safety
/// A pointer that is not null is aligned and points to `count` initialised values that nobody else reads or changes during `'a`.
#[inline(always)]
pub unsafe fn slice_mut<'a, T>(pointer: *mut T, count: u32) -> Result<&'a mut [T], lb_status> {
    if pointer.is_null() {
        return Err(LB_ERR_NULL);
    }
    // SAFETY: not null; the rest is the caller's promise
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer, count as usize) })
}
