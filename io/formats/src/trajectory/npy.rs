//! Arrays in the format `.npy` of numpy: a header, which is a dictionary in Python's syntax, and the entries
//! by rows.

use std::io::{self, Read, Write};

/// Numbers that arrays have.
pub(super) trait Number: Copy {
    /// Its kind and its bytes, as numpy names them.
    const KIND: &'static str;

    /// The nearest 64-bit float.
    fn as_f64(self) -> f64;

    /// Adds its bytes, the lowest first.
    fn put(self, bytes: &mut Vec<u8>);

    /// The number of so many bytes, the lowest first.
    fn of(bytes: &[u8]) -> Self;
}

macro_rules! numbers {
    ($($number:ty: $kind:literal),*) => {$(
        impl Number for $number {
            const KIND: &'static str = $kind;

            fn as_f64(self) -> f64 {
                self as f64
            }

            fn put(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }

            fn of(bytes: &[u8]) -> Self {
                let mut own = [0; size_of::<Self>()];
                own.copy_from_slice(bytes);
                Self::from_le_bytes(own)
            }
        }
    )*};
}

numbers!(
    f64: "f8", f32: "f4", i64: "i8", i32: "i4", i16: "i2", i8: "i1", u64: "u8", u32: "u4", u16: "u2", u8: "u1"
);

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// The longest header of an array, bytes: that of version 1 of the format.
const LONGEST_HEADER: u32 = 65_535;

/// About so many bytes are read and written at once.
const CHUNK: usize = 1 << 16;

/// Writes the header of an array of version 1, to a multiple of 64 bytes.
fn write_header<T: Number>(to: &mut impl Write, shape: &[u64]) -> io::Result<()> {
    let shape = match shape {
        [n] => format!("({n},)"),
        many => format!(
            "({})",
            many.iter()
                .map(u64::to_string)
                .collect::<Vec<_>>()
                .join(", ")
        ),
    };
    let kind = T::KIND;
    let header = format!("{{'descr': '<{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    // Six bytes of magic, two of the version, two of the length, and a line break.
    let padded = (header.len() + 11).next_multiple_of(64) - 11;
    let length = (padded + 1) as u16;
    to.write_all(MAGIC)?;
    to.write_all(&[1, 0])?;
    to.write_all(&length.to_le_bytes())?;
    writeln!(to, "{header:padded$}")
}

/// Writes an array, whose entries come one after the other.
pub(super) struct ArrayWriter<W> {
    to: W,
    bytes: Vec<u8>,
    /// Entries that are still to come.
    left: u64,
}

impl<W: Write> ArrayWriter<W> {
    pub(super) fn new<T: Number>(mut to: W, shape: &[u64]) -> io::Result<Self> {
        write_header::<T>(&mut to, shape)?;
        Ok(Self {
            to,
            bytes: Vec::with_capacity(CHUNK + 8),
            left: shape.iter().product(),
        })
    }

    pub(super) fn push(&mut self, value: impl Number) -> io::Result<()> {
        self.left = self.left.checked_sub(1).ok_or_else(other_shape)?;
        value.put(&mut self.bytes);
        if self.bytes.len() < CHUNK {
            return Ok(());
        }
        self.to.write_all(&self.bytes)?;
        self.bytes.clear();
        Ok(())
    }

    pub(super) fn finish(mut self) -> io::Result<()> {
        match self.left {
            0 => self.to.write_all(&self.bytes),
            _ => Err(other_shape()),
        }
    }
}

fn other_shape() -> io::Error {
    io::Error::new(
        io::ErrorKind::InvalidInput,
        "an array has another shape than its entries",
    )
}

/// What the header of an array says.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// The type of its entries as numpy writes it, such as `'<f8'`.
    pub(super) kind: String,
    /// Whether it is stored by columns.
    pub(super) by_columns: bool,
    pub(super) shape: Vec<u64>,
}

impl Header {
    /// Reads the header of an array.
    pub(super) fn read(from: &mut impl Read) -> io::Result<Self> {
        let wrong = |problem: String| io::Error::new(io::ErrorKind::InvalidData, problem);
        let mut start = [0; 8];
        from.read_exact(&mut start)?;
        if !start.starts_with(MAGIC) {
            return Err(wrong("it is no array of numpy".into()));
        }
        let mut length = [0; 4];
        let bytes = if start[6] == 1 { 2 } else { 4 };
        from.read_exact(&mut length[..bytes])?;
        let length = u32::from_le_bytes(length);
        if length > LONGEST_HEADER {
            return Err(wrong(format!("its header announces {length} bytes")));
        }
        let mut text = vec![0; length as usize];
        from.read_exact(&mut text)?;
        let text = String::from_utf8_lossy(&text);
        Self::parse(&text).ok_or_else(|| wrong(format!("its header is {:?}", text.trim())))
    }

    fn parse(text: &str) -> Option<Self> {
        let inner = text.trim().strip_prefix('{')?.strip_suffix('}')?;
        let entries: Vec<(&str, &str)> = parts(inner)?
            .into_iter()
            .map(|entry| entry.split_once(':'))
            .collect::<Option<_>>()?;
        let value = |name: &str| {
            let found = entries
                .iter()
                .find(|(key, _)| key.trim().trim_matches(['\'', '"']) == name);
            found.map(|(_, value)| value.trim())
        };
        let by_columns = match value("fortran_order")? {
            "True" => true,
            "False" => false,
            _ => return None,
        };
        let shape = value("shape")?.strip_prefix('(')?.strip_suffix(')')?;
        let shape = parts(shape)?.into_iter().map(|n| n.trim().parse().ok());
        Some(Self {
            kind: value("descr")?.to_owned(),
            by_columns,
            shape: shape.collect::<Option<_>>()?,
        })
    }

    /// Whether the entries are numbers of this kind, and if so whether the highest of their bytes is the
    /// first.
    pub(super) fn order_of<T: Number>(&self) -> Option<ByteOrder> {
        let kind = self.kind.trim_matches(['\'', '"']);
        match kind.strip_suffix(T::KIND)? {
            // A single byte has no order.
            "<" | "|" => Some(ByteOrder::LowestFirst),
            ">" => Some(ByteOrder::HighestFirst),
            _ => None,
        }
    }
}

/// The order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    LowestFirst,
    HighestFirst,
}

/// What stands between the commas of a text of Python, those in brackets and quotation marks left out.
fn parts(text: &str) -> Option<Vec<&str>> {
    let (mut depth, mut quote, mut start) = (0_usize, None, 0);
    let mut parts = Vec::new();
    for (place, c) in text.char_indices() {
        match (quote, c) {
            (Some(mark), _) if mark == c => quote = None,
            (Some(_), _) => {}
            (None, '\'' | '"') => quote = Some(c),
            (None, '(' | '[' | '{') => depth += 1,
            (None, ')' | ']' | '}') => depth = depth.checked_sub(1)?,
            (None, ',') if depth == 0 => {
                parts.push(&text[start..place]);
                start = place + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts.retain(|part| !part.trim().is_empty());
    Some(parts)
}

/// Reads so many entries and adds them.
pub(super) fn read_entries<T: Number>(
    from: &mut impl Read,
    order: ByteOrder,
    mut count: usize,
    entries: &mut Vec<T>,
) -> io::Result<()> {
    let size = size_of::<T>();
    let mut bytes = vec![0; CHUNK / size * size];
    while count > 0 {
        let now = count.min(CHUNK / size);
        let bytes = &mut bytes[..now * size];
        from.read_exact(bytes)?;
        if order == ByteOrder::HighestFirst {
            bytes.chunks_exact_mut(size).for_each(<[u8]>::reverse);
        }
        entries.extend(bytes.chunks_exact(size).map(T::of));
        count -= now;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use npyz::{NpyFile, WriterBuilder};

    fn written<T: Number>(shape: &[u64], values: &[T]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut writer = ArrayWriter::new::<T>(&mut bytes, shape).unwrap();
        values.iter().try_for_each(|v| writer.push(*v)).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn another_reader_reads_what_is_written() {
        let values: Vec<f64> = (0..30_000).map(|k| f64::from(k).sqrt()).collect();
        let bytes = written(&[100, 100, 3], &values);
        let other = NpyFile::new(&bytes[..]).unwrap();
        assert_eq!(other.shape(), [100, 100, 3]);
        assert_eq!((bytes.len() - 8 * values.len()) % 64, 0);
        assert_eq!(other.into_vec::<f64>().unwrap(), values);
        let other = NpyFile::new(&written(&[2], &[-1_i32, 7])[..])
            .unwrap()
            .into_vec::<i32>();
        assert_eq!(other.unwrap(), [-1, 7]);
        let mut short = ArrayWriter::new::<f64>(io::sink(), &[2]).unwrap();
        short.push(1.0).unwrap();
        assert!(short.finish().is_err());
        let mut long = ArrayWriter::new::<f64>(io::sink(), &[0]).unwrap();
        assert!(long.push(1.0).is_err());
    }

    #[test]
    fn what_another_writer_writes_is_read() {
        for (kind, order) in [
            ("<i8", ByteOrder::LowestFirst),
            (">i8", ByteOrder::HighestFirst),
        ] {
            let values: Vec<i64> = (0..20_000).map(|k| k * k - 40_000).collect();
            let mut bytes = Vec::new();
            let dtype = npyz::DType::new_scalar(kind.parse().unwrap());
            let options = npyz::WriteOptions::new().dtype(dtype).shape(&[10_000, 2]);
            let mut writer = options.writer(&mut bytes).begin_nd().unwrap();
            writer.extend(values.iter().copied()).unwrap();
            writer.finish().unwrap();
            let mut from = &bytes[..];
            let header = Header::read(&mut from).unwrap();
            assert_eq!(
                (header.by_columns, &header.shape[..]),
                (false, &[10_000, 2][..])
            );
            assert_eq!(header.order_of::<i64>(), Some(order));
            assert_eq!(header.order_of::<f64>(), None);
            let mut read: Vec<i64> = Vec::new();
            read_entries(&mut from, order, values.len(), &mut read).unwrap();
            assert_eq!(read, values);
        }
    }

    #[test]
    fn headers_of_python_are_read_and_others_refused() {
        let read =
            Header::parse("{\"shape\": (), 'descr': [('a, b', '<f8')], 'fortran_order': True}");
        let expected = Header {
            kind: "[('a, b', '<f8')]".into(),
            by_columns: true,
            shape: vec![],
        };
        assert_eq!(read, Some(expected));
        for wrong in [
            "",
            "{}",
            "{'descr': '<f8', 'fortran_order': 0, 'shape': (1,)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (-1,)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': 1)}",
        ] {
            assert_eq!(Header::parse(wrong), None, "{wrong}");
        }
        assert!(Header::read(&mut &b"\x93NUMPZ"[..]).is_err());
        let long = b"\x93NUMPY\x02\x00\xff\xff\xff\xff";
        let error = Header::read(&mut &long[..]).unwrap_err().to_string();
        assert_eq!(error, "its header announces 4294967295 bytes");
    }
}
