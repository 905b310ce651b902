//! The page of a run: one HTML file that shows the sheet and the bodies in 3D, plays the motion and plots
//! what was measured.
//!
//! [`Replay`] holds all that the page shows; [`Replay::to_html`] makes the page. The page needs neither other
//! files nor a connection: the program ([three.js](https://threejs.org) for the 3D view,
//! [uPlot](https://github.com/leeoniya/uPlot) for the plots, both under the MIT licence) and the data are in
//! it. It works from a disk, from a server and as an attachment.
//!
//! # What the page shows
//! The sheet has two colours, one for each side. It can be coloured by the fold angles of the edges, by
//! height and by every [`Field`]. The range of colours is that of the whole run; of the fold angles above a
//! degree it has 98 %, and the legend says so. [`Field::edge_strain`] makes the field of the strains. Fields
//! of either sign ([`Scale::Signed`]) have zero in the middle of the colours, magnitudes
//! ([`Scale::Magnitude`]) at their lower end; the range of either has 98 % of the values that are not zero.
//! The camera frames the rest shape, the first frame, the bodies, and where the sheet usually is (90 % of
//! each coordinate over all frames) unless this is far away. Pins are marked. Bodies are drawn where their
//! poses say: solid, see-through or not at all, as the reader chooses. The rest shape is shown on demand.
//! What is under the pointer (vertex, edge, face) is named with its fold angle and values. A click in a plot
//! goes to that time. Space plays, arrow keys step. The part of the address after `#` makes choices, as in
//! `page.html#frame=20&colour=fold&rest=1`; colours are `plain`, `fold`, `height`, and `field-K` for field K
//! from 0; `bodies` is `solid`, `glass` or `hidden`.
//!
//! # Precision
//! Let `L` be the longest side of the box that holds the positions of all frames, `h` the height of
//! triangles, and `min` and `max` the extremes of a field in the run: of a logarithmic one, those above zero.
//! Zero has a byte of its own.
//!
//! | quantity | stored as | error, at most |
//! |---|---|---|
//! | positions | 16-bit integers | `L / 65535 / 2` in each coordinate, and round-off |
//! | fold angles | not stored | about `2 L / 65535 / h` radians |
//! | fields, linear | 16-bit integers | `(max - min) / 65535 / 2` |
//! | fields, logarithmic | bytes | a factor `(max / min)^(1 / 508)` |
//! | signed fields, magnitudes | 16-bit integers | 0.022 % of the value; values below `1e-6 max` are zero |
//! | rest shape, times, series, poses | doubles | none |
//!
//! # Size
//! The program takes a quarter of a megabyte, compressed like the data. Integers of `b` bytes take `4/3 c b`
//! bytes for each number and frame: `c` is what compression leaves, a fifth of smooth motions, half of
//! crumpling ones, nearly all of noise. Positions have 3V numbers of two bytes in a frame: 289 vertices in
//! 600 frames take 0.3 to 0.7 megabytes. Doubles of series take up to 11 bytes each. Above
//! [`PageOptions::budget`] every second, fourth, ... frame is kept, and the last one; the page says so.
//! Series keep all their values.
//!
//! # Browsers
//! WebGL 2 and `DecompressionStream` are needed: Chrome and Edge 111, Firefox 113, Safari 16.4, or newer.
//! With `#selftest=1` the page tests itself and leaves the result as JSON in the attribute `data-selftest` of
//! its body.
//!
//! # Runs that go on
//! [`Replay::to_live_html`] makes the page of a run that has not ended, of its first frame: with buttons,
//! sliders ([`LivePage`]) and a hand that pulls at vertices in place of the bar of frames. It follows the
//! server-sent events at the address `events` beside its own and posts what is to be done to `command`;
//! `isosheet live` is the server.
//!
//! # Encoding
//! The data are JSON in the element `replay`. Integers are replaced by differences of order 0, 1 or 2 in
//! time, whichever is shortest, modulo `2^(8 b)`; differences become unsigned by the zigzag map; all low
//! bytes precede all high bytes; gzip and base64 follow. Doubles and indices are split into byte planes and
//! packed likewise.
//!
//! ```
//! use isosheet_page::{Field, Replay};
//!
//! let faces = vec![[0, 1, 2], [0, 2, 3]];
//! let rest = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
//! // The sheet shuts along its diagonal: vertex 3 turns about it.
//! let frame = |angle: f64| {
//!     let mut x = rest.clone();
//!     let lift = 0.5 * (1.0 - angle.cos());
//!     (x[9], x[10], x[11]) = (lift, 1.0 - lift, 0.5_f64.sqrt() * angle.sin());
//!     x
//! };
//! let times: Vec<f64> = (0..30).map(|k| f64::from(k) / 30.0).collect();
//! let positions: Vec<_> = times.iter().map(|&t| frame(t)).collect();
//! let page = Replay {
//!     title: "A fold".into(),
//!     fields: vec![Field::edge_strain(&faces, &rest, &positions)?],
//!     faces,
//!     times,
//!     positions,
//!     rest,
//!     ..Replay::default()
//! }
//! .to_html()?;
//! assert!(page.starts_with("<!doctype html>"));
//! # Ok::<(), isosheet_files::DataError>(())
//! ```

mod body;
mod check;
mod document;
mod field;
mod frames;
mod history;
mod live;
mod pack;
mod page;
mod quantise;
mod replay;

pub use body::{Body, BodyShape};
pub use check::no_frames;
pub use field::strains;
pub use field::{Centering, Field, Scale, TimeSeries};
pub use live::{LivePage, LiveSlider};
pub use page::PageOptions;
pub use replay::{Axis, Replay};

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
