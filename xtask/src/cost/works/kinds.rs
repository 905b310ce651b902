//! The kinds of runs.

use crate::report::Effort;
use crate::runs::FigureScene;
use anyhow::Result;
use isosheet_io::scene::StartingPoint;
use std::path::Path;

/// A kind of run, at several sizes.
#[derive(Debug)]
pub(in crate::cost) struct Work {
    /// Its name on the command line and in tables.
    pub(super) name: &'static str,
    /// What happens, for people.
    pub(super) title: &'static str,
    /// A file of `xtask/scenes`, or a kind of `isosheet new`.
    file: &'static str,
    /// Edits besides those of the size and of the start.
    edits: &'static [&'static str],
    /// The keys that are the size.
    keys: &'static [&'static str],
    /// Sizes of quick runs, of all others, and in addition of full ones.
    sizes: [&'static [u32]; 3],
    /// Random displacements of the start as a part of the mean edge length.
    perturbation: f64,
    pub(super) threads: &'static [usize],
}

/// Size of scenes that have one only.
const ONE: [&[u32]; 3] = [&[0], &[0], &[0]];
const LEVEL: &[&str] = &["sheet.mesh.square.level"];

/// A work of one size on one thread.
const fn single(name: &'static str, title: &'static str, file: &'static str) -> Work {
    Work {
        name,
        title,
        file,
        edits: &[],
        keys: &[],
        sizes: ONE,
        perturbation: 1e-3,
        threads: &[1],
    }
}

/// The crane's mesh in the folder that `ISOSHEET_DATA` names: a crease pattern of the folder is no part of
/// the repository.
const CRANE: &str = "fold/crane_rabbitear.fold";

/// All of them.
pub(super) static WORKS: &[Work] = &[
    Work {
        keys: LEVEL,
        sizes: [&[2], &[2, 3, 4], &[2, 3, 4, 5]],
        // From a random displacement ten times as large 4225 vertices have no way back to their lengths.
        perturbation: 1e-4,
        ..single("w1", "square of rods hangs by a corner", "cost-hanging")
    },
    Work {
        keys: LEVEL,
        sizes: [&[2], &[2, 3, 4], &[2, 3, 4, 5]],
        ..single(
            "w1e",
            "elastic square hangs by a corner",
            "cost-hanging-elastic",
        )
    },
    Work {
        keys: LEVEL,
        sizes: [&[2], &[2, 3, 4], &[2, 3, 4]],
        ..single("w2", "square of rods falls flat on a table", "cost-table")
    },
    Work {
        keys: LEVEL,
        sizes: [&[2], &[2, 3, 4], &[2, 3, 4, 5]],
        ..single(
            "w2e",
            "elastic square falls flat on a table",
            "cost-table-elastic",
        )
    },
    single("star", "star of rods falls on a ball", "cost-star"),
    single("disk", "disk of rods falls on a ball", "cost-disk"),
    Work {
        perturbation: 1e-4,
        ..single("jam", "strip of paper jams in a guide", "fig16")
    },
    Work {
        perturbation: 1e-4,
        ..single("stamping", "die punches a blank", "fig13")
    },
    Work {
        edits: &[
            "sheet.mesh={file={path=\"CRANE\",polygons=\"triangulate\",scale=0.15}}",
            "crease[0].angle.smooth_step.to=175.0",
            "contact={self_contact=true,friction=0.3}",
        ],
        ..single("crane", "crane is folded flat", "fold")
    },
    single(
        "annulus",
        "annulus of paper is folded along a curved crease",
        "cost-annulus",
    ),
    Work {
        keys: &["sheet.mesh.miura.columns", "sheet.mesh.miura.rows"],
        sizes: [&[10], &[42], &[42]],
        perturbation: 1e-4,
        ..single("miura", "Miura's pattern is folded", "fig17")
    },
    Work {
        keys: &["sheet.mesh.rectangle.columns", "sheet.mesh.rectangle.rows"],
        sizes: [&[32], &[32], &[32, 64, 128]],
        ..single(
            "turnover",
            "gravity on a hanging elastic sheet is turned over",
            "cost-turnover",
        )
    },
    Work {
        keys: &["sheet.mesh.disk.rings"],
        sizes: [&[14], &[28], &[28, 57]],
        threads: &[1, 2],
        ..single("ball", "plastic film drapes over a ball", "cost-ball")
    },
];

impl Work {
    /// The sizes that an effort has time for, smallest first.
    pub(super) fn sizes(&self, effort: Effort) -> &'static [u32] {
        let [quick, standard, full] = self.sizes;
        effort.pick(quick, standard, full)
    }

    /// A size in words; empty where there is one only.
    pub(super) fn size_name(&self, size: u32) -> String {
        match self.keys {
            [] => String::new(),
            keys if keys == LEVEL => format!("M^{size}"),
            _ => size.to_string(),
        }
    }

    /// The name of a row, for people.
    pub(super) fn row_name(&self, size: u32, threads: usize) -> String {
        let size = self.size_name(size);
        let mut name = format!("{} {size}", self.name).trim_end().to_owned();
        if threads > 1 {
            name += &format!(", {threads} threads");
        }
        name
    }

    /// The edits of a size, as `isosheet simulate --set` takes them; `None` if the mesh is a file that is not
    /// there.
    pub(super) fn edits(&self, size: u32) -> Option<Vec<String>> {
        let mut edits: Vec<String> = self.edits.iter().map(|&edit| edit.to_owned()).collect();
        if let Some(edit) = edits.iter_mut().find(|e| e.contains("CRANE")) {
            let path = Path::new(&std::env::var_os("ISOSHEET_DATA")?).join(CRANE);
            let path = path.canonicalize().ok()?;
            *edit = edit.replace("CRANE", path.to_str()?);
        }
        edits.extend(self.keys.iter().map(|key| format!("{key}={size}")));
        Some(edits)
    }

    /// The scene file with the edits that make it the row of the table, for people.
    pub(super) fn command(&self, size: u32) -> String {
        let edits = self.keys.iter().map(|key| format!("{key}={size}"));
        let fixed = self.edits.iter().map(|&edit| edit.to_owned());
        let edits: Vec<String> = fixed.chain(edits).collect();
        [vec![self.file.to_owned()], edits].concat().join(" ")
    }

    /// The scene from one of its starts, by number; `None` if its mesh is a file that is not there.
    ///
    /// # Errors
    /// A scene file that cannot be read or edited.
    pub(super) fn scene(&self, size: u32, start: u64) -> Result<Option<FigureScene>> {
        let Some(mut edits) = self.edits(size) else {
            return Ok(None);
        };
        let Self { perturbation, .. } = self;
        edits.push(format!(
            "sheet.start={{perturbation={perturbation:?},seed={start}}}"
        ));
        let kind = StartingPoint::ALL.iter().find(|s| s.name() == self.file);
        let scene = match kind {
            Some(kind) => FigureScene::starting_at(*kind, &edits)?,
            None => FigureScene::of(self.file, self.name, &edits)?,
        };
        Ok(Some(scene))
    }
}
