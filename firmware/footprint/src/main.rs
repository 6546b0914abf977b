//! Calls every entry point of the C interface on inputs of a fixed seed and prints, a line each, what it costs: `run` gathers
//! the lines of all boards into `footprint.csv`.
//!
//! | line | meaning |
//! |---|---|
//! | `instructions NAME MEAN MAX` | a call, with the branch to it and the return, the loop around it taken out |
//! | `stack NAME BYTES` | below the caller's stack pointer at the call, by painting |
//! | `bits NAME HASH` | of all results: must be the same on every board and on the host |
//! | `error NAME VALUE` | largest relative error, in units of 10⁻⁸ (on the host only: the bits are the same) |
//! | `worst NAME VALUE` | a bound that a search keeps: steps at most |

#![cfg_attr(target_os = "none", no_std, no_main)]

mod cost;
#[cfg(not(target_os = "none"))]
mod error;
mod inputs;
mod jobs;

#[cfg_attr(all(target_os = "none", target_arch = "arm"), cortex_m_rt::entry)]
#[cfg_attr(all(target_os = "none", target_arch = "riscv32"), riscv_rt::entry)]
fn main() -> ! {
    example::board::start();
    jobs::all();
    #[cfg(not(target_os = "none"))]
    error::all();
    example::board::exit(true)
}
