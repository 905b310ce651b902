//! A connected part of a sheet as pieces in the plane.

use super::cut_graph::CutGraph;
use super::halving;
use super::least_squares::{LeastSquares, largest_strain, turned_over};
use super::overlap::overlapping;
use super::patch::Patch;
use super::start;
use super::vec2::{Point, distance};
use super::{UnrollError, UnrollOptions};
use isosheet_mesh::{EdgeId, FaceId, Sheet, VertexId, angle_deficits, fold_angle};

/// A piece in the plane.
pub(super) struct Laid {
    pub(super) patch: Patch,
    pub(super) points: Vec<Point>,
    /// The edge with the largest strain, and its strain.
    pub(super) strain: (EdgeId, f64),
}

/// Depth to which triangles may lie on each other, as a part of the size of their piece: digits that layouts
/// lose to round-off are fewer.
const DEPTH: f64 = 1e-9;

/// What is to be laid out.
pub(super) struct Disks<'a> {
    pub(super) options: &'a UnrollOptions,
    /// Of each vertex of the whole the angle deficit.
    pub(super) deficits: &'a [f64],
    /// Whether a pair of vertices of the whole is an edge that is to be cut in any case.
    pub(super) is_named: &'a dyn Fn([VertexId; 2]) -> bool,
}

impl Disks<'_> {
    /// The pieces of a connected part.
    ///
    /// Deficits that are small one by one may add up. Where they do, the part is cut to all that are larger
    /// than their share of what is allowed.
    pub(super) fn of(&self, part: &Patch) -> Result<Vec<Laid>, UnrollError> {
        let limit = self.options.largest_deficit();
        let first = self.cut_to(part, limit);
        let Err(UnrollError::Curved { .. } | UnrollError::TurnedOver { .. }) = first else {
            return first;
        };
        let (count, ..) = worst(part);
        self.cut_to(part, limit / count.max(1) as f64).or(first)
    }

    /// The pieces of a connected part, cut to corners with deficits of more than `limit`, radians.
    fn cut_to(&self, part: &Patch, limit: f64) -> Result<Vec<Laid>, UnrollError> {
        let (sheet, t) = (&part.sheet, part.sheet.topology());
        let angles: Vec<Option<f64>> = t
            .edge_ids()
            .map(|e| fold_angle(t, sheet.positions(), e))
            .collect();
        let costs = costs(sheet, &angles);
        let own: Vec<f64> = t
            .vertex_ids()
            .map(|v| match t.is_boundary_vertex(v) {
                true => 0.0,
                false => self.deficits[part.vertices[v.index()] as usize],
            })
            .collect();
        let corners = self.corners(sheet, &angles, &own, limit);
        // Edges that were to be cut and are not, as both ends are inside.
        let given: Vec<bool> = t
            .edge_ids()
            .map(|e| !t.is_boundary_edge(e) && (self.is_named)(part.whole_ends(e)))
            .collect();
        let worst = t
            .vertex_ids()
            .max_by(|a, b| own[a.index()].abs().total_cmp(&own[b.index()].abs()));
        let graph = CutGraph {
            topology: t,
            costs: &costs,
            corners: &corners,
            given: &given,
            last_resort: worst.unwrap_or(VertexId(0)),
        };
        let mut cuts = graph.cuts();
        let mut open = part.opened(&cuts)?;
        open.reverse();
        let mut laid = Vec::new();
        while let Some(patch) = open.pop() {
            let (points, strain) = self.lay_out(&patch)?;
            match overlap(&patch.sheet, &points, strain.1) {
                None => laid.push(Laid {
                    patch,
                    points,
                    strain,
                }),
                Some(faces) => {
                    let mut halves = self.halved(&patch, faces)?;
                    halves.reverse();
                    open.extend(halves);
                }
            }
        }
        let places = Places::of(part, &laid);
        for e in t.edge_ids() {
            // Pieces that had to be divided are cut along more edges.
            cuts[e.index()] |= places.is_between_pieces(part, e);
        }
        let rejoined = self.rejoined(part, &cuts, &given, &places)?;
        Ok(rejoined.unwrap_or(laid))
    }

    /// The vertices inside to which the part is cut. Each has a deficit of more than a limit, and is on a
    /// crease or has no neighbour with such a deficit, as the apex of a cone. Elsewhere the part is curved.
    fn corners(
        &self,
        sheet: &Sheet,
        angles: &[Option<f64>],
        deficits: &[f64],
        limit: f64,
    ) -> Vec<bool> {
        let t = sheet.topology();
        let is_large = |v: VertexId| deficits[v.index()].abs() > limit;
        let is_crease =
            |e: &EdgeId| angles[e.index()].is_some_and(|angle| angle.abs() >= self.options.crease);
        let is_corner = |v: VertexId| {
            is_large(v)
                && (t.vertex_edges(v).iter().any(is_crease) || !t.neighbours(v).any(is_large))
        };
        t.vertex_ids().map(is_corner).collect()
    }

    /// The layout of a disk, with its largest strain.
    fn lay_out(&self, patch: &Patch) -> Result<(Vec<Point>, (EdgeId, f64)), UnrollError> {
        let sheet = &patch.sheet;
        let mut equations = LeastSquares::new(sheet)?;
        let mut points = start::face_by_face(sheet);
        let is_turned = turned_over(sheet, &points).is_some();
        equations.fit(&mut points)?;
        let mut strain = largest_strain(sheet, &points);
        let is_good =
            strain.1.abs() <= self.options.strain && turned_over(sheet, &points).is_none();
        if is_turned && !is_good {
            let mut other = start::on_a_disk(sheet)?;
            equations.fit(&mut other)?;
            let own = largest_strain(sheet, &other);
            if turned_over(sheet, &other).is_none() || own.1.abs() < strain.1.abs() {
                (points, strain) = (other, own);
            }
        }
        if strain.1.abs() > self.options.strain {
            let (count, vertex, deficit) = worst(patch);
            return Err(UnrollError::Curved {
                ends: patch.whole_ends(strain.0),
                strain: strain.1,
                limit: self.options.strain,
                count,
                vertex,
                deficit,
            });
        }
        if let Some(f) = turned_over(sheet, &points) {
            let (_, vertex, deficit) = worst(patch);
            return Err(UnrollError::TurnedOver {
                face: FaceId(patch.faces[f]),
                vertex,
                deficit,
            });
        }
        Ok((points, strain))
    }

    /// A piece that lies on itself with two faces, in two.
    fn halved(&self, patch: &Patch, faces: [usize; 2]) -> Result<Vec<Patch>, UnrollError> {
        let (sheet, t) = (&patch.sheet, patch.sheet.topology());
        let x = sheet.positions();
        let angles: Vec<Option<f64>> = t.edge_ids().map(|e| fold_angle(t, x, e)).collect();
        let cut = halving::between(sheet, &costs(sheet, &angles), faces.map(FaceId::from_index));
        let Some(cut) = cut else {
            let faces = faces.map(|f| FaceId(patch.faces[f]));
            return Err(UnrollError::Overlap { faces });
        };
        let mut is_cut = vec![false; t.edge_count()];
        cut.iter().for_each(|e| is_cut[e.index()] = true);
        Ok(patch.opened(&is_cut)?)
    }

    /// The pieces joined again along cuts whose sides lie on each other in the plane, as around the hole of a
    /// flat sheet; `None` where there are no such cuts.
    fn rejoined(
        &self,
        part: &Patch,
        cuts: &[bool],
        given: &[bool],
        places: &Places,
    ) -> Result<Option<Vec<Laid>>, UnrollError> {
        let (sheet, t) = (&part.sheet, part.sheet.topology());
        let meets = |e: EdgeId| {
            cuts[e.index()]
                && !given[e.index()]
                && places.apart(part, e) <= self.options.strain * sheet.lengths()[e.index()]
        };
        let mut kept = cuts.to_vec();
        t.edge_ids()
            .filter(|e| meets(*e))
            .for_each(|e| kept[e.index()] = false);
        if kept == cuts {
            return Ok(None);
        }
        let mut laid = Vec::new();
        for patch in part.opened(&kept)? {
            let t = patch.sheet.topology();
            let mut points = vec![[0.0; 2]; t.vertex_count()];
            for (corners, whole) in t.faces().iter().zip(&patch.faces) {
                let Some((_, place)) = places.of_face(*whole) else {
                    return Ok(None);
                };
                corners
                    .iter()
                    .zip(place)
                    .for_each(|(v, p)| points[v.index()] = p);
            }
            LeastSquares::new(&patch.sheet)?.fit(&mut points)?;
            let strain = largest_strain(&patch.sheet, &points);
            let is_good = strain.1.abs() <= self.options.strain
                && turned_over(&patch.sheet, &points).is_none()
                && overlap(&patch.sheet, &points, strain.1).is_none();
            if !is_good {
                return Ok(None);
            }
            laid.push(Laid {
                patch,
                points,
                strain,
            });
        }
        // A cut of a single edge between two whole vertices would have been closed.
        let count = kept.iter().filter(|k| **k).count();
        let boundary = |l: &Laid| l.patch.sheet.topology().boundary_edge_count();
        let sides: usize = laid.iter().map(boundary).sum();
        Ok((sides == t.boundary_edge_count() + 2 * count).then_some(laid))
    }
}

/// Where the faces of a part lie in the plane.
struct Places {
    /// Of each face of the whole its piece, and its corners.
    faces: std::collections::HashMap<u32, (usize, [Point; 3])>,
}

impl Places {
    fn of(part: &Patch, laid: &[Laid]) -> Self {
        let mut faces = std::collections::HashMap::with_capacity(part.faces.len());
        for (piece, own) in laid.iter().enumerate() {
            let corners = own.patch.sheet.topology().faces();
            for (corners, whole) in corners.iter().zip(&own.patch.faces) {
                faces.insert(*whole, (piece, corners.map(|v| own.points[v.index()])));
            }
        }
        Self { faces }
    }

    fn of_face(&self, whole: u32) -> Option<(usize, [Point; 3])> {
        self.faces.get(&whole).copied()
    }

    /// The piece and the places of the ends of an edge of the part, as each of its faces has them.
    fn sides(&self, part: &Patch, e: EdgeId) -> [Option<(usize, [Point; 2])>; 2] {
        let t = part.sheet.topology();
        let ends = t.edges()[e.index()];
        t.edge_faces(e).map(|f| {
            let f = f?;
            let (piece, corners) = self.of_face(part.faces[f.index()])?;
            let own = t.faces()[f.index()];
            let place = |v: VertexId| own.iter().position(|w| *w == v).map(|k| corners[k]);
            Some((piece, [place(ends[0])?, place(ends[1])?]))
        })
    }

    fn is_between_pieces(&self, part: &Patch, e: EdgeId) -> bool {
        matches!(self.sides(part, e), [Some((one, _)), Some((other, _))] if one != other)
    }

    /// How far the two sides of a cut are apart in the plane; infinite where they are of different pieces.
    fn apart(&self, part: &Patch, e: EdgeId) -> f64 {
        match self.sides(part, e) {
            [Some((one, p)), Some((other, q))] if one == other => {
                distance(p[0], q[0]).max(distance(p[1], q[1]))
            }
            _ => f64::INFINITY,
        }
    }
}

/// What cuts cost: the length of an edge times `cos^2(angle / 2)`. A crease that is folded by a right angle
/// costs half as much as an edge that folds little. A flat edge costs more than all edges that fold do
/// together: a plane face is cut only where no way leads along folds.
///
/// Costs are whole multiples of a part of the shortest edge. So ways that cost the same have the same sum,
/// however the mesh is turned, and the numbers of their vertices decide.
fn costs(sheet: &Sheet, angles: &[Option<f64>]) -> Vec<f64> {
    /// Folds below are flat, radians. Coordinates with seven digits let triangles tilt by this angle that are
    /// a ten-thousandth as high as the mesh is large.
    const FLAT: f64 = 1e-3;
    /// The unit of costs, as a part of the shortest edge: well above round-off.
    const UNIT: f64 = 1e-6;
    let shortest = sheet.lengths().iter().fold(f64::INFINITY, |m, l| m.min(*l));
    let own = sheet.lengths().iter().zip(angles).map(|(l, angle)| {
        let angle = angle.unwrap_or(0.0);
        let cost = l / shortest * (0.5 * angle).cos().powi(2);
        ((cost / UNIT).round(), angle.abs() < FLAT)
    });
    let own: Vec<(f64, bool)> = own.collect();
    let folds: f64 = own.iter().filter(|c| !c.1).map(|c| c.0).sum();
    // A flat edge costs at least `1 / UNIT`.
    let flat = 1.0 + (UNIT * folds).ceil();
    own.into_iter()
        .map(|(cost, is_flat)| if is_flat { flat * cost } else { cost })
        .collect()
}

/// Two faces of a layout that lie on each other.
fn overlap(sheet: &Sheet, points: &[Point], strain: f64) -> Option<[usize; 2]> {
    let faces = sheet.topology().faces();
    let triangles: Vec<[Point; 3]> = faces.iter().map(|f| f.map(|v| points[v.index()])).collect();
    let size = points.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
    let longest = sheet.lengths().iter().fold(0.0_f64, |m, l| m.max(*l));
    overlapping(&triangles, DEPTH * size + strain.abs() * longest)
}

/// The number of vertices inside with a deficit beyond round-off, and that with the largest one.
fn worst(patch: &Patch) -> (usize, VertexId, f64) {
    /// Angles of triangles whose corners have round-off.
    const ROUND_OFF: f64 = 1e-9;
    let deficits = angle_deficits(patch.sheet.topology(), patch.sheet.positions());
    let count = deficits.iter().filter(|d| d.abs() > ROUND_OFF).count();
    let pairs = deficits.into_iter().zip(&patch.vertices);
    let most = pairs.fold((0.0_f64, 0), |most, (d, v)| {
        if d.abs() > most.0.abs() {
            (d, *v)
        } else {
            most
        }
    });
    (count, VertexId(most.1), most.0)
}
