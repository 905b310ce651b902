//! Blocks, and where they are inserted.

use super::groups::{Record, section};
use isosheet_files::DataError;
use std::collections::HashMap;

/// Entities that are drawn wherever the block is inserted.
pub(super) struct Block<'a, 'b> {
    pub(super) name: &'a str,
    /// The point that is put where it is inserted.
    base: [f64; 2],
    pub(super) entities: &'b [Record<'a>],
}

/// The blocks by their names in capital letters, as the format does not tell these from small ones.
pub(super) struct Blocks<'a, 'b>(HashMap<String, Block<'a, 'b>>);

/// A map of the plane: where its axes go, and where the origin goes.
pub(super) type Place = [[f64; 2]; 3];

/// The map that takes `inner` first.
pub(super) fn compose(outer: Place, inner: Place) -> Place {
    let linear = |p: [f64; 2]| [0, 1].map(|k| outer[0][k] * p[0] + outer[1][k] * p[1]);
    let [u, v, w] = inner.map(linear);
    [u, v, [w[0] + outer[2][0], w[1] + outer[2][1]]]
}

impl<'a, 'b> Blocks<'a, 'b> {
    pub(super) fn of(records: &'b [Record<'a>]) -> Result<Self, DataError> {
        let mut blocks = HashMap::new();
        let mut rest = section(records, "BLOCKS")?;
        while let Some(begin) = rest.iter().position(|r| r.kind == "BLOCK") {
            let (head, tail) = (&rest[begin], &rest[begin + 1..]);
            let end = tail.iter().position(|r| r.kind == "ENDBLK");
            let end = end.unwrap_or(tail.len());
            let name = head.text(2).unwrap_or_default();
            let base = [head.number(10)?, head.number(20)?].map(|c| c.unwrap_or(0.0));
            let block = Block {
                name,
                base,
                entities: &tail[..end],
            };
            blocks.insert(name.to_uppercase(), block);
            rest = &tail[end..];
        }
        Ok(Self(blocks))
    }

    /// The block that an entity inserts; `None` if the file has no such block.
    pub(super) fn of_insert(&self, insert: &Record<'_>) -> Option<&Block<'a, 'b>> {
        self.0.get(&insert.text(2)?.to_uppercase())
    }
}

impl Block<'_, '_> {
    /// The places of all copies that an entity makes, in rows and columns that turn with the block and do not
    /// grow with it.
    pub(super) fn places(
        &self,
        insert: &Record<'_>,
    ) -> Result<impl Iterator<Item = Place> + use<>, DataError> {
        let or = |code, default: f64| Ok::<_, DataError>(insert.number(code)?.unwrap_or(default));
        let count = |code| Ok::<_, DataError>(insert.flags(code)?.max(1));
        let [x, y] = insert.point(10)?;
        let scale = [or(41, 1.0)?, or(42, 1.0)?];
        let (sin, cos) = or(50, 0.0)?.to_radians().sin_cos();
        let (columns, rows) = (count(70)?, count(71)?);
        let apart = [or(44, 0.0)?, or(45, 0.0)?];
        // From below its coordinates are mirrored.
        let side = or(230, 1.0)?.signum();
        let seen = [[side, 0.0], [0.0, 1.0], [0.0, 0.0]];
        let turned = [[cos, sin], [-sin, cos], [x, y]];
        let sized = [[scale[0], 0.0], [0.0, scale[1]]];
        let base = [0, 1].map(|k| -scale[k] * self.base[k]);
        let copies = (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row]));
        Ok(copies.map(move |copy| {
            let moved = [0, 1].map(|k| base[k] + copy[k] as f64 * apart[k]);
            compose(seen, compose(turned, [sized[0], sized[1], moved]))
        }))
    }
}
