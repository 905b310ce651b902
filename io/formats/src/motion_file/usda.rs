//! Meshes in motion in files of Universal Scene Description as text.

mod layer;
mod tokens;
mod transform;

use crate::mesh_file::polygon_mesh;
use crate::{Clock, MovingMesh};
use isosheet_files::{FileError, input};
use isosheet_mesh::Advice;
use isosheet_mesh::wording::counted;
use layer::{Attribute, Layer, Prim};
use std::path::Path;
use transform::Placing;

/// Reads all meshes that a file shows, one after the other, at the times of all its samples, in metres and
/// with z upwards: points go straight on between samples.
pub(super) fn read(path: &Path) -> Result<MovingMesh, FileError> {
    let bytes = input::read(path).map_err(|e| FileError::unreadable(path, e))?;
    let wrong = |problem: String| {
        let remedy = "export the meshes with their samples as one file of text (`usdcat --flatten IN -o OUT.usda`), each \
                      instance as a mesh of its own";
        FileError::content(path, problem, remedy)
    };
    let layer = Layer::parse(&String::from_utf8_lossy(&bytes)).map_err(wrong)?;
    let meshes = meshes_of(&layer).map_err(wrong)?;
    let mut codes: Vec<f64> = meshes.iter().flat_map(Mesh::codes).collect();
    codes.sort_by(f64::total_cmp);
    codes.dedup();
    if codes.is_empty() {
        codes.push(0.0);
    }
    let (mut x, mut corners, mut first) = (Vec::new(), Vec::new(), 0);
    for mesh in &meshes {
        let own = mesh.faces();
        let own = own.map_err(|(problem, remedy)| FileError::content(path, problem, remedy))?;
        corners.extend(own.into_iter().flatten().map(|v| first + i64::from(v)));
        first += mesh.vertex_count as i64;
    }
    for &code in &codes {
        for mesh in &meshes {
            let points = mesh.points_at(code).map_err(wrong)?;
            x.extend(points.iter().flat_map(|p| layer.in_metres(*p)));
        }
    }
    let times = codes
        .iter()
        .map(|code| code / layer.codes_a_second)
        .collect();
    MovingMesh::new(path, (Clock::Seconds, times), x, &corners)
}

/// A mesh with where it is.
struct Mesh<'a> {
    name: String,
    prim: &'a Prim,
    points: &'a Attribute,
    vertex_count: usize,
    placing: Placing<'a>,
}

/// The meshes that are shown.
fn meshes_of(layer: &Layer) -> Result<Vec<Mesh<'_>>, String> {
    let mut found = Vec::new();
    let mut open: Vec<(&Prim, String, Placing<'_>)> = Vec::new();
    let tops = layer.prims.iter().rev();
    open.extend(tops.map(|prim| (prim, String::new(), Placing::default())));
    while let Some((prim, parent, outer)) = open.pop() {
        if !prim.is_shown {
            continue;
        }
        let name = format!("{parent}/{}", prim.name);
        if let Some(what) = &prim.elsewhere {
            return Err(format!("{name} has {what}, which are not read"));
        }
        let placing = outer.within(prim).map_err(|e| format!("{name} {e}"))?;
        if prim.kind == "Mesh" {
            let points = prim.attribute("points");
            let points = points.ok_or_else(|| format!("the mesh {name} has no points"))?;
            let numbers = points.at_first().map_or(0, |value| value.numbers.len());
            found.push(Mesh {
                name: name.clone(),
                prim,
                points,
                vertex_count: numbers / 3,
                placing: placing.clone(),
            });
        }
        for child in prim.children.iter().rev() {
            open.push((child, name.clone(), placing.clone()));
        }
    }
    match found.is_empty() {
        true => Err("the file shows no meshes".to_owned()),
        false => Ok(found),
    }
}

impl Mesh<'_> {
    /// The time codes of its samples.
    fn codes(&self) -> impl Iterator<Item = f64> {
        let own = self.points.samples.iter().map(|(code, _)| *code);
        own.chain(self.placing.codes())
    }

    /// Its triangles, or what is wrong and what to do.
    fn faces(&self) -> Result<Vec<[u32; 3]>, (String, &'static str)> {
        let list = |name: &str| {
            let attribute = self.prim.attribute(name);
            if attribute.is_some_and(|a| !a.samples.is_empty()) {
                let problem = format!("the mesh {} has samples of {name}", self.name);
                return Err((problem, "export a mesh whose faces stay the same"));
            }
            let value = attribute.and_then(Attribute::at_first);
            let numbers = value.map_or(&[][..], |value| &value.numbers);
            Ok(numbers.iter().map(|v| *v as i64).collect::<Vec<i64>>())
        };
        let (counts, corners) = (list("faceVertexCounts")?, list("faceVertexIndices")?);
        let points = self.points.at_first().map_or(&[][..], |v| &v.numbers);
        let mesh = polygon_mesh(points, &counts, &corners).map_err(|problem| {
            let advice = problem.advice().unwrap_or("export the mesh again");
            (format!("the mesh {}: {problem}", self.name), advice)
        })?;
        Ok(mesh.faces)
    }

    /// Where its points are in space.
    fn points_at(&self, code: f64) -> Result<Vec<[f64; 3]>, String> {
        let wrong = |found: usize| {
            format!(
                "the mesh {} has {}, and {} in the sample at the time code {code}",
                self.name,
                counted(self.vertex_count, "vertex", "vertices"),
                found / 3
            )
        };
        let (before, after, part) = self.points.about(code);
        let numbers = self.points.value(before).map_or(&[][..], |v| &v.numbers);
        let next = self.points.value(after).map_or(&[][..], |v| &v.numbers);
        for numbers in [numbers, next] {
            if numbers.len() != 3 * self.vertex_count {
                return Err(wrong(numbers.len()));
            }
        }
        let between = |(a, b): (&f64, &f64)| if part == 0.0 { *a } else { a + part * (b - a) };
        let flat: Vec<f64> = numbers.iter().zip(next).map(between).collect();
        let place = self
            .placing
            .at(code)
            .map_err(|e| format!("{} {e}", self.name))?;
        let points = flat.as_chunks::<3>().0.iter();
        Ok(points
            .map(|p| place.map_or(*p, |place| transform::apply(&place, *p)))
            .collect())
    }
}
