//! `spectral gallery`: every built-in scene in all its ways, on one page.

mod job;
mod page;
mod papers;
mod plan;

use core::sync::atomic::{AtomicU64, Ordering};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Args;
use renderers::compare::{CompareOptions, compare};
use renderers::image::write_atomic;
use renderers::progress::Progress;
use renderers::render::Watch;
use renderers::scene::builtin;
use serde_json::{Value, json};

use super::{Answer, Failure};
use job::{Done, Job};
use plan::{ENTRIES, Entry};

/// What `spectral gallery` takes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Built-in scenes; all of them by default.
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Folder for the page and its pictures; made if it isn't there. What is rendered there with the same parameters stays.
    #[arg(long, value_name = "DIR", default_value = "out/gallery")]
    out: PathBuf,
    /// Small pictures, about a minute in all.
    #[arg(long)]
    quick: bool,
    /// Render everything anew.
    #[arg(long)]
    fresh: bool,
}

/// A picture of the page.
pub(super) struct Shown {
    mode: &'static str,
    command: String,
    done: Result<Done, String>,
    /// What `spectral compare --json` says of it and the reference.
    compared: Option<Result<Value, String>>,
}

/// An entry with its pictures.
pub(super) struct Section {
    entry: &'static Entry,
    shown: Vec<Shown>,
    maps: Vec<Mapped>,
}

/// Maps that were made together.
pub(super) struct Mapped {
    command: String,
    /// Where they are, within the gallery.
    folder: String,
    done: Result<Done, String>,
}

/// Steps of the progress bar for each picture.
const STEPS: u64 = 1000;

impl Arguments {
    pub(super) fn run(self) -> Result<(Answer, ExitCode), Failure> {
        let start = Instant::now();
        let entries = chosen(&self.names)?;
        let figures = papers::figures().map_err(Failure)?;
        std::fs::create_dir_all(&self.out).map_err(|e| Failure(format!("{}: {e}", self.out.display())))?;
        let pictures: usize = entries.iter().map(|entry| entry.modes.len() + entry.maps.len()).sum();
        let bar = Progress::new("gallery", pictures as u64 * STEPS);
        let sections: Vec<_> = entries.into_iter().map(|entry| self.section(entry, &bar)).collect();
        drop(bar);
        let text = page::html(&sections, &figures, self.quick);
        let page = self.out.join("index.html");
        write_atomic(&page, |file| file.write_all(text.as_bytes()))?;
        let answer = summary(&sections, &page, start.elapsed().as_secs_f64());
        let failed = sections.iter().any(|section| section.errors().next().is_some());
        Ok((answer, if failed { ExitCode::from(1) } else { ExitCode::SUCCESS }))
    }

    /// Renders an entry in all its modes, then compares them with the reference.
    fn section(&self, entry: &'static Entry, bar: &Progress) -> Section {
        let quality = if self.quick { job::QUICK } else { job::FULL };
        let render = |mode| {
            let job = Job::new(entry, mode, quality, &self.out);
            let share = Share::new(bar);
            bar.note(&format!("{} {}", entry.name, mode.name));
            let done = job.run(self.fresh, &share).map_err(|Failure(line)| line);
            share.finish();
            Shown { mode: mode.name, command: job.command(), done, compared: None }
        };
        let mut shown: Vec<_> = entry.modes.iter().map(render).collect();
        let picture = |shown: &Shown| {
            let file = shown.done.as_ref().ok()?.file(".exr")?.to_owned();
            Some(self.out.join(entry.name).join(shown.mode).join(file))
        };
        let reference = shown.iter().find(|shown| shown.mode == entry.reference).and_then(picture);
        for shown in shown.iter_mut().filter(|shown| shown.mode != entry.reference) {
            if let (Some(reference), Some(picture)) = (&reference, picture(shown)) {
                shown.compared = Some(self.compare(entry, shown.mode, [&picture, reference]));
            }
        }
        let map = |options: &&str| {
            let job = Job::map(entry, options, quality, &self.out);
            let share = Share::new(bar);
            let done = job.run(self.fresh, &share).map_err(|Failure(line)| line);
            share.finish();
            Mapped { command: job.command(), folder: job.folder(&self.out), done }
        };
        Section { entry, shown, maps: entry.maps.iter().map(map).collect() }
    }

    fn compare(&self, entry: &Entry, mode: &str, [picture, reference]: [&Path; 2]) -> Result<Value, String> {
        let options = CompareOptions { exposure: entry.exposure, ..CompareOptions::default() };
        let folder = self.out.join(entry.name).join(mode).join("compared");
        let found = compare(picture, reference, &folder, &options).map_err(|e| e.to_string())?;
        serde_json::to_value(found).map_err(|e| e.to_string())
    }
}

/// The entries of the scenes that are asked for.
fn chosen(names: &[String]) -> Result<Vec<&'static Entry>, Failure> {
    let is_known = |name: &str| ENTRIES.iter().any(|entry| entry.scene == name);
    if let Some(unknown) = names.iter().find(|name| !is_known(name)) {
        let known: Vec<_> = builtin::names().collect();
        return Err(Failure(format!("no built-in scene is called {unknown:?} (built-in: {})", known.join(", "))));
    }
    let is_asked_for = |entry: &&Entry| names.is_empty() || names.iter().any(|name| name == entry.scene);
    Ok(ENTRIES.iter().filter(is_asked_for).collect())
}

impl Section {
    /// What failed, by mode.
    fn errors(&self) -> impl Iterator<Item = (&str, &str)> {
        let of_modes = self.shown.iter().filter_map(|shown| Some((shown.mode, shown.error()?)));
        let of_maps = self.maps.iter().filter_map(|maps| Some((plan::MAPS, maps.done.as_ref().err()?.as_str())));
        of_modes.chain(of_maps)
    }

    /// Everything that was made.
    fn done(&self) -> impl Iterator<Item = &Done> {
        let of_modes = self.shown.iter().filter_map(|shown| shown.done.as_ref().ok());
        of_modes.chain(self.maps.iter().filter_map(|maps| maps.done.as_ref().ok()))
    }
}

impl Shown {
    /// Why it isn't there, or isn't compared.
    fn error(&self) -> Option<&str> {
        let compared = self.compared.as_ref().and_then(|compared| compared.as_ref().err());
        self.done.as_ref().err().or(compared).map(String::as_str)
    }
}

fn summary(sections: &[Section], page: &Path, seconds: f64) -> Answer {
    let of_section = |section: &Section| {
        let name = section.entry.name.to_owned();
        section.errors().map(|(mode, error)| (name.clone(), mode.to_owned(), error.to_owned())).collect::<Vec<_>>()
    };
    let failed: Vec<_> = sections.iter().flat_map(of_section).collect();
    let found = sections.iter().flat_map(Section::done).filter(|done| done.found).count();
    let rendered = sections.iter().flat_map(Section::done).filter(|done| !done.found).count();
    let mut text = format!("{rendered} pictures rendered, {found} found, {seconds:.1} s\n");
    for (name, mode, error) in &failed {
        text += &format!("failed: {name} {mode}: {error}\n");
    }
    text += &page.display().to_string();
    let failed: Vec<_> =
        failed.iter().map(|(name, mode, error)| json!({ "scene": name, "mode": mode, "error": error })).collect();
    let json = json!({ "page": page, "rendered": rendered, "found": found, "failed": failed, "seconds": seconds });
    Answer { text, json }
}

/// A picture's part of the progress bar.
struct Share<'b> {
    bar: &'b Progress,
    steps: AtomicU64,
    done: AtomicU64,
    told: AtomicU64,
}

impl<'b> Share<'b> {
    fn new(bar: &'b Progress) -> Self {
        let zero = || AtomicU64::new(0);
        Self { bar, steps: zero(), done: zero(), told: zero() }
    }

    fn tell(&self, now: u64) {
        let before = self.told.fetch_max(now, Ordering::Relaxed);
        self.bar.add(now.saturating_sub(before));
    }

    fn finish(&self) {
        self.tell(STEPS);
    }
}

impl Watch for Share<'_> {
    fn stage(&self, _: &str, steps: u64) {
        self.steps.store(steps, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
    }

    fn add(&self, steps: u64) {
        let done = self.done.fetch_add(steps, Ordering::Relaxed) + steps;
        self.tell((STEPS * done / self.steps.load(Ordering::Relaxed).max(1)).min(STEPS));
    }
}
