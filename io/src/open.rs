//! Pages in the browser of the user.

use super::message::print_message;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// Opens a page with the program that the system has for it. Where there is none, a warning says so: the page
/// is written all the same.
pub(crate) fn open_page(page: &Path) {
    let whole = page.canonicalize();
    warn(whole.and_then(::open::that_detached), page.display());
}

/// Opens an address in the browser by a file that leads to it, and which nobody but the user can read: others
/// see the arguments of processes, and the address has a secret. Where there is no browser, a warning says
/// so. Returns the file, which ends when it is dropped.
pub(crate) fn open_address(address: &str) -> Option<NamedTempFile> {
    let door = door(address);
    let opened = door.as_ref().map(|file| ::open::that_detached(file.path()));
    match opened {
        Ok(opened) => warn(opened, address),
        Err(error) => warn(
            Err(io::Error::new(error.kind(), error.to_string())),
            address,
        ),
    }
    door.ok()
}

/// A file that leads a browser to an address, which is that of a page of this machine.
fn door(address: &str) -> io::Result<NamedTempFile> {
    let mut file = tempfile::Builder::new()
        .prefix("isosheet-")
        .suffix(".html")
        .tempfile()?;
    write!(
        file,
        "<!doctype html><meta charset=\"utf-8\"><meta name=\"referrer\" content=\"no-referrer\">\
         <meta http-equiv=\"refresh\" content=\"0; url={address}\"><a href=\"{address}\">isosheet</a>"
    )?;
    file.flush()?;
    Ok(file)
}

fn warn(opened: io::Result<()>, what: impl Display) {
    if let Err(error) = opened {
        print_message(format_args!(
            "warning: cannot open {what}: {error}\n  = help: open {what} in a browser"
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_door_leads_to_the_address_and_is_for_the_user_alone() {
        let address = "http://127.0.0.1:4711/0a1b/";
        let file = door(address).unwrap();
        let text = std::fs::read_to_string(file.path()).unwrap();
        assert!(text.contains(&format!("url={address}\"")), "{text}");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = file.as_file().metadata().unwrap().permissions().mode();
            assert_eq!(mode & 0o077, 0);
        }
    }
}
