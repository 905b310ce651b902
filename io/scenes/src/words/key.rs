//! Places in a scene.

use isosheet_files::DataError;
use isosheet_mesh::Advice;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// A place in a scene: the names of keys and the numbers of list entries that lead to it. Written as
/// `obstacle[1].shape.sphere.radius`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Key(Vec<KeyPart>);

/// One step of a [`Key`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KeyPart {
    /// The name of a key.
    Name(String),
    /// The number of a list entry, from 0.
    Entry(usize),
}

/// A text that is not the key of a place in a scene.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{text}` is not a key")]
pub struct KeyError {
    /// The text.
    pub text: String,
}

impl Advice for KeyError {
    fn advice(&self) -> Option<&'static str> {
        Some(
            "write names with dots between them, and numbers of list entries in brackets, for example \
             `obstacle[0].shape.sphere.radius`",
        )
    }
}

impl From<KeyError> for DataError {
    fn from(error: KeyError) -> Self {
        Self::plain(error.to_string()).remedy(error.advice())
    }
}

impl Key {
    /// The scene as a whole.
    pub fn root() -> Self {
        Self::default()
    }

    /// The key of the given name below this one. Dots separate several names.
    #[must_use]
    pub fn name(&self, names: &str) -> Self {
        let mut parts = self.0.clone();
        parts.extend(names.split('.').map(|n| KeyPart::Name(n.to_owned())));
        Self(parts)
    }

    /// The entry with the given number, from 0, of the list at this key.
    #[must_use]
    pub fn entry(&self, number: usize) -> Self {
        let mut parts = self.0.clone();
        parts.push(KeyPart::Entry(number));
        Self(parts)
    }

    /// The entries of the list at this key, each with its own.
    pub(crate) fn entries<'a, T>(&self, list: &'a [T]) -> impl Iterator<Item = (Self, &'a T)> {
        let entries = list.iter().enumerate();
        entries.map(|(k, entry)| (self.entry(k), entry))
    }

    /// Whether the key is another one, or leads on from it.
    pub fn is_within(&self, other: &Self) -> bool {
        self.0.starts_with(&other.0)
    }

    /// The list that the key has an entry of, the first one; itself if it has none.
    pub(crate) fn list(&self) -> Self {
        let is_name = |part: &&KeyPart| matches!(part, KeyPart::Name(_));
        Self(self.0.iter().take_while(is_name).cloned().collect())
    }

    /// The key without the numbers of entries, if there are any: the same for all entries of lists.
    pub(crate) fn of_entries(&self) -> Option<String> {
        let mut whole = Self::root();
        for part in &self.0 {
            if let KeyPart::Name(name) = part {
                whole = whole.name(name);
            }
        }
        (whole != *self).then(|| whole.to_string())
    }

    /// The place one step further.
    #[must_use]
    pub fn part(&self, part: &KeyPart) -> Self {
        let mut parts = self.0.clone();
        parts.push(part.clone());
        Self(parts)
    }

    /// The value at the place in a scene, if there is one.
    pub fn find<'a>(&self, scene: &'a toml::Value) -> Option<&'a toml::Value> {
        self.0.iter().try_fold(scene, |value, part| match part {
            KeyPart::Name(name) => value.get(name.as_str()),
            KeyPart::Entry(number) => value.get(*number),
        })
    }

    /// The place that this one is in, unless it is the scene as a whole.
    pub(crate) fn above(&self) -> Option<Self> {
        let (_, above) = self.0.split_last()?;
        (!above.is_empty()).then(|| Self(above.to_vec()))
    }

    /// The way from the root.
    pub fn parts(&self) -> &[KeyPart] {
        &self.0
    }
}

impl FromStr for Key {
    type Err = KeyError;

    /// Names as in TOML, with numbers of list entries in brackets: `obstacle[1].friction`. A name that is a
    /// number is the number of an entry, too: `obstacle.1.friction`.
    fn from_str(text: &str) -> Result<Self, KeyError> {
        parts_of(text).map(Self).ok_or_else(|| KeyError {
            text: text.to_owned(),
        })
    }
}

/// The parts of a key; none if it is malformed.
fn parts_of(text: &str) -> Option<Vec<KeyPart>> {
    let mut pieces = text.split('[');
    let mut parts = names(pieces.next()?)?;
    for piece in pieces {
        let (number, rest) = piece.split_once(']')?;
        parts.push(KeyPart::Entry(entry_number(number.trim())?));
        let rest = rest.trim();
        if !rest.is_empty() {
            parts.extend(names(rest.strip_prefix('.')?)?);
        }
    }
    Some(parts)
}

/// The parts between the numbers in brackets.
fn names(text: &str) -> Option<Vec<KeyPart>> {
    let names = toml_edit::Key::parse(text).ok()?;
    let part = |name: toml_edit::Key| match entry_number(name.get()) {
        Some(number) => KeyPart::Entry(number),
        None => KeyPart::Name(name.get().to_owned()),
    };
    Some(names.into_iter().map(part).collect())
}

fn entry_number(text: &str) -> Option<usize> {
    let digits = text.bytes().all(|b| b.is_ascii_digit());
    digits.then(|| text.parse().ok()).flatten()
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, part) in self.0.iter().enumerate() {
            match part {
                KeyPart::Name(name) if k == 0 => f.write_str(name)?,
                KeyPart::Name(name) => write!(f, ".{name}")?,
                KeyPart::Entry(number) => write!(f, "[{number}]")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_read_as_they_are_shown() {
        for text in ["stop", "stop.time", "a[3]", "a[0][12].b-c.d_e[1]"] {
            assert_eq!(text.parse::<Key>().unwrap().to_string(), text);
        }
        let key = Key::root().name("obstacle").entry(2).name("pose.turn");
        for same in [
            "obstacle[2].pose.turn",
            "obstacle.2.pose.turn",
            " obstacle [ 2 ] . pose . turn ",
            "\"obstacle\"[2].'pose'.turn",
        ] {
            assert_eq!(same.parse::<Key>().as_ref(), Ok(&key), "{same}");
        }
    }

    #[test]
    fn malformed_keys_are_refused() {
        for wrong in [
            "",
            " ",
            ".",
            "a.",
            ".a",
            "a..b",
            "a[0",
            "a[0.b",
            "a]",
            "a[0]]",
            "a[0]].b",
            "a[[0]]",
            "a[]",
            "a[x]",
            "a[-1]",
            "a[+1]",
            "a[0]b",
            "a[0] b",
            "a[0].",
            "[0]",
            "[0].a",
            "a b",
            "a[0].[1]",
            "\"a",
            "a[99999999999999999999]",
        ] {
            let error = wrong.parse::<Key>().expect_err(wrong);
            assert_eq!(error.to_string(), format!("`{wrong}` is not a key"));
        }
    }
}
