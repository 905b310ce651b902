//! Texts that do no more than being read.

use std::borrow::Cow;
use std::fmt::Write;

/// A text whose control characters are written as `\u001b`, all but line breaks, tabs and those of `kept`: names
/// of files and in files may have such that move the cursor, change the title of a terminal or hide what follows.
pub(super) fn printable<'a>(text: &'a str, kept: &[char]) -> Cow<'a, str> {
    let is_plain = |c: char| !controls(c) || ['\n', '\t'].contains(&c) || kept.contains(&c);
    if text.chars().all(is_plain) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match is_plain(c) {
            true => plain.push(c),
            false => write!(plain, "\\u{:04x}", c as u32).expect("memory takes every text"),
        }
    }
    Cow::Owned(plain)
}

/// Whether a character controls the terminal or the direction of the text.
fn controls(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_stay_and_controls_are_shown() {
        let text = "Fläche 1\n\tzwei";
        assert!(matches!(printable(text, &[]), Cow::Borrowed(_)));
        assert_eq!(
            printable("\u{1b}]0;x\u{7} \u{9b}2J \u{202e}a\r", &[]),
            "\\u001b]0;x\\u0007 \\u009b2J \\u202ea\\u000d"
        );
        assert_eq!(
            printable("\u{1b}[1m\u{9b}", &['\u{1b}']),
            "\u{1b}[1m\\u009b"
        );
    }
}
