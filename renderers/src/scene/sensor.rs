//! Camera, film, sampler and integrator.

use super::props::{Props, unsupported};
use super::transform::similarity;
use super::{Camera, Film, Filter, FovAxis, Integrator, Sampler, SceneError};
use crate::whitted::DEFAULT_MAX_DEPTH;

/// What a scene gets that names no integrator.
pub(crate) const DEFAULT_INTEGRATOR: Integrator = Integrator::Path { max_depth: None, rr_depth: 5 };
/// Longest side of an image, pixels.
const MAX_SIDE: i64 = 65_536;
/// Most samples of a pixel.
const MAX_SAMPLES: i64 = 65_536;
/// Longest chain of reflections and refractions: more than is ever seen, and no more than a thread's stack holds.
const MAX_DEPTH: i64 = 256;
/// How far a camera's transform may be from a rotation: Mitsuba's own limit.
const RIGID_TOLERANCE: f64 = 1e-3;

/// Reads an `<integrator>`.
pub(crate) fn integrator(mut props: Props<'_>) -> Result<Integrator, SceneError> {
    let max = i64::from(u32::MAX);
    let integrator = match props.kind() {
        "direct" => Integrator::Direct,
        "path" => {
            let max_depth = props.integer("max_depth", -1, -1, max)?;
            let rr_depth = unsigned(props.integer("rr_depth", 5, 1, max)?);
            Integrator::Path { max_depth: u32::try_from(max_depth).ok(), rr_depth }
        }
        "whitted" => Integrator::Whitted {
            max_depth: unsigned(props.integer("max_depth", i64::from(DEFAULT_MAX_DEPTH), 0, MAX_DEPTH)?),
        },
        other => {
            return Err(unsupported(props.node(), "integrator type", other, &["direct", "path", "whitted"]));
        }
    };
    props.finish()?;
    Ok(integrator)
}

/// A checked, positive integer as an unsigned one.
fn unsigned(value: i64) -> u32 {
    u32::try_from(value).unwrap_or(u32::MAX)
}

/// Reads a `<sensor>`.
pub(crate) fn sensor(mut props: Props<'_>) -> Result<(Camera, Film, Sampler), SceneError> {
    if props.kind() != "perspective" {
        return Err(unsupported(props.node(), "sensor type", props.kind(), &["perspective"]));
    }
    let camera = camera(&mut props)?;
    let film = match props.take_tag(&["film"]) {
        Some(node) => film(Props::new(node)?)?,
        None => Film { width: 768, height: 576, filter: Filter::Gaussian { stddev: 0.5 } },
    };
    let sampler = match props.take_tag(&["sampler"]) {
        Some(node) => sampler(Props::new(node)?)?,
        None => Sampler { sample_count: 4, seed: 0 },
    };
    props.finish()?;
    Ok((camera, film, sampler))
}

fn camera(props: &mut Props<'_>) -> Result<Camera, SceneError> {
    let (at, to_world) = props.transform()?;
    let (deviation, scale) = similarity(&to_world);
    if !(deviation <= RIGID_TOLERANCE && (scale - 1.0).abs() <= RIGID_TOLERANCE) {
        return Err(at.error("a camera can be rotated and moved, not scaled"));
    }
    let fov = props.float_where("fov", 0.0, |fov| fov > 0.0 && fov < 180.0, "between 0 and 180 degrees")?;
    if fov == 0.0 {
        return Err(props.node().error("missing property \"fov\""));
    }
    let fov_axis = match props.choice("fov_axis", &["x", "y", "diagonal", "smaller", "larger"])? {
        Some("y") => FovAxis::Y,
        Some("diagonal") => FovAxis::Diagonal,
        Some("smaller") => FovAxis::Smaller,
        Some("larger") => FovAxis::Larger,
        _ => FovAxis::X,
    };
    let near_clip = props.float_where("near_clip", 1e-2, |near| near > 0.0, "positive")?;
    let far_clip = props.float_where("far_clip", 1e4, |far| far > near_clip, "beyond near_clip")?;
    if far_clip <= near_clip {
        return Err(props.node().error("\"near_clip\" must be below \"far_clip\""));
    }
    Ok(Camera { to_world, fov, fov_axis, near_clip, far_clip })
}

fn film(mut props: Props<'_>) -> Result<Film, SceneError> {
    if props.kind() != "hdrfilm" {
        return Err(unsupported(props.node(), "film type", props.kind(), &["hdrfilm"]));
    }
    let width = unsigned(props.integer("width", 768, 1, MAX_SIDE)?);
    let height = unsigned(props.integer("height", 576, 1, MAX_SIDE)?);
    // How Mitsuba is to store its file; nothing to do with the picture.
    props.choice("file_format", &["openexr"])?;
    props.choice("pixel_format", &["rgb"])?;
    props.choice("component_format", &["float16", "float32"])?;
    let filter = match props.take_tag(&["rfilter"]) {
        Some(node) => filter(Props::new(node)?)?,
        None => Filter::Gaussian { stddev: 0.5 },
    };
    props.finish()?;
    Ok(Film { width, height, filter })
}

fn filter(mut props: Props<'_>) -> Result<Filter, SceneError> {
    // Wider filters would reach over hundreds of pixels and mean a slip of the pen.
    let sane = |length: f64| length > 0.0 && length <= 100.0;
    let what = "above 0 and at most 100 pixels";
    let filter = match props.kind() {
        "box" => Filter::Box,
        "tent" => Filter::Tent { radius: props.float_where("radius", 1.0, sane, what)? },
        "gaussian" => Filter::Gaussian { stddev: props.float_where("stddev", 0.5, sane, what)? },
        other => {
            return Err(unsupported(props.node(), "rfilter type", other, &["box", "tent", "gaussian"]));
        }
    };
    props.finish()?;
    Ok(filter)
}

fn sampler(mut props: Props<'_>) -> Result<Sampler, SceneError> {
    const TYPES: [&str; 5] = ["independent", "stratified", "multijitter", "orthogonal", "ldsampler"];
    if !TYPES.contains(&props.kind()) {
        return Err(unsupported(props.node(), "sampler type", props.kind(), &TYPES));
    }
    let sample_count = unsigned(props.integer("sample_count", 4, 1, MAX_SAMPLES)?);
    let seed = props.integer("seed", 0, 0, i64::MAX)?;
    props.finish()?;
    Ok(Sampler { sample_count, seed: u64::try_from(seed).unwrap_or(0) })
}
