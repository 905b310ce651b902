//! `reproduce-figures`: makes what is asked for and not up to date, then writes the page.

use crate::figures::{self, Made};
use crate::interrupt;
use crate::progress;
use crate::report::{Effort, FullOptions, Page, Part, Section, excerpt};
use crate::runs::scene_fingerprint;
use crate::store::{Kept, Store, Unit};
use anyhow::Result;
use clap::{Args, value_parser};
use maud::{Markup, html};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeSet;
use std::time::Instant;

/// Arguments of `reproduce-figures`.
#[derive(Debug, Args)]
pub(crate) struct ReproduceArgs {
    /// Figures to make, such as 3,11; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = value_parser!(u8).range(1..=LAST))]
    figures: Vec<u8>,

    #[command(flatten)]
    options: FullOptions,
}

/// The last figure of the paper; Fig. 10 is a table.
const LAST: i64 = 15;

/// What is kept of a figure: its section of the page and its tables.
#[derive(Debug, Serialize, Deserialize)]
struct FigureRecord {
    section: Section,
    /// Its tables for the book.
    excerpt: Vec<Part>,
}

/// Runs the command.
pub(crate) fn run(args: &ReproduceArgs) -> Result<()> {
    let store = args.options.open("reproduce-figures")?;
    let mut figures: BTreeSet<u8> = args.figures.iter().copied().collect();
    if figures.is_empty() {
        figures.extend(all());
    }
    let scenes = scene_fingerprint()?;
    let made = figures
        .into_iter()
        .try_for_each(|n| make(&store, n, scenes));
    interrupt::afterwards(made, || write(&store, scenes))
}

/// The numbers of all figures.
fn all() -> impl Iterator<Item = u8> {
    1..=LAST as u8
}

/// What is kept of a figure; `scenes` is the fingerprint of the files of scenes that figures are made of.
fn unit(store: &Store, figure: u8, scenes: u64) -> Unit {
    let mut unit = store.unit(format!("fig{figure:02}"), format!("figure {figure}"));
    unit.options["scenes"] = json!(scenes);
    unit
}

fn make(store: &Store, figure: u8, scenes: u64) -> Result<()> {
    let unit = unit(store, figure, scenes);
    store.keep(&unit, |files| {
        let started = Instant::now();
        let made = figures::make(figure, store)?;
        made.write(figure, files)?;
        let wall = started.elapsed().as_secs_f64();
        progress::note(&unit.title, &format!("made ({wall:.1} s)"));
        Ok(FigureRecord {
            section: section(figure, &made).into(),
            excerpt: tables(figure, &made),
        })
    })?;
    Ok(())
}

/// Writes `index.html` of all figures made so far.
fn write(store: &Store, scenes: u64) -> Result<()> {
    let units = all().map(|figure| unit(store, figure, scenes));
    let Kept::<FigureRecord> { records, left_out } = store.all_kept(units.collect());
    let parts: Vec<Part> = records.iter().flat_map(|r| r.excerpt.clone()).collect();
    excerpt::write(store, "reproduce-figures", parts)?;
    let body = html! {
        p {
            "Every picture is computed by isosheet. Beside each: what is shown in Y.-J. Liu, K. Tang and A. Joneja, "
            i { "Modeling dynamic developable meshes by the Hamilton principle" } ", Computer-Aided Design 39 (2007) "
            "719–731, and what is measured here. Pictures open in full; those of runs open pages that play them in 3D, and "
            code { "isosheet simulate" } " runs their scene files. SI units, z upwards."
        }
        @if store.effort == Effort::Standard {
            p {
                "Each run is shown by itself. " code { "cargo xtask reproduce-figures --full" } " adds eleven neighbours to most "
                "of them, which start a thousandth of an edge beside, tells medians and ranges, and checks what figures say of them."
            }
        }
        @for record in &records { (record.section) }
    };
    let page = Page {
        heading: "Dynamic developable meshes: the figures reproduced",
        left_out,
        ..Page::new("Figures of Liu, Tang and Joneja 2007, reproduced", body)
    };
    page.write(store, "index.html")
}

/// The tables of a figure for the book: `fig10-1`, `fig10-2`.
fn tables(figure: u8, made: &Made) -> Vec<Part> {
    let numbered = (1..).zip(&made.tables);
    let part = |(k, table)| Part::table(format!("fig{figure:02}-{k}"), table);
    numbered.map(part).collect()
}

fn section(n: u8, made: &Made) -> Markup {
    html! {
        section id={ "fig" (n) } {
            h2 { "Fig. " (n) ". " (made.title) }
            p { (made.paper) " " (made.here) }
            div.pictures { @for picture in &made.pictures { (picture.inside) } }
            @if !made.pages.is_empty() {
                div.play { @for play in &made.pages { figure {
                    a href={ (play.path) (play.choices) } { (play.thumbnail.inside) (play.label) }
                    figcaption { a href=(play.scene.0) { "scene file" } }
                } } }
            }
            @if let [first, more @ ..] = made.tables.as_slice() {
                (first)
                @if !more.is_empty() {
                    details { summary { "More measurements" } @for table in more { (table) } }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::{Drawing, Stroke, palette};
    use crate::figures::Play;
    use crate::report::{Picture, Table};

    #[test]
    fn the_section_holds_everything() {
        let mut drawing = Drawing::new();
        let line = [[0.0, 0.0], [100.0, 0.0]];
        drawing.line(&line, Stroke::new(palette::INK, 6.0));
        let png = |file, alt| Picture::png(file, vec![1, 2, 3], alt);
        let made = Made {
            title: "A < B",
            paper: "said",
            here: "seen",
            pictures: vec![
                Picture::svg("a", &drawing, "a"),
                png("b.png", "b \"quoted\""),
            ],
            pages: vec![Play {
                path: "fig10-a.html".into(),
                choices: "#bodies=glass",
                label: "M<2>".into(),
                page: String::new(),
                scene: ("scenes/a.toml".into(), String::new()),
                thumbnail: png("fig10-a-end.png", "Figure 10, M<2>, at the end"),
            }],
            tables: vec![Table::new("t", &["x"]).with_texts([vec!["<1>".into()]])],
        };
        let html = section(10, &made).into_string();
        for part in [
            "A &lt; B",
            // 106 x 6 and a margin of 2 points all around, enlarged by 1.3.
            "width=\"143.00pt\" height=\"13.00pt\"",
            "alt=\"b &quot;quoted&quot;\" src=\"data:image/png;base64,AQID\"",
            "<td>&lt;1&gt;</td>",
            "<a href=\"scenes/a.toml\">scene file</a>",
            "<a href=\"fig10-a.html#bodies=glass\"><img alt=\"Figure 10, M&lt;2&gt;, at the end\" \
             src=\"data:image/png;base64,AQID\">M&lt;2&gt;</a>",
        ] {
            assert!(html.contains(part), "{part} is missing in {html}");
        }
    }
}
