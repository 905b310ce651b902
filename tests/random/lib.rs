//! The seeds of all random tests: fixed, so that `cargo test` gives the same verdict on every machine, every
//! time. `cargo xtask soak` searches with new ones.

use proptest::test_runner::{Config, RngSeed};

/// How many times as many cases as usual random tests try, a whole number: for `cargo xtask soak`.
pub const TIMES: &str = "ISOSHEET_TIMES";

/// The variable of proptest with the seed of all random tests, a whole number.
pub const SEED: &str = "PROPTEST_RNG_SEED";

/// The seed of random tests: 1, or that of [`SEED`].
pub fn seed() -> u64 {
    match Config::default().rng_seed {
        RngSeed::Fixed(seed) => seed,
        RngSeed::Random => 1,
    }
}

/// How many times as many cases as usual are tried: once, or as [`TIMES`] says.
///
/// # Panics
/// If the value of the variable is no whole number.
pub fn times() -> u32 {
    std::env::var(TIMES).map_or(1, |text| {
        let times = text.parse();
        times.unwrap_or_else(|_| panic!("{TIMES} is {text:?}, a whole number is expected"))
    })
}

/// The configuration of a random test that usually tries so many cases. A case that fails is printed; no file
/// is written that later runs would depend on.
pub fn cases(count: u32) -> Config {
    Config {
        cases: count * times(),
        rng_seed: RngSeed::Fixed(seed()),
        failure_persistence: None,
        ..Config::default()
    }
}
