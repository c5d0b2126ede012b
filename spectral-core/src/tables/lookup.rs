//! Built-in tables by name.

use super::{GlassTable, LineTable, MetalTable, UniformTable};
use super::{cornell_lamp, fluorescent, glasses, high_pressure, illuminants, led, lines, metals, narrowband};

/// The families of light sources, in the order in which [`lights`] lists them.
static FAMILIES: [&[UniformTable]; 6] =
    [&illuminants::ALL, &fluorescent::ALL, &high_pressure::ALL, &led::ALL, &narrowband::ALL, &cornell_lamp::ALL];

/// All built-in light sources that are sampled spectra: relative spectral powers on the grid of their source.
///
/// Line spectra are apart, in [`lines::ALL`](super::lines::ALL).
pub fn lights() -> impl Iterator<Item = &'static UniformTable> {
    FAMILIES.into_iter().flatten()
}

/// The light source with the given name, such as `D65`, `FL2`, `FL3.1`, `HP1` or `LED-B1`.
///
/// Case is ignored, and `_`, `-` and space are the same.
#[must_use]
pub fn find_light(name: &str) -> Option<&'static UniformTable> {
    lights().find(|table| same(table.name, name))
}

/// The line spectrum with the given name, `sodium-D` or `mercury`; names compare as in [`find_light`].
#[must_use]
pub fn find_lines(name: &str) -> Option<&'static LineTable> {
    lines::ALL.iter().find(|table| same(table.name, name))
}

/// The metal with the given name, such as `Au`; names compare as in [`find_light`].
#[must_use]
pub fn find_metal(name: &str) -> Option<&'static MetalTable> {
    metals::ALL.iter().find(|table| same(table.name, name))
}

/// The transparent material with the given name, such as `N-BK7`; names compare as in [`find_light`].
#[must_use]
pub fn find_glass(name: &str) -> Option<&'static GlassTable> {
    glasses::ALL.iter().find(|table| same(table.name, name))
}

fn same(a: &str, b: &str) -> bool {
    let fold = |byte: u8| if matches!(byte, b'_' | b' ') { b'-' } else { byte.to_ascii_lowercase() };
    a.len() == b.len() && a.bytes().zip(b.bytes()).all(|(a, b)| fold(a) == fold(b))
}
