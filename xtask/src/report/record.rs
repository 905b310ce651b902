//! The parts of a report that are kept one by one, and what is made of all of them.

use super::{Finding, Page, Part, Section, demand, excerpt, findings};
use crate::store::{Kept, Store};
use anyhow::Result;
use maud::{Markup, html};
use serde::{Deserialize, Serialize};

/// What is kept of a part.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Record {
    pub(crate) name: String,
    /// Its section of the page.
    pub(crate) section: Section,
    /// Tables for the book.
    pub(crate) excerpt: Vec<Part>,
    pub(crate) findings: Vec<Finding>,
}

impl Record {
    /// A part with nothing but its section of the page.
    pub(crate) fn new(name: &str, inside: Markup) -> Self {
        Self {
            name: name.to_owned(),
            section: html! { section id=(name) { (inside) } }.into(),
            ..Self::default()
        }
    }
}

/// Every finding with the name of its part.
pub(crate) fn all_findings(records: &[Record]) -> impl Iterator<Item = (&str, &Finding)> + Clone {
    records
        .iter()
        .flat_map(|r| r.findings.iter().map(move |f| (r.name.as_str(), f)))
}

/// What all parts make of a report.
pub(crate) struct Report {
    /// Its name on the command line.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// What stands before the findings.
    pub(crate) introduction: Markup,
    /// What the table of the findings shows.
    pub(crate) caption: &'static str,
    /// What the book has besides the tables of the parts.
    pub(crate) excerpt: Vec<Part>,
}

impl Report {
    /// Writes the page, the findings and what the book shows.
    ///
    /// # Errors
    /// Files that cannot be written; findings by which the report fails.
    pub(crate) fn write(self, store: &Store, kept: Kept<Record>) -> Result<()> {
        let Kept { records, left_out } = kept;
        let found = all_findings(&records);
        let table = findings(self.caption, found.clone());
        table.write_to(&store.path("findings.csv"))?;
        let mut parts = self.excerpt;
        parts.extend(records.iter().flat_map(|r| r.excerpt.clone()));
        excerpt::write(store, self.name, parts)?;
        let body = html! {
            (self.introduction)
            section #findings { h2 { "Findings" } (table) }
            @for record in &records { (record.section) }
        };
        let page = Page::new(self.title, body);
        Page { left_out, ..page }.write(store, "index.html")?;
        demand(found)
    }
}
