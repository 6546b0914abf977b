//! The bare Cortex-M4F: vectors, start-up, and the debugger's console (Arm semihosting) for output.

use core::arch::{asm, global_asm};

// Sixteen vectors: the stack, the reset, and every exception ends the run as a failure.
// The FPU is off after reset: CPACR (0xE000_ED88) must be written before the first floating-point instruction.
global_asm!(
    r#"
    .section .vectors, "a"
    .word _stack_top
    .word reset
    .rept 14
    .word exception
    .endr

    .section .text.reset, "ax"
    .global reset
    .type reset, %function
    .thumb_func
reset:
    ldr   r0, =0xE000ED88
    ldr   r1, [r0]
    orr   r1, r1, #0x00F00000
    str   r1, [r0]
    dsb
    isb
    ldr   r0, =_data_start
    ldr   r1, =_data_end
    ldr   r2, =_data_load
1:  cmp   r0, r1
    bhs   2f
    ldr   r3, [r2], #4
    str   r3, [r0], #4
    b     1b
2:  ldr   r0, =_bss_start
    ldr   r1, =_bss_end
    movs  r3, #0
3:  cmp   r0, r1
    bhs   4f
    str   r3, [r0], #4
    b     3b
4:  bl    start
    b     exception
    .ltorg
"#
);

/// Semihosting call `operation`: the debugger (QEMU) reads the argument where `argument` points.
fn semihosting(operation: u32, argument: u32) {
    // SAFETY: bkpt 0xAB hands r0 and r1 to the debugger, which writes r0 only; every argument passed below is either
    // a constant or the address of a byte that lives through the call.
    unsafe { asm!("bkpt 0xAB", inout("r0") operation => _, in("r1") argument, options(nostack)) }
}

/// One byte to the console (SYS_WRITEC).
pub fn write(byte: u8) {
    semihosting(0x03, (&raw const byte) as u32);
}

/// End of the run (SYS_EXIT): exit status 0 for success, 1 otherwise.
fn exit(success: bool) -> ! {
    const APPLICATION_EXIT: u32 = 0x2_0026;
    const INTERNAL_ERROR: u32 = 0x2_0024;
    semihosting(0x18, if success { APPLICATION_EXIT } else { INTERNAL_ERROR });
    loop {
        core::hint::spin_loop();
    }
}

#[unsafe(no_mangle)]
extern "C" fn start() -> ! {
    crate::print_all(write);
    exit(true)
}

#[unsafe(no_mangle)]
extern "C" fn exception() -> ! {
    exit(false)
}

// Its own symbol, never inlined: whatever reaches the handler shows in `nm` under this name, whichever way the
// compiler names and merges the functions of core.
#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn link_check_panicked() -> ! {
    exit(false)
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    link_check_panicked()
}
