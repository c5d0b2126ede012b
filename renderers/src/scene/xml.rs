//! The XML text as a flat list of elements with their lines, `<default>`s and `$parameters` already put in.

use std::collections::HashMap;

use super::SceneError;

/// A parsed document: elements in document order, the root first.
pub(crate) struct Document {
    file: String,
    elements: Vec<Element>,
}

struct Element {
    tag: String,
    attributes: Vec<(String, String)>,
    children: Vec<usize>,
    position: (u32, u32),
}

/// One element of a document.
#[derive(Clone, Copy)]
pub(crate) struct Node<'a> {
    document: &'a Document,
    index: usize,
}

impl<'a> Node<'a> {
    pub(crate) fn index(self) -> usize {
        self.index
    }

    fn element(self) -> &'a Element {
        &self.document.elements[self.index]
    }

    pub(crate) fn tag(self) -> &'a str {
        &self.element().tag
    }

    pub(crate) fn attribute(self, name: &str) -> Option<&'a str> {
        self.element().attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The value of an attribute that must be there.
    pub(crate) fn require(self, name: &str) -> Result<&'a str, SceneError> {
        self.attribute(name).ok_or_else(|| self.error(format!("missing attribute {name:?}")))
    }

    /// Refuses attributes other than those listed.
    pub(crate) fn allow_attributes(self, allowed: &[&str]) -> Result<(), SceneError> {
        match self.element().attributes.iter().find(|(key, _)| !allowed.contains(&key.as_str())) {
            Some((key, _)) => Err(self.error(format!("unknown attribute {key:?}"))),
            None => Ok(()),
        }
    }

    /// Refuses children.
    pub(crate) fn no_children(self) -> Result<(), SceneError> {
        match self.children().next() {
            Some(child) => Err(child.error(format!("not expected inside <{}>", self.tag()))),
            None => Ok(()),
        }
    }

    pub(crate) fn children(self) -> impl Iterator<Item = Node<'a>> {
        self.element().children.iter().map(move |&index| Node { document: self.document, index })
    }

    /// File and line for messages, as `file:line`.
    pub(crate) fn place(self) -> String {
        format!("{}:{}", self.document.file, self.element().position.0)
    }

    /// A fault of this element.
    pub(crate) fn error(self, message: impl AsRef<str>) -> SceneError {
        SceneError::new(&self.document.file, self.element().position, self.tag(), message)
    }
}

impl Document {
    /// Parses a text; `parameters` replace `$name` in attributes and win over `<default>`s of the same name.
    pub(crate) fn parse(file: &str, text: &str, parameters: &[(String, String)]) -> Result<Self, SceneError> {
        let tree = roxmltree::Document::parse(text).map_err(|e| malformed(file, text, &e))?;
        let mut builder = Builder::new(file, text, parameters);
        for node in tree.descendants() {
            builder.add(node)?;
        }
        builder.finish()
    }

    pub(crate) fn root(&self) -> Node<'_> {
        Node { document: self, index: 0 }
    }

    pub(crate) fn nodes(&self) -> impl Iterator<Item = Node<'_>> {
        (0..self.elements.len()).map(|index| Node { document: self, index })
    }
}

fn malformed(file: &str, text: &str, error: &roxmltree::Error) -> SceneError {
    use roxmltree::Error;
    let last_line = u32::try_from(text.lines().count().max(1)).unwrap_or(u32::MAX);
    let place = match error {
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream | Error::NoRootNode => (last_line, 0),
        _ => (error.pos().row, error.pos().col),
    };
    SceneError::new(file, place, "", format!("malformed XML: {error}"))
}

/// Copies a tree into a [`Document`], in document order.
struct Builder<'t> {
    document: Document,
    parameters: Parameters,
    lines: Lines<'t>,
    indices: HashMap<roxmltree::NodeId, usize>,
}

impl<'t> Builder<'t> {
    fn new(file: &str, text: &'t str, parameters: &[(String, String)]) -> Self {
        Self {
            document: Document { file: file.to_owned(), elements: Vec::new() },
            parameters: Parameters::new(parameters),
            lines: Lines::new(text),
            indices: HashMap::new(),
        }
    }

    fn add(&mut self, node: roxmltree::Node<'_, '_>) -> Result<(), SceneError> {
        if node.is_text() {
            return self.refuse_text(node);
        }
        if !node.is_element() {
            return Ok(());
        }
        let position = self.lines.position(node.range().start);
        let file = self.document.file.clone();
        let fail = |message: String| SceneError::new(&file, position, node.tag_name().name(), message);
        if node.tag_name().namespace().is_some() {
            return Err(fail("XML namespaces are not supported".into()));
        }
        let mut attributes = Vec::new();
        for attribute in node.attributes() {
            let value = self.parameters.substitute(attribute.value()).map_err(fail)?;
            attributes.push((attribute.name().to_owned(), value));
        }
        let index = self.document.elements.len();
        let element = Element { tag: node.tag_name().name().to_owned(), attributes, children: Vec::new(), position };
        self.document.elements.push(element);
        self.indices.insert(node.id(), index);
        if node.tag_name().name() == "default" {
            return self.define_default(index);
        }
        if let Some(parent) = node.parent_element().and_then(|parent| self.indices.get(&parent.id())) {
            self.document.elements[*parent].children.push(index);
        }
        Ok(())
    }

    /// A `<default>` is kept as an element (for messages) but is nobody's child.
    fn define_default(&mut self, index: usize) -> Result<(), SceneError> {
        let node = Node { document: &self.document, index };
        node.allow_attributes(&["name", "value"])?;
        let (name, value) = (node.require("name")?, node.require("value")?);
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if name.is_empty() || !name.chars().all(is_word) {
            return Err(node.error(format!("{name:?} is not a parameter name: letters, digits and _ only")));
        }
        self.parameters.define(name, value);
        Ok(())
    }

    fn refuse_text(&self, node: roxmltree::Node<'_, '_>) -> Result<(), SceneError> {
        let text = node.text().unwrap_or_default();
        let Some(offset) = text.find(|c: char| !c.is_whitespace()) else { return Ok(()) };
        let position = self.lines.position(node.range().start + offset);
        let tag = node.parent_element().map_or("", |parent| parent.tag_name().name());
        Err(SceneError::new(&self.document.file, position, tag, "text between elements is not expected"))
    }

    fn finish(self) -> Result<Document, SceneError> {
        for node in self.document.nodes().filter(|node| node.tag() == "default") {
            node.no_children()?;
        }
        match self.parameters.first_unused() {
            Some(name) => {
                let message = format!("parameter {name:?} is given but not used by this scene");
                Err(SceneError::new(&self.document.file, (0, 0), "", message))
            }
            None => Ok(self.document),
        }
    }
}

/// Offsets of the starts of lines, to turn a byte offset into line and column.
struct Lines<'t> {
    text: &'t str,
    starts: Vec<usize>,
}

impl<'t> Lines<'t> {
    fn new(text: &'t str) -> Self {
        let starts = core::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        Self { text, starts }
    }

    fn position(&self, offset: usize) -> (u32, u32) {
        let line = self.starts.partition_point(|&start| start <= offset);
        let start = self.starts.get(line.wrapping_sub(1)).copied().unwrap_or(0);
        let column = self.text.get(start..offset).map_or(0, |before| before.chars().count()) + 1;
        (u32::try_from(line).unwrap_or(u32::MAX), u32::try_from(column).unwrap_or(u32::MAX))
    }
}

struct Parameter {
    name: String,
    value: String,
    used: bool,
}

/// What `$name` stands for, longest names first so that `$width2` is not taken for `$width` followed by a 2.
struct Parameters(Vec<Parameter>);

impl Parameters {
    fn new(given: &[(String, String)]) -> Self {
        let mut parameters: Vec<_> = given
            .iter()
            .map(|(name, value)| Parameter { name: name.clone(), value: value.clone(), used: false })
            .collect();
        parameters.sort_by_key(|parameter| core::cmp::Reverse(parameter.name.len()));
        Self(parameters)
    }

    /// Adds a default; the first definition of a name wins, and defaults needn't be used.
    fn define(&mut self, name: &str, value: &str) {
        if self.0.iter().any(|parameter| parameter.name == name) {
            return;
        }
        let at = self.0.partition_point(|parameter| parameter.name.len() >= name.len());
        let parameter = Parameter { name: name.to_owned(), value: value.to_owned(), used: true };
        self.0.insert(at, parameter);
    }

    /// Puts parameters into a text; `\$` is a dollar sign.
    fn substitute(&mut self, text: &str) -> Result<String, String> {
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            let (before, after) = (&rest[..at], &rest[at + 1..]);
            if let Some(unescaped) = before.strip_suffix('\\') {
                out.push_str(unescaped);
                out.push('$');
                rest = after;
                continue;
            }
            out.push_str(before);
            let Some(found) = self.0.iter_mut().find(|p| !p.name.is_empty() && after.starts_with(&p.name)) else {
                let end = after.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(after.len());
                return Err(format!("undefined parameter \"${}\"", &after[..end]));
            };
            found.used = true;
            out.push_str(&found.value);
            rest = &after[found.name.len()..];
        }
        out.push_str(rest);
        Ok(out)
    }

    fn first_unused(&self) -> Option<&str> {
        self.0.iter().find(|parameter| !parameter.used).map(|parameter| parameter.name.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, parameters: &[(&str, &str)]) -> Result<Document, SceneError> {
        let owned: Vec<_> = parameters.iter().map(|&(n, v)| (n.to_owned(), v.to_owned())).collect();
        Document::parse("s.xml", text, &owned)
    }

    #[test]
    fn parameters_win_over_defaults_and_longest_names_match_first() {
        let text = r#"<s><default name="a" value="1"/><default name="a" value="2"/><default name="ab" value="3"/>
            <f v="x$a-$ab-\$a$a"/></s>"#;
        let value = |parameters: &[_]| {
            let document = parse(text, parameters).unwrap();
            document.root().children().next().unwrap().attribute("v").unwrap().to_owned()
        };
        assert_eq!(value(&[]), "x1-3-$a1");
        assert_eq!(value(&[("a", "9")]), "x9-3-$a9");
    }

    #[test]
    fn undefined_late_and_unused_parameters_are_refused() {
        let late = parse("<s>\n<f v=\"$a\"/><default name=\"a\" value=\"1\"/></s>", &[]).err().unwrap();
        assert_eq!((late.line, late.element.as_str()), (2, "f"));
        assert!(late.message.contains("$a"));
        let unused = parse("<s/>", &[("spp", "4")]).err().unwrap();
        assert!(unused.message.contains("spp"));
    }

    #[test]
    fn positions_count_lines_and_characters() {
        let document = parse("<s>\n  <a v=\"é\"/><b/></s>", &[]).unwrap();
        let positions: Vec<_> = document.nodes().map(|node| node.element().position).collect();
        assert_eq!(positions, [(1, 1), (2, 3), (2, 13)]);
    }

    #[test]
    fn text_between_elements_is_refused_where_it_stands() {
        let error = parse("<s>\n\n oops</s>", &[]).err().unwrap();
        assert_eq!((error.line, error.column), (3, 2));
    }
}
