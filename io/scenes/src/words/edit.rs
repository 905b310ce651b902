//! Edits of a scene by `key=value`.

use crate::words::key::{Key, KeyPart};
use isosheet_files::DataError;
use isosheet_mesh::Advice;
use std::fmt;
use std::str::FromStr;
use thiserror::Error;
use toml_edit::{DocumentMut, Item, Table, Value};

/// An edit of a scene: a key and its new value. As a text it is `key=value`.
///
/// ```
/// use isosheet_scenes::Edit;
///
/// let edit: Edit = "obstacle[0].friction=0.3".parse()?;
/// assert_eq!(edit.value.as_float(), Some(0.3));
/// # Ok::<(), isosheet_scenes::EditError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// The key.
    pub key: Key,
    /// The new value.
    pub value: toml::Value,
}

impl FromStr for Edit {
    type Err = EditError;

    /// A value that is not TOML is taken as a string, so that names need no quotes.
    fn from_str(edit: &str) -> Result<Self, EditError> {
        let (key, value) = split(edit).map_err(|problem| EditError {
            edit: edit.to_owned(),
            problem,
        })?;
        let value = value.parse().unwrap_or_else(|_| value.into());
        Ok(Self { key, value })
    }
}

impl fmt::Display for Edit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.value)
    }
}

/// An edit that cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("`{edit}`: {problem}")]
pub struct EditError {
    /// The edit.
    pub edit: String,
    /// Why it cannot be made.
    pub problem: DataError,
}

impl Advice for EditError {
    fn advice(&self) -> Option<&'static str> {
        self.problem.advice()
    }
}

/// A key on the way is a value that has no keys, or a list that has no such entry.
fn no_place(place: &Key) -> DataError {
    let remedy = "count the entries of lists from 0, for example `obstacle[0].friction=0.3`";
    DataError::new(format!("the scene has no place `{place}`"), remedy)
}

/// What is driven is no function of time.
pub(crate) fn no_function(place: &Key) -> DataError {
    let message = format!("the scene has no function of time at `{place}`");
    let remedy = "name a function of time, for example `support[0].hold.moving_pin.z` of a support that the scene holds \
                  by a `moving_pin`, or `crease[0].angle`";
    DataError::new(message, remedy)
}

/// What is driven to a pose is no rigid motion.
pub(crate) fn no_motion(place: &Key) -> DataError {
    let message = format!("the scene has no rigid motion at `{place}`");
    let remedy = "name one of an obstacle, for example `obstacle[0].motion`, or of a support that moves in the scene, \
                  `support[0].hold.moving_clamp`";
    DataError::new(message, remedy)
}

/// The document with all edits made, in their order. A value that is not TOML is taken as a string, so that
/// names need no quotes.
pub(crate) fn apply(document: &mut DocumentMut, edits: &[String]) -> Result<(), EditError> {
    for edit in edits {
        make(document, edit).map_err(|problem| EditError {
            edit: edit.clone(),
            problem,
        })?;
    }
    Ok(())
}

fn make(document: &mut DocumentMut, edit: &str) -> Result<(), DataError> {
    let (key, value) = split(edit)?;
    let value: Value = value.parse().unwrap_or_else(|_| Value::from(value));
    set(document.as_item_mut(), &key, value)
}

/// Key and value of an edit.
fn split(edit: &str) -> Result<(Key, &str), DataError> {
    let (key, value) = edit.split_once('=').ok_or_else(|| {
        let remedy = "write for example `stop.time=0.5`";
        DataError::new("it is not of the form key=value", remedy)
    })?;
    Ok((key.trim().parse()?, value.trim()))
}

/// Sets the value at a key; tables on the way are made where they are missing.
pub(crate) fn set(mut item: &mut Item, key: &Key, value: Value) -> Result<(), DataError> {
    let mut place = Key::root();
    for part in key.parts() {
        let list = place.clone();
        place = place.part(part);
        let is_last = place == *key;
        item = match (item, part) {
            // An entry of a list of tables stays a table: the text has no place for another item there.
            (Item::ArrayOfTables(tables), KeyPart::Entry(k)) if is_last => {
                let table = tables.get_mut(*k).ok_or_else(|| no_place(&place))?;
                let Value::InlineTable(new) = value else {
                    let remedy = "write all keys of the entry in braces, for example `obstacle[0]={ shape = { sphere = { \
                                  radius = 0.1 } } }`, or change one of its keys, `obstacle[0].friction=0.3`";
                    let message = format!("the entries of `{list}` are tables");
                    return Err(DataError::new(message, remedy));
                };
                replace(table, new.into_table());
                return Ok(());
            }
            (item, part) => descend(item, part).ok_or_else(|| no_place(&place))?,
        };
    }
    *item = Item::Value(value);
    Ok(())
}

/// Puts a table where another one is in the text, with the comments before it.
fn replace(table: &mut Table, mut new: Table) {
    *new.decor_mut() = table.decor().clone();
    new.set_position(table.position());
    *table = new;
}

/// The item at a part of a key in another one; keys of tables are made where they are missing. A list with
/// one entry is named as its entry is: `sheet.mass` of one `[[sheet]]`.
fn descend<'a>(item: &'a mut Item, part: &KeyPart) -> Option<&'a mut Item> {
    let item = match part {
        KeyPart::Name(_) if has_one_entry(item) => item.get_mut(0)?,
        _ => item,
    };
    match (item, part) {
        (
            item @ (Item::None | Item::Table(_) | Item::Value(Value::InlineTable(_))),
            KeyPart::Name(name),
        ) => Some(&mut item[name.as_str()]),
        (
            item @ (Item::ArrayOfTables(_) | Item::Value(Value::Array(_))),
            KeyPart::Entry(number),
        ) => item.get_mut(*number),
        _ => None,
    }
}

/// Whether an item is a list with one entry.
pub(crate) fn has_one_entry(item: &Item) -> bool {
    match item {
        Item::ArrayOfTables(tables) => tables.len() == 1,
        Item::Value(Value::Array(values)) => values.len() == 1,
        _ => false,
    }
}

#[cfg(test)]
mod tests;
