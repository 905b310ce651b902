//! Drawings that are written: lines for a cutter, in true size.

use super::file::DrawingFormat;
use super::stroke::{MILLIMETRES, Stroke};
use crate::{dxf, svg};
use isosheet_files::{DataError, FileError, write_atomically};
use std::io::Write;
use std::path::Path;

/// Writes lines as a drawing in millimetres, atomically, in the format of the extension: a layer for each
/// class of lines, which [`read_drawing`](crate::read_drawing) takes for what they are.
///
/// ```
/// use isosheet_drawings::{DrawingOptions, LineClass, Stroke, read_drawing, write_drawing};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("card.svg");
/// let outline = vec![[0.0, 0.0], [0.02, 0.0], [0.02, 0.01], [0.0, 0.01], [0.0, 0.0]];
/// let fold = vec![[0.01, 0.0], [0.01, 0.01]];
/// let lines = [
///     Stroke { points: outline, class: LineClass::Cut, angle: None },
///     Stroke { points: fold, class: LineClass::Valley, angle: Some(1.0) },
/// ];
/// write_drawing(&path, &lines)?;
/// let drawing = read_drawing(&path, &DrawingOptions::with_spacing(0.002))?;
/// assert_eq!(drawing.lines.len(), 5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FileError`] for a name that is none of a drawing, a coordinate or an angle that is not finite, and a
/// file that cannot be written; nothing is written then.
pub fn write_drawing(path: &Path, lines: &[Stroke]) -> Result<(), FileError> {
    let format = DrawingFormat::of(path).ok_or_else(|| {
        let remedy = "name a file .svg or .dxf";
        FileError::content(
            path,
            DataError::new("it is no drawing by its name", remedy),
            remedy,
        )
    })?;
    let is_finite = |line: &Stroke| {
        let mut all = line.points.iter().flatten().copied().chain(line.angle);
        all.all(|c| (MILLIMETRES * c).is_finite())
    };
    if let Some(k) = lines.iter().position(|line| !is_finite(line)) {
        let message = format!("line {k} has a coordinate or an angle that is not finite");
        return Err(FileError::unwritable(path, std::io::Error::other(message)));
    }
    let text = match format {
        DrawingFormat::Svg => svg::text(lines),
        DrawingFormat::Dxf => dxf::text(lines),
    };
    write_atomically(path, |w| w.write_all(text.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DrawingOptions, LineClass, LineRules, read_drawing};
    use std::f64::consts::PI;

    fn strokes() -> Vec<Stroke> {
        let stroke = |points: &[[f64; 2]], class, angle| Stroke {
            points: points.to_vec(),
            class,
            angle,
        };
        let [a, b, c, d] = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.1 / 3.0], [0.0, 0.1 / 3.0]];
        vec![
            stroke(&[a, b, c, d, a], LineClass::Cut, None),
            stroke(&[[0.1, 0.0], [0.1, 0.01]], LineClass::Mountain, Some(0.3)),
            stroke(&[[0.1, 0.01], [0.1, 0.02]], LineClass::Mountain, Some(PI)),
            stroke(&[[0.2, 0.0], [0.2, 0.01]], LineClass::Valley, Some(1.7)),
            stroke(&[[0.2, 0.02], [0.21, 0.02]], LineClass::Crease, None),
            stroke(&[[0.2, 0.03], [0.21, 0.03]], LineClass::Flat, None),
            stroke(&[[0.25, 0.01], [0.26, 0.02]], LineClass::Ignored, None),
        ]
    }

    /// Both formats give back lines, classes, and SVG the angles too.
    #[test]
    fn what_is_written_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["out.svg", "out.DXF"] {
            let path = folder.path().join(name);
            write_drawing(&path, &strokes()).unwrap();
            let drawing = read_drawing(&path, &DrawingOptions::with_spacing(1.0)).unwrap();
            assert_eq!(drawing.assumed_unit, None);
            assert!(drawing.left_out.is_empty());
            let rules = LineRules::default();
            // An SVG drawing has a margin around its lines.
            let ends: Vec<[f64; 2]> = drawing.lines.iter().flat_map(|l| l.curve.ends()).collect();
            let least = [0, 1].map(|k| ends.iter().fold(f64::INFINITY, |m, p| m.min(p[k])));
            // An SVG drawing has thirteen digits of its longer side, 0.3 m.
            let near = |p: [f64; 2], q: [f64; 2]| {
                (p[0] - least[0] - q[0]).hypot(p[1] - least[1] - q[1]) < 2e-13
            };
            for stroke in strokes() {
                let own = drawing.lines.iter().filter(|line| {
                    let pen = &drawing.pens[line.pen];
                    rules.class(pen).unwrap().0 == stroke.class
                });
                for side in stroke.points.windows(2) {
                    let line = own.clone().find(|line| {
                        let [a, b] = line.curve.ends();
                        near(a, side[0]) && near(b, side[1])
                    });
                    let opacity = drawing.pens[line.expect("a side").pen].opacity;
                    let is_svg = name == "out.svg";
                    let expected = if is_svg { stroke.opacity() } else { 1.0 };
                    assert!((opacity - expected).abs() < 1e-15, "{name}: {opacity}");
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_written_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.svg");
        let mut lines = strokes();
        lines[1].points[0][1] = f64::NAN;
        let error = write_drawing(&path, &lines).unwrap_err();
        assert!(error.to_string().contains("line 1"), "{error}");
        assert!(!path.exists());
        assert!(write_drawing(&folder.path().join("out.pdf"), &strokes()).is_err());
        write_drawing(&path, &[]).unwrap();
    }
}
