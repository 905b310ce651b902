//! The newest state of the run, for any number of pages, and which of them steers.

use super::message::Role;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Where the run puts its newest state, and pages wait for it. A page that is slow misses states, and gets
/// the newest one next. The page that came first steers; when it leaves, the next one does.
#[derive(Debug, Default)]
pub(super) struct Board {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    frame: Arc<str>,
    /// Counts frames.
    frames: u64,
    /// In the order in which they came.
    viewers: Vec<u64>,
    last_viewer: u64,
    is_closed: bool,
}

/// What a page has been told.
#[derive(Debug, Default)]
pub(super) struct Told {
    frames: u64,
    role: Option<Role>,
}

/// What a page has not been told yet.
#[derive(Debug, Default)]
pub(super) struct News {
    pub(super) role: Option<Role>,
    pub(super) frame: Option<Arc<str>>,
    pub(super) is_end: bool,
}

/// What the leave of a page means.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Leave {
    /// Whether it steered.
    pub(super) steered: bool,
    /// Whether no page is left.
    pub(super) was_last: bool,
}

impl State {
    fn role(&self, viewer: u64) -> Role {
        Role {
            viewer,
            steers: self.viewers.first() == Some(&viewer),
            pages: self.viewers.len(),
        }
    }

    fn news(&self, viewer: u64, told: &mut Told) -> Option<News> {
        let role = self.role(viewer);
        let role = (told.role != Some(role)).then_some(role);
        let is_new = told.frames != self.frames;
        if role.is_none() && !is_new && !self.is_closed {
            return None;
        }
        told.role = role.or(told.role);
        told.frames = self.frames;
        Some(News {
            role,
            frame: is_new.then(|| self.frame.clone()),
            is_end: self.is_closed,
        })
    }
}

impl Board {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts the newest state in place of the one before.
    pub(super) fn publish(&self, frame: String) {
        let mut state = self.state();
        state.frame = frame.into();
        state.frames += 1;
        self.changed.notify_all();
    }

    /// The run has ended.
    pub(super) fn close(&self) {
        self.state().is_closed = true;
        self.changed.notify_all();
    }

    pub(super) fn is_closed(&self) -> bool {
        self.state().is_closed
    }

    /// A page has come. Its number.
    pub(super) fn join(&self) -> u64 {
        let mut state = self.state();
        state.last_viewer += 1;
        let viewer = state.last_viewer;
        state.viewers.push(viewer);
        self.changed.notify_all();
        viewer
    }

    /// A page has left.
    pub(super) fn leave(&self, viewer: u64) -> Leave {
        let mut state = self.state();
        let steered = state.role(viewer).steers;
        state.viewers.retain(|other| *other != viewer);
        self.changed.notify_all();
        Leave {
            steered,
            was_last: state.viewers.is_empty(),
        }
    }

    pub(super) fn steers(&self, viewer: u64) -> bool {
        self.state().role(viewer).steers
    }

    /// Waits for news for a page; nothing if there are none for some time.
    pub(super) fn wait(&self, viewer: u64, told: &mut Told, patience: Duration) -> Option<News> {
        let mut state = self.state();
        if let Some(news) = state.news(viewer, told) {
            return Some(news);
        }
        state = self
            .changed
            .wait_timeout(state, patience)
            .unwrap_or_else(PoisonError::into_inner)
            .0;
        state.news(viewer, told)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Duration = Duration::ZERO;

    #[test]
    fn slow_pages_get_the_newest_state() {
        let board = Board::default();
        board.publish("a".into());
        let (viewer, mut told) = (board.join(), Told::default());
        let news = board.wait(viewer, &mut told, NOW).unwrap();
        assert_eq!(news.frame.as_deref(), Some("a"));
        assert!(board.wait(viewer, &mut told, NOW).is_none());
        board.publish("b".into());
        board.publish("c".into());
        let news = board.wait(viewer, &mut told, NOW).unwrap();
        assert_eq!((news.frame.as_deref(), news.role), (Some("c"), None));
        board.close();
        assert!(board.wait(viewer, &mut told, NOW).unwrap().is_end);
    }

    #[test]
    fn the_first_page_steers_until_it_leaves() {
        let board = Board::default();
        let [first, second, third] = [board.join(), board.join(), board.join()];
        let mut told = Told::default();
        let role = board.wait(second, &mut told, NOW).unwrap().role.unwrap();
        assert_eq!((role.viewer, role.steers, role.pages), (second, false, 3));
        assert!(board.steers(first) && !board.steers(second) && !board.steers(99));
        let leave = |steered, was_last| Leave { steered, was_last };
        assert_eq!(board.leave(third), leave(false, false));
        assert_eq!(board.leave(first), leave(true, false));
        let role = board.wait(second, &mut told, NOW).unwrap().role.unwrap();
        assert!(role.steers && role.pages == 1);
        assert_eq!(board.leave(second), leave(true, true));
    }
}
