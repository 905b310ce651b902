//! How the lines are drawn that edges of a FOLD file follow: the keys `isosheet:lines` of a frame, a list of
//! colours (`"#rrggbb"`), dashes and layers, and `edges_isosheet:lines`, of each edge the numbers of its
//! lines in that list.

use crate::mesh_file::FileCrease;
use isosheet_drawings::{Colour, DrawnLines, Pen};
use isosheet_files::DataError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// How a line is drawn.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct LineRecord {
    colour: String,
    #[serde(default)]
    dashed: bool,
    #[serde(default)]
    layers: Vec<String>,
}

impl From<&Pen> for LineRecord {
    fn from(pen: &Pen) -> Self {
        let Colour([r, g, b]) = pen.colour;
        Self {
            colour: format!("#{r:02x}{g:02x}{b:02x}"),
            dashed: pen.dashed,
            layers: pen.layers.clone(),
        }
    }
}

impl LineRecord {
    fn pen(&self, line: usize) -> Result<Pen, DataError> {
        let colour = Colour::parse(&self.colour).ok_or_else(|| {
            let message = format!("line {line} of `isosheet:lines` has no colour that is known");
            DataError::new(message, "write it as \"#rrggbb\"").at(line)
        })?;
        Ok(Pen {
            colour,
            dashed: self.dashed,
            opacity: 1.0,
            layers: self.layers.clone(),
        })
    }
}

/// The lines of a frame; says of its edges which they follow.
pub(super) fn read(
    lines: &[LineRecord],
    of_edges: &[Vec<usize>],
    edges: &mut [FileCrease],
) -> Result<DrawnLines, DataError> {
    if of_edges.is_empty() {
        return Ok(DrawnLines::default());
    }
    if of_edges.len() != edges.len() {
        let message = format!(
            "`edges_isosheet:lines` has {} entries for {} edges",
            of_edges.len(),
            edges.len()
        );
        return Err(DataError::new(message, "give one for each edge"));
    }
    let pens = lines.iter().enumerate().map(|(k, line)| line.pen(k));
    let (mut drawn, numbers) = DrawnLines::of_pens(&pens.collect::<Result<Vec<_>, _>>()?);
    for (edge, (crease, of_edge)) in edges.iter_mut().zip(of_edges).enumerate() {
        if let Some(line) = of_edge.iter().find(|line| **line >= lines.len()) {
            let message = format!(
                "edge {edge} follows line {line} of `isosheet:lines`, which has {}, counted from 0",
                lines.len()
            );
            return Err(DataError::new(message, "correct `edges_isosheet:lines`").at(edge));
        }
        let pens: BTreeSet<usize> = of_edge.iter().map(|line| numbers[*line]).collect();
        crease.drawn = (!pens.is_empty()).then(|| drawn.set(pens));
    }
    Ok(drawn)
}

#[cfg(test)]
mod tests {
    use crate::mesh_file::MeshFormat;
    use crate::mesh_file::tests::{parse, refuses};

    /// The lines of a drawing that edges follow are written and read, and cuts and welds keep them.
    #[test]
    fn edges_know_the_lines_of_their_drawing() {
        let text = r##"{"vertices_coords": [[0,0],[1,0],[1,1],[0,1]], "faces_vertices": [[0,1,2],[0,2,3]],
        "edges_vertices": [[0,1],[1,2],[2,3],[3,0],[0,2]], "edges_assignment": ["B","B","B","B","V"],
        "edges_foldAngle": [null,null,null,null,90],
        "isosheet:lines": [{"colour": "#000000"}, {"colour": "#e6007e", "dashed": true, "layers": ["Wing", "Box"]}],
        "edges_isosheet:lines": [[0],[0],[0],[0],[1]]}"##;
        let mesh = parse(MeshFormat::Fold, text.as_bytes()).unwrap();
        let name = |mesh: &crate::MeshFile, k: usize| {
            mesh.drawn.name(mesh.creases[k].drawn).map(str::to_owned)
        };
        assert_eq!(
            (name(&mesh, 4).as_deref(), name(&mesh, 0)),
            (Some("Wing"), None)
        );
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("again.fold");
        crate::write_mesh(&path, &mesh).unwrap();
        let again = crate::read_mesh(&path).unwrap();
        assert_eq!((&again.drawn, &again.creases), (&mesh.drawn, &mesh.creases));
        let wrong = |from: &str, to: &str, says: &str| {
            refuses(
                MeshFormat::Fold,
                text.replace(from, to).as_bytes(),
                None,
                says,
            );
        };
        wrong(
            "[1]]",
            "[2]]",
            "edge 4 follows line 2 of `isosheet:lines`, which has 2",
        );
        wrong(
            "[[0],",
            "[",
            "`edges_isosheet:lines` has 4 entries for 5 edges",
        );
        wrong(
            "#000000",
            "soot",
            "line 0 of `isosheet:lines` has no colour",
        );
    }
}
