//! How what is remembered of bends depends on positions and on what was remembered before.

use super::super::bend::{Bend, NUMBERS};
use super::super::face::Face;
use super::super::surroundings::{largest_of_mean, pull_largest_of_mean};
use super::Arcs;
use crate::potential::At;
use nalgebra::{Matrix3, Vector3};

/// Derivatives of a number by the bends of faces.
struct OfBends {
    chords: Vec<Vector3<f64>>,
    own: Vec<f64>,
    errors: Vec<Vector3<f64>>,
}

impl Arcs {
    /// Number of its faces.
    pub(in super::super) fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Of [`Arcs::remember`] with the numbers `found` that were remembered before it, of all faces, and with
    /// the parts of the way that its own faces chose: makes the
    /// derivatives of a number by what it leaves those by what it found, and adds those by the positions.
    pub(in super::super) fn pull_back(
        &self,
        faces: &[Face],
        here: At<'_>,
        (found, choices): (&[f64], &[f64]),
        of: &mut [f64],
        of_x: &mut [f64],
    ) {
        let own = &faces[self.faces.clone()];
        let before = &found.as_chunks::<NUMBERS>().0[self.faces.clone()];
        let of = self.rows(of);
        let bends: Vec<Bend> = self.bends(faces, here).collect();
        let stresses: Vec<[Vector3<f64>; 2]> = own
            .iter()
            .zip(before)
            .map(|(face, row)| {
                [Bend::remembered(row), Bend::FLAT].map(|bend| face.stress(here, &bend))
            })
            .collect();
        let count = own.len();
        let mut of_bends = OfBends {
            chords: vec![Vector3::zeros(); count],
            own: vec![0.0; count],
            errors: vec![Vector3::zeros(); count],
        };
        let mut of_stresses = vec![[Vector3::zeros(); 2]; count];
        let mut left = vec![[0.0; NUMBERS]; count];
        for (k, around) in self.around.iter().enumerate() {
            let given = Bend::remembered(&of[k]);
            of_bends.chords[k] += given.chords;
            of_bends.own[k] += given.own;
            let Bend {
                squared, credit, ..
            } = Bend::remembered(&before[k]);
            let bend = Bend {
                squared,
                credit,
                ..bends[k]
            };
            let most = around.iter().map(|f| f.face);
            let most = most.reduce(|a, b| match bends[b].own > bends[a].own {
                true => b,
                false => a,
            });
            let Some(most) = most else { continue };
            let mean =
                |which: usize| largest_of_mean(around, |f| (own[f].area(), stresses[f][which]));
            let means = [mean(0), mean(1)];
            let which = usize::from(means[1] < means[0]);
            let part = own[k].left_by(means[which]);
            let wanted = part * bends[most].own;
            let of_slack = own[k].pull_slack(
                here,
                bend,
                (wanted, choices[k]),
                [given.squared, given.credit],
            );
            left[k][4] += of_slack.squared;
            left[k][5] += given.credit;
            of_bends.errors[k] += of_slack.beyond;
            of_bends.chords[k] -= of_slack.beyond;
            of_bends.own[most] += of_slack.wanted * part;
            if part < 1.0 {
                // It goes with the inverse of the tension.
                let of_mean = -of_slack.wanted * wanted / means[which];
                pull_largest_of_mean(
                    around,
                    |f| (own[f].area(), stresses[f][which]),
                    |f, of| of_stresses[f][which] += of_mean * of,
                );
            }
        }
        for k in 0..count {
            let bend = Bend::remembered(&before[k]);
            let [of_own, of_flat] = &of_stresses[k];
            let (errors, squared) = own[k].pull_stress(here, &bend, of_own);
            of_bends.errors[k] += errors;
            for (i, error) in errors.iter().enumerate() {
                left[k][i] -= error;
            }
            left[k][4] += squared;
            of_bends.errors[k] += own[k].pull_stress(here, &Bend::FLAT, of_flat).0;
        }
        of.copy_from_slice(&left);
        self.pull_bends(own, here, &of_bends, of_x);
    }

    /// Of [`Arcs::start`] with derivatives of a number by what it writes.
    pub(in super::super) fn pull_start(
        &self,
        faces: &[Face],
        here: At<'_>,
        of: &[f64],
        of_x: &mut [f64],
    ) {
        let own = &faces[self.faces.clone()];
        let rows = &of.as_chunks::<NUMBERS>().0[self.faces.clone()];
        let rows = rows.iter().map(Bend::remembered);
        let (chords, squares) = rows.map(|b| (b.chords, b.own + b.squared)).unzip();
        let of_bends = OfBends {
            chords,
            own: squares,
            errors: vec![Vector3::zeros(); own.len()],
        };
        self.pull_bends(own, here, &of_bends, of_x);
    }

    fn pull_bends(&self, own: &[Face], here: At<'_>, of: &OfBends, of_x: &mut [f64]) {
        for (face, errors) in own.iter().zip(&of.errors) {
            if *errors != Vector3::zeros() {
                face.pull_errors(here, errors, of_x);
            }
        }
        let at = At::new(here.t, &here.x[self.coordinates.clone()]);
        let second: Vec<Matrix3<f64>> = self.curvatures.at(at).collect();
        let of_second: Vec<Matrix3<f64>> = (0..own.len())
            .map(|k| {
                let sign = self.at_rest.get(k).map_or(1.0, |rest| {
                    let squared = second[k].norm_squared() * own[k].mean_squared_length();
                    (squared - rest.own).signum()
                });
                own[k].pull_bend(&second[k], &of.chords[k], sign * of.own[k])
            })
            .collect();
        let of_x = &mut of_x[self.coordinates.clone()];
        self.curvatures.add_transposed(&of_second, of_x);
    }
}
