//! Repairs that are made only on request.

use std::collections::VecDeque;

use crate::build::{check_faces, sorted_sides};
use crate::{FaceId, TopologyError, VertexId};

/// Reverses faces so that neighbours run along their common edge in opposite directions.
///
/// Faces are visited breadth first from the lowest face of every component. In each component the winding of
/// the majority stays (that of its lowest face on a tie), so as few faces as possible are reversed. A
/// reversed face `[a, b, c]` becomes `[a, c, b]`.
///
/// Returns the reversed faces, ascending; empty when nothing was wrong.
///
/// ```
/// let mut faces = [[0, 1, 2], [0, 3, 2], [0, 3, 4]];
/// let reversed = isosheet_mesh::orient_consistently(5, &mut faces)?;
/// assert_eq!(reversed, [isosheet_mesh::FaceId(1)]);
/// assert_eq!(faces[1], [0, 2, 3]);
/// # Ok::<(), isosheet_mesh::TopologyError>(())
/// ```
///
/// # Errors
/// [`TopologyError::NonOrientable`] for a Moebius band and its like, [`TopologyError::NonManifoldEdge`] where
/// more than two faces meet, and what is wrong with single faces (index out of range, repeated vertex,
/// duplicate). The faces are then unchanged.
pub fn orient_consistently(
    vertex_count: usize,
    faces: &mut [[u32; 3]],
) -> Result<Vec<FaceId>, TopologyError> {
    check_faces(vertex_count, faces)?;
    // The neighbour at side i of a face: the other face, and whether the two windings agree.
    let mut neighbours: Vec<[Option<(u32, bool)>; 3]> = vec![[None; 3]; faces.len()];
    for group in sorted_sides(faces).chunk_by(|s, t| (s.low, s.high) == (t.low, t.high)) {
        match group {
            [_] => {}
            [s, t] => {
                let agree = s.reversed != t.reversed;
                neighbours[s.face as usize][s.corner as usize] = Some((t.face, agree));
                neighbours[t.face as usize][t.corner as usize] = Some((s.face, agree));
            }
            _ => {
                return Err(TopologyError::NonManifoldEdge {
                    a: VertexId(group[0].low),
                    b: VertexId(group[0].high),
                    count: group.len(),
                    faces: [0, 1, 2].map(|k| FaceId(group[k].face)),
                });
            }
        }
    }

    // None: not visited; Some(flip): whether the face differs from the first face of its component.
    let mut flip: Vec<Option<bool>> = vec![None; faces.len()];
    let mut reversed = Vec::new();
    let mut queue = VecDeque::new();
    for seed in 0..faces.len() {
        if flip[seed].is_some() {
            continue;
        }
        flip[seed] = Some(false);
        queue.push_back(seed);
        let mut component = Vec::new();
        while let Some(f) = queue.pop_front() {
            let mine = flip[f] == Some(true);
            component.push((f, mine));
            for &(g, agree) in neighbours[f].iter().flatten() {
                // Agreeing neighbours share the flag, disagreeing ones have opposite flags.
                let want = mine == agree;
                match flip[g as usize] {
                    None => {
                        flip[g as usize] = Some(want);
                        queue.push_back(g as usize);
                    }
                    Some(found) if found != want => {
                        return Err(TopologyError::NonOrientable { face: FaceId(g) });
                    }
                    Some(_) => {}
                }
            }
        }
        let count = component.iter().filter(|c| c.1).count();
        let minority = 2 * count <= component.len();
        reversed.extend(
            component
                .into_iter()
                .filter(|c| c.1 == minority)
                .map(|c| FaceId::from_index(c.0)),
        );
    }
    reversed.sort_unstable();
    for f in &reversed {
        faces[f.index()].swap(1, 2);
    }
    Ok(reversed)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::Topology;
    use crate::tests::surfaces::{moebius, surfaces};

    #[test]
    fn a_moebius_band_is_refused() {
        for n in [5, 7, 11] {
            let (count, mut faces) = moebius(n);
            let before = faces.clone();
            assert!(matches!(
                orient_consistently(count, &mut faces),
                Err(TopologyError::NonOrientable { .. })
            ));
            assert_eq!(faces, before, "left unchanged");
            assert!(matches!(
                Topology::from_faces(count, &faces),
                Err(TopologyError::InconsistentWinding { .. })
            ));
        }
    }

    #[test]
    fn a_third_face_is_refused() {
        let mut faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        assert!(matches!(
            orient_consistently(5, &mut faces),
            Err(TopologyError::NonManifoldEdge { count: 3, .. })
        ));
        assert!(matches!(
            orient_consistently(2, &mut faces),
            Err(TopologyError::IndexOutOfRange { .. })
        ));
    }

    proptest! {
        #![proptest_config(isosheet_random::cases(256))]

        /// Any faces of an oriented surface may be turned over: repair finds an oriented surface again,
        /// turning at most half of each component, and calling it twice changes nothing.
        #[test]
        fn turned_faces_are_turned_back((n, faces) in surfaces(), seed in any::<u64>()) {
            let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
            let mut broken = faces.clone();
            for f in &mut broken {
                if rng.random_bool(0.3) {
                    f.swap(0, 1);
                }
            }
            let given = broken.clone();
            let reversed = orient_consistently(n, &mut broken).unwrap();
            let t = Topology::from_faces(n, &broken).unwrap();
            t.check_invariants();
            let mut turned = vec![0; t.component_count()];
            let mut size = vec![0; t.component_count()];
            for (k, (a, b)) in given.iter().zip(&broken).enumerate() {
                let c = t.vertex_component(VertexId(a[0]));
                size[c] += 1;
                turned[c] += usize::from(a != b);
                prop_assert_eq!(a != b, reversed.contains(&FaceId::from_index(k)));
            }
            prop_assert!(turned.iter().zip(&size).all(|(t, s)| 2 * t <= *s));
            prop_assert!(orient_consistently(n, &mut broken).unwrap().is_empty());
        }
    }
}
