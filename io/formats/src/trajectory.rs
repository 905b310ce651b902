//! Trajectories as numpy archives.

mod archive;
mod data;
mod motion;
mod moving_mesh;
mod npy;
mod rate;

pub use data::FrameData;
pub use data::{FrameQuantity, MeshCounts};
pub use motion::{MotionFrame, MotionFrames, WriteMotionError};
pub use moving_mesh::{Clock, MovingMesh};

use archive::{ArchiveReader, ArchiveWriter, Packing, is_read, wrong_array};
use data::not_finite;
use isosheet_files::{DataError, FileError, write_atomically};
use isosheet_mesh::wording::{counted, given};
use isosheet_mesh::{Sheet, VertexId};
use std::convert::Infallible;
use std::io;
use std::ops::ControlFlow;
use std::path::Path;

/// The frames of a run with its mesh, as kept in an `.npz` file.
///
/// | array | type | shape | |
/// |---|---|---|---|
/// | `t` | f64 | T | time of each frame, in seconds |
/// | `x` | f64 | T x V x 3 | positions, in metres |
/// | `faces` | u32 | F x 3 | corners, counter-clockwise, from 0 |
/// | `edges` | u32 | E x 2 | ends, from 0 |
/// | `rest_lengths` | f64 | E | in metres |
/// | `rod_forces` | f64 | T x E | forces of the rods, in newtons, tension positive; of runs that have them |
/// | `contact_forces` | f64 | T x V x 3 | force of contact on each vertex, in newtons; of runs with contact |
/// | `gaps` | f64 | T x V | gap of each vertex, in metres; of runs with contact |
/// | `plastic_angles` | f64 | T x E | plastic angle of each edge, in radians; of runs with edges that yield |
/// | `plastic_curvatures` | f64 | T x F x 2 | principal values of the plastic curvature of each face, in 1/m; of runs with a plate that yields |
/// | `crease_bends` | f64 | T x E | bend of the faces beside each crease, in radians; of runs with creases in sheets that bend |
/// | `rulings` | f64 | T x F x 3 | unit vector along the ruling of each face, zero where there is none; of scenes that ask for curvature |
/// | `ruling_curvatures` | f64 | T x F | curvature across the ruling of each face, in 1/m; with `rulings` |
/// | `gauss_curvatures` | f64 | T x V | Gauss curvature besides that of the rest shape, in 1/m2; with `rulings` |
///
/// In Python: `data = numpy.load("trajectory.npz"); data["x"][-1]` are the last positions.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    vertex_count: usize,
    t: Vec<f64>,
    x: Vec<f64>,
    faces: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    rest_lengths: Vec<f64>,
    /// Of each quantity the values of all frames, or none at all.
    data: [Vec<f64>; FrameQuantity::COUNT],
}

/// What a motion has.
struct MotionContents {
    /// Times of the frames, seconds.
    times: Vec<f64>,
    /// What the frames have besides positions.
    quantities: Vec<FrameQuantity>,
}

impl MotionFrames for Trajectory {
    type Error = Infallible;

    fn each(
        &self,
        show: &mut dyn FnMut(&MotionFrame<'_>) -> ControlFlow<()>,
    ) -> Result<(), Infallible> {
        for (number, &t) in self.t.iter().enumerate() {
            let n = 3 * self.vertex_count;
            let frame = MotionFrame {
                number,
                t,
                x: &self.x[n * number..n * (number + 1)],
                data: FrameData::each(|q: FrameQuantity| {
                    self.values(q, number).unwrap_or_default()
                }),
                fields: &[],
            };
            if show(&frame).is_break() {
                break;
            }
        }
        Ok(())
    }
}

impl Trajectory {
    /// An empty trajectory of a sheet.
    pub fn new(sheet: &Sheet) -> Self {
        let t = sheet.topology();
        Self {
            vertex_count: t.vertex_count(),
            t: Vec::new(),
            x: Vec::new(),
            faces: sheet.face_indices(),
            edges: t.edges().iter().map(|e| e.map(|v| v.0)).collect(),
            rest_lengths: sheet.lengths().to_vec(),
            data: Default::default(),
        }
    }

    /// Adds a frame: time in seconds and positions (length 3V, metres).
    ///
    /// # Errors
    /// [`DataError`] for a wrong length, a number that is not finite, a time before the last, or if the
    /// frames before have further data; nothing is added then.
    pub fn push(&mut self, t: f64, x: &[f64]) -> Result<(), DataError> {
        self.push_with(t, x, &FrameData::default())
    }

    /// Adds a frame with further data, each of which all frames of a trajectory have, or none.
    ///
    /// # Errors
    /// As [`Self::push`], and for another number of values than the frames before have.
    pub fn push_with(&mut self, t: f64, x: &[f64], data: &FrameData<'_>) -> Result<(), DataError> {
        let frame = MotionFrame {
            number: self.t.len(),
            t,
            x,
            data: *data,
            fields: &[],
        };
        let before = self.t.last().copied().unwrap_or(f64::NEG_INFINITY);
        let has = |quantity: FrameQuantity| !self.data[quantity as usize].is_empty();
        self.check(&frame, before, &has)?;
        for (quantity, kept) in FrameQuantity::ALL.into_iter().zip(&mut self.data) {
            kept.extend_from_slice(quantity.of(data));
        }
        self.t.push(t);
        self.x.extend_from_slice(x);
        Ok(())
    }

    /// Checks a frame after one at the time `before`; those after the first one have the quantities that
    /// `has` names.
    fn check(
        &self,
        frame: &MotionFrame<'_>,
        before: f64,
        has: &dyn Fn(FrameQuantity) -> bool,
    ) -> Result<(), DataError> {
        let &MotionFrame {
            number, t, x, data, ..
        } = frame;
        if x.len() != 3 * self.vertex_count {
            let message = format!(
                "frame {number} has {} coordinates, but the mesh has {}, three coordinates each",
                x.len(),
                counted(self.vertex_count, "vertex", "vertices")
            );
            return Err(DataError::plain(message).at(number));
        }
        if let Some(k) = x.iter().position(|c| !c.is_finite()) {
            let (vertex, axis) = (VertexId::from_index(k / 3), ["x", "y", "z"][k % 3]);
            let what = format!("coordinate {axis} of {vertex}");
            return Err(not_finite(&what, number, x[k]));
        }
        if !t.is_finite() || t < before {
            let (now, before) = (given(t), given(before));
            let message = format!("frame {number} has the time {now} s after {before} s");
            let error = DataError::new(message, "record frames in the order of time");
            return Err(error.at(number).value(t));
        }
        for quantity in FrameQuantity::ALL {
            let values = quantity.of(&data);
            let expected = match number {
                0 if values.is_empty() => 0,
                0 => self.size(quantity),
                _ if has(quantity) => self.size(quantity),
                _ => 0,
            };
            quantity.check(values, number, expected)?;
        }
        Ok(())
    }

    /// The trajectory of some of the frames, in the order of time.
    pub(super) fn subset(&self, frames: &[usize]) -> Result<Self, DataError> {
        let mut subset = self.without_frames();
        for &k in frames {
            let data = FrameData::each(|quantity| self.values(quantity, k).unwrap_or_default());
            let x = &self.x[3 * self.vertex_count * k..3 * self.vertex_count * (k + 1)];
            subset.push_with(self.t[k], x, &data)?;
        }
        Ok(subset)
    }

    /// The trajectory of the first vertices, edges and faces of the mesh, which belong together.
    pub fn of_first(&self, counts: MeshCounts) -> Self {
        let frames = |values: &[f64], size: usize, first: usize| -> Vec<f64> {
            let frames = values.chunks_exact(size.max(1));
            frames.flat_map(|frame| &frame[..first]).copied().collect()
        };
        let data = FrameQuantity::ALL.map(|quantity| {
            let first = quantity.size(counts);
            frames(self.all(quantity), self.size(quantity), first)
        });
        Self {
            vertex_count: counts.vertices,
            t: self.t.clone(),
            x: frames(&self.x, 3 * self.vertex_count, 3 * counts.vertices),
            faces: self.faces[..counts.faces].to_vec(),
            edges: self.edges[..counts.edges].to_vec(),
            rest_lengths: self.rest_lengths[..counts.edges].to_vec(),
            data,
        }
    }

    /// The mesh without frames.
    fn without_frames(&self) -> Self {
        Self {
            vertex_count: self.vertex_count,
            t: Vec::new(),
            x: Vec::new(),
            faces: self.faces.clone(),
            edges: self.edges.clone(),
            rest_lengths: self.rest_lengths.clone(),
            data: Default::default(),
        }
    }

    /// A quantity in all frames, one after the other; nothing if the trajectory does not have it.
    pub(super) fn all(&self, quantity: FrameQuantity) -> &[f64] {
        &self.data[quantity as usize]
    }

    /// The numbers of a quantity in one frame.
    fn size(&self, quantity: FrameQuantity) -> usize {
        quantity.size(self.counts())
    }

    fn counts(&self) -> MeshCounts {
        MeshCounts {
            vertices: self.vertex_count,
            edges: self.edges.len(),
            faces: self.faces.len(),
        }
    }

    /// What the first frame has besides positions.
    pub fn first_data(&self) -> Option<FrameData<'_>> {
        let of = |quantity| self.values(quantity, 0).unwrap_or_default();
        (!self.is_empty()).then(|| FrameData::each(of))
    }

    /// A quantity in a frame.
    fn values(&self, quantity: FrameQuantity, k: usize) -> Option<&[f64]> {
        let n = self.size(quantity);
        self.data[quantity as usize].get(n * k..n * (k + 1))
    }

    /// The number of frames T.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there is no frame yet.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// The number of vertices V.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The times of the frames, in seconds.
    pub fn times(&self) -> &[f64] {
        &self.t
    }

    /// The frame that is nearest to a time, seconds; of several that are as near the last. `None` without
    /// frames, and for a time that is beyond the frames by more than a frame lasts.
    pub fn nearest(&self, time: f64) -> Option<usize> {
        let (first, last) = (self.t.first()?, self.t.last()?);
        let frame = (last - first) / (self.t.len().max(2) - 1) as f64;
        let nearest = self.with_least(|t| (t - time).abs());
        nearest.filter(|_| (first - frame..=last + frame).contains(&time))
    }

    /// The frame whose time makes a value the smallest; of several such frames the last.
    pub fn with_least(&self, value: impl Fn(f64) -> f64) -> Option<usize> {
        let values = self.t.iter().map(|t| value(*t)).enumerate().rev();
        let least = values.min_by(|a, b| a.1.total_cmp(&b.1));
        least.map(|(frame, _)| frame)
    }

    /// The positions (length 3V, metres) of a frame; `None` when there is no such frame.
    pub fn frame(&self, k: usize) -> Option<&[f64]> {
        let n = 3 * self.vertex_count;
        (k < self.len()).then(|| &self.x[n * k..n * (k + 1)])
    }

    /// The corners of the faces.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The ends of the edges.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The rest length of each edge, in metres.
    pub fn rest_lengths(&self) -> &[f64] {
        &self.rest_lengths
    }

    /// The force of each edge in a frame (newtons, tension positive); `None` when the trajectory has no
    /// forces or no such frame.
    pub fn rod_forces(&self, k: usize) -> Option<&[f64]> {
        self.values(FrameQuantity::RodForces, k)
    }

    /// The force of contact on each vertex in a frame (length 3V, newtons): normal forces and friction of the
    /// bodies on the sheet and of the sheet on itself. `None` when the trajectory has no contact or no such
    /// frame.
    pub fn contact_forces(&self, k: usize) -> Option<&[f64]> {
        self.values(FrameQuantity::ContactForces, k)
    }

    /// The gap of each vertex in a frame (length V, metres): the smallest gap of the contacts that the vertex
    /// or an edge or a face at it takes part in, and the activation distance of contact where nothing is
    /// within reach; `None` when the trajectory has no contact or no such frame.
    pub fn gaps(&self, k: usize) -> Option<&[f64]> {
        self.values(FrameQuantity::Gaps, k)
    }

    /// The plastic angle of each edge in a frame (length E, radians, positive for valleys, 0 where nothing
    /// yields): what stays of its fold angle where its moment is zero. `None` when no edge can yield, or
    /// there is no such frame.
    pub fn plastic_angles(&self, k: usize) -> Option<&[f64]> {
        self.values(FrameQuantity::PlasticAngles, k)
    }

    /// The two principal values of the plastic curvature of each face in a frame (length 2F, 1/m): the larger
    /// one in size first, positive where the sheet is a valley as seen from the side from which faces are
    /// counter-clockwise. It is what stays of the curvature where the moment is zero. `None` when no face can
    /// yield, or there is no such frame.
    pub fn plastic_curvatures(&self, k: usize) -> Option<&[f64]> {
        self.values(FrameQuantity::PlasticCurvatures, k)
    }

    /// The bend of the faces beside each crease in a frame (length E, radians, positive for valleys, 0 at
    /// other edges): the angle between the two faces at a crease ([`fold_angle`](isosheet_mesh::fold_angle))
    /// is the kink of the crease and this bend. `None` when no crease is in a sheet that bends, or there is
    /// no such frame.
    pub fn crease_bends(&self, k: usize) -> Option<&[f64]> {
        self.values(FrameQuantity::CreaseBends, k)
    }

    /// The unit vector along the ruling of each face in a frame (length 3F), zero where a face has none;
    /// `None` where they were not asked for, or there is no such frame.
    pub fn rulings(&self, k: usize) -> Option<&[f64]> {
        self.values(FrameQuantity::Rulings, k)
    }

    /// The principal curvature across the ruling of each face in a frame (length F, 1/m, positive for
    /// valleys), 0 where a face has none; `None` as of [`Trajectory::rulings`].
    pub fn ruling_curvatures(&self, k: usize) -> Option<&[f64]> {
        self.values(FrameQuantity::RulingCurvatures, k)
    }

    /// The Gauss curvature at each vertex in a frame besides that of the rest shape (length V, 1/m2); `None`
    /// as of [`Trajectory::rulings`].
    pub fn gauss_curvatures(&self, k: usize) -> Option<&[f64]> {
        self.values(FrameQuantity::GaussCurvatures, k)
    }

    /// Gives all frames a quantity, in place of the one that they have.
    ///
    /// # Panics
    /// If there are not as many numbers as the frames have, or one is not finite.
    pub fn set_all(&mut self, quantity: FrameQuantity, values: Vec<f64>) {
        assert_eq!(
            values.len(),
            self.len() * self.size(quantity),
            "numbers of all frames"
        );
        assert!(values.iter().all(|v| v.is_finite()), "finite numbers");
        self.data[quantity as usize] = values;
    }

    /// Writes the `.npz` file, atomically. Equal trajectories give equal bytes.
    ///
    /// # Errors
    /// [`FileError`].
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        Ok(self.write_motion(path, self)?)
    }

    /// Writes the mesh of this trajectory with the frames of a motion, of which one is in memory at a time.
    pub fn write_motion<M: MotionFrames>(
        &self,
        path: &Path,
        motion: &M,
    ) -> Result<(), WriteMotionError<M::Error>> {
        let MotionContents { times, quantities } = self.contents(motion)?;
        let (frames, vertices) = (times.len() as u64, self.vertex_count as u64);
        let mut failed = None;
        let mut rows = |of: &dyn for<'f> Fn(&MotionFrame<'f>) -> &'f [f64],
                        put: &mut dyn FnMut(&[f64]) -> io::Result<()>| {
            let mut done = Ok(());
            let shown = motion.each(&mut |frame| {
                done = put(of(frame));
                if done.is_ok() {
                    ControlFlow::Continue(())
                } else {
                    ControlFlow::Break(())
                }
            });
            shown.map_err(|error| {
                failed = Some(error);
                io::Error::other("a frame cannot be read")
            })?;
            done
        };
        let mut write = |packing| {
            write_atomically(path, |w| {
                let mut npz = ArchiveWriter::new(w, packing);
                npz.put("t", &[frames], times.iter().copied())?;
                npz.put_rows("x", &[frames, vertices, 3], |put| {
                    rows(&|frame| frame.x, put)
                })?;
                let faces = self.faces.iter().flatten().copied();
                npz.put("faces", &[self.faces.len() as u64, 3], faces)?;
                let edges = self.edges.iter().flatten().copied();
                npz.put("edges", &[self.edges.len() as u64, 2], edges)?;
                let lengths = self.rest_lengths.iter().copied();
                npz.put("rest_lengths", &[self.rest_lengths.len() as u64], lengths)?;
                for quantity in &quantities {
                    let frame = quantity.shape(self.counts());
                    let shape = [&[frames], &frame[..]].concat();
                    npz.put_rows(quantity.name(), &shape, |put| {
                        rows(&|frame| quantity.of(&frame.data), put)
                    })?;
                }
                npz.finish()
            })
        };
        let mut written = write(Packing::Compressed);
        let length = std::fs::metadata(path).map_or(0, |file| file.len());
        if written
            .as_ref()
            .is_ok_and(|arrays| !is_read(*arrays, length))
        {
            written = write(Packing::Plain);
        }
        match failed {
            Some(error) => Err(WriteMotionError::Frame(error)),
            None => Ok(written.map(drop)?),
        }
    }

    /// What a motion has, if its frames come from a trajectory.
    fn contents<M: MotionFrames>(
        &self,
        motion: &M,
    ) -> Result<MotionContents, WriteMotionError<M::Error>> {
        let (mut times, mut quantities) = (Vec::new(), Vec::new());
        let mut checked = Ok(());
        let shown = motion.each(&mut |frame| {
            let before = times.last().copied().unwrap_or(f64::NEG_INFINITY);
            checked = self.check(frame, before, &|quantity| quantities.contains(&quantity));
            if times.is_empty() {
                let has = |quantity: &FrameQuantity| !quantity.of(&frame.data).is_empty();
                quantities.extend(FrameQuantity::ALL.into_iter().filter(has));
            }
            times.push(frame.t);
            if checked.is_ok() {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        });
        shown.map_err(WriteMotionError::Frame)?;
        checked.map_err(FileError::from)?;
        Ok(MotionContents { times, quantities })
    }

    /// Reads an `.npz` file that [`Self::write`] wrote, or one of the same arrays.
    ///
    /// # Errors
    /// [`FileError::Read`], naming the array that is missing or does not fit the others.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let mut npz = ArchiveReader::open(path)
            .map_err(|e| FileError::content(path, e, "check that it is an .npz file"))?;
        let array = |name: &str, problem: String| wrong_array(path, name, &problem);
        let (t_shape, t) = npz.get::<f64>("t", 1)?;
        let (x_shape, x) = npz.get::<f64>("x", 3)?;
        let (faces_shape, faces) = npz.get::<u32>("faces", 2)?;
        let (edges_shape, edges) = npz.get::<u32>("edges", 2)?;
        let (lengths_shape, rest_lengths) = npz.get::<f64>("rest_lengths", 1)?;
        let (frames, vertices, rods) = (t_shape[0], x_shape[1], edges_shape[0]);
        for (name, shape, expected) in [
            ("x", &x_shape, vec![frames, vertices, 3]),
            ("faces", &faces_shape, vec![faces_shape[0], 3]),
            ("edges", &edges_shape, vec![rods, 2]),
            ("rest_lengths", &lengths_shape, vec![rods]),
        ] {
            if *shape != expected {
                let problem = format!("its shape is {shape:?}, {expected:?} expected");
                return Err(array(name, problem));
            }
        }
        let counts = MeshCounts {
            vertices: vertices as usize,
            edges: rods as usize,
            faces: faces_shape[0] as usize,
        };
        let mut data: [Vec<f64>; FrameQuantity::COUNT] = Default::default();
        for (quantity, kept) in FrameQuantity::ALL.into_iter().zip(&mut data) {
            let frame = quantity.shape(counts);
            let expected = [&[frames], &frame[..]].concat();
            let found = npz.get_if_there::<f64>(quantity.name(), expected.len())?;
            let Some((shape, values)) = found else {
                continue;
            };
            if shape != expected {
                let problem = format!("its shape is {shape:?}, {expected:?} expected");
                return Err(array(quantity.name(), problem));
            }
            *kept = values;
        }
        let outside = |v: &&u32| u64::from(**v) >= vertices;
        for (name, list) in [("faces", &faces), ("edges", &edges)] {
            if let Some(v) = list.iter().find(outside) {
                return Err(array(
                    name,
                    format!("it refers to vertex {v} of {vertices}"),
                ));
            }
        }
        let further = FrameQuantity::ALL
            .map(FrameQuantity::name)
            .into_iter()
            .zip(&data);
        let own = [("t", &t), ("x", &x), ("rest_lengths", &rest_lengths)];
        for (name, list) in own.into_iter().chain(further) {
            if let Some(v) = list.iter().find(|v| !v.is_finite()) {
                return Err(array(name, format!("it contains {v}")));
            }
        }
        Ok(Self {
            vertex_count: vertices as usize,
            t,
            x,
            faces: faces.chunks_exact(3).map(|f| [f[0], f[1], f[2]]).collect(),
            edges: edges.chunks_exact(2).map(|e| [e[0], e[1]]).collect(),
            rest_lengths,
            data,
        })
    }
}

#[cfg(test)]
mod tests;
