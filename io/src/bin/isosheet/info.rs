//! `isosheet info`.

use crate::Done;
use crate::exit::{Code, Failure};
use crate::write::to_stdout;
use clap::Args;
use isosheet_io::dynamics::{SheetModel, rod_rank};
use isosheet_io::mesh::{Dof, MassKind, Sheet};
use isosheet_io::read_sheet;
use isosheet_io::scene::{SceneFile, Setup};
use std::path::{Path, PathBuf};

/// Print counts, degrees of freedom, boundary loops and sizes
#[derive(Debug, Args)]
pub(crate) struct Info {
    /// A scene (.toml) or a mesh (OBJ, OFF, STL, PLY, FOLD, glTF)
    file: PathBuf,
}

/// Whether a file is a scene by its name; everything else is read as a mesh.
pub(crate) fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "toml")
}

impl Info {
    pub(crate) fn run(&self) -> Done {
        if is_scene(&self.file) {
            let setup = SceneFile::read(&self.file, &[])?.build()?;
            return to_stdout(&describe_scene(&setup));
        }
        let sheet = read_sheet(&self.file).map_err(|e| {
            let remedy = format!("`isosheet check {}` says more", self.file.display());
            Failure::new(Code::Input, e).remedy(remedy)
        })?;
        let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped)
            .map_err(|e| Failure::of(Code::Input, &e))?;
        to_stdout(&describe_sheet(&sheet, &model, sheet.positions()))
    }
}

/// A scene in a few lines.
pub(crate) fn describe_scene(setup: &Setup) -> String {
    let sheet = describe_sheet(&setup.sheet, &setup.model, &setup.start.x);
    let pins = setup.model.pins().len();
    let mass = setup.model.mass().total();
    let modelled = setup.modelled.join(", ");
    format!(
        "{sheet}mass             {mass:.6} kg\npinned vertices  {pins}\nmodelled         {modelled}\n"
    )
}

/// A sheet at positions `x` in a few lines.
fn describe_sheet(sheet: &Sheet, model: &SheetModel, x: &[f64]) -> String {
    let t = sheet.topology();
    let Dof {
        total, internal, ..
    } = Dof::of(t);
    let loops = t.boundary_loops();
    let lengths: Vec<String> = loops.iter().map(|l| l.len().to_string()).collect();
    let rank = match rod_rank(model, x) {
        Some(rank) => format!(
            "{} as given (rank {} of {} rods, smallest singular value {:.1e})",
            rank.deficiency, rank.rank, rank.rods, rank.smallest
        ),
        None => "not computed as given: more than 1000 rods".to_owned(),
    };
    let [shortest, longest] = [
        sheet
            .lengths()
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min),
        sheet.lengths().iter().copied().fold(0.0, f64::max),
    ];
    let [low, high] = bounds(x);
    format!(
        "vertices         {}, of these {} on the boundary\n\
         edges            {}, {shortest:.4} to {longest:.4} m long, {:.4} m in the mean\n\
         faces            {}, together {:.6} m2\n\
         components       {}, Euler characteristic {}\n\
         boundary loops   {}{}\n\
         degrees of freedom {total} = 3V - E, {internal} besides rigid motions\n\
         dependent rods   {} in a flat state, {rank}\n\
         bounds           x {:.4} to {:.4}, y {:.4} to {:.4}, z {:.4} to {:.4} m\n",
        t.vertex_count(),
        t.boundary_vertex_count(),
        t.edge_count(),
        sheet.mean_length(),
        t.face_count(),
        sheet.area(),
        t.component_count(),
        t.euler_characteristic(),
        loops.len(),
        if loops.is_empty() {
            String::new()
        } else {
            format!(", of {} vertices", lengths.join(", "))
        },
        Dof::flat_redundancy(t),
        low[0],
        high[0],
        low[1],
        high[1],
        low[2],
        high[2],
    )
}

/// Smallest and largest coordinates, metres.
fn bounds(x: &[f64]) -> [[f64; 3]; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for p in x.as_chunks::<3>().0 {
        for k in 0..3 {
            bounds[0][k] = bounds[0][k].min(p[k]);
            bounds[1][k] = bounds[1][k].max(p[k]);
        }
    }
    bounds
}
