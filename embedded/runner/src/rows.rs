//! Rows in one precision, on the host.

use core::fmt;
use core::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;

use embedded_entries::{ENTRIES, Entry, Run};

/// The number type of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Precision {
    Single,
    Double,
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Single => "f32",
            Self::Double => "f64",
        })
    }
}

/// A row in one precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    pub(crate) entry: &'static Entry,
    pub(crate) precision: Precision,
}

impl Wanted {
    fn suffix(&self) -> &'static str {
        match self.precision {
            Precision::Single => "single",
            Precision::Double => "double",
        }
    }

    /// What the linker is told to want.
    pub(crate) fn symbol(&self) -> String {
        format!("{}_{}", self.suffix(), self.entry.name)
    }

    /// The digest and number of results on this machine.
    pub(crate) fn on_host(&self) -> (u64, u32) {
        let mut run = Run::new(|| 0);
        for _ in 0..self.entry.times {
            match self.precision {
                Precision::Single => (self.entry.single)(&mut run),
                Precision::Double => (self.entry.double)(&mut run),
            }
        }
        (run.digest(), run.results())
    }
}

/// All rows in both precisions, in the order of their sections, which is that in an image.
pub(crate) fn all() -> Vec<Wanted> {
    let both = |entry| [Precision::Single, Precision::Double].map(|precision| Wanted { entry, precision });
    let mut rows: Vec<Wanted> = ENTRIES.into_iter().flatten().flat_map(both).collect();
    rows.sort_by_key(|row| format!(".entries.{}.{}", row.entry.name, row.suffix()));
    rows
}

/// FNV-1a over numbers.
pub(crate) fn fnv<const N: usize>(numbers: [u64; N]) -> u64 {
    let bytes = numbers.into_iter().flat_map(u64::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// Results in the order of the jobs, made by as many workers as there are cores; each job gets the number of its worker.
pub(crate) fn in_parallel<J: Sync, T: Send>(jobs: &[J], work: impl Fn(&J, usize) -> T + Sync) -> Vec<T> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for worker in 0..workers {
            let (next, done, work) = (&next, &done, &work);
            scope.spawn(move || {
                loop {
                    let place = next.fetch_add(1, Ordering::Relaxed);
                    let Some(job) = jobs.get(place) else { break };
                    let result = work(job, worker);
                    if let Ok(mut done) = done.lock() {
                        done.push((place, result));
                    }
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_default();
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, result)| result).collect()
}
