//! Front propagation against the published algorithm word by word, and the counting identities.

use super::*;
use crate::testing::{isotropic_square, random_sheet};
use isosheet_mesh::{Advice, EdgeId};
use proptest::prelude::*;

/// The algorithm of Sec. 3.3 as printed: quadratic, no priority structure. Vertex, front, known neighbours.
fn literal(sheet: &Sheet, start: VertexId) -> Vec<(VertexId, u32, usize)> {
    let t = sheet.topology();
    let mut mark = vec![false; t.vertex_count()];
    mark[start.index()] = true;
    let mut order = vec![(start, 0, 0)];
    let unmarked = |mark: &[bool], layer: &[VertexId]| {
        let mut front: Vec<VertexId> = Vec::new();
        for v in layer {
            for w in t.neighbours(*v) {
                if !mark[w.index()] && !front.contains(&w) {
                    front.push(w);
                }
            }
        }
        front
    };
    let mut front = unmarked(&mark, &[start]);
    let mut number = 0;
    while !front.is_empty() {
        number += 1;
        let copy = front.clone();
        while !front.is_empty() {
            let (mut max_cstr, mut max_v) = (0, 0);
            for (i, v) in front.iter().enumerate() {
                let cstr = t.neighbours(*v).filter(|w| mark[w.index()]).count();
                if cstr > max_cstr {
                    (max_cstr, max_v) = (cstr, i);
                }
            }
            let v = front.remove(max_v);
            mark[v.index()] = true;
            order.push((v, number, max_cstr));
        }
        front = unmarked(&mark, &copy);
    }
    order
}

fn starts(level: u32) -> [VertexId; 3] {
    let m = 1u32 << (level + 1);
    let half = m / 2;
    [0, half + half * (m + 1), half].map(VertexId)
}

#[test]
fn union_jack_squares_need_no_closures() {
    for level in 0..=4 {
        let sheet = isotropic_square(level, 1.0);
        let boundary = sheet.topology().boundary_edge_count();
        let vertices = sheet.topology().vertex_count();
        for v in starts(level) {
            let a = sys_coord_assnmt_single(&sheet, StartVertex::Pinned(v)).unwrap();
            assert_eq!(a.rule_count('p'), 1);
            assert_eq!(a.rule_count('h'), 1, "M^{level} from {v}");
            assert_eq!(a.rule_count('g'), boundary - 2, "M^{level} from {v}");
            assert_eq!(a.rule_count('f'), vertices - boundary, "M^{level} from {v}");
            assert!(a.closures().is_empty());
            assert_eq!(a.dof(), boundary);
            let free = sys_coord_assnmt_single(&sheet, StartVertex::Free(v)).unwrap();
            assert_eq!(free.coordinate_count(), boundary + 3);
            // Lemma 2: 11, 19, 35, 67, 131.
            assert_eq!(free.dof(), (8 << level) + 3);
        }
    }
}

#[test]
fn same_order_as_the_published_algorithm() {
    for level in 0..=2 {
        let sheet = isotropic_square(level, 1.0);
        for v in 0..sheet.topology().vertex_count() as u32 {
            let a = sys_coord_assnmt_single(&sheet, StartVertex::Pinned(VertexId(v))).unwrap();
            let b = literal(&sheet, VertexId(v));
            for (p, (w, front, known)) in a.order().iter().zip(b) {
                assert_eq!((p.vertex, p.front), (w, front));
                assert_eq!(p.rule.known().len(), known.min(3));
            }
        }
    }
}

#[test]
fn rules_use_vertices_placed_before() {
    let sheet = isotropic_square(3, 1.0);
    let a = sys_coord_assnmt_single(&sheet, StartVertex::Pinned(VertexId(5))).unwrap();
    let mut known = vec![false; sheet.topology().vertex_count()];
    for p in a.order() {
        assert!(p.rule.known().iter().all(|w| known[w.index()]));
        assert_eq!(a.placing(p.vertex), p);
        if let Rule::F {
            known: k,
            edges,
            hub: Some(hub),
        } = p.rule
        {
            // The hub edge ends in the middle neighbour, which is joined to the two others.
            assert_eq!(hub, edges[1]);
            let t = sheet.topology();
            assert_eq!(t.other_end(hub, p.vertex), k[1]);
            assert!(t.neighbours(k[1]).any(|w| w == k[0]));
            assert!(t.neighbours(k[1]).any(|w| w == k[2]));
        }
        known[p.vertex.index()] = true;
    }
    assert!(known.iter().all(|k| *k));
}

#[test]
fn closed_band_has_closures() {
    // Two rings of n vertices: no disk, DOF = B + 3 chi = 2n.
    let n = 8u32;
    let mut x = Vec::new();
    for ring in 0..2 {
        for i in 0..n {
            let t = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            let r = 1.0 + f64::from(ring);
            x.extend([r * t.cos(), r * t.sin(), 0.0]);
        }
    }
    let mut faces = Vec::new();
    for i in 0..n {
        let j = (i + 1) % n;
        faces.push([i, n + i, n + j]);
        faces.push([i, n + j, j]);
    }
    let sheet = Sheet::new(x, &faces).unwrap();
    let a = sys_coord_assnmt_single(&sheet, StartVertex::Free(VertexId(0))).unwrap();
    assert!(!a.closures().is_empty());
    assert_eq!(a.dof(), 2 * n as usize);
}

#[test]
fn figure_7_is_assigned_on_request() {
    // A vertex with three known neighbours on a line: a fan whose rim is straight.
    let x = vec![
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0, 1.0, 0.0, //
    ];
    let sheet = Sheet::new(x, &[[0, 1, 3], [1, 2, 3]]).unwrap();
    let options = |degenerate| AssignmentOptions {
        pins: vec![VertexId(0), VertexId(1), VertexId(2)],
        degenerate,
        ..Default::default()
    };
    let carried = assign(&sheet, sheet.positions(), &options(Degenerate::Carry)).unwrap();
    assert_eq!((carried.rule_count('f'), carried.dof()), (1, 0));
    let line = assign(&sheet, sheet.positions(), &options(Degenerate::Assign)).unwrap();
    assert_eq!(line.rule_count('t'), 1);
    assert_eq!((line.coordinate_count(), line.closures().len()), (1, 1));
    let Rule::Turn { known, .. } = line.placing(VertexId(3)).rule else {
        panic!("rule of vertex 3")
    };
    assert_eq!(
        known[2],
        VertexId(1),
        "the outer two are seen under 90 degrees"
    );
    // With the middle of the three out of the plane it is rule f again.
    let mut x = sheet.positions().to_vec();
    x[5] = 0.8;
    let bent = assign(&sheet, &x, &options(Degenerate::Assign)).unwrap();
    assert_eq!(bent.rule_count('f'), 1);
}

#[test]
fn bad_requests() {
    let sheet = isotropic_square(0, 1.0);
    let v = VertexId;
    let ask = |pins: Vec<VertexId>, starts: Vec<VertexId>| {
        let options = AssignmentOptions {
            pins,
            starts,
            ..Default::default()
        };
        assign(&sheet, sheet.positions(), &options).unwrap_err()
    };
    assert_eq!(
        ask(vec![v(9)], vec![]),
        AssignmentError::NoSuchVertex {
            vertex: v(9),
            count: 9
        }
    );
    assert_eq!(
        ask(vec![v(1), v(1)], vec![]),
        AssignmentError::Repeated { vertex: v(1) }
    );
    assert_eq!(
        ask(vec![v(1)], vec![v(2)]),
        AssignmentError::UnusedStart { vertex: v(2) }
    );
    assert!(matches!(
        assign(&sheet, &[0.0; 3], &AssignmentOptions::default()),
        Err(AssignmentError::StateLength { .. })
    ));
}

proptest! {
    #![proptest_config(isosheet_random::cases(256))]

    #[test]
    fn any_mesh_any_start(splits in 1..40usize, seed in 0..1000u64, start in 0..1000u32, pins in 0..4u32) {
        let sheet = random_sheet(splits, seed);
        let t = sheet.topology();
        let count = t.vertex_count() as u32;
        let pins: Vec<VertexId> = (0..pins.min(count)).map(|i| VertexId((start + 7 * i) % count)).collect();
        let mut unique = pins.clone();
        unique.sort();
        unique.dedup();
        let starts = if pins.is_empty() { vec![VertexId(start % count)] } else { vec![] };
        let options = AssignmentOptions { pins: unique.clone(), starts, ..Default::default() };
        let a = assign(&sheet, sheet.positions(), &options).unwrap();
        let pinned = |v: &VertexId| unique.contains(v);
        let edges = t.edges().iter().filter(|[a, b]| !(pinned(a) && pinned(b))).count() as i64;
        let dof = 3 * (i64::from(count) - unique.len() as i64) - edges;
        prop_assert_eq!(a.coordinate_count() as i64 - a.closures().len() as i64, dof);
        // Every edge is used exactly once, by its later end or as a closure.
        let mut used = vec![0; t.edge_count()];
        for p in a.order() {
            let edges: &[EdgeId] = match &p.rule {
                Rule::H { edge, .. } => std::slice::from_ref(edge),
                Rule::G { edges, .. } => edges,
                Rule::F { edges, .. } => edges,
                _ => &[],
            };
            for e in edges { used[e.index()] += 1; }
        }
        for c in a.closures() { used[c.edge.index()] += 1; }
        for (n, [a, b]) in used.iter().zip(t.edges()) {
            prop_assert_eq!(*n, i32::from(!(pinned(a) && pinned(b))));
        }
    }

    #[test]
    fn several_components(splits in 1..6usize) {
        let one = random_sheet(splits, 3);
        let n = one.topology().vertex_count() as u32;
        let mut x = one.positions().to_vec();
        x.extend(one.positions());
        let mut faces: Vec<[u32; 3]> = one.topology().faces().iter().map(|f| f.map(|v| v.0)).collect();
        faces.extend(faces.clone().iter().map(|f| f.map(|v| v + n)));
        let sheet = Sheet::new(x, &faces).unwrap();
        let a = sys_coord_assnmt_single(&sheet, StartVertex::Pinned(VertexId(1))).unwrap();
        let single = sys_coord_assnmt_single(&one, StartVertex::Free(VertexId(0))).unwrap();
        prop_assert_eq!(a.dof(), 2 * single.dof() - 3);
        prop_assert_eq!(a.rule_count('s'), 1);
    }
}

#[test]
fn volumes_are_those_of_unit_vectors() {
    let sheet = isotropic_square(0, 1.0);
    let ask = |volume: f64| {
        let options = AssignmentOptions {
            volume,
            ..Default::default()
        };
        let found = assign(&sheet, sheet.positions(), &options).map(|_| ());
        assert_eq!(found.is_ok(), options.validate().is_ok());
        found
    };
    assert_eq!(AssignmentOptions::default().validate(), Ok(()));
    for volume in [0.0, 1.0] {
        assert_eq!(ask(volume), Ok(()));
    }
    for volume in [-1e-300, 1.0 + f64::EPSILON, f64::INFINITY] {
        assert_eq!(ask(volume), Err(AssignmentError::Volume { volume }));
    }
    let error = ask(f64::NAN).unwrap_err();
    assert!(matches!(error, AssignmentError::Volume { volume } if volume.is_nan()));
    let advice = error.advice().expect("there is a range");
    assert!(advice.contains("from 0 to 1"), "{advice}");
}
