//! On which page of the reference a part of scenes is described.

use serde_json::Value;
use std::collections::BTreeMap;

/// The page of what several tables have.
pub(super) const SHARED: &str = "values";

/// The page of the index, which lies outside of the folder of the others.
pub(super) const INDEX: &str = "";

/// A part of scenes on its page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Place {
    /// The table whose page it is, or [`SHARED`].
    pub(super) page: String,
    /// Whether the page is all about it.
    pub(super) is_title: bool,
}

/// The places of all parts.
#[derive(Debug)]
pub(super) struct Places {
    all: BTreeMap<String, Place>,
    /// The parts in their order on the pages.
    order: Vec<String>,
    /// The tables in the order of a scene file.
    tables: Vec<String>,
}

impl Places {
    /// A part that one table uses is on the page of that table, and what several use on a page of its own.
    pub(super) fn of(schema: &Value) -> Self {
        let parts = &schema["$defs"];
        let mut places = Self {
            all: BTreeMap::new(),
            order: Vec::new(),
            tables: Vec::new(),
        };
        for (table, property) in schema["properties"].as_object().into_iter().flatten() {
            let mut used = Vec::new();
            for title in references(property) {
                reach(parts, &title, &mut used);
            }
            let Some(title) = used.first() else {
                continue;
            };
            places.tables.push(table.clone());
            for part in &used {
                let place = Place {
                    page: table.clone(),
                    is_title: part == title,
                };
                match places.all.get_mut(part) {
                    Some(other) => {
                        other.page = SHARED.to_owned();
                        other.is_title = false;
                    }
                    None => {
                        places.all.insert(part.clone(), place);
                        places.order.push(part.clone());
                    }
                }
            }
        }
        places
    }

    /// The keys of a scene that are tables or lists of them.
    pub(super) fn tables(&self) -> &[String] {
        &self.tables
    }

    /// The parts on a page, in their order.
    pub(super) fn on<'a>(&'a self, page: &'a str) -> impl Iterator<Item = &'a str> {
        let parts = self.order.iter().map(String::as_str);
        parts.filter(move |part| self.all[*part].page == page)
    }

    pub(super) fn place(&self, part: &str) -> &Place {
        &self.all[part]
    }

    /// Where a link on a page, or on the [`INDEX`], leads to a part.
    pub(super) fn target(&self, part: &str, from: &str) -> String {
        let Place { page, is_title } = self.place(part);
        let folder = if from == INDEX { "scene/" } else { "" };
        let anchor = part.to_lowercase();
        match (page == from, *is_title) {
            (true, _) => format!("#{anchor}"),
            (false, true) => format!("{folder}{page}.md"),
            (false, false) => format!("{folder}{page}.md#{anchor}"),
        }
    }
}

/// Collects a part and the parts that its keys refer to, each once.
fn reach(parts: &Value, name: &str, found: &mut Vec<String>) {
    if found.iter().any(|other| other == name) {
        return;
    }
    found.push(name.to_owned());
    for inner in references(&parts[name]) {
        reach(parts, &inner, found);
    }
}

/// The parts that a part refers to, in the order of its keys.
fn references(part: &Value) -> Vec<String> {
    match part {
        Value::Object(entries) => {
            let own = entries.get("$ref").and_then(Value::as_str);
            let own = own.and_then(|r| r.rsplit('/').next()).map(str::to_owned);
            let inner = entries.iter().filter(|(name, _)| *name != "$defs");
            own.into_iter()
                .chain(inner.flat_map(|(_, value)| references(value)))
                .collect()
        }
        Value::Array(entries) => entries.iter().flat_map(references).collect(),
        _ => Vec::new(),
    }
}
