use isosheet_mesh::{Advice, generate};
use npyz::NpyFile;
use npyz::npz::{array_name_from_file_name, file_name_from_array_name};
use std::fs::File;
use zip::ZipArchive;
use zip::read::ZipFile;

use super::*;

fn sample() -> (Sheet, Trajectory) {
    let sheet = generate::annulus(7, 2, 0.3, 1.0).unwrap();
    let mut run = Trajectory::new(&sheet);
    for k in 0..5 {
        let x: Vec<f64> = sheet
            .positions()
            .iter()
            .enumerate()
            .map(|(i, c)| c + (k as f64 * i as f64).sin() / 3.0)
            .collect();
        let forces: Vec<f64> = (0..sheet.lengths().len())
            .map(|e| (e as f64 - 9.5) * 10.0_f64.powi(k))
            .collect();
        let contact_forces: Vec<f64> = x.iter().map(|c| c * c - 0.2).collect();
        let gaps: Vec<f64> = (0..x.len() / 3).map(|v| 1e-3 / (v + 1) as f64).collect();
        let count = 2 * sheet.topology().face_count();
        let curvatures: Vec<f64> = (0..count).map(|f| f as f64 * 3.5 - k as f64).collect();
        let data = FrameData {
            rod_forces: &forces,
            contact_forces: &contact_forces,
            gaps: &gaps,
            plastic_angles: &forces,
            plastic_curvatures: &curvatures,
            crease_bends: &forces,
            rulings: &[&curvatures[..], &curvatures[..count / 2]].concat(),
            ruling_curvatures: &curvatures[..count / 2],
            gauss_curvatures: &gaps,
        };
        run.push_with(0.1 * k as f64, &x, &data).unwrap();
    }
    (sheet, run)
}

#[test]
fn comes_back_bit_for_bit() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("runs/a/trajectory.npz");
    let (sheet, run) = sample();
    run.write(&path).unwrap();
    let back = Trajectory::read(&path).unwrap();
    assert_eq!(back, run);
    assert_eq!((back.len(), back.vertex_count()), (5, 21));
    assert!(!back.is_empty());
    assert_eq!(back.frame(4), run.frame(4));
    assert_eq!(back.frame(5), None);
    assert_eq!(back.times()[3], 0.1 * 3.0);
    assert_eq!(back.faces(), sheet.face_indices());
    assert_eq!(back.edges().len(), sheet.lengths().len());
    assert_eq!(back.rest_lengths(), sheet.lengths());
    let last = back.rod_forces(4).unwrap();
    assert_eq!((last.len(), last[3]), (sheet.lengths().len(), -6.5e4));
    assert_eq!(back.rod_forces(5), None);
    let (x, forces) = (back.frame(3).unwrap(), back.contact_forces(3).unwrap());
    assert_eq!((forces.len(), forces[4]), (63, x[4] * x[4] - 0.2));
    assert_eq!(back.gaps(1).unwrap()[1..3], [1e-3 / 2.0, 1e-3 / 3.0]);
    assert_eq!((back.contact_forces(5), back.gaps(5)), (None, None));
    let curvatures = back.plastic_curvatures(4).unwrap();
    assert_eq!(
        (curvatures.len(), curvatures[3]),
        (2 * sheet.topology().face_count(), 6.5)
    );
    assert_eq!(
        (back.plastic_angles(4), back.plastic_angles(5)),
        (Some(last), None)
    );
    assert_eq!(
        (back.crease_bends(4), back.crease_bends(5)),
        (Some(last), None)
    );
    let faces = sheet.topology().face_count();
    let rulings = back.rulings(4).unwrap();
    assert_eq!(
        (rulings.len(), &rulings[..2 * faces]),
        (3 * faces, curvatures)
    );
    assert_eq!(back.ruling_curvatures(4), Some(&curvatures[..faces]));
    assert_eq!(back.gauss_curvatures(4), back.gaps(4));
    // Without forces, and without frames: still a file.
    let mut run = Trajectory::new(&sheet);
    run.push(0.0, sheet.positions()).unwrap();
    run.write(&path).unwrap();
    let back = Trajectory::read(&path).unwrap();
    assert_eq!((back.rod_forces(0), &back), (None, &run));
    Trajectory::new(&sheet).write(&path).unwrap();
    assert!(Trajectory::read(&path).unwrap().is_empty());
}

/// The directory of the archive: entries carry a fixed date (1980-01-01 00:00, `0x0021` and 0 in the format)
/// and no clock.
#[test]
fn equal_trajectories_are_equal_files() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("trajectory.npz");
    let (_, run) = sample();
    run.write(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let entries: Vec<usize> = (0..bytes.len() - 46)
        .filter(|k| bytes[*k..].starts_with(b"PK\x01\x02"))
        .collect();
    assert_eq!(entries.len(), 14);
    for k in entries {
        assert_eq!(bytes[k + 12..k + 16], [0, 0, 0x21, 0]);
    }
    run.write(&path).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
}

/// The file as the numpy reader of another crate sees it.
fn array_in<'a>(npz: &'a mut ZipArchive<File>, name: &str) -> NpyFile<ZipFile<'a, File>> {
    let entry = npz.by_name(&file_name_from_array_name(name)).unwrap();
    NpyFile::new(entry).unwrap()
}

#[test]
fn arrays_have_the_documented_names_types_and_shapes() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("trajectory.npz");
    let (sheet, run) = sample();
    run.write(&path).unwrap();
    let mut npz = ZipArchive::new(File::open(&path).unwrap()).unwrap();
    let names = npz.file_names().map(|name| {
        let name = name.unwrap();
        array_name_from_file_name(&name).unwrap().to_owned()
    });
    let mut names: Vec<String> = names.collect();
    names.sort();
    assert_eq!(
        names,
        [
            "contact_forces",
            "crease_bends",
            "edges",
            "faces",
            "gaps",
            "gauss_curvatures",
            "plastic_angles",
            "plastic_curvatures",
            "rest_lengths",
            "rod_forces",
            "ruling_curvatures",
            "rulings",
            "t",
            "x"
        ]
    );
    let edges = sheet.topology().edge_count() as u64;
    for (name, shape) in [
        ("contact_forces", &[5, 21, 3][..]),
        ("gaps", &[5, 21]),
        ("plastic_angles", &[5, edges]),
        ("plastic_curvatures", &[5, 28, 2]),
        ("crease_bends", &[5, edges]),
        ("rulings", &[5, 28, 3]),
        ("ruling_curvatures", &[5, 28]),
        ("gauss_curvatures", &[5, 21]),
    ] {
        let array = array_in(&mut npz, name);
        assert_eq!(
            (array.shape(), array.dtype().descr()),
            (shape, "'<f8'".to_owned())
        );
    }
    let forces = array_in(&mut npz, "rod_forces");
    assert_eq!(forces.shape(), [5, sheet.lengths().len() as u64]);
    assert_eq!(forces.dtype().descr(), "'<f8'");
    drop(forces);
    let x = array_in(&mut npz, "x");
    assert_eq!(x.shape(), [5, 21, 3]);
    assert_eq!(x.dtype().descr(), "'<f8'");
    let x = x.into_vec::<f64>().unwrap();
    // Row-major: frame, vertex, axis.
    assert_eq!(x[(2 * 21 + 4) * 3 + 1], run.frame(2).unwrap()[3 * 4 + 1]);
    let faces = array_in(&mut npz, "faces");
    assert_eq!(faces.shape(), [28, 3]);
    assert_eq!(faces.dtype().descr(), "'<u4'");
    drop(faces);
    let e = array_in(&mut npz, "edges");
    assert_eq!(e.shape(), [sheet.topology().edge_count() as u64, 2]);
}

#[test]
fn bad_frames_are_refused() {
    let (sheet, mut run) = sample();
    let mut x = sheet.positions().to_vec();
    for (t, x, says) in [
        (
            1.0,
            &x[..6],
            "frame 5 has 6 coordinates, but the mesh has 21 vertices",
        ),
        (0.05, &x[..], "frame 5 has the time 0.05 s after "),
        (f64::NAN, &x[..], "frame 5 has the time NaN s after "),
    ] {
        match run.push(t, x) {
            Err(error) => {
                assert!(error.message.starts_with(says), "{error}");
                assert_eq!(error.index, Some(5));
            }
            Ok(()) => panic!("{says}"),
        }
    }
    x[4] = f64::NAN;
    let error = run.push(1.0, &x).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("coordinate y of vertex 1 in frame 5 is NaN"),
        "{error}"
    );
    x[4] = 0.0;
    let edges = sheet.lengths().len();
    let (rods, forces, gaps) = (vec![0.0; edges], vec![0.0; 63], vec![0.0; 21]);
    let curvatures = vec![0.0; 2 * sheet.topology().face_count()];
    let whole = FrameData {
        rod_forces: &rods,
        contact_forces: &forces,
        gaps: &gaps,
        plastic_angles: &rods,
        plastic_curvatures: &curvatures,
        crease_bends: &rods,
        rulings: &[&curvatures[..], &curvatures[..curvatures.len() / 2]].concat(),
        ruling_curvatures: &curvatures[..curvatures.len() / 2],
        gauss_curvatures: &gaps,
    };
    let mut without = Trajectory::new(&sheet);
    without.push(0.0, &x).unwrap();
    let new = Trajectory::new(&sheet);
    let (none, few) = (&[][..], &rods[..3]);
    for (run, data, array, got, expected) in [
        (
            &run,
            FrameData {
                rod_forces: none,
                ..whole
            },
            "rod_forces",
            0,
            edges,
        ),
        (
            &run,
            FrameData {
                rod_forces: few,
                ..whole
            },
            "rod_forces",
            3,
            edges,
        ),
        (
            &run,
            FrameData {
                contact_forces: none,
                ..whole
            },
            "contact_forces",
            0,
            63,
        ),
        (&run, FrameData { gaps: few, ..whole }, "gaps", 3, 21),
        (
            &new,
            FrameData {
                plastic_angles: few,
                ..whole
            },
            "plastic_angles",
            3,
            edges,
        ),
        (
            &run,
            FrameData {
                plastic_curvatures: none,
                ..whole
            },
            "plastic_curvatures",
            0,
            curvatures.len(),
        ),
        (
            &new,
            FrameData {
                rod_forces: few,
                ..whole
            },
            "rod_forces",
            3,
            edges,
        ),
        (
            &new,
            FrameData {
                contact_forces: few,
                ..whole
            },
            "contact_forces",
            3,
            63,
        ),
        (
            &without,
            FrameData {
                gaps: &gaps,
                ..FrameData::default()
            },
            "gaps",
            21,
            0,
        ),
    ] {
        let (mut run, frame) = (run.clone(), run.len());
        match run.push_with(1.0, &x, &data) {
            Err(error) => assert_eq!(
                error.to_string(),
                format!("frame {frame} has {got} values of `{array}` where {expected} are needed")
            ),
            Ok(()) => panic!("{array}"),
        }
        assert_eq!(run.len(), frame, "nothing was added");
    }
    let mut forces = forces.clone();
    forces[7] = f64::NEG_INFINITY;
    let contact_forces = &forces[..];
    let data = FrameData {
        contact_forces,
        ..whole
    };
    let error = run.push_with(1.0, &x, &data).unwrap_err().to_string();
    assert!(
        error.starts_with("value 7 of `contact_forces` in frame 5 is -inf"),
        "{error}"
    );
    assert_eq!((run.len(), without.len()), (5, 1), "nothing was added");
}

/// Writes what no trajectory has.
fn write_unchecked(run: &Trajectory, path: &Path) {
    let mut npz = ArchiveWriter::new(File::create(path).unwrap(), Packing::Compressed);
    let (frames, vertices) = (run.t.len() as u64, run.vertex_count as u64);
    npz.put("t", &[frames], run.t.iter().copied()).unwrap();
    npz.put("x", &[frames, vertices, 3], run.x.iter().copied())
        .unwrap();
    let (faces, edges) = (run.faces.as_flattened(), run.edges.as_flattened());
    npz.put("faces", &[run.faces.len() as u64, 3], faces.iter().copied())
        .unwrap();
    npz.put("edges", &[run.edges.len() as u64, 2], edges.iter().copied())
        .unwrap();
    let lengths = run.rest_lengths.iter().copied();
    npz.put("rest_lengths", &[run.rest_lengths.len() as u64], lengths)
        .unwrap();
    for quantity in FrameQuantity::ALL {
        let shape = [&[frames], &quantity.shape(run.counts())[..]].concat();
        let values = run.data[quantity as usize].iter().copied();
        npz.put(quantity.name(), &shape, values).unwrap();
    }
    npz.finish().unwrap();
}

#[test]
fn other_files_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("x.npz");
    assert!(Trajectory::read(&path).is_err());
    std::fs::write(&path, b"not a zip").unwrap();
    let error = Trajectory::read(&path).unwrap_err();
    assert_eq!(error.advice(), Some("check that it is an .npz file"));
    let (_, run) = sample();
    run.write(&path).unwrap();
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    assert!(Trajectory::read(&path).is_err(), "cut in half");

    let broken = |change: &dyn Fn(&mut Trajectory), array: &str| {
        let (_, mut run) = sample();
        change(&mut run);
        write_unchecked(&run, &path);
        match Trajectory::read(&path) {
            Err(error) => {
                let named = format!("array `{array}`: ");
                assert!(error.to_string().contains(&named), "{error}");
            }
            Ok(_) => panic!("{array}"),
        }
    };
    broken(&|r| r.faces[3][1] = 21, "faces");
    broken(&|r| r.edges[0][0] = 400, "edges");
    broken(&|r| r.rest_lengths[0] = f64::NAN, "rest_lengths");
    broken(&|r| r.rest_lengths.truncate(3), "rest_lengths");
    broken(&|r| r.t[0] = f64::INFINITY, "t");
    broken(&|r| r.data[0][1] = f64::NAN, "rod_forces");
    broken(&|r| r.data[1][1] = f64::NAN, "contact_forces");
    broken(&|r| r.data[2][1] = f64::INFINITY, "gaps");

    // A missing array.
    let file = File::create(&path).unwrap();
    let mut npz = ArchiveWriter::new(file, Packing::Compressed);
    npz.put("t", &[1], [0.0].into_iter()).unwrap();
    npz.put("x", &[3], [0.0f64; 3].into_iter()).unwrap();
    npz.finish().unwrap();
    let error = Trajectory::read(&path).unwrap_err().to_string();
    assert!(error.contains("array `x`: it has 1 dimensions"), "{error}");
}

/// Deflate makes a thousandth of zeros at best, so that small archives may stand for any memory.
#[test]
fn arrays_are_in_proportion_to_their_archive() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("x.npz");
    let mut npz = ArchiveWriter::new(File::create(&path).unwrap(), Packing::Compressed);
    let entries = 5 << 20;
    npz.put("t", &[entries], std::iter::repeat_n(0.0, entries as usize))
        .unwrap();
    npz.finish().unwrap();
    let length = std::fs::metadata(&path).unwrap().len();
    // 40 MiB, where half of 64 MiB and of a hundred times the archive are allowed.
    let (needs, most) = (8 * entries, (32 << 20) + 50 * length);
    assert!(needs > most);
    let error = Trajectory::read(&path).unwrap_err();
    let said = format!("array `t`: it takes {needs} bytes, more than the {most} that");
    assert!(error.to_string().contains(&said), "{error}");
    let advice = "save the arrays without compression: `numpy.savez`";
    assert_eq!(error.advice(), Some(advice));

    // A sheet at rest is one frame over and over, and is read again all the same.
    let sheet = generate::annulus(7, 2, 0.3, 1.0).unwrap();
    let mut run = Trajectory::new(&sheet);
    let frames = (36 << 20) / size_of_val(sheet.positions());
    for k in 0..frames {
        run.push(k as f64, sheet.positions()).unwrap();
    }
    run.write(&path).unwrap();
    assert_eq!(Trajectory::read(&path).unwrap().len(), frames);
}
