//! A key of a scene and the values that a sweep gives it.

use isosheet_files::DataError;
use isosheet_scenes::Key;
use std::fmt;
use std::str::FromStr;

/// A key of a scene and the values that it takes, written as `key=a,b,c`.
///
/// Values are values of TOML. As in edits of a scene, a value that is not TOML is taken as a string, so that
/// names need no quotes. Commas inside of quotes, brackets and braces belong to a value.
///
/// ```
/// use isosheet_runs::Variation;
/// let v: Variation = "forces.gravity=[0, 0, -9.81],[0, 0, -1.62]".parse()?;
/// assert_eq!(v.key(), "forces.gravity");
/// assert_eq!(v.values(), ["[0, 0, -9.81]", "[0, 0, -1.62]"]);
/// # Ok::<(), isosheet_files::DataError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variation {
    key: String,
    place: Key,
    values: Vec<String>,
}

impl Variation {
    /// The key, as it was written.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// The values as TOML, at least one.
    pub fn values(&self) -> &[String] {
        &self.values
    }

    /// The place of the key in a scene.
    pub(crate) fn place(&self) -> &Key {
        &self.place
    }
}

impl FromStr for Variation {
    type Err = DataError;

    fn from_str(text: &str) -> Result<Self, DataError> {
        let form = || {
            let message = format!("`{text}` is not of the form key=a,b,c");
            DataError::new(message, "write for example `stop.time=0.5,1,2`")
        };
        let (key, values) = text.split_once('=').ok_or_else(form)?;
        let key = key.trim().to_owned();
        let place = key.parse()?;
        if text.chars().any(char::is_control) {
            let message = format!("`{key}` has a control character");
            let remedy = "write values on one line, and \\n in quotes for a line break";
            return Err(DataError::new(message, remedy));
        }
        let pieces = split(values).ok_or_else(|| {
            let message = format!("the values of `{key}` end inside of a quote, bracket or brace");
            DataError::new(message, "close it")
        })?;
        let mut values: Vec<String> = Vec::new();
        for (k, piece) in pieces.into_iter().enumerate() {
            let value = piece.trim().to_owned();
            if value.is_empty() {
                let message = format!("value {} of `{key}` is empty", k + 1);
                let remedy = "take out the comma, or write \"\" for an empty text";
                return Err(DataError::new(message, remedy).at(k + 1));
            }
            if values.contains(&value) {
                let message = format!("`{key}` takes the value {value} twice");
                let remedy = "give it once, since both runs would be the same";
                return Err(DataError::new(message, remedy));
            }
            values.push(value);
        }
        Ok(Self { key, place, values })
    }
}

impl fmt::Display for Variation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.key, self.values.join(","))
    }
}

/// The parts of a text between the commas that are in no quotes, brackets or braces; none if one of these is
/// not closed. A quote opens at the start of a value and inside of brackets; elsewhere it is a letter.
fn split(text: &str) -> Option<Vec<&str>> {
    let (mut parts, mut start, mut depth) = (Vec::new(), 0, 0usize);
    let mut letters = text.char_indices();
    while let Some((at, letter)) = letters.next() {
        match letter {
            '[' | '{' => depth += 1,
            ']' | '}' => depth = depth.checked_sub(1)?,
            '"' | '\'' if depth > 0 || text[start..at].trim().is_empty() => {
                skip_quoted(&mut letters, letter)?;
            }
            ',' if depth == 0 => {
                parts.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    (depth == 0).then_some(parts)
}

/// Goes behind the closing quote; none if there is none. `"` has escapes, `'` has not.
fn skip_quoted(letters: &mut impl Iterator<Item = (usize, char)>, quote: char) -> Option<()> {
    while let Some((_, letter)) = letters.next() {
        if letter == quote {
            return Some(());
        }
        if letter == '\\' && quote == '"' {
            letters.next()?;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use toml_edit::Value;

    fn values(text: &str) -> Vec<String> {
        text.parse::<Variation>().unwrap().values
    }

    #[test]
    fn commas_inside_of_values_do_not_part_them() {
        assert_eq!(values("a.b = 1, 2.5 ,-3e-2"), ["1", "2.5", "-3e-2"]);
        assert_eq!(values("a=bdf2,implicit_euler"), ["bdf2", "implicit_euler"]);
        assert_eq!(
            values("a={ x = [1, 2], y = \"}\" },{ x = [3] }"),
            ["{ x = [1, 2], y = \"}\" }", "{ x = [3] }"]
        );
        assert_eq!(
            values(r#"a="one, \"two\"",'three\',it's"#),
            [r#""one, \"two\"""#, r"'three\'", "it's"]
        );
        assert_eq!(values("a=x=1,y"), ["x=1", "y"]);
    }

    /// For values that are TOML, the parts of a TOML array of this text.
    #[test]
    fn the_parts_are_the_entries_of_an_array() {
        for text in [
            "1,2,3",
            "[1,2],[[3],4]",
            r#"{a="x,y",b='{'},{a="\\",b=','}"#,
            "true,1979-05-27,\"\\\"\"",
        ] {
            let array: Value = format!("[{text}]").parse().unwrap();
            let entries = array.as_array().unwrap().iter();
            let entries: Vec<String> = entries.map(|v| v.to_string().trim().to_owned()).collect();
            assert_eq!(values(&format!("k={text}")), entries);
        }
    }

    #[test]
    fn what_is_no_list_of_values_is_refused() {
        let says = |text: &str, says: &str| {
            let error = text.parse::<Variation>().unwrap_err();
            assert!(error.message.contains(says), "{text}: {error}");
        };
        says("stop.time", "is not of the form");
        for key in [" ", "obstacle[0.friction", "obstacle[0]].friction", "a..b"] {
            says(&format!("{key}=1"), "is not a key");
        }
        says("a=", "value 1 of `a` is empty");
        says("a=1,,2", "value 2 of `a` is empty");
        for open in ["a=[1,2", "a=1]", "a=\"x", "a='x,y", "a={b=\"}\"", "a=\"\\"] {
            says(open, "end inside of a quote");
        }
        says("a=1,2,1", "takes the value 1 twice");
        says("a=\"x\ny\"", "a control character");
    }
}
