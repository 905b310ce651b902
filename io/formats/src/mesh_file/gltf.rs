//! Reading glTF 2.0 files, as text or binary.

use super::error::{Located, Location, MeshFileProblem, cut_short};
use super::faces::Polyhedron;
use super::{MeshOptions, SeparateBuffers};
use base64::Engine;
use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use gltf::{Accessor, Document, Gltf, Mesh, Semantic};
use isosheet_files::{DataError, input};
use std::io::{self, Read};
use std::path::Path;

/// Bytes of the header of a binary file.
const GLB_HEADER: usize = 12;

/// Reads the triangles of all meshes that the default scene shows, each where its nodes place it.
///
/// Coordinates are metres and have y upwards by definition of the format; they are turned to z upwards,
/// `(x, y, z) -> (x, -z, y)`. The names of nodes, meshes and materials are groups of faces; the first texture
/// coordinates are kept. Skins and morph targets are skipped.
pub(super) fn parse(
    bytes: &[u8],
    path: &Path,
    options: &MeshOptions,
) -> Result<Polyhedron, Located> {
    if bytes.is_empty() {
        return Ok(Polyhedron::default());
    }
    if bytes.starts_with(b"glTF") && (bytes.len() < GLB_HEADER || glb_length(bytes) < GLB_HEADER) {
        let problem = cut_short("the header of a binary glTF file");
        return Err((Some(Location::Byte(bytes.len().min(8))), problem.into()));
    }
    read(bytes, path, options).map_err(|problem| (None, problem))
}

/// The length that the header of a binary file states.
fn glb_length(bytes: &[u8]) -> usize {
    u32::from_le_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]) as usize
}

fn read(bytes: &[u8], path: &Path, options: &MeshOptions) -> Result<Polyhedron, MeshFileProblem> {
    let name = options.mesh.as_deref();
    let (document, blob) = open(bytes)?;
    if let Some(name) = document.extensions_required().find(|e| !is_harmless(e)) {
        let message = format!("the file needs the extension {name}, which is not supported");
        return Err(DataError::new(message, "export the file without it").into());
    }
    let placed = placed_meshes(&document, name);
    if placed.is_empty() {
        let names = document
            .meshes()
            .map(|m| m.name().unwrap_or_default().to_owned());
        let names: Vec<String> = names.collect();
        let wanted = name.unwrap_or("at all");
        let message = format!("there is no mesh {wanted} (the meshes of the file are {names:?})");
        let error = DataError::new(message, "name a mesh of the file, or export it with one");
        return Err(match name {
            Some(_) => MeshFileProblem::Name(error),
            None => error.into(),
        });
    }
    let buffers = read_buffers(&document, blob, path, options.buffers)?;
    let mut polyhedron = Polyhedron::default();
    for placed in &placed {
        polyhedron.begin_part();
        add_mesh(placed, &buffers, &mut polyhedron)?;
    }
    Ok(polyhedron)
}

/// Adds the triangles of a mesh where it is placed.
fn add_mesh(
    placed: &PlacedMesh<'_>,
    buffers: &[Vec<u8>],
    polyhedron: &mut Polyhedron,
) -> Result<(), DataError> {
    let PlacedMesh {
        node,
        mesh,
        placement,
    } = placed;
    let is_mirrored = determinant(placement) < 0.0;
    for (k, primitive) in mesh.primitives().enumerate() {
        let part = format!("part {k} of mesh {}", mesh.index());
        let array = |array: &str, problem: String| {
            let message = format!("{part}: {array} {problem}");
            DataError::new(message, "export the file again").at(mesh.index())
        };
        let first = (polyhedron.positions.len() / 3) as i64;
        let positions = primitive.get(&Semantic::Positions);
        let positions = positions.ok_or_else(|| array("positions", "are missing".to_owned()))?;
        let points = vectors::<3>(&positions, buffers).map_err(|e| array("positions", e))?;
        let count = points.len() as i64;
        let corners: Vec<i64> = match primitive.indices() {
            Some(indices) => scalars(&indices, buffers).map_err(|e| array("indices", e))?,
            None => (0..count).collect(),
        };
        if let Some(v) = corners.iter().find(|&&v| v >= count) {
            let problem = format!("refer to vertex {v} of {count}");
            return Err(array("indices", problem));
        }
        let Some(triangles) = triangles(primitive.mode(), &corners) else {
            let message = format!("{part} is made of {:?}", primitive.mode());
            let remedy = "export it as triangles, or without this part";
            return Err(DataError::new(message, remedy).at(mesh.index()));
        };
        let texture = primitive.get(&Semantic::TexCoords(0));
        let texture = texture.and_then(|t| vectors::<2>(&t, buffers).ok());
        let material = primitive.material();
        let groups = [*node, mesh.name(), material.name()];
        for p in points {
            let [x, y, z] = apply(placement, p);
            polyhedron.push_vertex([x, -z, y])?;
        }
        for t in triangles {
            let [a, b, c] = t.map(|v| first + v);
            let corners = if is_mirrored { [a, c, b] } else { [a, b, c] };
            let place = Location::Face(polyhedron.face_count());
            polyhedron.push_face(corners, place);
            if let Some(texture) = &texture {
                let of_corner = |v: i64| texture.get(usize::try_from(v - first).ok()?).copied();
                polyhedron.push_texture(corners.map(of_corner));
            }
            for group in groups.iter().flatten() {
                polyhedron.push_group(group);
            }
        }
    }
    Ok(())
}

/// The triangles of a list, strip or fan of corners; none if the corners belong to points or lines.
fn triangles(mode: Mode, corners: &[i64]) -> Option<Vec<[i64; 3]>> {
    let triples = corners.windows(3).map(|c| [c[0], c[1], c[2]]);
    Some(match mode {
        Mode::Triangles => corners.as_chunks().0.to_vec(),
        // Every second triangle of a strip runs against the order of its corners.
        Mode::TriangleStrip => triples
            .enumerate()
            .map(|(k, [a, b, c])| if k % 2 == 0 { [a, b, c] } else { [a, c, b] })
            .collect(),
        Mode::TriangleFan => triples.map(|[_, b, c]| [corners[0], b, c]).collect(),
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return None,
    })
}

/// The valid document and the binary part of a file.
fn open(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), DataError> {
    let format = |e: gltf::Error| invalid(&e.to_string());
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(format)?;
    let json = document.into_json();
    // The validation of the library relies on these indices.
    let primitives = json.meshes.iter().flat_map(|m| &m.primitives);
    let mut accessors = primitives.flat_map(|p| p.attributes.values());
    if let Some(index) = accessors.find(|a| a.value() >= json.accessors.len()) {
        let (index, count) = (index.value(), json.accessors.len());
        return Err(invalid(&format!(
            "a mesh refers to accessor {index} of {count}"
        )));
    }
    Ok((Document::from_json(json).map_err(format)?, blob))
}

/// A file that breaks the rules of the format.
fn invalid(problem: &str) -> DataError {
    let short: String = problem.chars().take(300).collect();
    let remedy = "export the file again; the Khronos glTF validator says more";
    DataError::new(format!("the file is not valid glTF: {short}"), remedy)
}

/// Whether an extension changes neither positions nor triangles.
fn is_harmless(extension: &str) -> bool {
    ["KHR_materials", "KHR_texture", "KHR_lights"]
        .iter()
        .any(|prefix| extension.starts_with(prefix))
}

fn read_buffers(
    document: &Document,
    mut blob: Option<Vec<u8>>,
    path: &Path,
    separate: SeparateBuffers,
) -> Result<Vec<Vec<u8>>, DataError> {
    let problem = |buffer: usize, problem: String| {
        let remedy = "keep the file and its buffers together, or use .glb";
        DataError::new(format!("buffer {buffer}: {problem}"), remedy).at(buffer)
    };
    let mut buffers = Vec::new();
    let mut all = 0_u64;
    for buffer in document.buffers() {
        let (k, length) = (buffer.index(), buffer.length());
        all = all.saturating_add(length as u64);
        if all > input::LARGEST {
            let most = input::LARGEST;
            let large = format!("with those before it has more than {most} bytes");
            return Err(problem(k, large));
        }
        let mut bytes = match buffer.source() {
            gltf::buffer::Source::Bin => blob
                .take()
                .ok_or_else(|| problem(k, "the file has no binary part for it".to_owned()))?,
            gltf::buffer::Source::Uri(uri) => match uri.strip_prefix("data:") {
                Some(data) => {
                    let text = data.split_once(";base64,").map(|(_, text)| text);
                    let text = text.ok_or_else(|| problem(k, "is no base64 data".to_owned()))?;
                    base64::engine::general_purpose::STANDARD
                        .decode(text)
                        .map_err(|e| problem(k, e.to_string()))?
                }
                None if separate == SeparateBuffers::Refuse => {
                    let file: String = uri.chars().take(100).collect();
                    let message = format!("buffer {k} is the file {file:?}");
                    let remedy = "export the mesh as one file, as .glb";
                    return Err(DataError::new(message, remedy).at(k));
                }
                None => {
                    let folder = path.parent().unwrap_or(Path::new(""));
                    let name = decoded(uri);
                    read_separate(folder, &name, length)
                        .map_err(|e| problem(k, format!("cannot read the file {name:?}: {e}")))?
                }
            },
        };
        if bytes.len() < length {
            let found = bytes.len();
            let short = format!("it has {found} bytes, and {length} by its `byteLength`");
            return Err(problem(k, short));
        }
        bytes.truncate(length);
        buffers.push(bytes);
    }
    Ok(buffers)
}

/// A URI with `%XX` as the bytes that they stand for (RFC 3986, Sec. 2.1).
fn decoded(uri: &str) -> String {
    let mut parts = uri.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        let code = part
            .get(..2)
            .and_then(|code| u8::from_str_radix(code, 16).ok());
        match code {
            Some(byte) => {
                bytes.push(byte);
                bytes.extend(&part.as_bytes()[2..]);
            }
            None => {
                bytes.push(b'%');
                bytes.extend(part.as_bytes());
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The first bytes of a file in a folder or beneath it, as many as there are up to `length`.
fn read_separate(folder: &Path, name: &str, length: usize) -> io::Result<Vec<u8>> {
    let file = input::open(&input::within(folder, Path::new(name))?)?;
    let mut bytes = Vec::new();
    file.take(length as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The bytes of each element of an accessor, `size` bytes long each.
fn elements<'a>(
    accessor: &Accessor<'_>,
    buffers: &'a [Vec<u8>],
    size: usize,
) -> Result<Vec<&'a [u8]>, String> {
    if accessor.sparse().is_some() {
        return Err("are stored sparsely, which is not supported".to_owned());
    }
    let view = accessor.view().ok_or("have no data")?;
    let (start, length) = (view.offset(), view.length());
    let bytes = buffers.get(view.buffer().index());
    let bytes = bytes.and_then(|b| b.get(start..start.checked_add(length)?));
    let bytes = bytes.ok_or("lie outside of their buffer")?;
    let stride = view.stride().unwrap_or(size);
    let element = |k: usize| {
        let at = k.checked_mul(stride)?.checked_add(accessor.offset())?;
        bytes.get(at..at.checked_add(size)?)
    };
    if accessor.count() > bytes.len() {
        return Err("lie outside of their buffer".to_owned());
    }
    let all: Option<Vec<&[u8]>> = (0..accessor.count()).map(element).collect();
    all.ok_or_else(|| "lie outside of their buffer".to_owned())
}

/// The vectors of an accessor, which have `N` components.
fn vectors<const N: usize>(
    accessor: &Accessor<'_>,
    buffers: &[Vec<u8>],
) -> Result<Vec<[f64; N]>, String> {
    let (dimensions, kind) = (accessor.dimensions(), accessor.data_type());
    if (dimensions.multiplicity(), kind) != (N, DataType::F32) || dimensions == Dimensions::Mat2 {
        return Err(format!("are not vectors of {N} 32-bit floats"));
    }
    let number = |b: [u8; 4]| f64::from(f32::from_le_bytes(b));
    let point = |bytes: &[u8]| std::array::from_fn(|k| number(bytes.as_chunks::<4>().0[k]));
    Ok(elements(accessor, buffers, 4 * N)?
        .into_iter()
        .map(point)
        .collect())
}

fn scalars(accessor: &Accessor<'_>, buffers: &[Vec<u8>]) -> Result<Vec<i64>, String> {
    let size = match (accessor.dimensions(), accessor.data_type()) {
        (Dimensions::Scalar, DataType::U8) => 1,
        (Dimensions::Scalar, DataType::U16) => 2,
        (Dimensions::Scalar, DataType::U32) => 4,
        _ => return Err("are not unsigned integers".to_owned()),
    };
    // Little-endian.
    let number = |b: &[u8]| b.iter().rev().fold(0, |n, &byte| n << 8 | i64::from(byte));
    Ok(elements(accessor, buffers, size)?
        .into_iter()
        .map(number)
        .collect())
}

/// A matrix by columns, as glTF has them.
type Matrix = [[f64; 4]; 4];

const IDENTITY: Matrix = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
];

/// A mesh as a node shows it.
struct PlacedMesh<'a> {
    /// The name of the node, if it has one.
    node: Option<&'a str>,
    mesh: Mesh<'a>,
    placement: Matrix,
}

/// The meshes that nodes of the scene show, each with the matrix of its node, as often as they are shown: all
/// of them, or the meshes of a name. Where no node shows one of these, they are as they are.
fn placed_meshes<'a>(document: &'a Document, name: Option<&str>) -> Vec<PlacedMesh<'a>> {
    let is_wanted = |m: &Mesh<'_>| name.is_none() || m.name() == name;
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next());
    let mut seen = vec![false; document.nodes().len()];
    let roots = scene
        .into_iter()
        .flat_map(|s| s.nodes().collect::<Vec<_>>());
    let mut pending: Vec<_> = roots.map(|node| (node, IDENTITY)).collect();
    pending.reverse();
    let mut placed = Vec::new();
    while let Some((node, parent)) = pending.pop() {
        // The nodes of a valid file are trees; a circle ends here.
        if std::mem::replace(&mut seen[node.index()], true) {
            continue;
        }
        let own = node
            .transform()
            .matrix()
            .map(|column| column.map(f64::from));
        let matrix: Matrix = own.map(|column| {
            std::array::from_fn(|row| (0..4).map(|k| parent[k][row] * column[k]).sum())
        });
        let mesh = node.mesh().filter(is_wanted);
        placed.extend(mesh.map(|mesh| PlacedMesh {
            node: node.name(),
            mesh,
            placement: matrix,
        }));
        let children: Vec<_> = node.children().collect();
        pending.extend(children.into_iter().rev().map(|child| (child, matrix)));
    }
    if placed.is_empty() {
        let meshes = document.meshes().filter(is_wanted);
        placed.extend(meshes.map(|mesh| PlacedMesh {
            node: None,
            mesh,
            placement: IDENTITY,
        }));
    }
    placed
}

fn apply(m: &Matrix, p: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|row| m[0][row] * p[0] + m[1][row] * p[1] + m[2][row] * p[2] + m[3][row])
}

/// The determinant of the linear part.
fn determinant(m: &Matrix) -> f64 {
    let minor = |a: usize, b: usize| m[1][a] * m[2][b] - m[1][b] * m[2][a];
    m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
}
