//! Other people's files: each is read or refused with a typed error, never a panic.
//!
//! The files are not part of the repository. Point `ISOSHEET_DATA` at the folder that has them; without it
//! these tests say that they were skipped.

#[path = "../../tests/shared/skip.rs"]
mod skip;

use std::path::PathBuf;

use isosheet_formats::{
    EdgeAssignment, MeshFileError, MeshFileProblem, MeshFormat, MeshOptions, parse_mesh, read_mesh,
    read_sheet,
};
use isosheet_mesh::generate::FoldAssignment;
use isosheet_mesh::{Advice, Dof, EdgeId, MeshError, Sheet, TopologyError, orient_consistently};

fn folder(name: &str) -> Option<PathBuf> {
    skip::data_folder().map(|root| root.join(name))
}

fn refused(r: Result<Sheet, MeshFileError>) -> MeshFileProblem {
    let e = r.expect_err("should be refused");
    assert!(e.with_advice().len() > 30, "an error explains itself: {e}");
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
    let polygons = |name: &str| matches!(refused(sheet(name)), MeshFileProblem::Polygon(_));

    for (name, says) in [
        ("empty.obj", "it is empty"),
        (
            "points_only.obj",
            "the file has 8 vertices, 0 line elements",
        ),
        ("wireframe_lines_only.obj", "but no faces"),
        ("collinear_line.obj", "the file has 4 vertices, "),
        ("face_with_missing_indices.obj", "a face has 2 corners"),
        (
            "polygon_faces.obj",
            "a face has 5 corners, and a rigid sheet",
        ),
    ] {
        let problem = refused(sheet(name)).to_string();
        assert!(problem.contains(says), "{name}: {problem}");
    }
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
/// What is expected of a file: refused with a problem of that name, or read with so many vertices, triangles
/// and polygons that were cut. What was read is a sheet with that Euler characteristic, or is no sheet for
/// that reason. Another program counted vertices, faces and characteristics in the files.
enum Expected {
    Refused(&'static str),
    Read(usize, usize, usize, Surface),
}

enum Surface {
    Sheet(i64),
    No(&'static str),
}

use Expected::{Read, Refused};
use Surface::{No, Sheet as Chi};

#[rustfmt::skip]
const FILES: [(&str, Expected); 83] = [
    ("fold/bad_twist.fold", Read(16, 18, 9, Chi(1))),
    ("fold/bird_base_oriedita.fold", Read(9, 8, 4, Chi(1))),
    ("fold/bird_base_x4_tri.fold", Read(33, 56, 0, Chi(1))),
    ("fold/crane_rabbitear.fold", Read(56, 98, 33, Chi(1))),
    ("fold/crane_simplified_tri.fold", Read(24, 36, 0, Chi(1))),
    ("fold/edemaine_diagonal_cp.fold", Read(4, 2, 0, Chi(1))),
    ("fold/edemaine_diagonal_folded.fold", Read(4, 2, 0, Chi(1))),
    ("fold/edemaine_simple.fold", Read(6, 4, 0, Chi(1))),
    ("fold/edemaine_squaretwist_3d.fold", Read(16, 18, 9, Chi(1))),
    ("fold/hypar_tri.fold", Read(64, 122, 0, Chi(1))),
    ("fold/hypar_unstable_tri.fold", Read(44, 82, 0, Chi(1))),
    ("fold/kabuto_traditional.fold", Read(19, 20, 2, Chi(1))),
    ("fold/miura_4x4_quads_foldforge.fold", Read(25, 32, 16, Chi(1))),
    ("fold/miura_herringbone_8x8_tri.fold", Read(81, 128, 0, Chi(1))),
    ("fold/miura_herringbone_large_tri.fold", Read(289, 512, 0, Chi(1))),
    ("fold/miura_ori_oripa_quads.fold", Read(81, 128, 56, Chi(1))),
    ("fold/not_flat_foldable.fold", Read(9, 8, 3, Chi(1))),
    ("fold/one_vertex.fold", Refused("but no faces")),
    ("fold/single_vertex_no_faces.fold", Read(5, 4, 0, Chi(1))),
    ("fold/snowflake_tri.fold", Read(61, 60, 0, Chi(1))),
    ("fold/squarebase_perfect_rot.fold", Read(9, 8, 0, Chi(1))),
    ("fold/squarebase_tri.fold", Read(9, 8, 0, Chi(1))),
    ("fold/thirteen_horns_tri.fold", Read(123, 210, 0, No("DuplicateFace"))),
    ("fold/two_triangle_square.fold", Read(4, 2, 0, Chi(1))),
    ("fold/wavy_tri.fold", Read(43, 68, 0, Chi(1))),
    ("svg/birdBase.svg", Read(13, 16, 0, Chi(1))),
    ("svg/miura-ori.svg", Read(182, 312, 156, Chi(1))),
    ("svg/simpleVertex.svg", Read(9, 8, 4, Chi(1))),
    ("svg/singlesquaretwist.svg", Read(16, 18, 9, Chi(1))),
    ("fold_reference/fourCrease10_series.fold", Read(9, 8, 0, Chi(1))),
    ("fold_reference/fourCrease90_series.fold", Read(9, 8, 0, Chi(1))),
    ("fold_reference/simpleVertex_-100.fold", Read(9, 8, 0, Chi(1))),
    ("fold_reference/simpleVertex_-50.fold", Read(9, 8, 0, Chi(1))),
    ("fold_reference/simpleVertex_0.fold", Read(9, 8, 0, Chi(1))),
    ("fold_reference/simpleVertex_100.fold", Read(9, 8, 0, Chi(1))),
    ("fold_reference/simpleVertex_50.fold", Read(9, 8, 0, Chi(1))),
    ("fold_reference/simpleVertex_series_0to100by10.fold", Read(9, 8, 0, Chi(1))),
    ("nasty/closed_pentagons.obj", Read(20, 36, 12, Chi(2))),
    ("nasty/closed_sphere_ascii.ply", Read(162, 320, 0, Chi(2))),
    ("nasty/closed_tet.obj", Read(4, 4, 0, Chi(2))),
    ("nasty/collinear_line.obj", Refused("but no faces")),
    ("nasty/degenerate_and_duplicate_L.obj", Read(24, 44, 0, No("ZeroAreaFace"))),
    ("nasty/duplicate_vertices.obj", Read(16, 4, 0, No("UnreferencedVertex"))),
    ("nasty/empty.obj", Refused("it is empty")),
    ("nasty/face_with_missing_indices.obj", Refused("2 corners, and needs at least three")),
    ("nasty/five_closed_components_mixed.obj", Read(50, 80, 18, Chi(10))),
    ("nasty/fully_split_vertices.obj", Read(288, 96, 0, Chi(96))),
    ("nasty/moebius_nonorientable_quads.obj", Read(280, 448, 224, No("InconsistentWinding"))),
    ("nasty/nan_vertex_colours.obj", Read(8, 12, 0, Chi(2))),
    ("nasty/negative_indices.obj", Read(8, 12, 6, Chi(2))),
    ("nasty/nonmanifold_edge_fan3.obj", Read(5, 3, 0, No("NonManifoldEdge"))),
    ("nasty/nonmanifold_joined_tets.obj", Read(5, 8, 0, No("DuplicateFace"))),
    ("nasty/nonmanifold_triple_vierbein.obj", Read(75, 108, 0, No("NonManifoldEdge"))),
    ("nasty/nonplanar_cap.obj", Read(217, 384, 0, Chi(1))),
    ("nasty/off_whitespace.off", Read(8, 12, 6, Chi(2))),
    ("nasty/points_only.obj", Refused("but no faces")),
    ("nasty/polygon_faces.obj", Refused("crosses or touches itself")),
    ("nasty/shared_edge_solids.STL", Read(14, 24, 0, No("NonManifoldEdge"))),
    ("nasty/triangle_soup.stl", Read(300, 100, 0, Chi(100))),
    ("nasty/two_objects.obj", Read(12, 16, 0, Chi(4))),
    ("nasty/wireframe_lines_only.obj", Refused("but no faces")),
    ("planar/annulus_60v.obj", Read(60, 98, 0, Chi(0))),
    ("planar/card_strip.obj", Read(10, 8, 0, Chi(1))),
    ("planar/disk_688v_mm_scale.obj", Read(688, 1296, 0, Chi(1))),
    ("planar/lego_outline.ply", Read(1649, 3072, 0, Chi(1))),
    ("planar/lshape_6t.obj", Read(8, 6, 0, Chi(1))),
    ("planar/mat_60x20.obj", Read(1200, 2242, 0, Chi(1))),
    ("planar/square_delaunay_102v.obj", Read(102, 170, 0, Chi(1))),
    ("planar/square_irregular_1939v.obj", Read(1939, 3716, 0, Chi(1))),
    ("planar/step_reentrant_2302v.obj", Read(2302, 4222, 0, Chi(1))),
    ("planar/two_sheets_one_file.obj", Read(1200, 2204, 0, Chi(2))),
    ("planar/two_triangles.obj", Read(4, 2, 0, Chi(1))),
    ("tools/cone.obj", Read(5, 4, 0, Chi(1))),
    ("tools/cylinder.obj", Read(130, 256, 0, Chi(2))),
    ("tools/plate_holes.STL", Read(618, 1252, 0, Chi(-8))),
    ("tools/punching_press_fixed.off", Read(176, 336, 0, Chi(8))),
    ("tools/punching_press_p1.off", Read(370, 736, 0, Chi(2))),
    ("tools/punching_press_p2.off", Read(484, 972, 0, Chi(-2))),
    ("tools/punching_press_p4.off", Read(484, 972, 0, Chi(-2))),
    ("tools/punching_press_p5.off", Read(253, 502, 0, Chi(2))),
    ("tools/skirt_annulus_nonplanar.obj", Read(1024, 1920, 0, Chi(0))),
    ("tools/sphere_1k.obj", Read(1239, 2474, 0, Chi(2))),
    ("tools/table.obj", Read(6712, 13420, 0, Chi(2))),
];

/// The name of the innermost variant but data: `NoFaces`, or `Topology`'s `NonManifoldEdge`.
fn variant(problem: &MeshFileProblem) -> String {
    let text = match problem {
        MeshFileProblem::Mesh(MeshError::Topology(e)) => format!("{e:?}"),
        MeshFileProblem::Mesh(e) => format!("{e:?}"),
        e => format!("{e:?}"),
    };
    text.chars().take_while(|c| c.is_alphanumeric()).collect()
}

#[test]
fn every_file_is_read_or_refused_for_the_right_reason() {
    let Some(root) = folder("") else { return };
    for (name, expected) in &FILES {
        let read = read_mesh(&root.join(name));
        match (read, expected) {
            (Ok(mesh), Read(vertices, faces, polygons, surface)) => {
                let got = (mesh.vertex_count(), mesh.faces.len(), mesh.polygons);
                assert_eq!(got, (*vertices, *faces, *polygons), "{name}");
                match (mesh.into_sheet(), surface) {
                    (Ok(sheet), Chi(chi)) => {
                        assert_eq!(sheet.topology().euler_characteristic(), *chi, "{name}");
                    }
                    (Err(e), No(reason)) => assert_eq!(variant(&e.problem), *reason, "{name}"),
                    (result, _) => panic!("{name}: {:?}", result.map(|_| "a sheet")),
                }
            }
            (Err(e), Refused(reason)) => {
                assert!(e.with_advice().len() > 60, "an error explains itself: {e}");
                assert!(e.to_string().contains(reason), "{name}: {e}");
            }
            (Ok(_), Refused(reason)) => panic!("{name} was read, and not refused as {reason}"),
            (Err(e), Read(..)) => panic!("{e}"),
        }
    }
}

/// The table has every file of a known format, and no reader panics at a file of another one.
#[test]
fn the_table_is_complete_and_nothing_panics() {
    let Some(root) = folder("") else { return };
    let mut pending = vec![root.clone()];
    while let Some(path) = pending.pop() {
        if path.is_dir() {
            let entries = std::fs::read_dir(&path).expect("readable");
            pending.extend(entries.map(|e| e.expect("readable").path()));
            continue;
        }
        let bytes = std::fs::read(&path).expect("readable");
        for format in MeshFormat::ALL {
            if let Ok(mut mesh) = parse_mesh(&bytes, format, &path, &MeshOptions::default()) {
                let _ = mesh.repair();
                let _ = mesh.into_sheet();
            }
        }
        let name = path
            .strip_prefix(&root)
            .expect("inside")
            .to_string_lossy()
            .into_owned();
        let listed = FILES.iter().any(|(n, _)| *n == name);
        assert_eq!(MeshFormat::of(&path).is_some(), listed, "{name}");
    }
}

/// Koryo Miura's pattern: each interior vertex has four creases, three of one kind and one of the other
/// (Maekawa's theorem: mountains and valleys differ by two), and opposite angles add up to a straight one
/// (Kawasaki's theorem).
#[test]
fn a_miura_file_has_the_creases_of_a_flat_foldable_pattern() {
    let Some(folder) = folder("fold") else { return };
    for (name, tolerance) in [
        ("miura_ori_oripa_quads.fold", 1e-6),
        ("miura_herringbone_8x8_tri.fold", 1e-3),
    ] {
        let mesh = read_mesh(&folder.join(name)).expect("a crease pattern");
        let count = |a| mesh.creases.iter().filter(|c| c.assignment == a).count();
        let [mountains, valleys] = [EdgeAssignment::Mountain, EdgeAssignment::Valley].map(count);
        assert_eq!((mountains, valleys), (60, 60), "{name}");
        assert_eq!(
            (count(EdgeAssignment::Boundary), count(EdgeAssignment::Flat)),
            (32, 56),
            "{name}"
        );
        let sheet = mesh.clone().into_sheet().expect("a sheet");
        let t = sheet.topology();
        let assignments = mesh.fold_assignments(t).expect("a FOLD file");
        let mut checked = 0;
        for v in t.vertex_ids().filter(|&v| !t.is_boundary_vertex(v)) {
            let sign = |e: &EdgeId| assignments[e.index()].map_or(0.0, FoldAssignment::sign);
            let folds: Vec<EdgeId> = t
                .vertex_edges(v)
                .iter()
                .copied()
                .filter(|e| sign(e) != 0.0)
                .collect();
            assert_eq!(folds.len(), 4, "{name}: {v}");
            assert_eq!(
                folds.iter().map(sign).sum::<f64>().abs(),
                2.0,
                "{name}: {v}"
            );
            let p = sheet.position(v);
            let mut directions: Vec<f64> = folds
                .iter()
                .map(|&e| sheet.position(t.other_end(e, v)))
                .map(|q| (q[1] - p[1]).atan2(q[0] - p[0]))
                .collect();
            directions.sort_by(f64::total_cmp);
            let opposite = directions[1] - directions[0] + directions[3] - directions[2];
            assert!(
                (opposite - std::f64::consts::PI).abs() < tolerance,
                "{name}: {v}: {opposite}"
            );
            checked += 1;
        }
        assert_eq!(checked, 49, "{name}");
    }
}
