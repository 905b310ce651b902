//! Drawing Exchange Format.

use super::lines::Drawing;
use super::options::DrawingOptions;
use crate::format::DataError;

pub(super) fn parse(_bytes: &[u8], _options: &DrawingOptions) -> Result<Drawing, DataError> {
    Err(DataError::plain("not yet"))
}
