//! Writing IES LM-63-2002.

use core::fmt::Write;

use super::file::PhotometricFile;
use super::ies::tilt_value;

/// Values on a line.
const PER_LINE: usize = 10;

impl PhotometricFile {
    /// The file as IES LM-63-2002 text, type C, in metres, with all factors in the candela.
    ///
    /// Reading it gives the same intensities, labels, lamps, opening and tilt to the bit; idealised sources are
    /// [tabulated](super::LuminousIntensity::tabulated), and of EULUMDAT's lamp sets the first is written. Labels that would
    /// be something else to a reader (`TILT=…`) are left out, control characters in them become spaces.
    #[must_use]
    pub fn to_ies(&self) -> String {
        let mut text = "IESNA:LM-63-2002\n".to_owned();
        let plain = |label: &String| label.replace(char::is_control, " ");
        for label in self.labels.iter().map(plain).filter(|label| tilt_value(label).is_none()) {
            text.push_str(&label);
            text.push('\n');
        }
        match &self.tilt {
            None => text.push_str("TILT=NONE\n"),
            Some(tilt) => {
                put(&mut text, format_args!("TILT=INCLUDE\n{}\n{}\n", tilt.geometry, tilt.angles.len()));
                list(&mut text, &tilt.angles);
                list(&mut text, &tilt.factors);
            }
        }
        let tabulated = self.intensity.tabulated();
        let Some((planes, gammas, candela)) = tabulated.as_table() else { return text };
        let lamps = self.lamp_sets.first();
        let number = lamps.map_or(1, |set| set.number);
        let lumens = lamps.and_then(|set| set.lumens_per_lamp).unwrap_or(-1.0);
        let watts = lamps.map_or(0.0, |set| set.watts);
        let opening = &self.opening;
        put(&mut text, format_args!("{number} {} 1 {} {} 1 2 ", Number(lumens), gammas.len(), planes.len()));
        list(&mut text, &[opening.width, opening.length, opening.height]);
        put(&mut text, format_args!("1 1 {}\n", Number(watts)));
        list(&mut text, gammas);
        list(&mut text, planes);
        for plane in candela.chunks(gammas.len().max(1)) {
            list(&mut text, plane);
        }
        text
    }
}

fn list(text: &mut String, values: &[f64]) {
    for line in values.chunks(PER_LINE) {
        for (index, value) in line.iter().enumerate() {
            put(text, format_args!("{}{}", if index == 0 { "" } else { " " }, Number(*value)));
        }
        text.push('\n');
    }
}

fn put(text: &mut String, arguments: core::fmt::Arguments<'_>) {
    // Writing to a string doesn't fail.
    let _ = text.write_fmt(arguments);
}

/// The shortest decimals that are read back as the same number, without `.0`.
struct Number(f64);

impl core::fmt::Display for Number {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-6..1e15).contains(&size) { write!(f, "{}", self.0) } else { write!(f, "{:e}", self.0) }
    }
}
