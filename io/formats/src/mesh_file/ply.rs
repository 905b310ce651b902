//! Reading PLY files (Polygon File Format).

use super::error::{CORRECT, Located, Location, announced, unexpected};
use super::faces::Polyhedron;
use isosheet_files::DataError;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
    ScalarType,
};

/// The first bytes of every PLY file.
const MAGIC: &[u8] = b"ply";

/// Reads the vertices and faces of a PLY file, text or binary of either byte order: the properties `x`, `y`
/// and `z` of the element `vertex` and the list `vertex_indices` or `vertex_index` of the element `face`.
/// Faces are grouped by their properties that are integers and no colours. Texture coordinates are the
/// properties `s` and `t`, `u` and `v` or `texture_u` and `texture_v` of the vertices, or the list `texcoord`
/// of the faces. Everything else is skipped.
pub(super) fn parse(bytes: &[u8]) -> Result<Polyhedron, Located> {
    let mut mesh = Polyhedron::default();
    if bytes.is_empty() {
        return Ok(mesh);
    }
    if !bytes.starts_with(MAGIC) {
        let first: String = bytes.iter().take(20).map(|&b| char::from(b)).collect();
        let found = first.lines().next().unwrap_or_default();
        let problem = unexpected("the word ply", found);
        return Err((Some(Location::Line(1)), problem.into()));
    }
    let parser = Parser::<PlyRow>::new();
    let mut reader = Reader::new(bytes);
    let header = parser
        .read_header(&mut reader)
        .map_err(|e| located(&e, true))?;
    let text = header.encoding == Encoding::Ascii;
    check(&header, reader.get_ref().len() as u64)?;
    let mut texture = Vec::new();
    for (name, element) in &header.elements {
        let rows = parser
            .read_payload_for_element(&mut reader, element, &header)
            .map_err(|e| located(&e, text))?;
        match name.as_str() {
            "vertex" => {
                for row in rows {
                    texture.push(texture_coordinates(row.texture));
                    mesh.push_vertex(row.place)
                        .map_err(|problem| (None, problem.into()))?;
                }
            }
            "face" => {
                for (k, row) in rows.into_iter().enumerate() {
                    let of_corners: Vec<_> = row.texture_of_corners(&texture).collect();
                    mesh.push_face(row.corners, Location::Face(k));
                    if of_corners.iter().any(Option::is_some) {
                        mesh.push_texture(of_corners);
                    }
                    for (name, value) in row.integers {
                        mesh.push_group(&format!("{name}={value}"));
                    }
                }
            }
            _ => {}
        }
    }
    Ok(mesh)
}

/// A vertex, a face or another element.
struct PlyRow {
    place: [f64; 3],
    corners: Vec<i64>,
    /// Texture coordinates of a vertex.
    texture: [Option<f64>; 2],
    /// Two texture coordinates of each corner of a face.
    texcoord: Vec<f32>,
    /// The integers of a face that are no colours.
    integers: Vec<(String, i64)>,
}

/// Properties of faces by which they are not grouped.
const COLOURS: [&str; 4] = ["red", "green", "blue", "alpha"];

/// Two texture coordinates, if both are there.
fn texture_coordinates([u, v]: [Option<f64>; 2]) -> Option<[f64; 2]> {
    let both = [u?, v?];
    both.iter().all(|c| c.is_finite()).then_some(both)
}

impl PropertyAccess for PlyRow {
    fn new() -> Self {
        Self {
            place: [0.0; 3],
            corners: Vec::new(),
            texture: [None; 2],
            texcoord: Vec::new(),
            integers: Vec::new(),
        }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match name {
            "x" => self.set(0, &property),
            "y" => self.set(1, &property),
            "z" => self.set(2, &property),
            "vertex_indices" | "vertex_index" => {
                self.corners = match property {
                    Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
                    Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
                    Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
                    Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
                    Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
                    Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
                    _ => return PropertyAccessResult::UnsupportedType,
                };
                PropertyAccessResult::Set
            }
            "s" | "u" | "texture_u" => self.set_texture(0, &property),
            "t" | "v" | "texture_v" => self.set_texture(1, &property),
            "texcoord" => match property {
                Property::ListFloat(list) => {
                    self.texcoord = list;
                    PropertyAccessResult::Set
                }
                _ => PropertyAccessResult::Ignored,
            },
            name if COLOURS.contains(&name) => PropertyAccessResult::Ignored,
            name => match integer(&property) {
                Some(value) => {
                    self.integers.push((name.to_owned(), value));
                    PropertyAccessResult::Set
                }
                None => PropertyAccessResult::Ignored,
            },
        }
    }
}

impl PlyRow {
    fn set(&mut self, axis: usize, property: &Property) -> PropertyAccessResult {
        match number(property) {
            Some(value) => {
                self.place[axis] = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::UnsupportedType,
        }
    }

    fn set_texture(&mut self, axis: usize, property: &Property) -> PropertyAccessResult {
        self.texture[axis] = number(property);
        PropertyAccessResult::Set
    }

    /// The texture coordinates of the corners of a face: its own, or the coordinates of the vertices.
    fn texture_of_corners(
        &self,
        vertices: &[Option<[f64; 2]>],
    ) -> impl Iterator<Item = Option<[f64; 2]>> {
        let own = self.texcoord.as_chunks::<2>().0;
        let is_own = own.len() == self.corners.len();
        self.corners
            .iter()
            .enumerate()
            .map(move |(k, &corner)| match is_own {
                true => texture_coordinates(own[k].map(|c| Some(c.into()))),
                false => *vertices.get(usize::try_from(corner).ok()?)?,
            })
    }
}

/// A property that is a number.
fn number(property: &Property) -> Option<f64> {
    match *property {
        Property::Float(v) => Some(v.into()),
        Property::Double(v) => Some(v),
        // Integers have 32 bits at most.
        _ => integer(property).map(|v| v as f64),
    }
}

/// A property that is an integer.
fn integer(property: &Property) -> Option<i64> {
    Some(match *property {
        Property::Char(v) => v.into(),
        Property::UChar(v) => v.into(),
        Property::Short(v) => v.into(),
        Property::UShort(v) => v.into(),
        Property::Int(v) => v.into(),
        Property::UInt(v) => v.into(),
        _ => return None,
    })
}

/// Checks that the elements have the properties of a mesh, and that the rest of the file can hold as many as
/// the header announces.
fn check(header: &Header, available: u64) -> Result<(), Located> {
    let problem = |text: String| Err((None, DataError::new(text, CORRECT).into()));
    let has = |element: &ElementDef, name: &str| element.properties.iter().any(|(k, _)| k == name);
    for (name, element) in &header.elements {
        let (count, text) = (element.count as u64, header.encoding == Encoding::Ascii);
        if count > 0 && element.properties.is_empty() {
            return problem(format!("the element {name:?} has no properties"));
        }
        let sizes = element.properties.iter().map(|(_, p)| match &p.data_type {
            // A digit and a separator.
            _ if text => 2,
            PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size(scalar),
        });
        // The last separator may be missing.
        let needed = count
            .saturating_mul(sizes.sum())
            .saturating_sub(u64::from(text));
        if needed > available {
            let what = format!("elements {name:?}");
            return Err((None, announced(&what, count, needed, available).into()));
        }
        if name == "vertex"
            && let Some(missing) = ["x", "y", "z"].iter().find(|c| !has(element, c))
        {
            return problem(format!("the vertices have no property {missing:?}"));
        }
        if name == "tristrips" && count > 0 {
            return problem("the triangles of the element \"tristrips\" are in strips".to_owned());
        }
        if name == "face" && !has(element, "vertex_indices") && !has(element, "vertex_index") {
            return problem("the faces have no property \"vertex_indices\"".to_owned());
        }
    }
    Ok(())
}

/// Bytes of a number.
fn size(scalar: &ScalarType) -> u64 {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// The error of the parser, which may quote a line of any length.
fn located(error: &ParseError, is_text: bool) -> Located {
    let message = error.to_string().replace(['\n', '\t'], " ");
    let short: String = message.chars().take(200).collect();
    let line = error.line().filter(|_| is_text).map(Location::Line);
    (line, DataError::new(short, CORRECT).into())
}
