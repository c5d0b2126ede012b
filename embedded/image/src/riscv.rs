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
fn call(operation: u32, argument: u32) {
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

/// Writes text that ends with a zero.
pub(crate) fn write(text: &[u8]) {
    const SYS_WRITE0: u32 = 4;
    call(SYS_WRITE0, text.as_ptr().addr() as u32);
}

/// Ends the emulator: status 0, or 1.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn exit(success: bool) -> ! {
    const SYS_EXIT_EXTENDED: u32 = 0x20;
    const STOPPED: u32 = 0x20026;
    let block = [STOPPED, u32::from(!success)];
    loop {
        call(SYS_EXIT_EXTENDED, block.as_ptr().addr() as u32);
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
