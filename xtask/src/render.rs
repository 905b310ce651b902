//! A small renderer for shaded pictures of sheets: z-buffer, two-sided colours, ambient occlusion, thin
//! wires.

mod camera;
mod canvas;
mod glyphs;
mod montage;
mod occlusion;
mod pieces;
mod sheet;
mod solid;

pub(crate) use camera::Camera;
pub(crate) use canvas::{Image, png};
pub(crate) use montage::{Labelled, montage};
pub(crate) use sheet::{Look, SheetPicture, render};
pub(crate) use solid::Solid;
