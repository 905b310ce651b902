//! Binary glTF 2.0, with morph targets for motions.

use super::error::{fits, single};
use super::moving::{Moving, MovingSheet};
use super::{BodyPose, ExportError, Series, SeriesBody};
use isosheet_files::write_atomically;
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

/// A vector in the axes of the format, which has y upwards.
fn upright([x, y, z]: [f32; 3]) -> [f32; 3] {
    [x, z, -y]
}

/// Writes a mesh that may move, and bodies that may: times in seconds, counted from the first one in the
/// file, positions in metres. The format has y upwards: `(x, y, z)` becomes `(x, z, -y)`.
pub(super) fn write(path: &Path, moving: &Moving<'_>) -> Result<(), ExportError> {
    let mut file = GlbFile::default();
    let mut nodes = Vec::new();
    for sheet in &moving.sheets {
        nodes.push(file.sheet(sheet, moving)?);
    }
    for (body, poses) in &moving.bodies {
        nodes.push(file.body(body, poses)?);
    }
    if moving.states.len() > 1 {
        file.animate(moving)?;
    }
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "isosheet" },
        "scene": 0,
        "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": file.meshes,
        "materials": [
            material("paper", [0.86, 0.78, 0.62, 1.0]),
            material("body", [0.49, 0.49, 0.47, 1.0]),
        ],
    });
    if moving.bodies.is_empty() {
        document["materials"].as_array_mut().map(Vec::pop);
    }
    if let Some(animation) = file.animation {
        document["animations"] = json!([animation]);
    }
    let bytes = file.buffer.into_file(document)?;
    Ok(write_atomically(path, |w| w.write_all(&bytes))?)
}

/// The parts of a file in the making.
#[derive(Default)]
struct GlbFile {
    buffer: Buffer,
    meshes: Vec<Value>,
    animation: Option<Value>,
}

impl GlbFile {
    /// Adds a sheet, with a morph target for each state but the first, and returns its node.
    fn sheet(
        &mut self,
        sheet: &MovingSheet<'_>,
        moving: &Moving<'_>,
    ) -> Result<Value, ExportError> {
        let indices = self.buffer.push_faces(&sheet.faces);
        let mut points = Vec::with_capacity(moving.states.len());
        for (_, x) in &moving.states {
            let own = sheet.own(x.as_chunks::<3>().0).as_flattened();
            points.push(single(own)?.into_iter().map(upright).collect::<Vec<_>>());
        }
        let base = self.buffer.push_vectors(&points[0]);
        let mut attributes = json!({ "POSITION": base });
        if let Some(uv) = moving.uv.map(|uv| sheet.own(uv)) {
            // Pictures begin at their upper left corner in this format.
            let flipped = uv.iter().flat_map(|[u, v]| [*u as f32, (1.0 - v) as f32]);
            let data = floats(&flipped.collect::<Vec<_>>());
            attributes["TEXCOORD_0"] =
                json!(
                    self.buffer
                        .push(data, ARRAY_BUFFER, FLOAT, "VEC2", uv.len())
                );
        }
        let displacement = |p: &Vec<[f32; 3]>| -> Vec<[f32; 3]> {
            let pairs = p.iter().zip(&points[0]);
            pairs
                .map(|(p, q)| std::array::from_fn(|k| p[k] - q[k]))
                .collect()
        };
        let targets: Vec<Value> = points[1..]
            .iter()
            .map(|p| json!({ "POSITION": self.buffer.push_vectors(&displacement(p)) }))
            .collect();
        let mut primitive = json!({ "attributes": attributes, "indices": indices, "material": 0 });
        let mut mesh = json!({ "name": sheet.name });
        if !targets.is_empty() {
            mesh["weights"] = json!(vec![0.0; targets.len()]);
            primitive["targets"] = json!(targets);
        }
        mesh["primitives"] = json!([primitive]);
        self.meshes.push(mesh);
        Ok(json!({ "name": sheet.name, "mesh": self.meshes.len() - 1 }))
    }

    /// Adds a body and returns its node, in the pose of the first state.
    fn body(&mut self, body: &SeriesBody, poses: &[BodyPose]) -> Result<Value, ExportError> {
        let indices = self.buffer.push_faces(&body.faces);
        let points: Vec<[f32; 3]> = single(&body.positions)?.into_iter().map(upright).collect();
        let base = self.buffer.push_vectors(&points);
        self.meshes.push(json!({
            "name": body.name,
            "primitives": [{ "attributes": { "POSITION": base }, "indices": indices, "material": 1 }]
        }));
        let [translations, rotations] = placements(poses)?;
        Ok(json!({
            "name": body.name, "mesh": self.meshes.len() - 1,
            "translation": translations[..3], "rotation": rotations[..4]
        }))
    }

    /// Adds the motion: at state k the k-th target of each sheet counts and no other, and bodies are in their
    /// poses.
    fn animate(&mut self, moving: &Moving<'_>) -> Result<(), ExportError> {
        let (states, targets) = (moving.states.len(), moving.states.len() - 1);
        let start = moving.states[0].0;
        let times: Vec<f32> = moving
            .states
            .iter()
            .map(|(t, _)| (t - start) as f32)
            .collect();
        let input = self.buffer.push(floats(&times), 0, FLOAT, "SCALAR", states);
        self.buffer.accessors[input]["min"] = json!([times[0]]);
        self.buffer.accessors[input]["max"] = json!([times[states - 1]]);
        let weight = |k: usize| f32::from(u8::from(k % targets + 1 == k / targets));
        let weights: Vec<f32> = (0..states * targets).map(weight).collect();
        let sheets = moving.sheets.len();
        let mut outputs = vec![(0..sheets, "weights", weights, "SCALAR", states * targets)];
        for (k, (_, poses)) in moving.bodies.iter().enumerate() {
            if poses.len() > 1 {
                let [translations, rotations] = placements(poses)?;
                let node = sheets + k..sheets + k + 1;
                outputs.push((node.clone(), "translation", translations, "VEC3", states));
                outputs.push((node, "rotation", rotations, "VEC4", states));
            }
        }
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        for (nodes, path, values, kind, count) in outputs {
            let output = self.buffer.push(floats(&values), 0, FLOAT, kind, count);
            for node in nodes {
                let target = json!({ "node": node, "path": path });
                channels.push(json!({ "sampler": samplers.len(), "target": target }));
            }
            samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
        }
        self.animation =
            Some(json!({ "name": "motion", "samplers": samplers, "channels": channels }));
        Ok(())
    }
}

/// Translations and rotations in the axes of the format.
fn placements(poses: &[BodyPose]) -> Result<[Vec<f32>; 2], ExportError> {
    let (mut translations, mut rotations) = (Vec::new(), Vec::new());
    for pose in poses {
        translations.extend(single(&pose.translation)?.into_iter().flat_map(upright));
        let [x, y, z, w] = pose.rotation.map(|c| c as f32);
        let [x, y, z] = upright([x, y, z]);
        rotations.extend([x, y, z, w]);
    }
    Ok([translations, rotations])
}

fn material(name: &str, colour: [f64; 4]) -> Value {
    json!({
        "name": name,
        "doubleSided": true,
        "pbrMetallicRoughness": { "baseColorFactor": colour, "metallicFactor": 0.0 }
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

    /// Adds the corners of faces.
    fn push_faces(&mut self, faces: &[[u32; 3]]) -> usize {
        let corners = faces.as_flattened();
        let data = corners.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.push(
            data,
            ELEMENT_ARRAY_BUFFER,
            UNSIGNED_INT,
            "SCALAR",
            corners.len(),
        )
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
