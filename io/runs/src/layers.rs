//! In which order the panels of a flat-folded sheet lie on each other.

use super::fold_verdict::panels;
use super::overlap::{Triangle, overlap};
use super::{FoldVerdict, LayersError, Recording};
use isosheet_mesh::{FaceId, Topology};
use isosheet_scenes::size;
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// Panels that lie on each other with their order, at the end of a run that folds a crease pattern flat.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The panel of each face, from 0.
    pub panels: Vec<usize>,
    /// The layer of each panel, from 0 at the bottom: it is above all panels that it covers.
    pub levels: Vec<usize>,
    /// Whether the front of each panel is seen from above: the side from which its faces are
    /// counter-clockwise.
    pub shows_front: Vec<bool>,
    /// Of each two panels that cover each other a face of either, the lower one first.
    pub covers: Vec<[FaceId; 2]>,
    /// The direction upward.
    pub up: Vector3<f64>,
}

/// Panels are flat whose normals are at most so far from the direction upward or downward, degrees.
const FLAT: f64 = 20.0;

/// Panels cover each other whose common area is this share of a face at least: neighbours meet along a line.
const COMMON: f64 = 1e-3;

/// The least distance of panels whose order can be told where nothing keeps them apart, beside the longest
/// side of the sheet.
const APART: f64 = 2.5e-5;

/// What is known of two panels that cover each other.
#[derive(Clone, Copy, Debug, Default)]
struct Cover {
    /// The common area, and this area times the height of the second panel over the first one.
    area: f64,
    above: f64,
    /// The two faces with the largest common area, and this area.
    faces: [usize; 2],
    most: f64,
}

impl Layers {
    /// Of the last frame of a run.
    ///
    /// # Errors
    /// [`LayersError`] if the run folds no pattern, or its panels are not flat or have no order.
    pub fn of(recording: &Recording) -> Result<Self, LayersError> {
        let verdict = FoldVerdict::of(recording).ok_or(LayersError::NoPattern)?;
        let last = recording.trajectory.len().checked_sub(1);
        let x = last.and_then(|k| recording.trajectory.frame(k));
        let (Some(x), Some(targets)) = (x, &recording.targets.folding) else {
            return Err(LayersError::NoPattern);
        };
        if let Some(part) = verdict.passing {
            return Err(LayersError::Passing { part });
        }
        let topology = recording.sheet.topology();
        // Panels in contact never pass through each other: however near they are, the sign of their distance
        // tells their order.
        let least = match recording.scene.scene().contact.self_contact {
            true => 0.0,
            false => APART * size(x.as_chunks::<3>().0),
        };
        Self::of_panels(topology, x, &panels(topology, targets), least)
    }

    /// Of faces at positions `x` (`3V`, metres), each with a number that stands for its panel. Panels have an
    /// order that are at least `least` apart, metres.
    fn of_panels(
        topology: &Topology,
        x: &[f64],
        roots: &[usize],
        least: f64,
    ) -> Result<Self, LayersError> {
        let panels = compact(roots);
        let count = panels.iter().max().map_or(0, |last| last + 1);
        let corners = |f: usize| {
            let [a, b, c] = topology.faces()[f].map(|v| 3 * v.index());
            [a, b, c].map(|k| Point3::new(x[k], x[k + 1], x[k + 2]))
        };
        let normal = |f: usize| {
            let [a, b, c] = corners(f);
            (b - a).cross(&(c - a))
        };
        let mut normals = vec![Vector3::zeros(); count];
        for (f, panel) in panels.iter().enumerate() {
            normals[*panel] += normal(f);
        }
        let largest = normals.iter().max_by(|a, b| a.norm().total_cmp(&b.norm()));
        let up = largest.map_or(Vector3::z(), |n| n.normalize());
        // As in the pattern, where it was: the side of its viewer is above.
        let up = if up.z < 0.0 { -up } else { up };
        for f in 0..panels.len() {
            let turned = normal(f).normalize().dot(&up).abs().min(1.0);
            let off = turned.acos().to_degrees();
            if off > FLAT {
                return Err(LayersError::NotFlat { off });
            }
        }
        let across = up.cross(&Vector3::x());
        let across = match across.norm() > 0.1 {
            true => across.cross(&up).normalize(),
            false => Vector3::y().cross(&up).normalize(),
        };
        let axes = [across, up.cross(&across), up];
        let triangles = (0..panels.len()).map(|f| {
            let at = corners(f).map(|p| axes.map(|axis| axis.dot(&p.coords)));
            Triangle::new(at)
        });
        let triangles: Vec<Triangle> = triangles.collect();
        let covers = lower_first(covers(&triangles, &panels), least)?;
        let levels = levels(count, &covers, &panels)?;
        Ok(Self {
            levels,
            shows_front: normals.iter().map(|n| n.dot(&up) > 0.0).collect(),
            covers: covers.iter().map(|c| c.map(FaceId::from_index)).collect(),
            panels,
            up,
        })
    }

    /// The number of layers.
    pub fn count(&self) -> usize {
        self.levels.iter().max().map_or(0, |top| top + 1)
    }

    /// The order as `faceOrders` of the FOLD format has it: `[f, g, s]` with `s = 1` where `f` lies on the
    /// side of `g` to which its normal points, and `-1` where it lies on the other one.
    pub fn face_orders(&self) -> Vec<[i64; 3]> {
        let order = |[lower, upper]: &[FaceId; 2]| {
            let shows_front = self.shows_front[self.panels[lower.index()]];
            let side = if shows_front { 1 } else { -1 };
            [upper.index() as i64, lower.index() as i64, side]
        };
        self.covers.iter().map(order).collect()
    }
}

/// Numbers from 0 for the numbers that stand for panels.
fn compact(roots: &[usize]) -> Vec<usize> {
    let mut known = BTreeMap::new();
    let number = |root: &usize| {
        let next = known.len();
        *known.entry(*root).or_insert(next)
    };
    roots.iter().map(number).collect()
}

/// Which panels cover each other, by the numbers of both.
fn covers(triangles: &[Triangle], panels: &[usize]) -> BTreeMap<[usize; 2], Cover> {
    let mut found: BTreeMap<[usize; 2], Cover> = BTreeMap::new();
    for (f, first) in triangles.iter().enumerate() {
        for (g, second) in triangles.iter().enumerate().skip(f + 1) {
            if panels[f] == panels[g] {
                continue;
            }
            let Some(common) = overlap(first, second) else {
                continue;
            };
            if common.area < COMMON * first.area().min(second.area()) {
                continue;
            }
            let above = common.area * (second.height(common.middle) - first.height(common.middle));
            let (pair, faces, above) = match panels[f] < panels[g] {
                true => ([panels[f], panels[g]], [f, g], above),
                false => ([panels[g], panels[f]], [g, f], -above),
            };
            let cover = found.entry(pair).or_default();
            cover.area += common.area;
            cover.above += above;
            if common.area > cover.most {
                (cover.most, cover.faces) = (common.area, faces);
            }
        }
    }
    found
}

/// The faces of two panels that cover each other, the lower one first.
fn lower_first(
    covers: BTreeMap<[usize; 2], Cover>,
    least: f64,
) -> Result<Vec<[usize; 2]>, LayersError> {
    let order = |cover: Cover| {
        let apart = cover.above / cover.area;
        let [a, b] = cover.faces;
        match apart.abs() < least {
            true => Err(LayersError::Touching {
                apart: apart.abs(),
                least,
            }),
            false if apart > 0.0 => Ok([a, b]),
            false => Ok([b, a]),
        }
    };
    covers.into_values().map(order).collect()
}

/// The layer of each panel: one more than that of the highest panel below it.
fn levels(
    count: usize,
    covers: &[[usize; 2]],
    panels: &[usize],
) -> Result<Vec<usize>, LayersError> {
    let mut levels = vec![0; count];
    // The pair that lifted each panel last.
    let mut lifted = vec![None; count];
    // A way upward passes each panel once, so that as many rounds suffice.
    for _ in 0..=count {
        let mut is_settled = true;
        for pair in covers {
            let [lower, upper] = pair.map(|f| panels[f]);
            if levels[upper] <= levels[lower] {
                levels[upper] = levels[lower] + 1;
                lifted[upper] = Some(*pair);
                is_settled = false;
            }
        }
        if is_settled {
            return Ok(levels);
        }
    }
    Err(LayersError::Circle {
        faces: circle(&levels, &lifted, panels),
    })
}

/// A face of each panel of a circle, from the pairs that lifted panels without end.
fn circle(levels: &[usize], lifted: &[Option<[usize; 2]>], panels: &[usize]) -> Vec<FaceId> {
    let below = |panel: usize| lifted[panel].map_or(panel, |[lower, _]| panels[lower]);
    // The highest panel is of a circle or above one: so many steps down end in it.
    let highest = (0..levels.len()).max_by_key(|panel| levels[*panel]);
    let first = (0..levels.len()).fold(highest.unwrap_or(0), |panel, _| below(panel));
    let mut faces = Vec::new();
    let mut panel = first;
    loop {
        faces.extend(lifted[panel].map(|[_, upper]| FaceId::from_index(upper)));
        panel = below(panel);
        if panel == first {
            faces.reverse();
            return faces;
        }
    }
}

#[cfg(test)]
mod tests;
