//! What a program did between the steps of a run that it recorded.

use serde::{Deserialize, Serialize};
use std::fmt;

/// What a program did between the steps of a run that is not in the scene that the run began with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Intervention {
    /// The key of the scene that was changed, or what was done in words.
    pub what: String,
    /// When it was done first, seconds.
    pub first: f64,
    /// When it was done last, seconds.
    pub last: f64,
    /// How often.
    pub times: u64,
    /// Whether the scene in the folder of the run has it: functions of time are there as they went, at the
    /// ends of the steps.
    pub in_scene: bool,
}

impl fmt::Display for Intervention {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            what,
            first,
            last,
            times,
            in_scene,
        } = self;
        match times {
            1 => write!(f, "{what} at {first:.4} s")?,
            _ => write!(f, "{what}, {times} times from {first:.4} s to {last:.4} s")?,
        }
        f.write_str(if *in_scene { "" } else { ", not in the scene" })
    }
}

/// Notes what was done at a time.
pub(super) fn note(done: &mut Vec<Intervention>, what: &str, t: f64, in_scene: bool) {
    match done.iter_mut().find(|known| known.what == what) {
        Some(known) => {
            known.last = t;
            known.times += 1;
            known.in_scene &= in_scene;
        }
        None => done.push(Intervention {
            what: what.to_owned(),
            first: t,
            last: t,
            times: 1,
            in_scene,
        }),
    }
}
