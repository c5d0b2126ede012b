//! Cases as files for other programs.

use core::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::case::{Case, Work};
use super::radiance::spaced;
use super::{mitsuba, radiance};
use crate::image::{ImageError, write_atomic};

/// A file that could not be written.
#[derive(Debug)]
pub struct ExportError {
    path: PathBuf,
    error: std::io::Error,
}

impl core::fmt::Display for ExportError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.error)
    }
}

impl core::error::Error for ExportError {}

/// Writes each case that is a scene into its own folder below `folder`: `scene.xml` and `places.txt` for Mitsuba 3,
/// `scene.rad` and `points.txt` for Radiance, as far as each can say it; besides, `points.csv` with all points and
/// `README.md` with the commands. Returns the files.
///
/// # Errors
/// [`ExportError`] for the first file or folder that can't be written.
pub fn export(cases: &[Case], folder: &Path) -> Result<Vec<PathBuf>, ExportError> {
    let mut files = Vec::new();
    let mut all_points = String::from("case,point,x,y,z,nx,ny,nz\n");
    let mut list = String::new();
    for case in cases.iter().filter(|case| case.work.is_scene()) {
        let own = folder.join(&case.name);
        let depth = if case.work == Work::Direct { 2 } else { -1 };
        let Some(first) = case.points.first() else { continue };
        let xml = mitsuba::plain_scene(&case.model, first, &case.about, depth);
        let places = xml.as_ref().map(|_| case.points.iter().map(|point| mitsuba::place(point) + "\n").collect());
        let rad = radiance::scene(&case.model, &case.about);
        let said = match (&xml, &rad) {
            (Some(_), Some(_)) => "",
            (Some(_), None) => " (Mitsuba only: surfaces that shine and reflect)",
            _ => " (points only: needs photometric files)",
        };
        let kind = if case.work == Work::Direct { "direct light" } else { "all reflections" };
        let _ = writeln!(list, "- `{}`: {} {} points, {kind}{said}.", case.name, case.about, case.points.len());
        for (name, text) in
            [("scene.xml", xml), ("places.txt", places), ("scene.rad", rad), ("points.txt", Some(points(case)))]
        {
            if let Some(text) = text {
                files.push(write(&own.join(name), &text)?);
            }
        }
        for point in &case.points {
            let place = spaced(point.position).replace(' ', ",");
            let normal = spaced(point.normal).replace(' ', ",");
            let _ = writeln!(all_points, "{},{},{place},{normal}", case.name, point.name);
        }
    }
    files.push(write(&folder.join("points.csv"), &all_points)?);
    files.push(write(&folder.join("README.md"), &format!("{README}{list}"))?);
    Ok(files)
}

fn points(case: &Case) -> String {
    let line = |point: &super::SensorPoint| format!("{} {}\n", spaced(point.position), spaced(point.normal));
    case.points.iter().map(line).collect()
}

fn write(path: &Path, text: &str) -> Result<PathBuf, ExportError> {
    let refuse = |error| ExportError { path: path.to_owned(), error };
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent).map_err(refuse)?;
    }
    write_atomic(path, |file| file.write_all(text.as_bytes())).map_err(|error| match error {
        ImageError::Io { source, .. } => refuse(source),
        other => refuse(std::io::Error::other(other.to_string())),
    })?;
    Ok(path.to_owned())
}

const README: &str = "\
# Test cases for illuminance

Each folder is a case: `scene.xml` and `places.txt` (Mitsuba 3; the frame of a point on each line), `scene.rad` and `points.txt`
(Radiance; x y z nx ny nz on each line). `points.csv` names all points. Lengths are in metres. Lights are
grey and their numbers photometric: a radiance of 1 stands for 1 cd/m², so that the irradiance a program gives is
illuminance in lx.

Write the illuminance at each point (direct and reflected light together) into a file of lines `case,point,value`, such as
`cie-171.5.6.1,A,19.66`, and have it judged by

    spectral verify --score RESULTS.csv

Points that are left out are skipped, never passed; with names of cases before `--score` only those are judged.

## Radiance

    oconv CASE/scene.rad > CASE/scene.oct
    rtrace -I -h -ab 0 -dt 0 -dj 0 -ds 0.02 CASE/scene.oct < CASE/points.txt                          # direct light
    rtrace -I -h -ab 1 -aa 0 -ad 100000 -lw 0 -lr 1 CASE/scene.oct < CASE/points.txt                  # cie-171.5.6, 5.7
    rtrace -I -h -ab 400 -aa 0 -ad 8 -lw 1e-3 -lr -400 -dt 0 CASE/scene.oct < CASE/points.txt         # cie-171.5.8, 4.x

The three numbers of a line are equal; no factor of 179 belongs to them. A point light is a sphere of 1 cm radius, parallel
light a source of 1 degree. Under area lights give each point a run of its own: in Radiance 6.0a a receiver whose horizon cuts
a disk light makes that light vanish for later points. `tests/peers/verify_radiance.py` of the project does all this.

## Mitsuba 3

    import math, mitsuba as mi, numpy as np
    mi.set_variant('scalar_rgb')
    for place in open('CASE/places.txt'):
        scene = mi.load_file('CASE/scene.xml', place=place.strip(), spp=4096)
        print(math.pi * np.array(mi.render(scene)).mean())

A radiance meter looks at a small white patch, hence the factor. In spectral variants a flat radiance of 1 has a luminance of 1.001 (the
sum of its tables over the constant by which it divides), which is to be divided out. `tests/peers/verify_mitsuba.py` of
the project does all this.

## Cases

";
