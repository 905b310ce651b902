//! STL files (stereolithography).

use super::ExportError;
use super::error::{fits, single};
use isosheet_files::write_atomically;
use std::path::Path;
use stl_io::{Normal, Triangle, Vertex};

/// Writes one mesh, binary, with coordinates of 32 bits. Normals have length 1, or 0 for faces without area.
pub(super) fn write(path: &Path, faces: &[[u32; 3]], x: &[f64]) -> Result<(), ExportError> {
    let _: u32 = fits("faces", faces.len(), u32::MAX as usize)?;
    let points = single(x)?;
    let triangles: Vec<Triangle> = faces
        .iter()
        .map(|face| {
            let corners = face.map(|v| points[v as usize]);
            Triangle {
                normal: Normal::new(normal(corners)),
                vertices: corners.map(Vertex::new),
            }
        })
        .collect();
    Ok(write_atomically(path, |w| {
        stl_io::write_stl(w, triangles.iter())
    })?)
}

fn normal(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| p.map(f64::from));
    let [u, v]: [[f64; 3]; 2] = [b, c].map(|p| std::array::from_fn(|k| p[k] - a[k]));
    let n = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    let length = n[0].hypot(n[1]).hypot(n[2]);
    if length > 0.0 {
        n.map(|c| (c / length) as f32)
    } else {
        [0.0; 3]
    }
}
