//! The iridescent sphere on the processor, in `f32`, by the formulas that `sphere.wgsl` has.

use core::f32::consts::PI;

type Vector = [f32; 3];

/// A sphere of radius 1 under a thin layer, lit by parallel light and seen from +z without perspective.
///
/// The reflection is that of a layered material in three components (Granier and Heidrich 2003), each with its own index
/// of refraction n and wavelength λ:
///
/// - specular: two beams, |a|² + |b|² + 2 a b cos(2π n d (cos θᵢ + cos θₒ) / λ), θ inside the layer of thickness d:
///   a = √F · (r · v)³² from the surface of the layer, b = √((1 − Fᵢ)(1 − Fₒ)) · (−r′ · v′)³² from the base, whose
///   normal is tilted against the surface's, so that each component has its highlight elsewhere. F is Schlick's reflection,
///   r mirrored light, v the view, primed inside the layer;
/// - diffuse: (1 + 2 cos(4π n d / λ) √(T(1 − T))) / 2 with T = 80/21 · n / (n + 1)², the mean transmission.
///
/// Thickness and tilt change smoothly over the sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// Unit vector towards the light, in front of the sphere.
    pub light_direction: Vector,
    /// The colour of the light, linear sRGB.
    pub light: Vector,
    /// Width and height of the picture in pixels, at least 1.
    pub size: u16,
    /// The layer's index of refraction for red, green and blue, above 1.
    pub indices: Vector,
    /// The wavelengths that stand for red, green and blue, in nm.
    pub wavelengths: Vector,
    /// Mean thickness of the layer, in nm.
    pub thickness: f32,
    /// By how much the thickness deviates at most, in nm.
    pub thickness_range: f32,
    /// The colour of the base, linear sRGB.
    pub base: Vector,
    /// By how much the normal of the base deviates, as a tangent, at most, in x and y.
    pub tilt: f32,
    /// Weight of the diffuse term.
    pub diffuse: f32,
    /// Weight of the specular term.
    pub specular: f32,
}

/// Half the width of the picture, in radii of the sphere.
const HALF_WIDTH: f32 = 1.05;

impl Scene {
    /// The sphere of the pictures under a light of a colour.
    #[must_use]
    pub fn new(size: u16, light: Vector) -> Self {
        Self {
            light_direction: [0.36, 0.48, 0.8],
            light,
            size,
            indices: [1.3, 1.6, 1.9],
            wavelengths: [645.0, 525.0, 445.0],
            thickness: 330.0,
            thickness_range: 60.0,
            base: [0.6, 0.6, 0.6],
            tilt: 0.28,
            diffuse: 0.4,
            specular: 1.0,
        }
    }

    /// The scene as the uniform buffer of `sphere.wgsl`, in rows of 16 bytes.
    #[must_use]
    pub fn uniforms(&self) -> [[f32; 4]; 6] {
        let (width, half_pixel) = (f32::from(self.size), self.half_pixel());
        let ([lx, ly, lz], [red, green, blue]) = (self.light_direction, self.light);
        let ([nr, ng, nb], [wr, wg, wb], [br, bg, bb]) = (self.indices, self.wavelengths, self.base);
        [
            [lx, ly, lz, half_pixel],
            [red, green, blue, width],
            [nr, ng, nb, self.thickness],
            [wr, wg, wb, self.thickness_range],
            [br, bg, bb, self.tilt],
            [self.diffuse, self.specular, 0.0, 0.0],
        ]
    }

    /// The colour under white light at a pixel, counted from the upper left; black outside the sphere.
    #[must_use]
    pub fn reflected_colour(&self, column: u16, row: u16) -> Vector {
        let width = f32::from(self.size);
        let x = self.half_pixel() * (2.0 * (f32::from(column) + 0.5) - width);
        let y = self.half_pixel() * (width - 2.0 * (f32::from(row) + 0.5));
        let square = x * x + y * y;
        if square >= 1.0 {
            return [0.0; 3];
        }
        let normal = [x, y, (1.0 - square).sqrt()];
        let lit = dot(normal, self.light_direction);
        if lit <= 0.0 {
            return [0.0; 3];
        }
        let tilt = [self.tilt * cosine(0.2 * x + 0.1 * y + 0.05), self.tilt * cosine(0.2 * y - 0.1 * x + 0.45), 0.0];
        let tilted = add(normal, tilt);
        let base_normal = scale(1.0 / dot(tilted, tilted).sqrt(), tilted);
        let thickness = self.thickness + self.thickness_range * cosine(0.3 * x - 0.4 * y + 0.1);
        core::array::from_fn(|c| {
            let (index, waves) = (self.indices[c], thickness / self.wavelengths[c]);
            let specular = self.specular_term(normal, base_normal, index, waves);
            lit * (self.diffuse * self.base[c] * diffuse_term(index, waves) + self.specular * specular)
        })
    }

    fn half_pixel(&self) -> f32 {
        HALF_WIDTH / f32::from(self.size)
    }

    fn specular_term(&self, normal: Vector, base_normal: Vector, index: f32, thickness_in_waves: f32) -> f32 {
        let (to_view, to_light) = ([0.0, 0.0, 1.0], self.light_direction);
        let at_light = Cosines::new(index, dot(normal, to_light));
        let at_view = Cosines::new(index, normal[2]);
        let reflected = fresnel(index, at_light.outside);
        let transmitted = (1.0 - reflected) * (1.0 - fresnel(index, at_view.outside));

        let mirrored = add(scale(2.0 * at_light.outside, normal), scale(-1.0, to_light));
        let surface = reflected.sqrt() * lobe(mirrored, to_view);

        let down = at_light.refracted(to_light, normal, index);
        let seen = at_view.refracted(to_view, normal, index);
        let up = add(down, scale(-2.0 * dot(down, base_normal), base_normal));
        let reached = dot(down, base_normal) < 0.0 && dot(seen, base_normal) < 0.0;
        let base = if reached { transmitted.sqrt() * lobe(up, scale(-1.0, seen)) } else { 0.0 };
        let phase = cosine(index * thickness_in_waves * (at_light.inside + at_view.inside));
        surface * surface + base * base + 2.0 * surface * base * phase
    }
}

/// Cosines against the normal of the layer, of a direction outside and of the refracted one inside.
struct Cosines {
    outside: f32,
    inside: f32,
}

impl Cosines {
    fn new(index: f32, outside: f32) -> Self {
        Self { outside, inside: (1.0 - (1.0 - outside * outside) / (index * index)).sqrt() }
    }

    /// The direction opposite to `towards`, refracted into the layer.
    fn refracted(&self, towards: Vector, normal: Vector, index: f32) -> Vector {
        add(scale(self.outside / index - self.inside, normal), scale(-1.0 / index, towards))
    }
}

/// The part reflected by a layer's surface (Schlick 1994).
fn fresnel(index: f32, cosine_outside: f32) -> f32 {
    let normal = ((index - 1.0) / (index + 1.0)).powi(2);
    normal + (1.0 - normal) * (1.0 - cosine_outside).powi(5)
}

/// The diffuse term: the mean over all directions.
fn diffuse_term(index: f32, thickness_in_waves: f32) -> f32 {
    let passed = 80.0 / 21.0 * index / ((index + 1.0) * (index + 1.0));
    0.5 + cosine(2.0 * index * thickness_in_waves) * (passed * (1.0 - passed)).sqrt()
}

fn cosine(turns: f32) -> f32 {
    (2.0 * PI * (turns - turns.round())).cos()
}

/// The 32nd power of the cosine between unit vectors, 0 where that is negative. The cosine is computed as 1 − |a − b|²/2:
/// near 1, where the power magnifies errors, it has smaller ones than a · b.
fn lobe(a: Vector, b: Vector) -> f32 {
    let difference = add(a, scale(-1.0, b));
    (1.0 - 0.5 * dot(difference, difference)).max(0.0).powi(32)
}

fn dot(a: Vector, b: Vector) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn add(a: Vector, b: Vector) -> Vector {
    core::array::from_fn(|i| a[i] + b[i])
}

fn scale(factor: f32, a: Vector) -> Vector {
    a.map(|c| factor * c)
}

#[cfg(test)]
mod tests {
    use super::*;

    const INDICES: [f32; 4] = [1.2, 1.4, 1.7, 2.2];

    /// From the sphere's centre towards the upper right, at a slope.
    const NORMAL: Vector = [0.36, 0.48, 0.8];

    #[test]
    fn the_mean_transmission_is_the_integral_of_schlicks() {
        for index in INDICES {
            // ∫ (1 − F(c)) 2c dc by midpoints.
            let steps = 20_000_u16;
            let term = |i: u16| {
                let c = (f64::from(i) + 0.5) / f64::from(steps);
                let n = f64::from(index);
                let normal = ((n - 1.0) / (n + 1.0)).powi(2);
                (1.0 - normal) * (1.0 - (1.0 - c).powi(5)) * 2.0 * c / f64::from(steps)
            };
            let passed: f64 = (0..steps).map(term).sum();
            // A whole wave there and back interferes the most; a quarter of one not at all.
            let greatest = f64::from(diffuse_term(index, 0.5 / index));
            assert!((greatest - (0.5 + (passed * (1.0 - passed)).sqrt())).abs() <= 1e-6);
            assert!((diffuse_term(index, 0.125 / index) - 0.5).abs() <= 1e-6);
        }
    }

    #[test]
    fn refraction_obeys_snell_and_keeps_the_length() {
        for index in INDICES {
            for towards in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.8, 0.6]] {
                let cosines = Cosines::new(index, dot(NORMAL, towards));
                let down = cosines.refracted(towards, NORMAL, index);
                assert!((dot(down, down) - 1.0).abs() <= 1e-6);
                assert!((dot(down, NORMAL) + cosines.inside).abs() <= 1e-6);
                // The tangential part shrinks by the index.
                let along = add(towards, scale(-cosines.outside, NORMAL));
                let left = add(add(down, scale(cosines.inside, NORMAL)), scale(1.0 / index, along));
                assert!(dot(left, left).sqrt() <= 1e-6);
            }
        }
    }

    #[test]
    fn without_tilt_a_mirrored_view_sees_both_beams_in_full() {
        // The normal halfway between the light and the view.
        let scene = Scene::new(1, [1.0; 3]);
        let half = add(scene.light_direction, [0.0, 0.0, 1.0]);
        let normal = scale(1.0 / dot(half, half).sqrt(), half);
        for index in INDICES {
            let reflected = fresnel(index, normal[2]);
            let (a, b) = (reflected.sqrt(), 1.0 - reflected);
            let path = 2.0 * index * Cosines::new(index, normal[2]).inside;
            for (phase, amplitude) in [(1.0, a + b), (0.5, a - b)] {
                let term = scene.specular_term(normal, normal, index, phase / path);
                assert!((term - amplitude * amplitude).abs() <= 1e-5, "{term} instead of {}", amplitude * amplitude);
            }
        }
    }
}
