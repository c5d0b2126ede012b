//! What the page asks of `spectral-core`: a light's report, and what becomes of it on paints, as JSON.
//!
//! The page writes text to [`input`], calls a function, and reads its answer of [`output_length`] bytes at [`output`]. An answer
//! that is an object with `error` says in words what was wrong.

mod catalogue;
mod examine;
mod light;
mod swatch;

use std::cell::RefCell;

use serde::Serialize;
use spectral_core::tables;

use light::{LightFileError, LightReport, SpectralTable, parse_light, report};

/// What is kept between calls.
#[derive(Default)]
struct State {
    input: Vec<u8>,
    output: Vec<u8>,
    light: Option<SpectralTable>,
}

thread_local! {
    static STATE: RefCell<State> = RefCell::default();
}

/// What was wrong, and where in a file.
#[derive(Serialize)]
struct Refusal {
    error: String,
    line: Option<u32>,
}

impl Refusal {
    fn new(error: impl ToString) -> Self {
        Self { error: error.to_string(), line: None }
    }
}

impl From<LightFileError> for Refusal {
    fn from(error: LightFileError) -> Self {
        Self { error: error.message, line: Some(error.line).filter(|&line| line > 0) }
    }
}

/// A light's report, and what the page draws beside it.
#[derive(Serialize)]
struct Loaded {
    report: LightReport,
    /// The light's own colour as bytes of sRGB, as bright as can be.
    srgb: [u8; 3],
}

/// Answers with an object, or with what was wrong.
fn answer<T: Serialize>(task: impl FnOnce(&mut State) -> Result<T, Refusal>) {
    STATE.with_borrow_mut(|state| {
        let json = match task(state) {
            Ok(found) => serde_json::to_vec(&found),
            Err(refusal) => serde_json::to_vec(&refusal),
        };
        state.output = json.unwrap_or_default();
    });
}

/// Room for so many bytes of input.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    STATE.with_borrow_mut(|state| {
        state.input = vec![0; length];
        state.input.as_mut_ptr()
    })
}

/// Where the answer is.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    STATE.with_borrow(|state| state.output.as_ptr())
}

/// How many bytes the answer has.
#[unsafe(no_mangle)]
pub extern "C" fn output_length() -> usize {
    STATE.with_borrow(|state| state.output.len())
}

/// Answers with what there is to choose from.
#[unsafe(no_mangle)]
pub extern "C" fn catalogue() {
    answer(|_| Ok(catalogue::catalogue()));
}

/// Takes a file for the light: the input is its name, of so many bytes, and its content. Answers with its report.
#[unsafe(no_mangle)]
pub extern "C" fn load(name_length: usize) {
    answer(|state| {
        let (name, content) = state.input.split_at_checked(name_length).ok_or_else(|| Refusal::new("no file"))?;
        let name = String::from_utf8_lossy(name).into_owned();
        let table = parse_light(&name, content)?;
        measured(&name, table, state)
    });
}

/// Takes a built-in light. Answers with its report.
#[unsafe(no_mangle)]
pub extern "C" fn choose(index: usize) {
    answer(|state| {
        let table = tables::lights().nth(index).ok_or_else(|| Refusal::new("there is no such light"))?;
        measured(table.name, SpectralTable::from(table), state)
    });
}

fn measured(name: &str, table: SpectralTable, state: &mut State) -> Result<Loaded, Refusal> {
    let report = report(name, &table).map_err(Refusal::new)?;
    let srgb = swatch::brightest(&table).ok_or_else(|| Refusal::new("the light has no colour"))?;
    state.light = Some(table);
    Ok(Loaded { report, srgb })
}

/// Answers with what becomes of the light after so many reflections by a paint: by spectra on intervals, to a threshold of
/// ΔE*ab in a mode (certified, corrected, paper), and by the operators for three components.
#[unsafe(no_mangle)]
pub extern "C" fn examine(threshold: f64, mode: usize, paint: usize, reflections: usize) {
    answer(|state| {
        let light = state.light.as_ref().ok_or_else(|| Refusal::new("there is no light yet"))?;
        examine::examine(light, threshold, mode, paint, reflections).map_err(Refusal::new)
    });
}
