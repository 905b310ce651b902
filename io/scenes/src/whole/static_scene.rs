//! The equilibrium of a scene.

use crate::Scene;
use crate::holding::switch::When;
use crate::meshes::sequence::Sequence;
use crate::methods::method::{Integrator, MethodKey};
use crate::time::poses::Poses;
use crate::time::profile::ProfileKey;
use crate::words::key::Key;
use crate::words::part::all;

impl Scene {
    /// The scene without motion: its steps end at equilibria (`method.integrator = "static"`). A scene in
    /// which nothing is a function of time has one step, at its end. Returns the scene with the keys that
    /// have changed.
    pub fn at_rest(&self) -> (Self, Vec<Key>) {
        let mut scene = self.clone();
        scene.method = MethodKey {
            integrator: Integrator::Static,
            step: self.method.step,
            strain_tolerance: self.method.strain_tolerance,
            max_iterations: self.method.max_iterations,
            rod_stiffness: self.method.rod_stiffness,
            ..MethodKey::default()
        };
        scene.stop.rest = None;
        if !self.changes() {
            scene.method.step = self.stop.time;
            scene.output.frames_per_second = 1.0 / self.stop.time;
        }
        let keys = ["method", "stop", "output"].map(|name| Key::root().name(name));
        (scene, keys.into())
    }

    /// Whether loads, supports or bodies change with time.
    fn changes(&self) -> bool {
        let functions = all::<ProfileKey>(self, Key::root()).into_iter();
        let mut functions = functions.map(|(_, f): (_, &ProfileKey)| f);
        functions.any(|f| !matches!(f, ProfileKey::Constant(_)))
            || !all::<Poses>(self, Key::root()).is_empty()
            || !all::<Sequence>(self, Key::root()).is_empty()
            || !all::<When>(self, Key::root()).is_empty()
    }
}
