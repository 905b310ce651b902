//! Animated pictures.

use super::canvas::{Image, encoder, srgb_bytes};
use super::error::PictureError;
use super::memory::at_once;
use isosheet_files::DataError;
use rayon::prelude::*;

/// An animated PNG file of `count` pictures of one size (pixels), which `picture` makes, several at a time on
/// the threads that rayon has. Each is shown for `delay` milliseconds, and the whole is repeated without end.
/// Programs that know no animations show the first picture.
///
/// # Errors
/// [`PictureError::Data`] for no picture, or for one of another size, [`PictureError::Options`] for a size
/// that memory does not hold, [`PictureError::Png`] if the file cannot be made, and whatever `picture`
/// returns.
pub fn animated_png(
    size: [usize; 2],
    delay: u16,
    count: usize,
    picture: impl Fn(usize) -> Result<Image, PictureError> + Sync,
) -> Result<Vec<u8>, PictureError> {
    let frames = u32::try_from(count).unwrap_or(u32::MAX);
    if frames == 0 {
        return Err(PictureError::no_frames());
    }
    let mut bytes = Vec::new();
    let mut encoder = encoder(&mut bytes, size[0] as u32, size[1] as u32);
    encoder.set_animated(frames, 0)?;
    encoder.set_frame_delay(delay, 1000)?;
    let mut writer = encoder.write_header()?;
    // So many pictures are in memory at a time.
    let batch = at_once(size, 2 * rayon::current_num_threads())?;
    for first in (0..count).step_by(batch) {
        let drawn = (first..count.min(first + batch)).into_par_iter();
        let drawn = drawn.map(|frame| {
            let image = picture(frame)?;
            if image.size() != size {
                let found = image.size();
                let message = format!(
                    "picture {frame} has {} x {} pixels, the animation {} x {}",
                    found[0], found[1], size[0], size[1]
                );
                let error = DataError::new(message, "draw all pictures in one size");
                return Err(PictureError::Data(error.at(frame)));
            }
            Ok(srgb_bytes(&image))
        });
        for data in drawn.collect::<Result<Vec<_>, _>>()? {
            writer.write_image_data(&data)?;
        }
    }
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// Another reader finds the pictures, their number and their times.
    #[test]
    fn frames_come_back() {
        let grey = |k: usize| {
            let mut image = Image::white(3, 2);
            image.pixels.fill([[1.0; 3], [0.75; 3], [0.0; 3]][k]);
            image
        };
        let bytes = animated_png([3, 2], 40, 3, |k| Ok(grey(k))).unwrap();
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let control = reader.info().animation_control.unwrap();
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        for value in [255, 225, 0] {
            reader.next_frame(&mut data).unwrap();
            assert_eq!(data, [value; 18]);
            let frame = reader.info().frame_control.unwrap();
            assert_eq!((frame.delay_num, frame.delay_den), (40, 1000));
        }
    }

    #[test]
    fn no_frames_and_other_sizes_are_refused() {
        let white = |_: usize| Ok(Image::white(3, 2));
        let none = animated_png([3, 2], 40, 0, white);
        assert!(matches!(none, Err(PictureError::Data(_))));
        let other = animated_png([2, 2], 40, 1, white);
        assert!(matches!(
            other,
            Err(PictureError::Data(error)) if error.index == Some(0)
        ));
    }
}
