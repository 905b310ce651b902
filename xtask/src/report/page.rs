//! Pages: one HTML file each, pictures inside.

use super::Effort;
use crate::store::Store;
use anyhow::Result;
use maud::{DOCTYPE, Markup, PreEscaped, Render, html};
use serde::{Deserialize, Serialize};

/// The look of all pages.
const STYLE: &str = "\
:root{color-scheme:light}body{font:16px/1.5 Helvetica,Arial,sans-serif;color:#222;background:#fff;margin:2.5rem auto;\
max-width:64rem;padding:0 1.5rem}h1{font-size:1.7rem;margin-bottom:.3rem}h2{font-size:1.15rem;margin:0 0 .7rem}\
section{border-top:1px solid #ddd;padding:1.6rem 0}figure{margin:0 0 1rem}figure svg,figure img{max-width:100%;height:auto;\
display:block;margin:auto}.pictures{display:flex;flex-wrap:wrap;gap:1rem;align-items:center}.pictures a>*{display:block;width:auto;height:auto;\
max-width:min(30rem,100%);max-height:15rem}.note{background:#fdf3d8;padding:.5rem .8rem}\
.scroll{overflow-x:auto}table{border-collapse:collapse;min-width:24rem;font-size:.88rem;margin:.8rem 0}caption{text-align:left;color:#666;\
padding-bottom:.3rem}th,td{border-bottom:1px solid #ddd;padding:.25rem .8rem .25rem 0;text-align:left;vertical-align:top}\
.play{display:flex;flex-wrap:wrap;gap:.6rem 1rem;margin:1rem 0;text-align:center}.play figure{margin:0;max-width:11rem}\
.play a{color:#0b57a4;font-size:.85rem;text-decoration:none}.play a:hover{text-decoration:underline}\
.play img{display:block;height:5rem;margin:auto}th{font-weight:600}summary{color:#0b57a4;cursor:pointer}";

/// A page. Whatever is written into its body is escaped by the templates of maud.
#[derive(Clone, Debug)]
pub(crate) struct Page {
    /// The title of the window.
    pub(crate) title: &'static str,
    pub(crate) heading: &'static str,
    /// Rules of style beside the rules of all pages.
    pub(crate) style: &'static str,
    /// Parts that are not on the page, as another build of the program made them.
    pub(crate) left_out: Vec<String>,
    pub(crate) body: Markup,
}

impl Page {
    /// A page whose heading is its title.
    pub(crate) fn new(title: &'static str, body: Markup) -> Self {
        Self {
            title,
            heading: title,
            style: "",
            left_out: Vec::new(),
            body,
        }
    }

    /// Writes the page as a file of the output folder and says where it is.
    pub(crate) fn write(&self, store: &Store, file: &str) -> Result<()> {
        store.write(file, self.to_html(store.effort).as_bytes())?;
        println!("{}", store.path(file).display());
        Ok(())
    }

    /// The file.
    pub(crate) fn to_html(&self, effort: Effort) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) (PreEscaped(self.style)) }
                }
                body {
                    h1 { (self.heading) }
                    @if effort == Effort::Quick {
                        p.note {
                            "Made with " code { "--quick" } ": short runs on small meshes, which show that everything "
                            "works, and no result."
                        }
                    }
                    @if !self.left_out.is_empty() {
                        p.note {
                            "Left out, since another build of the program made them or their files are gone: "
                            (self.left_out.join(", ")) ". The same command makes them again."
                        }
                    }
                    (self.body)
                }
            }
        };
        page.into_string() + "\n"
    }
}

/// A part of a page, as units keep it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Section(String);

impl From<Markup> for Section {
    fn from(markup: Markup) -> Self {
        Self(markup.into_string())
    }
}

impl Render for Section {
    fn render(&self) -> Markup {
        PreEscaped(self.0.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped_and_quick_results_marked() {
        let page = Page::new("a < b", html! { p { "\"c\" & d" } });
        let full = page.to_html(Effort::Full);
        for part in ["<title>a &lt; b</title>", "<p>&quot;c&quot; &amp; d</p>"] {
            assert!(full.contains(part), "{full}");
        }
        let is_marked = |page: String| page.contains("class=\"note\"");
        assert!(is_marked(page.to_html(Effort::Quick)) && !is_marked(full));
        let left_out = vec!["figure 3".to_owned()];
        let page = Page { left_out, ..page };
        assert!(
            page.to_html(Effort::Full)
                .contains("or their files are gone: figure 3.")
        );
    }
}
