//! The tokens of a file of Universal Scene Description.

/// A token.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token<'a> {
    /// A name, a keyword or a number.
    Word(&'a str),
    /// A text in quotation marks.
    Text(&'a str),
    /// The name of a file.
    Asset,
    /// A place in a scene.
    Path,
    /// A bracket or another sign.
    Sign(u8),
}

/// The tokens that have not been taken.
pub(super) struct Tokens<'a> {
    text: &'a str,
    place: usize,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, place: 0 }
    }

    /// A problem at the place that was reached.
    pub(super) fn problem(&self, what: &str) -> String {
        let line = 1 + self.text[..self.place]
            .bytes()
            .filter(|b| *b == b'\n')
            .count();
        format!("line {line}: {what}")
    }

    fn skip_space(&mut self) {
        let bytes = self.text.as_bytes();
        while let Some(byte) = bytes.get(self.place) {
            match byte {
                b'#' => {
                    let rest = &self.text[self.place..];
                    self.place += rest.find('\n').unwrap_or(rest.len());
                }
                b if b.is_ascii_whitespace() || *b == b';' => self.place += 1,
                _ => break,
            }
        }
    }

    /// What is between the place that was reached and an end, behind which it goes on.
    fn until(&mut self, end: &str) -> Result<&'a str, String> {
        let rest = &self.text[self.place..];
        let length = rest.find(end);
        let length = length
            .ok_or_else(|| self.problem(&format!("there is no {end} to end what begins here")))?;
        self.place += length + end.len();
        Ok(&rest[..length])
    }

    /// The next token, which is not taken.
    pub(super) fn peek(&mut self) -> Result<Option<Token<'a>>, String> {
        let place = self.place;
        let token = self.next();
        self.place = place;
        token
    }

    /// The next token.
    pub(super) fn next(&mut self) -> Result<Option<Token<'a>>, String> {
        self.skip_space();
        let rest = &self.text[self.place..];
        let Some(first) = rest.bytes().next() else {
            return Ok(None);
        };
        let quote = ["\"\"\"", "'''", "\"", "'"]
            .into_iter()
            .find(|q| rest.starts_with(q));
        if let Some(quote) = quote {
            self.place += quote.len();
            let start = self.place;
            loop {
                let part = self.until(quote)?;
                let escapes = part.bytes().rev().take_while(|b| *b == b'\\').count();
                if escapes % 2 == 0 {
                    return Ok(Some(Token::Text(
                        &self.text[start..self.place - quote.len()],
                    )));
                }
            }
        }
        if first == b'@' {
            let mark = if rest.starts_with("@@@") { "@@@" } else { "@" };
            self.place += mark.len();
            self.until(mark)?;
            return Ok(Some(Token::Asset));
        }
        if first == b'<' {
            self.until(">")?;
            return Ok(Some(Token::Path));
        }
        let is_number = first.is_ascii_digit() || b"+-.".contains(&first);
        let bytes = rest.as_bytes();
        let is_word = |(k, b): (usize, &u8)| match b {
            b':' => {
                !is_number
                    && bytes
                        .get(k + 1)
                        .is_some_and(|next| next.is_ascii_alphanumeric() || *next == b'_')
            }
            b'_' | b'.' | b'+' | b'-' | b'!' | b'|' => true,
            b => b.is_ascii_alphanumeric() || *b >= 0x80,
        };
        let length = bytes
            .iter()
            .enumerate()
            .take_while(|(k, b)| is_word((*k, b)))
            .count();
        if length > 0 {
            self.place += length;
            return Ok(Some(Token::Word(&rest[..length])));
        }
        self.place += 1;
        Ok(Some(Token::Sign(first)))
    }

    /// Takes a sign if it is the next token.
    pub(super) fn take(&mut self, sign: u8) -> Result<bool, String> {
        let is_next = self.peek()? == Some(Token::Sign(sign));
        if is_next {
            self.next()?;
        }
        Ok(is_next)
    }

    /// The next token, which has to be there.
    pub(super) fn needed(&mut self) -> Result<Token<'a>, String> {
        let token = self.next()?;
        token.ok_or_else(|| self.problem("the file ends here: it was cut short"))
    }

    /// Takes a sign that has to be the next token.
    pub(super) fn expect(&mut self, sign: u8) -> Result<(), String> {
        match self.needed()? {
            Token::Sign(found) if found == sign => Ok(()),
            found => {
                let sign = char::from(sign);
                Err(self.problem(&format!("expected {sign}, found {found:?}")))
            }
        }
    }

    /// Takes all up to the bracket that closes one which has been taken.
    pub(super) fn skip_brackets(&mut self) -> Result<(), String> {
        let mut depth = 1;
        while depth > 0 {
            match self.needed()? {
                Token::Sign(b'(' | b'[' | b'{') => depth += 1,
                Token::Sign(b')' | b']' | b'}') => depth -= 1,
                _ => {}
            }
        }
        Ok(())
    }
}
