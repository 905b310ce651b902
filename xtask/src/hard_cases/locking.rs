//! The same drape on different triangulations.

use super::case::number;
use super::scenes::{FRAME, STRAIN, at_rest, course};
use super::{Case, Effort, Findings};
use crate::figures::Picture;
use crate::render::{Camera, Labelled, Look, SheetPicture, montage, render};
use anyhow::Result;
use isosheet_dynamics::{Method, SheetModel};
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{CreasePattern, MassKind, Sheet, VertexId};

pub(crate) const DRAPE: Case = Case {
    name: "locking",
    title: "The same drape on three triangulations",
    expected: "A triangulated sheet folds along its edges only, so how it drapes depends on where they are: in the union jack straight lines run in four directions, \
               in the one-way grid in three, in an irregular mesh there are none. This is a property of the model (known as locking), not an \
               error of the solver: it is measured here, not bounded.",
    run: drape,
};

/// Largest kinetic energy of a sheet that hangs at rest, of its weight times 1 m.
const REST: f64 = 1e-4;

fn drape(effort: Effort) -> Result<Findings> {
    let mut f = Findings::default();
    let cells = effort.pick(4, 8, 16);
    let spacing = 1.0 / cells as f64;
    let meshes: [(&str, Sheet); 3] = [
        (
            "union jack",
            generate::grid(cells, cells, 1.0, 1.0, Diagonals::UnionJack)?,
        ),
        (
            "one-way",
            generate::grid(cells, cells, 1.0, 1.0, Diagonals::Falling)?,
        ),
        (
            "irregular",
            generate::delaunay_square(1.0, 1.08 * spacing, 5)?,
        ),
    ];
    let mut rows = Vec::new();
    let mut ends: Vec<(Vec<f64>, VertexId)> = Vec::new();
    let mut depths = [Vec::new(), Vec::new()];
    for (held_at, k) in [("a corner", 0), ("the middle", 1)] {
        for (name, sheet) in &meshes {
            let find = |target: [f64; 2]| {
                sheet
                    .topology()
                    .vertex_ids()
                    .min_by(|a, b| {
                        let d = |v: VertexId| {
                            let p = sheet.position(v);
                            (p[0] - target[0]).hypot(p[1] - target[1])
                        };
                        d(*a).total_cmp(&d(*b))
                    })
                    .unwrap_or(VertexId(0))
            };
            let pin = [find([0.0, 1.0]), find([0.5, 0.5])][k];
            let model = SheetModel::new(sheet, 0.1, MassKind::Lumped)?
                .with_gravity()
                .with_pins(&[pin])?
                .with_damping(1.0)?;
            let mut run = at_rest(model, sheet.positions(), Method::default())?;
            let mut kinetic = 0.0;
            let c = course(&mut run, FRAME, effort.pick(60, 900, 1800), |r, _| {
                kinetic = r.kinetic;
            })?;
            let x = run.state().x.clone();
            let (depth, shadow) = shape(sheet, &x, pin);
            let lines = CreasePattern::of(sheet, 1e-6);
            let directions = lines.folding_directions().len();
            rows.push(vec![
                (*name).to_owned(),
                held_at.to_owned(),
                format!(
                    "{}/{}",
                    sheet.topology().vertex_count(),
                    sheet.topology().face_count()
                ),
                directions.to_string(),
                format!("{depth:.3}"),
                format!("{shadow:.3}"),
                number(kinetic / 0.98),
            ]);
            f.at_most(
                format!("{name}, held at {held_at}: edge strain"),
                c.if_finished(c.strain),
                STRAIN,
            )
            .remark(c.said());
            if effort != Effort::Quick {
                f.at_most(
                    format!(
                        "{name}, held at {held_at}: kinetic energy at the end, of weight × 1 m"
                    ),
                    kinetic / 0.98,
                    REST,
                );
            }
            depths[k].push(depth);
            ends.push((x, pin));
        }
    }
    let spread = |d: &[f64]| {
        let (low, high) = d
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(l, h), d| (l.min(*d), h.max(*d)));
        (high - low, low)
    };
    let (difference, _) = spread(&depths[0]);
    let (difference2, _) = spread(&depths[1]);
    f.naive(
        "Taking one triangulation for the sheet",
        format!(
            "The centre of mass hangs up to {} m higher or lower on another mesh of the same size (held at a corner), {} m (held in the middle).",
            number(difference),
            number(difference2)
        ),
        difference > 1e-3,
    );
    f.table(
        "Sheets at rest, damping 1/s, BDF2 at 1/60 s from flat",
        &[
            "mesh",
            "held at",
            "V/F",
            "directions of straight lines",
            "depth of the centre, m",
            "area of the shadow, m²",
            "kinetic energy left, of weight × 1 m",
        ],
        rows,
    );
    f.here = "Lengths are exact and the sheets at rest; what differs is the shape. A smooth sheet would bend about any line. Its triangulation bends \
              about lines of edges; where they do not run through, bending needs crumpling of the triangles on the way, or does not take place."
        .into();
    if effort != Effort::Quick {
        f.pictures.push(picture(&meshes, &ends)?);
    }
    Ok(f)
}

/// Depth of the centre of area below the first pin, and the area of the shadow straight below (overlaps counted once for each layer).
fn shape(sheet: &Sheet, x: &[f64], pin: VertexId) -> (f64, f64) {
    let (mut depth, mut shadow) = (0.0, 0.0);
    let top = x[3 * pin.index() + 2];
    for (face, area) in sheet.topology().faces().iter().zip(sheet.face_areas()) {
        let [a, b, c] = face.map(|v| &x[3 * v.index()..3 * v.index() + 3]);
        depth += area * (top - (a[2] + b[2] + c[2]) / 3.0);
        shadow += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
    }
    (depth / sheet.area(), shadow)
}

fn picture(meshes: &[(&str, Sheet)], ends: &[(Vec<f64>, VertexId)]) -> Result<Picture> {
    let points = ends
        .iter()
        .flat_map(|(x, _)| x.as_chunks::<3>().0.iter().copied());
    let view = Camera::new([0.0; 3], -62.0, 12.0, 1.0, 6.0);
    let aspect = view.aspect(points.clone());
    let camera = view.framing(points, aspect, 0.04);
    let look = Look {
        size: [(420.0 * aspect).round() as usize, 420],
        ..Look::default()
    };
    let frames: Vec<Labelled> = ends
        .iter()
        .enumerate()
        .map(|(k, (x, pin))| Labelled {
            image: render(
                &SheetPicture {
                    topology: meshes[k % meshes.len()].1.topology(),
                    positions: x,
                    pins: &[*pin],
                    solids: &[],
                },
                &camera,
                &look,
            ),
            label: String::new(),
        })
        .collect();
    Ok(Picture {
        file: "locking.png".into(),
        alt: "At rest, held at a corner (above) and in the middle (below): union jack, one-way grid, irregular mesh.".into(),
        bytes: montage(&frames, 3).to_png()?,
    })
}
