//! RV32: riscv-rt starts it, semihosting is its console, minstret its counter.

use core::arch::asm;

use super::paint;

/// Semihosting call `operation`: the debugger (QEMU) reads the argument where `argument` points.
#[inline(never)]
fn semihosting(operation: u32, argument: u32) {
    // SAFETY: this sequence, uncompressed and within one page, hands a0 and a1 to the debugger, which writes a0 only; every
    // argument passed below is either a constant or the address of memory that lives through the call
    unsafe {
        asm!(
            ".balign 16",
            ".option push",
            ".option norvc",
            "slli x0, x0, 0x1f",
            "ebreak",
            "srai x0, x0, 7",
            ".option pop",
            inout("a0") operation => _,
            in("a1") argument,
            options(nostack)
        )
    }
}

/// One byte to the console (SYS_WRITEC).
pub fn write(byte: u8) {
    semihosting(0x03, (&raw const byte) as u32);
}

/// End of the run (SYS_EXIT): exit status 0 for success, 1 otherwise.
pub fn exit(success: bool) -> ! {
    const APPLICATION_EXIT: u32 = 0x2_0026;
    const INTERNAL_ERROR: u32 = 0x2_0024;
    semihosting(0x18, if success { APPLICATION_EXIT } else { INTERNAL_ERROR });
    loop {
        core::hint::spin_loop();
    }
}

/// Nothing to prepare: minstret counts from reset.
pub fn start() {}

fn retired() -> u32 {
    let count: u32;
    // SAFETY: reads a counter
    unsafe { asm!("csrr {}, minstret", out(reg) count, options(nomem, nostack)) }
    count
}

/// Runs `work` and returns how many instructions it took, exactly; `work` must take fewer than 2³².
pub fn instructions(work: impl FnOnce()) -> u64 {
    let before = retired();
    work();
    u64::from(retired().wrapping_sub(before))
}

#[inline(always)]
fn stack_pointer() -> usize {
    let pointer: usize;
    // SAFETY: copies a register
    unsafe { asm!("mv {}, sp", out(reg) pointer, options(nomem, nostack)) }
    pointer
}

/// Runs `work` and returns the bytes of stack that it took.
pub fn stack(work: impl FnOnce()) -> usize {
    paint::high_water(stack_pointer, work)
}
