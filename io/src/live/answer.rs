//! Answers, as they are written to a connection, which ends with them.

use std::io::{self, Write};

/// How a request ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Status {
    Done,
    NoContent,
    BadRequest,
    Forbidden,
    NotFound,
    WrongMethod,
    Conflict,
    LengthRequired,
    TooLarge,
    Busy,
}

impl Status {
    fn line(self) -> &'static str {
        match self {
            Self::Done => "200 OK",
            Self::NoContent => "204 No Content",
            Self::BadRequest => "400 Bad Request",
            Self::Forbidden => "403 Forbidden",
            Self::NotFound => "404 Not Found",
            Self::WrongMethod => "405 Method Not Allowed",
            Self::Conflict => "409 Conflict",
            Self::LengthRequired => "411 Length Required",
            Self::TooLarge => "413 Content Too Large",
            Self::Busy => "503 Service Unavailable",
        }
    }
}

/// What all answers say: nothing is kept, passed on, guessed or shown inside of another page.
const COMMON: &str = "Cache-Control: no-store\r\nReferrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\n\
                      X-Frame-Options: DENY\r\nConnection: close\r\n";

/// The content security policy of the page: it runs its own scripts, which have the nonce, and speaks to the
/// server that it came from alone.
pub(super) fn policy(nonce: &str) -> String {
    format!(
        "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'unsafe-inline'; img-src data:; \
         connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

/// Writes an answer without content.
pub(super) fn status(connection: &mut impl Write, status: Status) -> io::Result<()> {
    let line = status.line();
    let length = match status {
        Status::NoContent => "",
        _ => "Content-Length: 0\r\n",
    };
    let allow = match status {
        Status::WrongMethod => "Allow: GET, POST\r\n",
        _ => "",
    };
    write!(connection, "HTTP/1.1 {line}\r\n{COMMON}{allow}{length}\r\n")?;
    connection.flush()
}

/// Writes a page with its policy.
pub(super) fn page(connection: &mut impl Write, page: &str, policy: &str) -> io::Result<()> {
    let (line, length) = (Status::Done.line(), page.len());
    write!(
        connection,
        "HTTP/1.1 {line}\r\n{COMMON}Content-Type: text/html; charset=utf-8\r\nContent-Security-Policy: {policy}\r\n\
         Content-Length: {length}\r\n\r\n{page}"
    )?;
    connection.flush()
}

/// Begins a stream of events, which ends with the connection.
pub(super) fn begin_events(connection: &mut impl Write) -> io::Result<()> {
    let line = Status::Done.line();
    write!(
        connection,
        "HTTP/1.1 {line}\r\n{COMMON}Content-Type: text/event-stream\r\n\r\n"
    )?;
    connection.flush()
}

/// Writes an event whose data are one line.
pub(super) fn event(connection: &mut impl Write, name: &str, data: &str) -> io::Result<()> {
    write!(connection, "event: {name}\ndata: {data}\n\n")?;
    connection.flush()
}

/// Writes what a reader passes over, to see whether it is still there.
pub(super) fn sign_of_life(connection: &mut impl Write) -> io::Result<()> {
    connection.write_all(b":\n\n")?;
    connection.flush()
}
