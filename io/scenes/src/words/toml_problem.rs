//! What the readers of TOML say, in words of scenes.

use crate::words::key::Key;
use crate::words::problem::Problem;

/// A text that is no TOML.
pub(crate) fn syntax_problem(error: &toml_edit::TomlError) -> Problem {
    Problem {
        key: Key::root(),
        message: error.message().to_owned(),
        remedy: Some("correct the syntax; https://toml.io describes it".into()),
        span: error.span(),
    }
}

/// A text that is TOML and no scene.
pub(crate) fn toml_problem(error: &toml::de::Error) -> Problem {
    let (message, remedy) = in_words(error.message());
    Problem {
        span: error.span(),
        ..Problem::new(Key::root(), message, remedy)
    }
}

/// Message and remedy.
fn in_words(full: &str) -> (String, String) {
    let message = full.lines().next().unwrap_or_default();
    // An empty table is found where an enum is expected.
    let wrong =
        wrong_type(message).filter(|(_, expected)| !["enum", "newtype variant"].contains(expected));
    if let Some((found, expected)) = wrong {
        let (expected, remedy) = expected_in_words(expected);
        let message = match found {
            "" => format!("expected {expected}"),
            found => format!("expected {expected}, found {}", found_in_words(found)),
        };
        return (message, remedy.to_owned());
    }
    let names: Vec<&str> = full.split('`').skip(1).step_by(2).collect();
    match names.split_first() {
        Some((bad, known)) if message.starts_with("unknown variant") => {
            (format!("unknown choice `{bad}`"), suggestion(bad, known))
        }
        Some((missing, _)) if message.starts_with("missing field") => (
            format!("the key `{missing}` is missing here"),
            "add it; docs/scene.md describes all keys".to_owned(),
        ),
        // Of a choice whose names have tables of their own.
        _ if message.starts_with("wanted exactly 1 element, more") => (
            "this is one choice among several, and more than one is given".to_owned(),
            "keep one of them".to_owned(),
        ),
        _ if message.starts_with("invalid type: unit variant, expected") => (
            "this choice has a value, and none is given".to_owned(),
            "write it as a table, `{ choice = value }`; docs/scene.md has the choices".to_owned(),
        ),
        _ if message.starts_with("wanted exactly 1 element, found 0")
            || message.ends_with(", expected enum") =>
        {
            (
                "this is one choice among several, and none is given".to_owned(),
                "docs/scene.md has the choices".to_owned(),
            )
        }
        _ => (
            message.to_owned(),
            "docs/scene.md describes all keys, https://toml.io the syntax".to_owned(),
        ),
    }
}

/// What was found and what was expected, in the words of the reader.
fn wrong_type(message: &str) -> Option<(&str, &str)> {
    if message == "wanted string or table" {
        return Some(("", "string or table"));
    }
    let kinds = ["invalid type: ", "invalid value: ", "invalid length "];
    let rest = kinds.iter().find_map(|kind| message.strip_prefix(kind))?;
    rest.rsplit_once(", expected ")
}

fn found_in_words(found: &str) -> String {
    let pairs = [
        ("map", "a table"),
        ("sequence", "a list"),
        ("boolean ", ""),
        ("integer ", "the number "),
        ("floating point ", "the number "),
        ("string ", "the text "),
    ];
    let known = pairs.iter().find_map(|(name, words)| {
        let rest = found.strip_prefix(name)?;
        Some(format!("{words}{rest}"))
    });
    let known = known.unwrap_or_else(|| found.to_owned());
    match known.parse::<usize>() {
        Ok(length) => format!("a list of length {length}"),
        Err(_) => known,
    }
}

/// What is expected, and what to do.
fn expected_in_words(expected: &str) -> (String, &'static str) {
    const TABLE: &str = "write its keys in braces, `{ key = value }`; docs/scene.md describes them";
    const NUMBER: &str = "write a number, without quotes";
    let (words, remedy) = match expected {
        "f64" => ("a number", NUMBER),
        "u32" | "u64" | "usize" => (
            "a whole number of at least 0",
            "write a whole number of at least 0, without quotes",
        ),
        "a boolean" => ("true or false", "write `true` or `false`, without quotes"),
        "a string" => ("a text", "write it in quotes"),
        "path string" => ("a path", "write the path in quotes"),
        "a sequence" => ("a list", "write the values in brackets, `[1, 2]`"),
        "string or table" => (
            "the name of a choice, or a table",
            "write names in quotes; docs/scene.md describes the choices",
        ),
        other if other.starts_with("struct ") || other.contains(" variant ") => ("a table", TABLE),
        other => return expected_list(other),
    };
    (words.to_owned(), remedy)
}

/// Lists of fixed length; other words are words of scenes already.
fn expected_list(expected: &str) -> (String, &'static str) {
    let lengths = ["an array of length ", "a tuple of size "];
    let length = lengths.iter().find_map(|l| expected.strip_prefix(l));
    match length {
        Some(length) => (
            format!("a list of length {length}"),
            "write so many values in brackets, `[1, 2]`",
        ),
        None => (
            expected.to_owned(),
            "docs/scene.md describes what is expected; numbers have no quotes",
        ),
    }
}

/// The nearest known name, and all of them.
pub(crate) fn suggestion(bad: &str, known: &[&str]) -> String {
    let all = known.iter().map(|k| format!("`{k}`")).collect::<Vec<_>>();
    let all = all.join(", ");
    let nearest = known
        .iter()
        .map(|k| (strsim::damerau_levenshtein(bad, k), k))
        .min();
    match nearest {
        // As many wrong letters as a word of this length has by accident: one, and one more for every three.
        Some((distance, k)) if distance <= 1 + k.len() / 3 => {
            format!("did you mean `{k}`? Known here: {all}")
        }
        Some(_) => format!("known here: {all}"),
        None => "no key is known here".to_owned(),
    }
}
