//! How a crease pattern is folded, as command lines say it.

use clap::Args;
use isosheet_scenes::{FoldGroup, FoldScene, Touch};

/// How a crease pattern is folded.
#[derive(Debug, Args)]
pub(super) struct FoldOptions {
    /// Of a crease pattern, which part of its angle each crease is folded by, above 0 and at most 1 [default:
    /// 1]
    #[arg(long, value_name = "PART", value_parser = part)]
    part: Option<f64>,
    /// Of a crease pattern, panels touch each other, and do not pass through each other
    #[arg(long)]
    contact: bool,
    /// Of a crease pattern, groups of creases that fold one after the other, with `;` between them:
    /// mountains, valleys, numbers of edges of the FOLD file, or lines of the drawing (layer:NAME, red,
    /// #ff8000, dashed, solid) with `,` between them
    #[arg(long, value_name = "GROUPS", value_delimiter = ';')]
    order: Vec<FoldGroup>,
    /// Which frame of a FOLD file, by its number from 0 [default: the first one with vertices]
    #[arg(long, value_name = "NUMBER")]
    pub(super) frame: Option<usize>,
}

/// A number from 0 to 1 that is not 0.
fn part(text: &str) -> Result<f64, String> {
    let part: Option<f64> = text.parse().ok();
    part.filter(|p| *p > 0.0 && *p <= 1.0)
        .ok_or_else(|| "give a number above 0 and at most 1".to_owned())
}

impl FoldOptions {
    /// A scene that folds a pattern in this way.
    pub(super) fn of(&self, scene: FoldScene) -> FoldScene {
        FoldScene {
            part: self.part.unwrap_or(scene.part),
            touch: match self.contact {
                true => Touch::Touches,
                false => scene.touch,
            },
            order: self.order.clone(),
            ..scene
        }
    }

    /// The name of an option that is given, if one is.
    pub(super) fn given(&self) -> Option<&'static str> {
        let given = [
            ("--part", self.part.is_some()),
            ("--contact", self.contact),
            ("--order", !self.order.is_empty()),
            ("--frame", self.frame.is_some()),
        ];
        given
            .into_iter()
            .find(|(_, is_given)| *is_given)
            .map(|(name, _)| name)
    }
}
