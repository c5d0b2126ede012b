//! Spectra: their XML forms, their files, their checks, and the table in which each function stands once.

use std::collections::HashMap;

use super::load::Ids;
use super::photometry::Stated;
use super::props::{Props, parse_finite, parse_float, parse_list, tokens, unsupported};
use super::source::Source;
use super::xml::Node;
use super::{SceneError, SpectrumData, SpectrumId, SpectrumKind};

/// Where Mitsuba's emission spectra start and end, nm.
const RANGE: (f64, f64) = (360.0, 830.0);
/// What a refractive index must cover, nm.
const VISIBLE: (f64, f64) = (380.0, 780.0);

/// What a spectrum is used for, which decides how a bare number is read and which values are allowed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// A fraction of light: 0 to 1, and no emission spectrum.
    Fraction,
    /// Light: not negative; a bare number is a multiple of D65.
    Emission,
    /// Refractive index: positive, defined over the visible range.
    Index,
    /// Extinction coefficient: not negative, defined over the visible range.
    Extinction,
    /// Absorption coefficient: not negative.
    Absorption,
}

/// The spectra of a scene under construction.
pub(crate) struct Spectra<'a> {
    source: &'a Source,
    ids: &'a Ids<'a>,
    list: Vec<SpectrumData>,
    known: HashMap<Vec<u64>, SpectrumId>,
}

impl<'a> Spectra<'a> {
    pub(crate) fn new(source: &'a Source, ids: &'a Ids<'a>) -> Self {
        Self { source, ids, list: Vec::new(), known: HashMap::new() }
    }

    pub(crate) fn finish(self) -> Vec<SpectrumData> {
        self.list
    }

    /// Takes the spectrum property `name`, or stands in `default`.
    pub(crate) fn property(
        &mut self,
        props: &mut Props<'a>,
        name: &str,
        role: Role,
        default: SpectrumKind,
    ) -> Result<SpectrumId, SceneError> {
        let place = props.node();
        Ok(match self.optional(props, name, role)? {
            Some(id) => id,
            None => self.intern(default, || format!("default {name} ({})", place.place())),
        })
    }

    /// Takes the spectrum property `name`, if it is there.
    pub(crate) fn optional(
        &mut self,
        props: &mut Props<'a>,
        name: &str,
        role: Role,
    ) -> Result<Option<SpectrumId>, SceneError> {
        let taken = self.take(props, name, role)?;
        Ok(taken.map(|(kind, label)| self.intern(kind, || label)))
    }

    /// Takes the spectrum property `name` of a light, or stands in `default`, and gives it the photometric value that is
    /// stated.
    pub(crate) fn light(
        &mut self,
        props: &mut Props<'a>,
        name: &str,
        default: SpectrumKind,
        stated: Option<&Stated<'a>>,
    ) -> Result<SpectrumId, SceneError> {
        let place = props.node();
        let taken = self.take(props, name, Role::Emission)?;
        let (kind, label) = taken.unwrap_or_else(|| (default, format!("default {name} ({})", place.place())));
        let kind = match stated {
            Some(stated) => stated.apply(&kind)?,
            None => kind,
        };
        Ok(self.intern(kind, || label))
    }

    /// Takes the spectrum property `name`, if it is there, with its label.
    fn take(
        &self,
        props: &mut Props<'a>,
        name: &str,
        role: Role,
    ) -> Result<Option<(SpectrumKind, String)>, SceneError> {
        let Some(node) = props.take(name) else { return Ok(None) };
        let kind = self.parse(node, role)?;
        check(node, name, &kind, role)?;
        let label = node.attribute("filename").unwrap_or(name);
        Ok(Some((kind, format!("{label} ({})", node.place()))))
    }

    /// A constant, for defaults that no property stands for.
    pub(crate) fn constant(&mut self, value: f64, label: impl FnOnce() -> String) -> SpectrumId {
        self.intern(SpectrumKind::Constant(value), label)
    }

    /// The largest sum of two reflectances over the visible wavelengths, and the wavelength in nm where it is reached, unless it is everywhere.
    pub(crate) fn largest_sum(&self, first: SpectrumId, second: SpectrumId) -> (f64, Option<f64>) {
        let kinds = [first, second].map(|id| self.list.get(id.0).map(|data| &data.kind));
        let value = |wavelength: f64| kinds.iter().flatten().map(|kind| reflectance(kind, wavelength)).sum::<f64>();
        // Sums of functions that are linear between nodes are largest at one of the nodes.
        let nodes = kinds.iter().flatten().flat_map(|kind| match kind {
            SpectrumKind::Table { wavelengths, .. } => wavelengths.as_slice(),
            _ => &[],
        });
        let mut nodes = nodes.copied().peekable();
        if nodes.peek().is_none() {
            return (value(0.0), None);
        }
        let (low, high) = VISIBLE;
        let visible = nodes.filter(|at| (low..=high).contains(at)).chain([low, high]);
        let largest = visible.map(|at| (value(at), at)).max_by(|a, b| a.0.total_cmp(&b.0));
        largest.map_or_else(|| (value(0.0), None), |(most, at)| (most, Some(at)))
    }

    /// Checks a spectrum that stands at the top of the scene, to be referred to by its id.
    pub(crate) fn check_declaration(&self, node: Node<'a>) -> Result<(), SceneError> {
        node.require("id")?;
        declared(node, Role::Emission).map(drop)
    }

    fn parse(&self, node: Node<'a>, role: Role) -> Result<SpectrumKind, SceneError> {
        match node.tag() {
            "spectrum" if node.attribute("type").is_some() => declared(node, role),
            "spectrum" => self.inline(node),
            "float" | "integer" => {
                node.allow_attributes(&["name", "value"])?;
                node.no_children()?;
                Ok(bare_number(parse_float(node, node.require("value")?)?, role))
            }
            "rgb" => super::rgb::parse(node, role),
            "ref" => {
                let target = self.ids.resolve(node)?;
                if target.tag() != "spectrum" {
                    return Err(node.error(format!("refers to a <{}>, not to a spectrum", target.tag())));
                }
                declared(target, role)
            }
            "texture" => Err(node.error("textures are not supported: use a <spectrum>")),
            _ => Err(node.error("a spectrum must be given as <spectrum>, <float>, <rgb> or <ref>")),
        }
    }

    /// `<spectrum name="…" value="…"/>` or `filename="…"`.
    fn inline(&self, node: Node<'a>) -> Result<SpectrumKind, SceneError> {
        node.allow_attributes(&["name", "value", "filename"])?;
        node.no_children()?;
        match (node.attribute("value"), node.attribute("filename")) {
            (Some(text), None) if !text.contains(':') => Ok(SpectrumKind::Constant(parse_float(node, text)?)),
            (Some(text), None) => {
                let mut pairs = Vec::new();
                for token in tokens(text) {
                    let pair = token.split_once(':');
                    let (wavelength, value) =
                        pair.ok_or_else(|| node.error(format!("{token:?} is not a pair \"wavelength:value\"")))?;
                    pairs.push((parse_float(node, wavelength)?, parse_float(node, value)?));
                }
                table(pairs).map_err(|(_, message)| node.error(message))
            }
            (None, Some(name)) => {
                let (file, text) = self.source.read_asset(name).map_err(|message| node.error(message))?;
                parse_file(&file, &text)
            }
            _ => Err(node.error("needs \"value\" or \"filename\", or a \"type\"; one of them")),
        }
    }

    fn intern(&mut self, kind: SpectrumKind, label: impl FnOnce() -> String) -> SpectrumId {
        let next = SpectrumId(self.list.len());
        let id = *self.known.entry(fingerprint(&kind)).or_insert(next);
        if id == next {
            self.list.push(SpectrumData { kind, label: label() });
        }
        id
    }
}

/// Reads a spectrum file: two columns, wavelength in nm and value, separated by white space or a comma; `#` starts a
/// comment; a first line of two words is a heading. At least two nodes, wavelengths positive and strictly increasing,
/// values not negative: gives a [`SpectrumKind::Table`].
///
/// # Errors
/// What breaks these rules, with `file` and the line at fault.
pub fn parse_file(file: &str, text: &str) -> Result<SpectrumKind, SceneError> {
    let fail = |line: usize, message: String| {
        SceneError::new(file, (u32::try_from(line + 1).unwrap_or(u32::MAX), 0), "", message)
    };
    let (mut pairs, mut lines) = (Vec::new(), Vec::new());
    let mut heading_allowed = true;
    for (line, content) in text.lines().enumerate() {
        let content = content.split('#').next().unwrap_or_default();
        let columns: Vec<_> = tokens(content).collect();
        match columns.as_slice() {
            [] => continue,
            [a, b] if heading_allowed && is_word(a) && is_word(b) => {}
            [wavelength, value] => {
                let number = |text| parse_finite(text).map_err(|message| fail(line, message));
                pairs.push((number(wavelength)?, number(value)?));
                lines.push(line);
            }
            other => {
                return Err(fail(line, format!("expected a wavelength and a value, found {} columns", other.len())));
            }
        }
        heading_allowed = false;
    }
    let last = text.lines().count().saturating_sub(1);
    table(pairs).map_err(|(at, message)| fail(lines.get(at).copied().unwrap_or(last), message))
}

fn is_word(text: &str) -> bool {
    parse_finite(text).is_err() && text.starts_with(char::is_alphabetic) && !text.eq_ignore_ascii_case("nan")
}

/// Checks the nodes of a table, all finite numbers; the error carries the index of the node at fault.
fn table(pairs: Vec<(f64, f64)>) -> Result<SpectrumKind, (usize, String)> {
    if pairs.len() < 2 {
        return Err((pairs.len(), format!("a spectrum needs at least two wavelengths, not {}", pairs.len())));
    }
    let mut before = 0.0;
    for (i, &(wavelength, value)) in pairs.iter().enumerate() {
        if wavelength <= before {
            let message = if i == 0 {
                format!("wavelength {wavelength} nm is not positive")
            } else {
                format!("wavelengths must increase: {wavelength} nm comes after {before} nm")
            };
            return Err((i, message));
        }
        if value < 0.0 {
            return Err((i, format!("negative value {value} at {wavelength} nm")));
        }
        before = wavelength;
    }
    let (wavelengths, values) = pairs.into_iter().unzip();
    Ok(SpectrumKind::Table { wavelengths, values })
}

/// `<spectrum type="…">`.
fn declared(node: Node<'_>, role: Role) -> Result<SpectrumKind, SceneError> {
    const TYPES: [&str; 5] = ["uniform", "regular", "irregular", "d65", "blackbody"];
    let mut props = Props::new(node)?;
    let kind = match props.kind() {
        "uniform" => {
            let value = props.float_where("value", 1.0, |v| v >= 0.0, "not negative")?;
            SpectrumKind::Constant(value)
        }
        "regular" => regular(&mut props)?,
        "irregular" => irregular(&mut props)?,
        "d65" | "blackbody" if role != Role::Emission => {
            return Err(node.error(format!("a {:?} spectrum is light, and can't be used here", props.kind())));
        }
        "d65" => SpectrumKind::D65 { scale: props.float_where("scale", 1.0, |v| v >= 0.0, "not negative")? },
        "blackbody" => blackbody(&mut props)?,
        other => return Err(unsupported(node, "spectrum type", other, &TYPES)),
    };
    props.finish()?;
    Ok(kind)
}

fn required<'a>(props: &Props<'a>, name: &str) -> SceneError {
    props.node().error(format!("missing property {name:?}"))
}

fn list<'a>(props: &mut Props<'a>, name: &str) -> Result<(Node<'a>, Vec<f64>), SceneError> {
    let (node, text) = props.string(name)?.ok_or_else(|| required(props, name))?;
    Ok((node, parse_list(node, text)?))
}

fn regular(props: &mut Props<'_>) -> Result<SpectrumKind, SceneError> {
    let (node, values) = list(props, "values")?;
    let min = props.float("wavelength_min")?.ok_or_else(|| required(props, "wavelength_min"))?;
    let max = props.float("wavelength_max")?.ok_or_else(|| required(props, "wavelength_max"))?;
    let count = values.len();
    let last = u32::try_from(count.saturating_sub(1)).unwrap_or(u32::MAX);
    let at = |i: u32| if i == last { max } else { min + (max - min) * f64::from(i) / f64::from(last) };
    let pairs = (0..).zip(values).map(|(i, value)| (at(i), value)).collect();
    if min >= max {
        return Err(props.node().error(format!("\"wavelength_max\" {max} must be above \"wavelength_min\" {min}")));
    }
    table(pairs).map_err(|(_, message)| node.error(message))
}

fn irregular(props: &mut Props<'_>) -> Result<SpectrumKind, SceneError> {
    let (node, wavelengths) = list(props, "wavelengths")?;
    let (_, values) = list(props, "values")?;
    if wavelengths.len() != values.len() {
        return Err(node.error(format!("{} wavelengths but {} values", wavelengths.len(), values.len())));
    }
    table(wavelengths.into_iter().zip(values).collect()).map_err(|(_, message)| node.error(message))
}

fn blackbody(props: &mut Props<'_>) -> Result<SpectrumKind, SceneError> {
    let positive = |v| v > 0.0;
    let temperature = props.float_where("temperature", 0.0, positive, "positive")?;
    if temperature == 0.0 {
        return Err(required(props, "temperature"));
    }
    let scale = props.float_where("scale", 1.0, |v| v >= 0.0, "not negative")?;
    let wavelength_min = props.float_where("wavelength_min", RANGE.0, positive, "positive")?;
    let wavelength_max =
        props.float_where("wavelength_max", RANGE.1, |v| v > wavelength_min, "above wavelength_min")?;
    if wavelength_min >= wavelength_max {
        return Err(props.node().error("\"wavelength_max\" must be above \"wavelength_min\""));
    }
    Ok(SpectrumKind::Blackbody { temperature, scale, wavelength_min, wavelength_max })
}

pub(crate) fn bare_number(value: f64, role: Role) -> SpectrumKind {
    if role == Role::Emission { SpectrumKind::D65 { scale: value } } else { SpectrumKind::Constant(value) }
}

/// Refuses values (all finite by now) that can't be what the role says.
fn check(node: Node<'_>, name: &str, kind: &SpectrumKind, role: Role) -> Result<(), SceneError> {
    let (low, high) = extremes(kind);
    if low < 0.0 {
        return Err(node.error(format!("{name:?} is negative: {low}")));
    }
    if role == Role::Fraction && high > 1.0 {
        return Err(node.error(format!("{name:?} must not be above 1, but reaches {high}")));
    }
    if role == Role::Index && low <= 0.0 {
        return Err(node.error(format!("{name:?} must be positive")));
    }
    if let (Role::Index | Role::Extinction, SpectrumKind::Table { wavelengths, .. }) = (role, kind) {
        let ends = (wavelengths.first().copied(), wavelengths.last().copied());
        if !(ends.0 <= Some(VISIBLE.0) && ends.1 >= Some(VISIBLE.1)) {
            let message = format!("{name:?} must be given from {} to {} nm", VISIBLE.0, VISIBLE.1);
            return Err(node.error(message));
        }
    }
    Ok(())
}

/// The value of a reflectance, which is no emission spectrum.
fn reflectance(kind: &SpectrumKind, wavelength: f64) -> f64 {
    match kind {
        SpectrumKind::Constant(value) => *value,
        SpectrumKind::Table { wavelengths, values } => {
            let after = wavelengths.partition_point(|w| *w < wavelength);
            match (wavelengths.get(after), after.checked_sub(1)) {
                (Some(at), _) if *at == wavelength => values[after],
                (Some(to), Some(before)) => {
                    let t = (wavelength - wavelengths[before]) / (to - wavelengths[before]);
                    values[before] + (values[after] - values[before]) * t
                }
                _ => 0.0,
            }
        }
        SpectrumKind::D65 { .. } | SpectrumKind::Blackbody { .. } => 0.0,
    }
}

/// Least and greatest value at the nodes.
fn extremes(kind: &SpectrumKind) -> (f64, f64) {
    match kind {
        SpectrumKind::Constant(value) => (*value, *value),
        SpectrumKind::D65 { scale } | SpectrumKind::Blackbody { scale, .. } => (*scale, *scale),
        SpectrumKind::Table { values, .. } => values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value))),
    }
}

/// The bits that tell functions apart.
fn fingerprint(kind: &SpectrumKind) -> Vec<u64> {
    // Adding 0 turns −0 into +0, which is the same function.
    let bits = |value: f64| (value + 0.0).to_bits();
    match kind {
        SpectrumKind::Constant(value) => vec![0, bits(*value)],
        SpectrumKind::D65 { scale } => vec![1, bits(*scale)],
        SpectrumKind::Blackbody { temperature, scale, wavelength_min, wavelength_max } => {
            vec![2, bits(*temperature), bits(*scale), bits(*wavelength_min), bits(*wavelength_max)]
        }
        SpectrumKind::Table { wavelengths, values } => {
            core::iter::once(3).chain(wavelengths.iter().chain(values).map(|&value| bits(value))).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_may_have_comments_commas_and_a_heading() {
        let expected = SpectrumKind::Table { wavelengths: vec![400.0, 500.5], values: vec![0.0, 2.0] };
        for text in ["400 0\n500.5\t2\n", "# c\n\n400,0 # here\r\n500.5, 2", "wavelength_nm,value\n400,0\n500.5,2"] {
            assert_eq!(parse_file("a.spd", text).unwrap(), expected, "{text:?}");
        }
    }

    #[test]
    fn file_faults_name_their_line() {
        for (text, line, part) in [
            ("400 1\n410 x", 2, "not a number"),
            ("400 1\nnan nan", 2, "not a finite"),
            ("NaN NaN\n400 1", 1, "not a finite"),
            ("400 1\n\n390 1", 3, "increase"),
            ("400 1\n400 1", 2, "increase"),
            ("400 1\n410 -1", 2, "negative"),
            ("-1 1\n410 1", 1, "not positive"),
            ("400 1 2\n410 1", 1, "3 columns"),
            ("# only\n400 1", 2, "at least two"),
            ("", 1, "at least two"),
            ("400 inf\n410 1", 1, "finite"),
        ] {
            let error = parse_file("a.spd", text).unwrap_err();
            assert_eq!((error.file.as_str(), error.line), ("a.spd", line), "{text:?}: {error}");
            assert!(error.message.contains(part), "{text:?}: {error}");
        }
    }
}
