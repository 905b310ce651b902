use crate::mesh_file::{MeshFile, MeshFormat, MeshOptions, parse_mesh};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;
use std::path::Path;

fn read(format: MeshFormat, bytes: &[u8]) -> Result<MeshFile, String> {
    let read = parse_mesh(bytes, format, Path::new("a"), &MeshOptions::default());
    read.map_err(|e| e.to_string())
}

const POINTS: [f64; 12] = [0.0, 0.0, 0.1, 1.0, 0.0, 0.2, 1.0, 1.0, 0.3, 0.0, 1.0, 0.4];
const CORNERS: [i64; 6] = [0, 1, 2, 0, 2, 3];
const ENDS: [i64; 2] = [3, 6];

/// How the arrays of a file are written.
#[derive(Clone, Copy, Debug)]
struct Form {
    header: usize,
    is_big_endian: bool,
    /// Bytes of a block that is compressed.
    block: Option<usize>,
    /// Whether the data are in the elements, appended in base 64, or appended as they are.
    place: Place,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Inline,
    AppendedText,
    AppendedBytes,
}

impl Form {
    fn number(self, value: usize) -> Vec<u8> {
        let mut bytes = (value as u64).to_le_bytes()[..self.header].to_vec();
        if self.is_big_endian {
            bytes.reverse();
        }
        bytes
    }

    /// An array with the numbers before it.
    fn array(self, values: &[[u8; 8]]) -> Vec<u8> {
        let order = |b: &[u8; 8]| {
            let mut bytes = *b;
            if self.is_big_endian {
                bytes.reverse();
            }
            bytes
        };
        let bytes: Vec<u8> = values.iter().flat_map(order).collect();
        let code = |parts: &[&[u8]]| match self.place {
            Place::AppendedBytes => parts.concat(),
            _ => parts
                .iter()
                .flat_map(|part| STANDARD.encode(part).into_bytes())
                .collect(),
        };
        let Some(size) = self.block else {
            return code(&[&[self.number(bytes.len()), bytes].concat()]);
        };
        let blocks: Vec<Vec<u8>> = bytes
            .chunks(size)
            .map(|block| {
                let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
                encoder.write_all(block).unwrap();
                encoder.finish().unwrap()
            })
            .collect();
        let last = bytes.len() % size;
        let sizes = blocks.iter().flat_map(|block| self.number(block.len()));
        let head = [blocks.len(), size, last].map(|n| self.number(n)).concat();
        let head: Vec<u8> = head.into_iter().chain(sizes).collect();
        code(&[&head, &blocks.concat()])
    }

    fn file(self) -> Vec<u8> {
        let floats: Vec<_> = POINTS.iter().map(|v| v.to_le_bytes()).collect();
        let integers = |values: &[i64]| values.iter().map(|v| v.to_le_bytes()).collect::<Vec<_>>();
        let mut appended = Vec::new();
        let mut element = |kind: &str, name: &str, values: &[[u8; 8]]| {
            let data = self.array(values);
            if self.place == Place::Inline {
                let text = String::from_utf8(data).unwrap();
                return format!(
                    "<DataArray type=\"{kind}\" Name=\"{name}\" format=\"binary\">\n {text}\n</DataArray>"
                );
            }
            let offset = appended.len();
            appended.extend(data);
            format!(
                "<DataArray type=\"{kind}\" Name=\"{name}\" format=\"appended\" offset=\"{offset}\"/>"
            )
        };
        let points = element("Float64", "Points", &floats);
        let corners = element("Int64", "connectivity", &integers(&CORNERS));
        let ends = element("Int64", "offsets", &integers(&ENDS));
        let order = if self.is_big_endian {
            "BigEndian"
        } else {
            "LittleEndian"
        };
        let header = 8 * self.header;
        let compressor = self
            .block
            .map_or("", |_| "compressor=\"vtkZLibDataCompressor\"");
        let mut file = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" byte_order=\"{order}\" header_type=\"UInt{header}\" \
             {compressor}><PolyData><Piece NumberOfPoints=\"4\" NumberOfPolys=\"2\"><Points>{points}</Points>\
             <Polys>{corners}{ends}</Polys></Piece></PolyData>"
        )
        .into_bytes();
        if self.place != Place::Inline {
            let encoding = if self.place == Place::AppendedBytes {
                "raw"
            } else {
                "base64"
            };
            file.extend(format!("<AppendedData encoding=\"{encoding}\">\n _").into_bytes());
            file.extend(appended);
            file.extend(b"</AppendedData>");
        }
        file.extend(b"</VTKFile>");
        file
    }
}

#[test]
fn all_forms_of_xml_are_read() {
    for header in [4, 8] {
        for is_big_endian in [false, true] {
            for block in [None, Some(32), Some(40), Some(1000)] {
                for place in [Place::Inline, Place::AppendedText, Place::AppendedBytes] {
                    let form = Form {
                        header,
                        is_big_endian,
                        block,
                        place,
                    };
                    let file = form.file();
                    let mesh =
                        read(MeshFormat::Vtp, &file).unwrap_or_else(|e| panic!("{form:?}: {e}"));
                    assert_eq!(mesh.positions, POINTS, "{form:?}");
                    assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
                    // Cut short anywhere it is refused, or has all that is needed.
                    for end in 0..file.len() {
                        if let Ok(part) = read(MeshFormat::Vtp, &file[..end]) {
                            assert_eq!(part.positions, POINTS);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_no_polygon_is_refused() {
    let form = Form {
        header: 4,
        is_big_endian: false,
        block: None,
        place: Place::Inline,
    };
    let text = String::from_utf8(form.file()).unwrap();
    for (from, to, says) in [
        (
            "PolyData\" byte",
            "ImageData\" byte",
            "data of the kind \"ImageData\"",
        ),
        (
            "NumberOfPolys",
            "NumberOfStrips=\"1\" NumberOfPolys",
            "strips of triangles",
        ),
        (
            "Points=\"4\"",
            "Points=\"5\"",
            "announces 15 coordinates, and its array has 12",
        ),
        ("UInt32", "UInt16", "header_type UInt32 or UInt64"),
        ("Float64", "String", "an array of numbers"),
        ("binary", "appended", "is appended, and nothing is"),
        ("<VTKFile", "<File", "not valid XML"),
    ] {
        let said = read(MeshFormat::Vtp, text.replacen(from, to, 1).as_bytes()).unwrap_err();
        assert!(said.contains(says), "{said}");
    }
    for (text, says) in [
        ("solid", "# vtk DataFile Version"),
        (
            "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\n",
            "data of the kind",
        ),
        (
            "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 9 float\n0 0",
            "ends before",
        ),
        (
            "# vtk DataFile Version 3.0\na\nBINARY\nDATASET POLYDATA\nPOINTS 9 float\n0 0",
            "27 numbers",
        ),
        (
            "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOLYGONS 1 4\n9 0 1 2\n",
            "9 corners",
        ),
    ] {
        let said = read(MeshFormat::Vtk, text.as_bytes()).unwrap_err();
        assert!(said.contains(says), "{said}");
    }
}

/// Binary legacy files have the largest byte first; files of version 5 list where polygons begin.
#[test]
fn legacy_files_are_read() {
    let points: Vec<u8> = POINTS.iter().flat_map(|v| v.to_be_bytes()).collect();
    let of = |values: &[i32]| {
        values
            .iter()
            .flat_map(|v| v.to_be_bytes())
            .collect::<Vec<u8>>()
    };
    let of_long = |values: &[i64]| {
        values
            .iter()
            .flat_map(|v| v.to_be_bytes())
            .collect::<Vec<u8>>()
    };
    let head =
        b"# vtk DataFile Version 5.1\nmade by hand\nBINARY\nDATASET POLYDATA\nPOINTS 4 double\n";
    let old = [
        &head[..],
        &points,
        b"\n\nPOLYGONS 2 8\n",
        &of(&[3, 0, 1, 2, 3, 0, 2, 3]),
        b"\n\nCELL_DATA 2\n",
    ];
    let new = [
        &head[..],
        &points,
        b"\nMETADATA\nINFORMATION 0\n\nLINES 2 2\nOFFSETS vtktypeint64\n",
        &of_long(&[0, 2]),
        b"\nCONNECTIVITY vtktypeint64\n",
        &of_long(&[0, 1]),
        b"\nPOLYGONS 3 6\nOFFSETS vtktypeint64\n",
        &of_long(&[0, 3, 6]),
        b"\nCONNECTIVITY vtktypeint64\n",
        &of_long(&CORNERS),
        b"\n",
    ];
    for file in [old.concat(), new.concat()] {
        let mesh = read(MeshFormat::Vtk, &file).unwrap();
        assert_eq!(mesh.positions, POINTS);
        assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
        for end in 0..file.len() {
            let _ = read(MeshFormat::Vtk, &file[..end]);
        }
    }
}

/// A block that is named often stands for any memory: the lengths of all are counted before they are decoded.
#[test]
fn arrays_are_in_proportion_to_their_file() {
    let block = |length: usize| {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&vec![0; length]).unwrap();
        encoder.finish().unwrap()
    };
    let file = |count: usize, length: usize| {
        let block = block(length);
        let numbers = [vec![count, length, 0], vec![block.len(); count]].concat();
        let head: Vec<u8> = numbers
            .iter()
            .flat_map(|n| (*n as u64).to_le_bytes())
            .collect();
        let points = STANDARD.encode(head) + &STANDARD.encode(block.repeat(count));
        format!(
            "<VTKFile type=\"PolyData\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"><PolyData>\
             <Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><Points><DataArray type=\"Float64\" Name=\"p\" \
             format=\"binary\">{points}</DataArray></Points></Piece></PolyData></VTKFile>"
        )
    };
    // Bytes and numbers, where half of 64 MiB and of a hundred times the file are allowed.
    let said = |text: &str| read(MeshFormat::Vtp, text.as_bytes()).unwrap_err();
    let bomb = file(20, 1 << 20);
    let most = (32 << 20) + 50 * bomb.len();
    assert!(2 * (20 << 20) > most);
    let expected = format!(
        "the array \"p\" of the file would take more than {} MiB",
        most >> 20
    );
    assert!(said(&bomb).contains(&expected), "{}", said(&bomb));
    assert!(said(&file(8, 1 << 20)).contains("and its array has 1048576"));
}
