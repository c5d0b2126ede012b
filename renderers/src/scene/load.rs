//! From the XML text to a [`Scene`]: the elements at the top of the file, ids and references.

use std::collections::HashMap;

use super::bsdf::Bsdfs;
use super::props::Props;
use super::sensor;
use super::shape;
use super::source::Source;
use super::spectrum::Spectra;
use super::xml::{Document, Node};
use super::{Camera, Emitter, Film, Integrator, Sampler, Scene, SceneError, Shape, emitter};

/// Reads a scene. `parameters` are names and values for the `$name`s in it; they win over its `<default>`s.
///
/// # Errors
/// Whatever breaks the rules of the [supported subset](super), with the file, line and element at fault.
pub fn load(source: &Source, parameters: &[(String, String)]) -> Result<Scene, SceneError> {
    let file = source.file_name();
    let text = source.read_scene()?;
    let document = Document::parse(&file, &text, parameters)?;
    check_root(document.root())?;
    let ids = Ids::collect(&document)?;
    let mut loader = Loader::new(source, &ids);
    for node in document.root().children() {
        loader.top(node)?;
    }
    loader.finish(source.stem(), document.root())
}

fn check_root(root: Node<'_>) -> Result<(), SceneError> {
    if root.tag() != "scene" {
        return Err(root.error("the outermost element must be <scene>"));
    }
    root.allow_attributes(&["version", "type", "id"])?;
    let version = root.require("version")?;
    let parts: Option<Vec<u32>> = version.split('.').map(|part| part.parse().ok()).collect();
    match parts.as_deref() {
        Some([2 | 3, ..]) => Ok(()),
        Some(_) => Err(root.error(format!("version {version:?} is not supported (supported: 2 and 3)"))),
        None => Err(root.error(format!("{version:?} is not a version, such as \"3.0.0\""))),
    }
}

/// The elements that can be referred to, by their ids.
pub(crate) struct Ids<'a>(HashMap<&'a str, Node<'a>>);

impl<'a> Ids<'a> {
    fn collect(document: &'a Document) -> Result<Self, SceneError> {
        let mut ids = HashMap::new();
        for node in document.nodes().filter(|node| node.tag() != "ref") {
            let Some(id) = node.attribute("id") else { continue };
            if ids.insert(id, node).is_some() {
                return Err(node.error(format!("the id {id:?} is given twice")));
            }
        }
        Ok(Self(ids))
    }

    /// What a `<ref id="…"/>` refers to.
    pub(crate) fn resolve(&self, node: Node<'a>) -> Result<Node<'a>, SceneError> {
        node.allow_attributes(&["id", "name"])?;
        node.no_children()?;
        let id = node.require("id")?;
        self.0.get(id).copied().ok_or_else(|| node.error(format!("nothing has the id {id:?}")))
    }
}

/// The parts of a scene under construction.
pub(crate) struct Loader<'a> {
    pub(crate) source: &'a Source,
    pub(crate) spectra: Spectra<'a>,
    pub(crate) bsdfs: Bsdfs<'a>,
    pub(crate) shapes: Vec<Shape>,
    pub(crate) emitters: Vec<Emitter>,
    integrator: Option<Integrator>,
    view: Option<(Camera, Film, Sampler)>,
}

impl<'a> Loader<'a> {
    fn new(source: &'a Source, ids: &'a Ids<'a>) -> Self {
        Self {
            source,
            spectra: Spectra::new(source, ids),
            bsdfs: Bsdfs::new(ids),
            shapes: Vec::new(),
            emitters: Vec::new(),
            integrator: None,
            view: None,
        }
    }

    /// One child of `<scene>`.
    fn top(&mut self, node: Node<'a>) -> Result<(), SceneError> {
        match node.tag() {
            "integrator" => once(&mut self.integrator, node, sensor::integrator(Props::new(node)?)?),
            "sensor" => once(&mut self.view, node, sensor::sensor(Props::new(node)?)?),
            "bsdf" => self.bsdfs.add(node, &mut self.spectra).map(drop),
            "shape" => shape::add(self, node),
            "emitter" => emitter::add(self, node),
            "spectrum" => self.spectra.check_declaration(node),
            "include" => Err(node.error("included files are not supported: write the elements here")),
            "ref" => Err(node.error("nothing can be referred to directly inside <scene>")),
            _ => Err(node.error(
                "not supported inside <scene> (supported: integrator, sensor, bsdf, shape, emitter, spectrum, default)",
            )),
        }
    }

    fn finish(self, name: String, root: Node<'a>) -> Result<Scene, SceneError> {
        let (camera, film, sampler) = self.view.ok_or_else(|| root.error("the scene has no <sensor>"))?;
        Ok(Scene {
            name,
            integrator: self.integrator.unwrap_or(sensor::DEFAULT_INTEGRATOR),
            camera,
            film,
            sampler,
            shapes: self.shapes,
            bsdfs: self.bsdfs.finish(),
            emitters: self.emitters,
            spectra: self.spectra.finish(),
        })
    }
}

/// For messages: the id or else the type of an element, and its place.
pub(crate) fn label(node: Node<'_>) -> String {
    let name = node.attribute("id").or(node.attribute("type")).unwrap_or_default();
    format!("{name} ({})", node.place())
}

fn once<T>(slot: &mut Option<T>, node: Node<'_>, value: T) -> Result<(), SceneError> {
    match slot.replace(value) {
        Some(_) => Err(node.error(format!("a scene has only one <{}>", node.tag()))),
        None => Ok(()),
    }
}
