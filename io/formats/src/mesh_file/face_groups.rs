//! Groups of faces that a mesh file names.

use std::collections::BTreeMap;

/// Groups of faces by their names. A face may belong to several.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FaceGroups(BTreeMap<String, Vec<u32>>);

impl FaceGroups {
    /// Adds a face, whose number is not below any number of a face in the group.
    pub(crate) fn add(&mut self, group: &str, face: u32) {
        match self.0.get_mut(group) {
            Some(faces) if faces.last() == Some(&face) => {}
            Some(faces) => faces.push(face),
            None => {
                self.0.insert(group.to_owned(), vec![face]);
            }
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The faces of a group by their numbers from 0, ascending; `None` if no face belongs to it.
    pub fn faces(&self, group: &str) -> Option<&[u32]> {
        self.0.get(group).map(Vec::as_slice)
    }

    /// The groups with their faces, in the order of their names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &[u32])> {
        self.0.iter().map(|(name, faces)| (&**name, &**faces))
    }

    /// The groups of other faces, each of which is, or is a part of, the face whose number `origin` has at
    /// its place.
    pub fn of_parts(&self, origin: &[u32]) -> Self {
        if self.is_empty() {
            return Self::default();
        }
        let mut parts: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (part, &face) in (0..).zip(origin) {
            parts.entry(face).or_default().push(part);
        }
        let of_group = |(name, faces): (&String, &Vec<u32>)| {
            let mut own: Vec<u32> = faces
                .iter()
                .filter_map(|f| parts.get(f))
                .flatten()
                .copied()
                .collect();
            own.sort_unstable();
            (!own.is_empty()).then(|| (name.clone(), own))
        };
        Self(self.0.iter().filter_map(of_group).collect())
    }

    /// The groups of several meshes in one, each with the number of its first face there, ascending.
    pub fn union<'a>(meshes: impl IntoIterator<Item = (&'a Self, usize)>) -> Self {
        let mut union = Self::default();
        for (own, first) in meshes {
            for (name, faces) in own.iter() {
                for face in faces {
                    union.add(name, first as u32 + face);
                }
            }
        }
        union
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of five faces three stay, of which the last is cut in two.
    #[test]
    fn parts_belong_to_the_groups_of_their_faces() {
        let mut groups = FaceGroups::default();
        for (group, face) in [
            ("hem", 0),
            ("all", 0),
            ("hem", 0),
            ("hem", 3),
            ("gone", 1),
            ("all", 3),
            ("all", 4),
        ] {
            groups.add(group, face);
        }
        assert_eq!(groups.faces("hem"), Some(&[0, 3][..]));
        let parts = groups.of_parts(&[4, 0, 3, 3]);
        assert_eq!(parts.faces("hem"), Some(&[1, 2, 3][..]));
        assert_eq!(parts.faces("all"), Some(&[0, 1, 2, 3][..]));
        assert_eq!(parts.faces("gone"), None);
        assert_eq!(parts.iter().count(), 2);
    }
}
