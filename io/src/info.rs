//! `isosheet info`.

use super::failure::{Code, Done, Failure};
use super::message::{counted, print_warnings};
use super::reading::what_reading_did;
use super::write::to_stdout;
use clap::Args;
use isosheet_dynamics::{SheetModel, rod_rank};
use isosheet_formats::{
    FaceGroups, MeshFile, MeshFileProblem, MeshOptions, Polygons, read_mesh_with,
};
use isosheet_mesh::{Dof, MassKind, Sheet, Topology, VertexId};
use isosheet_runs::Recording;
use isosheet_scenes::{CarriedBody, SceneFile, Setup, bounds};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  isosheet info cloth-run                          how the run ended, or how far it has come
  isosheet info cloth.toml                         counts, degrees of freedom and sizes of the sheet of a scene
  isosheet info cloth.toml --set sheet.mesh.square.level=3
  isosheet info sheet.obj                          the same of a mesh";

/// Say what came of a run, or print counts, degrees of freedom, boundary loops and sizes of a sheet
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES)]
pub(crate) struct Info {
    /// A scene (.toml), a mesh (OBJ, OFF, STL, PLY, FOLD, glTF, VTK), a crease pattern (SVG, CP, OPX) or the
    /// folder of a run
    file: PathBuf,
    /// Of a scene, change a key before, as `isosheet simulate` does
    #[arg(long = "set", value_name = "KEY=VALUE")]
    edits: Vec<String>,
}

/// Whether a file is a scene by its name; everything else is read as a mesh.
pub(crate) fn is_scene(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// Refuses a folder where a file is needed.
pub(crate) fn refuse_folder(path: &Path) -> Done {
    if !path.is_dir() {
        return Ok(());
    }
    let message = format!("{} is a folder", path.display());
    Err(Failure::new(Code::Input, message).remedy("name a scene or a mesh file"))
}

/// Refuses changes of keys where there is no scene to change.
pub(crate) fn refuse_edits(edits: &[String]) -> Done {
    if edits.is_empty() {
        return Ok(());
    }
    let message = "--set changes keys of a scene, and this is none";
    Err(Failure::misuse(message).remedy("leave it out, or name a scene"))
}

impl Info {
    pub(crate) fn run(&self) -> Done {
        if is_scene(&self.file) {
            let setup = SceneFile::read(&self.file, &self.edits)?.build()?;
            to_stdout(&describe_scene(&setup))?;
            print_warnings(&setup.warnings());
            return Ok(());
        }
        refuse_edits(&self.edits)?;
        // Of a folder that is none of a run this says so.
        if self.file.is_dir() {
            return describe_run(&self.file);
        }
        let options = MeshOptions {
            polygons: Polygons::Refuse,
            ..MeshOptions::default()
        };
        let mesh = read_mesh_with(&self.file, &options);
        let changes = mesh.as_ref().map_or(String::new(), what_reading_did);
        let groups = mesh
            .as_ref()
            .map_or(String::new(), |mesh| describe_groups(&mesh.groups));
        let sheet = mesh
            .and_then(MeshFile::into_sheet)
            .map_err(|e| match e.problem {
                MeshFileProblem::Mesh(_) => {
                    let remedy = format!("`isosheet check {}` says more", self.file.display());
                    Failure::new(Code::Input, e).remedy(remedy)
                }
                MeshFileProblem::Polygon(_) => {
                    let remedy = "`isosheet convert` cuts polygons into triangles";
                    Failure::new(Code::Input, e).remedy(remedy)
                }
                _ => Failure::of(Code::Input, &e),
            })?;
        let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped)
            .map_err(|e| Failure::of(Code::Input, &e))?;
        let description = describe_sheet(&sheet, &model, sheet.positions());
        to_stdout(&format!("{description}{groups}{changes}"))
    }
}

/// The groups of faces that a mesh file names.
fn describe_groups(groups: &FaceGroups) -> String {
    let line = |(name, faces): (&str, &[u32])| {
        format!(
            "group            {name}: {}\n",
            counted(faces.len(), "face", "faces")
        )
    };
    groups.iter().map(line).collect()
}

/// Prints what came of a run, and what its scene is like.
fn describe_run(folder: &Path) -> Done {
    let recording = Recording::read(folder)?;
    let facts = recording.facts();
    let width = facts.iter().map(|(name, _)| name.len()).max();
    let lines = facts.iter().map(|(name, value)| {
        let width = width.unwrap_or_default();
        format!("{name:width$}  {value}\n")
    });
    let setup = recording.scene.build()?;
    to_stdout(&format!(
        "{}\n{}\nThe scene:\n{}",
        folder.display(),
        lines.collect::<String>(),
        describe_scene(&setup)
    ))?;
    if let Some(summary) = &recording.summary {
        print_warnings(&summary.warnings());
    }
    Ok(())
}

/// A scene in a few lines.
pub(crate) fn describe_scene(setup: &Setup) -> String {
    let sheet = describe_sheet(&setup.sheets_alone(), &setup.model, &setup.start.x);
    let carriers: Vec<VertexId> = setup
        .bodies
        .iter()
        .flat_map(CarriedBody::vertices)
        .collect();
    let pins = setup.model.pins().into_iter();
    let pins = pins
        .filter(|v| !carriers.contains(v) && !setup.origins.is_driven(*v))
        .count();
    let mass = setup.model.mass().total();
    let modelled = setup.modelled.join(", ");
    let bodies = setup.bodies.iter().map(|body| body.surface());
    let bodies: Vec<_> = bodies.collect();
    let sheets = setup.parts.iter().map(|(name, part)| {
        let mut driven = setup.origins.driven_parts();
        let kind = match bodies.contains(&part.vertices) {
            true => "body",
            false if driven.any(|surface| surface == part) => "obstacle",
            false => "sheet",
        };
        let (v, f) = (&part.vertices, &part.faces);
        let last = [v.end - 1, f.end - 1];
        format!(
            "{kind:<16} {name}: vertices {} to {}, faces {} to {}\n",
            v.start, last[0], f.start, last[1]
        )
    });
    let sheets: String = sheets.collect();
    let material = setup.material.as_ref();
    let material = material.map_or(String::new(), |m| format!("material         {m}\n"));
    format!(
        "{sheet}{sheets}{material}mass             {} kg\npinned vertices  {pins}\nmodelled         {modelled}\n",
        number(mass)
    )
}

/// A sheet at positions `x` in a few lines.
fn describe_sheet(sheet: &Sheet, model: &SheetModel, x: &[f64]) -> String {
    let t = sheet.topology();
    let loops = t.boundary_loops();
    let lengths: Vec<String> = loops.iter().map(|l| l.len().to_string()).collect();
    let [shortest, longest] = [
        sheet
            .lengths()
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min),
        sheet.lengths().iter().copied().fold(0.0, f64::max),
    ];
    let [low, high] =
        bounds(&x.as_chunks::<3>().0[..t.vertex_count()]).map(|corner| corner.map(number));
    format!(
        "vertices         {}, of these {} on the boundary\n\
         edges            {}, {} to {} m long, {} m in the mean\n\
         faces            {}, together {} m2\n\
         components       {}, Euler characteristic {}\n\
         boundary loops   {}{}\n\
         {}\
         bounds           x {} to {}, y {} to {}, z {} to {} m\n",
        t.vertex_count(),
        t.boundary_vertex_count(),
        t.edge_count(),
        number(shortest),
        number(longest),
        number(sheet.mean_length()),
        t.face_count(),
        number(sheet.area()),
        t.component_count(),
        t.euler_characteristic(),
        loops.len(),
        if loops.is_empty() {
            String::new()
        } else {
            format!(", of {} vertices", lengths.join(", "))
        },
        describe_freedom(t, model, x),
        low[0],
        high[0],
        low[1],
        high[1],
        low[2],
        high[2],
    )
}

/// How a sheet at positions `x` may move: with rigid rods, or an elastic one, whose edges may change their
/// lengths.
fn describe_freedom(t: &Topology, model: &SheetModel, x: &[f64]) -> String {
    if model.rod_edges().is_empty() {
        let coordinates = 3 * t.vertex_count();
        return format!("degrees of freedom {coordinates} = 3V, as no edge is a rigid rod\n");
    }
    let Dof {
        total, internal, ..
    } = Dof::of(t);
    let rank = match rod_rank(model, x) {
        Some(rank) => format!(
            "{} as given (rank {} of {} rods, smallest singular value {:.1e})",
            rank.deficiency, rank.rank, rank.rods, rank.smallest
        ),
        None => "not computed as given: a position is not finite".to_owned(),
    };
    format!(
        "degrees of freedom {total} = 3V - E, {internal} besides rigid motions\n\
         dependent rods   {} in a flat state, {rank}\n",
        Dof::flat_redundancy(t)
    )
}

/// A number with four digits after the point, or with an exponent where these say too little.
fn number(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-2..1e5).contains(&size) => format!("{value:.4}"),
        _ => format!("{value:.4e}"),
    }
}
