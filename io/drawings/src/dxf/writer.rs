//! DXF files that are written: release 12, which all programs read, with the unit in the header.

use crate::stroke::{LAYERS, MILLIMETRES, Stroke, of_class};
use std::fmt::Write;

/// The text of a drawing with a layer for each class of lines.
pub(crate) fn text(lines: &[Stroke]) -> String {
    let mut text = String::new();
    let mut group = |code: u32, value: &dyn std::fmt::Display| {
        let _ = writeln!(text, "{code}\n{value}");
    };
    let header: [(u32, &str); 9] = [
        (0, "SECTION"),
        (2, "HEADER"),
        (9, "$ACADVER"),
        (1, "AC1009"),
        (9, "$INSUNITS"),
        (70, "4"),
        (9, "$MEASUREMENT"),
        (70, "1"),
        (0, "ENDSEC"),
    ];
    for (code, value) in header {
        group(code, &value);
    }
    let used = |(class, ..): &(_, _, _, _)| of_class(lines, *class).next().is_some();
    let layers: Vec<_> = LAYERS.into_iter().filter(used).collect();
    for (code, value) in [(0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LAYER")] {
        group(code, &value);
    }
    group(70, &layers.len());
    for (_, name, _, colour) in &layers {
        group(0, &"LAYER");
        group(2, name);
        group(70, &0);
        group(62, colour);
        group(6, &"CONTINUOUS");
    }
    for (code, value) in [
        (0, "ENDTAB"),
        (0, "ENDSEC"),
        (0, "SECTION"),
        (2, "ENTITIES"),
    ] {
        group(code, &value);
    }
    for (class, name, ..) in &layers {
        for line in of_class(lines, *class) {
            let points: Vec<_> = line
                .points
                .iter()
                .map(|p| p.map(|c| MILLIMETRES * c))
                .collect();
            if let [a, b] = points[..] {
                group(0, &"LINE");
                group(8, name);
                for (code, value) in [(10, a[0]), (20, a[1]), (11, b[0]), (21, b[1])] {
                    group(code, &value);
                }
                continue;
            }
            group(0, &"POLYLINE");
            group(8, name);
            group(66, &1);
            group(70, &i32::from(line.is_closed()));
            let drawn = points.len() - usize::from(line.is_closed());
            for p in &points[..drawn] {
                group(0, &"VERTEX");
                group(8, name);
                group(10, &p[0]);
                group(20, &p[1]);
            }
            group(0, &"SEQEND");
            group(8, name);
        }
    }
    group(0, &"ENDSEC");
    group(0, &"EOF");
    text
}
