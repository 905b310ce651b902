//! The machine that a report was made on.

/// The processor, as the system names it.
pub(crate) fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        info.lines()
            .find(|l| l.starts_with(name))
            .and_then(|l| l.split_once(':'))
            .map(|(_, value)| value.trim().to_owned())
    };
    let name = field("model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let clock = field("cpu MHz")
        .and_then(|mhz| mhz.parse::<f64>().ok())
        .map(|mhz| format!(", {mhz:.0} MHz"))
        .unwrap_or_default();
    let noun = if cores == 1 { "core" } else { "cores" };
    format!("{name}{clock}, {cores} {noun}")
}
