//! Cortex-M: cortex-m-rt starts it (vectors, memory, the FPU), semihosting is its console, SysTick its counter.

use core::arch::asm;

use super::paint;

/// Semihosting call `operation`: the debugger (QEMU) reads the argument where `argument` points.
fn semihosting(operation: u32, argument: u32) {
    // SAFETY: bkpt 0xAB hands r0 and r1 to the debugger, which writes r0 only; every argument passed below is either a
    // constant or the address of a byte that lives through the call
    unsafe { asm!("bkpt 0xAB", inout("r0") operation => _, in("r1") argument, options(nostack)) }
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

const SYST_CSR: *mut u32 = 0xE000_E010 as *mut u32;
const SYST_RVR: *mut u32 = 0xE000_E014 as *mut u32;
const SYST_CVR: *mut u32 = 0xE000_E018 as *mut u32;
const FULL: u32 = 0x00FF_FFFF;

/// Starts SysTick on the processor's clock, 24 bits, without interrupt.
pub fn start() {
    // SAFETY: SysTick's registers, which nothing else in this program uses
    unsafe {
        SYST_RVR.write_volatile(FULL);
        SYST_CVR.write_volatile(0);
        SYST_CSR.write_volatile(0b101);
    }
}

fn ticks(work: impl FnOnce()) -> u64 {
    // SAFETY: a read of SysTick's counter
    let now = || unsafe { SYST_CVR.read_volatile() };
    let before = now();
    work();
    // it counts down
    u64::from(before.wrapping_sub(now()) & FULL)
}

/// Twice `rounds` instructions.
#[inline(never)]
fn known(rounds: u32) {
    // SAFETY: counts a register down to 0
    unsafe { asm!("1: subs {0}, {0}, #1", "bne 1b", inout(reg) rounds => _, options(nomem, nostack)) }
}

/// Runs `work` and returns how many instructions it took, to within one tick of SysTick (some tens of them).
///
/// Under `-icount shift=0` an instruction takes one nanosecond of virtual time; how many make a tick is measured on a loop
/// of known length. `work` must be shorter than 2²⁴ ticks (700 million instructions).
pub fn instructions(work: impl FnOnce()) -> u64 {
    const ROUNDS: u32 = 500_000;
    let per_million = ticks(|| known(ROUNDS));
    let taken = ticks(work);
    if per_million == 0 { 0 } else { taken * 1_000_000 / per_million }
}

#[inline(always)]
fn stack_pointer() -> usize {
    let pointer: usize;
    // SAFETY: copies a register
    unsafe { asm!("mov {}, sp", out(reg) pointer, options(nomem, nostack)) }
    pointer
}

/// Runs `work` and returns the bytes of stack that it took.
pub fn stack(work: impl FnOnce()) -> usize {
    paint::high_water(stack_pointer, work)
}
