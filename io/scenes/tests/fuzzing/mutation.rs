//! Random changes of files, for readers of text and of binary formats alike.

use rand::{Rng, RngExt};

/// A file is not made longer than this many bytes.
const LONGEST: usize = 1 << 16;

/// Numbers and words at which readers go wrong: signs, ends of ranges, what is not finite, empty and nested
/// values.
const TOKENS: [&str; 40] = [
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "3",
    "255",
    "65536",
    "4294967295",
    "4294967296",
    "2147483648",
    "18446744073709551615",
    "-9223372036854775808",
    "1e-320",
    "1e308",
    "-1e308",
    "1e999",
    "1e39",
    "nan",
    "inf",
    "-inf",
    "NaN",
    "Infinity",
    "null",
    "true",
    "\"\"",
    "[]",
    "{}",
    "[[",
    "]]",
    "[[[[[[[[",
    "{ a = 1 }",
    "1/1/1",
    "0.1.2",
    "#",
    "\\",
    "\r\n",
    "\u{feff}",
    "\t",
    "é",
];

/// A changed copy of one of the seeds.
pub(crate) fn mutate(seeds: &[Vec<u8>], rng: &mut impl Rng) -> Vec<u8> {
    let mut data = seeds[rng.random_range(0..seeds.len())].clone();
    for _ in 0..rng.random_range(1..=6) {
        change(&mut data, seeds, rng);
    }
    data.truncate(LONGEST);
    data
}

fn change(data: &mut Vec<u8>, seeds: &[Vec<u8>], rng: &mut impl Rng) {
    let (from, to) = range(data, rng);
    match rng.random_range(0..11) {
        0 => flip_bit(data, rng),
        1 => drop(data.splice(from..to, [])),
        2 => {
            let part = data[from..to].to_vec();
            let at = rng.random_range(0..=data.len());
            data.splice(at..at, part);
        }
        3 => {
            let other = &seeds[rng.random_range(0..seeds.len())];
            let (a, b) = range(other, rng);
            data.splice(from..to, other[a..b].to_vec());
        }
        4 => data.truncate(to),
        5 => {
            let byte = rng.random_range(0..=255);
            data.splice(from..from, [byte]);
        }
        6 => overwrite(data, from, rng),
        7 => swap_tokens(data, rng),
        8 => {
            let part = data[from..to].repeat(rng.random_range(2..40));
            data.splice(from..to, part);
        }
        _ => replace_token(data, rng),
    }
}

/// A part of the data, short more often than long.
fn range(data: &[u8], rng: &mut impl Rng) -> (usize, usize) {
    let from = rng.random_range(0..=data.len());
    let longest = 1usize << rng.random_range(0..10);
    let to = data.len().min(from + rng.random_range(0..=longest));
    (from, to)
}

fn flip_bit(data: &mut [u8], rng: &mut impl Rng) {
    if !data.is_empty() {
        let at = rng.random_range(0..data.len());
        data[at] ^= 1 << rng.random_range(0..8);
    }
}

/// Writes a number in binary over what is there: an end of a range, or what is not finite.
fn overwrite(data: &mut [u8], at: usize, rng: &mut impl Rng) {
    let bytes: Vec<u8> = match rng.random_range(0..8) {
        0 => vec![0xff],
        1 => u32::MAX.to_le_bytes().to_vec(),
        2 => u32::MAX.to_be_bytes().to_vec(),
        3 => 0x7fff_ffffu32.to_le_bytes().to_vec(),
        4 => f64::NAN.to_le_bytes().to_vec(),
        5 => f32::INFINITY.to_le_bytes().to_vec(),
        6 => 0u32.to_le_bytes().to_vec(),
        _ => f64::MAX.to_le_bytes().to_vec(),
    };
    for (to, from) in data[at..].iter_mut().zip(bytes) {
        *to = from;
    }
}

/// The words and numbers of a text, as ranges of bytes.
fn tokens(data: &[u8]) -> Vec<(usize, usize)> {
    let is_part = |b: &u8| b.is_ascii_alphanumeric() || b"+-._".contains(b);
    let mut found = Vec::new();
    let mut at = 0;
    while at < data.len() {
        let length = data[at..].iter().take_while(|b| is_part(b)).count();
        if length > 0 {
            found.push((at, at + length));
        }
        at += length + 1;
    }
    found
}

fn replace_token(data: &mut Vec<u8>, rng: &mut impl Rng) {
    let tokens = tokens(data);
    if !tokens.is_empty() {
        let (from, to) = tokens[rng.random_range(0..tokens.len())];
        let by = TOKENS[rng.random_range(0..TOKENS.len())];
        data.splice(from..to, by.bytes());
    }
}

fn swap_tokens(data: &mut Vec<u8>, rng: &mut impl Rng) {
    let tokens = tokens(data);
    if tokens.len() > 1 {
        let (from, to) = tokens[rng.random_range(0..tokens.len())];
        let (a, b) = tokens[rng.random_range(0..tokens.len())];
        data.splice(from..to, data[a..b].to_vec());
    }
}
