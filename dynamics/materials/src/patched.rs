//! What differs from face to face of a sheet.

use isosheet_mesh::{Advice, FaceId};

/// Something that a sheet has everywhere, and patches that have another: laws, yields, densities.
#[derive(Debug, Clone, PartialEq)]
pub struct Patched<L> {
    ground: L,
    patches: Vec<(Vec<FaceId>, L)>,
}

/// A patch has a face that the sheet has not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{face} is named as one of a patch, but the sheet has {count} faces")]
pub struct NoFace {
    /// The face.
    pub face: FaceId,
    /// Number of faces.
    pub count: usize,
}

impl Advice for NoFace {
    fn advice(&self) -> Option<&'static str> {
        Some("name faces of this sheet")
    }
}

impl<L> Patched<L> {
    /// One `ground` everywhere, without patches.
    pub fn everywhere(ground: L) -> Self {
        let patches = Vec::new();
        Self { ground, patches }
    }

    /// With a patch of some faces; where patches overlap the last one counts.
    #[must_use]
    pub fn with_patch(mut self, faces: Vec<FaceId>, own: L) -> Self {
        self.patches.push((faces, own));
        self
    }

    /// What the sheet has outside of the patches.
    pub fn ground(&self) -> &L {
        &self.ground
    }

    /// The values that `make` gives for the ground and for each patch, on the same faces.
    pub fn map<M>(&self, make: impl Fn(&L) -> M) -> Patched<M> {
        let patches = self.patches.iter();
        let patches = patches.map(|(faces, own)| (faces.clone(), make(own)));
        Patched {
            ground: make(&self.ground),
            patches: patches.collect(),
        }
    }

    /// All of them, that outside of the patches first.
    pub fn all(&self) -> impl Iterator<Item = &L> {
        std::iter::once(&self.ground).chain(self.patches.iter().map(|(_, own)| own))
    }

    /// Whether one value is for all faces.
    pub(crate) fn is_uniform(&self) -> bool {
        self.patches.is_empty()
    }

    /// What each of the first `count` faces has.
    ///
    /// # Errors
    /// [`NoFace`].
    pub fn of_faces(&self, count: usize) -> Result<Vec<&L>, NoFace> {
        let mut all = vec![&self.ground; count];
        for (faces, own) in &self.patches {
            for &face in faces {
                *all.get_mut(face.index()).ok_or(NoFace { face, count })? = own;
            }
        }
        Ok(all)
    }
}
