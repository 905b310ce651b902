//! Requests, as they are read from a connection: one on each.

use super::answer::Status;
use std::io::{ErrorKind, Read};

/// Largest size of the head of a request: twice the most that browsers write.
const MOST_HEAD: usize = 16 * 1024;
/// Largest number of its fields, several times that of browsers.
const MOST_FIELDS: usize = 100;
/// Largest size of a body: several times the longest command.
const MOST_BODY: usize = 4 * 1024;

/// A request.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Request {
    pub(super) method: String,
    /// The path that is asked for.
    pub(super) target: String,
    /// The name under which it asks, if it says exactly one.
    pub(super) host: Option<String>,
    /// The page that asks, where a browser says it.
    pub(super) origin: Option<String>,
    /// Size of the body that follows; none where it is not said.
    length: Option<usize>,
    /// What has been read of the body.
    begun: Vec<u8>,
}

impl Request {
    /// Reads a request up to its body.
    ///
    /// # Errors
    /// The status to answer with, if it is none.
    pub(super) fn read(connection: &mut impl Read) -> Result<Self, Status> {
        let mut bytes = Vec::new();
        loop {
            let mut part = [0; 2048];
            let count = match connection.read(&mut part) {
                Ok(0) => return Err(Status::BadRequest),
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(_) => return Err(Status::BadRequest),
            };
            bytes.extend(&part[..count]);
            if let Some(request) = Self::parse(&bytes)? {
                return Ok(request);
            }
            if bytes.len() > MOST_HEAD {
                return Err(Status::TooLarge);
            }
        }
    }

    /// The request of these bytes; nothing if its head has not ended.
    fn parse(bytes: &[u8]) -> Result<Option<Self>, Status> {
        let mut fields = [httparse::EMPTY_HEADER; MOST_FIELDS];
        let mut head = httparse::Request::new(&mut fields);
        let parsed = head.parse(bytes).map_err(|_| Status::BadRequest)?;
        let httparse::Status::Complete(end) = parsed else {
            return Ok(None);
        };
        let texts = |name: &str| {
            let named = head.headers.iter();
            let named = named.filter(|field| field.name.eq_ignore_ascii_case(name));
            let text = |field: &httparse::Header<'_>| String::from_utf8(field.value.to_vec()).ok();
            named.map(text).collect::<Option<Vec<String>>>()
        };
        let only = |name: &str| match texts(name).as_deref() {
            Some([]) => Ok(None),
            Some([text]) => Ok(Some(text.clone())),
            _ => Err(Status::BadRequest),
        };
        let length = only("content-length")?.map(|text| text.trim().parse());
        Ok(Some(Self {
            method: head.method.unwrap_or_default().into(),
            target: head.path.unwrap_or_default().into(),
            host: only("host")?,
            origin: only("origin")?,
            length: length.transpose().map_err(|_| Status::BadRequest)?,
            begun: bytes[end..].to_vec(),
        }))
    }

    /// Reads the body. Nothing is kept room for that has not come.
    ///
    /// # Errors
    /// The status to answer with: without a length, of more than four kilobytes, or cut off.
    pub(super) fn body(self, connection: &mut impl Read) -> Result<Vec<u8>, Status> {
        let length = self.length.ok_or(Status::LengthRequired)?;
        if length > MOST_BODY {
            return Err(Status::TooLarge);
        }
        let mut body = self.begun;
        let rest = length.saturating_sub(body.len()) as u64;
        body.truncate(length);
        let read = connection.take(rest).read_to_end(&mut body);
        match read {
            Ok(_) if body.len() == length => Ok(body),
            _ => Err(Status::BadRequest),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives its bytes one by one.
    struct Slow<'a>(&'a [u8]);

    impl Read for Slow<'_> {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            let count = self.0.len().min(1).min(into.len());
            into[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    #[test]
    fn requests_are_read_in_any_parts() {
        let text = b"POST /token/command HTTP/1.1\r\nHost: localhost:1\r\nOrigin: http://a\r\n\
                     content-length: 5\r\n\r\nhello and more";
        let whole = Request::read(&mut &text[..]).unwrap();
        assert_eq!(
            [&whole.method[..], &whole.target],
            ["POST", "/token/command"]
        );
        assert_eq!(whole.host.as_deref(), Some("localhost:1"));
        assert_eq!(whole.origin.as_deref(), Some("http://a"));
        assert_eq!(whole.body(&mut &b""[..]).unwrap(), b"hello");
        let mut slow = Slow(text);
        let request = Request::read(&mut slow).unwrap();
        assert_eq!(request.body(&mut slow).unwrap(), b"hello");
    }

    #[test]
    fn what_is_no_request_is_refused() {
        let read = |text: &str| Request::read(&mut text.as_bytes()).map(drop);
        for text in [
            "",
            "GET / HTTP/1.1\r\n",
            "\0\0\0",
            "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n",
            "GET / HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
            "GET / HTTP/1.1\r\nContent-Length: 99999999999999999999\r\n\r\n",
        ] {
            assert_eq!(read(text), Err(Status::BadRequest), "{text}");
        }
        let long = format!("GET /{} HTTP/1.1\r\n", "a".repeat(MOST_HEAD));
        assert_eq!(read(&long), Err(Status::TooLarge));
    }

    #[test]
    fn bodies_are_limited() {
        let body = |field: &str, sent: &str| {
            let text = format!("POST / HTTP/1.1\r\n{field}\r\n{sent}");
            let mut bytes = text.as_bytes();
            Request::read(&mut bytes).unwrap().body(&mut bytes)
        };
        assert_eq!(body("", "x"), Err(Status::LengthRequired));
        // No room is made for what is only announced.
        let huge = format!("Content-Length: {}\r\n", usize::MAX);
        assert_eq!(body(&huge, "x"), Err(Status::TooLarge));
        let most = format!("Content-Length: {MOST_BODY}\r\n");
        assert_eq!(body(&most, "x"), Err(Status::BadRequest));
        assert_eq!(
            body(&most, &"x".repeat(MOST_BODY)).unwrap().len(),
            MOST_BODY
        );
        assert_eq!(body("Content-Length: 0\r\n", "").unwrap(), b"");
    }
}
