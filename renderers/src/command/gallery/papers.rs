//! Numbers that papers print, from `papers.csv`, and their counterparts in what was rendered.

use serde_json::Value;

/// One number of a paper.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Figure {
    pub(super) entry: String,
    pub(super) mode: String,
    pub(super) paper: String,
    pub(super) place: String,
    pub(super) quantity: String,
    pub(super) published: f64,
    value: String,
    pub(super) remark: String,
}

const TEXT: &str = include_str!("papers.csv");

/// All of them.
pub(super) fn figures() -> Result<Vec<Figure>, String> {
    let lines = TEXT.lines().enumerate().filter(|(_, line)| !line.starts_with('#') && !line.is_empty());
    lines.skip(1).map(|(number, line)| figure(line).ok_or_else(|| format!("papers.csv:{}", number + 1))).collect()
}

fn figure(line: &str) -> Option<Figure> {
    let mut fields = fields(line).into_iter();
    let mut next = || fields.next();
    let figure = Figure {
        entry: next()?,
        mode: next()?,
        paper: next()?,
        place: next()?,
        quantity: next()?,
        published: next()?.parse().ok()?,
        value: next()?,
        remark: next()?,
    };
    fields.next().is_none().then_some(figure)
}

/// The fields of a line of comma-separated values; quotation marks around a field, doubled within.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut field, mut quoted) = (Vec::new(), String::new(), false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                field.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(core::mem::take(&mut field)),
            _ => field.push(letter),
        }
    }
    fields.push(field);
    fields
}

impl Figure {
    /// The counterpart, by its place:
    ///
    /// - `render/…` and `compare/…`: a number in what `spectral render --json` and `spectral compare --json` say of the mode, the latter
    ///   of the mode and the reference;
    /// - `map/QUANTITY/…`: a number in what `spectral map --json` says of a quantity;
    /// - `share A-B`: pixels with A to B intervals, in %;
    /// - `thrown-again`: photons that were thrown again as their ways depend on the wavelength: each at one wavelength or a few;
    /// - `excess min` and `max`: extremes of how much too bright the mode is, relative to itself, in %.
    pub(super) fn counterpart(&self, render: &Value, compare: Option<&Value>) -> Option<f64> {
        if let Some((first, last)) = self.value.strip_prefix("share ").and_then(|range| range.split_once('-')) {
            let (first, last): (usize, usize) = (first.parse().ok()?, last.parse().ok()?);
            let counts: Vec<f64> =
                render["intervals"]["histogram"].as_array()?.iter().filter_map(Value::as_f64).collect();
            let within: f64 = counts.iter().take(last + 1).skip(first).sum();
            return Some(100.0 * within / counts.iter().sum::<f64>());
        }
        if let Some(extreme) = self.value.strip_prefix("excess ") {
            let ratio = compare?["relative_brightness"][extreme].as_f64()?;
            return Some(100.0 * ratio / (1.0 + ratio));
        }
        if self.value == "thrown-again" {
            let photons = &render["photon_map"];
            let keys: f64 = photons["keys_nm"].as_array()?.iter().map(|_| 1.0).sum();
            return Some(keys.max(1.0) * photons["dispersed_paths"].as_f64()?);
        }
        if let Some((quantity, number)) = self.value.strip_prefix("map/").and_then(|rest| rest.split_once('/')) {
            let maps = render["maps"].as_array()?;
            return maps.iter().find(|map| map["quantity"] == quantity)?[number].as_f64();
        }
        let (from, pointer) = self.value.split_once('/')?;
        let object = if from == "render" { render } else { compare? };
        object.pointer(&format!("/{pointer}"))?.as_f64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn figure(value: &str) -> Figure {
        Figure { value: value.to_owned(), ..figures().unwrap()[0].clone() }
    }

    #[test]
    fn counterparts_are_found() {
        let maps = json!([{ "quantity": "ra", "min": 60.0 }, { "quantity": "cct", "min": 3000.0 }]);
        let render = json!({ "maps": maps, "intervals": { "mean": 2.5, "histogram": [0, 1, 2, 3, 2] } });
        let compare = json!({ "relative_brightness": { "min": -0.2, "max": 0.25 } });
        let of = |value: &str| figure(value).counterpart(&render, Some(&compare));
        assert_eq!(of("render/intervals/mean"), Some(2.5));
        assert_eq!((of("map/cct/min"), of("map/duv/min")), (Some(3000.0), None));
        assert_eq!(of("share 2-3"), Some(62.5));
        assert!((of("excess max").unwrap() - 20.0).abs() <= 1e-12);
        assert!((of("excess min").unwrap() + 25.0).abs() <= 1e-12);
        assert_eq!((of("compare/delta_e00/max"), of("thrown-again")), (None, None));
        for (keys, times) in [(json!([]), 1.0), (json!([380.0, 500.0, 780.0]), 3.0)] {
            let render = json!({ "photon_map": { "keys_nm": keys, "dispersed_paths": 2000 } });
            assert_eq!(figure("thrown-again").counterpart(&render, None), Some(2000.0 * times));
        }
        assert_eq!(figure("compare/delta_e00/max").counterpart(&render, None), None);
    }

    #[test]
    fn fields_may_be_quoted() {
        assert_eq!(fields(r#"a,"b, ""c""",d"#), ["a", r#"b, "c""#, "d"]);
    }
}
