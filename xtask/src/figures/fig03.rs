//! Fig. 3: the directions in which a mesh folds.

use super::{Made, Table, caption, style, svg};
use crate::draw::{
    Colour, Drawing, SMALL, Stroke, TEXT, flat_edges, flat_faces, palette, plan, row,
};
use crate::report::columns;
use anyhow::Result;
use isosheet_mesh::generate::{anisotropic_grid, isotropic_square};
use isosheet_mesh::{CreasePattern, Sheet};

const SIDE: f64 = 118.0;

pub(super) fn make() -> Result<Made> {
    let one_way = anisotropic_grid(4, 4, 1.0, 1.0)?;
    let jack = isotropic_square(1, 1.0)?;
    let (mut panels, mut anisotropies) = (Vec::new(), Vec::new());
    for (sheet, name) in [
        (&one_way, "one-way grid (Fig. 1)"),
        (&jack, "union jack (Fig. 4)"),
    ] {
        let pattern = CreasePattern::of(sheet, CreasePattern::TOLERANCE);
        let mut lines = draw_lines(sheet, &pattern);
        let names: Vec<String> = pattern
            .folding_directions()
            .iter()
            .map(|d| format!("{:.0}°", d.angle.to_degrees()))
            .collect();
        caption(
            &mut lines,
            [0.5 * SIDE, -7.0],
            TEXT,
            &[name.to_owned(), format!("folds along {}", names.join(", "))],
        );
        panels.push(lines);
        let mut rose = rose(sheet, &pattern);
        let words = ["crease length", "(circles: 2 and 4 sides)"].map(str::to_owned);
        caption(&mut rose, [0.0, 0.5 * SIDE - 46.0], SMALL, &words);
        panels.push(rose);
        anisotropies.push(pattern.anisotropy());
    }
    let gaps = [16.0, 34.0];
    let pairs: Vec<Drawing> = panels.chunks(2).map(|pair| row(pair, gaps[0])).collect();
    let all = row(&pairs, gaps[1]);
    let anisotropy = Table::of(
        "Anisotropy |Σ l exp(2iφ)| / Σ l of the crease lines (length l, direction φ)",
        ["one-way grid", "union jack"].into_iter().zip(anisotropies),
        columns! { row;
            "mesh" => row.0,
            "anisotropy" => row.1,
        },
    );
    let alt = "Crease lines of the one-way grid and of the union-jack grid with their directions";
    Ok(Made {
        title: "Folding directions",
        paper: "Meshes refined by the 1–4 split fold horizontally, vertically and along the diagonal from lower right to upper \
                left, but not along the other diagonal: the pattern is anisotropic.",
        here: "Straight crease lines from boundary to boundary are found on the meshes and coloured by direction; the bars are \
               their total lengths by direction.",
        tables: vec![anisotropy],
        pictures: svg(3, &all, alt),
        ..Made::default()
    })
}

/// Colour of a direction; the four of the square patterns have their own.
fn colour(angle: f64) -> Colour {
    let eighth = (angle / std::f64::consts::FRAC_PI_4).round() as i64;
    [
        palette::BLUE,
        palette::ORANGE,
        palette::GREEN,
        palette::VERMILION,
    ][eighth.rem_euclid(4) as usize]
}

fn draw_lines(sheet: &Sheet, pattern: &CreasePattern) -> Drawing {
    let mut d = Drawing::new();
    flat_faces(&mut d, sheet, SIDE, |_| style::FACE);
    flat_edges(&mut d, sheet, SIDE, |e| {
        sheet.topology().is_boundary_edge(e).then_some(style::EDGE)
    });
    let place = plan(sheet, SIDE);
    for line in pattern.through_lines() {
        let points: Vec<[f64; 2]> = line.vertices.iter().map(|&v| place(v)).collect();
        d.line(&points, Stroke::new(colour(line.direction), 1.3));
    }
    for line in pattern
        .lines
        .iter()
        .filter(|l| !pattern.through_lines().any(|t| t == *l))
    {
        let points: Vec<[f64; 2]> = line.vertices.iter().map(|&v| place(v)).collect();
        d.line(&points, style::GHOST);
    }
    d
}

/// Half-lines from a point in each of the eight directions, as long as the total length of the crease lines
/// along them.
fn rose(sheet: &Sheet, pattern: &CreasePattern) -> Drawing {
    let mut d = Drawing::new();
    let unit = 9.0 / sheet.area().sqrt();
    let centre = [0.0, 0.5 * SIDE];
    for circle in [2.0, 4.0] {
        let points: Vec<[f64; 2]> = (0..=72)
            .map(|k| {
                let (s, c) = (f64::from(k) * std::f64::consts::TAU / 72.0).sin_cos();
                [centre[0] + 9.0 * circle * c, centre[1] + 9.0 * circle * s]
            })
            .collect();
        d.line(&points, Stroke::new(palette::PALE, 0.5));
    }
    for direction in pattern.folding_directions() {
        let (s, c) = direction.angle.sin_cos();
        let r = unit * direction.length;
        let ends = [
            [centre[0] - r * c, centre[1] - r * s],
            [centre[0] + r * c, centre[1] + r * s],
        ];
        d.line(&ends, Stroke::new(colour(direction.angle), 3.0));
    }
    d
}
