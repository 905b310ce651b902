//! A spring by which somebody pulls at a vertex while the simulation runs.

use isosheet_materials::hessian::HessianSink;
use isosheet_materials::potential::{At, Potential, Remembering};
use isosheet_mesh::wording::given;
use isosheet_mesh::{Advice, Topology, VertexId};
use nalgebra::{Matrix3, Vector3};

/// Why a hand cannot pull.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HandError {
    /// The vertex does not exist.
    #[error("{vertex} is pulled at, but the sheet has only {vertex_count} vertices")]
    NoSuchVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        vertex_count: usize,
    },
    /// No hand holds the vertex.
    #[error("no hand holds {vertex}")]
    NoHand {
        /// The vertex.
        vertex: VertexId,
    },
    /// The stiffness is not positive and finite.
    #[error("the stiffness of the hand is {stiffness} N/m", stiffness = given(*stiffness))]
    Stiffness {
        /// The stiffness, N/m.
        stiffness: f64,
    },
    /// The way of the hand ends now or before, or at no time.
    #[error("the hand is to arrive at {end} s, and it is {now} s", end = given(*end), now = given(*now))]
    End {
        /// The time given, seconds.
        end: f64,
        /// The time of the simulation, seconds.
        now: f64,
    },
    /// A coordinate of the point that pulls is not finite.
    #[error("the hand is led to [{x}, {y}, {z}] m", x = given(to[0]), y = given(to[1]), z = given(to[2]))]
    Target {
        /// The point, metres.
        to: [f64; 3],
    },
}

impl Advice for HandError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NoSuchVertex { .. } => None,
            Self::NoHand { .. } => Some("give the model a hand at this vertex"),
            Self::Stiffness { .. } => Some("give a positive number"),
            Self::End { .. } => Some("give a later time"),
            Self::Target { .. } => Some("give three finite numbers"),
        }
    }
}

/// A spring between a vertex and a point in space that is led from outside, `V(t, x) = k |x_v - p(t)|^2 / 2`:
/// a hand that holds a vertex. Between two steps it is led elsewhere (`Simulation::lead_hand`), and its
/// work enters the energy balance. Where it is and where it goes is what it remembers: a part of the state of
/// a simulation and of its checkpoints.
#[derive(Debug, Clone)]
pub struct Hand {
    vertex: VertexId,
    stiffness: f64,
    /// Where it is at first, metres.
    at: Vector3<f64>,
}

/// A straight way of the point: at `from` until `begin`, at `to` from `end` on (seconds).
#[derive(Debug, Clone, Copy)]
struct Way {
    from: Vector3<f64>,
    to: Vector3<f64>,
    begin: f64,
    end: f64,
}

impl Way {
    fn at(&self, t: f64) -> Vector3<f64> {
        if t >= self.end {
            return self.to;
        }
        let part = ((t - self.begin) / (self.end - self.begin)).clamp(0.0, 1.0);
        self.from + part * (self.to - self.from)
    }

    /// As it is kept in a memory.
    fn numbers(&self) -> [f64; 8] {
        let [[a, b, c], [d, e, f]] = [self.from, self.to].map(<[f64; 3]>::from);
        [a, b, c, d, e, f, self.begin, self.end]
    }
}

impl Hand {
    /// A hand of a stiffness (N/m) that holds a vertex and is at a point (metres): where the vertex is, it
    /// pulls at nothing yet.
    ///
    /// # Errors
    /// [`HandError`] naming the first argument that cannot be used.
    pub fn new(
        topology: &Topology,
        vertex: VertexId,
        stiffness: f64,
        at: [f64; 3],
    ) -> Result<Self, HandError> {
        let vertex_count = topology.vertex_count();
        if vertex.index() >= vertex_count {
            return Err(HandError::NoSuchVertex {
                vertex,
                vertex_count,
            });
        }
        if !(stiffness.is_finite() && stiffness > 0.0) {
            return Err(HandError::Stiffness { stiffness });
        }
        let at = point(at)?;
        Ok(Self {
            vertex,
            stiffness,
            at,
        })
    }

    /// The vertex that is held.
    pub fn vertex(&self) -> VertexId {
        self.vertex
    }

    /// The stiffness of the spring, N/m.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Where the hand of a memory is at time `t` (seconds), metres.
    pub fn target(&self, t: f64, memory: &[f64]) -> Vector3<f64> {
        self.way(memory).at(t)
    }

    /// Leads the hand of a memory from where it is at time `begin` to a point (metres) until time `end`
    /// (seconds).
    pub fn lead(
        &self,
        to: [f64; 3],
        [begin, end]: [f64; 2],
        memory: &mut [f64],
    ) -> Result<(), HandError> {
        let to = point(to)?;
        if !(end.is_finite() && end > begin) {
            return Err(HandError::End { end, now: begin });
        }
        let from = self.way(memory).at(begin);
        let way = Way {
            from,
            to,
            begin,
            end,
        };
        memory.copy_from_slice(&way.numbers());
        Ok(())
    }

    fn way(&self, memory: &[f64]) -> Way {
        match *memory {
            [a, b, c, d, e, f, begin, end] => Way {
                from: Vector3::new(a, b, c),
                to: Vector3::new(d, e, f),
                begin,
                end,
            },
            _ => Way {
                from: self.at,
                to: self.at,
                begin: 0.0,
                end: 0.0,
            },
        }
    }

    /// From the hand to the vertex, metres.
    fn stretch(&self, at: At<'_>) -> Vector3<f64> {
        let place = Vector3::from(at.x.as_chunks::<3>().0[self.vertex.index()]);
        place - self.target(at.t, at.memory)
    }
}

fn point(to: [f64; 3]) -> Result<Vector3<f64>, HandError> {
    match to.iter().all(|c| c.is_finite()) {
        true => Ok(to.into()),
        false => Err(HandError::Target { to }),
    }
}

impl Potential for Hand {
    fn energy(&self, at: At<'_>) -> f64 {
        0.5 * self.stiffness * self.stretch(at).norm_squared()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let force = self.stiffness * self.stretch(at);
        let row = &mut gradient.as_chunks_mut::<3>().0[self.vertex.index()];
        for k in 0..3 {
            row[k] += force[k];
        }
    }

    fn add_hessian(&self, _at: At<'_>, hessian: &mut dyn HessianSink) {
        let block = Matrix3::from_diagonal_element(self.stiffness);
        hessian.add_vertex(self.vertex, &block);
    }

    fn is_driven(&self) -> bool {
        true
    }

    fn remembering(&self) -> Option<&dyn Remembering> {
        Some(self)
    }
}

impl Remembering for Hand {
    /// The way that it is led.
    fn memory(&self) -> Vec<f64> {
        self.way(&[]).numbers().to_vec()
    }

    fn held_vertex(&self) -> Option<VertexId> {
        Some(self.vertex)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{EdgeId, Sheet, generate};

    const CORNER: VertexId = VertexId(20);

    fn sheet() -> Sheet {
        generate::isotropic_square(1, 0.2).expect("a mesh")
    }

    fn hand(sheet: &Sheet, stiffness: f64) -> Hand {
        let at = sheet.position(CORNER);
        Hand::new(sheet.topology(), CORNER, stiffness, at).expect("a hand")
    }

    struct Blocks(Vec<(VertexId, Matrix3<f64>)>);

    impl HessianSink for Blocks {
        fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
            self.0.push((v, *block));
        }

        fn add_edge(&mut self, e: EdgeId, _block: &Matrix3<f64>) {
            panic!("a block at {e}");
        }

        fn add_pair(&mut self, a: VertexId, b: VertexId, _block: &Matrix3<f64>) {
            panic!("a block at {a} and {b}");
        }
    }

    /// The energy is quadratic: central differences have no error but round-off.
    #[test]
    fn derivatives_match_differences() {
        let sheet = sheet();
        let hand = hand(&sheet, 7.0);
        let mut memory = hand.memory();
        hand.lead([0.4, -0.1, 0.3], [1.0, 2.0], &mut memory)
            .expect("finite");
        let x = sheet.positions().to_vec();
        fn at<'a>(x: &'a [f64], memory: &'a [f64]) -> At<'a> {
            At::new(1.25, x).with_memory(memory)
        }
        let gradient = |x: &[f64]| {
            let mut gradient = vec![0.0; x.len()];
            hand.add_gradient(at(x, &memory), &mut gradient);
            gradient
        };
        let mut blocks = Blocks(Vec::new());
        hand.add_hessian(at(&x, &memory), &mut blocks);
        let [(vertex, block)] = blocks.0[..] else {
            panic!("{} blocks", blocks.0.len());
        };
        assert_eq!(vertex, CORNER);
        let slope = gradient(&x);
        for i in 0..x.len() {
            let (mut up, mut down) = (x.clone(), x.clone());
            up[i] += 0.5;
            down[i] -= 0.5;
            let difference = hand.energy(at(&up, &memory)) - hand.energy(at(&down, &memory));
            assert!((difference - slope[i]).abs() < 1e-13, "coordinate {i}");
            for (j, (a, b)) in gradient(&up).iter().zip(gradient(&down)).enumerate() {
                let first = 3 * CORNER.index();
                let own = first..first + 3;
                let is_inside = own.contains(&i) && own.contains(&j);
                let want = if is_inside {
                    block[(i - first, j - first)]
                } else {
                    0.0
                };
                assert!((a - b - want).abs() < 1e-13, "coordinates {i}, {j}");
            }
        }
    }

    #[test]
    fn the_way_is_straight_and_begins_where_the_hand_is() {
        let hand = hand(&sheet(), 1.0);
        let mut memory = hand.memory();
        let start = hand.target(3.0, &memory);
        let to = start + Vector3::new(0.0, 0.0, 0.4);
        hand.lead(to.into(), [1.0, 3.0], &mut memory)
            .expect("finite");
        let at = |t: f64, memory: &[f64]| hand.target(t, memory) - start;
        assert_eq!(at(0.5, &memory), Vector3::zeros());
        assert!((at(1.5, &memory) - Vector3::new(0.0, 0.0, 0.1)).norm() < 1e-15);
        assert_eq!(hand.target(5.0, &memory), to);
        // On the way it is led back, from where it is.
        hand.lead(start.into(), [2.0, 2.5], &mut memory)
            .expect("finite");
        assert!((at(2.0, &memory) - Vector3::new(0.0, 0.0, 0.2)).norm() < 1e-15);
        assert!((at(2.25, &memory) - Vector3::new(0.0, 0.0, 0.1)).norm() < 1e-15);
        let error = hand.lead([0.0, f64::NAN, 0.0], [0.0, 1.0], &mut memory);
        assert!(matches!(error, Err(HandError::Target { .. })), "{error:?}");
        assert_eq!(hand.target(9.0, &memory), start);
    }

    #[test]
    fn arguments_without_a_meaning_are_refused() {
        let sheet = sheet();
        let new = |vertex, stiffness, x| {
            Hand::new(sheet.topology(), VertexId(vertex), stiffness, [x, 0.0, 0.0]).map(drop)
        };
        assert!(matches!(
            new(9999, 1.0, 0.0),
            Err(HandError::NoSuchVertex { .. })
        ));
        for stiffness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                new(0, stiffness, 0.0),
                Err(HandError::Stiffness { .. })
            ));
        }
        assert!(matches!(
            new(0, 1.0, f64::NAN),
            Err(HandError::Target { .. })
        ));
    }
}
