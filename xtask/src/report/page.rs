//! Pages: one HTML file each, pictures inside.

use super::picture::Picture;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// The look of all pages.
const STYLE: &str = "\
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

/// A page. Whatever is written into its body is escaped by the templates of maud.
#[derive(Clone, Debug)]
pub(crate) struct Page {
    /// The title of the window.
    pub(crate) title: &'static str,
    pub(crate) heading: &'static str,
    /// Rules of style beside those of all pages.
    pub(crate) style: &'static str,
    pub(crate) body: Markup,
}

impl Page {
    /// A page whose heading is its title.
    pub(crate) fn new(title: &'static str, body: Markup) -> Self {
        Self {
            title,
            heading: title,
            style: "",
            body,
        }
    }

    /// The file.
    pub(crate) fn to_html(&self) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) (PreEscaped(self.style)) }
                }
                body { h1 { (self.heading) } (self.body) }
            }
        };
        page.into_string() + "\n"
    }
}

/// A list of sentences; nothing where there are none.
pub(crate) fn list(items: &[String]) -> Markup {
    html! { @if !items.is_empty() { ul { @for item in items { li { (item) } } } } }
}

/// Size of drawings in the page relative to their own: their text is as large as that of the page then.
const ENLARGED: f64 = 1.3;

/// A drawing inside the page: an SVG file without its XML declaration, enlarged.
pub(crate) fn drawing(svg: &[u8]) -> Markup {
    let svg = String::from_utf8_lossy(svg);
    let mut out = svg
        .find("<svg")
        .map_or(&*svg, |start| &svg[start..])
        .to_owned();
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
    PreEscaped(out)
}

impl Picture {
    /// The picture inside the page, whose file has the given contents.
    pub(crate) fn inside(&self, bytes: &[u8]) -> Markup {
        if self.path.ends_with(".svg") {
            return drawing(bytes);
        }
        let data = format!("data:image/png;base64,{}", STANDARD.encode(bytes));
        html! { img alt=(self.alt) src=(data); }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawings_are_enlarged_and_texts_escaped() {
        let svg = br#"<?xml?><svg width="100.00pt" height="50.00pt"></svg>"#;
        assert_eq!(
            drawing(svg).into_string(),
            "<svg width=\"130.00pt\" height=\"65.00pt\"></svg>"
        );
        let page = Page::new("a < b", list(&["\"c\" & d".into()])).to_html();
        assert!(page.contains("<title>a &lt; b</title>"), "{page}");
        assert!(
            page.contains("<ul><li>&quot;c&quot; &amp; d</li></ul>"),
            "{page}"
        );
        assert_eq!(list(&[]).into_string(), "");
    }
}
