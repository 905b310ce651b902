//! VTK: one `.vtp` file for each frame and a `.pvd` file that lists them.

use super::{ExportError, FieldSupport, Series};
use isosheet_files::{FileError, NumberedFiles, WriteError, write_atomically};
use isosheet_mesh::{EdgeId, Part};
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Writes the bodies and the list of their files, if there are any, then the frames and, last, their list.
/// Returns the files, and how many of an earlier export were removed.
pub(super) fn write_series(
    path: &Path,
    series: &Series<'_>,
) -> Result<(Vec<PathBuf>, usize), ExportError> {
    let folder = path.with_extension("");
    let folder_name = folder
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let [bodies, frames] = ["bodies", "frame"].map(|n| NumberedFiles::new(&folder, n, "vtp"));
    let list = folder.with_file_name(format!("{folder_name}-bodies.pvd"));
    let mut files = Vec::new();
    let placed = series.frames_of_bodies();
    for &frame in placed {
        let bytes = bodies_file(series, frame);
        write_atomically(&bodies.path(frame), |w| w.write_all(&bytes))?;
        files.push(bodies.path(frame));
    }
    let listed = |files: &NumberedFiles, chosen: &[usize]| -> Vec<(f64, String)> {
        let chosen = chosen.iter();
        let entry = |&frame: &usize| (series.state(frame).0, files.name(frame));
        chosen.map(entry).collect()
    };
    if !placed.is_empty() {
        write_list(&list, &folder_name, &listed(&bodies, placed))?;
        files.push(list.clone());
    }
    for &frame in series.frames() {
        let bytes = frame_file(series, frame);
        write_atomically(&frames.path(frame), |w| w.write_all(&bytes))?;
        files.push(frames.path(frame));
    }
    write_list(path, &folder_name, &listed(&frames, series.frames()))?;
    files.push(path.to_owned());
    let removed_bodies = bodies.keep_only(placed)?;
    // The list of bodies of which none is left.
    let is_void = placed.is_empty() && removed_bodies > 0 && list.is_file();
    if is_void {
        fs::remove_file(&list)
            .map_err(|source| FileError::from(WriteError::Remove { path: list, source }))?;
    }
    let removed = frames.keep_only(series.frames())? + removed_bodies + usize::from(is_void);
    Ok((files, removed))
}

/// Writes the list of the files in a folder, each with its time.
fn write_list(path: &Path, folder: &str, files: &[(f64, String)]) -> Result<(), ExportError> {
    let folder = escaped(folder);
    let entry = |(t, name): &(f64, String)| {
        format!("<DataSet timestep=\"{t}\" part=\"0\" file=\"{folder}/{name}\"/>\n")
    };
    let entries: String = files.iter().map(entry).collect();
    let list = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n\
         {entries}</Collection>\n</VTKFile>\n"
    );
    Ok(write_atomically(path, |w| w.write_all(list.as_bytes()))?)
}

/// All bodies in their places in a frame, as one mesh whose faces know the number of their body.
fn bodies_file(series: &Series<'_>, frame: usize) -> Vec<u8> {
    let (mut points, mut faces, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    for (number, body) in series.bodies().iter().enumerate() {
        let first = (points.len() / 3) as u32;
        points.extend(body.placed(frame));
        faces.extend(body.faces.iter().flatten().map(|v| v + first));
        numbers.extend(body.faces.iter().map(|_| number as f64));
    }
    let mut file = Appended::new();
    file.begin(
        series.state(frame).0,
        [points.len() / 3, 0, faces.len() / 3],
    );
    file.line("<CellData>");
    file.floats("body", "", &numbers);
    file.line("</CellData>\n<Points>");
    file.floats("Points", VECTORS, &points);
    file.line("</Points>\n<Polys>");
    file.cells(&faces, 3);
    file.line("</Polys>\n</Piece>\n</PolyData>");
    file.finish()
}

/// The attribute of arrays of vectors.
const VECTORS: &str = "NumberOfComponents=\"3\"";

/// The cells of a frame: one line for each edge, then one triangle for each face. Fields of vertices are
/// point data; all others are cell data. A triangle has the value of that of its edges whose value is
/// largest in size, a line the mean of the values of its faces.
fn frame_file(series: &Series<'_>, frame: usize) -> Vec<u8> {
    let t = series.topology();
    let (time, x) = series.state(frame);
    let mut file = Appended::new();
    let (points, lines, faces) = (t.vertex_count(), t.edge_count(), t.face_count());
    file.begin(time, [points, lines, faces]);
    match series.uv() {
        Some(uv) => {
            file.line("<PointData TCoords=\"uv\">");
            file.floats("uv", "NumberOfComponents=\"2\"", uv.as_flattened());
        }
        None => file.line("<PointData>"),
    }
    for (field, values) in series.fields(frame) {
        match field.support {
            FieldSupport::Vertices => file.floats(&field.name, "", values),
            FieldSupport::VertexVectors => file.floats(&field.name, VECTORS, values),
            FieldSupport::Edges | FieldSupport::Faces | FieldSupport::FaceVectors => {}
        }
    }
    file.line("</PointData>\n<CellData>");
    let degrees: Vec<f64> = series
        .fold_angles(frame)
        .iter()
        .map(|a| a.to_degrees())
        .collect();
    file.floats("strain", "", &of_edges(series, &series.edge_strains(frame)));
    file.floats("fold_angle", "", &of_edges(series, &degrees));
    if !series.sheets().is_empty() {
        let numbers = |of: fn(&Part) -> usize| -> Vec<f64> {
            let sheets = series.sheets().iter().enumerate();
            let cells =
                sheets.flat_map(|(k, sheet)| std::iter::repeat_n(k as f64, of(&sheet.part)));
            cells.collect()
        };
        let [on_lines, on_faces] = [numbers(|p| p.edges.len()), numbers(|p| p.faces.len())];
        file.floats("sheet", "", &[on_lines, on_faces].concat());
    }
    for (field, values) in series.fields(frame) {
        match field.support {
            FieldSupport::Vertices | FieldSupport::VertexVectors => {}
            FieldSupport::Edges => file.floats(&field.name, "", &of_edges(series, values)),
            FieldSupport::Faces => file.floats(&field.name, "", &of_faces(series, values)),
            FieldSupport::FaceVectors => {
                // Lines have none.
                let lines = vec![0.0; 3 * t.edge_count()];
                file.floats(&field.name, VECTORS, &[&lines, values].concat());
            }
        }
    }
    file.line("</CellData>\n<Points>");
    file.floats("Points", VECTORS, x);
    file.line("</Points>\n<Lines>");
    let edges: Vec<u32> = t.edges().iter().flatten().map(|v| v.0).collect();
    file.cells(&edges, 2);
    file.line("</Lines>\n<Polys>");
    file.cells(series.faces().as_flattened(), 3);
    file.line("</Polys>\n</Piece>\n</PolyData>");
    file.finish()
}

/// Values of edges on lines and triangles.
fn of_edges(series: &Series<'_>, values: &[f64]) -> Vec<f64> {
    let t = series.topology();
    let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    let of_face = |f| {
        let edges = t.face_edges(f).map(|e| values[e.index()]);
        edges.into_iter().fold(0.0, larger)
    };
    values
        .iter()
        .copied()
        .chain(t.face_ids().map(of_face))
        .collect()
}

/// Values of faces on lines and triangles.
fn of_faces(series: &Series<'_>, values: &[f64]) -> Vec<f64> {
    let t = series.topology();
    let of_edge = |e: EdgeId| {
        let faces = t.edge_faces(e).into_iter().flatten();
        let (sum, count) = faces.fold((0.0, 0.0), |(sum, n), f| (sum + values[f.index()], n + 1.0));
        sum / f64::max(count, 1.0)
    };
    t.edge_ids()
        .map(of_edge)
        .chain(values.iter().copied())
        .collect()
}

/// An XML file with arrays as raw bytes after its end: each begins with its length in bytes.
struct Appended {
    xml: String,
    data: Vec<u8>,
}

impl Appended {
    fn new() -> Self {
        Self {
            xml: String::new(),
            data: Vec::new(),
        }
    }

    /// The head of a file with so many points, lines and polygons.
    fn begin(&mut self, time: f64, [points, lines, faces]: [usize; 3]) {
        self.xml += "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" \
            byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n";
        self.floats("TimeValue", "NumberOfTuples=\"1\"", &[time]);
        self.line(&format!(
            "</FieldData>\n<Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"0\" NumberOfLines=\"{lines}\" \
             NumberOfStrips=\"0\" NumberOfPolys=\"{faces}\">"
        ));
    }

    fn line(&mut self, text: &str) {
        self.xml += text;
        self.xml.push('\n');
    }

    fn floats(&mut self, name: &str, attributes: &str, values: &[f64]) {
        let bytes = values.iter().flat_map(|v| v.to_le_bytes());
        self.array("Float64", name, attributes, 8 * values.len(), bytes);
    }

    /// The corners of cells of `size` corners, and where each cell ends.
    fn cells(&mut self, corners: &[u32], size: usize) {
        let integers = |v: i64| v.to_le_bytes();
        let bytes = corners.iter().map(|&v| i64::from(v)).flat_map(integers);
        self.array("Int64", "connectivity", "", 8 * corners.len(), bytes);
        let count = corners.len() / size;
        let ends = (1..=count).map(|k| (size * k) as i64).flat_map(integers);
        self.array("Int64", "offsets", "", 8 * count, ends);
    }

    fn array(
        &mut self,
        kind: &str,
        name: &str,
        attributes: &str,
        length: usize,
        bytes: impl Iterator<Item = u8>,
    ) {
        let (name, offset) = (escaped(name), self.data.len());
        let written = writeln!(
            self.xml,
            "<DataArray type=\"{kind}\" Name=\"{name}\" {attributes} format=\"appended\" offset=\"{offset}\"/>"
        );
        written.expect("a string takes any text");
        self.data.extend((length as u64).to_le_bytes());
        self.data.extend(bytes);
    }

    fn finish(self) -> Vec<u8> {
        let mut file = self.xml.into_bytes();
        file.extend(b"<AppendedData encoding=\"raw\">\n_");
        file.extend(self.data);
        file.extend(b"\n</AppendedData>\n</VTKFile>\n");
        file
    }
}

/// Text for an attribute of XML.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            // XML has no other control characters, not even escaped.
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
