//! Numbers as short texts: differences in time, byte planes, gzip, base64.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::{Serialize, Serializer};

/// Unsigned integers of one or two bytes, in rows of equal length: one row for each frame.
#[derive(Serialize)]
pub(super) struct Packed {
    /// Bytes of an integer: 1 or 2.
    bytes: usize,
    /// 0 for the integers themselves, 1 and 2 for their first and second differences in time.
    order: usize,
    /// The byte planes, compressed.
    data: String,
}

/// Packs rows of integers below `2^(8 bytes)` with the order of differences that makes the shortest text.
///
/// Differences are taken modulo `2^(8 bytes)` from the rows before, where rows before the first are zero, and
/// mapped to unsigned integers by `0, -1, 1, -2, ... -> 0, 1, 2, 3, ...` (zigzag).
pub(super) fn pack_rows(rows: &[Vec<u16>], bytes: usize) -> Packed {
    let orders = (0..=2).map(|order| Packed {
        bytes,
        order,
        data: compress(&planes(differences(rows, order, bytes), bytes)),
    });
    orders
        .min_by_key(|packed| packed.data.len())
        .expect("there are three orders")
}

/// The differences of some order in time as zigzag integers, row after row, in little-endian bytes.
fn differences(rows: &[Vec<u16>], order: usize, bytes: usize) -> Vec<[u8; 2]> {
    let bits = 8 * bytes as u32;
    let zigzag = |difference: i32| {
        // Shifts cut the difference to `bits` bits and repeat its sign.
        let signed = difference << (32 - bits) >> (32 - bits);
        ((signed << 1) ^ (signed >> 31)) as u16
    };
    let mut out = Vec::with_capacity(rows.iter().map(Vec::len).sum());
    for (k, row) in rows.iter().enumerate() {
        for (i, &value) in row.iter().enumerate() {
            let before = |lag: usize| {
                if k < lag {
                    0
                } else {
                    i32::from(rows[k - lag][i])
                }
            };
            let value = i32::from(value);
            let integer = match order {
                0 => value as u16,
                1 => zigzag(value - before(1)),
                _ => zigzag(value - 2 * before(1) + before(2)),
            };
            out.push(integer.to_le_bytes());
        }
    }
    out
}

/// The first bytes of all items, then their second bytes, and so on for `count` bytes of each.
fn planes<const N: usize>(items: Vec<[u8; N]>, count: usize) -> Vec<u8> {
    (0..count)
        .flat_map(|byte| items.iter().map(move |item| item[byte]))
        .collect()
}

/// Packs doubles without a loss.
pub(super) fn pack_doubles(values: impl IntoIterator<Item = f64>) -> String {
    compress(&planes(
        values.into_iter().map(f64::to_le_bytes).collect(),
        8,
    ))
}

/// Packs indices.
pub(super) fn pack_indices(values: &[u32]) -> String {
    compress(&planes(values.iter().map(|v| v.to_le_bytes()).collect(), 4))
}

/// Writes doubles as [`pack_doubles`] packs them.
pub(super) fn packed_doubles<S: Serializer>(
    values: &[f64],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&pack_doubles(values.iter().copied()))
}

/// Writes the corners of triangles as [`pack_indices`] packs them.
pub(super) fn packed_triangles<S: Serializer>(
    faces: &[[u32; 3]],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&pack_indices(faces.as_flattened()))
}

/// Packs a text.
pub(super) fn pack_text(text: &str) -> String {
    compress(text.as_bytes())
}

fn compress(bytes: &[u8]) -> String {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::new(6));
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    STANDARD.encode(written.expect("memory takes every byte"))
}
