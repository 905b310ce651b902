//! The commit that the command was built from.

/// Git's log of HEAD, of which only the hash in its last line gets into the program. The log is empty where
/// the command is built outside of a repository.
#[cfg(isosheet_log_of_head)]
const LOG: &[u8] = include_bytes!(env!("ISOSHEET_LOG_OF_HEAD"));
#[cfg(not(isosheet_log_of_head))]
const LOG: &[u8] = b"";

/// Where in the log the hash begins, and its length, which is 0 if there is none.
const PLACE: (usize, usize) = place(LOG);

const HASH: [u8; PLACE.1] = {
    let mut hash = [0; PLACE.1];
    let mut k = 0;
    while k < hash.len() {
        hash[k] = LOG[PLACE.0 + k];
        k += 1;
    }
    hash
};

/// The hash of the commit, if the command was built in a repository.
pub(crate) fn commit() -> Option<&'static str> {
    let hash = std::str::from_utf8(&HASH).ok()?;
    (!hash.is_empty()).then_some(hash)
}

/// The begin and the length of the second word in the last line of a log, whose lines are
/// `hash-before hash-after who when<tab>what`.
const fn place(log: &[u8]) -> (usize, usize) {
    let mut end = log.len();
    while end > 0 && log[end - 1] == b'\n' {
        end -= 1;
    }
    let mut k = end;
    while k > 0 && log[k - 1] != b'\n' {
        k -= 1;
    }
    let before = end_of_hash(log, k);
    let after = end_of_hash(log, before + 1);
    if before > k && after > before + 1 && after < end && log[after] == b' ' {
        (before + 1, after - before - 1)
    } else {
        (0, 0)
    }
}

/// Where a hash ends that begins at a place.
const fn end_of_hash(log: &[u8], mut k: usize) -> usize {
    while k < log.len() && log[k].is_ascii_hexdigit() {
        k += 1;
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_the_second_one_of_the_last_line() {
        let hash = |log: &'static str| {
            let (begin, length) = place(log.as_bytes());
            &log[begin..begin + length]
        };
        let log =
            "00 a1 A <a@b> 1 +0000\tcommit (initial): a\na1 b2c3 A <a@b> 2 +0000\tcommit: b\n";
        assert_eq!(hash(log), "b2c3");
        assert_eq!(hash(log.trim_end()), "b2c3");
        for none in [
            "", "\n", "a1", "a1 ", "a1 b2", "a1 b2\n", "no log\n", " a1 ",
        ] {
            assert_eq!(hash(none), "", "{none:?}");
        }
    }
}
