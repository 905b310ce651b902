//! `isosheet unroll`.

mod folds;
mod report;
mod rulings;
mod strokes;

use super::failure::{Code, Done, Failure};
use super::info::refuse_folder;
use super::reading::what_reading_did;
use super::write::{is_same_file, refuse_file_of_run, to_stdout};
use clap::Args;
use isosheet_coords::{UnrollError, UnrollOptions, unroll};
use isosheet_drawings::{DrawingFormat, DrawingUnit, Length, write_drawing};
use isosheet_formats::{
    ExportError, ExportMeshFormat, FoldFrame, MeshFile, MeshFileProblem, MeshOptions,
    read_mesh_with, write_pattern,
};
use isosheet_mesh::wording::{brief, given};
use isosheet_mesh::{EdgeId, Opened, Sheet, VertexId, fold_angle};
use std::path::PathBuf;
use std::str::FromStr;

const EXAMPLES: &str = "\
Examples:
  isosheet unroll cone.obj -o cone.svg         lay a mesh out in the plane, in millimetres for a cutter
  isosheet unroll box.stl -o box.dxf --unit mm
                                               of a file whose unit is the millimetre
  isosheet unroll cube.obj -o cube.svg --cut 0-1,1-3
                                               cut it along these edges first
  isosheet unroll hull.ply -o hull.fold --strain 0.01
                                               accept edges that are longer or shorter by 1 %";

const NOTES: &str = "\
A part that is no disk is cut open along short edges, creases before others and plane faces last, and cut to its corners:
vertices whose angles lack more than a strain makes up for, on creases or alone. Then all edges get their lengths in the
plane. Where the surface is not developable the edges are strained, as little as possible in the mean of the squares.
More than the limit of --strain is refused, with the vertex that has the largest angle deficit. A piece that would lie on
itself is cut further.

Files that are read: all mesh files that `isosheet convert` reads; vertices count from 0
Files that are written:
  .svg, .dxf       drawings in millimetres: layers cut, mountain, valley and crease; rulings on the layer guide, not to cut.
                   In SVG files the opacity of a crease is its angle as a part of 180 degrees
  .fold            the flat mesh with the fold angle of each edge, and as its second frame the mesh in space
  .obj .off .ply .stl .glb .usda
                   the flat mesh alone, in metres
docs/unroll.md says more.";

/// Two vertices of a mesh with an edge between them.
#[derive(Clone, Copy, Debug)]
struct Ends([u32; 2]);

impl FromStr for Ends {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ends = text
            .split_once('-')
            .map(|(a, b)| [a, b].map(|v| v.trim().parse().ok()));
        match ends {
            Some([Some(a), Some(b)]) => Ok(Self([a, b])),
            _ => Err(format!(
                "{text:?} is no edge: name the vertices at its ends, as 3-7"
            )),
        }
    }
}

/// Lay a mesh out in the plane as a pattern to cut
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES, after_help = NOTES)]
pub(crate) struct Unroll {
    /// A mesh (OBJ, OFF, STL, PLY, FOLD, glTF, VTK) or a crease pattern (SVG, CP, OPX)
    mesh: PathBuf,
    /// The file to write, or to replace; its extension says the format
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// Cut along these edges in any case: vertices A and B, which count from 0
    #[arg(long, value_name = "A-B", value_delimiter = ',')]
    cut: Vec<Ends>,
    /// The largest strain of an edge in the plane that is accepted
    #[arg(long, value_name = "LIMIT", default_value_t = UnrollOptions::default().strain, allow_negative_numbers = true)]
    strain: f64,
    /// Folds by this angle or more are creases: they are drawn, and cut before other edges
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = 30.0,
        allow_negative_numbers = true
    )]
    crease_angle: f64,
    /// The distance between pieces, such as 5mm; metres without a unit [default: a twentieth of the longest
    /// side of a piece]
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    gap: Option<Length>,
    /// The length that a unit of the file means: m, cm, mm, in, pt or px [default: what the file says, or m]
    #[arg(long)]
    unit: Option<DrawingUnit>,
    /// Make the sheet larger by this factor
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        allow_negative_numbers = true
    )]
    scale: f64,
    /// Draw no rulings
    #[arg(long)]
    no_rulings: bool,
    /// Make vertices one that are at most T apart, in the unit of the file [default: 0 for STL and glTF, no
    /// welding for others]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    weld: Option<f64>,
    /// Of a FOLD file, read frame K (from 0)
    #[arg(long, value_name = "K")]
    frame: Option<usize>,
}

impl Unroll {
    pub(crate) fn run(&self) -> Done {
        self.check_files()?;
        let options = MeshOptions {
            weld: self.weld,
            frame: self.frame.map(FoldFrame::Number),
            ..MeshOptions::default()
        };
        let mut mesh = read_mesh_with(&self.mesh, &options).map_err(|e| {
            let code = match e.problem {
                MeshFileProblem::Options(_) => Code::CommandLine,
                _ => Code::Input,
            };
            Failure::of(code, &e)
        })?;
        let size = self.size(&mesh)?;
        mesh.positions.iter_mut().for_each(|c| *c *= size);
        let opened = Opened::surface(&mesh.faces);
        let sheet = self.sheet(&mesh, &opened)?;
        let options = UnrollOptions {
            strain: self.strain,
            crease: self.crease_angle.to_radians(),
            cuts: self.cuts(&opened, &sheet)?,
            gap: self.gap.map(|gap| gap.metres),
        };
        let number = |v: VertexId| VertexId(opened.origins[v.index()]);
        let unrolled = unroll(&sheet, &options).map_err(|e| {
            let fold = match &e {
                UnrollError::Curved { vertex, .. } => largest_fold(&sheet, *vertex),
                _ => 0.0,
            };
            failed(e.numbered(number), fold)
        })?;
        let folds = folds::folds(&mesh, &opened.origins, &sheet, &unrolled, options.crease);
        let mut rulings = None;
        if DrawingFormat::of(&self.out).is_some() {
            let mut lines = Vec::new();
            if !self.no_rulings {
                lines = rulings::rulings(&sheet, &unrolled, &folds);
                rulings = Some(lines.len());
            }
            lines.extend(strokes::creases(&unrolled.flat, &folds));
            lines.extend(strokes::outlines(&unrolled.flat));
            write_drawing(&self.out, &lines).map_err(|e| Failure::of(Code::Output, &e))?;
        } else {
            let pattern = folds::pattern(&unrolled, &folds);
            let folded = unrolled.vertices.iter().flat_map(|v| sheet.position(*v));
            let folded: Vec<f64> = folded.collect();
            write_pattern(&self.out, &pattern, &folded).map_err(|error| {
                let code = match error {
                    ExportError::Extension { .. } => Code::CommandLine,
                    _ => Code::Output,
                };
                Failure::of(code, &error)
            })?;
        }
        let report = report::Report {
            out: &self.out,
            opened: &opened,
            given: &sheet,
            unrolled: &unrolled,
            folds: &folds,
            rulings,
            options: &options,
            unit_is_assumed: !mesh.in_metres && self.unit.is_none(),
        };
        to_stdout(&format!("{}{}", what_reading_did(&mesh), report.text()))
    }

    /// Refuses files that cannot be read or written, before anything is computed.
    fn check_files(&self) -> Done {
        refuse_folder(&self.mesh)?;
        let name = self.out.display();
        if is_same_file(&self.mesh, &self.out) {
            let message = format!("{name} is the file that is read");
            return Err(Failure::misuse(message).remedy("choose another name"));
        }
        refuse_file_of_run(&self.out)?;
        let extension = self.out.extension().unwrap_or_default();
        let is = |f: &ExportMeshFormat| extension.eq_ignore_ascii_case(f.extension());
        if DrawingFormat::of(&self.out).is_none() && !ExportMeshFormat::ALL.iter().any(is) {
            let known = ExportMeshFormat::ALL.map(|f| format!(".{}", f.extension()));
            let message = format!(
                "{name} names no format that can be written here (known are .svg, .dxf, {})",
                known.join(", ")
            );
            return Err(Failure::misuse(message).remedy("choose a known format"));
        }
        Ok(())
    }

    /// Metres of a unit of the mesh, times the scale.
    fn size(&self, mesh: &MeshFile) -> Result<f64, Failure> {
        if !(self.scale > 0.0 && self.scale.is_finite()) {
            let message = format!("the scale is {}", given(self.scale));
            return Err(Failure::misuse(message).remedy("give a positive, finite one"));
        }
        match self.unit {
            Some(_) if mesh.in_metres => {
                let message = format!("{} says how long its unit is", self.mesh.display());
                Err(Failure::misuse(message).remedy("leave out --unit, or give --scale"))
            }
            unit => Ok(self.scale * unit.map_or(1.0, |unit| unit.metres(1.0))),
        }
    }

    /// The mesh as an oriented surface.
    fn sheet(&self, mesh: &MeshFile, opened: &Opened) -> Result<Sheet, Failure> {
        let count = mesh.vertex_count();
        let name = self.mesh.display();
        let place = |v: &u32| {
            let place = mesh.positions.as_chunks::<3>().0.get(*v as usize);
            place.copied().ok_or(*v)
        };
        let places: Result<Vec<[f64; 3]>, u32> = opened.origins.iter().map(place).collect();
        let places = places.map_err(|v| {
            let message = format!("{name}: a face refers to vertex {v}, and there are {count}");
            Failure::new(Code::Input, message).remedy("correct the file")
        })?;
        Sheet::new(places.concat(), &opened.faces).map_err(|e| {
            let remedy = format!("`isosheet check {name}` says more");
            Failure::new(Code::Input, format!("{name}: {e}")).remedy(remedy)
        })
    }

    /// The edges of the sheet that are to be cut.
    fn cuts(&self, opened: &Opened, sheet: &Sheet) -> Result<Vec<EdgeId>, Failure> {
        let t = sheet.topology();
        let mut cuts = Vec::new();
        for Ends([a, b]) in &self.cut {
            let before = cuts.len();
            // Where the surface was cut already, several vertices have the number of one.
            let first = opened.origins.partition_point(|v| v < a);
            let own = opened.origins[first..].iter().take_while(|v| *v == a);
            for v in (first..first + own.count()).map(VertexId::from_index) {
                let ends = t.vertex_edges(v).iter();
                cuts.extend(ends.filter(|e| opened.origins[t.other_end(**e, v).index()] == *b));
            }
            if cuts.len() == before {
                let message = format!("no edge joins the vertices {a} and {b}");
                let remedy = "name two vertices of one face; they count from 0";
                return Err(Failure::misuse(message).remedy(remedy));
            }
        }
        Ok(cuts)
    }
}

/// The largest fold of the edges at a vertex, radians.
fn largest_fold(sheet: &Sheet, v: VertexId) -> f64 {
    let t = sheet.topology();
    let folds = t
        .vertex_edges(v)
        .iter()
        .filter_map(|e| fold_angle(t, sheet.positions(), *e));
    folds.fold(0.0, |m, angle| m.max(angle.abs()))
}

/// A sheet that cannot be unrolled; `fold` is the largest one, radians, at the vertex with the largest
/// deficit.
fn failed(error: UnrollError, fold: f64) -> Failure {
    match error {
        UnrollError::Option { .. } => Failure::of(Code::CommandLine, &error),
        UnrollError::Curved {
            ends,
            vertex,
            strain,
            ..
        } => {
            let degrees = rounded(fold.to_degrees(), f64::floor);
            let mut remedy = format!(
                "cut the sheet at {vertex} by `--cut A-B,...`, or let cuts lead to it and to others on folds by \
                 {degrees} degrees or more by `--crease-angle {degrees}`"
            );
            if strain.abs() < 1.0 {
                let accepted = rounded(strain.abs(), f64::ceil);
                let [a, b] = ends.map(|v| v.0);
                remedy +=
                    &format!(", or accept the strain of edge {a}-{b} by `--strain {accepted}`");
            }
            Failure::of(Code::Input, &error).remedy(remedy)
        }
        error => Failure::of(Code::Input, &error),
    }
}

/// A positive number with two digits.
fn rounded(value: f64, round: fn(f64) -> f64) -> String {
    let digit = 10_f64.powf(value.log10().floor() - 1.0);
    match value > 0.0 {
        true => brief(round(value / digit) * digit).to_string(),
        false => "0".to_owned(),
    }
}
