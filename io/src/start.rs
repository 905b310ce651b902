//! `isosheet new`.

use super::failure::{Code, Done, Failure};
use super::message::print_result;
use clap::builder::{PathBufValueParser, PossibleValue, TypedValueParser};
use clap::{Args, ValueEnum};
use isosheet_files::write_atomically;
use isosheet_scenes::StartingPoint;
use std::ffi::OsStr;
use std::io::Write;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  isosheet new cloth                           a sheet of paper that hangs by one corner, in cloth.toml
  isosheet new cloth --kind drape              a tablecloth that drapes over a table
  isosheet new -o scenes/punch.toml --kind stamp";

/// Write a commented scene to start from
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES)]
pub(crate) struct New {
    /// The name of the scene; the file is NAME.toml in the current folder
    #[arg(required_unless_present = "out", conflicts_with = "out")]
    #[arg(value_parser = PathBufValueParser::new().try_map(file_name))]
    name: Option<PathBuf>,
    /// The file to write [default: NAME.toml]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// What it shows
    #[arg(long, value_enum, default_value_t = Kind(StartingPoint::Hanging))]
    kind: Kind,
}

/// A starting point as a value on the command line.
#[derive(Clone, Copy, Debug)]
struct Kind(StartingPoint);

impl Kind {
    const ALL: [Self; StartingPoint::ALL.len()] = {
        let mut all = [Self(StartingPoint::Hanging); StartingPoint::ALL.len()];
        let mut k = 0;
        while k < all.len() {
            all[k] = Self(StartingPoint::ALL[k]);
            k += 1;
        }
        all
    };
}

impl ValueEnum for Kind {
    fn value_variants<'a>() -> &'a [Self] {
        &Self::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.name()).help(self.0.about()))
    }
}

/// Refuses a path that does not end in the name of a file, such as `..` or `scenes/`.
fn file_name(path: PathBuf) -> Result<PathBuf, &'static str> {
    let end = |name: &OsStr| {
        path.as_os_str()
            .as_encoded_bytes()
            .ends_with(name.as_encoded_bytes())
    };
    match path.file_name().is_some_and(end) {
        true => Ok(path),
        false => Err("it does not end in a name; write for example `cloth` or `scenes/cloth`"),
    }
}

impl New {
    pub(crate) fn run(&self) -> Done {
        let path = self.path();
        if path.exists() {
            let message = format!("{} exists", path.display());
            return Err(Failure::new(Code::Output, message).remedy("choose another name"));
        }
        let text = self.kind.0.text();
        write_atomically(&path, |w| w.write_all(text.as_bytes()))
            .map_err(|e| Failure::of(Code::Output, &e))?;
        print_result(format_args!(
            "wrote {path}; run it with `isosheet simulate {path}`",
            path = path.display()
        ))
    }

    /// The file to write: the name of a scene gets its extension, the file of `--out` is taken as it is.
    fn path(&self) -> PathBuf {
        if let Some(out) = &self.out {
            return out.clone();
        }
        let mut path = self.name.clone().unwrap_or_default();
        if path.extension().is_none_or(|e| e != "toml") {
            path.as_mut_os_string().push(".toml");
        }
        path
    }
}
