//! The server of a run: one page, the events that it follows, and the commands that it posts.

use super::access::Access;
use super::answer::{self, Status};
use super::board::{Board, Told};
use super::message::{Command, Order};
use super::request::Request;
use std::io;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::Sender;
use std::thread;
use std::time::{Duration, Instant};

/// How long a request may take to come, and an answer to be taken.
const PATIENCE: Duration = Duration::from_secs(10);
/// How often a page without news is asked for a sign of life.
const SIGN: Duration = Duration::from_millis(500);
/// Most connections at a time: a page has an open one, and some more for moments.
const MOST_CONNECTIONS: usize = 64;
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
    pub(super) commands: Sender<Command>,
    pub(super) end_is_asked: Arc<AtomicBool>,
    /// The number of requests that are being answered.
    pub(super) answering: AtomicUsize,
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
            let open = Arc::new(AtomicUsize::new(0));
            for connection in listener.incoming() {
                if serving.board.is_closed() {
                    return;
                }
                let Ok(mut connection) = connection else {
                    continue;
                };
                if open.load(Ordering::SeqCst) >= MOST_CONNECTIONS {
                    // Whoever does not take it is not waited for.
                    let _ = answer::status(&mut connection, Status::Busy);
                    continue;
                }
                open.fetch_add(1, Ordering::SeqCst);
                let (shared, count) = (serving.clone(), open.clone());
                let serve = move || {
                    // A connection that breaks off needs no answer.
                    let _ = shared.serve(&mut connection);
                    count.fetch_sub(1, Ordering::SeqCst);
                };
                if name("live connection").spawn(serve).is_err() {
                    open.fetch_sub(1, Ordering::SeqCst);
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

impl Shared {
    /// Answers the request of a connection.
    fn serve(&self, connection: &mut TcpStream) -> io::Result<()> {
        connection.set_read_timeout(Some(PATIENCE))?;
        connection.set_write_timeout(Some(PATIENCE))?;
        connection.set_nodelay(true)?;
        let request = match Request::read(connection) {
            Ok(request) => request,
            Err(status) => return answer::status(connection, status),
        };
        self.answering.fetch_add(1, Ordering::SeqCst);
        let answered = self.answer(connection, request);
        self.answering.fetch_sub(1, Ordering::SeqCst);
        answered
    }

    fn answer(&self, connection: &mut TcpStream, request: Request) -> io::Result<()> {
        let target = request.target.clone();
        let (host, origin) = (request.host.as_deref(), request.origin.as_deref());
        let Some(asked) = self.access.asked(&target, host, origin) else {
            return answer::status(connection, Status::Forbidden);
        };
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
        if command == Command::End {
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
            let _ = self.commands.send(Command::Release);
        }
        if leave.was_last {
            let _ = self.commands.send(Command::Pause);
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
