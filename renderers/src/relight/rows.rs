//! Some rows of a picture on their way from one file to another.

/// Samples of a channel that isn't a colour, as bytes of this machine's order.
#[derive(Clone, Debug, Default)]
pub(super) struct Plane {
    /// Bytes of a sample.
    pub(super) width: usize,
    pub(super) bytes: Vec<u8>,
}

/// Rows of pixels, or columns where a picture is stored by columns.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    /// Pixels in a row.
    pub(super) length: usize,
    /// Linear RGB, row by row.
    pub(super) colours: Vec<[f32; 3]>,
    /// The other channels, row by row.
    pub(super) others: Vec<Plane>,
}

impl Rows {
    pub(super) fn count(&self) -> usize {
        self.colours.len().checked_div(self.length).unwrap_or(0)
    }

    /// Takes the first rows away; all, if there are no more than `count`.
    pub(super) fn take(&mut self, count: usize) -> Self {
        let pixels = (count * self.length).min(self.colours.len());
        let rest = self.colours.split_off(pixels);
        let colours = core::mem::replace(&mut self.colours, rest);
        let split = |plane: &mut Plane| {
            let rest = plane.bytes.split_off(pixels * plane.width);
            Plane { width: plane.width, bytes: core::mem::replace(&mut plane.bytes, rest) }
        };
        Self { length: self.length, colours, others: self.others.iter_mut().map(split).collect() }
    }

    /// Appends black rows, 0 in all channels, and returns the index of their first pixel.
    pub(super) fn grow(&mut self, count: usize) -> usize {
        let (before, pixels) = (self.colours.len(), self.colours.len() + count * self.length);
        self.colours.resize(pixels, [0.0; 3]);
        for plane in &mut self.others {
            plane.bytes.resize(pixels * plane.width, 0);
        }
        before
    }
}
