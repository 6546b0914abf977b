//! Where C's pointers become Rust's slices: all the unsafe code there is.

use leafbrdf_core::DirectionCosines;
use leafbrdf_fit::device::Workspace;

use crate::band::lb_workspace;
use crate::number::Number;
use crate::status::{LB_ERR_NULL, lb_status};
use crate::surface::lb_cosines;

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

/// The same place, by a way that the compiler cannot see through: what has been read and checked is then read once more where it is
/// needed, instead of being kept on the stack meanwhile. For a Cortex-M0, where every operation is a call and there are few registers.
#[inline(always)]
pub fn afresh<T>(place: &T) -> &T {
    #[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
    {
        #![expect(clippy::pointers_in_nomem_asm_block, reason = "the compiler shall know that nothing is read")]
        let mut pointer = core::ptr::from_ref(place);
        // SAFETY: no instruction at all
        unsafe {
            core::arch::asm!("/* {0} */", inlateout(reg) pointer, options(pure, nomem, nostack, preserves_flags))
        };
        // SAFETY: the same pointer
        unsafe { &*pointer }
    }
    #[cfg(not(all(target_arch = "arm", not(target_abi = "eabihf"))))]
    {
        place
    }
}

/// C's sines and cosines as the model's.
#[inline(always)]
pub fn cosines(at: &lb_cosines) -> &DirectionCosines<Number> {
    const {
        assert!(size_of::<DirectionCosines<Number>>() == size_of::<lb_cosines>());
        assert!(align_of::<DirectionCosines<Number>>() == align_of::<lb_cosines>());
    }
    // SAFETY: five numbers both, in the same order
    unsafe { &*core::ptr::from_ref(at).cast::<DirectionCosines<Number>>() }
}
