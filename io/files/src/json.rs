//! JSON files such as a run's summary.

use crate::check_finite;
use crate::{DataError, FileError, input, write_atomically};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::Write;
use std::path::Path;

/// Writes `value` as indented JSON, atomically. Numbers keep all their digits.
///
/// # Errors
/// [`FileError`]; a number that is not finite is refused by name, and nothing is written then.
pub fn write_json<T: Serialize + ?Sized>(path: &Path, value: &T) -> Result<(), FileError> {
    check_finite(value)?;
    let mut text = serde_json::to_vec_pretty(value)
        .map_err(|e| DataError::plain(format!("cannot write {} as JSON: {e}", path.display())))?;
    text.push(b'\n');
    write_atomically(path, |w| w.write_all(&text))
}

/// Reads a JSON file.
///
/// # Errors
/// [`FileError::Read`] for a file that cannot be read, or is not what was expected.
pub fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, FileError> {
    let text = input::read(path).map_err(|e| FileError::unreadable(path, e))?;
    serde_json::from_slice(&text)
        .map_err(|e| FileError::content(path, e, "correct the file or write it anew"))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde::Deserialize;

    use super::*;

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    enum Scheme {
        Plain,
        Damped { rate: f64 },
        Pair(f64, f64),
        Wrapped(f64),
    }

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Summary {
        name: String,
        steps: Vec<Step>,
        pair: (f64, i32),
        note: Option<f64>,
        sizes: BTreeMap<String, f64>,
        scheme: Scheme,
    }

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Step {
        energy: f64,
        ok: bool,
    }

    fn summary() -> Summary {
        Summary {
            name: "falling \"sheet\"".into(),
            steps: vec![
                Step {
                    energy: 0.1 + 0.2,
                    ok: true,
                },
                Step {
                    energy: -1e-300,
                    ok: false,
                },
            ],
            pair: (f64::MAX, -3),
            note: None,
            sizes: BTreeMap::from([("M1".into(), 1.0 / 3.0)]),
            scheme: Scheme::Plain,
        }
    }

    #[test]
    fn values_come_back_bit_for_bit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("runs/a/summary.json");
        for scheme in [
            Scheme::Plain,
            Scheme::Damped { rate: 2.5 },
            Scheme::Pair(1.0, 2.0),
            Scheme::Wrapped(0.5),
        ] {
            let s = Summary {
                scheme,
                ..summary()
            };
            write_json(&path, &s).unwrap();
            assert_eq!(read_json::<Summary>(&path).unwrap(), s);
        }
        assert!(std::fs::read_to_string(&path).unwrap().ends_with("}\n"));
    }

    #[test]
    fn nan_is_refused_by_name() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("summary.json");
        let cases: [(&str, Summary); 7] = [
            ("steps[1].energy", {
                let mut s = summary();
                s.steps[1].energy = f64::NAN;
                s
            }),
            (
                "pair[0]",
                Summary {
                    pair: (f64::INFINITY, 0),
                    ..summary()
                },
            ),
            (
                "note",
                Summary {
                    note: Some(f64::NEG_INFINITY),
                    ..summary()
                },
            ),
            (
                "sizes.M1",
                Summary {
                    sizes: BTreeMap::from([("M1".into(), f64::NAN)]),
                    ..summary()
                },
            ),
            (
                "scheme.Damped.rate",
                Summary {
                    scheme: Scheme::Damped { rate: f64::NAN },
                    ..summary()
                },
            ),
            (
                "scheme.Pair[1]",
                Summary {
                    scheme: Scheme::Pair(0.0, f64::NAN),
                    ..summary()
                },
            ),
            (
                "scheme.Wrapped",
                Summary {
                    scheme: Scheme::Wrapped(f64::NAN),
                    ..summary()
                },
            ),
        ];
        for (name, s) in cases {
            match write_json(&path, &s) {
                Err(FileError::Data(error)) => {
                    assert!(error.message.starts_with(&format!("{name} is ")), "{error}");
                }
                other => panic!("{name}: {other:?}"),
            }
        }
        assert!(!path.exists());
        assert!(matches!(
            write_json(&path, &f32::NAN),
            Err(FileError::Data(_))
        ));
    }

    #[test]
    fn unreadable_files_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("summary.json");
        let missing = read_json::<Summary>(&path).unwrap_err().to_string();
        assert!(missing.starts_with("cannot read "), "{missing}");
        std::fs::write(&path, "{\"name\": 3").unwrap();
        let error = read_json::<Summary>(&path).unwrap_err();
        assert!(
            error.to_string().contains("summary.json") && error.to_string().contains("line 1"),
            "{error}"
        );
        let keyed = BTreeMap::from([((1, 2), 3)]);
        assert!(matches!(write_json(&path, &keyed), Err(FileError::Data(_))));
    }
}
