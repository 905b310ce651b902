use super::*;
use crate::distance::{edge_edge, point_triangle};
use isosheet_mesh::{Sheet, generate};
use nalgebra::Vector3;
use proptest::prelude::*;
use std::collections::BTreeSet;

fn set(pairs: &[[u32; 2]]) -> BTreeSet<[u32; 2]> {
    let set: BTreeSet<_> = pairs.iter().copied().collect();
    assert_eq!(set.len(), pairs.len(), "a pair was reported twice");
    set
}

fn corners<const N: usize>(list: [u32; N], x: &[f64]) -> [Vector3<f64>; N] {
    list.map(|v| Vector3::from_row_slice(&x[3 * v as usize..3 * v as usize + 3]))
}

fn between(x0: &[f64], x1: &[f64], t: f64) -> Vec<f64> {
    x0.iter().zip(x1).map(|(a, b)| a + t * (b - a)).collect()
}

/// Pairs that come within `reach` of each other at one of several times: their boxes have to
/// overlap. Exact distances, no boxes.
fn close_pairs(mesh: &ContactMesh, x0: &[f64], x1: &[f64], reach: f64) -> Candidates {
    let mut vertex_face = BTreeSet::new();
    let mut edges = BTreeSet::new();
    for k in 0..=4 {
        let x = between(x0, x1, f64::from(k) / 4.0);
        for (f, face) in mesh.faces().iter().enumerate() {
            for v in 0..mesh.vertex_count() as u32 {
                let [a, b, c] = *face;
                if !face.contains(&v)
                    && point_triangle(&corners([v, a, b, c], &x)).distance() <= reach
                {
                    vertex_face.insert([v, f as u32]);
                }
            }
        }
        for (e, &[a, b]) in mesh.edges().iter().enumerate() {
            for (g, &[c, d]) in mesh.edges().iter().enumerate().skip(e + 1) {
                if ![a, b].iter().any(|v| [c, d].contains(v))
                    && edge_edge(&corners([a, b, c, d], &x)).distance() <= reach
                {
                    edges.insert([e as u32, g as u32]);
                }
            }
        }
    }
    Candidates {
        vertex_face: vertex_face.into_iter().collect(),
        edge_edge: edges.into_iter().collect(),
    }
}

/// All pairs with overlapping boxes, by testing every pair.
fn box_pairs(phase: &BroadPhase) -> Candidates {
    let mut out = Candidates::default();
    let mesh = &phase.mesh;
    for v in 0..mesh.vertex_count() {
        for f in 0..mesh.faces().len() {
            if !mesh.faces()[f].contains(&(v as u32)) && phase.vertices[v].overlaps(&phase.faces[f])
            {
                out.vertex_face.push([v as u32, f as u32]);
            }
        }
    }
    for e in 0..mesh.edges().len() {
        for g in e + 1..mesh.edges().len() {
            let shared = mesh.edges()[e].iter().any(|v| mesh.edges()[g].contains(v));
            if !shared && phase.edges[e].overlaps(&phase.edges[g]) {
                out.edge_edge.push([e as u32, g as u32]);
            }
        }
    }
    out
}

fn sheet() -> Sheet {
    generate::isotropic_square(0, 1.0).unwrap()
}

/// Displacements of the vertices, from slight waves to complete scrambling.
fn motions(n: usize) -> impl Strategy<Value = Vec<Vec<f64>>> {
    let one = (proptest::collection::vec(-1.0..1.0_f64, n), 0.0..2.0_f64)
        .prop_map(|(d, size)| d.into_iter().map(|c| c * size * size).collect());
    proptest::collection::vec(one, 3)
}

proptest! {
    #![proptest_config(isosheet_random::cases(200))]

    #[test]
    fn self_pairs_are_complete(moves in motions(3 * 9), inflation in 0.0..0.2_f64, size in -6.0..3.0_f64) {
        let sheet = sheet();
        let unit = 10.0_f64.powf(size);
        let rest: Vec<f64> = sheet.positions().iter().map(|c| unit * c).collect();
        let mut phase = BroadPhase::new(ContactMesh::from_topology(sheet.topology()), &rest);
        let mut found = Candidates::default();
        let mut x0 = rest;
        // Several refits of the same tree.
        for step in &moves {
            let x1: Vec<f64> = x0.iter().zip(step).map(|(a, d)| a + unit * d).collect();
            phase.update(&x0, &x1, unit * inflation);
            phase.self_candidates(&mut found);
            let all = box_pairs(&phase);
            let (vertex_face, edges) = (set(&found.vertex_face), set(&found.edge_edge));
            prop_assert_eq!(&vertex_face, &set(&all.vertex_face));
            prop_assert_eq!(&edges, &set(&all.edge_edge));
            let close = close_pairs(phase.mesh(), &x0, &x1, 2.0 * unit * inflation);
            prop_assert!(set(&close.vertex_face).is_subset(&vertex_face));
            prop_assert!(set(&close.edge_edge).is_subset(&edges));
            x0 = x1;
        }
    }

    #[test]
    fn cross_pairs_are_complete(moves in motions(3 * 9), others in motions(3 * 4), inflation in 0.0..0.2_f64, kind in 0..3_u8) {
        let sheet = sheet();
        let mut phase = BroadPhase::new(ContactMesh::from_topology(sheet.topology()), sheet.positions());
        // A tetrahedron, a segment, a point.
        let obstacle = match kind {
            0 => ContactMesh::from_triangles(4, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap(),
            1 => ContactMesh::segment(),
            _ => ContactMesh::point(),
        };
        let n = 3 * obstacle.vertex_count();
        let y0 = [0.2, 0.2, 0.3, 0.9, 0.2, 0.3, 0.4, 0.8, 0.3, 0.4, 0.4, 0.8];
        let mut other = BroadPhase::new(obstacle, &y0[..n]);
        let (mut x0, mut y0) = (sheet.positions().to_vec(), y0[..n].to_vec());
        let mut found = CrossCandidates::default();
        for (a, b) in moves.iter().zip(&others) {
            let x1: Vec<f64> = x0.iter().zip(a).map(|(a, d)| a + d).collect();
            let y1: Vec<f64> = y0.iter().zip(b).map(|(a, d)| a + d).collect();
            phase.update(&x0, &x1, inflation);
            other.update(&y0, &y1, 0.0);
            phase.candidates_with(&other, &mut found);
            let (vf, fv, ee) = (set(&found.vertex_face), set(&found.face_vertex), set(&found.edge_edge));
            let mut expected = [BTreeSet::new(), BTreeSet::new(), BTreeSet::new()];
            for (i, v) in phase.vertices.iter().enumerate() {
                for (j, f) in other.faces.iter().enumerate() {
                    if v.overlaps(f) { expected[0].insert([i as u32, j as u32]); }
                }
            }
            for (i, f) in phase.faces.iter().enumerate() {
                for (j, v) in other.vertices.iter().enumerate() {
                    if v.overlaps(f) { expected[1].insert([i as u32, j as u32]); }
                }
            }
            for (i, e) in phase.edges.iter().enumerate() {
                for (j, g) in other.edges.iter().enumerate() {
                    if e.overlaps(g) { expected[2].insert([i as u32, j as u32]); }
                }
            }
            prop_assert_eq!([vf, fv, ee], expected);
            x0 = x1;
            y0 = y1;
        }
    }
}

#[test]
fn a_flat_sheet_at_rest_has_only_neighbours_as_candidates() {
    let sheet = generate::isotropic_square(2, 1.0).unwrap();
    let mesh = ContactMesh::from_topology(sheet.topology());
    let mut phase = BroadPhase::new(mesh, sheet.positions());
    let mut found = Candidates::default();
    phase.update(sheet.positions(), sheet.positions(), 1e-3);
    phase.self_candidates(&mut found);
    assert!(!found.is_empty());
    let h = 1.0 / 8.0;
    let x = sheet.positions();
    for &[v, f] in &found.vertex_face {
        let [a, b, c] = phase.mesh().faces()[f as usize];
        assert!(point_triangle(&corners([v, a, b, c], x)).distance() <= 1.5 * h);
    }
    // Capacity is kept from call to call.
    let (a, b) = (found.vertex_face.capacity(), found.edge_edge.capacity());
    phase.self_candidates(&mut found);
    assert_eq!(
        (a, b),
        (found.vertex_face.capacity(), found.edge_edge.capacity())
    );
}

#[test]
fn motion_through_is_a_candidate_although_start_and_end_are_apart() {
    let sheet = sheet();
    let mut phase = BroadPhase::new(
        ContactMesh::from_topology(sheet.topology()),
        sheet.positions(),
    );
    let mut point = BroadPhase::new(ContactMesh::point(), &[0.3, 0.3, 100.0]);
    phase.update(sheet.positions(), sheet.positions(), 0.0);
    point.update(&[0.3, 0.3, 100.0], &[0.3, 0.3, -100.0], 0.0);
    let mut found = CrossCandidates::default();
    phase.candidates_with(&point, &mut found);
    assert!(!found.face_vertex.is_empty() && !found.is_empty());
    assert_eq!(found.len(), found.face_vertex.len());
    point.update(&[0.3, 0.3, 100.0], &[0.3, 0.3, 1.0], 0.0);
    phase.candidates_with(&point, &mut found);
    assert!(found.is_empty());
}
