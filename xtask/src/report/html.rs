//! The page: one file, pictures inside. Its parts serve other reports as well.

use crate::figures::{PageRef, PictureRef, Record, RenderEffort, Table};
use crate::selection::PAPER;
use crate::store::StoreError;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write;

/// The look of all pages.
pub(crate) const STYLE: &str = "\
:root{color-scheme:light}body{font:16px/1.5 Helvetica,Arial,sans-serif;color:#222;background:#fff;margin:2.5rem auto;\
max-width:64rem;padding:0 1.5rem}h1{font-size:1.7rem;margin-bottom:.3rem}h2{font-size:1.15rem;margin:0 0 .7rem}\
section{border-top:1px solid #ddd;padding:1.6rem 0}figure{margin:0 0 1rem}figure svg,figure img{max-width:100%;height:auto;\
display:block;margin:auto}.texts{display:grid;grid-template-columns:1fr 1fr;gap:0 2rem}.texts p{margin:.2rem 0}\
.texts b{display:block;font-weight:600;font-size:.85rem;color:#666}.note{background:#fdf3d8;padding:.5rem .8rem}\
.scroll{overflow-x:auto}table{border-collapse:collapse;font-size:.88rem;margin:.8rem 0}caption{text-align:left;color:#666;\
padding-bottom:.3rem}th,td{border-bottom:1px solid #ddd;padding:.25rem .8rem .25rem 0;text-align:left;vertical-align:top}\
.play{display:flex;flex-wrap:wrap;gap:.6rem 1rem;margin:0 0 1rem}\
.play a{text-align:center;color:#0b57a4;font-size:.85rem;text-decoration:none}.play a:hover{text-decoration:underline}\
.play img{display:block;height:6rem;margin:auto}th{font-weight:600}@media(max-width:44rem){.texts{grid-template-columns:1fr}}";

/// The page for the given figures; `read` gives the bytes of a picture.
pub(super) fn page(
    records: &[(Record, RenderEffort)],
    read: &mut dyn FnMut(&str) -> Result<Vec<u8>, StoreError>,
) -> Result<String, StoreError> {
    let mut out = String::new();
    out.push_str(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
                  <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
                  <title>Figures of Liu, Tang and Joneja 2007, reproduced</title><style>",
    );
    out.push_str(STYLE);
    out.push_str("</style></head><body><h1>Dynamic developable meshes: the figures reproduced</h1>\
                  <p>Every picture is computed by isosheet. Beside each: what is shown in Y.-J. Liu, K. Tang and A. Joneja, \
                  <i>Modeling dynamic developable meshes by the Hamilton principle</i>, Computer-Aided Design 39 (2007) \
                  719–731, and what is measured here. SI units, z upwards.</p>");
    if records.iter().any(|(_, e)| *e == RenderEffort::Quick) {
        out.push_str("<p class=\"note\">Some figures below were made with <code>--quick</code>: their runs are cut short and \
                      show that the programs work, not what they find.</p>");
    }
    for (record, effort) in records {
        section(&mut out, record, *effort, read)?;
    }
    out.push_str("</body></html>\n");
    Ok(out)
}

fn section(
    out: &mut String,
    record: &Record,
    effort: RenderEffort,
    read: &mut dyn FnMut(&str) -> Result<Vec<u8>, StoreError>,
) -> Result<(), StoreError> {
    let n = record.figure;
    let quick = if effort == RenderEffort::Quick {
        " (quick)"
    } else {
        ""
    };
    let kind = if n > PAPER {
        "Beyond the paper,"
    } else {
        "Fig."
    };
    // Writing to a string cannot fail.
    let _ = write!(
        out,
        "<section id=\"fig{n}\"><h2>{kind} {n}. {}{quick}</h2>",
        escape(&record.title)
    );
    for picture in &record.pictures {
        out.push_str("<figure>");
        image(out, picture, &read(&picture.path)?);
        out.push_str("</figure>");
    }
    if !record.pages.is_empty() {
        plays(out, record, read)?;
    }
    let _ = write!(
        out,
        "<div class=\"texts\"><p><b>The paper</b>{}</p><p><b>Here</b>{}</p></div>",
        escape(&record.paper),
        escape(&record.measured)
    );
    for t in &record.tables {
        table(out, t);
    }
    out.push_str("</section>\n");
    Ok(())
}

/// Links to the pages that play the runs of a figure.
fn plays(
    out: &mut String,
    record: &Record,
    read: &mut dyn FnMut(&str) -> Result<Vec<u8>, StoreError>,
) -> Result<(), StoreError> {
    out.push_str("<p><b>Turn it round and play it:</b></p><div class=\"play\">");
    for PageRef {
        path,
        thumbnail,
        choices,
        label,
    } in &record.pages
    {
        // Writing to a string cannot fail.
        let _ = write!(out, "<a href=\"{}{}\">", escape(path), escape(choices));
        let picture = PictureRef {
            path: thumbnail.clone(),
            alt: format!("Figure {}, {label}, at the end", record.figure),
        };
        image(out, &picture, &read(thumbnail)?);
        let _ = write!(out, "{}</a>", escape(label));
    }
    out.push_str("</div>");
    Ok(())
}

/// A picture of the page, inside it.
pub(crate) fn image(out: &mut String, picture: &PictureRef, bytes: &[u8]) {
    if picture.path.ends_with(".svg") {
        out.push_str(&inline_svg(&String::from_utf8_lossy(bytes)));
    } else {
        // Writing to a string cannot fail.
        let _ = write!(
            out,
            "<img alt=\"{}\" src=\"data:image/png;base64,{}\">",
            escape(&picture.alt),
            STANDARD.encode(bytes)
        );
    }
}

/// A table that scrolls when it is wide.
pub(crate) fn table(out: &mut String, t: &Table) {
    let _ = write!(
        out,
        "<div class=\"scroll\"><table><caption>{}</caption><thead><tr>",
        escape(&t.caption)
    );
    for h in &t.head {
        let _ = write!(out, "<th>{}</th>", escape(h));
    }
    out.push_str("</tr></thead><tbody>");
    for row in &t.rows {
        out.push_str("<tr>");
        for cell in row {
            let _ = write!(out, "<td>{}</td>", escape(cell));
        }
        out.push_str("</tr>");
    }
    out.push_str("</tbody></table></div>");
}

/// Size of drawings in the page relative to their own: their text is as large as that of the page then.
const ENLARGED: f64 = 1.3;

/// The part of an SVG file that may stand in a page: without an XML declaration, and enlarged.
pub(crate) fn inline_svg(svg: &str) -> String {
    let svg = svg.find("<svg").map_or(svg, |start| &svg[start..]);
    let mut out = svg.to_owned();
    for name in ["width=\"", "height=\""] {
        // The first of each belongs to the drawing as a whole.
        let Some(start) = out.find(name).map(|k| k + name.len()) else {
            continue;
        };
        let Some(length) = out[start..].find("pt\"") else {
            continue;
        };
        if let Ok(points) = out[start..start + length].parse::<f64>() {
            out.replace_range(start..start + length, &format!("{:.2}", ENLARGED * points));
        }
    }
    out
}

/// Text as it stands in a page.
pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_holds_everything() {
        let record = Record {
            figure: 10,
            title: "A < B".into(),
            paper: "said".into(),
            measured: "seen".into(),
            pictures: vec![
                PictureRef {
                    path: "figures/a.svg".into(),
                    alt: "a".into(),
                },
                PictureRef {
                    path: "figures/b.png".into(),
                    alt: "b \"quoted\"".into(),
                },
            ],
            pages: vec![PageRef {
                path: "fig10-a.html".into(),
                thumbnail: "figures/fig10-a-end.png".into(),
                choices: "#bodies=glass".into(),
                label: "M<2>".into(),
            }],
            tables: vec![Table {
                caption: "t".into(),
                head: vec!["x".into()],
                rows: vec![vec!["<1>".into()]],
            }],
            facts: serde_json::Value::Null,
        };
        let mut read = |path: &str| {
            Ok(if path.ends_with("svg") {
                br#"<?xml?><svg width="100.00pt" height="50.00pt"></svg>"#.to_vec()
            } else {
                vec![1, 2, 3]
            })
        };
        let html = page(&[(record, RenderEffort::Full)], &mut read).unwrap();
        for part in [
            "A &lt; B",
            "<figure><svg width=\"130.00pt\" height=\"65.00pt\"></svg></figure>",
            "alt=\"b &quot;quoted&quot;\" src=\"data:image/png;base64,AQID\"",
            "<td>&lt;1&gt;</td>",
            "<a href=\"fig10-a.html#bodies=glass\"><img alt=\"Figure 10, M&lt;2&gt;, at the end\" \
             src=\"data:image/png;base64,AQID\">M&lt;2&gt;</a>",
        ] {
            assert!(html.contains(part), "{part} is missing in {html}");
        }
        assert!(!html.contains("http"), "nothing is loaded from elsewhere");
        assert!(!html.contains("class=\"note\""));
    }
}
