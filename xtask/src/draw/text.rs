//! Sizes of text.

/// Size of ordinary text in drawings, points.
pub(crate) const TEXT: f64 = 9.0;

/// Size of text inside crowded drawings, points.
pub(crate) const SMALL: f64 = 7.5;

/// Estimated width in points: enough for whichever font the viewer has.
pub(super) fn width(text: &str, size: f64) -> f64 {
    size * text.chars().map(advance).sum::<f64>()
}

/// The widest of the font families that the files name, em.
fn advance(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '\'' | 'I' => 0.28,
        ' ' | '.' | ',' | ':' | ';' | '/' | '|' => 0.33,
        'f' | 't' | 'r' | '-' | '(' | ')' | '!' => 0.40,
        '°' => 0.50,
        '₀'..='₉' | '⁰'..='⁹' | '¹' | '²' | '³' | 'ᵗ' | '′' => 0.45,
        'm' | 'M' | 'W' | '%' => 0.96,
        '=' | '+' | '−' | '≤' | '<' | '>' | '×' => 0.84,
        'w' | 'C' | 'D' | 'G' | 'H' | 'N' | 'O' | 'Q' | 'R' | 'U' => 0.78,
        'A' | 'B' | 'E' | 'K' | 'P' | 'S' | 'V' | 'X' | 'Y' | 'T' | 'F' | 'L' | 'Z' => 0.68,
        _ => 0.63,
    }
}
