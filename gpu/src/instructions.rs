//! Counts of shader instructions.

use core::fmt;
use std::collections::BTreeMap;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{ShaderStage, back::spv, front};

use crate::renderer::Fragment;

/// Words before the first instruction of a SPIR-V module.
const HEADER: usize = 5;

/// A shader that naga refuses, in its words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused(pub String);

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the shader was refused: {}", self.0)
    }
}

impl core::error::Error for Refused {}

/// How often each SPIR-V instruction stands in the functions of a fragment shader, as naga writes them: parsed and validated,
/// not optimised.
///
/// # Errors
/// [`Refused`] when the text isn't valid.
pub fn count(fragment: Fragment<'_>) -> Result<BTreeMap<String, usize>, Refused> {
    let module = parse(fragment)?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| Refused(error.into_inner().to_string()))?;
    let options = spv::Options { flags: spv::WriterFlags::empty(), ..spv::Options::default() };
    let words = spv::write_vec(&module, &info, &options, None).map_err(|error| Refused(error.to_string()))?;
    Ok(count_words(&words))
}

/// What `more` has above `less`.
#[must_use]
pub fn extra(more: &BTreeMap<String, usize>, less: &BTreeMap<String, usize>) -> BTreeMap<String, usize> {
    let above = |(name, &n): (&String, &usize)| {
        let rest = n.saturating_sub(less.get(name).copied().unwrap_or(0));
        (rest > 0).then(|| (name.clone(), rest))
    };
    more.iter().filter_map(above).collect()
}

/// How many vector instructions a SPIR-V instruction on three components is on hardware such as the paper's, where an
/// instruction multiplies and adds, and reorders and negates its operands for nothing; none where it only moves data.
///
/// A matrix times a vector is a multiplication and two multiplications with addition. Subtracting the result of that could
/// be part of these, as it would be on hardware: one instruction less than counted here.
#[must_use]
pub fn vector_instructions(name: &str) -> usize {
    match name {
        "MatrixTimesVector" => 3,
        "FAdd" | "FSub" | "FMul" | "FDiv" | "VectorTimesScalar" | "Dot" | "ExtInst" => 1,
        _ => 0,
    }
}

fn parse(fragment: Fragment<'_>) -> Result<naga::Module, Refused> {
    match fragment {
        Fragment::Wgsl(text) => front::wgsl::parse_str(text).map_err(|error| Refused(error.emit_to_string(text))),
        Fragment::Glsl(text) => front::glsl::Frontend::default()
            .parse(&front::glsl::Options::from(ShaderStage::Fragment), text)
            .map_err(|error| Refused(error.emit_to_string(text))),
    }
}

/// Counts the instructions between each OpFunction and its OpFunctionEnd.
fn count_words(words: &[u32]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    let (mut rest, mut inside) = (words.get(HEADER..).unwrap_or(&[]), false);
    while let [first, ..] = rest {
        // The upper half is the number of words, this one included, the lower the instruction.
        let (length, code) = ((first >> 16) as usize, first & 0xffff);
        let name = spirv::Op::from_u32(code).map_or_else(|| code.to_string(), |op| format!("{op:?}"));
        inside = inside || name == "Function";
        if inside {
            *counts.entry(name.clone()).or_insert(0) += 1;
        }
        inside = inside && name != "FunctionEnd";
        rest = rest.get(length.max(1)..).unwrap_or(&[]);
    }
    counts
}
