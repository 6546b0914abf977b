//! What the programs of this firmware share.
//!
//! | room | what |
//! |---|---|
//! | `board` | start-up, console, instruction counter and stack of a device under QEMU; the same calls on the host |
//! | `text` | numbers in decimal without `core::fmt`, whose machinery can panic |
//! | `measurement` | a simulated measurement, a table in flash |
//! | `agreement` | evaluations that must have the same bits everywhere |

#![cfg_attr(target_os = "none", no_std)]

pub mod agreement;
pub mod board;
pub mod measurement;
pub mod text;
