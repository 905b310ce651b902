use super::{Layers, LayersError};
use isosheet_mesh::Topology;

/// Strips of a leporello that lie on each other: each is 1 wide and 2 long, and rises by `gap` over the last
/// one.
fn leporello(strips: usize, gap: f64) -> (Topology, Vec<f64>, Vec<usize>) {
    let mut x = Vec::new();
    for k in 0..=strips {
        let (side, height) = ((k % 2) as f64, gap * k as f64);
        x.extend([side, 0.0, height, side, 2.0, height]);
    }
    let mut faces = Vec::new();
    for k in 0..strips as u32 {
        let [a, b, c, d] = [2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 3];
        // Counter-clockwise in the flat sheet, whose strips go to the right.
        faces.extend([[a, c, d], [a, d, b]]);
    }
    let topology = Topology::from_faces(2 * strips + 2, &faces).unwrap();
    let panels = (0..2 * strips).map(|f| f - f % 2).collect();
    (topology, x, panels)
}

#[test]
fn a_leporello_has_a_layer_for_each_strip() {
    let (topology, x, panels) = leporello(5, 1e-3);
    let layers = Layers::of_panels(&topology, &x, &panels, 1e-6).unwrap();
    assert_eq!(layers.levels, [0, 1, 2, 3, 4]);
    assert_eq!(layers.count(), 5);
    assert_eq!(layers.shows_front, [true, false, true, false, true]);
    // Each two of five strips cover each other.
    assert_eq!(layers.covers.len(), 10);
    // From the second strip on, whose back is up, the next one is on the side against its normal.
    for [f, g, side] in layers.face_orders() {
        assert!(f > g);
        assert_eq!(side, if (g / 2) % 2 == 0 { 1 } else { -1 });
    }
}

#[test]
fn a_leporello_that_is_turned_over_has_the_other_order() {
    let (topology, x, panels) = leporello(4, -1e-3);
    let layers = Layers::of_panels(&topology, &x, &panels, 1e-6).unwrap();
    assert_eq!(layers.levels, [3, 2, 1, 0]);
}

#[test]
fn what_has_no_order_is_refused() {
    let (topology, x, panels) = leporello(3, 1e-9);
    let found = Layers::of_panels(&topology, &x, &panels, 1e-6);
    assert!(
        matches!(found, Err(LayersError::Touching { .. })),
        "{found:?}"
    );
    // One strip stands upright.
    let (topology, mut x, panels) = leporello(1, 0.0);
    let (other, upright, _) = leporello(2, 2.0);
    let found = Layers::of_panels(&other, &upright, &[0, 0, 2, 2], 1e-6);
    assert!(
        matches!(found, Err(LayersError::NotFlat { .. })),
        "{found:?}"
    );
    x.iter_mut().for_each(|c| *c *= 2.0);
    assert_eq!(
        Layers::of_panels(&topology, &x, &panels, 1e-6)
            .unwrap()
            .count(),
        1
    );
}

/// Four strips that are woven: each lies on the next one, and the last one on the first.
#[test]
fn woven_strips_have_no_layers() {
    let mut x: Vec<f64> = Vec::new();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for k in 0..4 {
        let (s, c) = (f64::from(k) * std::f64::consts::FRAC_PI_2).sin_cos();
        // From (-2, -1.5) to (2, -1), higher at its end by more than at its beginning.
        for [p, q] in [[-2.0, -1.5], [2.0, -1.5], [2.0, -1.0], [-2.0, -1.0]] {
            x.extend([c * p - s * q, s * p + c * q, 0.05 * p]);
        }
        let a = 4 * k as u32;
        faces.extend([[a, a + 1, a + 2], [a, a + 2, a + 3]]);
    }
    let topology = Topology::from_faces(16, &faces).unwrap();
    let panels = [0, 0, 2, 2, 4, 4, 6, 6];
    let found = Layers::of_panels(&topology, &x, &panels, 1e-6);
    let Err(LayersError::Circle { faces }) = found else {
        panic!("{found:?}");
    };
    let mut circle: Vec<usize> = faces.iter().map(|f| panels[f.index()]).collect();
    // Each lies on the one before.
    for k in 0..4 {
        assert_eq!((circle[k] + 6) % 8, circle[(k + 1) % 4], "{circle:?}");
    }
    circle.sort_unstable();
    assert_eq!(circle, [0, 2, 4, 6]);
}
