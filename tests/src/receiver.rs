//! A receiver that the camera sees straight: pictures as maps of irradiance.
//!
//! The camera is a pinhole before the middle of a diffuse square and sees exactly all of it, so that every pixel stands for the same area of it.
//! Radiance L of a surface of reflectance ρ is an irradiance of π L / ρ. Cameras are in nobody's way: close before the receiver, nothing
//! hides it from them.

use core::f64::consts::PI;
use core::ops::Range;

use renderers::geometry::glam::DVec3;
use renderers::render::{Options, PhotonReport, Renderer, Rendering, render};
use renderers::scene::{Scene, SceneError, Source, load};
use renderers::whitted::RenderError;
use spectral_core::colour::rgb::linear_rgb_to_xyz;

/// The receiver's reflectance.
pub const REFLECTANCE: f64 = 0.5;

/// A diffuse square, black on its back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// Its middle.
    pub centre: DVec3,
    /// The unit normal on the side that receives.
    pub normal: DVec3,
    /// The unit direction along which rows of pixels follow each other; across the normal.
    pub down: DVec3,
    /// Half of its side.
    pub half: f64,
    /// How far before it the camera is.
    pub eye: f64,
}

impl Receiver {
    /// A floor at a height y that sees up; columns of pixels go along x, rows along z.
    #[must_use]
    pub const fn floor(y: f64, half: f64, eye: f64) -> Self {
        Self { centre: DVec3::new(0.0, y, 0.0), normal: DVec3::Y, down: DVec3::Z, half, eye }
    }

    /// A scene of some elements with the receiver as the last shape, seen by its camera.
    ///
    /// # Errors
    /// What [`load`] finds.
    pub fn scene(&self, elements: &str, assets: &[(&str, &str)]) -> Result<Scene, SceneError> {
        let Self { centre, normal, down, half, eye } = *self;
        let text = |v: DVec3| format!("{}, {}, {}", v.x, v.y, v.z);
        let lookat = |origin: DVec3, target: DVec3| {
            format!("<lookat origin='{}' target='{}' up='{}'/>", text(origin), text(target), text(-down))
        };
        let xml = format!(
            "<scene version='3.0.0'><integrator type='path'/>
            <sensor type='perspective'><float name='fov' value='{}'/><transform name='to_world'>{}</transform>
            <film type='hdrfilm'><integer name='width' value='64'/><integer name='height' value='64'/><rfilter type='box'/></film></sensor>
            {elements}<shape type='rectangle'><transform name='to_world'><scale value='{half}'/>{}</transform>
            <bsdf type='diffuse'><spectrum name='reflectance' value='{REFLECTANCE}'/></bsdf></shape></scene>",
            2.0 * (half / eye).atan().to_degrees(),
            lookat(centre + normal * eye, centre),
            lookat(centre, centre + normal),
        );
        let source = Source::text("receiver.xml", xml);
        let source = assets.iter().fold(source, |source, (name, text)| source.with_asset(*name, *text));
        load(&source, &[])
    }

    /// The irradiance by way of mirrors and glass: what the photon map finds besides direct light.
    ///
    /// # Errors
    /// What the renderer refuses.
    pub fn caustics(&self, scene: &Scene, options: &Options) -> Result<(Irradiance, PhotonReport), RenderError> {
        let picture = |renderer| render(scene, &Options { renderer, ..*options }, &|_| {});
        let [whole, direct] = [picture(Renderer::PhotonMap)?, picture(Renderer::Whitted)?];
        let report = whole.photons.clone().ok_or_else(|| RenderError::new("there were no photons"))?;
        Ok((self.irradiance(&whole).minus(&self.irradiance(&direct)), report))
    }

    /// The irradiance that a picture shows: of all of the receiver, or of a strip along its middle if it is less high than wide.
    #[must_use]
    pub fn irradiance(&self, rendering: &Rendering) -> Irradiance {
        let pixels = rendering.picture.pixels();
        let xyz = |rgb: &[f32; 3]| linear_rgb_to_xyz(rgb.map(f64::from)).map(|value| PI * value / REFLECTANCE);
        let size = [rendering.picture.width(), rendering.picture.height()];
        Irradiance { size, pixel: 2.0 * self.half / count(size[0]), xyz: pixels.iter().map(xyz).collect() }
    }
}

/// A map of irradiance on a receiver in XYZ: ∫E x̄ … relative to ∫ȳ, over 380–780 nm.
#[derive(Clone, Debug, PartialEq)]
pub struct Irradiance {
    size: [usize; 2],
    /// The side of a pixel.
    pixel: f64,
    xyz: Vec<[f64; 3]>,
}

impl Irradiance {
    /// What there is besides another map's, as of light that another renderer leaves out.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        let pairs = self.xyz.iter().zip(&other.xyz);
        let xyz = pairs.map(|(a, b)| core::array::from_fn(|c| a[c] - b[c])).collect();
        Self { xyz, ..*self }
    }

    /// All pixels, row by row.
    #[must_use]
    pub fn pixels(&self) -> &[[f64; 3]] {
        &self.xyz
    }

    /// The area of a pixel.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.pixel * self.pixel
    }

    /// Where a number of columns from the first side is, from the middle.
    #[must_use]
    pub fn place(&self, number: f64) -> f64 {
        self.along(0, number)
    }

    /// The same of columns (0) or rows (1).
    fn along(&self, axis: usize, number: f64) -> f64 {
        (number - count(self.size[axis]) / 2.0) * self.pixel
    }

    /// The flux on all of the receiver.
    #[must_use]
    pub fn flux(&self) -> [f64; 3] {
        self.sum(|_, _| 1.0)
    }

    /// The flux in a rectangle, given by what it spans along columns and rows from the middle: pixels count by their part of it.
    #[must_use]
    pub fn flux_in(&self, columns: &Range<f64>, rows: &Range<f64>) -> [f64; 3] {
        let [across, along] = [self.shares(0, columns), self.shares(1, rows)];
        self.sum(|column, row| across[column] * along[row])
    }

    /// The flux within a distance of the middle; pixels count by the part of 16 × 16 points that is within.
    #[must_use]
    pub fn flux_within(&self, radius: f64) -> [f64; 3] {
        const FINE: u32 = 16;
        self.sum(|column, row| {
            let at = |axis: usize, number: usize, part: u32| {
                self.along(axis, count(number) + (f64::from(part) + 0.5) / f64::from(FINE))
            };
            let points = (0..FINE).flat_map(|a| (0..FINE).map(move |b| (a, b)));
            let inside = points.filter(|(a, b)| at(0, column, *a).hypot(at(1, row, *b)) <= radius).count();
            count(inside) / f64::from(FINE * FINE)
        })
    }

    /// The centroid of the light of all of it, by columns and rows from the middle, for one of X, Y and Z.
    #[must_use]
    pub fn centroid(&self, channel: usize) -> [f64; 2] {
        let middle = |axis: usize, number: usize| self.along(axis, count(number) + 0.5);
        let total = self.flux()[channel];
        let moments = [self.sum(|column, _| middle(0, column)), self.sum(|_, row| middle(1, row))];
        moments.map(|moment| moment[channel] / total)
    }

    /// The mean over rows (those in a span) of each column.
    #[must_use]
    pub fn profile(&self, rows: &Range<f64>) -> Vec<[f64; 3]> {
        let shares = self.shares(1, rows);
        let total: f64 = shares.iter().sum();
        let column = |column: usize| {
            let weighed = |c: usize| {
                shares
                    .iter()
                    .enumerate()
                    .map(|(row, share)| share * self.xyz[row * self.size[0] + column][c])
                    .sum::<f64>()
            };
            [0, 1, 2].map(|c| weighed(c) / total)
        };
        (0..self.size[0]).map(column).collect()
    }

    /// The part of each column or row that is in a span.
    fn shares(&self, axis: usize, span: &Range<f64>) -> Vec<f64> {
        let part = |number: usize| {
            let [from, to] = [self.along(axis, count(number)), self.along(axis, count(number + 1))];
            ((to.min(span.end) - from.max(span.start)) / (to - from)).clamp(0.0, 1.0)
        };
        (0..self.size[axis]).map(part).collect()
    }

    fn sum(&self, share: impl Fn(usize, usize) -> f64) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (number, xyz) in self.xyz.iter().enumerate() {
            let share = share(number % self.size[0], number / self.size[0]) * self.area();
            sum = core::array::from_fn(|c| sum[c] + share * xyz[c]);
        }
        sum
    }
}

#[allow(clippy::cast_precision_loss, reason = "counts are small")]
const fn count(n: usize) -> f64 {
    n as f64
}
