//! A page about what was done: pictures before and after, sizes, errors, what stood in the way. One file, nothing beside it.

use std::fmt::Write;
use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use multires::mesh::Mesh;
use multires::quality::{self, Camera, RenderOptions};
use serde_json::Value;

use crate::canvas::Canvas;
use crate::files;
use crate::output::Failure;
use crate::workers;

/// Pixels on a side of a picture.
const SIDE: usize = 420;

/// From where the models are looked at.
const DIRECTION: [f64; 3] = [0.6, 0.45, 1.0];

const STYLE: &str = "
:root { color-scheme: light dark; --paper: #fafaf8; --card: #fff; --ink: #1d2126; --soft: #5d6670; --line: #e3e4e0; --warn: #9a5b00 }
@media (prefers-color-scheme: dark) { :root { --paper: #16181b; --card: #1f2226; --ink: #e8e9ea; --soft: #9aa3ac; --line: #33373c; --warn: #e0a94e } }
body { margin: 0 auto; max-width: 1200px; padding: 24px; font: 15px/1.45 system-ui, sans-serif; background: var(--paper); color: var(--ink) }
h1 { font-size: 22px; margin: 0 0 4px } h2 { font-size: 17px; margin: 0 0 12px; overflow-wrap: anywhere }
p { margin: 0 0 20px; color: var(--soft) }
section { background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 16px; margin-bottom: 20px }
.row { display: flex; flex-wrap: wrap; gap: 16px } figure { margin: 0; flex: 1 1 260px; max-width: 420px; min-width: 0 }
img { width: 100%; height: auto; border-radius: 6px; display: block } figcaption { color: var(--soft); padding-top: 6px }
.wide { overflow-x: auto; margin-top: 12px } table { border-collapse: collapse } td, th { padding: 3px 14px 3px 0; text-align: left; white-space: nowrap }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums } th { color: var(--soft); font-weight: 500 }
ul { margin: 12px 0 0; padding-left: 18px; color: var(--warn) } li { overflow-wrap: anywhere }
";

/// Writes the page. `answers`: of each file worked on; `failures`: lines about the others.
pub fn write(path: &Path, answers: &[Value], failures: &[String]) -> Result<(), Failure> {
    let sections = workers::each(answers.len(), |i| section(&answers[i]));
    let mut page = String::from("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">");
    page.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>multires simplify</title>");
    let _ = write!(page, "<style>{STYLE}</style></head><body><h1>multires simplify</h1>");
    let sum = |key: &str| answers.iter().map(|a| a["input"][key].as_u64().unwrap_or(0)).sum::<u64>();
    let last = |key: &str| outputs(&answers.iter().collect::<Vec<_>>(), key);
    let _ = write!(
        page,
        "<p>{} files, {} triangles &rarr; {}; {} &rarr; {}</p>",
        answers.len(),
        thousands(sum("triangles")),
        thousands(last("triangles")),
        bytes(sum("bytes")),
        bytes(last("bytes")),
    );
    sections.iter().for_each(|section| page.push_str(section));
    if !failures.is_empty() {
        page.push_str("<section><h2>Failed</h2><ul>");
        failures.iter().for_each(|failure| {
            let _ = write!(page, "<li>{}</li>", escaped(failure));
        });
        page.push_str("</ul></section>");
    }
    page.push_str("</body></html>\n");
    files::write_bytes(path, page.as_bytes())
}

/// Sums a number of the outputs; of several levels the last.
fn outputs(answers: &[&Value], key: &str) -> u64 {
    let one = |answer: &&Value| {
        levels(answer).last().map_or(0, |level| level_value(level, key).as_u64().unwrap_or(0))
    };
    answers.iter().map(one).sum()
}

/// Returns what was written: the answer itself, or its levels.
fn levels(answer: &Value) -> Vec<&Value> {
    match answer["levels"].as_array() {
        Some(levels) => levels.iter().collect(),
        None => vec![answer],
    }
}

/// Levels of one file carry their sizes; others have an output.
fn level_value<'a>(level: &'a Value, key: &str) -> &'a Value {
    level.get("output").unwrap_or(level).get(key).unwrap_or(&Value::Null)
}

/// Returns the part of the page about a file.
fn section(answer: &Value) -> String {
    let mut html = String::new();
    let input = answer["input"]["path"].as_str().unwrap_or_default();
    let _ = write!(html, "<section><h2>{}</h2><div class=\"row\">", escaped(input));
    let path_of = |level: &&Value| level_value(level, "path").as_str().unwrap_or_default().to_owned();
    let paths: Vec<String> = levels(answer).iter().map(path_of).collect();
    let read = |path: &str| files::read_mesh(Path::new(path)).ok().map(|imported| imported.mesh);
    // Levels within one file have no picture each: the file shows the finest. What was written over has none either.
    let in_one = paths.len() > 1 && paths.iter().all(|path| *path == paths[0]);
    let after: Vec<Option<Mesh>> = paths.iter().map(|path| read(path).filter(|_| !in_one)).collect();
    let before = read(input).filter(|_| paths.iter().all(|path| path != input));
    let framed = before.as_ref().or(after.iter().flatten().next());
    let camera = framed.map(|mesh| Camera::framing(mesh, DIRECTION));
    let mut shown = |mesh: Option<&Mesh>, caption: &str| {
        let picture = mesh.zip(camera.as_ref()).and_then(|(mesh, camera)| picture(mesh, camera));
        if let Some(picture) = picture {
            let _ = write!(
                html,
                "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>",
                escaped(caption),
                BASE64_STANDARD.encode(picture)
            );
        }
    };
    let triangles = |value: &Value| format!("{} triangles", thousands(value.as_u64().unwrap_or(0)));
    shown(before.as_ref(), &format!("before: {}", triangles(&answer["input"]["triangles"])));
    for (level, mesh) in levels(answer).iter().zip(&after) {
        shown(mesh.as_ref(), &format!("after: {}", triangles(level_value(level, "triangles"))));
    }
    html.push_str(
        "</div><div class=\"wide\"><table><tr><th></th><th class=n>triangles</th><th class=n>vertices</th>",
    );
    html.push_str(
        "<th class=n>file</th><th class=n>error</th><th class=n>in poses</th><th>stopped by</th></tr>",
    );
    let number = |value: &Value| value.as_u64().map_or(String::new(), thousands);
    let size = |value: &Value| value.as_u64().map_or(String::new(), bytes);
    let input = &answer["input"];
    let _ = write!(
        html,
        "<tr><td>before</td><td class=n>{}</td><td class=n>{}</td><td class=n>{}</td></tr>",
        number(&input["triangles"]),
        number(&input["vertices"]),
        size(&input["bytes"])
    );
    for level in levels(answer) {
        let error = match (level["error"].as_f64(), level["error_percent"].as_f64()) {
            (Some(error), Some(percent)) => format!("{error:.6} ({percent:.3} %)"),
            (Some(error), None) => format!("{error:.6}"),
            _ => String::new(),
        };
        let posed = level["pose_error"].as_f64().map_or(String::new(), |error| format!("{error:.6}"));
        let _ = write!(
            html,
            "<tr><td>after</td><td class=n>{}</td><td class=n>{}</td><td class=n>{}</td><td class=n>{error}</td>\
             <td class=n>{posed}</td><td>{}</td></tr>",
            number(level_value(level, "triangles")),
            number(level_value(level, "vertices")),
            size(level_value(level, "bytes")),
            escaped(stop(level))
        );
    }
    html.push_str("</table></div>");
    html.push_str(&meshes(answer));
    html.push_str(&refusals(answer));
    html.push_str("</section>");
    html
}

/// Returns why a level is no smaller: its own reason, or that of its only mesh.
fn stop(level: &Value) -> &str {
    let only = level["meshes"].as_array().filter(|meshes| meshes.len() == 1);
    let holder = only.map_or(level, |meshes| &meshes[0]);
    holder["stop"].as_str().unwrap_or_default()
}

/// Returns a table of the meshes of a document, if there are several.
fn meshes(answer: &Value) -> String {
    let levels = levels(answer);
    let Some(list) = levels.last().and_then(|level| level["meshes"].as_array()).filter(|list| list.len() > 1)
    else {
        return String::new();
    };
    let mut html = String::from(
        "<div class=\"wide\"><table><tr><th>mesh</th><th class=n>before</th><th class=n>after</th>",
    );
    html.push_str("<th class=n>error</th><th>stopped by</th></tr>");
    for mesh in list {
        let name = mesh["name"].as_str().filter(|name| !name.is_empty()).map(str::to_owned);
        let name = name.unwrap_or_else(|| format!("mesh {}", mesh["mesh"]));
        let number = |key: &str| mesh[key].as_u64().map_or(String::new(), thousands);
        let _ = write!(
            html,
            "<tr><td>{}</td><td class=n>{}</td><td class=n>{}</td><td class=n>{:.6}</td><td>{}</td></tr>",
            escaped(&name),
            number("input_triangles"),
            number("triangles"),
            mesh["error"].as_f64().unwrap_or(0.0),
            escaped(mesh["stop"].as_str().unwrap_or_default())
        );
    }
    html.push_str("</table></div>");
    html
}

/// Returns what stood in the way, and the warnings.
fn refusals(answer: &Value) -> String {
    let mut lines: Vec<String> = Vec::new();
    let standing = answer["refusals"].as_array().into_iter().flatten();
    for refusal in standing.filter(|r| r["standing"].as_u64() > Some(0)) {
        let name = refusal["oracle"].as_str().unwrap_or_default();
        lines.push(format!("{name}: {} collapses refused at the end", refusal["standing"]));
    }
    let warnings = answer["warnings"].as_array().into_iter().flatten();
    lines.extend(warnings.filter_map(Value::as_str).map(str::to_owned));
    if lines.is_empty() {
        return String::new();
    }
    let items: String = lines.iter().map(|line| format!("<li>{}</li>", escaped(line))).collect();
    format!("<ul>{items}</ul>")
}

/// Returns a picture with the edges of triangles, as a PNG file; `None` for a mesh that cannot be shown.
fn picture(mesh: &Mesh, camera: &Camera) -> Option<Vec<u8>> {
    let options = RenderOptions::default().with_size(SIDE, SIDE).with_occlusion_rays(2).with_edges(0.7);
    let picture = quality::render(mesh, camera, &options).ok()?;
    let mut canvas = Canvas::new(SIDE as u32, SIDE as u32, [255; 3]);
    for (at, &colour) in (0..).zip(picture.pixels()) {
        canvas.put(at % SIDE as u32, at / SIDE as u32, colour);
    }
    canvas.png(6).ok()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Groups digits by three.
fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Returns a size of a file for people.
fn bytes(number: u64) -> String {
    match number {
        0..=9_999 => format!("{} bytes", thousands(number)),
        10_000..=9_999_999 => format!("{} kB", thousands(number / 1000)),
        _ => format!("{} MB", thousands(number / 1_000_000)),
    }
}
