//! The sheets of a series that has several in one mesh.

use super::ExportError;
use super::error::check_count;
use isosheet_mesh::Part;
use std::ops::Range;

/// A sheet in the mesh of a series, with a name that all formats take.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NamedPart {
    pub(super) name: String,
    pub(super) part: Part,
}

impl NamedPart {
    /// The sheets of a mesh with numbers of vertices, edges and faces, named by identifiers.
    ///
    /// # Errors
    /// [`ExportError::Data`] if they are not the whole mesh, one after the other.
    pub(super) fn all(
        sheets: &[(String, Part)],
        counts: [usize; 3],
    ) -> Result<Vec<Self>, ExportError> {
        let ranges: [fn(&Part) -> &Range<usize>; 3] = [|p| &p.vertices, |p| &p.edges, |p| &p.faces];
        for ((range, expected), what) in ranges
            .iter()
            .zip(counts)
            .zip(["vertices", "edges", "faces"])
        {
            let follow = |end: usize, part: &Range<usize>| (part.start == end).then_some(part.end);
            let end = sheets
                .iter()
                .map(|(_, part)| range(part))
                .try_fold(0, follow);
            let what = format!("{what} of the sheets, one after the other,");
            check_count(&what, end.unwrap_or_default(), expected)?;
        }
        let mut named: Vec<Self> = Vec::new();
        for (k, (name, part)) in sheets.iter().enumerate() {
            let plain = identifier(name);
            let (mut name, mut number) = (plain.clone(), k);
            while named.iter().any(|sheet| sheet.name == name) {
                name = format!("{plain}_{number}");
                number += 1;
            }
            let part = part.clone();
            named.push(Self { name, part });
        }
        Ok(named)
    }
}

/// A name of ASCII letters, digits and `_` that begins neither with a digit nor as names of bodies do.
fn identifier(name: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let plain: String = name
        .chars()
        .map(|c| if is_plain(c) { c } else { '_' })
        .collect();
    let is_other = plain.is_empty()
        || plain.starts_with(|c: char| c.is_ascii_digit())
        || plain.starts_with("obstacle_");
    match is_other {
        true => format!("_{plain}"),
        false => plain,
    }
}

#[cfg(test)]
mod tests {
    use super::NamedPart;
    use crate::Trajectory;
    use crate::{Series, SeriesOptions, read_mesh, write_series};
    use isosheet_mesh::{Part, Sheet, generate};
    use std::fs;

    /// Two squares, the second one above the first and finer, in three frames.
    fn stacked() -> (Vec<(String, Part)>, Trajectory) {
        let [below, above] = [0, 1].map(|level| generate::isotropic_square(level, 0.5).unwrap());
        let union = Sheet::union(&[&below, &above]).unwrap();
        let parts = Part::of_union(&[&below, &above]);
        let names = ["top cover", "9"].map(str::to_owned);
        let first = parts[1].vertices.start;
        let mut trajectory = Trajectory::new(&union);
        for k in 0..3 {
            let mut x = union.positions().to_vec();
            for p in &mut x.as_chunks_mut::<3>().0[first..] {
                p[2] = 0.25 + 0.125 * f64::from(k);
            }
            trajectory.push(f64::from(k), &x).unwrap();
        }
        (names.into_iter().zip(parts).collect(), trajectory)
    }

    #[test]
    fn several_sheets_have_their_names() {
        let (sheets, trajectory) = stacked();
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        let options = SeriesOptions::default();
        let series = Series::new(&trajectory, &options).unwrap();
        let series = series.with_sheets(&sheets).unwrap();
        for name in ["run.obj", "run.glb", "run.usda", "run.pvd", "run.pc2"] {
            write_series(&file(name), &series).unwrap();
        }
        // OBJ: one mesh as before, and a group before the first face of each sheet.
        let mesh = read_mesh(&file("run/frame_00002.obj")).unwrap();
        assert_eq!(mesh.faces, trajectory.faces());
        let text = fs::read_to_string(file("run/frame_00002.obj")).unwrap();
        let faces = |text: &str| text.lines().filter(|l| l.starts_with("f ")).count();
        let (before, after) = text.split_once("g _9\n").unwrap();
        assert_eq!([before, after].map(faces), [8, 32]);
        assert_eq!(before.matches("g top_cover\n").count(), 1);
        assert!(
            fs::read_to_string(file("run.obj"))
                .unwrap()
                .contains("g _9\n")
        );

        // glTF: a node with a mesh and its own vertices for each sheet, moved by the same weights.
        let ::gltf::Gltf { document, blob } = ::gltf::Gltf::open(file("run.glb")).unwrap();
        let names = document.nodes().map(|n| n.name().unwrap().to_owned());
        let expected = ["top_cover", "_9"];
        assert_eq!(names.collect::<Vec<_>>(), expected);
        let (blob, x) = (
            blob.unwrap(),
            trajectory.frame(2).unwrap().as_chunks::<3>().0,
        );
        for (k, (_, part)) in sheets.iter().enumerate() {
            let mesh = document.nodes().nth(k).unwrap().mesh().unwrap();
            let primitive = mesh.primitives().next().unwrap();
            let reader = primitive.reader(|_| Some(&blob));
            let base: Vec<_> = reader.read_positions().unwrap().collect();
            let target = reader.read_morph_targets().nth(1).unwrap().0.unwrap();
            for ((p, d), q) in base.iter().zip(target).zip(&x[part.vertices.clone()]) {
                // The format has y upwards.
                let found = [p[0] + d[0], -(p[2] + d[2]), p[1] + d[1]];
                assert_eq!(found.map(f64::from), *q);
            }
            assert_eq!(base.len(), part.vertices.len());
            let corners = reader.read_indices().unwrap().into_u32();
            let corners: Vec<u32> = corners.collect();
            assert_eq!(corners.len(), 3 * part.faces.len());
            assert_eq!(
                corners.into_iter().max(),
                Some(part.vertices.len() as u32 - 1)
            );
        }
        let animation = document.animations().next().unwrap();
        let targets = animation
            .channels()
            .map(|c| (c.target().node().index(), c.sampler().index()));
        assert_eq!(targets.collect::<Vec<_>>(), [(0, 0), (1, 0)]);

        let text = fs::read_to_string(file("run.usda")).unwrap();
        for name in expected {
            assert_eq!(text.matches(&format!("def Mesh \"{name}\"")).count(), 1);
        }
        let frame = fs::read(file("run/frame_00000.vtp")).unwrap();
        assert!(String::from_utf8_lossy(&frame).contains("Name=\"sheet\""));

        // Sheets that are not the whole mesh are refused.
        let wrong = series.clone().with_sheets(&sheets[..1]).unwrap_err();
        let wrong = wrong.to_string();
        assert!(wrong.contains("9 values, 34 are needed"), "{wrong}");
        let [first, second] = [0, 1].map(|k| sheets[k].clone());
        let wrong = series.clone().with_sheets(&[second, first]).unwrap_err();
        assert!(wrong.to_string().contains("there are 0 values"), "{wrong}");
    }

    #[test]
    fn names_are_identifiers_of_their_own() {
        let part = Part::default();
        let names = ["a_b_2", "a b", "a_b", "a-b", "", "obstacle_0"];
        let sheets = names.map(|name| (name.to_owned(), part.clone()));
        let named = NamedPart::all(&sheets, [0; 3]).unwrap();
        let names: Vec<&str> = named.iter().map(|sheet| &*sheet.name).collect();
        let expected = ["a_b_2", "a_b", "a_b_3", "a_b_4", "_", "_obstacle_0"];
        assert_eq!(names, expected);
    }
}
