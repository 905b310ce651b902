//! Reads the data of a page back. Written after the documentation of the module `view`, not after its code.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::GzDecoder;
use serde_json::Value;
use std::io::Read;

/// The data of a page as JSON.
pub(crate) fn document(page: &str) -> Value {
    let (_, rest) = page
        .split_once(r#"<script type="application/json" id="replay">"#)
        .unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(json).unwrap()
}

fn inflate(text: &Value) -> Vec<u8> {
    let bytes = STANDARD.decode(text.as_str().unwrap()).unwrap();
    let mut out = Vec::new();
    GzDecoder::new(bytes.as_slice())
        .read_to_end(&mut out)
        .unwrap();
    out
}

/// Item k of numbers of `N` bytes whose bytes are in planes.
fn item<const N: usize>(planes: &[u8], k: usize) -> [u8; N] {
    let count = planes.len() / N;
    std::array::from_fn(|byte| planes[byte * count + k])
}

pub(crate) fn doubles(text: &Value) -> Vec<f64> {
    let planes = inflate(text);
    (0..planes.len() / 8)
        .map(|k| f64::from_le_bytes(item(&planes, k)))
        .collect()
}

pub(crate) fn indices(text: &Value) -> Vec<u32> {
    let planes = inflate(text);
    (0..planes.len() / 4)
        .map(|k| u32::from_le_bytes(item(&planes, k)))
        .collect()
}

/// The integers of a packed table, row by row: sums of differences, with the modulus taken at the end.
pub(crate) fn rows(packed: &Value, rows: usize) -> Vec<Vec<i64>> {
    let planes = inflate(&packed["data"]);
    let (order, bytes) = (
        packed["order"].as_u64().unwrap(),
        packed["bytes"].as_u64().unwrap(),
    );
    let raw: Vec<i64> = match bytes {
        1 => planes.iter().map(|&b| i64::from(b)).collect(),
        _ => (0..planes.len() / 2)
            .map(|k| u16::from_le_bytes(item(&planes, k)).into())
            .collect(),
    };
    let width = raw.len() / rows;
    let mut table: Vec<Vec<i64>> = raw.chunks(width).map(<[i64]>::to_vec).collect();
    if order > 0 {
        for z in table.iter_mut().flatten() {
            *z = if *z % 2 == 0 { *z / 2 } else { -(*z + 1) / 2 };
        }
    }
    for _ in 0..order {
        for k in 1..rows {
            for i in 0..width {
                table[k][i] += table[k - 1][i];
            }
        }
    }
    for v in table.iter_mut().flatten() {
        *v = v.rem_euclid(1 << (8 * bytes));
    }
    table
}

/// The positions of all frames.
pub(crate) fn positions(data: &Value) -> Vec<Vec<f64>> {
    let low: Vec<f64> = (0..3).map(|k| data["low"][k].as_f64().unwrap()).collect();
    let step = data["step"].as_f64().unwrap();
    let table = rows(&data["positions"], frames(data));
    let row = |row: &Vec<i64>| {
        row.iter()
            .enumerate()
            .map(|(i, &q)| low[i % 3] + step * q as f64)
            .collect()
    };
    table.iter().map(row).collect()
}

pub(crate) fn frames(data: &Value) -> usize {
    data["frames"].as_u64().unwrap() as usize
}

/// The values of a field in all frames.
pub(crate) fn field(data: &Value, index: usize) -> Vec<Vec<f64>> {
    let field = &data["fields"][index];
    let (low, step) = (
        field["low"].as_f64().unwrap(),
        field["step"].as_f64().unwrap(),
    );
    let value = |&q: &i64| match (field["scale"].as_str().unwrap(), q) {
        ("linear", q) => low + step * q as f64,
        (_, 0) => 0.0,
        ("signed", q) if q > 32767 => -10_f64.powf(low + step * (q - 32769) as f64),
        (_, q) => 10_f64.powf(low + step * (q - 1) as f64),
    };
    let table = rows(&field["values"], frames(data));
    table
        .iter()
        .map(|row| row.iter().map(value).collect())
        .collect()
}

/// FNV-1a of 32 bits over 16-bit integers, low bytes first, as the page computes it of what it decoded.
pub(crate) fn checksum(table: &[Vec<i64>]) -> u64 {
    let mut hash = 0x811c_9dc5_u32;
    for &value in table.iter().flatten() {
        for byte in [value & 255, value >> 8] {
            hash = (hash ^ byte as u32).wrapping_mul(0x0100_0193);
        }
    }
    hash.into()
}
