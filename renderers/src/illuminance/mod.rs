//! Illuminance at points of a scene: what `spectral illuminance` measures.
//!
//! The direct part is that of [`direct`](crate::direct): closed forms wherever the geometry allows, shadow rays to a requested accuracy
//! elsewhere. Spectra are integrated exactly. Mirrors and glass cast shadows like everything else; what light they send on is not found.
//!
//! ```
//! use renderers::illuminance::{Meter, Settings};
//! use renderers::scene::glam::DVec3;
//! use renderers::scene::{Source, load};
//!
//! let xml = r#"<scene version="3.0.0">
//!   <integrator type="direct"/>
//!   <sensor type="perspective"><float name="fov" value="40"/></sensor>
//!   <shape type="disk">
//!     <transform name="to_world"><rotate x="1" angle="180"/><translate z="1"/></transform>
//!     <emitter type="area"><spectrum name="radiance" type="d65"/></emitter>
//!   </shape>
//! </scene>"#;
//! let scene = load(&Source::text("disk.xml", xml), &[])?;
//! let meter = Meter::new(&scene, Settings::default(), None)?;
//! let below = meter.read(DVec3::ZERO, DVec3::Z)?;
//! let beside = meter.read(DVec3::new(1.0, 0.0, 0.0), DVec3::Z)?;
//! // r²/(r² + h²) = 1/2 on the axis, (1 − h/√(4 r² + h²))/2 below the rim.
//! let ratio: f64 = (1.0 - 1.0 / 5.0_f64.sqrt()) / 2.0 / 0.5;
//! assert!((beside.lux / below.lux - ratio).abs() <= 1e-12);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```

mod colour;
mod indirect;
mod meter;
mod nanometres;
mod points;

pub use colour::{ColourMeter, LightColour};
pub use indirect::{IndirectIrradiance, IndirectLight, IndirectPart};
pub use meter::{Meter, MeterError, Reading, Settings};
pub use nanometres::{Nanometres, SpectralIndirect};
pub use points::{Point, PointsError, parse_points};
