#![doc = include_str!("../README.md")]

mod film;
mod film_encoder;
mod gallery;
mod quantity;
mod viewpoint;

pub use film::{Film, FilmOptions, Marks};
pub use film_encoder::FilmError;
pub use gallery::{Gallery, GalleryEntry, GalleryError};
pub use viewpoint::Viewpoint;
