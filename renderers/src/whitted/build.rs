//! From a scene's data to what the tracer needs, and what others may ask of that.

use super::{GlossyLight, RenderError, Settings, Surface, Whitted};
use crate::direct::{self, Blockers, Cells, Light, Source};
use crate::frame::Parametrisation;
use crate::geometry::{self, Camera, Hit, World};
use crate::material::Material;
use crate::scene::{Emitter, FovAxis, Geometry, Integrator, Scene, Shape};
use crate::spectral::{Factor, Palette, Role};

impl Whitted {
    /// Makes a scene ready; its spectra are added to the palette.
    ///
    /// # Errors
    /// Whatever this renderer can't do, by the name the scene gives it.
    pub fn new(scene: &Scene, size: [u32; 2], palette: &mut Palette) -> Result<Self, RenderError> {
        let world = direct::world(scene).map_err(|e| RenderError::new(e.to_string()))?;
        let mut surfaces = Vec::new();
        for (number, shape) in scene.shapes.iter().enumerate() {
            let material = Material::new(scene, shape.bsdf, palette)?;
            let axes = || Parametrisation::new(&shape.geometry, world.primitives(number).start);
            let parametrisation = material.has_axes().then(axes);
            surfaces.push(Surface { material, emission: None, parametrisation });
        }
        let camera = camera(scene, size)?;
        let mut result = Self {
            pixel_angle: pixel_angle(&camera, size),
            world,
            blockers: Blockers::new(scene),
            camera,
            surfaces,
            lights: Vec::new(),
            ambient: Vec::new(),
            cells: None,
            settings: settings(scene.integrator)?,
            counts: Vec::new(),
        };
        for emitter in &scene.emitters {
            result.add_light(scene, emitter, palette)?;
        }
        result.cells = Some(Cells::new(&result.world, &result.lights));
        Ok(result)
    }

    fn add_light(&mut self, scene: &Scene, emitter: &Emitter, palette: &mut Palette) -> Result<(), RenderError> {
        let mut light = |spectrum| palette.factor(scene.spectrum(spectrum), Role::Light);
        match emitter {
            Emitter::Area { shape, radiance } => {
                let radiance = light(*radiance);
                let data = scene.shapes.get(shape.0).ok_or_else(|| RenderError::new("a light has no shape"))?;
                if let Some(surface) = self.surfaces.get_mut(shape.0) {
                    surface.emission = Some((radiance, self.lights.len()));
                }
                let primitive = self.world.primitives(shape.0).start;
                self.lights.push(Light::Area { source: area_source(data, primitive)?, radiance });
            }
            Emitter::Point { position, intensity } => {
                self.lights.push(Light::Point { position: *position, intensity: light(*intensity) });
            }
            Emitter::Directional { direction, irradiance } => {
                self.lights.push(Light::Directional { direction: *direction, irradiance: light(*irradiance) });
            }
            Emitter::Luminaire { luminaire, spectrum, .. } => {
                self.lights.push(Light::Luminaire { luminaire: luminaire.clone(), intensity: light(*spectrum) });
            }
            Emitter::Ambient { radiance } => self.ambient.push(light(*radiance)),
            Emitter::Constant { label, .. } => {
                return Err(RenderError::new(format!(
                    "{label}: the Whitted renderer has no environments: use area, point, directional or ambient emitters"
                )));
            }
        }
        Ok(())
    }
}

/// A path of Mitsuba's `max_depth` has up to two segments less of reflections and refractions: the first comes from the eye, the last
/// from a light.
fn settings(integrator: Integrator) -> Result<Settings, RenderError> {
    const MOST: u32 = 256;
    let settings = |max_depth| Settings { max_depth, glossy: GlossyLight::default() };
    match integrator {
        Integrator::Whitted { max_depth } => Ok(settings(max_depth)),
        Integrator::Path { max_depth: Some(0 | 1), .. } => Err(RenderError::new(
            "the Whitted renderer can't leave out direct light: the max_depth of a path must be 2 or more",
        )),
        Integrator::Path { max_depth: Some(depth), .. } => Ok(settings((depth - 2).min(MOST))),
        _ => Ok(Settings::default()),
    }
}

/// The angle between the rays through neighbouring pixels in the middle of a picture.
#[allow(clippy::cast_precision_loss, reason = "pictures are smaller")]
fn pixel_angle(camera: &Camera, size: [u32; 2]) -> f64 {
    let [x, y] = size.map(|s| s as f32 / 2.0);
    let direction = |x: f32| camera.ray(x, y).direction.as_dvec3().normalize_or_zero();
    direction(x).distance(direction(x + 1.0))
}

pub(crate) fn camera(scene: &Scene, [width, height]: [u32; 2]) -> Result<Camera, RenderError> {
    let axis = match scene.camera.fov_axis {
        FovAxis::X => geometry::FovAxis::X,
        FovAxis::Y => geometry::FovAxis::Y,
        FovAxis::Diagonal => geometry::FovAxis::Diagonal,
        FovAxis::Smaller => geometry::FovAxis::Smaller,
        FovAxis::Larger => geometry::FovAxis::Larger,
    };
    Camera::new(&scene.camera.to_world, scene.camera.fov, axis, width, height)
        .map_err(|e| RenderError::new(e.to_string()))
}

/// The light of a shape that shines.
fn area_source(shape: &Shape, primitive: u32) -> Result<Source, RenderError> {
    match (&shape.geometry, direct::sources(shape, primitive).as_deref()) {
        (Geometry::Rectangle { .. } | Geometry::Disk { .. } | Geometry::Sphere { .. }, Some([source])) => Ok(*source),
        _ => Err(RenderError::new(format!(
            "{}: the Whitted renderer has area lights on rectangles, disks and spheres seen from outside alone",
            shape.label
        ))),
    }
}

impl Whitted {
    /// All surfaces, for rays.
    pub(crate) const fn world(&self) -> &World {
        &self.world
    }

    /// What the side of a shape that was hit does with light; `None` where it is black.
    pub(crate) fn material(&self, hit: &Hit) -> Option<&Material> {
        self.surfaces.get(hit.shape as usize)?.material.side(hit.front)
    }

    /// The materials of all shapes.
    pub(crate) fn materials(&self) -> impl Iterator<Item = &Material> {
        self.surfaces.iter().map(|surface| &surface.material)
    }

    /// Where the scene is seen from.
    pub(crate) const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The radiances that stand for light between surfaces.
    pub(crate) fn ambient(&self) -> &[Factor] {
        &self.ambient
    }

    /// All lights.
    pub(crate) fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The spectra of the lights.
    pub(crate) fn light_factors(&self) -> impl Iterator<Item = Factor> {
        self.lights.iter().map(Light::factor)
    }
}
