//! The parts of a file of Universal Scene Description that meshes need.

use super::tokens::{Token, Tokens};

/// Deeper parts are refused.
const DEEPEST: usize = 200;

/// A file.
pub(super) struct Layer {
    pub(super) prims: Vec<Prim>,
    metres_a_unit: f64,
    is_y_up: bool,
    pub(super) codes_a_second: f64,
}

/// A part of the scene.
#[derive(Default)]
pub(super) struct Prim {
    /// Its type.
    pub(super) kind: String,
    pub(super) name: String,
    pub(super) is_shown: bool,
    /// What of it is in other files or chosen from others.
    pub(super) elsewhere: Option<&'static str>,
    attributes: Vec<(String, Attribute)>,
    pub(super) children: Vec<Prim>,
}

/// The values of an attribute.
#[derive(Default)]
pub(super) struct Attribute {
    default: Option<Value>,
    /// By their time codes, which increase.
    pub(super) samples: Vec<(f64, Value)>,
}

/// A value: all numbers in it, and all texts.
#[derive(Clone, Debug, Default)]
pub(super) struct Value {
    pub(super) numbers: Vec<f64>,
    pub(super) texts: Vec<String>,
}

impl Attribute {
    /// The number of a value: the default one is the first where there are no samples.
    pub(super) fn value(&self, number: usize) -> Option<&Value> {
        match &self.samples[..] {
            [] => self.default.as_ref(),
            samples => samples.get(number).map(|(_, value)| value),
        }
    }

    pub(super) fn at_first(&self) -> Option<&Value> {
        self.value(0)
    }

    /// The numbers of the samples before and after a time code, and how far it is from one to the other, from
    /// 0 to 1.
    pub(super) fn about(&self, code: f64) -> (usize, usize, f64) {
        let next = self.samples.partition_point(|(c, _)| *c <= code);
        let before = next.saturating_sub(1);
        if next == 0 || next == self.samples.len() {
            return (before, before, 0.0);
        }
        let [from, to] = [before, next].map(|k| self.samples[k].0);
        (before, next, (code - from) / (to - from))
    }
}

impl Prim {
    pub(super) fn attribute(&self, name: &str) -> Option<&Attribute> {
        let found = self.attributes.iter().find(|(own, _)| own == name);
        found.map(|(_, attribute)| attribute)
    }
}

impl Layer {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        if !text.starts_with("#usda") {
            return Err(
                "the file does not begin with #usda: it is no text of Universal Scene Description"
                    .to_owned(),
            );
        }
        let mut tokens = Tokens::new(text);
        // What the format says of files that say nothing.
        let mut layer = Self {
            prims: Vec::new(),
            metres_a_unit: 0.01,
            is_y_up: true,
            codes_a_second: 24.0,
        };
        if tokens.take(b'(')? {
            let mut rates = [None, None];
            for (name, value) in metadata(&mut tokens)? {
                let number = value.numbers.first().copied();
                let positive = number.filter(|n| *n > 0.0 && n.is_finite());
                let needed = || {
                    positive.ok_or_else(|| tokens.problem(&format!("{name} is no positive number")))
                };
                match &name[..] {
                    "metersPerUnit" => layer.metres_a_unit = needed()?,
                    "timeCodesPerSecond" => rates[0] = Some(needed()?),
                    "framesPerSecond" => rates[1] = Some(needed()?),
                    "upAxis" => layer.is_y_up = value.texts.first().is_none_or(|axis| axis != "Z"),
                    "subLayers" => return Err("the file has layers in other files".to_owned()),
                    _ => {}
                }
            }
            layer.codes_a_second = rates[0].or(rates[1]).unwrap_or(layer.codes_a_second);
        }
        while let Some(token) = tokens.next()? {
            match token {
                Token::Word(word @ ("def" | "over" | "class")) => {
                    layer.prims.push(prim(&mut tokens, word, 0)?);
                }
                other => return Err(tokens.problem(&format!("expected def, found {other:?}"))),
            }
        }
        Ok(layer)
    }

    /// A point in metres with z upwards.
    pub(super) fn in_metres(&self, p: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = p.map(|c| c * self.metres_a_unit);
        if self.is_y_up { [x, -z, y] } else { [x, y, z] }
    }
}

/// The entries of metadata up to the bracket that closes them.
fn metadata(tokens: &mut Tokens<'_>) -> Result<Vec<(String, Value)>, String> {
    let mut entries = Vec::new();
    while !tokens.take(b')')? {
        match tokens.needed()? {
            Token::Word("prepend" | "append" | "add" | "delete" | "reorder") | Token::Text(_) => {}
            Token::Word(name) => {
                tokens.expect(b'=')?;
                entries.push((name.to_owned(), value(tokens)?));
            }
            other => return Err(tokens.problem(&format!("expected a name, found {other:?}"))),
        }
    }
    Ok(entries)
}

/// A prim after its first word.
fn prim(tokens: &mut Tokens<'_>, specifier: &str, depth: usize) -> Result<Prim, String> {
    if depth > DEEPEST {
        return Err(tokens.problem(&format!("parts are more than {DEEPEST} levels deep")));
    }
    let mut found = Prim {
        is_shown: specifier == "def",
        ..Prim::default()
    };
    match tokens.needed()? {
        Token::Word(kind) => {
            found.kind = kind.to_owned();
            match tokens.needed()? {
                Token::Text(name) => found.name = name.to_owned(),
                other => return Err(tokens.problem(&format!("expected a name, found {other:?}"))),
            }
        }
        Token::Text(name) => found.name = name.to_owned(),
        other => return Err(tokens.problem(&format!("expected a name, found {other:?}"))),
    }
    if found.kind == "PointInstancer" {
        found.elsewhere = Some("instances of its parts");
    }
    if tokens.take(b'(')? {
        for (name, value) in metadata(tokens)? {
            let has = |what| Some(what);
            match &name[..] {
                "active" => found.is_shown &= !value.texts.iter().any(|text| text == "false"),
                "references" => found.elsewhere = has("references"),
                "payload" => found.elsewhere = has("payloads"),
                "inherits" | "specializes" => found.elsewhere = has("classes"),
                "variantSets" => found.elsewhere = has("variants"),
                _ => {}
            }
        }
    }
    tokens.expect(b'{')?;
    while !tokens.take(b'}')? {
        match tokens.needed()? {
            Token::Word(word @ ("def" | "over" | "class")) => {
                found.children.push(prim(tokens, word, depth + 1)?);
            }
            Token::Word("variantSet") => {
                found.elsewhere = Some("variants");
                tokens.needed()?;
                tokens.expect(b'=')?;
                tokens.expect(b'{')?;
                tokens.skip_brackets()?;
            }
            Token::Word(word) => property(tokens, word, &mut found)?,
            other => return Err(tokens.problem(&format!("expected an attribute, found {other:?}"))),
        }
    }
    let visibility = found.attribute("visibility").and_then(Attribute::at_first);
    found.is_shown &= !visibility.is_some_and(|v| v.texts.iter().any(|t| t == "invisible"));
    Ok(found)
}

/// An attribute or a relation after its first word: further words, the last two of which are its type and its
/// name, a value, metadata.
fn property(tokens: &mut Tokens<'_>, first: &str, of: &mut Prim) -> Result<(), String> {
    let (mut kind, mut name) = (String::new(), first.to_owned());
    loop {
        match tokens.peek()? {
            Some(Token::Word(word)) => {
                kind = std::mem::replace(&mut name, word.to_owned());
                tokens.next()?;
            }
            // That of a type of lists.
            Some(Token::Sign(b'[')) => {
                tokens.next()?;
                tokens.expect(b']')?;
            }
            _ => break,
        }
    }
    if tokens.take(b'=')? {
        // 32-bit floats are written with as many digits as these need.
        let is_single = kind.ends_with('f') || kind.starts_with("float");
        let (own, samples) = match name.strip_suffix(".timeSamples") {
            Some(own) => (own, sampled(tokens)?),
            None => (&name[..], vec![(None, value(tokens)?)]),
        };
        let place = of.attributes.iter().position(|(known, _)| known == own);
        let place = place.unwrap_or_else(|| {
            of.attributes.push((own.to_owned(), Attribute::default()));
            of.attributes.len() - 1
        });
        let attribute = &mut of.attributes[place].1;
        for (code, mut value) in samples {
            if is_single {
                for number in &mut value.numbers {
                    *number = f64::from(*number as f32);
                }
            }
            match code {
                None => attribute.default = Some(value),
                Some(code) => attribute.samples.push((code, value)),
            }
        }
    }
    if tokens.take(b'(')? {
        tokens.skip_brackets()?;
    }
    Ok(())
}

/// Values by time codes. Those that are blocked are left out.
fn sampled(tokens: &mut Tokens<'_>) -> Result<Vec<(Option<f64>, Value)>, String> {
    tokens.expect(b'{')?;
    let (mut samples, mut last) = (Vec::new(), f64::NEG_INFINITY);
    while !tokens.take(b'}')? {
        let code = match tokens.needed()? {
            Token::Word(word) => word.parse().ok().filter(|code: &f64| code.is_finite()),
            _ => None,
        };
        let code = code.ok_or_else(|| tokens.problem("a time code is no number"))?;
        tokens.expect(b':')?;
        let value = value(tokens)?;
        if code <= last {
            return Err(tokens.problem(&format!("the time code {code} follows {last}")));
        }
        if !value.texts.iter().any(|text| text == "None") {
            samples.push((Some(code), value));
        }
        last = code;
        tokens.take(b',')?;
    }
    Ok(samples)
}

/// A value with all that is in it.
fn value(tokens: &mut Tokens<'_>) -> Result<Value, String> {
    let (mut found, mut depth) = (Value::default(), 0_usize);
    loop {
        match tokens.needed()? {
            Token::Word(word) => match word.parse() {
                Ok(number) => found.numbers.push(number),
                Err(_) => found.texts.push(word.to_owned()),
            },
            Token::Text(text) => found.texts.push(text.to_owned()),
            Token::Asset => {
                if tokens.peek()? == Some(Token::Path) {
                    tokens.next()?;
                }
                if tokens.take(b'(')? {
                    tokens.skip_brackets()?;
                }
            }
            Token::Path => {}
            Token::Sign(b'(' | b'[') => depth += 1,
            Token::Sign(b')' | b']') if depth > 0 => depth -= 1,
            Token::Sign(b',') if depth > 0 => continue,
            Token::Sign(b'{') => tokens.skip_brackets()?,
            other => return Err(tokens.problem(&format!("expected a value, found {other:?}"))),
        }
        if depth == 0 {
            return Ok(found);
        }
    }
}
