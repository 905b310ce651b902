//! Meshes in motion, of archives of numpy.

use super::archive::{ArchiveReader, ArchiveWriter, Packing, is_read};
use isosheet_files::FileError;
use isosheet_mesh::wording::{counted, given};
use std::io::{self, Cursor};
use std::path::Path;

/// The unit of the times of a mesh in motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// They are seconds.
    Seconds,
    /// They count frames, of which nothing says how many a second has.
    Frames,
}

impl Clock {
    /// The name of the array of the times in an archive.
    fn array(self) -> &'static str {
        match self {
            Self::Seconds => "t",
            Self::Frames => "frame",
        }
    }
}

/// The positions of the vertices of a mesh at several times, between which they go straight on.
#[derive(Clone, Debug, PartialEq)]
pub struct MovingMesh {
    clock: Clock,
    /// In the unit of the clock, increasing.
    times: Vec<f64>,
    /// `3V` for each time, metres.
    x: Vec<f64>,
    vertex_count: usize,
    faces: Vec<[u32; 3]>,
}

impl MovingMesh {
    /// Reads the arrays `t`, `x` and `faces` of an archive as [`Trajectory::write`](super::Trajectory::write)
    /// makes it, or of a mesh in motion ([`motion_archive`](crate::motion_archive)), with `frame` in place of
    /// `t`; `path` is used in errors only.
    ///
    /// # Errors
    /// [`FileError::Read`], naming the array and the place in it.
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self, FileError> {
        const ARRAYS: &str = "give an .npz file with the arrays `t` (T), `x` (T x V x 3) and `faces` (F x 3), such as \
                              the trajectory of a run";
        let wrong = |problem: String| FileError::content(path, problem, ARRAYS);
        let mut npz =
            ArchiveReader::new(Cursor::new(bytes), path).map_err(|e| wrong(e.to_string()))?;
        let missing = |name: &str| wrong(format!("array `{name}`: it is missing"));
        let mut array = |name, dimensions| npz.numbers_if_there(name, dimensions);
        let (clock, (t_shape, times)) = match array(Clock::Seconds.array(), 1)? {
            Some(times) => (Clock::Seconds, times),
            None => {
                let numbers = array(Clock::Frames.array(), 1)?;
                let numbers = numbers.ok_or_else(|| missing(Clock::Seconds.array()))?;
                (Clock::Frames, numbers)
            }
        };
        let (x_shape, x) = array("x", 3)?.ok_or_else(|| missing("x"))?;
        let (faces_shape, corners) = array("faces", 2)?.ok_or_else(|| missing("faces"))?;
        let (frames, vertices) = (t_shape[0], x_shape[1]);
        for (name, shape, expected) in [
            ("x", &x_shape, vec![frames, vertices, 3]),
            ("faces", &faces_shape, vec![faces_shape[0], 3]),
        ] {
            if *shape != expected {
                return Err(wrong(format!(
                    "array `{name}`: its shape is {shape:?}, {expected:?} expected"
                )));
            }
        }
        let whole = |(k, v): (usize, &f64)| match v.fract() == 0.0 {
            true => Ok(*v as i64),
            false => {
                let problem = format!("face {} refers to vertex {}", k / 3, given(*v));
                Err(FileError::content(path, problem, "give whole numbers"))
            }
        };
        let corners: Vec<i64> = corners
            .iter()
            .enumerate()
            .map(whole)
            .collect::<Result<_, _>>()?;
        Self::new(path, (clock, times), x, &corners)
    }

    /// Frames at some times: the positions of all vertices in each, one frame after the other, and the
    /// corners of the faces between them. `path` is used in errors only.
    ///
    /// # Errors
    /// [`FileError::Read`], naming the frame and the vertex.
    pub fn new(
        path: &Path,
        (clock, times): (Clock, Vec<f64>),
        x: Vec<f64>,
        corners: &[i64],
    ) -> Result<Self, FileError> {
        let frames = times.len();
        let vertices = x.len() / 3 / frames.max(1);
        if frames == 0 || vertices == 0 {
            let problem = format!(
                "it has {} of {}",
                counted(frames, "frame", "frames"),
                counted(vertices, "vertex", "vertices")
            );
            return Err(FileError::content(path, problem, "give frames of a mesh"));
        }
        if let Some(k) = times.iter().position(|t| !t.is_finite()) {
            let problem = format!("the time of frame {k} is {}", given(times[k]));
            return Err(FileError::content(path, problem, "give finite times"));
        }
        if let Some(k) = times.windows(2).position(|t| t[0] >= t[1]) {
            let [before, now] = [times[k], times[k + 1]].map(given);
            let problem = format!("frame {} has the time {now} s after {before} s", k + 1);
            return Err(FileError::content(
                path,
                problem,
                "sort the frames by time, and give one for each time",
            ));
        }
        if let Some(k) = x.iter().position(|c| !c.is_finite()) {
            let (axis, v, value) = (["x", "y", "z"][k % 3], k / 3, given(x[k]));
            let (frame, vertex) = (v / vertices, v % vertices);
            let problem =
                format!("coordinate {axis} of vertex {vertex} in frame {frame} is {value}");
            return Err(FileError::content(
                path,
                problem,
                "write finite coordinates",
            ));
        }
        let corner = |(k, v): (usize, &i64)| match u32::try_from(*v) {
            Ok(corner) if (corner as usize) < vertices => Ok(corner),
            _ => {
                let problem = format!("face {} refers to vertex {v} of {vertices}", k / 3);
                Err(FileError::content(
                    path,
                    problem,
                    "number the vertices from 0",
                ))
            }
        };
        let corners = corners.iter().enumerate().map(corner);
        let corners: Vec<u32> = corners.collect::<Result<_, _>>()?;
        Ok(Self {
            clock,
            times,
            x,
            vertex_count: vertices,
            faces: corners.as_chunks().0.to_vec(),
        })
    }

    /// The archive that [`Self::parse`] reads.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn archive(&self) -> io::Result<Vec<u8>> {
        let (bytes, arrays) = self.packed(Packing::Compressed)?;
        match is_read(arrays, bytes.len() as u64) {
            true => Ok(bytes),
            false => Ok(self.packed(Packing::Plain)?.0),
        }
    }

    /// The bytes of the archive, and the number of bytes of its arrays.
    fn packed(&self, packing: Packing) -> io::Result<(Vec<u8>, u64)> {
        let mut bytes = Vec::new();
        let mut npz = ArchiveWriter::new(Cursor::new(&mut bytes), packing);
        let [frames, vertices, faces] =
            [self.times.len(), self.vertex_count, self.faces.len()].map(|n| n as u64);
        npz.put(self.clock.array(), &[frames], self.times.iter().copied())?;
        npz.put("x", &[frames, vertices, 3], self.x.iter().copied())?;
        npz.put(
            "faces",
            &[faces, 3],
            self.faces.as_flattened().iter().copied(),
        )?;
        let arrays = npz.finish()?;
        Ok((bytes, arrays))
    }

    /// The unit of the times.
    pub fn clock(&self) -> Clock {
        self.clock
    }

    /// This motion with times in seconds, if `rate` frames take one second.
    pub fn at_rate(mut self, rate: f64) -> Self {
        self.times.iter_mut().for_each(|t| *t /= rate);
        self.clock = Clock::Seconds;
        self
    }

    /// This motion with each position changed.
    pub fn map(mut self, change: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        for p in self.x.as_chunks_mut::<3>().0 {
            *p = change(*p);
        }
        self
    }

    /// This motion `by` later, in the unit of the times.
    pub fn delayed(mut self, by: f64) -> Self {
        self.times.iter_mut().for_each(|t| *t += by);
        self
    }

    /// The times of the frames, seconds.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The corners of the faces.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The positions of a frame, metres.
    pub fn frame(&self, k: usize) -> &[[f64; 3]] {
        let n = 3 * self.vertex_count;
        self.x[n * k..n * (k + 1)].as_chunks().0
    }

    /// The position of a vertex at a time: on the line between those at the times about it, and that at the
    /// first or the last time beyond these.
    pub fn position(&self, vertex: usize, t: f64) -> [f64; 3] {
        let next = self.times.partition_point(|time| *time <= t);
        let at = |k: usize| self.frame(k)[vertex];
        if next == 0 || next == self.times.len() {
            return at(next.saturating_sub(1));
        }
        let [before, after] = [self.times[next - 1], self.times[next]];
        let part = (t - before) / (after - before);
        let [p, q] = [at(next - 1), at(next)];
        std::array::from_fn(|k| p[k] + part * (q[k] - p[k]))
    }

    /// The positions of all vertices at a time.
    pub fn positions(&self, t: f64) -> Vec<f64> {
        (0..self.vertex_count)
            .flat_map(|v| self.position(v, t))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Trajectory;
    use crate::trajectory::npy::Number;
    use isosheet_mesh::{Advice, Sheet};

    fn moving(times: &[f64], heights: &[f64]) -> MovingMesh {
        let x = |z: f64| [0.0, 0.0, z, 1.0, 0.0, z, 0.0, 1.0, 2.0 * z];
        let mut trajectory = Trajectory::new(&Sheet::new(x(0.0).to_vec(), &[[0, 1, 2]]).unwrap());
        for (t, z) in times.iter().zip(heights) {
            trajectory.push(*t, &x(*z)).unwrap();
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("moving.npz");
        trajectory.write(&path).unwrap();
        MovingMesh::parse(&std::fs::read(&path).unwrap(), &path).unwrap()
    }

    /// An archive with these arrays.
    fn archive<T: Number, X: Number, F: Number>(t: &[T], x: &[X], faces: &[F]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut npz = ArchiveWriter::new(Cursor::new(&mut bytes), Packing::Compressed);
        npz.put("t", &[t.len() as u64], t.iter().copied()).unwrap();
        let shape = [t.len() as u64, (x.len() / 3 / t.len().max(1)) as u64, 3];
        npz.put("x", &shape, x.iter().copied()).unwrap();
        npz.put("faces", &[faces.len() as u64 / 3, 3], faces.iter().copied())
            .unwrap();
        npz.finish().unwrap();
        bytes
    }

    /// What is said of an archive with these arrays.
    fn refused<F: Number>(t: &[f64], x: &[f64], faces: &[F]) -> String {
        match MovingMesh::parse(&archive(t, x, faces), Path::new("body.npz")) {
            Ok(mesh) => panic!("accepted: {mesh:?}"),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_frame_and_vertex() {
        let mut x = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
            .as_flattened()
            .repeat(3);
        let faces = [0_i64, 1, 2];
        let found = refused(&[0.0, 1.0, 1.0], &x, &faces);
        assert_eq!(found, "body.npz: frame 2 has the time 1 s after 1 s");
        let found = refused(&[0.0, f64::NAN, 1.0], &x, &faces);
        assert_eq!(found, "body.npz: the time of frame 1 is NaN");
        let found = refused(&[0.0, 1.0, 2.0], &x, &[0, 1, 2, 2, 1, 3]);
        assert_eq!(found, "body.npz: face 1 refers to vertex 3 of 3");
        let found = refused(&[], &[], &faces);
        assert_eq!(found, "body.npz: it has 0 frames of 0 vertices");
        x[9 + 7] = f64::INFINITY;
        let found = refused(&[0.0, 1.0, 2.0], &x, &faces);
        assert_eq!(
            found,
            "body.npz: coordinate y of vertex 2 in frame 1 is inf"
        );
        let other = MovingMesh::parse(b"no archive", Path::new("body.npz")).unwrap_err();
        assert!(other.to_string().starts_with("body.npz: "), "{other}");
    }

    /// Whole numbers and floats of the sizes that numpy has.
    #[test]
    fn numbers_of_any_size_are_read() {
        let read = |bytes: Vec<u8>| MovingMesh::parse(&bytes, Path::new("body.npz")).unwrap();
        let x = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 5, 1, 0, 5, 0, 1, 5];
        let expected = read(archive(&[0.0, 1.0], &x.map(f64::from), &[0_i64, 1, 2]));
        assert_eq!(expected.frame(1)[2], [0.0, 1.0, 5.0]);
        for bytes in [
            archive(&[0_i64, 1], &x.map(|c| c as f32), &[0_i16, 1, 2]),
            archive(&[0_i32, 1], &x.map(|c| c as i8), &[0_u64, 1, 2]),
            archive(&[0_u8, 1], &x.map(|c| c as u16), &[0.0_f64, 1.0, 2.0]),
            archive(&[0.0_f32, 1.0], &x, &[0_u32, 1, 2]),
        ] {
            assert_eq!(read(bytes), expected);
        }
        let x = x.map(f64::from);
        let found = refused(&[0.0, 1.0], &x, &[0.0, 1.0, 1.5]);
        assert_eq!(found, "body.npz: face 0 refers to vertex 1.5");
        let found = refused(&[0.0, 1.0], &x, &[0, 1, -1]);
        assert_eq!(found, "body.npz: face 0 refers to vertex -1 of 3");
    }

    /// Half precision, which is too coarse for positions, is refused with the way out.
    #[test]
    fn other_types_are_told() {
        #[derive(Clone, Copy)]
        struct Half;
        impl Number for Half {
            const KIND: &'static str = "f2";

            fn as_f64(self) -> f64 {
                0.0
            }

            fn put(self, bytes: &mut Vec<u8>) {
                bytes.extend([0; 2]);
            }

            fn of(_: &[u8]) -> Self {
                Self
            }
        }
        let bytes = archive(&[0.0], &[Half; 9], &[0, 1, 2]);
        let error = MovingMesh::parse(&bytes, Path::new("body.npz")).unwrap_err();
        assert_eq!(error.to_string(), "body.npz: array `x`: its type is '<f2'");
        assert!(error.advice().unwrap().contains("`x.astype(float)`"));
    }

    #[test]
    fn vertices_go_straight_on_between_frames_and_rest_before_and_after() {
        let mesh = moving(&[1.0, 2.0, 4.0], &[0.0, 0.5, -0.5]);
        assert_eq!((mesh.vertex_count(), mesh.faces()), (3, &[[0, 1, 2]][..]));
        let heights = [-1.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0].map(|t| mesh.position(2, t)[2]);
        assert_eq!(heights, [0.0, 0.0, 0.5, 1.0, 0.0, -1.0, -1.0]);
        let later = mesh.clone().delayed(10.0).map(|[x, y, z]| [z, y, x]);
        assert_eq!(later.position(2, 11.5), [0.5, 1.0, 0.0]);
        assert_eq!(mesh.positions(1.5)[..6], [0.0, 0.0, 0.25, 1.0, 0.0, 0.25]);
    }
}
