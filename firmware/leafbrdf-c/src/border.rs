//! Where C's pointers become Rust's slices: all the unsafe code there is.

use leafbrdf_fit::device::Workspace;

use crate::band::lb_workspace;
use crate::number::Number;
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

/// [`slice`], seen as the numbers that compute.
///
/// # Safety
/// As for [`slice`].
#[inline(always)]
pub unsafe fn numbers<'a>(pointer: *const f32, count: u32) -> Result<&'a [Number], lb_status> {
    // SAFETY: the caller's promise; Number is a transparent f32
    unsafe { slice(pointer.cast::<Number>(), count) }
}

/// `count` places at `pointer`, to write.
///
/// # Errors
/// [`LB_ERR_NULL`] for a null pointer.
///
/// # Safety
/// A pointer that is not null is aligned and points to `count` values of `T` (which may be `MaybeUninit`) that nobody else reads
/// or changes during `'a`.
#[inline(always)]
pub unsafe fn slice_mut<'a, T>(pointer: *mut T, count: u32) -> Result<&'a mut [T], lb_status> {
    if pointer.is_null() {
        return Err(LB_ERR_NULL);
    }
    // SAFETY: not null; the rest is the caller's promise
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer, count as usize) })
}

/// C's opaque memory as the solver's workspace.
///
/// # Safety
/// A pointer that is not null is aligned and points to an `lb_workspace` that nobody else reads or changes during `'a`.
#[inline(always)]
pub unsafe fn workspace<'a>(pointer: *mut lb_workspace) -> Result<&'a mut Workspace<Number>, lb_status> {
    const {
        assert!(size_of::<Workspace<Number>>() == size_of::<lb_workspace>(), "LB_WORKSPACE_FLOATS is not the size");
        assert!(align_of::<Workspace<Number>>() == align_of::<lb_workspace>());
    }
    // SAFETY: of one size and alignment, and both nothing but floats, for which every content is a value
    unsafe { pointer.cast::<Workspace<Number>>().as_mut() }.ok_or(LB_ERR_NULL)
}
