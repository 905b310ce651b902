//! XML files of VTK (`.vtp`): arrays as text, in base 64 or as bytes after the XML, also compressed by zlib.

use super::{TimedPolygons, other_data, plain, strips};
use crate::mesh_file::error::{COPY, CORRECT, Located, cut_short, excerpt, unexpected};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use isosheet_files::xml::Entities;
use isosheet_files::{Allowance, DataError, xml};
use roxmltree::Node;
use std::borrow::Cow;
use std::cell::Cell;
use std::io::Read;

/// The points and polygons of a file of the type `PolyData`, and the field `TimeValue`. Vertices, lines and
/// data of points and cells are skipped.
pub(in crate::mesh_file) fn parse(bytes: &[u8]) -> Result<TimedPolygons, Located> {
    if bytes.is_empty() {
        return Ok(TimedPolygons::default());
    }
    polygons(bytes).map_err(plain)
}

fn polygons(bytes: &[u8]) -> Result<TimedPolygons, DataError> {
    let (text, appended) = divided(bytes)?;
    let document = xml::parse(text.trim_start_matches('\u{feff}'), Entities::Refused);
    let document = document.map_err(|e| DataError::new(e.to_string(), COPY))?;
    let root = document.root_element();
    if !root.has_tag_name("VTKFile") {
        let found = excerpt(root.tag_name().name());
        return Err(unexpected("the element VTKFile", &found));
    }
    let kind = root.attribute("type").unwrap_or_default();
    if kind != "PolyData" {
        return Err(other_data(&excerpt(kind)));
    }
    let form = Form::of(root, appended, Allowance::of(bytes.len()).half())?;
    let mut found = TimedPolygons::default();
    let named = |node: &Node<'_, '_>, name: &str| node.attribute("Name") == Some(name);
    let mut arrays = document
        .descendants()
        .filter(|n| n.has_tag_name("DataArray"));
    if let Some(time) = arrays.find(|n| named(n, "TimeValue")) {
        found.time = form.floats(time)?.first().copied();
    }
    for piece in document.descendants().filter(|n| n.has_tag_name("Piece")) {
        let count = |name: &str| {
            let text = piece.attribute(name).unwrap_or("0");
            text.parse::<usize>()
                .map_err(|_| unexpected(&format!("a number as {name}"), &excerpt(text)))
        };
        if count("NumberOfStrips")? > 0 {
            return Err(strips());
        }
        let within = |name: &str| {
            let parent = piece.children().find(|n| n.has_tag_name(name));
            let arrays = parent.into_iter().flat_map(|n| n.children());
            arrays.filter(|n| n.has_tag_name("DataArray"))
        };
        let cells = |name: &str| match within("Polys").find(|n| named(n, name)) {
            Some(array) => form.integers(array),
            None => Ok(Vec::new()),
        };
        let points = match within("Points").next() {
            Some(array) => form.floats(array)?,
            None => Vec::new(),
        };
        let (corners, ends) = (cells("connectivity")?, cells("offsets")?);
        let expected = [
            (
                "coordinates",
                count("NumberOfPoints")?.saturating_mul(3),
                points.len(),
            ),
            ("polygons", count("NumberOfPolys")?, ends.len()),
        ];
        for (what, expected, got) in expected {
            if expected != got {
                let message =
                    format!("a piece announces {expected} {what}, and its array has {got}");
                return Err(DataError::new(message, COPY));
            }
        }
        found.add(&points, &corners, &ends)?;
    }
    Ok(found)
}

/// The XML of a file, and the data that are appended to it, with their encoding.
fn divided(bytes: &[u8]) -> Result<(String, Appended<'_>), DataError> {
    let find = |from: usize, what: &[u8]| {
        let rest = &bytes[from..];
        let place = rest.windows(what.len()).position(|w| w == what);
        place.map(|place| from + place)
    };
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let Some(tag) = find(0, b"<AppendedData") else {
        return Ok((text(bytes), Appended::Nothing));
    };
    let begin = find(tag, b">").and_then(|end| Some((end, find(end, b"_")?)));
    let (end, begin) = begin.ok_or_else(|| cut_short("the data that are appended"))?;
    let data = &bytes[begin + 1..];
    let appended = if text(&bytes[tag..end]).contains("raw") {
        Appended::Raw(data)
    } else {
        Appended::Base64(data)
    };
    Ok((text(&bytes[..tag]) + "</VTKFile>", appended))
}

/// Data after the XML.
#[derive(Clone, Copy)]
enum Appended<'a> {
    Nothing,
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

/// How the arrays of a file are written.
struct Form<'a> {
    appended: Appended<'a>,
    /// Bytes of the numbers before an array.
    header: usize,
    is_big_endian: bool,
    is_compressed: bool,
    /// The bytes that further arrays may take: all may be made of one and the same part of a file.
    left: Cell<Allowance>,
}

/// The bytes of an array.
enum Source<'a> {
    Raw(&'a [u8]),
    Base64(Cow<'a, [u8]>),
}

/// Where the bytes of an array are behind the numbers before it.
struct Layout {
    begin: usize,
    /// The length of each part of the array in the file, and in the array.
    parts: Vec<[usize; 2]>,
}

impl Layout {
    /// All lengths of the parts together.
    fn lengths(&self) -> Option<[usize; 2]> {
        self.parts.iter().try_fold([0_usize; 2], |[a, b], [c, d]| {
            Some([a.checked_add(*c)?, b.checked_add(*d)?])
        })
    }
}

impl Source<'_> {
    /// So many bytes from one on. In base 64 they are written on their own or with all that follows.
    fn part(&self, from: usize, count: usize) -> Option<Vec<u8>> {
        match self {
            Self::Raw(bytes) => bytes
                .get(from..from.checked_add(count)?)
                .map(<[u8]>::to_vec),
            Self::Base64(text) => {
                let text = text.get(from..)?;
                let length = count.checked_add(2)? / 3 * 4;
                let mut bytes = STANDARD.decode(text.get(..length)?).ok()?;
                bytes.truncate(count);
                Some(bytes)
            }
        }
    }

    /// The place after so many bytes that are written on their own from one on.
    fn after(&self, from: usize, count: usize) -> usize {
        match self {
            Self::Raw(_) => from + count,
            Self::Base64(_) => from + count.div_ceil(3) * 4,
        }
    }
}

impl<'a> Form<'a> {
    fn of(root: Node<'_, '_>, appended: Appended<'a>, left: Allowance) -> Result<Self, DataError> {
        let header = match root.attribute("header_type") {
            Some("UInt64") => 8,
            Some("UInt32") | None => 4,
            Some(other) => return Err(unexpected("header_type UInt32 or UInt64", &excerpt(other))),
        };
        let compressor = root.attribute("compressor");
        if compressor.is_some_and(|name| name != "vtkZLibDataCompressor") {
            let found = excerpt(compressor.unwrap_or_default());
            let message = format!("the arrays are compressed by {found}");
            return Err(DataError::new(
                message,
                "export it without compression, or with ZLib",
            ));
        }
        Ok(Self {
            appended,
            header,
            is_big_endian: root.attribute("byte_order") == Some("BigEndian"),
            is_compressed: compressor.is_some(),
            left: Cell::new(left),
        })
    }

    /// The values of an array of floats.
    fn floats(&self, array: Node<'_, '_>) -> Result<Vec<f64>, DataError> {
        let kind = array.attribute("type").unwrap_or_default();
        match kind {
            "Float32" => self.values(array, |b: [u8; 4]| f64::from(f32::from_le_bytes(b))),
            "Float64" => self.values(array, f64::from_le_bytes),
            _ => {
                let integers = self.integers(array)?;
                Ok(integers.into_iter().map(|v| v as f64).collect())
            }
        }
    }

    /// The values of an array of integers.
    fn integers(&self, array: Node<'_, '_>) -> Result<Vec<i64>, DataError> {
        match array.attribute("type").unwrap_or_default() {
            "Int8" => self.values(array, |b| i64::from(i8::from_le_bytes(b))),
            "UInt8" => self.values(array, |b| i64::from(u8::from_le_bytes(b))),
            "Int16" => self.values(array, |b| i64::from(i16::from_le_bytes(b))),
            "UInt16" => self.values(array, |b| i64::from(u16::from_le_bytes(b))),
            "Int32" => self.values(array, |b| i64::from(i32::from_le_bytes(b))),
            "UInt32" => self.values(array, |b| i64::from(u32::from_le_bytes(b))),
            "Int64" | "UInt64" => self.values(array, i64::from_le_bytes),
            other => Err(unexpected("an array of numbers", &excerpt(other))),
        }
    }

    /// The values of an array, each of `N` bytes.
    fn values<T: std::str::FromStr, const N: usize>(
        &self,
        array: Node<'_, '_>,
        of: impl Fn([u8; N]) -> T,
    ) -> Result<Vec<T>, DataError> {
        let name = excerpt(array.attribute("Name").unwrap_or_default());
        let wrong = |what: &str| DataError::new(format!("the array {name:?} {what}"), CORRECT);
        let text = || {
            let texts = array.children().filter_map(|n| n.text());
            texts.collect::<String>()
        };
        let source = match (array.attribute("format"), self.appended) {
            (Some("ascii") | None, _) => {
                let text = text();
                let words = text.split_ascii_whitespace();
                let values = words.map(|w| w.parse().ok());
                let values: Option<Vec<T>> = values.collect();
                return values.ok_or_else(|| wrong("has what is no number"));
            }
            (Some("binary"), _) => {
                let text = text();
                let code = text.bytes().filter(|b| !b.is_ascii_whitespace());
                Source::Base64(Cow::Owned(code.collect()))
            }
            (_, Appended::Nothing) => return Err(wrong("is appended, and nothing is")),
            (_, Appended::Raw(data)) => {
                let offset = offset(array).and_then(|at| data.get(at..));
                Source::Raw(offset.ok_or_else(|| wrong("begins beyond the end of the file"))?)
            }
            (_, Appended::Base64(data)) => {
                let offset = offset(array).and_then(|at| data.get(at..));
                let data = offset.ok_or_else(|| wrong("begins beyond the end of the file"))?;
                Source::Base64(Cow::Borrowed(data))
            }
        };
        let undecoded = || wrong("cannot be decoded, or was cut short");
        let layout = self.layout(&source).ok_or_else(undecoded)?;
        let [stored, length] = layout.lengths().ok_or_else(undecoded)?;
        let values = (length / N).saturating_mul(size_of::<T>());
        let mut left = self.left.get();
        left.spend(
            stored.saturating_add(length).saturating_add(values),
            &format!("the array {name:?}"),
        )?;
        self.left.set(left);
        let bytes = self.bytes(&source, &layout).ok_or_else(undecoded)?;
        let (values, rest) = bytes.as_chunks::<N>();
        if !rest.is_empty() {
            return Err(wrong("ends within a number"));
        }
        let in_order = |b: &[u8; N]| {
            let mut bytes = *b;
            if self.is_big_endian {
                bytes.reverse();
            }
            of(bytes)
        };
        Ok(values.iter().map(in_order).collect())
    }

    /// Reads the numbers before an array.
    fn layout(&self, source: &Source<'_>) -> Option<Layout> {
        let word = self.header;
        let numbers = |count: usize| -> Option<Vec<usize>> {
            let bytes = source.part(0, count.checked_mul(word)?)?;
            let value = |b: &[u8]| {
                let in_order = |value: u64, b: &u8| value << 8 | u64::from(*b);
                let value = match self.is_big_endian {
                    true => b.iter().fold(0, in_order),
                    false => b.iter().rev().fold(0, in_order),
                };
                usize::try_from(value).ok()
            };
            bytes.chunks_exact(word).map(value).collect()
        };
        if !self.is_compressed {
            let length = numbers(1)?[0];
            return Some(Layout {
                begin: word,
                parts: vec![[length; 2]],
            });
        }
        let [blocks, size, last] = numbers(3)?[..] else {
            return None;
        };
        let head = numbers(blocks.checked_add(3)?)?;
        let part = |(k, stored): (usize, &usize)| {
            let is_last = k + 1 == blocks && last > 0;
            [*stored, if is_last { last } else { size }]
        };
        Some(Layout {
            begin: source.after(0, head.len().checked_mul(word)?),
            parts: head[3..].iter().enumerate().map(part).collect(),
        })
    }

    /// The bytes of an array without the numbers before it.
    fn bytes(&self, source: &Source<'_>, layout: &Layout) -> Option<Vec<u8>> {
        let [stored, length] = layout.lengths()?;
        if !self.is_compressed {
            let mut all = source.part(0, layout.begin.checked_add(stored)?)?;
            all.drain(..layout.begin);
            return Some(all);
        }
        let mut compressed = &source.part(layout.begin, stored)?[..];
        let mut bytes = Vec::with_capacity(length);
        for &[stored, length] in &layout.parts {
            let (block, rest) = compressed.split_at_checked(stored)?;
            compressed = rest;
            let end = bytes.len() + length;
            let mut block = ZlibDecoder::new(block).take(length as u64);
            block.read_to_end(&mut bytes).ok()?;
            if bytes.len() != end {
                return None;
            }
        }
        Some(bytes)
    }
}

/// Where an array begins in the data that are appended.
fn offset(array: Node<'_, '_>) -> Option<usize> {
    array.attribute("offset")?.parse().ok()
}
