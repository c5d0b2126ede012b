//! Indirect illuminance by random walks: an oracle for radiosity that has no patches, links or form factors.

use disk_sampling::Receiver;
use rayon::prelude::*;
use renderers::direct;
use renderers::geometry::glam::Vec3A;
use renderers::geometry::sampling::square_to_cosine_hemisphere;
use renderers::geometry::{GeometryError, SurfacePoint, World};
use renderers::radiosity::Representation as _;
use renderers::scene::{BsdfKind, Emitter, Geometry, Scene};
use renderers::spectral::{Factor, Palette, Role, UniformBins};

use crate::generators::Draw;

/// lm/W at the maximum of photopic vision.
const EFFICACY: f64 = spectral_core::action::MAXIMUM_LUMINOUS_EFFICACY;
/// The first directions of a batch of walks are spread over so many cells in each of two dimensions.
const CELLS: u32 = 64;
/// Walks are ended at random from this reflection on.
const ROULETTE: u32 = 4;

/// A lamp's triangle.
#[derive(Clone, Debug)]
struct Lamp {
    corner: Vec3A,
    edges: [Vec3A; 2],
    normal: Vec3A,
    /// Areas of this and of those before it.
    sum: f64,
    shape: usize,
}

/// A scene of flat one-sided or two-sided diffuse surfaces and area lights, ready for walks; spectra are means over bins.
#[derive(Debug)]
pub struct Walker {
    world: World,
    /// For each shape the reflectances of its front and of its back, bin by bin.
    reflectance: Vec<[Vec<f64>; 2]>,
    radiance: Vec<Vec<f64>>,
    lamps: Vec<Lamp>,
    luminous: Vec<f64>,
}

/// A mean with the standard deviation of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// In lx.
    pub mean: f64,
    /// In lx.
    pub deviation: f64,
}

#[allow(clippy::cast_possible_truncation, reason = "rays are traced in f32")]
fn single(v: [f64; 3]) -> Vec3A {
    Vec3A::from_array(v.map(|x| x as f32))
}

impl Walker {
    /// Prepares a scene; `bins` are of the palette after its spectra were added, which they are by [`spectra`].
    ///
    /// # Errors
    /// Surfaces that are not fit for rays.
    pub fn new(scene: &Scene, palette: &mut Palette, bins: &UniformBins) -> Result<Self, GeometryError> {
        let means = |factor: Option<Factor>| -> Vec<f64> {
            let mut row = vec![0.0; bins.len()];
            if let Some(factor) = factor {
                bins.light(factor, &mut row);
            }
            row
        };
        let factors = spectra(scene, palette);
        let mut lamps: Vec<Lamp> = Vec::new();
        for (shape, (_, radiance)) in factors.iter().enumerate() {
            for [a, b, c] in radiance.iter().flat_map(|_| triangles(&scene.shapes[shape].geometry)) {
                let (edges, before) = ([b - a, c - a], lamps.last().map_or(0.0, |l| l.sum));
                let cross = edges[0].cross(edges[1]);
                let sum = before + 0.5 * f64::from(cross.length());
                lamps.push(Lamp { corner: a, edges, normal: cross.normalize(), sum, shape });
            }
        }
        Ok(Self {
            world: direct::world(scene)?,
            reflectance: factors.iter().map(|(sides, _)| sides.map(means)).collect(),
            radiance: factors.iter().map(|(_, radiance)| means(*radiance)).collect(),
            lamps,
            luminous: bins.weights()[1].iter().map(|w| EFFICACY * w).collect(),
        })
    }

    /// Illuminance by light that was reflected once or more, from `batches` × 4096 walks: for each the light of a random point of the
    /// lamps at every reflection.
    #[must_use]
    pub fn indirect(&self, receiver: &Receiver<f64>, batches: u32) -> Measured {
        let (position, normal) = (single(receiver.position()), single(receiver.normal()));
        let batch = |seed: u32| {
            let mut random = Draw::new(u64::from(seed) << 32 | 0x5eed);
            let mut sum = 0.0;
            for cell in 0..CELLS * CELLS {
                let place = [cell % CELLS, cell / CELLS].map(|i| (f64::from(i) + random.unit()) / f64::from(CELLS));
                sum += self.walk(SurfacePoint::new(position, normal), normal, place, &mut random);
            }
            sum / f64::from(CELLS * CELLS)
        };
        let means: Vec<f64> = (0..batches).into_par_iter().map(batch).collect();
        let n = f64::from(batches);
        let mean = means.iter().sum::<f64>() / n;
        let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
        Measured { mean, deviation: (variance / n).sqrt() }
    }

    fn walk(&self, mut point: SurfacePoint, mut normal: Vec3A, mut place: [f64; 2], random: &mut Draw<'_>) -> f64 {
        let mut weights = self.luminous.clone();
        let mut found = 0.0;
        for reflection in 0_u32.. {
            #[allow(clippy::cast_possible_truncation, reason = "rays are traced in f32")]
            let way = square_to_cosine_hemisphere(place.map(|x| x as f32));
            let (u, v) = normal.any_orthonormal_pair();
            let Some(hit) = self.world.closest_hit(&point.ray(u * way.x + v * way.y + normal * way.z)) else { break };
            let reflectance = &self.reflectance[hit.shape as usize][usize::from(!hit.front)];
            weights.iter_mut().zip(reflectance).for_each(|(w, r)| *w *= r);
            if weights.iter().all(|w| *w <= 0.0) {
                break;
            }
            normal = if hit.front { hit.geometric_normal } else { -hit.geometric_normal };
            // The kernel's own offset point of the hit, on the side that was hit.
            point = hit.point();
            found += self.lamp_light(&point, normal, &weights, random);
            if reflection >= ROULETTE {
                let live = reflectance.iter().fold(0.0_f64, |m, r| m.max(*r)).min(0.95);
                if random.unit() >= live {
                    break;
                }
                weights.iter_mut().for_each(|w| *w /= live);
            }
            place = [random.unit(), random.unit()];
        }
        found
    }

    /// The weighted irradiance that a random point of the lamps gives.
    #[allow(clippy::cast_possible_truncation, reason = "rays are traced in f32")]
    fn lamp_light(&self, point: &SurfacePoint, normal: Vec3A, weights: &[f64], random: &mut Draw<'_>) -> f64 {
        let Some(area) = self.lamps.last().map(|l| l.sum) else { return 0.0 };
        let (choice, mut u, mut v) = (random.unit() * area, random.unit() as f32, random.unit() as f32);
        let Some(lamp) = self.lamps.iter().find(|l| choice < l.sum) else { return 0.0 };
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let target = lamp.corner + lamp.edges[0] * u + lamp.edges[1] * v;
        let way = target - point.offset(normal);
        let cosines = f64::from(way.dot(normal).max(0.0) * (-way.dot(lamp.normal)).max(0.0));
        if !(cosines > 0.0) || self.world.occluded(point, &SurfacePoint::new(target, lamp.normal)) {
            return 0.0;
        }
        let squared = f64::from(way.length_squared());
        let light: f64 = weights.iter().zip(&self.radiance[lamp.shape]).map(|(w, l)| w * l).sum();
        light * area * cosines / (squared * squared)
    }
}

/// For each shape the reflectances of both sides, and the radiance if it shines; added to the palette.
pub fn spectra(scene: &Scene, palette: &mut Palette) -> Vec<([Option<Factor>; 2], Option<Factor>)> {
    let of = |shape: &renderers::scene::Shape| {
        let sides = match &scene.bsdf(shape.bsdf).kind {
            BsdfKind::TwoSided { front, back } => [Some(*front), Some(*back)],
            _ => [Some(shape.bsdf), None],
        };
        let mut reflectance = |id| match scene.bsdf(id).kind {
            BsdfKind::Diffuse { reflectance } => Some(palette.factor(scene.spectrum(reflectance), Role::Reflectance)),
            _ => None,
        };
        let sides = sides.map(|id| id.and_then(&mut reflectance));
        let radiance = match shape.emitter.map(|id| scene.emitter(id)) {
            Some(Emitter::Area { radiance, .. }) => Some(palette.factor(scene.spectrum(*radiance), Role::Light)),
            _ => None,
        };
        (sides, radiance)
    };
    scene.shapes.iter().map(of).collect()
}

/// The triangles of a rectangle or mesh, anticlockwise from the front; none for other shapes.
fn triangles(geometry: &Geometry) -> Vec<[Vec3A; 3]> {
    match geometry {
        Geometry::Rectangle { center, half_u, half_v, normal } => {
            let (u, v) =
                if half_u.cross(*half_v).dot(*normal) >= 0.0 { (*half_u, *half_v) } else { (*half_v, *half_u) };
            let [a, b, c, d] = [*center - u - v, *center + u - v, *center + u + v, *center - u + v];
            [[a, b, c], [a, c, d]].map(|t| t.map(|x| single(x.to_array()))).to_vec()
        }
        Geometry::Mesh(mesh) => {
            (0..mesh.triangles.len()).map(|t| mesh.corners(t).map(|x| single(x.to_array()))).collect()
        }
        _ => Vec::new(),
    }
}
