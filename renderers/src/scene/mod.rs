//! Scenes: a documented subset of Mitsuba 3's XML, read into plain data, and the built-in scenes.
//!
//! [`load`] reads a [`Source`] (a file, or a text in memory) into a [`Scene`]: plain data in world space, every number
//! finite and in its domain, every reference resolved. Whatever is outside the subset below is refused with a
//! [`SceneError`] that names file, line and element; nothing is ignored. The scenes of [`builtin`] are such files too.
//!
//! # The supported subset
//!
//! Conventions are those of Mitsuba 3.9.1: the defaults, the units, the composition of transforms, the camera that looks
//! along +z with +x to the left of the image, normals along +z (rectangle, disk) or outward (sphere, cube), one-sided
//! materials and area lights, meshes smoothed unless they say otherwise. Properties marked *ext.* are this project's own.
//!
//! | Element | Types | Properties |
//! |---|---|---|
//! | `<scene version>` | 2.x, 3.x | children: `integrator`, `sensor`, `bsdf`, `shape`, `emitter`, `spectrum` with an `id`, `default` |
//! | `<default name value>` | | comes before use, the first one wins, parameters given from outside win over it |
//! | `<ref id>` | | to a `bsdf` or a `spectrum`, before or after it |
//! | `<integrator>` | `direct` | |
//! | | `path` | `max_depth` (−1: no limit), `rr_depth` (5) |
//! | | `whitted` *ext.* | `max_depth` (8, at most 256) |
//! | `<sensor>` | `perspective` | `fov` (needed), `fov_axis` (`x`), `near_clip` (0.01), `far_clip` (10⁴), `to_world`; `sampler`, `film` |
//! | `<sampler>` | `independent`, `stratified`, `multijitter`, `orthogonal`, `ldsampler` | `sample_count` (4), `seed` (0); the type has no effect |
//! | `<film>` | `hdrfilm` | `width` (768), `height` (576); `rfilter`; `pixel_format` (`rgb` only), `file_format`, `component_format`: no effect |
//! | `<rfilter>` | `box`; `tent`; `gaussian` (default) | `radius` (1); `stddev` (0.5) |
//! | `<shape>` | `rectangle`, `disk`, `cube` | `to_world`, `flip_normals`; a `bsdf` or `ref` (default: diffuse 0.5), an area `emitter` |
//! | | `sphere` | the same, `center` (origin), `radius` (1) |
//! | | `obj` | the same, `filename`, `face_normals`; `v`, `vn`, `f` with 3 or 4 corners |
//! | `<bsdf>` | `diffuse` | `reflectance` (0.5) |
//! | | `conductor` | `material` (`none`, `Au`, `Ag`, `Cu`, `Al`) or `eta` and `k`; `specular_reflectance` (1); default: perfect mirror |
//! | | `dielectric` | `int_ior` (1.5046), `ext_ior` (1.000277): a number, a name of Mitsuba's, *ext.* one of [`DISPERSIVE_GLASSES`] (in a `<string>` or a `<float>`) or a spectrum; `specular_reflectance`, `specular_transmittance` (1); `absorption` *ext.* |
//! | | `schlick` *ext.* | `reflectance` (0.5), `roughness` (1), `isotropy` (1) |
//! | | `ward` *ext.* | `variant` (`ward`, `ward-duer`, `ward-neumann`, `balanced`: the default), `alpha` (0.1) or `alpha_u` and `alpha_v`, 10⁻⁶ to 100; `specular_reflectance` (0.2), `diffuse_reflectance` (0.5): together at most 1 at every wavelength |
//! | | `twosided` | one or two `bsdf`s or `ref`s |
//! | `<emitter>` | `area` (inside a shape) | `radiance`; `luminance` or `luminous_flux` *ext.* |
//! | | `point` | `intensity`; `position` or `to_world`; `luminous_intensity` or `luminous_flux` *ext.* |
//! | | `directional` | `irradiance`; `direction` or `to_world`; `illuminance` *ext.* |
//! | | `constant` | `radiance`; `luminance` *ext.* |
//! | | `ambient` *ext.* | `radiance`; `luminance` |
//! | | `luminaire` *ext.* | `filename` (`.ies`, `.ldt`), `to_world` (rigid), `luminous_flux` (the file's), `spectrum` |
//! | `<transform>` | | `translate`, `rotate`, `scale`, `lookat` (with `up`), `matrix` (9 or 16 values), later ones applied after earlier ones |
//!
//! A spectrum property is a `<spectrum>` with `value="0.5"`, `value="400:0.1, 500:0.2"` or `filename` (see
//! [`parse_spectrum_file`]); a `<spectrum type>` of `uniform` (`value`), `regular` (`wavelength_min`, `wavelength_max`,
//! `values`), `irregular` (`wavelengths`, `values`), `d65` (`scale`) or `blackbody` (`temperature`, `wavelength_min`,
//! `wavelength_max`, `scale` *ext.*); a `<ref>` to one; a `<float>`; or an `<rgb>`. A `<float>` and a grey `<rgb>` are constants for
//! materials and multiples of D65 for lights, whose default is D65 with Y = 1; a coloured `<rgb>`, linear Rec. 709, is the smooth
//! spectrum that has this colour under D65, and for lights times D65 ([`spectral_core::upsampling`]). Tables are linear
//! between their nodes and 0 outside.
//!
//! A photometric quantity (`<float>`, positive; the scene's length unit is the metre) gives a light's spectrum its scale:
//! with `luminance` in cd/m², `luminous_flux` in lm, `luminous_intensity` in cd or `illuminance` in lx (on a plane across
//! parallel light), the spectrum, whatever it is, is multiplied so that its [photometric value](SpectrumKind::photometric)
//! is what is stated; flux is π × luminance × area of the front for area lights of any shape, 4π × intensity for points. A
//! light has one such quantity at most. Units are then absolute: a luminance of 1 cd/m² is a picture's Y of 1.37·10⁻⁵.
//!
//! A `luminaire` has the candela of its IES LM-63 or EULUMDAT file ([`luminaire`](crate::luminaire)), scaled to
//! `luminous_flux` where that is given, and shines as a point. In its own frame it hangs upright: its light goes down along
//! −z (γ = 0), plane C0 is +x and C90 +y, and `to_world` moves, turns or mirrors that frame. `spectrum` gives the colour
//! alone, its scale has no effect; the default is D65 as for all lights.
//!
//! The bsdf `ward` has the parameters and defaults of the plugin of Mitsuba 0.6, spelt as Mitsuba 3 spells them. `alpha_u` is along the
//! derivative of the surface by its first coordinate, as in Mitsuba: along x of rectangles, away from the middle of disks, along the
//! parallels of spheres, and on meshes along each triangle's first edge (texture coordinates are not read, which would decide there).
//!
//! Stricter than Mitsuba: refused are NaN and infinite numbers anywhere, negative spectra, reflectances above 1, indices
//! that do not cover 380–780 nm, wavelengths that do not increase, singular transforms, radii and image sizes that are not
//! positive, spheres and disks under a transform that is no similarity, sheared rectangles, meshes without area, scaled
//! cameras, scenes without a sensor, textures, included files, text between elements, and properties
//! given twice.
//!
//! What is no error but hardly meant is told by [`Scene::warnings`]: surfaces of transparent media that don't enclose them.
//!
//! ```
//! use renderers::scene::{BsdfKind, Source, load};
//!
//! let xml = r#"<scene version="3.0.0">
//!   <sensor type="perspective"><float name="fov" value="40"/></sensor>
//!   <shape type="sphere"><float name="radius" value="$r"/></shape>
//! </scene>"#;
//! let scene = load(&Source::text("ball.xml", xml), &[("r".to_owned(), "2".to_owned())])?;
//! assert!(matches!(scene.bsdf(scene.shapes[0].bsdf).kind, BsdfKind::Diffuse { .. }));
//!
//! let error = load(&Source::text("ball.xml", xml), &[("r".to_owned(), "-2".to_owned())]).unwrap_err();
//! assert_eq!(error.to_string(), "ball.xml:3: <float>: \"radius\" must be positive, not -2");
//! # Ok::<(), renderers::scene::SceneError>(())
//! ```

mod bsdf;
pub mod builtin;
mod data;
mod emitter;
mod error;
mod load;
mod obj;
mod photometry;
mod props;
mod rgb;
mod sensor;
mod shape;
mod source;
mod spectrum;
mod transform;
mod warning;
mod xml;

pub use bsdf::DISPERSIVE_GLASSES;
pub use data::*;
pub use error::SceneError;
pub use glam;
pub use load::load;
pub use source::Source;
pub use spectrum::parse_file as parse_spectrum_file;
pub use warning::{Flaw, Warning};

#[cfg(test)]
mod tests;
