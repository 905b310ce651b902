//! Sheets as bodies with a thickness.

use super::ExportError;
use crate::mesh_file::MeshFile;
use isosheet_files::DataError;
use isosheet_mesh::vec3::{cross, sub};
use isosheet_mesh::wording::given;
use std::collections::HashSet;

/// The body between the two sides of a sheet of a thickness, in the unit of the mesh: its vertices are moved
/// by half of it to both sides, along the mean normal of the faces at them, and a rim joins the sides. Where
/// the sheet is bent more sharply than it is thick, or touches itself, the body passes through itself.
///
/// # Errors
/// [`ExportError::Data`] for a thickness that is not positive and finite.
pub fn thickened(mesh: &MeshFile, thickness: f64) -> Result<MeshFile, ExportError> {
    if !(thickness > 0.0 && thickness.is_finite()) {
        let message = format!("the thickness is {}", given(thickness));
        let error = DataError::new(message, "give a positive, finite one");
        return Err(error.value(thickness).into());
    }
    let points = mesh.positions.as_chunks::<3>().0;
    let mut normals = vec![[0.0; 3]; points.len()];
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| points[v as usize]);
        let area = cross(sub(b, a), sub(c, a));
        for v in face {
            for (sum, part) in normals[*v as usize].iter_mut().zip(area) {
                *sum += part;
            }
        }
    }
    let side = |towards: f64| {
        let moved = normals.iter().zip(points).flat_map(move |(normal, p)| {
            let [x, y, z] = *normal;
            let length = x.hypot(y).hypot(z);
            // A vertex without a normal stays where it is.
            let by = if length > 0.0 { towards / length } else { 0.0 };
            [0, 1, 2].map(|k| p[k] + by * normal[k])
        });
        moved.collect::<Vec<f64>>()
    };
    let positions = [side(0.5 * thickness), side(-0.5 * thickness)].concat();
    let below = |v: u32| v + points.len() as u32;
    let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let all: HashSet<[u32; 2]> = mesh.faces.iter().flat_map(sides).collect();
    let rim = mesh.faces.iter().flat_map(sides);
    let rim = rim.filter(|[a, b]| !all.contains(&[*b, *a]));
    let rim = rim.flat_map(|[a, b]| [[b, a, below(a)], [b, below(a), below(b)]]);
    let back = mesh
        .faces
        .iter()
        .map(|&[a, b, c]| [below(c), below(b), below(a)]);
    let faces = mesh.faces.iter().copied().chain(back).chain(rim).collect();
    Ok(MeshFile::of_frame(positions, faces, Vec::new()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::Topology;
    use isosheet_mesh::generate::{Diagonals, grid};

    /// A plate has the volume of a box, and no boundary.
    #[test]
    fn a_flat_sheet_becomes_a_box() {
        let sheet = grid(3, 2, 0.3, 0.2, Diagonals::UnionJack).unwrap();
        let mesh = MeshFile::of_frame(sheet.positions().to_vec(), sheet.face_indices(), Vec::new());
        let solid = thickened(&mesh, 0.01).unwrap();
        let t = Topology::from_faces(solid.vertex_count(), &solid.faces).unwrap();
        assert_eq!(t.boundary_edge_count(), 0);
        let points = solid.positions.as_chunks::<3>().0;
        let volume: f64 = solid
            .faces
            .iter()
            .map(|face| {
                let [a, b, c] = face.map(|v| points[v as usize]);
                let area = cross(b, c);
                (0..3).map(|k| a[k] * area[k]).sum::<f64>() / 6.0
            })
            .sum();
        assert!((volume - 0.3 * 0.2 * 0.01).abs() < 1e-15, "{volume}");
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(thickened(&mesh, wrong).is_err());
        }
    }
}
