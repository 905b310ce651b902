use super::stencil::POINTS;
use super::*;
use crate::hessian::HessianPart;
use crate::testing::product;
use crate::{CreaseSpring, CreaseSprings};
use isosheet_mesh::generate::{self, Diagonals};
use isosheet_mesh::{MassKind, MassMatrix, Sheet};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A strip along x of which the lines of vertices at the ends and at `fixed` stay where they are; the others
/// are displaced by up to `jitter` cells.
pub(super) fn strip(
    cells: [usize; 2],
    size: [f64; 2],
    diagonals: Diagonals,
    jitter: f64,
    fixed: f64,
) -> Sheet {
    let sheet = generate::grid(cells[0], cells[1], size[0], size[1], diagonals).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let cell = size[0] / cells[0] as f64;
    let mut x = sheet.positions().to_vec();
    for (v, p) in x.as_chunks_mut::<3>().0.iter_mut().enumerate() {
        let v = VertexId(u32::try_from(v).unwrap());
        let is_boundary = sheet.topology().is_boundary_vertex(v);
        for c in &mut p[..2] {
            let shift = rng.random_range(-1.0..1.0) * jitter * cell;
            if !is_boundary && (*c - fixed).abs() > 1e-6 * cell {
                *c += shift;
            }
        }
    }
    Sheet::new(x, &sheet.face_indices()).unwrap()
}

/// Positions with constant second derivatives, on an irregular mesh: exact in every face.
#[test]
fn second_derivatives_are_exact_for_quadratic_positions() {
    let sheet = strip([6, 6], [1.0, 1.2], Diagonals::UnionJack, 0.2, -1.0);
    let second = [
        Matrix2::new(0.3, -0.2, -0.2, 0.7),
        Matrix2::new(-1.1, 0.4, 0.4, 0.2),
        Matrix2::new(0.9, 0.5, 0.5, -0.6),
    ];
    let mut x = Vec::new();
    for p in sheet.positions().as_chunks::<3>().0 {
        let u = Vector2::new(p[0], p[1]);
        x.extend(second.map(|h| 0.5 * u.dot(&(h * u)) + 0.4 * p[0] - 0.3 * p[1] + 2.0));
    }
    let plate = PlateBending::new(&sheet, 2.0).unwrap();
    for (point, stencil) in plate.stencils.iter().enumerate() {
        // The frame of a face is its own; norm and trace of a component do not depend on it.
        let face = face_of(point);
        let area = sheet.face_areas()[face] / POINTS as f64;
        let h = stencil.apply(At::new(0.0, &x)) / (2.0 * area).sqrt();
        for k in 0..3 {
            let row = h.row(k);
            let (norm, trace) = (row.norm(), row[0] + row[2]);
            assert!((norm - second[k].norm()).abs() < 1e-11, "{face}: {norm}");
            assert!((trace - second[k].trace()).abs() < 1e-11, "{face}: {trace}");
        }
    }
}

#[test]
fn flat_sheets_have_no_energy_wherever_they_lie() {
    let sheet = strip([5, 4], [1.0, 0.8], Diagonals::Falling, 0.2, -1.0);
    let plate = PlateBending::new(&sheet, 3.0).unwrap();
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let mut x = Vec::new();
    for p in sheet.positions().as_chunks::<3>().0 {
        let q = turn * Vector3::from(*p) + Vector3::new(5.0, -3.0, 8.0);
        x.extend(q.iter());
    }
    assert!(plate.energy(At::new(0.0, &x)) < 1e-24);
    let mut gradient = vec![0.0; x.len()];
    plate.add_gradient(At::new(0.0, &x), &mut gradient);
    assert!(gradient.iter().all(|g| g.abs() < 1e-10));
}

/// The energy depends on the lengths of the sheet alone: a sheet that is given folded has the plate of one
/// that is given flat.
#[test]
fn the_rest_shape_is_flat_however_the_sheet_is_given() {
    let flat = generate::grid(4, 3, 1.0, 0.6, Diagonals::Rising).unwrap();
    let mut x = flat.positions().to_vec();
    for p in x.as_chunks_mut::<3>().0 {
        // A right-angled fold along a line of the mesh.
        if p[0] > 0.5 {
            (p[0], p[2]) = (0.5, p[0] - 0.5);
        }
    }
    let folded = Sheet::new(x.clone(), &flat.face_indices()).unwrap();
    let of_flat = PlateBending::new(&flat, 1.0).unwrap();
    let of_folded = PlateBending::new(&folded, 1.0).unwrap();
    let energy = of_flat.energy(At::new(0.0, &x));
    assert!(energy > 1.0);
    assert!((of_folded.energy(At::new(0.0, &x)) - energy).abs() < 1e-11 * energy);
}

#[test]
fn gradient_and_hessian_are_derivatives_of_the_energy() {
    let sheet = strip([4, 4], [1.0, 1.0], Diagonals::UnionJack, 0.2, -1.0);
    let pins: Vec<_> = (0..5).chain(10..12).map(VertexId).collect();
    let stiffness = PlateStiffness {
        rigidity: 0.7,
        poisson: 0.3,
    };
    let plate = PlateBending::clamped(&sheet, stiffness, &pins).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let crumple = |p: &f64| p + rng.random_range(-0.1..0.1);
    let x: Vec<f64> = sheet.positions().iter().map(crumple).collect();
    let gradient = |x: &[f64]| {
        let mut g = vec![0.0; x.len()];
        plate.add_gradient(At::new(0.0, x), &mut g);
        g
    };
    let g = gradient(&x);
    let largest = g.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    for i in (0..x.len()).step_by(5) {
        let at = |s: f64| {
            let mut y = x.clone();
            y[i] += s;
            plate.energy(At::new(0.0, &y))
        };
        // (Central differences of a quadratic function are exact.)
        let slope = (at(1e-2) - at(-1e-2)) / 2e-2;
        assert!((slope - g[i]).abs() < 1e-10 * largest, "{i}");
    }
    let along: Vec<f64> = (0..x.len()).map(|i| (1.3 * i as f64).sin()).collect();
    let moved: Vec<f64> = x.iter().zip(&along).map(|(x, a)| x + a).collect();
    let change = gradient(&moved);
    let plate = PlateBending::clamped(&sheet, stiffness, &pins).unwrap();
    let at = (At::new(0.0, &x), HessianPart::Full);
    let product = product(sheet.topology(), &plate, at, &along);
    for i in 0..x.len() {
        let exact = change[i] - g[i];
        assert!((product[i] - exact).abs() < 1e-9 * largest, "{i}");
    }
}

/// Collects the entries of a Hessian for displacements along z.
pub(super) struct Upwards<'a> {
    pub(super) sheet: &'a Sheet,
    pub(super) matrix: DMatrix<f64>,
}

impl HessianSink for Upwards<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        self.matrix[(v.index(), v.index())] += block[(2, 2)];
    }

    fn add_edge(&mut self, edge: EdgeId, block: &Matrix3<f64>) {
        let [a, b] = self.sheet.topology().edges()[edge.index()];
        self.add_pair(a, b, block);
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        self.matrix[(a.index(), b.index())] += block[(2, 2)];
        self.matrix[(b.index(), a.index())] += block[(2, 2)];
    }
}

/// Tip deflection of a strip of length 0.3 m and flexural rigidity 1 under a uniform load of 1, linear
/// theory; a quarter of the strip is clamped. Half way to its end is a crease, if it has a stiffness.
fn cantilever(cells: usize, diagonals: Diagonals, jitter: f64, crease: Option<f64>) -> f64 {
    let (length, overhang) = (0.3, 0.1);
    let size = [length + overhang, 0.1];
    let sheet = strip([4 * cells, cells], size, diagonals, jitter, overhang);
    let (t, x) = (sheet.topology(), sheet.positions());
    let count = t.vertex_count();
    let is_pinned = |v: usize| x[3 * v] < overhang + 1e-9;
    let pins = (0..count).filter(|v| is_pinned(*v));
    let pins: Vec<_> = pins.map(|v| VertexId(u32::try_from(v).unwrap())).collect();
    let on_line = |v: &VertexId| (x[3 * v.index()] - overhang - 0.5 * length).abs() < 1e-9;
    let spring = |edge: EdgeId| {
        let is_inside = !t.is_boundary_edge(edge) && t.edges()[edge.index()].iter().all(on_line);
        Some(CreaseSpring {
            edge,
            stiffness: crease.filter(|_| is_inside)? * sheet.lengths()[edge.index()],
            rest: 0.0.into(),
            yields: None,
            in_series: None,
        })
    };
    let mut springs: Vec<_> = t.edge_ids().filter_map(spring).collect();
    let creases: Vec<_> = springs.iter().map(|s| s.edge).collect();
    assert_eq!(creases.len(), crease.map_or(0, |_| cells));
    CreaseSpring::put_in_sheet(&mut springs, &sheet, 1.0);
    let springs = CreaseSprings::new(t, springs).unwrap();
    let plate = PlateBending::creased(&sheet, 1.0, &pins, &creases).unwrap();
    let matrix = DMatrix::zeros(count, count);
    let mut upwards = Upwards {
        sheet: &sheet,
        matrix,
    };
    plate.add_hessian(At::new(0.0, x), &mut upwards);
    springs.add_hessian(At::new(0.0, x), &mut upwards);
    let free: Vec<usize> = (0..count).filter(|v| !is_pinned(*v)).collect();
    let k = upwards.matrix.select_rows(&free).select_columns(&free);
    let mass = MassMatrix::from_density(&sheet, 1.0, MassKind::Lumped).unwrap();
    let load = DVector::from_iterator(free.len(), free.iter().map(|v| mass.vertex[*v]));
    let deflection = k.cholesky().expect("positive definite").solve(&load);
    let tip = free.iter().zip(deflection.iter());
    let tip: Vec<f64> = tip
        .filter(|(v, _)| x[3 * **v] > size[0] - 1e-9)
        .map(|(_, d)| *d)
        .collect();
    tip.iter().sum::<f64>() / tip.len() as f64
}

/// Without a crease `q L^4 / (8 D)`. A crease of stiffness `k` per length turns by `M / k` with the moment `M
/// = q (L/2)^2 / 2` of the outer half, which hangs `L/2 M / k` deeper.
#[test]
fn a_crease_is_in_series_with_the_sheet() {
    let length = 0.3_f64;
    for diagonals in [Diagonals::UnionJack, Diagonals::Falling, Diagonals::Rising] {
        for k in [0.3, 3.0, 30.0, 1e9] {
            let exact = length.powi(4) / 8.0 + length.powi(3) / (16.0 * k);
            let error = |cells| (cantilever(cells, diagonals, 0.0, Some(k)) / exact - 1.0).abs();
            let errors = [2, 4, 8].map(error);
            let what = format!("{diagonals:?} {k}: {errors:?}");
            assert!(errors[2] < 0.02, "{what}");
            assert!(
                errors[2] < 0.65 * errors[1] && errors[1] < 0.65 * errors[0],
                "{what}"
            );
        }
    }
}

/// A strip of two flat panels that meet in a crease at its rest angle has no energy and no force, whatever
/// the stiffness of sheet and crease and the size of the mesh.
#[test]
fn a_sheet_rests_at_the_rest_angle_of_its_crease() {
    let angle = 1.5_f64;
    for cells in [1, 2, 4] {
        let size = [4.0, 1.0];
        let sheet = strip([4 * cells, cells], size, Diagonals::UnionJack, 0.2, 2.0);
        let (t, flat) = (sheet.topology(), sheet.positions());
        let on_line = |v: &VertexId| (flat[3 * v.index()] - 2.0).abs() < 1e-9;
        let creases: Vec<_> = t
            .edge_ids()
            .filter(|&e| !t.is_boundary_edge(e) && t.edges()[e.index()].iter().all(on_line))
            .collect();
        assert_eq!(creases.len(), cells);
        let mut x = flat.to_vec();
        for p in x.as_chunks_mut::<3>().0 {
            if p[0] > 2.0 {
                let beyond = p[0] - 2.0;
                (p[0], p[2]) = (2.0 + beyond * angle.cos(), beyond * angle.sin());
            }
        }
        let found = isosheet_mesh::fold_angle(t, &x, creases[0]).unwrap();
        assert!((found.abs() - angle).abs() < 1e-12);
        for k in [1e-3, 1.0, 1e3] {
            let spring = |&edge: &EdgeId| CreaseSpring {
                edge,
                stiffness: k * sheet.lengths()[edge.index()],
                rest: found.into(),
                yields: None,
                in_series: None,
            };
            let mut springs: Vec<_> = creases.iter().map(spring).collect();
            CreaseSpring::put_in_sheet(&mut springs, &sheet, 1.0);
            let parts: [Box<dyn Potential>; 3] = [
                Box::new(CreaseSprings::new(t, springs).unwrap()),
                Box::new(CreaseSprings::bending_beside(&sheet, 1.0, &creases).unwrap()),
                Box::new(PlateBending::creased(&sheet, 1.0, &[], &creases).unwrap()),
            ];
            for part in parts {
                let mut force = vec![0.0; x.len()];
                part.add_gradient(At::new(0.0, &x), &mut force);
                assert!(part.energy(At::new(0.0, &x)) < 1e-18 * (1.0 + k));
                assert!(force.iter().all(|f| f.abs() < 1e-9 * (1.0 + k)));
            }
        }
    }
}

#[test]
fn a_cantilever_bends_as_a_plate_does_on_any_mesh() {
    for (diagonals, jitter) in [
        (Diagonals::UnionJack, 0.0),
        (Diagonals::Falling, 0.0),
        (Diagonals::Rising, 0.2),
        (Diagonals::UnionJack, 0.2),
    ] {
        let exact = 0.3_f64.powi(4) / 8.0;
        let errors =
            [2, 4, 8].map(|cells| (cantilever(cells, diagonals, jitter, None) / exact - 1.0).abs());
        let what = format!("{diagonals:?} {jitter}: {errors:?}");
        assert!(errors[1] < 1e-2 && errors[2] < 3e-3, "{what}");
        assert!((errors[0] / errors[2]).log2() / 2.0 > 1.5, "{what}");
    }
}

#[test]
fn bad_input_is_refused() {
    let sheet = generate::isotropic_square(0, 1.0).unwrap();
    for rigidity in [-1.0, f64::NAN, f64::INFINITY] {
        let error = PlateBending::new(&sheet, rigidity).unwrap_err();
        assert!(
            matches!(error, PlateBendingError::Rigidity { .. }),
            "{error}"
        );
    }
    for poisson in [-0.1, 0.6, f64::NAN] {
        let rigidity = 1.0;
        let error = PlateBending::new(&sheet, PlateStiffness { rigidity, poisson }).unwrap_err();
        assert!(
            matches!(error, PlateBendingError::Poisson { .. }),
            "{error}"
        );
    }
    let error = PlateBending::clamped(&sheet, 1.0, &[VertexId(9)]).unwrap_err();
    let (vertex, count) = (VertexId(9), 9);
    assert_eq!(error, PlateBendingError::NoVertex { vertex, count });
    let error = PlateBending::creased(&sheet, 1.0, &[], &[EdgeId(16)]).unwrap_err();
    let (edge, count) = (EdgeId(16), 16);
    assert_eq!(error, PlateBendingError::NoEdge { edge, count });
}

/// Meshes too small for a fit: two faces of the unit square that fold by a small angle `theta` about their
/// diagonal. Moments about the four free sides are zero, a twist is left, and the energy is `D theta^2 / 2`.
/// One face alone does not bend.
#[test]
fn the_smallest_meshes_bend() {
    let x = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let square = Sheet::new(x.clone(), &[[0, 1, 2], [0, 2, 3]]).unwrap();
    let plate = PlateBending::new(&square, 2.0).unwrap();
    let mut y = x.clone();
    y[11] = 1e-3;
    let twist = 0.5 * 2.0 * (2.0_f64.sqrt() * 1e-3).powi(2);
    assert!(plate.energy(At::new(0.0, &x)) < 1e-30);
    assert!((plate.energy(At::new(0.0, &y)) - twist).abs() < 1e-5 * twist);
    let triangle = Sheet::new(x[..9].to_vec(), &[[0, 1, 2]]).unwrap();
    let plate = PlateBending::new(&triangle, 2.0).unwrap();
    assert!(plate.energy(At::new(0.0, &y[..9])) < 1e-30);
}

/// A cantilever of length `L` whose outer half is of another stiffness: under a uniform load the tip of a
/// beam of the pieces `D_1` and `D_2` sinks by `q L^4 / 8 [1 / D_1 + (1 / D_2 - 1 / D_1) / 16]`.
#[test]
fn a_cantilever_of_two_stiffnesses_is_a_beam_of_two_pieces() {
    let (length, overhang) = (0.3, 0.1);
    for (diagonals, jitter) in [(Diagonals::UnionJack, 0.0), (Diagonals::Rising, 0.2)] {
        for outer in [0.2, 5.0] {
            let cells = 8;
            let size = [length + overhang, 0.1];
            let sheet = strip([4 * cells, cells], size, diagonals, jitter, overhang);
            let (t, x) = (sheet.topology(), sheet.positions());
            let middle = overhang + 0.5 * length;
            let is_outer = |f: &FaceId| {
                let corners = t.faces()[f.index()].map(|v| x[3 * v.index()]);
                corners.iter().sum::<f64>() / 3.0 > middle
            };
            let faces: Vec<_> = t.face_ids().filter(is_outer).collect();
            let laws = Patched::everywhere(PlateLaw::from(1.0)).with_patch(faces, outer.into());
            let pins = sheet.vertices_where(|[x, ..]| x < overhang + 1e-9);
            let edges = PlateEdges {
                pinned: &pins,
                creases: &[],
                clamps: &[],
            };
            let plate = PlateBending::patched(&sheet, &laws, &edges).unwrap();
            let count = t.vertex_count();
            let matrix = DMatrix::zeros(count, count);
            let mut upwards = Upwards {
                sheet: &sheet,
                matrix,
            };
            plate.add_hessian(At::new(0.0, x), &mut upwards);
            let is_free = |v: &usize| x[3 * v] > overhang + 1e-9;
            let free: Vec<usize> = (0..count).filter(is_free).collect();
            let k = upwards.matrix.select_rows(&free).select_columns(&free);
            let mass = MassMatrix::from_density(&sheet, 1.0, MassKind::Lumped).unwrap();
            let load = DVector::from_iterator(free.len(), free.iter().map(|v| mass.vertex[*v]));
            let deflection = k.cholesky().expect("positive definite").solve(&load);
            let tip = free.iter().zip(deflection.iter());
            let tip = tip.filter(|(v, _)| (x[3 * **v] - length - overhang).abs() < 1e-9);
            let tip: Vec<f64> = tip.map(|(_, d)| *d).collect();
            let found = tip.iter().sum::<f64>() / tip.len() as f64;
            let exact = length.powi(4) / 8.0 * (1.0 + (1.0 / outer - 1.0) / 16.0);
            let error = found / exact - 1.0;
            assert!(
                error.abs() < 1e-2,
                "{diagonals:?} {jitter} {outer}: {error}"
            );
        }
    }
}

#[test]
fn patches_that_make_no_sense_are_refused() {
    let sheet = generate::isotropic_square(0, 1.0).unwrap();
    let edges = PlateEdges::default();
    let refused = |face: u32, rigidity: f64| {
        let laws = Patched::everywhere(PlateLaw::from(1.0));
        let laws = laws.with_patch(vec![FaceId(face)], rigidity.into());
        PlateBending::patched(&sheet, &laws, &edges).unwrap_err()
    };
    let (face, count) = (FaceId(8), 8);
    let expected = crate::NoFace { face, count };
    assert_eq!(refused(8, 1.0), PlateBendingError::Patch(expected));
    for rigidity in [0.0, -1.0] {
        let expected = PlateBendingError::Rigidity { rigidity };
        assert_eq!(refused(0, rigidity), expected);
    }
}

/// Of waves `cos(k x)` in any direction the energy is too small by a part of second order in `k h`, which is
/// smaller than that of the mean curvatures of the faces, and on the whole less than half of it.
#[test]
fn waves_have_nearly_the_energy_of_their_plate() {
    let h = 0.025;
    let cells = |diagonals, jitter| strip([40, 40], [1.0, 1.0], diagonals, jitter, 0.0);
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let meshes = [
        cells(Diagonals::Rising, 0.0),
        cells(Diagonals::Rising, 0.2),
        cells(Diagonals::UnionJack, 0.0),
        cells(Diagonals::UnionJack, 0.2),
        generate::delaunay(&square, h, 3).unwrap(),
    ];
    let (mut all, mut all_of_means) = (0.0, 0.0);
    for (number, sheet) in meshes.iter().enumerate() {
        let plate = PlateBending::new(sheet, 1.0).unwrap();
        // Away from the sides.
        let is_inside = |f: &FaceId| {
            let corners = sheet.topology().faces()[f.index()].map(|v| sheet.position(v));
            corners
                .iter()
                .all(|[x, y, _]| (0.2..0.8).contains(x) && (0.2..0.8).contains(y))
        };
        let inside: Vec<usize> = sheet
            .topology()
            .face_ids()
            .filter(is_inside)
            .map(FaceId::index)
            .collect();
        for angle in [0.0_f64, 22.5, 45.0, 67.5, 90.0, 135.0] {
            let (s, c) = angle.to_radians().sin_cos();
            let k = 0.25 / h;
            let (mut energy, mut of_means, mut exact) = (0.0, 0.0, 0.0);
            // Sine and cosine together have a constant energy.
            for phase in [0.0, std::f64::consts::FRAC_PI_2] {
                let mut x = sheet.positions().to_vec();
                for p in x.as_chunks_mut::<3>().0 {
                    p[2] = (k * (c * p[0] + s * p[1]) + phase).cos();
                }
                let at = At::new(0.0, &x);
                let rows: Vec<_> = plate
                    .stencils
                    .iter()
                    .map(|s| s.apply(at).row(2).transpose())
                    .collect();
                for &face in &inside {
                    let own = &rows[POINTS * face..POINTS * (face + 1)];
                    energy += own.iter().map(Vector3::norm_squared).sum::<f64>();
                    of_means += own.iter().sum::<Vector3<f64>>().norm_squared() / POINTS as f64;
                    exact += 0.5 * sheet.face_areas()[face] * k.powi(4);
                }
            }
            let error = (energy / exact - 1.0).abs();
            let of_means = (of_means / exact - 1.0).abs();
            assert!(
                error < of_means,
                "mesh {number}, {angle} degrees: {error} {of_means}"
            );
            all += error;
            all_of_means += of_means;
        }
    }
    assert!(all < 0.5 * all_of_means, "{all} {all_of_means}");
}
