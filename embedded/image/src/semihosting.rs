//! What a bare machine asks of the host that it is emulated on.
#![allow(unsafe_code, reason = "the start-up code finds `exit` by its name")]

use crate::board::call;

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
