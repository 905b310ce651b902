//! Contact, and obstacles.

use super::builder::{Builder, Kept, at};
use crate::bodies::obstacle_names;
use crate::bodies::obstacles::ShapeKey;
use crate::holding::switch::Holder;
use crate::placing::driven_surface::DrivenSurface;
use crate::placing::placed::PlacedSheet;
use crate::placing::placed_bodies::Surface;
use crate::words::error::SceneError;
use crate::words::key::Key;
use crate::words::problem::Problem;
use isosheet_collide::{ContactOptions, Contacts, ContactsError, Obstacle};
use isosheet_mesh::wording::place;
use isosheet_mesh::{Sheet, VertexId};
use std::collections::HashMap;
use std::ops::Range;

/// One of the two that meet in a pair.
enum Meeting {
    /// The points of sheets, bodies and obstacles in motion, between which contact acts.
    Points(Range<usize>),
    /// The obstacle of this number among the rigid ones.
    Body(u32),
}

impl Builder<'_> {
    pub(super) fn cuts(&self) -> Vec<[VertexId; 2]> {
        let mut pairs = Vec::new();
        for PlacedSheet { form, part, .. } in &self.sheets.list {
            let placed = &form.placed;
            let start = self.x[part.coordinates()].as_chunks::<3>().0;
            let rest = placed.positions().as_chunks::<3>().0;
            let mut first_there = HashMap::new();
            let t = placed.topology();
            for v in t.vertex_ids().filter(|v| t.is_boundary_vertex(*v)) {
                // (A zero may have either sign.)
                let bits = |p: [f64; 3]| p.map(|c| (c + 0.0).to_bits());
                let place = [rest, start].map(|x| bits(x[v.index()]));
                if let Some(first) = first_there.get(&place) {
                    pairs.push([part.vertex(*first), part.vertex(v)]);
                } else {
                    first_there.insert(place, v);
                }
            }
        }
        pairs
    }

    pub(super) fn contacts(&mut self) -> Result<(Option<Contacts>, Vec<Obstacle>), SceneError> {
        let (scene, key) = (self.scene, Key::root());
        if !scene.has_contact() {
            return Ok((None, Vec::new()));
        }
        let automatic = match &self.surface {
            None => ContactOptions::for_sheet(self.model()),
            Some(surface) => {
                let round = self
                    .bodies
                    .list
                    .iter()
                    .filter(|body| body.round().is_some());
                let replaced: Vec<_> = round.map(|body| body.part.vertices.clone()).collect();
                ContactOptions::for_surface_without(&surface.sheet, &surface.points, &replaced)
            }
        };
        let thickest = scene.largest_thickness();
        let options = scene.contact.options(automatic, thickest);
        let contacts = match &self.surface {
            None => Contacts::new(self.model(), options),
            Some(Surface { sheet, points }) => Contacts::on_surface(sheet, points.clone(), options),
        };
        let mut contacts = contacts
            .map_err(at(&key.name("contact")))?
            .with_glue(&[&self.glued[..], &self.cuts()].concat());
        for PlacedSheet { of, part, key, .. } in &self.sheets.list {
            if of.thickness != thickest {
                contacts = contacts
                    .with_thickness_of(part.vertices.clone(), of.thickness)
                    .map_err(at(&key.name("thickness")))?;
            }
        }
        let sheets = 0..self.sheets.union.topology().vertex_count();
        if let Some(surface) = &self.surface {
            let mut parts: Vec<_> = self.origins.bodies.clone();
            if !scene.contact.self_contact {
                // Sheets meet bodies, and not one another.
                parts.push(sheets.clone());
            }
            if let Some(first) = self.driven.first_point() {
                // Obstacles pass through one another.
                parts.push(first..surface.points.count());
                contacts = contacts.with_driven_from(VertexId::from_index(first));
            }
            contacts = contacts.with_parts(&parts, self.glued_to_bodies.iter().copied());
            for (number, body) in self.bodies.list.iter().enumerate() {
                if let Some(round) = body.round() {
                    let carried = |p| body.body.carried(p, body.first);
                    contacts = contacts
                        .with_round_body(number, body.part.vertices.clone(), round, carried)
                        .map_err(at(&body.key))?;
                }
            }
        }
        let mut obstacles = Vec::new();
        for (k, obstacle) in scene.obstacle.iter().enumerate() {
            let key = key.name("obstacle").entry(k);
            if matches!(obstacle.shape, ShapeKey::Sequence(_)) {
                continue;
            }
            let Kept { files, shapes, .. } = &mut *self.kept;
            let shape = shapes.get(k, obstacle.shape.clone(), |shape| {
                shape.build(&key.name("shape"), files)
            });
            let (moved, pose) = (key.name("motion"), obstacle.pose.isometry());
            let motion = self.led.of_body(&moved, &obstacle.motion, pose);
            let body =
                Obstacle::new(shape?, motion).map_err(|e| Problem::from_error(key.clone(), &e))?;
            obstacles.push(body.clone());
            let coefficients = obstacle.friction.coefficients();
            contacts = contacts.with_body(body, coefficients).map_err(at(&key))?;
        }
        self.count(scene.obstacle.len(), "obstacle", "obstacles");
        self.bodies.check_empty(&self.sheets, &obstacles)?;
        if scene.contact.self_contact || self.surface.is_some() {
            let coefficients = scene.contact.friction.coefficients();
            let surface = self.surface.as_ref();
            let surface = surface.map_or(&self.sheets.union, |surface| &surface.sheet);
            contacts = contacts
                .with_self_contact(coefficients)
                .map_err(|e| SceneError::from(self_contact_problem(&e, surface)))?;
            for DrivenSurface { number, part, .. } in &self.origins.driven {
                let coefficients = scene.obstacle[*number].friction.coefficients();
                let others = 0..self.driven.first_point().unwrap_or_default();
                contacts = contacts
                    .with_friction_between([others, part.vertices.clone()], coefficients)
                    .map_err(at(&key.name("obstacle").entry(*number)))?;
            }
        }
        for (k, (key, pair)) in (0..).zip(key.name("contact.pair").entries(&scene.contact.pair)) {
            let [first, second] = [0, 1].map(|side| self.meeting(&pair.sheets[side], &key));
            let holds = self.switches.holds(Holder::Contact(k));
            let coefficients = pair.friction.coefficients();
            let with_pair = match (first?, second?) {
                (Meeting::Points(first), Meeting::Points(second)) if !holds => {
                    Ok(contacts.without_contact_between([first, second]))
                }
                (Meeting::Points(first), Meeting::Points(second)) => {
                    contacts.with_friction_between([first, second], coefficients)
                }
                (Meeting::Body(body), Meeting::Points(vertices))
                | (Meeting::Points(vertices), Meeting::Body(body)) => {
                    contacts.with_friction_on(body, vertices, coefficients)
                }
                (Meeting::Body(_), Meeting::Body(_)) => {
                    let message = "two obstacles do not meet each other";
                    let remedy = "name a sheet or a body that responds and what it meets";
                    return Err(Problem::new(key, message, remedy).into());
                }
            };
            contacts = with_pair.map_err(at(&key))?;
        }
        if scene.contact.self_contact {
            self.modelled.push("self-contact".into());
        }
        Ok((Some(contacts), obstacles))
    }

    /// What one of the names of a pair stands for.
    fn meeting(&self, name: &str, key: &Key) -> Result<Meeting, Problem> {
        let obstacles = &self.scene.obstacle;
        let Some(number) = obstacle_names::number_of(obstacles, name) else {
            return self.points_of(name, key).map(Meeting::Points);
        };
        let mut driven = self.origins.driven.iter();
        Ok(match driven.find(|surface| surface.number == number) {
            Some(surface) => Meeting::Points(surface.part.vertices.clone()),
            None => {
                let before = obstacles[..number].iter();
                let rigid = before.filter(|o| !matches!(o.shape, ShapeKey::Sequence(_)));
                Meeting::Body(rigid.count() as u32)
            }
        })
    }

    pub(super) fn points_of(&self, name: &str, key: &Key) -> Result<Range<usize>, Problem> {
        let part = match self.bodies.named(name) {
            Some(body) => &body.part,
            None => &self.sheets.one(Some(name), key, "the contacts")?.part,
        };
        Ok(part.vertices.clone())
    }
}

/// Why the sheets cannot touch themselves, of the surface of all that touches.
fn self_contact_problem(error: &ContactsError, sheet: &Sheet) -> Problem {
    let key = Key::root().name("contact.self_contact");
    let where_is = match error {
        ContactsError::Reach { face, .. } => {
            let corners = sheet.topology().faces()[*face as usize].map(|v| sheet.position(v));
            let middle = [0, 1, 2].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / 3.0);
            format!("; the face is at {}", place(&middle))
        }
        _ => String::new(),
    };
    let remedy = "choose a smaller `sheet.thickness` or `contact.activation`, or a mesh without narrow faces";
    Problem::new(key, format!("{error}{where_is}"), remedy)
}
