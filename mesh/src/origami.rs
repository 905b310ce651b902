//! Exact kinematics of rigid origami with one degree of freedom: the fold angles of a vertex of degree four,
//! and fold angles and positions of Miura's pattern, for the sheets of
//! [`generate::degree_four`](crate::generate::degree_four) and [`generate::miura`](crate::generate::miura).

use crate::generate::FoldAssignment;

/// One of the two ways in which a flat-foldable vertex of degree four folds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FoldingMode {
    /// Creases 2 and 4 fold alike, creases 1 and 3 unlike.
    EvenAlike,
    /// Creases 1 and 3 fold alike, creases 2 and 4 unlike.
    OddAlike,
}

/// A vertex of degree four with sectors `a1, a2, pi - a1, pi - a2`, rigid between its creases.
///
/// The half-angle tangents of neighbouring creases are proportional (Huffman 1976; Tachi 2009; Foschi, Hull
/// and Ku 2022). With the fold angles `r1` to `r4`, positive for valleys:
///
/// ```text
/// even alike: r3 = -r1, r4 =  r2, tan(r2/2) =  sin((a1 + a2)/2) / sin((a1 - a2)/2) tan(r1/2)
/// odd alike:  r3 =  r1, r4 = -r2, tan(r2/2) = -cos((a1 + a2)/2) / cos((a1 - a2)/2) tan(r1/2)
/// ```
#[derive(Debug, Clone, Copy)]
pub struct DegreeFour {
    /// `a1` between creases 1 and 2, `a2` between 2 and 3, radians.
    pub sectors: [f64; 2],
}

impl DegreeFour {
    /// `tan(r2/2) / tan(r1/2)`.
    pub fn ratio(&self, mode: FoldingMode) -> f64 {
        let [a, b] = self.sectors;
        let (half_sum, half_difference) = (0.5 * (a + b), 0.5 * (a - b));
        match mode {
            FoldingMode::EvenAlike => half_sum.sin() / half_difference.sin(),
            FoldingMode::OddAlike => -half_sum.cos() / half_difference.cos(),
        }
    }

    /// The fold angles of the four creases when the first is folded by `first`, radians.
    pub fn angles(&self, mode: FoldingMode, first: f64) -> [f64; 4] {
        let second = 2.0 * (self.ratio(mode) * (0.5 * first).tan()).atan();
        match mode {
            FoldingMode::EvenAlike => [first, second, -first, second],
            FoldingMode::OddAlike => [first, second, first, -second],
        }
    }

    /// Mountains and valleys of a mode with the first crease a valley.
    pub fn assignment(&self, mode: FoldingMode) -> [FoldAssignment; 4] {
        self.angles(mode, 1.0).map(|angle| {
            if angle > 0.0 {
                FoldAssignment::Valley
            } else {
                FoldAssignment::Mountain
            }
        })
    }
}

/// Miura's pattern of [`generate::miura`](crate::generate::miura) with rigid panels, by the angle `theta` of
/// the panels to the plane of the folded sheet, from 0 (flat) to pi/2 (folded shut), half the fold angle of
/// the zigzag creases. After Wei, Guo, Dudte, Liang and Mahadevan 2013.
#[derive(Debug, Clone, Copy)]
pub struct Miura {
    /// Length of the straight creases, metres.
    pub straight: f64,
    /// Length of the zigzag creases, metres.
    pub zigzag: f64,
    /// Acute angle of the panels, radians.
    pub angle: f64,
}

impl Miura {
    /// Size of the fold angle of the straight creases, `tan(fold/2) = cos(angle) tan(theta)`, radians.
    pub fn straight_fold(&self, theta: f64) -> f64 {
        2.0 * (self.angle.cos() * theta.tan()).atan()
    }

    /// Width and depth of a panel in the plane of the folded sheet, metres: along the zigzags and along the
    /// straight creases.
    pub fn panel(&self, theta: f64) -> [f64; 2] {
        let (c, tan) = (theta.cos(), self.angle.tan());
        let d = (1.0 + c * c * tan * tan).sqrt();
        let lean = theta.sin() * self.angle.sin();
        [
            self.zigzag * c * tan / d,
            self.straight * (1.0 - lean * lean).sqrt(),
        ]
    }

    /// Positions of `columns` x `rows` panels, `3V`, metres, numbered as the generator does.
    pub fn positions(&self, columns: usize, rows: usize, theta: f64) -> Vec<f64> {
        let (c, tan) = (theta.cos(), self.angle.tan());
        let shift = self.zigzag / (1.0 + c * c * tan * tan).sqrt();
        let height = self.straight * theta.sin() * self.angle.sin();
        let [width, depth] = self.panel(theta);
        let mut x = Vec::new();
        for j in 0..=rows {
            for i in 0..=columns {
                let aside = if i % 2 == 1 { shift } else { 0.0 };
                let up = if j % 2 == 1 { height } else { 0.0 };
                x.extend([width * i as f64, depth * j as f64 + aside, up]);
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{degree_four, miura};
    use crate::{LengthConstraints, VertexId, fold_angle};

    #[test]
    fn the_folded_miura_is_isometric_and_folds_as_assigned() {
        let m = Miura {
            straight: 0.02,
            zigzag: 0.03,
            angle: 1.1,
        };
        let (columns, rows) = (4, 5);
        let p = miura(columns, rows, m.straight, m.zigzag, m.angle).expect("valid");
        let t = p.sheet.topology();
        let flat = m.positions(columns, rows, 0.0);
        let differences = flat.iter().zip(p.sheet.positions());
        assert!(differences.map(|(a, b)| (a - b).abs()).all(|d| d < 1e-15));
        for theta in [0.1, 0.7, 1.3] {
            let x = m.positions(columns, rows, theta);
            assert!(LengthConstraints::new(&p.sheet).max_strain(&x) < 1e-14);
            for e in t.edge_ids() {
                let Some(fold) = fold_angle(t, &x, e) else {
                    continue;
                };
                let [a, b] = t.edges()[e.index()];
                let size = match (p.assignment(e), b.index() - a.index()) {
                    (FoldAssignment::Flat, _) => 0.0,
                    (_, 1) => 2.0 * theta,
                    _ => m.straight_fold(theta),
                };
                let expected = p.assignment(e).sign() * size;
                assert!((fold - expected).abs() < 1e-12, "{e}: {fold} {expected}");
            }
        }
    }

    /// Places the four creases by rotations and looks whether the last face closes the vertex.
    #[test]
    fn the_angles_of_a_vertex_close() {
        let v = DegreeFour {
            sectors: [1.0, 1.5],
        };
        let sectors = [1.0f64, 1.5, std::f64::consts::PI - 1.0];
        for mode in [FoldingMode::EvenAlike, FoldingMode::OddAlike] {
            let angles = v.angles(mode, 0.8);
            // Crease 1 along x; each face is turned about the crease before it.
            let mut frame = nalgebra::Rotation3::identity();
            let mut x = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
            for (k, sector) in sectors.into_iter().enumerate() {
                if k > 0 {
                    frame *= nalgebra::Rotation3::from_axis_angle(
                        &nalgebra::Vector3::x_axis(),
                        angles[k],
                    );
                }
                frame *= nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), sector);
                let end = frame * nalgebra::Vector3::x();
                x.extend(end.iter());
            }
            let p = degree_four(v.sectors, 1.0, v.assignment(mode)).expect("valid");
            let t = p.sheet.topology();
            assert!(
                LengthConstraints::new(&p.sheet).max_strain(&x) < 1e-14,
                "{mode:?}: the fourth side has its length"
            );
            for (k, angle) in angles.into_iter().enumerate() {
                let e = t.find_edge(VertexId(0), VertexId(k as u32 + 1));
                let fold = fold_angle(t, &x, e.expect("a crease")).expect("interior");
                assert!((fold - angle).abs() < 1e-13, "{mode:?}, crease {}", k + 1);
            }
        }
    }
}
