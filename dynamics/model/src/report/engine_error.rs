//! Errors of engines from outside.

use isosheet_mesh::Advice;
use std::any::Any;
use std::error::Error;
use std::fmt;
use std::sync::Arc;

/// An error with advice of an `Engine` from outside.
pub trait AdvisedError: Error + Advice + Any + Send + Sync {}

impl<T: Error + Advice + Any + Send + Sync> AdvisedError for T {}

/// The error of an `Engine` from outside.
#[derive(Clone, Debug)]
pub struct EngineError(Arc<dyn AdvisedError>);

impl EngineError {
    /// Of an engine.
    pub fn new(error: impl AdvisedError) -> Self {
        Self(Arc::new(error))
    }

    /// The error of a type, if it is of that.
    pub fn downcast_ref<T: AdvisedError>(&self) -> Option<&T> {
        (&*self.0 as &dyn Any).downcast_ref()
    }
}

/// By their messages.
impl PartialEq for EngineError {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

impl fmt::Display for EngineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Error for EngineError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.0.source()
    }
}

impl Advice for EngineError {
    fn advice(&self) -> Option<&'static str> {
        self.0.advice()
    }
}
