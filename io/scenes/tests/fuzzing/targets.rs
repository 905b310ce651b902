//! What the readers are held to, one function for each of them. The program of cargo-fuzz (`io/fuzz`)
//! includes this file, so that there is one list of targets.
//!
//! A target may return a value or a typed error and has to panic on anything that neither of them may be:
//! a number that is not finite, an index of nothing, a value that another call of the crate does not take.

use isosheet_drawings::{DrawingOptions, parse_drawing};
use isosheet_dynamics::{Checkpoint, Method, SheetModel, Simulation, State};
use isosheet_formats::{
    FoldFrame, FrameData, HistoryRow, HistoryWriter, MeshFile, MeshFormat, MeshOptions, Polygons,
    SeparateBuffers, Trajectory, mesh_drawing, parse_mesh, read_history,
};
use isosheet_mesh::{MassKind, VertexId, generate};
use isosheet_scenes::{Mesh, Outline, OutlineShape, Scene, SceneFile};
use std::path::Path;

/// A reader under test.
pub(crate) type Target = fn(&[u8]);

/// All targets with their names.
pub(crate) const TARGETS: [(&str, Target); 18] = [
    ("obj", obj),
    ("off", off),
    ("stl", stl),
    ("ply", ply),
    ("fold", fold),
    ("gltf", gltf),
    ("glb", glb),
    ("vtk", vtk),
    ("vtp", vtp),
    ("cp", cp),
    ("opx", opx),
    ("svg", svg),
    ("dxf", dxf),
    ("scene", scene),
    ("checkpoint", checkpoint),
    ("checkpoint_json", checkpoint_json),
    ("trajectory", trajectory),
    ("history", history),
];

/// The target of a name.
pub(crate) fn target(name: &str) -> Target {
    let found = TARGETS.iter().find(|(known, _)| *known == name);
    found.expect("a name of the list").1
}

fn obj(data: &[u8]) {
    mesh(data, MeshFormat::Obj);
}

fn off(data: &[u8]) {
    mesh(data, MeshFormat::Off);
}

fn stl(data: &[u8]) {
    mesh(data, MeshFormat::Stl);
}

fn ply(data: &[u8]) {
    mesh(data, MeshFormat::Ply);
}

fn fold(data: &[u8]) {
    mesh(data, MeshFormat::Fold);
}

fn gltf(data: &[u8]) {
    mesh(data, MeshFormat::Gltf);
}

fn glb(data: &[u8]) {
    mesh(data, MeshFormat::Glb);
}

fn vtk(data: &[u8]) {
    mesh(data, MeshFormat::Vtk);
}

fn vtp(data: &[u8]) {
    mesh(data, MeshFormat::Vtp);
}

fn cp(data: &[u8]) {
    mesh(data, MeshFormat::Cp);
}

fn opx(data: &[u8]) {
    mesh(data, MeshFormat::Opx);
}

/// A drawing of lines, and of a crease pattern.
fn svg(data: &[u8]) {
    drawing(data, Path::new("drawing.svg"));
    mesh(data, MeshFormat::Svg);
}

fn dxf(data: &[u8]) {
    drawing(data, Path::new("drawing.dxf"));
}

/// Reads a drawing, and makes a mesh of it with some ten edges across.
fn drawing(data: &[u8], path: &Path) {
    let options = DrawingOptions::with_spacing(1.0);
    let drawing = match parse_drawing(data, path, &options) {
        Ok(drawing) => drawing,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let ends = drawing.lines.iter().flat_map(|line| line.curve.ends());
    let far = ends.flatten().map(f64::abs).fold(1e-9, f64::max);
    match mesh_drawing(&drawing, &DrawingOptions::with_spacing(0.1 * far)) {
        Ok(drawn) => {
            assert!(!drawn.report.to_string().is_empty());
            use_mesh(drawn.mesh);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Reads a mesh as it is by default, and with the other choice of every option.
fn mesh(data: &[u8], format: MeshFormat) {
    let other = MeshOptions {
        polygons: Polygons::Refuse,
        weld: Some(1e-3),
        frame: (format == MeshFormat::Fold).then_some(FoldFrame::Number(1)),
        mesh: None,
        buffers: SeparateBuffers::Refuse,
    };
    for options in [MeshOptions::default(), other] {
        // A folder that does not exist: no buffers beside the file.
        let path = Path::new("no-such-folder/mesh");
        match parse_mesh(data, format, path, &options) {
            Ok(mesh) => use_mesh(mesh),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
}

/// What the commands `check`, `check --fix` and `simulate` do with a mesh.
fn use_mesh(mesh: MeshFile) {
    check_mesh(&mesh);
    let mut repaired = mesh.clone();
    if repaired.repair().is_ok() {
        check_mesh(&repaired);
    }
    let mut used = mesh.clone();
    used.drop_unreferenced();
    check_mesh(&used);
    for mesh in [mesh, repaired, used] {
        if let Ok(sheet) = mesh.clone().into_sheet() {
            assert!(sheet.area().is_finite() && sheet.area() > 0.0);
            let assignments = mesh.fold_assignments(sheet.topology());
            let edges = sheet.topology().edge_count();
            assert!(assignments.is_none_or(|a| a.len() == edges));
        }
    }
}

fn check_mesh(mesh: &MeshFile) {
    assert_eq!(mesh.positions.len() % 3, 0);
    assert!(mesh.positions.iter().all(|x| x.is_finite()));
    let inside = |v: &u32| (*v as usize) < mesh.vertex_count();
    assert!(mesh.faces.iter().flatten().all(inside));
    assert!(mesh.diagonals.iter().flatten().all(inside));
    let angles = mesh.creases.iter().filter_map(|c| c.angle);
    assert!(mesh.creases.iter().all(|c| c.ends.iter().all(inside)));
    assert!(angles.into_iter().all(f64::is_finite));
}

/// From TOML to a scene that can start, as `isosheet check` does it. Scenes that name files or many vertices
/// are checked and not built.
fn scene(data: &[u8]) {
    let Ok(text) = String::from_utf8(data.to_vec()) else {
        return;
    };
    let file = match SceneFile::parse(text, Path::new("no-such-folder/scene.toml"), &[]) {
        Ok(file) => file,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let written = toml::Table::try_from(file.scene()).expect("a scene can be written");
    check_table(&toml::Value::Table(written.clone()));
    let text = toml::to_string(&written).expect("a table can be written");
    let again: Scene = toml::from_str(&text).expect("a written scene can be read");
    assert_eq!(&again, file.scene());
    if !is_small(file.scene()) {
        return;
    }
    match file.build() {
        Ok(setup) => match setup.start() {
            Ok(simulation) => assert!(simulation.state().x.iter().all(|x| x.is_finite())),
            Err(error) => assert!(!error.to_string().is_empty()),
        },
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Whether a scene is built within milliseconds: its mesh has at most a few hundred cells.
fn is_small(scene: &Scene) -> bool {
    const MOST: usize = 300;
    let cells = |mesh: &Mesh| match mesh {
        Mesh::Square { level, .. } => 4usize.saturating_pow(level.saturating_add(1)),
        Mesh::Rectangle { columns, rows, .. } => columns.saturating_mul(*rows),
        Mesh::Disk { rings, .. } => rings.saturating_mul(*rings).saturating_mul(6),
        Mesh::Annulus {
            segments, rings, ..
        } => segments.saturating_mul(*rings),
        Mesh::Fan { triangles, .. } => *triangles,
        Mesh::Miura(miura) => miura.columns.saturating_mul(miura.rows),
        Mesh::PolygonRings { outline, rings } => {
            let sides = match outline {
                Outline::Corners(corners) => corners.len(),
                Outline::Shape(OutlineShape::Regular { sides, .. }) => *sides,
            };
            rings.saturating_mul(*rings).saturating_mul(sides)
        }
        Mesh::DegreeFour(_) => 4,
        Mesh::Waterbomb(pattern) => pattern.columns.saturating_mul(pattern.rows),
        Mesh::Yoshimura(pattern) => pattern.columns.saturating_mul(pattern.rows),
        Mesh::Kresling(pattern) => pattern.columns.saturating_mul(pattern.rows),
        Mesh::Hypar(pattern) => pattern.rings.saturating_mul(4),
        Mesh::SquareTwist(_) => 13,
        _ => usize::MAX,
    };
    let all = scene.sheet.iter().map(|sheet| cells(&sheet.mesh));
    all.fold(0, usize::saturating_add) <= MOST && scene.files().is_empty()
}

/// Infinite numbers are written by nobody and mean nothing.
fn check_table(value: &toml::Value) {
    match value {
        toml::Value::Float(x) => assert!(x.is_finite(), "{x} in a checked scene"),
        toml::Value::Array(values) => values.iter().for_each(check_table),
        toml::Value::Table(table) => table.values().for_each(check_table),
        _ => {}
    }
}

/// Reads a checkpoint as it is, and once more with the header and the checksum that its fields should have:
/// without these every change of a byte is found at once, and the decoder is not reached.
fn checkpoint(data: &[u8]) {
    const HEADER: usize = 12;
    const SUM: usize = 4;
    resume(Checkpoint::from_bytes(data).ok());
    if data.len() < HEADER + SUM {
        return;
    }
    let [valid, ..] = checkpoints();
    let mut mended = valid[..HEADER].to_vec();
    mended.extend_from_slice(&data[HEADER..data.len() - SUM]);
    let sum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&mended);
    mended.extend_from_slice(&sum.to_le_bytes());
    resume(Checkpoint::from_bytes(&mended).ok());
}

fn checkpoint_json(data: &[u8]) {
    if let Ok(text) = std::str::from_utf8(data) {
        resume(Checkpoint::from_json(text).ok());
    }
}

/// A checkpoint that can be read continues or is refused; a simulation that continues has
/// finite numbers, and its next step ends.
fn resume(checkpoint: Option<Checkpoint>) {
    let Some(checkpoint) = checkpoint else {
        return;
    };
    let bytes = checkpoint.to_bytes().expect("a checkpoint can be written");
    let again = Checkpoint::from_bytes(&bytes).expect("a written checkpoint can be read");
    assert_eq!(
        again.to_bytes().expect("a checkpoint can be written"),
        bytes
    );
    match Simulation::resume(model(), None, checkpoint) {
        Ok(mut simulation) => {
            // The pin, and vertices that rods keep in place: at most all nine.
            assert!(simulation.reactions().len() <= 9);
            if let Err(error) = simulation.step(1.0 / 60.0) {
                assert!(!error.to_string().is_empty());
            }
            let State { x, v, t, .. } = simulation.state();
            assert!(x.iter().chain(v).chain([t]).all(|x| x.is_finite()));
            assert!(simulation.energy().is_finite());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// The model of the checkpoints: a square of eight triangles, held at a corner.
fn model() -> SheetModel {
    let sheet = generate::isotropic_square(0, 0.21).expect("valid");
    SheetModel::new(&sheet, 3.5e-3, MassKind::Lumped)
        .expect("valid")
        .with_gravity()
        .with_pins(&[VertexId(6)])
        .expect("the corner exists")
}

fn trajectory(data: &[u8]) {
    let Ok(run) = with_file("npz", data, Trajectory::read) else {
        return;
    };
    let vertices = run.vertex_count();
    assert!(
        run.faces()
            .iter()
            .flatten()
            .all(|&v| (v as usize) < vertices)
    );
    assert!(
        run.edges()
            .iter()
            .flatten()
            .all(|&v| (v as usize) < vertices)
    );
    assert_eq!(run.edges().len(), run.rest_lengths().len());
    for k in 0..run.len() {
        let x = run.frame(k).expect("it counts the frames");
        assert_eq!(x.len(), 3 * vertices);
        let kept = [
            (run.rod_forces(k), run.edges().len()),
            (run.contact_forces(k), 3 * vertices),
            (run.gaps(k), vertices),
            (run.plastic_angles(k), run.edges().len()),
            (run.plastic_curvatures(k), 2 * run.faces().len()),
            (run.crease_bends(k), run.edges().len()),
            (run.rulings(k), 3 * run.faces().len()),
            (run.ruling_curvatures(k), run.faces().len()),
            (run.gauss_curvatures(k), vertices),
        ];
        for (kept, count) in kept {
            let Some(kept) = kept else { continue };
            assert_eq!(kept.len(), count);
            assert!(kept.iter().all(|v| v.is_finite()));
        }
        assert!(x.iter().all(|v| v.is_finite()));
    }
}

fn history(data: &[u8]) {
    // Rows are read as they are: a run may have recorded that a number was not finite.
    let _ = with_file("csv", data, read_history);
}

/// What `read` makes of a file of these bytes.
pub(crate) fn with_file<T>(extension: &str, data: &[u8], read: impl Fn(&Path) -> T) -> T {
    let name = format!("isosheet-fuzz-{}.{extension}", std::process::id());
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, data).expect("the temporary folder can be written");
    let value = read(&path);
    // A file that stays is written anew by the next case.
    let _ = std::fs::remove_file(&path);
    value
}

/// A trajectory to begin with: three frames with all that frames may have.
pub(crate) fn trajectories() -> [Vec<u8>; 1] {
    let sheet = generate::isotropic_square(0, 0.21).expect("valid");
    let mut run = Trajectory::new(&sheet);
    let (rods, n) = (sheet.lengths().len(), sheet.positions().len());
    for k in 0..3 {
        let data = FrameData {
            rod_forces: &vec![f64::from(k); rods],
            contact_forces: &vec![0.5; n],
            gaps: &vec![1e-3; n / 3],
            plastic_angles: &vec![0.1; rods],
            plastic_curvatures: &vec![20.0; 2 * sheet.topology().face_count()],
            crease_bends: &vec![0.1; rods],
            rulings: &vec![0.0; 3 * sheet.topology().face_count()],
            ruling_curvatures: &vec![2.0; sheet.topology().face_count()],
            gauss_curvatures: &vec![-1.0; n / 3],
        };
        run.push_with(0.1 * f64::from(k), sheet.positions(), &data)
            .expect("it fits");
    }
    [with_file("npz", &[], |path| {
        run.write(path)
            .expect("the temporary folder can be written");
        std::fs::read(path).expect("it was just written")
    })]
}

/// A history to begin with.
pub(crate) fn histories() -> [Vec<u8>; 1] {
    [with_file("csv", &[], |path| {
        let mut writer = HistoryWriter::create(path).expect("the temporary folder can be written");
        for k in 0..4 {
            let row = HistoryRow {
                t: 0.1 * f64::from(k),
                gap: (k > 1).then_some(1e-3),
                ..HistoryRow::default()
            };
            writer.append(&row).expect("there is room");
        }
        std::fs::read(path).expect("it was just written")
    })]
}

/// Checkpoints to begin with, in the binary form: after two steps of BDF2 and of implicit Euler.
pub(crate) fn checkpoints() -> [Vec<u8>; 2] {
    [
        simulation(Method::default()),
        simulation(Method::ImplicitEuler(Default::default())),
    ]
    .map(|s| s.checkpoint().to_bytes().expect("memory suffices"))
}

/// Checkpoints to begin with, in the JSON form: after two steps of BDF2 and of implicit Euler.
pub(crate) fn checkpoints_json() -> [Vec<u8>; 2] {
    [
        simulation(Method::default()),
        simulation(Method::ImplicitEuler(Default::default())),
    ]
    .map(|s| {
        let text = s.checkpoint().to_json().expect("memory suffices");
        text.into_bytes()
    })
}

fn simulation(method: Method) -> Simulation {
    let sheet = generate::isotropic_square(0, 0.21).expect("valid");
    let start = State::at_rest(sheet.positions().to_vec());
    let mut simulation = Simulation::new(model(), start, method).expect("valid");
    for _ in 0..2 {
        simulation.step(1.0 / 60.0).expect("a hanging square");
    }
    simulation
}
