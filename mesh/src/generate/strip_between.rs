//! Developable strips between two curves.

use super::error::{GenerateError, check_count, check_faces};
use super::space_curve::SpaceCurve;
use crate::Sheet;
use crate::vec3::{Vec3, cross, dot, norm, sub, unit};

/// A strip between two curves.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RuledStrip {
    /// The strip in space, in columns of triangles. Vertex (i, j) has the number `i + j columns`, where a
    /// strip that is not closed has one column more than it has cells; row 0 is the first curve.
    pub sheet: Sheet,
    /// The ends of each ruling, on the first and on the second curve, metres.
    pub rulings: Vec<[[f64; 3]; 2]>,
    /// The largest angle, radians, between the planes that a ruling spans with the tangents of both curves: 0
    /// for a developable strip.
    pub twist: f64,
}

/// The strip between two curves that is developable, or as nearly so as it can be.
///
/// The curves go smoothly through their points (metres); both are closed if the last point of each is its
/// first one. A ruling from `p1` to `p2` belongs to a developable surface if it lies in one plane with the
/// tangents `t1` and `t2` there: `D = det(t1, t2, p2 - p1) = 0`, of unit vectors (Liu, Pottmann, Wallner,
/// Yang and Wang, *Geometric modeling with conical meshes and developable surfaces*, ACM Trans. Graph. 25,
/// 2006; Tang, Bo, Wallner and Pottmann, *Interactive design of developable surfaces*, ACM Trans. Graph. 35,
/// 2016). The twist of a ruling is the angle between the planes that it spans with both tangents. Rulings run
/// along both curves from start to end and never back. Dynamic programming finds the way with the least sum
/// of squared sines of the twist. Then each ruling moves to the next zero of `D`, or to the least twist where
/// there is none near. An open curve that runs against the other one is reversed.
///
/// `columns` cells lie between the rulings, at equal parts of both lengths together, and `rows` of them
/// across. The rest lengths are the lengths in space.
///
/// ```
/// use isosheet_mesh::generate::strip_between;
/// // Two arcs of circles about one axis: a piece of a cone.
/// let arc = |radius: f64, z: f64| -> Vec<[f64; 3]> {
///     (0..=20).map(|k| 0.1 * f64::from(k)).map(|a| [radius * a.cos(), radius * a.sin(), z]).collect()
/// };
/// let strip = strip_between(&arc(0.2, 0.0), &arc(0.1, 0.15), 24, 1)?;
/// assert!(strip.twist < 1e-6);
/// # Ok::<(), isosheet_mesh::generate::GenerateError>(())
/// ```
///
/// # Errors
/// [`GenerateError`] for a curve with fewer than two points or with points in the same place, for an open
/// curve and a closed one, for curves that meet, for counts below one (three columns of a closed strip), and
/// for too many faces.
pub fn strip_between(
    first: &[[f64; 3]],
    second: &[[f64; 3]],
    columns: usize,
    rows: usize,
) -> Result<RuledStrip, GenerateError> {
    let first = SpaceCurve::through("first", first)?;
    let second = SpaceCurve::through("second", second)?;
    let is_closed = first.is_closed;
    if is_closed != second.is_closed {
        let name = if is_closed { "second" } else { "first" };
        let problem = "it is open, and the other curve is closed";
        return Err(GenerateError::Curve {
            name,
            point: 0,
            problem,
        });
    }
    check_count("columns", columns, if is_closed { 3 } else { 1 })?;
    check_count("rows", rows, 1)?;
    check_faces(2 * columns as u128 * rows as u128)?;
    let pairs = Pairs::best(first, second, columns);
    let ways = pairs.rulings(columns);
    let twist = ways.iter().map(|[s, t]| pairs.twist(*s, *t));
    let twist = twist.fold(0.0, f64::max);
    let mut rulings: Vec<[Vec3; 2]> = ways.iter().map(|[s, t]| pairs.ends(*s, *t)).collect();
    if is_closed {
        rulings.pop();
    }
    // Beside a shorter one faces would have no area.
    let shortest = Sheet::MIN_RELATIVE_ALTITUDE * pairs.first.length();
    for (ruling, [p, q]) in rulings.iter().enumerate() {
        let length = norm(sub(*q, *p));
        if length <= shortest {
            let place = *p;
            return Err(GenerateError::CurvesMeet {
                ruling,
                place,
                length,
            });
        }
    }
    let n = rulings.len();
    let mut x = Vec::with_capacity(3 * n * (rows + 1));
    for j in 0..=rows {
        let part = j as f64 / rows as f64;
        for [p, q] in &rulings {
            x.extend([0, 1, 2].map(|k| (1.0 - part) * p[k] + part * q[k]));
        }
    }
    let number = |i: usize, j: usize| (i % n + j * n) as u32;
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j]));
    let faces: Vec<[u32; 3]> = cells
        .flat_map(|[i, j]| {
            let [a, b] = [number(i, j), number(i + 1, j)];
            let [d, c] = [number(i, j + 1), number(i + 1, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Ok(RuledStrip {
        sheet: Sheet::new(x, &faces)?,
        rulings,
        twist,
    })
}

/// Places along two curves: parts of their lengths.
struct Pairs {
    first: SpaceCurve,
    second: SpaceCurve,
    /// What is added to the part of the second curve, for closed ones.
    shift: f64,
    /// Places along both curves after each of `2 cells` steps: the numbers of cells along the first one.
    way: Vec<usize>,
    cells: usize,
    /// What the square of the length of a ruling costs.
    weight: f64,
}

/// Cells along each curve for the dynamic programming: enough to tell apart the zeros of curves with a
/// hundred bends, and their square takes a second at most.
const MOST_CELLS: usize = 512;

/// Rulings at which a closed strip may start that are tried: curves that bend like circles and ellipses have
/// two for each of both ways round.
const MOST_STARTS: usize = 16;

impl Pairs {
    /// The best way along both curves.
    fn best(first: SpaceCurve, second: SpaceCurve, columns: usize) -> Self {
        let cells = (2 * columns).clamp(64, MOST_CELLS);
        let of = |second: &SpaceCurve, shift: f64| {
            let mut pairs = Self {
                first: first.clone(),
                second: second.clone(),
                shift,
                way: Vec::new(),
                cells,
                weight: 0.0,
            };
            pairs.find_way();
            (pairs.mean_cost(columns), pairs)
        };
        if !first.is_closed {
            let far = |a: f64, b: f64| norm(sub(first.at(a)[0], second.at(b)[0]));
            let crosswise = far(0.0, 1.0) + far(1.0, 0.0) < far(0.0, 0.0) + far(1.0, 1.0);
            let second = if crosswise { second.reversed() } else { second };
            return of(&second, 0.0).1;
        }
        // A closed strip starts with a ruling that is one of a developable surface: the shortest ones are
        // tried.
        let mut starts = Vec::new();
        for second in [second.reversed(), second.clone()] {
            let probe = Self {
                first: first.clone(),
                second,
                shift: 0.0,
                way: Vec::new(),
                cells,
                weight: 0.0,
            };
            let determinant = |t: f64| probe.determinant(0.0, t);
            for k in 0..cells {
                let [low, high] = [k, k + 1].map(|k| k as f64 / cells as f64);
                if determinant(low) == 0.0 || determinant(low) * determinant(high) < 0.0 {
                    let shift = zero(determinant, low, high);
                    let [p, q] = probe.ends(0.0, shift);
                    starts.push((norm(sub(q, p)), shift, probe.second.clone()));
                }
            }
        }
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best = of(&second, 0.0);
        for (_, shift, second) in starts.iter().take(MOST_STARTS) {
            let found = of(second, *shift);
            best = if found.0 < best.0 { found } else { best };
        }
        best.1
    }

    /// Both ends of a ruling.
    fn ends(&self, s: f64, t: f64) -> [Vec3; 2] {
        [self.first.at(s)[0], self.second.at(t + self.shift)[0]]
    }

    /// `D` of unit vectors; 0 where the curves meet.
    fn determinant(&self, s: f64, t: f64) -> f64 {
        let ([p, u], [q, v]) = (self.first.at(s), self.second.at(t + self.shift));
        dot(cross(unit(u), unit(v)), unit(sub(q, p)))
    }

    /// The angle between the planes of a ruling with both tangents.
    fn twist(&self, s: f64, t: f64) -> f64 {
        squared_sine(&self.first.at(s), &self.second.at(t + self.shift))
            .sqrt()
            .min(1.0)
            .asin()
    }

    /// What a ruling costs: the squared sine of its twist, and a part of its squared length that decides
    /// between ways that are alike. On a grid of `G` cells zeros are met to `1 / G`, so that squares have
    /// errors of `1 / G^2`: this is the weight of the square of the length, as a part of the mean one of all
    /// pairs.
    fn cost(&self, one: &[Vec3; 2], other: &[Vec3; 2]) -> f64 {
        let ruling = sub(other[0], one[0]);
        squared_sine(one, other) + self.weight * dot(ruling, ruling)
    }

    /// What rulings cost in the mean.
    fn mean_cost(&self, columns: usize) -> f64 {
        let rulings = self.rulings(columns).into_iter();
        let cost = |[s, t]: [f64; 2]| self.cost(&self.first.at(s), &self.second.at(t + self.shift));
        rulings.map(cost).sum::<f64>() / (columns + 1) as f64
    }

    /// Finds the way along both curves with the least sum of costs.
    fn find_way(&mut self) {
        let n = self.cells;
        let place = |k: usize| k as f64 / n as f64;
        let rows: Vec<[Vec3; 2]> = (0..=n).map(|i| self.first.at(place(i))).collect();
        let columns = (0..=n).map(|j| self.second.at(place(j) + self.shift));
        let columns: Vec<[Vec3; 2]> = columns.collect();
        let squared = rows.iter().flat_map(|[p, _]| {
            columns.iter().map(move |[q, _]| {
                let ruling = sub(*q, *p);
                dot(ruling, ruling)
            })
        });
        let mean = squared.sum::<f64>() / ((n + 1) * (n + 1)) as f64;
        self.weight = 1.0 / (mean * (n * n) as f64);
        let cost = |i: usize, j: usize| self.cost(&rows[i], &columns[j]);
        let width = n + 1;
        let mut sums = vec![f64::INFINITY; width * width];
        // The sums at the two cells from which the way may come.
        let before = |sums: &[f64], i: usize, j: usize| {
            let at = |i: Option<usize>, j: Option<usize>| {
                i.zip(j).map_or(f64::INFINITY, |(i, j)| sums[i * width + j])
            };
            [at(i.checked_sub(1), Some(j)), at(Some(i), j.checked_sub(1))]
        };
        sums[0] = cost(0, 0);
        for i in 0..=n {
            for j in 0..=n {
                if i + j > 0 {
                    let [left, below] = before(&sums, i, j);
                    sums[i * width + j] = left.min(below) + cost(i, j);
                }
            }
        }
        let (mut i, mut j) = (n, n);
        let mut way = vec![n];
        while i + j > 0 {
            let [left, below] = before(&sums, i, j);
            (i, j) = if left <= below {
                (i - 1, j)
            } else {
                (i, j - 1)
            };
            way.push(i);
        }
        way.reverse();
        self.way = way;
    }

    /// Parts of both curves for each ruling: at equal parts of both together, at the zero of `D` next to the
    /// way, or where the cost is least there.
    fn rulings(&self, columns: usize) -> Vec<[f64; 2]> {
        /// Of an even step at least this part is made along each curve, so that no cell lacks a side.
        const LEAST_STEP: f64 = 0.01;
        let n = self.cells as f64;
        let least_step = LEAST_STEP / columns as f64;
        let mut rulings: Vec<[f64; 2]> = vec![[0.0; 2]];
        for k in 1..columns {
            let sum = 2.0 * k as f64 / columns as f64;
            let at = |s: f64| [s, sum - s];
            let step = (sum * n).floor() as usize;
            let [a, b] = [step, step + 1].map(|k| self.way[k.min(self.way.len() - 1)] as f64);
            let s = (a + (sum * n - step as f64) * (b - a)) / n;
            let before = rulings[k - 1].map(|c| c + least_step);
            // Both curves are left room to end at their ends.
            let most = 1.0 - least_step * (columns - k) as f64;
            let low = before[0].max(sum - most);
            let high = (sum - before[1]).min(most).max(low);
            let s = s.clamp(low, high);
            let near = [(s - 2.0 / n).max(low), (s + 2.0 / n).min(high)];
            let determinant = |s: f64| self.determinant(at(s)[0], at(s)[1]);
            // The zero that is next to the way, of the two sides of it.
            let sides = [[near[0], s], [s, near[1]]];
            let crosses = |[a, b]: &&[f64; 2]| determinant(*a) * determinant(*b) <= 0.0;
            let found = match sides.iter().find(crosses) {
                Some([a, b]) => zero(determinant, *a, *b),
                None => least(
                    |s| {
                        let [s, t] = at(s);
                        self.cost(&self.first.at(s), &self.second.at(t + self.shift))
                    },
                    near,
                ),
            };
            rulings.push(at(found));
        }
        rulings.push([1.0; 2]);
        rulings
    }
}

/// The squared sine of the angle between the planes that a ruling spans with the tangents at its ends. Where
/// a tangent runs along the ruling it is the square of the determinant of the three unit vectors.
fn squared_sine([p, u]: &[Vec3; 2], [q, v]: &[Vec3; 2]) -> f64 {
    let (u, v, ruling) = (unit(u), unit(v), unit(sub(q, p)));
    let [m, n] = [u, v].map(|t| cross(t, ruling));
    let determinant = dot(cross(u, v), ruling);
    let sines = norm(m) * norm(n);
    // Squares of sines below are round-off.
    match sines > f64::EPSILON.sqrt() {
        true => (determinant / sines).powi(2).min(1.0),
        false => determinant * determinant,
    }
}

/// The zero of a function between two places of different signs, by bisection.
fn zero(of: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let at_low = of(low);
    if at_low == 0.0 {
        return low;
    }
    // Each step gains a digit of 53.
    for _ in 0..53 {
        let middle = 0.5 * (low + high);
        match of(middle) * at_low > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

/// The place of the least value of a function between two places, by the golden section.
fn least(of: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    // A least value is known to half of the digits, which 40 steps reach.
    for _ in 0..40 {
        let [a, b] = [high - golden * (high - low), low + golden * (high - low)];
        match of(a) <= of(b) {
            true => high = b,
            false => low = a,
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests;
