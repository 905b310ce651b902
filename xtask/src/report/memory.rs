//! The memory that this process uses.

use std::fs;

/// Begins to measure the peak of the memory anew, where the system can (Linux). Elsewhere the peak stays that
/// of the whole process.
pub(crate) fn reset_peak_memory() {
    // A system that refuses goes on with the old peak.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Most resident memory of this process since [`reset_peak_memory`], bytes; `None` where the system does not
/// tell.
pub(crate) fn peak_memory() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kibibytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024.0 * kibibytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_holds_what_is_used() {
        let used = vec![1_u8; 1 << 26];
        if let Some(peak) = peak_memory() {
            assert!(peak > used.iter().map(|b| f64::from(*b)).sum(), "{peak}");
        }
    }
}
