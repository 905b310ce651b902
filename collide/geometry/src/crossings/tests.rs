use super::*;
use crate::{BroadPhase, Candidates, CcdOptions, CrossCandidates, MeshMotion};
use isosheet_mesh::generate;
use proptest::prelude::*;

fn add(x: &[f64], dx: &[f64], t: f64) -> Vec<f64> {
    x.iter().zip(dx).map(|(x, d)| x + t * d).collect()
}

proptest! {
    #![proptest_config(isosheet_random::cases(40))]

    /// A sheet whose vertices are thrown about at random, each step cut to what is proven safe: it
    /// never passes through itself, and the same motions uncut do.
    #[test]
    fn a_sheet_thrown_about_never_crosses_itself(
        throws in proptest::collection::vec(proptest::collection::vec(-1.0..1.0_f64, 3 * 25), 12),
        size in -6.0..3.0_f64,
    ) {
        let unit = 10.0_f64.powf(size);
        let sheet = generate::isotropic_square(1, unit).unwrap();
        let mesh = ContactMesh::from_topology(sheet.topology());
        prop_assert_eq!(mesh.vertex_count(), 25);
        let mut phase = BroadPhase::new(mesh.clone(), sheet.positions());
        let mut candidates = Candidates::default();
        let mut x = sheet.positions().to_vec();
        let options = CcdOptions::default();
        let mut cut = 0;
        for throw in &throws {
            let dx: Vec<f64> = throw.iter().map(|d| 0.5 * unit * d).collect();
            let goal = add(&x, &dx, 1.0);
            phase.update(&x, &goal, 0.0);
            phase.self_candidates(&mut candidates);
            let before = candidates.smallest_distance(&mesh, &x);
            let t = candidates.safe_part(&options, MeshMotion { mesh: &mesh, x: &x, dx: &dx });
            cut += usize::from(t < 1.0);
            x = add(&x, &dx, t);
            prop_assert_eq!(crossings(&mesh, &x), Vec::<[u32; 2]>::new());
            prop_assert!(candidates.smallest_distance(&mesh, &x) > 0.0);
            prop_assert!(before > 0.0);
        }
        prop_assert!(cut > 0, "no step was cut");
        // One throw as far as the sheet is wide, uncut: the test for crossings does find some.
        let far = add(sheet.positions(), &throws[0].iter().map(|d| unit * d).collect::<Vec<_>>(), 1.0);
        prop_assert!(!crossings(&mesh, &far).is_empty());
    }

    /// A tetrahedron shot through a sheet at a thousand sheet sizes per step stops before it.
    #[test]
    fn a_fast_body_does_not_tunnel(
        place in proptest::array::uniform2(0.1..0.9_f64), gap in 1e-6..1.0_f64, speed in 1.0..1000.0_f64, thickness in 0.0..0.9_f64,
    ) {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let mesh = ContactMesh::from_topology(sheet.topology());
        let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let body = ContactMesh::from_triangles(4, &tetrahedron).unwrap();
        let [u, v] = place;
        let y = [u, v, gap, u + 0.1, v, gap + 0.2, u, v + 0.1, gap + 0.2, u, v, gap + 0.3];
        let dy: Vec<f64> = (0..12).map(|k| if k % 3 == 2 { -speed } else { 0.0 }).collect();
        let x = sheet.positions();
        let separation = thickness * gap;
        let rest = vec![0.0; x.len()];
        let [mut phase, mut of_body] = [(&mesh, x), (&body, &y[..])].map(|(mesh, x)| BroadPhase::new(mesh.clone(), x));
        phase.update(x, x, separation);
        of_body.update(&y, &add(&y, &dy, 1.0), 0.0);
        let mut pairs = CrossCandidates::default();
        phase.candidates_with(&of_body, &mut pairs);
        let options = CcdOptions { separation, ..CcdOptions::default() };
        let (first, second) = (MeshMotion { mesh: &mesh, x, dx: &rest }, MeshMotion { mesh: &body, x: &y, dx: &dy });
        let t = pairs.safe_part(&options, first, second);
        let impact = (gap - separation) / speed;
        prop_assert!(t < impact && t > 0.8 * impact, "{t} {impact}");
        let stopped = add(&y, &dy, t);
        prop_assert!(crossings_between(&body, &stopped, &mesh, x).is_empty());
        prop_assert!(crossings_between(&mesh, x, &body, &stopped).is_empty());
        let through = add(&y, &dy, (gap + 0.1) / speed);
        prop_assert!(!crossings_between(&body, &through, &mesh, x).is_empty());
    }
}

/// A flat sheet crosses nothing, in whatever plane round-off leaves it.
#[test]
fn tilted_planes_do_not_cross() {
    let sheet = generate::isotropic_square(2, 1.0).unwrap();
    let mesh = ContactMesh::from_topology(sheet.topology());
    for k in 0..20 {
        let turn = nalgebra::Rotation3::new(Vector3::new(0.3, 0.1 * f64::from(k), -0.7));
        let mut x = sheet.positions().to_vec();
        for p in x.as_chunks_mut::<3>().0 {
            *p = (turn * Vector3::from(*p) + Vector3::new(0.1, 0.2, 0.3)).into();
        }
        assert!(crossings(&mesh, &x).is_empty());
    }
}
