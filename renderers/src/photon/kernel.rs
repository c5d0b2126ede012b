//! Kernels of density estimation on the unit disk.

use core::f64::consts::{FRAC_1_PI, TAU};

/// How photons count by their distance from a point (Silverman 1986, section 4.2): rotationally symmetric, not negative, with the integral 1
/// over the unit disk and nothing outside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kernel {
    /// 1/π: all alike.
    Constant,
    /// 3/π · (1 − t): Jensen's cone filter (Jensen 1996) with k = 1.
    Cone,
    /// 2/π · (1 − t²): Epanechnikov's, the best for a smooth density.
    #[default]
    Epanechnikov,
    /// 3/π · (1 − t²)²: Silverman's quartic kernel, whose slope is continuous at the edge.
    Biweight,
    /// 4/π · (1 − t²)³: with a continuous second derivative.
    Triweight,
}

impl Kernel {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Constant, Self::Cone, Self::Epanechnikov, Self::Biweight, Self::Triweight];

    /// Its value at the square of a distance from the middle, per area of the unit disk over π; 0 beyond 1 and for NaN, the value in the
    /// middle below 0.
    #[inline]
    pub fn value(self, t2: f32) -> f32 {
        if !(t2 <= 1.0) {
            return 0.0;
        }
        self.within(t2.max(0.0))
    }

    /// The same from 0 to 1.
    #[inline]
    pub(crate) fn within(self, t2: f32) -> f32 {
        let rest = 1.0 - t2;
        #[allow(clippy::cast_possible_truncation, reason = "a constant")]
        let by_pi = FRAC_1_PI as f32;
        by_pi
            * match self {
                Self::Constant => 1.0,
                Self::Cone => 3.0 * (1.0 - t2.sqrt()),
                Self::Epanechnikov => 2.0 * rest,
                Self::Biweight => 3.0 * rest * rest,
                Self::Triweight => 4.0 * rest * rest * rest,
            }
    }

    /// ∫ t² K over the disk. A quarter of it, times the Laplacian of the density and the square of the radius, is the bias of an estimate.
    pub const fn second_moment(self) -> f64 {
        match self {
            Self::Constant => 1.0 / 2.0,
            Self::Cone => 3.0 / 10.0,
            Self::Epanechnikov => 1.0 / 3.0,
            Self::Biweight => 1.0 / 4.0,
            Self::Triweight => 1.0 / 5.0,
        }
    }

    /// π ∫ K² over the disk: the relative variance of an estimate from n photons in the disk is this over n.
    pub const fn roughness(self) -> f64 {
        match self {
            Self::Constant => 1.0,
            Self::Cone => 3.0 / 2.0,
            Self::Epanechnikov => 4.0 / 3.0,
            Self::Biweight => 9.0 / 5.0,
            Self::Triweight => 16.0 / 7.0,
        }
    }

    /// ∫₀ᵗ K(s) s ds / t² for t ≤ 1: the mass within a region around the middle is ∮ of this times x dy − y dx along the region's edge.
    pub fn mean_within(self, t2: f64) -> f64 {
        (match self {
            Self::Constant => 1.0,
            Self::Cone => 3.0 - 2.0 * t2.sqrt(),
            Self::Epanechnikov => 2.0 - t2,
            Self::Biweight => 3.0 - t2 * (3.0 - t2),
            Self::Triweight => 4.0 - t2 * (6.0 - t2 * (4.0 - t2)),
        }) / TAU
    }

    /// The indefinite integral of [`mean_within`](Self::mean_within) over s along a straight line, t² = h² + s², in closed form.
    pub fn mean_along(self, h: f64, s: f64) -> f64 {
        let (h2, s2) = (h * h, s * s);
        let squares = s * (h2 + s2 / 3.0);
        let fourth = s * (h2 * h2 + s2 * (h2 * 2.0 / 3.0 + s2 / 5.0));
        (match self {
            Self::Constant => s,
            Self::Cone => {
                let distance = (h2 + s2).sqrt();
                let rest = if h2 > 0.0 { h2 * (s / h.abs()).asinh() } else { 0.0 };
                3.0 * s - (s * distance + rest)
            }
            Self::Epanechnikov => 2.0 * s - squares,
            Self::Biweight => 3.0 * (s - squares) + fourth,
            Self::Triweight => {
                let sixth = s * (h2 * h2 * h2 + s2 * (h2 * h2 + s2 * (h2 * 3.0 / 5.0 + s2 / 7.0)));
                4.0 * (s + fourth) - 6.0 * squares - sixth
            }
        }) / TAU
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::Kernel;

    /// ∫ f(t, K(t)) over the unit disk by the midpoint rule, whose error is below 1e-8 for these kernels.
    fn over_the_disk(kernel: Kernel, upto: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
        let steps = 4000;
        let step = upto / f64::from(steps);
        let ring = |i: i32| {
            let t = (f64::from(i) + 0.5) * step;
            #[allow(clippy::cast_possible_truncation, reason = "as it is used")]
            let value = f64::from(kernel.value((t * t) as f32));
            f(t, value) * 2.0 * PI * t * step
        };
        (0..steps).map(ring).sum()
    }

    #[test]
    fn moments_are_those_of_quadrature() {
        for kernel in Kernel::ALL {
            // Values are rounded to f32: some 1e-7 at most, less on average.
            let close = |a: f64, b: f64| assert!((a - b).abs() <= 2e-7, "{kernel:?}: {a} {b}");
            close(over_the_disk(kernel, 1.0, |_, k| k), 1.0);
            close(over_the_disk(kernel, 1.0, |t, k| t * t * k), kernel.second_moment());
            close(PI * over_the_disk(kernel, 1.0, |_, k| k * k), kernel.roughness());
            for t in [0.1, 0.5, 0.9, 1.0] {
                close(over_the_disk(kernel, t, |_, k| k), kernel.mean_within(t * t) * 2.0 * PI * t * t);
            }
        }
    }

    #[test]
    fn integrals_along_lines_are_those_of_quadrature() {
        let steps = 2000;
        for kernel in Kernel::ALL {
            for (h, from, to) in [(0.0, -0.5, 1.0), (0.3, -0.9, 0.9), (-0.7, 0.1, 0.6), (1e-3, -1e-2, 0.5)] {
                let step = (to - from) / f64::from(steps);
                let s = |i: i32| from + (f64::from(i) + 0.5) * step;
                let sum: f64 = (0..steps).map(|i| kernel.mean_within(h * h + s(i) * s(i)) * step).sum();
                let closed = kernel.mean_along(h, to) - kernel.mean_along(h, from);
                // The midpoint rule's error is step² / 24 times the change of the slope, which is at most 4 here.
                assert!((sum - closed).abs() <= step * step / 6.0, "{kernel:?}: {sum} {closed}");
            }
        }
    }

    #[test]
    fn nothing_counts_beyond_the_disk() {
        for kernel in Kernel::ALL {
            assert_eq!(kernel.value(1.0_f32.next_up()), 0.0);
            assert_eq!(kernel.value(f32::INFINITY), 0.0);
            assert_eq!(kernel.value(f32::NAN), 0.0);
            assert_eq!(kernel.value(-1.0), kernel.value(0.0));
            assert!(kernel.value(0.5) > 0.0);
        }
    }
}
