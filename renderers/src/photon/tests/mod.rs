//! Scenes with known answers.

use super::{Emission, Limits, Settings};
use glam::DVec3;

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
        let xml = format!(
            r#"<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="40"/></sensor>{elements}</scene>"#
        );
        Self::ready(load(&Source::text("test.xml", &xml), &[]).unwrap())
    }

    /// The same with a mesh in place of the first shape.
    fn with_mesh(elements: &str, mesh: Mesh) -> Self {
        let mut scene = Self::of(elements).scene;
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

fn limits(max_depth: u32, share: f64) -> Settings {
    Settings { seed: 0, limits: Limits { max_depth, share } }
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
