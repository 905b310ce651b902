use super::*;
use isosheet_materials::hessian::HessianProduct;
use isosheet_materials::vectors::dot;
use isosheet_mesh::Topology;

/// The corners of an octahedron that is pushed out of shape, and its faces with their front outside.
pub(in crate::sheet_model) fn octahedron() -> (Topology, Vec<f64>) {
    let faces: Vec<[u32; 3]> = (0..4)
        .flat_map(|k| {
            let (here, next) = (k, (k + 1) % 4);
            [[here, next, 4], [next, here, 5]]
        })
        .collect();
    let corners = [
        [1.0, 0.0, 0.1],
        [0.0, 1.2, 0.0],
        [-1.0, 0.2, 0.0],
        [0.0, -1.0, -0.3],
        [0.1, 0.0, 1.0],
        [0.0, 0.2, -0.7],
    ];
    let topology = Topology::from_faces(6, &faces).expect("an octahedron");
    (topology, corners.concat())
}

fn volume() -> (Volume, Topology, Vec<f64>) {
    let (topology, x) = octahedron();
    let faces = LoadedFaces::all(&topology).expect("faces");
    (Volume::new(&faces), topology, x)
}

fn moved(x: &[f64], by: f64, direction: &[f64]) -> Vec<f64> {
    x.iter().zip(direction).map(|(x, d)| x + by * d).collect()
}

fn gradient(volume: &Volume, x: &[f64]) -> Vec<f64> {
    volume
        .gradient(x)
        .iter()
        .flat_map(|(_, g)| <[f64; 3]>::from(*g))
        .collect()
}

fn product(part: HessianPart, direction: &[f64]) -> Vec<f64> {
    let (volume, topology, x) = volume();
    let edges: Vec<[usize; 2]> = topology
        .edges()
        .iter()
        .map(|e| e.map(|v| v.index()))
        .collect();
    let mut product = vec![0.0; x.len()];
    let mut sink = HessianProduct {
        edges: &edges,
        scale: 1.0,
        vector: direction,
        product: &mut product,
    };
    volume.add_hessian(&x, -0.7, part, &mut sink);
    product
}

fn wave(k: f64) -> Vec<f64> {
    (0..18).map(|i| (k * f64::from(i)).cos()).collect()
}

#[test]
fn derivatives_are_those_of_differences() {
    let (volume, _, x) = volume();
    let tetrahedra = [[0, 1], [1, 2], [2, 3], [3, 0]].map(|[i, j]: [usize; 2]| {
        let at = |k: usize| Vector3::from_column_slice(&x[3 * k..3 * k + 3]);
        (at(i) - at(5))
            .cross(&(at(j) - at(5)))
            .dot(&(at(4) - at(5)))
            / 6.0
    });
    assert!((volume.value(&x) - tetrahedra.iter().sum::<f64>()).abs() < 1e-14);
    let direction = wave(1.3);
    let [up, down] = [1e-5, -1e-5].map(|d| moved(&x, d, &direction));
    let slope = (volume.value(&up) - volume.value(&down)) / 2e-5;
    assert!((slope - dot(&gradient(&volume, &x), &direction)).abs() < 1e-8);
    let [up, down] = [up, down].map(|x| gradient(&volume, &x));
    for (i, p) in product(HessianPart::Full, &direction).iter().enumerate() {
        let slope = -0.7 * (up[i] - down[i]) / 2e-5;
        assert!((slope - p).abs() < 1e-8, "{i}: {slope} {p}");
    }
}

/// The semidefinite part is, and what it leaves out is not positive.
#[test]
fn the_semidefinite_part_is_the_positive_one() {
    for k in 1..200 {
        let direction = wave(0.37 * f64::from(k));
        let part = dot(
            &direction,
            &product(HessianPart::PositiveSemidefinite, &direction),
        );
        let whole = dot(&direction, &product(HessianPart::Full, &direction));
        assert!(
            part >= -1e-12 && whole - part <= 1e-12,
            "{k}: {part} {whole}"
        );
    }
}

/// The volume between two squares whose rims are joined, and stand apart, is that of the box, whichever way
/// their fronts point; its gradient is that of differences.
#[test]
fn strips_close_open_seams() {
    let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
    let lower = square.iter().flat_map(|[x, y]| [*x, *y, 0.3]);
    let x: Vec<f64> = lower
        .chain(square.iter().flat_map(|[x, y]| [*x, *y, 0.8]))
        .collect();
    let pairs: Vec<[VertexId; 2]> = (0..4).map(|k| [VertexId(k), VertexId(k + 4)]).collect();
    for second in [[[4, 5, 6], [4, 6, 7]], [[4, 6, 5], [4, 7, 6]]] {
        let faces = [[0, 1, 2], [0, 2, 3]]
            .into_iter()
            .chain(second)
            .collect::<Vec<_>>();
        let topology = Topology::from_faces(8, &faces).expect("two squares");
        let faces: Vec<_> = topology.face_ids().collect();
        let loaded = LoadedFaces::new(&topology, &faces, &pairs).expect("faces");
        for (loaded, sign) in [(loaded.clone(), -1.0), (loaded.turned_over(), 1.0)] {
            let volume = Volume::new(&loaded);
            assert!((volume.value(&x) - sign * 2.0).abs() < 1e-14);
            let slopes = gradient(&volume, &x);
            for (i, slope) in slopes.iter().enumerate() {
                let at = |d: f64| {
                    let mut x = x.clone();
                    x[i] += d;
                    volume.value(&x)
                };
                assert!(((at(1e-5) - at(-1e-5)) / 2e-5 - slope).abs() < 1e-9, "{i}");
            }
        }
    }
}
