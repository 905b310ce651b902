//! The selections of vertices of a scene.

use crate::Scene;
use crate::bodies::body;
use crate::meshes::selection::Selection;
use crate::words::key::{Key, KeyPart};
use crate::words::part::all;
use std::collections::BTreeMap;

/// A selection of vertices of a scene.
pub(crate) struct Selected<'a> {
    pub(crate) key: Key,
    /// The name of the sheet that it is of, if the scene gives one.
    pub(crate) sheet: Option<&'a String>,
    pub(crate) at: &'a Selection,
}

impl Scene {
    /// All selections of vertices of sheets at their start.
    pub(crate) fn selections(&self) -> Vec<Selected<'_>> {
        let texts = all::<String>(self, Key::root()).into_iter();
        let texts: BTreeMap<String, &String> =
            texts.map(|(at, text)| (at.key.to_string(), text)).collect();
        let selected = all(self, Key::root())
            .into_iter()
            .map(|(at, selection)| Selected {
                sheet: name_of_sheet(&at.key, &texts),
                key: at.key,
                at: selection,
            });
        let is_of_body = |name: &&String| body::number_of(&self.body, name).is_some();
        selected
            .filter(|of| of.sheet.filter(is_of_body).is_none())
            .collect()
    }
}

/// The name of the sheet that a part of a scene is in, or that stands nearest to the part as `sheet`.
fn name_of_sheet<'a>(key: &Key, texts: &BTreeMap<String, &'a String>) -> Option<&'a String> {
    let name = match key.parts() {
        [KeyPart::Name(first), ..] if first == "sheet" => "name",
        _ => "sheet",
    };
    let mut above = std::iter::successors(key.above(), Key::above);
    above.find_map(|above| texts.get(&above.name(name).to_string()).copied())
}
