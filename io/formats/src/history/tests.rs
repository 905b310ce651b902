use super::*;

fn row(k: usize) -> HistoryRow {
    let s = (k as f64).sin();
    HistoryRow {
        t: 0.1 * k as f64,
        h: 0.1,
        substeps: k + 1,
        iterations: 3 * k,
        factorisations: 5 * k,
        rejected: k % 3,
        kinetic: s * 1e-12,
        potential: -s * 1e9,
        total: 1.0 / 3.0,
        drift: f64::MIN_POSITIVE * s,
        work: 0.1 * s,
        damped: 0.2 * s,
        friction: 0.3 * s,
        plastic: (k % 3 == 1).then_some(s * s),
        strain: f64::EPSILON,
        gap: (k % 2 == 1).then_some(s),
    }
}

#[test]
fn rows_come_back_bit_for_bit() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("new/history.csv");
    let mut w = HistoryWriter::create(&path).unwrap();
    assert_eq!(w.path(), path);
    assert!(read_history(&path).unwrap().is_empty());
    let rows: Vec<_> = (0..20).map(row).collect();
    for (k, r) in rows.iter().enumerate() {
        w.append(r).unwrap();
        // Readable while the run goes on.
        assert_eq!(read_history(&path).unwrap(), rows[..=k]);
    }
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(
        text.starts_with(
            "t,h,substeps,iterations,factorisations,rejected,kinetic,potential,H,dH,work,damped,friction,plastic,strain,gap\n"
        ),
        "{text}"
    );
}

#[test]
fn a_cut_file_keeps_its_complete_rows() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("history.csv");
    let mut w = HistoryWriter::create(&path).unwrap();
    for k in 0..3 {
        w.append(&row(k)).unwrap();
    }
    let text = std::fs::read(&path).unwrap();
    let second_end = text
        .iter()
        .enumerate()
        .filter(|(_, b)| **b == b'\n')
        .nth(2)
        .unwrap()
        .0
        + 1;
    for cut in second_end..text.len() {
        std::fs::write(&path, &text[..cut]).unwrap();
        assert_eq!(read_history(&path).unwrap(), [row(0), row(1)]);
    }
}

#[test]
fn a_history_continues_where_it_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("history.csv");
    let mut whole = HistoryWriter::create(&path).unwrap();
    let mut lengths = vec![whole.written()];
    for k in 0..4 {
        whole.append(&row(k)).unwrap();
        lengths.push(whole.written());
    }
    whole.sync().unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(bytes.len() as u64, lengths[4].length);
    for (k, length) in lengths.iter().enumerate() {
        let mut resumed = HistoryWriter::resume(&path, *length).unwrap();
        for j in k..4 {
            resumed.append(&row(j)).unwrap();
        }
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
    }
    // Every byte that counts is looked at.
    for at in 0..lengths[2].length as usize {
        let mut changed = bytes.clone();
        changed[at] ^= 1;
        std::fs::write(&path, &changed).unwrap();
        let refused = HistoryWriter::resume(&path, lengths[2]);
        let error = refused.unwrap_err().to_string();
        assert!(
            error.contains("its checksum is wrong"),
            "byte {at}: {error}"
        );
        assert_eq!(std::fs::read(&path).unwrap(), changed);
    }
    std::fs::write(&path, &bytes).unwrap();
    let longer = HistoryWriter::resume(
        &path,
        Written {
            length: lengths[4].length + 1,
            ..lengths[4]
        },
    );
    assert!(
        longer
            .unwrap_err()
            .to_string()
            .contains("it was cut or replaced")
    );
    let missing = HistoryWriter::resume(&dir.path().join("none.csv"), lengths[0]);
    assert!(missing.unwrap_err().to_string().starts_with("cannot read "));
}

#[test]
fn nan_is_refused_and_leaves_the_file_as_it_was() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("history.csv");
    let mut w = HistoryWriter::create(&path).unwrap();
    w.append(&row(1)).unwrap();
    let before = std::fs::read(&path).unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let cases = [
            (
                HistoryRow {
                    kinetic: bad,
                    ..row(2)
                },
                "kinetic",
            ),
            (
                HistoryRow {
                    total: bad,
                    ..row(2)
                },
                "H",
            ),
            (
                HistoryRow {
                    gap: Some(bad),
                    ..row(2)
                },
                "gap",
            ),
            (
                HistoryRow {
                    plastic: Some(bad),
                    ..row(2)
                },
                "plastic",
            ),
        ];
        for (r, name) in cases {
            match w.append(&r) {
                Err(FileError::Data(error)) => {
                    assert!(
                        error.message.starts_with(&format!("{name} at t = ")),
                        "{error}"
                    );
                }
                other => panic!("{other:?}"),
            }
        }
    }
    assert_eq!(std::fs::read(&path).unwrap(), before);
}

#[test]
fn other_files_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("x.csv");
    let refused = |says: &str| {
        let error = read_history(&path).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    };
    refused("cannot read ");
    std::fs::write(&path, "").unwrap();
    refused("does not start with the columns");
    std::fs::write(&path, "a,b\n1,2\n").unwrap();
    refused("but with \"a,b\"");
    let header = COLUMNS.join(",");
    std::fs::write(
        &path,
        format!("{header}\n1,2,x,4,5,6,7,8,9\n1,2,3,4,5,6,7,8,9\n"),
    )
    .unwrap();
    refused("row 1: ");
    assert!(HistoryWriter::create(dir.path()).is_err());
}
