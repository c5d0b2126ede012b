//! The form of a row, and how an image gets hold of it.

use crate::Run;

/// One row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The name, also of the symbols by which images ask for it.
    pub name: &'static str,
    /// The public functions that the row calls, such as `interval::Interval::product`; methods of traits as
    /// `Trait::method for Type`.
    pub covers: &'static [&'static str],
    /// How often it runs, to fill the digest.
    pub times: u32,
    /// In `f32`.
    pub single: fn(&mut Run),
    /// In `f64`.
    pub double: fn(&mut Run),
}

/// A row in one precision, as it stands in an image.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Linked {
    /// What to run.
    pub run: fn(&mut Run),
    /// How often.
    pub times: u32,
}

/// Rows: a name, how often it runs, what it covers, and a body that is generic over the precision.
///
/// For bare metal each row and precision also becomes a symbol in a section of its own: an image is linked from the rows
/// that the linker is told to want.
macro_rules! entries {
    ($($(#[$doc:meta])* $name:ident $times:literal [$($covers:literal),* $(,)?] |$run:ident, $real:ident| $body:block)*) => {
        $($(#[$doc])* fn $name<$real: spectral_core::Real>($run: &mut $crate::Run) $body)*

        pub(crate) const ENTRIES: &[$crate::Entry] = &[$($crate::Entry {
            name: stringify!($name),
            covers: &[$($covers),*],
            times: $times,
            single: $name::<f32>,
            double: $name::<f64>,
        }),*];

        $(#[cfg(target_os = "none")]
        #[allow(unsafe_code, reason = "the linker selects rows by these names")]
        mod $name {
            use $crate::Linked;
            #[unsafe(export_name = concat!("single_", stringify!($name)))]
            #[unsafe(link_section = concat!(".entries.", stringify!($name), ".single"))]
            static SINGLE: Linked = Linked { run: super::$name::<f32>, times: $times };
            #[unsafe(export_name = concat!("double_", stringify!($name)))]
            #[unsafe(link_section = concat!(".entries.", stringify!($name), ".double"))]
            static DOUBLE: Linked = Linked { run: super::$name::<f64>, times: $times };
        })*
    };
}
