//! Lights.

use alloc::sync::Arc;
use core::f64::consts::PI;

use glam::{DAffine3, DVec3};

use super::load::{Loader, label};
use super::photometry::{self, Stated};
use super::props::{Props, unsupported};
use super::transform::similarity;
use super::xml::Node;
use super::{Emitter, EmitterId, SceneError, ShapeId, SpectrumId, SpectrumKind};
use crate::luminaire::{LuminousIntensity, PlacedLuminaire};

/// The default of every emission property: D65 with Y = 1.
const DEFAULT_LIGHT: SpectrumKind = SpectrumKind::D65 { scale: 1.0 };
const TYPES: [&str; 6] = ["area", "point", "directional", "constant", "ambient", "luminaire"];
/// How far a luminaire's frame may be from a rigid one, relative: rounding of the numbers in a scene file.
const RIGIDITY: f64 = 1e-6;

/// Reads an `<emitter>` at the top of the scene.
pub(crate) fn add<'a>(loader: &mut Loader<'a>, node: Node<'a>) -> Result<(), SceneError> {
    let mut props = Props::new(node)?;
    let emitter = match props.kind() {
        "point" => {
            let position = position(&mut props)?;
            let quantities = [("luminous_intensity", 1.0), ("luminous_flux", 4.0 * PI)];
            Emitter::Point { position, intensity: light(loader, &mut props, "intensity", &quantities)? }
        }
        "directional" => {
            let direction = direction(&mut props)?;
            let irradiance = light(loader, &mut props, "irradiance", &[("illuminance", 1.0)])?;
            Emitter::Directional { direction, irradiance }
        }
        "constant" => {
            let radiance = light(loader, &mut props, "radiance", &[("luminance", 1.0)])?;
            Emitter::Constant { radiance, label: label(node) }
        }
        "ambient" => Emitter::Ambient { radiance: light(loader, &mut props, "radiance", &[("luminance", 1.0)])? },
        "luminaire" => luminaire(loader, &mut props)?,
        "area" => return Err(node.error("an area light belongs inside the <shape> that shines")),
        other => return Err(unsupported(node, "emitter type", other, &TYPES)),
    };
    props.finish()?;
    let single = matches!(emitter, Emitter::Constant { .. } | Emitter::Ambient { .. });
    let same = |other: &Emitter| core::mem::discriminant(other) == core::mem::discriminant(&emitter);
    if single && loader.emitters.iter().any(same) {
        return Err(node.error("a scene has only one emitter of this type"));
    }
    loader.emitters.push(emitter);
    Ok(())
}

/// Takes the area light of the shape that will get the id `shape` and has this area.
pub(crate) fn of_shape<'a>(
    loader: &mut Loader<'a>,
    shape_props: &mut Props<'a>,
    shape: ShapeId,
    area: f64,
) -> Result<Option<EmitterId>, SceneError> {
    let Some(node) = shape_props.take_tag(&["emitter"]) else { return Ok(None) };
    let mut props = Props::new(node)?;
    if props.kind() != "area" {
        return Err(unsupported(node, "inside a shape, emitter type", props.kind(), &["area"]));
    }
    let radiance = light(loader, &mut props, "radiance", &[("luminance", 1.0), ("luminous_flux", PI * area)])?;
    props.finish()?;
    loader.emitters.push(Emitter::Area { shape, radiance });
    Ok(Some(EmitterId(loader.emitters.len() - 1)))
}

/// Takes the spectrum `name` of a light, scaled to the one of the photometric `quantities` that is stated.
fn light<'a>(
    loader: &mut Loader<'a>,
    props: &mut Props<'a>,
    name: &str,
    quantities: &[(&str, f64)],
) -> Result<SpectrumId, SceneError> {
    let stated = Stated::take(props, quantities)?;
    loader.spectra.light(props, name, DEFAULT_LIGHT, stated.as_ref())
}

/// A luminaire: the distribution from its file, where it hangs, and the spectrum of one candela.
fn luminaire<'a>(loader: &mut Loader<'a>, props: &mut Props<'a>) -> Result<Emitter, SceneError> {
    let node = props.node();
    let to_world = rigid(props)?;
    let Some((file_node, name)) = props.string("filename")? else {
        return Err(node.error("missing property \"filename\""));
    };
    let (file, text) = loader.source.read_asset(name).map_err(|message| file_node.error(message))?;
    let file =
        crate::luminaire::parse(&file, &text).map_err(|e| SceneError::new(&e.file, (e.line, 0), "", e.what()))?;
    let intensity = rescaled(file.intensity, props)?;
    let spectrum = loader.spectra.light(props, "spectrum", DEFAULT_LIGHT, Some(&Stated::unit(node)))?;
    let luminaire = PlacedLuminaire::new(Arc::new(intensity), &to_world);
    Ok(Emitter::Luminaire { luminaire, spectrum, label: label(node) })
}

/// Takes `luminous_flux`, which replaces that of the file.
fn rescaled(intensity: LuminousIntensity, props: &mut Props<'_>) -> Result<LuminousIntensity, SceneError> {
    let Some((node, lumen)) = photometry::positive(props, "luminous_flux")? else { return Ok(intensity) };
    intensity.with_flux(lumen).map_err(|error| node.error(error.to_string()))
}

/// Takes a `to_world` that only moves, turns and mirrors.
fn rigid(props: &mut Props<'_>) -> Result<DAffine3, SceneError> {
    let (node, to_world) = props.transform()?;
    let (deviation, scale) = similarity(&to_world);
    if deviation <= RIGIDITY && (scale - 1.0).abs() <= RIGIDITY {
        Ok(to_world)
    } else {
        Err(node.error("a luminaire can be moved, turned and mirrored, but not scaled"))
    }
}

/// The place of a point light: its `position`, or where `to_world` takes the origin.
fn position(props: &mut Props<'_>) -> Result<DVec3, SceneError> {
    let (node, to_world) = props.transform()?;
    let Some((given, position)) = props.vector("position", "point")? else {
        return Ok(to_world.translation);
    };
    if node.tag() == "transform" {
        return Err(given.error("\"position\" excludes \"to_world\""));
    }
    Ok(position)
}

/// The way of parallel light: its `direction`, or where `to_world` takes +z; unit.
fn direction(props: &mut Props<'_>) -> Result<DVec3, SceneError> {
    let (node, to_world) = props.transform()?;
    let (node, direction) = match props.vector("direction", "vector")? {
        Some((given, _)) if node.tag() == "transform" => {
            return Err(given.error("\"direction\" excludes \"to_world\""));
        }
        Some(given) => given,
        None => (node, to_world.transform_vector3(DVec3::Z)),
    };
    direction.try_normalize().ok_or_else(|| node.error("the direction is zero"))
}
