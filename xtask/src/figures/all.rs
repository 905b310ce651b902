//! Figures by their numbers.

use super::{
    Context, Made, crumple, drape, fig01, fig02, fig03, fig04, fig05, fig06, fig07, fig08, fig09,
    jam, origami, performance, stamping,
};
use anyhow::Result;

/// Makes a figure.
///
/// # Errors
/// [`Interrupted`](crate::interrupt::Interrupted) after Ctrl-C.
pub(crate) fn make(figure: u8, context: &Context<'_>) -> Result<Made> {
    match figure {
        1 => fig01::make(),
        2 => fig02::make(),
        3 => fig03::make(),
        4 => fig04::make(),
        5 => fig05::make(),
        6 => fig06::make(),
        7 => fig07::make(),
        8 => fig08::make(),
        9 => fig09::make(),
        10 => performance::make(context),
        11 => crumple::make(11, 1, context),
        12 => crumple::make(12, 2, context),
        13 => stamping::make(context),
        14 => drape::fig14(context),
        15 => drape::fig15(context),
        16 => jam::make(context),
        17 => origami::make(context),
        _ => anyhow::bail!("figure {figure} cannot be made"),
    }
}
