//! IES LM-63, the editions of 1986, 1991, 1995, 2002 and 2019.

use super::error::{Fault, PhotometricFileError, excerpt};
use super::file::{Format, LampSet, Opening, PhotometricFile, Tilt, check_size};
use super::intensity::{IntensityError, LuminousIntensity, Place};

const METRES_PER_FOOT: f64 = 0.3048;
const EDITIONS: &str = "IESNA91, IESNA:LM-63-1995, IESNA:LM-63-2002, IES:LM-63-2019; none for 1986";

type Result<T> = core::result::Result<T, PhotometricFileError>;

/// Parses an IES LM-63 text of type C, of any edition; `file` is its name for messages.
///
/// After `TILT=` numbers are separated by white space or commas, in lines of any length. Candela are multiplied by the
/// multiplier, the ballast factor and, in the editions of 1986 and 1991, the ballast–lamp photometric factor (later editions
/// use its place otherwise). Label lines are kept as they are, keywords or not.
///
/// # Errors
/// [`PhotometricFileError`] with line and field: an unknown edition, no `TILT=`, a tilt in another file, types A and B,
/// numbers that are none or not finite, counts that are not whole, factors that are not positive, negative candela, angles
/// that don't increase or fit no range of the format, a file that ends early or goes on after the last value.
pub fn parse(file: &str, text: &str) -> Result<PhotometricFile> {
    check_size(file, text.len())?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // DOS editors end files with control-Z.
    let text = text.trim_end_matches(['\u{1a}', '\0']);
    let (header, mut fields) = Header::split(file, text)?;
    let tilt = if header.tilt_included { Some(tilt(&mut fields)?) } else { None };
    let lamps = fields.whole("number of lamps", 1.0)?;
    let lumens =
        fields.checked("lumens per lamp", "positive, or -1 for absolute photometry", |v| v > 0.0 || v == -1.0)?;
    let multiplier = fields.positive("candela multiplier")?;
    let gamma_count = fields.whole("number of vertical angles", 2.0)?;
    let plane_count = fields.whole("number of horizontal angles", 1.0)?;
    fields.code("photometric type", "1, type C; types A and B are those of floodlights and headlights", &[1.0])?;
    let units = fields.code("units type", "1 for feet, 2 for metres", &[1.0, 2.0])?;
    let metres = if units == 1.0 { METRES_PER_FOOT } else { 1.0 };
    let opening = Opening {
        width: fields.number(|| "width".into())? * metres,
        length: fields.number(|| "length".into())? * metres,
        height: fields.number(|| "height".into())? * metres,
    };
    let ballast = fields.positive("ballast factor")?;
    let ballast_lamp = match header.format {
        Format::Ies1986 | Format::Ies1991 => fields.positive("ballast-lamp photometric factor")?,
        _ => {
            fields.number(|| "future use or file generation type".into())?;
            1.0
        }
    };
    let watts = fields.checked("input watts", "zero or positive", |v| v >= 0.0)?;
    let intensity = fields.table(gamma_count, plane_count, multiplier * ballast * ballast_lamp)?;
    fields.end()?;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number that fits")]
    let number = lamps as u32;
    let lumens_per_lamp = (lumens > 0.0).then_some(lumens);
    Ok(PhotometricFile {
        format: header.format,
        intensity,
        labels: header.labels,
        lamp_sets: vec![LampSet { number, lumens_per_lamp, watts, kind: String::new(), factor: 1.0 }],
        opening,
        tilt,
        stated_flux: None,
        stated_downward_fraction: None,
    })
}

/// What stands before the numbers.
struct Header {
    format: Format,
    labels: Vec<String>,
    tilt_included: bool,
}

impl Header {
    fn split<'t>(file: &'t str, text: &'t str) -> Result<(Self, Fields<'t>)> {
        let mut lines = (1..).zip(text.lines());
        let mut header = Self { format: Format::Ies1986, labels: Vec::new(), tilt_included: false };
        let mut last = 1;
        for (line, content) in &mut lines {
            last = line;
            let content = content.trim_end();
            if let Some(value) = tilt_value(content) {
                header.tilt_included = match value.to_ascii_uppercase().as_str() {
                    "NONE" => false,
                    "INCLUDE" => true,
                    _ => {
                        let supported = "NONE, INCLUDE; not a file of its own";
                        let fault = Fault::Unsupported { found: excerpt(value), supported };
                        return Err(PhotometricFileError::new(file, line, "TILT", fault));
                    }
                };
                return Ok((header, Fields::new(file, line, lines)));
            }
            match edition(content) {
                Some(Some(format)) if line == 1 => header.format = format,
                Some(None) if line == 1 => {
                    let fault = Fault::Unsupported { found: excerpt(content), supported: EDITIONS };
                    return Err(PhotometricFileError::new(file, line, "edition", fault));
                }
                _ => header.labels.push(content.to_owned()),
            }
        }
        Err(PhotometricFileError::new(file, last, "TILT", Fault::Truncated))
    }
}

/// The edition that a first line names, `Some(None)` for one that is not known; `None` for a label.
fn edition(line: &str) -> Option<Option<Format>> {
    let name = line.trim().to_ascii_uppercase();
    let known = match name.as_str() {
        "IESNA86" | "IESNA:LM-63-1986" => Format::Ies1986,
        "IESNA91" | "IESNA:LM-63-1991" => Format::Ies1991,
        "IESNA:LM-63-1995" => Format::Ies1995,
        "IESNA:LM-63-2002" => Format::Ies2002,
        "IES:LM-63-2019" | "IESNA:LM-63-2019" => Format::Ies2019,
        _ if name.starts_with("IESNA:") || name.starts_with("IES:") => return Some(None),
        _ => return None,
    };
    Some(Some(known))
}

/// What stands behind `TILT=`.
pub(super) fn tilt_value(line: &str) -> Option<&str> {
    let (word, rest) = line.trim_start().split_at_checked(4)?;
    if !word.eq_ignore_ascii_case("TILT") {
        return None;
    }
    rest.trim_start().strip_prefix('=').map(str::trim)
}

fn tilt(fields: &mut Fields<'_>) -> Result<Tilt> {
    let geometry = fields.code("lamp-to-luminaire geometry", "1, 2 or 3", &[1.0, 2.0, 3.0])?;
    let count = fields.whole("number of tilt angles", 1.0)?;
    let mut angles = Vec::new();
    for index in indices(count) {
        let angle = fields.number(|| format!("tilt angle {}", index + 1))?;
        if let Some(&before) = angles.last()
            && angle <= before
        {
            return Err(
                fields.fault(&format!("tilt angle {}", index + 1), Fault::NotIncreasing { value: angle, before })
            );
        }
        angles.push(angle);
    }
    let mut factors = Vec::new();
    for index in indices(count) {
        let factor = fields.number(|| format!("tilt factor {}", index + 1))?;
        if factor < 0.0 {
            let fault = Fault::Domain { value: factor, wanted: "zero or positive" };
            return Err(fields.fault(&format!("tilt factor {}", index + 1), fault));
        }
        factors.push(factor);
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1, 2 or 3")]
    let geometry = geometry as u8;
    Ok(Tilt { geometry, angles, factors })
}

/// The indices of a counted list; counts were checked by [`Fields::whole`].
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number that fits")]
fn indices(count: f64) -> core::ops::Range<usize> {
    0..count as usize
}

/// The numbers of a file, one after the other.
struct Fields<'t> {
    file: &'t str,
    /// The line of the last field, or the last line.
    line: u32,
    lines: Box<dyn Iterator<Item = (u32, &'t str)> + 't>,
    /// What is left of the line.
    rest: Box<dyn Iterator<Item = &'t str> + 't>,
}

impl<'t> Fields<'t> {
    fn new(file: &'t str, line: u32, lines: impl Iterator<Item = (u32, &'t str)> + 't) -> Self {
        Self { file, line, lines: Box::new(lines), rest: Box::new(core::iter::empty()) }
    }

    fn token(&mut self) -> Option<&'t str> {
        loop {
            if let Some(token) = self.rest.next() {
                return Some(token);
            }
            let (line, content) = self.lines.next()?;
            self.line = line;
            let separates = |c: char| c.is_whitespace() || c == ',';
            self.rest = Box::new(content.split(separates).filter(|token| !token.is_empty()));
        }
    }

    fn fault(&self, field: &str, fault: Fault) -> PhotometricFileError {
        PhotometricFileError::new(self.file, self.line, field, fault)
    }

    /// The next number, finite; the field's name is made only when it is needed.
    fn number(&mut self, field: impl Fn() -> String) -> Result<f64> {
        let Some(token) = self.token() else { return Err(self.fault(&field(), Fault::Truncated)) };
        match token.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(self.fault(&field(), Fault::NotFinite(excerpt(token)))),
            Err(_) => Err(self.fault(&field(), Fault::NotANumber(excerpt(token)))),
        }
    }

    fn checked(&mut self, field: &str, wanted: &'static str, holds: impl Fn(f64) -> bool) -> Result<f64> {
        let value = self.number(|| field.to_owned())?;
        if holds(value) { Ok(value) } else { Err(self.fault(field, Fault::Domain { value, wanted })) }
    }

    fn positive(&mut self, field: &str) -> Result<f64> {
        self.checked(field, "positive", |v| v > 0.0)
    }

    /// A whole number from `least`, small enough for any list in a file.
    fn whole(&mut self, field: &str, least: f64) -> Result<f64> {
        let value = self.number(|| field.to_owned())?;
        if value.fract() != 0.0 {
            return Err(self.fault(field, Fault::NotWhole(value)));
        }
        let wanted = if least == 2.0 { "from 2 to 1000000" } else { "from 1 to 1000000" };
        if value >= least && value <= 1e6 { Ok(value) } else { Err(self.fault(field, Fault::Domain { value, wanted })) }
    }

    /// A number that stands for one of several things.
    fn code(&mut self, field: &str, supported: &'static str, codes: &[f64]) -> Result<f64> {
        let value = self.number(|| field.to_owned())?;
        if codes.contains(&value) {
            return Ok(value);
        }
        Err(self.fault(field, Fault::Unsupported { found: value.to_string(), supported }))
    }

    /// Angles and candela.
    fn table(&mut self, gamma_count: f64, plane_count: f64, factor: f64) -> Result<LuminousIntensity> {
        let (gammas, gamma_lines) = self.list(gamma_count, |index| format!("vertical angle {}", index + 1))?;
        let (planes, plane_lines) = self.list(plane_count, |index| format!("horizontal angle {}", index + 1))?;
        let (mut candela, mut candela_lines) = (Vec::new(), Vec::new());
        for plane in &planes {
            for gamma in &gammas {
                candela.push(self.number(|| candela_field(*plane, *gamma))? * factor);
                candela_lines.push(self.line);
            }
        }
        let (file, last) = (self.file, self.line);
        LuminousIntensity::table(planes.clone(), gammas.clone(), candela).map_err(|error| {
            let lines = Lines { planes: &plane_lines, gammas: &gamma_lines, candela: &candela_lines, last };
            let (line, field) = lines.of(&error, &planes, &gammas, ["vertical", "horizontal"]);
            PhotometricFileError::new(file, line, field, Fault::from(&error))
        })
    }

    fn list(&mut self, count: f64, field: impl Fn(usize) -> String) -> Result<(Vec<f64>, Vec<u32>)> {
        let (mut values, mut lines) = (Vec::new(), Vec::new());
        for index in indices(count) {
            values.push(self.number(|| field(index))?);
            lines.push(self.line);
        }
        Ok((values, lines))
    }

    fn end(mut self) -> Result<()> {
        match self.token() {
            None => Ok(()),
            Some(token) => Err(self.fault("", Fault::Trailing(excerpt(token)))),
        }
    }
}

pub(super) fn candela_field(plane: f64, gamma: f64) -> String {
    format!("candela at C {plane:?}, γ {gamma:?}").replace(".0,", ",").trim_end_matches(".0").to_owned()
}

/// The lines on which a table's values stand.
pub(super) struct Lines<'a> {
    pub(super) planes: &'a [u32],
    pub(super) gammas: &'a [u32],
    pub(super) candela: &'a [u32],
    pub(super) last: u32,
}

impl Lines<'_> {
    /// Line and field of what is wrong with a table; `names` are the format's for γ and C.
    pub(super) fn of(&self, error: &IntensityError, planes: &[f64], gammas: &[f64], names: [&str; 2]) -> (u32, String) {
        let line = |lines: &[u32], index: usize| lines.get(index).copied().unwrap_or(self.last);
        let angle = |angles: &[f64], index: usize| angles.get(index).copied().unwrap_or(f64::NAN);
        let place = match error {
            IntensityError::NotFinite { place, .. }
            | IntensityError::Negative { place, .. }
            | IntensityError::NotIncreasing { place, .. } => *place,
            IntensityError::PlaneRange { .. } => {
                return (line(self.planes, planes.len().saturating_sub(1)), format!("{} angles", names[1]));
            }
            IntensityError::GammaRange { .. } => {
                return (line(self.gammas, gammas.len().saturating_sub(1)), format!("{} angles", names[0]));
            }
            IntensityError::Counts { .. } | IntensityError::Flux => return (self.last, "candela".to_owned()),
        };
        match place {
            Place::Gamma(index) => (line(self.gammas, index), format!("{} angle {}", names[0], index + 1)),
            Place::Plane(index) => (line(self.planes, index), format!("{} angle {}", names[1], index + 1)),
            Place::Candela(plane, row) => {
                let at = plane * gammas.len() + row;
                (line(self.candela, at), candela_field(angle(planes, plane), angle(gammas, row)))
            }
        }
    }
}
