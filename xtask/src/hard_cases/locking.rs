//! The same drape on different triangulations.

use super::scenes::{FRAME, VIEWPOINT, at_rest, go};
use super::{Case, Findings, Work};
use crate::draw::Shot;
use crate::locking::meshes::nearest;
use crate::report::{Bound, Effort, Picture, Table, extremes, number};
use crate::runs::Course;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::{Method, SheetModel};
use isosheet_io::picture::Solid;
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{CreasePattern, MassKind, Sheet, VertexId};
use nalgebra::Isometry3;

pub(crate) const DRAPE: Case = Case {
    name: "locking",
    title: "The same drape on three triangulations",
    expected: "A triangulated sheet folds along its edges only, so how it drapes depends on where they are: in the union jack straight lines run in four directions, \
               in the one-way grid in three, in an irregular mesh there are none. This is a property of the model (known as locking), not an \
               error of the solver: it is measured here, not bounded.",
    run: Work::Code(drape),
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
struct End<'a> {
    mesh: &'a (&'static str, Sheet),
    how: &'static str,
    x: Vec<f64>,
    pins: Vec<VertexId>,
    body: Option<Obstacle>,
    course: Course,
}

impl<'a> End<'a> {
    /// Where a sheet comes to rest on a support after a number of steps.
    fn of(
        mesh: &'a (&'static str, Sheet),
        (how, support): (&'static str, Support),
        steps: usize,
    ) -> Result<Self> {
        let sheet = &mesh.1;
        let mut model = SheetModel::new(sheet, 0.1, MassKind::Lumped)?
            .with_gravity()
            .with_damping(1.0)?;
        let mut pins = Vec::new();
        if let Support::Pin(target) = support {
            pins.push(nearest(sheet, target));
            model = model.with_pins(&pins)?;
        }
        let options = ContactOptions::for_sheet(&model);
        let mut contacts = Contacts::new(&model, options)?;
        let mut run = at_rest(model, sheet.positions(), Method::default())?;
        let mut body = None;
        if support == Support::Table {
            let table = table(options.activation)?;
            contacts = contacts.with_body(table.clone(), Coefficients::equal(FRICTION))?;
            run = run.with_contact(contacts)?;
            body = Some(table);
        }
        let (course, x) = go(run, FRAME, steps)?;
        Ok(Self {
            mesh,
            how,
            x,
            pins,
            body,
            course,
        })
    }

    /// Kinetic energy left, of weight times 1 m.
    fn kinetic(&self) -> f64 {
        self.course.kinetic / 0.98
    }

    /// Depth of the centre and area of the shadow, see [`shape`].
    fn shape(&self) -> (f64, f64) {
        let top = self.pins.first().map_or(0.0, |p| self.x[3 * p.index() + 2]);
        shape(&self.mesh.1, &self.x, top)
    }
}

fn drape(f: &mut Findings, effort: Effort) -> Result<()> {
    let n = effort.pick(4, 8, 16);
    let meshes: [(&str, Sheet); 3] = [
        (
            "union jack",
            generate::grid(n, n, 1.0, 1.0, Diagonals::UnionJack)?,
        ),
        (
            "one-way",
            generate::grid(n, n, 1.0, 1.0, Diagonals::Falling)?,
        ),
        (
            "irregular",
            generate::delaunay_square(1.0, 1.08 / n as f64, 5)?,
        ),
    ];
    let (mut all, mut differences) = (Vec::new(), Vec::new());
    for support in SUPPORTS {
        let end = |mesh| End::of(mesh, support, effort.pick(60, 900, 1800));
        let ends: Vec<End<'_>> = meshes.iter().map(end).collect::<Result<_>>()?;
        for end in &ends {
            let mut judge = f.of(&end.course, format!("{}, {}", end.mesh.0, end.how));
            judge.strain("edge strain");
            if support.1 == Support::Table {
                judge.at_least(
                    "smallest gap, m",
                    end.course.gap.unwrap_or(f64::INFINITY),
                    f64::MIN_POSITIVE,
                );
            }
            if effort != Effort::Quick {
                let quantity = "kinetic energy at the end, of weight × 1 m";
                judge.at_most(quantity, end.kinetic(), REST);
            }
        }
        if effort != Effort::Quick {
            f.pictures.push(picture(&ends)?);
        }
        let depths = ends.iter().map(|end| end.shape().0);
        let difference = extremes(depths).map_or(0.0, |[low, high]| high - low);
        differences.push((difference, support.0));
        all.extend(ends);
    }
    for (difference, how) in differences {
        let what = format!("{how}: difference of the depths of the centre of mass, m");
        let method = "Taking one triangulation for the sheet";
        f.naive(method, what, difference, Bound::AtMost(1e-3));
    }
    f.tables.push(table_of(&all));
    f.here = "Lengths are exact and the sheets at rest; what differs is the shape. A smooth sheet would bend about any line. Its triangulation bends \
              about lines of edges; where they do not run through, bending needs crumpling of the triangles on the way, or does not take place. The \
              round table prefers no direction: the folds of the overhang are where the lines of the mesh let them be.";
    Ok(())
}

fn table_of(all: &[End<'_>]) -> Table {
    let directions = |end: &End<'_>| {
        let lines = CreasePattern::of(&end.mesh.1, 1e-6);
        lines.folding_directions().len()
    };
    Table::of(
        "Sheets at rest, damping 1/s, BDF2 at 1/60 s from flat; on the table with contact and friction",
        all,
        &[
            ("mesh", &|end| end.mesh.0.into()),
            ("support", &|end| end.how.into()),
            ("V/F", &|end| {
                let t = end.mesh.1.topology();
                format!("{}/{}", t.vertex_count(), t.face_count()).into()
            }),
            ("directions of straight lines", &|end| {
                directions(end).to_string().into()
            }),
            ("depth of the centre, m", &|end| {
                format!("{:.3}", end.shape().0).into()
            }),
            ("area of the shadow, m²", &|end| {
                format!("{:.3}", end.shape().1).into()
            }),
            ("kinetic energy left, of weight × 1 m", &|end| {
                number(end.kinetic()).into()
            }),
        ],
    )
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
fn picture(ends: &[End<'_>]) -> Result<Picture> {
    let mut shots = Vec::new();
    for end in ends {
        let solids = end.body.iter().map(|b| Solid::of(b, 0.0));
        shots.push(Shot {
            sheet: &end.mesh.1,
            x: &end.x,
            pins: &end.pins,
            solids: solids.collect::<Result<_, _>>()?,
            label: String::new(),
        });
    }
    let how = ends[0].how;
    let file = format!("locking-{}.png", how.replace(' ', "-"));
    let alt = format!("At rest, {how}: union jack, one-way grid, irregular mesh.");
    Picture::shaded(&file, &VIEWPOINT.montage(shots, 3, 300)?, &alt)
}
