//! Lists of mesh files with their times: collections (`.pvd`) and series (`.vtk.series`) of VTK.

use super::extension::has_extension;
use super::samples::{self, SampleTimes};
use crate::MovingMesh;
use isosheet_files::xml::Entities;
use isosheet_files::{FileError, input, xml};
use serde::Deserialize;
use std::path::{Path, PathBuf};

const REMEDY: &str = "write the list again, with a file and a time in seconds for each sample";

pub(super) fn read(path: &Path) -> Result<MovingMesh, FileError> {
    let (times, files) = files(path)?;
    samples::read(path, SampleTimes::Seconds(times), &files)
}

/// The times and the files of a list.
pub(super) fn files(path: &Path) -> Result<(Vec<f64>, Vec<PathBuf>), FileError> {
    let bytes = input::read(path).map_err(|e| FileError::unreadable(path, e))?;
    let list = if has_extension(path, "series") {
        series(&bytes)
    } else {
        collection(&String::from_utf8_lossy(&bytes))
    };
    let list = list.map_err(|problem| FileError::content(path, problem, REMEDY))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let file = |name: PathBuf| {
        let found = input::within(folder, &name);
        found.map_err(|e| FileError::unreadable(&folder.join(&name), e))
    };
    let (times, names): (Vec<f64>, Vec<PathBuf>) = list.into_iter().unzip();
    let files = names.into_iter().map(file);
    Ok((times, files.collect::<Result<_, _>>()?))
}

/// The times and files of a collection in XML.
fn collection(text: &str) -> Result<Vec<(f64, PathBuf)>, String> {
    let document = xml::parse(text.trim_start_matches('\u{feff}'), Entities::Refused);
    let document = document.map_err(|e| e.to_string())?;
    let sets = document.descendants().filter(|n| n.has_tag_name("DataSet"));
    let entry = |(k, set): (usize, roxmltree::Node<'_, '_>)| {
        let time = set.attribute("timestep").unwrap_or_default();
        let time = time.trim().parse().ok().filter(|t: &f64| t.is_finite());
        let file = set.attribute("file").filter(|name| !name.is_empty());
        match (time, file) {
            (Some(time), Some(file)) => Ok((time, file.into())),
            (None, _) => Err(format!("sample {k} has no `timestep` that is a number")),
            (_, None) => Err(format!("sample {k} has no `file`")),
        }
    };
    sets.enumerate().map(entry).collect()
}

/// The times and files of a series in JSON.
fn series(bytes: &[u8]) -> Result<Vec<(f64, PathBuf)>, String> {
    #[derive(Deserialize)]
    struct Series {
        files: Vec<Sample>,
    }
    #[derive(Deserialize)]
    struct Sample {
        name: PathBuf,
        time: f64,
    }
    let series: Series = serde_json::from_slice(bytes).map_err(|e| e.to_string())?;
    let samples = series.files.into_iter();
    Ok(samples.map(|sample| (sample.time, sample.name)).collect())
}
