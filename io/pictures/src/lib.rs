#![doc = include_str!("../README.md")]

mod animation;
mod band;
mod camera;
mod canvas;
mod colour_bar;
mod colour_scale;
mod colours;
mod drawing;
mod error;
mod lines;
mod memory;
mod montage;
mod occlusion;
mod pieces;
mod raster;
mod shading;
mod sheet;
mod solid;
mod text;
mod ticks;
#[cfg(feature = "labels")]
mod vector_drawing;

pub use animation::animated_png;
pub use camera::Camera;
pub use canvas::Image;
pub use colour_bar::strip;
pub use colour_scale::{ColourMap, ColourScale, Spacing};
pub use colours::Colours;
pub use error::PictureError;
pub use memory::at_once;
pub use montage::{Labelled, montage};
pub use sheet::{Look, SheetPicture, render, render_folded};
pub use solid::DrawnSolid;
#[cfg(feature = "labels")]
pub use vector_drawing::svg_to_png;
