//! `isosheet mesh`.

use super::failure::{Code, Done, Failure};
use super::info::refuse_folder;
use super::message::counted;
use super::strip;
use super::write::{is_same_file, to_stdout};
use clap::Args;
use isosheet_drawings::{
    DrawingOptions, DrawingUnit, Length, LineClass, LineRules, Selector, read_drawing,
};
use isosheet_formats::{DrawingError, DrawnSheet, ExportError, MeshFile, MeshFormat, write_mesh};
use isosheet_mesh::plane::PlaneError;
use isosheet_mesh::wording::given;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  isosheet mesh box.svg -o box.fold --spacing 5mm
                    black lines are cut, red ones mountains, blue ones valleys, as in Origami Simulator
  isosheet mesh card.dxf -o card.fold --spacing 2mm --cut layer:KNIFE --crease layer:RULE
                    the lines of two layers; `isosheet mesh` says what it took for what
  isosheet mesh tray.svg -o tray.fold --spacing 4mm --cut magenta --crease dashed --snap 0.2mm
                    by colour and dash, and lines joined that leave gaps of up to 0.2 mm
  isosheet mesh lower.csv --strip-to upper.csv --columns 60 -o strip.obj
                    the developable strip between two curves";

const LINES: &str = "\
Which lines are what:
  layer:NAME        lines in a layer or group of this name, or with this name
  red, #ff8000      lines of a colour: black, white, grey, red, yellow, green, cyan, blue, magenta and their
                    shades, or exactly the one that is given by its digits
  dashed, solid     lines with dashes and without
A layer counts before a colour, and that before dashes. What no option names goes by the words in the name of its
layer (cut, outline, crease, fold, score, perf, mountain, valley, facet, dimension ...), then by its colour: black and
green are cut, red is a mountain, blue a valley, magenta a crease of either side, yellow stays flat, white is left
out; black dashes are creases. A mountain or valley that is half transparent folds by 90 degrees.

The sheet is what the cuts bound. Outlines within outlines are holes, cuts that end inside are slits, and creases end
where the sheet does.

A curve for a strip is a file with a point on each line, x, y and z, or an OBJ file with a line. The strip is in space,
and `isosheet unroll` lays it out in the plane.

Files that are read: .svg, .dxf (text)
Files that are written: .fold has the creases; .obj .off .ply .stl .glb .usda have the mesh alone
docs/drawing.md says more.";

/// Make a triangle mesh of a drawing, with its creases, cuts and holes
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES, after_help = LINES)]
pub(crate) struct MeshArgs {
    /// A drawing (.svg, .dxf), or with --strip-to a file with the points of a curve
    drawing: PathBuf,
    /// The mesh to write, or to replace; its extension says the format, and .fold has the creases
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// Length of the edges of the mesh, about, such as 5mm; metres without a unit
    #[arg(
        long,
        value_name = "LENGTH",
        allow_hyphen_values = true,
        required_unless_present = "strip_to"
    )]
    spacing: Option<Length>,
    /// Make the developable strip from the curve to that in this file
    #[arg(
        long,
        value_name = "FILE",
        requires = "columns",
        conflicts_with_all = ["spacing", "snap", "cut", "crease", "mountain", "valley", "flat", "ignore"]
    )]
    strip_to: Option<PathBuf>,
    /// Of a strip, the number of cells along the curves
    #[arg(long, value_name = "N", requires = "strip_to")]
    columns: Option<usize>,
    /// Of a strip, the number of cells across
    #[arg(long, value_name = "N", requires = "strip_to", default_value_t = 1)]
    rows: usize,
    /// Join ends of lines that are at most so far apart, and lines that run along each other as near as this
    /// [default: a ten-thousandth of the diagonal of the drawing]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    snap: Option<Length>,
    /// The length that a unit of the drawing means: m, cm, mm, in, pt or px [default: what the file says, or
    /// m for curves]
    #[arg(long)]
    unit: Option<DrawingUnit>,
    /// Make the drawing larger by this factor
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        allow_hyphen_values = true
    )]
    scale: f64,
    /// Lines where the sheet ends or is cut
    #[arg(long, value_name = "LINES")]
    cut: Vec<Selector>,
    /// Lines where it folds to either side
    #[arg(long, value_name = "LINES")]
    crease: Vec<Selector>,
    /// Lines where it folds away from the viewer
    #[arg(long, value_name = "LINES")]
    mountain: Vec<Selector>,
    /// Lines where it folds towards the viewer
    #[arg(long, value_name = "LINES")]
    valley: Vec<Selector>,
    /// Lines that edges follow, and that stay flat
    #[arg(long, value_name = "LINES")]
    flat: Vec<Selector>,
    /// Lines that are left out
    #[arg(long, value_name = "LINES")]
    ignore: Vec<Selector>,
    /// Another number gives another triangulation
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

impl MeshArgs {
    pub(crate) fn run(&self) -> Done {
        refuse_folder(&self.drawing)?;
        let name = self.out.display();
        if is_same_file(&self.drawing, &self.out) {
            let message = format!("{name} is the file that is read");
            return Err(Failure::misuse(message).remedy("choose another name"));
        }
        if let Some(second) = &self.strip_to {
            return self.make_strip(second);
        }
        let made = DrawnSheet::read(&self.drawing, &self.options()).map_err(|e| self.failed(&e))?;
        self.write(&made.mesh)?;
        let [w, h] = made.report.size.map(|metres| Length { metres });
        let no_creases = match MeshFormat::of(&self.out) {
            Some(MeshFormat::Fold) => "",
            _ => {
                "note: this format has the edges along creases, but not which they are: .fold has\n"
            }
        };
        to_stdout(&format!(
            "{name}: {} and {}, {w} by {h}\n{}{no_creases}",
            counted(made.mesh.vertex_count(), "vertex", "vertices"),
            counted(made.mesh.faces.len(), "face", "faces"),
            made.report
        ))
    }

    fn write(&self, mesh: &MeshFile) -> Done {
        write_mesh(&self.out, mesh).map_err(|error| {
            let code = match error {
                ExportError::Extension { .. } => Code::CommandLine,
                _ => Code::Output,
            };
            Failure::of(code, &error)
        })
    }

    /// Makes the strip between two curves.
    fn make_strip(&self, second: &Path) -> Done {
        let name = self.out.display();
        if is_same_file(second, &self.out) {
            let message = format!("{name} is a file that is read");
            return Err(Failure::misuse(message).remedy("choose another name"));
        }
        if !(self.scale > 0.0 && self.scale.is_finite()) {
            let message = format!("the scale is {}", given(self.scale));
            return Err(Failure::misuse(message).remedy("give a positive, finite one"));
        }
        let metres = self.scale * self.unit.map_or(1.0, |unit| unit.metres(1.0));
        let cells = [self.columns.unwrap_or_default(), self.rows];
        let strip = strip::strip([&self.drawing, second], metres, cells)?;
        let sheet = &strip.sheet;
        self.write(&MeshFile::of_frame(
            sheet.positions().to_vec(),
            sheet.face_indices(),
            Vec::new(),
        ))?;
        let t = sheet.topology();
        to_stdout(&format!(
            "{name}: {} and {}, {}\n{}\n",
            counted(t.vertex_count(), "vertex", "vertices"),
            counted(t.face_count(), "face", "faces"),
            counted(strip.rulings.len(), "ruling", "rulings"),
            strip::verdict(&strip)
        ))
    }

    fn options(&self) -> DrawingOptions {
        let selected = [
            (&self.cut, LineClass::Cut),
            (&self.crease, LineClass::Crease),
            (&self.mountain, LineClass::Mountain),
            (&self.valley, LineClass::Valley),
            (&self.flat, LineClass::Flat),
            (&self.ignore, LineClass::Ignored),
        ];
        let selectors = selected
            .into_iter()
            .flat_map(|(selectors, class)| selectors.iter().map(move |s| (s.clone(), class)));
        DrawingOptions {
            snap: self.snap.map(|length| length.metres),
            unit: self.unit,
            scale: self.scale,
            rules: LineRules {
                selectors: selectors.collect(),
            },
            seed: self.seed,
            ..DrawingOptions::with_spacing(self.spacing.map_or(0.0, |length| length.metres))
        }
    }

    /// A tolerance that makes a sheet of a drawing with this fault.
    fn helping_snap(&self, error: &DrawingError) -> Option<f64> {
        let is_of_ends = match error {
            DrawingError::Plane(error) => {
                matches!(error, PlaneError::Open { .. } | PlaneError::Touching { .. })
            }
            DrawingError::Crossing(_) => true,
            _ => false,
        };
        let options = self.options();
        let drawing = is_of_ends.then(|| read_drawing(&self.drawing, &options))?;
        DrawnSheet::helping_snap(&drawing.ok()?, &options)
    }

    fn failed(&self, error: &DrawingError) -> Failure {
        let code = match error {
            DrawingError::Data(e) if e.value.is_some() => Code::CommandLine,
            DrawingError::Plane(PlaneError::TooManyFaces { .. }) => Code::CommandLine,
            _ => Code::Input,
        };
        let failure = Failure::of(code, error);
        if let Some(snap) = self.helping_snap(error) {
            return failure.remedy(format!(
                "`--snap {}` joins what nearly meets, and makes a sheet of this drawing: look whether it is the right one",
                Length { metres: snap }.to_string().replace(' ', "")
            ));
        }
        match error {
            DrawingError::Plane(PlaneError::Open { .. }) => failure.remedy(
                "close the outline there, give `--snap` a length of at least the gap, or leave out lines that are no \
                 outline by `--ignore`",
            ),
            _ => failure,
        }
    }
}
