//! What a scene is made of, in words.

use super::placed::PlacedSheet;
use isosheet_dynamics::ElasticSheet;
use isosheet_mesh::wording::brief;

/// What the sheets are made of, if the scene names it.
pub(super) fn materials_in_words(sheets: &[PlacedSheet<'_>]) -> Option<String> {
    let words = |sheet: &PlacedSheet<'_>| {
        let words = sheet.of.material.as_ref()?.in_words()?;
        match (&sheet.of.name, sheets.len()) {
            (Some(name), 2..) => Some(format!("{name} of {words}")),
            _ => Some(words),
        }
    };
    let all: Vec<String> = sheets.iter().filter_map(words).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// What an elastic sheet is on its mesh.
pub(super) fn elastic_in_words(elastic: &ElasticSheet) -> String {
    let used = elastic.face_stiffnesses();
    let [least, most] = used.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], k| {
        [least.min(k), most.max(k)]
    });
    let softened = if least == elastic.stiffness() {
        String::new()
    } else if brief(least).to_string() == brief(most).to_string() {
        format!(", softened on this mesh to {} N/m", brief(least))
    } else {
        let [least, most] = [brief(least), brief(most)];
        format!(", softened on this mesh to between {least} and {most} N/m")
    };
    format!(
        "elasticity in the plane ({} N/m{softened}; strain below {} %)",
        brief(elastic.stiffness()),
        brief(100.0 * elastic.limit())
    )
}
