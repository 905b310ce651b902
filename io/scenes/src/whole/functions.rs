//! The functions of time of a scene, and the motions that are made of them.

use crate::time::pose::MotionKey;
use crate::time::poses::Poses;
use crate::time::profile::ProfileKey;
use crate::words::key::{Key, KeyPart};
use crate::words::part::{all, all_mut};
use crate::{AnyPart, Place, Scene, Unit};
use nalgebra::Isometry3;

/// A function of time of a scene.
#[derive(Clone, Debug)]
pub struct Function<'a> {
    /// The place of the function in the scene.
    pub key: Key,
    /// The function.
    pub profile: &'a ProfileKey,
    /// The unit of its values, as it is written behind a number.
    pub unit: &'static str,
}

/// A rigid motion of a scene.
pub struct Moved<'a> {
    /// The place of the motion in the scene.
    pub key: Key,
    /// The motion.
    pub motion: &'a mut MotionKey,
    /// The frame of what moves while it is not displaced: that of an obstacle, and that of space of a
    /// support.
    pub(crate) frame: Isometry3<f64>,
}

impl Scene {
    /// All functions of time.
    pub fn functions(&self) -> Vec<Function<'_>> {
        let functions = all(self, Key::root()).into_iter();
        let function = |(at, profile): (Place, _)| Function {
            profile,
            unit: at.unit.map_or("", Unit::symbol),
            key: at.key,
        };
        functions.map(function).collect()
    }

    /// All functions of time with their keys, so that they can be changed.
    pub fn functions_mut(&mut self) -> Vec<(Key, &mut ProfileKey)> {
        let functions = all_mut(self, Key::root()).into_iter();
        functions.map(|(at, profile)| (at.key, profile)).collect()
    }

    /// All rigid motions of supports and obstacles.
    pub fn motions_mut(&mut self) -> Vec<Moved<'_>> {
        let obstacles = self.obstacle.iter();
        let frames: Vec<_> = obstacles.map(|o| o.pose.isometry()).collect();
        let frame = |key: &Key| match key.parts() {
            [KeyPart::Name(list), KeyPart::Entry(k), ..] if list == "obstacle" => frames[*k],
            _ => Isometry3::identity(),
        };
        let motions = all_mut(self, Key::root()).into_iter();
        let moved = motions.map(|(at, motion)| Moved {
            frame: frame(&at.key),
            key: at.key,
            motion,
        });
        moved.collect()
    }

    /// When functions of time and motions by poses change abruptly, seconds, see
    /// [`SheetModel::with_breaks`](isosheet_dynamics::SheetModel::with_breaks).
    pub(crate) fn breaks(&self) -> Vec<f64> {
        breaks(self)
    }
}

impl MotionKey {
    /// The times at which the velocity or the acceleration jumps, seconds.
    pub fn breaks(&self) -> Vec<f64> {
        breaks(self)
    }
}

/// When functions of time and poses in a part of a scene change abruptly, seconds.
fn breaks(part: &AnyPart) -> Vec<f64> {
    let functions = all::<ProfileKey>(part, Key::root()).into_iter();
    let poses = all::<Poses>(part, Key::root()).into_iter();
    let of_functions = functions.flat_map(|(_, function)| function.breaks());
    let of_poses = poses.flat_map(|(_, poses)| poses.breaks());
    of_functions.chain(of_poses).collect()
}
