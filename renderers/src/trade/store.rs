//! What has been measured already, kept so that an interrupted account goes on.
//!
//! Each task has a file with the runs of all its settings, round by round, and with a key: the program and what the
//! task was asked for. A file with another key counts as none.

use alloc::collections::BTreeMap;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::TradeError;
use super::plan::Run;
use crate::image::write_atomic;

/// One run: seconds, operations, error, largest error.
type Kept = [f64; 4];

/// The runs of one task.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    key: String,
    /// For each setting, its runs.
    runs: BTreeMap<String, Vec<Kept>>,
    /// Settings in order, with their method and whether it is the project's own.
    settings: Vec<(String, String, bool)>,
    /// Rounds that are complete.
    pub(super) rounds: usize,
}

impl Record {
    /// A record without runs.
    pub(super) fn new(key: &str, settings: Vec<(String, String, bool)>) -> Self {
        Self { key: key.to_owned(), settings, ..Self::default() }
    }

    pub(super) fn settings(&self) -> &[(String, String, bool)] {
        &self.settings
    }

    /// Adds a complete round.
    pub(super) fn add(&mut self, round: Vec<(String, Run)>) {
        for (name, run) in round {
            let kept = [run.seconds, run.operations, run.error, run.worst].map(storable);
            self.runs.entry(name).or_default().push(kept);
        }
        self.rounds += 1;
    }

    /// The runs of a setting.
    pub(super) fn runs(&self, setting: &str) -> Vec<Run> {
        let runs = self.runs.get(setting).map_or(&[][..], Vec::as_slice);
        runs.iter().map(|&[seconds, operations, error, worst]| Run { seconds, operations, error, worst }).collect()
    }
}

/// JSON has neither NaN nor ∞: the largest number stands for both.
fn storable(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::MAX }
}

/// The folder of an account.
#[derive(Clone, Debug)]
pub(super) struct Store {
    folder: PathBuf,
    program: String,
}

impl Store {
    /// Opens the folder, made if need be; `fresh` forgets all runs.
    pub(super) fn open(folder: &Path, fresh: bool) -> Result<Self, TradeError> {
        let runs = folder.join("runs");
        if fresh && runs.is_dir() {
            fs::remove_dir_all(&runs).map_err(|e| TradeError::io(&runs, &e))?;
        }
        fs::create_dir_all(&runs).map_err(|e| TradeError::io(&runs, &e))?;
        Ok(Self { folder: folder.to_owned(), program: program() })
    }

    /// The folder.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// What tells runs of one program and task apart from others.
    pub(super) fn key(&self, task: &str) -> String {
        format!("{}; {task}", self.program)
    }

    /// The program that measures.
    pub(super) fn program(&self) -> &str {
        &self.program
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join("runs").join(format!("{name}.json"))
    }

    /// What is kept under a name, if it has this key.
    pub(super) fn load<T: serde::de::DeserializeOwned + Keyed>(&self, name: &str, key: &str) -> Option<T> {
        let text = fs::read(self.path(name)).ok()?;
        serde_json::from_slice(&text).ok().filter(|kept: &T| kept.key() == key)
    }

    /// Keeps something under a name.
    pub(super) fn save<T: Serialize>(&self, name: &str, what: &T) -> Result<(), TradeError> {
        self.write(&self.path(name), |file| serde_json::to_writer(file, what).map_err(io::Error::other))
    }

    /// Writes a file as a whole or not at all.
    pub(super) fn write(
        &self,
        path: &Path,
        write: impl FnOnce(&mut io::BufWriter<fs::File>) -> io::Result<()>,
    ) -> Result<(), TradeError> {
        write_atomic(path, write).map_err(|e| TradeError::new(e.to_string()))
    }

    /// Writes a text into the folder and returns where it is.
    pub(super) fn write_text(&self, name: &str, text: &str) -> Result<PathBuf, TradeError> {
        let path = self.folder.join(name);
        self.write(&path, |file| file.write_all(text.as_bytes()))?;
        Ok(path)
    }
}

/// What is kept with a key.
pub(super) trait Keyed {
    /// The key.
    fn key(&self) -> &str;
}

impl Keyed for Record {
    fn key(&self) -> &str {
        &self.key
    }
}

/// The program's version, and a hash of its file: another build measures anew.
fn program() -> String {
    let bytes = std::env::current_exe().and_then(fs::read).unwrap_or_default();
    // FNV-1a over words of eight bytes.
    let hash = bytes.chunks(8).fold(0xcbf2_9ce4_8422_2325_u64, |hash, chunk| {
        let mut word = [0; 8];
        word.iter_mut().zip(chunk).for_each(|(w, b)| *w = *b);
        (hash ^ u64::from_le_bytes(word)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("spectral {} ({hash:016x})", env!("CARGO_PKG_VERSION"))
}
