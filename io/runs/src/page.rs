//! The page of a run.

use super::elastic::ElasticSummary;
use super::frame_field::FrameField;
use super::recording::{Recording, RunFrames};
use super::replay::{measure_series, still, with_frames};
use super::round_off::beyond;
use super::spool::Spool;
use super::{EndReason, FoldVerdict, RunError, SheetPlace, Summary, constraints};
use isosheet_files::{DataError, prepare_folder, write_atomically};
use isosheet_formats::FrameQuantity;
use isosheet_mesh::wording::brief;
use isosheet_page::{PageOptions, Replay, no_frames};
use isosheet_scenes::{Gauge, Scene, bounds};
use std::io::Write;
use std::path::Path;

impl Recording {
    /// What the page of the run shows: [`replay_of`](super::replay_of) with the measures of the scene, the
    /// pins and immobile vertices, the curves and surfaces that hold vertices, a summary, the scene and how
    /// to make the run again.
    ///
    /// # Errors
    /// [`DataError`] of a run without a frame yet.
    pub fn replay(&self) -> Result<Replay, DataError> {
        if self.trajectory.is_empty() {
            return Err(no_frames());
        }
        let frames = (0..self.trajectory.len()).filter_map(|k| self.trajectory.frame(k));
        let corners = bounds(frames.flat_map(|x| x.as_chunks::<3>().0));
        let still = self.still(self.trajectory.times().to_vec(), corners);
        with_frames(still, &self.trajectory, &self.sheet, &self.fields())
    }

    /// The fields of the page.
    pub(super) fn fields(&self) -> Vec<FrameField<'_>> {
        let has = |quantity: FrameQuantity| self.shape.has(quantity);
        let folding = self.targets.folding.as_ref();
        let open = folding.map(|targets| FrameField::open(&self.sheet, targets));
        let mut fields: Vec<_> = open.into_iter().collect();
        fields.extend(FrameField::all(
            &self.sheet,
            &self.origins,
            &self.obstacles,
            has,
        ));
        fields.extend(FrameField::elastic(
            &self.model,
            self.sheet.topology().face_count(),
        ));
        if self.scene.scene().output.curvature {
            fields.extend(self.curvature_fields());
        }
        fields
    }

    /// The page without its frames, which are at these times, and whose positions lie in the box between two
    /// corners.
    fn still(&self, times: Vec<f64>, corners: [[f64; 3]; 2]) -> Replay {
        let ground = self.ground(&times, corners);
        let mut replay = still(&self.sheet, &self.obstacles, times, &self.history);
        for (k, body) in replay.bodies.iter_mut().enumerate() {
            body.name = self.origins.obstacle_called(k);
        }
        if let Some(folding) = &self.scene.scene().folding {
            let part = |t: &f64| folding.part.abs() * folding.progress(*t);
            replay.folded = replay.times.iter().map(part).collect();
        }
        let held = constraints::bodies(self.scene.scene(), &replay.times, corners);
        replay.bodies.extend(held);
        replay
            .series
            .extend(measure_series(&self.measures, &self.facts.measures));
        Replay {
            // How far creases are from their angles, unless they have reached them.
            colour: self
                .targets
                .folding
                .as_ref()
                .filter(|_| !self.is_folded())
                .map(|_| 0),
            title: self.name.clone(),
            sheets: self
                .parts
                .iter()
                .map(|(_, part)| part.faces.len())
                .collect(),
            pins: self.pins.iter().map(|v| v.0).collect(),
            immobile: self.immobile.iter().map(|v| v.0).collect(),
            summary: self.facts(),
            ground,
            scene: self.scene.text().text.clone(),
            reproduce: self.reproduce(),
            ..replay
        }
    }

    /// Whether the run is complete and all creases of its pattern have reached their angles.
    fn is_folded(&self) -> bool {
        let residuals = self
            .summary
            .as_ref()
            .map(|summary| &summary.ending.residuals);
        let folding = residuals.and_then(|residuals| residuals.folding);
        folding.is_some_and(|folding| folding.largest <= FoldVerdict::OPEN)
    }

    /// What came of the run so far as names and values: the table of the page.
    pub fn facts(&self) -> Vec<(String, String)> {
        let mut rows = Rows(Vec::new());
        rows.add("modelled", self.modelled.join(", "));
        match &self.summary {
            Some(summary) => {
                rows.of_summary(summary, self.scene.scene());
                rows.of_gauges(summary, &self.facts.measures);
            }
            None => {
                let t = self.history.last().map_or(0.0, |row| row.t);
                rows.add("state", format!("not complete: up to {t:.4} s"));
            }
        }
        if !self.shape.has(FrameQuantity::Gaps) {
            rows.add(
                "not recorded",
                "gaps of the sheet to itself by vertex".into(),
            );
        }
        rows.0
    }

    fn reproduce(&self) -> String {
        let files = if self.scene.scene().files().is_empty() {
            "Save the scene above as scene.toml."
        } else {
            "The scene above and the mesh files that it names are in the folder of the run."
        };
        let control = self.summary.iter().flat_map(|summary| &summary.control);
        let files = match control
            .map(|done| done.in_scene)
            .reduce(|all, one| all && one)
        {
            None => files.to_owned(),
            Some(true) => format!("{files} It has what a program drove in the course of the run."),
            Some(false) => format!(
                "{files} A program changed more in the course of the run than the scene can say."
            ),
        };
        let program = match &self.summary {
            None => String::new(),
            Some(summary) => {
                let commit = summary.commit.as_ref();
                let commit = commit.map_or(String::new(), |c| format!(", commit {c}"));
                format!("\n# {} {}{commit}", summary.program, summary.version)
            }
        };
        format!("# {files}{program}\nisosheet simulate scene.toml --out again")
    }
}

/// Names and values.
struct Rows(Vec<(String, String)>);

impl Rows {
    fn add(&mut self, name: &str, value: String) {
        self.0.push((name.into(), value));
    }

    fn of_elastic(&mut self, elastic: &ElasticSummary) {
        self.add(
            "stiffness of the sheet",
            format!("{} N/m", brief(elastic.stiffness)),
        );
        self.add(
            "largest strain of a face",
            format!("{:.1e}, limit {}", elastic.strain, elastic.limit),
        );
        self.add(
            "stretching in the elastic energy at the end",
            format!("{:.0} %", 100.0 * elastic.share),
        );
        if let Some(bend) = elastic.sharpest {
            self.add("sharpest bend over a face", bend.to_string());
        }
    }

    /// What gauges show at the end.
    fn of_gauges(&mut self, summary: &Summary, gauges: &[Gauge]) {
        for gauge in gauges {
            let Some(measured) = summary.measures.get(&gauge.name) else {
                continue;
            };
            let [last, least, largest] =
                [measured.last, measured.least, measured.largest].map(brief);
            let unit = gauge.unit();
            let value = format!("{last} {unit} at the end, from {least} to {largest} {unit}");
            self.add(&gauge.name, value);
        }
    }

    fn of_summary(&mut self, summary: &Summary, scene: &Scene) {
        let ending = &summary.ending;
        let reason = match ending.reason {
            EndReason::Time => "the whole time has passed",
            EndReason::Rest => "the sheet is at rest",
            EndReason::SupportForce => "the force at a support is reached",
            EndReason::Program => "the program that took the steps ended it",
            EndReason::Error => "an error ended the program that took the steps",
            EndReason::Taut => "more is asked for than the lengths allow",
        };
        let reason = ending.taut.as_deref().unwrap_or(reason);
        self.add("ended", format!("at {:.4} s: {reason}", ending.t));
        if let Some(failed) = &ending.failed {
            self.add("the step after that failed", failed.clone());
        }
        self.add(
            "steps",
            format!("{}, {} rejected", summary.steps, summary.rejected),
        );
        for SheetPlace {
            name,
            vertices,
            faces,
            largest_strain,
        } in &summary.sheets
        {
            let [[v, w], [f, g]] = [*vertices, *faces];
            let strain = largest_strain.map(|strain| format!(", largest strain {strain:.1e}"));
            let place = format!(
                "vertices {v} to {}, faces {f} to {}{}",
                w - 1,
                g - 1,
                strain.unwrap_or_default()
            );
            self.add(&format!("sheet {name}"), place);
        }
        let solves = (summary.iterations, summary.factorisations);
        self.add(
            "solver",
            format!("{} iterations, {} factorisations", solves.0, solves.1),
        );
        if let Some(error) = summary.time_error {
            self.add("largest estimated error of a step", error.to_string());
        }
        self.add("wall time", format!("{:.2} s", summary.wall_time));
        self.add("largest strain", format!("{:.1e}", summary.largest_strain));
        if let Some(elastic) = &summary.elastic {
            self.of_elastic(elastic);
        }
        if let Some(gap) = summary.gap_in_words() {
            self.add("smallest gap", gap);
        }
        if let Some(plastic) = ending.plastic {
            self.add("dissipated by yielding", format!("{plastic:.2e} J"));
        }
        for done in &summary.control {
            self.add(
                "changed by the program that took the steps",
                done.to_string(),
            );
        }
        for words in ending.kept.in_words() {
            self.add("kept after unloading", words);
        }
        for words in ending.residuals.in_words() {
            self.add("targets at the end", words);
        }
        self.add(
            "energy that the method took out of the motion (-) or added (+)",
            format!("{:.2e} J", summary.drift_beyond_round_off()),
        );
        self.add(
            "largest speed at the end",
            format!("{:.2e} m/s", summary.speed_beyond_round_off()),
        );
        let vector = |force| vector(force, summary.round_off_of_forces());
        for (k, force) in ending.supports.iter().enumerate() {
            let name = format!("force of support[{k}] on the sheet at the end");
            self.add(&name, vector(force));
        }
        for (k, (force, obstacle)) in ending.obstacles.iter().zip(&scene.obstacle).enumerate() {
            let name = format!("force of the sheet on {} at the end", obstacle.called(k));
            self.add(&name, vector(force));
        }
        for (k, (force, body)) in ending.bodies.iter().zip(&scene.body).enumerate() {
            let name = format!("force of contact on {} at the end", body.called(k));
            self.add(&name, vector(force));
        }
    }
}

/// A force in words, whose components are 0 up to a size.
fn vector(force: &[f64; 3], round_off: f64) -> String {
    let [x, y, z] = force.map(|c| beyond(c, round_off));
    format!("({x:.3e}, {y:.3e}, {z:.3e}) N")
}

/// Writes the page of the run in a folder, complete or not, to a file. Returns the size of the page, bytes.
///
/// # Errors
/// [`RunError::NoRun`] if the folder is not that of a run, [`RunError::Page`] if the run cannot be shown,
/// [`RunError`] if a file cannot be read or written.
pub fn write_page(folder: &Path, file: &Path, options: &PageOptions) -> Result<usize, RunError> {
    let (recording, frames) = Recording::open(folder)?;
    write_page_of(&recording, &frames, file, options)
}

/// Writes the page of a run that was read already to a file. Returns the size of the page, bytes.
pub(crate) fn write_page_of(
    recording: &Recording,
    frames: &RunFrames,
    file: &Path,
    options: &PageOptions,
) -> Result<usize, RunError> {
    let page = page_of(recording, frames, &prepare_folder(file)?, options)?;
    write_atomically(file, |w| w.write_all(page.as_bytes()))?;
    Ok(page.len())
}

/// The page of a run. One frame is in memory at a time: while the page is made, what it shows of them is in a
/// file without a name in a folder.
fn page_of(
    recording: &Recording,
    frames: &RunFrames,
    folder: &Path,
    options: &PageOptions,
) -> Result<String, RunError> {
    let fields = recording.fields();
    let spool = Spool::of(frames, &recording.sheet, &fields, folder)?;
    if spool.times.is_empty() {
        return Err(no_frames().into());
    }
    let still = recording.still(spool.times.clone(), spool.corners);
    let still = Replay {
        bends: FrameField::of_bends(&fields),
        fields: fields.into_iter().map(|field| field.head).collect(),
        ..still
    };
    still.page_of(&spool, options)
}

impl Recording {
    /// Reads a run, and makes its page; what the page shows is in a file without a name in a folder
    /// meanwhile. A run that has no page is read all the same.
    ///
    /// # Errors
    /// [`RunError`] if the folder is not that of a run.
    pub fn read_with_page(
        folder: &Path,
        spool: &Path,
        options: &PageOptions,
    ) -> Result<(Self, Result<String, RunError>), RunError> {
        let (mut recording, frames) = Self::open(folder)?;
        let page = page_of(&recording, &frames, spool, options);
        recording.load(frames, folder)?;
        Ok((recording, page))
    }
}
