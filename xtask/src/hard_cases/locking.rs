//! The same drape on different triangulations.

use super::scenes::{FRAME, STRAIN, at_rest, course};
use super::{Case, Findings};
use crate::locking::meshes::nearest;
use crate::report::Effort;
use crate::report::Picture;
use crate::report::number;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::{Method, SheetModel};
use isosheet_io::picture::{Camera, Labelled, Look, SheetPicture, Solid, montage, render};
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{CreasePattern, MassKind, Sheet, VertexId};
use nalgebra::Isometry3;

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

/// The support of a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Support {
    /// The vertex next to a point of the sheet is pinned.
    Pin([f64; 2]),
    /// A round table, with contact and friction.
    Table,
}

/// The supports in the order of the report.
const SUPPORTS: [(&str, Support); 3] = [
    ("held at a corner", Support::Pin([0.0, 1.0])),
    ("held in the middle", Support::Pin([0.5, 0.5])),
    ("on a round table", Support::Table),
];

/// Radius and height of the table, metres: round, so that it prefers no direction of the mesh.
const TABLE: [f64; 2] = [0.25, 0.1];

/// Friction that keeps an uneven cloth from sliding off.
const FRICTION: f64 = 0.5;

/// The table below a sheet in the plane z = 0, its top half an activation distance lower.
fn table(activation: f64) -> Result<Obstacle> {
    let shape = Shape::Cylinder {
        radius: TABLE[0],
        half_height: 0.5 * TABLE[1],
    };
    let pose = Isometry3::translation(0.5, 0.5, -0.5 * (TABLE[1] + activation));
    Ok(Obstacle::fixed(shape, pose)?)
}

/// A sheet at rest.
struct End {
    x: Vec<f64>,
    pins: Vec<VertexId>,
    body: Option<Obstacle>,
}

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
    let mut depths = Vec::new();
    for (how, support) in SUPPORTS {
        let mut of_meshes = [f64::INFINITY, 0.0];
        let mut ends = Vec::new();
        for (name, sheet) in &meshes {
            let mut model = SheetModel::new(sheet, 0.1, MassKind::Lumped)?
                .with_gravity()
                .with_damping(1.0)?;
            let mut pins = Vec::new();
            if let Support::Pin(target) = support {
                pins.push(nearest(sheet, target));
                model = model.with_pins(&pins)?;
            }
            let contact = match support {
                Support::Pin(_) => None,
                Support::Table => {
                    let options = ContactOptions::for_sheet(&model);
                    let body = table(options.activation)?;
                    let contacts = Contacts::new(&model, options)?
                        .with_body(body.clone(), Coefficients::equal(FRICTION))?;
                    Some((body, contacts))
                }
            };
            let mut run = at_rest(model, sheet.positions(), Method::default())?;
            let mut body = None;
            if let Some((table, contacts)) = contact {
                run = run.with_contact(contacts)?;
                body = Some(table);
            }
            let (mut kinetic, mut gap) = (0.0, f64::INFINITY);
            let c = course(&mut run, FRAME, effort.pick(60, 900, 1800), |r, _| {
                kinetic = r.kinetic;
                gap = gap.min(r.gap.unwrap_or(f64::INFINITY));
            })?;
            let x = run.state().x.clone();
            let top = pins.first().map_or(0.0, |p| x[3 * p.index() + 2]);
            let (depth, shadow) = shape(sheet, &x, top);
            let lines = CreasePattern::of(sheet, 1e-6);
            let directions = lines.folding_directions().len();
            rows.push(vec![
                (*name).to_owned(),
                how.to_owned(),
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
                format!("{name}, {how}: edge strain"),
                c.if_finished(c.strain),
                STRAIN,
            )
            .remark(c.said());
            if support == Support::Table {
                f.at_least(
                    format!("{name}, {how}: smallest gap, m"),
                    c.if_finished(gap),
                    f64::MIN_POSITIVE,
                );
            }
            if effort != Effort::Quick {
                f.at_most(
                    format!("{name}, {how}: kinetic energy at the end, of weight × 1 m"),
                    kinetic / 0.98,
                    REST,
                );
            }
            of_meshes = [of_meshes[0].min(depth), of_meshes[1].max(depth)];
            ends.push(End { x, pins, body });
        }
        depths.push(of_meshes);
        if effort != Effort::Quick {
            f.pictures.push(picture(how, &meshes, &ends)?);
        }
    }
    let differences: Vec<f64> = depths.iter().map(|[low, high]| high - low).collect();
    let listed: Vec<String> = SUPPORTS
        .iter()
        .zip(&differences)
        .map(|((how, _), d)| format!("{} m {how}", number(*d)))
        .collect();
    f.naive(
        "Taking one triangulation for the sheet",
        format!(
            "The centre of mass hangs higher or lower on another mesh of the same size, by up to {}.",
            listed.join(", ")
        ),
        differences.iter().any(|d| *d > 1e-3),
    );
    f.table(
        "Sheets at rest, damping 1/s, BDF2 at 1/60 s from flat; on the table with contact and friction",
        &[
            "mesh",
            "support",
            "V/F",
            "directions of straight lines",
            "depth of the centre, m",
            "area of the shadow, m²",
            "kinetic energy left, of weight × 1 m",
        ],
        rows,
    );
    f.here = "Lengths are exact and the sheets at rest; what differs is the shape. A smooth sheet would bend about any line. Its triangulation bends \
              about lines of edges; where they do not run through, bending needs crumpling of the triangles on the way, or does not take place. The \
              round table prefers no direction: the folds of the overhang are where the lines of the mesh let them be."
        .into();
    Ok(f)
}

/// Depth of the centre of area below a height, and the area of the vertical projection, in which overlaps
/// count once for each layer.
fn shape(sheet: &Sheet, x: &[f64], top: f64) -> (f64, f64) {
    let (mut depth, mut shadow) = (0.0, 0.0);
    for (face, area) in sheet.topology().faces().iter().zip(sheet.face_areas()) {
        let [a, b, c] = face.map(|v| &x[3 * v.index()..3 * v.index() + 3]);
        depth += area * (top - (a[2] + b[2] + c[2]) / 3.0);
        shadow += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
    }
    (depth / sheet.area(), shadow)
}

/// The three ends on one support.
fn picture(how: &str, meshes: &[(&str, Sheet)], ends: &[End]) -> Result<Picture> {
    let points = ends
        .iter()
        .flat_map(|end| end.x.as_chunks::<3>().0.iter().copied());
    let view = Camera::new([0.0; 3], -62.0, 18.0, 1.0, 6.0);
    let aspect = view.aspect(points.clone());
    let camera = view.framing(points, aspect, 0.04);
    let look = Look {
        size: [360, (360.0 / aspect).round() as usize],
        ..Look::default()
    };
    let mut frames = Vec::new();
    for ((_, sheet), end) in meshes.iter().zip(ends) {
        let solids = end.body.iter().map(|b| Solid::of(b, 0.0));
        let solids = solids.collect::<Result<Vec<_>, _>>()?;
        let picture = SheetPicture {
            topology: sheet.topology(),
            positions: &end.x,
            pins: &end.pins,
            solids: &solids,
        };
        frames.push(Labelled {
            image: render(&picture, &camera, &look)?,
            label: String::new(),
        });
    }
    Ok(Picture {
        file: format!("locking-{}.png", how.replace(' ', "-")),
        alt: format!("At rest, {how}: union jack, one-way grid, irregular mesh."),
        bytes: montage(&frames, 3)?.to_png()?,
    })
}
