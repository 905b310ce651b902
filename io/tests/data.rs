//! Other people's files: each is read or refused with a typed error, never a panic.
//!
//! The files are not part of the repository. Point `ISOSHEET_DATA` at the folder that has them; without it
//! these tests say that they were skipped.

use std::io::Write;
use std::path::{Path, PathBuf};

use isosheet_io::{
    MeshFile, MeshFileError, MeshFileProblem, MeshOptions, Polygons, read_mesh, read_mesh_with, read_sheet,
};
use isosheet_mesh::{Dof, MeshError, Sheet, TopologyError, orient_consistently};

fn folder(name: &str) -> Option<PathBuf> {
    match std::env::var_os("ISOSHEET_DATA") {
        Some(root) => Some(Path::new(&root).join(name)),
        None => {
            // The test harness keeps what `println!` and `eprintln!` write to itself.
            let _ = std::io::stderr()
                .write_all(b"skipped, as ISOSHEET_DATA is not set: a test of io/tests/data.rs\n");
            None
        }
    }
}

fn refused(r: Result<Sheet, MeshFileError>) -> MeshFileProblem {
    let e = r.expect_err("should be refused");
    assert!(e.to_string().len() > 30, "an error explains itself: {e}");
    e.problem
}

#[test]
fn nasty_files_are_read_or_refused_for_the_right_reason() {
    let Some(folder) = folder("nasty") else {
        return;
    };
    let sheet = |name: &str| read_sheet(&folder.join(name));
    let topology = |name: &str| match refused(sheet(name)) {
        MeshFileProblem::Mesh(MeshError::Topology(t)) => t,
        other => panic!("{name}: {other}"),
    };
    let polygons = |name: &str| matches!(refused(sheet(name)), MeshFileProblem::Polygon { .. });

    assert!(matches!(refused(sheet("empty.obj")), MeshFileProblem::Empty));
    assert!(matches!(
        refused(sheet("points_only.obj")),
        MeshFileProblem::NoFaces { vertices: 8, .. }
    ));
    assert!(matches!(
        refused(sheet("wireframe_lines_only.obj")),
        MeshFileProblem::NoFaces {
            vertices: 8,
            lines: 1..,
            ..
        }
    ));
    assert!(matches!(
        refused(sheet("collinear_line.obj")),
        MeshFileProblem::NoFaces { vertices: 4, .. }
    ));
    assert!(matches!(
        refused(sheet("face_with_missing_indices.obj")),
        MeshFileProblem::TooFewCorners { corners: 2 }
    ));
    assert!(matches!(
        refused(sheet("polygon_faces.obj")),
        MeshFileProblem::Polygon { corners: 5 }
    ));
    for name in [
        "closed_pentagons.obj",
        "five_closed_components_mixed.obj",
        "moebius_nonorientable_quads.obj",
        "negative_indices.obj",
    ] {
        assert!(polygons(name), "{name}");
    }
    assert!(matches!(
        topology("duplicate_vertices.obj"),
        TopologyError::UnreferencedVertex { .. }
    ));
    assert!(matches!(
        topology("nonmanifold_edge_fan3.obj"),
        TopologyError::NonManifoldEdge { count: 3, .. }
    ));
    // The two tetrahedra share a face, wound both ways.
    assert!(matches!(
        topology("nonmanifold_joined_tets.obj"),
        TopologyError::DuplicateFace { .. }
    ));
    assert!(matches!(
        topology("nonmanifold_triple_vierbein.obj"),
        TopologyError::NonManifoldEdge { .. } | TopologyError::InconsistentWinding { .. }
    ));
    assert!(matches!(
        refused(sheet("degenerate_and_duplicate_L.obj")),
        MeshFileProblem::Mesh(MeshError::ZeroAreaFace { .. } | MeshError::Topology(_))
    ));
    let closed = sheet("closed_tet.obj").expect("a closed surface is a mesh");
    assert_eq!(Dof::of(closed.topology()).internal, 0);
    assert_eq!(
        sheet("nan_vertex_colours.obj")
            .expect("colours do not matter")
            .topology()
            .vertex_count(),
        8
    );
    let split = sheet("fully_split_vertices.obj").expect("96 separate triangles");
    assert_eq!(split.topology().component_count(), 96);
    assert_eq!(
        sheet("two_objects.obj")
            .expect("two groups")
            .topology()
            .component_count(),
        2
    );
    let cap = sheet("nonplanar_cap.obj").expect("a curved surface is a mesh");
    assert!(matches!(
        cap.check_developable(1e-3),
        Err(MeshError::NotDevelopable { .. })
    ));
}

#[test]
fn nasty_polygons_can_be_cut() {
    let Some(folder) = folder("nasty") else {
        return;
    };
    let pentagons = read_mesh(&folder.join("closed_pentagons.obj")).expect("convex");
    assert_eq!(pentagons.polygons, 12);
    let pentagons = pentagons.into_sheet().expect("a closed surface");
    assert_eq!(Dof::of(pentagons.topology()).internal, 0);
    let five = read_mesh(&folder.join("five_closed_components_mixed.obj")).expect("convex");
    let five = five.into_sheet().expect("closed surfaces");
    assert_eq!(five.topology().component_count(), 5);
    let cube = read_mesh(&folder.join("negative_indices.obj"))
        .expect("convex")
        .into_sheet()
        .expect("cube");
    assert_eq!(cube.topology().face_count(), 12);
    let mut band = read_mesh(&folder.join("moebius_nonorientable_quads.obj")).expect("convex");
    let vertices = band.vertex_count();
    assert!(matches!(
        orient_consistently(vertices, &mut band.faces),
        Err(TopologyError::NonOrientable { .. })
    ));
    assert!(matches!(
        refused(band.into_sheet()),
        MeshFileProblem::Mesh(MeshError::Topology(
            TopologyError::InconsistentWinding { .. }
        ))
    ));
}

#[test]
fn planar_files_are_sheets() {
    let Some(folder) = folder("planar") else {
        return;
    };
    // Name, vertices, faces, boundary edges, Euler characteristic, 3V - E.
    let expected = [
        ("annulus_60v.obj", 60, 98, 22, 0, 22),
        ("card_strip.obj", 10, 8, 10, 1, 13),
        ("disk_688v_mm_scale.obj", 688, 1296, 78, 1, 81),
        ("lshape_6t.obj", 8, 6, 8, 1, 11),
        ("mat_60x20.obj", 1200, 2242, 156, 1, 159),
        ("square_delaunay_102v.obj", 102, 170, 32, 1, 35),
        ("square_irregular_1939v.obj", 1939, 3716, 160, 1, 163),
        ("step_reentrant_2302v.obj", 2302, 4222, 380, 1, 383),
        ("two_sheets_one_file.obj", 1200, 2204, 192, 2, 198),
        ("two_triangles.obj", 4, 2, 4, 1, 7),
    ];
    for (name, v, f, b, chi, dof) in expected {
        let sheet = read_sheet(&folder.join(name)).unwrap_or_else(|e| panic!("{e}"));
        let t = sheet.topology();
        t.check_invariants();
        assert_eq!(
            (t.vertex_count(), t.face_count(), t.boundary_edge_count()),
            (v, f, b),
            "{name}"
        );
        assert_eq!(
            (t.euler_characteristic(), Dof::of(t).total),
            (chi, dof),
            "{name}"
        );
        sheet
            .check_developable(1e-4)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}
