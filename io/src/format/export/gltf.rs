//! Binary glTF 2.0, with morph targets for motions.

use super::error::{fits, single};
use super::{ExportError, Series};
use crate::format::atomic::write_atomically;
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;

/// The largest number of frames of a glTF file. Each frame is a morph target, and each of its weights is kept
/// at each frame: weights grow with the square of the frames, and 120 frames of 1089 vertices take 1.7 MB.
pub const MOST_KEY_FRAMES: usize = 120;

/// The format's numbers for types of data and for uses of buffers.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The frames of a series that are written: all, or [`MOST_KEY_FRAMES`] of them, evenly chosen, with the
/// first and the last. Frames whose times are equal as 32-bit floats are written once.
pub(super) fn key_frames(series: &Series<'_>) -> Vec<usize> {
    let all = series.frames();
    let start = series.state(all[0]).0;
    let time = |frame: usize| (series.state(frame).0 - start) as f32;
    let mut frames: Vec<usize> = if all.len() <= MOST_KEY_FRAMES {
        all.to_vec()
    } else {
        let last = MOST_KEY_FRAMES - 1;
        (0..=last)
            .map(|k| all[(k * (all.len() - 1) + last / 2) / last])
            .collect()
    };
    frames.dedup_by(|later, first| time(*later) == time(*first));
    frames
}

/// Writes a mesh that may move: times in seconds, counted from the first one in the file, positions in
/// metres. The format has y upwards: `(x, y, z)` becomes `(x, z, -y)`.
pub(super) fn write(
    path: &Path,
    faces: &[[u32; 3]],
    states: &[(f64, &[f64])],
) -> Result<(), ExportError> {
    let mut buffer = Buffer::default();
    let indices = faces
        .iter()
        .flatten()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let indices = buffer.push(
        indices,
        ELEMENT_ARRAY_BUFFER,
        UNSIGNED_INT,
        "SCALAR",
        3 * faces.len(),
    );
    let mut points = Vec::with_capacity(states.len());
    for (_, x) in states {
        points.push(
            single(x)?
                .iter()
                .map(|&[x, y, z]| [x, z, -y])
                .collect::<Vec<_>>(),
        );
    }
    let base = buffer.push_vectors(&points[0]);
    let displacement = |p: &Vec<[f32; 3]>| -> Vec<[f32; 3]> {
        let pairs = p.iter().zip(&points[0]);
        pairs
            .map(|(p, q)| std::array::from_fn(|k| p[k] - q[k]))
            .collect()
    };
    let targets: Vec<Value> = points[1..]
        .iter()
        .map(|p| json!({ "POSITION": buffer.push_vectors(&displacement(p)) }))
        .collect();
    let mut primitive = json!({
        "attributes": { "POSITION": base }, "indices": indices, "material": 0
    });
    let mut mesh = json!({ "name": "sheet" });
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "isosheet" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": "sheet", "mesh": 0 }],
        "materials": [{
            "name": "paper",
            "doubleSided": true,
            "pbrMetallicRoughness": { "baseColorFactor": [0.86, 0.78, 0.62, 1.0], "metallicFactor": 0.0 }
        }],
    });
    if !targets.is_empty() {
        mesh["weights"] = json!(vec![0.0; targets.len()]);
        document["animations"] = json!([animation(&mut buffer, states, targets.len())]);
        primitive["targets"] = json!(targets);
    }
    mesh["primitives"] = json!([primitive]);
    document["meshes"] = json!([mesh]);
    let bytes = buffer.into_file(document)?;
    Ok(write_atomically(path, |w| w.write_all(&bytes))?)
}

/// The animation of the weights: at frame k the k-th target counts and no other.
fn animation(buffer: &mut Buffer, states: &[(f64, &[f64])], targets: usize) -> Value {
    let frames = states.len();
    let times: Vec<f32> = states
        .iter()
        .map(|(t, _)| (t - states[0].0) as f32)
        .collect();
    let input = buffer.push(floats(&times), 0, FLOAT, "SCALAR", frames);
    buffer.accessors[input]["min"] = json!([times[0]]);
    buffer.accessors[input]["max"] = json!([times[frames - 1]]);
    let weight = |k: usize| f32::from(u8::from(k % targets + 1 == k / targets));
    let weights: Vec<f32> = (0..frames * targets).map(weight).collect();
    let output = buffer.push(floats(&weights), 0, FLOAT, "SCALAR", frames * targets);
    json!({
        "name": "motion",
        "samplers": [{ "input": input, "output": output, "interpolation": "LINEAR" }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }]
    })
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|c| c.to_le_bytes()).collect()
}

/// The binary part of the file and the lists that describe it. All data are of four bytes, so that everything
/// is aligned.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Adds an array; `target` is its use, or 0.
    fn push(
        &mut self,
        data: Vec<u8>,
        target: u32,
        component: u32,
        kind: &str,
        count: usize,
    ) -> usize {
        let mut view = json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": data.len()
        });
        if target != 0 {
            view["target"] = json!(target);
        }
        self.bytes.extend(data);
        self.views.push(view);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": component, "count": count, "type": kind
        }));
        self.accessors.len() - 1
    }

    /// Adds vectors with their bounds.
    fn push_vectors(&mut self, vectors: &[[f32; 3]]) -> usize {
        let data = floats(vectors.as_flattened());
        let accessor = self.push(data, ARRAY_BUFFER, FLOAT, "VEC3", vectors.len());
        let bound = |take: fn(f32, f32) -> f32| -> [f32; 3] {
            let first = vectors.first().copied().unwrap_or_default();
            vectors
                .iter()
                .fold(first, |m, v| std::array::from_fn(|k| take(m[k], v[k])))
        };
        self.accessors[accessor]["min"] = json!(bound(f32::min));
        self.accessors[accessor]["max"] = json!(bound(f32::max));
        accessor
    }

    /// The file: a header and two chunks, each with its length and name.
    fn into_file(self, mut document: Value) -> Result<Vec<u8>, ExportError> {
        document["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        document["bufferViews"] = json!(self.views);
        document["accessors"] = json!(self.accessors);
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + text.len() + 8 + self.bytes.len();
        let length: u32 = fits("bytes", length, u32::MAX as usize)?;
        let mut file = b"glTF".to_vec();
        file.extend(2_u32.to_le_bytes());
        file.extend(length.to_le_bytes());
        for (name, chunk) in [(b"JSON", text), (b"BIN\0", self.bytes)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(name);
            file.extend(chunk);
        }
        Ok(file)
    }
}
