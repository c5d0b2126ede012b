//! What is to be measured: tasks, and the settings of methods that do them.

use core::hint::black_box;
use std::time::Instant;

/// One run of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    /// What it took.
    pub(super) seconds: f64,
    /// Counted work.
    pub(super) operations: f64,
    /// The error over all items.
    pub(super) error: f64,
    /// The largest error of an item.
    pub(super) worst: f64,
}

/// Runs a setting in a round; methods at random take other random numbers in every round.
pub(super) type Runner = Box<dyn FnMut(u64) -> Result<Run, String>>;

/// A setting of a method.
pub(super) struct Setting {
    pub(super) name: String,
    pub(super) method: &'static str,
    pub(super) own: bool,
    pub(super) run: Runner,
}

impl Setting {
    pub(super) fn new(
        name: impl Into<String>,
        method: &'static str,
        own: bool,
        run: impl FnMut(u64) -> Result<Run, String> + 'static,
    ) -> Self {
        Self { name: name.into(), method, own, run: Box::new(run) }
    }
}

/// Makes the settings of a task, truth included; called when the task's turn comes.
pub(super) type Builder = Box<dyn FnOnce() -> Result<Vec<Setting>, String>>;

/// A task with all settings that are to do it.
pub(super) struct Plan {
    pub(super) name: &'static str,
    pub(super) title: String,
    /// What the error is, with its unit.
    pub(super) error: &'static str,
    /// What is counted.
    pub(super) operations: &'static str,
    pub(super) truth: String,
    /// Errors below this count as none: truth itself is no surer.
    pub(super) floor: f64,
    pub(super) rounds: usize,
    /// About how many seconds it all takes, for telling the time left.
    pub(super) weight: f64,
    pub(super) build: Builder,
}

/// Does something, and how long it took in seconds.
pub(super) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = black_box(work());
    (result, start.elapsed().as_secs_f64())
}

/// How often items are done within a run.
const REPEATS: usize = 3;

/// Does some items one after the other, three times, each time with a new state: what came out last, and the time that all took.
///
/// Time is taken of some items at a time (`chunk`), and of each chunk the least of the three counts: what else interrupts it on a busy
/// machine is no part of it.
pub(super) fn timed_items<S, I, T>(
    items: &[I],
    chunk: usize,
    state: impl Fn() -> S,
    mut each: impl FnMut(&mut S, &I) -> T,
) -> (Vec<T>, f64) {
    let mut least = vec![f64::INFINITY; items.len().div_ceil(chunk)];
    let mut found = Vec::with_capacity(items.len());
    for _ in 0..REPEATS {
        found.clear();
        let mut state = state();
        for (part, least) in items.chunks(chunk).zip(&mut least) {
            let start = Instant::now();
            found.extend(part.iter().map(|item| each(&mut state, item)));
            *least = start.elapsed().as_secs_f64().min(*least);
        }
    }
    (black_box(found), least.iter().sum())
}

/// Mean and largest of some errors. NaN counts: a number that is none is as wrong as can be.
pub(super) fn mean_and_worst(errors: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f64, 0.0);
    for error in errors {
        sum += error;
        worst = if error > worst || error.is_nan() { error } else { worst };
        count += 1.0;
    }
    [sum / count, worst]
}

/// Root mean square and largest of some errors.
pub(super) fn rms_and_worst(errors: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f64, 0.0_f64);
    for error in errors {
        sum += error * error;
        worst = if error.abs() > worst || error.is_nan() { error.abs() } else { worst };
        count += 1.0;
    }
    [(sum / count).sqrt(), worst]
}

/// A count as a number.
#[allow(clippy::cast_precision_loss, reason = "counts are far below 2⁵³")]
pub(super) const fn count(n: usize) -> f64 {
    n as f64
}

/// The same of 64 bits.
#[allow(clippy::cast_precision_loss, reason = "counts are far below 2⁵³")]
pub(super) const fn count64(n: u64) -> f64 {
    n as f64
}

/// Random numbers: `SplitMix64` of Steele, Lea and Flood (2014).
#[derive(Clone, Copy, Debug)]
pub(super) struct Random(u64);

impl Random {
    /// A stream of its own for each pair of numbers.
    pub(super) const fn new(stream: u64, round: u64) -> Self {
        Self(stream.wrapping_mul(0xd6e8_feb8_6659_fd93) ^ round.wrapping_mul(0xa076_1d64_78bd_642f))
    }

    /// A number in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        count64((z ^ (z >> 31)) >> 11) / count64(1 << 53)
    }

    /// A number between two, evenly.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}
