//! Scenes with known answers.

mod beams;
mod drifting;
mod optics;
mod paths;
mod slight;

use glam::DVec3;

use super::trace::Limits;
use super::{Emission, Emitted, Settings};
use crate::scene::{Geometry, Mesh, Scene, Source, builtin, load};
use crate::spectral::Palette;
use crate::whitted::Whitted;

/// A scene made ready.
struct Stage {
    scene: Scene,
    whitted: Whitted,
    palette: Palette,
}

impl Stage {
    /// A scene of these elements.
    fn of(elements: &str) -> Self {
        Self::ready(scene(elements))
    }

    /// The same with a mesh in place of the first shape.
    fn with_mesh(elements: &str, mesh: Mesh) -> Self {
        let mut scene = scene(elements);
        scene.shapes[0].geometry = Geometry::Mesh(mesh);
        Self::ready(scene)
    }

    fn built_in(name: &str) -> Self {
        Self::ready(builtin::load(name, &[]).unwrap())
    }

    fn ready(scene: Scene) -> Self {
        let mut palette = Palette::default();
        let whitted = Whitted::new(&scene, [16, 16], &mut palette).unwrap();
        Self { scene, whitted, palette }
    }

    fn emission(&self, settings: Settings) -> Emission<'_> {
        Emission::new(&self.scene, &self.whitted, &self.palette, settings)
    }
}

fn scene(elements: &str) -> Scene {
    let sensor = r#"<sensor type="perspective"><float name="fov" value="40"/></sensor>"#;
    let xml = format!(r#"<scene version="3.0.0">{sensor}{elements}</scene>"#);
    load(&Source::text("test.xml", &xml), &[]).unwrap()
}

fn settings(seed: u32, max_depth: u32, share: f64) -> Settings {
    Settings { seed, limits: Limits { max_depth, share } }
}

fn emit(emission: &Emission<'_>, count: u64, pass: u32) -> Emitted {
    emission.emit(count, pass, &|_| ())
}

/// Glass of an index against 1, and more.
fn glass(index: &str, more: &str) -> String {
    let kind = if index.parse::<f64>().is_ok() { "float" } else { "string" };
    format!(
        r#"<bsdf type="dielectric"><{kind} name="int_ior" value="{index}"/><float name="ext_ior" value="1"/>{more}</bsdf>"#
    )
}

fn point(position: &str) -> String {
    format!(
        r#"<emitter type="point"><point name="position" value="{position}"/><spectrum name="intensity" value="1"/></emitter>"#
    )
}

fn directional(direction: DVec3) -> String {
    let DVec3 { x, y, z } = direction;
    format!(
        r#"<emitter type="directional"><vector name="direction" value="{x} {y} {z}"/>
        <spectrum name="irradiance" value="1"/></emitter>"#
    )
}

/// A shape that shines, placed by a transform.
fn area(shape: &str, transform: &str) -> String {
    format!(
        r#"<shape type="{shape}"><transform name="to_world">{transform}</transform>
        <emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>"#
    )
}

/// A black sphere around everything; what lands there is kept.
fn surroundings(radius: f64) -> String {
    format!(
        r#"<shape type="sphere"><float name="radius" value="{radius}"/><boolean name="flip_normals" value="true"/>
        <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>"#
    )
}

/// A ring with a rectangular section, of 8 triangles for each of `count` steps; it stands on z = 0.01.
fn ring(count: u32, [inner, outer, height]: [f64; 3]) -> Mesh {
    let corners = [(inner, 0.0), (outer, 0.0), (outer, height), (inner, height)];
    let positions = (0..count).flat_map(|step| {
        let (sin, cos) = (core::f64::consts::TAU * f64::from(step) / f64::from(count)).sin_cos();
        corners.map(|(radius, z)| DVec3::new(radius * cos, radius * sin, z + 0.01))
    });
    let triangles = (0..count).flat_map(|step| {
        let (here, next) = (4 * step, 4 * ((step + 1) % count));
        [0, 1, 2, 3].into_iter().flat_map(move |corner| {
            let after = (corner + 1) % 4;
            let [a, b, c, d] = [here + corner, here + after, next + after, next + corner];
            [[a, d, c], [a, c, b]]
        })
    });
    Mesh { positions: positions.collect(), normals: None, triangles: triangles.collect() }
}

/// The mean of independent estimates and its standard error.
fn mean(values: &[f64]) -> (f64, f64) {
    let count = f64::from(u32::try_from(values.len()).unwrap());
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}
