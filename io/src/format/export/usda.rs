//! Universal Scene Description as text.

use super::ExportError;
use super::error::single;
use crate::format::atomic::{FileWriter, write_atomically};
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

/// Time codes a second: the frames a second that a film has, so that animation programs show the motion at
/// its own speed.
const TIME_CODES: f64 = 24.0;

/// Writes a mesh that may move: times in seconds and positions in metres, z upwards. The time codes are
/// `24 t`, and programs interpolate linearly between them.
pub(super) fn write(
    path: &Path,
    faces: &[[u32; 3]],
    states: &[(f64, &[f64])],
) -> Result<(), ExportError> {
    let mut samples = Vec::with_capacity(states.len());
    for (t, x) in states {
        samples.push((TIME_CODES * t, single(x)?));
    }
    Ok(write_atomically(path, |w| {
        head(w, &samples)?;
        let counts = faces.iter().map(|_| 3);
        list(w, "    int[] faceVertexCounts = ", counts)?;
        list(w, "    int[] faceVertexIndices = ", faces.iter().flatten())?;
        if let [(_, points)] = &samples[..] {
            list(w, "    float3[] extent = ", extent(points).map(tuple))?;
            list(
                w,
                "    point3f[] points = ",
                points.iter().map(|p| tuple(*p)),
            )?;
        } else {
            writeln!(w, "    float3[] extent.timeSamples = {{")?;
            for (time, points) in &samples {
                list(w, &format!("        {time}: "), extent(points).map(tuple))?;
            }
            writeln!(w, "    }}\n    point3f[] points.timeSamples = {{")?;
            for (time, points) in &samples {
                list(
                    w,
                    &format!("        {time}: "),
                    points.iter().map(|p| tuple(*p)),
                )?;
            }
            writeln!(w, "    }}")?;
        }
        writeln!(w, "}}")
    })?)
}

fn head(w: &mut FileWriter<'_>, samples: &[(f64, Vec<[f32; 3]>)]) -> io::Result<()> {
    writeln!(
        w,
        "#usda 1.0\n(\n    defaultPrim = \"sheet\"\n    doc = \"isosheet\""
    )?;
    writeln!(w, "    upAxis = \"Z\"\n    metersPerUnit = 1")?;
    if let [(first, _), .., (last, _)] = samples {
        writeln!(w, "    startTimeCode = {first}\n    endTimeCode = {last}")?;
        writeln!(
            w,
            "    timeCodesPerSecond = {TIME_CODES}\n    framesPerSecond = {TIME_CODES}"
        )?;
    }
    writeln!(
        w,
        ")\n\ndef Mesh \"sheet\"\n{{\n    uniform bool doubleSided = 1"
    )?;
    writeln!(w, "    uniform token subdivisionScheme = \"none\"")
}

/// A list, which ends its line; the entries of the dictionaries of samples end with a comma.
fn list<T: Display>(
    w: &mut FileWriter<'_>,
    before: &str,
    entries: impl IntoIterator<Item = T>,
) -> io::Result<()> {
    write!(w, "{before}[")?;
    for (k, entry) in entries.into_iter().enumerate() {
        let separator = if k == 0 { "" } else { ", " };
        write!(w, "{separator}{entry}")?;
    }
    writeln!(w, "]{}", if before.ends_with(": ") { "," } else { "" })
}

fn tuple([x, y, z]: [f32; 3]) -> String {
    format!("({x}, {y}, {z})")
}

/// The corners of the box that holds all points; no points are at the origin.
fn extent(points: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let first = points.first().copied().unwrap_or_default();
    points.iter().fold([first; 2], |[low, high], p| {
        [
            std::array::from_fn(|k| low[k].min(p[k])),
            std::array::from_fn(|k| high[k].max(p[k])),
        ]
    })
}
