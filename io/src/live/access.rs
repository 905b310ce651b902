//! Who may speak to the server: what knows the token, under its own address.

/// Bytes of a token: as many values as no search goes through.
const TOKEN_BYTES: usize = 16;

/// Random bytes of the operating system as hexadecimal digits.
///
/// # Errors
/// [`getrandom::Error`] on a system that has none.
pub(super) fn random_text() -> Result<String, getrandom::Error> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// What a request has to know and to say of itself.
#[derive(Clone, Debug)]
pub(super) struct Access {
    token: String,
    port: u16,
}

impl Access {
    pub(super) fn new(token: String, port: u16) -> Self {
        Self { token, port }
    }

    /// The address of the page.
    pub(super) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// What a request asks for: the part of its target behind the token. Nothing for a request that is
    /// refused: under another name than that of this machine (a page of another site whose name leads here),
    /// from a page of another origin, or with a wrong token.
    pub(super) fn asked<'a>(
        &self,
        target: &'a str,
        host: Option<&str>,
        origin: Option<&str>,
    ) -> Option<&'a str> {
        let port = self.port;
        let names = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}"));
        let is_own = |name: &str| names.iter().any(|own| own.eq_ignore_ascii_case(name));
        let host = host.filter(|host| is_own(host));
        let is_same = |origin: &str| origin.strip_prefix("http://").is_some_and(is_own);
        if host.is_none() || !origin.is_none_or(is_same) {
            return None;
        }
        let path = target.strip_prefix('/')?;
        let (token, rest) = path.split_once('/').unwrap_or((path, ""));
        self.is_token(token).then_some(rest)
    }

    /// Compares all bytes, whatever the first ones are: the time that it takes says nothing of where they
    /// differ.
    fn is_token(&self, token: &str) -> bool {
        let (own, other) = (self.token.as_bytes(), token.as_bytes());
        let differences = own.iter().zip(other).map(|(a, b)| a ^ b);
        own.len() == other.len() && differences.fold(0, |all, one| all | one) == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_are_long_and_never_the_same() {
        let [one, other] = [random_text().unwrap(), random_text().unwrap()];
        assert_eq!(one.len(), 2 * TOKEN_BYTES);
        assert_ne!(one, other);
        assert!(one.bytes().all(|b| b.is_ascii_hexdigit()));
    }

    #[test]
    fn strangers_are_refused() {
        let access = Access::new("0a1b".into(), 4711);
        let own = Some("127.0.0.1:4711");
        assert_eq!(access.asked("/0a1b/events", own, None), Some("events"));
        assert_eq!(access.asked("/0a1b/", own, None), Some(""));
        let other_name = Some("LocalHost:4711");
        assert_eq!(access.asked("/0a1b/x", other_name, None), Some("x"));
        for origin in ["http://127.0.0.1:4711", "http://localhost:4711"] {
            assert!(access.asked("/0a1b/", own, Some(origin)).is_some());
        }
        for origin in [
            "http://127.0.0.1:4712",
            "https://127.0.0.1:4711",
            "http://example.org",
            "http://example.org:4711",
            "null",
            "",
        ] {
            assert_eq!(access.asked("/0a1b/", own, Some(origin)), None, "{origin}");
        }
        for host in ["127.0.0.1", "127.0.0.1:4712", "example.org:4711", ""] {
            assert_eq!(access.asked("/0a1b/", Some(host), None), None, "{host}");
        }
        assert_eq!(access.asked("/0a1b/", None, None), None);
        for target in [
            "/", "/0a1", "/0a1c/", "/0a1bb/", "/0A1B/", "//0a1b/", "0a1b/", "", "*", "/x/0a1b/",
        ] {
            assert_eq!(access.asked(target, own, None), None, "{target}");
        }
    }
}
