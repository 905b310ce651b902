//! A sheet of metal on a frame, punched upwards by a square die.

use super::Staged;
use super::scene::SelfContact;
use anyhow::Result;
use isosheet_collide::{
    Coefficients, ContactOptions, Contacts, Keyframe, Obstacle, Shape, Stiffness, TriangleSurface,
};
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::generate::isotropic_square;
use isosheet_mesh::{MassKind, Sheet};
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Everything that decides how a run goes: the blank starts flat and at rest on the frame, its middle at the
/// origin, the die just below it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Stamping {
    /// Name of the folder of the run.
    pub(crate) name: String,
    /// Level k of the mesh M^k.
    pub(crate) level: u32,
    /// Side of the blank, metres.
    pub(crate) side: f64,
    /// Mass of a square metre, kilograms.
    pub(crate) weight: f64,
    /// Half the side of the die, metres.
    pub(crate) die: f64,
    /// Half the side of the opening of the frame, metres.
    pub(crate) opening: f64,
    /// Half the width of the four holders above the middles of the frame's sides, metres.
    pub(crate) holder: f64,
    /// Clearance between frame and holders, metres.
    pub(crate) clearance: f64,
    /// Speed of the die, metres per second.
    pub(crate) speed: f64,
    /// Displacement of the die, metres.
    pub(crate) stroke: f64,
    /// Gap below which contact acts, metres.
    pub(crate) activation: f64,
    /// Stiffness of the contact barrier, joules.
    pub(crate) stiffness: f64,
    /// Coefficient of friction with the tools.
    pub(crate) friction: f64,
    pub(crate) contact: SelfContact,
    /// Rate of the velocity damping, 1/s.
    pub(crate) damping: f64,
    /// Time between frames, seconds.
    pub(crate) frame: f64,
    /// Number of frames after the first.
    pub(crate) frames: usize,
}

/// The number of the die among the bodies; the frame follows, then the four holders.
pub(crate) const DIE: usize = 0;

/// Thickness of frame and holders, and height of the die, metres.
const PLATE: f64 = 0.02;
const BLOCK: f64 = 0.2;

/// How far frame and holders reach out beyond the blank, as part of half its side.
const MARGIN: f64 = 0.2;

impl Stamping {
    /// The same scene with a sheet that may pass through itself.
    pub(crate) fn without_self_contact(&self) -> Self {
        Self {
            name: format!("{}-free", self.name),
            contact: SelfContact::None,
            ..self.clone()
        }
    }

    /// Half the side of what frame and holders reach to.
    fn outer(&self) -> f64 {
        0.5 * (1.0 + MARGIN) * self.side
    }

    /// The four holders, from the edge of the opening outwards, at height `z` of their middle.
    fn holders(&self, z: f64) -> Result<Vec<Obstacle>> {
        let width = 0.5 * (self.outer() - self.opening);
        let middle = self.opening + width;
        let bar = |x: f64, y: f64, hx: f64, hy: f64| {
            let half = [hx, hy, 0.5 * PLATE];
            Obstacle::fixed(Shape::Cuboid { half }, Isometry3::translation(x, y, z))
        };
        Ok(vec![
            bar(middle, 0.0, width, self.holder)?,
            bar(-middle, 0.0, width, self.holder)?,
            bar(0.0, middle, self.holder, width)?,
            bar(0.0, -middle, self.holder, width)?,
        ])
    }
}

/// Surface of a square plate with a square hole in it about the z axis: half the sides of plate and hole,
/// heights of its lower and upper face.
fn frame([outer, inner]: [f64; 2], heights: [f64; 2]) -> Result<TriangleSurface> {
    // Vertex 8 level + 4 ring + corner: below and above, outside and inside, counter-clockwise.
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let rings =
        heights.map(|z| [outer, inner].map(|half| corners.map(|[x, y]| [half * x, half * y, z])));
    let positions = rings.as_flattened().as_flattened().as_flattened();
    let faces: Vec<[u32; 3]> = (0..4)
        .flat_map(|k| {
            let next = (k + 1) % 4;
            let vertex = |level: u32, ring: u32, corner: u32| 8 * level + 4 * ring + corner;
            let quads = [
                [
                    vertex(1, 0, k),
                    vertex(1, 0, next),
                    vertex(1, 1, next),
                    vertex(1, 1, k),
                ],
                [
                    vertex(0, 1, k),
                    vertex(0, 1, next),
                    vertex(0, 0, next),
                    vertex(0, 0, k),
                ],
                [
                    vertex(0, 0, k),
                    vertex(0, 0, next),
                    vertex(1, 0, next),
                    vertex(1, 0, k),
                ],
                [
                    vertex(1, 1, k),
                    vertex(1, 1, next),
                    vertex(0, 1, next),
                    vertex(0, 1, k),
                ],
            ];
            quads
                .into_iter()
                .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        })
        .collect();
    Ok(TriangleSurface::new(positions, &faces)?)
}

impl Staged for Stamping {
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
        let half = 0.5 * self.side;
        Ok(isotropic_square(self.level, self.side)?
            .map_positions(|[x, y, z]| [x - half, y - half, z])?)
    }

    fn bodies(&self) -> Result<Vec<Obstacle>> {
        let pose = |z: f64| Isometry3::translation(0.0, 0.0, z - 0.5 * BLOCK);
        let low = -self.activation;
        let keys = vec![
            Keyframe {
                t: 0.0,
                pose: pose(low),
            },
            Keyframe {
                t: self.stroke / self.speed,
                pose: pose(low + self.stroke),
            },
        ];
        let half = [self.die, self.die, 0.5 * BLOCK];
        let mut bodies = vec![Obstacle::new(Shape::Cuboid { half }, keys)?];
        let surface = frame([self.outer(), self.opening], [low - PLATE, low])?;
        let shape = Shape::Surface(Arc::new(surface));
        bodies.push(Obstacle::fixed(shape, Isometry3::identity())?);
        bodies.extend(self.holders(low + self.clearance + 0.5 * PLATE)?);
        Ok(bodies)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_is_closed_and_has_its_volume() {
        let surface = frame([0.3, 0.14], [-0.5, -0.2]).unwrap();
        assert!(surface.is_closed());
        let geometry = Shape::Surface(Arc::new(surface))
            .contact_geometry(1)
            .unwrap()
            .unwrap();
        let at = |v: u32| {
            let i = 3 * v as usize;
            nalgebra::Vector3::from_column_slice(&geometry.positions[i..i + 3])
        };
        let faces = geometry.mesh.faces().iter();
        let volume: f64 = faces
            .map(|f| at(f[0]).dot(&at(f[1]).cross(&at(f[2]))) / 6.0)
            .sum();
        assert!(
            (volume - 0.3 * (0.6f64.powi(2) - 0.28f64.powi(2))).abs() < 1e-15,
            "{volume}"
        );
    }
}
