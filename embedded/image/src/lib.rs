//! The part of an image that is not a row of the table: start-up, semihosting, clock and stack of a bare machine; or, on
//! WebAssembly, the table itself.
#![cfg_attr(any(target_os = "none", target_arch = "wasm32"), no_std)]

#[cfg(all(target_os = "none", target_arch = "arm"))]
#[path = "cortex_m.rs"]
mod board;
#[cfg(all(target_os = "none", target_arch = "riscv32"))]
#[path = "riscv.rs"]
mod board;

#[cfg(target_os = "none")]
mod bare;
#[cfg(target_os = "none")]
mod semihosting;
#[cfg(target_arch = "wasm32")]
mod wasm;
