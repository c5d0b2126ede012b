//! Runs the rows that are linked, and reports each over semihosting; or the demonstration.
#![allow(unsafe_code, reason = "the linker's symbols, the unused stack and the panic handler are beyond safe code")]

use core::panic::PanicInfo;

use embedded_entries::{Linked, Run};

use crate::{board, semihosting};

unsafe extern "C" {
    static __entries_start: u8;
    static __entries_end: u8;
    static __flash_start: u8;
    static __flash_end: u8;
    static __static_ram: u8;
    static __stack_limit: u8;
    /// Defined nowhere: an image in which a panic is left doesn't link.
    safe fn a_panic_is_left(file: *const u8, length: usize, line: u32, column: u32) -> !;
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    // The location so that it can be found in an image that is linked all the same.
    let (file, line, column) = info.location().map_or(("", 0, 0), |at| (at.file(), at.line(), at.column()));
    a_panic_is_left(file.as_ptr(), file.len(), line, column)
}

/// What the stack holds where nothing was written.
const PAINT: u32 = 0xcccc_cccc;
/// Bytes below the stack pointer that [`paint`] may keep registers in; less than any row takes.
const MARGIN: usize = 64;

/// Where the start-up code goes in an image of rows: a line a row, then one with flash and static RAM in bytes.
#[unsafe(no_mangle)]
extern "C" fn rows_main() -> ! {
    board::start_clock();
    for entry in rows() {
        let base = paint();
        let mut run = Run::new(board::clock);
        for _ in 0..entry.times {
            (entry.run)(&mut run);
        }
        let used = stack_used(base);
        let (ticks, calls) = run.time();
        write_numbers([run.digest(), u64::from(run.results()), ticks, u64::from(calls), used as u64]);
    }
    let (end, start, ram) = (&raw const __flash_end, &raw const __flash_start, &raw const __static_ram);
    write_numbers([(end.addr() - start.addr()) as u64, ram.addr() as u64]);
    semihosting::exit(true)
}

/// Where the start-up code goes in an image of the demonstration.
#[unsafe(no_mangle)]
extern "C" fn demo_main() -> ! {
    let is_done = embedded_demo::report(&mut |text| {
        let mut line = Line::new();
        for byte in text.bytes() {
            line.push(byte);
        }
        line.write();
    });
    semihosting::exit(is_done)
}

/// The rows in the image.
fn rows() -> impl Iterator<Item = &'static Linked> {
    let mut next = (&raw const __entries_start).cast::<Linked>();
    let end = &raw const __entries_end;
    core::iter::from_fn(move || {
        if next.addr() >= end.addr() {
            return None;
        }
        // SAFETY: the linker script puts whole, aligned rows, and nothing else, between the two symbols; they are never
        // written.
        let row = unsafe { &*next };
        next = next.wrapping_add(1);
        Some(row)
    })
}

/// Paints the stack below this function's frame; the address from which use is counted.
#[inline(never)]
fn paint() -> usize {
    let base = board::stack_pointer();
    let mut word = (&raw const __stack_limit).cast_mut().cast::<u32>();
    while word.addr() < base - MARGIN {
        // SAFETY: RAM between static data and the stack belongs to nobody, and nothing is called meanwhile.
        unsafe { word.write_volatile(PAINT) };
        word = word.wrapping_add(1);
    }
    base
}

/// Bytes of stack below `base` that were written to since [`paint`].
#[inline(never)]
fn stack_used(base: usize) -> usize {
    let mut word = (&raw const __stack_limit).cast::<u32>();
    // SAFETY: as in `paint`; reading does no harm.
    while word.addr() < base && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    base - word.addr()
}

/// Writes a line of numbers in hexadecimal.
fn write_numbers<const N: usize>(numbers: [u64; N]) {
    let mut line = Line::new();
    for number in numbers {
        line.hex(number);
    }
    line.write();
}

/// A line of text that ends with a zero.
struct Line {
    text: [u8; 96],
    length: usize,
}

impl Line {
    const fn new() -> Self {
        Self { text: [0; 96], length: 0 }
    }

    fn push(&mut self, byte: u8) {
        // The last byte stays zero.
        if let Some((place, _)) = self.text.get_mut(self.length..).and_then(<[u8]>::split_first_mut) {
            *place = byte;
            self.length = (self.length + 1).min(95);
        }
    }

    fn hex(&mut self, number: u64) {
        for place in (0..16).rev() {
            let [digit, ..] = (number >> (4 * place) & 15).to_le_bytes();
            self.push(if digit < 10 { b'0' + digit } else { b'a' - 10 + digit });
        }
        self.push(b' ');
    }

    fn write(mut self) {
        self.push(b'\n');
        semihosting::write(&self.text);
    }
}
