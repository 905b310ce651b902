//! The order in which parts of a drawing are painted, so that what is nearer hides what is farther.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// Parts that have less in common count as beside each other: hundredths of a pixel, or of a square pixel.
const TOUCHING: f64 = 0.01;

/// A part of a drawing: a flat convex polygon, or a line.
pub(super) trait Part {
    /// Parts of one group are painted one after the other where their order is free.
    type Group: Ord + Copy;

    /// Corners or ends: places in the picture, pixels, and nearness, which is linear in between.
    fn corners(&self) -> &[[f64; 3]];

    fn group(&self) -> Self::Group;

    /// How much nearer than another part this one counts where both are as near; none for parts that never
    /// cover each other.
    fn lead(&self, other: &Self) -> Option<f64>;
}

/// The numbers of the parts in the order of painting.
///
/// Of two parts that have places in common the farther one comes first, as seen at the middle of these. Where parts
/// overlap in a circle no order is right, and of all that are left the farthest is painted.
pub(super) fn painted<P: Part>(parts: &[P]) -> Vec<usize> {
    let nearness = |part: &P| {
        let corners = part.corners();
        corners.iter().map(|c| c[2]).sum::<f64>() / corners.len() as f64
    };
    let mut by_nearness: Vec<usize> = (0..parts.len()).collect();
    by_nearness.sort_by(|a, b| nearness(&parts[*a]).total_cmp(&nearness(&parts[*b])));
    let mut place = vec![0; parts.len()];
    for (k, &part) in by_nearness.iter().enumerate() {
        place[part] = k;
    }
    // The parts that come after each, and the number of those that come before it and are left.
    let mut after = vec![Vec::new(); parts.len()];
    let mut before = vec![0; parts.len()];
    for [far, near] in covered(parts) {
        after[far].push(near);
        before[near] += 1;
    }
    // What nothing is before, by groups, each from the farthest on.
    let mut ready: BTreeMap<P::Group, BTreeSet<usize>> = BTreeMap::new();
    let mut is_painted = vec![false; parts.len()];
    let mut painted = Vec::with_capacity(parts.len());
    let add = |ready: &mut BTreeMap<P::Group, BTreeSet<usize>>, part: usize| {
        let group = ready.entry(parts[part].group()).or_default();
        group.insert(place[part]);
    };
    for part in (0..parts.len()).filter(|part| before[*part] == 0) {
        add(&mut ready, part);
    }
    let mut farthest = by_nearness.iter().copied();
    let mut group = None;
    while painted.len() < parts.len() {
        let next = match group.filter(|group| ready.contains_key(group)) {
            Some(group) => Some(group),
            None => ready.first_key_value().map(|(group, _)| *group),
        };
        let part = match next.and_then(|next| ready.get_mut(&next)?.pop_first()) {
            Some(place) => by_nearness[place],
            // A circle.
            None => match farthest.find(|part| !is_painted[*part]) {
                Some(part) => part,
                None => break,
            },
        };
        group = Some(parts[part].group());
        ready.retain(|_, places| !places.is_empty());
        is_painted[part] = true;
        painted.push(part);
        for &near in &after[part] {
            before[near] -= 1;
            if before[near] == 0 && !is_painted[near] {
                add(&mut ready, near);
            }
        }
    }
    painted
}

/// The pairs of parts of which the second one covers a part of the first one.
fn covered<P: Part>(parts: &[P]) -> Vec<[usize; 2]> {
    let of = |part: &P| {
        let places = part.corners().iter();
        Aabb::from_points(places.map(|[x, y, _]| Vector::new(*x, *y, 0.0)))
    };
    let boxes: Vec<Aabb> = parts.iter().map(of).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let mut pairs = Vec::new();
    for (i, around) in boxes.iter().enumerate() {
        for j in tree.intersect_aabb(around).map(|j| j as usize) {
            if i < j
                && let Some(lead) = parts[i].lead(&parts[j])
                && let [a, b] = [i, j].map(|k| parts[k].corners())
                && let Some(middle) = common(a, b)
            {
                let ahead = nearness(a, middle) - nearness(b, middle) + lead;
                match ahead.total_cmp(&0.0) {
                    Ordering::Less => pairs.push([i, j]),
                    Ordering::Equal => {}
                    Ordering::Greater => pairs.push([j, i]),
                }
            }
        }
    }
    pairs
}

/// The middle of what two parts have in common in the picture; none if that is nothing, and of two lines.
fn common(a: &[[f64; 3]], b: &[[f64; 3]]) -> Option<[f64; 2]> {
    let (cut, by) = if b.len() > 2 { (a, b) } else { (b, a) };
    if by.len() < 3 {
        return None;
    }
    // Sutherland and Hodgman: what is left of one beyond the sides of the other.
    let mut left: Vec<[f64; 2]> = cut.iter().map(|[x, y, _]| [*x, *y]).collect();
    let turn = area(by.iter().map(|[x, y, _]| [*x, *y])).signum();
    for k in 0..by.len() {
        let ([ax, ay, _], [bx, by, _]) = (by[k], by[(k + 1) % by.len()]);
        let height = |p: &[f64; 2]| turn * ((bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax));
        let mut inside = Vec::with_capacity(left.len() + 1);
        for (i, p) in left.iter().enumerate() {
            let q = &left[(i + 1) % left.len()];
            let (here, there) = (height(p), height(q));
            if here >= 0.0 {
                inside.push(*p);
            }
            if (here >= 0.0) != (there >= 0.0) {
                let part = here / (here - there);
                inside.push([0, 1].map(|k| p[k] + part * (q[k] - p[k])));
            }
        }
        left = inside;
    }
    let mean = |k: usize| left.iter().map(|p| p[k]).sum::<f64>() / left.len() as f64;
    let middle = [mean(0), mean(1)];
    let size = match cut.len() {
        2 => left
            .iter()
            .map(|p| 2.0 * (p[0] - middle[0]).hypot(p[1] - middle[1]))
            .fold(0.0, f64::max),
        _ => area(left.iter().copied()).abs(),
    };
    (size > TOUCHING).then_some(middle)
}

/// The area of a polygon, positive if its corners run clockwise in the picture, whose y points downwards.
fn area(places: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let next = places.clone().cycle().skip(1);
    let twice: f64 = places
        .zip(next)
        .map(|(p, q)| p[0] * q[1] - p[1] * q[0])
        .sum();
    0.5 * twice
}

/// The nearness of a part at a place.
fn nearness(corners: &[[f64; 3]], [x, y]: [f64; 2]) -> f64 {
    match *corners {
        [a, b, c, ..] => {
            let twice =
                |p: [f64; 3], q: [f64; 3]| (p[0] - x) * (q[1] - y) - (q[0] - x) * (p[1] - y);
            let weights = [twice(b, c), twice(c, a), twice(a, b)];
            let sum: f64 = weights.iter().sum();
            (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / sum
        }
        [a, b] => {
            let along = [b[0] - a[0], b[1] - a[1]];
            let square = along[0] * along[0] + along[1] * along[1];
            let part = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / square;
            a[2] + part * (b[2] - a[2])
        }
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle of a group.
    struct Triangle([[f64; 3]; 3], u32);

    impl Part for Triangle {
        type Group = u32;

        fn corners(&self) -> &[[f64; 3]] {
            &self.0
        }

        fn group(&self) -> u32 {
            self.1
        }

        fn lead(&self, _: &Self) -> Option<f64> {
            Some(0.0)
        }
    }

    /// A large face that is nearer on the whole, and a small one before its far corner: the order by mean depths, which
    /// is the other one, is wrong.
    #[test]
    fn what_counts_is_the_place_where_parts_overlap() {
        let large = Triangle([[0.0, 0.0, 0.0], [90.0, 0.0, 90.0], [0.0, 90.0, 90.0]], 0);
        let small = Triangle([[0.0, 0.0, 20.0], [9.0, 0.0, 20.0], [0.0, 9.0, 20.0]], 0);
        assert_eq!(painted(&[large, small]), [0, 1]);
    }

    /// Three sticks, each of which is over the next one at one end and under the one before at the other, can be
    /// painted in no right order, and are painted all the same. Without one of them there is a right order.
    #[test]
    fn circles_end() {
        let stick = |k: u32| {
            let turn = |x: f64, y: f64, nearness: f64| {
                let (s, c) = (f64::from(k) * std::f64::consts::TAU / 3.0).sin_cos();
                [c * x - s * y, s * x + c * y, nearness]
            };
            let corners = [
                turn(-30.0, 10.0, 0.0),
                turn(30.0, 7.0, 9.0),
                turn(30.0, 13.0, 9.0),
            ];
            Triangle(corners, 0)
        };
        let mut all = painted(&[stick(0), stick(1), stick(2)]);
        all.sort_unstable();
        assert_eq!(all, [0, 1, 2]);
        let two = painted(&[stick(0), stick(1)]);
        let middle = common(&stick(0).0, &stick(1).0).unwrap();
        let [first, second] = [two[0], two[1]].map(|k| nearness(&stick(k as u32).0, middle));
        assert!(first < second, "{two:?}");
    }

    /// Parts of a group that do not cover each other follow one another.
    #[test]
    fn groups_stay_together() {
        let at =
            |x: f64, group: u32| Triangle([[x, 0.0, x], [x + 5.0, 0.0, x], [x, 5.0, x]], group);
        let parts: Vec<Triangle> = (0..9).map(|k| at(10.0 * f64::from(k), k % 3)).collect();
        let groups: Vec<u32> = painted(&parts).into_iter().map(|k| parts[k].1).collect();
        assert_eq!(groups, [0, 0, 0, 1, 1, 1, 2, 2, 2]);
    }

    /// Faces with a side in common are beside each other, whatever their nearness is elsewhere.
    #[test]
    fn neighbours_touch_only() {
        let side = [[3.0, 1.0, 0.0], [5.1, 70.3, 8.0]];
        let [left, right] = [[-40.0, 33.0, 5.0], [60.0, 41.0, -9.0]];
        let [a, b] = [[side[0], side[1], left], [side[1], side[0], right]];
        assert_eq!(common(&a, &b), None);
        let middle = common(&a, &[side[0], side[1]]).unwrap();
        assert!((nearness(&a, middle) - nearness(&b, middle)).abs() < 1e-9);
    }
}
