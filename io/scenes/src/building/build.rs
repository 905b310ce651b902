//! From a scene to a simulation.

mod bends;
mod builder;
mod contacts;
mod follow;
mod follower_loads;
mod forces;
mod glue;
mod guides;
mod start;
mod supports;

use crate::building::setup::Facts;
use crate::measures::measure::Measurable;
use crate::placing::in_words::materials_in_words;
use crate::placing::placed::PlacedSheet;
use crate::placing::placed_bodies::Surface;
use crate::whole::step_path::check_step;
use crate::whole::switches::Switches;
use crate::words::error::SceneError;
use crate::words::key::Key;
use crate::{Gauge, Measure, Scene, Setup};
use builder::Builder;
pub use builder::Kept;
use isosheet_collide::{Contacts, Obstacle};
use isosheet_dynamics::contact::SurfacePoints;
use isosheet_mesh::VertexId;
use std::path::Path;
use std::sync::Arc;

impl Scene {
    /// Makes everything that a simulation needs. Masses are lumped: a third of that of each face at each of
    /// its corners. Paths are relative to `folder`.
    ///
    /// # Errors
    /// [`SceneError`], with all problems of the values or the first one of what is made of them.
    pub fn build(&self, folder: &Path) -> Result<Setup, SceneError> {
        self.validate()?;
        self.build_with(&mut Kept::in_folder(folder))
    }

    /// Makes what a simulation needs of a scene that has been checked, with what is kept of it.
    pub(crate) fn build_with(&self, kept: &mut Kept) -> Result<Setup, SceneError> {
        self.build_held(kept, &Switches::at_start(self))
    }

    /// Makes what a simulation under way goes on with, in which something has been taken up or released.
    pub(crate) fn build_switched(
        &self,
        kept: &mut Kept,
        switches: &Switches,
    ) -> Result<Setup, SceneError> {
        if kept.start.is_none() {
            self.build_with(kept)?;
        }
        self.build_held(kept, switches)
    }

    fn build_held(&self, kept: &mut Kept, switches: &Switches) -> Result<Setup, SceneError> {
        let mut builder = Builder::new(self, kept, switches)?;
        switches.check(builder.x.len())?;
        builder.add_forces()?;
        builder.add_supports()?;
        builder.add_guides()?;
        builder.add_body_forces()?;
        builder.mend_start()?;
        builder.add_folds()?;
        builder.add_isometry()?;
        builder.perturb_start()?;
        builder.add_glue()?;
        builder.add_follower_loads()?;
        let (contacts, obstacles) = builder.contacts()?;
        let gauge = |(k, measure): (usize, &Measure)| {
            let key = Key::root().name("measure").entry(k);
            let things = Measurable {
                creases: &builder.creases,
                enclosed: &builder.enclosed,
            };
            measure.gauge(&key, &builder.sheets, &builder.bodies, things)
        };
        let measures = self.measure.iter().enumerate().map(gauge);
        let mut measures: Vec<Gauge> = measures.collect::<Result<_, _>>()?;
        let of_gas = |(name, gas): &(String, _)| Gauge::of_gas(name, gas);
        measures.extend(builder.gases.iter().flat_map(of_gas));
        let setup = builder.finish(contacts, obstacles, measures);
        check_step(self, &setup.model, setup.sheet.area(), &setup.start.v)?;
        Ok(setup)
    }
}

impl Builder<'_> {
    fn finish(
        mut self,
        contacts: Option<Contacts>,
        obstacles: Vec<Obstacle>,
        measures: Vec<Gauge>,
    ) -> Setup {
        let start = self.start();
        let model = self.model.take();
        let model = model
            .expect("a change that fails ends the building")
            .with_breaks(self.scene.breaks());
        let sheets = &self.sheets.list;
        let part = |sheet: &PlacedSheet<'_>| {
            let name = sheet.of.name.clone();
            (name.unwrap_or_else(|| "sheet".into()), sheet.part.clone())
        };
        let of_bodies = self.bodies.list.iter().enumerate();
        let of_bodies = of_bodies.map(|(k, body)| (body.of.name(k), body.part.clone()));
        let of_obstacles = self.origins.driven.iter();
        let of_obstacles = of_obstacles.map(|o| (format!("obstacle_{}", o.number), o.part.clone()));
        let parts: Vec<_> = match &sheets[..] {
            [_] if self.surface.is_none() => Vec::new(),
            several => several
                .iter()
                .map(part)
                .chain(of_bodies)
                .chain(of_obstacles)
                .collect(),
        };
        let of_sheets = self.sheets.warnings(self.scene);
        let mut fold_assignments = self.sheets.fold_assignments();
        let (sheet, points) = match self.surface {
            None => (self.sheets.union, None),
            Some(Surface { sheet, points }) => (sheet, Some(points)),
        };
        if let Some(of_edges) = &mut fold_assignments {
            of_edges.resize(sheet.topology().edge_count(), None);
        }
        let bodies = self.bodies.carried();
        let carriers: Vec<VertexId> = bodies.iter().flat_map(|body| body.vertices).collect();
        let mut pins = model.pins();
        pins.retain(|v| !carriers.contains(v) && !self.origins.is_driven(*v));
        let material = materials_in_words(sheets);
        let facts = Facts {
            mass: model.mass().total(),
            start: SurfacePoints::placed(points.as_ref(), &start.x).into_owned(),
            sheet,
            points,
            parts,
            bodies,
            obstacles,
            modelled: self.modelled,
            targets: self.targets,
            measures,
            origins: self.origins,
            bonds: self.bonds,
            led: self.led.into_list(),
            pins,
            creased: self.creased,
            fold_assignments,
        };
        Setup {
            facts: Arc::new(facts),
            start,
            model,
            contacts,
            integration: self.scene.method.build(),
            material,
            of_sheets,
            switches: self.switches.clone(),
            text: None,
        }
    }
}
