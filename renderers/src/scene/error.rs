//! What is wrong with a scene, and where.

use core::fmt;

/// A refused scene: the file, line and element at fault, and one sentence on what is wrong with it.
///
/// [`Display`](fmt::Display) gives one line, `file:line: <element>: message`; the parts that are unknown (a file that
/// can't be read has no line) are left out. Faults inside a spectrum or OBJ file name that file and its line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneError {
    /// The file at fault, as it was named by whoever asked for it.
    pub file: String,
    /// Line in `file`, from 1; 0 if the fault belongs to the whole file.
    pub line: u32,
    /// Column in `file`, from 1, counted in characters; 0 if unknown.
    pub column: u32,
    /// The element at fault: an XML tag, or the keyword of a statement of an OBJ file; empty if there is none.
    pub element: String,
    /// What is wrong, without a full stop.
    pub message: String,
}

impl SceneError {
    /// A fault at a place in a file; control characters in the texts become spaces so that the error stays one line.
    pub(crate) fn new(file: &str, (line, column): (u32, u32), element: &str, message: impl AsRef<str>) -> Self {
        let clean = |text: &str| text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        Self { file: clean(file), line, column, element: clean(element), message: clean(message.as_ref()) }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
        }
        if !self.element.is_empty() {
            write!(f, ": <{}>", self.element)?;
        }
        write!(f, ": {}", self.message)
    }
}

impl core::error::Error for SceneError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_is_one_line_and_leaves_out_what_is_unknown() {
        let full = SceneError::new("a.xml", (3, 7), "bsdf", "bad\nvalue");
        assert_eq!(full.to_string(), "a.xml:3: <bsdf>: bad value");
        let whole = SceneError::new("a.xml", (0, 0), "", "not found");
        assert_eq!(whole.to_string(), "a.xml: not found");
    }
}
