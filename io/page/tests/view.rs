//! The page of a run: what is in it, read by a decoder of its own, and what a browser makes of it.

#[path = "../../tests/shared/headless.rs"]
mod headless;
#[path = "../../tests/shared/skip.rs"]
mod skip;

#[path = "../../tests/shared/devtools.rs"]
mod devtools;

mod view {
    mod browser;
    mod decoder;
    mod encoding;
    mod errors;
    mod keys;
    mod parts;
    mod scenes;
}
