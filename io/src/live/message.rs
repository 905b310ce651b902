//! What the page and the server say to each other, as JSON.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;

/// What a page posts.
#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Order {
    /// The number that the page was given.
    pub(super) viewer: u64,
    pub(super) command: LiveCommand,
}

/// What a page asks for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum LiveCommand {
    /// Take steps, in real time at most.
    Play,
    /// Take no more steps.
    Pause,
    /// Take one step.
    Step,
    /// Hold a vertex.
    Grab { vertex: u32 },
    /// Lead the vertex that is held towards a point, metres.
    Drag { to: [f64; 3] },
    /// Let go of it.
    Release,
    /// Drive what a slider stands for, by its number, to a value.
    Set { slider: usize, value: f64 },
    /// End the run.
    End,
}

/// The state of the run, as pages show it.
#[derive(Debug, Serialize)]
pub(super) struct LiveFrame<'a> {
    /// Time, seconds.
    pub(super) t: f64,
    pub(super) playing: bool,
    /// Seconds of the run in a second, while it plays.
    pub(super) pace: Option<f64>,
    /// Positions, `3V`: doubles in little-endian order, as base64.
    #[serde(serialize_with = "as_base64")]
    pub(super) x: Cow<'a, [f64]>,
    /// The bends beside creases, of each edge (radians), in the same way; nothing where there are none.
    #[serde(
        serialize_with = "as_base64",
        skip_serializing_if = "<[f64]>::is_empty"
    )]
    pub(super) bends: Vec<f64>,
    /// Quaternion and translation of each body.
    pub(super) poses: Vec<[f64; 7]>,
    /// A value for each of the plotted series.
    pub(super) series: Vec<Option<f64>>,
    pub(super) hand: Option<HandFrame>,
    /// The value of each slider.
    pub(super) sliders: Vec<f64>,
    pub(super) notice: Option<&'a Notice>,
}

/// A vertex that is held.
#[derive(Debug, Serialize)]
pub(super) struct HandFrame {
    pub(super) vertex: u32,
    /// Where the hand is, metres.
    pub(super) to: [f64; 3],
}

/// Something that has to be said.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Notice {
    pub(super) kind: NoticeKind,
    pub(super) text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum NoticeKind {
    Note,
    Problem,
}

/// What a page is told of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Role {
    /// Its number.
    pub(super) viewer: u64,
    /// Whether it steers the run; the others watch.
    pub(super) steers: bool,
    /// How many pages there are.
    pub(super) pages: usize,
}

fn as_base64<S: Serializer>(x: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    let bytes: Vec<u8> = x.iter().flat_map(|c| c.to_le_bytes()).collect();
    serializer.serialize_str(&STANDARD.encode(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_understood_or_refused_whole() {
        let order = |command: &str| {
            let text = format!("{{\"viewer\":3,\"command\":{command}}}");
            serde_json::from_str::<Order>(&text).map(|order| order.command)
        };
        assert_eq!(order("\"play\"").unwrap(), LiveCommand::Play);
        assert_eq!(
            order("{\"drag\":{\"to\":[1,2,0.5]}}").unwrap(),
            LiveCommand::Drag {
                to: [1.0, 2.0, 0.5]
            }
        );
        for wrong in [
            "\"fly\"",
            "{\"drag\":{\"to\":[1,2]}}",
            "{\"drag\":{\"to\":[1,2,null]}}",
            "{\"grab\":{\"vertex\":-1}}",
            "{\"grab\":{\"vertex\":1,\"more\":2}}",
            "\"play\",\"more\":1",
        ] {
            assert!(order(wrong).is_err(), "{wrong}");
        }
    }
}
