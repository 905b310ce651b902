//! Lines and dots of a picture.

use super::canvas::light;
use super::drawing::{Corner, Stroke};
use super::sheet::{GRAIN, INK, Painter, SheetPicture};
use super::solid::Triangles;
use isosheet_mesh::vec3::axpy;
use isosheet_mesh::{EdgeId, Topology, VertexId};
use std::collections::HashSet;

/// How far lines are drawn in front of what they lie on, as part of what the picture shows.
const LIFT: f64 = 0.004;

/// How far edges of bodies are drawn behind what lies on them, pixels.
const SINK: f64 = 2.0;

/// Edges within a sheet are not drawn where they are shorter than the first of so many pixels in the mean,
/// and in full where they are longer than the second: fine meshes look like a sheet.
const FADING: [f64; 2] = [10.0, 30.0];

/// The width of dots, as part of the mean length of edges in the picture, and its bounds, pixels.
const DOT: f64 = 0.4;
const SMALLEST_DOT: f64 = 2.0;
const LARGEST_DOT: f64 = 9.0;

/// The width of bars, as part of the mean length of edges in the picture, and its bounds, as parts of the
/// height of the picture.
const BAR_OF_EDGE: f64 = 1.0 / 6.0;
const BAR: [f64; 2] = [1.0 / 480.0, 1.0 / 160.0];

impl Painter<'_> {
    /// Edges of bodies and of the sheet.
    pub(super) fn wires(
        &self,
        topology: &Topology,
        creases: &[EdgeId],
        scene: &Triangles,
    ) -> Vec<Stroke> {
        let stroke = |ends: [[f64; 3]; 2], vertices: [usize; 2], width: f64, cover: f64| Stroke {
            ends: ends.map(|p| self.corner(&p, light(INK))),
            vertices,
            width: width * self.look.wire,
            cover: cover as f32,
            lift: LIFT * self.scale,
            sink: 0.0,
        };
        let cutter = self.cutter(GRAIN);
        let mut strokes = Vec::new();
        for (vertices, skin) in &scene.ridges {
            let parts = cutter.parts(vertices.map(|v| scene.x[v]), skin).into_iter();
            strokes.extend(parts.map(|ends| Stroke {
                sink: SINK * self.scale / self.size[1],
                ..stroke(ends, *vertices, 1.0, 0.8)
            }));
        }
        let edges = self.seen_edges(topology, scene);
        let is_crease: HashSet<[usize; 2]> = creases
            .iter()
            .map(|e| topology.edges()[e.index()].map(VertexId::index))
            .collect();
        let mean = self.mean_length(&edges, scene);
        let [none, full] = FADING;
        let inner = 0.55 * ((mean - none) / (full - none)).clamp(0.0, 1.0);
        strokes.extend(edges.iter().map(|(vertices, is_boundary)| {
            let ends = vertices.map(|v| scene.x[v]);
            if *is_boundary {
                stroke(ends, *vertices, 1.7, 0.9)
            } else if is_crease.contains(vertices) {
                stroke(ends, *vertices, 1.4, 0.8)
            } else {
                stroke(ends, *vertices, 1.0, inner)
            }
        }));
        strokes
    }

    /// The edges of the sheet that are not behind the camera, and whether they are of its boundary.
    fn seen_edges(&self, topology: &Topology, scene: &Triangles) -> Vec<([usize; 2], bool)> {
        let seen =
            |vertices: &[usize; 2]| !vertices.iter().any(|v| self.camera.is_behind(&scene.x[*v]));
        let edges = topology.edge_ids().map(|e| {
            let ends = topology.edges()[e.index()].map(VertexId::index);
            (ends, topology.is_boundary_edge(e))
        });
        edges.filter(|(ends, _)| seen(ends)).collect()
    }

    /// The mean length of edges in the picture, pixels.
    fn mean_length(&self, edges: &[([usize; 2], bool)], scene: &Triangles) -> f64 {
        let length = |(ends, _): &([usize; 2], bool)| {
            let [a, b] = ends.map(|v| self.place(&scene.x[v]));
            (b[0] - a[0]).hypot(b[1] - a[1])
        };
        edges.iter().map(length).sum::<f64>() / edges.len().max(1) as f64
    }

    /// Bars along edges that show values, and on top of these dots.
    pub(super) fn marks(&self, picture: &SheetPicture<'_>, scene: &Triangles) -> Vec<Stroke> {
        let mean = self.mean_length(&self.seen_edges(picture.topology, scene), scene);
        let mut marks = self.bars(picture, mean, scene);
        marks.extend(self.dots(picture, mean, scene));
        marks
    }

    /// Bars along edges, thinner where the mesh is finer; bars nearer to the viewer come last.
    fn bars(&self, picture: &SheetPicture<'_>, mean: f64, scene: &Triangles) -> Vec<Stroke> {
        let Some(colours) = picture.colours else {
            return Vec::new();
        };
        let [thinnest, widest] = BAR.map(|part| part * self.size[1]);
        let width = (BAR_OF_EDGE * mean).clamp(thinnest, widest);
        let topology = picture.topology;
        let bar = |e: EdgeId| {
            let vertices = topology.edges()[e.index()].map(VertexId::index);
            let ends = vertices.map(|v| scene.x[v]);
            let colour = light(colours.of_edge(e)?);
            (!ends.iter().any(|p| self.camera.is_behind(p))).then(|| Stroke {
                ends: ends.map(|p| self.corner(&p, colour)),
                vertices,
                width,
                cover: 1.0,
                lift: LIFT * self.scale,
                sink: 0.0,
            })
        };
        let mut bars: Vec<Stroke> = topology.edge_ids().filter_map(bar).collect();
        let nearness = |bar: &Stroke| bar.ends[0].nearness + bar.ends[1].nearness;
        bars.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)));
        bars
    }

    /// Dots with a rim, smaller where the mesh is finer.
    fn dots(&self, picture: &SheetPicture<'_>, mean: f64, scene: &Triangles) -> Vec<Stroke> {
        let mut strokes = Vec::new();
        let widest = (DOT * mean).clamp(SMALLEST_DOT, LARGEST_DOT);
        for (v, colour) in picture.dots() {
            let vertex = v.index();
            let p = &scene.x[vertex];
            if self.camera.is_behind(p) {
                continue;
            }
            let raised = axpy(p, 3.0 * LIFT * self.scale, self.camera.viewer(p));
            for (width, colour) in [(widest, INK), (widest * 2.0 / 3.0, colour)] {
                let [x, y, _] = self.place(p);
                let end = Corner {
                    x,
                    y,
                    ..self.corner(&raised, light(colour))
                };
                strokes.push(Stroke {
                    ends: [end; 2],
                    vertices: [vertex; 2],
                    width,
                    cover: 1.0,
                    lift: 0.0,
                    sink: 0.0,
                });
            }
        }
        strokes
    }
}

#[cfg(test)]
mod tests {
    use super::super::sheet::{Look, SheetPicture, render_folded};
    use crate::Camera;
    use isosheet_mesh::generate::{Diagonals, grid};
    use isosheet_mesh::{EdgeId, VertexId};

    /// A fine mesh is drawn without its edges, and with the line in its middle along which it folds.
    #[test]
    fn creases_are_drawn_on_fine_meshes() {
        let sheet = grid(40, 40, 1.0, 1.0, Diagonals::UnionJack).unwrap();
        let t = sheet.topology();
        let middle = |v: &VertexId| (sheet.position(*v)[0] - 0.5).abs() < 1e-9;
        let creases: Vec<EdgeId> = t
            .edge_ids()
            .filter(|e| t.edges()[e.index()].iter().all(middle))
            .collect();
        assert_eq!(creases.len(), 40);
        let picture = SheetPicture::of(t, sheet.positions());
        let camera = Camera::new([0.5, 0.5, 0.0], -90.0, 90.0, 1.25, 100.0);
        let look = Look {
            size: [125, 125],
            wire: 1.5,
            ..Look::default()
        };
        let row = |creases: &[EdgeId]| {
            let image = render_folded(&picture, creases, &camera, &look).unwrap();
            // What is dark, from side to side of the sheet and without its boundary.
            let row = &image.pixels[62 * 125..63 * 125];
            let dark = (20..105).filter(|x| row[*x][0] < 0.4);
            dark.collect::<Vec<usize>>()
        };
        assert!(row(&[]).is_empty());
        let line = row(&creases);
        assert!(
            !line.is_empty() && line.iter().all(|x| (60..=64).contains(x)),
            "{line:?}"
        );
        let none = EdgeId::from_index(t.edge_count());
        assert!(render_folded(&picture, &[none], &camera, &look).is_err());
    }
}
