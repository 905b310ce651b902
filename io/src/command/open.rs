//! Pages in the browser of the user.

use super::message::print_message;
use std::fmt::Display;
use std::io;
use std::path::Path;

/// Opens a page with the program that the system has for it. Where there is none, a warning says so: the page
/// is written all the same.
pub(crate) fn open_page(page: &Path) {
    let whole = page.canonicalize();
    warn(whole.and_then(::open::that_detached), page.display());
}

/// Opens an address in the browser. Where there is none, a warning says so.
pub(crate) fn open_address(address: &str) {
    warn(::open::that_detached(address), address);
}

fn warn(opened: io::Result<()>, what: impl Display) {
    if let Err(error) = opened {
        print_message(format_args!(
            "warning: cannot open {what}: {error}\n  = help: open {what} in a browser"
        ));
    }
}
