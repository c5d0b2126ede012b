//! Pictures for the eye.

use std::path::Path;

/// A square picture in linear sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    size: usize,
    pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// A picture with half the width and height of what was rendered: each pixel is the mean of four.
    ///
    /// `rendered` has `2 * size` rows of as many pixels; missing ones are black.
    #[must_use]
    pub fn halved(rendered: &[[f32; 4]], size: usize) -> Self {
        let at = |x: usize, y: usize, c: usize| rendered.get(y * 2 * size + x).map_or(0.0, |pixel| pixel[c]);
        let mean = |x: usize, y: usize, c| {
            0.25 * (at(2 * x, 2 * y, c)
                + at(2 * x + 1, 2 * y, c)
                + at(2 * x, 2 * y + 1, c)
                + at(2 * x + 1, 2 * y + 1, c))
        };
        let pixel = |i: usize| core::array::from_fn(|c| mean(i % size, i / size, c));
        Self { size, pixels: (0..size * size).map(pixel).collect() }
    }

    /// Draws a rectangle in the lower right corner that shows a colour, such as that of the light.
    pub fn show_colour(&mut self, colour: [f32; 3]) {
        let (far, edge) = (self.size / 8, self.size / 40);
        for y in self.size - far..self.size - edge {
            for pixel in self.pixels.iter_mut().skip(y * self.size + self.size - far).take(far - edge) {
                *pixel = colour;
            }
        }
    }

    /// Writes an 8-bit sRGB PNG; components outside 0 to 1 are clipped.
    ///
    /// # Errors
    /// Those of the encoder and of the file.
    pub fn write_png(&self, path: &Path) -> Result<(), Box<dyn core::error::Error>> {
        let mut file = Vec::new();
        let side = u32::try_from(self.size)?;
        let mut encoder = png::Encoder::new(&mut file, side, side);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
        let bytes: Vec<u8> = self.pixels.as_flattened().iter().map(|&c| encoded(c)).collect();
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&bytes)?;
        writer.finish()?;
        std::fs::write(path, file)?;
        Ok(())
    }
}

/// IEC 61966-2-1, in 8 bits.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the value is clipped to 0…255 and rounded")]
fn encoded(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded + 0.5) as u8
}
