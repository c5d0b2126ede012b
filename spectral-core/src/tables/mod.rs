//! Built-in tables, generated from the CSV files of `spectral-core/data`.

/// The samples of one column of a built-in table, in both precisions; only the one that is used gets linked.
///
/// [`Real::samples`](crate::Real::samples) picks the precision.
#[derive(Clone, Copy, Debug)]
pub struct Samples {
    /// The samples in `f32`.
    pub single: &'static [f32],
    /// The samples in `f64`.
    pub double: &'static [f64],
}
