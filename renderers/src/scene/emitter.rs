//! Lights.

use glam::DVec3;

use super::load::{Loader, label};
use super::props::{Props, unsupported};
use super::spectrum::Role;
use super::xml::Node;
use super::{Emitter, EmitterId, SceneError, ShapeId, SpectrumKind};

/// The default of every emission property: D65 with Y = 1.
const DEFAULT_LIGHT: SpectrumKind = SpectrumKind::D65 { scale: 1.0 };

/// Reads an `<emitter>` at the top of the scene.
pub(crate) fn add<'a>(loader: &mut Loader<'a>, node: Node<'a>) -> Result<(), SceneError> {
    let mut props = Props::new(node)?;
    let emitter = match props.kind() {
        "point" => {
            let position = position(&mut props)?;
            Emitter::Point { position, intensity: light(loader, &mut props, "intensity")? }
        }
        "directional" => {
            let direction = direction(&mut props)?;
            Emitter::Directional { direction, irradiance: light(loader, &mut props, "irradiance")? }
        }
        "constant" => Emitter::Constant { radiance: light(loader, &mut props, "radiance")?, label: label(node) },
        "ambient" => Emitter::Ambient { radiance: light(loader, &mut props, "radiance")? },
        "area" => return Err(node.error("an area light belongs inside the <shape> that shines")),
        other => {
            return Err(unsupported(
                node,
                "emitter type",
                other,
                &["area", "point", "directional", "constant", "ambient"],
            ));
        }
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

/// Takes the area light of the shape that will get the id `shape`.
pub(crate) fn of_shape<'a>(
    loader: &mut Loader<'a>,
    shape_props: &mut Props<'a>,
    shape: ShapeId,
) -> Result<Option<EmitterId>, SceneError> {
    let Some(node) = shape_props.take_tag(&["emitter"]) else { return Ok(None) };
    let mut props = Props::new(node)?;
    if props.kind() != "area" {
        return Err(unsupported(node, "inside a shape, emitter type", props.kind(), &["area"]));
    }
    let radiance = light(loader, &mut props, "radiance")?;
    props.finish()?;
    loader.emitters.push(Emitter::Area { shape, radiance });
    Ok(Some(EmitterId(loader.emitters.len() - 1)))
}

fn light<'a>(loader: &mut Loader<'a>, props: &mut Props<'a>, name: &str) -> Result<super::SpectrumId, SceneError> {
    loader.spectra.property(props, name, Role::Emission, DEFAULT_LIGHT)
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
