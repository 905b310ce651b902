//! A cloth that is let go just above a table and drapes over it.

use super::Staged;
use super::scene::SelfContact;
use anyhow::Result;
use isosheet_collide::{
    Coefficients, ContactOptions, Contacts, Obstacle, Shape, Stiffness, TriangleSurface,
};
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::generate::{delaunay, isotropic_rectangle, octagon_244};
use isosheet_mesh::{MassKind, Sheet};
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Everything that decides how a run goes: the cloth starts exactly flat, horizontal and at rest, with its
/// middle above that of the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Drape {
    /// Name of the folder of the run.
    pub(crate) name: String,
    pub(crate) cloth: Cloth,
    /// Outline of the table top.
    pub(crate) table: Outline,
    /// Height from which the cloth is let go, metres.
    pub(crate) drop: f64,
    /// Gap below which contact acts, metres.
    pub(crate) activation: f64,
    /// Stiffness of the contact barrier, joules.
    pub(crate) stiffness: f64,
    /// Coefficient of friction between cloth and table.
    pub(crate) friction: f64,
    pub(crate) contact: SelfContact,
    /// Mass of a square metre, kilograms.
    pub(crate) weight: f64,
    /// Rate of the velocity damping, 1/s.
    pub(crate) damping: f64,
    /// Time between frames, seconds.
    pub(crate) frame: f64,
    /// Number of frames after the first.
    pub(crate) frames: usize,
}

/// A convex outline about the origin, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Outline {
    /// Half the sides along x and y.
    Rectangle { half: [f64; 2] },
    /// A regular polygon with two sides upright (for an even number).
    Regular { sides: u32, radius: f64 },
}

impl Outline {
    /// The corners, counter-clockwise.
    pub(crate) fn corners(&self) -> Vec<[f64; 2]> {
        match *self {
            Self::Rectangle { half: [a, b] } => vec![[a, b], [-a, b], [-a, -b], [a, -b]],
            Self::Regular { sides, radius } => (0..sides)
                .map(|k| {
                    let (sin, cos) = (TAU * (f64::from(k) + 0.5) / f64::from(sides)).sin_cos();
                    [radius * cos, radius * sin]
                })
                .collect(),
        }
    }

    /// How far a point is outside, negative inside: the largest distance from the lines of the sides.
    pub(crate) fn outside(&self, p: [f64; 2]) -> f64 {
        let corners = self.corners();
        let n = corners.len();
        (0..n)
            .map(|k| {
                let (a, b) = (corners[k], corners[(k + 1) % n]);
                let side = [b[0] - a[0], b[1] - a[1]];
                (side[1] * (p[0] - a[0]) - side[0] * (p[1] - a[1])) / side[0].hypot(side[1])
            })
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The cloth and its mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Cloth {
    /// A rectangle with the union-jack mesh M^level.
    UnionJack { half: [f64; 2], level: u32 },
    /// An irregular triangulation.
    Irregular {
        outline: Outline,
        spacing: f64,
        seed: u64,
    },
    /// The octagon with the paper's counts 244/440.
    Octagon { radius: f64 },
    /// A regular polygon in concentric rings of triangles: the lines from the middle to the corners are
    /// edges.
    Rings { sides: u32, radius: f64, rings: u32 },
}

impl Cloth {
    /// Its outline.
    pub(crate) fn outline(&self) -> Outline {
        match *self {
            Self::UnionJack { half, .. } => Outline::Rectangle { half },
            Self::Irregular { outline, .. } => outline,
            Self::Octagon { radius } => Outline::Regular { sides: 8, radius },
            Self::Rings { sides, radius, .. } => Outline::Regular { sides, radius },
        }
    }
}

/// Height of the table's body, metres: the cloth does not reach below it.
const TABLE: f64 = 0.72;

impl Drape {
    /// The same scene with a sheet that may pass through itself.
    pub(crate) fn without_self_contact(&self) -> Self {
        Self {
            name: format!("{}-free", self.name),
            contact: SelfContact::None,
            ..self.clone()
        }
    }

    fn table_shape(&self) -> Result<Shape> {
        Ok(match self.table {
            Outline::Rectangle { half: [a, b] } => Shape::Cuboid {
                half: [a, b, 0.5 * TABLE],
            },
            Outline::Regular { .. } => {
                let (positions, faces) = prism(&self.table.corners(), 0.5 * TABLE);
                Shape::Surface(Arc::new(TriangleSurface::new(&positions, &faces)?))
            }
        })
    }
}

impl Staged for Drape {
    fn name(&self) -> &str {
        &self.name
    }

    fn frame(&self) -> f64 {
        self.frame
    }

    fn frames(&self) -> usize {
        self.frames
    }

    fn sheet(&self) -> Result<Sheet> {
        Ok(match self.cloth {
            Cloth::UnionJack {
                half: [a, b],
                level,
            } => isotropic_rectangle(1, 1, level, 2.0 * a, 2.0 * b)?
                .map_positions(|[x, y, z]| [x - a, y - b, z])?,
            Cloth::Irregular {
                outline,
                spacing,
                seed,
            } => delaunay(&outline.corners(), spacing, seed)?,
            Cloth::Octagon { radius } => octagon_244(radius)?,
            Cloth::Rings { rings: count, .. } => rings(&self.cloth.outline().corners(), count)?,
        })
    }

    fn bodies(&self) -> Result<Vec<Obstacle>> {
        let pose = Isometry3::translation(0.0, 0.0, -0.5 * TABLE - self.drop);
        Ok(vec![Obstacle::fixed(self.table_shape()?, pose)?])
    }

    fn simulation(&self, sheet: &Sheet) -> Result<Simulation> {
        let model = SheetModel::new(sheet, self.weight * sheet.area(), MassKind::Lumped)?
            .with_gravity()
            .with_damping(self.damping)?;
        let options = ContactOptions {
            activation: self.activation,
            stiffness: Stiffness::Joules(self.stiffness),
            ..ContactOptions::for_sheet(&model)
        };
        let mut contacts = Contacts::new(&model, options)?;
        for body in self.bodies()? {
            contacts = contacts.with_body(body, Coefficients::equal(self.friction))?;
        }
        contacts = self.contact.add_to(contacts)?;
        let state = State::at_rest(sheet.positions().to_vec());
        Ok(Simulation::new(model, state, Method::default())?.with_contact(contacts)?)
    }
}

/// A polygon about the origin in concentric rings; every side of ring r has r edges.
fn rings(corners: &[[f64; 2]], count: u32) -> Result<Sheet> {
    let n = u32::try_from(corners.len())?;
    let mut positions = vec![0.0; 3];
    let mut faces = Vec::new();
    // Point j of side k of ring r; the last of a side is the first of the next one.
    let vertex = |r: u32, k: u32, j: u32| match r {
        0 => 0,
        _ => 1 + n * (r * (r - 1) / 2) + (k * r + j) % (n * r),
    };
    for r in 1..=count {
        for k in 0..n {
            let [a, b] = [k, (k + 1) % n].map(|c| corners[c as usize]);
            for j in 0..r {
                let (size, s) = (f64::from(r) / f64::from(count), f64::from(j) / f64::from(r));
                let point = [0, 1].map(|axis| size * (a[axis] + s * (b[axis] - a[axis])));
                positions.extend([point[0], point[1], 0.0]);
                faces.push([vertex(r - 1, k, j), vertex(r, k, j), vertex(r, k, j + 1)]);
                if j > 0 {
                    faces.push([
                        vertex(r - 1, k, j - 1),
                        vertex(r, k, j),
                        vertex(r - 1, k, j),
                    ]);
                }
            }
        }
    }
    Ok(Sheet::new(positions, &faces)?)
}

/// Positions and faces of an upright prism over a convex outline, `half_height` up and down.
fn prism(outline: &[[f64; 2]], half_height: f64) -> (Vec<f64>, Vec<[u32; 3]>) {
    let n = u32::try_from(outline.len()).expect("an outline has few corners");
    let mut positions = Vec::new();
    for z in [half_height, -half_height] {
        positions.extend(outline.iter().flat_map(|p| [p[0], p[1], z]));
    }
    let mut faces = Vec::new();
    for k in 1..n - 1 {
        faces.extend([[0, k, k + 1], [n, n + k + 1, n + k]]);
    }
    for k in 0..n {
        let next = (k + 1) % n;
        faces.extend([[k, n + k, n + next], [k, n + next, next]]);
    }
    (positions, faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outside_is_the_distance_from_the_sides() {
        let square = Outline::Rectangle { half: [2.0, 1.0] };
        assert_eq!(square.outside([0.0, 0.0]), -1.0);
        assert_eq!(square.outside([2.5, 0.0]), 0.5);
        let octagon = Outline::Regular {
            sides: 8,
            radius: 1.0,
        };
        let apothem = (TAU / 16.0).cos();
        assert!((octagon.outside([0.0, 0.0]) + apothem).abs() < 1e-14);
        assert!((octagon.outside([2.0, 0.0]) - (2.0 - apothem)).abs() < 1e-14);
        assert!(
            octagon
                .corners()
                .iter()
                .all(|c| octagon.outside(*c).abs() < 1e-14)
        );
    }

    #[test]
    fn rings_fill_the_polygon_and_have_its_corner_lines() {
        let outline = Outline::Regular {
            sides: 8,
            radius: 2.0,
        };
        let sheet = rings(&outline.corners(), 5).unwrap();
        let t = sheet.topology();
        assert_eq!((t.vertex_count(), t.face_count()), (1 + 8 * 15, 8 * 25));
        assert!((sheet.area() - 8.0 * 2.0 * (TAU / 8.0).sin()).abs() < 1e-12);
        let hem = t.vertex_ids().filter(|v| t.is_boundary_vertex(*v)).count();
        assert_eq!(hem, 40);
        // Five edges from the middle to each corner.
        let along = |p: [f64; 3]| {
            outline
                .corners()
                .iter()
                .any(|c| (p[0] * c[1] - p[1] * c[0]).abs() < 1e-12)
        };
        let lines = t
            .edges()
            .iter()
            .filter(|e| e.iter().all(|v| along(sheet.position(*v))));
        let radial = lines.filter(|e| {
            let [p, q] = e.map(|v| sheet.position(v));
            (p[0] * q[1] - p[1] * q[0]).abs() < 1e-12
        });
        assert_eq!(radial.count(), 40);
    }

    #[test]
    fn a_prism_has_its_volume_and_points_outwards() {
        let outline = Outline::Regular {
            sides: 6,
            radius: 1.0,
        };
        let (x, faces) = prism(&outline.corners(), 0.5);
        let at =
            |v: u32| nalgebra::Vector3::from_column_slice(&x[3 * v as usize..3 * v as usize + 3]);
        let volume: f64 = faces
            .iter()
            .map(|f| at(f[0]).cross(&at(f[1])).dot(&at(f[2])) / 6.0)
            .sum();
        assert!((volume - 1.5 * 3f64.sqrt()).abs() < 1e-12);
    }
}
