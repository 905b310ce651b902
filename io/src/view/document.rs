//! The data in a page, as JSON.

use serde::Serialize;

use super::body::{Body, BodyShape};
use super::field::{Field, Place, Scale, Series};
use super::live::LivePage;
use super::pack::{Packed, pack_doubles, pack_indices, pack_rows};
use super::quantise::{quantise_field, quantise_positions};
use super::replay::{Axis, Replay};

/// A replay with every `stride`-th frame and the last one. The field names are those in the JSON text.
#[derive(Serialize)]
pub(super) struct Document<'a> {
    program: &'static str,
    version: &'static str,
    title: &'a str,
    up: Axis,
    vertices: usize,
    frames: usize,
    frames_of_run: usize,
    stride: usize,
    times: String,
    faces: String,
    rest: String,
    low: [f64; 3],
    step: f64,
    positions: Packed,
    sheets: &'a [usize],
    pins: &'a [u32],
    immobile: &'a [u32],
    bodies: Vec<BodyData<'a>>,
    fields: Vec<FieldData<'a>>,
    series: Vec<SeriesData<'a>>,
    summary: &'a [(String, String)],
    scene: &'a str,
    reproduce: &'a str,
    /// Of a run that goes on.
    #[serde(skip_serializing_if = "Option::is_none")]
    live: Option<&'a LivePage>,
}

#[derive(Serialize)]
struct BodyData<'a> {
    name: &'a str,
    shape: &'a BodyShape,
    /// Seven numbers for each pose: quaternion and translation.
    poses: String,
}

#[derive(Serialize)]
struct FieldData<'a> {
    name: &'a str,
    unit: &'a str,
    place: Place,
    scale: Scale,
    note: &'a str,
    low: f64,
    step: f64,
    values: Packed,
}

#[derive(Serialize)]
struct SeriesData<'a> {
    name: &'a str,
    unit: &'a str,
    scale: Scale,
    times: String,
    values: String,
}

/// The frames that are left of `frames` when every `stride`-th one and the last one are kept.
pub(super) fn frames_kept(frames: usize, stride: usize) -> Vec<usize> {
    let mut kept: Vec<usize> = (0..frames).step_by(stride).collect();
    if !(frames - 1).is_multiple_of(stride) {
        kept.push(frames - 1);
    }
    kept
}

impl<'a> Document<'a> {
    /// The document of a replay that was validated.
    pub(super) fn new(replay: &'a Replay, stride: usize) -> Self {
        let kept = frames_kept(replay.times.len(), stride);
        let frames: Vec<&Vec<f64>> = kept.iter().map(|&k| &replay.positions[k]).collect();
        let (low, step, integers) = quantise_positions(&frames);
        Self {
            program: "isosheet",
            version: env!("CARGO_PKG_VERSION"),
            title: &replay.title,
            up: replay.up,
            vertices: replay.rest.len() / 3,
            frames: kept.len(),
            frames_of_run: replay.times.len(),
            stride,
            times: pack_doubles(kept.iter().map(|&k| replay.times[k])),
            faces: pack_indices(replay.faces.as_flattened()),
            rest: pack_doubles(replay.rest.iter().copied()),
            low,
            step,
            positions: pack_rows(&integers, 2),
            sheets: &replay.sheets,
            pins: &replay.pins,
            immobile: &replay.immobile,
            bodies: replay.bodies.iter().map(|b| body_data(b, &kept)).collect(),
            fields: replay.fields.iter().map(|f| field_data(f, &kept)).collect(),
            series: replay.series.iter().map(series_data).collect(),
            summary: &replay.summary,
            scene: &replay.scene,
            reproduce: &replay.reproduce,
            live: None,
        }
    }

    /// The same of a run that goes on.
    pub(super) fn live(self, live: &'a LivePage) -> Self {
        Self {
            live: Some(live),
            ..self
        }
    }

    /// The number of frames that the document has.
    pub(super) fn frame_count(&self) -> usize {
        self.frames
    }

    /// The JSON text. It has no `<`, so that no text in it ends the element of the page that holds it.
    pub(super) fn to_json(&self) -> String {
        let json =
            serde_json::to_string(self).expect("maps have texts as keys, and numbers are finite");
        json.replace('<', "\\u003c")
    }
}

fn body_data<'a>(body: &'a Body, kept: &[usize]) -> BodyData<'a> {
    let poses: Vec<_> = match body.poses.as_slice() {
        [pose] => vec![pose],
        poses => kept.iter().map(|&k| &poses[k]).collect(),
    };
    let numbers = poses
        .iter()
        .flat_map(|p| p.rotation.into_iter().chain(p.translation));
    BodyData {
        name: &body.name,
        shape: &body.shape,
        poses: pack_doubles(numbers),
    }
}

fn field_data<'a>(field: &'a Field, kept: &[usize]) -> FieldData<'a> {
    let rows: Vec<&Vec<f64>> = kept.iter().map(|&k| &field.values[k]).collect();
    let quantised = quantise_field(&rows, field.scale);
    FieldData {
        name: &field.name,
        unit: &field.unit,
        place: field.place,
        scale: field.scale,
        note: &field.note,
        low: quantised.low,
        step: quantised.step,
        values: pack_rows(&quantised.rows, quantised.bytes),
    }
}

fn series_data(series: &Series) -> SeriesData<'_> {
    SeriesData {
        name: &series.name,
        unit: &series.unit,
        scale: match series.scale {
            // Signs and magnitudes are matters of colour.
            Scale::Linear | Scale::Signed | Scale::Magnitude => Scale::Linear,
            Scale::Logarithmic => Scale::Logarithmic,
        },
        times: pack_doubles(series.times.iter().copied()),
        values: pack_doubles(series.values.iter().copied()),
    }
}
