//! Which frame of a run is meant.

use super::failure::Failure;
use super::frames::FrameNumber;
use clap::Args;
use isosheet_formats::{FoldFrame, Trajectory};
use isosheet_mesh::wording::{brief, given};
use isosheet_scenes::Folding;

/// The one frame of a run that is written, if one alone is.
#[derive(Debug, Args)]
pub(super) struct OneFrame {
    /// Of a run, write frame K alone, as a mesh or a picture; of a FOLD file, read frame K (from 0; of a run
    /// also `last`)
    #[arg(long, value_name = "K", conflicts_with_all = ["frames", "every", "fps"])]
    pub(super) frame: Option<FrameNumber>,
    /// Of a run, write the frame that is nearest to time T alone, seconds; T is a time of the run
    #[arg(long, value_name = "T", allow_negative_numbers = true, conflicts_with_all = ["frame", "frames", "every", "fps"])]
    time: Option<f64>,
    /// Of a run that folds a pattern, write the frame alone that is nearest to the part P of the angles, from
    /// 0 to 1
    #[arg(long, value_name = "P", allow_negative_numbers = true, conflicts_with_all = ["frame", "time", "frames", "every", "fps"])]
    part: Option<f64>,
}

impl OneFrame {
    /// The name of the option that chooses a frame of a run, and of no mesh file, if one is given.
    pub(super) fn of_run(&self) -> Option<&'static str> {
        let part = self.part.map(|_| "--part");
        self.time.map(|_| "--time").or(part)
    }

    /// The frame of a FOLD file that is asked for, if one is.
    pub(super) fn of_file(&self) -> Result<Option<FoldFrame>, Failure> {
        match self.frame {
            None => Ok(None),
            Some(FrameNumber::Number(number)) => Ok(Some(FoldFrame::Number(number))),
            Some(FrameNumber::Last) => {
                let message = "--frame last is for runs, and this is a mesh file";
                Err(Failure::misuse(message).remedy("give the number of a frame, from 0"))
            }
        }
    }

    /// Whether one frame alone is written.
    pub(super) fn is_asked_for(&self) -> bool {
        self.frame.is_some() || self.of_run().is_some()
    }

    /// The frame of a motion that is asked for, if one is: of several that are as near the last.
    pub(super) fn of(
        &self,
        trajectory: &Trajectory,
        folding: Option<&Folding>,
    ) -> Result<Option<usize>, Failure> {
        let wrong = |message: String, remedy: &str| Err(Failure::misuse(message).remedy(remedy));
        match (self.time, self.part, folding) {
            (Some(time), ..) => match trajectory.nearest(time) {
                Some(frame) => Ok(Some(frame)),
                None => wrong(
                    format!(
                        "there is no frame near {} s{}",
                        given(time),
                        in_words(trajectory.times())
                    ),
                    "give a time of the run, seconds",
                ),
            },
            (_, Some(part), Some(folding)) if (0.0..=1.0).contains(&part) => {
                let folded = |t: f64| folding.part.abs() * folding.progress(t);
                Ok(trajectory.with_least(|t| (folded(t) - part).abs()))
            }
            (_, Some(part), Some(_)) => wrong(
                format!("the part of the folding is {}", given(part)),
                "give a number from 0 to 1",
            ),
            (_, Some(_), None) => wrong(
                "--part chooses a frame of a run that folds a crease pattern, and this one folds none that is known".to_owned(),
                "name the folder of the run, or choose a frame with `--frame K` or `--time T`",
            ),
            _ => Ok(self.frame.map(|frame| frame.of(trajectory.len()))),
        }
    }
}

/// From when to when a run has frames.
fn in_words(times: &[f64]) -> String {
    let ends = times.first().zip(times.last());
    ends.map_or(String::new(), |(first, last)| {
        format!(
            ": the run has frames from {} to {} s",
            brief(*first),
            brief(*last)
        )
    })
}
