//! The oldest toolchain that `Cargo.toml` names is one with which all dependencies can be built.

use serde_json::Value;
use std::env;
use std::path::Path;
use std::process::Command;

/// The numbers of a version such as `1.89`, with zeros for those that are left out.
fn numbers(version: &str) -> [u32; 3] {
    let mut numbers = [0; 3];
    for (number, word) in numbers.iter_mut().zip(version.split('.')) {
        *number = word.parse().expect("a number");
    }
    numbers
}

#[test]
fn no_dependency_asks_for_a_newer_toolchain() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let output = Command::new(env::var_os("CARGO").expect("cargo runs the tests"))
        .args([
            "metadata",
            "--locked",
            "--format-version",
            "1",
            "--manifest-path",
        ])
        .arg(root.join("Cargo.toml"))
        .output()
        .expect("cargo");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    let asked = |package: &Value| package["rust_version"].as_str().map(numbers);
    let own = packages
        .iter()
        .find(|package| package["name"] == "isosheet");
    let own = own
        .and_then(asked)
        .expect("`rust-version` of the workspace");
    let newer: Vec<String> = packages
        .iter()
        .filter(|package| asked(package) > Some(own))
        .map(|package| {
            format!(
                "{} {}: {}",
                package["name"], package["version"], package["rust_version"]
            )
        })
        .collect();
    assert!(
        packages.len() > 100 && newer.is_empty(),
        "{}",
        newer.join("\n")
    );
}
