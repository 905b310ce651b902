#![doc = include_str!("../README.md")]

mod allowance;
mod atomic;
mod bytes;
mod cell;
mod data_error;
mod file_error;
mod finite;
pub mod input;
mod json;
pub mod memory;
mod numbered;
pub mod xml;

pub use allowance::Allowance;
pub use atomic::{FileWriter, is_unfinished, prepare_folder, write_atomically};
pub use bytes::bytes_in_words;
pub use cell::cell;
pub use data_error::DataError;
pub use file_error::{FileError, ReadError, WriteError};
pub use finite::check_finite;
pub use json::{read_json, write_json};
pub use numbered::NumberedFiles;
