//! What is wrong with a scene, and where.

use isosheet_mesh::Advice;
use std::fmt;
use std::ops::Range;

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

    /// The way from the root.
    pub fn parts(&self) -> &[KeyPart] {
        &self.0
    }
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

/// Something that is wrong with a scene. Shown as key and message, without the remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Where, as far as known.
    pub key: Key,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub remedy: Option<String>,
    /// The bytes of the text that are to blame, where the key alone does not say it.
    pub span: Option<Range<usize>>,
}

impl Problem {
    /// A problem at a key.
    pub fn new(key: Key, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            key,
            message: message.into(),
            remedy: Some(remedy.into()),
            span: None,
        }
    }

    /// A problem that another error describes; its advice is the remedy.
    pub(crate) fn from_error(key: Key, error: &impl Advice) -> Self {
        Self {
            key,
            message: error.to_string(),
            remedy: error.advice().map(str::to_owned),
            span: None,
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.key.parts().is_empty() {
            write!(f, "{}: ", self.key)?;
        }
        f.write_str(&self.message)
    }
}

/// A number with its unit, if it has one.
fn quantity(value: f64, unit: &str) -> String {
    match unit {
        "" => value.to_string(),
        unit => format!("{value} {unit}"),
    }
}

/// A remedy that names the unit, if there is one.
fn in_unit(remedy: &str, unit: &str) -> String {
    match unit {
        "" => remedy.to_owned(),
        unit => format!("{remedy}, in {unit}"),
    }
}

/// Collects all range errors of a scene.
#[derive(Debug, Default)]
pub(crate) struct Checks {
    pub(crate) problems: Vec<Problem>,
}

impl Checks {
    pub(crate) fn report(
        &mut self,
        key: Key,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        self.problems.push(Problem::new(key, message, remedy));
    }

    /// A finite number above zero.
    pub(crate) fn positive(&mut self, key: Key, value: f64, unit: &str) {
        if !(value.is_finite() && value > 0.0) {
            let message = format!(
                "`{key}` is {}, which is not a positive number",
                quantity(value, unit)
            );
            self.report(key, message, in_unit("give a number above 0", unit));
        }
    }

    /// A finite number of at least zero.
    pub(crate) fn not_negative(&mut self, key: Key, value: f64, unit: &str) {
        if !(value.is_finite() && value >= 0.0) {
            let value = quantity(value, unit);
            let message = format!("`{key}` is {value}, which is less than 0 or not finite");
            self.report(key, message, in_unit("give 0 or a positive number", unit));
        }
    }

    /// A number from `least` to `most`.
    pub(crate) fn within(&mut self, key: Key, value: f64, [least, most]: [f64; 2]) {
        if !(least..=most).contains(&value) {
            let message = format!("`{key}` is {value}, which is out of range");
            self.report(
                key,
                message,
                format!("give a number from {least} to {most}"),
            );
        }
    }

    /// A count of at least `least`, and not above the largest whole number of TOML.
    pub(crate) fn count(&mut self, key: Key, value: usize, least: usize) {
        let remedy = if value < least {
            format!("give at least {least}")
        } else if i64::try_from(value).is_err() {
            format!("give at most {}", i64::MAX)
        } else {
            return;
        };
        self.report(key.clone(), format!("`{key}` is {value}"), remedy);
    }

    /// A finite number.
    pub(crate) fn number(&mut self, key: Key, value: f64) {
        if !value.is_finite() {
            let message = format!("`{key}` is {value}");
            self.report(key, message, "give a finite number");
        }
    }

    /// Finite components.
    pub(crate) fn finite(&mut self, key: Key, vector: &[f64]) {
        if let Some((k, value)) = vector.iter().enumerate().find(|(_, c)| !c.is_finite()) {
            let message = format!("`{key}` has the component {value}");
            self.report(key.entry(k), message, "give finite numbers");
        }
    }

    /// Finite components that are not all zero.
    pub(crate) fn direction(&mut self, key: Key, vector: &[f64; 3]) {
        let length2: f64 = vector.iter().map(|c| c * c).sum();
        if !vector.iter().all(|c| c.is_finite()) {
            self.finite(key, vector);
        } else if !length2.is_normal() {
            let message =
                format!("`{key}` has no direction: its length is zero, or its square out of range");
            self.report(key, message, "give a vector of about unit length");
        }
    }
}
