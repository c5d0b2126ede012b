//! Reconstruction filters, sampled by importance: a camera sample is moved by an offset distributed as the filter, and
//! all samples of a pixel then have equal weights (M. Ernst, M. Stamminger & G. Greiner, "Filter Importance Sampling",
//! 2006).
//!
//! All filters are separable, even and not negative. Offsets and widths are in pixels.

use super::GeometryError;

/// Cells of the tabulated distribution of a Gaussian.
const CELLS: usize = 512;

/// A separable reconstruction filter. The default is Mitsuba's: [`gaussian`](Self::gaussian) of deviation ½.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter(Shape);

#[derive(Clone, Debug, PartialEq)]
enum Shape {
    /// Constant up to the radius.
    Box {
        radius: f64,
    },
    /// Falls linearly to zero at the radius.
    Tent {
        radius: f64,
    },
    Gaussian(Box<Gaussian>),
}

/// A Gaussian less its value at the radius, and its distribution function at equally spaced points.
#[derive(Clone, Debug, PartialEq)]
struct Gaussian {
    radius: f64,
    exponent: f64,
    bias: f64,
    /// The integral of the filter over its support.
    integral: f64,
    /// Distribution function at −radius + i·2·radius/CELLS.
    cumulative: Vec<f64>,
}

impl Default for Filter {
    fn default() -> Self {
        Self(Shape::Gaussian(Box::new(Gaussian::new(0.5))))
    }
}

impl Filter {
    /// The average over the pixel: radius ½.
    #[must_use]
    pub const fn pixel() -> Self {
        Self(Shape::Box { radius: 0.5 })
    }

    /// A constant up to the radius, in pixels.
    ///
    /// # Errors
    /// [`GeometryError::BadFilterWidth`] unless the radius is positive and finite.
    pub fn constant(radius: f64) -> Result<Self, GeometryError> {
        check_width(radius).map(|radius| Self(Shape::Box { radius }))
    }

    /// 1 − |x|/radius; Mitsuba's radius is 1 pixel.
    ///
    /// # Errors
    /// [`GeometryError::BadFilterWidth`] unless the radius is positive and finite.
    pub fn tent(radius: f64) -> Result<Self, GeometryError> {
        check_width(radius).map(|radius| Self(Shape::Tent { radius }))
    }

    /// exp(−x²/2σ²) − exp(−r²/2σ²) for |x| ≤ r = 4σ, with the standard deviation σ in pixels: Mitsuba's `gaussian`, whose
    /// default is σ = ½ (Mitsuba evaluates it by an approximation that is within 4·10⁻⁴ of the formula).
    ///
    /// # Errors
    /// [`GeometryError::BadFilterWidth`] unless the deviation is positive and finite.
    pub fn gaussian(deviation: f64) -> Result<Self, GeometryError> {
        check_width(deviation)
            .map(|deviation| Self(Shape::Gaussian(Box::new(Gaussian::new(deviation)))))
    }

    /// Beyond this distance, in pixels, the filter is zero.
    #[must_use]
    pub fn radius(&self) -> f64 {
        match &self.0 {
            Shape::Box { radius } | Shape::Tent { radius } => *radius,
            Shape::Gaussian(gaussian) => gaussian.radius,
        }
    }

    /// The filter at a distance in pixels along one axis, as defined: not normalised.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        let distance = x.abs();
        match &self.0 {
            Shape::Box { radius } => f64::from(u8::from(distance <= *radius)),
            Shape::Tent { radius } => (1.0 - distance / radius).max(0.0),
            Shape::Gaussian(gaussian) => gaussian.value(distance),
        }
    }

    /// An offset in pixels, distributed as the filter, from two numbers in [0, 1): its density is [`pdf`](Self::pdf).
    #[must_use]
    #[allow(clippy::cast_possible_truncation, reason = "film positions are f32")]
    pub fn square_to_offset(&self, u: [f32; 2]) -> [f32; 2] {
        u.map(|u| self.quantile(f64::from(u)) as f32)
    }

    /// The density, per square pixel, of [`square_to_offset`](Self::square_to_offset).
    #[must_use]
    pub fn pdf(&self, offset: [f32; 2]) -> f64 {
        offset.map(|x| self.density(f64::from(x))).iter().product()
    }

    /// The numbers from which [`square_to_offset`](Self::square_to_offset) makes an offset: its inverse.
    #[must_use]
    pub fn offset_to_square(&self, offset: [f32; 2]) -> [f64; 2] {
        offset.map(|x| self.cumulative(f64::from(x)))
    }

    /// The density along one axis, per pixel.
    #[must_use]
    pub fn density(&self, x: f64) -> f64 {
        let integral = match &self.0 {
            Shape::Box { radius } => 2.0 * radius,
            Shape::Tent { radius } => *radius,
            Shape::Gaussian(gaussian) => gaussian.integral,
        };
        self.value(x) / integral
    }

    /// The part of the filter below `x`, in [0, 1]; within 10⁻⁸ for a Gaussian, to rounding for the others.
    #[must_use]
    pub fn cumulative(&self, x: f64) -> f64 {
        let r = self.radius();
        let x = x.clamp(-r, r);
        match &self.0 {
            Shape::Box { .. } => (x + r) / (2.0 * r),
            Shape::Tent { .. } => {
                let tail = (1.0 - x.abs() / r).powi(2) / 2.0;
                if x < 0.0 { tail } else { 1.0 - tail }
            }
            Shape::Gaussian(gaussian) => gaussian.cumulative(x),
        }
    }

    /// The offset along one axis below which the part `u` of the filter lies, for u in [0, 1]: the inverse of
    /// [`cumulative`](Self::cumulative), to rounding.
    #[must_use]
    pub fn quantile(&self, u: f64) -> f64 {
        let r = self.radius();
        let u = u.clamp(0.0, 1.0);
        match &self.0 {
            Shape::Box { .. } => (2.0 * u - 1.0) * r,
            Shape::Tent { .. } if u < 0.5 => ((2.0 * u).sqrt() - 1.0) * r,
            Shape::Tent { .. } => (1.0 - (2.0 - 2.0 * u).sqrt()) * r,
            Shape::Gaussian(gaussian) => gaussian.quantile(u),
        }
    }
}

impl Gaussian {
    fn new(deviation: f64) -> Self {
        let radius = 4.0 * deviation;
        let exponent = -0.5 / (deviation * deviation);
        let bias = (exponent * radius * radius).exp();
        let mut gaussian = Self { radius, exponent, bias, integral: 1.0, cumulative: vec![0.0] };
        let mut sum = 0.0;
        for cell in 0..CELLS {
            // Simpson's rule: the error of the sum is below 1e-12.
            let [a, b] = [cell, cell + 1].map(|i| gaussian.node(i));
            let values = [a, (a + b) / 2.0, b].map(|x| gaussian.value(x.abs()));
            sum += (values[0] + 4.0 * values[1] + values[2]) / 6.0 * (b - a);
            gaussian.cumulative.push(sum);
        }
        for value in &mut gaussian.cumulative {
            *value /= sum;
        }
        gaussian.integral = sum;
        gaussian
    }

    #[allow(clippy::cast_precision_loss, reason = "there are few cells")]
    fn node(&self, i: usize) -> f64 {
        self.radius * (2.0 * i as f64 / CELLS as f64 - 1.0)
    }

    fn value(&self, distance: f64) -> f64 {
        ((self.exponent * distance * distance).exp() - self.bias).max(0.0)
    }

    /// The density at both ends of a cell such that, linear in between, it has the tabulated integral.
    fn ends(&self, cell: usize) -> [f64; 2] {
        let ends = [cell, cell + 1].map(|i| self.value(self.node(i).abs()));
        let mean = (ends[0] + ends[1]) / 2.0;
        let width = 2.0 * self.radius / f64::from(u32::try_from(CELLS).unwrap_or(1));
        let scale = (self.cumulative[cell + 1] - self.cumulative[cell]) / (mean * width);
        ends.map(|x| x * scale)
    }

    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a cell"
    )]
    fn cumulative(&self, x: f64) -> f64 {
        let cell = (((x / self.radius + 1.0) / 2.0 * CELLS as f64) as usize).min(CELLS - 1);
        let [low, high] = self.ends(cell);
        let (start, end) = (self.node(cell), self.node(cell + 1));
        let t = (x - start) / (end - start);
        (self.cumulative[cell] + (end - start) * t * (low + (high - low) * t / 2.0)).clamp(0.0, 1.0)
    }

    fn quantile(&self, u: f64) -> f64 {
        let cell = self.cumulative.partition_point(|c| *c <= u).clamp(1, CELLS) - 1;
        let [low, high] = self.ends(cell);
        let (start, end) = (self.node(cell), self.node(cell + 1));
        let rest = (u - self.cumulative[cell]) / (end - start);
        // The root of low·t + (high − low)·t²/2 = rest, in the form that doesn't cancel.
        let root = (low * low + 2.0 * (high - low) * rest).max(0.0).sqrt();
        let t = if rest > 0.0 { 2.0 * rest / (low + root) } else { 0.0 };
        start + (end - start) * t.clamp(0.0, 1.0)
    }
}

fn check_width(width: f64) -> Result<f64, GeometryError> {
    if width > 0.0 && width.is_finite() { Ok(width) } else { Err(GeometryError::BadFilterWidth) }
}
