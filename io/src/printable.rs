//! Texts that do no more than being read.

use std::borrow::Cow;
use std::fmt::Write;

/// A text whose control characters are written as `\u001b`, all but line breaks, tabs and `kept`: names of
/// files and in files may have such that move the cursor, change the title of a terminal or hide what
/// follows.
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

/// Characters of a line of a message at most: two of the longest paths of Linux.
const LONGEST: usize = 2 * 4096;

/// A text whose longer lines have their beginning alone, with the number of the characters that are left out.
pub(super) fn shortened(text: &str) -> Cow<'_, str> {
    if text.len() <= LONGEST {
        return Cow::Borrowed(text);
    }
    let lines = text
        .split('\n')
        .map(|line| match line.char_indices().nth(LONGEST) {
            None => Cow::Borrowed(line),
            Some((end, _)) => {
                let more = line[end..].chars().count();
                Cow::Owned(format!("{}... ({more} more characters)", &line[..end]))
            }
        });
    Cow::Owned(lines.collect::<Vec<_>>().join("\n"))
}

/// Whether a character controls the terminal, the lines or the direction of the text.
fn controls(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_shortened() {
        assert!(matches!(shortened("a name\nb"), Cow::Borrowed(_)));
        let text = format!("error: {}\n  = help: rename it", "n".repeat(100_000));
        let [first, last] = [0, 1].map(|k| shortened(&text).split('\n').nth(k).unwrap().to_owned());
        assert!(first.len() < LONGEST + 40, "{}", first.len());
        assert!(
            first.ends_with("n... (91815 more characters)"),
            "{}",
            &first[LONGEST..]
        );
        assert_eq!(last, "  = help: rename it");
    }

    #[test]
    fn texts_stay_and_controls_are_shown() {
        let text = "Fläche 1\n\tzwei";
        assert!(matches!(printable(text, &[]), Cow::Borrowed(_)));
        assert_eq!(
            printable("\u{1b}]0;x\u{7} \u{9b}2J \u{202e}a\r", &[]),
            "\\u001b]0;x\\u0007 \\u009b2J \\u202ea\\u000d"
        );
        assert_eq!(printable("a\u{2028}b\u{2029}c", &[]), "a\\u2028b\\u2029c");
        assert_eq!(
            printable("\u{1b}[1m\u{9b}", &['\u{1b}']),
            "\u{1b}[1m\\u009b"
        );
    }
}
