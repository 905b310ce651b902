//! What a run needs, before it begins.

use super::frames::FrameShape;
use super::steps::step_count;
use isosheet_files::{bytes_in_words, memory};
use isosheet_mesh::wording::counted;
use isosheet_scenes::{Key, MEMORY_OF_FACE, Problem, Scene, SceneError, SceneFile, Setup, Warning};
use std::fmt;
use std::path::Path;

/// Memory of a vertex for the factors of a step, bytes for each doubling of the number of vertices: what
/// nested dissection leaves of the blocks of a mesh. 430 was measured for a square of 22 801 vertices.
const MEMORY_OF_FACTORS: f64 = 430.0;

/// Bytes of a step in the history, at most.
const ROW: f64 = 300.0;

/// Bytes of a coordinate in an OBJ file, about.
const OBJ_NUMBER: f64 = 22.0;

/// What a run needs, about: of a run that may end early at most that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Number of vertices.
    pub vertices: usize,
    /// Steps.
    pub steps: u64,
    /// Frames.
    pub frames: u64,
    /// Length of the file of frames, bytes.
    pub frame_bytes: f64,
    /// Length of all files, bytes.
    pub disk: f64,
    /// Memory, bytes.
    pub memory: f64,
    /// Wall time on one core, seconds: that of a sheet of rods without contact, which others exceed.
    pub time: f64,
    /// Whether the run may end before its time.
    may_end_early: bool,
}

impl Estimate {
    /// What the run of a scene needs.
    pub fn of(scene: &Scene, setup: &Setup) -> Self {
        let topology = setup.sheet.topology();
        let (vertices, faces) = (topology.vertex_count(), topology.face_count());
        let steps = step_count(scene);
        let frames = 2 + steps / scene.output.steps_per_frame(scene.method.step);
        let v = vertices as f64;
        let frame_bytes = frames as f64 * FrameShape::of(setup).bytes() as f64;
        let output = &scene.output;
        let copies = if output.trajectory { 2.0 } else { 1.0 };
        let obj = match output.obj {
            true => frames as f64 * OBJ_NUMBER * 3.0 * v,
            false => 0.0,
        };
        Self {
            vertices,
            steps,
            frames,
            frame_bytes,
            disk: copies * frame_bytes + obj + ROW * steps as f64,
            memory: MEMORY_OF_FACE * faces as f64 + MEMORY_OF_FACTORS * v * v.max(2.0).log2(),
            // 25, 81 and 289 vertices take 0.1, 0.5 and 3.7 ms a step.
            time: 7e-7 * v.powf(1.5) * steps as f64,
            may_end_early: scene.stop.rest.is_some() || scene.stop.support_force.is_some(),
        }
    }

    /// Refuses a run in a folder whose disk has no room for its frames, unless it may end early.
    ///
    /// # Errors
    /// [`SceneError`], shown at its place in the text of the scene.
    pub fn check(&self, file: &SceneFile, folder: &Path) -> Result<(), SceneError> {
        let Some(free) = free_space(folder) else {
            return Ok(());
        };
        if self.may_end_early || self.frame_bytes <= free {
            return Ok(());
        }
        let message = format!(
            "{} frames need {} on the disk, and {} are free",
            self.frames,
            bytes_in_words(self.frame_bytes),
            bytes_in_words(free)
        );
        let key = Key::root().name("output.frames_per_second");
        let remedy = "take fewer frames a second, or a shorter `stop.time`";
        Err(SceneError::from(Problem::new(key, message, remedy)).in_text(file.text()))
    }

    /// What to know of it before a run in a folder.
    pub fn warnings(&self, folder: &Path) -> Vec<Warning> {
        const MUCH: f64 = 1e10;
        const DAY: f64 = 86_400.0;
        let mut warnings = Vec::new();
        let free = free_space(folder).unwrap_or(f64::INFINITY);
        if self.disk > MUCH.min(0.5 * free) {
            let needed = bytes_in_words(self.disk);
            let message = format!("the files of the run need about {needed}");
            let remedy = "take fewer frames a second, `output.frames_per_second`";
            warnings.push(Warning::new(message, remedy));
        }
        if self.memory > 0.5 * memory::free() as f64 {
            let needed = bytes_in_words(self.memory);
            let message =
                format!("the run needs about {needed} of memory, more than half of what is free");
            warnings.push(Warning::new(message, "make the mesh coarser"));
        }
        if self.time > DAY {
            let days = counted((self.time / DAY) as usize, "day", "days");
            let message = format!("the run takes {days} or more");
            let remedy = "make the mesh coarser, the steps longer or the time shorter";
            warnings.push(Warning::new(message, remedy));
        }
        warnings
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let most = if self.may_end_early { "at most " } else { "" };
        write!(
            f,
            "{most}{} steps and {} frames, about {} on the disk and {} of memory",
            self.steps,
            self.frames,
            bytes_in_words(self.disk),
            bytes_in_words(self.memory)
        )
    }
}

/// The free space of the disk of a folder that need not be there yet, bytes, where the system says it.
fn free_space(folder: &Path) -> Option<f64> {
    #[cfg(unix)]
    {
        let folder = std::path::absolute(folder).ok()?;
        let disk = folder
            .ancestors()
            .find_map(|f| rustix::fs::statvfs(f).ok())?;
        // What is no disk, such as /proc, has no blocks.
        (disk.f_blocks > 0).then_some(disk.f_bavail as f64 * disk.f_frsize as f64)
    }
    #[cfg(not(unix))]
    {
        let _ = folder;
        None
    }
}
