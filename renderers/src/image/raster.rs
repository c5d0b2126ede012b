//! Rasters of pixels: [`Picture`] and [`ScalarMap`].

use super::ImageError;

/// The largest number of pixels of a raster: 2²⁷, which is 16384 × 8192.
///
/// The limit keeps a damaged header from asking for more memory than there is.
pub const MAX_PIXELS: usize = 1 << 27;

/// A rectangle of pixels, row by row from the top left.
///
/// Neither side is ever 0, and there are exactly width times height pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster<T> {
    width: usize,
    height: usize,
    pixels: Vec<T>,
}

/// Linear-light colours: RGB with the primaries and the white (D65) of Rec. 709, relative to Y = 1 for diffuse white.
///
/// Values above 1 and, for colours outside the gamut, below 0 are kept.
pub type Picture = Raster<[f32; 3]>;

/// One number a pixel, in whatever unit.
pub type ScalarMap = Raster<f32>;

impl<T> Raster<T> {
    /// A raster of given pixels, row by row from the top left.
    ///
    /// # Errors
    /// [`ImageError::Size`] if a side is 0, if there are more than [`MAX_PIXELS`], or if `pixels` does not hold
    /// `width * height` of them.
    pub fn from_pixels(width: usize, height: usize, pixels: Vec<T>) -> Result<Self, ImageError> {
        if pixels.len() != area(width, height)? {
            return Err(ImageError::Size { width, height });
        }
        Ok(Self { width, height, pixels })
    }

    /// A raster of the values of a function of column and row, called row by row.
    ///
    /// # Errors
    /// [`ImageError::Size`] if a side is 0 or there are more than [`MAX_PIXELS`].
    pub fn from_fn(width: usize, height: usize, value: impl Fn(usize, usize) -> T) -> Result<Self, ImageError> {
        let count = area(width, height)?;
        Ok(Self { width, height, pixels: (0..count).map(|k| value(k % width, k / width)).collect() })
    }

    /// A raster of the same size with each pixel mapped.
    pub fn map<U>(&self, function: impl FnMut(&T) -> U) -> Raster<U> {
        Raster { width: self.width, height: self.height, pixels: self.pixels.iter().map(function).collect() }
    }

    /// Pixels in a row, at least 1.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows, at least 1.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Whether another raster has the same width and height.
    #[must_use]
    pub fn same_size<U>(&self, other: &Raster<U>) -> bool {
        (self.width, self.height) == (other.width, other.height)
    }

    /// The pixels, row by row from the top left.
    #[must_use]
    pub fn pixels(&self) -> &[T] {
        &self.pixels
    }

    /// The pixels, row by row from the top left, without the rest.
    #[must_use]
    pub fn into_pixels(self) -> Vec<T> {
        self.pixels
    }

    /// The pixels, row by row from the top left.
    pub fn pixels_mut(&mut self) -> &mut [T] {
        &mut self.pixels
    }

    /// The pixel at column `x` from the left and row `y` from the top, or `None` outside.
    #[must_use]
    pub fn get(&self, x: usize, y: usize) -> Option<&T> {
        if x < self.width { self.pixels.get(y.checked_mul(self.width)?.checked_add(x)?) } else { None }
    }

    /// Column and row of a pixel given by its index in [`Raster::pixels`].
    #[must_use]
    pub fn position(&self, index: usize) -> (usize, usize) {
        (index % self.width, index / self.width)
    }
}

impl<T: Clone> Raster<T> {
    /// A raster filled with one value.
    ///
    /// # Errors
    /// [`ImageError::Size`] if a side is 0 or there are more than [`MAX_PIXELS`].
    pub fn filled(width: usize, height: usize, value: T) -> Result<Self, ImageError> {
        Ok(Self { width, height, pixels: vec![value; area(width, height)?] })
    }
}

/// The number of pixels, if a raster may have that many.
pub(super) fn area(width: usize, height: usize) -> Result<usize, ImageError> {
    match width.checked_mul(height) {
        Some(area @ 1..=MAX_PIXELS) => Ok(area),
        _ => Err(ImageError::Size { width, height }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_stored_row_by_row() {
        let map = Raster::from_fn(3, 2, |x, y| 10 * y + x).unwrap();
        assert_eq!(map.pixels(), [0, 1, 2, 10, 11, 12]);
        assert_eq!(map.get(2, 1), Some(&12));
        assert_eq!(map.get(3, 0), None, "not the first of the next row");
        assert_eq!(map.get(0, 2), None);
        assert_eq!(map.get(0, usize::MAX), None);
        assert_eq!(map.position(4), (1, 1));
    }

    #[test]
    fn impossible_sizes_are_refused() {
        for (width, height) in [(0, 5), (5, 0), (0, 0), (MAX_PIXELS, 2), (usize::MAX, usize::MAX)] {
            assert!(matches!(ScalarMap::filled(width, height, 0.0), Err(ImageError::Size { .. })));
            assert!(matches!(Raster::from_fn(width, height, |_, _| ()), Err(ImageError::Size { .. })));
        }
        assert!(ScalarMap::from_pixels(2, 2, vec![0.0; 3]).is_err());
        assert!(ScalarMap::from_pixels(2, 2, vec![0.0; 4]).is_ok());
    }
}
