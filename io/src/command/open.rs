//! Pages in the browser of the user.

use super::message::print_message;
use std::path::Path;

/// Opens a page with the program that the system has for it. Where there is none, a warning says so: the page
/// is written all the same.
pub(crate) fn open_page(page: &Path) {
    let whole = page.canonicalize();
    let opened = whole.and_then(::open::that_detached);
    if let Err(error) = opened {
        print_message(format_args!(
            "warning: cannot open {page}: {error}\n  = help: open {page} in a browser",
            page = page.display()
        ));
    }
}
