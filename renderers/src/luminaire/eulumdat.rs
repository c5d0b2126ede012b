//! EULUMDAT, `.ldt`: one field on each line (Stockmar 1990, "EULUMDAT – ein Leuchtendatenformat für den europäischen
//! Beleuchtungsplaner").

use super::error::{Fault, PhotometricFileError, excerpt};
use super::file::{Format, LampSet, Opening, PhotometricFile, check_size};
use super::ies::Lines;
use super::intensity::LuminousIntensity;

/// The largest count of planes, angles or lamp sets: more than any file within the limit can hold lines.
const MOST: u32 = 1_000_000;
const METRES_PER_MILLIMETRE: f64 = 1e-3;
const LUMENS_PER_KILOLUMEN: f64 = 1000.0;
/// Direct ratios for ten room indices.
const ROOM_INDICES: usize = 10;

type Result<T> = core::result::Result<T, PhotometricFileError>;

/// Parses an EULUMDAT text; `file` is its name for messages.
///
/// One value stands on each line, with a decimal point or comma; the lamps' six fields stand in groups, one line for each
/// set. Intensities in cd/klm become cd by the flux of the first set and the conversion factor. A negative number of lamps
/// is absolute photometry. All five symmetries are read; Isym 3, which writes the planes 270 to 90, is turned into its
/// mirror image 90 to 270. Blank lines stand for 0 where a number has no effect on the intensity.
///
/// # Errors
/// [`PhotometricFileError`] with line and field, as [`parse_ies`](super::parse_ies) has; planes that do not begin with 0 or
/// don't hold those that the symmetry needs.
pub fn parse(file: &str, text: &str) -> Result<PhotometricFile> {
    check_size(file, text.len())?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text).trim_end_matches(['\u{1a}', '\0']);
    let mut reader = Reader { file, line: 0, lines: text.lines() };
    let company = reader.text("company identification")?;
    reader.whole("type indicator", 0, 3)?;
    let symmetry = reader.whole("symmetry indicator", 0, 4)?;
    let plane_count = reader.whole("number of C-planes", 1, MOST)?;
    let planes_line = reader.line;
    reader.size("distance between C-planes")?;
    let gamma_count = reader.whole("number of intensities in a C-plane", 2, MOST)?;
    reader.size("distance between intensities")?;
    let labels = reader.labels(company)?;
    let opening = reader.opening()?;
    let downward = reader.size("downward flux fraction")?;
    let output_ratio = reader.size("light output ratio")?;
    let conversion = reader.positive("conversion factor")?;
    reader.extra("tilt during measurement")?;
    let (lamp_sets, flux) = reader.lamp_sets()?;
    for index in 0..ROOM_INDICES {
        reader.extra(&format!("direct ratio {}", index + 1))?;
    }
    let stored = Stored::new(file, symmetry, plane_count, planes_line)?;
    let intensity = reader.table(&stored, plane_count, gamma_count, conversion * flux / LUMENS_PER_KILOLUMEN)?;
    reader.end()?;
    let percent = |value: f64| (value > 0.0).then_some(value / 100.0);
    Ok(PhotometricFile {
        format: Format::Eulumdat,
        intensity,
        labels,
        lamp_sets,
        opening,
        tilt: None,
        stated_flux: percent(output_ratio).map(|ratio| ratio * flux),
        // 0 is a luminaire that shines up, or a field that was not filled in.
        stated_downward_fraction: percent(downward),
    })
}

/// Which planes of the list have intensities.
struct Stored {
    symmetry: u32,
    /// Index of the first, counted on around the circle.
    first: usize,
    count: usize,
    /// Planes by index that the symmetry needs, and their angles.
    needed: Vec<(usize, f64)>,
}

impl Stored {
    fn new(file: &str, symmetry: u32, planes: u32, line: u32) -> Result<Self> {
        let (divisor, wanted) = match symmetry {
            2 => (2, "even for symmetry 2"),
            3 | 4 => (4, "a multiple of 4 for symmetries 3 and 4"),
            _ => (1, ""),
        };
        if !planes.is_multiple_of(divisor) {
            let fault = Fault::Domain { value: f64::from(planes), wanted };
            return Err(PhotometricFileError::new(file, line, "number of C-planes", fault));
        }
        let all = usize::try_from(planes).unwrap_or(usize::MAX);
        let (first, count, needed) = match symmetry {
            0 => (0, all, vec![]),
            1 => (0, 1, vec![]),
            2 => (0, all / 2 + 1, vec![(all / 2, 180.0)]),
            3 => (3 * all / 4, all / 2 + 1, vec![(all / 4, 90.0), (3 * all / 4, 270.0)]),
            _ => (0, all / 4 + 1, vec![(all / 4, 90.0)]),
        };
        Ok(Self { symmetry, first, count, needed })
    }
}

/// The lines of a file, one after the other.
struct Reader<'t> {
    file: &'t str,
    /// The last line that was read.
    line: u32,
    lines: core::str::Lines<'t>,
}

impl<'t> Reader<'t> {
    fn fault(&self, field: &str, fault: Fault) -> PhotometricFileError {
        PhotometricFileError::new(self.file, self.line.max(1), field, fault)
    }

    fn text(&mut self, field: &str) -> Result<&'t str> {
        let Some(content) = self.lines.next() else { return Err(self.fault(field, Fault::Truncated)) };
        self.line += 1;
        Ok(content.trim())
    }

    fn number(&mut self, field: &str) -> Result<f64> {
        let text = self.text(field)?;
        self.parse(field, text)
    }

    fn parse(&self, field: &str, text: &str) -> Result<f64> {
        match text.replace(',', ".").parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(self.fault(field, Fault::NotFinite(excerpt(text)))),
            Err(_) => Err(self.fault(field, Fault::NotANumber(excerpt(text)))),
        }
    }

    /// A number without effect on the intensity, which may be left out.
    fn extra(&mut self, field: &str) -> Result<f64> {
        let text = self.text(field)?;
        if text.is_empty() { Ok(0.0) } else { self.parse(field, text) }
    }

    /// The same for what can't be negative.
    fn size(&mut self, field: &str) -> Result<f64> {
        let value = self.extra(field)?;
        if value >= 0.0 {
            Ok(value)
        } else {
            Err(self.fault(field, Fault::Domain { value, wanted: "zero or positive" }))
        }
    }

    fn positive(&mut self, field: &str) -> Result<f64> {
        let value = self.number(field)?;
        if value > 0.0 { Ok(value) } else { Err(self.fault(field, Fault::Domain { value, wanted: "positive" })) }
    }

    fn integer(&mut self, field: &str) -> Result<f64> {
        let value = self.number(field)?;
        if value.fract() == 0.0 { Ok(value) } else { Err(self.fault(field, Fault::NotWhole(value))) }
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number within bounds")]
    fn whole(&mut self, field: &str, least: u32, most: u32) -> Result<u32> {
        let value = self.integer(field)?;
        if (f64::from(least)..=f64::from(most)).contains(&value) {
            return Ok(value as u32);
        }
        let wanted = match (least, most) {
            (0, 3) => "from 0 to 3",
            (0, 4) => "from 0 to 4",
            (2, _) => "from 2 to 1000000",
            _ => "from 1 to 1000000",
        };
        Err(self.fault(field, Fault::Domain { value, wanted }))
    }

    /// The five lines of names, as the keywords of LM-63.
    fn labels(&mut self, company: &str) -> Result<Vec<String>> {
        let mut labels = vec![format!("[MANUFAC] {company}")];
        for (field, keyword) in [
            ("measurement report number", "TEST"),
            ("luminaire name", "LUMINAIRE"),
            ("luminaire number", "LUMCAT"),
            ("file name", "OTHER"),
            ("date and user", "ISSUEDATE"),
        ] {
            let text = self.text(field)?;
            labels.push(format!("[{keyword}] {text}").trim_end().to_owned());
        }
        Ok(labels)
    }

    fn opening(&mut self) -> Result<Opening> {
        for field in ["length of luminaire", "width of luminaire", "height of luminaire"] {
            self.size(field)?;
        }
        let length = self.size("length of luminous area")? * METRES_PER_MILLIMETRE;
        let width = self.size("width of luminous area")? * METRES_PER_MILLIMETRE;
        let mut height = 0.0_f64;
        for field in ["C0", "C90", "C180", "C270"] {
            height = height.max(self.size(&format!("height of luminous area, {field}-plane"))?);
        }
        let height = height * METRES_PER_MILLIMETRE;
        // The length runs in C90–C270 here; a width of 0 says that it is a diameter.
        Ok(if width == 0.0 {
            Opening { width: -length, length: -length, height }
        } else {
            Opening { width: length, length: width, height }
        })
    }

    /// The sets, and the flux of the first one's lamps (of the luminaire, if photometry is absolute).
    fn lamp_sets(&mut self) -> Result<(Vec<LampSet>, f64)> {
        let count = self.whole("number of lamp sets", 1, MOST)?;
        let mut numbers = Vec::new();
        for _ in 0..count {
            let number = self.integer("number of lamps")?;
            if number == 0.0 || number.abs() > f64::from(MOST) {
                return Err(self
                    .fault("number of lamps", Fault::Domain { value: number, wanted: "neither 0 nor above 1000000" }));
            }
            numbers.push(number);
        }
        let mut kinds = Vec::new();
        for _ in 0..count {
            kinds.push(self.text("type of lamps")?.to_owned());
        }
        let mut fluxes = Vec::new();
        for _ in 0..count {
            fluxes.push(self.positive("flux of lamps")?);
        }
        for field in ["colour of lamps", "colour rendering of lamps"] {
            for _ in 0..count {
                self.text(field)?;
            }
        }
        let first = fluxes.first().copied().unwrap_or(0.0);
        let mut sets = Vec::new();
        for ((number, kind), flux) in numbers.into_iter().zip(kinds).zip(fluxes) {
            let watts = self.size("wattage")?;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number within bounds")]
            let lamps = number.abs() as u32;
            let lumens_per_lamp = (flux / number > 0.0).then_some(flux / number);
            sets.push(LampSet { number: lamps, lumens_per_lamp, watts, kind, factor: flux / first });
        }
        Ok((sets, first))
    }

    fn table(&mut self, stored: &Stored, planes: u32, gammas: u32, factor: f64) -> Result<LuminousIntensity> {
        let (all, all_lines) = self.list("C angle", planes)?;
        self.check_planes(&all, &all_lines, stored)?;
        let (gammas, gamma_lines) = self.list("G angle", gammas)?;
        let (mut candela, mut candela_lines) = (Vec::new(), Vec::new());
        let mut order: Vec<usize> = (0..stored.count).map(|index| (stored.first + index) % all.len()).collect();
        for plane in &order {
            for gamma in &gammas {
                candela.push(self.number(&super::ies::candela_field(all[*plane], *gamma))? * factor);
                candela_lines.push(self.line);
            }
        }
        let mut planes: Vec<f64> = order.iter().map(|plane| all[*plane]).collect();
        let rows = gammas.len();
        match stored.symmetry {
            0 => {
                // The circle closes with the first plane.
                planes.push(360.0);
                order.push(0);
                candela.extend_from_within(..rows);
                candela_lines.extend_from_within(..rows);
            }
            3 => {
                // I(C) = I(180° − C): 270, …, 0, …, 90 are 270, …, 180, …, 90 again.
                for c in &mut planes {
                    *c = if *c >= 270.0 { 540.0 - *c } else { 180.0 - *c };
                }
                planes.reverse();
                order.reverse();
                candela = candela.chunks(rows).rev().flatten().copied().collect();
                candela_lines = candela_lines.chunks(rows).rev().flatten().copied().collect();
            }
            _ => {}
        }
        let plane_lines: Vec<u32> = order.iter().map(|plane| all_lines[*plane]).collect();
        let (file, last) = (self.file, self.line);
        LuminousIntensity::table(planes.clone(), gammas.clone(), candela).map_err(|error| {
            let lines = Lines { planes: &plane_lines, gammas: &gamma_lines, candela: &candela_lines, last };
            let (line, field) = lines.of(&error, &planes, &gammas, ["G", "C"]);
            PhotometricFileError::new(file, line, field, Fault::from(&error))
        })
    }

    fn list(&mut self, field: &str, count: u32) -> Result<(Vec<f64>, Vec<u32>)> {
        let (mut values, mut lines) = (Vec::new(), Vec::new());
        for index in 0..count {
            values.push(self.number(&format!("{field} {}", index + 1))?);
            lines.push(self.line);
        }
        Ok((values, lines))
    }

    /// The list of planes: from 0, increasing, below 360, with those that the symmetry needs in their places.
    fn check_planes(&self, planes: &[f64], lines: &[u32], stored: &Stored) -> Result<()> {
        let fail = |index: usize, fault| {
            let line = lines.get(index).copied().unwrap_or(self.line);
            Err(PhotometricFileError::new(self.file, line, format!("C angle {}", index + 1), fault))
        };
        for (index, &value) in planes.iter().enumerate() {
            if index == 0 && value != 0.0 {
                return fail(index, Fault::Domain { value, wanted: "0, where the planes begin" });
            }
            if let Some(&before) = index.checked_sub(1).and_then(|i| planes.get(i))
                && value <= before
            {
                return fail(index, Fault::NotIncreasing { value, before });
            }
            if value >= 360.0 {
                return fail(index, Fault::Domain { value, wanted: "below 360" });
            }
        }
        for &(index, angle) in &stored.needed {
            let value = planes.get(index).copied().unwrap_or(f64::NAN);
            if value != angle {
                let wanted = match index {
                    _ if angle == 180.0 => "180, half of the planes on, for symmetry 2",
                    _ if angle == 270.0 => "270, three quarters of the planes on, for symmetry 3",
                    _ => "90, a quarter of the planes on, for symmetries 3 and 4",
                };
                return fail(index, Fault::Domain { value, wanted });
            }
        }
        Ok(())
    }

    fn end(mut self) -> Result<()> {
        while let Some(content) = self.lines.next() {
            self.line += 1;
            if !content.trim().is_empty() {
                return Err(self.fault("", Fault::Trailing(excerpt(content.trim()))));
            }
        }
        Ok(())
    }
}
