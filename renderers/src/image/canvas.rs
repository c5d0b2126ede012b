//! Drawing for legends and charts: rectangles, lines and text on an opaque ground.

use super::font::{BASELINE, Segment, strokes};
use super::png::write_rgb8;
use super::raster::area;
use super::{ImageError, Raster};
use std::path::Path;
use tiny_skia::{Color, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Rect, Stroke, Transform};

/// An sRGB colour of 8 bits a component.
pub type Rgb8 = [u8; 3];

/// Which point of a text is put where it is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The left end.
    Start,
    /// The middle.
    Middle,
    /// The right end.
    End,
}

/// A drawing in sRGB. Coordinates are in pixels from the top left corner; what lies outside is cut off.
pub struct Canvas {
    pixmap: Pixmap,
}

impl Canvas {
    /// A canvas of one colour.
    ///
    /// # Errors
    /// [`ImageError::Size`] if a side is 0 or there are more than [`MAX_PIXELS`](super::MAX_PIXELS) pixels.
    pub fn new(width: usize, height: usize, ground: Rgb8) -> Result<Self, ImageError> {
        area(width, height)?;
        let refuse = ImageError::Size { width, height };
        let (Ok(columns), Ok(rows)) = (u32::try_from(width), u32::try_from(height)) else {
            return Err(refuse);
        };
        let mut pixmap = Pixmap::new(columns, rows).ok_or(refuse)?;
        pixmap.fill(opaque(ground));
        Ok(Self { pixmap })
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        usize::try_from(self.pixmap.width()).unwrap_or(usize::MAX)
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        usize::try_from(self.pixmap.height()).unwrap_or(usize::MAX)
    }

    /// Fills a rectangle given by its left and top edge, width and height. Nothing is drawn if a number is not finite
    /// or a side not positive.
    pub fn rectangle(&mut self, [x, y, width, height]: [f32; 4], colour: Rgb8) {
        if let Some(rectangle) = Rect::from_xywh(x, y, width, height) {
            self.pixmap.fill_rect(rectangle, &paint(colour), Transform::identity(), None);
        }
    }

    /// Draws straight lines through points, `thickness` pixels wide.
    pub fn lines(&mut self, points: &[[f32; 2]], thickness: f32, colour: Rgb8) {
        let mut path = PathBuilder::new();
        for (index, &[x, y]) in points.iter().enumerate() {
            if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        self.stroke(path, thickness, Transform::identity(), colour);
    }

    /// Draws one line of text whose capitals are `size` pixels high, with its anchor on the baseline at a point.
    ///
    /// Characters that are not built in are drawn as an empty box.
    pub fn text(&mut self, text: &str, at: [f32; 2], size: f32, anchor: Anchor, colour: Rgb8) {
        self.write(text, size, anchor, Transform::from_translate(at[0], at[1]), colour);
    }

    /// [`Canvas::text`] turned by a quarter to the left, so that it reads upwards.
    pub fn text_upwards(&mut self, text: &str, at: [f32; 2], size: f32, anchor: Anchor, colour: Rgb8) {
        self.write(text, size, anchor, Transform::from_row(0.0, -1.0, 1.0, 0.0, at[0], at[1]), colour);
    }

    /// The width of a text in pixels, when its capitals are `size` pixels high.
    #[must_use]
    pub fn text_width(text: &str, size: f32) -> f32 {
        strokes(text).1 * size / BASELINE
    }

    fn write(&mut self, text: &str, size: f32, anchor: Anchor, place: Transform, colour: Rgb8) {
        let (segments, width) = strokes(text);
        let shift = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * width,
            Anchor::End => -width,
        };
        let scale = size / BASELINE;
        let mut path = PathBuilder::new();
        for segment in segments {
            match segment {
                Segment::Move(x, y) => path.move_to(x, y),
                Segment::Line(x, y) => path.line_to(x, y),
                Segment::Curve(x1, y1, x2, y2) => path.quad_to(x1, y1, x2, y2),
            }
        }
        let transform = place.pre_scale(scale, scale).pre_translate(shift, -BASELINE);
        // Stems a seventh of the height read well, but never thinner than a pixel.
        let thickness = (size / 7.0).max(1.1) / scale;
        self.stroke(path, thickness, transform, colour);
    }

    fn stroke(&mut self, path: PathBuilder, thickness: f32, transform: Transform, colour: Rgb8) {
        let Some(path) = path.finish() else { return };
        let stroke =
            Stroke { width: thickness, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        self.pixmap.stroke_path(&path, &paint(colour), &stroke, transform, None);
    }

    /// Puts a raster of colours with its top left corner at column `left` and row `top`, each pixel as a square of
    /// `magnification` pixels a side.
    pub fn picture(&mut self, colours: &Raster<Rgb8>, left: usize, top: usize, magnification: usize) {
        let (width, height) = (self.width(), self.height());
        let right = width.min(left.saturating_add(colours.width().saturating_mul(magnification)));
        let bottom = height.min(top.saturating_add(colours.height().saturating_mul(magnification)));
        let data = self.pixmap.data_mut();
        for y in top..bottom {
            for x in left..right {
                let colour = colours.get((x - left) / magnification, (y - top) / magnification);
                let start = 4 * (y * width + x);
                if let (Some(colour), Some(pixel)) = (colour, data.get_mut(start..start + 3)) {
                    pixel.copy_from_slice(colour);
                }
            }
        }
    }

    /// Writes the drawing as PNG.
    ///
    /// # Errors
    /// [`ImageError::Io`].
    pub fn write_png(&self, path: &Path) -> Result<(), ImageError> {
        // Everything is opaque, so that premultiplied is plain.
        let bytes: Vec<u8> =
            self.pixmap.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        write_rgb8(path, self.width(), self.height(), &bytes)
    }
}

fn opaque([red, green, blue]: Rgb8) -> Color {
    Color::from_rgba8(red, green, blue, u8::MAX)
}

fn paint(colour: Rgb8) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(opaque(colour));
    paint
}

/// A coordinate or a small count as a length in pixels; exact for any size that a drawing can have.
#[allow(clippy::cast_precision_loss, reason = "pixels of a drawing are far below 2^24")]
pub(crate) fn position(count: usize) -> f32 {
    count as f32
}

/// A length in whole pixels, rounded up.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "lengths are small and positive")]
pub(crate) fn whole(length: f32) -> usize {
    length.ceil() as usize
}
