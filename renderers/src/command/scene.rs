//! `spectral scene`: the built-in scenes.

use std::path::PathBuf;

use clap::Args;
use renderers::scene::builtin;

use super::{Answer, Failure};

/// What `spectral scene` takes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A built-in scene; without one, their names are listed.
    name: Option<String>,
    /// Write the scene's XML, meshes and spectra into this folder.
    #[arg(long, value_name = "DIR", requires = "name")]
    export: Option<PathBuf>,
}

impl Arguments {
    pub(super) fn run(self) -> Result<Answer, Failure> {
        let Some(name) = self.name else {
            let names: Vec<_> = builtin::names().collect();
            return Ok(Answer { text: names.join("\n"), json: serde_json::json!({ "scenes": names }) });
        };
        let Some(folder) = self.export else {
            let scene = builtin::load(&name, &[])?;
            let (shapes, lights) = (scene.shapes.len(), scene.emitters.len());
            let [width, height] = [scene.film.width, scene.film.height];
            return Ok(Answer {
                text: format!("{name}: {shapes} shapes, {lights} lights, {width} × {height} pixels"),
                json: serde_json::json!({ "name": name, "shapes": shapes, "lights": lights, "width": width, "height": height }),
            });
        };
        let files = builtin::export(&name, &folder)?;
        let names: Vec<_> = files.iter().map(|f| f.display().to_string()).collect();
        Ok(Answer { text: names.join("\n"), json: serde_json::json!({ "files": names }) })
    }
}
