//! Where a scene's files come from: a folder on disk, or texts in memory (the built-in scenes).

use std::path::{Path, PathBuf};

use super::SceneError;

/// A scene file together with the place where the files that it names are looked up.
#[derive(Debug, Clone)]
pub enum Source {
    /// An XML file on disk; what it names is looked up relative to its folder.
    Disk(PathBuf),
    /// An XML text in memory; what it names is looked up in a list by its exact name.
    Memory {
        /// File name for messages, such as `cornell-box.xml`.
        name: String,
        /// The XML text.
        xml: String,
        /// Names, as the scene writes them, and texts of spectra and meshes.
        assets: Vec<(String, String)>,
    },
}

impl Source {
    /// A scene file on disk.
    #[must_use]
    pub fn disk(path: impl Into<PathBuf>) -> Self {
        Self::Disk(path.into())
    }

    /// A scene text in memory with no files beside it.
    #[must_use]
    pub fn text(name: impl Into<String>, xml: impl Into<String>) -> Self {
        Self::Memory { name: name.into(), xml: xml.into(), assets: Vec::new() }
    }

    /// The same with one more file, if this is a scene in memory; a scene on disk stays as it is.
    #[must_use]
    pub fn with_asset(mut self, name: impl Into<String>, text: impl Into<String>) -> Self {
        if let Self::Memory { assets, .. } = &mut self {
            assets.push((name.into(), text.into()));
        }
        self
    }

    /// The scene file's name for messages.
    #[must_use]
    pub fn file_name(&self) -> String {
        match self {
            Self::Disk(path) => path.display().to_string(),
            Self::Memory { name, .. } => name.clone(),
        }
    }

    /// The scene file's name without folder and extension.
    pub(crate) fn stem(&self) -> String {
        let name = self.file_name();
        Path::new(&name).file_stem().map_or_else(|| name.clone(), |stem| stem.to_string_lossy().into_owned())
    }

    /// The XML text.
    pub(crate) fn read_scene(&self) -> Result<String, SceneError> {
        let path = match self {
            Self::Memory { xml, .. } => return Ok(xml.clone()),
            Self::Disk(path) => path,
        };
        let refuse = |message: String| SceneError::new(&self.file_name(), (0, 0), "", message);
        let bytes = std::fs::read(path).map_err(|e| refuse(format!("cannot read the scene: {e}")))?;
        String::from_utf8(bytes).map_err(|_| refuse("the scene is not UTF-8 text".into()))
    }

    /// The text of a file that the scene names, and that file's name for messages; else why it can't be read.
    ///
    /// Bytes that are not UTF-8 (in comments, most often) are replaced: spectra and meshes need ASCII only.
    pub(crate) fn read_asset(&self, name: &str) -> Result<(String, String), String> {
        match self {
            Self::Disk(scene) => {
                let path = scene.parent().unwrap_or_else(|| Path::new("")).join(name);
                let bytes = std::fs::read(&path).map_err(|e| format!("cannot read {name:?}: {e}"))?;
                Ok((path.display().to_string(), String::from_utf8_lossy(&bytes).into_owned()))
            }
            Self::Memory { assets, .. } => assets
                .iter()
                .find(|(asset, _)| asset == name)
                .cloned()
                .ok_or_else(|| format!("cannot read {name:?}: no such file beside this built-in scene")),
        }
    }
}
