//! `isosheet convert`.

use super::failure::{Code, Done, Failure};
use super::frames::{ColourRange, FrameRange, Size, View};
use super::info::is_scene;
use super::layers;
use super::message::counted;
use super::one_frame::OneFrame;
use super::pictures::{self, FrameChoice, PictureFormat, input, wrong};
use super::write::{is_same_file, refuse_file_of_run, to_stdout};
use clap::Args;
use isosheet_drawings::Length;
use isosheet_files::FileError;
use isosheet_films::{FilmOptions, Marks};
use isosheet_formats::{
    ExportError, Exported, MOST_KEY_FRAMES, MeshFile, MeshFileProblem, MeshFormat, MeshOptions,
    Series, SeriesOptions, Trajectory, read_mesh_with, thickened, write_frame, write_mesh,
    write_series,
};
use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;
use isosheet_runs::Recording;
use isosheet_scenes::Folding;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// What is read and written, as `--help` shows it.
const FORMATS: &str = "\
Mesh files that are read:
  .obj .off .stl .ply .fold .gltf .glb .vtk .vtp
  .svg .cp .opx           crease patterns
Mesh files that are written, also of one frame of a run (--frame K or --frame last):
  .obj .off .ply .fold    all digits; .fold with edges, assignments and fold angles
  .stl .glb .usda         32-bit floats
                          .stl for printers: --thickness 0.8mm --scale 1000
Runs that are read: the folder of a run, or a trajectory (.npz)
Files that are written of a run:
  .fold   one frame for each frame, with times and fold angles
  .glb    morph targets, at most 120 frames, evenly chosen, and bodies (all glTF viewers)
  .usda   time samples, and bodies (Blender: the best choice)
  .pc2    point cache, with the mesh as .obj beside it (Blender: Mesh Cache modifier)
  .pvd    VTK, one .vtp for each frame in a folder, with strain, fold angle, rulings, forces and gaps
          (ParaView); bodies in a .pvd of their own
  .obj    one file for each frame in a folder of that name, and files with the bodies
  .csv    a line for each vertex of each frame, with force of contact and gap
  .npz    a numpy archive of all frames, as trajectory.npz of the run
  .png    a shaded picture of one frame (--frame K, the last one without it); with --frames, --every or --fps
          numbered pictures in a folder of that name
  .apng   shaded pictures of all frames as an animation in real time, at most 50 a second (browsers)
  .svg    the layers of a sheet that is folded flat, drawn apart
  .mp4 .webm .mov .mkv .avi .gif   the same as a film, encoded by ffmpeg where it is installed
A file that exists is replaced, unless it is the one that is read, or one that a run has written.
docs/formats.md says more.";

const EXAMPLES: &str = "\
Examples:
  isosheet convert cloth-run cloth.usda        a run for Blender, with its bodies
  isosheet convert cloth-run cloth.apng        a run as a film
  isosheet convert cloth-run end.png           a picture of its last frame
  isosheet convert cloth-run half.png --time 0.5 --plain
  isosheet convert cloth-run gap.png --colour gap --size 1200
                                               its colours are a quantity, with their scale
  isosheet convert crane-run half.fold --part 0.5
                                               a run that folds a pattern, where it is folded by half
  isosheet convert sheet.obj sheet.fold        a mesh in another format";

/// Convert a mesh file to another format, or a run to files of other programs
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES, after_help = FORMATS)]
pub(crate) struct Convert {
    /// A mesh file, the folder of a run, or a trajectory (.npz)
    input: PathBuf,
    /// The file to write, or to replace; its extension says the format
    #[arg(required_unless_present = "out", conflicts_with = "out")]
    output: Option<PathBuf>,
    /// The file to write, or to replace: an option, as the other commands have it
    #[arg(short, long, value_name = "OUTPUT")]
    out: Option<PathBuf>,
    #[command(flatten)]
    one: OneFrame,
    /// Of a run, write the frames from A to B, both included; A.. and ..B go to an end
    #[arg(long, value_name = "A..B")]
    frames: Option<FrameRange>,
    /// Of a run, write every Nth frame, beginning with the first
    #[arg(long, value_name = "N", conflicts_with = "fps", value_parser = clap::value_parser!(u64).range(1..))]
    every: Option<u64>,
    /// Of a run, write F frames a second: states between two frames of the run are interpolated linearly
    #[arg(long, value_name = "F")]
    fps: Option<f64>,
    /// Of pictures, the size in pixels: width and height such as 1280x720, or the height alone for the width
    /// that fits [default: 480]
    #[arg(long, value_name = "SIZE")]
    size: Option<Size>,
    /// Of pictures, where the viewer is: front, back, left, right, top, bottom, or degrees counter-clockwise
    /// from the x axis and above the horizon [default: -60,25, or elsewhere if bodies hide the sheet from
    /// there]
    #[arg(long, value_name = "VIEW", allow_hyphen_values = true)]
    view: Option<View>,
    /// Of pictures, leave out the edges of the mesh and the marks of pins
    #[arg(long)]
    plain: bool,
    /// Of pictures, colour the sheet by a quantity, such as "fold angle" or "gap", with a scale of colours
    /// below; an unknown name is answered with the names that the run has
    #[arg(long, visible_alias = "color", value_name = "QUANTITY")]
    colour: Option<String>,
    /// Of pictures with a quantity, the values at both ends of the scale of colours [default: those in all
    /// frames that are drawn]
    #[arg(
        long,
        value_name = "LOW..HIGH",
        allow_hyphen_values = true,
        requires = "colour"
    )]
    range: Option<ColourRange>,
    /// Of one mesh as .stl, .obj, .off or .ply, make it larger by this factor: 1000 for the millimetres of
    /// printers
    #[arg(long, value_name = "FACTOR")]
    scale: Option<f64>,
    /// Of the same, make a closed body of the sheet, of this thickness (such as 0.8mm; metres without a unit)
    /// before it is made larger
    #[arg(long, value_name = "LENGTH")]
    thickness: Option<Length>,
    /// Of a run, leave its bodies out
    #[arg(long)]
    no_bodies: bool,
    /// Of a mesh file, make vertices one that are at most T apart, in the unit of the file [default: 0 for
    /// STL and glTF, no welding for others]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    weld: Option<f64>,
}

impl Convert {
    /// The file to write, which the parser has made sure of.
    fn output(&self) -> &Path {
        let output = self.output.as_deref().or(self.out.as_deref());
        output.unwrap_or(Path::new(""))
    }

    pub(crate) fn run(&self) -> Done {
        self.check_output()?;
        if self.input.is_dir() {
            return self.convert_run();
        }
        if let Err(error) = std::fs::metadata(&self.input) {
            let error = FileError::unreadable(&self.input, error);
            return Err(Failure::of(Code::Input, &error));
        }
        if self
            .input
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("npz"))
        {
            if PictureFormat::of(self.output()).is_some() {
                let message = "pictures need the bodies and supports of the run";
                return Err(wrong(message, FOLDER));
            }
            if self.no_bodies {
                let message = "the file does not say which vertices belong to bodies";
                return Err(wrong(message, FOLDER));
            }
            let trajectory = Trajectory::read(&self.input).map_err(|e| input(&e))?;
            let trajectory = self.at_rate(trajectory)?;
            let series = Series::new(&trajectory, &self.series_options()?);
            let series = series.map_err(|e| failed(&e, Code::Input))?;
            return self.write_run(&series, &trajectory, None);
        }
        self.check_input()?;
        let of_runs = [
            ("--frames", self.frames.is_some(), "chooses frames"),
            ("--every", self.every.is_some(), "chooses frames"),
            ("--fps", self.fps.is_some(), "chooses frames"),
            ("--no-bodies", self.no_bodies, "leaves out bodies"),
            (
                self.one.of_run().unwrap_or_default(),
                self.one.of_run().is_some(),
                "chooses a frame",
            ),
        ];
        if let Some((option, _, what)) = of_runs.iter().find(|(_, given, _)| *given) {
            let message = format!("{option} {what} of a run, and a mesh file has none");
            return Err(wrong(&message, "leave it out"));
        }
        self.check_look()?;
        let options = MeshOptions {
            weld: self.weld,
            frame: self.one.of_file()?,
            ..MeshOptions::default()
        };
        let mesh = read_mesh_with(&self.input, &options).map_err(|e| match e.problem {
            MeshFileProblem::Options(_) => Failure::of(Code::CommandLine, &e),
            _ => input(&e),
        })?;
        self.write_mesh(mesh)
    }

    /// Converts the folder of a run.
    fn convert_run(&self) -> Done {
        let mut recording = Recording::read(&self.input).map_err(Failure::from)?;
        recording.trajectory = self.at_rate(recording.trajectory)?;
        if self.no_bodies {
            recording.leave_out_bodies();
        }
        if let Some(format) = PictureFormat::of(self.output()) {
            return self.write_pictures(&recording, format);
        }
        if self
            .output()
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("svg"))
        {
            return layers::write(&recording, self.output());
        }
        // An archive is that of the run, which has them where its scene asks for them.
        let is_asked = recording.scene.scene().output.curvature;
        let has_rulings = |extension: &OsStr| {
            let is = |e: &str| extension.eq_ignore_ascii_case(e);
            is("pvd") || is("npz") && is_asked
        };
        if self.output().extension().is_some_and(has_rulings) {
            recording.add_rulings();
        }
        let series = recording.series(&self.series_options()?);
        let series = series.map_err(|e| failed(&e, Code::Input))?;
        let folding = recording.scene.scene().folding.as_ref();
        self.write_run(&series, &recording.trajectory, folding)
    }

    /// The chosen part of a motion at the rate that was asked for.
    fn at_rate(&self, trajectory: Trajectory) -> Result<Trajectory, Failure> {
        match self.fps {
            Some(rate) if !trajectory.is_empty() => {
                let range = self.frames.unwrap_or_default().of(trajectory.len());
                let changed = trajectory.at_rate(rate, range);
                changed.map_err(|e| Failure::of(Code::CommandLine, &e))
            }
            _ => Ok(trajectory),
        }
    }

    /// The frames that are chosen of a motion; all of one whose rate was changed.
    fn range(&self) -> FrameRange {
        match self.fps {
            Some(_) => FrameRange::default(),
            None => self.frames.unwrap_or_default(),
        }
    }

    fn every(&self) -> usize {
        let every = self.every.map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        every.unwrap_or(1)
    }

    /// Refuses options of pictures for other files.
    fn check_look(&self) -> Result<(), Failure> {
        let options = [
            ("--size", self.size.is_some()),
            ("--view", self.view.is_some()),
            ("--plain", self.plain),
            ("--colour", self.colour.is_some()),
        ];
        match options.iter().find(|(_, given)| *given) {
            Some((option, _)) => Err(wrong(
                &format!("{option} is for pictures and films of runs: .png, .apng, .mp4"),
                "leave it out",
            )),
            None => Ok(()),
        }
    }

    /// Refuses an output that would replace what is read: the file itself, or a file of the run. Other files
    /// are replaced.
    fn check_output(&self) -> Result<(), Failure> {
        let (input, output) = (&self.input, self.output());
        let (is_run, name) = (input.is_dir(), output.display());
        let folder = output.with_extension("");
        let gets_frames =
            |own: &Path| is_run && self.is_folder_written() && is_same_file(own, &folder);
        let message = if is_same_file(input, output) {
            let what = if is_run { "folder" } else { "file" };
            format!("{name} is the {what} that is read")
        } else if gets_frames(input) {
            "the files of single frames would be written into the folder of the run".to_owned()
        } else if gets_frames(&input.join("obj")) {
            "the files of single frames would replace files of the run itself".to_owned()
        } else {
            return refuse_file_of_run(output);
        };
        Err(wrong(&message, "choose another name"))
    }

    /// Whether the files of single frames go to a folder with the name of the output.
    fn is_folder_written(&self) -> bool {
        let extension = self.output().extension().unwrap_or_default();
        let has_folder = ["obj", "pvd"]
            .iter()
            .any(|e| extension.eq_ignore_ascii_case(e));
        let is_many = self.frames.is_some() || self.every.is_some() || self.fps.is_some();
        let is_picture = extension.eq_ignore_ascii_case("png");
        has_folder && !self.one.is_asked_for() || is_picture && is_many
    }

    /// Refuses files of a run and scenes, of which a user means the run.
    fn check_input(&self) -> Result<(), Failure> {
        let name = self.input.display();
        let folder = self.input.parent().unwrap_or(Path::new(""));
        let is_mesh = MeshFormat::of(&self.input).is_some();
        if !is_mesh && self.input.is_file() && folder.join("run.lock").is_file() {
            let message = format!("{name} is a file of a run, and no mesh");
            let remedy = format!("name its folder, {}", folder.display());
            return Err(Failure::new(Code::Input, message).remedy(remedy));
        }
        if is_scene(&self.input) && self.input.is_file() {
            let message = format!("{name} is a scene, and no mesh");
            let remedy =
                format!("run it, `isosheet simulate {name}`, and convert the folder of the run");
            return Err(Failure::new(Code::Input, message).remedy(remedy));
        }
        Ok(())
    }

    fn series_options(&self) -> Result<SeriesOptions, Failure> {
        if self.weld.is_some() {
            return Err(weld_of_run());
        }
        self.check_look()?;
        let range = self.range();
        Ok(SeriesOptions {
            first: range.first.unwrap_or(0),
            last: range.last,
            every: self.every(),
            rate: self.fps.unwrap_or(SeriesOptions::default().rate),
        })
    }

    fn write_pictures(&self, recording: &Recording, format: PictureFormat) -> Done {
        if self.weld.is_some() {
            return Err(weld_of_run());
        }
        if self.is_changed() {
            let message = "--scale and --thickness are for meshes, and a picture is none";
            return Err(wrong(message, "leave them out"));
        }
        let is_many = self.frames.is_some() || self.every.is_some() || self.fps.is_some();
        let count = recording.trajectory.len();
        let folding = recording.scene.scene().folding.as_ref();
        let choice = match self.one.of(&recording.trajectory, folding)? {
            Some(frame) => FrameChoice::One(frame),
            None if is_many || format != PictureFormat::Png => {
                let [first, last] = self.range().of(count);
                let is_free = self.every.is_none() && self.fps.is_none();
                let every = match format {
                    PictureFormat::AnimatedPng if is_free => {
                        pictures::shown_by_browsers(recording.trajectory.times())
                    }
                    _ => self.every(),
                };
                FrameChoice::Many { first, last, every }
            }
            None => FrameChoice::One(count.saturating_sub(1)),
        };
        let mut options = FilmOptions::default();
        if let Some(size) = self.size {
            (options.width, options.height) = (size.width, size.height);
        }
        options.view = self.view.map(|View(view)| view);
        options.colour = self.colour.clone();
        options.range = self.range.map(|ColourRange(range)| range);
        if self.plain {
            options.marks = Marks::Nothing;
        }
        pictures::write(recording, choice, format, &options, self.output())
    }

    fn write_run(
        &self,
        series: &Series<'_>,
        trajectory: &Trajectory,
        folding: Option<&Folding>,
    ) -> Done {
        if let Some(frame) = self.one.of(trajectory, folding)? {
            let mesh = series.mesh(frame).map_err(|e| failed(&e, Code::Input))?;
            if self.is_changed() {
                return self.write_mesh(mesh);
            }
            write_frame(self.output(), series, frame).map_err(|e| no_mesh(&e))?;
            return self.say_mesh(&mesh);
        }
        if self.is_changed() {
            let message = "--scale and --thickness are for one mesh, and a run has many frames";
            return Err(wrong(message, ONE_FRAME));
        }
        let has_one_mesh = ["stl", "off", "ply"];
        let extension = self.output().extension().unwrap_or_default();
        if has_one_mesh
            .iter()
            .any(|e| extension.eq_ignore_ascii_case(e))
        {
            let message = format!(
                "a .{} file has one mesh, and the run has {}",
                extension.display(),
                counted(trajectory.len(), "frame", "frames")
            );
            return Err(wrong(&message, ONE_FRAME));
        }
        let Exported {
            files,
            frames,
            removed,
        } = write_series(self.output(), series).map_err(|error| {
            let failure = failed(&error, Code::Output);
            match error {
                ExportError::Extension { .. } if is_unknown(&error) => failure.remedy(
                    "choose a known format, or .png or .apng for pictures of the folder of a run",
                ),
                _ => failure,
            }
        })?;
        let is_sequence = files.len() == frames.len() && files.len() > 1;
        let names = match &files[..] {
            [first, .., last] if is_sequence => {
                let last = last.file_name().unwrap_or_default().display();
                format!("{} to {last}", first.display())
            }
            [others @ .., last] if !others.is_empty() => {
                let more = counted(others.len(), "more file", "more files");
                format!("{} and {more}", last.display())
            }
            _ => last(&files).display().to_string(),
        };
        let chosen = match series.frames().len() {
            all if all > frames.len() => {
                format!(" of {all} (this format takes at most {MOST_KEY_FRAMES})")
            }
            _ => String::new(),
        };
        let count = counted(frames.len(), "frame", "frames");
        let removed = pictures::removed_in_words(removed);
        to_stdout(&format!("{names}: {count}{chosen}{removed}\n"))
    }

    /// Whether a mesh is to be made larger or thicker.
    fn is_changed(&self) -> bool {
        self.scale.is_some() || self.thickness.is_some()
    }

    /// Writes a mesh, larger and thicker as it is asked for.
    fn write_mesh(&self, mut mesh: MeshFile) -> Done {
        let has_no_unit = [
            MeshFormat::Stl,
            MeshFormat::Obj,
            MeshFormat::Off,
            MeshFormat::Ply,
        ];
        let format = MeshFormat::of(self.output());
        if self.is_changed() && !format.is_some_and(|format| has_no_unit.contains(&format)) {
            let message = "--scale and --thickness are for meshes as .stl, .obj, .off and .ply";
            return Err(wrong(
                message,
                "choose one of these formats, or leave them out",
            ));
        }
        if let Some(thickness) = self.thickness {
            let solid = thickened(&mesh, thickness.metres);
            mesh = solid.map_err(|e| failed(&e, Code::CommandLine))?;
        }
        if let Some(scale) = self.scale {
            if !(scale > 0.0 && scale.is_finite()) {
                let message = format!("the scale is {}", given(scale));
                return Err(wrong(&message, "give a positive, finite factor"));
            }
            mesh.positions.iter_mut().for_each(|c| *c *= scale);
        }
        write_mesh(self.output(), &mesh).map_err(|e| no_mesh(&e))?;
        self.say_mesh(&mesh)
    }

    fn say_mesh(&self, mesh: &MeshFile) -> Done {
        let polygons = match mesh.polygons {
            0 => String::new(),
            n => format!(", {} cut into triangles", counted(n, "polygon", "polygons")),
        };
        let did = mesh.what_reading_did();
        let changes = did.map_or(String::new(), |did| format!(", {did}"));
        to_stdout(&format!(
            "{}: {} and {}{polygons}{changes}\n",
            self.output().display(),
            counted(mesh.vertex_count(), "vertex", "vertices"),
            counted(mesh.faces.len(), "face", "faces")
        ))
    }
}

/// What to do where a trajectory alone is not enough.
const FOLDER: &str = "name the folder of the run";

/// What to do where one frame is needed.
const ONE_FRAME: &str = "choose one, with `--frame last`, `--frame K`, `--time T` or `--part P`; or write .obj, a folder with a mesh for each frame";

/// The file that was asked for.
fn last(files: &[PathBuf]) -> &Path {
    files.last().map_or(Path::new(""), PathBuf::as_path)
}

fn weld_of_run() -> Failure {
    let message = "--weld is for mesh files, and the vertices of a run are shared already";
    wrong(message, "leave it out")
}

/// Whether nothing better is known to do about an error than to choose another format.
fn is_unknown(error: &ExportError) -> bool {
    error.advice() == Some("choose a known format")
}

/// Why a mesh is not written.
fn no_mesh(error: &ExportError) -> Failure {
    let failure = failed(error, Code::Output);
    match error {
        ExportError::Extension { .. } if is_unknown(error) => failure.remedy(
            "choose a known format; pictures and the formats of moving sheets are made of the folder of a run",
        ),
        _ => failure,
    }
}

/// The failure of an export: of what the command line asks for, or else with the given code.
fn failed(error: &ExportError, otherwise: Code) -> Failure {
    let code = match error {
        ExportError::Extension { .. } | ExportError::Frames(_) => Code::CommandLine,
        _ => otherwise,
    };
    Failure::of(code, error)
}
