//! What a file may cost: memory and steps in proportion to its length.

use crate::DataError;

/// Every file may cost so much, bytes: less than a program that shows an empty window takes.
const LEAST: usize = 64 << 20;

/// Bytes for each byte of a file: its shortest line has two characters and becomes a curve, which takes 160
/// bytes while it is read.
const TIMES: usize = 100;

/// The bytes or steps that what is made of a file may still take.
#[derive(Clone, Copy, Debug)]
pub struct Allowance {
    all: usize,
    left: usize,
}

impl Allowance {
    /// What a file of so many bytes may cost.
    pub fn of(length: usize) -> Self {
        let all = LEAST.saturating_add(length.saturating_mul(TIMES));
        Self { all, left: all }
    }

    /// Half of it: what is read is copied once.
    pub fn half(self) -> Self {
        Self {
            all: self.all / 2,
            left: self.left / 2,
        }
    }

    /// All of it, bytes.
    pub fn all(self) -> usize {
        self.all
    }

    /// What is left of it, bytes.
    pub fn left(self) -> usize {
        self.left
    }

    /// Takes some of it.
    ///
    /// # Errors
    /// [`DataError`] where less is left, which names what it was for.
    pub fn spend(&mut self, cost: usize, what: &str) -> Result<(), DataError> {
        match self.left.checked_sub(cost) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => {
                self.left = 0;
                let most = self.all >> 20;
                let message = format!("{what} of the file would take more than {most} MiB");
                let remedy = "export it again with less in it: that is far more than a file of its length has";
                Err(DataError::new(message, remedy))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_grows_with_the_file_and_ends() {
        let mut left = Allowance::of(1000);
        assert_eq!(left.all(), (64 << 20) + 100_000);
        left.spend(64 << 20, "a").unwrap();
        left.spend(100_000, "a").unwrap();
        let error = left.spend(1, "the lines").unwrap_err().to_string();
        assert_eq!(error, "the lines of the file would take more than 64 MiB");
        assert_eq!(Allowance::of(usize::MAX).all(), usize::MAX);
    }
}
