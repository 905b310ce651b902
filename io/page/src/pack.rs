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

/// Packs rows of integers below `2^(8 bytes)`, which come one after the other and once for each byte plane,
/// with the order of differences that makes the shortest text.
///
/// Differences are taken modulo `2^(8 bytes)` from the rows before, where rows before the first are zero, and
/// mapped to unsigned integers by `0, -1, 1, -2, ... -> 0, 1, 2, 3, ...` (zigzag).
pub(super) struct RowPacker {
    bytes: usize,
    /// The byte plane that is written, from 0, the low bytes.
    plane: usize,
    /// The two rows before, the last one first; empty where there is none.
    before: [Vec<u16>; 2],
    /// One for each order.
    encoders: [GzEncoder<Vec<u8>>; 3],
}

impl RowPacker {
    pub(super) fn new(bytes: usize) -> Self {
        Self {
            bytes,
            plane: 0,
            before: Default::default(),
            encoders: std::array::from_fn(|_| encoder()),
        }
    }

    /// Begins a byte plane, in which all rows come again. Returns whether the integers have it.
    pub(super) fn begin_plane(&mut self, plane: usize) -> bool {
        self.plane = plane;
        self.before.iter_mut().for_each(Vec::clear);
        plane < self.bytes
    }

    /// Adds a row.
    pub(super) fn push(&mut self, row: &[u16]) {
        let bits = 8 * self.bytes as u32;
        let zigzag = |difference: i32| {
            // Shifts cut the difference to `bits` bits and repeat its sign.
            let signed = difference << (32 - bits) >> (32 - bits);
            ((signed << 1) ^ (signed >> 31)) as u16
        };
        let [last, second] = &self.before;
        let before = |row: &[u16], i: usize| row.get(i).map_or(0, |&v| i32::from(v));
        for (order, encoder) in self.encoders.iter_mut().enumerate() {
            let integer = |(i, &value): (usize, &u16)| match order {
                0 => value,
                1 => zigzag(i32::from(value) - before(last, i)),
                _ => zigzag(i32::from(value) - 2 * before(last, i) + before(second, i)),
            };
            let integers = row.iter().enumerate().map(integer);
            let plane: Vec<u8> = integers.map(|n| n.to_le_bytes()[self.plane]).collect();
            encoder.write_all(&plane).expect("memory takes every byte");
        }
        self.before.swap(0, 1);
        self.before[0].clear();
        self.before[0].extend_from_slice(row);
    }

    /// The length that the text has at least.
    pub(super) fn least_length(&self) -> usize {
        let lengths = self.encoders.iter().map(|e| e.get_ref().len());
        lengths.min().unwrap_or_default() / 3 * 4
    }

    pub(super) fn finish(self) -> Packed {
        let orders = self.encoders.into_iter().enumerate();
        let orders = orders.map(|(order, encoder)| Packed {
            bytes: self.bytes,
            order,
            data: text_of(encoder),
        });
        orders
            .min_by_key(|packed| packed.data.len())
            .expect("there are three orders")
    }
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
    let mut encoder = encoder();
    encoder.write_all(bytes).expect("memory takes every byte");
    text_of(encoder)
}

fn encoder() -> GzEncoder<Vec<u8>> {
    GzEncoder::new(Vec::new(), Compression::new(6))
}

fn text_of(encoder: GzEncoder<Vec<u8>>) -> String {
    STANDARD.encode(encoder.finish().expect("memory takes every byte"))
}
