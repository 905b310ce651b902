//! Errors and checks of checkpoints.

use isosheet_materials::potential::OtherMemories;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;

/// Errors of a checkpoint.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The bytes are not a checkpoint.
    #[error(
        "these {length} bytes are no checkpoint of isosheet: they do not begin with `isosheet`"
    )]
    NoCheckpoint {
        /// Number of bytes.
        length: usize,
    },
    /// The format version is not supported.
    #[error("the checkpoint has version {found}, this program reads version {supported}")]
    Version {
        /// Of the checkpoint.
        found: u32,
        /// The supported one.
        supported: u32,
    },
    /// The checksum does not match.
    #[error("the checkpoint is damaged: its checksum is {found:08x} instead of {expected:08x}")]
    Damaged {
        /// In the file.
        expected: u32,
        /// Of the bytes.
        found: u32,
    },
    /// Decoding failed.
    #[error("the checkpoint cannot be decoded: {0}")]
    Decode(String),
    /// Encoding failed.
    #[error("the checkpoint cannot be encoded: {0}")]
    Encode(String),
    /// The model has another number of vertices or edges.
    #[error(
        "the checkpoint is of a sheet of {} vertices and {} edges, the model has {} and {}",
        expected[0], expected[1], found[0], found[1]
    )]
    OtherSize {
        /// Vertices and edges in the checkpoint.
        expected: [usize; 2],
        /// Vertices and edges of the model.
        found: [usize; 2],
    },
    /// The model is another one.
    #[error("the {what} of the model are not those of the checkpoint")]
    OtherSheet {
        /// What differs.
        what: &'static str,
    },
    /// The contacts have other laws of friction.
    #[error("the laws of friction of the contacts are not those of the checkpoint")]
    Friction,
    /// An array has the wrong length.
    #[error("{what} of the checkpoint has {found} values where the model needs {expected}")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length needed.
        expected: usize,
    },
    /// A number is not finite.
    #[error(
        "{what} of the checkpoint have the value {value} at index {index}: the checkpoint was \
         changed from outside",
        value = given(*value)
    )]
    NotFinite {
        /// Which array.
        what: &'static str,
        /// Index in the array.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A vertex does not exist.
    #[error(
        "the checkpoint names vertex {vertex}, the model has only {vertices} vertices: the checkpoint was \
         changed from outside"
    )]
    NoSuchVertex {
        /// The vertex.
        vertex: u32,
        /// Vertices of the model.
        vertices: usize,
    },
    /// Contact is missing or not expected.
    #[error("the checkpoint was made {} contact and is resumed {} it",
        if *.expected { "with" } else { "without" }, if *.expected { "without" } else { "with" })]
    Contact {
        /// Whether the checkpoint has contact.
        expected: bool,
    },
    /// The checkpoint is of another engine.
    #[error("the checkpoint is of a simulation by {found}")]
    Engine {
        /// What moved the sheet.
        found: String,
    },
}

impl CheckpointError {
    /// Refuses numbers that are not as many as expected, or not finite; `what` they are, in the plural.
    ///
    /// # Errors
    /// [`CheckpointError::Length`], [`CheckpointError::NotFinite`].
    pub fn check_numbers(what: &'static str, values: &[f64], expected: usize) -> Result<(), Self> {
        check_length(what, values.len(), expected)?;
        check_finite(what, values)
    }
}

impl Advice for CheckpointError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NoCheckpoint { .. } => Some("give the bytes of a checkpoint"),
            Self::Version { .. } => Some("continue with the program that wrote it"),
            Self::Damaged { .. } | Self::NotFinite { .. } | Self::NoSuchVertex { .. } => {
                Some("use an earlier checkpoint")
            }
            Self::OtherSize { .. } | Self::OtherSheet { .. } => {
                Some("supply the model that the checkpoint was made with")
            }
            Self::Contact { .. } | Self::Friction => {
                Some("supply the contact that the checkpoint was made with")
            }
            Self::Engine { .. } => Some("resume it with what moved the sheet before"),
            Self::Decode(..) | Self::Encode(..) | Self::Length { .. } => None,
        }
    }
}

/// Refuses an array of the wrong length.
pub(crate) fn check_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), CheckpointError> {
    if found == expected {
        return Ok(());
    }
    Err(CheckpointError::Length {
        what,
        found,
        expected,
    })
}

/// Refuses an array with a number that is not finite.
pub(crate) fn check_finite(what: &'static str, values: &[f64]) -> Result<(), CheckpointError> {
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(index) => Err(CheckpointError::NotFinite {
            what,
            index,
            value: values[index],
        }),
    }
}

impl From<OtherMemories> for CheckpointError {
    fn from(OtherMemories { found, expected }: OtherMemories) -> Self {
        Self::Length {
            what: "what potentials remember",
            found,
            expected,
        }
    }
}
