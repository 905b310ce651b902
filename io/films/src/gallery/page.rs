//! The page of a gallery.

use super::entry::{GalleryEntry, RUNS};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::path::PathBuf;

const STYLE: &str = "\
:root{color-scheme:light dark;--text:#222;--muted:#667;--page:#fff;--rule:#dde;--link:#0b57a4}
@media(prefers-color-scheme:dark){:root{--text:#dfe4ea;--muted:#98a2ae;--page:#14171b;--rule:#30363d;--link:#58a6ff}}
body{font:15px/1.45 Helvetica,Arial,sans-serif;color:var(--text);background:var(--page);margin:2rem auto;
max-width:80rem;padding:0 1.2rem}
h1{font-size:1.6rem;margin:0}header p{color:var(--muted);margin:.2rem 0 1.4rem}
main{display:grid;grid-template-columns:repeat(auto-fill,minmax(17rem,1fr));gap:1.2rem}
article{border:1px solid var(--rule);border-radius:6px;overflow:hidden;display:flex;flex-direction:column}
article>a{display:block;background:#fff;height:13rem}article img{width:100%;height:100%;object-fit:contain}
div{padding:.7rem .9rem .9rem}h2{font-size:1.05rem;margin:0;overflow-wrap:anywhere}h2 a{color:var(--link)}
p{margin:.3rem 0 .6rem}dl{display:grid;grid-template-columns:auto 1fr;gap:.05rem .8rem;margin:0;font-size:.88rem}
dt{color:var(--muted)}dd{margin:0;font-variant-numeric:tabular-nums}.folder{color:var(--muted);font-size:.8rem;
overflow-wrap:anywhere;margin:.6rem 0 0}footer{margin:2rem 0;color:var(--muted);overflow-wrap:anywhere}";

/// The page of the runs, and of folders that are not shown with the reasons.
pub(super) fn page(entries: &[GalleryEntry], left_out: &[(PathBuf, String)]) -> String {
    let count = match entries.len() {
        1 => "1 run".to_owned(),
        n => format!("{n} runs"),
    };
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "Gallery of runs" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { "Gallery of runs" }
                    p { (count) ". A picture shows the end of its run and leads to the page that plays it." }
                }
                main { @for entry in entries { (card(entry)) } }
                @if !left_out.is_empty() {
                    footer {
                        h2 { "Not shown" }
                        ul {
                            @for (folder, reason) in left_out {
                                li { (folder.display()) ": " (reason) }
                            }
                        }
                    }
                }
            }
        }
    };
    page.into_string() + "\n"
}

fn card(entry: &GalleryEntry) -> Markup {
    let [page, picture] = ["html", "png"].map(|e| format!("{}/{}.{e}", RUNS, entry.name));
    html! {
        article {
            a href=(page) { img src=(picture) alt={ "The sheet at the end of " (entry.title) } loading="lazy"; }
            div {
                h2 { a href=(page) { (entry.title) } }
                @if !entry.caption.is_empty() { p { (entry.caption) } }
                dl { @for (name, value) in numbers(entry) { dt { (name) } dd { (value) } } }
                p.folder { (entry.folder.display()) }
            }
        }
    }
}

/// The values by which a run of a sweep differs from the others, and the key numbers of a run.
fn numbers(entry: &GalleryEntry) -> Vec<(&str, String)> {
    let swept = entry.values.iter();
    let mut rows: Vec<(&str, String)> = swept
        .map(|(key, value)| (&key[..], value.clone()))
        .collect();
    rows.push(("vertices", entry.vertices.to_string()));
    let Some(summary) = &entry.summary else {
        rows.push(("state", format!("not complete: up to {:.3} s", entry.t)));
        return rows;
    };
    rows.push(("time", format!("{:.3} s", entry.t)));
    rows.push(("steps", summary.steps.to_string()));
    rows.push(("largest strain", format!("{:.1e}", summary.largest_strain)));
    if let Some(gap) = summary.gap_in_words() {
        rows.push(("smallest gap", gap));
    }
    rows.push(("wall time", format!("{:.2} s", summary.wall_time)));
    rows
}
