//! The functions of time of a scene.

use super::Scene;
use super::key::Key;
use super::pose::Motion;
use super::profile::Profile;
use super::sheets::sheet_key;
use super::supports::Hold;

impl Scene {
    /// All functions of time with their keys.
    pub(crate) fn functions_mut(&mut self) -> Vec<(Key, &mut Profile)> {
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
        for (k, support) in self.support.iter_mut().enumerate() {
            let (place, motion) = match &mut support.hold {
                Hold::Pin | Hold::Clamp | Hold::Follow { .. } => continue,
                Hold::MovingPin(motion) => ("hold.moving_pin", motion),
                Hold::MovingClamp(motion) => ("hold.moving_clamp", motion),
                Hold::SlidingClamp { motion, .. } => ("hold.sliding_clamp.motion", motion),
                Hold::Curve { motion, .. } => ("hold.curve.motion", motion),
                Hold::Surface { motion, .. } => ("hold.surface.motion", motion),
            };
            all.extend(motion.functions_mut(&root.name("support").entry(k).name(place)));
        }
        for (k, obstacle) in self.obstacle.iter_mut().enumerate() {
            let key = root.name("obstacle").entry(k).name("motion");
            all.extend(obstacle.motion.functions_mut(&key));
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

impl Motion {
    fn functions_mut(&mut self, key: &Key) -> Vec<(Key, &mut Profile)> {
        let Self { x, y, z, rotation } = self;
        let mut all = vec![(key.name("x"), x), (key.name("y"), y), (key.name("z"), z)];
        let rotation = rotation.as_mut();
        all.extend(rotation.map(|r| (key.name("rotation.angle"), &mut r.angle)));
        all
    }
}
