//! Pools of a given number of threads.

use isosheet_mesh::Advice;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// The operating system refused to start threads.
#[derive(Debug, thiserror::Error)]
#[error("cannot start a pool of size {threads}: {cause}")]
pub(crate) struct ThreadsError {
    threads: usize,
    /// Not the source: the error of the operating system below it would be taken for one of a file.
    cause: ThreadPoolBuildError,
}

impl Advice for ThreadsError {
    fn advice(&self) -> Option<&'static str> {
        Some("end other programs, or allow more processes (ulimit -u) or memory (ulimit -v)")
    }
}

/// A pool of so many threads.
pub(crate) fn pool(threads: usize) -> Result<ThreadPool, ThreadsError> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|cause| ThreadsError { threads, cause })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::error::Error;

    #[test]
    fn a_pool_has_its_threads_or_says_what_to_do() {
        assert_eq!(pool(2).unwrap().current_num_threads(), 2);
        let builder = ThreadPoolBuilder::new().num_threads(1);
        let refused = builder.spawn_handler(|_| Err(std::io::Error::other("no more")));
        let cause = refused.build().unwrap_err();
        let error = ThreadsError { threads: 1, cause };
        assert_eq!(error.to_string(), "cannot start a pool of size 1: no more");
        assert!(error.advice().is_some() && error.source().is_none());
    }
}
