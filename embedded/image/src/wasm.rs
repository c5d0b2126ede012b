//! The table and the demonstration as exports of a WebAssembly module.
#![allow(unsafe_code, reason = "exports, imports and the panic handler")]

use core::panic::PanicInfo;

use embedded_entries::{ENTRIES, Entry, Run};

#[link(wasm_import_module = "host")]
unsafe extern "C" {
    /// Takes the next byte of the demonstration's text.
    safe fn put_byte(byte: u32);
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}

fn row(index: u32) -> Option<&'static Entry> {
    ENTRIES.into_iter().flatten().nth(index as usize)
}

/// The digest of a row's results.
#[unsafe(no_mangle)]
extern "C" fn digest(index: u32, is_double: u32) -> u64 {
    let Some(row) = row(index) else { return 0 };
    let mut run = Run::new(|| 0);
    for _ in 0..row.times {
        (if is_double == 0 { row.single } else { row.double })(&mut run);
    }
    run.digest()
}

/// The number of rows.
#[unsafe(no_mangle)]
extern "C" fn rows() -> u32 {
    ENTRIES.into_iter().flatten().count() as u32
}

/// The demonstration.
#[unsafe(no_mangle)]
extern "C" fn demo() -> u32 {
    u32::from(embedded_demo::report(&mut |text| {
        for byte in text.bytes().chain([b'\n']) {
            put_byte(u32::from(byte));
        }
    }))
}
