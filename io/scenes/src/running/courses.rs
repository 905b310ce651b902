//! How supports and obstacles move in a step.

use crate::Scene;
use crate::running::under_way::UnderWay;
use crate::whole::functions::Moved;
use crate::words::key::{Key, KeyPart};
use nalgebra::Point3;

/// How the points of a support, or the origin of an obstacle, move.
pub(crate) struct Course {
    /// The motion.
    pub(crate) key: Key,
    /// Where each point is, and where it is to be.
    pub(crate) points: Vec<[Point3<f64>; 2]>,
}

/// How supports and obstacles with a motion move in a step of `h` seconds from the present state.
pub(crate) fn courses(scene: &Scene, under_way: &UnderWay, h: f64) -> Vec<Course> {
    let simulation = &under_way.simulation;
    let (t, x) = (
        simulation.state().t,
        simulation.state().x.as_chunks::<3>().0,
    );
    let (origins, model) = (&under_way.facts.origins, simulation.model());
    let held = origins.vertices(model, scene.support.len());
    let mut scene = scene.clone();
    let courses = scene.motions_mut().into_iter().filter_map(|moved| {
        let Moved { key, motion, frame } = moved;
        let Some(KeyPart::Entry(number)) = key.parts().get(1) else {
            return None;
        };
        let body = motion.of_body(frame);
        let [from, to] = [t, t + h].map(|t| body.kinematics(t).pose);
        let points: Vec<Point3<f64>> = match &key.parts()[0] {
            KeyPart::Name(list) if list == "support" => {
                let vertices = held.get(*number)?.iter();
                vertices.map(|v| Point3::from(x[v.index()])).collect()
            }
            _ => vec![from * Point3::origin()],
        };
        let there = to * from.inverse();
        let points = points.iter().map(|p| [*p, there * p]).collect();
        Some(Course { key, points })
    });
    courses.collect()
}
