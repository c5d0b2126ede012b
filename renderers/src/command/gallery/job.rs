//! One picture of the gallery: rendered, or found as it was left by an earlier run.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Parser;
use renderers::image::write_atomic;
use renderers::render::Watch;
use serde_json::{Value, json};

use super::plan::{Entry, Mode};
use crate::command::{Failure, render};

/// How large pictures are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quality {
    pub(super) side: u32,
    pub(super) samples: u32,
    /// What numbers of photons are divided by.
    pub(super) photons: u32,
}

pub(super) const FULL: Quality = Quality { side: 256, samples: 4, photons: 1 };
pub(super) const QUICK: Quality = Quality { side: 64, samples: 1, photons: 16 };

/// `spectral render`, with what it takes.
#[derive(Debug, Parser)]
#[command(name = "spectral render", no_binary_name = true)]
struct Line {
    #[command(flatten)]
    render: render::Arguments,
}

/// A picture to be rendered.
#[derive(Debug)]
pub(super) struct Job {
    /// What `spectral render` is called with, but for the folder.
    pub(super) arguments: Vec<String>,
    /// Where its files go.
    folder: PathBuf,
    /// The program and the scene that it was rendered with: pictures of others don't count.
    made_of: String,
}

/// A picture that is there.
#[derive(Debug)]
pub(super) struct Done {
    /// What `spectral render --json` says.
    pub(super) render: Value,
    /// Whether it was there already.
    pub(super) found: bool,
}

const RECORD: &str = "record.json";

impl Job {
    pub(super) fn new(entry: &Entry, mode: &Mode, quality: Quality, out: &Path) -> Self {
        let Quality { side, samples, photons } = quality;
        let mut arguments = vec![entry.scene.to_owned()];
        arguments.extend(mode.options.split_whitespace().map(str::to_owned));
        arguments.extend(entry.options.iter().map(|option| (*option).to_owned()));
        arguments.extend(entry.photons.map(|count| format!("--photons={}", (count / photons).max(1))));
        arguments.extend([format!("--size={side}x{side}"), format!("--spp={samples}")]);
        if (entry.exposure - 1.0).abs() > 0.0 {
            arguments.push(format!("--exposure={}", entry.exposure));
        }
        let scene = renderers::scene::builtin::source(entry.scene).map(|source| format!("{source:?}"));
        let made_of = format!("{} {:016x}", env!("CARGO_PKG_VERSION"), hash(&scene.unwrap_or_default()));
        Self { arguments, folder: out.join(entry.name).join(mode.name), made_of }
    }

    /// The command that renders the same picture.
    pub(super) fn command(&self) -> String {
        let quoted =
            |argument: &String| if argument.contains(' ') { format!("\"{argument}\"") } else { argument.clone() };
        format!("spectral render {}", self.arguments.iter().map(quoted).collect::<Vec<_>>().join(" "))
    }

    /// The picture as an earlier run has left it, if that was the same one and its files are there.
    fn found(&self) -> Option<Value> {
        let record: Value = serde_json::from_slice(&fs::read(self.folder.join(RECORD)).ok()?).ok()?;
        let files = record["render"]["files"].as_array()?;
        let is_same = record["arguments"] == json!(self.arguments) && record["made_of"] == json!(self.made_of);
        let is_there = |file: &Value| file.as_str().is_some_and(|file| self.folder.join(file).is_file());
        (is_same && files.iter().all(is_there)).then(|| record["render"].clone())
    }

    /// Renders the picture, unless it is there.
    pub(super) fn run(&self, fresh: bool, watch: &dyn Watch) -> Result<Done, Failure> {
        if let Some(render) = self.found().filter(|_| !fresh) {
            return Ok(Done { render, found: true });
        }
        let out = format!("--out={}", self.folder.display());
        let line = Line::try_parse_from(self.arguments.iter().chain([&out]))?;
        let mut render = line.render.run_watched(watch)?.json;
        // Files by their names, so that the folder can be moved.
        let names = |files: &Vec<Value>| files.iter().filter_map(name).map(Value::from).collect::<Value>();
        render["files"] = render["files"].as_array().map(names).unwrap_or_default();
        let record = json!({ "arguments": self.arguments, "made_of": self.made_of, "render": render });
        write_atomic(&self.folder.join(RECORD), |file| writeln!(file, "{record:#}"))?;
        Ok(Done { render, found: false })
    }
}

fn name(file: &Value) -> Option<&str> {
    Path::new(file.as_str()?).file_name()?.to_str()
}

/// FNV-1a of 64 bits (G. Fowler, L. C. Noll, K.-P. Vo).
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

impl Done {
    /// The file whose name ends so; that of the picture itself has the shortest name of its kind.
    pub(super) fn file(&self, end: &str) -> Option<&str> {
        let files = self.render["files"].as_array()?.iter().filter_map(Value::as_str);
        files.filter(|file| file.ends_with(end)).min_by_key(|file| file.len())
    }
}
