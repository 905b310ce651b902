use super::*;

/// Two squares of two faces each, with fronts to the same side, the first with the vertices 0 to 3, the
/// second with 4 to 7.
fn two_squares() -> Topology {
    Topology::from_faces(8, &[[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]).expect("two squares")
}

fn loaded(faces: &[u32], joined: &[[u32; 2]]) -> Result<LoadedFaces, LoadedFacesError> {
    let faces: Vec<FaceId> = faces.iter().map(|f| FaceId(*f)).collect();
    let joined: Vec<_> = joined.iter().map(|pair| pair.map(VertexId)).collect();
    LoadedFaces::new(&two_squares(), &faces, &joined)
}

/// Of a pillow one side is turned over and nothing is left open; a square that continues another one stays as
/// it is.
#[test]
fn seams_give_a_common_front() {
    let all = [0, 1, 2, 3];
    let pillow = loaded(&all, &[[0, 4], [1, 5], [2, 6], [3, 7]]).expect("a pillow");
    assert!(pillow.rim().is_empty());
    let corners: Vec<_> = pillow
        .corners
        .iter()
        .map(|c| c.vertices.map(|v| v.0))
        .collect();
    assert_eq!(corners, [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]);
    for face in &pillow.corners {
        for (k, side) in face.sides.iter().enumerate() {
            let mut ends = two_squares().edges()[side.edge.index()];
            if !side.is_forward {
                ends.reverse();
            }
            assert_eq!(ends, face.ends(k));
        }
    }
    let strip = loaded(&all, &[[1, 4], [2, 7]]).expect("a strip");
    assert_eq!(strip.rim().len(), 6);
    assert_eq!(strip.corners[2].vertices, [4, 5, 6].map(VertexId));
}

#[test]
fn what_cannot_be_used_is_named() {
    assert_eq!(loaded(&[], &[]).err(), Some(LoadedFacesError::Empty));
    let missing = loaded(&[0, 9], &[]).err();
    assert!(matches!(missing, Some(LoadedFacesError::NoSuchFace { .. })));
    // A band with half a turn has one side.
    let band = loaded(&[0, 1, 2, 3], &[[1, 4], [2, 7], [5, 3], [6, 0]]).err();
    assert!(
        matches!(band, Some(LoadedFacesError::OneSided { .. })),
        "{band:?}"
    );
}
