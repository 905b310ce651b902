//! Whether the creases around a vertex fold flat together.

use std::f64::consts::TAU;
use std::fmt;

/// A crease at a vertex of a flat sheet that folds by half a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatCrease {
    /// Its direction from the vertex, radians from the x axis.
    pub direction: f64,
    /// Whether it is a mountain; otherwise it is a valley.
    pub is_mountain: bool,
}

/// A condition for the creases around a vertex inside a sheet, all of which fold by 180 degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlatFoldingLaw {
    /// Maekawa's theorem: mountains and valleys differ by two in number.
    Maekawa {
        /// Number of mountains.
        mountains: usize,
        /// Number of valleys.
        valleys: usize,
    },
    /// Kawasaki's theorem: the angles between creases, taken by turns, add up to 180 degrees twice.
    Kawasaki {
        /// The two sums, degrees.
        sums: [f64; 2],
    },
    /// The order of the layers: an angle between larger ones lies between a mountain and a valley, and of
    /// equal angles one does (Hull 1994; Bern and Hayes 1996).
    Layers {
        /// The angle, degrees.
        angle: f64,
        /// How many equal angles are side by side there.
        count: usize,
        /// Whether all creases of these are mountains; else they are valleys.
        are_mountains: bool,
        /// How many smaller angles have been folded away before, each with its mountain and its valley.
        crimps: usize,
    },
}

/// A sector between two creases, with the crease at its end.
#[derive(Clone, Copy, Debug)]
struct Sector {
    /// Radians.
    angle: f64,
    ends_in_mountain: bool,
}

impl FlatFoldingLaw {
    /// The condition that the creases around a vertex break first; `None` if they fold flat. Sums of angles
    /// that differ by no more than `tolerance` (radians) from half a turn are half a turn, and angles that
    /// differ by no more are equal.
    ///
    /// The time grows with the square of the number of creases.
    pub fn broken(creases: &[FlatCrease], tolerance: f64) -> Option<Self> {
        let mountains = creases.iter().filter(|c| c.is_mountain).count();
        let valleys = creases.len() - mountains;
        if mountains.abs_diff(valleys) != 2 {
            return Some(Self::Maekawa { mountains, valleys });
        }
        let sectors = sectors(creases);
        let mut sums = [0.0; 2];
        for (k, sector) in sectors.iter().enumerate() {
            sums[k % 2] += sector.angle;
        }
        if (sums[0] - 0.5 * TAU).abs() > tolerance {
            let sums = sums.map(f64::to_degrees);
            return Some(Self::Kawasaki { sums });
        }
        layers(sectors, tolerance)
    }
}

/// The sectors between creases, counter-clockwise.
fn sectors(creases: &[FlatCrease]) -> Vec<Sector> {
    let mut sorted = creases.to_vec();
    sorted.sort_by(|a, b| a.direction.total_cmp(&b.direction));
    let next = sorted.iter().cycle().skip(1);
    let between = sorted.iter().zip(next).map(|(from, to)| Sector {
        angle: (to.direction - from.direction).rem_euclid(TAU),
        ends_in_mountain: to.is_mountain,
    });
    between.collect()
}

/// Folds the smallest sectors away, one after the other, each with its mountain and its valley, until two
/// creases are left, or the smallest sectors lie between creases of one kind. Such a crimp changes neither
/// whether the vertex folds flat nor the difference of mountains and valleys, which is two.
fn layers(mut sectors: Vec<Sector>, tolerance: f64) -> Option<FlatFoldingLaw> {
    let mut crimps = 0;
    while sectors.len() > 2 {
        let n = sectors.len();
        let before = |k: usize| (k + n - 1) % n;
        let smallest = sectors
            .iter()
            .map(|s| s.angle)
            .fold(f64::INFINITY, f64::min);
        let is_small = |k: usize| sectors[k].angle <= smallest + tolerance;
        let is_mixed =
            |k: usize| sectors[k].ends_in_mountain != sectors[before(k)].ends_in_mountain;
        let by_size = |a: &usize, b: &usize| sectors[*a].angle.total_cmp(&sectors[*b].angle);
        let Some(k) = (0..n)
            .filter(|k| is_small(*k) && is_mixed(*k))
            .min_by(by_size)
        else {
            let first = (0..n).find(|k| is_small(*k) && !is_small(before(*k)))?;
            let run = (first..first + n).take_while(|k| is_small(k % n));
            return Some(FlatFoldingLaw::Layers {
                angle: sectors[first].angle.to_degrees(),
                count: run.count(),
                are_mountains: sectors[first].ends_in_mountain,
                crimps,
            });
        };
        // The sector and those beside it become one, which ends where the last of them did.
        sectors.rotate_left(before(k));
        let merged = sectors[0].angle - sectors[1].angle + sectors[2].angle;
        sectors[2].angle = merged;
        sectors.drain(..2);
        crimps += 1;
    }
    None
}

impl fmt::Display for FlatFoldingLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Maekawa { mountains, valleys } => write!(
                f,
                "it has {mountains} mountains and {valleys} valleys, whose numbers have to differ by 2 (Maekawa)"
            ),
            Self::Kawasaki { sums: [a, b] } => write!(
                f,
                "the angles between its creases add up to {a:.1} and {b:.1} degrees by turns, which have to be 180 \
                 (Kawasaki)"
            ),
            Self::Layers {
                angle,
                count,
                are_mountains,
                crimps,
            } => {
                if crimps > 0 {
                    let (angles, are) = match crimps {
                        1 => ("1 smaller angle".to_owned(), "is"),
                        more => (format!("{more} smaller angles"), "are"),
                    };
                    write!(
                        f,
                        "once {angles} between a mountain and a valley {are} folded, "
                    )?;
                }
                let kind = if are_mountains {
                    "mountains"
                } else {
                    "valleys"
                };
                match count {
                    1 => write!(
                        f,
                        "the angle of {angle:.1} degrees between two {kind} is smaller than both beside it, and so no \
                         order of the layers is possible (big-little-big)"
                    ),
                    _ => write!(
                        f,
                        "{count} equal angles of {angle:.1} degrees between {} {kind} are smaller than those beside \
                         them, and so no order of the layers is possible (Hull)",
                        count + 1
                    ),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use std::collections::BTreeSet;

    /// Whole degrees are exact to this, radians.
    const ROUND_OFF: f64 = 1e-9;

    /// Creases with these angles between them, degrees, the first of them at the end of the first angle.
    fn creases(sectors: &[u32], mountains: u32) -> Vec<FlatCrease> {
        let ends = sectors.iter().scan(0, |sum, sector| {
            *sum += sector;
            Some(*sum)
        });
        let crease = |(k, degrees): (usize, u32)| FlatCrease {
            direction: f64::from(degrees).to_radians(),
            is_mountain: mountains >> k & 1 == 1,
        };
        ends.enumerate().map(crease).collect()
    }

    fn folds(sectors: &[u32], mountains: u32) -> bool {
        FlatFoldingLaw::broken(&creases(sectors, mountains), ROUND_OFF).is_none()
    }

    /// All mountains and valleys with which the sectors of a vertex fold flat, by trying each order of their
    /// layers: the sectors are intervals of a line one above the other, no layer passes through a crease, and
    /// no two creases at one place on one side pass through each other.
    fn by_layers(sectors: &[u32]) -> BTreeSet<u32> {
        let n = sectors.len();
        let mut places = vec![0_i64];
        for (k, sector) in sectors.iter().enumerate() {
            let sign = if k.is_multiple_of(2) { 1 } else { -1 };
            places.push(places[k] + sign * i64::from(*sector));
        }
        assert_eq!(places[n], 0, "Kawasaki");
        let crossed = |height: &[usize]| {
            let spans = |k: usize, at: i64| {
                let [a, b] = [places[k], places[k + 1]];
                a.min(b) < at && at < a.max(b)
            };
            let within = |h: usize, [a, b]: [usize; 2]| {
                height[a].min(height[b]) < height[h] && height[h] < height[a].max(height[b])
            };
            (0..n).any(|i| {
                let crease = [i, (i + 1) % n];
                let layer_in = (0..n).any(|k| spans(k, places[i + 1]) && within(k, crease));
                // Creases of one parity are on one side.
                let crease_in = (0..n).any(|j| {
                    let [a, b] = [j, (j + 1) % n];
                    let is_other = i != j && places[i + 1] == places[j + 1] && i % 2 == j % 2;
                    is_other && within(a, crease) != within(b, crease)
                });
                layer_in || crease_in
            })
        };
        let mut found = BTreeSet::new();
        let mut heights: Vec<usize> = (0..n).collect();
        permuted(&mut heights, 0, &mut |height| {
            if !crossed(height) {
                // Every second sector is seen from behind.
                let is_mountain =
                    |k: usize| (height[(k + 1) % n] > height[k]) == k.is_multiple_of(2);
                found.insert((0..n).map(|k| u32::from(is_mountain(k)) << k).sum());
            }
        });
        found
    }

    fn permuted(items: &mut [usize], from: usize, visit: &mut impl FnMut(&[usize])) {
        if from == items.len() {
            return visit(items);
        }
        for k in from..items.len() {
            items.swap(from, k);
            permuted(items, from + 1, visit);
            items.swap(from, k);
        }
    }

    fn same_as_by_layers(sectors: &[u32]) -> usize {
        let expected = by_layers(sectors);
        for mountains in 0..1 << sectors.len() {
            let folds = folds(sectors, mountains);
            assert_eq!(
                folds,
                expected.contains(&mountains),
                "{sectors:?} {mountains:b}"
            );
        }
        expected.len()
    }

    /// Parts of 180 degrees in whole ones.
    fn parts(rng: &mut ChaCha8Rng, count: usize, unit: u32) -> Vec<u32> {
        let all = 180 / unit;
        let mut cuts: BTreeSet<u32> = BTreeSet::from([0, all]);
        while cuts.len() < count + 1 {
            cuts.insert(rng.random_range(1..all));
        }
        let cuts: Vec<u32> = cuts.into_iter().collect();
        cuts.windows(2).map(|c| unit * (c[1] - c[0])).collect()
    }

    #[test]
    fn verdicts_are_those_of_all_orders_of_layers() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for (half, units, tries) in [(2, [5, 30], 60), (3, [5, 30], 40), (4, [20, 36], 4)] {
            for unit in units {
                for _ in 0..tries {
                    let [odd, even] = [(); 2].map(|()| parts(&mut rng, half, unit));
                    let sectors: Vec<u32> = odd
                        .into_iter()
                        .zip(even)
                        .flat_map(|(a, b)| [a, b])
                        .collect();
                    same_as_by_layers(&sectors);
                }
            }
        }
    }

    /// Hull's counts: `2 C(2n, n - 1)` for `2n` equal angles, and `2^n` where each smallest angle is the only
    /// one.
    #[test]
    fn as_many_assignments_fold_as_hull_counts() {
        assert_eq!(same_as_by_layers(&[180, 180]), 2);
        assert_eq!(same_as_by_layers(&[90; 4]), 8);
        assert_eq!(same_as_by_layers(&[60; 6]), 30);
        assert_eq!(same_as_by_layers(&[45; 8]), 112);
        // The smallest angles of each stage: 40, then 80 with 100 beside it.
        assert_eq!(same_as_by_layers(&[40, 80, 140, 100]), 4);
        assert_eq!(same_as_by_layers(&[10, 50, 60, 35, 110, 95]), 8);
        // Two equal angles between larger ones have C(3, 1) ways for three creases, for either kind of the
        // one that stays.
        assert_eq!(same_as_by_layers(&[40, 40, 140, 140]), 6);
    }

    #[test]
    fn the_angle_between_creases_of_one_kind_is_told() {
        let told = |sectors: &[u32], mountains| {
            FlatFoldingLaw::broken(&creases(sectors, mountains), ROUND_OFF).unwrap()
        };
        // The smallest angle, which is the first, lies between the last crease and the first.
        let law = told(&[40, 90, 140, 90], 0b1101);
        let FlatFoldingLaw::Layers {
            angle,
            count,
            are_mountains,
            crimps,
        } = law
        else {
            panic!("{law:?}");
        };
        assert!((angle - 40.0).abs() < 1e-9);
        assert_eq!((count, are_mountains, crimps), (1, true, 0));
        let text = told(&[40, 40, 140, 140], 0b1011).to_string();
        assert!(
            text.starts_with("2 equal angles of 40.0 degrees between 3 mountains"),
            "{text}"
        );
        let law = told(&[90; 4], 0b0011);
        assert!(
            matches!(
                law,
                FlatFoldingLaw::Maekawa {
                    mountains: 2,
                    valleys: 2
                }
            ),
            "{law:?}"
        );
        let law = told(&[80, 90, 110, 80], 0b0001);
        assert!(matches!(law, FlatFoldingLaw::Kawasaki { .. }), "{law:?}");
        // The first angle is smaller than both beside it by less than the tolerance.
        let near = creases(&[80, 90, 100, 90], 0b1101);
        assert!(FlatFoldingLaw::broken(&near, ROUND_OFF).is_some());
        assert_eq!(FlatFoldingLaw::broken(&near, 21_f64.to_radians()), None);
    }
}
