//! The first number of a value that is not finite.
//!
//! JSON has no NaN, and `serde_json` silently writes `null` for it; this finds it first and says where.

use crate::DataError;
use ciborium::Value;
use isosheet_mesh::wording::given;
use serde::Serialize;

/// Checks every number in `value`; what is not finite is named by its path, as in `steps[3].energy`.
pub fn check_finite<T: Serialize + ?Sized>(value: &T) -> Result<(), DataError> {
    // Of all forms that a value may take, CBOR has what JSON has, and NaN too.
    let value = Value::serialized(value)
        .map_err(|e| DataError::plain(format!("the value has no form in JSON: {e}")))?;
    match not_finite(&value) {
        None => Ok(()),
        Some((path, value)) => {
            let path = path.trim_start_matches('.');
            let message = format!("{path} is {}, which JSON cannot hold", given(value));
            let remedy = "leave it out (`None`) or find where it comes from";
            Err(DataError::new(message, remedy).value(value))
        }
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
