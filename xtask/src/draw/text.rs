//! Text with subscripts, superscripts and slanted letters.
//!
//! `_{..}` lowers, `^{..}` raises, `~..~` slants.

use maud::{Markup, html};

/// Size of ordinary text in drawings, points.
pub(crate) const TEXT: f64 = 9.0;

/// Size of text inside crowded drawings, points.
pub(crate) const SMALL: f64 = 7.5;

/// Size of subscripts and superscripts relative to the text.
const SCRIPT: f64 = 0.72;

/// Shift of the baseline of subscripts and superscripts, em of the text.
const SHIFT: [f64; 2] = [0.22, 0.38];

/// Where a piece of text stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Script {
    #[default]
    Base,
    Lowered,
    Raised,
}

impl Script {
    /// Size, and height above the baseline in em of the text.
    fn size_and_height(self) -> [f64; 2] {
        match self {
            Self::Base => [1.0, 0.0],
            Self::Lowered => [SCRIPT, -SHIFT[0]],
            Self::Raised => [SCRIPT, SHIFT[1]],
        }
    }
}

/// Letters of one look.
#[derive(Clone, Debug, Default, PartialEq)]
struct Piece {
    letters: String,
    script: Script,
    slanted: bool,
}

impl Piece {
    /// Estimated width, em of the text.
    fn width(&self) -> f64 {
        let [size, _] = self.script.size_and_height();
        size * self.letters.chars().map(advance).sum::<f64>()
    }
}

/// The pieces that the mark-up separates; a brace that closes nothing is a letter.
fn pieces(text: &str) -> Vec<Piece> {
    let mut pieces = vec![Piece::default()];
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        let now = &pieces[pieces.len() - 1];
        let (mut script, mut slanted) = (now.script, now.slanted);
        match c {
            '_' | '^' if chars.next_if_eq(&'{').is_some() => {
                script = if c == '_' {
                    Script::Lowered
                } else {
                    Script::Raised
                };
            }
            '}' if script != Script::Base => script = Script::Base,
            '~' => slanted = !slanted,
            _ => {
                let last = pieces.len() - 1;
                pieces[last].letters.push(c);
                continue;
            }
        }
        pieces.push(Piece {
            letters: String::new(),
            script,
            slanted,
        });
    }
    pieces.retain(|p| !p.letters.is_empty());
    pieces
}

/// The contents of a text element of the given size (points). A raised piece right after a lowered one stands
/// above it.
pub(super) fn markup(text: &str, size: f64) -> Markup {
    let pieces = pieces(text);
    let mut before = &Piece::default();
    let mut spans = Vec::new();
    for piece in &pieces {
        let [scale, height] = piece.script.size_and_height();
        let rise = height - before.script.size_and_height()[1];
        let stacked = (before.script, piece.script) == (Script::Lowered, Script::Raised);
        let shift = |by: f64| (by != 0.0).then(|| format!("{by:.2}"));
        let dx = shift(if stacked { -size * before.width() } else { 0.0 });
        let font = (scale < 1.0).then(|| format!("{:.2}", size * scale));
        spans.push(html! {
            tspan dx=[dx] dy=[shift(-size * rise)] font-size=[font]
                font-style=[piece.slanted.then_some("italic")] { (piece.letters) }
        });
        before = piece;
    }
    html! { @for span in &spans { (span) } }
}

/// Estimated width in points: enough for whichever font the viewer has.
pub(super) fn width(text: &str, size: f64) -> f64 {
    size * pieces(text).iter().map(Piece::width).sum::<f64>()
}

/// How far the text reaches below and above its baseline, points.
pub(super) fn extent(text: &str, size: f64) -> (f64, f64) {
    let low = if text.contains("_{") { 0.36 } else { 0.22 };
    let high = if text.contains("^{") { 0.92 } else { 0.74 };
    (low * size, high * size)
}

/// The widest of the font families that the files name, em.
fn advance(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '\'' | 'I' => 0.28,
        ' ' | '.' | ',' | ':' | ';' | '/' | '|' => 0.33,
        'f' | 't' | 'r' | '-' | '(' | ')' | '!' => 0.40,
        '°' => 0.50,
        'm' | 'M' | 'W' | '%' => 0.96,
        '=' | '+' | '−' | '≤' | '<' | '>' | '×' => 0.84,
        'w' | 'C' | 'D' | 'G' | 'H' | 'N' | 'O' | 'Q' | 'R' | 'U' => 0.78,
        'A' | 'B' | 'E' | 'K' | 'P' | 'S' | 'V' | 'X' | 'Y' | 'T' | 'F' | 'L' | 'Z' => 0.68,
        _ => 0.63,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_return_to_the_baseline() {
        let svg = markup("~v~_{I}^{t} = 2", 10.0).into_string();
        assert_eq!(
            svg,
            "<tspan font-style=\"italic\">v</tspan><tspan dy=\"2.20\" font-size=\"7.20\">I</tspan>\
             <tspan dx=\"-2.02\" dy=\"-6.00\" font-size=\"7.20\">t</tspan><tspan dy=\"3.80\"> = 2</tspan>"
        );
        assert_eq!(
            markup("a + b}", 10.0).into_string(),
            "<tspan>a + b}</tspan>"
        );
    }

    #[test]
    fn scripts_are_narrower() {
        assert!(width("v_{12}", 10.0) < width("v12", 10.0));
        assert!((width("~v~", 10.0) - width("v", 10.0)).abs() < 1e-12);
    }
}
