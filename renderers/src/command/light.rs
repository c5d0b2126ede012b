//! `spectral light`: everything there is to say of a light.

use std::path::{Path, PathBuf};

use clap::Args;
use renderers::light::{LightReport, SpectralTable, plot, read_light, report};
use renderers::report::Table;
use serde_json::json;
use spectral_core::tables::{UniformTable, find_light, lights};

use super::{Answer, Failure};

/// What `spectral light` takes.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A built-in light such as FL2 or D65, or a file: two columns of wavelength in nm and power, or TM-27 XML.
    ///
    /// A file that is named like a built-in light is meant when it is written with a folder, ./FL2.
    #[arg(value_name = "SPD", required_unless_present = "list")]
    light: Option<String>,
    /// List the built-in lights.
    #[arg(long, conflicts_with_all = ["light", "plot"])]
    list: bool,
    /// Draw spectrum, chromaticity and test samples into a PNG file.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

impl Arguments {
    pub(super) fn run(self) -> Result<Answer, Failure> {
        let Some(name) = self.light else { return Ok(list()) };
        let found = report(&name, &table(&name)?).map_err(|error| Failure(format!("{name}: {error}")))?;
        let mut text = describe(&found);
        let mut json = serde_json::to_value(&found)?;
        let mut files = Vec::new();
        if let Some(path) = &self.plot {
            plot(&found, path)?;
            text += &format!("\n{}\n", path.display());
            files.push(path.display().to_string());
        }
        if let Some(object) = json.as_object_mut() {
            object.insert("files".to_owned(), json!(files));
        }
        Ok(Answer { text, json })
    }
}

fn table(name: &str) -> Result<SpectralTable, Failure> {
    if let Some(table) = find_light(name) {
        return Ok(SpectralTable::from(table));
    }
    let path = Path::new(name);
    if !path.exists() {
        return Err(Failure(format!("{name}: no such file, and no built-in light (spectral light --list)")));
    }
    Ok(read_light(path)?)
}

fn list() -> Answer {
    let last =
        |table: &UniformTable| usize::from(table.first) + usize::from(table.step) * (table.samples.double.len() - 1);
    let mut shown = Table::new(["light", "from (nm)", "to (nm)", "step (nm)"]);
    let mut all = Vec::new();
    for table in lights() {
        let [first, last, step] = [usize::from(table.first), last(table), usize::from(table.step)];
        shown.row([table.name.to_owned(), first.to_string(), last.to_string(), step.to_string()]);
        all.push(json!({ "name": table.name, "first": first, "last": last, "step": step }));
    }
    Answer { text: shown.to_string(), json: json!({ "lights": all }) }
}

fn describe(found: &LightReport) -> String {
    let grid = &found.grid;
    let last = usize::from(grid.first) + usize::from(grid.step) * (grid.count - 1);
    let summed = format!("sums over {}–{last} nm at {} nm: {}", grid.first, grid.step, grid.from);
    let quantities = quantities(found);
    let specials = specials(found);
    format!("{}, {summed}\n\n{quantities}\n{specials}{}", found.light, note(found))
}

fn quantities(found: &LightReport) -> Table {
    let mut table = Table::new(["quantity", "value", ""]);
    let mut row = |name: &str, value: String, note: &str| {
        table.row([name, value.as_str(), note]);
    };
    let index = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"));
    let worth = if found.cct_status == "valid" { "" } else { found.cct_status };
    row("colour temperature", format!("{:.1} K", found.cct), worth);
    row("Duv", format!("{:+.5}", found.duv), "");
    row("x", format!("{:.5}", found.xy[0]), "");
    row("y", format!("{:.5}", found.xy[1]), "");
    row("luminous efficacy", format!("{:.1} lm/W", found.luminous_efficacy), "of radiation");
    let reference = found.reference.as_ref().map_or_else(
        || "no reference light at this colour temperature".to_owned(),
        |reference| format!("reference: {} {:.0} K", reference.kind, reference.temperature),
    );
    row("Ra", index(found.ra), &reference);
    row("CRI00, Munsell", index(found.cri00_munsell), "");
    row("CRI00, ColorChecker", index(found.cri00_colorchecker), "substitute samples");
    let nearest = &found.r96a_c_reference;
    let nearest = format!("substitute samples, reference: {} {:.0} K", nearest.kind, nearest.temperature);
    row("R96a(c)", index(Some(found.r96a_c)), &nearest);
    row("R96(TCC/LAB)a", index(found.r96a_tcc_lab), "substitute samples");
    row("Rf", index(found.rf), "CIE 224:2017");
    row("Rg", index(found.rg), "ANSI/IES TM-30");
    row("a_cv", format!("{:.4}", found.acv), "circadian action factor");
    let error = |error: f64| format!("{:+.1} % by tristimulus values", 100.0 * error);
    row("SY / Y", format!("{:.4}", found.sy_ratio), &error(found.approximation_error.sy));
    row("SY", format!("{:.4e}", found.sy), "the light's unit times nm");
    row("melanopic DER", format!("{:.4}", found.melanopic_der), &error(found.approximation_error.melanopic));
    table
}

fn specials(found: &LightReport) -> String {
    let (Some(r), Some(munsell), Some(checker)) = (&found.r, &found.cri00_munsell_i, &found.cri00_colorchecker_i)
    else {
        return String::new();
    };
    let mut table = Table::new(["sample", "Ri", "CRI00, Munsell", "CRI00, ColorChecker"]);
    for (index, (r, munsell)) in r.iter().zip(munsell).enumerate() {
        let checker = checker.get(index).map_or_else(String::new, |value| format!("{value:.2}"));
        table.row([(index + 1).to_string(), format!("{r:.2}"), format!("{munsell:.2}"), checker]);
    }
    table.to_string()
}

/// What the reader has to know about the figures that can't be those printed elsewhere.
fn note(found: &LightReport) -> &'static str {
    if found.cct_status == "far-from-locus" {
        return "\nThe light is more than 0.05 from the Planckian locus: colour temperature and indices describe it badly.\n";
    }
    "\nThe ten samples of R96 are not public: red, orange, yellow, yellow green, green, cyan, blue, magenta, light and dark\n\
     skin of the ColorChecker stand in. With them FL3.1, FL2, FL7, FL11 have R96a(c) 55.29, 66.28, 90.67, 80.58 (printed\n\
     54.82, 64.74, 90.41, 80.02), R96(TCC/LAB)a 58.08, 68.63, 91.28, 81.33 (58.14, 66.51, 89.73, 81.14) and CRI00 52.40,\n\
     63.60, 89.57, 81.79 (51.00, 62.78, 88.99, 81.58).\n"
}
