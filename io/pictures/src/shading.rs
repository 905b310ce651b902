//! Pieces of a picture in their light.

use super::camera::{Camera, normal};
use super::canvas::{Light, light};
use super::colours::Colours;
use super::drawing::{Corner, Facet};
use super::occlusion::{Occlusion, Surroundings};
use super::pieces::Piece;
use super::raster::seen;
use super::sheet::Painter;
use super::solid::{Skin, Triangles};
use isosheet_mesh::vec3::dot;

/// How far faces darken each other, as part of what the picture shows.
const REACH: f64 = 0.3;

/// How far from its border a picture lets half-spaces fade out, as part of its smaller side.
const BORDER: f64 = 0.15;

/// Largest edge over which the light on a body is interpolated at the rim of a shadow, where the openness
/// would change by more than [`CONTRAST`] within a piece, as part of the height of the picture.
const FINE_GRAIN: f64 = 0.007;

/// A change of the light that is seen as an edge.
pub(super) const CONTRAST: f64 = 0.12;

/// How much of the light and shade of a sheet is left where its colours are values, which shade would change.
const SHADE_OF_VALUES: f64 = 0.5;

/// The light on a point with the unit normal `n` towards the viewer: that of the surroundings, which are
/// brighter above, and that of a key light at the upper left.
fn light_on(camera: &Camera, n: &[f64; 3], p: &[f64; 3]) -> [f64; 2] {
    let facing = dot(n, camera.viewer(p)).max(0.0);
    let key = camera.direction([-0.66, 0.62, 0.42]);
    [
        0.34 + 0.10 * n[2] + 0.10 * facing,
        0.68 * dot(n, key).max(0.0),
    ]
}

impl Painter<'_> {
    /// The colour of a corner of a piece of a body or of a sheet, under light of this strength.
    fn colour(&self, piece: &Piece, scene: &Triangles, corner: usize, shade: f64) -> Light {
        let vertex = piece.corners[corner];
        let p = &scene.x[vertex];
        let Some(skin) = scene.skin(piece.face) else {
            let of_value = |colours: &Colours| colours.of_corner(piece.face, vertex);
            if let Some(colour) = self.colours.and_then(of_value) {
                let shade = 1.0 + SHADE_OF_VALUES * (shade - 1.0);
                return light(colour).map(|c| c * shade as f32);
            }
            let sides = self.look.sides;
            let side = sides[scene.sheet(piece.face) % sides.len()][usize::from(piece.back)];
            return light(side).map(|c| c * shade as f32);
        };
        // What has faded out is white, as the background is.
        let inside = if skin.is_plane() { self.inside(p) } else { 1.0 };
        let strength = (inside * skin.strength(p)) as f32;
        let own = match skin {
            Skin::Shadow { .. } => [1.0; 3],
            _ => light(self.look.body),
        };
        own.map(|c| 1.0 + strength * (c * shade as f32 - 1.0))
    }

    /// 0 at the border of the picture and beyond, 1 well inside, and smooth between.
    fn inside(&self, p: &[f64; 3]) -> f64 {
        let ([x, y, _], [width, height]) = (self.place(p), self.size);
        let distance = x.min(width - x).min(y).min(height - y);
        let s = (distance / (BORDER * width.min(height))).clamp(0.0, 1.0);
        s * s * (3.0 - 2.0 * s)
    }

    /// All pieces that are seen in their light; pieces of bodies at the rim of a shadow are cut once more.
    pub(super) fn facets(&self, pieces: &[Piece], scene: &mut Triangles) -> Vec<Facet> {
        let occlusion = Occlusion::new(scene, REACH * self.scale);
        let outlines: Vec<Facet> = pieces.iter().map(|p| self.outline(p, scene)).collect();
        let seen = seen(self.look.size, &outlines);
        let around = occlusion.of_corners(pieces, &seen, scene);
        let is_rim = |piece: &Piece, around: &[Surroundings; 3]| {
            let open = around.map(|corner| corner.open);
            let change = (0..3).map(|i| (open[i] - open[(i + 1) % 3]).abs());
            piece.face >= scene.own && change.fold(0.0, f64::max) > CONTRAST
        };
        let (mut facets, mut rims) = (Vec::new(), Vec::new());
        let pieces = pieces.iter().zip(&around).zip(&seen);
        for ((piece, around), _) in pieces.filter(|(_, seen)| **seen) {
            let mut facet = self.facet(piece, around, scene);
            if is_rim(piece, around) {
                rims.push(*piece);
                // Its parts are nearer to a curved surface than the pieces beside it: what is between them
                // and these shows the piece itself.
                for corner in &mut facet.corners {
                    corner.nearness -= self.scale / self.size[1];
                }
            }
            facets.push(facet);
        }
        let finer = self.cutter(FINE_GRAIN).finer(&rims, scene);
        let around = occlusion.of_corners(&finer, &vec![true; finer.len()], scene);
        let finer = finer.iter().zip(&around);
        facets.extend(finer.map(|(piece, around)| self.facet(piece, around, scene)));
        facets
    }

    /// Where a piece is in the picture.
    fn outline(&self, piece: &Piece, scene: &Triangles) -> Facet {
        Facet {
            corners: piece.corners.map(|v| self.corner(&scene.x[v], [1.0; 3])),
            face: piece.face as u32,
        }
    }

    /// A piece in its light.
    fn facet(&self, piece: &Piece, around: &[Surroundings; 3], scene: &Triangles) -> Facet {
        let points = piece.corners.map(|v| scene.x[v]);
        let flat = normal(&points);
        let flat = if piece.back { flat.map(|c| -c) } else { flat };
        let skin = scene.skin(piece.face);
        let corners = [0, 1, 2].map(|k| {
            let (Surroundings { open: o, normal }, p) = (around[k], &points[k]);
            let [sky, sun] = match &skin {
                // White where nothing is above it.
                Some(Skin::Shadow { .. }) => [1.0, 0.0],
                None => light_on(self.camera, &normal, p),
                Some(skin) => light_on(self.camera, &skin.normal(&flat, p), p),
            };
            let shade = sky * o + sun * (0.4 + 0.6 * o);
            self.corner(p, self.colour(piece, scene, k, shade))
        });
        let face = piece.face as u32;
        Facet { corners, face }
    }

    pub(super) fn corner(&self, p: &[f64; 3], light: Light) -> Corner {
        let [x, y, nearness] = self.place(p);
        Corner {
            x,
            y,
            nearness,
            light,
        }
    }
}
