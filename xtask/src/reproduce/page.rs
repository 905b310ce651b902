//! The page of the figures and `summary.json`.

use crate::figures::{Made, Play};
use crate::report::{Effort, Page, Picture};
use crate::selection::PAPER;
use crate::store::{Store, StoreError};
use anyhow::Result;
use maud::{Markup, html};
use serde_json::json;

/// Writes `index.html` and `summary.json`.
pub(super) fn write(store: &Store, effort: Effort, records: &[(u8, Made, Effort)]) -> Result<()> {
    let page = page(records, &|path| store.read(path))?;
    store.write("index.html", page.to_html().as_bytes())?;
    let figures: Vec<_> = records
        .iter()
        .map(|(figure, r, effort)| {
            json!({
                "figure": figure, "title": r.title, "effort": effort, "paper": r.paper, "measured": r.measured,
                "pictures": r.pictures.iter().map(|p| &p.path).collect::<Vec<_>>(),
                "pages": r.pages.iter().map(|p| &p.path).collect::<Vec<_>>(), "facts": r.facts,
            })
        })
        .collect();
    store.write_json(
        "summary.json",
        &json!({ "version": env!("CARGO_PKG_VERSION"), "effort": effort, "figures": figures }),
    )?;
    Ok(())
}

/// Reads a picture.
type Read<'a> = &'a dyn Fn(&str) -> Result<Vec<u8>, StoreError>;

fn page(records: &[(u8, Made, Effort)], read: Read<'_>) -> Result<Page, StoreError> {
    let sections = records
        .iter()
        .map(|(figure, made, effort)| section(*figure, made, *effort, read))
        .collect::<Result<Vec<Markup>, _>>()?;
    let body = html! {
        p {
            "Every picture is computed by isosheet. Beside each: what is shown in Y.-J. Liu, K. Tang and A. Joneja, "
            i { "Modeling dynamic developable meshes by the Hamilton principle" } ", Computer-Aided Design 39 (2007) "
            "719–731, and what is measured here. SI units, z upwards."
        }
        @if records.iter().any(|(.., e)| *e == Effort::Quick) {
            p.note {
                "Some figures below were made with " code { "--quick" } ": their runs are cut short and "
                "show that the programs work, not what they find."
            }
        }
        @for section in &sections { (section) }
    };
    Ok(Page {
        heading: "Dynamic developable meshes: the figures reproduced",
        ..Page::new("Figures of Liu, Tang and Joneja 2007, reproduced", body)
    })
}

fn section(n: u8, record: &Made, effort: Effort, read: Read<'_>) -> Result<Markup, StoreError> {
    let kind = if n > PAPER {
        "Beyond the paper,"
    } else {
        "Fig."
    };
    let inside = |picture: &Picture| Ok(picture.inside(&read(&picture.path)?));
    let pictures = record.pictures.iter().map(inside);
    let pictures: Vec<Markup> = pictures.collect::<Result<_, _>>()?;
    let plays = plays(record, read)?;
    Ok(html! {
        section id={ "fig" (n) } {
            h2 { (kind) " " (n) ". " (record.title) @if effort == Effort::Quick { " (quick)" } }
            @for picture in &pictures { figure { (picture) } }
            @if !plays.is_empty() {
                p { b { "Turn it round and play it:" } }
                div.play { @for play in &plays { (play) } }
            }
            div.texts {
                p { b { "The paper" } (record.paper) }
                p { b { "Here" } (record.measured) }
            }
            @for table in &record.tables { (table) }
        }
    })
}

/// Links to the pages that play the runs of a figure.
fn plays(record: &Made, read: Read<'_>) -> Result<Vec<Markup>, StoreError> {
    let link = |play: &Play| {
        let picture = play.thumbnail.inside(&read(&play.thumbnail.path)?);
        Ok(html! { a href={ (play.path) (play.choices) } { (picture) (play.label) } })
    };
    record.pages.iter().map(link).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Table;

    #[test]
    fn the_page_holds_everything() {
        let picture = |file: &str, alt: &str| Picture::file(file, Vec::new(), alt);
        let made = Made {
            title: "A < B".into(),
            paper: "said".into(),
            measured: "seen".into(),
            pictures: vec![picture("a.svg", "a"), picture("b.png", "b \"quoted\"")],
            pages: vec![Play {
                path: "fig10-a.html".into(),
                choices: "#bodies=glass".into(),
                label: "M<2>".into(),
                page: String::new(),
                thumbnail: picture("fig10-a-end.png", "Figure 10, M<2>, at the end"),
            }],
            tables: vec![Table::new("t", &["x"]).with_texts([vec!["<1>".into()]])],
            facts: serde_json::Value::Null,
        };
        let read = |path: &str| {
            Ok(if path.ends_with("svg") {
                br#"<?xml?><svg width="100.00pt" height="50.00pt"></svg>"#.to_vec()
            } else {
                vec![1, 2, 3]
            })
        };
        let html = page(&[(10, made, Effort::Full)], &read).unwrap();
        let html = html.to_html();
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
