//! XML files, which are read in memory and time in proportion to their length.
//!
//! The parser copies an entity wherever it is named, compares each attribute with the others of its element,
//! and each prefix of a namespace with the others around it. All of this is counted before it begins.

use roxmltree::{Document, ParsingOptions};
use std::collections::{HashMap, HashSet};
use thiserror::Error;

/// What becomes of the entities that a file defines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entities {
    /// Their text stands where they are named.
    Expanded,
    /// The file is refused.
    Refused,
}

/// Why a file is not read as XML.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum XmlError {
    /// The parser refuses it.
    #[error("the file is not valid XML: {0}")]
    Invalid(#[from] roxmltree::Error),
    /// Its entities would become too long a text.
    #[error(
        "its entities would become a text of {expanded} bytes, more than the {most} for a file of this length"
    )]
    Entities {
        /// The length of the text, bytes.
        expanded: u64,
        /// How long it may be, bytes.
        most: u64,
    },
    /// Its entities are too many.
    #[error("it defines more than {MOST_ENTITIES} entities")]
    ManyEntities,
    /// The attributes of an element are too many.
    #[error("an element has more than {MOST_ATTRIBUTES} attributes")]
    Attributes,
    /// Its prefixes are too many.
    #[error("it has more than {MOST_PREFIXES} prefixes of namespaces")]
    Prefixes,
}

/// Each reference to an entity is compared with so many names at most; Illustrator defines some ten for
/// namespaces, and one for each style of its lines.
const MOST_ENTITIES: usize = 1000;

/// Each attribute is compared with so many others of its element at most; SVG knows some 300.
const MOST_ATTRIBUTES: usize = 1000;

/// Each element with a namespace compares the prefixes around it with each other; drawing programs have some
/// ten.
const MOST_PREFIXES: usize = 100;

/// The parser follows entities in entities so deep.
const DEEPEST: usize = 10;

/// Bytes that entities may become in any file.
const LEAST: u64 = 1 << 17;

/// Bytes that entities may become for each byte of a file: the name of a style of Illustrator with its path
/// takes 38 bytes, and the style 106.
const TIMES: u64 = 4;

/// Parses XML.
///
/// # Errors
/// [`XmlError`]
pub fn parse(text: &str, entities: Entities) -> Result<Document<'_>, XmlError> {
    let options = ParsingOptions {
        allow_dtd: entities == Entities::Expanded,
        // (Each has four bytes or more: `<a/>`.)
        nodes_limit: 1 << 24,
        ..ParsingOptions::default()
    };
    if options.allow_dtd {
        check_entities(text)?;
    }
    check_elements(text)?;
    Ok(Document::parse_with_options(text, options)?)
}

/// Refuses entities that become too long a text.
fn check_entities(text: &str) -> Result<(), XmlError> {
    let defined = definitions(text);
    if defined.len() > MOST_ENTITIES {
        return Err(XmlError::ManyEntities);
    }
    let mut lengths: HashMap<&str, u64> = HashMap::new();
    for _ in 0..DEEPEST {
        let expanded = |value: &str| {
            let inner = references(value).filter_map(|name| lengths.get(name));
            inner.fold(value.len() as u64, |sum, n| sum.saturating_add(*n))
        };
        lengths = defined
            .iter()
            .map(|(name, v)| (*name, expanded(v)))
            .collect();
    }
    let all = references(text).filter_map(|name| lengths.get(name));
    let expanded = all.fold(0, |sum: u64, n| sum.saturating_add(*n));
    let most = LEAST + TIMES * text.len() as u64;
    match expanded <= most {
        true => Ok(()),
        false => Err(XmlError::Entities { expanded, most }),
    }
}

/// The names of the entities that a file defines with their texts. (Of two with one name the longer one is
/// taken.)
fn definitions(text: &str) -> HashMap<&str, &str> {
    let mut found: HashMap<&str, &str> = HashMap::new();
    for (place, mark) in text.match_indices("<!ENTITY") {
        let rest = text[place + mark.len()..].trim_start();
        let rest = rest.strip_prefix('%').unwrap_or(rest).trim_start();
        let Some((name, rest)) = rest.split_once(char::is_whitespace) else {
            continue;
        };
        let rest = rest.trim_start();
        let Some(quote) = rest.chars().next().filter(|c| ['"', '\''].contains(c)) else {
            continue;
        };
        let value = rest[1..].split(quote).next().unwrap_or_default();
        let longest = found.entry(name).or_default();
        if value.len() >= longest.len() {
            *longest = value;
        }
    }
    found
}

/// The names of the entities that a text refers to.
fn references(text: &str) -> impl Iterator<Item = &str> {
    let after = text.split('&').skip(1);
    after
        .filter_map(|rest| rest.split_once(';'))
        .map(|(name, _)| name)
}

/// Refuses elements with too many attributes, and files with too many prefixes. No attribute has a `<` in it,
/// so that what stands in one element ends before the next `<` at the latest.
fn check_elements(text: &str) -> Result<(), XmlError> {
    let mut prefixes = HashSet::new();
    for element in text.split('<').skip(1) {
        let mut count = 0;
        for name in attributes(element) {
            count += 1;
            if name.starts_with("xmlns") {
                prefixes.insert(name);
            }
        }
        if count > MOST_ATTRIBUTES {
            return Err(XmlError::Attributes);
        }
        if prefixes.len() > MOST_PREFIXES {
            return Err(XmlError::Prefixes);
        }
    }
    Ok(())
}

/// The names of the attributes of an element, whose text follows its `<`.
fn attributes(element: &str) -> impl Iterator<Item = &str> {
    let mut rest = element
        .split_once(char::is_whitespace)
        .map_or("", |(_, rest)| rest);
    std::iter::from_fn(move || {
        let (name, value) = rest
            .split_once('=')
            .filter(|(name, _)| !name.contains('>'))?;
        let value = value.trim_start();
        let quote = value.chars().next().filter(|c| ['"', '\''].contains(c))?;
        rest = value[1..].split_once(quote)?.1;
        Some(name.trim())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        parse(text, Entities::Expanded).unwrap_err().to_string()
    }

    #[test]
    fn entities_become_a_text_in_proportion_to_the_file() {
        let file = |length: usize, count: usize| {
            let (value, named) = ("x".repeat(length), "&a;".repeat(count));
            format!(r#"<!DOCTYPE s [<!ENTITY a "{value}">]><s d="{named}"/>"#)
        };
        let most = |text: &str| (1 << 17) + 4 * text.len();
        // 50 times 4 000 bytes are more than 128 KiB and four times the file.
        let text = file(4000, 50);
        assert!(200_000 > most(&text));
        let expected = format!(
            "its entities would become a text of 200000 bytes, more than the {} for a file of this length",
            most(&text)
        );
        assert_eq!(refusal(&text), expected);
        let document = file(4000, 30);
        let document = parse(&document, Entities::Expanded).unwrap();
        let value = document.root_element().attribute("d").unwrap();
        assert_eq!(value.len(), 120_000);
        // Entities in entities: 10 to the power of 9 bytes.
        let mut text = "<!DOCTYPE s [<!ENTITY a0 'x'>".to_owned();
        for k in 1..10 {
            let inner = format!("&a{};", k - 1).repeat(10);
            text += &format!("<!ENTITY a{k} '{inner}'>");
        }
        text += "]><s>&a9;</s>";
        assert!(
            refusal(&text).starts_with("its entities would become"),
            "{text}"
        );
        assert!(parse(&file(1, 1), Entities::Refused).is_err());
    }

    #[test]
    fn what_is_compared_with_each_other_is_bounded() {
        let many = |count: usize, of: &dyn Fn(usize) -> String| (0..count).map(of).collect();
        let attributes: String = many(MOST_ATTRIBUTES, &|k| format!(" a{k} = '>'"));
        parse(&format!("<s{attributes}>b='c'</s>"), Entities::Refused).unwrap();
        let message = refusal(&format!("<!-- ' --><s{attributes} b=\"\"/>"));
        assert_eq!(message, "an element has more than 1000 attributes");
        let nested: String = many(MOST_PREFIXES + 1, &|k| format!("<g xmlns:n{k}='u'>"));
        let message = refusal(&nested);
        assert_eq!(message, "it has more than 100 prefixes of namespaces");
        let defined: String = many(MOST_ENTITIES + 1, &|k| format!("<!ENTITY e{k} ''>"));
        let message = refusal(&format!("<!DOCTYPE s [{defined}]><s/>"));
        assert_eq!(message, "it defines more than 1000 entities");
    }
}
