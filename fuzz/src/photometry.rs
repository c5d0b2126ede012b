//! Photometric files.

use renderers::luminaire::{
    Format, LuminousIntensity, PhotometricFile, PhotometricFileError, parse_eulumdat, parse_ies,
};

/// Reads the bytes as an IES LM-63 file: what is accepted must be a distribution, and be read as the same once written.
pub fn ies_file(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    judge("fuzz.ies", &text, parse_ies("fuzz.ies", &text));
}

/// The same for EULUMDAT.
pub fn ldt_file(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    judge("fuzz.ldt", &text, parse_eulumdat("fuzz.ldt", &text));
}

fn judge(name: &str, text: &str, found: Result<PhotometricFile, PhotometricFileError>) {
    match found {
        Err(error) => {
            let message = error.to_string();
            super::assert_one_line(&message);
            assert!(message.starts_with(&format!("{name}:{}: ", error.line)), "{message}");
            let lines = text.lines().count().max(1);
            assert!((1..=lines).contains(&(error.line as usize)), "line {} of {lines}: {message}", error.line);
        }
        Ok(file) => {
            check(&file.intensity);
            check_written(file);
        }
    }
}

/// Finite, within the peak, and of a flux that a source of the peak in every direction is not below.
fn check(intensity: &LuminousIntensity) {
    let (peak, flux) = (intensity.peak(), intensity.flux());
    assert!(peak >= 0.0 && peak.is_finite() && flux >= 0.0 && flux.is_finite());
    assert!(flux <= 4.0 * core::f64::consts::PI * peak * (1.0 + 1e-12) + f64::MIN_POSITIVE, "{flux} of {peak}");
    for c in [-90.0, -1e-300, 0.0, 10.0, 90.0, 179.9, 180.0, 222.2, 300.0, 360.0, 1e300] {
        for gamma in [-1.0, 0.0, 1e-300, 44.4, 90.0, 90.1, 180.0, 181.0] {
            let candela = intensity.candela(c, gamma);
            let most = peak * (1.0 + 1e-15);
            assert!((0.0..=most).contains(&candela), "{candela} at C {c}, γ {gamma}, of {peak}");
        }
    }
}

fn check_written(file: PhotometricFile) {
    let written = file.to_ies();
    let again = parse_ies("again.ies", &written).unwrap_or_else(|error| panic!("{error}\n{written}"));
    assert_eq!(again.intensity, file.intensity);
    if file.format != Format::Eulumdat {
        // What a control character kept from being the line of the tilt is left out.
        let is_tilt = |l: &String| {
            let upper = l.trim_start().to_ascii_uppercase();
            upper.strip_prefix("TILT").is_some_and(|rest| rest.trim_start().starts_with('='))
        };
        let plain = file.labels.iter().map(|l| l.replace(char::is_control, " ").trim_end().to_owned());
        let labels = plain.filter(|l| !is_tilt(l)).collect();
        assert_eq!(again, PhotometricFile { format: Format::Ies2002, labels, ..file });
    }
}
