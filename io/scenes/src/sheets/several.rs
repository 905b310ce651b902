//! One sheet, or several.

use crate::sheets::patched;
use crate::sheets::sheet::SheetKey;
use crate::sheets::size;
use crate::words::key::Key;
use crate::words::part::{Place, See, SeeMut};
use crate::words::problem::{Checks, Problem};
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// How `sheet` is written: `[sheet]` for one, `[[sheet]]` for several.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
#[expect(dead_code, reason = "the form of the schema, which has no values")]
pub(crate) enum OneOrSeveral {
    /// The sheet.
    One(Box<SheetKey>),
    /// The sheets.
    Several(Vec<SheetKey>),
}

pub(crate) fn serialize<S: Serializer>(sheets: &[SheetKey], to: S) -> Result<S::Ok, S::Error> {
    match sheets {
        [sheet] => sheet.serialize(to),
        sheets => sheets.serialize(to),
    }
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<SheetKey>, D::Error> {
    struct Either;
    impl<'de> Visitor<'de> for Either {
        type Value = Vec<SheetKey>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a table, or a list of tables")
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Vec<SheetKey>, A::Error> {
            SheetKey::deserialize(MapAccessDeserializer::new(map)).map(|sheet| vec![sheet])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Vec<SheetKey>, A::Error> {
            Vec::deserialize(SeqAccessDeserializer::new(list))
        }
    }
    from.deserialize_any(Either)
}

/// Shows the sheets.
pub(crate) fn shared<'a>(sheets: &'a [SheetKey], at: impl FnOnce() -> Place, see: See<'_, 'a>) {
    let (at, count) = (at(), sheets.len());
    for (k, sheet) in sheets.iter().enumerate() {
        see(place(&at, count, k), sheet);
    }
}

/// Shows the sheets so that they can be changed.
pub(crate) fn mutable<'a>(
    sheets: &'a mut [SheetKey],
    at: impl FnOnce() -> Place,
    see: SeeMut<'_, 'a>,
) {
    let (at, count) = (at(), sheets.len());
    for (k, sheet) in sheets.iter_mut().enumerate() {
        see(place(&at, count, k), sheet);
    }
}

/// The place of one of so many sheets, by that of all.
fn place(all: &Place, count: usize, number: usize) -> Place {
    match count {
        1 => all.clone(),
        _ => all.entry(number),
    }
}

/// The key of one of so many sheets.
pub(crate) fn sheet_key(count: usize, number: usize) -> Key {
    place(&Place::of(Key::root().name("sheet")), count, number).key
}

/// Checks the sheets.
pub(crate) fn check(sheets: &[SheetKey], checks: &mut Checks) {
    let root = Key::root().name("sheet");
    if sheets.is_empty() {
        checks.report(root, "the scene has no sheet", "write a table `[sheet]`");
        return;
    }
    let before = checks.problems.len();
    for (k, sheet) in sheets.iter().enumerate() {
        let key = sheet_key(sheets.len(), k);
        sheet.check(&key, checks);
        patched::check(sheet, &key, checks);
        if sheets.len() > 1 {
            check_name(sheets, k, &key, checks);
        }
    }
    if checks.problems.len() == before
        && let Err(problem) = size::check_sheets(sheets, |k| sheet_key(sheets.len(), k))
    {
        checks.problems.push(problem);
    }
}

fn check_name(sheets: &[SheetKey], k: usize, key: &Key, checks: &mut Checks) {
    let remedy = "give each of several sheets a name of its own, `name = \"cover\"`";
    match &sheets[k].name {
        None => checks.report(key.clone(), "the sheet has no name", remedy),
        Some(name) if name.is_empty() => {
            checks.report(key.name("name"), "the name is empty", remedy);
        }
        Some(name) if sheets[..k].iter().any(|s| s.name.as_ref() == Some(name)) => {
            let message = format!("another sheet has the name `{name}`, too");
            checks.report(key.name("name"), message, remedy);
        }
        Some(_) => {}
    }
}

/// Reports a name that no sheet has.
pub(crate) fn check_reference(
    sheets: &[SheetKey],
    name: Option<&str>,
    key: &Key,
    checks: &mut Checks,
) {
    if let Err(problem) = number_of(sheets, name, key) {
        checks.problems.push(problem);
    }
}

/// The number of the sheet of the given name; of no name, if there is one sheet only.
pub(crate) fn number_of<'a>(
    sheets: impl IntoIterator<Item = &'a SheetKey>,
    name: Option<&str>,
    key: &Key,
) -> Result<Option<usize>, Problem> {
    let names: Vec<Option<&str>> = sheets.into_iter().map(|s| s.name.as_deref()).collect();
    let Some(name) = name else {
        return Ok((names.len() == 1).then_some(0));
    };
    let found = names.iter().position(|n| *n == Some(name));
    let known = names.iter().flatten().map(|n| (*n).to_owned());
    found
        .map(Some)
        .ok_or_else(|| unknown_name("sheet", known, name, key))
}

/// Nothing of what may be meant has a name; `known` are the names of all of it.
pub(crate) fn unknown_name(
    meant: &str,
    known: impl Iterator<Item = String>,
    name: &str,
    key: &Key,
) -> Problem {
    let known: Vec<String> = known.map(|name| format!("`{name}`")).collect();
    let remedy = match known.is_empty() {
        true => "leave the key out, or give the sheet this `name`".to_owned(),
        false => format!("give one of these: {}", known.join(", ")),
    };
    Problem::new(
        key.clone(),
        format!("no {meant} has the name `{name}`"),
        remedy,
    )
}

/// The number of the sheet that is meant, which has to be said if there are several.
pub(crate) fn one_of<'a>(
    sheets: impl IntoIterator<Item = &'a SheetKey>,
    name: Option<&str>,
    key: &Key,
    what: &str,
) -> Result<usize, Problem> {
    number_of(sheets, name, &key.name("sheet"))?.ok_or_else(|| {
        let message = format!("{what} may be of several sheets");
        Problem::new(
            key.clone(),
            message,
            "add `sheet = \"...\"` with the name of the sheet that is meant",
        )
    })
}
