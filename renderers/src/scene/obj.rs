//! A small reader of Wavefront OBJ files: vertices, normals, triangles and quadrilaterals.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};

use super::props::parse_finite;
use super::{Mesh, SceneError};

/// How a mesh is to be made from its file.
pub(crate) struct MeshOptions {
    /// From the file's coordinates to the world.
    pub(crate) to_world: DAffine3,
    /// Flat shading: no vertex normals.
    pub(crate) face_normals: bool,
    /// Front and back exchanged.
    pub(crate) flip_normals: bool,
}

/// A corner of a face: its position, texture coordinate and normal, counted from 0.
type Corner = (usize, Option<usize>, Option<usize>);

#[derive(Default)]
struct Reader {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    texture_count: usize,
    corners: HashMap<Corner, u32>,
    vertices: Vec<Corner>,
    triangles: Vec<[u32; 3]>,
}

/// Reads an OBJ text into world space.
///
/// Statements: `v`, `vn`, `vt` (counted only), `f` with 3 or 4 corners (`v`, `v/vt`, `v//vn`, `v/vt/vn`; negative indices
/// count from the end), `#`; `o`, `g`, `s`, `usemtl` and `mtllib` have no effect; others are refused. Quadrilaterals are
/// split along the diagonal from their first corner. Triangles without area are left out.
///
/// Normals: the file's if every corner has one; else angle-weighted means over the triangles that share a vertex; none
/// with `face_normals`. A triangle that winds against the file's normals is turned round: normals say where the front is.
pub(crate) fn parse(file: &str, text: &str, options: &MeshOptions) -> Result<Mesh, SceneError> {
    let mut reader = Reader::default();
    let mut last = 0;
    for (number, line) in (1..).zip(text.lines()) {
        let mut words = line.split('#').next().unwrap_or_default().split_whitespace();
        let Some(keyword) = words.next() else { continue };
        let arguments: Vec<_> = words.collect();
        let fail = |message: String| SceneError::new(file, (number, 0), keyword, message);
        reader.statement(keyword, &arguments).map_err(fail)?;
        last = number;
    }
    reader.mesh(options).map_err(|message| SceneError::new(file, (last, 0), "", message))
}

impl Reader {
    fn statement(&mut self, keyword: &str, arguments: &[&str]) -> Result<(), String> {
        match keyword {
            "v" => self.positions.push(vector(arguments)?),
            "vn" => self.normals.push(vector(arguments)?),
            "vt" => self.texture_count += 1,
            "f" => self.face(arguments)?,
            "o" | "g" | "s" | "usemtl" | "mtllib" => {}
            _ => {
                return Err("this statement is not supported (supported: v, vn, vt, f, o, g, s, usemtl, mtllib)".into());
            }
        }
        Ok(())
    }

    fn face(&mut self, arguments: &[&str]) -> Result<(), String> {
        if !(3..=4).contains(&arguments.len()) {
            return Err(format!("a face has 3 or 4 corners, not {}", arguments.len()));
        }
        let mut corners = Vec::with_capacity(4);
        for argument in arguments {
            let corner = self.corner(argument)?;
            let next = u32::try_from(self.vertices.len()).map_err(|_| "too many vertices")?;
            let vertex = *self.corners.entry(corner).or_insert(next);
            if vertex == next {
                self.vertices.push(corner);
            }
            corners.push(vertex);
        }
        let first = corners[0];
        self.triangles.extend(corners[1..].windows(2).map(|pair| [first, pair[0], pair[1]]));
        Ok(())
    }

    fn corner(&self, text: &str) -> Result<Corner, String> {
        let parts: Vec<_> = text.split('/').collect();
        let (v, vt, vn) = match *parts.as_slice() {
            [v] => (v, "", ""),
            [v, vt] => (v, vt, ""),
            [v, vt, vn] => (v, vt, vn),
            _ => return Err(format!("{text:?} is not a corner of a face")),
        };
        let optional = |text: &str, count, what| (!text.is_empty()).then(|| index(text, count, what)).transpose();
        Ok((
            index(v, self.positions.len(), "vertex")?,
            optional(vt, self.texture_count, "texture coordinate")?,
            optional(vn, self.normals.len(), "normal")?,
        ))
    }

    fn mesh(self, options: &MeshOptions) -> Result<Mesh, String> {
        let positions: Vec<_> =
            self.vertices.iter().map(|&(v, _, _)| options.to_world.transform_point3(self.positions[v])).collect();
        if !positions.iter().all(|p| p.is_finite()) {
            return Err("a vertex leaves the range of numbers".into());
        }
        let mut mesh = Mesh { positions, normals: None, triangles: self.triangles.clone() };
        mesh.drop_degenerate();
        if mesh.triangles.is_empty() {
            return Err("the mesh has no triangle with an area".into());
        }
        if !options.face_normals {
            let given = self.file_normals(options)?;
            let turn = given.is_some();
            mesh.normals = Some(given.unwrap_or_else(|| mesh.smooth_normals()));
            if turn {
                mesh.turn_towards_normals();
            }
        }
        if options.flip_normals {
            mesh.flip();
        }
        Ok(mesh)
    }

    /// The file's normals in world space; `None` if it has none.
    fn file_normals(&self, options: &MeshOptions) -> Result<Option<Vec<DVec3>>, String> {
        let with = self.vertices.iter().filter(|vertex| vertex.2.is_some()).count();
        if with == 0 {
            return Ok(None);
        }
        if with < self.vertices.len() {
            return Err("some corners have a normal and some have none".into());
        }
        let to_normals = options.to_world.matrix3.inverse().transpose();
        let normal = |vertex: &Corner| {
            let given = self.normals[vertex.2?];
            (to_normals * given.try_normalize()?).try_normalize()
        };
        let normals: Option<Vec<_>> = self.vertices.iter().map(normal).collect();
        normals.map(Some).ok_or_else(|| "a normal has no direction: its length is zero".into())
    }
}

fn vector(arguments: &[&str]) -> Result<DVec3, String> {
    match *arguments {
        [x, y, z] => Ok(DVec3::new(parse_finite(x)?, parse_finite(y)?, parse_finite(z)?)),
        _ => Err(format!("expected three numbers, found {}", arguments.len())),
    }
}

/// An index from 1, or from −1 backwards, as one from 0.
fn index(text: &str, count: usize, what: &str) -> Result<usize, String> {
    let number: i64 = text.parse().map_err(|_| format!("{text:?} is not an index"))?;
    let distance = usize::try_from(number.unsigned_abs()).unwrap_or(usize::MAX);
    let found = if number > 0 { distance.checked_sub(1) } else { count.checked_sub(distance) };
    found
        .filter(|&i| i < count)
        .ok_or_else(|| format!("there is no {what} {number}: {count} are given before this face"))
}

impl Mesh {
    fn drop_degenerate(&mut self) {
        let kept = (0..self.triangles.len()).filter(|&t| self.face_cross(t).length() > 0.0);
        self.triangles = kept.map(|t| self.triangles[t]).collect();
    }

    /// Means of the normals of the triangles around each vertex, weighted by the angle there (Thürmer and Wüthrich 1998,
    /// "Computing vertex normals from polygonal facets").
    fn smooth_normals(&self) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for t in 0..self.triangles.len() {
            let (corners, face) = (self.corners(t), self.face_cross(t).normalize_or_zero());
            for i in 0..3 {
                let (a, b) = (corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]);
                sums[self.triangles[t][i] as usize] += face * a.angle_between(b);
            }
        }
        // Where opposite triangles cancel out, or none is left, any direction is as good.
        sums.into_iter().map(|sum| sum.try_normalize().unwrap_or(DVec3::Z)).collect()
    }

    fn turn_towards_normals(&mut self) {
        let Some(normals) = &self.normals else { return };
        let against = |t: usize| {
            let mean: DVec3 = self.triangles[t].iter().map(|&i| normals[i as usize]).sum();
            mean.dot(self.face_cross(t)) < 0.0
        };
        let turned: Vec<_> = (0..self.triangles.len()).filter(|&t| against(t)).collect();
        for t in turned {
            self.triangles[t].swap(1, 2);
        }
    }

    /// Exchanges front and back.
    pub(crate) fn flip(&mut self) {
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
        }
        for normal in self.normals.iter_mut().flatten() {
            *normal = -*normal;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\n";

    fn options(to_world: DAffine3, face_normals: bool, flip_normals: bool) -> MeshOptions {
        MeshOptions { to_world, face_normals, flip_normals }
    }

    fn read(text: &str) -> Result<Mesh, SceneError> {
        parse("m.obj", text, &options(DAffine3::IDENTITY, false, false))
    }

    #[test]
    fn smooth_normals_are_those_of_mitsuba() {
        let mesh = read(&format!("{QUAD}f 1 2 3 4")).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        // Printed by Mitsuba 3.9.1 for this file, to six digits.
        let shared = DVec3::new(0.227_046, -0.227_046, 0.947_048);
        let expected = [shared, DVec3::Z, shared, DVec3::new(0.408_248, -0.408_248, 0.816_497)];
        for (normal, expected) in mesh.normals.unwrap().iter().zip(expected) {
            assert!((*normal - expected).abs().max_element() <= 1e-6, "{normal} is not {expected}");
        }
    }

    #[test]
    fn negative_indices_count_back_and_flat_meshes_have_no_normals() {
        let text = format!("{QUAD}vn 0 0 1\nvt 0 0\nf -4/-1/-1 -3/1/1 -2//1");
        let flat = parse("m.obj", &text, &options(DAffine3::from_scale(DVec3::splat(2.0)), true, true)).unwrap();
        assert_eq!(flat.positions, [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(2.0, 2.0, 0.0)]);
        assert_eq!(flat.triangles, [[0, 2, 1]]);
        assert_eq!(flat.normals, None);
    }

    #[test]
    fn normals_decide_the_front_and_follow_the_transform() {
        let text = format!("{QUAD}vn 1 0 2\nf 1//1 3//1 2//1");
        let mesh =
            parse("m.obj", &text, &options(DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.0)), false, false)).unwrap();
        assert_eq!(mesh.triangles, [[0, 2, 1]]);
        let expected = DVec3::new(0.5, 0.0, 2.0).normalize();
        assert!((mesh.normals.unwrap()[0] - expected).length() <= 1e-15);
    }

    #[test]
    fn faults_name_their_line() {
        for (tail, line, part) in [
            ("f 1 2 5", 5, "no vertex 5"),
            ("f 1 2 0", 5, "no vertex 0"),
            ("f 1 2 -5", 5, "no vertex -5"),
            ("f 1 2", 5, "3 or 4 corners, not 2"),
            ("f 1 2 3 4 1", 5, "3 or 4 corners, not 5"),
            ("f 1//1 2//1 3//1", 5, "no normal 1"),
            ("f 1 2 x", 5, "not an index"),
            ("f 1 2 99999999999999999999", 5, "not an index"),
            ("f 1 2 -9223372036854775808", 5, "no vertex"),
            ("f 1/1/1/1 2 3", 5, "not a corner"),
            ("v 1 nan 2", 5, "finite"),
            ("v 1 2", 5, "three numbers"),
            ("curv 1 2", 5, "not supported"),
            ("vn 0 0 0\nf 1//1 2//1 3//1", 6, "length is zero"),
            ("vn 0 0 1\nf 1//1 2//1 3", 6, "some have none"),
            ("f 1 1 2", 5, "no triangle"),
            ("", 4, "no triangle"),
        ] {
            let error = read(&format!("{QUAD}{tail}")).unwrap_err();
            assert_eq!(error.line, line, "{tail}: {error}");
            assert!(error.message.contains(part), "{tail}: {error}");
        }
    }
}
