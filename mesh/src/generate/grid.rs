//! Rectangular grids of triangles.

use super::error::{GenerateError, check_count, check_faces, check_size};
use crate::Sheet;

/// How the cells of a rectangular grid are cut into two triangles each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonals {
    /// Alternating, so that the cells of even parity (i + j even) are cut from lower left to upper right and
    /// the others the other way: the isotropic or "union jack" pattern of Liu, Tang and Joneja 2007, Fig. 4.
    /// Vertices of even parity have degree 8 inside, vertices of odd parity 4.
    UnionJack,
    /// All from lower right to upper left: the anisotropic pattern of Figs. 1 and 3. Interior vertices have
    /// degree 6.
    Falling,
    /// All from lower left to upper right: the mirror image of the former.
    Rising,
}

/// A flat rectangle `[0, width] x [0, height]` (metres) of `columns` x `rows` cells, each cut into two
/// triangles.
///
/// Vertex (i, j) has the index i + j (columns + 1) and lies at (i width / columns, j height / rows, 0).
///
/// # Errors
/// [`GenerateError`] for a count of zero, a size that is not positive, or more than 2^24 faces.
pub fn grid(
    columns: usize,
    rows: usize,
    width: f64,
    height: f64,
    diagonals: Diagonals,
) -> Result<Sheet, GenerateError> {
    check_count("columns", columns, 1)?;
    check_count("rows", rows, 1)?;
    check_size("width", width)?;
    check_size("height", height)?;
    check_faces(2 * columns as u128 * rows as u128)?;
    let place = |i, j| {
        [
            width * i as f64 / columns as f64,
            height * j as f64 / rows as f64,
        ]
    };
    cut_quadrilaterals(columns, rows, place, |i, j| match diagonals {
        Diagonals::UnionJack => (i + j) % 2 == 0,
        Diagonals::Falling => false,
        Diagonals::Rising => true,
    })
}

/// A flat sheet of `columns` x `rows` quadrilaterals, each cut into two triangles.
///
/// Vertex (i, j) has the index i + j (columns + 1) and lies at `place(i, j)`, `[x, y]` in metres. The
/// quadrilateral (i, j) is cut from lower left to upper right where `is_rising(i, j)`, and the other way
/// elsewhere. The counts have been checked.
pub(super) fn cut_quadrilaterals(
    columns: usize,
    rows: usize,
    place: impl Fn(usize, usize) -> [f64; 2],
    is_rising: impl Fn(usize, usize) -> bool,
) -> Result<Sheet, GenerateError> {
    let mut positions = Vec::with_capacity(3 * (columns + 1) * (rows + 1));
    for j in 0..=rows {
        for i in 0..=columns {
            let [x, y] = place(i, j);
            positions.extend([x, y, 0.0]);
        }
    }
    let mut faces = Vec::with_capacity(2 * columns * rows);
    for j in 0..rows {
        for i in 0..columns {
            let sw = (i + j * (columns + 1)) as u32;
            let (se, nw) = (sw + 1, sw + columns as u32 + 1);
            let ne = nw + 1;
            if is_rising(i, j) {
                faces.extend([[sw, se, ne], [sw, ne, nw]]);
            } else {
                faces.extend([[sw, se, nw], [se, ne, nw]]);
            }
        }
    }
    Ok(Sheet::new(positions, &faces)?)
}

/// The isotropic square M^level of side `side` (metres): a grid of 2^(level + 1) cells each way, cut in the
/// union-jack pattern (Liu, Tang and Joneja 2007, Fig. 4).
///
/// Levels 0 to 4 have 9/8, 25/32, 81/128, 289/512 and 1089/2048 vertices/faces. Vertex (i, j) has the index
/// i + j (2^(level + 1) + 1).
///
/// ```
/// let m1 = isosheet_mesh::generate::isotropic_square(1, 0.2)?;
/// assert_eq!((m1.topology().vertex_count(), m1.topology().face_count()), (25, 32));
/// # Ok::<(), isosheet_mesh::generate::GenerateError>(())
/// ```
///
/// # Errors
/// [`GenerateError`] for a level above 10 or a side that is not positive.
pub fn isotropic_square(level: u32, side: f64) -> Result<Sheet, GenerateError> {
    check_level(level)?;
    let n = 2usize << level;
    grid(n, n, side, side, Diagonals::UnionJack)
}

/// The one-way grid of Liu, Tang and Joneja 2007, Figs. 1 and 3: all diagonals run from lower right to upper
/// left.
///
/// # Errors
/// As [`grid`].
pub fn anisotropic_grid(
    columns: usize,
    rows: usize,
    width: f64,
    height: f64,
) -> Result<Sheet, GenerateError> {
    grid(columns, rows, width, height, Diagonals::Falling)
}

/// A strip of one row of `cells` cells along x; no interior vertex, so that its lengths are independent even
/// when flat.
///
/// With [`Diagonals::UnionJack`] the creases zigzag, otherwise they are parallel. Vertex i is at the bottom
/// of rung i, vertex i + cells + 1 at its top.
///
/// # Errors
/// As [`grid`].
pub fn strip(
    cells: usize,
    length: f64,
    width: f64,
    diagonals: Diagonals,
) -> Result<Sheet, GenerateError> {
    grid(cells, 1, length, width, diagonals)
}

/// A strip of `rows` rungs of two vertices each, numbered downwards (along -y): the mesh of the hanging
/// chain.
///
/// Rung k is at y = -k `spacing`; vertices 2k and 2k + 1 are at x = 0 and x = `rung` (metres). Held at the
/// first rung, with equal vertex masses, it hangs and swings as `rows` - 1 equal beads on a string do: the
/// side rods carry all the weight, rungs and diagonals none. Turn it upright with
/// `map_positions(|[x, y, z]| [x, -z, y])`.
///
/// # Errors
/// [`GenerateError`] for fewer than two rows or a size that is not positive.
pub fn ladder(rows: usize, rung: f64, spacing: f64) -> Result<Sheet, GenerateError> {
    check_count("rows", rows, 2)?;
    check_size("rung", rung)?;
    check_size("spacing", spacing)?;
    let positions = (0..rows)
        .flat_map(|k| {
            let y = -(k as f64) * spacing;
            [0.0, y, 0.0, rung, y, 0.0]
        })
        .collect();
    let faces: Vec<[u32; 3]> = (0..rows as u32 - 1)
        .flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]])
        .collect();
    Ok(Sheet::new(positions, &faces)?)
}

fn check_level(level: u32) -> Result<(), GenerateError> {
    const MAX: u32 = 10;
    if level <= MAX {
        return Ok(());
    }
    Err(GenerateError::Count {
        name: "level",
        value: level as usize,
        min: 0,
        max: MAX as usize,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn union_jack_counts_and_degrees() {
        for (level, v, f) in [
            (0, 9, 8),
            (1, 25, 32),
            (2, 81, 128),
            (3, 289, 512),
            (4, 1089, 2048),
        ] {
            let s = isotropic_square(level, 0.7).unwrap();
            let t = s.topology();
            assert_eq!((t.vertex_count(), t.face_count()), (v, f));
            assert_eq!(t.euler_characteristic(), 1);
            assert!((s.area() - 0.49).abs() < 1e-14);
            let n = 2usize << level;
            for j in 1..n {
                for i in 1..n {
                    let degree = t.degree(crate::VertexId::from_index(i + j * (n + 1)));
                    assert_eq!(degree, if (i + j) % 2 == 0 { 8 } else { 4 });
                }
            }
            for corner in [0, n, n * (n + 1), n * (n + 2)] {
                assert_eq!(
                    t.degree(crate::VertexId::from_index(corner)),
                    3,
                    "a diagonal runs into every corner"
                );
            }
        }
    }

    #[test]
    fn rectangles_and_strips() {
        let s = grid(12, 8, 0.6, 0.4, Diagonals::UnionJack).unwrap();
        s.topology().check_invariants();
        assert_eq!(
            (s.topology().vertex_count(), s.topology().face_count()),
            (13 * 9, 2 * 12 * 8)
        );
        assert_eq!(
            grid(8, 8, 0.3, 0.3, Diagonals::UnionJack).unwrap(),
            isotropic_square(2, 0.3).unwrap()
        );
        let s = anisotropic_grid(3, 4, 0.6, 0.4).unwrap();
        s.topology().check_invariants();
        assert_eq!(s.topology().degree(crate::VertexId(5)), 6);
        for diagonals in [Diagonals::UnionJack, Diagonals::Falling, Diagonals::Rising] {
            let s = strip(6, 1.2, 0.1, diagonals).unwrap();
            s.topology().check_invariants();
            assert_eq!(s.topology().interior_vertex_count(), 0);
        }
        let s = ladder(4, 0.1, 0.3).unwrap();
        s.topology().check_invariants();
        assert_eq!(
            (s.topology().vertex_count(), s.topology().face_count()),
            (8, 6)
        );
        assert!((s.area() - 0.09).abs() < 1e-15);
        let t = s.topology();
        let side = t.find_edge(crate::VertexId(1), crate::VertexId(3)).unwrap();
        assert!((s.lengths()[side.index()] - 0.3).abs() < 1e-15);
    }

    #[test]
    fn misuse_is_refused() {
        assert!(matches!(
            grid(0, 1, 1.0, 1.0, Diagonals::Rising),
            Err(GenerateError::Count {
                name: "columns",
                ..
            })
        ));
        assert!(matches!(
            isotropic_square(11, 1.0),
            Err(GenerateError::Count { .. })
        ));
        assert!(matches!(
            isotropic_square(0, -1.0),
            Err(GenerateError::Size { .. })
        ));
        assert!(matches!(
            isotropic_square(0, f64::NAN),
            Err(GenerateError::Size { .. })
        ));
        assert!(matches!(
            grid(1 << 13, 1 << 13, 1.0, 1.0, Diagonals::Rising),
            Err(GenerateError::TooManyFaces { .. })
        ));
    }
}
