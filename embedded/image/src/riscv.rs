//! RISC-V, 32 bits: start-up and semihosting; no clock.
#![allow(unsafe_code, reason = "instructions of the machine are beyond safe code")]

use core::arch::{asm, global_asm};

global_asm!(
    ".section .vectors, \"ax\"",
    ".global __flash_start, reset",
    "__flash_start:",
    "reset:",
    "la sp, __stack_top",
    "la t0, fault",
    "csrw mtvec, t0",
    "call main",
    ".balign 4",
    "fault:",
    "li a0, 0",
    "call exit",
    "j fault",
);

/// One semihosting call: three instructions that must not be compressed.
pub(crate) fn call(operation: u32, argument: u32) {
    // SAFETY: the host reads memory that the caller owns, and writes none.
    unsafe {
        asm!(
            ".balign 16",
            ".option push",
            ".option norvc",
            "slli x0, x0, 0x1f",
            "ebreak",
            "srai x0, x0, 7",
            ".option pop",
            inout("a0") operation => _, in("a1") argument, options(nostack)
        );
    }
}

/// Where the stack ends now.
#[inline(always)]
pub(crate) fn stack_pointer() -> usize {
    let pointer: usize;
    // SAFETY: copies a register.
    unsafe { asm!("mv {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags)) };
    pointer
}

/// Nothing: instructions are counted on Cortex-M.
pub(crate) fn start_clock() {}

/// No time passes.
pub(crate) fn clock() -> u32 {
    0
}
