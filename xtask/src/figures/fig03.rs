//! Fig. 3: the directions in which a mesh folds.

use super::sketch::{Sketch, captioned};
use super::{Made, Picture, Table, caption, style, svg};
use crate::draw::{
    Colour, Drawing, SMALL, Stroke, TEXT, flat_edges, flat_faces, palette, plan, row,
};
use crate::report::columns;
use anyhow::{Result, ensure};
use isosheet_coords::EulerParameters;
use isosheet_mesh::generate::{anisotropic_grid, isotropic_square};
use isosheet_mesh::vec3::{axpy, norm, sub};
use isosheet_mesh::{CreasePattern, EdgeId, Sheet};
use std::f64::consts::{FRAC_PI_4, PI};

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
    let mut pictures = svg(3, &all, alt);
    let tries = [
        (&one_way, "one-way grid", 3.0 * FRAC_PI_4),
        (&jack, "union jack", FRAC_PI_4),
        (&one_way, "one-way grid", FRAC_PI_4),
    ];
    let folded = tries.map(|(sheet, name, along)| Folded::of(sheet, name, along));
    check(&folded)?;
    let (panels, words) = folded
        .iter()
        .map(|f| (f.drawing(), f.words()))
        .unzip::<_, _, Vec<_>, Vec<_>>();
    let alt = "Both grids folded along a diagonal, and the one-way grid along the other, where edges change their lengths";
    pictures.push(Picture::svg(
        "fig03-folded",
        &captioned(panels, &words, 40.0),
        alt,
    ));
    Ok(Made {
        title: "Folding directions",
        paper: "Meshes refined by the 1–4 split fold horizontally, vertically and along the diagonal from lower right to upper \
                left, but not along the other diagonal: the pattern is anisotropic.",
        here: "Straight crease lines from boundary to boundary are found on the meshes and coloured by direction; the bars are \
               their total lengths by direction. Both meshes fold by 70° along a diagonal that is a crease line and keep all lengths; along the \
               other diagonal the one-way grid would have to change those of the red edges.",
        tables: vec![anisotropy],
        pictures,
        ..Made::default()
    })
}

/// The fold that is tried.
const FOLD: f64 = 70.0 * PI / 180.0;

/// A sheet that is folded along a line through its middle, as if its faces could be.
struct Folded<'a> {
    sheet: &'a Sheet,
    name: &'static str,
    /// Direction of the line, radians.
    along: f64,
    x: Vec<[f64; 3]>,
}

impl<'a> Folded<'a> {
    fn of(sheet: &'a Sheet, name: &'static str, along: f64) -> Self {
        let (s, c) = along.sin_cos();
        let middle = [0.5, 0.5, 0.0];
        let turn = |sign: f64| EulerParameters::about(&[c, s, 0.0], 0.5 * sign * FOLD);
        let sides = [turn(-1.0), turn(1.0)];
        let place = |p: &[f64; 3]| {
            let from = sub(p, middle);
            let is_left = c * from[1] - s * from[0] > 0.0;
            axpy(middle, 1.0, sides[usize::from(is_left)].rotate(&from))
        };
        let x = sheet.positions().as_chunks::<3>().0.iter().map(place);
        Self {
            sheet,
            name,
            along,
            x: x.collect(),
        }
    }

    /// The relative change of the length of an edge.
    fn strain(&self, e: EdgeId) -> f64 {
        let [a, b] = self.sheet.topology().edges()[e.index()];
        let length = norm(sub(self.x[a.index()], self.x[b.index()]));
        (length / self.sheet.lengths()[e.index()] - 1.0).abs()
    }

    /// The edges that would change their lengths, and the largest relative change.
    fn strained(&self) -> (usize, f64) {
        let strains = self.sheet.topology().edge_ids().map(|e| self.strain(e));
        let strained: Vec<f64> = strains.filter(|s| *s > ROUNDING).collect();
        (strained.len(), strained.into_iter().fold(0.0, f64::max))
    }

    fn words(&self) -> Vec<String> {
        let degrees = self.along.to_degrees();
        let lengths = match self.strained() {
            (0, _) => "all lengths are kept".to_owned(),
            (edges, most) => format!("{edges} edges change by up to {:.0} %", 100.0 * most),
        };
        vec![format!("{}, along {degrees:.0}°", self.name), lengths]
    }

    fn drawing(&self) -> Drawing {
        let mut d = Sketch::seen(-90.0, 36.0, 112.0);
        let t = self.sheet.topology();
        let near = |f: &[[f64; 3]; 3]| f.iter().map(|p| d.view.nearness(p)).sum::<f64>();
        let mut faces: Vec<[[f64; 3]; 3]> = t
            .faces()
            .iter()
            .map(|f| f.map(|v| self.x[v.index()]))
            .collect();
        faces.sort_by(|a, b| near(a).total_cmp(&near(b)));
        for corners in faces {
            d.face(corners, style::FACE);
        }
        for e in t.edge_ids().filter(|e| self.strain(*e) > ROUNDING) {
            let ends = t.edges()[e.index()].map(|v| self.x[v.index()]);
            d.line(&ends, Stroke::new(palette::VERMILION, 1.4));
        }
        d.drawing
    }
}

/// Relative changes of lengths that are rounding.
const ROUNDING: f64 = 1e-12;

/// The grids fold along the first two lines, and not along the third.
fn check(folded: &[Folded<'_>; 3]) -> Result<()> {
    let strained = folded.each_ref().map(|f| f.strained().0 > 0);
    ensure!(
        strained == [false, false, true],
        "folds that change lengths: {strained:?}"
    );
    Ok(())
}

/// Colour of a direction; the four of the square patterns have their own.
fn colour(angle: f64) -> Colour {
    let eighth = (angle / FRAC_PI_4).round() as i64;
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
