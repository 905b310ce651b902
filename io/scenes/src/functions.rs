//! The functions of time of a scene.

use super::Scene;
use super::key::Key;
use super::pose::Motion;
use super::poses::Poses;
use super::profile::Profile;
use super::sheets::sheet_key;
use super::{Obstacle, Support};
use nalgebra::Isometry3;

impl Scene {
    /// All rigid motions of supports and obstacles.
    pub fn motions_mut(&mut self) -> Vec<Moved<'_>> {
        moved(&mut self.support, &mut self.obstacle)
    }

    /// All functions of time with their keys.
    pub fn functions_mut(&mut self) -> Vec<(Key, &mut Profile)> {
        let (root, mut all) = (Key::root(), Vec::new());
        if let Some(air) = &mut self.air {
            let components = air.wind.iter_mut().enumerate();
            all.extend(components.map(|(k, wind)| (root.name("air.wind").entry(k), wind)));
        }
        let sheets = self.sheet.len();
        for (k, sheet) in self.sheet.iter_mut().enumerate() {
            let key = sheet_key(sheets, k);
            let curl = sheet.curl.as_mut().map(|curl| &mut curl.profile);
            all.extend(curl.map(|profile| (key.name("curl.profile"), profile)));
            let swell = sheet.swell.as_mut();
            all.extend(swell.map(|swell| (key.name("swell"), swell)));
            let stiffening = sheet.stiffening.as_mut();
            all.extend(stiffening.map(|factor| (key.name("stiffening"), factor)));
        }
        for (k, crease) in self.crease.iter_mut().enumerate() {
            all.push((
                root.name("crease").entry(k).name("angle"),
                &mut crease.angle,
            ));
        }
        let course = self
            .folding
            .as_mut()
            .and_then(|folding| folding.course.as_mut());
        all.extend(course.map(|course| (root.name("folding.course"), course)));
        for Moved { key, motion, .. } in moved(&mut self.support, &mut self.obstacle) {
            all.extend(motion.functions_mut(&key));
        }
        for (k, body) in self.body.iter_mut().enumerate() {
            all.extend(body.functions_mut(&root.name("body").entry(k)));
        }
        for (k, load) in self.forces.load.iter_mut().enumerate() {
            let key = root.name("forces.load").entry(k).name("size");
            all.push((key, &mut load.size));
        }
        for (k, pressure) in self.forces.pressure.iter_mut().enumerate() {
            let key = root.name("forces.pressure").entry(k).name("size");
            all.push((key, &mut pressure.size));
        }
        for (k, gas) in self.forces.gas.iter_mut().enumerate() {
            let key = root.name("forces.gas").entry(k).name("added");
            all.push((key, &mut gas.added));
        }
        for (k, moment) in self.forces.moment.iter_mut().enumerate() {
            let key = root.name("forces.moment").entry(k).name("size");
            all.push((key, &mut moment.size));
        }
        for (k, field) in self.forces.acceleration.iter_mut().enumerate() {
            let key = root.name("forces.acceleration").entry(k).name("size");
            all.push((key, &mut field.size));
        }
        for (k, glue) in self.glue.iter_mut().enumerate() {
            all.push((
                root.name("glue").entry(k).name("closing"),
                &mut glue.closing,
            ));
        }
        all
    }
}

impl Scene {
    /// When functions of time and motions by poses change abruptly, seconds, see
    /// [`SheetModel::with_breaks`](isosheet_dynamics::SheetModel::with_breaks).
    pub(crate) fn breaks(&self) -> Vec<f64> {
        let mut scene = self.clone();
        let functions = scene.functions_mut().into_iter();
        let mut all: Vec<f64> = functions
            .flat_map(|(_, function)| function.breaks())
            .collect();
        for Moved { motion, .. } in scene.motions_mut() {
            all.extend(motion.poses.iter().flat_map(Poses::breaks));
        }
        all
    }
}

/// A rigid motion of a scene.
pub struct Moved<'a> {
    /// The place of the motion in the scene.
    pub key: Key,
    /// The motion.
    pub motion: &'a mut Motion,
    /// The frame of what moves while it is not displaced: that of an obstacle, and that of space of a
    /// support.
    pub(crate) frame: Isometry3<f64>,
}

fn moved<'a>(supports: &'a mut [Support], obstacles: &'a mut [Obstacle]) -> Vec<Moved<'a>> {
    let supports = supports.iter_mut().enumerate();
    let of_supports = supports.filter_map(|(k, support)| {
        let place = support.hold.motion_place()?;
        Some(Moved {
            key: Key::root().name("support").entry(k).name(place),
            motion: support.hold.motion_mut()?,
            frame: Isometry3::identity(),
        })
    });
    let obstacles = obstacles.iter_mut().enumerate();
    let of_obstacles = obstacles.map(|(k, obstacle)| Moved {
        key: Key::root().name("obstacle").entry(k).name("motion"),
        frame: obstacle.pose.isometry(),
        motion: &mut obstacle.motion,
    });
    of_supports.chain(of_obstacles).collect()
}

impl Motion {
    /// The times at which the velocity or the acceleration jumps, seconds.
    pub fn breaks(&self) -> Vec<f64> {
        let mut motion = self.clone();
        let functions = motion.functions_mut(&Key::root()).into_iter();
        let of_functions = functions.flat_map(|(_, function)| function.breaks());
        let of_poses = self.poses.iter().flat_map(Poses::breaks);
        of_functions.chain(of_poses).collect()
    }

    fn functions_mut(&mut self, key: &Key) -> Vec<(Key, &mut Profile)> {
        let Self {
            x, y, z, rotation, ..
        } = self;
        let mut all = vec![(key.name("x"), x), (key.name("y"), y), (key.name("z"), z)];
        let rotation = rotation.as_mut();
        all.extend(rotation.map(|r| (key.name("rotation.angle"), &mut r.angle)));
        all
    }
}
