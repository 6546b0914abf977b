//! Prints the hashes that host and every device, Rust and C must agree on.

#![cfg_attr(target_os = "none", no_std, no_main)]

use example::agreement::agreement;
use example::board;
use example::text::{print, print_bits, print_whole};

#[cfg_attr(all(target_os = "none", target_arch = "arm"), cortex_m_rt::entry)]
#[cfg_attr(all(target_os = "none", target_arch = "riscv32"), riscv_rt::entry)]
fn main() -> ! {
    board::start();
    agreement(&mut |name, block, hash| {
        print(name);
        print(" ");
        print_whole(u64::from(block));
        print(" ");
        print_bits(hash);
        print("\n");
    });
    board::exit(true)
}
