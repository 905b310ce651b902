//! The data in a page, as JSON.

use serde::Serialize;
use std::ops::ControlFlow;

use super::body::{Body, BodyShape};
use super::field::{Centering, Field, Scale, TimeSeries};
use super::frames::KeptFrames;
use super::live::LivePage;
use super::pack::{Packed, RowPacker, pack_doubles, pack_indices};
use super::quantise::{FieldScale, PositionScale};
use super::replay::{Axis, Replay};
use isosheet_files::DataError;
use isosheet_formats::MotionFrames;

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
    #[serde(skip_serializing_if = "Vec::is_empty")]
    folded: Vec<f64>,
    faces: String,
    rest: String,
    low: [f64; 3],
    step: f64,
    positions: Packed,
    #[serde(skip_serializing_if = "Option::is_none")]
    ground: Option<f64>,
    sheets: &'a [usize],
    pins: &'a [u32],
    immobile: &'a [u32],
    bodies: Vec<BodyData<'a>>,
    fields: Vec<FieldData<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    colour: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bends: Option<usize>,
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
    place: Centering,
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

impl<'a> Document<'a> {
    /// The document of the frames of a replay, which were validated; none where it is longer than `most`
    /// bytes for sure. Positions and values of fields come from `frames`, everything else from the replay.
    pub(super) fn new<M: MotionFrames<Error: From<DataError>>>(
        replay: &'a Replay,
        frames: &M,
        kept: KeptFrames,
        most: usize,
    ) -> Result<Option<Self>, M::Error> {
        let (scales, positions) = scales(replay, frames, kept)?;
        let Some((packed, fields)) = pack(&scales, positions, frames, kept, most)? else {
            return Ok(None);
        };
        let (low, step) = positions.low_and_step();
        let heads = replay.fields.iter().zip(&scales);
        let fields = heads.zip(fields).map(|((head, scale), values)| {
            let [low, step] = scale.low_and_step();
            FieldData {
                name: &head.name,
                unit: &head.unit,
                place: head.place,
                scale: head.scale,
                note: &head.note,
                low,
                step,
                values,
            }
        });
        Ok(Some(Self {
            program: "isosheet",
            version: env!("CARGO_PKG_VERSION"),
            title: &replay.title,
            up: replay.up,
            vertices: replay.rest.len() / 3,
            frames: kept.numbers().count(),
            frames_of_run: kept.frames,
            stride: kept.stride,
            times: pack_doubles(kept.numbers().map(|k| replay.times[k])),
            folded: kept
                .numbers()
                .filter_map(|k| replay.folded.get(k).copied())
                .collect(),
            faces: pack_indices(replay.faces.as_flattened()),
            rest: pack_doubles(replay.rest.iter().copied()),
            low,
            step,
            positions: packed,
            ground: replay.ground,
            sheets: &replay.sheets,
            pins: &replay.pins,
            immobile: &replay.immobile,
            bodies: replay.bodies.iter().map(|b| body_data(b, kept)).collect(),
            fields: fields.collect(),
            colour: replay.colour,
            bends: replay.bends,
            series: replay.series.iter().map(series_data).collect(),
            summary: &replay.summary,
            scene: &replay.scene,
            reproduce: &replay.reproduce,
            live: None,
        }))
    }

    /// The document of a run that goes on.
    pub(super) fn live(self, live: &'a LivePage) -> Self {
        Self {
            live: Some(live),
            ..self
        }
    }

    /// The JSON text. It has no `<`, so that no text in it ends the element of the page that holds it.
    pub(super) fn to_json(&self) -> String {
        let json =
            serde_json::to_string(self).expect("maps have texts as keys, and numbers are finite");
        json.replace('<', "\\u003c")
    }
}

/// How positions and the values of each field become integers.
fn scales<M: MotionFrames<Error: From<DataError>>>(
    replay: &Replay,
    frames: &M,
    kept: KeptFrames,
) -> Result<(Vec<FieldScale>, PositionScale), M::Error> {
    let mut positions = PositionScale::new();
    let new = |field: &Field| FieldScale::new(field.scale);
    let mut scales: Vec<FieldScale> = replay.fields.iter().map(new).collect();
    kept.try_each(frames, |frame| {
        positions.observe(frame.x);
        let of_fields = scales.iter_mut().zip(frame.fields);
        of_fields.for_each(|(scale, values)| scale.observe_sizes(values));
        Ok(())
    })?;
    kept.try_each(frames, |frame| {
        let of_fields = scales.iter_mut().zip(frame.fields);
        of_fields.for_each(|(scale, values)| scale.observe(values));
        Ok(())
    })?;
    Ok((scales, positions))
}

/// Positions and the values of each field, packed; none where they are longer than `most` bytes for sure.
fn pack<M: MotionFrames<Error: From<DataError>>>(
    scales: &[FieldScale],
    positions: PositionScale,
    frames: &M,
    kept: KeptFrames,
    most: usize,
) -> Result<Option<(Packed, Vec<Packed>)>, M::Error> {
    let mut packed = RowPacker::new(2);
    let new = |scale: &FieldScale| RowPacker::new(scale.bytes());
    let mut fields: Vec<RowPacker> = scales.iter().map(new).collect();
    let (mut integers, mut is_too_long) = (Vec::new(), false);
    for plane in 0..2 {
        packed.begin_plane(plane);
        let has_plane: Vec<bool> = fields.iter_mut().map(|f| f.begin_plane(plane)).collect();
        kept.each(frames, &mut |frame| {
            positions.integers(frame.x, &mut integers);
            packed.push(&integers);
            let of_fields = fields.iter_mut().zip(scales).zip(frame.fields);
            let of_plane = of_fields.zip(&has_plane).filter(|(_, has)| **has);
            for (((field, scale), values), _) in of_plane {
                scale.integers(values, &mut integers);
                field.push(&integers);
            }
            let length = fields.iter().map(RowPacker::least_length).sum::<usize>();
            is_too_long = packed.least_length() + length > most;
            match is_too_long {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        })?;
        if is_too_long {
            return Ok(None);
        }
    }
    let fields = fields.into_iter().map(RowPacker::finish).collect();
    Ok(Some((packed.finish(), fields)))
}

fn body_data(body: &Body, kept: KeptFrames) -> BodyData<'_> {
    let poses: Vec<_> = match body.poses.as_slice() {
        [pose] => vec![pose],
        poses => kept.numbers().map(|k| &poses[k]).collect(),
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

fn series_data(series: &TimeSeries) -> SeriesData<'_> {
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
