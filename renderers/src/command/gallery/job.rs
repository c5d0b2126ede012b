//! One picture of the gallery: rendered, or found as it was left by an earlier run.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Parser;
use renderers::image::write_atomic;
use renderers::render::Watch;
use serde_json::{Value, json};

use super::plan::{Entry, MAPS, Mode};
use crate::command::{Failure, render, run_line};

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
    /// The command of this program, `render` or `map`.
    command: &'static str,
    /// What it is called with, but for the folder.
    arguments: Vec<String>,
    /// Where its files go.
    folder: PathBuf,
    /// The program and the scene that it was rendered with: pictures of others don't count.
    made_of: String,
}

/// A picture that is there.
#[derive(Debug)]
pub(super) struct Done {
    /// What `spectral render --json`, or `spectral map --json`, says.
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
        Self { command: "render", arguments, folder: out.join(entry.name).join(mode.name), made_of: made_of(entry) }
    }

    /// The maps with these options.
    pub(super) fn map(entry: &Entry, options: &str, quality: Quality, out: &Path) -> Self {
        let mut arguments = vec![entry.scene.to_owned()];
        arguments.extend(options.split_whitespace().map(str::to_owned));
        arguments.extend(entry.options.iter().map(|option| (*option).to_owned()));
        arguments.push(format!("--size={0}x{0}", quality.side));
        let folder = out.join(entry.name).join(MAPS).join(options.replace("--", "").replace([' ', ','], "-"));
        Self { command: "map", arguments, folder, made_of: made_of(entry) }
    }

    /// Its folder, within that of the gallery.
    pub(super) fn folder(&self, out: &Path) -> String {
        self.folder.strip_prefix(out).unwrap_or(&self.folder).to_string_lossy().replace('\\', "/")
    }

    /// The command that renders the same picture.
    pub(super) fn command(&self) -> String {
        let quoted =
            |argument: &String| if argument.contains(' ') { format!("\"{argument}\"") } else { argument.clone() };
        format!("spectral {} {}", self.command, self.arguments.iter().map(quoted).collect::<Vec<_>>().join(" "))
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
        let arguments = self.arguments.iter().chain([&out]);
        let mut render = if self.command == "render" {
            Line::try_parse_from(arguments)?.render.run_watched(watch)?.json
        } else {
            run_line(core::iter::once(self.command).chain(arguments.map(String::as_str)))?.json
        };
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

/// The program and the scene.
fn made_of(entry: &Entry) -> String {
    let scene = renderers::scene::builtin::source(entry.scene).map(|source| format!("{source:?}"));
    format!("{} {:016x}", env!("CARGO_PKG_VERSION"), hash(&scene.unwrap_or_default()))
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

    /// All files whose names end so.
    pub(super) fn files<'d>(&'d self, end: &'d str) -> impl Iterator<Item = &'d str> {
        let files = self.render["files"].as_array().into_iter().flatten().filter_map(Value::as_str);
        files.filter(move |file| file.ends_with(end))
    }
}
