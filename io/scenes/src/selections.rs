//! The selections of vertices of a scene.

use super::selection::Selection;
use super::sheets::sheet_key;
use super::{Key, Quantity, Scene, bodies};

/// A selection of vertices of a scene.
pub(super) struct Selected<'a> {
    pub(super) key: Key,
    /// The name of the sheet that it is of, if the scene gives one.
    pub(super) sheet: Option<&'a String>,
    pub(super) at: &'a Selection,
}

impl Scene {
    /// All selections of vertices of sheets at their start.
    pub(super) fn selections(&self) -> Vec<Selected<'_>> {
        let mut all = Vec::new();
        let entry = |name: &str, k: usize| Key::root().name(name).entry(k);
        let mut add = |key: Key, sheet, at| all.push(Selected { key, sheet, at });
        for (k, sheet) in self.sheet.iter().enumerate() {
            let key = sheet_key(self.sheet.len(), k).name("patch");
            for (key, patch) in key.entries(&sheet.patch) {
                add(key.name("at"), sheet.name.as_ref(), &patch.at);
            }
        }
        for (k, support) in self.support.iter().enumerate() {
            let key = entry("support", k).name("at");
            add(key, support.sheet.as_ref(), &support.at);
        }
        for (k, load) in self.forces.load.iter().enumerate() {
            let key = entry("forces.load", k).name("at");
            add(key, load.sheet.as_ref(), &load.at);
        }
        for (k, moment) in self.forces.moment.iter().enumerate() {
            let key = entry("forces.moment", k).name("at");
            add(key, moment.sheet.as_ref(), &moment.at);
        }
        for (k, pressure) in self.forces.pressure.iter().enumerate() {
            add(entry("forces.pressure", k).name("at"), None, &pressure.at);
        }
        if let Some(flow) = self.air.as_ref().and_then(|air| air.attached.as_ref()) {
            let key = Key::root().name("air.attached.trailing");
            add(key, flow.sheet.as_ref(), &flow.trailing);
        }
        for (k, weight) in self.weight.iter().enumerate() {
            let key = entry("weight", k).name("at");
            add(key, weight.sheet.as_ref(), &weight.at);
        }
        for (k, measure) in self.measure.iter().enumerate() {
            let (key, sheet) = (entry("measure", k), measure.sheet.as_ref());
            if sheet.is_some_and(|name| bodies::number_of(&self.body, name).is_some()) {
                continue;
            }
            if let Some(at) = &measure.at {
                add(key.name("at"), sheet, at);
            }
            if let Quantity::DistanceTo(others) = &measure.quantity {
                add(key.name("quantity.distance_to"), sheet, others);
            }
        }
        all
    }
}
