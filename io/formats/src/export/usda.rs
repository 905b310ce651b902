//! Universal Scene Description as text.

use super::error::single;
use super::moving::Moving;
use super::{BodyPose, ExportError, SeriesBody};
use isosheet_files::{FileWriter, write_atomically};
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

/// Linear colours of the sheet and of bodies, for programs that show meshes without a material.
const COLOURS: [[f32; 3]; 2] = [[0.86, 0.78, 0.62], [0.49, 0.49, 0.47]];

/// A body with its points as 32-bit floats.
type PlacedBody<'a> = (&'a SeriesBody, Vec<[f32; 3]>, &'a [BodyPose]);

/// Writes a mesh that may move, and bodies that may, below one root: times in seconds and positions in
/// metres, z upwards. There are as many time codes a second as frames, and programs interpolate between them,
/// places linearly and rotations along the great circle.
pub(super) fn write(path: &Path, moving: &Moving<'_>) -> Result<(), ExportError> {
    let rate = moving.rate;
    let mut samples = Vec::with_capacity(moving.states.len());
    for (t, x) in &moving.states {
        samples.push((rate * t, single(x)?));
    }
    let mut bodies: Vec<PlacedBody<'_>> = Vec::new();
    for (body, poses) in &moving.bodies {
        for pose in poses {
            single(&pose.translation)?;
        }
        bodies.push((body, single(&body.positions)?, poses));
    }
    // Whole numbers are not to be missed by round-off.
    let codes: Vec<f64> = samples
        .iter()
        .map(|(code, _)| (1e6 * code).round() / 1e6)
        .collect();
    Ok(write_atomically(path, |w| {
        head(w, &codes, rate)?;
        for sheet in &moving.sheets {
            begin_mesh(w, sheet.name, &sheet.faces, COLOURS[0])?;
            if let Some(uv) = moving.uv {
                let own = sheet.own(uv).iter();
                let tuples = own.map(|[u, v]| format!("({}, {})", *u as f32, *v as f32));
                list(
                    w,
                    "        texCoord2f[] primvars:st = ",
                    tuples,
                    " (\n            interpolation = \"vertex\"\n        )",
                )?;
            }
            let points = samples.iter().map(|(_, points)| sheet.own(points));
            let extents = points.clone().map(|p| extent(p).to_vec());
            sampled(w, "float3[] extent", &codes, extents)?;
            let points = points.map(<[_]>::to_vec);
            sampled(w, "point3f[] points", &codes, points)?;
            writeln!(w, "    }}")?;
        }
        for (body, points, poses) in &bodies {
            begin_mesh(w, &body.name, &body.faces, COLOURS[1])?;
            list(
                w,
                "        float3[] extent = ",
                extent(points).map(tuple),
                "",
            )?;
            list(
                w,
                "        point3f[] points = ",
                points.iter().map(|p| tuple(*p)),
                "",
            )?;
            placed(w, &codes, poses)?;
            writeln!(w, "    }}")?;
        }
        writeln!(w, "}}")
    })?)
}

fn head(w: &mut FileWriter<'_>, codes: &[f64], rate: f64) -> io::Result<()> {
    writeln!(
        w,
        "#usda 1.0\n(\n    defaultPrim = \"scene\"\n    doc = \"isosheet\""
    )?;
    writeln!(w, "    upAxis = \"Z\"\n    metersPerUnit = 1")?;
    if let [first, .., last] = codes {
        // Blender plays whole frames: the last one too.
        let last = last.ceil();
        writeln!(w, "    startTimeCode = {first}\n    endTimeCode = {last}")?;
        writeln!(
            w,
            "    timeCodesPerSecond = {rate}\n    framesPerSecond = {rate}"
        )?;
    }
    writeln!(w, ")\n\ndef Xform \"scene\"\n{{")
}

fn begin_mesh(
    w: &mut FileWriter<'_>,
    name: &str,
    faces: &[[u32; 3]],
    colour: [f32; 3],
) -> io::Result<()> {
    writeln!(
        w,
        "    def Mesh \"{name}\"\n    {{\n        uniform bool doubleSided = 1"
    )?;
    writeln!(w, "        uniform token subdivisionScheme = \"none\"")?;
    list(
        w,
        "        int[] faceVertexCounts = ",
        faces.iter().map(|_| 3),
        "",
    )?;
    list(
        w,
        "        int[] faceVertexIndices = ",
        faces.iter().flatten(),
        "",
    )?;
    let colour = [tuple(colour)];
    list(w, "        color3f[] primvars:displayColor = ", colour, "")
}

/// An attribute with a list of vectors for each time code.
fn sampled(
    w: &mut FileWriter<'_>,
    attribute: &str,
    codes: &[f64],
    values: impl Iterator<Item = Vec<[f32; 3]>>,
) -> io::Result<()> {
    let is_still = codes.len() == 1;
    if !is_still {
        writeln!(w, "        {attribute}.timeSamples = {{")?;
    }
    for (code, value) in codes.iter().zip(values) {
        let tuples = value.into_iter().map(tuple);
        if is_still {
            list(w, &format!("        {attribute} = "), tuples, "")?;
        } else {
            list(w, &format!("            {code}: "), tuples, ",")?;
        }
    }
    if is_still {
        Ok(())
    } else {
        writeln!(w, "        }}")
    }
}

/// Where a body is at each time code.
fn placed(w: &mut FileWriter<'_>, codes: &[f64], poses: &[BodyPose]) -> io::Result<()> {
    let translation = |p: &BodyPose| {
        let [x, y, z] = p.translation;
        format!("({x}, {y}, {z})")
    };
    let quaternion = |p: &BodyPose| {
        let [x, y, z, w] = p.rotation;
        format!("({w}, {x}, {y}, {z})")
    };
    let values = |of: &dyn Fn(&BodyPose) -> String| poses.iter().map(of).collect::<Vec<_>>();
    let attributes = [
        ("double3 xformOp:translate", values(&translation)),
        ("quatd xformOp:orient", values(&quaternion)),
    ];
    for (attribute, values) in attributes {
        if let [value] = &values[..] {
            writeln!(w, "        {attribute} = {value}")?;
            continue;
        }
        writeln!(w, "        {attribute}.timeSamples = {{")?;
        for (code, value) in codes.iter().zip(values) {
            writeln!(w, "            {code}: {value},")?;
        }
        writeln!(w, "        }}")?;
    }
    let order = ["\"xformOp:translate\"", "\"xformOp:orient\""];
    list(w, "        uniform token[] xformOpOrder = ", order, "")
}

/// A list between what comes before it and what comes after it in its line.
fn list<T: Display>(
    w: &mut FileWriter<'_>,
    before: &str,
    entries: impl IntoIterator<Item = T>,
    after: &str,
) -> io::Result<()> {
    write!(w, "{before}[")?;
    for (k, entry) in entries.into_iter().enumerate() {
        let separator = if k == 0 { "" } else { ", " };
        write!(w, "{separator}{entry}")?;
    }
    writeln!(w, "]{after}")
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
