//! The scenes that come with the program: Mitsuba XML, meshes and spectra, compiled in.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::{Scene, SceneError, Source, load as load_source};

/// Names and texts of files in `renderers/scenes`.
macro_rules! embedded {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../scenes/", $name)))),*]
    };
}

const SCENES: &[(&str, &str)] = embedded![
    "cornell-box.xml",
    "cornell-box-sodium.xml",
    "cornell-box-lamp.xml",
    "cornell-box-spheres.xml",
    "cornell-box-paper.xml",
    "grazing.xml",
    "cie-171-5-8.xml",
    "furnace.xml",
    "lounge.xml",
    "cri-room.xml",
    "neumann-schanda.xml",
    "caustic-ring.xml",
    "caustic-ring-mirror.xml",
    "prism.xml",
    "prism-lamp.xml",
    "cornell-box-glass.xml",
    "fluorescent-spheres.xml",
    "seminar-room.xml",
    "office.xml",
];

const ASSETS: &[(&str, &str)] = embedded![
    "luminaires/specular_louver.ies",
    "meshes/back_wall.obj",
    "meshes/ceiling.obj",
    "meshes/cube_ceiling.obj",
    "meshes/floor.obj",
    "meshes/left_wall.obj",
    "meshes/light_tube.obj",
    "meshes/lounge_back_wall.obj",
    "meshes/lounge_floor.obj",
    "meshes/lounge_lamp.obj",
    "meshes/lounge_painting_left.obj",
    "meshes/lounge_painting_middle.obj",
    "meshes/lounge_painting_right.obj",
    "meshes/lounge_sofa.obj",
    "meshes/lounge_table.obj",
    "meshes/prism.obj",
    "meshes/right_wall.obj",
    "meshes/ring.obj",
    "meshes/short_block.obj",
    "meshes/tall_block.obj",
    "spectra/colorchecker_black_2.spd",
    "spectra/colorchecker_blue.spd",
    "spectra/colorchecker_blue_flower.spd",
    "spectra/colorchecker_dark_skin.spd",
    "spectra/colorchecker_foliage.spd",
    "spectra/colorchecker_green.spd",
    "spectra/colorchecker_light_skin.spd",
    "spectra/colorchecker_magenta.spd",
    "spectra/colorchecker_neutral_6_5.spd",
    "spectra/colorchecker_neutral_8.spd",
    "spectra/colorchecker_orange.spd",
    "spectra/colorchecker_orange_yellow.spd",
    "spectra/colorchecker_purplish_blue.spd",
    "spectra/colorchecker_red.spd",
    "spectra/colorchecker_white_9_5.spd",
    "spectra/colorchecker_yellow.spd",
    "spectra/colorchecker_yellow_green.spd",
    "spectra/cornell_green.spd",
    "spectra/cornell_lamp.spd",
    "spectra/cornell_red.spd",
    "spectra/cornell_white.spd",
    "spectra/lamp_fl2.spd",
    "spectra/lamp_fl3_11.spd",
    "spectra/lamp_fl3_14.spd",
    "spectra/lamp_fl3_15.spd",
    "spectra/lamp_fl7.spd",
    "spectra/lamp_led_b5.spd",
    "spectra/lamp_led_v2.spd",
    "spectra/linoleum_moderate_red.spd",
    "spectra/linoleum_red.spd",
    "spectra/plaster_white.spd",
    "spectra/sodium_low_pressure.spd",
];

/// The name of the scene that is rendered if none is given.
pub const DEFAULT: &str = "cornell-box";

/// Names of the built-in scenes, the default first.
pub fn names() -> impl Iterator<Item = &'static str> {
    SCENES.iter().map(|(file, _)| file.trim_end_matches(".xml"))
}

/// The text of a built-in scene; `None` if no scene has this name.
#[must_use]
pub fn xml(name: &str) -> Option<&'static str> {
    find(name).map(|(_, xml)| xml)
}

/// The text of a built-in scene with the files that it names; `None` if no scene has this name.
#[must_use]
pub fn source(name: &str) -> Option<Source> {
    let (file, xml) = find(name)?;
    Some(assets(xml).fold(Source::text(file, xml), |source, (asset, text)| source.with_asset(asset, text)))
}

/// Reads a built-in scene; `parameters` as in [`load`](super::load). All of them take `resolution` and `spp`; the comment at the
/// head of each says what else it takes, where it comes from, and what of it was chosen.
///
/// # Errors
/// An unknown name, or parameters that the scene refuses.
pub fn load(name: &str, parameters: &[(String, String)]) -> Result<Scene, SceneError> {
    load_source(&source(name).ok_or_else(|| unknown(name))?, parameters)
}

/// Writes a built-in scene and the files that it names into a folder, made if need be, and returns what was written, the
/// scene first. Mitsuba 3 opens all but `cornell-box-spheres`, `cornell-box-paper`, `cri-room`, `caustic-ring`, `prism`,
/// `prism-lamp`, `fluorescent-spheres`, `seminar-room` and `office`, which use extensions.
///
/// # Errors
/// An unknown name, or the file that can't be written.
pub fn export(name: &str, folder: &Path) -> Result<Vec<PathBuf>, SceneError> {
    let (file, xml) = find(name).ok_or_else(|| unknown(name))?;
    core::iter::once((file, xml))
        .chain(assets(xml))
        .map(|(file, text)| {
            let path = folder.join(file);
            write(&path, text).map_err(|e| {
                SceneError::new(&path.display().to_string(), (0, 0), "", format!("cannot write the file: {e}"))
            })?;
            Ok(path)
        })
        .collect()
}

fn find(name: &str) -> Option<(&'static str, &'static str)> {
    SCENES.iter().copied().find(|(file, _)| file.strip_suffix(".xml") == Some(name))
}

/// The files that a scene names; where a name holds a parameter, all that it can stand for.
fn assets(xml: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    ASSETS.iter().copied().filter(move |(name, _)| xml.split('"').any(|quoted| stands_for(quoted, name)))
}

/// Whether a name as a scene writes it, which may end in a parameter and an extension such as `lamp_$lamp.spd`, can be this file.
fn stands_for(written: &str, file: &str) -> bool {
    let Some((before, parameter)) = written.split_once('$') else { return written == file };
    let after = parameter.find('.').map_or("", |dot| &parameter[dot..]);
    !before.is_empty() && file.starts_with(before) && file.ends_with(after)
}

fn write(path: &Path, text: &str) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(path, text)
}

fn unknown(name: &str) -> SceneError {
    let known: Vec<_> = names().collect();
    let message = format!("no built-in scene has this name (built-in: {})", known.join(", "));
    SceneError::new(name, (0, 0), "", message)
}
