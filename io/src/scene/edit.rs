//! Edits of a scene by `key=value`.

use isosheet_mesh::Advice;
use thiserror::Error;
use toml_edit::{DocumentMut, Item, Value};

/// An edit that cannot be made.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum EditError {
    /// There is no equals sign, or no key before it.
    #[error("`{edit}` is not of the form key=value")]
    Form {
        /// The edit.
        edit: String,
    },
    /// A key on the way is a value that has no keys, or a list that has no such entry.
    #[error("`{edit}`: the scene has no place `{place}`")]
    Place {
        /// The edit.
        edit: String,
        /// The key up to where it fails.
        place: String,
    },
}

impl Advice for EditError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Form { .. } => Some("write for example `stop.time=0.5`"),
            Self::Place { .. } => {
                Some("count the entries of lists from 0, for example `obstacle[0].friction=0.3`")
            }
        }
    }
}

/// The document with all edits made, in their order. A value that is not TOML is taken as a string, so that
/// names need no quotes.
pub(crate) fn apply(document: &mut DocumentMut, edits: &[String]) -> Result<(), EditError> {
    for edit in edits {
        let form = || EditError::Form { edit: edit.clone() };
        let (key, value) = edit.split_once('=').ok_or_else(form)?;
        // `list[1]` is read as `list.1`.
        let key = key.trim().replace('[', ".").replace(']', "");
        let names: Vec<&str> = key.split('.').collect();
        if names.iter().any(|n| n.is_empty()) {
            return Err(form());
        }
        let value = value.trim();
        let value: Value = value.parse().unwrap_or_else(|_| Value::from(value));
        let mut item: &mut Item = document.as_item_mut();
        for (k, name) in names.iter().enumerate() {
            item = descend(item, name).ok_or_else(|| EditError::Place {
                edit: edit.clone(),
                place: names[..=k].join("."),
            })?;
        }
        *item = Item::Value(value);
    }
    Ok(())
}

/// The item of a name or number in another one; keys of tables are made where they are missing.
fn descend<'a>(item: &'a mut Item, name: &str) -> Option<&'a mut Item> {
    match item {
        Item::None => Some(&mut item[name]),
        Item::Table(_) | Item::Value(Value::InlineTable(_)) => Some(&mut item[name]),
        Item::ArrayOfTables(_) | Item::Value(Value::Array(_)) => {
            item.get_mut(name.parse::<usize>().ok()?)
        }
        Item::Value(_) => None,
    }
}
