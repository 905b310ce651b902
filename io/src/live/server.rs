//! The server of a run: one page, the events that it follows, and the commands that it posts.

use super::access::Access;
use super::answer::{self, Status};
use super::board::{Board, Told};
use super::message::{LiveCommand, Order};
use super::request::Request;
use std::collections::VecDeque;
use std::io::{self, Read};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// How long a request may take to come, and an answer to be taken.
const PATIENCE: Duration = Duration::from_secs(10);
/// How often a page without news is asked for a sign of life.
const SIGN: Duration = Duration::from_millis(500);
/// How long the head of a request may take to come: browsers send it at once.
const HEAD: Duration = Duration::from_secs(2);
/// Most connections at a time whose request knows the token: a page has an open one, and some more for
/// moments.
const MOST_CONNECTIONS: usize = 64;
/// Most connections at a time whose request has not come yet. Where there are more, the oldest one is closed,
/// so that whoever opens many and says nothing keeps no page away.
const MOST_WAITING: usize = 64;
/// How long the end of a run waits at most until pages have been told and commands answered. A browser on a
/// busy machine may leave unread for a second what has come.
const FAREWELL: Duration = Duration::from_secs(2);

/// What the connections of a server share.
pub(super) struct Shared {
    pub(super) access: Access,
    pub(super) page: String,
    /// The content security policy of the page.
    pub(super) policy: String,
    pub(super) board: Arc<Board>,
    pub(super) commands: Sender<LiveCommand>,
    pub(super) end_is_asked: Arc<AtomicBool>,
    /// The number of requests that are being answered.
    pub(super) answering: AtomicUsize,
    /// The connections whose request has not come yet, by number, the oldest one first.
    pub(super) waiting: Mutex<VecDeque<(u64, TcpStream)>>,
}

/// Listens on the loopback address alone; on a free port for 0.
///
/// # Errors
/// [`io::Error`] if the port is taken.
pub(super) fn listen(port: u16) -> io::Result<TcpListener> {
    TcpListener::bind((Ipv4Addr::LOCALHOST, port))
}

/// A server that serves until it is ended.
pub(super) struct Server {
    shared: Arc<Shared>,
    port: u16,
    thread: thread::JoinHandle<()>,
}

impl Server {
    /// Serves what comes from now on.
    ///
    /// # Errors
    /// [`io::Error`] if there is no thread for it.
    pub(super) fn start(listener: TcpListener, shared: Shared) -> io::Result<Self> {
        let port = listener.local_addr()?.port();
        let shared = Arc::new(shared);
        let serving = shared.clone();
        let name = |name: &str| thread::Builder::new().name(name.into());
        let accept = move || {
            for connection in listener.incoming() {
                if serving.board.is_closed() {
                    return;
                }
                let Ok(mut connection) = connection else {
                    continue;
                };
                let Ok(number) = serving.wait_for(&connection) else {
                    continue;
                };
                let shared = serving.clone();
                let serve = move || {
                    // A connection that breaks off needs no answer.
                    let _ = shared.serve(&mut connection, number);
                };
                if name("live connection").spawn(serve).is_err() {
                    serving.has_come(number);
                }
            }
        };
        Ok(Self {
            shared,
            port,
            thread: name("live server").spawn(accept)?,
        })
    }

    /// Tells all pages that the run has ended, and closes the port.
    pub(super) fn end(self) {
        self.shared.board.close();
        let begun = Instant::now();
        while self.shared.answering.load(Ordering::SeqCst) > 0 && begun.elapsed() < FAREWELL {
            thread::sleep(Duration::from_millis(5));
        }
        // A connection wakes the thread that waits for one.
        if TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).is_ok() {
            let _ = self.thread.join();
        }
    }
}

/// A connection from which is read until a time, however little comes at once.
struct Until<'a> {
    connection: &'a mut TcpStream,
    end: Instant,
}

impl Read for Until<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        self.connection.set_read_timeout(Some(left))?;
        self.connection.read(into)
    }
}

impl Shared {
    /// Adds a connection to the ones that wait for their request, and closes the oldest one where there are
    /// too many. Returns its number.
    fn wait_for(&self, connection: &TcpStream) -> io::Result<u64> {
        let connection = connection.try_clone()?;
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        let number = waiting.back().map_or(0, |(last, _)| last + 1);
        waiting.push_back((number, connection));
        if waiting.len() > MOST_WAITING
            && let Some((_, oldest)) = waiting.pop_front()
        {
            // The thread that reads from it ends by that.
            let _ = oldest.shutdown(Shutdown::Both);
        }
        Ok(number)
    }

    /// Takes a connection out of the ones that wait for their request.
    fn has_come(&self, number: u64) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.retain(|(other, _)| *other != number);
    }

    /// Answers the request of a connection.
    fn serve(&self, connection: &mut TcpStream, number: u64) -> io::Result<()> {
        connection.set_write_timeout(Some(PATIENCE))?;
        connection.set_nodelay(true)?;
        let end = Instant::now() + HEAD;
        let request = Request::read(&mut Until { connection, end });
        self.has_come(number);
        let request = match request {
            Ok(request) => request,
            // Browsers open connections before they need them: one that is closed is opened anew.
            Err(_) if Instant::now() >= end => return Ok(()),
            Err(status) => return answer::status(connection, status),
        };
        let target = request.target.clone();
        let (host, origin) = (request.host.as_deref(), request.origin.as_deref());
        let Some(asked) = self.access.asked(&target, host, origin) else {
            return answer::status(connection, Status::Forbidden);
        };
        let before = self.answering.fetch_add(1, Ordering::SeqCst);
        let answered = match before < MOST_CONNECTIONS {
            true => self.answer(connection, request, asked),
            false => answer::status(connection, Status::Busy),
        };
        self.answering.fetch_sub(1, Ordering::SeqCst);
        answered
    }

    fn answer(&self, connection: &mut TcpStream, request: Request, asked: &str) -> io::Result<()> {
        connection.set_read_timeout(Some(PATIENCE))?;
        match (asked, request.method.as_str()) {
            ("", "GET") => answer::page(connection, &self.page, &self.policy),
            ("events", "GET") => self.events(connection),
            ("command", "POST") => {
                let status = match request.body(connection) {
                    Ok(body) => self.order(&body),
                    Err(status) => status,
                };
                answer::status(connection, status)
            }
            ("" | "events" | "command", _) => answer::status(connection, Status::WrongMethod),
            _ => answer::status(connection, Status::NotFound),
        }
    }

    /// Passes a command on, if the page that posts it steers.
    fn order(&self, body: &[u8]) -> Status {
        let Ok(Order { viewer, command }) = serde_json::from_slice(body) else {
            return Status::BadRequest;
        };
        if !self.board.steers(viewer) {
            return Status::Conflict;
        }
        if command == LiveCommand::End {
            self.end_is_asked.store(true, Ordering::SeqCst);
        }
        match self.commands.send(command) {
            Ok(()) => Status::NoContent,
            Err(_) => Status::NotFound,
        }
    }

    /// Tells a page all news until it leaves or the run ends.
    fn events(&self, connection: &mut TcpStream) -> io::Result<()> {
        let viewer = self.board.join();
        let told = self.tell(connection, viewer);
        let leave = self.board.leave(viewer);
        // What nobody steers any more holds nothing, and what nobody sees does not go on. Where the player
        // has ended nothing is left to be done.
        if leave.steered {
            let _ = self.commands.send(LiveCommand::Release);
        }
        if leave.was_last {
            let _ = self.commands.send(LiveCommand::Pause);
        }
        told
    }

    fn tell(&self, connection: &mut TcpStream, viewer: u64) -> io::Result<()> {
        answer::begin_events(connection)?;
        let mut told = Told::default();
        loop {
            let Some(news) = self.board.wait(viewer, &mut told, SIGN) else {
                answer::sign_of_life(connection)?;
                continue;
            };
            if let Some(role) = news.role {
                let role = serde_json::to_string(&role).map_err(io::Error::other)?;
                answer::event(connection, "role", &role)?;
            }
            if let Some(frame) = news.frame {
                answer::event(connection, "frame", &frame)?;
            }
            if news.is_end {
                return answer::event(connection, "end", "");
            }
        }
    }
}
