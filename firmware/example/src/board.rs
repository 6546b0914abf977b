//! A device under QEMU, or the host that stands in for it.
//!
//! | call | device | host |
//! |---|---|---|
//! | [`write()`] | semihosting console | standard output |
//! | [`exit`] | semihosting exit | process exit |
//! | [`instructions`] | SysTick or minstret under `-icount shift=0` | 0 |
//! | [`stack`] | painted memory below the stack pointer | 0 |

#[cfg(all(target_os = "none", target_arch = "arm"))]
#[path = "board/cortex_m.rs"]
mod machine;
#[cfg(all(target_os = "none", target_arch = "riscv32"))]
#[path = "board/riscv.rs"]
mod machine;
#[cfg(not(target_os = "none"))]
#[path = "board/host.rs"]
mod machine;
#[cfg(target_os = "none")]
mod paint;

pub use machine::{exit, instructions, stack, start, write};

// Its own symbol, never inlined: whatever reaches the handler shows in `nm` under this name.
#[cfg(target_os = "none")]
#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn example_panicked() -> ! {
    exit(false)
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    example_panicked()
}
