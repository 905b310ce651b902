//! What a scene is made of, in words.

use crate::placing::placed::PlacedSheet;
use isosheet_dynamics::ElasticSheet;
use isosheet_mesh::wording::brief;

/// What the sheets are made of, if the scene names it.
pub(crate) fn materials_in_words(sheets: &[PlacedSheet<'_>]) -> Option<String> {
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

/// What an elastic sheet is.
pub(crate) fn elastic_in_words(elastic: &ElasticSheet) -> String {
    format!(
        "elasticity in the plane ({} N/m; strain below {} %)",
        brief(elastic.stiffness()),
        brief(100.0 * elastic.limit())
    )
}
