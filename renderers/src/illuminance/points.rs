//! Files of points: position and normal on each line.

use core::fmt;

use glam::DVec3;

use crate::geometry::MAX_COORDINATE;

/// A place and a direction for which illuminance is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The position, scene units.
    pub position: DVec3,
    /// The normal, of any length but zero.
    pub normal: DVec3,
}

/// Why a file of points was refused: one line, with the line of the file at fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PointsError {
    /// The file's name.
    pub file: String,
    /// The line at fault, from 1; 0 when it is the whole file.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for PointsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.file, self.message),
            line => write!(f, "{}:{line}: {}", self.file, self.message),
        }
    }
}

impl core::error::Error for PointsError {}

/// Reads points: six numbers on a line, x, y, z and the normal's nx, ny, nz, with commas, tabs or spaces between. Lines that are empty
/// or start with `#` are left out, and so is a first line of names. `file` is what errors will name.
///
/// # Errors
/// A line that isn't six finite numbers, a normal without direction, or no points at all.
pub fn parse_points(file: &str, text: &str) -> Result<Vec<Point>, PointsError> {
    let error = |line, message: String| PointsError { file: file.to_owned(), line, message };
    let mut points = Vec::new();
    let mut may_be_names = true;
    for (line, content) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
        let content = content.trim();
        if content.is_empty() || content.starts_with('#') {
            continue;
        }
        let fields = fields(content);
        let is_names = may_be_names && fields.iter().all(|field| is_name(field));
        may_be_names = false;
        if !is_names {
            points.push(point(&fields).map_err(|message| error(line, message))?);
        }
    }
    if points.is_empty() { Err(error(0, "no points in it".to_owned())) } else { Ok(points) }
}

/// What is between commas if there are any, between spaces otherwise.
fn fields(line: &str) -> Vec<&str> {
    if line.contains(',') { line.split(',').map(str::trim).collect() } else { line.split_whitespace().collect() }
}

fn is_name(field: &str) -> bool {
    field.parse::<f64>().is_err() && field.trim_matches('"').starts_with(char::is_alphabetic)
}

fn point(fields: &[&str]) -> Result<Point, String> {
    let [x, y, z, nx, ny, nz] = *fields else {
        return Err(format!("expected six numbers, x, y, z, nx, ny, nz, and not {}", fields.len()));
    };
    let number = |field: &str| match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{field:?} is not a finite number")),
    };
    let position = DVec3::new(number(x)?, number(y)?, number(z)?);
    let normal = DVec3::new(number(nx)?, number(ny)?, number(nz)?);
    if position.abs().max_element() > f64::from(MAX_COORDINATE) {
        return Err(format!("a coordinate is beyond {MAX_COORDINATE:e}"));
    }
    if normal == DVec3::ZERO {
        return Err("the normal is zero".to_owned());
    }
    Ok(Point { position, normal })
}

#[cfg(test)]
mod tests {
    use super::{DVec3, Point, parse_points};

    #[test]
    fn reads_commas_spaces_comments_and_names() {
        let expected = [
            Point { position: DVec3::new(1.0, -2.0, 0.5), normal: DVec3::Z },
            Point { position: DVec3::ZERO, normal: DVec3::new(0.0, -3.0, 0.0) },
        ];
        for text in [
            "1,-2,0.5,0,0,1\n0,0,0,0,-3,0\n",
            "\u{feff}# points\n\nx,y,z,nx,ny,nz\r\n 1 , -2, 5e-1,0,0,+1\r\n0,0,0,0,-3,0",
            "x y z nx ny nz\n1 -2\t.5 0 0 1\n# more\n0 0 0 0 -3 0",
        ] {
            assert_eq!(parse_points("p.csv", text).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (text, said) in [
            ("", "p.csv: no points in it"),
            ("x,y,z,nx,ny,nz\n", "p.csv: no points in it"),
            ("0,0,0,0,0,1\n1e300,0,0,0,0,1\n", "p.csv:2: a coordinate is beyond 1e12"),
            ("0,0,0,0,0,1\n1,2,3\n", "p.csv:2: expected six numbers, x, y, z, nx, ny, nz, and not 3"),
            ("0,0,0,0,0,1,\n", "p.csv:1: expected six numbers, x, y, z, nx, ny, nz, and not 7"),
            ("0,0,0,0,0,1\nx,y,z,nx,ny,nz\n", "p.csv:2: \"x\" is not a finite number"),
            ("0,0,nan,0,0,1\n", "p.csv:1: \"nan\" is not a finite number"),
            ("0,0,inf,0,0,1\n", "p.csv:1: \"inf\" is not a finite number"),
            ("0,0,,0,0,1\n", "p.csv:1: \"\" is not a finite number"),
            ("\n#\n0,0,1,0,0,0\n", "p.csv:3: the normal is zero"),
        ] {
            assert_eq!(parse_points("p.csv", text).unwrap_err().to_string(), said, "{text:?}");
        }
    }
}
