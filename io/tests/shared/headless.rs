//! A browser without a window. Tests that need one run where Chromium or Chrome is installed, and say so
//! where it is not.

use crate::skip::{runs, skipped};
use serde_json::Value;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];
/// How long a browser may take: some seconds suffice on an idle machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// A browser that starts. Without one the test is skipped.
pub(crate) fn browser() -> Option<&'static str> {
    let browser = BROWSERS.into_iter().find(|name| runs(name, &["--version"]));
    if browser.is_none() {
        skipped("browser", &format!("none of {BROWSERS:?} is installed"));
    }
    browser
}

/// What the test of itself of a page says in a window of the given size, or `None` without a browser.
pub(crate) fn self_test(page: &str, window: &str) -> Option<Value> {
    let browser = browser()?;
    let folder = tempfile::tempdir().unwrap();
    let (html, dump) = (
        folder.path().join("page.html"),
        folder.path().join("dump.html"),
    );
    std::fs::write(&html, page).unwrap();
    run(browser, &html, &dump, folder.path(), window);
    let dump = std::fs::read_to_string(&dump).unwrap();
    let body = &dump[dump.find("<body").expect("the browser wrote a page")..];
    let attribute = |name: &str| {
        let (_, rest) = body[..body.find('>').unwrap()].split_once(&format!("{name}=\""))?;
        let (text, _) = rest.split_once('"')?;
        Some(
            text.replace("&quot;", "\"")
                .replace("&lt;", "<")
                .replace("&gt;", ">")
                .replace("&amp;", "&"),
        )
    };
    assert_eq!(attribute("data-failure"), None);
    let result = attribute("data-selftest").expect("the page tested itself");
    Some(serde_json::from_str(&result).unwrap())
}

fn run(browser: &str, html: &Path, dump: &Path, folder: &Path, window: &str) {
    let mut child = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
        ])
        .args(["--virtual-time-budget=20000", "--dump-dom"])
        .arg(format!("--window-size={window}"))
        .arg(format!(
            "--user-data-dir={}",
            folder.join("profile").display()
        ))
        .arg(format!("file://{}#selftest=1", html.display()))
        .stdout(File::create(dump).unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("{browser} did not end within {PATIENCE:?}");
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}
