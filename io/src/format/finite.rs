//! The first number of a value that is not finite.
//!
//! JSON has no NaN, and `serde_json` silently writes `null` for it; this finds it first and says where.

use ciborium::Value;
use serde::Serialize;

/// Where a value is not finite, or why it has no form in which that could be seen.
#[derive(Debug)]
pub(crate) enum Finding {
    NotFinite { path: String, value: f64 },
    Other(String),
}

/// Checks every number in `value`; a finding carries its path, as in `steps[3].energy`.
pub(crate) fn check_finite<T: Serialize + ?Sized>(value: &T) -> Result<(), Finding> {
    // Of all forms that a value may take, CBOR has what JSON has, and NaN too.
    let value = Value::serialized(value).map_err(|e| Finding::Other(e.to_string()))?;
    match not_finite(&value) {
        None => Ok(()),
        Some((path, value)) => Err(Finding::NotFinite {
            path: path.trim_start_matches('.').to_owned(),
            value,
        }),
    }
}

/// The first number that is not finite, and the path that leads to it.
fn not_finite(value: &Value) -> Option<(String, f64)> {
    let below = |step: String, value| {
        let (path, number) = not_finite(value)?;
        Some((step + &path, number))
    };
    match value {
        Value::Float(number) => (!number.is_finite()).then(|| (String::new(), *number)),
        Value::Array(items) => {
            let mut items = items.iter().enumerate();
            items.find_map(|(k, item)| below(format!("[{k}]"), item))
        }
        Value::Map(entries) => entries.iter().find_map(|(key, entry)| {
            let key = match key {
                Value::Text(key) => key.clone(),
                Value::Integer(key) => i128::from(*key).to_string(),
                _ => "?".to_owned(),
            };
            below(format!(".{key}"), entry)
        }),
        _ => None,
    }
}
