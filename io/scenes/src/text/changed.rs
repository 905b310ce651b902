//! Scenes whose values are changed, and their texts.

use crate::Scene;
use crate::words::edit::{Edit, set};
use crate::words::key::{Key, KeyPart};
use serde::Deserialize;
use toml_edit::DocumentMut;

/// The values of a scene, by way of its text: what reads and writes texts of scenes is compiled once, and
/// nothing else.
fn values(scene: &Scene) -> Option<toml::Value> {
    let text = toml::to_string(scene).ok()?;
    text.parse().ok().map(toml::Value::Table)
}

/// A scene with edits made in its values. None where its values have no such place, or the result is no
/// scene: what is wrong with it, or right because of what its text leaves out, the text says.
pub(crate) fn edited(scene: &Scene, edits: &[Edit]) -> Option<Scene> {
    let mut whole = values(scene)?;
    for Edit { key, value } in edits {
        let (last, way) = key.parts().split_last()?;
        let mut place = &mut whole;
        for part in way {
            place = match part {
                KeyPart::Name(name) => place.get_mut(name.as_str()),
                KeyPart::Entry(number) => place.get_mut(*number),
            }?;
        }
        match last {
            KeyPart::Name(name) => drop(place.as_table_mut()?.insert(name.clone(), value.clone())),
            KeyPart::Entry(number) => *place.get_mut(*number)? = value.clone(),
        }
    }
    let text = toml::to_string(&whole).ok()?;
    Scene::deserialize(toml::Deserializer::parse(&text).ok()?).ok()
}

/// The text of a scene with other values at some keys: each is written at its key, or with what it is in
/// where the text has no place for it alone.
pub(crate) fn written(text: &str, scene: &Scene, keys: &[Key]) -> Option<String> {
    let mut document = text.parse::<DocumentMut>().ok()?;
    let whole = values(scene)?;
    for key in keys {
        let mut way = key.clone();
        loop {
            let value = way.find(&whole)?.to_string().parse().ok()?;
            if set(document.as_item_mut(), &way, value).is_ok() {
                break;
            }
            way = way.above()?;
        }
    }
    Some(document.to_string())
}
