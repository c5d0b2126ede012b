//! `<transform>`: a chain of affine maps, each applied after those before it.

use glam::{DAffine3, DMat3, DVec3};

use super::SceneError;
use super::props::{parse_float, parse_list, parse_vector};
use super::xml::Node;

/// The map of a `<transform>` element; refused if it (or any step) is singular or leaves the range of numbers.
pub(crate) fn parse(node: Node<'_>) -> Result<DAffine3, SceneError> {
    node.allow_attributes(&["name"])?;
    let mut whole = DAffine3::IDENTITY;
    for child in node.children() {
        child.no_children()?;
        let step = step(child)?;
        check_regular(child, &step)?;
        whole = step * whole;
    }
    check_regular(node, &whole)?;
    Ok(whole)
}

fn step(node: Node<'_>) -> Result<DAffine3, SceneError> {
    match node.tag() {
        "translate" => {
            node.allow_attributes(&["x", "y", "z", "value"])?;
            Ok(DAffine3::from_translation(parse_vector(node, 0.0)?))
        }
        "scale" => {
            node.allow_attributes(&["x", "y", "z", "value"])?;
            Ok(DAffine3::from_scale(parse_vector(node, 1.0)?))
        }
        "rotate" => rotate(node),
        "lookat" => lookat(node),
        "matrix" => matrix(node),
        _ => Err(node.error("not supported inside <transform>")),
    }
}

fn rotate(node: Node<'_>) -> Result<DAffine3, SceneError> {
    node.allow_attributes(&["x", "y", "z", "value", "angle"])?;
    let axis = parse_vector(node, 0.0)?.try_normalize().ok_or_else(|| node.error("the rotation axis is zero"))?;
    let degrees = parse_float(node, node.require("angle")?)?;
    Ok(DAffine3::from_axis_angle(axis, degrees.to_radians()))
}

/// The frame at `origin` with +z to `target`, +y as near to `up` as can be, and +x = up × z (image-left).
fn lookat(node: Node<'_>) -> Result<DAffine3, SceneError> {
    node.allow_attributes(&["origin", "target", "up"])?;
    let vector = |name| match parse_list(node, node.require(name)?)?.as_slice() {
        &[x, y, z] => Ok(DVec3::new(x, y, z)),
        other => Err(node.error(format!("{name:?} must hold three numbers, not {}", other.len()))),
    };
    let (origin, target, up) = (vector("origin")?, vector("target")?, vector("up")?);
    let forward =
        (target - origin).try_normalize().ok_or_else(|| node.error("\"origin\" and \"target\" are the same point"))?;
    let left = up.normalize_or_zero().cross(forward);
    let defined = left.length() > 1e-9;
    if !defined {
        return Err(node.error("\"up\" is zero or along the line of sight"));
    }
    let left = left.normalize();
    Ok(DAffine3 { matrix3: DMat3::from_cols(left, forward.cross(left), forward), translation: origin })
}

fn matrix(node: Node<'_>) -> Result<DAffine3, SceneError> {
    node.allow_attributes(&["value"])?;
    let values = parse_list(node, node.require("value")?)?;
    let (linear, translation) = match values.as_slice() {
        &[a, b, c, d, e, f, g, h, i] => ([a, b, c, d, e, f, g, h, i], DVec3::ZERO),
        &[a, b, c, x, d, e, f, y, g, h, i, z, 0.0, 0.0, 0.0, 1.0] => ([a, b, c, d, e, f, g, h, i], DVec3::new(x, y, z)),
        other if other.len() == 16 => {
            return Err(node.error("the last row of the matrix must be 0 0 0 1"));
        }
        other => {
            return Err(node.error(format!("a matrix has 9 or 16 values, not {}", other.len())));
        }
    };
    // The text goes row by row, glam's arrays column by column.
    Ok(DAffine3 { matrix3: DMat3::from_cols_array(&linear).transpose(), translation })
}

/// A map is regular if its columns span a volume of more than 1e-12 of the product of their lengths.
fn check_regular(node: Node<'_>, map: &DAffine3) -> Result<(), SceneError> {
    let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    let lengths: f64 = columns.iter().map(|column| column.length()).product();
    let volume = map.matrix3.determinant().abs();
    if map.is_finite() && lengths.is_finite() && volume.is_normal() && volume > 1e-12 * lengths {
        Ok(())
    } else {
        Err(node.error("the transform is singular or too large or small for the range of numbers"))
    }
}

/// Largest deviation of MᵀM from a multiple s² of the identity, over s², and s itself: 0 for rotation, mirroring and
/// uniform scale.
pub(crate) fn similarity(map: &DAffine3) -> (f64, f64) {
    let gram = map.matrix3.transpose() * map.matrix3;
    let square = (gram.x_axis.x + gram.y_axis.y + gram.z_axis.z) / 3.0;
    let off = gram - DMat3::from_diagonal(DVec3::splat(square));
    let worst = off.to_cols_array().iter().fold(0.0, |worst: f64, x| worst.max(x.abs()));
    (worst / square, square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::xml::Document;
    use super::*;

    fn map(body: &str) -> DAffine3 {
        try_map(body).unwrap()
    }

    fn try_map(body: &str) -> Result<DAffine3, SceneError> {
        let document = Document::parse("t.xml", &format!("<transform name=\"to_world\">{body}</transform>"), &[])?;
        parse(document.root())
    }

    #[track_caller]
    fn assert_near(a: DVec3, b: DVec3) {
        let err = (a - b).length();
        assert!(err <= 1e-12 * (1.0 + b.length()), "{a} is not {b}");
    }

    #[test]
    fn later_steps_apply_after_earlier_ones() {
        let there = map(r#"<translate x="1"/><rotate z="1" angle="90"/><scale value="2"/>"#);
        assert_near(there.transform_point3(DVec3::ZERO), DVec3::new(0.0, 2.0, 0.0));
        assert_near(there.transform_vector3(DVec3::X), DVec3::new(0.0, 2.0, 0.0));
    }

    #[test]
    fn rotation_is_right_handed_in_degrees() {
        let turn = map(r#"<rotate value="0 3 0" angle="90"/>"#);
        assert_near(turn.transform_point3(DVec3::Z), DVec3::X);
    }

    #[test]
    fn camera_looks_along_z_with_x_to_the_left() {
        let camera = map(r#"<lookat origin="1 2 3" target="1 2 13" up="0 5 0"/>"#);
        assert_near(camera.translation, DVec3::new(1.0, 2.0, 3.0));
        assert_near(camera.transform_vector3(DVec3::Z), DVec3::Z);
        assert_near(camera.transform_vector3(DVec3::Y), DVec3::Y);
        assert_near(camera.transform_vector3(DVec3::X), DVec3::X);
        let back = map(r#"<lookat origin="0 0 0" target="0 0 -1" up="0 1 0"/>"#);
        assert_near(back.transform_vector3(DVec3::X), DVec3::NEG_X);
        assert!((back.matrix3.determinant() - 1.0).abs() <= 1e-12);
    }

    #[test]
    fn matrices_are_row_by_row() {
        let there = map(r#"<matrix value="1 2 0 4  0 1 0 5  0 0 1 6  0 0 0 1"/>"#);
        assert_near(there.transform_point3(DVec3::Y), DVec3::new(6.0, 6.0, 6.0));
        assert_near(map(r#"<matrix value="0 1 0 1 0 0 0 0 1"/>"#).transform_point3(DVec3::X), DVec3::Y);
    }

    #[test]
    fn singular_and_degenerate_steps_are_refused() {
        for body in [
            r#"<scale x="0"/>"#,
            r#"<scale value="1e-200"/>"#,
            r#"<scale value="1e200"/>"#,
            r#"<rotate angle="3"/>"#,
            r#"<matrix value="1 2 3 2 4 6 0 0 1"/>"#,
            r#"<matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1"/>"#,
            r#"<lookat origin="0 0 0" target="0 0 0" up="0 1 0"/>"#,
            r#"<lookat origin="0 0 0" target="0 1 0" up="0 1 0"/>"#,
        ] {
            assert!(try_map(body).is_err(), "{body}");
        }
    }

    #[test]
    fn similarity_tells_uniform_scale() {
        let (off, scale) = similarity(&map(r#"<rotate value="1 2 3" angle="40"/><scale value="-3"/>"#));
        assert!(off <= 1e-14 && (scale - 3.0).abs() <= 1e-14);
        assert!(similarity(&map(r#"<scale z="1.001"/>"#)).0 > 1e-4);
    }
}
