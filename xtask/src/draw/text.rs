//! Text with subscripts, superscripts and slanted letters: `_{..}` lowers, `^{..}` raises, `~..~` slants.

/// Size of ordinary text in drawings, points.
pub(crate) const TEXT: f64 = 9.0;

/// Size of text inside crowded drawings, points.
pub(crate) const SMALL: f64 = 7.5;

/// Whether a piece of text is lowered or raised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Script {
    No,
    Sub,
    Super,
}

impl Script {
    /// Size relative to the text.
    pub(super) fn size(self) -> f64 {
        if self == Self::No { 1.0 } else { 0.72 }
    }

    /// Height of the baseline above that of the text, em of the text.
    pub(super) fn rise(self) -> f64 {
        match self {
            Self::No => 0.0,
            Self::Sub => -0.22,
            Self::Super => 0.38,
        }
    }
}

/// Characters that are written alike.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) text: String,
    pub(super) script: Script,
    pub(super) slanted: bool,
}

impl Piece {
    /// Estimated width, em of the whole text.
    pub(super) fn width(&self) -> f64 {
        self.script.size() * self.text.chars().map(advance).sum::<f64>()
    }
}

/// The pieces of a text, none of them empty.
pub(super) fn pieces(text: &str) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let (mut script, mut slanted) = (Script::No, false);
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '_' | '^' if chars.next_if_eq(&'{').is_some() => {
                script = if c == '_' { Script::Sub } else { Script::Super };
            }
            '}' if script != Script::No => script = Script::No,
            '~' => slanted = !slanted,
            _ => match pieces.last_mut() {
                Some(last) if (last.script, last.slanted) == (script, slanted) => last.text.push(c),
                _ => pieces.push(Piece {
                    text: c.into(),
                    script,
                    slanted,
                }),
            },
        }
    }
    pieces
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
    fn marks_become_pieces() {
        let all = pieces("~v~_{I}^{~t~} = 2");
        let seen: Vec<_> = all
            .iter()
            .map(|p| (&*p.text, p.script, p.slanted))
            .collect();
        let known = [
            ("v", Script::No, true),
            ("I", Script::Sub, false),
            ("t", Script::Super, true),
            (" = 2", Script::No, false),
        ];
        assert_eq!(seen, known);
        assert_eq!(pieces("a_1 + b}")[0].text, "a_1 + b}");
    }

    #[test]
    fn scripts_are_narrower() {
        assert!(width("v_{12}", 10.0) < width("v12", 10.0));
        assert!((width("~v~", 10.0) - width("v", 10.0)).abs() < 1e-12);
    }
}
