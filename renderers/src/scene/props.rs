//! The properties of one object element: taken by name and type, and none left over.

use core::str::FromStr;

use glam::{DAffine3, DVec3};

use super::SceneError;
use super::transform;
use super::xml::Node;

/// The children of an object such as `<shape type="…">`, to be taken one by one; [`finish`](Self::finish) refuses the rest.
pub(crate) struct Props<'a> {
    node: Node<'a>,
    rest: Vec<Node<'a>>,
}

impl<'a> Props<'a> {
    /// Checks the element's own attributes (`type` needed, `id` and `name` allowed) and that no property is given twice.
    pub(crate) fn new(node: Node<'a>) -> Result<Self, SceneError> {
        node.allow_attributes(&["type", "id", "name"])?;
        node.require("type")?;
        let rest: Vec<_> = node.children().collect();
        for (i, child) in rest.iter().enumerate() {
            let Some(name) = child.attribute("name") else { continue };
            if rest[..i].iter().any(|earlier| earlier.attribute("name") == Some(name)) {
                return Err(child.error(format!("property {name:?} is given twice")));
            }
        }
        Ok(Self { node, rest })
    }

    pub(crate) fn node(&self) -> Node<'a> {
        self.node
    }

    /// The `type` attribute.
    pub(crate) fn kind(&self) -> &'a str {
        self.node.attribute("type").unwrap_or_default()
    }

    /// Takes the child with this `name`.
    pub(crate) fn take(&mut self, name: &str) -> Option<Node<'a>> {
        let at = self.rest.iter().position(|child| child.attribute("name") == Some(name))?;
        Some(self.rest.remove(at))
    }

    /// The child with this `name`, without taking it.
    pub(crate) fn peek(&self, name: &str) -> Option<Node<'a>> {
        self.rest.iter().copied().find(|child| child.attribute("name") == Some(name))
    }

    /// Takes the first child with one of these tags, whatever its name.
    pub(crate) fn take_tag(&mut self, tags: &[&str]) -> Option<Node<'a>> {
        let at = self.rest.iter().position(|child| tags.contains(&child.tag()))?;
        Some(self.rest.remove(at))
    }

    /// Takes a `<float>` or `<integer>` as it is written.
    pub(crate) fn number_text(&mut self, name: &str) -> Result<Option<(Node<'a>, &'a str)>, SceneError> {
        self.value(name, &["float", "integer"])
    }

    /// Takes a `<float>` or `<integer>`.
    pub(crate) fn float(&mut self, name: &str) -> Result<Option<f64>, SceneError> {
        self.number_text(name)?.map(|(node, text)| parse_float(node, text)).transpose()
    }

    /// Takes a `<float>` that must satisfy a condition, described by `what` as in "must be positive".
    pub(crate) fn float_where(
        &mut self,
        name: &str,
        default: f64,
        holds: impl Fn(f64) -> bool,
        what: &str,
    ) -> Result<f64, SceneError> {
        let Some((node, text)) = self.number_text(name)? else {
            return Ok(default);
        };
        let value = parse_float(node, text)?;
        if holds(value) { Ok(value) } else { Err(node.error(format!("{name:?} must be {what}, not {text}"))) }
    }

    /// Takes an `<integer>` between two bounds, both included.
    pub(crate) fn integer(&mut self, name: &str, default: i64, min: i64, max: i64) -> Result<i64, SceneError> {
        let Some((node, text)) = self.value(name, &["integer"])? else { return Ok(default) };
        let value = i64::from_str(text.trim()).map_err(|_| node.error(format!("{text:?} is not an integer")))?;
        if (min..=max).contains(&value) {
            Ok(value)
        } else {
            Err(node.error(format!("{name:?} must be between {min} and {max}, not {value}")))
        }
    }

    /// Takes a `<boolean>`, `false` if there is none.
    pub(crate) fn boolean(&mut self, name: &str) -> Result<bool, SceneError> {
        match self.value(name, &["boolean"])? {
            None => Ok(false),
            Some((_, text)) if text.eq_ignore_ascii_case("true") => Ok(true),
            Some((_, text)) if text.eq_ignore_ascii_case("false") => Ok(false),
            Some((node, text)) => Err(node.error(format!("{text:?} is neither \"true\" nor \"false\""))),
        }
    }

    /// Takes a `<string>` and the element that holds it.
    pub(crate) fn string(&mut self, name: &str) -> Result<Option<(Node<'a>, &'a str)>, SceneError> {
        self.value(name, &["string"])
    }

    /// Takes a `<string>` that must be one of a list.
    pub(crate) fn choice(&mut self, name: &str, options: &[&str]) -> Result<Option<&'a str>, SceneError> {
        match self.string(name)? {
            Some((node, text)) if !options.contains(&text) => Err(unsupported(node, name, text, options)),
            other => Ok(other.map(|(_, text)| text)),
        }
    }

    /// Takes a `<point>` or `<vector>`: `value="x y z"`, or `x`, `y` and `z`.
    pub(crate) fn vector(&mut self, name: &str, tag: &str) -> Result<Option<(Node<'a>, DVec3)>, SceneError> {
        let Some(node) = self.take(name) else { return Ok(None) };
        expect_tag(node, name, &[tag])?;
        node.allow_attributes(&["name", "value", "x", "y", "z"])?;
        node.no_children()?;
        if node.attribute("value").is_none() {
            for axis in ["x", "y", "z"] {
                node.require(axis)?;
            }
        }
        Ok(Some((node, parse_vector(node, 0.0)?)))
    }

    /// Takes the `<transform name="to_world">`, identity if there is none; the element is for messages.
    pub(crate) fn transform(&mut self) -> Result<(Node<'a>, DAffine3), SceneError> {
        let Some(node) = self.take("to_world") else { return Ok((self.node, DAffine3::IDENTITY)) };
        expect_tag(node, "to_world", &["transform"])?;
        Ok((node, transform::parse(node)?))
    }

    /// Refuses what has not been taken.
    pub(crate) fn finish(self) -> Result<(), SceneError> {
        let Some(child) = self.rest.first() else { return Ok(()) };
        let owner = format!("<{} type={:?}>", self.node.tag(), self.kind());
        Err(child.error(match child.attribute("name") {
            Some(name) => format!("{owner} has no property {name:?} here"),
            None => format!("not supported inside {owner}"),
        }))
    }

    fn value(&mut self, name: &str, tags: &[&str]) -> Result<Option<(Node<'a>, &'a str)>, SceneError> {
        let Some(node) = self.take(name) else { return Ok(None) };
        expect_tag(node, name, tags)?;
        node.allow_attributes(&["name", "value"])?;
        node.no_children()?;
        Ok(Some((node, node.require("value")?)))
    }
}

fn expect_tag(node: Node<'_>, name: &str, tags: &[&str]) -> Result<(), SceneError> {
    if tags.contains(&node.tag()) {
        return Ok(());
    }
    let wanted: Vec<_> = tags.iter().map(|tag| format!("<{tag}>")).collect();
    Err(node.error(format!("property {name:?} must be given as {}", wanted.join(" or "))))
}

/// "… is not supported (supported: …)".
pub(crate) fn unsupported(node: Node<'_>, what: &str, value: &str, options: &[&str]) -> SceneError {
    node.error(format!("{what} {value:?} is not supported (supported: {})", options.join(", ")))
}

/// A finite number.
pub(crate) fn parse_float(node: Node<'_>, text: &str) -> Result<f64, SceneError> {
    parse_finite(text).map_err(|message| node.error(message))
}

/// A finite number, or what is wrong with it.
pub(crate) fn parse_finite(text: &str) -> Result<f64, String> {
    match f64::from_str(text.trim()) {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("{text:?} is not a finite number")),
        Err(_) => Err(format!("{text:?} is not a number")),
    }
}

/// Numbers separated by white space or commas.
pub(crate) fn parse_list(node: Node<'_>, text: &str) -> Result<Vec<f64>, SceneError> {
    tokens(text).map(|token| parse_float(node, token)).collect()
}

/// The parts of a text between white space and commas.
pub(crate) fn tokens(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c.is_whitespace() || c == ',').filter(|token| !token.is_empty())
}

/// A vector from `value` (three numbers, or one for all) or from `x`, `y`, `z`, which default to `missing`.
pub(crate) fn parse_vector(node: Node<'_>, missing: f64) -> Result<DVec3, SceneError> {
    if let Some(text) = node.attribute("value") {
        if ["x", "y", "z"].iter().any(|axis| node.attribute(axis).is_some()) {
            return Err(node.error("\"value\" excludes \"x\", \"y\" and \"z\""));
        }
        return match parse_list(node, text)?.as_slice() {
            &[all] => Ok(DVec3::splat(all)),
            &[x, y, z] => Ok(DVec3::new(x, y, z)),
            other => Err(node.error(format!("\"value\" must hold one or three numbers, not {}", other.len()))),
        };
    }
    let component = |axis| node.attribute(axis).map_or(Ok(missing), |text| parse_float(node, text));
    Ok(DVec3::new(component("x")?, component("y")?, component("z")?))
}
