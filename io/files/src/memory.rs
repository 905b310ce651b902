//! How much memory there is.

/// Where the system does not say how much memory is free, so much is taken for it, bytes.
const UNKNOWN: u64 = 8 << 30;

/// The memory that this process may still get, bytes: what the system says is free, within the limits of the
/// process and of its control group.
pub fn free() -> u64 {
    let limits = [free_of_machine(), limit_of_group(), limit_of_process()];
    limits.into_iter().flatten().min().unwrap_or(UNKNOWN)
}

/// The memory that programs can get without swapping, where the system says it as Linux does.
fn free_of_machine() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// What is left of the memory of the control group, as containers have them.
fn limit_of_group() -> Option<u64> {
    let number = |name: &str| -> Option<u64> {
        let text = std::fs::read_to_string(format!("/sys/fs/cgroup/memory.{name}"));
        text.ok()?.trim().parse().ok()
    };
    Some(number("max")?.saturating_sub(number("current")?))
}

/// What is left of the address space of the process, where that has a limit (`ulimit -v`).
fn limit_of_process() -> Option<u64> {
    #[cfg(unix)]
    return {
        let limit = rustix::process::getrlimit(rustix::process::Resource::As).current?;
        Some(limit.saturating_sub(address_space().unwrap_or(0)))
    };
    #[cfg(not(unix))]
    None
}

/// The address space that the process has, where the system says it as Linux does.
#[cfg(unix)]
fn address_space() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("VmSize:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}
