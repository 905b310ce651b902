//! `isosheet check`.

use super::failure::{Code, Done, Failure};
use super::info::{describe_scene, is_scene, refuse_edits, refuse_folder};
use super::message::{counted, print_warnings};
use super::reading::what_reading_did;
use super::write::{is_same_file, to_stdout};
use clap::Args;
use isosheet_formats::{
    MeshFile, MeshFileError, MeshFileProblem, MeshOptions, Polygons, read_mesh_with, write_mesh,
};
use isosheet_mesh::{Advice, Sheet};
use isosheet_runs::Estimate;
use isosheet_scenes::{SceneFile, Warning};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  isosheet check cloth.toml                        whether the scene can start, and what is wrong if it cannot
  isosheet check cloth.toml --set stop.time=2      the same with another value of a key
  isosheet check soup.obj                          whether the mesh is a sheet
  isosheet check soup.obj --fix -o sheet.obj       repair it";

/// Say what a scene or a mesh file is, what is wrong with it and how to repair it
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES)]
pub(crate) struct Check {
    /// A scene (.toml) or a mesh (OBJ, OFF, STL, PLY, FOLD, glTF, VTK) or a crease pattern (SVG, CP, OPX)
    file: PathBuf,
    /// Of a scene, change a key before, as `isosheet simulate` does
    #[arg(long = "set", value_name = "KEY=VALUE")]
    edits: Vec<String>,
    /// Of a mesh, repair what can be repaired, and write it to the file of --out
    #[arg(long, requires = "out")]
    fix: bool,
    /// The file to write the repaired mesh to, in the format of its extension
    #[arg(short, long, value_name = "FILE", requires = "fix")]
    out: Option<PathBuf>,
}

impl Check {
    pub(crate) fn run(&self) -> Done {
        if !is_scene(&self.file) {
            return self.check_mesh();
        }
        if self.fix {
            let message = "--fix repairs mesh files, and this is a scene";
            return Err(Failure::misuse(message).remedy("correct a scene by hand"));
        }
        let scene = SceneFile::read(&self.file, &self.edits)?;
        let setup = scene.build()?;
        let text = describe_scene(&setup);
        let (estimate, folder) = (Estimate::of(scene.scene(), &setup), Path::new("."));
        let warnings = [setup.warnings(), estimate.warnings(folder)].concat();
        estimate.check(&scene, folder)?;
        setup.start()?;
        to_stdout(&format!(
            "{}: a scene that can start\n{text}a run            {estimate}\n",
            self.file.display()
        ))?;
        print_warnings(&warnings);
        Ok(())
    }

    fn check_mesh(&self) -> Done {
        refuse_folder(&self.file)?;
        refuse_edits(&self.edits)?;
        let name = self.file.display();
        if let Some(fixed) = &self.out {
            return self.fix_mesh(fixed);
        }
        let mesh = read(&self.file, Polygons::Refuse)?;
        match mesh.clone().into_sheet() {
            Ok(sheet) => {
                let counts = counts(&sheet);
                let changes = what_reading_did(&mesh);
                let merging = what_merging_does(mesh);
                to_stdout(&format!("{name}: a sheet of {counts}\n{changes}{merging}"))?;
                let warnings = [
                    Warning::closed(&sheet, "the surface"),
                    Warning::wide_file(&sheet),
                ];
                print_warnings(&warnings.into_iter().flatten().collect::<Vec<_>>());
                Ok(())
            }
            Err(error) => {
                let remedy = what_repair_does(mesh, &error, &self.file);
                Err(Failure::new(Code::Input, error).remedy(remedy))
            }
        }
    }

    fn fix_mesh(&self, fixed: &Path) -> Done {
        let name = self.file.display();
        if is_same_file(&self.file, fixed) {
            let message = format!("{} is the file that is read", fixed.display());
            return Err(Failure::misuse(message).remedy("choose another name"));
        }
        let given = read(&self.file, Polygons::Triangulate)?;
        let mut mesh = given.clone();
        let repair = mesh
            .repair()
            .map_err(|e| (format!("{name}: {e}"), e.advice()));
        let polygons = match mesh.polygons {
            0 => String::new(),
            n => format!("{} cut into triangles, ", counted(n, "polygon", "polygons")),
        };
        let polygons = match given.what_reading_did() {
            None => polygons,
            Some(did) => format!("{polygons}{did}, "),
        };
        let repaired = repair.and_then(|repair| match mesh.clone().into_sheet() {
            Ok(sheet) => Ok((mesh, sheet, repair.to_string())),
            Err(error) => Err((
                format!("{error} (after the repair: {repair})"),
                error.advice(),
            )),
        });
        // Where parts of a valid sheet touch, merging their vertices may join more than two faces.
        let (mesh, sheet, done) = match (repaired, given.clone().into_sheet()) {
            (Ok(repaired), _) => repaired,
            (Err(_), Ok(sheet)) => {
                let done = "valid as it was; parts that touch stay apart";
                (given, sheet, done.to_owned())
            }
            (Err((message, advice)), Err(_)) => {
                let remedy = advice.unwrap_or("edit the mesh there");
                return Err(Failure::new(Code::Input, message).remedy(remedy));
            }
        };
        write_mesh(fixed, &mesh).map_err(|e| Failure::of(Code::Output, &e))?;
        to_stdout(&format!(
            "{}: a sheet of {} ({polygons}{done})\n",
            fixed.display(),
            counts(&sheet)
        ))
    }
}

/// What a repair would do to a mesh that is a sheet already.
fn what_merging_does(mut mesh: MeshFile) -> String {
    match mesh.repair() {
        Ok(repair) if !repair.is_nothing() => {
            format!("note: `--fix -o FILE2` would join parts that touch: {repair}\n")
        }
        _ => String::new(),
    }
}

fn read(path: &Path, polygons: Polygons) -> Result<MeshFile, Failure> {
    let options = MeshOptions {
        polygons,
        ..MeshOptions::default()
    };
    read_mesh_with(path, &options).map_err(|error| {
        let failure = Failure::of(Code::Input, &error);
        match error.problem {
            MeshFileProblem::Polygon(_) => failure.remedy(
                "of a crease pattern `isosheet fold FILE` keeps the panels flat; `--fix -o FILE2` cuts polygons into \
                 triangles, whose new edges are lines along which the sheet can fold",
            ),
            _ => failure,
        }
    })
}

fn what_repair_does(mut mesh: MeshFile, problem: &MeshFileError, path: &Path) -> String {
    let repair = match mesh.repair() {
        Ok(repair) => repair,
        Err(error) => {
            // What is in the way of a repair is often the problem itself.
            let reason = match problem.to_string().ends_with(&error.to_string()) {
                true => error.advice().unwrap_or("edit the mesh there").to_owned(),
                false => error.with_advice(),
            };
            return format!("this cannot be repaired automatically: {reason}");
        }
    };
    match mesh.into_sheet() {
        Ok(_) => format!(
            "`isosheet check {} --fix -o FILE2` repairs this: {repair}",
            path.display()
        ),
        Err(error) => {
            let error = error.problem.with_advice();
            format!("repair is not enough ({repair}): {error}")
        }
    }
}

fn counts(sheet: &Sheet) -> String {
    let t = sheet.topology();
    let parts = match t.component_count() {
        1 => String::new(),
        n => format!(" in {n} parts"),
    };
    format!(
        "{} and {}{parts}",
        counted(t.vertex_count(), "vertex", "vertices"),
        counted(t.face_count(), "face", "faces")
    )
}
