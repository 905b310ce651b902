//! A mesh that may move, as formats with several meshes take it.

use super::sheets::NamedPart;
use super::{BodyPose, SeriesBody};
use std::ops::Range;

/// What is written of a mesh that may move, and of bodies beside it.
pub(super) struct Moving<'a> {
    /// The sheets of the mesh.
    pub(super) sheets: Vec<MovingSheet<'a>>,
    /// Times (seconds) and positions (metres).
    pub(super) states: Vec<(f64, &'a [f64])>,
    /// Places of the vertices in a picture, from 0 to 1 rightwards and upwards.
    pub(super) uv: Option<&'a [[f64; 2]]>,
    /// Bodies, each with a pose for each state, or a single one if it rests.
    pub(super) bodies: Vec<(&'a SeriesBody, Vec<BodyPose>)>,
    /// Frames a second.
    pub(super) rate: f64,
}

impl<'a> Moving<'a> {
    /// A mesh alone.
    pub(super) fn still(faces: &'a [[u32; 3]], x: &'a [f64]) -> Self {
        Self {
            sheets: vec![MovingSheet::whole(faces, x.len() / 3)],
            states: vec![(0.0, x)],
            uv: None,
            bodies: Vec::new(),
            // Its only state is at time 0.
            rate: 1.0,
        }
    }
}

/// A sheet that moves, as a mesh of its own.
pub(super) struct MovingSheet<'a> {
    pub(super) name: &'a str,
    /// The range of its vertices among the vertices of all sheets.
    vertices: Range<usize>,
    /// Its faces, by the numbers of its own vertices.
    pub(super) faces: Vec<[u32; 3]>,
}

impl<'a> MovingSheet<'a> {
    /// The whole of a mesh with so many vertices.
    pub(super) fn whole(faces: &[[u32; 3]], vertices: usize) -> Self {
        Self {
            name: "sheet",
            vertices: 0..vertices,
            faces: faces.to_vec(),
        }
    }

    /// One of several sheets, of which the mesh has the faces.
    pub(super) fn of(sheet: &'a NamedPart, faces: &[[u32; 3]]) -> Self {
        let NamedPart { name, part } = sheet;
        let first = part.vertices.start as u32;
        let own = faces[part.faces.clone()].iter();
        Self {
            name,
            vertices: part.vertices.clone(),
            faces: own.map(|corners| corners.map(|v| v - first)).collect(),
        }
    }

    /// The values of its vertices among the values of all vertices.
    pub(super) fn own<'b, T>(&self, values: &'b [T]) -> &'b [T] {
        &values[self.vertices.clone()]
    }
}
