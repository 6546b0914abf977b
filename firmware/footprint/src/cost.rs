//! Counting: instructions by the board's counter, stack by painting.

use core::hint::black_box;

use example::board;
use example::text::{print, print_whole};

/// A function that returns at once, and on a device by one instruction: compiled Rust would make itself a frame first, which would
/// be taken for a part of what is around every call.
macro_rules! empty {
    ($name:ident($($argument:ty),* $(,)?)) => {
        #[cfg(target_os = "none")]
        #[unsafe(naked)]
        extern "C" fn $name($(_: $argument),*) -> lb_status {
            #[cfg(target_arch = "arm")]
            core::arch::naked_asm!("bx lr");
            #[cfg(target_arch = "riscv32")]
            core::arch::naked_asm!("ret");
        }
        #[cfg(not(target_os = "none"))]
        extern "C" fn $name($(_: $argument),*) -> lb_status {
            0
        }
    };
}
pub(crate) use empty;

/// Measures the entry point `real`, called by `call` with the number of the case; `empty` has the same signature and only returns.
///
/// Both run through the same code, so that the difference is the entry point's own. `each`: cases are timed one by one, for a
/// maximum; else all together, which a counter that ticks every 40 instructions needs for short calls.
pub fn measure<F: Copy>(name: &str, real: F, empty: F, cases: u32, each: bool, call: impl Fn(F, u32)) {
    let total = |f: F, from: u32, to: u32| {
        board::instructions(|| {
            for case in from..to {
                call(black_box(f), black_box(case));
            }
        })
    };
    // the call of the empty one is a branch and a return
    const BRANCHES: u64 = 2;
    let rounded = |real: u64, empty: u64, calls: u64| (real.saturating_sub(empty) + calls / 2) / calls + BRANCHES;
    let mean = rounded(total(real, 0, cases), total(empty, 0, cases), u64::from(cases));
    let mut largest = mean;
    if each {
        for case in 0..cases {
            largest = largest.max(rounded(total(real, case, case + 1), total(empty, case, case + 1), 1));
        }
    }
    line("instructions", name);
    print_whole(mean);
    print(" ");
    if each {
        print_whole(largest);
    }
    print("\n");

    let mut deepest = 0;
    for case in 0..cases.min(64) {
        let used = depth(&|| call(black_box(real), black_box(case)));
        let around = depth(&|| call(black_box(empty), black_box(case)));
        deepest = deepest.max(used.saturating_sub(around));
    }
    line("stack", name);
    print_whole(deepest as u64);
    print("\n");
}

/// `kind name `
pub fn line(kind: &str, name: &str) {
    print(kind);
    print(" ");
    print(name);
    print(" ");
}

/// Bytes of stack that `work` takes below the stack pointer of its caller.
#[inline(never)]
fn depth<W: Fn()>(work: &W) -> usize {
    extern "C" fn run<W: Fn()>(work: *const ()) {
        // SAFETY: the pointer below, to a W that lives through the call
        unsafe { (*work.cast::<W>())() }
    }
    #[cfg(target_os = "none")]
    {
        unsafe extern "C" {
            fn footprint_depth(run: extern "C" fn(*const ()), work: *const ()) -> usize;
        }
        // SAFETY: paints 5,000 bytes below its own stack pointer, which the smallest board has free, and calls `run` once
        unsafe { footprint_depth(run::<W>, core::ptr::from_ref(work).cast()) }
    }
    #[cfg(not(target_os = "none"))]
    {
        run::<W>(core::ptr::from_ref(work).cast());
        0
    }
}

// r0, a0: the function; r1, a1: its argument. From the stack pointer downwards everything is painted, so that not even one word
// of the callee's is missed.
#[cfg(all(target_os = "none", target_arch = "arm"))]
core::arch::global_asm!(
    r#"
    .section .text.footprint_depth, "ax"
    .global footprint_depth
    .type footprint_depth, %function
    .thumb_func
footprint_depth:
    push  {{r4, r5, r6, lr}}
    mov   r4, sp
    ldr   r2, =5000
    subs  r5, r4, r2
    mov   r2, r5
    ldr   r3, =0x5AFE5AFE
1:  str   r3, [r2]
    adds  r2, r2, #4
    cmp   r2, r4
    blo   1b
    mov   r2, r0
    mov   r0, r1
    blx   r2
    ldr   r3, =0x5AFE5AFE
2:  ldr   r2, [r5]
    cmp   r2, r3
    bne   3f
    adds  r5, r5, #4
    cmp   r5, r4
    blo   2b
3:  subs  r0, r4, r5
    pop   {{r4, r5, r6, pc}}
    .ltorg
"#
);
#[cfg(all(target_os = "none", target_arch = "riscv32"))]
core::arch::global_asm!(
    r#"
    .section .text.footprint_depth, "ax"
    .global footprint_depth
footprint_depth:
    addi  sp, sp, -16
    sw    ra, 12(sp)
    sw    s0, 8(sp)
    sw    s1, 4(sp)
    mv    s0, sp
    li    t0, 5000
    sub   s1, s0, t0
    mv    t1, s1
    li    t2, 0x5AFE5AFE
1:  sw    t2, 0(t1)
    addi  t1, t1, 4
    bltu  t1, s0, 1b
    mv    t0, a0
    mv    a0, a1
    jalr  t0
    li    t2, 0x5AFE5AFE
2:  lw    t0, 0(s1)
    bne   t0, t2, 3f
    addi  s1, s1, 4
    bltu  s1, s0, 2b
3:  sub   a0, s0, s1
    lw    ra, 12(sp)
    lw    s0, 8(sp)
    lw    s1, 4(sp)
    addi  sp, sp, 16
    ret
"#
);
