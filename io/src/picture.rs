//! Shaded pictures of sheets and bodies: two-sided colours, ambient occlusion, thin wires.
//!
//! Triangles are drawn with a depth for each pixel ([`render()`]); how much of the surroundings a point
//! sees is found by rays through a bounding volume hierarchy, on the threads that rayon has. Pictures are
//! the same to the bit at every run, for any number of threads and with any fonts on the system.
//!
//! ```
//! use isosheet_mesh::generate;
//! use isosheet_io::picture::{Camera, Look, SheetPicture, render};
//!
//! let sheet = generate::isotropic_square(1, 0.2)?;
//! let points = sheet.positions().as_chunks::<3>().0.iter().copied();
//! let camera = Camera::new([0.0; 3], -60.0, 25.0, 1.0, 1.5).framing(points, 1.0, 0.05);
//! let picture = SheetPicture::of(sheet.topology(), sheet.positions());
//! let image = render(&picture, &camera, &Look { size: [80, 80], ..Look::default() })?;
//! assert!(image.to_png()?.starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod animation;
mod camera;
mod canvas;
#[cfg(feature = "run")]
mod colour_bar;
mod colour_scale;
mod colours;
mod error;
mod lines;
mod memory;
mod montage;
mod occlusion;
mod pieces;
mod raster;
mod sheet;
mod solid;
mod text;
#[cfg(feature = "run")]
mod ticks;
mod vector;
#[cfg(feature = "labels")]
mod vector_drawing;

pub use animation::animated_png;
pub use camera::Camera;
pub use canvas::Image;
#[cfg(feature = "run")]
pub(crate) use colour_bar::strip;
pub use colour_scale::{ColourMap, ColourScale, Spacing};
pub use colours::Colours;
pub use error::PictureError;
#[cfg(feature = "run")]
pub(crate) use memory::at_once;
pub use montage::{Labelled, montage};
pub use sheet::{Look, SheetPicture, render, render_folded};
pub use solid::Solid;
#[cfg(feature = "labels")]
pub use vector_drawing::svg_to_png;
