//! Cortex-M: vectors, the floating-point unit, semihosting, SysTick.
#![allow(unsafe_code, reason = "instructions and registers of the machine are beyond safe code")]

use core::arch::{asm, global_asm};

global_asm!(
    ".section .vectors, \"a\"",
    ".global __flash_start",
    "__flash_start:",
    ".word __stack_top",
    ".word reset",
    ".rept 14",
    ".word fault",
    ".endr",
    ".section .text.reset, \"ax\"",
    ".thumb_func",
    ".global reset",
    "reset:",
);

// Full access to the coprocessors 10 and 11 before the first instruction for them.
#[cfg(target_abi = "eabihf")]
global_asm!(
    ".section .text.reset, \"ax\"",
    "ldr r0, =0xe000ed88",
    "ldr r1, [r0]",
    "orr r1, r1, #(0xf << 20)",
    "str r1, [r0]",
    "dsb",
    "isb",
);

// By address, which says that it is Thumb code: `main` is another name that the linker gives to a function.
global_asm!(
    ".section .text.reset, \"ax\"",
    "ldr r0, =main",
    "blx r0",
    ".thumb_func",
    ".global fault",
    "fault:",
    "movs r0, #0",
    "bl exit",
    "b fault",
    ".pool",
);

/// One semihosting call.
pub(crate) fn call(operation: u32, argument: u32) {
    // SAFETY: the host reads memory that the caller owns, and writes none.
    unsafe { asm!("bkpt 0xab", inout("r0") operation => _, in("r1") argument, options(nostack)) };
}

/// SysTick's control and status, reload value and current value.
const SYST: [*mut u32; 3] = [0xe000_e010 as *mut u32, 0xe000_e014 as *mut u32, 0xe000_e018 as *mut u32];

/// Where the stack ends now.
#[inline(always)]
pub(crate) fn stack_pointer() -> usize {
    let pointer: usize;
    // SAFETY: copies a register.
    unsafe { asm!("mov {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags)) };
    pointer
}

/// Starts SysTick from its longest period, on the processor's clock, without interrupts.
pub(crate) fn start_clock() {
    let [control, reload, value] = SYST;
    // SAFETY: these are registers of every Cortex-M, and nobody else uses them.
    unsafe {
        reload.write_volatile(0x00ff_ffff);
        value.write_volatile(0);
        control.write_volatile(5);
    }
}

/// Ticks upwards, in the upper 24 bits, so that differences wrap as they should.
pub(crate) fn clock() -> u32 {
    // SAFETY: as above.
    let value = unsafe { SYST[2].read_volatile() };
    (0x00ff_ffff - value) << 8
}
