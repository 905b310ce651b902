//! How a crease pattern is folded, as command lines say it.

use super::failure::Failure;
use clap::Args;
use isosheet_mesh::wording::given;
use isosheet_scenes::{FoldGroup, FoldScene, Touch};

/// How a crease pattern is folded.
#[derive(Debug, Args)]
pub(super) struct FoldOptions {
    /// Of a crease pattern, which part of its angle each crease is folded by, above 0 and at most 1 [default:
    /// 1]
    #[arg(long, value_name = "PART", value_parser = part)]
    part: Option<f64>,
    /// Of a crease pattern, the angle that its sharpest creases are folded by, degrees; the others are folded
    /// by the same part of theirs [default: all of the angle]
    #[arg(long, value_name = "DEGREES", value_parser = angle, conflicts_with = "part")]
    angle: Option<f64>,
    /// Of a crease pattern, mountains become valleys and valleys mountains: the pattern was drawn from the
    /// other side of the sheet
    #[arg(long)]
    swap: bool,
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

/// A fold angle, degrees.
fn angle(text: &str) -> Result<f64, String> {
    let angle: Option<f64> = text.parse().ok();
    angle
        .filter(|a| *a > 0.0 && *a <= 180.0)
        .ok_or_else(|| "give a number of degrees above 0 and at most 180".to_owned())
}

impl FoldOptions {
    /// A scene that folds a pattern in this way, whose sharpest creases have an angle, degrees.
    pub(super) fn of(&self, scene: FoldScene, sharpest: f64) -> Result<FoldScene, Failure> {
        let part = match (self.angle, self.part) {
            (Some(angle), _) if angle > sharpest => {
                let (angle, most) = (given(angle), given(sharpest));
                let message = format!(
                    "--angle {angle} is more than the creases of the pattern are folded by: at most {most} degrees"
                );
                return Err(Failure::misuse(message).remedy(format!("give at most {most}")));
            }
            (Some(angle), _) => angle / sharpest,
            (None, part) => part.unwrap_or(scene.part),
        };
        Ok(FoldScene {
            part: if self.swap { -part } else { part },
            touch: match self.contact {
                true => Touch::Touches,
                false => scene.touch,
            },
            order: self.order.clone(),
            ..scene
        })
    }

    /// The name of an option that is given, if one is.
    pub(super) fn given(&self) -> Option<&'static str> {
        let given = [
            ("--part", self.part.is_some()),
            ("--angle", self.angle.is_some()),
            ("--swap", self.swap),
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
