//! Text with subscripts, superscripts and slanted letters.
//!
//! `_{..}` lowers, `^{..}` raises, `~..~` slants. The SVG backend knows none of these, so they travel through
//! it as private characters ([`encode`]) and become `<tspan>` elements in the file ([`decode`]).

/// Size of ordinary text in drawings, points.
pub(crate) const TEXT: f64 = 9.0;

/// Size of text inside crowded drawings, points.
pub(crate) const SMALL: f64 = 7.5;

/// Size of subscripts and superscripts relative to the text.
const SCRIPT: f64 = 0.72;

/// Shift of the baseline of subscripts and superscripts, em of the text.
const SHIFT: [f64; 2] = [0.22, 0.38];

const SUB: char = '\u{e000}';
const SUPER: char = '\u{e001}';
const END_SUB: char = '\u{e002}';
const END_SUPER: char = '\u{e003}';
const SLANT: char = '\u{e004}';
const END_SLANT: char = '\u{e005}';

/// Replaces the mark-up by private characters.
pub(super) fn encode(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut open = Vec::new();
    let mut slanted = false;
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '_' | '^' if chars.peek() == Some(&'{') => {
                chars.next();
                out.push(if c == '_' { SUB } else { SUPER });
                open.push(if c == '_' { END_SUB } else { END_SUPER });
            }
            '}' => match open.pop() {
                Some(end) => out.push(end),
                None => out.push(c),
            },
            '~' => {
                out.push(if slanted { END_SLANT } else { SLANT });
                slanted = !slanted;
            }
            _ => out.push(c),
        }
    }
    out
}

/// Replaces the private characters in an SVG file by elements.
pub(super) fn decode(svg: &str) -> String {
    let mut out = String::with_capacity(svg.len());
    // Shift that a raised piece right after a lowered one has to take back, em of the text.
    let mut back = 0.0;
    // Width of the last lowered piece, em of its own size: a raised piece right after it stands above it.
    let mut lowered = 0.0;
    let mut chars = svg.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            SUB | SUPER => {
                let shift = if c == SUB { SHIFT[0] } else { -SHIFT[1] } + back;
                let dx = if back == 0.0 {
                    String::new()
                } else {
                    format!(" dx=\"{:.3}em\"", -lowered)
                };
                back = 0.0;
                lowered = 0.0;
                out.push_str(&format!(
                    "<tspan dy=\"{:.3}em\"{dx} font-size=\"{:.0}%\">",
                    shift / SCRIPT,
                    100.0 * SCRIPT
                ));
            }
            END_SUB | END_SUPER => {
                out.push_str("</tspan>");
                let shift = if c == END_SUB { -SHIFT[0] } else { SHIFT[1] };
                match chars.peek() {
                    // The text ends here: nothing to take back.
                    Some('<' | '\n') | None => back = 0.0,
                    Some(&SUB | &SUPER) => back = shift,
                    Some(_) => {
                        // A zero-width piece carries the shift, so that slanted text may follow.
                        out.push_str(&format!("<tspan dy=\"{shift:.3}em\">\u{200b}</tspan>"));
                        back = 0.0;
                    }
                }
            }
            SLANT => out.push_str("<tspan font-style=\"italic\">"),
            END_SLANT => out.push_str("</tspan>"),
            _ => {
                lowered += advance(c);
                out.push(c);
            }
        }
    }
    out
}

/// Estimated width in points: enough for whichever font the viewer has.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let mut scale = 1.0;
    let mut sum = 0.0;
    for c in encode(text).chars() {
        match c {
            SUB | SUPER => scale = SCRIPT,
            END_SUB | END_SUPER => scale = 1.0,
            SLANT | END_SLANT => {}
            _ => sum += scale * advance(c),
        }
    }
    sum * size
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
        let svg = decode(&encode("~v~_{I}^{t} = 2"));
        assert_eq!(
            svg,
            "<tspan font-style=\"italic\">v</tspan><tspan dy=\"0.306em\" font-size=\"72%\">I</tspan>\
             <tspan dy=\"-0.833em\" dx=\"-0.280em\" font-size=\"72%\">t</tspan><tspan dy=\"0.380em\">\u{200b}</tspan> = 2"
        );
        assert_eq!(decode(&encode("a + b}")), "a + b}");
    }

    #[test]
    fn scripts_are_narrower() {
        assert!(width("v_{12}", 10.0) < width("v12", 10.0));
        assert!((width("~v~", 10.0) - width("v", 10.0)).abs() < 1e-12);
    }
}
