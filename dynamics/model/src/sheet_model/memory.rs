//! What the potentials of a model remember.

use crate::{SheetModel, State};
use isosheet_materials::potential::{
    At, MaterialReport, Memories, Potential, Reached, Remembering, Settled,
};
use isosheet_mesh::{EdgeId, FaceId, principal_values};
use nalgebra::Matrix2;

impl SheetModel {
    /// What the potentials remember before anything has happened.
    pub fn memories(&self) -> Memories {
        Memories::of(self.potentials())
    }

    /// The potentials, each with where it is evaluated.
    pub fn potentials_at<'a>(
        &'a self,
        t: f64,
        x: &'a [f64],
        memories: &'a Memories,
    ) -> impl Iterator<Item = (&'a dyn Potential, At<'a>)> {
        let at = move |memory: &'a Vec<f64>| At::new(t, x).with_memory(memory);
        self.potentials().zip(memories.lists().iter().map(at))
    }

    /// What the potentials remember where a simulation starts at rest at positions `x` (`3V`, metres).
    pub fn memories_at_rest(&self, t: f64, x: &[f64]) -> Memories {
        let at_rest = State::at_rest(x.to_vec());
        self.memories_at_start(&State { t, ..at_rest })
    }

    /// What the potentials remember at the start of a simulation.
    pub fn memories_at_start(&self, state: &State) -> Memories {
        let mut memories = self.memories();
        for (p, memory) in self.potentials().zip(memories.lists_mut()) {
            if let Some(p) = p.remembering() {
                p.start(reached(state), memory);
            }
        }
        memories
    }

    /// Makes what the potentials remember that of the end of a step; what that does to the energy.
    pub fn settle(&self, state: &State, memories: &mut Memories) -> Settled {
        let mut sum = Settled::default();
        for (p, memory) in self.potentials().zip(memories.lists_mut()) {
            let Some(p) = p.remembering() else {
                continue;
            };
            let Settled { dissipated, work } = p.settle(reached(state), memory);
            sum.dissipated += dissipated;
            sum.work += work;
        }
        sum
    }

    /// The potentials that tell of their material, each with what it remembers.
    pub fn reports<'a>(
        &'a self,
        memories: &'a Memories,
    ) -> impl Iterator<Item = (&'a dyn MaterialReport, &'a [f64])> {
        let all = self.potentials().zip(memories.lists());
        all.filter_map(|(p, memory)| Some((p.report()?, &memory[..])))
    }

    /// Whether bends or creases can yield.
    pub fn can_yield(&self) -> bool {
        self.potentials()
            .filter_map(Potential::remembering)
            .any(Remembering::can_yield)
    }

    /// The plastic angle of each edge (length E, radians, positive for valleys), 0 where nothing yields;
    /// `None` where no edge can yield. It is what stays of a fold angle where the moment is zero.
    pub fn plastic_angles(&self, memories: &Memories) -> Option<Vec<f64>> {
        let all = self.reports(memories);
        let known: Vec<(EdgeId, f64)> = all.flat_map(|(p, m)| p.plastic_angles(m)).collect();
        if known.is_empty() {
            return None;
        }
        let mut angles = vec![0.0; self.topology().edge_count()];
        for (e, angle) in &known {
            angles[e.index()] += angle;
        }
        Some(angles)
    }

    /// The bend of the faces beside each crease (length E, radians, positive for valleys), 0 at other edges,
    /// at time `t` (seconds) and positions `x` (`3V`, metres); `None` where no crease is in a sheet that
    /// bends. The fold angle of the two faces at a crease ([`isosheet_mesh::fold_angle`]) is the kink of the
    /// crease and this bend (`CreaseSprings::bends_beside`).
    pub fn bends_at_creases(&self, t: f64, x: &[f64], memories: &Memories) -> Option<Vec<f64>> {
        let all = self.reports(memories);
        let at = |memory| At::new(t, x).with_memory(memory);
        let known: Vec<(EdgeId, f64)> = all
            .flat_map(|(p, memory)| p.bends_at_creases(at(memory)))
            .collect();
        if known.is_empty() {
            return None;
        }
        let mut bends = vec![0.0; self.topology().edge_count()];
        for (e, bend) in &known {
            bends[e.index()] += bend;
        }
        Some(bends)
    }

    /// The principal values of the plastic curvature of each face (length F, 1/m), the larger one in size
    /// first, positive where the sheet is a valley as seen from the side from which faces are
    /// counter-clockwise; `None` where no face can yield. They are what stays of the curvature where the
    /// moment is zero.
    pub fn plastic_curvatures(&self, memories: &Memories) -> Option<Vec<[f64; 2]>> {
        let all = self.reports(memories);
        let known: Vec<(FaceId, Matrix2<f64>)> =
            all.flat_map(|(p, m)| p.plastic_curvatures(m)).collect();
        if known.is_empty() {
            return None;
        }
        let mut curvatures = vec![Matrix2::zeros(); self.topology().face_count()];
        for (f, curvature) in &known {
            curvatures[f.index()] += curvature;
        }
        Some(curvatures.iter().map(principal).collect())
    }
}

fn reached(state: &State) -> Reached<'_> {
    Reached {
        t: state.t,
        x: &state.x,
        v: &state.v,
    }
}

/// The principal values of a symmetric matrix, the larger one in size first.
fn principal(m: &Matrix2<f64>) -> [f64; 2] {
    principal_values([m[(0, 0)], m[(0, 1)], m[(1, 1)]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PotentialOfPart;
    use isosheet_materials::{CreaseSpring, CreaseSprings, PlateBending, Yield};
    use isosheet_mesh::{MassKind, Part, Sheet, generate};

    #[test]
    fn principal_values_are_eigenvalues_in_the_order_of_size() {
        for m in [
            Matrix2::new(1.0, 0.4, 0.4, -3.0),
            Matrix2::new(2.0, -0.7, -0.7, 1.5),
            Matrix2::zeros(),
        ] {
            let [first, second] = principal(&m);
            assert!(first.abs() >= second.abs());
            let found = m.symmetric_eigenvalues();
            let (large, small) = (first.max(second), first.min(second));
            assert!((found.max() - large).abs() < 1e-14 && (found.min() - small).abs() < 1e-14);
        }
    }

    /// Of two strips the second one yields: rolled to a cylinder, its plate keeps what is beyond the yield,
    /// and its spring too. The first one has nothing.
    #[test]
    fn what_stays_has_its_place_among_several_sheets() {
        let (rigidity, moment, curvature) = (2.0, 0.5, 0.9);
        let strip = generate::strip(8, 1.0, 0.1, generate::Diagonals::Rising).expect("a strip");
        let lifted = strip
            .map_positions(|[x, y, z]| [x, y, z + 1.0])
            .expect("moved");
        let sheets = [&strip, &lifted];
        let parts = Part::of_union(&sheets);
        let both = Sheet::union(&sheets).expect("two strips");
        let plate = PlateBending::new(&lifted, rigidity).expect("a plate");
        let plate = plate
            .with_yield(&lifted, Yield::perfect(moment))
            .expect("in range");
        let t = lifted.topology();
        let rung = t
            .edge_ids()
            .filter(|e| !t.is_boundary_edge(*e))
            .nth(5)
            .expect("an inner edge");
        let spring = CreaseSpring {
            edge: rung,
            stiffness: 3.0,
            rest: 0.0.into(),
            yields: Some(Yield::perfect(0.06)),
            in_series: None,
        };
        let springs = CreaseSprings::new(t, vec![spring]).expect("a spring");
        let plain = SheetModel::new(&both, 0.1, MassKind::Lumped).expect("mass");
        assert_eq!(
            (
                plain.plastic_angles(&plain.memories()),
                plain.plastic_curvatures(&plain.memories())
            ),
            (None, None)
        );
        let model = plain
            .with_potential(PotentialOfPart::new(plate, &parts[1]))
            .with_potential(PotentialOfPart::new(springs, &parts[1]));
        let turn = |x: f64| (curvature * x).sin_cos();
        let rolled = |[x, y, z]: [f64; 3]| {
            let (sin, cos) = turn(x);
            [sin / curvature, y, z + (1.0 - cos) / curvature]
        };
        let x: Vec<f64> = both
            .positions()
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(|p| rolled(*p))
            .collect();
        let mut memories = model.memories();
        assert!(
            model
                .settle(&State::at_rest(x.clone()), &mut memories)
                .dissipated
                > 0.0
        );
        let curvatures = model
            .plastic_curvatures(&memories)
            .expect("a plate that yields");
        let expected = curvature - moment / rigidity;
        let own = parts[1].faces.clone();
        for (face, [first, second]) in curvatures.iter().enumerate() {
            // The faces at the ends of a strip have no neighbour to one side.
            if own.start + 2 <= face && face + 2 < own.end {
                assert!(
                    (first - expected).abs() < 0.03 * expected,
                    "{face}: {first}"
                );
                assert!(second.abs() < 0.03 * expected, "{face}: {second}");
            } else if face < own.start {
                assert_eq!([*first, *second], [0.0; 2]);
            }
        }
        let angles = model
            .plastic_angles(&memories)
            .expect("a spring that yields");
        let bent: Vec<usize> = (0..angles.len()).filter(|e| angles[*e] != 0.0).collect();
        assert_eq!(bent, [parts[1].edge(rung).index()]);
        let fold =
            isosheet_mesh::fold_angle(both.topology(), &x, parts[1].edge(rung)).expect("inner");
        let beyond = fold - 0.06 / 3.0;
        assert!(
            (angles[bent[0]] - beyond).abs() < 1e-12,
            "{angles:?} {beyond}"
        );
    }
}
