//! How many pictures memory holds at a time.

use super::band::MEMORY_OF_COLUMN;
use super::canvas::Light;
use super::error::PictureError;
use isosheet_files::memory;

/// Bytes for a pixel of a picture: its light, twice its three bytes as they are listed, and these bytes as
/// the file is made of them, filtered, compressed and gathered.
const MEMORY_OF_PIXEL: u64 = (size_of::<Light>() + 2 * 3 + 3 * 3) as u64;

/// As many pictures of a size (pixels) as may be drawn at a time, `most` at most.
///
/// # Errors
/// [`PictureError::Options`] where memory holds none.
pub fn at_once(size: [usize; 2], most: usize) -> Result<usize, PictureError> {
    at_once_within(size, most, memory::free())
}

fn at_once_within(size: [usize; 2], most: usize, free: u64) -> Result<usize, PictureError> {
    let [width, height] = size.map(|n| n as u64);
    let one = width.saturating_mul(height).saturating_mul(MEMORY_OF_PIXEL);
    // Each thread draws some rows of samples.
    let bands = width.saturating_mul(MEMORY_OF_COLUMN as u64);
    let bands = bands.saturating_mul(rayon::current_num_threads() as u64);
    match free.saturating_sub(bands) / one.max(1) {
        0 => Err(PictureError::memory(size, one.saturating_add(bands), free)),
        some => Ok(most.min(usize::try_from(some).unwrap_or(usize::MAX)).max(1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::Advice;

    #[test]
    fn so_many_pictures_are_drawn_as_memory_holds() {
        let threads = rayon::current_num_threads() as u64;
        // 27 bytes a pixel, and 32 x 9 samples of 20 bytes and 32 flags for each column of each thread.
        let (one, bands) = (27 * 1_000_000, threads * 1000 * 32 * (9 * 20 + 1));
        let at_once = |free| at_once_within([1000, 1000], 8, free);
        assert_eq!(at_once(bands + 3 * one).unwrap(), 3);
        assert_eq!(at_once(bands + 100 * one).unwrap(), 8);
        let error = at_once(bands + one - 1).unwrap_err();
        let said = "a picture of 1000 x 1000 pixels takes";
        assert!(error.to_string().starts_with(said), "{error}");
        assert!(error.advice().unwrap().contains("--size"));
        assert!(at_once_within([usize::MAX; 2], 1, u64::MAX).is_err());
    }
}
