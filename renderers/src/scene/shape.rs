//! Surfaces, brought into world space.

use glam::{DAffine3, DVec3};

use super::load::{Loader, label};
use super::obj::{self, MeshOptions};
use super::props::{Props, unsupported};
use super::transform::similarity;
use super::xml::Node;
use super::{Geometry, Mesh, SceneError, Shape, ShapeId, emitter};

const TYPES: [&str; 5] = ["rectangle", "disk", "sphere", "cube", "obj"];
/// How far a transform may be from keeping angles, relative: rounding of the numbers in a scene file.
const ANGLE_TOLERANCE: f64 = 1e-6;

/// Reads a `<shape>`.
pub(crate) fn add<'a>(loader: &mut Loader<'a>, node: Node<'a>) -> Result<(), SceneError> {
    let mut props = Props::new(node)?;
    let geometry = geometry(loader, &mut props)?;
    let bsdf = loader.bsdfs.of_shape(&mut props, &mut loader.spectra)?;
    let area = geometry.area();
    if !(area > 0.0 && area.is_finite()) {
        return Err(node.error("the shape's area is zero or leaves the range of numbers"));
    }
    let emitter = emitter::of_shape(loader, &mut props, ShapeId(loader.shapes.len()), area)?;
    props.finish()?;
    loader.shapes.push(Shape { geometry, bsdf, emitter, label: label(node) });
    Ok(())
}

fn geometry<'a>(loader: &Loader<'a>, props: &mut Props<'a>) -> Result<Geometry, SceneError> {
    let kind = props.kind();
    if !TYPES.contains(&kind) {
        return Err(unsupported(props.node(), "shape type", kind, &TYPES));
    }
    let (at, to_world) = props.transform()?;
    let flip = props.boolean("flip_normals")?;
    match kind {
        "rectangle" => rectangle(at, &to_world, flip),
        "disk" => disk(at, &to_world, flip),
        "sphere" => sphere(props, at, &to_world, flip),
        "cube" => Ok(Geometry::Mesh(cube(&to_world, flip))),
        _ => mesh(loader, props, to_world, flip),
    }
}

/// The unit normal of the plane z = 0, its front on the +z side before the transform.
fn plane_normal(at: Node<'_>, to_world: &DAffine3, flip: bool) -> Result<DVec3, SceneError> {
    let normal = to_world.matrix3.inverse().transpose() * DVec3::Z;
    let unit = normal.try_normalize().ok_or_else(|| at.error("the transform leaves the range of numbers"))?;
    Ok(if flip { -unit } else { unit })
}

fn rectangle(at: Node<'_>, to_world: &DAffine3, flip: bool) -> Result<Geometry, SceneError> {
    let (half_u, half_v) = (to_world.matrix3.x_axis, to_world.matrix3.y_axis);
    let square = half_u.dot(half_v).abs() <= ANGLE_TOLERANCE * half_u.length() * half_v.length();
    if !square {
        return Err(at.error("the transform shears the rectangle: use a mesh"));
    }
    Ok(Geometry::Rectangle { center: to_world.translation, half_u, half_v, normal: plane_normal(at, to_world, flip)? })
}

fn disk(at: Node<'_>, to_world: &DAffine3, flip: bool) -> Result<Geometry, SceneError> {
    let (u, v) = (to_world.matrix3.x_axis, to_world.matrix3.y_axis);
    let (length, other) = (u.length(), v.length());
    let round = (length - other).abs() <= ANGLE_TOLERANCE * length;
    if !(round && u.dot(v).abs() <= ANGLE_TOLERANCE * length * other) {
        return Err(at.error("the transform makes the disk an ellipse: scale its x and y alike"));
    }
    Ok(Geometry::Disk { center: to_world.translation, radius: length, normal: plane_normal(at, to_world, flip)? })
}

fn sphere(props: &mut Props<'_>, at: Node<'_>, to_world: &DAffine3, flip: bool) -> Result<Geometry, SceneError> {
    let center = props.vector("center", "point")?.map_or(DVec3::ZERO, |(_, center)| center);
    let radius = props.float_where("radius", 1.0, |r| r > 0.0, "positive")?;
    let (deviation, scale) = similarity(to_world);
    let round = deviation <= ANGLE_TOLERANCE;
    if !round {
        return Err(at.error("the transform makes the sphere an ellipsoid: scale x, y and z alike"));
    }
    // Mitsuba turns a sphere inside out by mirroring it, though not the other shapes.
    let inward = flip != (to_world.matrix3.determinant() < 0.0);
    let axis = to_world.matrix3.z_axis.normalize_or(DVec3::Z);
    Ok(Geometry::Sphere { center: to_world.transform_point3(center), radius: radius * scale, inward, axis })
}

/// The cube from (−1, −1, −1) to (1, 1, 1), flat shaded, its front outside.
fn cube(to_world: &DAffine3, flip: bool) -> Mesh {
    // Corner i has x, y, z from bits 0, 1, 2; every face anticlockwise from outside, its first edge along Mitsuba's first coordinate.
    const FACES: [[u32; 4]; 6] = [[4, 6, 2, 0], [1, 3, 7, 5], [1, 5, 4, 0], [6, 7, 3, 2], [0, 2, 3, 1], [5, 7, 6, 4]];
    let sign = |i: u32, bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    let corner = |i| to_world.transform_point3(DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)));
    let triangles = FACES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [c, d, a]]).collect();
    let mut mesh = Mesh { positions: (0..8).map(corner).collect(), normals: None, triangles };
    // A mirroring turns the corners' order round; the outside stays the front.
    if flip != (to_world.matrix3.determinant() < 0.0) {
        mesh.flip();
    }
    mesh
}

fn mesh<'a>(
    loader: &Loader<'a>,
    props: &mut Props<'a>,
    to_world: DAffine3,
    flip_normals: bool,
) -> Result<Geometry, SceneError> {
    let Some((node, name)) = props.string("filename")? else {
        return Err(props.node().error("missing property \"filename\""));
    };
    let face_normals = props.boolean("face_normals")?;
    let (file, text) = loader.source.read_asset(name).map_err(|message| node.error(message))?;
    obj::parse(&file, &text, &MeshOptions { to_world, face_normals, flip_normals }).map(Geometry::Mesh)
}
