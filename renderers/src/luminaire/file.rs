//! What photometric files say beside the distribution, and reading either format.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::error::{Fault, PhotometricFileError};
use super::{LARGEST_FILE, LuminousIntensity, parse_eulumdat, parse_ies};

/// A photometric file: an absolute luminous intensity distribution and what belongs to it.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotometricFile {
    /// The format and edition that it was read from.
    pub format: Format,
    /// Absolute intensity in cd, with all factors of the file applied; of EULUMDAT's lamp sets, with the first.
    pub intensity: LuminousIntensity,
    /// Lines of text before `TILT=`, such as `[LUMINAIRE] name`, without the edition; made of the fields for EULUMDAT.
    pub labels: Vec<String>,
    /// Lamps that the luminaire may have; at least one.
    pub lamp_sets: Vec<LampSet>,
    /// The luminous opening.
    pub opening: Opening,
    /// How the flux depends on the tilt of the luminaire, if the file has it. It is not applied to the intensity, which is
    /// that of the position in which the luminaire was measured.
    pub tilt: Option<Tilt>,
    /// The luminaire's flux in lm that the file states: EULUMDAT's light output ratio times the lamps' flux. IES has none.
    pub stated_flux: Option<f64>,
    /// The share of the flux below the horizontal that the file states: EULUMDAT's DFF, as a fraction.
    pub stated_downward_fraction: Option<f64>,
}

/// Format and edition of a photometric file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// LM-63-1986, which has no first line of its own.
    Ies1986,
    /// LM-63-1991, `IESNA91`.
    Ies1991,
    /// LM-63-1995.
    Ies1995,
    /// LM-63-2002.
    Ies2002,
    /// LM-63-2019.
    Ies2019,
    /// EULUMDAT.
    Eulumdat,
}

/// A set of lamps.
#[derive(Clone, Debug, PartialEq)]
pub struct LampSet {
    /// How many lamps, at least 1.
    pub number: u32,
    /// Rated flux of one lamp in lm, positive; `None` for absolute photometry.
    pub lumens_per_lamp: Option<f64>,
    /// Electric power with ballast in W.
    pub watts: f64,
    /// EULUMDAT's lamp type; empty for IES.
    pub kind: String,
    /// What the intensity is multiplied by for this set: 1 for the first.
    pub factor: f64,
}

/// The luminous opening as LM-63 writes it, in metres: negative numbers and zeros stand for round shapes and for points, as
/// the edition defines. `length` is along C0–C180, `width` along C90–C270.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Opening {
    /// Along C90–C270, m.
    pub width: f64,
    /// Along C0–C180, m.
    pub length: f64,
    /// Along the vertical, m.
    pub height: f64,
}

/// Flux of a tilted luminaire relative to the upright one.
#[derive(Clone, Debug, PartialEq)]
pub struct Tilt {
    /// LM-63's lamp-to-luminaire geometry: 1 (lamp vertical), 2 or 3 (lamp horizontal).
    pub geometry: u8,
    /// Angles of tilt in degrees, increasing.
    pub angles: Vec<f64>,
    /// A factor for each angle.
    pub factors: Vec<f64>,
}

/// The flux of a distribution against what its file says of it; differences are reported, not refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluxCheck {
    /// Integrated flux, lm.
    pub flux: f64,
    /// Stated flux of the luminaire, lm.
    pub stated_flux: Option<f64>,
    /// Rated flux of all lamps, lm.
    pub lamp_flux: Option<f64>,
    /// Integrated flux over the lamps' flux; above 1 something is wrong.
    pub output_ratio: Option<f64>,
    /// Integrated share of the flux below the horizontal; NaN without flux.
    pub downward_fraction: f64,
    /// Stated share.
    pub stated_downward_fraction: Option<f64>,
}

impl PhotometricFile {
    /// A file, as [`Format::Ies2002`] with absolute photometry, for a distribution that comes from elsewhere.
    #[must_use]
    pub fn new(intensity: LuminousIntensity, luminaire: &str) -> Self {
        let labels = ["[TEST] computed", "[TESTLAB] none", "[ISSUEDATE] none", "[MANUFAC] none"].map(str::to_owned);
        let mut labels = labels.to_vec();
        labels.push(format!("[LUMINAIRE] {luminaire}"));
        Self {
            format: Format::Ies2002,
            intensity,
            labels,
            lamp_sets: vec![LampSet { number: 1, lumens_per_lamp: None, watts: 0.0, kind: String::new(), factor: 1.0 }],
            opening: Opening::default(),
            tilt: None,
            stated_flux: None,
            stated_downward_fraction: None,
        }
    }

    /// The integrated flux against the file's figures.
    #[must_use]
    pub fn flux_check(&self) -> FluxCheck {
        let flux = self.intensity.flux();
        let lamps = self.lamp_sets.first();
        let lamp_flux = lamps.and_then(|set| Some(f64::from(set.number) * set.lumens_per_lamp?));
        FluxCheck {
            flux,
            stated_flux: self.stated_flux,
            lamp_flux,
            output_ratio: lamp_flux.map(|rated| flux / rated),
            downward_fraction: self.intensity.zonal_flux(0.0, 90.0) / flux,
            stated_downward_fraction: self.stated_downward_fraction,
        }
    }
}

/// Parses the text of a file whose name ends in `.ies` or `.ldt`, in any case of letters.
///
/// # Errors
/// Another ending, and as [`parse_ies`] and [`parse_eulumdat`].
pub fn parse(file: &str, text: &str) -> Result<PhotometricFile, PhotometricFileError> {
    let extension = Path::new(file).extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "ies" => parse_ies(file, text),
        "ldt" => parse_eulumdat(file, text),
        _ => {
            let fault = Fault::Unsupported { found: extension, supported: "ies, ldt" };
            Err(PhotometricFileError::new(file, 0, "file name extension", fault))
        }
    }
}

/// Reads a file by its ending, as [`parse`] does. Bytes that are not UTF-8 (in names, most often) are replaced.
///
/// # Errors
/// A file that can't be read or is larger than [`LARGEST_FILE`], and as [`parse`].
pub fn read(path: &Path) -> Result<PhotometricFile, PhotometricFileError> {
    let file = path.display().to_string();
    let limit = u64::try_from(LARGEST_FILE).unwrap_or(u64::MAX);
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|opened| opened.take(limit.saturating_add(1)).read_to_end(&mut bytes))
        .map_err(|error| PhotometricFileError::new(&file, 0, "", Fault::Unreadable(error.to_string())))?;
    check_size(&file, bytes.len())?;
    parse(&file, &String::from_utf8_lossy(&bytes))
}

pub(super) fn check_size(file: &str, bytes: usize) -> Result<(), PhotometricFileError> {
    if bytes <= LARGEST_FILE { Ok(()) } else { Err(PhotometricFileError::new(file, 0, "", Fault::TooLarge)) }
}
