//! The page: plain HTML with links that work wherever the folder is.

use renderers::scene::builtin;
use serde_json::Value;

use super::papers::Figure;
use super::plan::MAPS;
use super::{Mapped, Section, Shown};

const STYLE: &str = "
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 100rem; padding: 0 1rem; }
h1, h2 { line-height: 1.2; }
h2 { border-top: 1px solid #8888; margin-top: 3rem; padding-top: 1rem; }
nav a { margin-right: 1em; white-space: nowrap; }
.pictures { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(12rem, 1fr)); }
figure { margin: 0; }
figure img { display: block; width: 100%; image-rendering: pixelated; }
figure .map { image-rendering: auto; margin-top: .5rem; }
figcaption { overflow-wrap: anywhere; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: 1rem 0; }
th, td { border-bottom: 1px solid #8886; padding: .2rem .7rem; text-align: left; vertical-align: top; }
td.number { font-variant-numeric: tabular-nums; text-align: right; white-space: nowrap; }
pre { overflow-x: auto; white-space: pre-wrap; }
.failed { color: #c00; font-weight: bold; }
";

/// The page of these sections.
pub(super) fn html(sections: &[Section], figures: &[Figure], quick: bool) -> String {
    let mut text = String::from("<!DOCTYPE html>\n<html lang=\"en-GB\">\n<head>\n<meta charset=\"utf-8\">\n");
    text += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    text += &format!("<title>Spectral: gallery</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>Gallery</h1>\n");
    text += "<p>The built-in scenes, each rendered in several ways. Maps show the colour difference ΔE00 to the reference, histograms how many \
             intervals pixels took. Seconds are those of this machine, of pictures alone.</p>\n";
    if quick {
        text += "<p>Small pictures, by <code>--quick</code>: their noise is in all comparisons with papers.</p>\n";
    }
    text += "<nav>";
    for Section { entry, .. } in sections {
        text += &format!("<a href=\"#{0}\">{0}</a> ", entry.name);
    }
    text += "</nav>\n";
    for section in sections {
        text += &self::section(section, figures);
    }
    text + "</body>\n</html>\n"
}

fn section(section: &Section, figures: &[Figure]) -> String {
    let Section { entry, shown, maps } = section;
    let mut text = format!("<h2 id=\"{0}\">{0}</h2>\n", entry.name);
    if let Some((first, rest)) = description(entry.scene) {
        text += &format!("<p>{}</p>\n", escape(&first));
        text +=
            &format!("<details><summary>Source, and what was chosen</summary><pre>{}</pre></details>\n", escape(&rest));
    }
    text += "<div class=\"pictures\">\n";
    for shown in shown {
        text += &picture(entry.name, shown, shown.mode == entry.reference);
    }
    text += "</div>\n";
    text += &table(section);
    for maps in maps {
        text += &mapped(entry.name, maps);
    }
    let mut of_papers = entry.figures(figures).peekable();
    if of_papers.peek().is_some() {
        text += "<div class=\"wide\"><table><tr><th>paper</th><th>where</th><th>quantity</th><th>printed</th><th>here</th><th></th></tr>\n";
        for figure in of_papers {
            text += &compared_with_paper(section, figure);
        }
        text += "</table></div>\n";
    }
    text
}

/// The comment at the head of a scene: its first paragraph, and the others.
fn description(scene: &str) -> Option<(String, String)> {
    let (_, rest) = builtin::xml(scene)?.split_once("<!--")?;
    let (comment, _) = rest.split_once("-->")?;
    let (first, others) = comment.trim().split_once("\n\n").unwrap_or((comment.trim(), ""));
    let lines: Vec<_> = others.lines().map(|line| line.strip_prefix("  ").unwrap_or(line)).collect();
    Some((first.split_whitespace().collect::<Vec<_>>().join(" "), lines.join("\n").trim().to_owned()))
}

fn picture(entry: &str, shown: &Shown, is_reference: bool) -> String {
    let mode = shown.mode;
    let role = if is_reference { " (reference)" } else { "" };
    let mut text = format!("<figure>\n<figcaption><b>{mode}</b>{role}");
    if let Some(error) = shown.error() {
        text += &format!("<br><span class=\"failed\">{}</span>", escape(error));
    }
    text += "</figcaption>\n";
    let Ok(done) = &shown.done else { return text + "</figure>\n" };
    let mut image = |file: &str, class: &str, what: &str| {
        let source = format!("{entry}/{mode}/{file}");
        text += &format!(
            "<a href=\"{source}\"><img{class} src=\"{source}\" alt=\"{entry}, {mode}: {what}\" loading=\"lazy\"></a>\n"
        );
    };
    if let Some(file) = done.file(".png") {
        image(file, "", "picture");
    }
    if matches!(shown.compared, Some(Ok(_))) {
        image("compared/delta_e00.png", " class=\"map\"", "ΔE00 to the reference");
    }
    for (end, what) in [("-intervals.png", "intervals"), ("-interval-histogram.png", "histogram of intervals")] {
        if let Some(file) = done.file(end) {
            image(file, " class=\"map\"", what);
        }
    }
    text + "</figure>\n"
}

const HEADINGS: [&str; 11] = [
    "mode",
    "seconds",
    "preparation",
    "rays",
    "intervals, mean",
    "most",
    "bound of ΔE*ab, mean",
    "most",
    "ΔE00 to the reference, mean",
    "95th percentile",
    "most",
];

fn table(section: &Section) -> String {
    let cells = |tag: &str, cells: &[String]| {
        let class = |column: usize| if column > 0 && tag == "td" { " class=\"number\"" } else { "" };
        let cell = |(column, cell): (usize, &String)| format!("<{tag}{}>{cell}</{tag}>", class(column));
        format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>())
    };
    let mut text = String::from("<div class=\"wide\"><table>\n");
    text += &cells("th", &HEADINGS.map(str::to_owned));
    for shown in &section.shown {
        let Ok(done) = &shown.done else { continue };
        let compared = shown.compared.as_ref().and_then(|compared| compared.as_ref().ok()).unwrap_or(&Value::Null);
        let (render, bound, difference) = (&done.render, &done.render["delta_e_bound"], &compared["delta_e00"]);
        text += &cells(
            "td",
            &[
                shown.mode.to_owned(),
                number(&render["seconds"], 3),
                number(&render["preparation_seconds"], 3),
                number(&render["rays"], 0),
                number(&render["intervals"]["mean"], 2),
                number(&render["intervals"]["max"], 0),
                number(&bound["mean"], 3),
                number(&bound["max"], 3),
                number(&difference["mean"], 3),
                number(&difference["p95"], 3),
                number(&difference["max"], 3),
            ],
        );
    }
    text += "</table></div>\n<details><summary>Commands</summary><pre>";
    for shown in &section.shown {
        text += &format!("{}\n", escape(&shown.command));
    }
    text + "</pre></details>\n"
}

/// Maps of lighting measures, with what they range over.
fn mapped(entry: &str, maps: &Mapped) -> String {
    let done = match &maps.done {
        Ok(done) => done,
        Err(error) => return format!("<p class=\"failed\">{MAPS}: {}</p>\n", escape(error)),
    };
    let mut text = String::from("<div class=\"pictures\">\n");
    for file in done.files(".png") {
        let source = format!("{}/{file}", maps.folder);
        let image = format!("<img class=\"map\" src=\"{source}\" alt=\"{entry}, map: {file}\" loading=\"lazy\">");
        text += &format!("<figure><a href=\"{source}\">{image}</a></figure>\n");
    }
    text += "</div>\n<div class=\"wide\"><table>\n";
    text += "<tr><th>quantity</th><th>of</th><th>least</th><th>mean</th><th>largest</th><th>unit</th></tr>\n";
    for map in done.render["maps"].as_array().into_iter().flatten() {
        let word = |name: &str| format!("<td>{}</td>", escape(map[name].as_str().unwrap_or_default()));
        let numbers = ["min", "mean", "max"].map(|name| format!("<td class=\"number\">{}</td>", number(&map[name], 3)));
        text += &format!("<tr>{}{}{}{}</tr>\n", word("quantity"), word("of"), numbers.concat(), word("unit"));
    }
    text += "</table></div>\n";
    text + "<details><summary>Command</summary><pre>" + &escape(&maps.command) + "</pre></details>\n"
}

/// A number as people read it; nothing where there is none.
fn number(value: &Value, decimals: usize) -> String {
    match value.as_f64() {
        Some(value) if value.abs() >= 1e6 && decimals > 0 => format!("{value:.1e}"),
        Some(value) => format!("{value:.decimals$}"),
        None => String::new(),
    }
}

fn compared_with_paper(section: &Section, figure: &Figure) -> String {
    let of_mode = |shown: &Shown| {
        let compared = shown.compared.as_ref().and_then(|compared| compared.as_ref().ok());
        figure.counterpart(&shown.done.as_ref().ok()?.render, compared)
    };
    let of_map = |maps: &Mapped| figure.counterpart(&maps.done.as_ref().ok()?.render, None);
    let here = if figure.mode == MAPS {
        section.maps.iter().find_map(of_map)
    } else {
        section.shown.iter().find(|shown| shown.mode == figure.mode).and_then(of_mode)
    };
    let here = here.map_or_else(|| "–".to_owned(), significant);
    let words = [&figure.paper, &figure.place, &figure.quantity].map(|words| format!("<td>{}</td>", escape(words)));
    let printed = figure.published;
    let remark = escape(&figure.remark);
    format!(
        "<tr>{}<td class=\"number\">{printed}</td><td class=\"number\">{here}</td><td>{remark}</td></tr>\n",
        words.concat()
    )
}

/// Three digits, all of those before the point.
fn significant(value: f64) -> String {
    let decimals = if value.abs() >= 100.0 { 0 } else { 2 };
    format!("{value:.decimals$}")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_says_what_it_is() {
        for name in builtin::names() {
            let (first, _) = description(name).unwrap();
            assert!(first.len() >= 20 && !first.contains('\n'), "{name}: {first}");
        }
    }

    #[test]
    fn nothing_from_outside_is_markup() {
        assert_eq!(escape("<b title=\"&\">"), "&lt;b title=&quot;&amp;&quot;&gt;");
    }
}
